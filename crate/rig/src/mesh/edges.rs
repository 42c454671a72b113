//! Edges and the triangles at them, and what follows: rims, hinges.

use std::collections::BTreeMap;

/// A triangle at an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Side {
    /// Number of the triangle.
    pub triangle: usize,
    /// The edge runs from this corner of the triangle (0 to 2) to the next.
    pub corner: usize,
    /// The vertex that faces the edge.
    pub opposite: u32,
    /// Whether the triangle runs from the edge's lower vertex to the higher.
    pub forward: bool,
}

/// Edges (lower vertex, higher vertex) in ascending order, each with the triangles at it in theirs.
#[derive(Clone, Debug)]
pub struct Edges {
    edges: Vec<[u32; 2]>,
    /// Where the triangles of each edge begin in `sides`, and where the last end.
    offsets: Vec<usize>,
    sides: Vec<Side>,
}

/// An inner edge with two triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hinge {
    /// The edge's lower and higher vertex, the vertex that faces it on the left, seen along it from outside, and on the
    /// right.
    pub vertices: [u32; 4],
    /// The two triangles, in their order.
    pub triangles: [usize; 2],
}

/// The edges of a triangle as it runs around them.
pub fn around([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// An edge with its lower vertex first.
pub fn ordered([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

impl Edges {
    /// Of these triangles.
    pub fn new(triangles: &[[u32; 3]]) -> Self {
        let sides = triangles.iter().enumerate().flat_map(|(triangle, corners)| {
            around(*corners).into_iter().enumerate().map(move |(corner, [a, b])| {
                let side = Side { triangle, corner, opposite: corners[(corner + 2) % 3], forward: a < b };
                (ordered([a, b]), side)
            })
        });
        let mut sides: Vec<_> = sides.collect();
        sides.sort_by_key(|(edge, _)| *edge);
        let (mut edges, mut offsets) = (Vec::new(), vec![0]);
        for same in sides.chunk_by(|a, b| a.0 == b.0) {
            edges.push(same[0].0);
            offsets.push(offsets[edges.len() - 1] + same.len());
        }
        Self { edges, offsets, sides: sides.into_iter().map(|(_, side)| side).collect() }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.edges.len()
    }

    /// Every edge and the triangles at it.
    pub fn iter(&self) -> impl Iterator<Item = ([u32; 2], &[Side])> {
        self.edges.iter().zip(self.offsets.windows(2)).map(|(edge, ends)| (*edge, &self.sides[ends[0]..ends[1]]))
    }

    /// The triangles at an edge, its vertices in either order; none where there is no such edge.
    pub fn at(&self, edge: [u32; 2]) -> &[Side] {
        match self.edges.binary_search(&ordered(edge)) {
            Ok(found) => &self.sides[self.offsets[found]..self.offsets[found + 1]],
            Err(_) => &[],
        }
    }

    /// The edges with one triangle.
    pub fn boundary(&self) -> impl Iterator<Item = ([u32; 2], Side)> {
        self.iter().filter_map(|(edge, sides)| if let [side] = sides { Some((edge, *side)) } else { None })
    }

    /// The boundary loops, each as its edges in the order and direction in which its triangles run; a walk that cannot
    /// be closed, where triangles look opposite ways, ends where it ends.
    pub fn rims(&self) -> Vec<Vec<[u32; 2]>> {
        let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for ([a, b], side) in self.boundary() {
            let (from, to) = if side.forward { (a, b) } else { (b, a) };
            next.entry(from).or_default().push(to);
        }
        let mut rims = Vec::new();
        while let Some((&start, _)) = next.iter().find(|(_, ends)| !ends.is_empty()) {
            let (mut at, mut rim) = (start, Vec::new());
            while let Some(to) = next.get_mut(&at).and_then(Vec::pop) {
                rim.push([at, to]);
                at = to;
                if at == start {
                    break;
                }
            }
            rims.push(rim);
        }
        rims
    }

    /// The edges with two triangles.
    pub fn hinges(&self) -> impl Iterator<Item = Hinge> {
        self.iter().filter_map(|([a, b], sides)| {
            let [first, second] = sides else { return None };
            let (left, right) = if first.forward { (first, second) } else { (second, first) };
            Some(Hinge {
                vertices: [a, b, left.opposite, right.opposite],
                triangles: [first.triangle, second.triangle],
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles of a square and one that hangs from its corner 2.
    const TRIANGLES: [[u32; 3]; 3] = [[0, 1, 2], [2, 1, 3], [2, 5, 4]];

    #[test]
    fn edges_know_their_triangles() {
        let edges = Edges::new(&TRIANGLES);
        let counts: Vec<([u32; 2], usize)> = edges.iter().map(|(edge, sides)| (edge, sides.len())).collect();
        let wanted =
            [([0, 1], 1), ([0, 2], 1), ([1, 2], 2), ([1, 3], 1), ([2, 3], 1), ([2, 4], 1), ([2, 5], 1), ([4, 5], 1)];
        assert_eq!(counts, wanted);
        let side = |triangle, corner, opposite, forward| Side { triangle, corner, opposite, forward };
        assert_eq!(edges.at([2, 1]), [side(0, 1, 0, true), side(1, 0, 3, false)]);
        assert!(edges.at([0, 5]).is_empty() && edges.count() == 8);
    }

    #[test]
    fn hinges_have_a_left_and_a_right() {
        let hinges: Vec<Hinge> = Edges::new(&TRIANGLES).hinges().collect();
        assert_eq!(hinges, [Hinge { vertices: [1, 2, 0, 3], triangles: [0, 1] }]);
        let turned: Vec<Hinge> = Edges::new(&[TRIANGLES[1], TRIANGLES[0]]).hinges().collect();
        assert_eq!(turned, [Hinge { vertices: [1, 2, 0, 3], triangles: [0, 1] }]);
    }

    #[test]
    fn rims_run_as_their_triangles() {
        let rims = Edges::new(&TRIANGLES).rims();
        // Two loops that meet in vertex 2 are walked as they come: none of their edges is lost.
        assert_eq!(rims.iter().map(Vec::len).sum::<usize>(), 7);
        assert!(rims.iter().all(|rim| rim.windows(2).all(|pair| pair[0][1] == pair[1][0])));
        assert!(rims.iter().all(|rim| rim[0][0] == rim[rim.len() - 1][1]));
        let square = Edges::new(&TRIANGLES[..2]).rims();
        assert_eq!(square, [[[0, 1], [1, 3], [3, 2], [2, 0]]]);
    }
}
