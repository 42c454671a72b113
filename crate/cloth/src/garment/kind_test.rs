//! Every kind of garment: its openings, how far it reaches, where it is pinned.

use super::test::{assert_wearable, bounds_of, person, quadruped};
use super::*;
use crate::garment::kind::Build;
use clap::ValueEnum;

#[test]
fn every_kind_is_worn_by_some_body() {
    let builds = [Build::Upright, Build::Animal, Build::Limbless, Build::Rail];
    for kind in Kind::value_variants() {
        assert!(
            builds.iter().any(|build| build.kinds().contains(kind)),
            "{kind:?}: wanted it in a list of Build::kinds"
        );
        let name = kind.to_possible_value().expect("a kind on the command line");
        assert_eq!(name.get_name(), kind.name());
    }
}

/// A kind as the table has it.
fn kind(kind: Kind) -> Cut {
    Cut { kind: Some(kind), ..Cut::default() }
}

/// Makes a kind for the person: worn, with so many openings; heights of hem and top; pinned by a waistband or not.
fn made(what: Kind, loops: usize, bottom: [f64; 2], top: [f64; 2], pinned: bool) -> Garment {
    let person = person();
    let garment = shell(&person, &kind(what)).unwrap();
    let (low, high) = bounds_of(&garment);
    assert_wearable(&person, &garment, loops, 1.78 / 200.0);
    assert!((bottom[0]..bottom[1]).contains(&low.y) && (top[0]..top[1]).contains(&high.y), "{what:?} {low} {high}");
    assert_eq!(pinned, !garment.pins.is_empty(), "{what:?}");
    garment
}

#[test]
fn shirt_dress_and_trousers_have_their_own_openings_and_reach() {
    made(Kind::Tshirt, 4, [0.75, 0.95], [1.4, 1.6], false);
    made(Kind::Dress, 4, [0.4, 0.65], [1.4, 1.6], false);
    made(Kind::Trousers, 3, [0.05, 0.25], [0.95, 1.15], true);
}

#[test]
fn a_skirt_is_one_tube_that_widens_and_its_waistband_is_pinned() {
    let garment = made(Kind::Skirt, 2, [0.4, 0.65], [0.95, 1.15], true);
    let (low, high) = bounds_of(&garment);
    let ring = |y: f64| garment.mesh.positions.iter().filter(move |p| (p.y - y).abs() < 0.03);
    let width = |y: f64| ring(y).fold(0.0, |width: f64, p| width.max(p.x.abs()));
    assert!(width(low.y) > width(high.y) + 0.1, "{} {}", width(low.y), width(high.y));
    // Between the legs nothing: no cloth near the middle but in front and behind.
    assert!(ring(0.7).all(|p| p.x.abs() > 0.05 || p.z.abs() > 0.1));
    assert!(garment.pins.iter().all(|&v| garment.mesh.positions[v as usize].y > high.y - 0.03));
    assert!(garment.pins.len() > 20, "{}", garment.pins.len());
}

#[test]
fn a_robes_sleeves_are_wide_and_a_cape_leaves_the_front_open() {
    let robe = made(Kind::Robe, 4, [0.08, 0.3], [1.4, 1.6], true);
    let cuff = robe.mesh.positions.iter().filter(|p| p.x > 0.48);
    let (low, high) = cuff.fold((f64::MAX, f64::MIN), |(low, high), p| (low.min(p.y), high.max(p.y)));
    assert!(high - low > 0.14, "a cuff {low} to {high}, the arm is 0.09 thick");
    let cape = made(Kind::Cape, 1, [0.2, 0.5], [1.3, 1.6], true);
    // The person has no feet: either side may be the front, but only one is covered.
    let side = |sign: f64| cape.mesh.positions.iter().filter(|p| p.y < 1.2 && sign * p.z > 0.1).count();
    assert!(side(1.0).min(side(-1.0)) == 0 && side(1.0).max(side(-1.0)) > 500, "{} {}", side(1.0), side(-1.0));
}

#[test]
fn animals_wear_coats_vests_and_capes() {
    let quadruped = quadruped();
    for (what, loops) in [(Kind::Coat, 6), (Kind::Vest, 4), (Kind::Cape, 2)] {
        let garment = shell(&quadruped, &kind(what)).unwrap();
        assert_wearable(&quadruped, &garment, loops, 1.6 / 150.0);
        let (low, _) = bounds_of(&garment);
        assert_eq!(what == Kind::Vest, low.z > -0.3, "{what:?} {low}");
    }
    let refused = shell(&quadruped, &kind(Kind::Trousers)).unwrap_err().to_string();
    assert!(refused.contains("trousers") && refused.contains("coat, vest, cape"), "{refused}");
}
