//! Settings that are allowed but look like mistakes.

use jstsph_geometry::Dimension;
use jstsph_material::MaterialSpec;
use jstsph_solver::{Biharmonic, Integrator, Model, SmoothingReference};
use jstsph_sph::Kernel;
use jstsph_tensor::Vec3;

/// What the checks look at.
pub(crate) struct Facts<'a> {
    pub(crate) model: &'a Model,
    /// Simulated time, s.
    pub(crate) end: f64,
    /// Smallest fillet radius of every obstacle, m.
    pub(crate) smallest_fillets: &'a [Option<f64>],
}

/// Young's modulus below which a metal is taken for one whose unit was forgotten, Pa.
const SOFTEST_METAL: f64 = 1e5;

/// One sentence for everything that looks wrong.
pub(crate) fn warnings(facts: &Facts<'_>) -> Vec<String> {
    let mut found = Vec::new();
    bodies(facts, &mut found);
    fillets(facts, &mut found);
    runge_kutta_growth(facts.model, &mut found);
    dissipation_limits(facts.model, &mut found);
    found
}

fn bodies(facts: &Facts<'_>, found: &mut Vec<String>) {
    for body in &facts.model.bodies {
        if let MaterialSpec::HenckyVonMises(metal) = &body.material
            && metal.young_modulus.largest() < SOFTEST_METAL
        {
            found.push(format!(
                "the Young's modulus of body `{}` is {} Pa: a plain number is in Pa; was a unit such as \"GPa\" forgotten?",
                body.name,
                metal.young_modulus.largest()
            ));
        }
        let positions = &body.body.positions;
        let start = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
        let (low, high) = positions
            .iter()
            .fold(start, |(low, high), x| (low.inf(x), high.sup(x)));
        let longest = (high - low).max();
        let transit = longest / body.material.wave_speeds().pressure;
        if facts.end < transit {
            found.push(format!(
                "time.end = {} s is shorter than one wave transit of body `{}`, {transit:.2e} s: nothing reaches its other end",
                facts.end, body.name
            ));
        }
    }
}

fn fillets(facts: &Facts<'_>, found: &mut Vec<String>) {
    for (obstacle, radius) in facts.model.obstacles.iter().zip(facts.smallest_fillets) {
        let Some(radius) = radius else { continue };
        for body in &facts.model.bodies {
            if body.body.spacing > *radius {
                found.push(format!(
                    "the spacing of body `{}`, {:.3e} m, is larger than the smallest fillet of obstacle `{}`, {radius:.3e} m: its particles see a sharp corner",
                    body.name, body.body.spacing, obstacle.obstacle.name
                ));
            }
        }
    }
}

/// Two-stage TVD Runge-Kutta amplifies an undamped wave of frequency ω by |G|² = 1 + (ω dt)⁴/4 per
/// step; the fourth-order dissipation of long waves balances it from κ⁽⁴⁾ = cfl³/4 on:
/// `[eq:rk2-growth]`, `[eq:rk2-limit]`.
fn runge_kutta_growth(model: &Model, found: &mut Vec<String>) {
    let Some(jst) = model.scheme.stabilisation.jst else {
        return;
    };
    let needed = model.scheme.cfl.powi(3) / 4.0;
    let coefficient = largest(jst.biharmonic);
    if model.scheme.integrator == Integrator::TvdRungeKutta && coefficient < needed {
        found.push(format!(
            "stabilisation.jst.biharmonic = {coefficient} is below cfl^3/4 = {needed:.3e}: tvd-rk2 lets elastic waves grow slowly (|G|^2 = 1 + z^4/4); \
             reduce time.cfl below {:.2} or use the leapfrog",
            (4.0 * coefficient).cbrt()
        ));
    }
}

fn largest(biharmonic: Biharmonic) -> f64 {
    match biharmonic {
        Biharmonic::Constant(value) => value,
        Biharmonic::FallingWithPlasticStrain { initial, last, .. } => initial.max(last),
    }
}

/// Explicit dissipation is stable while its largest rate times the time step stays below 2.
fn dissipation_limits(model: &Model, found: &mut Vec<String>) {
    let scheme = &model.scheme;
    let laplacian = model
        .bodies
        .iter()
        .map(|body| {
            let d = model.dimension.count();
            let reference = match scheme.smoothing_reference {
                SmoothingReference::Spacing => body.body.support_spacing,
                SmoothingReference::Volume => {
                    let volume: f64 = body.body.volumes.iter().sum();
                    #[expect(
                        clippy::cast_precision_loss,
                        reason = "counts of particles are far below 2^53"
                    )]
                    let each = volume / body.body.positions.len() as f64;
                    if d == 2 { each.sqrt() } else { each.cbrt() }
                }
            };
            largest_eigenvalue(
                scheme.kernel,
                scheme.smoothing_ratio * reference / body.body.spacing,
                model.dimension,
            )
        })
        .fold(0.0, f64::max);
    let mut check = |key: &str, coefficient: f64, rate: f64| {
        let product = rate * coefficient * scheme.cfl;
        if product > 2.0 {
            found.push(format!(
                "stabilisation.{key} = {coefficient} with time.cfl = {} may be unstable: rate times time step is up to {product:.2}, the limit is 2",
                scheme.cfl
            ));
        }
    };
    check("upwind", scheme.stabilisation.upwind, laplacian);
    if let Some(jst) = scheme.stabilisation.jst {
        check("jst.harmonic", jst.harmonic, laplacian);
        check(
            "jst.biharmonic",
            largest(jst.biharmonic),
            laplacian * laplacian,
        );
    }
}

/// Upper bound of the eigenvalues of the symmetric SPH Laplacian on an infinite cubic lattice of
/// spacing 1.
///
/// The weights w(r) ∝ −W′(r)/r are scaled so that Σ w r² = 2 d; no eigenvalue exceeds 2 Σ w.
fn largest_eigenvalue(kernel: Kernel, smoothing_length: f64, dimension: Dimension) -> f64 {
    let d = dimension.count();
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the support is a few spacings wide"
    )]
    let reach = (2.0 * smoothing_length).ceil().min(20.0) as i32;
    let depth = if d == 3 { reach } else { 0 };
    let (mut sum, mut moment) = (0.0, 0.0);
    for i in -reach..=reach {
        for j in -reach..=reach {
            for k in -depth..=depth {
                let squared = f64::from(i * i + j * j + k * k);
                if squared > 0.0 {
                    let weight =
                        -kernel.derivative_over_radius(squared.sqrt(), smoothing_length, d);
                    sum += weight;
                    moment += weight * squared;
                }
            }
        }
    }
    #[expect(clippy::cast_precision_loss, reason = "2 or 3")]
    let factor = 4.0 * d as f64;
    if moment > 0.0 {
        factor * sum / moment
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn laplacian_bound_is_the_finite_difference_value_for_nearest_neighbours_and_lower_beyond() {
        // Only the four (six) nearest neighbours lie in a support of 1.2 spacings.
        let nearest = largest_eigenvalue(Kernel::WendlandC2, 0.6, Dimension::PlaneStrain);
        assert!((nearest - 8.0).abs() < 1e-12, "{nearest}");
        let nearest = largest_eigenvalue(Kernel::WendlandC2, 0.6, Dimension::Solid);
        assert!((nearest - 12.0).abs() < 1e-12, "{nearest}");
        let wide = largest_eigenvalue(Kernel::QuinticSpline, 1.2, Dimension::PlaneStrain);
        assert!((2.0..8.0).contains(&wide), "{wide}");
    }
}
