//! The parts of a body that a VRM file names: `VRM` (0.x) lists bones, `VRMC_vrm` (1.0) maps them. Both are said in the
//! names that this project gives parts, those of Mixamo's skeleton.

use serde_json::{Value, json};
use std::collections::BTreeMap;

/// VRM's names of the trunk, and ours.
const TRUNK: [(&str, &str); 6] = [
    ("hips", "Hips"),
    ("spine", "Spine"),
    ("chest", "Spine1"),
    ("upperChest", "Spine2"),
    ("neck", "Neck"),
    ("head", "Head"),
];
/// VRM's names of the limbs behind `left` or `right`, and ours behind `Left` or `Right`.
const LIMBS: [(&str, &str); 8] = [
    ("Shoulder", "Shoulder"),
    ("UpperArm", "Arm"),
    ("LowerArm", "ForeArm"),
    ("Hand", "Hand"),
    ("UpperLeg", "UpLeg"),
    ("LowerLeg", "Leg"),
    ("Foot", "Foot"),
    ("Toes", "ToeBase"),
];

/// Node of each named part, of the file's JSON; empty where the file is no VRM.
pub(super) fn parts(json: &Value) -> BTreeMap<String, usize> {
    let bones = |extension: &str| &json["extensions"][extension]["humanoid"]["humanBones"];
    let node = |bone: &Value| bone["node"].as_u64().map(|node| node as usize);
    let listed = bones("VRM").as_array().into_iter().flatten();
    let listed = listed.filter_map(|bone| Some((part(bone["bone"].as_str()?)?, node(bone)?)));
    let mapped = bones("VRMC_vrm").as_object().into_iter().flatten();
    let mapped = mapped.filter_map(|(name, bone)| Some((part(name)?, node(bone)?)));
    listed.chain(mapped).collect()
}

/// The extension `VRMC_vrm` (1.0) of these parts and their nodes: its bones alone, for whose the character is and what
/// may be done with it nobody has said here. None where no part is one of its bones.
pub(super) fn extension(parts: &BTreeMap<String, usize>) -> Option<Value> {
    let bones = parts.iter().filter_map(|(part, node)| Some((bone(part)?, json!({ "node": node }))));
    let bones: serde_json::Map<String, Value> = bones.collect();
    (!bones.is_empty()).then(|| json!({ "specVersion": "1.0", "humanoid": { "humanBones": bones } }))
}

/// The VRM bone of our name.
fn bone(part: &str) -> Option<String> {
    if let Some((bone, _)) = TRUNK.iter().find(|(_, name)| *name == part) {
        return Some(bone.to_string());
    }
    let sides = [("Left", "left"), ("Right", "right")];
    let (side, rest) = sides.iter().find_map(|(ours, theirs)| Some((theirs, part.strip_prefix(ours)?)))?;
    LIMBS.iter().find(|(_, name)| *name == rest).map(|(bone, _)| format!("{side}{bone}"))
}

/// Our name of a VRM bone; `None` for those that motion does not turn.
fn part(bone: &str) -> Option<String> {
    if let Some((_, part)) = TRUNK.iter().find(|(name, _)| *name == bone) {
        return Some(part.to_string());
    }
    let (side, rest) = bone
        .strip_prefix("left")
        .map(|rest| ("Left", rest))
        .or(bone.strip_prefix("right").map(|rest| ("Right", rest)))?;
    LIMBS.iter().find(|(name, _)| *name == rest).map(|(_, part)| format!("{side}{part}"))
}
