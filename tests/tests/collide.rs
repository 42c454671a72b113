//! Penetration repair: what is inside a body comes out, what is outside stays, and no body makes NaN; the GPU agrees.

use ctsn_core::cpu::Level;
use ctsn_core::cpu::repair::closest::{DEPTH, GAP};
use ctsn_core::cpu::repair::spread::FOLLOW;
use ctsn_core::model::HostModel;
use ctsn_core::topology::Graph;
use ctsn_core::{Predictor, Streams};
#[cfg(feature = "machine")]
use ctsn_tests::finite::largest;
use ctsn_tests::nested::{EMERGED, buried, emerged};
#[cfg(feature = "machine")]
use ctsn_tests::random;
use ctsn_tests::sphere::{RADIUS, RINGS, length, model, sphere};
use fastrand::Rng;
#[cfg(target_arch = "wasm32")]
use wasm_bindgen_test::{wasm_bindgen_test as test, wasm_bindgen_test_configure};

#[cfg(target_arch = "wasm32")]
wasm_bindgen_test_configure!(run_in_browser);

/// Points within a ball twice as wide as the body.
fn points(rng: &mut Rng, count: usize) -> Vec<f32> {
    let point = |rng: &mut Rng| std::array::from_fn::<f32, 3, _>(|_| (2.0 * rng.f32() - 1.0) * 2.0 * RADIUS);
    (0..count).flat_map(|_| point(rng)).collect()
}

/// The one joint where it is bound.
const STILL: [f32; 12] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];

/// Predicted positions, back in the space of the rest.
fn predict(model: &HostModel) -> Vec<f32> {
    let mut predictor = Predictor::from_model(model.clone(), Level::new());
    predictor.predict_row_major(&STILL, Streams::Both).expect("a pose");
    predictor.positions().to_vec()
}

#[test]
fn what_is_inside_comes_out_and_what_is_outside_stays() {
    let mut rng = Rng::with_seed(5);
    let (positions, triangles) = sphere();
    let places = points(&mut rng, 4000);
    let model = model(&mut rng, places.clone(), positions, triangles);
    let found = predict(&model);
    // A flat triangle of the sphere lies this far below it.
    let sagitta = RADIUS * (1.0 - (std::f32::consts::PI / RINGS as f32).cos());
    let (mut inside, mut outside) = (0, 0);
    for (place, found) in places.chunks_exact(3).zip(found.chunks_exact(3)) {
        if length(place) < RADIUS - sagitta {
            inside += 1;
            assert!(length(found) > RADIUS - sagitta + 0.9 * GAP, "{place:?} came to {found:?}");
        } else if length(place) > RADIUS + 1.01 * GAP {
            outside += 1;
            assert!(place.iter().zip(found).all(|(a, b)| (a - b).abs() < 1e-6), "{place:?} was moved to {found:?}");
        }
    }
    assert!(inside > 100 && outside > 1000, "{inside} inside, {outside} outside");
}

/// Two spheres far apart, a landmark of either first; the cloth, in and around the second, has all its seeds on the
/// first.
fn two_spheres(rng: &mut Rng) -> HostModel {
    let (near, faces) = sphere();
    let count = (near.len() / 3) as u32;
    let moved: Vec<f32> = near.chunks_exact(3).flat_map(|p| [p[0] + APART, p[1], p[2]]).collect();
    let mut positions = [near, moved].concat();
    let mut triangles = [faces.clone(), faces.iter().map(|i| i + count).collect()].concat();
    // A vertex of the second trades places with the first one's second.
    (0..3).for_each(|c| positions.swap(3 + c, 3 * count as usize + c));
    let traded = |i: u32| [(1, count), (count, 1)].into_iter().find(|trade| trade.0 == i).map_or(i, |trade| trade.1);
    triangles.iter_mut().for_each(|i| *i = traded(*i));
    let places = points(rng, 2000).chunks_exact(3).flat_map(|p| [p[0] + APART, p[1], p[2]]).collect();
    let mut model = model(rng, places, positions, triangles);
    let body = model.body.as_mut().expect("a body");
    body.seeds.iter_mut().for_each(|seed| *seed = 2 + *seed % (count - 2));
    model
}

/// Distance between the middles of the two spheres, metres.
const APART: f32 = 0.3;

