//! Internal force (3.10), `[eq:force]`, hourglass stiffness, and external forces.

use jstsph_tensor::{Mat3, Vec3};

use crate::lines::LineFields;
use crate::model::{Condition, ConditionKind, Model, Quadrature, Signal};
use crate::parallel;
use crate::reference::{BodyReference, Reference};
use crate::state::{State, Workspace};

/// T_c = (1/V_c) Σ_q V_q P_q B_qc per unit reference volume, N/m³; approximates −DIV P.
///
/// Σ_c V_c T_c = 0 to round-off for any stress, because Σ_c B_qc = 0.
pub(crate) fn internal(reference: &Reference, work: &mut Workspace) {
    for body in &reference.bodies {
        let stress = &work.scaled_stress[body.points.clone()];
        let volume = &reference.volume[body.particles.clone()];
        let force = &mut work.internal_force[body.particles.clone()];
        divergences(body, stress, &|a| volume[a], &mut work.lines, force);
    }
}

/// Σ_q S_q B_qc of tensors at the points of a body, divided by `divisor`, for its particles.
pub(crate) fn divergences(
    body: &BodyReference,
    tensors: &[Mat3],
    divisor: &(impl Fn(usize) -> f64 + Sync),
    fields: &mut LineFields,
    out: &mut [Vec3],
) {
    if let Some(lines) = &body.lines {
        fields.divergences((body, lines), tensors, divisor, out);
        return;
    }
    parallel::for_each_run(out, |first, out| {
        divergences_of_run(body, first, tensors, divisor, out);
    });
}

/// The same for a run of particles from `first` on, row by row.
pub(crate) fn divergences_of_run(
    body: &BodyReference,
    first: usize,
    tensors: &[Mat3],
    divisor: &impl Fn(usize) -> f64,
    out: &mut [Vec3],
) {
    body.gradient.divergences(first, tensors, out);
    for (k, out) in out.iter_mut().enumerate() {
        *out /= divisor(first + k);
    }
}

/// Averages G and F of the bonds to the particles, for the pair stabilisations.
pub(crate) fn average_to_particles(reference: &Reference, state: &State, work: &mut Workspace) {
    if reference.quadrature == Quadrature::Particles {
        return;
    }
    for body in reference.bodies.iter().filter(|body| body.pairs.is_some()) {
        let (range, points) = (body.particles.clone(), body.points.clone());
        let (velocity, deformation) = (
            &work.velocity_gradient[points.clone()],
            &state.deformation_gradient[points],
        );
        let averaged_velocity = &mut work.particle_velocity_gradient[range.clone()];
        let averaged_deformation = &mut work.particle_deformation_gradient[range];
        parallel::for_each_pair(averaged_velocity, averaged_deformation, |a, g, f| {
            *g = body.shares.mean_tensor(a, |q| velocity[q]);
            *f = body.shares.mean_tensor(a, |q| deformation[q]);
        });
    }
}

/// Adds the hourglass stiffness `[eq:hourglass]` to the internal force: the negative gradient of its energy
///
/// ```text
///   E = ¼ ζ μ Σ_ab V_a V_b w_ab |r_ab|² ,   r_ab = x_b − x_a − ½ (F_a + F_b)(X_b − X_a)
///   T_a −= ζ μ Σ_b V_b w_ab r_ab ,          V P at a −= ½ ζ μ V_a Σ_b V_b w_ab r_ab ⊗ (X_b − X_a)
/// ```
///
/// The first part acts on the positions (Ganzenmüller 2015, in pair form), the second on F, which
/// moves with them: without it the energy of several per cent of the plastic work is lost from the
/// balance. Zero for any affine motion; momentum-exact pair by pair and by Σ_c B_qc = 0. With bonds F
/// of a particle is the mean over its bonds, which share its part of the stress. docs/theory.md.
pub(crate) fn hourglass(
    reference: &Reference,
    state: &State,
    coefficient: f64,
    work: &mut Workspace,
) {
    for body in &reference.bodies {
        let Some(pairs) = &body.pairs else { continue };
        let (range, points) = (body.particles.clone(), body.points.clone());
        let deformation = match reference.quadrature {
            Quadrature::Particles => &state.deformation_gradient[points.clone()],
            Quadrature::Bonds => &work.particle_deformation_gradient[range.clone()],
        };
        let (position, start) = (
            &state.position[range.clone()],
            &reference.position[range.clone()],
        );
        let factor = coefficient * body.shear_modulus;
        parallel::for_each_pair(
            &mut work.internal_force[range.clone()],
            &mut work.hourglass_stress[range.clone()],
            |a, force, stress| {
                let (mut sum, mut moment) = (Vec3::zeros(), Mat3::zeros());
                for (b, weight) in pairs.row(a).entries() {
                    let offset = start[b] - start[a];
                    let predicted = (deformation[a] + deformation[b]) * offset * 0.5;
                    let residual = (position[b] - position[a] - predicted) * *weight;
                    sum += residual;
                    moment += residual * offset.transpose();
                }
                *force -= sum * factor;
                *stress = moment * (-0.5 * factor);
            },
        );
        // Each point takes the share of its ends, V_q / ends: at a particle all of it.
        let stress = &work.hourglass_stress[range.clone()];
        let point_volume = &reference.point_volume[points.clone()];
        parallel::fill(&mut work.hourglass_point_stress[points.clone()], |q| {
            let [a, b] = body.ends[q];
            (stress[a as usize] + stress[b as usize]) * (0.5 * point_volume[q])
        });
        let point_stress = &work.hourglass_point_stress[points];
        let volume = &reference.volume[range.clone()];
        parallel::for_each(&mut work.internal_force[range], |c, force| {
            *force += body.gradient.divergence_at(c, point_stress) / volume[c];
        });
    }
}

