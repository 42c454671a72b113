// β = sigmoid(w_g · [ĥ ; r ; ĥ - r]), h = ReLU(LayerNorm((1-β) ĥ + β r)), eps 1e-5. network.md §3.
// The end of attend.wgsl and attend.vertex.wgsl, to whose texts it is joined. Twin: crate/core/src/cpu/network/gate.rs

// ĥ of vertex i, in `attended` from `base` on -> h of vertex i, by SIZE invocations t; `total` sums over them.
fn gate(i: u32, t: u32, base: u32) {
    let features = params.features;
    let skip = (4u * i + 3u) * features;
    var logit = 0.0;
    for (var f = t; f < features; f += SIZE) {
        let w = weights[3u * f + 2u];
        let r = projected[skip + f];
        logit += w.x * attended[base + f] + w.y * r + w.z * (attended[base + f] - r);
    }
    let beta = 1.0 / (1.0 + exp(-total(t, logit)));
    var mean = 0.0;
    for (var f = t; f < features; f += SIZE) {
        attended[base + f] = mix(attended[base + f], projected[skip + f], beta);
        mean += attended[base + f];
    }
    mean = total(t, mean) / f32(features);
    var variance = 0.0;
    for (var f = t; f < features; f += SIZE) {
        attended[base + f] -= mean;
        variance += attended[base + f] * attended[base + f];
    }
    let inverse = inverseSqrt(total(t, variance) / f32(features) + 1e-5);
    for (var f = t; f < features; f += SIZE) {
        let normal = attended[base + f] * inverse * weights[3u * f].w + weights[3u * f + 1u].w;
        output[i * params.stride + f] = max(normal, 0.0);
    }
}
