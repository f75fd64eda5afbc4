//! Fields of the particles as they are written and drawn.

use jstsph_material::{Block, BlockReader, History, Material};
use jstsph_tensor::{Mat3, Vec3, von_mises};

use crate::parallel;
use crate::reference::{BodyReference, Shares};
use crate::simulation::Simulation;
use crate::time_step::smallest_stretch;

/// Fields per particle at the time of the positions; quantities of the evaluation points are
/// volume-weighted means over the points of a particle.
#[derive(Clone, Debug)]
pub struct ParticleFields {
    /// Velocity, m/s.
    pub velocity: Vec<Vec3>,
    /// Displacement x − X, m.
    pub displacement: Vec<Vec3>,
    /// F.
    pub deformation_gradient: Vec<Mat3>,
    /// det F, whose difference from the unknown J is a measure of the scheme.
    pub determinant: Vec<f64>,
    /// Cauchy stress, Pa.
    pub cauchy_stress: Vec<Mat3>,
    /// Von Mises stress, Pa.
    pub von_mises_stress: Vec<f64>,
    /// One third of the trace of the Cauchy stress, Pa: tension positive.
    pub pressure: Vec<f64>,
    /// Equivalent plastic strain.
    pub equivalent_plastic_strain: Vec<f64>,
    /// Temperature, K.
    pub temperature: Vec<f64>,
    /// Pressure wave speed in the reference configuration over the smallest stretch (3.17), m/s.
    pub wave_speed: Vec<f64>,
}

/// A vector of `value(i)`, or none at all.
fn filled<T: Clone + Send>(
    wanted: bool,
    items: usize,
    zero: T,
    value: impl Fn(usize) -> T + Sync,
) -> Vec<T> {
    let mut filled = vec![zero; if wanted { items } else { 0 }];
    parallel::fill(&mut filled, value);
    filled
}

/// One particle at the time of the positions: its fields, each computed when it is asked for, with the
/// bits of [`ParticleFields`].
#[derive(Clone, Copy, Debug)]
pub struct Particle<'a> {
    simulation: &'a Simulation,
    /// Its body, and its indices in the simulation and in the body.
    body: usize,
    index: usize,
    local: usize,
}

impl Particle<'_> {
    /// Velocity, m/s.
    #[must_use]
    pub fn velocity(&self) -> Vec3 {
        let Simulation { state, ledger, .. } = self.simulation;
        let a = self.index;
        let momentum = if self.simulation.synchronised {
            state.momentum[a]
        } else {
            (state.momentum[a] + ledger.momentum_before[a]) * 0.5
        };
        momentum / self.simulation.reference.density[a]
    }

    /// Displacement x − X, m.
    #[must_use]
    pub fn displacement(&self) -> Vec3 {
        let simulation = self.simulation;
        simulation.state.position[self.index] - simulation.reference.position[self.index]
    }

    /// F.
    #[must_use]
    pub fn deformation_gradient(&self) -> Mat3 {
        self.mean_tensor(|q| *self.gradient(q))
    }

    /// det F.
    #[must_use]
    pub fn determinant(&self) -> f64 {
        self.mean(|q| self.gradient(q).determinant())
    }

    /// Cauchy stress, Pa.
    #[must_use]
    pub fn cauchy_stress(&self) -> Mat3 {
        let Simulation {
            reference, work, ..
        } = self.simulation;
        // Computed for both ends of a bond rather than kept: that of the points is three times as long.
        self.mean_tensor(|q| {
            let f = self.gradient(q);
            // σ = P Fᵀ / det F.
            let cauchy = work.scaled_stress[q] * f.transpose()
                / (reference.point_volume[q] * f.determinant());
            jstsph_tensor::symmetric_part(&cauchy)
        })
    }

    /// Von Mises stress, Pa.
    #[must_use]
    pub fn von_mises_stress(&self) -> f64 {
        von_mises(&self.cauchy_stress())
    }

    /// One third of the trace of the Cauchy stress, Pa: tension positive.
    #[must_use]
    pub fn pressure(&self) -> f64 {
        jstsph_tensor::mean_trace(&self.cauchy_stress())
    }

    /// Equivalent plastic strain.
    #[must_use]
    pub fn equivalent_plastic_strain(&self) -> f64 {
        let material = &self.simulation.materials[self.body];
        material.visit_ref(&mut MeanPlasticStrain {
            shares: &self.owner().shares,
            particle: self.local,
        })
    }

    /// Pressure wave speed in the reference configuration over the smallest stretch (3.17), m/s.
    #[must_use]
    pub fn wave_speed(&self) -> f64 {
        self.owner().wave_speed / self.mean(|q| smallest_stretch(self.gradient(q)))
    }

    fn owner(&self) -> &BodyReference {
        &self.simulation.reference.bodies[self.body]
    }

    /// F of a point of the simulation.
    #[inline]
    fn gradient(&self, q: usize) -> &Mat3 {
        &self.simulation.state.deformation_gradient[q]
    }

    /// Mean over the points of the particle, which are given by their indices in the simulation.
    fn mean(&self, field: impl Fn(usize) -> f64) -> f64 {
        let (owner, first) = (self.owner(), self.owner().points.start);
        owner.shares.mean(self.local, |q| field(first + q))
    }

    fn mean_tensor(&self, field: impl Fn(usize) -> Mat3) -> Mat3 {
        let (owner, first) = (self.owner(), self.owner().points.start);
        owner.shares.mean_tensor(self.local, |q| field(first + q))
    }
}

