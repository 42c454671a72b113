use ctsn_author::{synthetic, train::*};
use ctsn_core::{Predictor, Streams, cpu::*, device::*};
fn time(name: &str, mut f: impl FnMut()) {
    let mut v = vec![];
    for _ in 0..30 {
        let t = std::time::Instant::now();
        f();
        v.push(t.elapsed().as_secs_f64() * 1e3);
    }
    v.sort_by(f64::total_cmp);
    println!("{name:<12} least {:.3} med {:.3}", v[0], v[15]);
}
fn main() {
    let (setup, samples) = synthetic::dataset(5000, 65, 4);
    let s: Vec<_> = samples.iter().collect();
    let m = initial(&setup, &s, Architecture::default(), 1).unwrap();
    let l = Level::new();
    println!("{l:?}");
    let mut p = Predictor::from_model(m.clone(), l);
    time("predict", || p.predict_row_major(&samples[0].joints, Streams::Both).unwrap());
    let a = p.activations();
    let n = m.sizes.vertices;
    let mut big = vec![0.0; n * 256];
    let mut f = vec![0.0; n * 64];
    let mut x3 = vec![0.0; n * 3];
    let mut x6 = vec![0.0; n * 6];
    let mut sc = attend::Scratch::default();
    for (i, layer) in m.layers.iter().enumerate() {
        let h = if i == 0 { &a.nodes } else { &a.layers[0].output };
        time("project", || {
            linear::linear(l, h, &layer.project.weight, &layer.project.bias, Activation::None, &mut big)
        });
        time("attend", || {
            attend::attend(l, &m.graph, 4, &a.layers[i].projected, &a.potentials, &layer.edge, &mut sc, &mut f)
        });
        time("gate", || {
            gate::gate(
                l,
                &a.layers[i].attended,
                &a.layers[i].projected,
                &layer.gate,
                &layer.norm_weight,
                &layer.norm_bias,
                &mut f,
            )
        });
    }
    time("vertex0", || {
        linear::linear(l, &a.layers[1].output, &m.vertex[0].weight, &m.vertex[0].bias, Activation::Relu, &mut f)
    });
    time("blend M", || blend::blend(l, a.vertex.last().unwrap(), &m.mesh, &mut x3));
    time("blend B", || blend::blend(l, a.embedding.last().unwrap(), &m.skeleton, &mut x3));
    time("skin", || skin::skin(l, &m.rest, &m.skin.joints, &m.skin.weights, &a.body_frame, Space::World, &mut x3));
    let mut nd = vec![0.0; n * 3];
    time("features", || {
        features::features(
            &a.reference,
            &m.rest,
            &m.reference.mean,
            &m.reference.std,
            m.reference.edge_scale,
            &mut nd,
            &mut x6,
        )
    });
    time("normals", || normals::normals(&a.positions, &m.triangles, &mut x3));
    time("embedding", || {
        let mut y = vec![0.0; 128];
        linear::linear(l, &a.pose, &m.embedding[0].weight, &m.embedding[0].bias, Activation::Relu, &mut y)
    });
}
