//! Order statistics, one definition for every report: the nearest rank.

/// Values in ascending order.
#[derive(Clone, Debug, Default)]
pub struct Sorted(Vec<f64>);

impl Sorted {
    /// Sorts `values`.
    pub fn new(values: impl IntoIterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.into_iter().collect();
        values.sort_by(f64::total_cmp);
        Self(values)
    }

    /// The least value that `percent` of a hundred do not exceed: the least of all for 0, the greatest for 100; 0 of
    /// none.
    pub fn percentile(&self, percent: usize) -> f64 {
        let rank = (self.0.len() * percent).div_ceil(100);
        self.0.get(rank.saturating_sub(1)).copied().unwrap_or_default()
    }

    /// The least value that half of all do not exceed; 0 of none.
    pub fn median(&self) -> f64 {
        self.percentile(50)
    }

    /// The greatest value; 0 of none.
    pub fn greatest(&self) -> f64 {
        self.percentile(100)
    }

    /// Mean; 0 of none.
    pub fn mean(&self) -> f64 {
        self.0.iter().sum::<f64>() / self.0.len().max(1) as f64
    }

    /// All of them, ascending.
    pub fn values(&self) -> &[f64] {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_of_the_nearest_rank() {
        let of = |count: usize| Sorted::new((1..=count).rev().map(|value| value as f64));
        let found = |count, percents: [usize; 5]| percents.map(|percent| of(count).percentile(percent));
        let five = Sorted::new([35.0, 20.0, 50.0, 15.0, 40.0]);
        assert_eq!([5, 30, 40, 50, 100].map(|percent| five.percentile(percent)), [15.0, 20.0, 20.0, 35.0, 50.0]);
        assert_eq!(found(20, [0, 50, 95, 96, 100]), [1.0, 10.0, 19.0, 20.0, 20.0]);
        assert_eq!(found(100, [0, 1, 95, 99, 100]), [1.0, 1.0, 95.0, 99.0, 100.0]);
        assert_eq!(found(1, [0, 1, 50, 99, 100]), [1.0; 5]);
        assert_eq!(found(0, [0, 1, 50, 99, 100]), [0.0; 5]);
        assert_eq!((of(4).median(), of(4).mean(), of(0).mean()), (2.0, 2.5, 0.0));
    }
}
