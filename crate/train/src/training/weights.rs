//! `W_C^I` with room to learn: skin weights of the nearest body vertex, made smooth over the cloth, and the joints
//! around each vertex. Nearest vertices alone tear loose garments: the vertices of a skirt follow the nearer leg. So
//! weights are blurred over the cloth, each vertex's as far as it is from the body: the least of
//! `Σ_i A_i ‖W_i - W_B[I_C(i)]‖² c_i / (ρ d_i)² + ∫ ‖∇W‖²`, where `A_i` is the vertex's area, `d_i` its distance and
//! `c_i` the cosine between its normal and the body's. network.md §3, §4.

use super::initial::rows_to_skin;
use crate::dataset::Setup;
use crate::{Error, Result};
use ctsn_core::model::Skinning;
use ctsn_core::topology::Graph;
use ctsn_rig::mesh::triangle;
use ctsn_rig::{Mesh, SkinWeights, vertices};
use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};

/// Skin weights per cloth vertex that training may change.
const SLOTS: usize = 8;
/// ρ: length of the blur over distance from the body. Of 0 (none), 0.5, 1, 2, 4, 8, 16 the best on poses to validate a
/// robe and a T-shirt.
const BLUR: f64 = 4.0;
/// Least distance from the body, in mean edge lengths: cloth on the skin keeps its weights.
const LEAST: f64 = 0.06;
/// Least c_i: a body vertex that faces away says nearly nothing, but decides where nothing else does.
const FACING: f64 = 1e-2;

/// `W_C^I` by nearest body vertex, smoothed. Rows sum to one.
pub(super) fn smooth(setup: &Setup, graph: &Graph<Vec<u32>>, nearest: &[usize]) -> Result<Vec<SkinWeights>> {
    let trust = trust(setup, graph, nearest);
    let joints = setup.description.joints.len();
    let n = nearest.len();
    // Cotangent weights of even triangles; positive for any mesh, so that blurred weights are none below zero.
    let side = 1.0 / 3.0_f64.sqrt();
    let mut entries = Vec::new();
    for i in 0..n {
        let neighbours = graph.of(i);
        entries.push(Triplet::new(i, i, trust[i] + side * neighbours.len() as f64));
        entries.extend(neighbours.iter().map(|j| Triplet::new(i, *j as usize, -side)));
    }
    let failed = |reason: String| Error::Training(format!("smoothing the skin weights of {n} vertices: {reason}"));
    let matrix = SparseColMat::try_new_from_triplets(n, n, &entries).map_err(|error| failed(format!("{error:?}")))?;
    let factor = matrix.sp_cholesky(Side::Lower).map_err(|error| failed(format!("{error:?}")))?;
    let mut weights = Mat::zeros(n, joints);
    for (i, nearest) in nearest.iter().enumerate() {
        for (joint, weight) in &setup.body_weights[*nearest] {
            weights[(i, *joint)] += trust[i] * weight;
        }
    }
    factor.solve_in_place(&mut weights);
    Ok((0..n).map(|i| strongest((0..joints).map(|joint| (joint, weights[(i, joint)])))).collect())
}

/// `A_i c_i / (ρ d_i)²` per cloth vertex.
fn trust(setup: &Setup, graph: &Graph<Vec<u32>>, nearest: &[usize]) -> Vec<f64> {
    let mesh = |positions: &[f32], triangles: &[u32]| Mesh {
        positions: vertices(positions),
        triangles: triangles.as_chunks::<3>().0.to_vec(),
    };
    let cloth = mesh(&setup.template, &setup.triangles);
    let body = mesh(&setup.body, &setup.body_triangles);
    let [cloth_normals, body_normals] = [&cloth, &body].map(|mesh| mesh.normals(&mesh.positions));
    let edges = |i: usize| graph.of(i).iter().map(move |j| (i, *j as usize));
    let lengths = (0..nearest.len()).flat_map(edges).map(|(i, j)| cloth.positions[i].distance(cloth.positions[j]));
    let edge = (lengths.sum::<f64>() / graph.neighbours.len().max(1) as f64).max(1e-6);
    let mut trust: Vec<f64> = nearest
        .iter()
        .enumerate()
        .map(|(i, nearest)| {
            let distance = cloth.positions[i].distance(body.positions[*nearest]).max(LEAST * edge);
            let facing = cloth_normals[i].dot(body_normals[*nearest]).max(FACING);
            facing / (BLUR * distance).powi(2)
        })
        .collect();
    let mut areas = vec![0.0; trust.len()];
    for triangle in &cloth.triangles {
        let area = triangle::area(triangle.map(|i| cloth.positions[i as usize]));
        triangle.iter().for_each(|i| areas[*i as usize] += area / 3.0);
    }
    // A vertex without area keeps the weights it has.
    trust.iter_mut().zip(&areas).for_each(|(trust, area)| *trust *= area.max(1e-3 * edge * edge));
    trust
}

/// The strongest joints that fit, with sum one.
fn strongest(row: impl Iterator<Item = (usize, f64)>) -> SkinWeights {
    let mut row: SkinWeights = row.filter(|entry| entry.1 > 1e-4).collect();
    row.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    row.truncate(SLOTS);
    let total: f64 = row.iter().map(|entry| entry.1).sum();
    row.iter_mut().for_each(|entry| entry.1 /= total);
    row
}

/// Rows with room to learn: each vertex also gets, at weight 0, the joints that matter to the cloth around it.
pub(super) fn trainable(graph: &Graph<Vec<u32>>, rows: &[SkinWeights]) -> Skinning<Vec<f32>, Vec<u32>> {
    let row = |i: usize| {
        let mut row = rows[i].clone();
        let mut around = std::collections::BTreeMap::new();
        for j in graph.of(i).iter().flat_map(|j| graph.of(*j as usize)) {
            rows[*j as usize].iter().for_each(|(joint, weight)| *around.entry(*joint).or_insert(0.0) += weight);
        }
        around.retain(|joint, _| !row.iter().any(|(own, _)| own == joint));
        let mut around: Vec<(usize, f64)> = around.into_iter().collect();
        around.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let free = SLOTS.saturating_sub(row.len());
        row.extend(around.into_iter().take(free).map(|(joint, _)| (joint, 0.0)));
        row
    };
    rows_to_skin(&(0..rows.len()).map(row).collect::<Vec<_>>())
}
