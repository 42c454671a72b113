//! The joints of a file's skins, and canonical space: upright, in metres. S·M takes bind space there:
//! M = G_hip · IB_hip at the file's own pose, S metres per unit. So `inverse_bind` = IB · (S·M)⁻¹, and a pose is S·G.
//! network.md §1.

use super::Read;
use super::file::File;
use super::look::words;
use super::nodes::{Nodes, affine};
use super::part::Part;
use crate::{Joint, Pose, SkinWeights};
use ::gltf::Document;
use ::gltf::accessor::Dimensions;
use glam::{DAffine3, DMat3, DVec3};
use std::cmp::Reverse;
use std::collections::{BTreeMap, HashSet};

/// A glTF skin: node and inverse bind matrix of each of its joints.
struct Skin {
    nodes: Vec<usize>,
    inverse_bind: Vec<DAffine3>,
}

/// The joints of all glTF skins in use, as one skeleton.
pub(super) struct Skeleton {
    /// Node of each joint; parents before children.
    pub nodes: Vec<usize>,
    /// The hip, index of a joint.
    pub hip: usize,
    /// Unique names.
    names: Vec<String>,
    /// Index of the parent joint.
    parent: Vec<Option<usize>>,
    /// Skins in use, by their index in the file.
    skins: BTreeMap<usize, Skin>,
    /// Of the skins that list the hip, the one with most vertices: its bind space is the canonical one.
    main: usize,
    /// World transforms of all nodes at the file's own pose, file units.
    rest: Vec<DAffine3>,
}

impl Skeleton {
    /// The skeleton of the skins that `parts` use, or `None` when they use none.
    pub fn read(file: &File, nodes: &Nodes, parts: &[Part]) -> Read<Option<Skeleton>> {
        let mut vertices: BTreeMap<usize, usize> = BTreeMap::new();
        for (part, skin) in parts.iter().filter_map(|part| Some((part, part.skin?))) {
            // Parts of a mesh may share one list of vertices: each counts those it draws.
            let drawn: HashSet<u32> = part.triangles.iter().flatten().copied().collect();
            *vertices.entry(skin).or_default() += drawn.len();
        }
        // Largest first, of equals the first.
        let mut largest: Vec<usize> = vertices.keys().copied().collect();
        largest.sort_by_key(|skin| Reverse(vertices[skin]));
        let Some(&main) = largest.first() else { return Ok(None) };
        let in_use = file.document.skins().filter(|skin| vertices.contains_key(&skin.index()));
        let skins =
            in_use.map(|skin| Ok((skin.index(), Skin::read(file, &skin)?))).collect::<Read<BTreeMap<_, _>>>()?;
        let joints: HashSet<usize> = skins.values().flat_map(|skin| skin.nodes.iter().copied()).collect();
        let order: Vec<usize> = nodes.order.iter().copied().filter(|node| joints.contains(node)).collect();
        let index = |node: usize| order.iter().position(|&joint| joint == node);
        let parent = order.iter().map(|&node| nodes.ancestors(node).find_map(index)).collect();
        let mut skeleton = Skeleton {
            names: unique_names(&file.document, &order),
            nodes: order,
            hip: 0,
            parent,
            skins,
            main,
            rest: nodes.worlds(&nodes.rest),
        };
        let told = skeleton.parts(file).get("Hips").copied();
        skeleton.hip = told.map_or_else(|| skeleton.find_hip(parts), Ok)?;
        // Hair may have more vertices than the body, and a skin of its own that knows only the head.
        let hip = skeleton.nodes[skeleton.hip];
        if let Some(&main) = largest.iter().find(|skin| skeleton.skins[skin].nodes.contains(&hip)) {
            skeleton.main = main;
        }
        Ok(Some(skeleton))
    }

