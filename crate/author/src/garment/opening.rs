//! Openings: where the garment ends on each limb, a plane across the limb. simulation.md §4.2.
//! Cut by limb-local planes: one global plane per pair also slit dress hems when it was tried in the prototype.

use super::Cut;
use super::anatomy::{Limb, anatomy, below, joint_positions, membership};
use crate::rig::Character;
use crate::{Error, Result};
use glam::DVec3;

/// One opening: the garment stops at a plane.
#[derive(Clone, Debug)]
pub(super) struct Opening {
    /// A point of the plane, metres, amid the limb.
    pub point: DVec3,
    /// Unit normal, towards the part that stays bare.
    pub normal: DVec3,
    /// Share of the bare limb's joints in each body vertex's weights [b].
    pub beyond: Vec<f64>,
    /// Where cloth starts to hang straight towards this opening, metres: the hip, for a hem around two legs.
    pub hangs_from: Option<DVec3>,
}

impl Opening {
    /// Signed distance past the plane, metres.
    pub fn past(&self, point: DVec3) -> f64 {
        (point - self.point).dot(self.normal)
    }
}

/// The openings of a cut on a body of the given extent (metres).
pub(super) fn openings(character: &Character, cut: &Cut, extent: f64) -> Result<Vec<Opening>> {
    if let Some(names) = &cut.joints {
        return around(character, names);
    }
    let anatomy = anatomy(character, extent);
    if anatomy.limbs.is_empty() {
        return Ok(band(character));
    }
    let positions = joint_positions(character);
    let hip = positions[anatomy.trunk[0]];
    // The trunk runs from the hip to where its last pair of limbs hangs.
    let end = anatomy.limbs.iter().filter(|limb| limb.mirror.is_some()).map(|limb| positions[limb.parent]);
    let end = end.max_by(|a, b| a.distance(hip).total_cmp(&b.distance(hip))).unwrap_or(hip);
    let trunk = if end.distance(hip) > 0.05 * extent { (end - hip).normalize() } else { DVec3::Y };
    let shares_hem = |limb: &Limb| {
        let along = limb.path[limb.path.len() - 1] - limb.path[0];
        let low = (positions[limb.parent] - hip).dot(trunk) < 0.3 * end.distance(hip).max(0.1 * extent);
        low && along.normalize_or_zero().dot(trunk) < -0.5
    };
    let mut openings = Vec::new();
    for (index, limb) in anatomy.limbs.iter().enumerate() {
        match limb.mirror {
            Some(mirror) if mirror < index && shares_hem(limb) => {
                openings.push(hem(character, [&anatomy.limbs[mirror], limb], cut.hem, hip));
            }
            Some(_) if shares_hem(limb) => {}
            Some(_) => openings.push(across(character, limb, cut.sleeve)),
            None => {
                let others = anatomy.limbs.iter().filter(|other| other.chain[0] != limb.chain[0]);
                openings.push(collar(character, limb, others, cut.collar));
            }
        }
    }
    Ok(openings)
}

/// Opening on one limb at a fraction of the way from where it leaves the trunk (0) to its tip (1).
fn across(character: &Character, limb: &Limb, fraction: f64) -> Opening {
    let beyond = membership(character, &below(character, limb.chain[0]));
    let (root, total) = (leaves_trunk(character, limb, &beyond), arc_length(&limb.path));
    let (point, normal) = at(&limb.path, root + fraction * (total - root));
    Opening { point, normal, beyond, hangs_from: None }
}

