//! glTF in and out: any skinned character and its clips, any garment; both written as GLB.
//! Canonical space is explained in `skeleton.rs`.

mod animation;
mod colour;
mod file;
mod look;
mod nodes;
mod pack;
mod part;
mod skeleton;
mod unpack;
mod vrm;
mod weld;
mod write;

pub use look::Look;
pub use pack::pack;
pub use weld::Source;
pub use write::{Appearance, write_character, write_garment, write_part};

use crate::mesh::{bounds, triangle};
use crate::{Character, Clip, Garment, Mesh, SkinWeights, SkinnedMesh};
use crate::{Error, Result};
use file::File;
use glam::{DAffine3, DVec3};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use nodes::Nodes;
use part::Part;
use skeleton::Skeleton;
use std::collections::HashSet;
use std::path::Path;
use weld::{Soup, Welded};

/// Result of a stage of reading. The error says what was wanted and what was found; the caller adds the path.
type Read<T> = std::result::Result<T, String>;

/// Reads a rigged character and its clips, sampled at `rate` poses per second.
///
/// All skinned meshes that its scene shows become one body. Of the glTF skins that list the hip, the one with most
/// vertices sets the canonical space. A vertex without weights takes those of the nearest vertex that has some, or
/// follows the hip when none has. A body that faces inwards is turned. Hair, eyes and accessories, by their names, are
/// drawn, but hold no cloth. Morph targets are taken as exported: by the weights of their node, or where it has none
/// those of their mesh. Meshes without a skin and animations that move no joint are left out. A file without clips is
/// accepted, see [`Character::clip`].
pub fn read_character(path: &Path, rate: f64) -> Result<Character> {
    let file = File::open(path)?;
    character(&file, rate).map_err(|reason| Error::File { path: path.into(), reason })
}

/// A mesh of a character's file, as far as one material goes.
#[derive(Clone, Debug, PartialEq)]
pub struct Listed {
    /// Names of its node and its material.
    pub name: String,
    /// What it looks like.
    pub look: Look,
    /// Whether its names say so; else its place on the body does.
    pub named: bool,
    /// Vertices and triangles.
    pub size: [usize; 2],
    /// Whether it follows joints; what does not is left out of characters.
    pub skinned: bool,
}

/// The parts of a character's file, in its order.
pub fn read_parts(path: &Path) -> Result<Vec<Listed>> {
    let file = File::open(path)?;
    listed(&file).map_err(|reason| Error::File { path: path.into(), reason })
}

/// The `wanted` parts of a character's file apart from the others: as a garment, canonical, metres; and the character
/// of the others.
pub fn part_character(path: &Path, rate: f64, wanted: &[usize]) -> Result<(Garment, Character)> {
    let file = File::open(path)?;
    let apart = || {
        let rest = character_of(&file, rate, |part| !wanted.contains(&part))?;
        let (garment, _) = garment_of(&file, rest.metres_per_unit, |part| wanted.contains(&part))?;
        Ok((garment, rest))
    };
    apart().map_err(|reason| Error::File { path: path.into(), reason })
}

/// Reads a garment modelled on a character in its canonical pose; `scale` = `metres_per_unit` of that character.
///
/// Mesh nodes are placed by their world transforms, skinned ones by their skin, as characters are. The vertex attribute
/// `_PIN` (scalar; pinned above one half) marks the vertices that springs hold to the body.
pub fn read_garment(path: &Path, scale: f64) -> Result<(Garment, Source)> {
    let file = File::open(path)?;
    garment(&file, scale).map_err(|reason| Error::File { path: path.into(), reason })
}

fn character(file: &File, rate: f64) -> Read<Character> {
    character_of(file, rate, |_| true)
}

