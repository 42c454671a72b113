//! A mesh whose triangles change: what every remesher needs (Botsch & Kobbelt, A Remeshing Approach to Multiresolution
//! Modeling, 2004, §4). Which edges are split, joined and flipped, and where vertices slide, is each remesher's own.

use super::{Mesh, triangle};
use glam::DVec3;

/// Share of the way to where a vertex should be that it slides at once.
const STEP: f64 = 0.7;

/// A mesh under change. Vertices that no triangle uses any more and triangles that are gone keep their numbers until
/// [`finish`](Self::finish).
pub struct DynamicMesh {
    /// Vertex positions, metres.
    pub positions: Vec<DVec3>,
    triangles: Vec<Option<[u32; 3]>>,
    /// Triangles around each vertex, in the order in which they came to it.
    fans: Vec<Vec<u32>>,
}

impl DynamicMesh {
    /// Starts from `mesh`.
    pub fn new(mesh: Mesh) -> Self {
        let mut fans = vec![Vec::new(); mesh.positions.len()];
        for (index, triangle) in mesh.triangles.iter().enumerate() {
            triangle.iter().for_each(|&v| fans[v as usize].push(index as u32));
        }
        Self { positions: mesh.positions, triangles: mesh.triangles.into_iter().map(Some).collect(), fans }
    }

    /// The mesh of what is left, vertices in their order, and the old number of each.
    pub fn finish(self) -> (Mesh, Vec<usize>) {
        let kept: Vec<usize> = (0..self.positions.len()).filter(|v| !self.fans[*v].is_empty()).collect();
        let mut number = vec![u32::MAX; self.positions.len()];
        kept.iter().zip(0..).for_each(|(v, new)| number[*v] = new);
        let mesh = Mesh {
            positions: kept.iter().map(|v| self.positions[*v]).collect(),
            triangles: self.triangles.iter().flatten().map(|t| t.map(|v| number[v as usize])).collect(),
        };
        (mesh, kept)
    }

    /// The triangles that are left, in their order.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        self.triangles.iter().flatten().copied()
    }

    /// The vertices of a triangle; none where it is gone.
    pub fn triangle(&self, index: u32) -> Option<[u32; 3]> {
        self.triangles[index as usize]
    }

    /// The triangles around a vertex.
    pub fn fan(&self, v: u32) -> &[u32] {
        &self.fans[v as usize]
    }

    /// How many vertices are in use.
    pub fn count(&self) -> usize {
        self.fans.iter().filter(|fan| !fan.is_empty()).count()
    }

    /// The vertices next to a vertex, ascending.
    pub fn ring(&self, v: u32) -> Vec<u32> {
        let near = self.fan(v).iter().filter_map(|t| self.triangle(*t)).flatten();
        let mut ring: Vec<u32> = near.filter(|other| *other != v).collect();
        ring.sort_unstable();
        ring.dedup();
        ring
    }

    /// Whether a triangle has both vertices.
    pub fn adjoins(&self, a: u32, b: u32) -> bool {
        self.fan(a).iter().any(|t| self.triangle(*t).is_some_and(|t| t.contains(&b)))
    }

    /// The triangles at an edge.
    pub fn beside(&self, [a, b]: [u32; 2]) -> Vec<u32> {
        let shares = |t: &&u32| self.triangle(**t).is_some_and(|t| t.contains(&b));
        self.fan(a).iter().filter(shares).copied().collect()
    }

    /// The vertex of a triangle that is not on an edge of it.
    pub fn opposite(&self, index: u32, edge: [u32; 2]) -> Option<u32> {
        self.triangle(index)?.into_iter().find(|v| !edge.contains(v))
    }

    /// Distance between two vertices, metres.
    pub fn length(&self, [a, b]: [u32; 2]) -> f64 {
        self.positions[a as usize].distance(self.positions[b as usize])
    }

    /// The middle between two vertices, metres.
    pub fn middle(&self, [a, b]: [u32; 2]) -> DVec3 {
        (self.positions[a as usize] + self.positions[b as usize]) * 0.5
    }

    /// The normal of a triangle of these vertices, twice as long as the area is large.
    pub fn cross(&self, triangle: [u32; 3]) -> DVec3 {
        triangle::cross(triangle.map(|v| self.positions[v as usize]))
    }

    /// Where a vertex comes that slides within the surface towards `place`, metres.
    pub fn slid(&self, v: u32, place: DVec3) -> DVec3 {
        let normals = self.fan(v).iter().filter_map(|t| self.triangle(*t)).map(|t| self.cross(t));
        let normal = normals.sum::<DVec3>().normalize_or_zero();
        let here = self.positions[v as usize];
        let step = place - here;
        here + STEP * (step - normal * normal.dot(step))
    }

    /// A new vertex, which no triangle uses yet.
    pub fn add_vertex(&mut self, position: DVec3) -> u32 {
        self.positions.push(position);
        self.fans.push(Vec::new());
        self.positions.len() as u32 - 1
    }

    /// A new triangle.
    pub fn add_triangle(&mut self, triangle: [u32; 3]) {
        let index = self.triangles.len() as u32;
        self.triangles.push(Some(triangle));
        triangle.iter().for_each(|v| self.fans[*v as usize].push(index));
    }

    /// Makes a triangle one of other vertices, or none: it comes last in the fans of all of them.
    pub fn set(&mut self, index: u32, triangle: Option<[u32; 3]>) {
        for v in self.triangles[index as usize].into_iter().flatten() {
            self.fans[v as usize].retain(|t| *t != index);
        }
        triangle.iter().flatten().for_each(|v| self.fans[*v as usize].push(index));
        self.triangles[index as usize] = triangle;
    }

    /// Makes a triangle one of other vertices: it keeps its place in the fans of those that it had.
    pub fn alter(&mut self, index: u32, triangle: [u32; 3]) {
        let old = self.triangles[index as usize].replace(triangle).unwrap_or(triangle);
        for v in old.into_iter().filter(|v| !triangle.contains(v)) {
            self.fans[v as usize].retain(|t| *t != index);
        }
        for v in triangle.into_iter().filter(|v| !old.contains(v)) {
            self.fans[v as usize].push(index);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of two triangles with its middle split, one half of it gone.
    #[test]
    fn fans_follow_what_changes() {
        let positions = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
        let mut mesh = DynamicMesh::new(Mesh { positions, triangles: vec![[0, 1, 2], [2, 1, 3]] });
        assert_eq!((mesh.beside([1, 2]), mesh.ring(1), mesh.opposite(1, [2, 1])), (vec![0, 1], vec![0, 2, 3], Some(3)));
        let middle = mesh.add_vertex(mesh.middle([1, 2]));
        mesh.alter(0, [0, middle, 2]);
        mesh.add_triangle([0, 1, middle]);
        assert_eq!((mesh.fan(1), mesh.fan(middle), mesh.ring(middle)), (&[1, 2][..], &[0, 2][..], vec![0, 1, 2]));
        mesh.set(1, None);
        assert_eq!(
            (mesh.beside([1, 2]), mesh.adjoins(1, 2), mesh.adjoins(1, 4), mesh.count()),
            (vec![], false, true, 4)
        );
        // Its neighbours pull the middle inwards, within the plane.
        let slid = mesh.slid(middle, DVec3::new(0.0, 0.5, 9.0));
        assert!(slid.abs_diff_eq(DVec3::new(0.15, 0.5, 0.0), 1e-12), "{slid}");
        let (mesh, kept) = mesh.finish();
        assert_eq!((kept, mesh.triangles), (vec![0, 1, 2, 4], vec![[0, 3, 2], [0, 1, 3]]));
    }
}
