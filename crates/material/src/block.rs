//! The history of many points of one material.

use crate::Material;

/// A run of points of one material, with the history they have and the history they would get.
///
/// An evaluation reads `committed` and writes every entry of `candidate`; only [`commit`](Self::commit)
/// moves history forward.
#[derive(Clone, Debug)]
pub struct Block<M: Material> {
    /// Parameters, the same for all points.
    pub model: M,
    /// History at the last accepted step, one entry per point.
    pub committed: Vec<M::History>,
    /// History after the latest evaluation, one entry per point.
    pub candidate: Vec<M::History>,
}

impl<M: Material> Block<M> {
    /// `points` points in their initial state.
    #[must_use]
    pub fn new(model: M, points: usize) -> Self {
        let committed = vec![model.initial_history(); points];
        let candidate = committed.clone();
        Self {
            model,
            committed,
            candidate,
        }
    }

    /// Accepts the latest evaluation. The two vectors change places, without a copy: the next
    /// evaluation must rewrite every candidate, and until then `candidate` holds the state before.
    pub fn commit(&mut self) {
        std::mem::swap(&mut self.committed, &mut self.candidate);
    }

    /// Accepts the latest evaluation of some points, by a copy: the others keep both histories.
    ///
    /// # Panics
    /// If there are no such points.
    pub fn commit_points(&mut self, points: std::ops::Range<usize>) {
        self.committed[points.clone()].copy_from_slice(&self.candidate[points]);
    }
}

/// Work on a block whatever its model, chosen once per call and not once per point.
pub trait BlockVisitor {
    /// What the work returns.
    type Output;
    /// The work.
    fn visit<M: Material>(&mut self, block: &mut Block<M>) -> Self::Output;
}

/// The same without changing the block.
pub trait BlockReader {
    /// What the work returns.
    type Output;
    /// The work.
    fn visit<M: Material>(&mut self, block: &Block<M>) -> Self::Output;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{History, Kinematics, library};
    use jstsph_tensor::Mat3;

    /// Shears every point by two per cent and returns the largest ε_p of the candidates.
    struct Shear;

    impl BlockVisitor for Shear {
        type Output = f64;
        fn visit<M: Material>(&mut self, block: &mut Block<M>) -> f64 {
            let now = Kinematics {
                deformation_gradient: Mat3::new(1.0, 0.02, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
                jacobian: 1.0,
                dt: 1e-6,
                temperature: crate::ROOM_TEMPERATURE,
            };
            for (old, new) in block.committed.iter().zip(&mut block.candidate) {
                *new = block.model.respond(&now, old).unwrap().history;
            }
            plastic_strain(&block.candidate)
        }
    }

    struct Committed;

    impl BlockReader for Committed {
        type Output = f64;
        fn visit<M: Material>(&mut self, block: &Block<M>) -> f64 {
            plastic_strain(&block.committed)
        }
    }

    fn plastic_strain(history: &[impl History]) -> f64 {
        history
            .iter()
            .map(History::equivalent_plastic_strain)
            .fold(0.0, f64::max)
    }

    #[test]
    fn history_moves_only_when_it_is_committed() {
        let mut block = library()[0].spec.block(3);
        let candidate = block.visit(&mut Shear);
        assert!(candidate > 1e-3);
        // A second trial starts from the same history.
        assert_eq!(block.visit(&mut Shear), candidate);
        assert_eq!(block.visit_ref(&mut Committed), 0.0);
        block.commit();
        assert_eq!(block.visit_ref(&mut Committed), candidate);
    }

    #[test]
    fn some_points_can_be_committed_before_the_others() {
        let mut block = library()[0].spec.block(3);
        let candidate = block.visit(&mut Shear);
        block.commit_points(1..2);
        let strains = block.visit_ref(&mut Strains);
        assert_eq!(strains, [0.0, candidate, 0.0]);
    }

    struct Strains;

    impl BlockReader for Strains {
        type Output = Vec<f64>;
        fn visit<M: Material>(&mut self, block: &Block<M>) -> Vec<f64> {
            let strain = |history: &M::History| history.equivalent_plastic_strain();
            block.committed.iter().map(strain).collect()
        }
    }
}