/// Mean equivalent plastic strain of the points of a particle, from the committed history.
struct MeanPlasticStrain<'a> {
    shares: &'a Shares,
    particle: usize,
}

impl BlockReader for MeanPlasticStrain<'_> {
    type Output = f64;
    fn visit<M: Material>(&mut self, block: &Block<M>) -> f64 {
        let strain = |q: usize| block.committed[q].equivalent_plastic_strain();
        self.shares.mean(self.particle, strain)
    }
}

/// Largest mean equivalent plastic strain of the particles of a body.
struct LargestPlasticStrain<'a> {
    shares: &'a Shares,
    particles: usize,
}

impl BlockReader for LargestPlasticStrain<'_> {
    type Output = f64;
    fn visit<M: Material>(&mut self, block: &Block<M>) -> f64 {
        let shares = self.shares;
        let strain = |q: usize| block.committed[q].equivalent_plastic_strain();
        parallel::reduce(
            self.particles,
            &|range| range.map(|a| shares.mean(a, strain)).fold(0.0, f64::max),
            &f64::max,
        )
    }
}

impl Simulation {
    /// The fields of one particle.
    ///
    /// # Panics
    /// If there is no such particle.
    #[must_use]
    pub fn particle(&self, particle: usize) -> Particle<'_> {
        let (body, local) = self.reference.owner_of_particle(particle);
        Particle {
            simulation: self,
            body,
            index: particle,
            local,
        }
    }

    /// Computes all fields; allocates, and is meant for output.
    #[must_use]
    pub fn particle_fields(&self) -> ParticleFields {
        self.fields(|_| true)
    }

    /// The fields with these names (of the entries of [`ParticleFields`]), with the bits of
    /// [`particle_fields`](Self::particle_fields) in a fraction of its time; the others are empty.
    #[must_use]
    pub fn fields_for(&self, names: &[&str]) -> ParticleFields {
        self.fields(|name| names.contains(&name))
    }

    fn fields<'a>(&'a self, wanted: impl Fn(&str) -> bool) -> ParticleFields {
        let particles = self.reference.position.len();
        let of = |a: usize| self.particle(a);
        let scalar = |name: &str, value: fn(&Particle<'a>) -> f64| {
            filled(wanted(name), particles, 0.0, |a| value(&of(a)))
        };
        let vector = |name: &str, value: fn(&Particle<'a>) -> Vec3| {
            filled(wanted(name), particles, Vec3::zeros(), |a| value(&of(a)))
        };
        let tensor = |name: &str, value: fn(&Particle<'a>) -> Mat3| {
            filled(wanted(name), particles, Mat3::zeros(), |a| value(&of(a)))
        };
        let invariants = wanted("von_mises_stress") || wanted("pressure");
        let stress = filled(
            invariants || wanted("cauchy_stress"),
            particles,
            Mat3::zeros(),
            |a| of(a).cauchy_stress(),
        );
        let of_stress = |name: &str, value: fn(&Mat3) -> f64| {
            filled(wanted(name), particles, 0.0, |a| value(&stress[a]))
        };
        ParticleFields {
            velocity: vector("velocity", Particle::velocity),
            displacement: vector("displacement", Particle::displacement),
            deformation_gradient: tensor("deformation_gradient", Particle::deformation_gradient),
            determinant: scalar("determinant", Particle::determinant),
            von_mises_stress: of_stress("von_mises_stress", von_mises),
            pressure: of_stress("pressure", jstsph_tensor::mean_trace),
            equivalent_plastic_strain: scalar(
                "equivalent_plastic_strain",
                Particle::equivalent_plastic_strain,
            ),
            temperature: filled(wanted("temperature"), particles, 0.0, |a| {
                self.state.temperature[a]
            }),
            wave_speed: scalar("wave_speed", Particle::wave_speed),
            cauchy_stress: if wanted("cauchy_stress") {
                stress
            } else {
                Vec::new()
            },
        }
    }

    /// Largest equivalent plastic strain of the particles.
    #[must_use]
    pub fn largest_plastic_strain(&self) -> f64 {
        let bodies = self.reference.bodies.iter().zip(&self.materials);
        bodies
            .map(|(body, material)| {
                material.visit_ref(&mut LargestPlasticStrain {
                    shares: &body.shares,
                    particles: body.particles.len(),
                })
            })
            .fold(0.0, f64::max)
    }

    /// Smallest and largest J of the particles.
    #[must_use]
    pub fn jacobian_range(&self) -> (f64, f64) {
        let jacobian = &self.state.jacobian;
        parallel::reduce(
            jacobian.len(),
            &|range| {
                let values = jacobian[range].iter();
                values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), j| {
                    (low.min(*j), high.max(*j))
                })
            },
            &|a: (f64, f64), b: (f64, f64)| (a.0.min(b.0), a.1.max(b.1)),
        )
    }

    /// First particle quantity that is not finite, with its particle: (quantity, particle).
    #[must_use]
    pub fn find_non_finite(&self) -> Option<(&'static str, usize)> {
        let bad = |v: &Vec3| !v.iter().all(|c| c.is_finite());
        if let Some(a) = self.state.position.iter().position(bad) {
            return Some(("position", a));
        }
        if let Some(a) = self.state.momentum.iter().position(bad) {
            return Some(("momentum", a));
        }
        let a = self.state.jacobian.iter().position(|j| !j.is_finite())?;
        Some(("jacobian", a))
    }
}

#[cfg(test)]
mod tests;
