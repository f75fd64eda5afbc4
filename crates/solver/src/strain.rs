//! Strain measures: velocity gradient (3.11a) and the evolution of F, H and J (3.14):
//! `[eq:strain]`, `[eq:cofactor]`, `[eq:jacobian]`; with bonds `[eq:bond-volume]`.

use jstsph_tensor::{Mat3, cofactor, double_dot, tensor_cross};

use crate::local_steps::{Groups, Part};
use crate::model::{Formulation, Quadrature};
use crate::parallel;
use crate::reference::Reference;
use crate::state::{State, Workspace};

mod drift;

/// Which strain measures are integrated, and where they live.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Strains {
    pub(crate) formulation: Formulation,
    pub(crate) quadrature: Quadrature,
}

/// G_q = Σ_c (p_c/ρ) ⊗ B_qc at every point, 1/s.
pub(crate) fn velocity_gradient(reference: &Reference, state: &State, work: &mut Workspace) {
    for body in &reference.bodies {
        let range = body.particles.clone();
        let inverse_density = 1.0 / body.density;
        let momentum = &state.momentum[range.clone()];
        let padded = &mut work.padded_momentum[range];
        parallel::fill(padded, |a| {
            [momentum[a].x, momentum[a].y, momentum[a].z, 0.0]
        });
        let padded = &*padded;
        let gradients = &mut work.velocity_gradient[body.points.clone()];
        parallel::for_each_run(gradients, |offset, gradients| {
            body.gradient
                .scaled_gradients(offset, padded, inverse_density, gradients);
        });
    }
}

/// Advances F, H and J by `dt` with the velocity gradient of mid-step: the drift of the leapfrog.
///
/// With constant G, F is linear and H quadratic in time; H is advanced exactly (it stays the
/// cofactor of F), and J by Simpson's rule, exact for the cubic det F. With bonds, ln J of a
/// particle grows by the shares of its bonds' ∫ tr(G F⁻¹) dt, midpoint rule.
pub(crate) fn drift(
    strains: Strains,
    reference: &Reference,
    state: &mut State,
    work: &mut Workspace,
    dt: f64,
) {
    let Workspace {
        velocity_gradient,
        volume_change,
        jacobian_dissipation,
        ..
    } = work;
    let bonds = strains.quadrature == Quadrature::Bonds;
    let plane = reference.is_plane();
    let step = drift::Drift { bonds, plane, dt };
    parallel::for_each_chunk(
        &mut state.deformation_gradient,
        &mut state.cofactor,
        volume_change,
        |offset, f, h, change| {
            let g = &velocity_gradient[offset..offset + f.len()];
            step.advance(g, f, h, change);
        },
    );
    for body in &reference.bodies {
        let change = &volume_change[body.points.clone()];
        let dissipation = &jacobian_dissipation[body.particles.clone()];
        parallel::for_each(
            &mut state.jacobian[body.particles.clone()],
            |a, jacobian| {
                let grown = if bonds {
                    *jacobian * body.shares.mean(a, |q| change[q]).exp()
                } else {
                    *jacobian + change[a]
                };
                *jacobian = grown + dt * dissipation[a];
            },
        );
    }
    constrain(strains, reference, state);
}

/// [`drift`] of F and H of a part of the points with bonds, by their velocity gradients; their changes
/// of volume are left in the workspace.
pub(crate) fn drift_part(
    reference: &Reference,
    (groups, fine): (&[Groups], bool),
    state: &mut State,
    work: &mut Workspace,
    dt: f64,
) {
    let step = drift::Drift {
        bonds: true,
        plane: reference.is_plane(),
        dt,
    };
    for (body, groups) in reference.bodies.iter().zip(groups) {
        let points = body.points.clone();
        let gradients = &work.velocity_gradient[points.clone()];
        let out = (
            &mut state.deformation_gradient[points.clone()],
            &mut state.cofactor[points.clone()],
            &mut work.volume_change[points],
        );
        groups
            .fine
            .for_each_chunk(fine, out, |first, f, h, change| {
                step.advance(&gradients[first..first + f.len()], f, h, change);
            });
    }
}

/// J of the particles of a part, by the changes of volume of their bonds: `[eq:bond-volume]`.
pub(crate) fn grow_part(
    reference: &Reference,
    (groups, fine): (&[Groups], bool),
    jacobian: &mut [f64],
    volume_change: &[f64],
) {
    for (body, groups) in reference.bodies.iter().zip(groups) {
        let change = &volume_change[body.points.clone()];
        let part = Part { groups, fine };
        part.for_each_jacobian(&mut jacobian[body.particles.clone()], |a, jacobian| {
            *jacobian *= body.shares.mean(a, |q| change[q]).exp();
        });
    }
}

/// Advances F, H and J by `dt` with their rates at the present state: one stage of TVD-RK2.
pub(crate) fn euler(
    strains: Strains,
    reference: &Reference,
    state: &mut State,
    work: &mut Workspace,
    dt: f64,
) {
    let Workspace {
        velocity_gradient,
        volume_change,
        jacobian_dissipation,
        ..
    } = work;
    let bonds = strains.quadrature == Quadrature::Bonds;
    parallel::for_each_triple(
        &mut state.deformation_gradient,
        &mut state.cofactor,
        volume_change,
        |q, f, h, rate| {
            let g = &velocity_gradient[q];
            *rate = if bonds {
                3.0 * double_dot(h, g) / double_dot(h, f)
            } else {
                double_dot(h, g)
            };
            *h += tensor_cross(f, g) * dt;
            *f += g * dt;
        },
    );
    for body in &reference.bodies {
        let rate = &volume_change[body.points.clone()];
        let dissipation = &jacobian_dissipation[body.particles.clone()];
        parallel::for_each(
            &mut state.jacobian[body.particles.clone()],
            |a, jacobian| {
                let growth = if bonds {
                    *jacobian * body.shares.mean(a, |q| rate[q])
                } else {
                    rate[a]
                };
                *jacobian += dt * (growth + dissipation[a]);
            },
        );
    }
    constrain(strains, reference, state);
}

/// F = 1 + grad(x − X) with the operator of (3.6), H = cof F and J = det F: the strains of the
/// displacement formulation (Ba & Gakwaya 2018). [eq:displacement-gradient]
pub(crate) fn from_positions(
    strains: Strains,
    reference: &Reference,
    state: &mut State,
    work: &mut Workspace,
) {
    let position = &state.position;
    parallel::fill(&mut work.displacement, |a| {
        position[a] - reference.position[a]
    });
    for body in &reference.bodies {
        let displacement = &work.displacement[body.particles.clone()];
        parallel::fill(&mut state.deformation_gradient[body.points.clone()], |q| {
            Mat3::identity() + body.gradient.gradient_at(q, displacement)
        });
    }
    constrain(strains, reference, state);
}

/// Evaluates the measures that the reduced systems do not integrate: H = cof F and J = det F.
pub(crate) fn constrain(strains: Strains, reference: &Reference, state: &mut State) {
    if strains.formulation == Formulation::MomentumGradientCofactorJacobian {
        return;
    }
    let gradients: &[Mat3] = &state.deformation_gradient;
    parallel::fill(&mut state.cofactor, |q| cofactor(&gradients[q]));
    if !strains.formulation.integrates_jacobian() {
        for body in &reference.bodies {
            let gradients = &gradients[body.points.clone()];
            parallel::fill(&mut state.jacobian[body.particles.clone()], |a| {
                body.shares.mean(a, |q| gradients[q].determinant())
            });
        }
    }
}

#[cfg(test)]
mod tests;
