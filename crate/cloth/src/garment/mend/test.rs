//! Garments spoilt in one way each are mended, and that is said; those that are spoilt anyhow are either fit to be
//! simulated afterwards or refused.

use crate::garment::check::{Fitted, Outside, SLIVER, fit_beside};
use crate::garment::test::person;
use crate::garment::{Cut, Kind, Resample, fit, quality, rehearse, shell};
use crate::simulate::{Elements, Material, Settings, Simulator};
use ctsn_rig::gltf::Source;
use ctsn_rig::mesh::triangle::least_angle;
use ctsn_rig::{Character, Garment, Mesh};
use glam::DVec3;
use std::sync::LazyLock;

/// A person, and garments with and without something that holds them.
static PERSON: LazyLock<Character> = LazyLock::new(person);
static OUTSIDE: LazyLock<Outside> = LazyLock::new(|| Outside::new(&PERSON).unwrap());
static SKIRT: LazyLock<Garment> = LazyLock::new(|| cut(Kind::Skirt));
static SHIRT: LazyLock<Garment> = LazyLock::new(|| cut(Kind::Tshirt));

fn cut(kind: Kind) -> Garment {
    shell(&PERSON, &Cut { kind: Some(kind), vertices: Some(600), ..Cut::default() }).unwrap()
}

fn fitted(garment: Garment) -> crate::Result<Fitted> {
    let numbers = (100..100 + garment.mesh.positions.len() as u32).collect();
    fit_beside(&OUTSIDE, garment, Source { numbers, ..Source::default() }, Resample::Never, Vec::new())
}

/// The sound garment after `spoil`, mended; what was said must hold all words.
#[track_caller]
fn mended(garment: &Garment, spoil: impl FnOnce(&mut Mesh), words: &[&str]) -> Garment {
    let mut spoilt = garment.clone();
    spoilt.surface = Default::default();
    spoil(&mut spoilt.mesh);
    let fitted = fitted(spoilt).expect("mended");
    let said = fitted.mended.iter().any(|said| words.iter().all(|word| said.contains(word)));
    assert!(said, "{words:?}: {:?}", fitted.mended);
    fitted.garment
}

/// A face of the garment's middle.
fn middle(mesh: &Mesh) -> usize {
    let [low, high] = mesh.bounds();
    let inner = |t: &[u32; 3]| {
        t.iter().all(|&v| {
            let share = (mesh.positions[v as usize].y - low.y) / (high.y - low.y);
            (0.4..0.6).contains(&share)
        })
    };
    mesh.triangles.iter().position(inner).unwrap()
}

#[test]
fn a_sound_garment_stays_as_it_is() {
    for garment in [&*SKIRT, &*SHIRT] {
        let fitted = fitted(garment.clone()).unwrap();
        assert_eq!(fitted.garment, *garment);
        assert!(fitted.mended.is_empty() && fitted.warnings.is_empty(), "{fitted:?}");
    }
}

#[test]
fn turned_faces_are_turned_back() {
    let found = mended(&SKIRT, |mesh| mesh.triangles.iter_mut().step_by(9).for_each(|t| t.swap(0, 1)), &["turned"]);
    assert!(quality(&found.mesh).manifold);
    let found =
        mended(&SHIRT, |mesh| mesh.triangles.iter_mut().for_each(|t| t.swap(0, 1)), &["right side out", "100 %"]);
    let same = |t: &[u32; 3]| {
        SHIRT.mesh.triangles.iter().any(|u| (0..3).any(|k| [t[k], t[(k + 1) % 3], t[(k + 2) % 3]] == *u))
    };
    assert!(found.mesh.triangles.iter().all(same));
}

#[test]
fn copies_and_crowded_edges_are_cut_away() {
    let [a, b, c] = SKIRT.mesh.triangles[7];
    let found = mended(
        &SKIRT,
        |mesh| mesh.triangles.push([b, c, a]),
        &["duplicated", &format!("{}-{}-{}", b + 100, c + 100, a + 100)],
    );
    assert_eq!(found.mesh, SKIRT.mesh);
    let [a, b, _] = SKIRT.mesh.triangles[middle(&SKIRT.mesh)];
    let flap = |mesh: &mut Mesh| {
        let middle = 0.5 * (mesh.positions[a as usize] + mesh.positions[b as usize]);
        mesh.positions.push(middle + middle.with_y(0.0).normalize() * 0.03);
        mesh.triangles.push([a, b, mesh.positions.len() as u32 - 1]);
    };
    let found = mended(&SKIRT, flap, &["more than two faces", &format!("{}-{}", a.min(b) + 100, a.max(b) + 100)]);
    assert_eq!(found.mesh.positions.len(), SKIRT.mesh.positions.len() + 3);
    assert!(quality(&found.mesh).manifold);
}

