//! A body where tools have deleted the skin under clothes: around bones that a garment covers and no skin is around, a
//! closed shell, as thick as bodies are and as far inside the cloth as cloth is thick. simulation.md §4.5.

use super::bones::{Bone, bones};
use super::cut::extract_parts;
use super::field::Field;
use super::nearest::Faces;
use super::remesh::remesh;
use ctsn_rig::mesh::bounds;
use ctsn_rig::{Character, Mesh, SkinWeights, SkinnedMesh};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Lengths in body extents: between two points of a bone; how far skin and cloth are looked for; the radius of a trunk
/// and of a limb at most; how far from the upright axis through the hip limbs begin; the shell's distance from cloth;
/// how far it goes on under the skin; how far the weights of skin reach.
const STEP: f64 = 0.012;
const REACH: f64 = 0.2;
const THICKEST: [f64; 2] = [0.11, 0.055];
const AXIS: f64 = 0.04;
const INSET: f64 = 0.004;
const OVERLAP: f64 = 0.02;
const SKIN_REACH: f64 = 0.03;
/// Shares of the directions from a bone: with less skin it is bare, with more cloth it is covered.
const SKIN: f64 = 0.5;
const COVERED: f64 = 0.6;
/// Fewest bare points: a bone's end that stands out of a mesh is no missing body.
const FEWEST: usize = 4;
/// Vertices of the shell, about.
const VERTICES: usize = 2500;

/// A point of a bone.
struct Point {
    at: DVec3,
    joint: usize,
    /// Whether a garment is around it, and no skin.
    bare: bool,
}

/// Directions to the corners, edges and sides of a cube, by their step; a little aside, for along an axis rays run
/// through edges.
fn ways(step: usize) -> Vec<DVec3> {
    let way = |i: usize| DVec3::new((i % 3) as f64, (i / 3 % 3) as f64, (i / 9) as f64) - 1.0;
    let ways = (0..27).step_by(step).map(way).filter(|way| *way != DVec3::ZERO);
    ways.map(|way| (way + DVec3::new(0.013, 0.029, 0.017)).normalize()).collect()
}

/// The share of these directions in which a face is met within `reach` metres.
fn share(faces: &Faces, ways: &[DVec3], at: DVec3, reach: f64) -> f64 {
    ways.iter().filter(|way| faces.first_hit(at, **way, reach).is_some()).count() as f64 / ways.len() as f64
}

/// Adds to the body what is missing of it under the garment (canonical, metres). -> what was missing, or nothing.
pub(crate) fn complete(character: &mut Character, garment: &Mesh) -> Option<String> {
    let skin = &character.body.mesh;
    let mut whole = SkinnedMesh { mesh: skin.clone(), weights: Vec::new() };
    whole.extend(SkinnedMesh { mesh: garment.clone(), weights: Vec::new() });
    let extent = whole.mesh.extent();
    let bones = bones(character);
    let points = points(&bones, skin, garment, extent);
    if points.iter().filter(|point| point.bare).count() < FEWEST {
        return None;
    }
    let hip = character.canonical_pose()[character.root].translation;
    let field = field(&points, &whole.mesh, extent, hip);
    let piece = extract_parts(&field);
    if piece.mesh.triangles.is_empty() {
        return None;
    }
    let mesh = remesh(piece, &field, &[], VERTICES).mesh;
    let faces = Faces::new(skin);
    let weights = mesh.positions.iter().map(|point| weights(*point, &bones, &faces, &character.body, extent)).collect();
    let count = mesh.positions.len();
    let mut shares: BTreeMap<usize, [usize; 2]> = BTreeMap::new();
    points.iter().for_each(|point| shares.entry(point.joint).or_default()[usize::from(point.bare)] += 1);
    let named = shares.iter().filter(|(_, [skin, bare])| bare > skin);
    let named: Vec<&str> = named.map(|(joint, _)| character.joints[*joint].name.as_str()).collect();
    let said = format!(
        "no skin under it around {}: a body of {count} vertices was made inside the cloth (--body OTHER.glb takes that \
         of another file)",
        named.join(", ")
    );
    character.body.extend(SkinnedMesh { mesh, weights });
    Some(said)
}

