//! A trained model predicted a second time by nothing of ours: read by Hugging Face's own crate, computed in f64 after
//! network.md, tensor by tensor. What `ctsn predict` writes must be the same.

mod made;

use ctsn_core::file::{Tensor, Tensors};
use ctsn_core::model::Storage;
use ctsn_train::dataset::Sample;
use ctsn_train::synthetic;
use ctsn_train::training::{Architecture, Settings, Trainer, initial};
use half::f16;
use made::Folder;
use safetensors::{Dtype, SafeTensors};
use serde_json::Value;

/// 3×4, row-major.
type Transform = [f64; 12];

/// Poses predicted.
const POSES: usize = 3;

struct File<'a>(SafeTensors<'a>);

impl File<'_> {
    /// Values of a tensor and its shape.
    fn get(&self, name: &str) -> (Vec<f64>, Vec<usize>) {
        let tensor = self.0.tensor(name).unwrap_or_else(|error| panic!("{name}: {error}"));
        let bytes = tensor.data();
        let words = || bytes.as_chunks::<4>().0.iter().copied();
        let values = match tensor.dtype() {
            Dtype::F32 => words().map(|word| f64::from(f32::from_le_bytes(word))).collect(),
            Dtype::U32 => words().map(|word| f64::from(u32::from_le_bytes(word))).collect(),
            Dtype::F16 => bytes.as_chunks::<2>().0.iter().map(|word| f16::from_le_bytes(*word).to_f64()).collect(),
            other => panic!("{name}: {other:?}"),
        };
        (values, tensor.shape().to_vec())
    }

    /// `W x + b` for each row of x; without a bias where the file has none.
    fn linear(&self, name: &str, x: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let (weight, shape) = self.get(&format!("{name}.weight"));
        let bias = format!("{name}.bias");
        let bias = if self.0.names().contains(&bias.as_str()) { self.get(&bias).0 } else { vec![0.0; shape[0]] };
        let row = |x: &Vec<f64>| {
            assert_eq!(x.len(), shape[1], "{name}");
            (0..shape[0]).map(|o| dot(&weight[o * shape[1]..][..shape[1]], x) + bias[o]).collect()
        };
        x.iter().map(row).collect()
    }

    /// Layers `name.0`, `name.1`, …; ReLU after each, after the last where `last` says so.
    fn mlp(&self, name: &str, mut x: Vec<Vec<f64>>, last: bool) -> Vec<Vec<f64>> {
        let count = (0..).take_while(|i| self.0.tensor(&format!("{name}.{i}.weight")).is_ok()).count();
        for i in 0..count {
            x = self.linear(&format!("{name}.{i}"), &x);
            if last || i + 1 < count {
                x.iter_mut().flatten().for_each(|value| *value = value.max(0.0));
            }
        }
        x
    }

    /// Graph transformer layer `l`: h [n][in] -> [n][F].
    fn attend(
        &self,
        l: usize,
        heads: usize,
        h: &[Vec<f64>],
        potentials: &[Vec<f64>],
        near: &[Vec<usize>],
    ) -> Vec<Vec<f64>> {
        let part = |name: &str, x: &[Vec<f64>]| self.linear(&format!("graph.{l}.{name}"), x);
        let [query, key, value, skip] = ["query", "key", "value", "skip"].map(|name| part(name, h));
        let gate = self.get(&format!("graph.{l}.gate.weight")).0;
        let [scale, shift] = ["weight", "bias"].map(|name| self.get(&format!("graph.{l}.norm.{name}")).0);
        let features = scale.len();
        let d = features / heads;
        let vertex = |i: usize| {
            let mut attended = vec![0.0; features];
            let edges = near[i].iter().map(|j| sum(&potentials[*j], &potentials[i], -1.0)).collect::<Vec<_>>();
            let edges = part("edge", &edges);
            for head in (0..heads).map(|c| c * d..(c + 1) * d) {
                let logit = |(j, edge): (&usize, &Vec<f64>)| {
                    let to = sum(&key[*j][head.clone()], &edge[head.clone()], 1.0);
                    (dot(&query[i][head.clone()], &to) / (d as f64).sqrt()).exp()
                };
                let shares: Vec<f64> = near[i].iter().zip(&edges).map(logit).collect();
                let total: f64 = shares.iter().sum();
                for ((j, edge), share) in near[i].iter().zip(&edges).zip(&shares) {
                    head.clone().for_each(|c| attended[c] += share / total * (value[*j][c] + edge[c]));
                }
            }
            let r = &skip[i];
            let told = [attended.clone(), r.clone(), sum(&attended, r, -1.0)].concat();
            let beta = 1.0 / (1.0 + (-dot(&gate, &told)).exp());
            let z: Vec<f64> = attended.iter().zip(r).map(|(a, r)| (1.0 - beta) * a + beta * r).collect();
            let mean = z.iter().sum::<f64>() / features as f64;
            let variance = z.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / features as f64;
            let norm = |c: usize| ((z[c] - mean) / (variance + 1e-5).sqrt() * scale[c] + shift[c]).max(0.0);
            (0..features).map(norm).collect()
        };
        (0..h.len()).map(vertex).collect()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// a + s b.
fn sum(a: &[f64], b: &[f64], s: f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + s * b).collect()
}

