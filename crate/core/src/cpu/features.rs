//! h⁰ and the edge potentials, whose differences are the edge features `e_ij`. network.md §3.

/// v [n, 3], rest [n, 3] -> nodes [n, 3], potentials [n, 6] = [V ; T_C] / edge_scale.
pub fn features(
    v: &[f32],
    rest: &[f32],
    mean: &[f32; 3],
    std: &[f32; 3],
    edge_scale: f32,
    nodes: &mut [f32],
    potentials: &mut [f32],
) {
    let rows = v.as_chunks::<3>().0.iter().zip(rest.as_chunks::<3>().0);
    let outputs = nodes.as_chunks_mut::<3>().0.iter_mut().zip(potentials.as_chunks_mut::<6>().0);
    for ((v, rest), (node, potential)) in rows.zip(outputs) {
        for c in 0..3 {
            node[c] = (v[c] - mean[c]) / std[c];
            potential[c] = v[c] / edge_scale;
            potential[3 + c] = rest[c] / edge_scale;
        }
    }
}
