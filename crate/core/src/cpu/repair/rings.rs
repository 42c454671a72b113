//! What lies around each vertex of the posed body, in whole vectors: the search over the body looks at all triangles
//! around a vertex at once.

use super::eight::{Eight, Packed, dot, from, greatest, splat};
use fearless_simd::Simd;
use glam::Vec3;

/// Triangles looked at together: mostly all that a vertex has, as the body is meshed evenly.
pub const RING: usize = 8;

/// The second corners of up to eight triangles around a vertex: all its neighbours. The vertex itself stands in for a
/// missing triangle.
#[derive(Clone, Default)]
pub struct Ring {
    /// Which they are.
    pub vertices: [u32; RING],
    positions: Packed,
}

impl Ring {
    /// The ways from a point to the neighbours.
    #[inline(always)]
    pub fn from<S: Simd>(&self, simd: S, point: Vec3) -> Eight<S> {
        from(simd, point, &self.positions)
    }
}

/// The rings of every vertex of a body, where it is posed.
#[derive(Default)]
pub struct Rings {
    /// Where those of each vertex start [b + 1].
    starts: Vec<u32>,
    rings: Vec<Ring>,
    /// Third corners of the same triangles.
    thirds: Vec<Packed>,
    /// How high the neighbours of each vertex rise above it along its normal, metres, at least zero [b].
    tops: Vec<f32>,
    /// What they were made of.
    positions: Vec<f32>,
    normals: Vec<f32>,
    offsets: Vec<u32>,
    corners: Vec<u32>,
}

impl Rings {
    /// Follows the body: positions and unit normals [b, 3]; where the triangles around each vertex start [b + 1], and
    /// their other two corners [3t, 2]. Nothing is done where they are those of the last time, as for the second look.
    #[inline(always)]
    pub fn pose<S: Simd>(&mut self, simd: S, positions: &[f32], normals: &[f32], offsets: &[u32], corners: &[u32]) {
        let same = equal(&self.positions, positions) && equal(&self.normals, normals);
        if same && equal(&self.offsets, offsets) && equal(&self.corners, corners) {
            return;
        }
        keep(&mut self.positions, positions);
        keep(&mut self.normals, normals);
        keep(&mut self.offsets, offsets);
        keep(&mut self.corners, corners);
        let (positions, fans) = (positions.as_chunks::<3>().0, corners.as_chunks::<2>().0);
        self.starts.clear();
        self.tops.clear();
        let mut count = 0;
        for (vertex, (bounds, normal)) in offsets.windows(2).zip(normals.as_chunks::<3>().0).enumerate() {
            self.starts.push(count as u32);
            let mut top = 0.0_f32;
            for fan in fans[bounds[0] as usize..bounds[1] as usize].chunks(RING) {
                if count == self.rings.len() {
                    self.rings.push(Ring::default());
                    self.thirds.push(Packed::default());
                }
                let (ring, third) = (&mut self.rings[count], &mut self.thirds[count]);
                fill(vertex as u32, fan, positions, ring, third);
                let ways = ring.from(simd, Vec3::from_array(positions[vertex]));
                top = top.max(greatest(dot(ways, splat(simd, Vec3::from_array(*normal)))));
                count += 1;
            }
            self.tops.push(top);
        }
        self.starts.push(count as u32);
    }

    /// Those of a vertex.
    #[inline(always)]
    pub fn of(&self, vertex: u32) -> &[Ring] {
        let [start, end] = [vertex, vertex + 1].map(|vertex| self.starts[vertex as usize] as usize);
        &self.rings[start..end]
    }

    /// The third corners of the same triangles.
    #[inline(always)]
    pub fn thirds(&self, vertex: u32) -> &[Packed] {
        let [start, end] = [vertex, vertex + 1].map(|vertex| self.starts[vertex as usize] as usize);
        &self.thirds[start..end]
    }

    /// How high the neighbours of a vertex rise above it along its normal, metres, at least zero.
    #[inline(always)]
    pub fn top(&self, vertex: u32) -> f32 {
        self.tops[vertex as usize]
    }
}

/// Up to eight triangles around a vertex.
#[inline(always)]
fn fill(vertex: u32, fan: &[[u32; 2]], positions: &[[f32; 3]], ring: &mut Ring, third: &mut Packed) {
    for place in 0..RING {
        let [b, c] = fan.get(place).copied().unwrap_or([vertex; 2]);
        ring.vertices[place] = b;
        let [b, c] = [b, c].map(|corner| positions[corner as usize]);
        for axis in 0..3 {
            ring.positions[axis][place] = b[axis];
            third[axis][place] = c[axis];
        }
    }
}

/// Not `==`, which in wasm compares byte after byte.
fn equal<T: PartialEq>(a: &[T], b: &[T]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a == b)
}

/// A copy in the same room.
fn keep<T: Copy>(room: &mut Vec<T>, values: &[T]) {
    room.clear();
    room.extend_from_slice(values);
}
