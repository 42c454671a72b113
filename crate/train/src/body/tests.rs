//! What spans two limbs and what the cloth does not feel is no part of the body a model carries.

use super::cut::landmarks_first;
use super::*;
use crate::synthetic;
use ctsn_core::cpu::repair::collide::LANDMARKS;
use glam::DVec3;

#[test]
fn what_spans_two_limbs_is_dropped() {
    let (setup, mut samples) = synthetic::dataset(120, 2, 2);
    let character = setup.character().unwrap();
    let mut skin = character.body.clone();
    let half = skin.weights.len() / 2;
    (0..skin.weights.len()).for_each(|i| skin.weights[i] = vec![(usize::from(i >= half), 1.0)]);
    let torn = |samples: &[Sample]| {
        let mut skin = skin.clone();
        tear(&mut skin, &character, &samples.iter().collect::<Vec<_>>().iter().collect::<Vec<_>>());
        skin.mesh.triangles
    };
    assert_eq!(torn(&samples), skin.mesh.triangles);
    // The second joint leaves by five metres, in one pose of two.
    samples[1].joints[12 + 7] += 5.0;
    let one = |triangle: &&[u32; 3]| triangle.iter().all(|i| (*i as usize >= half) == (triangle[0] as usize >= half));
    let kept: Vec<[u32; 3]> = skin.mesh.triangles.iter().filter(one).copied().collect();
    assert!(kept.len() < skin.mesh.triangles.len());
    assert_eq!(torn(&samples), kept);
}

#[test]
fn what_the_cloth_does_not_feel_is_no_obstacle() {
    let (mut setup, samples) = synthetic::dataset(400, 6, 2);
    // Cloth around the lowest 0.45 m of 1.5.
    setup.template.iter_mut().skip(1).step_by(3).for_each(|height| *height *= 0.3);
    let body = body(&setup, &samples.iter().collect::<Vec<_>>(), &[]).unwrap();
    let top = body.rest.iter().skip(1).step_by(3).fold(0.0, |top: f32, height| top.max(*height));
    assert!((0.7..1.1).contains(&top), "kept up to {top} m");
}

#[test]
fn landmarks_lie_evenly() {
    let line: Vec<DVec3> = (0..1000).map(|i| DVec3::X * f64::from(i)).collect();
    let mut list: Vec<usize> = (0..line.len()).collect();
    landmarks_first(&line, &mut list);
    let mut landmarks = list[..LANDMARKS].to_vec();
    landmarks.sort_unstable();
    let widest = landmarks.windows(2).map(|pair| pair[1] - pair[0]).max().unwrap();
    // 1000 / 64, at most twice that after halving and halving.
    assert!((landmarks[0], landmarks[LANDMARKS - 1]) == (0, 999) && widest <= 32, "{landmarks:?}");
    list.sort_unstable();
    assert!(list.into_iter().eq(0..line.len()));
}
