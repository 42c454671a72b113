//! The parts of a body that a VRM file names: `VRM` (0.x) lists bones, `VRMC_vrm` (1.0) maps them. Both are said in the
//! names that this project gives parts, those of Mixamo's skeleton.

use serde_json::Value;
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
