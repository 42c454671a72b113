use ctsn_author::{gltf, simulate::*};
use std::path::Path;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let c = gltf::read_character(Path::new(&a[1]), a[3].parse().unwrap()).unwrap();
    let g = gltf::read_garment(Path::new(&a[2]), c.metres_per_unit).unwrap();
    let base = Settings::default();
    let base = &base;
    let variants: Vec<(&str, Settings)> = vec![
        ("s10", Settings { contact_stiffness: 1e6, ..base.clone() }),
        ("s10it2", Settings { contact_stiffness: 1e6, path_iterations: 2, ..base.clone() }),
        ("s30it2", Settings { contact_stiffness: 3e6, path_iterations: 2, ..base.clone() }),
    ];
    for (name, s) in variants {
        if a.len() > 5 && !a[5].split(',').any(|v| v == name) {
            continue;
        }
        let sim = Simulator::new(&c, &g, Material::default(), s).unwrap();
        let t = sim.drape().unwrap();
        for cf in a[4].split(';') {
            let (cl, fr) = cf.split_once(':').unwrap();
            let pose = &c.clip(cl).unwrap().poses[fr.parse::<usize>().unwrap()];
            let st = std::time::Instant::now();
            let o = sim.simulate(&t, pose);
            let mut d: Vec<f64> = vec![];
            d.push(o.residual);
            println!(
                "{name} {cf} res {:.4}: {:?} stretch {:.2} dist {:.1}mm it {} {:.1}s",
                o.residual,
                o.status,
                o.stretch_max,
                o.least_distance * 1e3,
                o.iterations,
                st.elapsed().as_secs_f64()
            );
        }
    }
}
