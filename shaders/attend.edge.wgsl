// The edge term, ε_ij = W_e e_ij: joined to attend.wgsl and attend.vertex.wgsl. network.md §3.

// k_c + ε_c (part 1) or v_c + ε_c (part 2) of neighbour j at feature f; `edge` is e_ij.
fn with_edge(part: u32, j: u32, f: u32, edge: mat2x3<f32>) -> f32 {
    let term = dot(weights[3u * f].xyz, edge[0]) + dot(weights[3u * f + 1u].xyz, edge[1]);
    return projected[(4u * j + part) * params.features + f] + term;
}

fn edge_of(i: u32, j: u32) -> mat2x3<f32> {
    return mat2x3((potentials[2u * j] - potentials[2u * i]).xyz, (potentials[2u * j + 1u] - potentials[2u * i + 1u]).xyz);
}
