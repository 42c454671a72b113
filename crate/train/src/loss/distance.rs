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
