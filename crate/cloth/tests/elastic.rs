//! The elastic elements as a loss uses them: from outside the crate, energies against their gradients.

use ctsn_cloth::simulate::{Elastic, GRAVITY, Material};
use ctsn_rig::{Garment, Mesh};
use glam::DVec3;

/// A bent sheet of 4 × 3 quads of 2 cm.
fn garment() -> Garment {
    let place = |i: usize| DVec3::new((i % 5) as f64, (i / 5) as f64, 0.2 * (i % 5 % 2) as f64) * 0.02;
    let quad = |i: u32| [[i, i + 1, i + 5], [i + 1, i + 6, i + 5]];
    let quads = (0..3).flat_map(|row| (0..4).map(move |column| 5 * row + column));
    let mesh = Mesh { positions: (0..20).map(place).collect(), triangles: quads.flat_map(quad).collect() };
    Garment { mesh, ..Garment::default() }
}

fn elastic() -> Elastic {
    Elastic::new(&garment(), &Material::named("jersey").expect("jersey"), 0.5).expect("elements")
}

/// The sheet with every vertex moved by up to 4 mm along each axis.
fn shaken() -> Vec<DVec3> {
    let wave = |i: usize, k: f64| ((i as f64 + 1.0) * k).sin() * 0.004;
    let moved = |(i, at): (usize, &DVec3)| *at + DVec3::new(wave(i, 12.9), wave(i, 7.3), wave(i, 4.1));
    garment().mesh.positions.iter().enumerate().map(moved).collect()
}

type Energy = fn(&Elastic, &[DVec3], &mut [DVec3]) -> f64;

#[test]
fn gradients_are_those_of_the_energies() {
    let (elastic, x) = (elastic(), shaken());
    for (name, energy) in [("stretch", Elastic::stretch as Energy), ("bend", Elastic::bend), ("weigh", Elastic::weigh)]
    {
        // Added to what is there.
        let mut gradient = vec![DVec3::ONE; x.len()];
        energy(&elastic, &x, &mut gradient);
        let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
        for (i, axis) in (0..x.len()).flat_map(|i| (0..3).map(move |axis| (i, axis))) {
            let at = |by: f64| {
                let mut moved = x.clone();
                moved[i][axis] += by;
                energy(&elastic, &moved, &mut vec![DVec3::ZERO; x.len()])
            };
            let difference = (at(1e-6) - at(-1e-6)) / 2e-6;
            worst = worst.max((difference + 1.0 - gradient[i][axis]).abs());
            largest = largest.max(difference.abs());
        }
        assert!(largest > 1e-4 && worst < 1e-5 * largest, "{name}: off by {worst} of {largest} N");
    }
}

#[test]
fn energies_have_the_size_that_paper_and_pencil_give() {
    let (elastic, rest) = (elastic(), garment().mesh.positions);
    let none = || vec![DVec3::ZERO; rest.len()];
    assert!(elastic.stretch(&rest, &mut none()).abs() < 1e-18);
    // Half of its own folds are its rest, the other half is work.
    assert!(elastic.bend(&rest, &mut none()) > 0.0);
    let mass: f64 = elastic.masses.iter().sum();
    let area: f64 = elastic.triangles.iter().map(|triangle| triangle.area).sum();
    assert!((mass - 0.18 * area).abs() < 1e-12, "jersey has 0.18 kg/m², found {} kg on {area} m²", mass);
    let raised: Vec<DVec3> = rest.iter().map(|at| *at + DVec3::Y).collect();
    let work = elastic.weigh(&raised, &mut none()) - elastic.weigh(&rest, &mut none());
    assert!((work - mass * GRAVITY).abs() < 1e-9, "{work} J");
    // One per cent along the warp at fixed width: ½ A C₂₂ G², G = (1.01² - 1)/2, C₂₂ = 800/(1 - 0.2²) N/m.
    let longer: Vec<DVec3> = rest.iter().map(|at| DVec3::new(at.x, 1.01 * at.y, at.z)).collect();
    let strain = (1.01_f64.powi(2) - 1.0) / 2.0;
    let wanted = 0.5 * area * (800.0 / (1.0 - 0.2 * 0.2)) * strain * strain;
    let found = elastic.stretch(&longer, &mut none());
    assert!((found - wanted).abs() < 1e-9 * wanted.max(1.0), "wanted {wanted} J, found {found}");
}