/// Opening on an unpaired limb (neck, tail). Its skin often starts on the shoulders: the plane is moved up the first bone
/// until the body's section there is nearly as narrow as it gets.
fn collar<'a>(character: &Character, limb: &Limb, others: impl Iterator<Item = &'a Limb>, fraction: f64) -> Opening {
    let mut own = vec![true; character.joints.len()];
    for other in others {
        below(character, other.chain[0]).iter().zip(&mut own).for_each(|(other, own)| *own &= !other);
    }
    let own = membership(character, &own);
    let beyond = membership(character, &below(character, limb.chain[0]));
    let (root, total) = (leaves_trunk(character, limb, &beyond), arc_length(&limb.path));
    let bone = if limb.chain.len() > 1 { limb.path[0].distance(limb.path[1]) } else { 0.0 };
    let sections: Vec<(f64, f64)> = (0..=12)
        .map(|k| root + bone * 0.6 * k as f64 / 12.0)
        .map(|s| (s, section_radius(character, &own, at(&limb.path, s))))
        .collect();
    let least = sections.iter().fold(f64::INFINITY, |least, (_, radius)| least.min(*radius));
    let narrow = sections.iter().find(|(_, radius)| *radius <= 1.2 * least).map_or(root, |(s, _)| *s);
    let (point, normal) = at(&limb.path, narrow + fraction * (total - narrow));
    Opening { point, normal, beyond, hangs_from: None }
}

/// Largest distance from the point at which a plane through it meets skin of the given share, metres; 0 if it does not.
fn section_radius(character: &Character, own: &[f64], (point, normal): (DVec3, DVec3)) -> f64 {
    let positions = &character.body.positions;
    let mut radius = 0.0_f64;
    for triangle in &character.body.triangles {
        for k in 0..3 {
            let (a, b) = (triangle[k] as usize, triangle[(k + 1) % 3] as usize);
            let (da, db) = ((positions[a] - point).dot(normal), (positions[b] - point).dot(normal));
            if da * db < 0.0 && own[a].min(own[b]) > 0.5 {
                radius = radius.max(positions[a].lerp(positions[b], da / (da - db)).distance(point));
            }
        }
    }
    radius
}

/// One opening around two legs; the cloth hangs from the hip.
fn hem(character: &Character, legs: [&Limb; 2], fraction: f64, hip: DVec3) -> Opening {
    let beyond = legs.map(|leg| membership(character, &below(character, leg.chain[0])));
    let mut planes = Vec::new();
    for (leg, beyond) in legs.iter().zip(&beyond) {
        let from = leaves_trunk(character, leg, beyond);
        planes.push(at(&leg.path, from + fraction * (arc_length(&leg.path) - from)));
    }
    let point = (planes[0].0 + planes[1].0) / 2.0;
    let normal = (planes[0].1 + planes[1].1).normalize_or(DVec3::NEG_Y);
    let both: Vec<f64> = beyond[0].iter().zip(&beyond[1]).map(|(a, b)| a + b).collect();
    Opening { point, normal, beyond: both, hangs_from: Some(hip) }
}

/// Openings where a list of covered joints ends.
fn around(character: &Character, names: &[String]) -> Result<Vec<Opening>> {
    if names.is_empty() {
        return Err(Error::Garment("the list of covered joints is empty: wanted at least one name".into()));
    }
    let mut covered = vec![false; character.joints.len()];
    for name in names {
        let joint = character.joint(name).ok_or_else(|| Error::Garment(unknown(character, name)))?;
        covered[joint] = true;
    }
    let positions = joint_positions(character);
    let mut openings = Vec::new();
    for (index, joint) in character.joints.iter().enumerate() {
        let Some(parent) = joint.parent else { continue };
        if covered[index] == covered[parent] {
            continue;
        }
        let outwards = (positions[index] - positions[parent]).normalize_or(DVec3::Y);
        let side = below(character, index);
        let (normal, bare) =
            if covered[parent] { (outwards, side) } else { (-outwards, side.iter().map(|below| !below).collect()) };
        let beyond = membership(character, &bare);
        if beyond.iter().any(|weight| *weight > 0.5) {
            openings.push(Opening { point: positions[index], normal, beyond, hangs_from: None });
        }
    }
    if openings.is_empty() { Ok(band(character)) } else { Ok(openings) }
}

