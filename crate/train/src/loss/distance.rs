//! Mean over vertices of `‖x_p - x_g‖`, the paper's L2 distance and its E_dist. network.md §6, §7.

/// predicted, truth [n, 3] -> loss (metres); its gradient times `scale` is added to g [n, 3].
pub fn distance(predicted: &[f32], truth: &[f32], scale: f32, g: &mut [f32]) -> f32 {
    let count = predicted.len() as f32 / 3.0;
    let mut total = 0.0_f64;
    let rows = predicted.as_chunks::<3>().0.iter().zip(truth.as_chunks::<3>().0);
    for ((p, t), g) in rows.zip(g.as_chunks_mut::<3>().0) {
        let d: [f32; 3] = std::array::from_fn(|c| p[c] - t[c]);
        let length = d.iter().map(|d| d * d).sum::<f32>().sqrt();
        total += f64::from(length);
        // At zero distance any unit vector is a subgradient; zero is one too.
        if length > 0.0 {
            (0..3).for_each(|c| g[c] += scale * d[c] / (length * count));
        }
    }
    (total / f64::from(count)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_gradient_is_that_of_central_differences() {
        let mut rng = fastrand::Rng::with_seed(5);
        let [predicted, truth, direction] =
            [0; 3].map(|_| (0..30).map(|_| rng.f32() * 2.0 - 1.0).collect::<Vec<f32>>());
        let mut g = vec![0.0; 30];
        distance(&predicted, &truth, 1.0, &mut g);
        let at = |step: f32| {
            let moved: Vec<f32> = predicted.iter().zip(&direction).map(|(x, d)| x + step * d).collect();
            f64::from(distance(&moved, &truth, 1.0, &mut [0.0; 30]))
        };
        let difference = (at(1e-3) - at(-1e-3)) / 2e-3;
        let analytic: f64 = g.iter().zip(&direction).map(|(g, d)| f64::from(g * d)).sum();
        assert!((difference - analytic).abs() <= 1e-2 * difference.abs(), "{difference} against {analytic}");
    }
}
