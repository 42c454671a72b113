//! Closed C¹ paths through key postures: cubic Hermite segments with the slopes of the neighbouring keys.
//! Anything whose channels can be blended can be keyed: a posture of any kind of body, a foot's path.

/// A fixed set of numbers that are blended one by one.
pub trait Channels: Copy {
    /// Channel by channel `f(self, other)`.
    fn zip(&self, other: &Self, f: impl Fn(f64, f64) -> f64 + Copy) -> Self;

    /// Linear: `self` at share 0, `other` at 1.
    fn blend(&self, other: &Self, share: f64) -> Self {
        self.zip(other, |a, b| a + (b - a) * share)
    }
}

impl<const N: usize> Channels for [f64; N] {
    fn zip(&self, other: &Self, f: impl Fn(f64, f64) -> f64 + Copy) -> Self {
        std::array::from_fn(|i| f(self[i], other[i]))
    }
}

impl<const M: usize, const N: usize> Channels for [[f64; N]; M] {
    fn zip(&self, other: &Self, f: impl Fn(f64, f64) -> f64 + Copy) -> Self {
        std::array::from_fn(|i| self[i].zip(&other[i], f))
    }
}

/// The path through `keys` (seconds, channels) at `time`; it repeats every `period` seconds. Keys are in time order,
/// the first at 0, the last before `period`.
pub fn through<P: Channels>(keys: &[(f64, P)], period: f64, time: f64) -> P {
    let n = keys.len();
    let t = time.rem_euclid(period);
    let key = |i: isize| {
        let (time, posture) = &keys[i.rem_euclid(n as isize) as usize];
        (time + period * i.div_euclid(n as isize) as f64, posture)
    };
    let i = keys.partition_point(|(time, _)| *time <= t) as isize - 1;
    let ((t0, p0), (t1, p1), (t2, p2), (t3, p3)) = (key(i - 1), key(i), key(i + 1), key(i + 2));
    let h = t2 - t1;
    let slope = |a: &P, b: &P, dt: f64| a.zip(b, move |a, b| (b - a) / dt);
    let (m1, m2) = (slope(p0, p2, t2 - t0), slope(p1, p3, t3 - t1));
    let u = (t - t1) / h;
    let (h10, h11) = (u * (1.0 - u) * (1.0 - u) * h, u * u * (u - 1.0) * h);
    let ends = p1.blend(p2, u * u * (3.0 - 2.0 * u));
    ends.zip(&m1, |a, m| a + h10 * m).zip(&m2, |a, m| a + h11 * m)
}

/// A repeating motion of any kind of body, as key postures.
pub struct Move<P> {
    /// Name of the clip.
    pub name: &'static str,
    /// Seconds until it repeats.
    pub period: f64,
    /// Key postures in time order: (seconds, channels).
    pub keys: Vec<(f64, P)>,
}

/// 0 below 0, 1 above 1, C¹ between.
pub fn smoothstep(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// The Halton (1960) sequence: sample `index` (from 1) of dimension `dimension`, in [0, 1). It covers a box more evenly
/// than random numbers. Only every 409th sample is used (leaped, Kocis & Whiten 1997): successive ones would rise in
/// step in high dimensions. Dimensions beyond the table of primes repeat it.
pub fn halton(index: usize, dimension: usize) -> f64 {
    const PRIMES: [usize; 30] = [
        2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71, 73, 79, 83, 89, 97, 101, 103, 107,
        109, 113,
    ];
    let base = PRIMES[dimension % PRIMES.len()];
    let (mut left, mut share, mut sum) = (409 * index, 1.0, 0.0);
    while left > 0 {
        share /= base as f64;
        sum += share * (left % base) as f64;
        left /= base;
    }
    sum
}
