//! The triangles of the mesh nodes, as the file has them: vertices split at seams, skin weights per vertex.
//! glTF 2.0 §3.5.1 (scenes), §3.7.2 (primitives), §3.7.3.3 (skinned attributes). Morph targets are taken as exported:
//! by the weights of their node, or where it has none those of their mesh.

use super::Read;
use super::colour::Painter;
use super::file::File;
use super::nodes::Nodes;
use crate::SkinWeights;
use ::gltf::accessor::Dimensions;
use ::gltf::mesh::Mode;
use ::gltf::{Primitive, Semantic};
use glam::{DVec2, DVec3};
use std::collections::HashSet;

/// One primitive of one mesh node, in the mesh's own space.
#[derive(Clone)]
pub(super) struct Part {
    /// The node that holds the mesh.
    pub node: usize,
    /// The skin that node uses.
    pub skin: Option<usize>,
    /// [v] file units.
    pub positions: Vec<DVec3>,
    /// [v], or empty.
    pub uv: Vec<DVec2>,
    /// [v] weights with joint numbers of the skin; an empty list for a vertex without weights. Empty without a skin.
    pub weights: Vec<SkinWeights>,
    /// [v] whether springs hold the vertex to the body; or empty.
    pub pinned: Vec<bool>,
    /// Vertex indices.
    pub triangles: Vec<[u32; 3]>,
    /// [v] linear RGB.
    pub colour: Vec<[f32; 3]>,
    /// Names in the file that may tell what it is: of its material, its mesh, its node.
    pub names: [String; 3],
}

/// Every triangle primitive of every mesh node that is shown, in the order of the file.
pub(super) fn read(file: &File, nodes: &Nodes) -> Read<Vec<Part>> {
    let mut painter = Painter::new(file);
    let mut parts = Vec::new();
    let shown = shown(file, nodes);
    for node in file.document.nodes().filter(|node| shown[node.index()]) {
        let mesh = node.mesh();
        for primitive in mesh.iter().flat_map(|mesh| mesh.primitives()) {
            let pins = mesh.iter().find_map(|mesh| file.pins.get(&(mesh.index(), primitive.index())));
            let place = |reason| format!("mesh node {} ({}): {reason}", node.index(), node.name().unwrap_or("unnamed"));
            let skin = node.skin().map(|skin| (skin.index(), skin.joints().count()));
            let weights = node.weights().or(mesh.iter().find_map(|mesh| mesh.weights())).unwrap_or_default();
            if let Some(mut part) = read_primitive(file, &primitive, node.index(), skin, &mut painter).map_err(place)? {
                part.pinned = pinned(file, pins, part.positions.len()).map_err(place)?;
                morph(file, &primitive, weights, &mut part.positions).map_err(place)?;
                let mesh = mesh.iter().find_map(|mesh| mesh.name());
                let names = [primitive.material().name(), mesh, node.name()];
                part.names = names.map(|name| name.unwrap_or_default().to_owned());
                parts.push(part);
            }
        }
    }
    Ok(parts)
}

/// Whether each node is in the file's scene and not hidden: the default scene, or the first where none is the default.
/// In a file without scenes every node is.
fn shown(file: &File, nodes: &Nodes) -> Vec<bool> {
    let scene = file.document.default_scene().or(file.document.scenes().next());
    let tops: Option<HashSet<usize>> = scene.map(|scene| scene.nodes().map(|node| node.index()).collect());
    let mut shown = vec![false; nodes.parent.len()];
    for &node in &nodes.order {
        let above = nodes.parent[node];
        let is_top = tops.as_ref().map_or(above.is_none(), |tops| tops.contains(&node));
        shown[node] = (is_top || above.is_some_and(|above| shown[above])) && !file.hidden.contains(&node);
    }
    shown
}

/// One primitive, or `None` for points, lines, and where positions are missing. `skin`: its index and number of joints.
fn read_primitive(
    file: &File,
    primitive: &Primitive,
    node: usize,
    skin: Option<(usize, usize)>,
    painter: &mut Painter,
) -> Read<Option<Part>> {
    let Some(accessor) = primitive.get(&Semantic::Positions) else { return Ok(None) };
    let positions = file.components(&accessor, Dimensions::Vec3, "positions")?;
    let positions: Vec<DVec3> = positions.chunks_exact(3).map(DVec3::from_slice).collect();
    let triangles = triangles(file, primitive, positions.len())?;
    if triangles.is_empty() {
        return Ok(None);
    }
    let material = primitive.material().pbr_metallic_roughness();
    let set = material.base_color_texture().map_or(0, |texture| texture.tex_coord());
    let uv = match primitive.get(&Semantic::TexCoords(set)) {
        Some(accessor) => file.components(&accessor, Dimensions::Vec2, "texture coordinates")?,
        None => Vec::new(),
    };
    let uv: Vec<DVec2> = uv.chunks_exact(2).map(DVec2::from_slice).collect();
    check_count("texture coordinates", uv.len(), positions.len(), uv.is_empty())?;
    let weights = match skin {
        Some((_, joints)) => skin_weights(file, primitive, positions.len(), joints)?,
        None => Vec::new(),
    };
    let own = vertex_colours(file, primitive, positions.len())?;
    let mut colour = painter.paint(&material, &uv, &triangles, positions.len());
    colour.iter_mut().zip(&own).for_each(|(colour, own)| *colour = std::array::from_fn(|i| colour[i] * own[i]));
    Ok(Some(Part {
        node,
        skin: skin.map(|(index, _)| index),
        positions,
        uv,
        weights,
        pinned: Vec::new(),
        triangles,
        colour,
        names: Default::default(),
    }))
}