/// The character of the parts that are `kept`, by their numbers, on the skeleton of all.
fn character_of(file: &File, rate: f64, kept: impl Fn(usize) -> bool) -> Read<Character> {
    if !(rate.is_finite() && rate > 0.0) {
        return Err(format!("wanted a positive number of poses per second, found {rate}"));
    }
    if file.document.skins().len() == 0 {
        return Err("has no skin: wanted a rigged character, whose mesh is bound to a skeleton".to_string());
    }
    let nodes = Nodes::read(&file.document)?;
    let parts = part::read(file, &nodes)?;
    let skeleton = Skeleton::read(file, &nodes, &parts)?;
    let skeleton = skeleton.ok_or("has a skin, but no mesh of triangles that its scene shows uses it")?;
    let upright = skeleton.upright()?;
    let metres_per_unit = metres_per_unit(&body(&parts, &skeleton, upright, 1.0)?)?;
    let canonical = DAffine3::from_scale(DVec3::splat(metres_per_unit)) * upright;
    let parts: Vec<Part> = parts.into_iter().enumerate().filter(|(at, _)| kept(*at)).map(|(_, part)| part).collect();
    let mut welded = body(&parts, &skeleton, canonical, metres_per_unit)?.weld();
    if welded.mesh.triangles.is_empty() {
        return Err("no triangle of its skinned mesh has an area".to_string());
    }
    face_outwards(&mut welded);
    fill_weights(&mut welded.weights, &welded.mesh.positions, skeleton.hip)?;
    Ok(Character {
        joints: skeleton.joints(canonical, metres_per_unit)?,
        root: skeleton.hip,
        body: SkinnedMesh { mesh: welded.mesh, weights: welded.weights },
        surface: welded.surface,
        clips: clips(file, &nodes, &skeleton, rate, metres_per_unit)?,
        metres_per_unit,
        parts: skeleton.parts(file),
    })
}

/// The skinned parts in canonical space.
fn body(parts: &[Part], skeleton: &Skeleton, canonical: DAffine3, scale: f64) -> Read<Soup> {
    let joints = skeleton.joints(canonical, scale)?;
    let mut soup = Soup::default();
    for part in parts.iter().filter(|part| part.skin.is_some()) {
        let positions = skeleton.canonical_positions(part, &joints, canonical, scale);
        add(&mut soup, part, positions, skeleton.weights(part), canonical);
    }
    Ok(soup)
}

/// Adds a part to the soup. Where `to_world` mirrors the part, its triangles are turned.
fn add(soup: &mut Soup, part: &Part, positions: Vec<DVec3>, weights: Vec<SkinWeights>, to_world: DAffine3) {
    let Part { uv, pinned, triangles, colour, .. } = part.clone();
    let turn = to_world.matrix3.determinant() < 0.0;
    let is_loose = Look::named(&part.names).is_some_and(|look| !look.holds_cloth());
    soup.add(Soup { positions, weights, uv, pinned, triangles, colour, is_loose, ..Soup::default() }, turn);
}

/// Turns the triangles of a body that faces inwards as a whole: they tell cloth which side is out.
fn face_outwards(body: &mut Welded) {
    let Mesh { positions, triangles } = &mut body.mesh;
    let centre = positions.iter().sum::<DVec3>() / positions.len() as f64;
    let volume = |t: &[u32; 3]| triangle::volume(t.map(|i| positions[i as usize] - centre));
    if triangles.iter().map(volume).sum::<f64>() < 0.0 {
        triangles.iter_mut().chain(&mut body.surface.triangles).for_each(|triangle| triangle.swap(1, 2));
    }
}

/// 1 for an extent of 0.1 to 10 units, else the power of ten that brings the extent to between 1 and 10 metres.
fn metres_per_unit(body: &Soup) -> Read<f64> {
    let extent = body.extent();
    if !extent.is_normal() {
        return Err(format!("its skinned mesh has no size: largest extent {extent}"));
    }
    Ok(if (0.1..=10.0).contains(&extent) { 1.0 } else { 10f64.powi(-extent.log10().floor() as i32) })
}

/// Gives vertices without weights those of the nearest vertex with some, the first of equals; all follow the hip when
/// there is none.
fn fill_weights(weights: &mut [SkinWeights], positions: &[DVec3], hip: usize) -> Read<()> {
    let (bare, weighted): (Vec<usize>, Vec<usize>) = (0..weights.len()).partition(|vertex| weights[*vertex].is_empty());
    if weighted.is_empty() {
        weights.fill(vec![(hip, 1.0)]);
        return Ok(());
    }
    if bare.is_empty() {
        return Ok(());
    }
    let points: Vec<[f64; 3]> = weighted.iter().map(|vertex| positions[*vertex].to_array()).collect();
    let tree: ImmutableKdTree<f64, 3> =
        ImmutableKdTree::new_from_slice(&points).map_err(|error| format!("nearest-vertex search: {error:?}"))?;
    for vertex in bare {
        let place = positions[vertex].to_array();
        let least = tree.query(&place).nearest_one::<SquaredEuclidean<f64>>().execute().distance;
        let equals = tree.query(&place).within::<SquaredEuclidean<f64>>(least).execute();
        let nearest = equals.into_iter().map(|found| found.item as usize).min();
        weights[vertex] = nearest.map_or(vec![(hip, 1.0)], |nearest| weights[weighted[nearest]].clone());
    }
    Ok(())
}

