// Puts body vertices that lie inside another part of the body far away, where they keep no cloth out. They are found
// by the body's winding number, every other vertex counting as a dipole. One workgroup for each that may be buried.
// Twin: crate/core/src/cpu/repair/bury.rs

struct Params {
    vertices: u32,
    // Those that may be buried.
    first: u32,
    end: u32,
    // How far above its own skin a vertex asks, in square roots of its area.
    above: f32,
    // Solid angle of the others from which it is buried.
    least: f32,
    // Where it is put.
    away: f32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Posed body: positions and unit normals [b, 3], areas [b].
@group(0) @binding(1) var<storage, read> body: array<f32>;
@group(0) @binding(2) var<storage, read> normals: array<f32>;
@group(0) @binding(3) var<storage, read> areas: array<f32>;
// [b, 3]
@group(0) @binding(4) var<storage, read_write> exposed: array<f32>;

const SIZE = 64u;
var<workgroup> sums: array<f32, SIZE>;

fn position(vertex: u32) -> vec3<f32> {
    return vec3(body[3u * vertex], body[3u * vertex + 1u], body[3u * vertex + 2u]);
}

fn normal(vertex: u32) -> vec3<f32> {
    return vec3(normals[3u * vertex], normals[3u * vertex + 1u], normals[3u * vertex + 2u]);
}

// Solid angle of the other vertices' areas from `point`: every SIZEth from t on.
fn dipoles(point: vec3<f32>, own: u32, t: u32) -> f32 {
    var sum = 0.0;
    for (var i = t; i < params.vertices; i += SIZE) {
        let way = position(i) - point;
        let squared = dot(way, way);
        let angle = dot(way, normal(i)) * areas[i] / max(squared * sqrt(squared), 1.1754944e-38);
        sum += select(angle, 0.0, i == own);
    }
    return sum;
}

@compute @workgroup_size(64)
fn bury(@builtin(workgroup_id) id: vec3<u32>, @builtin(local_invocation_id) lane: vec3<u32>) {
    let t = lane.x;
    // All others are copied, by all workgroups together.
    let groups = max(params.end - params.first, 1u);
    for (var i = id.x * SIZE + t; i < params.vertices; i += groups * SIZE) {
        if (i < params.first || i >= params.end) {
            exposed[3u * i] = body[3u * i];
            exposed[3u * i + 1u] = body[3u * i + 1u];
            exposed[3u * i + 2u] = body[3u * i + 2u];
        }
    }
    let vertex = params.first + id.x;
    let known = min(vertex, params.vertices - 1u);
    let height = params.above * sqrt(areas[known]);
    sums[t] = dipoles(position(known) + normal(known) * height, known, t);
    workgroupBarrier();
    if (t > 0u || vertex >= params.end) {
        return;
    }
    var sum = 0.0;
    for (var i = 0u; i < SIZE; i++) {
        sum += sums[i];
    }
    let buried = sum > params.least && areas[vertex] > 0.0;
    exposed[3u * vertex] = select(body[3u * vertex], params.away, buried);
    exposed[3u * vertex + 1u] = select(body[3u * vertex + 1u], params.away, buried);
    exposed[3u * vertex + 2u] = select(body[3u * vertex + 2u], params.away, buried);
}
