//! Walking and jogging in place: foot paths over one stride, everything else in step with them; simulation.md §5.

use super::posture::Posture;
use crate::motion::curve::through;
use std::f64::consts::TAU;

/// How someone walks or runs. Lengths in leg lengths, angles in degrees.
#[derive(Clone, Copy, Debug)]
pub struct Gait {
    /// Seconds per stride (two steps).
    pub stride: f64,
    /// Foot path over one stride: share of the stride, forward, up, heel up.
    pub foot: &'static [[f64; 4]],
    /// Hips: standing height, bob, sway to the side.
    pub hips: [f64; 3],
    /// Trunk: lean forward, hip yaw, counter-twist of the spine, hip roll.
    pub trunk: [f64; 4],
    /// Arms: raise, mean swing, swing to and fro, elbow, elbow to and fro.
    pub arms: [f64; 5],
}

/// An easy walk.
pub const WALK: Gait = Gait {
    stride: 1.15,
    foot: &[
        [0.00, 0.390, 0.000, -18.0],
        [0.10, 0.265, 0.000, 0.0],
        [0.24, 0.055, 0.000, 0.0],
        [0.38, -0.155, 0.000, 3.0],
        [0.50, -0.330, 0.000, 18.0],
        [0.61, -0.400, 0.020, 48.0],
        [0.72, -0.140, 0.095, 38.0],
        [0.83, 0.220, 0.060, 4.0],
        [0.93, 0.400, 0.025, -18.0],
    ],
    hips: [-0.034, 0.013, 0.018],
    trunk: [2.0, 7.0, 12.0, 3.0],
    arms: [19.0, 2.0, 21.0, 22.0, 9.0],
};

/// A light jog.
pub const JOG: Gait = Gait {
    stride: 0.70,
    foot: &[
        [0.00, 0.200, 0.010, -4.0],
        [0.12, 0.060, 0.000, 0.0],
        [0.24, -0.100, 0.000, 6.0],
        [0.36, -0.240, 0.015, 38.0],
        [0.50, -0.330, 0.150, 64.0],
        [0.64, -0.150, 0.280, 50.0],
        [0.78, 0.170, 0.200, 14.0],
        [0.91, 0.270, 0.080, -4.0],
    ],
    hips: [-0.055, 0.022, 0.010],
    trunk: [7.0, 8.0, 18.0, 3.0],
    arms: [24.0, 4.0, 30.0, 82.0, 12.0],
};

/// A run.
pub const RUN: Gait = Gait {
    stride: 0.64,
    foot: &[
        [0.00, 0.210, 0.015, -4.0],
        [0.12, 0.040, 0.000, 2.0],
        [0.24, -0.200, 0.000, 12.0],
        [0.34, -0.420, 0.030, 48.0],
        [0.48, -0.500, 0.220, 74.0],
        [0.62, -0.220, 0.350, 60.0],
        [0.78, 0.220, 0.260, 18.0],
        [0.91, 0.320, 0.110, -4.0],
    ],
    hips: [-0.060, 0.028, 0.008],
    trunk: [10.0, 10.0, 22.0, 3.0],
    arms: [24.0, 8.0, 40.0, 88.0, 10.0],
};

/// Sneaking with bent knees and a low trunk.
pub const CROUCH: Gait = Gait {
    stride: 1.60,
    foot: &[
        [0.00, 0.300, 0.000, -10.0],
        [0.12, 0.190, 0.000, 0.0],
        [0.28, 0.030, 0.000, 0.0],
        [0.44, -0.130, 0.000, 8.0],
        [0.56, -0.240, 0.010, 30.0],
        [0.68, -0.130, 0.130, 34.0],
        [0.80, 0.140, 0.120, 6.0],
        [0.92, 0.300, 0.040, -10.0],
    ],
    hips: [-0.230, 0.014, 0.026],
    trunk: [20.0, 9.0, 12.0, 4.0],
    arms: [30.0, 26.0, 16.0, 58.0, 10.0],
};

/// On the spot, knees high.
pub const MARCH: Gait = Gait {
    stride: 1.10,
    foot: &[
        [0.00, 0.020, 0.000, 0.0],
        [0.25, 0.000, 0.000, 0.0],
        [0.46, -0.010, 0.005, 14.0],
        [0.60, 0.060, 0.230, 34.0],
        [0.74, 0.130, 0.400, 24.0],
        [0.88, 0.070, 0.180, 8.0],
    ],
    hips: [-0.020, 0.010, 0.030],
    trunk: [0.0, 5.0, 10.0, 3.0],
    arms: [20.0, 10.0, 38.0, 60.0, 20.0],
};

impl Gait {
    /// Posture at `time` seconds.
    pub fn at(&self, time: f64) -> Posture {
        let foot = |phase: f64| {
            let row = |&[share, z, y, pitch]: &[f64; 4]| {
                (share, Posture { feet: [[0.0, y, z, 5.0, pitch]; 2], ..Posture::default() })
            };
            let keys: Vec<(f64, Posture)> = self.foot.iter().map(row).collect();
            through(&keys, 1.0, phase).feet[0]
        };
        let phase = time / self.stride;
        let angle = TAU * phase;
        let [height, bob, sway] = self.hips;
        let [lean, yaw, twist, roll] = self.trunk;
        let [raise, mean, swing, elbow, more] = self.arms;
        // At phase 0 the left heel strikes: left hip forward (yaw to the right), left arm back.
        let arm = |fore: f64| [raise, mean + swing * fore, 0.0, elbow + more * fore, 4.0];
        let fore = -(angle - 0.15).cos();
        Posture {
            hips: [sway * (angle - 0.6).sin(), height - bob * (2.0 * angle - 0.5).cos(), 0.0],
            tilt: [lean, -yaw * angle.cos(), -roll * (angle - 0.4).sin()],
            spine: [lean, twist * angle.cos(), 1.5 * roll * (angle - 0.4).sin()],
            head: [-lean, -0.4 * (twist - yaw) * angle.cos(), 0.0],
            arms: [arm(fore), arm(-fore)],
            feet: [foot(phase), foot(phase + 0.5)],
            heading: 0.0,
        }
    }
}
