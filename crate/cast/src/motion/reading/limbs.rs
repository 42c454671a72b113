//! Limbs: by names where they tell a whole limb, else from a mirrored pair of chains. Left is left of where the feet
//! point, or of where the forelegs stand from the hind ones.

use super::tree::{Pair, Tree};
use super::words::{ARMS, HEAD, HIPS, LEGS, Limb, SHOULDER, TOES, told};
use super::{How, Reading};
use crate::motion::bones::plain;
use ctsn_rig::Character;
use glam::DVec3;

/// The upper bone of a limb is this many times as long as the lower one, at least and at most, where names tell them.
const RATIO: [f64; 2] = [0.35, 3.0];
/// An ankle is below this share of its leg's height.
const ANKLE: f64 = 0.25;
/// Arms are longer than this share of the height.
const ARM: f64 = 0.15;

const SIDES: [(&str, i8); 2] = [("Left", 1), ("Right", -1)];
const ARM_PARTS: [&str; 3] = ["Arm", "ForeArm", "Hand"];
const LEG_PARTS: [&str; 3] = ["UpLeg", "Leg", "Foot"];
/// Parts of an animal's legs, and what other files call them; toes may be missing.
const HIND: [(&str, &str); 4] =
    [("BackUpLeg", "Leg01"), ("BackLeg", "Leg02"), ("BackFoot", "Foot01"), ("BackToes", "Foot02")];
const FORE: [(&str, &str); 4] =
    [("FrontUpLeg", "UpperArm"), ("FrontLeg", "ForeArm"), ("FrontFoot", "Hand"), ("FrontToes", "")];

/// Reads the parts of a body with two arms and two legs.
pub(super) fn two_legs(character: &Character, tree: &Tree, reading: &mut Reading) {
    let names: Vec<Option<(i8, String)>> = character.joints.iter().map(|joint| told(&joint.name)).collect();
    for (limbs, parts) in [(&LEGS, LEG_PARTS), (&ARMS, ARM_PARTS)] {
        for (side, sign) in SIDES {
            let lacks = parts.iter().any(|part| reading.find(&format!("{side}{part}")).is_none());
            let found = limbs.iter().find_map(|limb| by_name(limb, sign, &names, tree)).filter(|_| lacks);
            let parts = found.into_iter().flat_map(|joints| parts.into_iter().zip(joints));
            parts.for_each(|(part, joint)| reading.take(&format!("{side}{part}"), joint, How::Name));
        }
    }
    let named = |words: &[&str], side: i8| {
        let is = |name: &Option<(i8, String)>| matches!(name, Some((s, core)) if *s == side && words.contains(&core.as_str()));
        names.iter().position(is)
    };
    legs_by_place(character, tree, reading);
    arms_by_place(tree, reading);
    let fork = reading.find("LeftUpLeg").zip(reading.find("RightUpLeg")).and_then(|(one, two)| tree.fork(one, two));
    let arms = reading.find("LeftArm").zip(reading.find("RightArm"));
    let chest = arms.and_then(|(one, two)| tree.fork(one, two));
    // Hips carry all limbs, whatever a joint is called.
    let all = fork.zip(chest).and_then(|(legs, chest)| tree.fork(legs, chest)).or(fork);
    if let Some(all) = all {
        match named(HIPS, 0).filter(|&hips| tree.is_above(hips, all)) {
            Some(hips) => reading.take("Hips", hips, How::Name),
            None => reading.take("Hips", all, How::Place),
        }
    }
    let Some(chest) = chest else { return };
    match named(HEAD, 0).filter(|&head| tree.is_above(chest, head)) {
        Some(head) => reading.take("Head", head, How::Name),
        None => head_by_place(tree, chest, reading),
    }
    for (side, sign) in SIDES {
        let arm = reading.find(&format!("{side}Arm"));
        let above =
            arm.and_then(|arm| tree.parents[arm]).filter(|&above| above != chest && tree.is_above(chest, above));
        let part = format!("{side}Shoulder");
        match named(SHOULDER, sign).filter(|shoulder| above == Some(*shoulder)) {
            Some(shoulder) => reading.take(&part, shoulder, How::Name),
            None => above.into_iter().for_each(|above| reading.take(&part, above, How::Place)),
        }
        let Some(foot) = reading.find(&format!("{side}Foot")) else { continue };
        let part = format!("{side}ToeBase");
        match named(TOES, sign).filter(|toes| tree.is_above(foot, *toes)) {
            Some(toes) => reading.take(&part, toes, How::Name),
            None => tree.children(foot).first().into_iter().for_each(|&toes| reading.take(&part, toes, How::Place)),
        }
    }
}

