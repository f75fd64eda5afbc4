//! Stress at the evaluation points, from their strains and committed history. Pure: nothing here
//! moves history; `commit` is called on one line of each integrator.

use std::sync::atomic::{AtomicUsize, Ordering};

use jstsph_material::{
    Block, BlockReader, BlockVisitor, History, Kinematics, Material, MaterialBlock, MaterialError,
};
use jstsph_tensor::Mat3;

use crate::local_steps::{Groups, Levels, Part};
use crate::model::Quadrature;
use crate::parallel;
use crate::reference::{BodyReference, Reference};
use crate::state::{Deformation, State, Workspace};
use crate::strain::Strains;

mod energy;
mod tile;

pub(crate) use energy::elastic_energy;

/// What the points of one body see.
#[derive(Clone, Copy)]
struct Points<'a> {
    strains: Strains,
    /// Whether nothing happens out of the plane.
    plane: bool,
    body: &'a BodyReference,
    jacobian: &'a [f64],
    temperature: &'a [f64],
    deformation: Deformation<'a>,
    volume: &'a [f64],
    dt: f64,
}

impl Points<'_> {
    /// Whether J is det F at the points themselves.
    fn without_jacobian(&self) -> bool {
        !self.strains.formulation.integrates_jacobian()
    }

    /// Whether the points are the particles.
    fn at_particles(&self) -> bool {
        self.strains.quadrature == Quadrature::Particles
    }

    /// Kinematics of a point: J is its own, or the geometric mean of those of its ends, so that a
    /// logarithmic pressure of the point is the mean of its ends' pressures.
    #[inline]
    fn kinematics(&self, q: usize) -> Kinematics {
        Kinematics {
            deformation_gradient: self.deformation.gradient[q],
            jacobian: self.jacobian(q),
            dt: self.dt,
            temperature: self.temperature(q),
        }
    }

    #[inline]
    fn jacobian(&self, q: usize) -> f64 {
        if self.without_jacobian() {
            return self.deformation.cofactor_and_determinant(q).1;
        }
        let [a, b] = self.body.ends[q];
        let (ja, jb) = (self.jacobian[a as usize], self.jacobian[b as usize]);
        // A bond one of whose ends is inverted must not look sound.
        if a == b {
            ja
        } else if ja > 0.0 && jb > 0.0 {
            (ja * jb).sqrt()
        } else {
            ja.min(jb)
        }
    }

    /// Temperature of a point: the mean of its ends.
    #[inline]
    fn temperature(&self, q: usize) -> f64 {
        let [a, b] = self.body.ends[q];
        0.5 * (self.temperature[a as usize] + self.temperature[b as usize])
    }
}

/// Finds the failure of a point by evaluating it again (responses are pure).
struct Failure<'a> {
    points: Points<'a>,
    point: usize,
}

impl BlockReader for Failure<'_> {
    type Output = Option<MaterialError>;
    fn visit<M: Material>(&mut self, block: &Block<M>) -> Self::Output {
        let now = self.points.kinematics(self.point);
        block
            .model
            .respond(&now, &block.committed[self.point])
            .err()
    }
}

struct Evaluation<'a> {
    points: Points<'a>,
    /// The points and particles that are evaluated, if not all.
    part: Option<Part<'a>>,
    volumetric_stress: &'a mut [f64],
    scaled_stress: &'a mut [Mat3],
    plastic_work: &'a mut [f64],
}

impl BlockVisitor for Evaluation<'_> {
    /// First point whose response failed.
    type Output = Option<usize>;

    fn visit<M: Material>(&mut self, block: &mut Block<M>) -> Self::Output {
        let points = self.points;
        let Block {
            model,
            committed,
            candidate,
        } = block;
        let (model, committed): (&M, &[M::History]) = (model, committed);
        let without_jacobian = points.without_jacobian();
        if !without_jacobian {
            let of_particle = |a: usize, stress: &mut f64| {
                *stress = model.volumetric_stress(points.jacobian[a], points.temperature[a]);
            };
            match &self.part {
                None => parallel::for_each(self.volumetric_stress, of_particle),
                Some(part) => part.for_each_jacobian(self.volumetric_stress, of_particle),
            }
        }
        let volumetric_stress: &[f64] = self.volumetric_stress;
        let pass = PointPass {
            points,
            model,
            volumetric_stress,
            // Only touched by a failing point; the smallest index makes the report deterministic.
            failed: AtomicUsize::new(usize::MAX),
        };
        let of_run = |offset: usize,
                      scaled_stress: &mut [Mat3],
                      plastic_work: &mut [f64],
                      candidate: &mut [M::History]| {
            let out = tile::Output {
                scaled_stress,
                plastic_work,
                candidate,
            };
            pass.evaluate(offset, committed, out);
        };
        let (stress, plastic_work) = (&mut *self.scaled_stress, &mut *self.plastic_work);
        match &self.part {
            None => parallel::for_each_chunk(stress, plastic_work, candidate, of_run),
            Some(Part { groups, level }) => {
                let out = (stress, plastic_work, &mut candidate[..]);
                groups
                    .points
                    .for_each_chunk(Levels::only(*level), out, of_run);
            }
        }
        let failed = pass.failed;
        let failed = failed.into_inner();
        (failed != usize::MAX).then_some(failed)
    }
}

/// The points of one body and what their stresses are made of.
struct PointPass<'a, M: Material> {
    points: Points<'a>,
    model: &'a M,
    volumetric_stress: &'a [f64],
    failed: AtomicUsize,
}

