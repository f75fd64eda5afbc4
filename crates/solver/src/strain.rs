//! Strain measures: velocity gradient (3.11a) and the evolution of F, H and J (3.14):
//! `[eq:strain]`, `[eq:cofactor]`, `[eq:jacobian]`; with bonds `[eq:bond-volume]`.

use jstsph_tensor::lanes::TILE;
use jstsph_tensor::{Mat3, Vec3, cofactor, double_dot, tensor_cross};

use crate::lines::LineFields;
use crate::local_steps::{Groups, Levels, Part};
use crate::model::{Formulation, Quadrature, Scheme};
use crate::parallel;
use crate::reference::{BodyReference, Reference};
use crate::state::{State, Workspace};

mod drift;

use drift::{Drift, GradientOf, Rates};

/// Which strain measures are integrated, and where they live.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Strains {
    pub(crate) formulation: Formulation,
    pub(crate) quadrature: Quadrature,
}

/// Whether something beside the drift of the leapfrog asks for G, or knows it already.
pub(crate) fn keeps_velocity_gradient(scheme: &Scheme) -> bool {
    scheme.formulation == Formulation::EulerianKernel
        || scheme.stabilisation.upwind != 0.0
        || scheme.stabilisation.hourglass != 0.0
}

/// The momenta with a fourth number, zero.
pub(crate) fn pad_momenta(state: &State, work: &mut Workspace) {
    let momentum = &state.momentum;
    parallel::fill(&mut work.padded_momentum, |a| padded(&momentum[a]));
}

/// A vector with a fourth number, zero.
#[inline]
pub(crate) fn padded(vector: &Vec3) -> [f64; 4] {
    [vector.x, vector.y, vector.z, 0.0]
}

/// G_q = Σ_c (p_c/ρ) ⊗ B_qc at every point, 1/s, by the padded momenta.
pub(crate) fn velocity_gradient(reference: &Reference, work: &mut Workspace) {
    for body in &reference.bodies {
        let field = &work.padded_momentum[body.particles.clone()];
        let gradients = &mut work.velocity_gradient[body.points.clone()];
        let field = (field, 1.0 / body.density);
        self::gradients(body, field, &mut work.lines, gradients);
    }
}

/// Gradients of a field over the particles of a body, times a factor, at its points.
pub(crate) fn gradients(
    body: &BodyReference,
    (field, factor): (&[[f64; 4]], f64),
    fields: &mut LineFields,
    out: &mut [Mat3],
) {
    let rows = GradientOf::new(body, field, factor);
    if let Some(lines) = &body.lines {
        fields.gradients(lines, field, factor);
        let (slots, fields) = (lines.points().slots(), &*fields);
        parallel::fill(out, |q| fields.tensor(slots[q], || rows.at(q)));
    } else {
        parallel::for_each_run(out, |offset, out| rows.read(offset, out));
    }
}