fn multiply(a: &Transform, b: &Transform) -> Transform {
    std::array::from_fn(|e| {
        let (row, column) = (e / 4, e % 4);
        let moved = if column == 3 { a[4 * row + 3] } else { 0.0 };
        (0..3).map(|k| a[4 * row + k] * b[4 * k + column]).sum::<f64>() + moved
    })
}

fn apply(a: &Transform, p: &[f64]) -> Vec<f64> {
    (0..3).map(|row| dot(&a[4 * row..4 * row + 3], p) + a[4 * row + 3]).collect()
}

/// `Σ_j w_j A_j p`.
fn skin(weights: &[f64], transforms: &[Transform], p: &[f64]) -> Vec<f64> {
    let blended = std::array::from_fn(|e| weights.iter().zip(transforms).map(|(w, a)| w * a[e]).sum());
    apply(&blended, p)
}

/// `N·A` per joint, and `N⁻¹`. network.md §1.
fn body_frame(joints: &[Transform], inverse_bind: &[Transform], root: usize) -> (Vec<Transform>, Transform) {
    let a: Vec<Transform> = joints.iter().zip(inverse_bind).map(|(joint, bind)| multiply(joint, bind)).collect();
    let (sin, cos) = (a[root][2] - a[root][8]).atan2(a[root][0] + a[root][10]).sin_cos();
    let [x, y, z] = [3, 7, 11].map(|e| joints[root][e]);
    let turn = [cos, 0.0, -sin, 0.0, 0.0, 1.0, 0.0, 0.0, sin, 0.0, cos, 0.0];
    let into = multiply(&turn, &[1.0, 0.0, 0.0, -x, 0.0, 1.0, 0.0, -y, 0.0, 0.0, 1.0, -z]);
    let back = [cos, 0.0, sin, x, 0.0, 1.0, 0.0, y, -sin, 0.0, cos, z];
    (a.iter().map(|a| multiply(&into, a)).collect(), back)
}

/// What is seen of the cloth around vertex `i`, by the columns of the linear part of its skinning, in metres.
fn around<'a>(
    compass: &'a [Vec<usize>],
    i: usize,
    [now, rest]: [&'a [Vec<f64>]; 2],
    columns: &'a [Vec<f64>; 3],
) -> impl Iterator<Item = f64> + 'a {
    let walks = [1, 3, 8, 20].into_iter().flat_map(|steps| (0..4).map(move |direction| (steps, direction)));
    walks.flat_map(move |(steps, direction)| {
        let to = (0..steps).fold(i, |at, _| compass[at][direction]);
        let way = sum(&now[to], &now[i], -1.0);
        (0..3).map(move |c| (dot(&columns[c], &way) - (rest[to][c] - rest[i][c])) / (0.2 * f64::from(steps)))
    })
}

