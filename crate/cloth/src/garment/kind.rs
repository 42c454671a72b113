//! The kinds of garment as a table of presets: how far from the body, how long, how wide, and what may wear them.
//! Lengths are fractions of a limb, from where it leaves the trunk (0) to its tip (1).

/// What a garment is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, clap::ValueEnum)]
pub enum Kind {
    /// Short sleeves, hem around the hips
    Tshirt,
    /// Fitted above the waist, flared to the knees, short sleeves
    Dress,
    /// Waistband on the hips, flared to the knees
    Skirt,
    /// A wizard's: wide long sleeves, wide to the ankles
    Robe,
    /// Down the back from the shoulders; on an animal over back and sides, fastened at the neck
    Cape,
    /// Waistband to ankles, two legs
    Trousers,
    /// Body and upper legs of an animal
    Coat,
    /// A band around the body with holes for the front limbs or fins
    Vest,
    /// A square hung from a rail, before an obstacle
    Sheet,
}

/// What a body has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Build {
    /// Two legs that continue the trunk downwards.
    Upright,
    /// Mirrored limbs, none of which continue the trunk: four legs, or fins.
    Animal,
    /// No mirrored limbs.
    Limbless,
    /// What only holds cloth before an obstacle.
    Rail,
}

/// The numbers behind a kind.
#[derive(Clone, Copy, Debug)]
pub(super) struct Preset {
    /// Distance from the body in body extents.
    pub looseness: f64,
    /// Covered fraction of arms, or of an animal's legs.
    pub sleeve: f64,
    /// Covered fraction of the legs of what walks upright.
    pub hem: f64,
    /// Covered fraction of neck and tail.
    pub collar: f64,
    /// Where cloth starts to fall free, and waistbands sit: fraction of the trunk from the hip to the shoulders.
    pub waist: f64,
    /// Metres by which a skirt widens on every side per metre of fall.
    pub flare: f64,
    /// The same for sleeves, per metre of arm.
    pub sleeve_flare: f64,
}

impl Build {
    /// The kinds it may wear, the default first.
    pub fn kinds(self) -> &'static [Kind] {
        use Kind::{Cape, Coat, Dress, Robe, Sheet, Skirt, Trousers, Tshirt, Vest};
        match self {
            Build::Upright => &[Tshirt, Dress, Skirt, Robe, Cape, Trousers],
            Build::Animal => &[Coat, Vest, Cape],
            Build::Limbless => &[Vest],
            Build::Rail => &[Sheet],
        }
    }

    /// In words, for messages.
    pub fn words(self) -> &'static str {
        match self {
            Build::Upright => "a body on two legs",
            Build::Animal => "an animal",
            Build::Limbless => "a body without limbs",
            Build::Rail => "a rail before an obstacle",
        }
    }
}

impl Kind {
    /// As the command line spells it.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Tshirt => "tshirt",
            Kind::Dress => "dress",
            Kind::Skirt => "skirt",
            Kind::Robe => "robe",
            Kind::Cape => "cape",
            Kind::Trousers => "trousers",
            Kind::Coat => "coat",
            Kind::Vest => "vest",
            Kind::Sheet => "sheet",
        }
    }

    /// The table.
    pub(super) fn preset(self) -> Preset {
        let [looseness, sleeve, hem, collar, waist, flare, sleeve_flare] = match self {
            Kind::Tshirt => [1.0 / 150.0, 0.24, 0.0, 0.05, 0.6, 0.0, 0.0],
            Kind::Dress => [1.0 / 190.0, 0.12, 0.55, 0.05, 0.3, 0.22, 0.0],
            Kind::Skirt => [1.0 / 200.0, 0.0, 0.5, 0.0, 0.2, 0.25, 0.0],
            Kind::Robe => [1.0 / 80.0, 0.7, 0.87, 0.05, 0.55, 0.12, 0.2],
            Kind::Cape => [1.0 / 100.0, 0.3, 0.75, 0.05, 1.0, 0.15, 0.0],
            Kind::Trousers => [1.0 / 120.0, 0.0, 0.94, 0.0, 0.2, 0.0, 0.0],
            Kind::Coat => [1.0 / 95.0, 0.3, 0.0, 0.05, 0.0, 0.0, 0.0],
            Kind::Vest => [1.0 / 150.0, 0.2, 0.0, 0.05, 0.0, 0.0, 0.0],
            // Cut by the rail alone.
            Kind::Sheet => [1.0 / 150.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        };
        Preset { looseness, sleeve, hem, collar, waist, flare, sleeve_flare }
    }
}