    /// The topmost joint named like a hip; else the first, from the top of the trees that the largest skin's joints are
    /// in, that moves vertices or has two joint children.
    fn find_hip(&self, parts: &[Part]) -> Read<usize> {
        let joints = 0..self.nodes.len();
        let upwards = |joint: usize| std::iter::successors(Some(joint), |&above| self.parent[above]);
        let named = joints.clone().filter(|&joint| names_a_hip(&self.names[joint]));
        if let Some(topmost) = named.min_by_key(|&joint| upwards(joint).count()) {
            return Ok(topmost);
        }
        let slots = |part: &Part| part.weights.iter().flatten().map(|entry| entry.0).collect::<HashSet<usize>>();
        let moved = parts.iter().filter_map(|part| Some((slots(part), &self.skins[&part.skin?])));
        let moving: HashSet<usize> =
            moved.flat_map(|(slots, skin)| slots.into_iter().map(|slot| skin.nodes[slot])).collect();
        let of_largest = joints.clone().filter(|&joint| self.skins[&self.main].nodes.contains(&self.nodes[joint]));
        let tops: HashSet<usize> = of_largest.filter_map(|joint| upwards(joint).last()).collect();
        let candidates = || joints.clone().filter(|&joint| upwards(joint).any(|above| tops.contains(&above)));
        let children = |joint: usize| self.parent.iter().filter(|&&parent| parent == Some(joint)).count();
        let first = candidates().find(|&joint| moving.contains(&self.nodes[joint]) || children(joint) >= 2);
        first.or(candidates().next()).ok_or_else(|| "its skin has no joints".to_string())
    }

    /// M = G_hip · IB_hip: bind space of the main skin -> the world of the file's own pose, file units.
    pub fn upright(&self) -> Read<DAffine3> {
        let skin = &self.skins[&self.main];
        let node = self.nodes[self.hip];
        let slot = skin.nodes.iter().position(|&joint| joint == node);
        let upright = slot.map(|slot| self.rest[node] * skin.inverse_bind[slot]);
        upright.filter(|affine| invertible(*affine)).ok_or_else(|| {
            let name = &self.names[self.hip];
            format!("joint {name}: its transform times its inverse bind matrix cannot be inverted")
        })
    }

    /// The joints in canonical space (`canonical` = S·M) at `scale` metres per unit.
    pub fn joints(&self, canonical: DAffine3, scale: f64) -> Read<Vec<Joint>> {
        let main = &self.skins[&self.main];
        let from_canonical = canonical.inverse();
        let mut joints: Vec<Joint> = Vec::new();
        for (at, &node) in self.nodes.iter().enumerate() {
            let inverse_bind = match main.nodes.iter().position(|&joint| joint == node) {
                Some(slot) => main.inverse_bind[slot] * from_canonical,
                // A joint that only other skins use keeps its place relative to its parent in the file's own pose.
                None => {
                    let above = self.parent[at];
                    let carried = above.map(|up| scaled(self.rest[self.nodes[up]], scale) * joints[up].inverse_bind);
                    scaled(self.rest[node], scale).inverse() * carried.unwrap_or(DAffine3::IDENTITY)
                }
            };
            if !invertible(inverse_bind) {
                return Err(format!("joint {}: its inverse bind matrix cannot be inverted", self.names[at]));
            }
            joints.push(Joint { name: self.names[at].clone(), parent: self.parent[at], inverse_bind });
        }
        Ok(joints)
    }

    /// The joints that the file names as parts of a body.
    pub fn parts(&self, file: &File) -> BTreeMap<String, usize> {
        let joint = |node: &usize| self.nodes.iter().position(|joint| joint == node);
        file.parts.iter().filter_map(|(part, node)| Some((part.clone(), joint(node)?))).collect()
    }

    /// World transforms of all nodes (file units) -> pose of the joints (metres).
    pub fn pose(&self, worlds: &[DAffine3], scale: f64) -> Pose {
        self.nodes.iter().map(|&node| scaled(worlds[node], scale)).collect()
    }

    /// Skin weights of a part, with the joint numbers of this skeleton.
    pub fn weights(&self, part: &Part) -> Vec<SkinWeights> {
        let Some(skin) = part.skin.map(|skin| &self.skins[&skin]) else { return Vec::new() };
        let index = |node: usize| self.nodes.iter().position(|&joint| joint == node).unwrap_or(self.hip);
        let joint: Vec<usize> = skin.nodes.iter().map(|&node| index(node)).collect();
        let renumber = |weights: &SkinWeights| weights.iter().map(|&(slot, weight)| (joint[slot], weight)).collect();
        part.weights.iter().map(renumber).collect()
    }