/// Neighbours of each vertex by the edges of triangles [t][3], ascending.
fn near(n: usize, triangles: &[Vec<f64>]) -> Vec<Vec<usize>> {
    let mut near = vec![std::collections::BTreeSet::new(); n];
    for triangle in triangles {
        let corners: Vec<usize> = triangle.iter().map(|corner| *corner as usize).collect();
        for (a, b) in corners.iter().flat_map(|a| corners.iter().map(move |b| (*a, *b))).filter(|(a, b)| a != b) {
            near[a].insert(b);
        }
    }
    near.into_iter().map(|set| set.into_iter().collect()).collect()
}

/// Positions of one pose [n][3], world. network.md §1–4.
fn predict(file: &File, ctsn: &Value, joints: &[Transform]) -> Vec<Vec<f64>> {
    let numbers = |list: &Value| -> Vec<f64> {
        list.as_array().expect("numbers").iter().map(|number| number.as_f64().expect("a number")).collect()
    };
    let bind = |list: &Value| Transform::try_from(numbers(list)).expect("12 numbers");
    let inverse_bind: Vec<Transform> = ctsn["inverse_bind"].as_array().expect("a list").iter().map(bind).collect();
    assert_eq!(ctsn["frame"], "hip_yaw");
    let (transforms, back) = body_frame(joints, &inverse_bind, ctsn["root"].as_u64().expect("an index") as usize);
    let rows = |name: &str| -> Vec<Vec<f64>> {
        let (values, shape) = file.get(name);
        values.chunks(shape[1]).map(<[f64]>::to_vec).collect()
    };
    let (rest, weights) = (rows("cloth.rest"), rows("cloth.weights"));
    let n = rest.len();
    let near = near(n, &rows("cloth.triangles"));
    // The skeleton stream.
    let (mean, std) = (file.get("pose.mean").0, file.get("pose.std").0);
    let pose = transforms.as_flattened().iter().zip(&mean).zip(&std).map(|((x, mean), std)| (x - mean) / std);
    let embedding = file.mlp("embedding", vec![pose.collect()], false).remove(0);
    let (b, m) = (file.get("skeleton.basis").0, file.get("mesh.basis").0);
    let blend = |i: usize, weights: &[f64], basis: &[f64], c: usize| -> f64 {
        weights.iter().enumerate().map(|(j, weight)| weight * basis[(j * n + i) * 3 + c]).sum()
    };
    let coarse = |i: usize| -> Vec<f64> { (0..3).map(|c| rest[i][c] + blend(i, &embedding, &b, c)).collect() };
    // The mesh stream sees the coarse cloth.
    let reference: Vec<Vec<f64>> = (0..n).map(|i| skin(&weights[i], &transforms, &coarse(i))).collect();
    let (mean, std) = (file.get("reference.mean").0, file.get("reference.std").0);
    let edge_scale = ctsn["edge_scale"].as_f64().expect("a number");
    let potential = |(v, t): (&Vec<f64>, &Vec<f64>)| v.iter().chain(t).map(|x| x / edge_scale).collect();
    let potentials: Vec<Vec<f64>> = reference.iter().zip(&rest).map(potential).collect();
    let compass: Vec<Vec<usize>> =
        rows("graph.compass").into_iter().map(|row| row.into_iter().map(|j| j as usize).collect()).collect();
    let node = |i: usize| -> Vec<f64> {
        let mut node: Vec<f64> = (0..3).map(|c| (reference[i][c] - mean[c]) / std[c]).collect();
        // Column c of the linear part of the vertex's skinning: where it takes axis c.
        let column = |c: usize| -> Vec<f64> {
            (0..3).map(|r| transforms.iter().zip(&weights[i]).map(|(a, w)| w * a[4 * r + c]).sum()).collect()
        };
        let columns = [column(0), column(1), column(2)];
        node.extend(columns.iter().map(|column| column[1]));
        node.extend(around(&compass, i, [&reference, &rest], &columns).map(|strain| strain / edge_scale));
        node
    };
    let mut h: Vec<Vec<f64>> = (0..n).map(node).collect();
    let heads = ctsn["heads"].as_u64().expect("a count") as usize;
    for l in (0..).take_while(|l| file.0.tensor(&format!("graph.{l}.edge.weight")).is_ok()) {
        h = file.attend(l, heads, &h, &potentials, &near);
    }
    let w = file.mlp("vertex", h, true);
    let vertex = |i: usize| {
        let fine: Vec<f64> = (0..3).map(|c| blend(i, &w[i], &m, c)).collect();
        let template = sum(&coarse(i), &fine, 1.0);
        apply(&back, &skin(&weights[i], &transforms, &template))
    };
    (0..n).map(vertex).collect()
}

