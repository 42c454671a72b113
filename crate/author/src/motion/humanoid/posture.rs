//! A posture of any humanoid as anatomical channels: what motions are written in and blended in.
//! Angles in degrees, lengths in leg lengths (hip to floor); all zero is standing straight, arms hanging.

/// Channels of one posture. Two-element arrays are left, right; a positive angle means the same on either side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Posture {
    /// Turn of the whole body about the vertical, to the left.
    pub heading: f64,
    /// Hips moved from standing: to the left, up, forward.
    pub hips: [f64; 3],
    /// Hips turned: pitch forward, yaw to the left, roll to the left (left side down).
    pub tilt: [f64; 3],
    /// Spine over all its joints: bend forward, twist to the left, lean to the left.
    pub spine: [f64; 3],
    /// Neck and head together: nod down, turn to the left, tilt to the left.
    pub head: [f64; 3],
    /// Per arm: raise sideways, swing forward, twist outward, elbow, wrist towards the palm.
    pub arms: [[f64; 5]; 2],
    /// Per foot: moved outward, up, forward; turned outward; heel up (negative: toes up).
    pub feet: [[f64; 5]; 2],
}

impl Posture {
    /// Channel by channel `f(self, other)`.
    pub fn zip(&self, other: &Posture, f: impl Fn(f64, f64) -> f64 + Copy) -> Posture {
        fn each<const N: usize>(a: &[f64; N], b: &[f64; N], f: impl Fn(f64, f64) -> f64) -> [f64; N] {
            std::array::from_fn(|i| f(a[i], b[i]))
        }
        let sides = |a: &[[f64; 5]; 2], b: &[[f64; 5]; 2]| [each(&a[0], &b[0], f), each(&a[1], &b[1], f)];
        Posture {
            heading: f(self.heading, other.heading),
            hips: each(&self.hips, &other.hips, f),
            tilt: each(&self.tilt, &other.tilt, f),
            spine: each(&self.spine, &other.spine, f),
            head: each(&self.head, &other.head, f),
            arms: sides(&self.arms, &other.arms),
            feet: sides(&self.feet, &other.feet),
        }
    }

    /// `self` at 0, `other` at 1.
    pub fn blend(&self, other: &Posture, share: f64) -> Posture {
        self.zip(other, |a, b| a + (b - a) * share)
    }

    /// Left and right exchanged.
    pub fn mirrored(&self) -> Posture {
        let Posture { heading, hips: [x, y, z], tilt: [pitch, yaw, roll], spine, head, arms, feet } = *self;
        Posture {
            heading: -heading,
            hips: [-x, y, z],
            tilt: [pitch, -yaw, -roll],
            spine: [spine[0], -spine[1], -spine[2]],
            head: [head[0], -head[1], -head[2]],
            arms: [arms[1], arms[0]],
            feet: [feet[1], feet[0]],
        }
    }
}

/// A closed C¹ path through key postures (seconds, posture), repeated every `period` seconds: cubic Hermite
/// segments with the slopes of the neighbouring keys. Keys in time order, the first at 0, the last before `period`.
pub fn through(keys: &[(f64, Posture)], period: f64, time: f64) -> Posture {
    let n = keys.len();
    let t = time.rem_euclid(period);
    let key = |i: isize| {
        let (time, posture) = &keys[i.rem_euclid(n as isize) as usize];
        (time + period * i.div_euclid(n as isize) as f64, posture)
    };
    let i = keys.partition_point(|(time, _)| *time <= t) as isize - 1;
    let ((t0, p0), (t1, p1), (t2, p2), (t3, p3)) = (key(i - 1), key(i), key(i + 1), key(i + 2));
    let h = t2 - t1;
    let slope = |a: &Posture, b: &Posture, dt: f64| a.zip(b, move |a, b| (b - a) / dt);
    let (m1, m2) = (slope(p0, p2, t2 - t0), slope(p1, p3, t3 - t1));
    let u = (t - t1) / h;
    let (h10, h11) = (u * (1.0 - u) * (1.0 - u) * h, u * u * (u - 1.0) * h);
    let ends = p1.blend(p2, u * u * (3.0 - 2.0 * u));
    ends.zip(&m1, |a, m| a + h10 * m).zip(&m2, |a, m| a + h11 * m)
}