/// Energy stored by the hourglass stiffness, ¼ ζ μ Σ_ab V_a V_b w_ab |·|², J.
///
/// Averages F anew, because the buffers hold that of the last force evaluation: none yet at the
/// start of a run, stage 2 of a Runge-Kutta step. Allocates, and is meant for output.
pub(crate) fn hourglass_energy(reference: &Reference, state: &State, coefficient: f64) -> f64 {
    let mut total = 0.0;
    for body in &reference.bodies {
        let Some(pairs) = &body.pairs else { continue };
        let range = body.particles.clone();
        let of_points = &state.deformation_gradient[body.points.clone()];
        let mut deformation = vec![Mat3::zeros(); range.len()];
        parallel::fill(&mut deformation, |a| {
            body.shares.mean_tensor(a, |q| of_points[q])
        });
        let (position, start) = (
            &state.position[range.clone()],
            &reference.position[range.clone()],
        );
        let volume = &reference.volume[range];
        total += 0.25
            * coefficient
            * body.shear_modulus
            * parallel::sum(volume.len(), 0.0, |a| {
                let mut sum = 0.0;
                for (b, weight) in pairs.row(a).entries() {
                    let offset = start[b] - start[a];
                    let predicted = (deformation[a] + deformation[b]) * offset * 0.5;
                    sum += weight * (position[b] - position[a] - predicted).norm_squared();
                }
                volume[a] * sum
            });
    }
    total
}

/// Body forces and tractions: everything that pushes and is neither a constraint nor a contact.
#[derive(Clone, Debug)]
pub(crate) struct Loads {
    body_forces: Vec<Option<[Signal; 3]>>,
    tractions: Vec<Condition>,
}

impl Loads {
    pub(crate) fn new(model: &Model) -> Self {
        Self {
            body_forces: model
                .bodies
                .iter()
                .map(|body| body.body_force.clone())
                .collect(),
            tractions: model
                .conditions
                .iter()
                .filter(|condition| matches!(condition.kind, ConditionKind::Traction { .. }))
                .cloned()
                .collect(),
        }
    }

    /// Whether nothing pushes.
    pub(crate) fn is_empty(&self) -> bool {
        self.tractions.is_empty() && self.body_forces.iter().all(Option::is_none)
    }

    /// ρ b + A t / V of every particle at `time`, N/m³.
    pub(crate) fn evaluate(&self, reference: &Reference, time: f64, external_force: &mut [Vec3]) {
        if self.is_empty() {
            return;
        }
        external_force.fill(Vec3::zeros());
        for (body, signals) in reference.bodies.iter().zip(&self.body_forces) {
            let Some(signals) = signals else { continue };
            let position = &reference.position[body.particles.clone()];
            parallel::fill(&mut external_force[body.particles.clone()], |a| {
                vector(signals, time, &position[a]) * body.material_density
            });
        }
        for condition in &self.tractions {
            let ConditionKind::Traction { areas, traction } = &condition.kind else {
                continue;
            };
            let first = reference.bodies[condition.body].particles.start;
            for (&particle, area) in condition.particles.iter().zip(areas) {
                let a = first + particle as usize;
                external_force[a] +=
                    vector(traction, time, &reference.position[a]) * (area / reference.volume[a]);
            }
        }
    }
}

/// Three signals as a vector.
pub(crate) fn vector(signals: &[Signal; 3], time: f64, reference_position: &Vec3) -> Vec3 {
    Vec3::new(
        signals[0].at(time, reference_position),
        signals[1].at(time, reference_position),
        signals[2].at(time, reference_position),
    )
}