/// A limb all of whose names are there, one below another, with bones of lengths that a limb has.
fn by_name(limb: &Limb, side: i8, names: &[Option<(i8, String)>], tree: &Tree) -> Option<[usize; 3]> {
    let find = |words: &[&str], above: Option<usize>| {
        let is = |joint: &usize| {
            let name = names[*joint].as_ref().filter(|(of, core)| *of == side && words.contains(&core.as_str()));
            name.is_some() && above.is_none_or(|above| above != *joint && tree.is_above(above, *joint))
        };
        (0..names.len()).find(is)
    };
    let upper = find(limb[0], None)?;
    let lower = find(limb[1], Some(upper))?;
    let end = find(limb[2], Some(lower))?;
    let ratio = tree.length(upper, lower) / tree.length(lower, end);
    (RATIO[0]..=RATIO[1]).contains(&ratio).then_some([upper, lower, end])
}

fn legs_by_place(character: &Character, tree: &Tree, reading: &mut Reading) {
    let &[pair] = &tree.standing()[..] else { return };
    let limbs = pair.limbs.map(|limb| {
        let path = tree.path(pair.base, tree.farthest(limb));
        let top = tree.place[limb].y - tree.floor;
        let low = |joint: &usize| tree.place[*joint].y - tree.floor < ANKLE * top;
        let ankle = path.iter().position(low)?;
        let [upper, knee] = halves(tree, &path[..=ankle])?;
        Some([upper, knee, path[ankle]])
    });
    let [Some(one), Some(two)] = limbs else { return };
    let ahead = [one, two].map(|[_, _, ankle]| pointing(character, tree, ankle)).iter().sum::<DVec3>();
    let Some(left) = DVec3::Y.cross(ahead).try_normalize() else { return };
    let one_is_left = (tree.place[one[2]] - tree.place[two[2]]).dot(left) > 0.0;
    let sides = if one_is_left { [one, two] } else { [two, one] };
    place_limbs(sides, LEG_PARTS, reading);
}

/// How far a foot reaches from its ankle, on the level.
fn pointing(character: &Character, tree: &Tree, ankle: usize) -> DVec3 {
    let on_foot = |joint: usize| tree.is_above(ankle, joint);
    let body = &character.body;
    let strongest = |vertex: &usize| body.weights[*vertex].first().is_some_and(|weight| on_foot(weight.0));
    let skin: Vec<DVec3> = (0..body.weights.len()).filter(strongest).map(|v| body.mesh.positions[v]).collect();
    let joints: Vec<DVec3> = tree.children(ankle).iter().map(|&toes| tree.place[toes]).collect();
    let points = if joints.is_empty() { skin } else { joints };
    let mean = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    if points.is_empty() { DVec3::Z * 1e-6 } else { (mean - tree.place[ankle]).with_y(0.0) }
}

fn arms_by_place(tree: &Tree, reading: &mut Reading) {
    let Some((left_leg, right_leg)) = reading.find("LeftUpLeg").zip(reading.find("RightUpLeg")) else { return };
    let Some(hips) = tree.fork(left_leg, right_leg) else { return };
    let reach = |pair: &Pair| tree.length(pair.base, pair.tips[0]).min(tree.length(pair.base, pair.tips[1]));
    let above = |pair: &Pair| tree.place[pair.base].y > tree.place[hips].y && !tree.is_above(left_leg, pair.base);
    let arms = tree.free().into_iter().filter(|pair| above(pair) && reach(pair) > ARM * tree.height);
    let Some(pair) = arms.max_by(|a, b| reach(a).total_cmp(&reach(b))) else { return };
    let limbs = pair.limbs.map(|limb| {
        let path = tree.path(pair.base, tree.farthest(limb));
        // A hand is where fingers part.
        let fingers =
            |joint: usize| tree.children(joint).iter().filter(|child| !tree.children(**child).is_empty()).count();
        let parts = |joint: &usize| fingers(*joint) > 1 || tree.children(*joint).len() > 2;
        let hand = path.iter().position(parts).filter(|hand| *hand > 1).unwrap_or(path.len() - 1);
        let [upper, elbow] = halves(tree, &path[..=hand])?;
        Some([upper, elbow, path[hand]])
    });
    let [Some(one), Some(two)] = limbs else { return };
    let left = tree.place[left_leg] - tree.place[right_leg];
    let one_is_left = (tree.place[one[2]] - tree.place[two[2]]).dot(left) > 0.0;
    place_limbs(if one_is_left { [one, two] } else { [two, one] }, ARM_PARTS, reading);
}

fn place_limbs(sides: [[usize; 3]; 2], parts: [&str; 3], reading: &mut Reading) {
    for ((side, _), joints) in SIDES.iter().zip(sides) {
        parts.iter().zip(joints).for_each(|(part, joint)| reading.take(&format!("{side}{part}"), joint, How::Place));
    }
}