/// The points of the bones, and whether they are bare.
fn points(bones: &[Bone], skin: &Mesh, garment: &Mesh, extent: f64) -> Vec<Point> {
    let [skin, garment] = [skin, garment].map(Faces::new);
    let (ways, reach) = (ways(1), REACH * extent);
    let all = bones.iter().flat_map(|bone| bone.points(STEP * extent).map(|at| (bone.joint, at)));
    let share = |faces: &Faces, at: DVec3| share(faces, &ways, at, reach);
    let point = |(joint, at)| Point { at, joint, bare: share(&skin, at) < SKIN && share(&garment, at) > COVERED };
    all.map(point).collect()
}

/// Negative inside the shell: nearer to a bare point than to one in skin, in sight of it, off the cloth.
fn field(points: &[Point], cloth: &Mesh, extent: f64, hip: DVec3) -> Field {
    let faces = Faces::new(cloth);
    let cell = extent / 250.0;
    let radius = |at: DVec3| extent * THICKEST[usize::from((at - hip).with_y(0.0).length() > AXIS * extent)];
    let (bare, kept): (Vec<&Point>, Vec<&Point>) = points.iter().partition(|point| point.bare);
    let margin = 4.0 * cell;
    let around = bare.iter().flat_map(|point| [1.0, -1.0].map(|side| point.at + side * (radius(point.at) + margin)));
    let [low, high] = bounds(around);
    let size = ((high - low) / cell).to_array().map(|n| n.ceil() as usize + 1);
    let mut field = Field { origin: low, cell, size, values: Vec::new() };
    let (band, ways) = (3.0 * cell, ways(2));
    let nearest = |list: &[&Point], place: DVec3| {
        let near = list.iter().map(|point| (point.at.distance_squared(place), point.at));
        near.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(squared, at)| (squared.sqrt(), at))
    };
    let value = |place: DVec3| -> f64 {
        let Some((distance, at)) = nearest(&bare, place) else { return band };
        let depth = distance - radius(at);
        let other = nearest(&kept, place).map_or(f64::INFINITY, |(distance, _)| distance);
        if depth > band || distance > other + OVERLAP * extent {
            return band;
        }
        let off = faces.nearest(place).map_or(f64::INFINITY, |(_, foot)| foot.distance(place));
        let way = (place - at).normalize_or(DVec3::Y);
        let value = depth.max(INSET * extent - off).clamp(-band, band);
        // Through a gap between cloth and skin a bone sees what is outside.
        let inside =
            || faces.first_hit(at, way, distance).is_none() && share(&faces, &ways, place, REACH * extent) > COVERED;
        if value < band && inside() { value } else { band }
    };
    let count = size.iter().product::<usize>();
    let place = |i: usize| field.point([i % size[0], i / size[0] % size[1], i / (size[0] * size[1])]);
    field.values = (0..count).into_par_iter().map(|i| value(place(i)) as f32).collect();
    field.smooth(cell);
    field
}

/// Weights of the bones around a point, and near skin more and more those of the skin.
fn weights(point: DVec3, bones: &[Bone], faces: &Faces, body: &SkinnedMesh, extent: f64) -> SkinWeights {
    let mut near: BTreeMap<usize, f64> = BTreeMap::new();
    for bone in bones {
        let distance = near.entry(bone.joint).or_insert(f64::INFINITY);
        *distance = distance.min(bone.distance(point));
    }
    let least = near.values().copied().fold(f64::INFINITY, f64::min).max(1e-6 * extent);
    let mut row: BTreeMap<usize, f64> = BTreeMap::new();
    let close = near.into_iter().filter(|(_, distance)| *distance < 2.0 * least);
    close.for_each(|(joint, distance)| *row.entry(joint).or_default() += (least / distance.max(least)).powi(4));
    let total: f64 = row.values().sum();
    let skin = faces.nearest(point).map(|(face, foot)| (face, 1.0 - foot.distance(point) / (SKIN_REACH * extent)));
    let share = skin.map_or(0.0, |(_, share)| share.max(0.0));
    row.values_mut().for_each(|weight| *weight *= (1.0 - share) / total.max(1e-18));
    if let Some((face, _)) = skin.filter(|_| share > 0.0) {
        for (joint, weight) in body.mesh.triangles[face].iter().flat_map(|vertex| &body.weights[*vertex as usize]) {
            *row.entry(*joint).or_default() += share * weight / 3.0;
        }
    }
    let mut row: SkinWeights = row.into_iter().filter(|(_, weight)| *weight > 1e-6).collect();
    row.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let sum: f64 = row.iter().map(|(_, weight)| weight).sum();
    row.iter_mut().for_each(|(_, weight)| *weight /= sum);
    row
}