/// Advances F and J by `dt` with the velocity gradient of mid-step: the drift of the leapfrog. G is that
/// of the padded momenta, or what the workspace holds where `gradients_are_kept`.
///
/// With constant G, F is linear in time, H quadratic and det F cubic, and all are exact: H is cof F at all
/// times and needs no place. With particles J grows by the change of det F; with bonds ln J of a particle
/// by the shares of its bonds' ∫ tr(G F⁻¹) dt, midpoint rule. Leaves bounds of the smallest stretches
/// for the next time step.
pub(crate) fn drift(
    strains: Strains,
    reference: &Reference,
    state: &mut State,
    work: &mut Workspace,
    (dt, gradients_are_kept): (f64, bool),
) {
    let bonds = strains.quadrature == Quadrature::Bonds;
    let step = Drift {
        bonds,
        plane: reference.is_plane(),
        dt,
    };
    for (body, bounds) in reference.bodies.iter().zip(&mut work.stretch_bounds.bodies) {
        let points = body.points.clone();
        let rates = if gradients_are_kept {
            Rates::Kept(&work.velocity_gradient[points.clone()])
        } else {
            Rates::of(body, &work.padded_momentum, &mut work.lines)
        };
        parallel::for_each_chunk_of(
            (
                &mut state.deformation_gradient[points.clone()],
                &mut work.volume_change[points.clone()],
            ),
            (bounds, TILE),
            |first, f, change, bounds| step.advance(&rates, first, f, change, bounds),
        );
        let change = &work.volume_change[points];
        let dissipation = &work.jacobian_dissipation[body.particles.clone()];
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
    work.stretch_bounds.are_fresh = true;
    constrain(strains, reference, state);
}

/// [`drift`] of F of a part of the points with bonds, by the padded momenta; their changes of volume
/// are left in the workspace.
pub(crate) fn drift_part(
    reference: &Reference,
    (groups, level): (&[Groups], u8),
    state: &mut State,
    work: &mut Workspace,
    dt: f64,
) {
    let step = Drift {
        bonds: true,
        plane: reference.is_plane(),
        dt,
    };
    let bodies = reference.bodies.iter().zip(groups);
    for ((body, groups), bounds) in bodies.zip(&mut work.stretch_bounds.bodies) {
        let points = body.points.clone();
        let rates = if level > 0 {
            Rates::Rows(GradientOf::velocity(body, &work.padded_momentum))
        } else {
            Rates::of(body, &work.padded_momentum, &mut work.lines)
        };
        let out = (
            &mut state.deformation_gradient[points.clone()],
            &mut work.volume_change[points],
        );
        parallel::for_each_chunk_of(out, (bounds, TILE), |offset, f, change, bounds| {
            for run in groups
                .points
                .runs(offset..offset + f.len(), Levels::only(level))
            {
                let here = run.start - offset..run.end - offset;
                let tiles = here.start / TILE..here.end.div_ceil(TILE);
                step.advance(
                    &rates,
                    run.start,
                    &mut f[here.clone()],
                    &mut change[here],
                    &mut bounds[tiles],
                );
            }
        });
    }
}

/// J of the particles of a part, by the changes of volume of their bonds: `[eq:bond-volume]`.
pub(crate) fn grow_part(
    reference: &Reference,
    (groups, level): (&[Groups], u8),
    jacobian: &mut [f64],
    volume_change: &[f64],
) {
    for (body, groups) in reference.bodies.iter().zip(groups) {
        let change = &volume_change[body.points.clone()];
        let part = Part { groups, level };
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
    let rate_of = |f: &Mat3, h: &Mat3, g: &Mat3| {
        if bonds {
            3.0 * double_dot(h, g) / double_dot(h, f)
        } else {
            double_dot(h, g)
        }
    };
    let gradients = &mut state.deformation_gradient;
    if state.cofactor.is_empty() {
        parallel::for_each_pair(gradients, volume_change, |q, f, rate| {
            let g = &velocity_gradient[q];
            *rate = rate_of(f, &cofactor(f), g);
            *f += g * dt;
        });
    } else {
        let cofactors = &mut state.cofactor;
        parallel::for_each_triple(gradients, cofactors, volume_change, |q, f, h, rate| {
            let g = &velocity_gradient[q];
            *rate = rate_of(f, h, g);
            *h += tensor_cross(f, g) * dt;
            *f += g * dt;
        });
    }
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

/// F = 1 + grad(x − X) with the operator of (3.6) and J = det F: the strains of the displacement formulation (Ba & Gakwaya 2018). [eq:displacement-gradient]
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

/// Evaluates J where it is not integrated: the mean of det F.
pub(crate) fn constrain(strains: Strains, reference: &Reference, state: &mut State) {
    if strains.formulation.integrates_jacobian() {
        return;
    }
    for body in &reference.bodies {
        let gradients = &state.deformation_gradient[body.points.clone()];
        parallel::fill(&mut state.jacobian[body.particles.clone()], |a| {
            body.shares.mean(a, |q| gradients[q].determinant())
        });
    }
}

#[cfg(test)]
mod tests;
