//! What is joined to what: union-find, each set led by its lowest member.

use super::Mesh;
use std::cell::Cell;

/// Sets of the numbers below n.
#[derive(Clone, Debug)]
pub struct Components {
    leader: Vec<Cell<usize>>,
}

impl Components {
    /// Every number below `count` by itself.
    pub fn new(count: usize) -> Self {
        Self { leader: (0..count).map(Cell::new).collect() }
    }

    /// Joins the sets of all of these.
    pub fn join(&mut self, members: impl IntoIterator<Item = usize>) {
        let mut members = members.into_iter();
        let Some(first) = members.next() else { return };
        for other in members {
            let (a, b) = (self.of(first), self.of(other));
            self.leader[a.max(b)].set(a.min(b));
        }
    }

    /// The lowest member of the set that holds `member`.
    pub fn of(&self, mut member: usize) -> usize {
        while self.leader[member].get() != member {
            let next = self.leader[self.leader[member].get()].get();
            self.leader[member].set(next);
            member = next;
        }
        member
    }

    /// The lowest member of each set, ascending.
    pub fn leaders(&self) -> impl Iterator<Item = usize> {
        (0..self.leader.len()).filter(|member| self.leader[*member].get() == *member)
    }
}

impl Mesh {
    /// The vertices that triangles join.
    pub fn components(&self) -> Components {
        let mut components = Components::new(self.positions.len());
        self.triangles.iter().for_each(|triangle| components.join(triangle.map(|vertex| vertex as usize)));
        components
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lowest_member_leads() {
        let mut components = Components::new(8);
        components.join([7, 5]);
        components.join([2, 4, 7]);
        components.join([]);
        components.join([3, 1]);
        assert_eq!((0..8).map(|member| components.of(member)).collect::<Vec<_>>(), [0, 1, 2, 1, 2, 2, 6, 2]);
        assert!(components.leaders().eq([0, 1, 2, 6]));
    }
}
