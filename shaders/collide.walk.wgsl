// Ways over the body's surface to the vertex nearest to a point, for collide.wgsl and settle.wgsl. Twins:
// crate/core/src/cpu/closest.rs, and collide.rs for the seeds.

// A body vertex and the squared distance to it.
struct Place {
    vertex: u32,
    squared: f32,
}

fn closer(best: Place, vertex: u32, point: vec3<f32>) -> Place {
    let found = squared(point - position(vertex));
    return Place(select(best.vertex, vertex, found < best.squared), min(best.squared, found));
}

// The nearest of the seeds of cloth vertex i, the last of them excepted.
fn nearest_own(i: u32, point: vec3<f32>) -> Place {
    var best = Place(seeds_of[i], 3.4e38);
    for (var s = 0u; s < max(params.seeds - 1u, 1u); s++) {
        best = closer(best, seeds_of[s * params.vertices + i], point);
    }
    return best;
}

// The nearest vertex downhill.
fn walk(point: vec3<f32>, start: Place) -> Place {
    var best = start;
    for (var taken = 0u; taken < params.steps; taken++) {
        let next = step_from(point, best, best.vertex);
        if (next.vertex == best.vertex) {
            break;
        }
        best = next;
    }
    return best;
}

// The same from the nearest neighbour of a neighbour: over a ridge, into the crease behind it.
fn leap(point: vec3<f32>, start: Place) -> Place {
    var best = start;
    for (var k = offsets[start.vertex]; k < offsets[start.vertex + 1u]; k++) {
        best = step_from(point, best, fans[k].x);
    }
    if (best.vertex == start.vertex) {
        return start;
    }
    return walk(point, best);
}

// The nearest neighbour of a vertex, if it is nearer than the best so far.
fn step_from(point: vec3<f32>, nearest: Place, vertex: u32) -> Place {
    var best = nearest;
    for (var k = offsets[vertex]; k < offsets[vertex + 1u]; k++) {
        best = closer(best, fans[k].x, point);
    }
    return best;
}
