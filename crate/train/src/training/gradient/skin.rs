//! `x_i = Σ_s w_is A_s T_i`: `dw_is = g · A_s T_i`, `dT_i = (Σ_s w_is R_s)ᵀ g`. Body frame.

/// rest [n, 3], joints and weights [n, width], transforms [J + 1, 3, 4], g [n, 3] -> drest (overwritten), dweights;
/// empty: not wanted.
pub fn skin(
    rest: &[f32],
    joints: &[u32],
    weights: &[f32],
    transforms: &[f32],
    g: &[f32],
    drest: &mut [f32],
    dweights: &mut [f32],
) {
    let transforms = transforms.as_chunks::<12>().0;
    let width = weights.len() / (g.len() / 3);
    for (i, (t, g)) in rest.as_chunks::<3>().0.iter().zip(g.as_chunks::<3>().0).enumerate() {
        let mut dt = [0.0; 3];
        for slot in i * width..(i + 1) * width {
            let a = &transforms[joints[slot] as usize];
            // gᵀ A, one row vector of 4.
            let row: [f32; 4] = std::array::from_fn(|c| g[0] * a[c] + g[1] * a[4 + c] + g[2] * a[8 + c]);
            if !dweights.is_empty() {
                dweights[slot] += row[0] * t[0] + row[1] * t[1] + row[2] * t[2] + row[3];
            }
            (0..3).for_each(|c| dt[c] += weights[slot] * row[c]);
        }
        if !drest.is_empty() {
            (0..3).for_each(|c| drest[3 * i + c] = dt[c]);
        }
    }
}
