//! The boundary as the gradient operator should see it: docs/theory.md, "Summation by parts near the
//! boundary".

use jstsph_geometry::{Body, surface_parts};
use jstsph_sph::{Correction, GradientOperator, Support};
use jstsph_tensor::Vec3;

/// Largest inner defect, in lattice faces, of an operator that is left as it is: boxes with a narrow
/// support, whose rows share their weights. docs/theory.md has the orders of magnitude.
const ACCEPTED_DEFECT: f64 = 2e-3;

/// Defects below this, in lattice faces, do not call for a change of the rows around them.
const TOLERANCE: f64 = 1e-6;

/// Smallest smoothing length of the extrapolation, in spacings: enough for a tip of the staircase to
/// reach the row behind it across the diagonal.
const EXTRAPOLATION_RATIO: f64 = 0.8;

/// N_c = Σ_s A_s n_s ψ_c(X_s) over the parts s of the surface, m²: zero away from the boundary.
///
/// ψ_c(X_s) = δ_ac + B_ac · (X_s − X_a) extrapolates linearly from the node a of the part to the point
/// of the true surface, which is the node itself except on the staircase of a round or carved body. Hence Σ N
/// and Σ X ⊗ N are those of the surface, zero and V 1.
///
/// On bodies carved out of a lattice, whose surface is known as accurately as it was sampled, nearly so. A
/// body with nodes that have too few neighbours for a gradient is not extrapolated.
pub(crate) fn area_vectors(body: &Body, weights: &[f64], support: &Support) -> Vec<Vec3> {
    let parts = surface_parts(body);
    let arm = |node: usize, point: &Vec3| point - body.positions[node];
    let far = 1e-9 * body.spacing;
    let extrapolates = parts
        .iter()
        .any(|part| arm(part.node as usize, &part.point).norm() > far);
    let support = Support {
        smoothing_length: support
            .smoothing_length
            .max(EXTRAPOLATION_RATIO * body.spacing),
        ..*support
    };
    let nodal = extrapolates
        .then(|| GradientOperator::at_particles(&body.positions, weights, &support).ok())
        .flatten();
    let mut vectors = vec![Vec3::zeros(); body.positions.len()];
    for part in &parts {
        let a = part.node as usize;
        let vector = part.normal * part.area;
        vectors[a] += vector;
        let arm = arm(a, &part.point);
        if let Some(nodal) = &nodal
            && arm.norm() > far
        {
            for (c, weight) in nodal.row(a).entries() {
                vectors[c] += vector * Vec3::from(*weight).dot(&arm);
            }
        }
    }
    vectors
}

/// The operator made to sum by parts, and how, when it does not do so by itself.
pub(crate) fn corrected(
    gradient: GradientOperator,
    body: &Body,
    point_volumes: &[f64],
    area_vectors: &[Vec3],
) -> (GradientOperator, Option<Correction>) {
    let face = body.spacing.powi(body.dimension.count() as i32 - 1);
    let inner = |a: usize| !body.boundary[a];
    let defect = largest_defect(&gradient, point_volumes, area_vectors, inner);
    if defect < ACCEPTED_DEFECT * face {
        return (gradient, None);
    }
    let tolerance = TOLERANCE * face;
    let (gradient, correction) =
        gradient.summing_by_parts(&body.positions, point_volumes, area_vectors, tolerance);
    (gradient, Some(correction))
}

/// Largest |Σ_q V_q B_qa − N_a| over the particles for which `chosen(a)` holds, m².
pub(crate) fn largest_defect(
    gradient: &GradientOperator,
    point_volumes: &[f64],
    area_vectors: &[Vec3],
    chosen: impl Fn(usize) -> bool,
) -> f64 {
    gradient
        .boundary_vectors(point_volumes)
        .iter()
        .zip(area_vectors)
        .enumerate()
        .filter(|(a, _)| chosen(*a))
        .map(|(_, (found, wanted))| (found - wanted).norm())
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests;
