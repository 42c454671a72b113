//! A sheet is found in cloth of two layers with pockets, meshed evenly, and what was drawn rides on it where it was.

use super::layers::{Layer, layers};
use super::{Resample, resample};
use crate::garment::check::{Fitted, Outside, fit_beside};
use crate::garment::quality;
use crate::garment::test::person;
use ctsn_rig::gltf::Source;
use ctsn_rig::mesh::{Edges, triangle};
use ctsn_rig::{Character, Drawn, Garment, Mesh, Surface};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;
use std::sync::LazyLock;

static PERSON: LazyLock<Character> = LazyLock::new(person);
static OUTSIDE: LazyLock<Outside> = LazyLock::new(|| Outside::new(&PERSON).unwrap());

/// Adds a grid of vertices, closed in the direction of `around`, and its triangles.
fn grid(mesh: &mut Mesh, [around, along]: [u32; 2], closed: bool, place: impl Fn(u32, u32) -> DVec3) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend((0..=along).flat_map(|row| (0..around).map(move |i| (row, i))).map(|(row, i)| place(row, i)));
    for row in 0..along {
        for i in 0..if closed { around } else { around - 1 } {
            let at = |row: u32, i: u32| first + row * around + i % around;
            let [a, b, c, d] = [at(row, i), at(row, i + 1), at(row + 1, i), at(row + 1, i + 1)];
            mesh.triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
}

/// Where the waist of the person is, and the radius of a tube around it, metres.
fn waist() -> (DVec3, f64) {
    let [low, high] = PERSON.body.mesh.bounds();
    let height = low.y + 0.55 * (high.y - low.y);
    let near = PERSON.body.mesh.positions.iter().filter(|p| (p.y - height).abs() < 0.05);
    let trunk: Vec<DVec3> = near.copied().filter(|p| p.x.abs() < 0.12 * (high.y - low.y)).collect();
    let centre = trunk.iter().sum::<DVec3>() / trunk.len() as f64;
    let centre = DVec3::new(centre.x, height, centre.z);
    let radius = trunk.iter().map(|p| (*p - centre).with_y(0.0).length()).fold(0.0, f64::max);
    (centre, radius + 0.02)
}

/// A skirt of `around` by `along` quads a layer, its lining 3 mm inside it, joined at waist and hem, with two pockets
/// of `pocket` by `pocket` quads 2 mm outside it.
fn skirt(around: u32, along: u32, pocket: u32) -> Garment {
    let (centre, radius) = waist();
    let tube = move |radius: f64, turn: f64, down: f64| {
        let wide = radius + 0.1 * down;
        centre + DVec3::new(wide * (TAU * turn).sin(), -0.4 * down, wide * (TAU * turn).cos())
    };
    let mut mesh = Mesh::default();
    let rows = 2 * along + 1;
    // Down the outside, and up the inside.
    grid(&mut mesh, [around, rows], true, |row, i| {
        let (layer, down) = if row <= along { (0.0, row) } else { (0.003, rows - row) };
        tube(radius - layer, f64::from(i) / f64::from(around), f64::from(down) / f64::from(along))
    });
    // At the waist, too.
    for i in 0..around {
        let [a, b] = [i, (i + 1) % around];
        let [c, d] = [a, b].map(|v| v + rows * around);
        mesh.triangles.extend([[a, b, c], [b, d, c]]);
    }
    for side in [0.2, 0.7] {
        grid(&mut mesh, [pocket, pocket], false, |row, i| {
            let [turn, down] = [i, row].map(|at| f64::from(at) / f64::from(pocket));
            tube(radius + 0.002, side + 0.1 * turn, 0.2 + 0.3 * down)
        });
    }
    let count = mesh.positions.len() as u32;
    let uv = mesh.positions.iter().map(|p| DVec2::new(p.x, p.y)).collect();
    let surface = Surface { vertex: (0..count).collect(), uv, triangles: mesh.triangles.clone(), colour: Vec::new() };
    Garment { mesh, surface, pins: (0..around).collect(), drawn: None }
}

fn source(garment: &Garment) -> Source {
    Source { numbers: (0..garment.mesh.positions.len() as u32).collect(), ..Source::default() }
}

/// Where the riders are on the cloth.
fn laid(drawn: &Drawn, cloth: &Mesh) -> Vec<DVec3> {
    let normals = cloth.normals(&cloth.positions);
    let lay = |rider: &ctsn_rig::Rider| {
        let [u, v, w, offset] = rider.coordinates;
        let places = rider.corners.map(|v| cloth.positions[v as usize]);
        let normal = triangle::point(rider.corners.map(|v| normals[v as usize]), [u, v, w]).normalize();
        triangle::point(places, [u, v, w]) + offset * normal
    };
    drawn.riders.iter().map(lay).collect()
}

#[test]
fn lining_and_pockets_are_told_from_the_sheet() {
    let garment = skirt(80, 40, 8);
    let found = layers(&garment.mesh, &OUTSIDE);
    let of = |face: usize| {
        let highest = garment.mesh.triangles[face].iter().max().copied().unwrap_or(0);
        let lowest = garment.mesh.triangles[face].iter().min().copied().unwrap_or(0);
        match (highest < 41 * 80, lowest >= 82 * 80) {
            (true, _) => Layer::Sheet,
            (_, true) => Layer::Trimming,
            _ => Layer::Inner,
        }
    };
    let wrong = (0..found.len()).filter(|face| found[*face] != of(*face)).count();
    assert_eq!(wrong, 0, "of {}", found.len());
}

#[test]
fn two_layers_with_pockets_ride_on_one_even_sheet() {
    let garment = skirt(150, 70, 12);
    assert!(garment.mesh.positions.len() > 20_000);
    let mut said = Vec::new();
    let (even, numbers) = resample(&OUTSIDE, garment.clone(), source(&garment), Resample::Auto, &mut said);
    assert_eq!((said.len(), numbers.numbers.len()), (1, even.mesh.positions.len()), "{said:?}");
    let found = quality(&even.mesh);
    assert!(found.manifold && found.components == 1 && found.loops == 2, "{found:?}");
    assert!((0.008..0.0155).contains(&found.edge) && found.spread[3] < 1.9 && found.spread[1] > 0.6, "{found:?}");
    assert!((3_000..5_000).contains(&found.vertices), "{found:?}");
    // The waist is held as before, by a ring of vertices.
    let rims = Edges::new(&even.mesh.triangles).rims();
    let waist = rims.iter().map(Vec::len).find(|edges| *edges == even.pins.len());
    assert!(waist.is_some(), "{} pins, rims {:?}", even.pins.len(), rims.iter().map(Vec::len).collect::<Vec<_>>());
    let drawn = even.drawn.as_ref().unwrap();
    let off = laid(drawn, &even.mesh).into_iter().zip(&garment.mesh.positions).map(|(a, b)| a.distance(*b));
    let off = off.fold(0.0, f64::max);
    assert!(off < 1e-4, "a drawn vertex is {off} m from where it was");
    assert_eq!(drawn.surface, garment.surface);
}

#[test]
fn what_is_coarse_is_drawn_as_finely_as_it_is_simulated() {
    let mut garment = skirt(16, 6, 2);
    // One layer of it: a grid of long edges.
    garment.mesh.triangles.truncate(2 * 16 * 6);
    garment.surface.triangles.truncate(2 * 16 * 6);
    let mut said = Vec::new();
    let (even, _) = resample(&OUTSIDE, garment.clone(), source(&garment), Resample::Edge(0.012), &mut said);
    let drawn = even.drawn.as_ref().unwrap();
    let places = laid(drawn, &even.mesh);
    let vertex = |corner: u32| places[drawn.surface.vertex[corner as usize] as usize];
    let longest = drawn.surface.triangles.iter().map(|face| face.map(vertex));
    let longest = longest.map(|[a, b, c]| a.distance(b).max(b.distance(c)).max(c.distance(a))).fold(0.0, f64::max);
    assert!(longest < 0.022, "{longest}");
    assert_eq!(drawn.surface.uv.len(), drawn.surface.vertex.len());
    // The artist's vertices come first, and stay where they were.
    let used: Vec<usize> = garment.mesh.triangles.iter().flatten().map(|&v| v as usize).collect();
    let off = used.iter().map(|&v| places[v].distance(garment.mesh.positions[v])).fold(0.0, f64::max);
    assert!(off < 5e-4, "{off}");
}

#[test]
fn a_mesh_finer_than_can_be_simulated_is_as_fine_as_can_be() {
    let mut garment = skirt(16, 6, 2);
    garment.mesh.triangles.truncate(2 * 16 * 6);
    garment.surface.triangles.truncate(2 * 16 * 6);
    let mut said = Vec::new();
    let (even, _) = resample(&OUTSIDE, garment.clone(), source(&garment), Resample::Edge(0.004), &mut said);
    assert!((8_000..11_000).contains(&even.mesh.positions.len()), "{said:?}");
    assert!(said[0].contains("edges of 4 mm would be") && said[0].contains("at most 10000 are simulated"), "{said:?}");
}

#[test]
fn an_even_mesh_and_one_of_ours_stay_as_they_are() {
    let mut said = Vec::new();
    let layered = skirt(40, 20, 4);
    let (even, numbers) = resample(&OUTSIDE, layered.clone(), source(&layered), Resample::Auto, &mut said);
    let even = Garment { drawn: None, ..even };
    said.clear();
    let same = resample(&OUTSIDE, even.clone(), numbers.clone(), Resample::Auto, &mut said);
    assert_eq!((same, said.len()), ((even, numbers), 0));
    let own = Source { own: true, ..source(&layered) };
    for (source, wanted) in [(own, Resample::Auto), (source(&layered), Resample::Never)] {
        let same = resample(&OUTSIDE, layered.clone(), source.clone(), wanted, &mut said);
        assert_eq!((same, said.len()), ((layered.clone(), source), 0));
    }
}

#[test]
fn what_is_asked_for_is_read_and_said() {
    for text in ["auto", "never", "12"] {
        assert_eq!(text.parse::<Resample>().unwrap().to_string(), text);
    }
    for text in ["", "12mm", "0.012", "NaN", "-3", "1000"] {
        assert!(text.parse::<Resample>().unwrap_err().contains("wanted auto, never"), "{text}");
    }
}

#[test]
fn a_layered_garment_is_fit_to_be_simulated() {
    let garment = skirt(150, 70, 12);
    let Fitted { garment, mended, .. } =
        fit_beside(&OUTSIDE, garment.clone(), source(&garment), Resample::Auto, Vec::new()).unwrap();
    assert!(mended.iter().any(|said| said.contains("even mesh of its own")), "{mended:?}");
    let drawn = garment.drawn.unwrap();
    let count = garment.mesh.positions.len() as u32;
    assert!(drawn.riders.iter().all(|rider| rider.corners.iter().all(|&corner| corner < count)));
}
