// A pull shared with the neighbours, for diffuse.wgsl and polish.wgsl: of the binding `pulls`, by `own` and `others` of
// `params`. Twin: crate/core/src/cpu/network/diffuse.rs

// First neighbour of each vertex [n + 1], and the neighbours.
@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> neighbours: array<u32>;

fn pull(i: u32) -> vec3<f32> {
    return vec3(pulls[3u * i], pulls[3u * i + 1u], pulls[3u * i + 2u]);
}

fn diffused_pull(i: u32) -> vec3<f32> {
    var sum = vec3(0.0);
    for (var k = offsets[i]; k < offsets[i + 1u]; k++) {
        sum += pull(neighbours[k]);
    }
    let mean = sum / f32(max(offsets[i + 1u] - offsets[i], 1u));
    return pull(i) * params.own + mean * params.others;
}
