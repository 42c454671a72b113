//! A garment hung on its character: the shell simulated to rest on the canonical pose, so that it neither floats nor
//! cuts in. The draped form is what is written. Its rest lengths then hold the sag of its own weight, which the strain
//! reported here bounds; written undraped, cloth and body would only meet when the first pose is simulated, and nobody
//! would have looked.

use crate::Result;
use crate::simulate::{Material, Settings, Simulator};
use ctsn_rig::statistics::Sorted;
use ctsn_rig::{Character, Garment};

/// Parts of the body so near to the garment are felt, metres.
const REACH: f64 = 0.3;

/// A garment at rest, and what draping did to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Rest {
    /// The garment as it hangs.
    pub garment: Garment,
    /// The farthest a vertex moved, metres.
    pub moved: f64,
    /// Changes of edge length over edge length: 95th percentile and largest.
    pub strain: [f64; 2],
}

/// Hangs the garment on the character's canonical pose.
pub fn drape(character: &Character, garment: &Garment) -> Result<Rest> {
    // What a cape falls onto is far from where it was cut.
    let settings = Settings { attached: garment.pins.clone(), reach: REACH, ..Settings::default() };
    let positions = Simulator::new(character, garment, Material::default(), settings)?.drape()?;
    let before = &garment.mesh.positions;
    let moved = positions.iter().zip(before).map(|(now, then)| now.distance(*then)).fold(0.0, f64::max);
    let edges = garment.mesh.triangles.iter().flat_map(|t| (0..3).map(move |k| [t[k], t[(k + 1) % 3]]));
    let strain = |[a, b]: [u32; 2]| {
        let length = |positions: &[glam::DVec3]| positions[a as usize].distance(positions[b as usize]);
        (length(&positions) / length(before) - 1.0).abs()
    };
    let strains = Sorted::new(edges.map(strain));
    let strain = [strains.percentile(95), strains.greatest()];
    let mut garment = garment.clone();
    garment.mesh.positions = positions;
    Ok(Rest { garment, moved, strain })
}