/// Moves positions by Σ weight · displacement of the morph targets. glTF 2.0 §3.7.2.2.
fn morph(file: &File, primitive: &Primitive, weights: &[f32], positions: &mut [DVec3]) -> Read<()> {
    for (target, &weight) in primitive.morph_targets().zip(weights) {
        let Some(accessor) = target.positions().filter(|_| weight != 0.0) else { continue };
        if !weight.is_finite() {
            return Err(format!("the weight of a morph target is {weight}, wanted a finite number"));
        }
        let moves = file.components(&accessor, Dimensions::Vec3, "morph target")?;
        check_count("morph target", moves.len() / 3, positions.len(), false)?;
        let moves = moves.chunks_exact(3).map(DVec3::from_slice);
        positions.iter_mut().zip(moves).for_each(|(position, moved)| *position += f64::from(weight) * moved);
    }
    Ok(())
}

/// The attribute `_PIN`: pinned above one half. [v], or empty without it.
fn pinned(file: &File, accessor: Option<&usize>, vertices: usize) -> Read<Vec<bool>> {
    let Some(&index) = accessor else { return Ok(Vec::new()) };
    let accessor = file.document.accessors().nth(index).ok_or_else(|| format!("_PIN: there is no accessor {index}"))?;
    let pins = file.components(&accessor, Dimensions::Scalar, "_PIN")?;
    check_count("_PIN", pins.len(), vertices, false)?;
    Ok(pins.iter().map(|pin| *pin > 0.5).collect())
}

/// COLOR_0, linear RGB in [0, 1]; empty where there is none. glTF 2.0 §3.7.2.1.
fn vertex_colours(file: &File, primitive: &Primitive, vertices: usize) -> Read<Vec<[f32; 3]>> {
    let Some(accessor) = primitive.get(&Semantic::Colors(0)) else { return Ok(Vec::new()) };
    let wanted = if accessor.dimensions() == Dimensions::Vec4 { Dimensions::Vec4 } else { Dimensions::Vec3 };
    let channels = file.components(&accessor, wanted, "vertex colours")?;
    let colour = |rgb: &[f64]| std::array::from_fn(|channel| rgb[channel].clamp(0.0, 1.0) as f32);
    let colours: Vec<[f32; 3]> = channels.chunks_exact(wanted.multiplicity()).map(colour).collect();
    check_count("vertex colours", colours.len(), vertices, false)?;
    Ok(colours)
}

fn check_count(what: &str, found: usize, wanted: usize, absent: bool) -> Read<()> {
    if absent || found == wanted {
        return Ok(());
    }
    Err(format!("{what}: wanted one per vertex ({wanted}), found {found}"))
}

/// Triangles of a list, strip or fan. Without indices the vertices are taken in order. Every second triangle of a strip
/// is reversed, so that all face one way.
fn triangles(file: &File, primitive: &Primitive, vertices: usize) -> Read<Vec<[u32; 3]>> {
    let corner: Vec<u32> = match primitive.indices() {
        Some(accessor) => {
            let indices = file.components(&accessor, Dimensions::Scalar, "indices")?;
            if let Some(wrong) = indices.iter().find(|&&index| !(0.0..vertices as f64).contains(&index)) {
                return Err(format!("indices: {wrong} where there are {vertices} vertices"));
            }
            indices.iter().map(|&index| index as u32).collect()
        }
        None => (0..vertices as u32).collect(),
    };
    Ok(match primitive.mode() {
        Mode::Triangles => corner.as_chunks::<3>().0.to_vec(),
        Mode::TriangleStrip => {
            let turn = |(at, three): (usize, &[u32])| [three[0], three[1 + at % 2], three[2 - at % 2]];
            corner.windows(3).enumerate().map(turn).collect()
        }
        Mode::TriangleFan => {
            let fan = corner.get(1..).unwrap_or(&[]).windows(2);
            fan.map(|two| [two[0], two[1], corner[0]]).collect()
        }
        _ => Vec::new(),
    })
}

/// All sets (JOINTS_0/WEIGHTS_0, JOINTS_1/WEIGHTS_1, …) together: positive, sum one, strongest first.
fn skin_weights(file: &File, primitive: &Primitive, vertices: usize, joints: usize) -> Read<Vec<SkinWeights>> {
    let mut weights: Vec<SkinWeights> = vec![Vec::new(); vertices];
    for set in 0.. {
        let accessors = (primitive.get(&Semantic::Joints(set)), primitive.get(&Semantic::Weights(set)));
        let (Some(joint), Some(weight)) = accessors else { break };
        let joint = file.components(&joint, Dimensions::Vec4, "joints")?;
        let weight = file.components(&weight, Dimensions::Vec4, "weights")?;
        check_count("joints", joint.len() / 4, vertices, false)?;
        check_count("weights", weight.len() / 4, vertices, false)?;
        for (at, (&joint, &weight)) in joint.iter().zip(&weight).enumerate() {
            // Unused slots hold weight zero, and in some files a joint that does not exist.
            if weight <= 0.0 {
                continue;
            }
            if joint >= joints as f64 {
                return Err(format!("vertex {} names joint {joint} of a skin with {joints} joints", at / 4));
            }
            let (list, joint) = (&mut weights[at / 4], joint as usize);
            match list.iter_mut().find(|entry| entry.0 == joint) {
                Some(entry) => entry.1 += weight,
                None => list.push((joint, weight)),
            }
        }
    }
    weights.iter_mut().for_each(normalise);
    Ok(weights)
}

fn normalise(weights: &mut SkinWeights) {
    let total = |weights: &SkinWeights| weights.iter().map(|entry| entry.1).sum::<f64>();
    let least = total(weights) * 1e-6;
    weights.retain(|entry| entry.1 > least);
    let sum = total(weights);
    weights.iter_mut().for_each(|entry| entry.1 /= sum);
    weights.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
}
