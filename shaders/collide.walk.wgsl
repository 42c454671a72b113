// Ways over the body's surface to the vertex nearest to a point, for collide.wgsl and settle.wgsl. Twins:
// crate/core/src/cpu/repair/closest.rs, and collide.rs for the seeds.

// Where a walk ended: vertex, squared distance to it, highest corner of the triangles around it along its normal.
struct Place {
    vertex: u32,
    squared: f32,
    top: f32,
}

// The nearest vertex downhill from the nearest of some seeds of cloth vertex i.
fn from_seeds(i: u32, point: vec3<f32>, first: u32, end: u32) -> Place {
    var best = 0u;
    var least = 3.4e38;
    for (var s = first; s < end; s++) {
        let vertex = seeds_of[s * params.vertices + i];
        let found = squared(point - position(vertex));
        best = select(best, vertex, found < least);
        least = min(least, found);
    }
    return downhill(point, best, least);
}

// The nearest vertex downhill from a place.
fn downhill(point: vec3<f32>, start: u32, distance_squared: f32) -> Place {
    var best = start;
    var least = distance_squared;
    for (var step = 0u; step < params.steps; step++) {
        let before = best;
        var top = 0.0;
        for (var k = offsets[before]; k < offsets[before + 1u]; k++) {
            let vertex = fans[k].x;
            let found = squared(point - position(vertex));
            top = max(top, dot(position(vertex) - position(before), normal(before)));
            best = select(best, vertex, found < least);
            least = min(least, found);
        }
        if (best == before) {
            return Place(best, least, top);
        }
    }
    return Place(best, least, 3.4e38);
}