    /// Canonical positions of a part, metres. In the main skin: S·M·v. In another skin: the point that the main skin's
    /// matrices, blended with the vertex's weights, take to where the vertex is in the file's own pose.
    pub fn canonical_positions(&self, part: &Part, joints: &[Joint], canonical: DAffine3, scale: f64) -> Vec<DVec3> {
        let skin = match part.skin {
            Some(index) if index != self.main => &self.skins[&index],
            _ => return part.positions.iter().map(|&v| canonical.transform_point3(v)).collect(),
        };
        let skinning: Vec<DAffine3> =
            self.nodes.iter().zip(joints).map(|(&n, j)| scaled(self.rest[n], scale) * j.inverse_bind).collect();
        let place = |(&v, (own, weights)): (&DVec3, (&SkinWeights, &SkinWeights))| {
            if weights.is_empty() {
                return canonical.transform_point3(v);
            }
            let to_world = |&(slot, weight): &(usize, f64)| {
                let joint = self.rest[skin.nodes[slot]] * skin.inverse_bind[slot];
                joint.transform_point3(v) * weight * scale
            };
            let posed: DVec3 = own.iter().map(to_world).sum();
            let blend = weights.iter().fold((DMat3::ZERO, DVec3::ZERO), |(matrix, shift), &(joint, weight)| {
                let affine = skinning[joint];
                (
                    matrix + affine.matrix3 * DMat3::from_diagonal(DVec3::splat(weight)),
                    shift + affine.translation * weight,
                )
            });
            let blend = DAffine3 { matrix3: blend.0, translation: blend.1 };
            if invertible(blend) { blend.inverse().transform_point3(posed) } else { posed }
        };
        part.positions.iter().zip(part.weights.iter().zip(&self.weights(part))).map(place).collect()
    }
}

impl Skin {
    fn read(file: &File, skin: &::gltf::Skin) -> Read<Skin> {
        let nodes: Vec<usize> = skin.joints().map(|joint| joint.index()).collect();
        let name = |reason| format!("skin {} ({}): {reason}", skin.index(), skin.name().unwrap_or("unnamed"));
        let inverse_bind: Vec<DAffine3> = match skin.inverse_bind_matrices() {
            Some(accessor) => {
                let numbers = file.components(&accessor, Dimensions::Mat4, "inverse bind matrices").map_err(name)?;
                numbers.as_chunks::<16>().0.iter().map(|&columns| affine(columns)).collect()
            }
            None => vec![DAffine3::IDENTITY; nodes.len()],
        };
        if inverse_bind.len() < nodes.len() {
            let (wanted, found) = (nodes.len(), inverse_bind.len());
            return Err(name(format!("wanted {wanted} inverse bind matrices, one per joint, found {found}")));
        }
        Ok(Skin { nodes, inverse_bind })
    }
}

/// The same transform with its lengths in metres instead of file units.
fn scaled(affine: DAffine3, scale: f64) -> DAffine3 {
    DAffine3 { matrix3: affine.matrix3 * scale, translation: affine.translation * scale }
}

fn invertible(affine: DAffine3) -> bool {
    affine.is_finite() && affine.matrix3.determinant().is_normal() && affine.inverse().is_finite()
}

/// Names of the nodes as in the file. Unnamed ones get a name, repeated names a suffix.
fn unique_names(document: &Document, nodes: &[usize]) -> Vec<String> {
    let given: Vec<Option<&str>> = document.nodes().map(|node| node.name()).collect();
    let mut taken = HashSet::new();
    let unique = |&node: &usize| {
        let base = given[node].filter(|name| !name.is_empty()).map_or(format!("joint_{node}"), str::to_string);
        let mut name = base.clone();
        let mut copy = 0;
        while !taken.insert(name.clone()) {
            copy += 1;
            name = format!("{base}_{copy}");
        }
        name
    };
    nodes.iter().map(unique).collect()
}

/// Whether a word of the name is hip, hips or pelvis, and no word names a side (`LeftHip` is a thigh in some rigs).
fn names_a_hip(name: &str) -> bool {
    let words = words(name);
    let has = |wanted: &[&str]| words.iter().any(|word| wanted.contains(&word.as_str()));
    has(&["hip", "hips", "pelvis"]) && !has(&["left", "right", "l", "r"])
}

#[cfg(test)]
mod tests {
    use super::names_a_hip;

    #[test]
    fn hips_are_found_by_whole_words() {
        for name in ["mixamorig:Hips", "b_Hip_01", "Bip01 Pelvis", "mixamorigHips", "HIPS", "pelvis", "J_Bip_C_Hips"] {
            assert!(names_a_hip(name), "{name}");
        }
        for name in ["LeftHip", "hip_L", "R_Hip", "Ship", "hippo", "Spine", "", "chipset_1"] {
            assert!(!names_a_hip(name), "{name}");
        }
    }
}
