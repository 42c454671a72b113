//! Area-weighted vertex normals: the sum of the cross products of the triangles around a vertex, made unit length.

/// positions [n, 3], triangles [t, 3] -> normals [n, 3]; +Y where a vertex has no area around it, or more than f32 can hold.
pub fn normals(positions: &[f32], triangles: &[u32], normals: &mut [f32]) {
    let (positions, normals) = (positions.as_chunks::<3>().0, normals.as_chunks_mut::<3>().0);
    normals.fill([0.0; 3]);
    for triangle in triangles.as_chunks::<3>().0 {
        let [a, b, c] = triangle.map(|i| positions[i as usize]);
        let (u, v): ([f32; 3], [f32; 3]) = (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
        let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        for i in triangle {
            let sum = &mut normals[*i as usize];
            (0..3).for_each(|c| sum[c] += normal[c]);
        }
    }
    for normal in normals {
        let length = normal.iter().map(|c| c * c).sum::<f32>().sqrt();
        *normal =
            if length > f32::MIN_POSITIVE && length.is_finite() { normal.map(|c| c / length) } else { [0.0, 1.0, 0.0] };
    }
}