#[test]
fn slivers_are_closed_and_holes_filled() {
    let at = middle(&SKIRT.mesh);
    let [a, b, c] = SKIRT.mesh.triangles[at];
    // A corner on the middle of a side, which the face beyond does not know of.
    let junction = |mesh: &mut Mesh| {
        let middle = 0.5 * (mesh.positions[a as usize] + mesh.positions[b as usize]);
        mesh.positions.push(middle);
        let new = mesh.positions.len() as u32 - 1;
        mesh.triangles[at] = [a, new, c];
        mesh.triangles.extend([[new, b, c], [a, b, new]]);
        let aside = 1e-4 * (mesh.positions[c as usize] - middle);
        mesh.positions[new as usize] += aside;
    };
    let found = mended(&SKIRT, junction, &["slivers", &format!("{}-{}-", a + 100, b + 100)]);
    assert!(quality(&found.mesh).manifold);
    let needle = |mesh: &mut Mesh| {
        let way = mesh.positions[b as usize] - mesh.positions[a as usize];
        mesh.positions.push(mesh.positions[a as usize] + 1e-3 * way);
        let new = mesh.positions.len() as u32 - 1;
        mesh.triangles[at] = [new, b, c];
        mesh.triangles.push([a, new, c]);
    };
    // The hole beside a needle, closed with it, leaves the skirt as it was.
    let found = mended(&SKIRT, needle, &["slivers"]);
    assert_eq!(found.mesh.triangles.len(), SKIRT.mesh.triangles.len());
    let found = mended(
        &SKIRT,
        |mesh| mesh.triangles.retain(|face| *face != [a, b, c]),
        &["holes closed", &(a + 100).to_string()],
    );
    assert_eq!(found.mesh.triangles.len(), SKIRT.mesh.triangles.len());
    assert!(quality(&found.mesh).manifold);
}

#[test]
fn tight_cloth_is_lifted_and_crossed_cloth_smoothed_apart() {
    let tight = |mesh: &mut Mesh| {
        let front = mesh.positions.iter_mut().filter(|p| p.y > 0.95 && p.z > 0.02);
        front.for_each(|p| p.z -= 0.035);
    };
    let found = mended(&SKIRT, tight, &["lifted out of the body"]);
    rehearse(&PERSON, &found, 0.0).expect("a drape");
    let crossed = |mesh: &mut Mesh| {
        // A corner folded far over the face beyond, whose own corner is drawn through it.
        let [a, b, c] = mesh.triangles[middle(mesh)];
        let beyond = mesh.triangles.iter().find(|t| t.contains(&b) && t.contains(&c) && !t.contains(&a)).unwrap();
        let far = *beyond.iter().find(|v| ![b, c].contains(v)).unwrap() as usize;
        let side = 0.5 * (mesh.positions[b as usize] + mesh.positions[c as usize]);
        let out = side.with_y(0.0).normalize();
        mesh.positions[far] += 0.03 * out;
        let corner = &mut mesh.positions[a as usize];
        *corner += 3.5 * (side - *corner) + 0.01 * out;
    };
    let found = mended(&SKIRT, crossed, &["crossed", "0 are left"]);
    assert!(
        Elements::new(&found.mesh.triangles, found.mesh.positions.len()).crossings(&found.mesh.positions).is_empty()
    );
}

#[test]
fn a_waistband_is_found_and_what_falls_is_refused() {
    let bare = Garment { pins: Vec::new(), ..SKIRT.clone() };
    let found = fitted(bare.clone()).unwrap();
    assert_eq!(found.garment.pins, SKIRT.pins);
    assert!(found.mended[0].contains("waistband"), "{:?}", found.mended);
    assert!(fitted(SHIRT.clone()).unwrap().garment.pins.is_empty());
    let mut wide = bare;
    wide.mesh.positions.iter_mut().for_each(|p| (p.x, p.z) = (1.6 * p.x, 1.6 * p.z));
    let message = fitted(wide).unwrap_err().to_string();
    assert!(message.contains("would fall") && message.contains("_PIN"), "{message}");
}

/// The person without the skin that a garment covers: no trunk, no upper arms.
fn hollow() -> Character {
    let mut hollow = PERSON.clone();
    let bare = |name: &str| ["hip", "chest", "arm.l", "arm.r"].contains(&name);
    hollow.body = PERSON.body.part(|joint| !bare(&PERSON.joints[joint].name));
    hollow
}

/// Numbers of a file that counts from 0.
fn plain(garment: &Garment) -> Source {
    Source { numbers: (0..garment.mesh.positions.len() as u32).collect(), ..Source::default() }
}

#[test]
fn a_body_is_made_where_skin_is_missing() {
    let mut sound = PERSON.clone();
    fit(&mut sound, SHIRT.clone(), plain(&SHIRT), Resample::Never).expect("a fit");
    assert_eq!(sound.body, PERSON.body, "nothing was missing");
    let mut hollow = hollow();
    let before = hollow.body.clone();
    let fitted = fit(&mut hollow, SHIRT.clone(), plain(&SHIRT), Resample::Never).expect("a fit");
    let said = &fitted.mended[0];
    for word in ["no skin", "hip", "chest", "--body"] {
        assert!(said.contains(word), "{word}: {said}");
    }
    assert!(!said.contains("head") && !said.contains("shin.l"), "{said}");
    let made = Mesh {
        positions: hollow.body.mesh.positions.clone(),
        triangles: hollow.body.mesh.triangles[before.mesh.triangles.len()..].to_vec(),
    };
    let chest = DVec3::new(0.0, 1.3, 0.0);
    let angle: f64 = made.corners().map(|corners| ctsn_rig::mesh::triangle::solid_angle(chest, corners)).sum();
    assert!((angle - 4.0 * std::f64::consts::PI).abs() < 1e-6, "around the chest, and right side out");
    for row in &hollow.body.weights[before.weights.len()..] {
        let sum: f64 = row.iter().map(|(_, weight)| weight).sum();
        assert!((sum - 1.0).abs() < 1e-9 && row.iter().all(|(joint, _)| *joint < hollow.joints.len()));
    }
}

