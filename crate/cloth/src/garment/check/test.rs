//! Garments spoilt in one way each: the check names the fault and the file's vertices.

use super::*;
use crate::garment::test::person;
use crate::garment::{Cut, Kind, shell};
use ctsn_rig::{Drawn, Mesh};
use glam::DVec3;

/// A person and a sound skirt.
fn scene() -> (Character, Garment) {
    let person = person();
    let cut = Cut { kind: Some(Kind::Skirt), vertices: Some(600), ..Cut::default() };
    let skirt = shell(&person, &cut).unwrap();
    (person, skirt)
}

/// What is found in a mesh whose file numbers its vertices from 100.
fn findings(character: &Character, mesh: Mesh) -> Findings {
    let numbers = (100..100 + mesh.positions.len() as u32).collect();
    let source = Source { numbers, ..Source::default() };
    check(character, &Garment { mesh, ..Garment::default() }, &source).unwrap()
}

/// Asserts that one message of the list holds all words.
fn assert_says(messages: &[String], words: &[&str]) {
    assert!(messages.iter().any(|message| words.iter().all(|word| message.contains(word))), "{words:?}: {messages:?}");
}

#[test]
fn a_sound_garment_passes_without_a_word() {
    let (person, skirt) = scene();
    assert_eq!(findings(&person, skirt.mesh), Findings::default());
}

#[test]
fn a_garment_inside_out_is_refused() {
    let (person, mut skirt) = scene();
    skirt.mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    assert_says(&findings(&person, skirt.mesh).errors, &["inside out", "100 %", "flip"]);
}

#[test]
fn scales_and_places_that_cannot_be_are_refused() {
    let (person, skirt) = scene();
    let scaled = |factor: f64| Mesh {
        positions: skirt.mesh.positions.iter().map(|p| *p * factor).collect(),
        triangles: skirt.mesh.triangles.clone(),
    };
    assert_says(&findings(&person, scaled(0.01)).errors, &["scale", "100 times too small"]);
    assert_says(&findings(&person, scaled(100.0)).errors, &["scale", "100 times too large"]);
    let mut away = skirt.mesh.clone();
    away.positions.iter_mut().for_each(|p| *p += DVec3::X * 3.0);
    assert_says(&findings(&person, away).errors, &["place", "from the body"]);
}

#[test]
fn what_is_held_may_hang_anywhere() {
    let (person, skirt) = scene();
    let mut long = skirt.clone();
    long.mesh.positions.iter_mut().for_each(|p| p.z = if p.y < 1.0 { p.z + 2.0 * (1.0 - p.y) } else { p.z });
    let source = Source { numbers: (0..long.mesh.positions.len() as u32).collect(), ..Source::default() };
    let place = |garment: &Garment| {
        let found = check(&person, garment, &source).unwrap();
        found.errors.iter().any(|message| message.contains("place"))
    };
    assert!(!skirt.pins.is_empty() && !place(&long));
    assert!(place(&Garment { pins: Vec::new(), ..long }));
}

#[test]
fn cloth_inside_the_body_is_named_by_vertex() {
    let (person, skirt) = scene();
    let mut tight = skirt.mesh.clone();
    let deepest = tight.positions.iter().position(|p| p.y > 0.9 && p.x > 0.1).unwrap();
    tight.positions[deepest] = DVec3::new(0.0, 1.0, 0.0);
    let found = findings(&person, tight);
    assert_says(&found.warnings, &["inside the body", &format!("first: {}", 100 + deepest)]);
    let mut shrunk = skirt.mesh.clone();
    shrunk.positions.iter_mut().for_each(|p| (p.x, p.z) = (0.4 * p.x, 0.4 * p.z));
    assert_says(&findings(&person, shrunk).errors, &["fit", "inside the body"]);
}

#[test]
fn duplicated_faces_and_crowded_edges_are_refused() {
    let (person, skirt) = scene();
    let mut doubled = skirt.mesh.clone();
    let [a, b, c] = doubled.triangles[7];
    doubled.triangles.push([b, c, a]);
    let found = findings(&person, doubled);
    assert_eq!(found.errors.len(), 1, "{found:?}");
    assert_says(&found.errors, &["duplicated", &format!("{}-{}-{}", b + 100, c + 100, a + 100)]);
    let mut crowded = skirt.mesh.clone();
    crowded.positions.push(crowded.positions[a as usize] * 1.2);
    let extra = crowded.positions.len() as u32 - 1;
    crowded.triangles.push([a, b, extra]);
    assert_says(
        &findings(&person, crowded).errors,
        &["non-manifold", &format!("{}-{}", a.min(b) + 100, a.max(b) + 100)],
    );
    let mut turned = skirt.mesh.clone();
    turned.triangles[7].swap(0, 1);
    assert_says(&findings(&person, turned).errors, &["opposite ways"]);
}

#[test]
fn holes_and_loose_pieces_are_remarked_upon() {
    let (person, skirt) = scene();
    let mut torn = skirt.mesh.clone();
    let middle = (0..torn.triangles.len())
        .find(|&t| torn.triangles[t].iter().all(|&v| (0.6..0.9).contains(&torn.positions[v as usize].y)));
    let [a, b, c] = torn.triangles.remove(middle.unwrap());
    let found = findings(&person, torn);
    assert!(found.errors.is_empty(), "{found:?}");
    assert_says(
        &found.warnings,
        &["hole of 3 edges", &(a + 100).to_string(), &(b + 100).to_string(), &(c + 100).to_string()],
    );
    let mut buttoned = skirt.mesh.clone();
    let first = buttoned.positions.len() as u32;
    buttoned.positions.extend([[0.4, 0.7, 0.3], [0.43, 0.7, 0.3], [0.4, 0.73, 0.3]].map(DVec3::from));
    buttoned.triangles.push([first, first + 1, first + 2]);
    assert_says(
        &findings(&person, buttoned).warnings,
        &["2 pieces", &format!("3 vertices with vertex {}", first + 100)],
    );
}

#[test]
fn thin_faces_are_remarked_upon_where_someone_drew_them() {
    let (person, mut skirt) = scene();
    let [a, b, _] = skirt.mesh.triangles[skirt.mesh.triangles.len() / 2].map(|vertex| vertex as usize);
    let [from, to] = [a, b].map(|vertex| skirt.mesh.positions[vertex]);
    skirt.mesh.positions[a] = to.lerp(from, 0.05);
    assert_says(&findings(&person, skirt.mesh.clone()).warnings, &["thin faces", &(a + 100).to_string()]);
    let source = Source { numbers: (0..skirt.mesh.positions.len() as u32).collect(), ..Source::default() };
    let own = Garment { mesh: skirt.mesh, drawn: Some(Drawn::default()), ..Garment::default() };
    assert_eq!(check(&person, &own, &source).unwrap(), Findings::default());
}

#[test]
fn a_list_names_each_vertex_once() {
    let numbers = [14, 14, 15, 16, 14, 17, 18, 19, 20, 20];
    let named = list(numbers.iter().map(u32::to_string));
    assert_eq!(named, "14, 15, 16, 17, 18, 19, … (7 in all)");
}
