//! Numbers by which files remember what they were made of: xxHash64, the same with every compiler and on every machine.

use super::{Drawn, Sample, Setup, to_json};
use crate::Result;
use std::hash::Hasher;
use twox_hash::XxHash64;

/// Tells these bytes from any others.
pub fn digest(bytes: &[u8]) -> u64 {
    XxHash64::oneshot(0, bytes)
}

/// Tells these poses of this setup from any other data.
pub fn fingerprint(setup: &Setup, samples: &[&Sample]) -> Result<u64> {
    let mut hasher = XxHash64::with_seed(0);
    hasher.write(to_json(&setup.description)?.as_bytes());
    for values in [&setup.triangles, &setup.body_triangles, &setup.surface.vertex, &setup.surface.triangles] {
        list(&mut hasher, values.iter().map(|value| value.to_le_bytes()));
    }
    if let Some(Drawn { surface, ride }) = &setup.drawn {
        for values in [&surface.vertex, &surface.triangles, &ride.corners] {
            list(&mut hasher, values.iter().map(|value| value.to_le_bytes()));
        }
        for values in [&surface.uv, &ride.coordinates] {
            list(&mut hasher, values.iter().map(|value| value.to_le_bytes()));
        }
    }
    for row in &setup.body_weights {
        list(&mut hasher, row.iter().map(|(joint, _)| (*joint as u64).to_le_bytes()));
        list(&mut hasher, row.iter().map(|(_, weight)| weight.to_le_bytes()));
    }
    let poses = samples.iter().flat_map(|sample| [&sample.joints, &sample.truth]);
    for values in [&setup.template, &setup.body, &setup.surface.uv].into_iter().chain(poses) {
        list(&mut hasher, values.iter().map(|value| value.to_le_bytes()));
    }
    Ok(hasher.finish())
}

/// The numbers of a list, their count first: none can pass to the next list unseen.
fn list<const N: usize>(hasher: &mut XxHash64, numbers: impl ExactSizeIterator<Item = [u8; N]>) {
    hasher.write(&(numbers.len() as u64).to_le_bytes());
    numbers.for_each(|bytes| hasher.write(&bytes));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::{Description, Record};
    use ctsn_core::model::Surface;

    fn data() -> (Setup, Sample) {
        let setup = Setup {
            description: Description::default(),
            garment: vec![],
            template: vec![0.5, 1.5, -2.0],
            triangles: vec![0, 0, 0],
            surface: Surface::default(),
            drawn: None,
            body: vec![],
            body_triangles: vec![],
            body_weights: vec![vec![(1, 0.25)]],
        };
        (setup, Sample { record: Record::default(), joints: vec![1.0], truth: vec![] })
    }

    #[test]
    fn numbers_kept_in_files_do_not_change_with_the_compiler() {
        // The reference implementation's, of no bytes and of these.
        assert_eq!(digest(b""), 0xef46_db37_51d8_e999);
        assert_eq!(digest(b"Nobody inspects the spammish repetition"), 0xfbce_a83c_8a37_8bf1);
    }

    #[test]
    fn other_data_has_another_number() {
        let (setup, sample) = data();
        let of = |setup: &Setup, samples: &[&Sample]| fingerprint(setup, samples).unwrap();
        let known = of(&setup, &[&sample]);
        assert_eq!(known, of(&setup.clone(), &[&sample.clone()]));
        let changes: [fn(&mut Setup, &mut Sample); 5] = [
            |setup, _| setup.template[1] += 1e-6,
            |setup, _| setup.body_weights[0][0].1 += 1e-9,
            |setup, _| setup.description.rate = 10.0,
            // The same numbers in the same order, in other lists.
            |setup, _| setup.body = setup.template.split_off(2),
            |_, sample| sample.truth.append(&mut sample.joints),
        ];
        for (number, change) in changes.iter().enumerate() {
            let (mut setup, mut sample) = data();
            change(&mut setup, &mut sample);
            assert_ne!(known, of(&setup, &[&sample]), "change {number}");
        }
        assert_ne!(known, of(&setup, &[]));
    }
}