#[test]
fn cloth_that_hangs_free_comes_out_of_what_it_never_met() {
    let model = two_spheres(&mut Rng::with_seed(9));
    let sagitta = RADIUS * (1.0 - (std::f32::consts::PI / RINGS as f32).cos());
    let from_middle = |point: &[f32]| length(&[point[0] - APART, point[1], point[2]]);
    let mut inside = 0;
    for (place, found) in model.rest.chunks_exact(3).zip(predict(&model).chunks_exact(3)) {
        if from_middle(place) < RADIUS - sagitta {
            inside += 1;
            assert!(from_middle(found) > RADIUS - sagitta + 0.9 * GAP, "{place:?} came to {found:?}");
        } else if from_middle(place) > RADIUS + 1.01 * GAP {
            assert!(place.iter().zip(found).all(|(a, b)| (a - b).abs() < 1e-6), "{place:?} was moved to {found:?}");
        }
    }
    assert!(inside > 50, "{inside} inside");
}

#[test]
fn cloth_on_skin_that_is_inside_another_part_stays_there() {
    let model = buried(&mut Rng::with_seed(13));
    assert_eq!(model.rest, predict(&model));
}

#[test]
fn cloth_beside_the_rim_of_what_is_buried_comes_out() {
    let model = emerged(&mut Rng::with_seed(15));
    assert!(model.rest.len() > 3 * 300);
    for (place, found) in model.rest.chunks_exact(3).zip(predict(&model).chunks_exact(3)) {
        let height = length(&[found[0], found[1] - EMERGED, found[2]]) - RADIUS;
        assert!(height > 0.0, "{place:?} came to {found:?}, {height}");
    }
}

#[test]
fn no_body_makes_nan() {
    #[cfg(feature = "machine")]
    let gpu = gpu();
    let mut rng = Rng::with_seed(6);
    let (positions, triangles) = sphere();
    let half = triangles[..triangles.len() / 2].to_vec();
    let flat: Vec<f32> = positions.chunks_exact(3).flat_map(|p| [p[0], 0.0, p[2]]).collect();
    let sliver: Vec<u32> = triangles.chunks_exact(3).flat_map(|t| [t[0], t[0], t[1]]).collect();
    let bodies = [
        ("open", positions.clone(), half),
        ("a point", vec![0.01; positions.len()], triangles.clone()),
        ("folded flat", flat, triangles.clone()),
        ("slivers", positions.clone(), sliver),
        ("inside out", positions.clone(), triangles.chunks_exact(3).flat_map(|t| [t[0], t[2], t[1]]).collect()),
        ("without triangles", positions, Vec::new()),
    ];
    for (name, positions, triangles) in bodies {
        let places = points(&mut rng, 500);
        let model = model(&mut rng, places.clone(), positions, triangles);
        let found = predict(&model);
        assert!(found.iter().all(|c| c.is_finite()), "{name}");
        #[cfg(feature = "machine")]
        assert!(on_gpu(&gpu, &model).iter().all(|c| c.is_finite()), "{name}, GPU");
        let far = places.iter().zip(&found).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        // Twice: by the first look and by the second.
        assert!(far < 2.0 * (DEPTH + GAP), "{name}: a vertex flew {far} m");
    }
}

/// A displacement takes the neighbours along, and what must move still does.
#[test]
fn neighbours_follow() {
    let mut rng = Rng::with_seed(7);
    let (positions, triangles) = sphere();
    // One vertex inside, two beside it outside, one apart.
    let places = vec![0.0, 0.045, 0.0, 0.02, 0.07, 0.0, -0.02, 0.07, 0.0, 0.0, 0.09, 0.0];
    let mut model = model(&mut rng, places.clone(), positions, triangles);
    model.graph = Graph::new(4, &[0, 1, 2]);
    let found = predict(&model);
    assert!(length(&found[..3]) > RADIUS + 0.8 * GAP, "{found:?}");
    for vertex in [1, 2] {
        let rise = found[3 * vertex + 1] - places[3 * vertex + 1];
        assert!((1e-3..RADIUS).contains(&rise), "vertex {vertex} rose by {rise}");
    }
    assert_eq!(found[9..], places[9..]);
}

/// Middle of the upper sphere, metres.
const UPPER: f32 = 0.14;

