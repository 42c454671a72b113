use ctsn_author::{dataset::*, gltf, ground_truth::*, render, simulate::body_frame};
use std::path::Path;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let c = gltf::read_character(Path::new(&a[1]), a[3].parse().unwrap()).unwrap();
    let s = Setup::read(Path::new(&a[2])).unwrap().unwrap();
    for cf in &a[4..] {
        let (cl, fr) = cf.split_once(':').unwrap();
        let (cl, fr): (usize, usize) = (cl.parse().unwrap(), fr.parse().unwrap());
        let pose = &c.clips[cl].poses[fr];
        let sample = Sample::read(&pose_path(Path::new(&a[2]), cl, fr), c.joints.len(), s.template.len() / 3).unwrap();
        let back = body_frame(&c, pose).inverse();
        let v: Vec<_> = vertices(&sample.truth).into_iter().map(|x| back.transform_point3(x)).collect();
        render::render_dressed(
            &c,
            pose,
            Some((&v, s.triangles.as_chunks::<3>().0)),
            Path::new(&format!("{}_{cl}_{fr}.png", a[2])),
        )
        .unwrap();
    }
}
