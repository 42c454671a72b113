// The body that cloth is kept out of, and how far a point is from its gap, for collide.wgsl and settle.wgsl.
// Twins: crate/core/src/cpu/repair/closest.rs, and collide.rs for the seeds.

struct Params {
    vertices: u32,
    // Seeds per vertex.
    seeds: u32,
    steps: u32,
    gap: f32,
    // How far above the body there is room.
    reach: f32,
    depth: f32,
    steepest: f32,
    sliver: f32,
    folded: f32,
    // The body's first vertices, spread evenly over it.
    landmarks: u32,
    free: f32,
    elsewhere: f32,
    again: f32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Posed body: positions and unit normals [b, 3].
@group(0) @binding(1) var<storage, read> body: array<f32>;
@group(0) @binding(2) var<storage, read> body_normals: array<f32>;
// First triangle around each body vertex [b + 1], and the other two corners of each.
@group(0) @binding(3) var<storage, read> offsets: array<u32>;
@group(0) @binding(4) var<storage, read> fans: array<vec2<u32>>;
// [seeds, n]
@group(0) @binding(5) var<storage, read> seeds_of: array<u32>;

fn position(vertex: u32) -> vec3<f32> {
    return vec3(body[3u * vertex], body[3u * vertex + 1u], body[3u * vertex + 2u]);
}

fn normal(vertex: u32) -> vec3<f32> {
    return vec3(body_normals[3u * vertex], body_normals[3u * vertex + 1u], body_normals[3u * vertex + 2u]);
}

// The last seed of cloth vertex i: on another part of the body, the first again where there is none.
fn other_seed(i: u32) -> u32 {
    return seeds_of[(params.seeds - 1u) * params.vertices + i];
}

// Whether a place is too far away to lead to a part nearer than what was found: squared distances.
fn is_elsewhere(place: f32, found: f32) -> bool {
    let bound = sqrt(found) + params.elsewhere;
    return place > bound * bound;
}

// The displacement out of reach, and the squared distance to the body around a place. (Parted in two functions, or with
// the highest corner sought here instead of on the walk, a software adapter took 5 ms instead of 2.)
fn push_from(point: vec3<f32>, place: Place) -> vec4<f32> {
    let vertex = place.vertex;
    if (dot(point - position(vertex), normal(vertex)) - place.top > params.reach) {
        return vec4(0.0, 0.0, 0.0, place.squared);
    }
    let a = position(vertex);
    var best = vec3(3.4e38, 0.0, 0.0);
    var foot = vec3(0.0);
    var corners = vec2(vertex);
    for (var k = offsets[vertex]; k < offsets[vertex + 1u]; k++) {
        let others = fans[k];
        let ab = position(others.x) - a;
        let ac = position(others.y) - a;
        let spot = closest(point - a, ab, ac);
        if (spot.x < best.x) {
            best = spot;
            foot = a + ab * spot.y + ac * spot.z;
            corners = others;
        }
    }
    let steep = normal(vertex) * (1.0 - best.y - best.z) + normal(corners.x) * best.y + normal(corners.y) * best.z;
    let least = squared(point - foot);
    let length = sqrt(squared(steep));
    let up = steep / max(length, 1e-30);
    let along_up = dot(point - foot, up);
    let beside = least > params.gap * params.gap && abs(along_up) < params.steepest * sqrt(least);
    let found = best.x < 3.4e38 && length > params.folded && !beside && along_up >= -params.depth;
    let height = select(along_up, sqrt(least), along_up > 0.0);
    return select(vec4(0.0, 0.0, 0.0, 3.4e38), vec4(up * max(params.reach - height, 0.0), least), found);
}
