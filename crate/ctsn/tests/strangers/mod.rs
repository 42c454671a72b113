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