/// One sphere above another; the first cloth vertex is deep in the lower one and leaves it upwards, the second is its
/// neighbour, just below the upper one.
fn dragged(rng: &mut Rng) -> HostModel {
    let (lower, faces) = sphere();
    let count = (lower.len() / 3) as u32;
    let upper: Vec<f32> = lower.chunks_exact(3).flat_map(|p| [p[0], p[1] + UPPER, p[2]]).collect();
    let triangles = [faces.clone(), faces.iter().map(|i| i + count).collect()].concat();
    // Beside the axis: on it, every way out is as good as the others.
    let places = vec![0.004, 0.025, 0.003, 0.004, UPPER - RADIUS - 0.005, 0.003];
    let mut model = model(rng, places, [lower, upper].concat(), triangles);
    model.graph = Graph::new(2, &[0, 1, 1]);
    // The top of the lower sphere, the bottom of the upper one.
    model.body.as_mut().expect("a body").seeds = [[0; 4], [count + 1; 4]].concat();
    model
}

#[test]
fn what_neighbours_drag_into_the_body_comes_out() {
    let model = dragged(&mut Rng::with_seed(11));
    let found = predict(&model);
    let dragged = model.rest[4] + FOLLOW * (found[1] - model.rest[1]);
    assert!(found[1] > RADIUS, "the first stays inside: {found:?}");
    assert!(dragged > UPPER - RADIUS + 0.01, "nothing drags the second inside: {found:?}");
    assert!(length(&[found[3], found[4] - UPPER, found[5]]) > 0.98 * RADIUS, "the second stays inside: {found:?}");
}

#[cfg(feature = "machine")]
fn gpu() -> ctsn_gpu::Gpu {
    pollster::block_on(ctsn_gpu::Gpu::new()).expect("a Vulkan adapter (Debian: mesa-vulkan-drivers)")
}

/// What [`predict`] tells, from the GPU.
#[cfg(feature = "machine")]
fn on_gpu(gpu: &ctsn_gpu::Gpu, model: &HostModel) -> Vec<f32> {
    use pollster::block_on;
    let model = block_on(ctsn_gpu::Model::new(gpu, model)).expect("a model");
    let mut predictor = block_on(ctsn_gpu::Predictor::new(&model)).expect("a predictor");
    predictor.predict_row_major(&STILL, Streams::Both).expect("a pose");
    block_on(predictor.read()).expect("a prediction").positions
}

#[cfg(feature = "machine")]
#[test]
fn the_gpu_finds_what_cloth_never_met() {
    let [a, b, c, d] = [10, 12, 14, 16].map(Rng::with_seed);
    for (scene, mut rng) in [(two_spheres as fn(&mut Rng) -> HostModel, a), (dragged, b), (buried, c), (emerged, d)] {
        let model = scene(&mut rng);
        let found = on_gpu(&gpu(), &model);
        let difference = largest(&predict(&model), &found);
        assert!(difference <= 1e-4, "{difference}");
    }
}

#[cfg(feature = "machine")]
#[test]
fn the_gpu_agrees() {
    use pollster::block_on;
    let gpu = gpu();
    let mut rng = Rng::with_seed(8);
    let (positions, triangles) = sphere();
    let places = points(&mut rng, 999);
    let mut model = model(&mut rng, places, positions, triangles);
    model.graph = Graph::new(999, &(0..997).flat_map(|i| [i, i + 1, i + 2]).collect::<Vec<_>>());
    let on_gpu = block_on(ctsn_gpu::Model::new(&gpu, &model)).expect("a model");
    let mut on_gpu = block_on(ctsn_gpu::Predictor::new(&on_gpu)).expect("a predictor");
    let mut on_cpu = Predictor::from_model(model.clone(), Level::new());
    let mut bare = Predictor::from_model(HostModel { body: None, ..model }, Level::new());
    for _ in 0..20 {
        let pose = random::pose(&mut rng, 1);
        on_gpu.predict_row_major(&pose, Streams::Both).expect("a pose");
        on_cpu.predict_row_major(&pose, Streams::Both).expect("a pose");
        bare.predict_row_major(&pose, Streams::Both).expect("a pose");
        let found = block_on(on_gpu.read()).expect("a prediction").positions;
        assert!(largest(&found, on_cpu.positions()) <= 1e-4);
        assert!(largest(bare.positions(), on_cpu.positions()) > 0.01, "nothing was repaired");
    }
}