#[test]
fn plugs_that_hide_a_missing_body_are_opened() {
    let edges = ctsn_rig::mesh::Edges::new(&SHIRT.mesh.triangles);
    let mut bag = Garment { surface: Default::default(), ..SHIRT.clone() };
    // Every opening but the collar is closed by a cone.
    for rim in edges.rims().iter().filter(|rim| SHIRT.mesh.positions[rim[0][0] as usize].y < 1.4) {
        let ends = rim.iter().map(|edge| SHIRT.mesh.positions[edge[0] as usize]);
        let apex = ends.clone().sum::<DVec3>() / rim.len() as f64;
        let inwards = (DVec3::new(0.0, 1.25, 0.0) - apex).normalize();
        bag.mesh.positions.push(apex + 0.02 * inwards);
        let apex = bag.mesh.positions.len() as u32 - 1;
        bag.mesh.triangles.extend(rim.iter().map(|[a, b]| [*b, *a, apex]));
    }
    assert!(bag.mesh.triangles.len() > SHIRT.mesh.triangles.len() + 30);
    let numbers = plain(&bag);
    let fitted = fit(&mut hollow(), bag, numbers, Resample::Never).expect("a fit");
    assert!(fitted.mended[0].contains("3 openings"), "{:?}", fitted.mended);
    assert_eq!(fitted.garment.mesh.triangles.len(), SHIRT.mesh.triangles.len());
}

/// Spoils a garment in some of nine ways.
fn mutate(garment: &Garment, seed: u64) -> Garment {
    let mut rng = fastrand::Rng::with_seed(seed);
    let mut garment = Garment { surface: Default::default(), ..garment.clone() };
    for _ in 0..rng.usize(1..4) {
        let mesh = &mut garment.mesh;
        let (vertices, faces) = (mesh.positions.len(), mesh.triangles.len());
        let (face, vertex) = (rng.usize(..faces), rng.usize(..vertices));
        let mut step = || DVec3::from_array([0; 3].map(|_| rng.f64() - 0.5));
        match step().x.abs() * 18.0 {
            x if x < 1.0 => mesh.triangles[face].swap(0, 2),
            x if x < 2.0 => drop(mesh.triangles.swap_remove(face)),
            x if x < 3.0 => mesh.triangles.push(mesh.triangles[face]),
            x if x < 4.0 => mesh.positions[vertex] += 0.1 * step(),
            x if x < 5.0 => {
                mesh.positions[mesh.triangles[face][0] as usize] =
                    mesh.positions[mesh.triangles[face][1] as usize] + 1e-4 * step()
            }
            x if x < 6.0 => mesh.triangles.push([mesh.triangles[face][0], mesh.triangles[face][1], vertex as u32]),
            x if x < 7.0 => garment.pins.clear(),
            x if x < 8.0 => {
                let (centre, push) = (mesh.positions[vertex], 0.08 * step());
                mesh.positions.iter_mut().filter(|p| p.distance(centre) < 0.06).for_each(|p| *p += push);
            }
            _ => mesh.triangles.iter_mut().for_each(|t| t.swap(0, 1)),
        }
    }
    garment.mesh.triangles.retain(|[a, b, c]| a != b && b != c && c != a);
    garment
}

#[test]
fn what_the_check_accepts_can_be_simulated() {
    let (mut accepted, rounds) = (0, 24);
    for seed in 0..rounds {
        let garment = mutate(if seed % 2 == 0 { &SKIRT } else { &SHIRT }, seed);
        let Ok(Fitted { garment, .. }) = fitted(garment) else { continue };
        accepted += 1;
        let mesh = &garment.mesh;
        assert!(quality(mesh).manifold, "{seed}");
        assert!(mesh.corners().all(|corners| least_angle(corners) >= SLIVER), "{seed}");
        assert!(Elements::new(&mesh.triangles, mesh.positions.len()).crossings(&mesh.positions).is_empty(), "{seed}");
        let settings = Settings { attached: garment.pins.clone(), ..Settings::default() };
        Simulator::new(&PERSON, &garment, Material::default(), settings).expect("a simulator");
        if seed % 12 < 1 {
            rehearse(&PERSON, &garment, 0.0).unwrap_or_else(|error| panic!("{seed}: {error}"));
        }
    }
    assert!(accepted > rounds / 3, "only {accepted} of {rounds} were accepted");
}
