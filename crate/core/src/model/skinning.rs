//! Skin weights as a dense matrix, as files have them, and as sparse rows, as skinning reads them.

use super::Skinning;

impl Skinning<Vec<f32>, Vec<u32>> {
    /// Dense weights [n, joints] -> rows as wide as the fullest vertex needs.
    pub fn from_dense(dense: &[f32], joints: usize) -> Self {
        let used = |row: &[f32]| row.iter().filter(|weight| **weight != 0.0).count();
        let width = dense.chunks_exact(joints).map(used).max().unwrap_or(0).max(1);
        let mut skinning = Skinning { joints: Vec::new(), weights: Vec::new(), width };
        for (i, row) in dense.chunks_exact(joints).enumerate() {
            for (joint, weight) in row.iter().enumerate().filter(|entry| *entry.1 != 0.0) {
                skinning.joints.push(joint as u32);
                skinning.weights.push(*weight);
            }
            skinning.joints.resize((i + 1) * width, 0);
            skinning.weights.resize((i + 1) * width, 0.0);
        }
        skinning
    }

    /// Weights as a dense matrix [n, joints].
    pub fn to_dense(&self, joints: usize) -> Vec<f32> {
        let mut dense = vec![0.0; self.weights.len() / self.width * joints];
        for (slot, (joint, weight)) in self.joints.iter().zip(&self.weights).enumerate() {
            dense[slot / self.width * joints + *joint as usize] += weight;
        }
        dense
    }
}
