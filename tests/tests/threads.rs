//! How many threads predict changes no bit: on cloth with more vertices than one thread takes for itself. Native only.
#![cfg(not(target_arch = "wasm32"))]

use ctsn_core::cpu::{Cpu, Level, Threads};
use ctsn_core::model::Cut;
use ctsn_core::operation::{Activation, Attend, Blend, Linear};
use ctsn_core::suite::numbers;
use ctsn_core::topology::Graph;
use ctsn_core::{Predictor, Streams};
use ctsn_tests::{golden, sphere};
use fastrand::Rng;
use std::time::{Duration, Instant};

/// More than the machine may have, and a number that divides no number of rows.
const COUNTS: [usize; 4] = [1, 2, 3, 7];

/// How long a thread may take to join, where other programs keep every core busy.
const PATIENCE: Duration = Duration::from_secs(120);

/// A strip of n vertices.
fn strip(n: usize) -> Graph<Vec<u32>> {
    let triangles: Vec<u32> = (2..n as u32).flat_map(|i| [i - 2, i - 1, i]).collect();
    Graph::new(n, &triangles)
}

/// What comes of `compute` on so many threads, once one of them has joined the caller: who wakes late finds nothing to
/// do.
fn joined<R>(count: usize, mut compute: impl FnMut(Threads) -> R) -> R {
    let threads = Threads::new(count).expect("threads");
    let end = Instant::now() + PATIENCE;
    while Instant::now() < end {
        let result = compute(threads.clone());
        if count == 1 || threads.joined() > 0 {
            return result;
        }
    }
    panic!("{count} threads: none joined within {PATIENCE:?}");
}

/// What `compute` writes with each number of threads, at each level, is what one thread writes.
fn same(what: &str, compute: impl Fn(&mut Cpu) -> Vec<f32>) {
    for level in [Level::fallback(), Level::baseline(), Level::new()] {
        let results = COUNTS.map(|count| joined(count, |threads| compute(&mut Cpu::with_threads(level, threads))));
        for (count, result) in COUNTS.iter().zip(&results) {
            let differ = result.iter().zip(&results[0]).position(|(a, b)| a.to_bits() != b.to_bits());
            assert_eq!(differ, None, "{what}, {level:?}, {count} threads: the first number that differs");
        }
        assert!(results[0].iter().any(|number| *number != 0.0), "{what}: computed");
    }
}

#[test]
fn operations_are_the_same_on_any_number_of_threads() {
    let (n, heads, per_head, rng) = (1001, 3, 5, &mut Rng::with_seed(1));
    let features = heads * per_head;
    let [x, weight, bias] = [n * 33, 33 * 19, 19].map(|count| numbers(rng, count, 1.0));
    same("linear", |cpu| {
        let mut y = vec![0.0; n * 19];
        let (x, weight, bias) = (&x[..], &weight[..], &bias[..]);
        cpu.compute(Linear { x, weight, bias, activation: Activation::Relu, y: &mut y[..] });
        y
    });
    let [weights, basis, rest] = [n * 13, 3 * n * 13, 3 * n].map(|count| numbers(rng, count, 1.0));
    for weights in [&weights[..], &weights[..13]] {
        same("blend", |cpu| {
            let (mut residual, mut template) = (vec![0.0; 3 * n], vec![0.0; 3 * n]);
            let (basis, rest, residual_of, share) = (&basis[..], &rest[..], &mut residual[..], &[0.7][..]);
            let template_of = &mut template[..];
            cpu.compute(Blend { weights, basis, rest, share, residual: residual_of, template: template_of });
            [residual, template].concat()
        });
    }
    let Graph { offsets, neighbours } = strip(n);
    let [projected, potentials, edge] = [n * 4 * features, n * 6, 6 * features].map(|count| numbers(rng, count, 1.0));
    let [gate, norm] = [3 * features, features].map(|count| numbers(rng, count, 0.5));
    same("attend", |cpu| {
        let (mut projected, mut attended, mut output) =
            (projected.clone(), vec![0.0; n * features], vec![0.0; n * features]);
        cpu.compute(Attend {
            offsets: &offsets[..],
            neighbours: &neighbours[..],
            heads,
            projected: &mut projected[..],
            potentials: &potentials[..],
            edge: &edge[..],
            gate: &gate[..],
            norm_weight: &norm[..],
            norm_bias: &norm[..],
            attended: &mut attended[..],
            output: &mut output[..],
        });
        [projected, attended, output].concat()
    });
}

#[test]
fn predictions_are_the_same_on_any_number_of_threads() {
    let small = &golden::ALL[1];
    let (mut model, pose) = (small.host_model(), small.read().poses.swap_remove(1));
    model.body = Some(sphere::body(model.sizes.vertices));
    model.cut = Some(Cut::new(model.rest.clone(), &model.graph, 4).expect("edges with a length"));
    let predict = |count: usize| {
        joined(count, |threads| {
            let mut predictor = Predictor::on_threads(model.clone(), Level::new(), threads);
            predictor.predict_row_major(&pose, Streams::Both).expect("a golden pose");
            let stages = predictor.activations().stages();
            let all = stages.iter().flat_map(|(_, values)| values.iter()).chain(predictor.positions());
            all.chain(predictor.normals()).map(|number| number.to_bits()).collect::<Vec<u32>>()
        })
    };
    let one = predict(1);
    COUNTS.iter().for_each(|count| assert!(predict(*count) == one, "{count} threads"));
}
