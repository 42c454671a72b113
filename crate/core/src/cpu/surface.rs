//! The drawn surface: every drawn vertex has the position and normal of its cloth vertex. Twin: shaders/surface.wgsl.

/// vertex [d], values [n, 3] -> drawn [d, 3].
pub fn surface(vertex: &[u32], values: &[f32], drawn: &mut [f32]) {
    let values = values.as_chunks::<3>().0;
    for (drawn, vertex) in drawn.as_chunks_mut::<3>().0.iter_mut().zip(vertex) {
        *drawn = values[*vertex as usize];
    }
}
