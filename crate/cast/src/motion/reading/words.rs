//! What the name of a joint says, in the common families of skeletons: Mixamo, Unreal, VRM and VRoid, Rigify, 3ds Max's
//! Biped, Ready Player Me, Daz, Character Creator, MakeHuman, Auto-Rig Pro, VRChat.

/// Words of exporters and rigs that say nothing of the body.
const NOISE: [&str; 22] = [
    "mixamorig",
    "bip",
    "biped",
    "valve",
    "j",
    "def",
    "cc",
    "base",
    "b",
    "bn",
    "bone",
    "jnt",
    "joint",
    "rig",
    "character",
    "c",
    "sk",
    "bend",
    "stretch",
    "deform",
    "bind",
    "x",
];
/// Words of joints that help others and are no part of the body themselves.
const HELPERS: [&str; 22] = [
    "org", "mch", "ctrl", "control", "ik", "fk", "pole", "target", "twist", "roll", "tweak", "end", "nub", "helper",
    "adj", "aux", "sec", "socket", "weapon", "prop", "share", "dummy",
];

/// A limb's three main joints by their names without the side: upper, lower, end.
pub(super) type Limb = [&'static [&'static str]; 3];

const HANDS: &[&str] = &["hand", "wrist"];
const FEET: &[&str] = &["foot", "ankle"];
const FOREARMS: &[&str] = &["forearm", "lowerarm", "lowarm", "loarm", "armlower", "elbow"];

/// Arms, in the order in which they are tried: a shoulder is an upper arm only where nothing else is.
pub(super) const ARMS: [Limb; 2] = [
    [&["upperarm", "uparm", "arm", "armupper", "shldr", "humerus"], FOREARMS, HANDS],
    [&["shoulder"], FOREARMS, HANDS],
];
/// Legs: a leg is a shank below a thigh, and a thigh above a knee.
pub(super) const LEGS: [Limb; 2] = [
    [
        &["upleg", "upperleg", "thigh", "legupper", "femur", "hip"],
        &["leg", "lowerleg", "lowleg", "loleg", "leglower", "shin", "calf", "knee"],
        FEET,
    ],
    [&["leg"], &["knee", "shin", "calf", "lowerleg"], FEET],
];
pub(super) const HIPS: &[&str] = &["hips", "hip", "pelvis"];
pub(super) const HEAD: &[&str] = &["head"];
pub(super) const SHOULDER: &[&str] = &["shoulder", "clavicle", "collar", "collarbone"];
pub(super) const TOES: &[&str] = &["toebase", "toe", "toes", "ball"];

/// The side that a name tells (1 left, -1 right, 0 none) and the rest of it in one word; `None` for a helper.
pub(super) fn told(name: &str) -> Option<(i8, String)> {
    let name = name.rsplit([':', '|']).next().unwrap_or(name);
    let (mut side, mut core) = (0, String::new());
    for word in split(name) {
        let (of_word, rest) = sided(&word);
        if HELPERS.contains(&rest) {
            return None;
        }
        side = if of_word == 0 { side } else { of_word };
        if !NOISE.contains(&rest) {
            core.push_str(rest);
        }
    }
    Some((side, core))
}

/// The side a word is or begins with, and what is left of it.
fn sided(word: &str) -> (i8, &str) {
    match word {
        "l" | "lf" | "lft" | "left" => (1, ""),
        "r" | "rt" | "rgt" | "right" => (-1, ""),
        _ => match (word.strip_prefix("left"), word.strip_prefix("right")) {
            (Some(rest), _) => (1, rest),
            (_, Some(rest)) => (-1, rest),
            _ => (0, word),
        },
    }
}

/// Words in lower case, without digits: at signs, digits and capitals a word begins. `LThighBend` -> l, thigh, bend.
fn split(name: &str) -> Vec<String> {
    let letters: Vec<char> = name.chars().collect();
    let mut words = vec![String::new()];
    for (at, &letter) in letters.iter().enumerate() {
        let before = at.checked_sub(1).map_or(' ', |at| letters[at]);
        let after = letters.get(at + 1).copied().unwrap_or(' ');
        let begins = letter.is_uppercase() && (!before.is_uppercase() || after.is_lowercase());
        if begins || !letter.is_alphabetic() {
            words.push(String::new());
        }
        if let Some(word) = words.last_mut().filter(|_| letter.is_alphabetic()) {
            word.extend(letter.to_lowercase());
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn families_of_names_say_the_same() {
        let upper_arms = [
            "mixamorig:LeftArm",
            "mixamorigLeftArm",
            "LeftArm",
            "upperarm_l",
            "J_Bip_L_UpperArm",
            "DEF-upper_arm.L",
            "Bip01 L UpperArm",
            "CC_Base_L_Upperarm",
            "lShldrBend",
            "arm_stretch.l",
            "LeftUpperArm",
            "Left arm",
            "upperarm01.L",
            "rig:b_LeftArm_07",
            "ValveBiped.Bip01_L_UpperArm",
        ];
        for name in upper_arms {
            let (side, core) = told(name).expect(name);
            assert!(side == 1 && ARMS[0][0].contains(&core.as_str()), "{name}: {side} {core}");
        }
        for name in ["RightUpLeg", "thigh_r", "J_Bip_R_UpperLeg", "DEF-thigh.R", "Bip01 R Thigh", "rThighBend"] {
            let (side, core) = told(name).expect(name);
            assert!(side == -1 && LEGS[0][0].contains(&core.as_str()), "{name}: {side} {core}");
        }
        for name in ["ik_hand_l", "upperarm_twist_01_l", "MCH-spine", "Bip01 L Toe0Nub", "ORG-thigh.L"] {
            assert_eq!(told(name), None, "{name}");
        }
        assert_eq!(told("Bone.017"), Some((0, String::new())));
    }
}
