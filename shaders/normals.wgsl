// Area-weighted vertex normals: the sum of the cross products of the triangles around a vertex, made unit length.
// Gathered by vertex, in the order of the triangles. Twin: crate/core/src/cpu/network/normals.rs

struct Params {
    vertices: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// [n, 3]
@group(0) @binding(1) var<storage, read> positions: array<f32>;
// First corner of each vertex [n + 1].
@group(0) @binding(2) var<storage, read> offsets: array<u32>;
// Vertices of the triangles around a vertex, three by three.
@group(0) @binding(3) var<storage, read> corners: array<u32>;
// [n, 3]
@group(0) @binding(4) var<storage, read_write> normals_of: array<f32>;

fn position(corner: u32) -> vec3<f32> {
    let at = 3u * corners[corner];
    return vec3(positions[at], positions[at + 1u], positions[at + 2u]);
}

// Twice the area of the triangle with sides u and v, along its normal. None where they are parallel: hardware that
// multiplies and adds at once leaves the rounding of a product, which has a direction.
fn area(u: vec3<f32>, v: vec3<f32>) -> vec3<f32> {
    let area = cross(u, v);
    return select(vec3(0.0), area, dot(area, area) > 1e-12 * dot(u, u) * dot(v, v));
}

@compute @workgroup_size(64)
fn normals(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= params.vertices) {
        return;
    }
    var sum = vec3(0.0);
    for (var corner = offsets[i]; corner < offsets[i + 1u]; corner += 3u) {
        let a = position(corner);
        sum += area(position(corner + 1u) - a, position(corner + 2u) - a);
    }
    // +Y where a vertex has no area around it, or more than f32 can hold; squares of less than 1e-18 lose their digits.
    let length = sqrt(dot(sum, sum));
    let normal = select(vec3(0.0, 1.0, 0.0), sum / length, length > 1e-18 && length < 3.4e38);
    normals_of[3u * i] = normal.x;
    normals_of[3u * i + 1u] = normal.y;
    normals_of[3u * i + 2u] = normal.z;
}
