//! The stages of a frame and what each must do at least: floating-point operations, and bytes when every operand is
//! moved once.

use crate::recording::Dispatch;

/// Least work of a dispatch or stage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Floating-point operations; a fused multiply-add counts as two.
    pub flops: f64,
    /// Bytes read and written. Attention is counted as if each vertex were read once, not once per neighbour.
    pub bytes: f64,
}

impl std::ops::AddAssign for Cost {
    fn add_assign(&mut self, other: Self) {
        self.flops += other.flops;
        self.bytes += other.bytes;
    }
}

/// A stage of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Stage {
    /// Name, as in the golden files; `polish`, `collide`, `normals`, `ride` and `surface` beside them.
    pub name: String,
    /// Its dispatches.
    pub dispatches: usize,
    /// Its least work.
    pub cost: Cost,
}

/// The stages of a frame in the order of their first dispatch, and for each dispatch the index of its stage.
pub(crate) fn stages(frame: &[Dispatch]) -> (Vec<Stage>, Vec<usize>) {
    let mut stages: Vec<Stage> = Vec::new();
    let mut index = Vec::with_capacity(frame.len());
    for dispatch in frame {
        let at = stages.iter().position(|stage| stage.name == dispatch.stage).unwrap_or_else(|| {
            stages.push(Stage { name: dispatch.stage.clone(), dispatches: 0, cost: Cost::default() });
            stages.len() - 1
        });
        stages[at].dispatches += 1;
        stages[at].cost += dispatch.cost;
        index.push(at);
    }
    (stages, index)
}