/// Every animation that moves a joint or a node above one.
fn clips(file: &File, nodes: &Nodes, skeleton: &Skeleton, rate: f64, scale: f64) -> Read<Vec<Clip>> {
    let mut moves = vec![false; nodes.parent.len()];
    for &joint in &skeleton.nodes {
        moves[joint] = true;
        nodes.ancestors(joint).for_each(|above| moves[above] = true);
    }
    let mut taken = HashSet::new();
    let mut clips = Vec::new();
    for animation in file.document.animations() {
        let base = animation.name().map_or(format!("clip_{}", animation.index()), str::to_string);
        let copies = (1..).map(|copy| format!("{base}_{copy}"));
        let free = std::iter::once(base.clone()).chain(copies).find(|name| !taken.contains(name));
        let name = free.unwrap_or(base);
        let worlds = animation::sample(file, nodes, &animation, &moves, rate);
        if let Some(worlds) = worlds.map_err(|reason| format!("animation {name}: {reason}"))? {
            let poses = worlds.iter().map(|worlds| skeleton.pose(worlds, scale)).collect();
            taken.insert(name.clone());
            clips.push(Clip { name, rate, poses });
        }
    }
    Ok(clips)
}

fn garment(file: &File, scale: f64) -> Read<(Garment, Source)> {
    garment_of(file, scale, |_| true)
}

/// The garment of the parts that are `kept`, by their numbers.
fn garment_of(file: &File, scale: f64, kept: impl Fn(usize) -> bool) -> Read<(Garment, Source)> {
    if !(scale.is_finite() && scale > 0.0) {
        return Err(format!("wanted a positive scale in metres per unit, found {scale}"));
    }
    let nodes = Nodes::read(&file.document)?;
    let worlds = nodes.worlds(&nodes.rest);
    let parts = part::read(file, &nodes)?;
    let skeleton = Skeleton::read(file, &nodes, &parts)?;
    let mut soup = Soup::default();
    let metres = DAffine3::from_scale(DVec3::splat(scale));
    for part in parts.iter().enumerate().filter(|(at, _)| kept(*at)).map(|(_, part)| part) {
        let skinned = skeleton.as_ref().filter(|_| part.skin.is_some());
        let (positions, to_world) = match skinned {
            Some(skeleton) => {
                let canonical = metres * skeleton.upright()?;
                let joints = skeleton.joints(canonical, scale)?;
                (skeleton.canonical_positions(part, &joints, canonical, scale), canonical)
            }
            None => {
                let to_world = metres * worlds[part.node];
                (part.positions.iter().map(|&v| to_world.transform_point3(v)).collect(), to_world)
            }
        };
        add(&mut soup, part, positions, Vec::new(), to_world);
    }
    let welded = soup.weld();
    if welded.mesh.triangles.is_empty() {
        return Err("holds no garment: no mesh that its scene shows has a triangle with an area".to_string());
    }
    let own = file.document.as_json().asset.generator.as_deref() == Some(write::GENERATOR);
    let source = Source { own, ..welded.source };
    Ok((Garment { mesh: welded.mesh, surface: welded.surface, pins: welded.pins, drawn: None }, source))
}

#[cfg(test)]
mod tests;

/// What the parts of a file are.
fn listed(file: &File) -> Read<Vec<Listed>> {
    let nodes = Nodes::read(&file.document)?;
    let parts = part::read(file, &nodes)?;
    let skeleton = Skeleton::read(file, &nodes, &parts)?.ok_or("has no skin: wanted a rigged character")?;
    let canonical = skeleton.upright()?;
    let joints = skeleton.joints(canonical, 1.0)?;
    let worlds = nodes.worlds(&nodes.rest);
    let place = |part: &Part| match part.skin {
        Some(_) => skeleton.canonical_positions(part, &joints, canonical, 1.0),
        None => part.positions.iter().map(|&v| worlds[part.node].transform_point3(v)).collect(),
    };
    let places: Vec<Vec<DVec3>> = parts.iter().map(place).collect();
    let whole = bounds(places.iter().flatten().copied());
    let list = |(part, places): (&Part, &Vec<DVec3>)| Listed {
        name: [&part.names[2], &part.names[0]]
            .into_iter()
            .filter(|name| !name.is_empty())
            .cloned()
            .collect::<Vec<_>>()
            .join(", "),
        named: Look::named(&part.names).is_some(),
        look: Look::named(&part.names).unwrap_or_else(|| Look::placed(bounds(places.iter().copied()), whole)),
        size: [part.positions.len(), part.triangles.len()],
        skinned: part.skin.is_some(),
    };
    Ok(parts.iter().zip(&places).map(list).collect())
}