/// Without limbs to go by (one joint, fish, snake): the middle half of the body along its longest axis.
fn band(character: &Character) -> Vec<Opening> {
    let positions = &character.body.positions;
    let low = positions.iter().fold(DVec3::INFINITY, |low, p| low.min(*p));
    let high = positions.iter().fold(DVec3::NEG_INFINITY, |high, p| high.max(*p));
    let axis = DVec3::AXES[(high - low).max_position()];
    let end = |sign: f64| {
        let point = (low + high) / 2.0 + axis * (sign * 0.25 * (high - low).max_element());
        let past = |p: &DVec3| ((*p - point).dot(axis * sign) > 0.0) as u8 as f64;
        Opening { point, normal: axis * sign, beyond: positions.iter().map(past).collect(), hangs_from: None }
    };
    vec![end(-1.0), end(1.0)]
}

/// Arc length along the limb's path at which its skin has left the trunk's: where body edges change sides, nearly last.
fn leaves_trunk(character: &Character, limb: &Limb, beyond: &[f64]) -> f64 {
    let body = &character.body;
    let mut seam = Vec::new();
    for triangle in &body.triangles {
        for k in 0..3 {
            let (a, b) = (triangle[k] as usize, triangle[(k + 1) % 3] as usize);
            if (beyond[a] > 0.5) != (beyond[b] > 0.5) {
                let t = (0.5 - beyond[a]) / (beyond[b] - beyond[a]);
                seam.push(project(&limb.path, body.positions[a].lerp(body.positions[b], t)));
            }
        }
    }
    quantile(&mut seam, 0.9)
}

/// The value below which the given share of the values lies; 0 for none.
fn quantile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    if values.is_empty() { 0.0 } else { values[((values.len() - 1) as f64 * share).round() as usize] }
}

/// Length of a path, metres.
fn arc_length(path: &[DVec3]) -> f64 {
    path.windows(2).map(|bone| bone[0].distance(bone[1])).sum()
}

/// Point and direction of a path at arc length `s`; the direction is taken over a tenth of the path around it.
fn at(path: &[DVec3], s: f64) -> (DVec3, DVec3) {
    let walk = |mut s: f64| {
        for bone in path.windows(2) {
            let length = bone[0].distance(bone[1]);
            if s <= length && length > 0.0 {
                return bone[0].lerp(bone[1], s / length);
            }
            s -= length;
        }
        path[path.len() - 1]
    };
    let half = 0.05 * arc_length(path);
    let direction = walk(s + half) - walk((s - half).max(0.0));
    (walk(s), direction.normalize_or(DVec3::NEG_Y))
}

/// Arc length of the point of a path nearest to `p`.
fn project(path: &[DVec3], p: DVec3) -> f64 {
    let (mut best, mut arc, mut walked) = (f64::INFINITY, 0.0, 0.0);
    for bone in path.windows(2) {
        let along = bone[1] - bone[0];
        let t = ((p - bone[0]).dot(along) / along.length_squared().max(1e-18)).clamp(0.0, 1.0);
        let distance = p.distance(bone[0] + along * t);
        if distance < best {
            (best, arc) = (distance, walked + t * along.length());
        }
        walked += along.length();
    }
    arc
}

/// Message for an unknown joint, with the names most like it.
fn unknown(character: &Character, name: &str) -> String {
    let wanted = name.to_lowercase();
    let likeness = |joint: &str| {
        let joint = joint.to_lowercase();
        let pairs = wanted.as_bytes().windows(2).filter(|pair| joint.as_bytes().windows(2).any(|other| other == *pair));
        pairs.count() as f64 / (joint.len() + wanted.len()) as f64
    };
    let mut names: Vec<&str> = character.joints.iter().map(|joint| joint.name.as_str()).collect();
    names.sort_by(|a, b| likeness(b).total_cmp(&likeness(a)));
    format!("unknown joint {name:?}; near: {}", names[..names.len().min(5)].join(", "))
}