impl<M: Material> PointPass<'_, M> {
    /// τ_vol of a point: the mean of its ends, or its own where J is no unknown of its own.
    #[inline]
    fn pressure(&self, q: usize, jacobian: f64, temperature: f64, history: &M::History) -> f64 {
        let pressure = if self.points.without_jacobian() {
            self.model.volumetric_stress(jacobian, temperature)
        } else {
            let [a, b] = self.points.body.ends[q];
            0.5 * (self.volumetric_stress[a as usize] + self.volumetric_stress[b as usize])
        };
        if pressure > 0.0 && !self.model.carries_tension(history) {
            0.0
        } else {
            pressure
        }
    }

    /// V P, plastic work and history of one point; nothing but the failure is written if it fails.
    fn evaluate_point(
        &self,
        q: usize,
        committed: &M::History,
        scaled_stress: &mut Mat3,
        plastic_work: &mut f64,
        candidate: &mut M::History,
    ) {
        let points = &self.points;
        let now = points.kinematics(q);
        let Ok(response) = self.model.respond(&now, committed) else {
            self.failed.fetch_min(q, Ordering::Relaxed);
            return;
        };
        let pressure = self.pressure(q, now.jacobian, now.temperature, &response.history);
        let mut stress = response.kirchhoff_stress;
        stress.m11 += pressure;
        stress.m22 += pressure;
        stress.m33 += pressure;
        // [eq:piola]: P = σ H with σ = τ/J (A.4); with bonds τ F⁻ᵀ, conjugate to tr(G F⁻¹).
        let (cofactor, determinant) = points.deformation.cofactor_and_determinant(q);
        let jacobian = if points.at_particles() {
            now.jacobian
        } else {
            determinant
        };
        *scaled_stress = stress * cofactor * (points.volume[q] / jacobian);
        *plastic_work = response.plastic_work;
        *candidate = response.history;
    }
}

/// A failed response: body, point of the body, cause.
#[derive(Debug)]
pub(crate) struct StressFailure {
    pub(crate) body: usize,
    pub(crate) point: usize,
    pub(crate) source: MaterialError,
}

/// V P at every point, from the state and the committed history; writes the candidate history.
/// `dt` is the time since the committed history, for rate-dependent models.
pub(crate) fn evaluate(
    strains: Strains,
    reference: &Reference,
    state: &State,
    materials: &mut [MaterialBlock],
    work: &mut Workspace,
    dt: f64,
) -> Result<(), StressFailure> {
    for (index, (body, material)) in reference.bodies.iter().zip(materials).enumerate() {
        let evaluation = Evaluation {
            points: points_of(strains, reference, body, state, dt),
            part: None,
            volumetric_stress: &mut work.volumetric_stress[body.particles.clone()],
            scaled_stress: &mut work.scaled_stress[body.points.clone()],
            plastic_work: &mut work.plastic_work[body.points.clone()],
        };
        evaluation.run(index, material)?;
    }
    Ok(())
}

/// [`evaluate`] for a part of each body. The stresses of the points go to `scaled_stress`, with the
/// pressures of all particles that `volumetric_stress` holds.
pub(crate) fn evaluate_part(
    (strains, dt): (Strains, f64),
    (reference, state): (&Reference, &State),
    (groups, level): (&[Groups], u8),
    materials: &mut [MaterialBlock],
    (volumetric_stress, scaled_stress): (&mut [f64], &mut [Mat3]),
    plastic_work: &mut [f64],
) -> Result<(), StressFailure> {
    let bodies = reference.bodies.iter().zip(materials).zip(groups);
    for (index, ((body, material), groups)) in bodies.enumerate() {
        let evaluation = Evaluation {
            points: points_of(strains, reference, body, state, dt),
            part: Some(Part { groups, level }),
            volumetric_stress: &mut volumetric_stress[body.particles.clone()],
            scaled_stress: &mut scaled_stress[body.points.clone()],
            plastic_work: &mut plastic_work[body.points.clone()],
        };
        evaluation.run(index, material)?;
    }
    Ok(())
}

impl Evaluation<'_> {
    /// Evaluates the points of one body, whose number is `body`.
    fn run(mut self, body: usize, material: &mut MaterialBlock) -> Result<(), StressFailure> {
        let Some(point) = material.visit(&mut self) else {
            return Ok(());
        };
        let points = self.points;
        let source = material
            .visit_ref(&mut Failure { points, point })
            .unwrap_or(MaterialError::NotFinite {
                jacobian: f64::NAN,
                determinant: f64::NAN,
            });
        Err(StressFailure {
            body,
            point,
            source,
        })
    }
}

fn points_of<'a>(
    strains: Strains,
    reference: &'a Reference,
    body: &'a BodyReference,
    state: &'a State,
    dt: f64,
) -> Points<'a> {
    Points {
        strains,
        plane: reference.is_plane(),
        body,
        jacobian: &state.jacobian[body.particles.clone()],
        temperature: &state.temperature[body.particles.clone()],
        deformation: state.deformation(body.points.clone()),
        volume: &reference.point_volume[body.points.clone()],
        dt,
    }
}

/// Reads the equivalent plastic strain of every point from the committed history.
struct PlasticStrain<'a> {
    out: &'a mut [f64],
}

impl BlockReader for PlasticStrain<'_> {
    type Output = ();
    fn visit<M: Material>(&mut self, block: &Block<M>) {
        parallel::fill(self.out, |q| block.committed[q].equivalent_plastic_strain());
    }
}

/// Equivalent plastic strain of every point.
pub(crate) fn equivalent_plastic_strain(
    reference: &Reference,
    materials: &[MaterialBlock],
    out: &mut [f64],
) {
    for (body, material) in reference.bodies.iter().zip(materials) {
        let out = &mut out[body.points.clone()];
        material.visit_ref(&mut PlasticStrain { out });
    }
}

#[cfg(test)]
mod tests;
