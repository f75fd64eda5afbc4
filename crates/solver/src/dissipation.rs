//! Artificial dissipation of momentum and Jacobian: JST (3.12)-(3.13), `[eq:harmonic]`,
//! `[eq:biharmonic]`, and upwind, `[eq:upwind]`.

use jstsph_tensor::Vec3;

use crate::model::{Biharmonic, Jst, Quadrature, Stabilisation};
use crate::reference::Reference;
use crate::state::{State, Workspace};
use crate::{parallel, strain, viscosity};

impl Biharmonic {
    /// κ⁽⁴⁾ at an equivalent plastic strain, (4.2).
    #[inline]
    pub(crate) fn at(&self, plastic_strain: f64) -> f64 {
        match *self {
            Self::Constant(coefficient) => coefficient,
            Self::FallingWithPlasticStrain {
                initial,
                last,
                strain,
            } => {
                let fraction = (plastic_strain / strain).min(1.0);
                initial + (last - initial) * fraction
            }
        }
    }

    /// Largest value it takes.
    #[must_use]
    pub fn largest(&self) -> f64 {
        match *self {
            Self::Constant(coefficient) => coefficient,
            Self::FallingWithPlasticStrain { initial, last, .. } => initial.max(last),
        }
    }
}

/// D(p) and D(J) of the present state.
///
/// ```text
///   D2(U) = κ⁽²⁾ c Δx Lap U ,    D4(U) = −c Δx³ Lap(κ⁽⁴⁾ Lap U)
/// ```
///
/// κ⁽⁴⁾ stands inside the outer Laplacian: where it varies in space, the paper's form with it
/// outside neither conserves momentum nor has a definite sign; for a constant one they agree.
/// Writing Lap U instead of the paper's D2/(κ⁽²⁾ c Δx) allows κ⁽²⁾ = 0.
///
/// Upwind: D(p)_a = β c Δx Σ_b V_b w_ab [p_b − p_a − ½ ρ (G_a + G_b)(X_b − X_a)], zero for affine
/// motion (after Lee, Gil, Ghavamian & Bonet 2019; docs/theory.md).
pub(crate) fn evaluate(
    stabilisation: &Stabilisation,
    reference: &Reference,
    state: &State,
    plastic_strain: &[f64],
    work: &mut Workspace,
) {
    match &stabilisation.jst {
        Some(jst) => apply_jst(jst, reference, state, plastic_strain, work),
        None if stabilisation.upwind != 0.0 || stabilisation.viscosity.is_some() => {
            work.dissipation.fill(Vec3::zeros());
        }
        None => {}
    }
    if stabilisation.upwind != 0.0 {
        add_upwind(stabilisation.upwind, reference, state, work);
    }
    if let Some(viscosity) = &stabilisation.viscosity {
        viscosity::add(viscosity, reference, state, work);
    }
}

fn apply_jst(
    jst: &Jst,
    reference: &Reference,
    state: &State,
    plastic_strain: &[f64],
    work: &mut Workspace,
) {
    for body in &reference.bodies {
        let Some(operator) = &body.laplacian else {
            continue;
        };
        let range = body.particles.clone();
        let harmonic = jst.harmonic * body.wave_speed * body.spacing;
        let biharmonic = body.wave_speed * body.spacing.powi(3);
        let strain = &plastic_strain[body.points.clone()];
        let coefficient =
            |a: usize| biharmonic * jst.biharmonic.at(body.shares.mean(a, |q| strain[q]));

        let momentum = &state.momentum[range.clone()];
        // Both parts in one outer sum: Lap U weighted by κ⁽⁴⁾ c Δx³, and κ⁽²⁾ c Δx Lap U beside it.
        parallel::for_each_pair(
            &mut work.laplacian[range.clone()],
            &mut work.dissipation[range.clone()],
            |a, scaled, dissipation| {
                let laplacian = operator.difference_at(a, momentum);
                *dissipation = laplacian * harmonic;
                *scaled = laplacian * coefficient(a);
            },
        );
        let scaled = &work.laplacian[range.clone()];
        parallel::for_each(&mut work.dissipation[range.clone()], |a, dissipation| {
            *dissipation -= operator.difference_at(a, scaled);
        });

        if jst.on_jacobian {
            let jacobian = &state.jacobian[range.clone()];
            parallel::for_each_pair(
                &mut work.jacobian_laplacian[range.clone()],
                &mut work.jacobian_dissipation[range.clone()],
                |a, scaled, dissipation| {
                    let laplacian = operator.scalar_difference_at(a, jacobian);
                    *dissipation = laplacian * harmonic;
                    *scaled = laplacian * coefficient(a);
                },
            );
            let scaled = &work.jacobian_laplacian[range.clone()];
            parallel::for_each(&mut work.jacobian_dissipation[range], |a, dissipation| {
                *dissipation -= operator.scalar_difference_at(a, scaled);
            });
        }
    }
}

fn add_upwind(upwind: f64, reference: &Reference, state: &State, work: &mut Workspace) {
    for body in &reference.bodies {
        let Some(jumps) = &body.jumps else { continue };
        let range = body.particles.clone();
        let gradient = match reference.quadrature {
            Quadrature::Particles => &work.velocity_gradient[body.points.clone()],
            Quadrature::Bonds => &work.particle_velocity_gradient[range.clone()],
        };
        let momentum = &state.momentum[range.clone()];
        // Others have used the buffer since the velocity gradient was computed.
        let padded = &mut work.padded_momentum[range.clone()];
        parallel::fill(padded, |a| strain::padded(&momentum[a]));
        let padded = &*padded;
        let factors = [upwind * body.wave_speed * body.spacing, body.density];
        parallel::for_each_run(&mut work.dissipation[range], |offset, dissipation| {
            jumps.add_jumps(offset, padded, gradient, factors, dissipation);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn biharmonic_coefficient_falls_linearly_and_stays() {
        // (4.2) of Greto & Kulasegaram 2019.
        let law = Biharmonic::FallingWithPlasticStrain {
            initial: 1.0 / 64.0,
            last: 1.0 / 4096.0,
            strain: 0.5,
        };
        assert_eq!(law.at(0.0), 1.0 / 64.0);
        let printed = 1.0 / 64.0 - 2.0 * (1.0 / 64.0 - 1.0 / 4096.0) * 0.2;
        assert!((law.at(0.2) - printed).abs() < 1e-17);
        assert_eq!(law.at(0.5), 1.0 / 4096.0);
        assert_eq!(law.at(3.0), 1.0 / 4096.0);
        assert_eq!(law.largest(), 1.0 / 64.0);
    }
}
