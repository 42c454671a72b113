//! Whether a mesh is a surface everywhere.

use super::{Edges, Mesh};
use std::collections::BTreeMap;

impl Mesh {
    /// Whether every one of its `edges` has one triangle or two of opposite directions, and every vertex one fan of
    /// triangles.
    pub fn is_manifold(&self, edges: &Edges) -> bool {
        let sound = edges.iter().all(|(_, sides)| match sides {
            [_] => true,
            [first, second] => first.forward != second.forward,
            _ => false,
        });
        sound && self.has_whole_fans()
    }

    /// Whether the triangles at every vertex form one fan: each is a step around the vertex, all of them one chain or
    /// one cycle.
    fn has_whole_fans(&self) -> bool {
        let mut steps = vec![BTreeMap::new(); self.positions.len()];
        for t in &self.triangles {
            for k in 0..3 {
                if steps[t[k] as usize].insert(t[(k + 1) % 3], t[(k + 2) % 3]).is_some() {
                    return false;
                }
            }
        }
        steps.iter().all(|next: &BTreeMap<u32, u32>| {
            let entered: Vec<u32> = next.values().copied().collect();
            let Some(first) = next.keys().find(|v| !entered.contains(v)).or(next.keys().next()) else { return false };
            let (mut v, mut walked) = (*first, 0);
            while let Some(&after) = next.get(&v) {
                (v, walked) = (after, walked + 1);
                if v == *first || walked > next.len() {
                    break;
                }
            }
            walked == next.len()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn what_is_no_surface_is_no_manifold() {
        let is_manifold = |triangles: &[[u32; 3]], count: usize| {
            let mesh = Mesh { positions: vec![DVec3::ZERO; count], triangles: triangles.to_vec() };
            mesh.is_manifold(&Edges::new(&mesh.triangles))
        };
        assert!(is_manifold(&[[0, 1, 2], [2, 1, 3]], 4), "a square");
        assert!(is_manifold(&[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]], 4), "a tetrahedron");
        assert!(!is_manifold(&[[0, 1, 2], [2, 1, 3]], 5), "a vertex of no triangle");
        assert!(!is_manifold(&[[0, 1, 2], [1, 2, 3]], 4), "two triangles that look opposite ways");
        assert!(!is_manifold(&[[0, 1, 2], [2, 1, 3], [2, 1, 4]], 5), "an edge of three");
        assert!(!is_manifold(&[[0, 1, 2], [2, 3, 4]], 5), "two fans at a vertex");
    }
}
