//! Characters and garments that others made: what is read, what is mended, what is refused.

use crate::made::{Folder, edit};

#[test]
fn joints_that_are_told_are_checked_and_reported() {
    let folder = Folder::new();
    folder.accepts("character mannequin -o character.glb");
    edit(&folder.path("character.glb"), |json, _| {
        let nodes = json["nodes"].as_array_mut().expect("nodes");
        nodes.iter_mut().enumerate().for_each(|(at, node)| node["name"] = format!("bone.{at:03}").into());
    });
    let said = folder.accepts("motion character.glb --rate 2 -o moving.glb");
    for words in ["two arms and two legs", "by place in the skeleton", "LeftForeArm = bone."] {
        assert!(said.contains(words), "wanted {words:?} in {said}");
    }
    let taken = folder.accepts("motion character.glb --from moving.glb --rate 2 -o taken.glb");
    assert!(taken.contains("showcase"), "{taken}");
    edit(&folder.path("taken.glb"), |json, _| {
        json.as_object_mut().expect("an object").remove("animations");
    });
    folder.refuses("motion character.glb --from taken.glb -o moving.glb", &["taken.glb has no clip"]);
    folder
        .write("map.json", br#"{"Tentacle": "bone.003"}"#)
        .write("lost.json", br#"{"LeftArm": "bone.777"}"#)
        .write("told.json", br#"{"Head": "bone.004"}"#);
    let told = folder.accepts("motion character.glb --rate 2 --joints told.json -o moving.glb");
    assert!(told.contains("1 joints told: Head = bone.004"), "{told}");
    for (map, says) in [("map", &["Tentacle", "LeftForeArm"][..]), ("lost", &["LeftArm", "bone.777", "bone.003"])] {
        folder.refuses(&format!("motion character.glb --joints {map}.json -o moving.glb"), says);
    }
}

/// Names of other families for ours; sides are `{}`.
type Family = (&'static str, [&'static str; 2], &'static [(&'static str, &'static str)]);

const FAMILIES: [Family; 4] = [
    (
        "Unreal",
        ["l", "r"],
        &[
            ("Hips", "pelvis"),
            ("Spine", "spine_01"),
            ("Spine1", "spine_02"),
            ("Spine2", "spine_03"),
            ("Neck", "neck_01"),
            ("Head", "head"),
            ("Shoulder", "clavicle_{}"),
            ("Arm", "upperarm_{}"),
            ("ForeArm", "lowerarm_{}"),
            ("Hand", "hand_{}"),
            ("UpLeg", "thigh_{}"),
            ("Leg", "calf_{}"),
            ("Foot", "foot_{}"),
            ("ToeBase", "ball_{}"),
        ],
    ),
    (
        "VRM",
        ["L", "R"],
        &[
            ("Hips", "J_Bip_C_Hips"),
            ("Spine", "J_Bip_C_Spine"),
            ("Spine1", "J_Bip_C_Chest"),
            ("Spine2", "J_Bip_C_UpperChest"),
            ("Neck", "J_Bip_C_Neck"),
            ("Head", "J_Bip_C_Head"),
            ("Shoulder", "J_Bip_{}_Shoulder"),
            ("Arm", "J_Bip_{}_UpperArm"),
            ("ForeArm", "J_Bip_{}_LowerArm"),
            ("Hand", "J_Bip_{}_Hand"),
            ("UpLeg", "J_Bip_{}_UpperLeg"),
            ("Leg", "J_Bip_{}_LowerLeg"),
            ("Foot", "J_Bip_{}_Foot"),
            ("ToeBase", "J_Bip_{}_ToeBase"),
        ],
    ),
    (
        "Rigify",
        ["L", "R"],
        &[
            ("Hips", "DEF-spine"),
            ("Spine", "DEF-spine.001"),
            ("Spine1", "DEF-spine.002"),
            ("Spine2", "DEF-spine.003"),
            ("Neck", "DEF-spine.004"),
            ("Head", "DEF-spine.006"),
            ("Shoulder", "DEF-shoulder.{}"),
            ("Arm", "DEF-upper_arm.{}"),
            ("ForeArm", "DEF-forearm.{}"),
            ("Hand", "DEF-hand.{}"),
            ("UpLeg", "DEF-thigh.{}"),
            ("Leg", "DEF-shin.{}"),
            ("Foot", "DEF-foot.{}"),
            ("ToeBase", "DEF-toe.{}"),
        ],
    ),
    (
        "Biped",
        ["L", "R"],
        &[
            ("Hips", "Bip01 Pelvis"),
            ("Spine", "Bip01 Spine"),
            ("Spine1", "Bip01 Spine1"),
            ("Spine2", "Bip01 Spine2"),
            ("Neck", "Bip01 Neck"),
            ("Head", "Bip01 Head"),
            ("Shoulder", "Bip01 {} Clavicle"),
            ("Arm", "Bip01 {} UpperArm"),
            ("ForeArm", "Bip01 {} Forearm"),
            ("Hand", "Bip01 {} Hand"),
            ("UpLeg", "Bip01 {} Thigh"),
            ("Leg", "Bip01 {} Calf"),
            ("Foot", "Bip01 {} Foot"),
            ("ToeBase", "Bip01 {} Toe0"),
        ],
    ),
];

/// A joint of ours in the names of a family.
fn renamed((_, sides, names): &Family, joint: &str) -> String {
    let ours = joint.rsplit(':').next().unwrap_or(joint);
    let (side, part) = match (ours.strip_prefix("Left"), ours.strip_prefix("Right")) {
        (Some(part), _) => (sides[0], part),
        (_, Some(part)) => (sides[1], part),
        _ => ("", ours),
    };
    let known = names.iter().find(|(own, _)| *own == part);
    known.map_or(joint.to_owned(), |(_, theirs)| theirs.replace("{}", side))
}

/// Deletes the skin of a file's trunk and upper limbs: the faces whose first corner follows one of them most.
fn delete_trunk(json: &mut serde_json::Value, bin: &mut [u8]) {
    let primitive = json["meshes"][0]["primitives"][0].clone();
    let place = |accessor: &serde_json::Value| {
        let accessor = &json["accessors"][accessor.as_u64().expect("an accessor") as usize];
        let view = &json["bufferViews"][accessor["bufferView"].as_u64().expect("a view") as usize];
        let offset = view["byteOffset"].as_u64().unwrap_or(0) as usize;
        (offset, accessor["count"].as_u64().expect("a count") as usize)
    };
    let name = |joint: usize| {
        let node = json["skins"][0]["joints"][joint].as_u64().expect("a node") as usize;
        json["nodes"][node]["name"].as_str().expect("a name").rsplit(':').next().expect("a part").to_owned()
    };
    let covered = ["Hips", "Spine", "Spine1", "Spine2", "LeftShoulder", "RightShoulder"];
    let (joints, (indices, count)) = (place(&primitive["attributes"]["JOINTS_0"]).0, place(&primitive["indices"]));
    let mut kept = 0;
    for face in 0..count / 3 {
        let at = indices + 12 * face;
        let corner = u32::from_le_bytes(bin[at..at + 4].try_into().expect("four bytes")) as usize;
        let joint = u16::from_le_bytes(bin[joints + 8 * corner..][..2].try_into().expect("two bytes"));
        if !covered.contains(&name(usize::from(joint)).as_str()) {
            bin.copy_within(at..at + 12, indices + 12 * kept);
            kept += 1;
        }
    }
    let index = primitive["indices"].as_u64().expect("an accessor") as usize;
    assert!(kept > 0 && kept < count / 3, "{kept} of {} faces", count / 3);
    json["accessors"][index]["count"] = (3 * kept).into();
}

/// The file `whole.glb` without a trunk's skin, its joints named as a family does.
fn without_torso(folder: &Folder, family: &Family) -> String {
    let file = format!("{}.glb", family.0);
    std::fs::copy(folder.path("whole.glb"), folder.path(&file)).expect("a copy");
    edit(&folder.path(&file), |json, bin| {
        delete_trunk(json, bin);
        for node in json["nodes"].as_array_mut().expect("nodes") {
            let name = renamed(family, node["name"].as_str().expect("a name"));
            node["name"] = name.into();
        }
    });
    file
}

#[test]
fn other_rigs_are_known_and_one_without_a_torso_ends_in_simulated_cloth() {
    let folder = Folder::new();
    folder.accepts("character mannequin -o whole.glb");
    for family in &FAMILIES {
        let file = without_torso(&folder, family);
        let told = folder.accepts(&format!("motion {file} --rate 2 -o {}_moving.glb", family.0));
        assert!(told.contains("two arms and two legs"), "{}: {told}", family.0);
    }
    // Whatever the names are, the body that is made in the trunk's place is the same, and so is cloth on it.
    folder.accepts("garment whole.glb --kind tshirt --vertices 600 -o shirt.glb");
    let checked = folder.accepts("garment Biped_moving.glb --check shirt.glb --html page.html");
    for words in ["no skin under it", "Bip01 Spine1", "fit to be simulated"] {
        assert!(checked.contains(words), "wanted {words:?} in {checked}");
    }
    let page = std::fs::read_to_string(folder.path("page.html")).expect("a page");
    assert!(page.contains("The body under it") && page.matches("data:image/png").count() == 3, "{page}");
    let told = folder.accepts("simulate Biped_moving.glb shirt.glb --resample never --rate 2 --poses 4 -o data");
    let kept = ctsn_train::report::Report::new(&folder.path("data")).expect("a report").kept;
    assert!(kept >= 3, "{kept} of 4 kept: {told}");
}

#[test]
fn what_a_check_refuses_is_on_its_page() {
    let folder = Folder::new();
    super::write_character(&folder, |_| ());
    super::write_garment(&folder, glam::DVec3::ZERO);
    super::change_garment(&folder, |garment| garment.mesh.positions.iter_mut().for_each(|p| *p *= 0.01));
    folder.refuses("garment character.glb --check garment.glb --html page.html", &["scale", "100 times too small"]);
    let page = std::fs::read_to_string(folder.path("page.html")).expect("a page");
    assert!(page.contains("cannot be simulated") && page.contains("100 times too small"), "{page}");
}

#[test]
fn a_dressed_character_is_split() {
    let folder = Folder::new();
    folder.accepts("character mannequin -o character.glb");
    folder.refuses("split character.glb -o parts", &["none of its parts is named like a garment", "--garment"]);
    // The last quarter of its faces as a part of its own, which its material calls a top.
    edit(&folder.path("character.glb"), |json, _| {
        let mut primitive = json["meshes"][0]["primitives"][0].clone();
        let index = primitive["indices"].as_u64().expect("an accessor") as usize;
        let mut indices = json["accessors"][index].clone();
        let count = indices["count"].as_u64().expect("a count") / 12 * 3;
        json["accessors"][index]["count"] = (3 * count).into();
        (indices["count"], indices["byteOffset"]) = (count.into(), (12 * count).into());
        let accessors = json["accessors"].as_array_mut().expect("accessors");
        accessors.push(indices);
        primitive["indices"] = (accessors.len() - 1).into();
        let mut material = json["materials"][0].clone();
        material["name"] = "Outfit_Top".into();
        let materials = json["materials"].as_array_mut().expect("materials");
        materials.push(material);
        primitive["material"] = (materials.len() - 1).into();
        json["meshes"][0]["primitives"].as_array_mut().expect("primitives").push(primitive);
        let hips = json["nodes"]
            .as_array()
            .expect("nodes")
            .iter()
            .position(|node| node["name"].as_str().is_some_and(|name| name.ends_with("Hips")));
        json["extensions"] =
            serde_json::json!({ "VRMC_vrm": { "humanoid": { "humanBones": { "hips": { "node": hips } } } } });
        json["extensionsUsed"] = serde_json::json!(["VRMC_vrm"]);
    });
    let told = folder.accepts("split character.glb -o parts");
    assert!(told.contains("top") && told.contains("body") && told.contains("top.glb"), "{told}");
    let read = |name: &str| ctsn_rig::gltf::read_character(&folder.path(name), 1.0).expect("a character");
    let (whole, rest) = (read("character.glb"), read("parts/character.glb"));
    let (top, _) = ctsn_rig::gltf::read_garment(&folder.path("parts/top.glb"), 1.0).expect("a garment");
    let faces = |of: &ctsn_rig::Character| of.body.mesh.triangles.len();
    assert_eq!(faces(&rest) + top.mesh.triangles.len(), faces(&whole));
    assert_eq!((rest.parts.get("Hips"), rest.parts.len()), (Some(&rest.root), 1), "VRM's bones are written again");
    edit(&folder.path("character.glb"), |json, _| drop(json.as_object_mut().expect("an object").remove("animations")));
    let told = folder.accepts("split character.glb -o still");
    assert!(told.contains("; 0 clips, 0 s"), "{told}");
}
