//! Which sizes of the network are worth their arithmetic: the Pareto front of error against operations, and one to
//! recommend.

/// Errors up to this share above the least count as equally good.
pub const MARGIN: f64 = 0.02;

/// Indices of the (operations, error) pairs that no other pair beats in both, by rising operations.
pub fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    let pair = |i: usize| points[i];
    order.sort_by(|a, b| pair(*a).0.total_cmp(&pair(*b).0).then(pair(*a).1.total_cmp(&pair(*b).1)));
    let mut least = f64::INFINITY;
    order.retain(|i| {
        let better = pair(*i).1 < least;
        least = least.min(pair(*i).1);
        better
    });
    order
}

/// The pair with the fewest operations whose error is within [`MARGIN`] of the least.
pub fn recommended(points: &[(f64, f64)]) -> Option<usize> {
    let least = points.iter().map(|point| point.1).fold(f64::INFINITY, f64::min);
    front(points).into_iter().find(|i| points[*i].1 <= least * (1.0 + MARGIN))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_holds_what_nothing_beats_and_the_cheapest_good_one_is_recommended() {
        let points = [(40.0, 5.0), (10.0, 8.0), (20.0, 5.09), (15.0, 9.0), (30.0, 5.09), (12.0, 8.0)];
        assert_eq!(front(&points), [1, 2, 0]);
        assert_eq!(recommended(&points), Some(2), "1.8 % worse than the best, at half the cost");
        assert_eq!(recommended(&[(40.0, 5.0), (20.0, 5.2)]), Some(0), "4 % is too much");
        assert_eq!(recommended(&[]), None);
    }
}