/// The two joints of a chain that part its end into the most equal bones: hip and knee, shoulder and elbow.
fn halves(tree: &Tree, path: &[usize]) -> Option<[usize; 2]> {
    let end = *path.last()?;
    let inner = &path[..path.len() - 1];
    let pairs =
        inner.iter().enumerate().flat_map(|(at, &upper)| inner[at + 1..].iter().map(move |&lower| [upper, lower]));
    let uneven = |[upper, lower]: &[usize; 2]| (tree.length(*upper, *lower) / tree.length(*lower, end)).ln().abs();
    let whole = tree.length(path[0], end);
    let long = |[upper, _]: &[usize; 2]| tree.length(*upper, end) > 0.6 * whole;
    pairs.filter(|pair| long(pair) && uneven(pair).is_finite()).min_by(|a, b| uneven(a).total_cmp(&uneven(b)))
}

/// The head by its place: where the neck's chain parts, or its end.
fn head_by_place(tree: &Tree, chest: usize, reading: &mut Reading) {
    let arm = |joint: usize| {
        let arms = [reading.find("LeftArm"), reading.find("RightArm")];
        arms.iter().flatten().any(|&arm| tree.is_above(joint, arm))
    };
    let top = tree.children(chest).iter().filter(|&&joint| !arm(joint)).map(|&joint| tree.highest(joint));
    let Some(top) = top.max_by(|a, b| tree.place[*a].y.total_cmp(&tree.place[*b].y)) else { return };
    let path = tree.path(chest, top);
    let parts = path.iter().find(|joint| tree.children(**joint).len() > 1).or(path.last());
    parts.into_iter().for_each(|&head| reading.take("Head", head, How::Place));
}

/// Reads the parts of a body with four legs.
pub(super) fn four_legs(character: &Character, tree: &Tree, reading: &mut Reading) {
    let named = |wanted: &str| character.joints.iter().position(|joint| plain(&joint.name) == wanted);
    let one_of = |names: &[&str]| names.iter().filter(|name| !name.is_empty()).find_map(|name| named(name));
    for (side, _) in SIDES {
        for (part, other) in HIND.iter().chain(&FORE) {
            let [part, other] =
                [part, other].map(|name| if name.is_empty() { String::new() } else { format!("{side}{name}") });
            one_of(&[&part, &other]).into_iter().for_each(|joint| reading.take(&part, joint, How::Name));
        }
    }
    one_of(&["Hips", "Hip"]).into_iter().for_each(|joint| reading.take("Hips", joint, How::Name));
    one_of(&["Head"]).into_iter().for_each(|joint| reading.take("Head", joint, How::Name));
    if !reading.missing().is_empty() {
        four_by_place(tree, reading);
    }
}

fn four_by_place(tree: &Tree, reading: &mut Reading) {
    let pairs = tree.standing();
    let &[one, two] = &pairs[..] else { return };
    // Skeletons grow from the hips.
    let (hind, fore) = if tree.is_above(one.base, two.base) { (one, two) } else { (two, one) };
    if !tree.is_above(hind.base, fore.base) || hind.base == fore.base {
        return;
    }
    let middle = |pair: &Pair| 0.5 * (tree.place[pair.tips[0]] + tree.place[pair.tips[1]]);
    let left = DVec3::Y.cross((middle(&fore) - middle(&hind)).with_y(0.0));
    for (pair, parts) in [(hind, HIND), (fore, FORE)] {
        let first_is_left = (tree.place[pair.tips[0]] - tree.place[pair.tips[1]]).dot(left) > 0.0;
        let order = if first_is_left { [0, 1] } else { [1, 0] };
        for ((side, _), which) in SIDES.iter().zip(order) {
            let path = tree.path(pair.base, pair.tips[which]);
            // The last is the toes; a leg of more bones begins below a shoulder blade.
            let from = path.len().saturating_sub(parts.len());
            let taken = path[from..].iter().zip(parts);
            taken.for_each(|(&joint, (part, _))| reading.take(&format!("{side}{part}"), joint, How::Place));
        }
    }
    reading.take("Hips", hind.base, How::Place);
    let leg = |joint: usize| fore.limbs.contains(&joint);
    let ahead = tree.children(fore.base).iter().filter(|&&joint| !leg(joint)).map(|&joint| tree.highest(joint));
    let Some(top) = ahead.max_by(|a, b| tree.place[*a].y.total_cmp(&tree.place[*b].y)) else { return };
    let path = tree.path(fore.base, top);
    let head = path.iter().find(|joint| tree.children(**joint).len() > 1).or(path.last());
    head.into_iter().for_each(|&head| reading.take("Head", head, How::Place));
}