#[test]
fn an_independent_reader_predicts_the_same() {
    let folder = Folder::new();
    let (setup, samples) = synthetic::dataset(150, 4, 12);
    let samples: Vec<&Sample> = samples.iter().collect();
    let architecture = Architecture { embedding: 5, basis: 6, layers: 2, heads: 2, features: 16 };
    let model = initial(&setup, &samples, architecture, 1).expect("a model");
    let rate = 1e-2;
    let mut trainer =
        Trainer::new(model, &setup, &samples, Settings { rate, ..Settings::default() }).expect("a trainer");
    (0..5).for_each(|_| _ = trainer.epoch(|_, _, _| ()).expect("an epoch"));
    let bytes = trainer.model().to_bytes(Storage::F16);
    folder.write("model.safetensors", &bytes);
    let mut poses = Tensors::default();
    let joints: Vec<f32> = samples[..POSES].iter().flat_map(|sample| sample.joints.clone()).collect();
    poses.tensors.insert("pose.joints".to_owned(), Tensor::f32(&[POSES, 4, 3, 4], &joints));
    folder.write("poses.safetensors", &poses.to_bytes());
    folder.accepts("predict model.safetensors poses.safetensors -o out.safetensors");

    let metadata = SafeTensors::read_metadata(&bytes).expect("metadata").1;
    let ctsn = metadata.metadata().as_ref().expect("metadata")["ctsn"].clone();
    let ctsn: Value = serde_json::from_str(&ctsn).expect("JSON");
    let file = File(SafeTensors::deserialize(&bytes).expect("a model"));
    let predicted = std::fs::read(folder.path("out.safetensors")).expect("a prediction");
    let predicted = File(SafeTensors::deserialize(&predicted).expect("tensors")).get("positions").0;
    let golden = Tensors::parse(include_bytes!("../../../tests/golden/tiny.golden.safetensors")).expect("golden file");
    let tolerances: Value = serde_json::from_str(&golden.metadata["tolerance"]).expect("tolerances");
    let tolerance = tolerances["positions"].as_f64().expect("a tolerance");
    let wanted = joints.chunks(48).flat_map(|pose| {
        let joint = |numbers: &[f32]| -> Transform { std::array::from_fn(|e| f64::from(numbers[e])) };
        predict(&file, &ctsn, &pose.chunks(12).map(joint).collect::<Vec<_>>()).concat()
    });
    let wanted: Vec<f64> = wanted.collect();
    assert_eq!(wanted.len(), predicted.len());
    for (element, (wanted, found)) in wanted.iter().zip(&predicted).enumerate() {
        assert!((wanted - found).abs() <= tolerance, "element {element}: wanted {wanted}, found {found}");
    }
    // The streams do something: without them the prediction is another one.
    folder.accepts("predict model.safetensors poses.safetensors -o plain.safetensors --streams none");
    let plain = std::fs::read(folder.path("plain.safetensors")).expect("a prediction");
    let plain = File(SafeTensors::deserialize(&plain).expect("tensors")).get("positions").0;
    let change = plain.iter().zip(&predicted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(change > 100.0 * tolerance, "{change}");
}
