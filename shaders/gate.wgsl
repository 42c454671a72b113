// β = sigmoid(w_g · [ĥ ; r ; ĥ - r]), h = ReLU(LayerNorm((1-β) ĥ + β r)), eps 1e-5. network.md §3.
// The end of attend.wgsl, to whose text it is joined. Twin: crate/core/src/cpu/gate.rs

// The sum of `value` over the workgroup.
fn total(t: u32, value: f32) -> f32 {
    workgroupBarrier();
    sums[t] = value;
    reduce(t, SIZE, 1u);
    return sums[0];
}

// ĥ of vertex i, in `attended` -> h of vertex i.
fn gate(i: u32, t: u32) {
    let features = params.features;
    let skip = (4u * i + 3u) * features;
    var logit = 0.0;
    for (var f = t; f < features; f += SIZE) {
        let w = weights[3u * f + 2u];
        let r = projected[skip + f];
        logit += w.x * attended[f] + w.y * r + w.z * (attended[f] - r);
    }
    let beta = 1.0 / (1.0 + exp(-total(t, logit)));
    var mean = 0.0;
    for (var f = t; f < features; f += SIZE) {
        attended[f] = mix(attended[f], projected[skip + f], beta);
        mean += attended[f];
    }
    mean = total(t, mean) / f32(features);
    var variance = 0.0;
    for (var f = t; f < features; f += SIZE) {
        attended[f] -= mean;
        variance += attended[f] * attended[f];
    }
    let inverse = inverseSqrt(total(t, variance) / f32(features) + 1e-5);
    for (var f = t; f < features; f += SIZE) {
        let normal = attended[f] * inverse * weights[3u * f].w + weights[3u * f + 1u].w;
        output[i * params.stride + f] = max(normal, 0.0);
    }
}
