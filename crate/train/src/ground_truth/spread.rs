//! In which order poses are simulated: those first whose cloth, skinned, is farthest from that of all before.

/// Indices of `places`, ordered.
pub(super) fn spread(places: &[Vec<f32>]) -> Vec<usize> {
    let mode = std::env::var("ORDER").unwrap_or_default();
    let mut rng = fastrand::Rng::with_seed(7);
    let mut nearest = vec![f64::INFINITY; places.len()];
    let mut order = Vec::with_capacity(places.len());
    let mut next = 0;
    while order.len() < places.len() {
        order.push(next);
        nearest[next] = -1.0;
        for (place, nearest) in places.iter().zip(&mut nearest) {
            if *nearest >= 0.0 {
                let square: f32 = place.iter().zip(&places[next]).map(|(a, b)| (a - b) * (a - b)).sum();
                *nearest = nearest.min(f64::from(square));
            }
        }
        next = if mode == "square" {
            let total: f64 = nearest.iter().map(|d| d.max(0.0) + 1e-12).sum();
            let mut left = rng.f64() * total;
            (0..places.len())
                .filter(|i| nearest[*i] >= 0.0)
                .find(|i| {
                    left -= nearest[*i] + 1e-12;
                    left <= 0.0
                })
                .or_else(|| (0..places.len()).rev().find(|i| nearest[*i] >= 0.0))
                .unwrap_or(0)
        } else {
            (0..places.len()).max_by(|a, b| nearest[*a].total_cmp(&nearest[*b])).unwrap_or(0)
        };
    }
    order
}
