//! The part of the stress of a point that acts less often than the rest of it.

use jstsph_tensor::Mat3;

use super::Groups;
use crate::reference::{BodyReference, Reference};
use crate::state::{Deformation, State};

/// The pressures of those ends of the points of a body whose J has a coarser level than the point.
#[derive(Clone, Copy)]
pub(super) struct SlowStress<'a> {
    body: &'a BodyReference,
    groups: &'a Groups,
    volume: &'a [f64],
    deformation: Deformation<'a>,
}

impl<'a> SlowStress<'a> {
    pub(super) fn new(
        reference: &'a Reference,
        state: &'a State,
        (body, groups): (&'a BodyReference, &'a Groups),
    ) -> Self {
        Self {
            body,
            groups,
            volume: &reference.point_volume[body.points.clone()],
            deformation: state.deformation(body.points.clone()),
        }
    }

    /// V ½ Σ τ_vol H / det F over the slow ends of a point, if it has some, with the pressures given.
    pub(super) fn of(&self, point: usize, pressure: impl Fn(usize) -> f64) -> Option<Mat3> {
        let ends = self.body.ends[point].map(|end| end as usize);
        let level = self.groups.points.level(point);
        let slow = |a: &usize| self.groups.jacobian[*a] < level;
        if !ends.iter().any(slow) {
            return None;
        }
        let sum: f64 = ends.into_iter().filter(slow).map(pressure).sum();
        let (cofactor, determinant) = self.deformation.cofactor_and_determinant(point);
        Some(cofactor * (0.5 * sum * self.volume[point] / determinant))
    }
}
