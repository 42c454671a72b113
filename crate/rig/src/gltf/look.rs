//! What a part of a character looks like: told by its names, or by where it is on the body.

use glam::DVec3;

/// What a part of a character is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// Skin, or what cloth lies on as on skin.
    Body,
    /// Hair and beards.
    Hair,
    /// Eyes, lashes, brows, teeth.
    Eyes,
    /// Glasses, jewellery, hats, bags.
    Accessory,
    /// Shirts and jackets.
    Top,
    /// Trousers and shorts.
    Trousers,
    /// Skirts.
    Skirt,
    /// Dresses, robes, overalls.
    Dress,
    /// Shoes and socks.
    Shoes,
}

/// Words in names, and what they say. The first that fits says it: `HairAccessory` is hair.
const WORDS: [(Look, &[&str]); 9] = [
    (Look::Hair, &["hair", "beard", "moustache", "ponytail", "bangs"]),
    (
        Look::Eyes,
        &["eye", "eyeball", "eyelid", "eyelash", "lash", "eyebrow", "brow", "iris", "teeth", "tooth", "tongue"],
    ),
    (Look::Shoes, &["shoe", "footwear", "boot", "sock", "sandal", "sneaker"]),
    (Look::Skirt, &["skirt"]),
    (Look::Dress, &["dress", "onepiece", "robe", "gown", "overall"]),
    (Look::Top, &["top", "shirt", "tshirt", "blouse", "jacket", "coat", "hoodie", "sweater", "vest"]),
    (Look::Trousers, &["bottom", "trouser", "pant", "jean", "short", "legging"]),
    (Look::Accessory, &["glass", "hat", "cap", "earring", "necklace", "watch", "jewelry", "accessory", "bag"]),
    (Look::Body, &["body", "skin", "head", "face", "hand", "arm", "leg", "foot", "torso"]),
];

impl Look {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Look::Body => "body",
            Look::Hair => "hair",
            Look::Eyes => "eyes",
            Look::Accessory => "accessory",
            Look::Top => "top",
            Look::Trousers => "trousers",
            Look::Skirt => "skirt",
            Look::Dress => "dress",
            Look::Shoes => "shoes",
        }
    }

    /// Whether cloth lies on it. Hair gives way, and what is thin or small would only catch it.
    pub fn holds_cloth(self) -> bool {
        !matches!(self, Look::Hair | Look::Eyes | Look::Accessory)
    }

    /// Whether it is a garment to simulate.
    pub fn is_garment(self) -> bool {
        matches!(self, Look::Top | Look::Trousers | Look::Skirt | Look::Dress)
    }

    /// By the first name that says it.
    pub(super) fn named(names: &[String]) -> Option<Look> {
        let said = |name: &String| {
            let words = words(name);
            let fits = |known: &&str| {
                // One or many.
                words.iter().any(|word| {
                    word == known || word.strip_suffix('s') == Some(known) || word.strip_suffix("es") == Some(known)
                })
            };
            WORDS.iter().find(|(_, known)| known.iter().any(fits)).map(|(look, _)| *look)
        };
        names.iter().find_map(said)
    }

    /// By its place in the box around the whole character.
    pub(super) fn placed(part: [DVec3; 2], whole: [DVec3; 2]) -> Look {
        let height = (whole[1].y - whole[0].y).max(f64::MIN_POSITIVE);
        let [low, high] = part.map(|corner| (corner.y - whole[0].y) / height);
        match (low, high) {
            _ if low < 0.1 && high > 0.9 => Look::Body,
            _ if high < 0.2 => Look::Shoes,
            _ if low > 0.82 => Look::Hair,
            _ if low < 0.45 && high > 0.7 => Look::Dress,
            _ if high > 0.68 => Look::Top,
            _ => Look::Trousers,
        }
    }
}

/// The words of a name, in lower case: parted by other signs, and where a capital follows a small letter.
pub(super) fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut before = ' ';
    for letter in name.chars() {
        if !letter.is_alphabetic() || before.is_lowercase() && letter.is_uppercase() {
            words.push(String::new());
        }
        if let Some(word) = words.last_mut().filter(|_| letter.is_alphabetic()) {
            word.extend(letter.to_lowercase());
        }
        before = letter;
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(names: [&str; 3]) -> Option<Look> {
        Look::named(&names.map(str::to_owned))
    }

    #[test]
    fn names_tell_what_a_part_is() {
        for (names, look) in [
            (["Wolf3D_Outfit_Top", "", "Wolf3D_Outfit_Top"], Some(Look::Top)),
            (["Wolf3D_Eye", "", "EyeLeft"], Some(Look::Eyes)),
            (["Std_Eyelash", "", ""], Some(Look::Eyes)),
            (["", "Eyelashes", ""], Some(Look::Eyes)),
            (["eyebrow001", "", ""], Some(Look::Eyes)),
            (["", "", "Wolf3D_Glasses"], Some(Look::Accessory)),
            (["N00_000_Hair_00_HAIR (Instance)", "Face", "Face"], Some(Look::Hair)),
            (["N00_010_01_Onepiece_00_CLOTH", "Body", "Body"], Some(Look::Dress)),
            (["N00_000_00_Body_00_SKIN", "Body", "Body"], Some(Look::Body)),
            (["", "jeans", ""], Some(Look::Trousers)),
            (["", "Alpha_Surface", "Beta_Joints"], None),
            (["Stopwatches", "chairs", "capsule"], None),
        ] {
            assert_eq!(named(names), look, "{names:?}");
        }
    }

    #[test]
    fn places_tell_where_names_do_not() {
        let boxed = |low: f64, high: f64| [DVec3::Y * low, DVec3::Y * high];
        let whole = boxed(0.0, 1.7);
        for (low, high, look) in [
            (0.0, 1.7, Look::Body),
            (0.0, 0.2, Look::Shoes),
            (1.5, 1.72, Look::Hair),
            (0.9, 1.4, Look::Top),
            (0.1, 1.0, Look::Trousers),
            (0.4, 1.4, Look::Dress),
        ] {
            assert_eq!(Look::placed(boxed(low, high), whole), look, "{low} to {high}");
        }
    }
}
