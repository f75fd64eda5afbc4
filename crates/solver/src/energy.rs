//! Energies, their balance, `[eq:balance]`, and momenta.

use jstsph_tensor::{Vec3, double_dot};

use crate::books::Work;
use crate::heat::HeatProcess;
use crate::parallel;
use crate::simulation::Simulation;
use crate::{force, stress};

/// Where the energy is and where it came from, J (per metre of thickness in plane strain).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energies {
    /// Σ V |p|²/(2ρ).
    pub kinetic: f64,
    /// Stored elastic energy.
    pub elastic: f64,
    /// Plastic dissipation so far, Σ V τ_eq Δε_p.
    pub plastic: f64,
    /// Energy removed by JST and upwind dissipation so far.
    pub numerical: f64,
    /// Energy stored in the hourglass stiffness.
    pub hourglass: f64,
    /// Work of loads and prescribed velocities so far.
    pub external: f64,
    /// Work of obstacles so far (negative: they took energy): of the contact law, and of friction
    /// at the velocity of the obstacle.
    pub contact: f64,
    /// Energy dissipated by friction at obstacles so far, `[eq:friction-energy]`.
    pub friction: f64,
    /// Heat content above that of the start.
    pub thermal: f64,
    /// Heat made of plastic, viscous and friction work so far: counted in `thermal` and where it
    /// was dissipated, so taken out of the balance once.
    pub heat_generated: f64,
    /// Heat from outside so far.
    pub heat_supplied: f64,
    /// Kinetic and elastic energy at the start.
    pub initial: f64,
}

impl Energies {
    /// Energy that appeared from nowhere, J: kinetic + elastic + plastic + numerical + hourglass
    /// + friction + thermal − heat_generated − heat_supplied − external − contact − initial.
    #[must_use]
    pub fn error(&self) -> f64 {
        self.kinetic
            + self.elastic
            + self.plastic
            + self.numerical
            + self.hourglass
            + self.friction
            + self.thermal
            - self.heat_generated
            - self.heat_supplied
            - self.external
            - self.contact
            - self.initial
    }

    /// The largest of the energies in absolute value, J.
    #[must_use]
    pub fn largest(&self) -> f64 {
        [
            self.kinetic,
            self.elastic,
            self.plastic,
            self.numerical,
            self.hourglass,
            self.external,
            self.contact,
            self.friction,
            self.thermal,
            self.heat_generated,
            self.heat_supplied,
            self.initial,
        ]
        .into_iter()
        .fold(0.0, |largest, energy| energy.abs().max(largest))
    }

    /// [`error`](Self::error) as a fraction of the largest energy; zero when there is none.
    #[must_use]
    pub fn balance(&self) -> f64 {
        let largest = self.largest();
        if largest > 0.0 {
            self.error() / largest
        } else {
            0.0
        }
    }
}

/// The quantities of Greto & Kulasegaram 2019, (4.1), `[eq:paper-energies]`, for one time step, so that its figures can
/// be redrawn. The paper's formulae lack the volume; here every particle counts with its own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PaperEnergies {
    /// (4.1a): Σ V Δt/ρ ‖p‖ ‖T‖, J per step.
    pub internal: f64,
    /// (4.1b): Σ V J ‖σ‖ Δε_p, J per step.
    pub plastic: f64,
    /// (4.1c): Σ V Δt/ρ |D(p)|, as printed not an energy (N s m³/kg); in norm because D is a vector.
    pub jst: f64,
}

/// Linear and angular momentum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Momenta {
    /// Σ V p, N s.
    pub linear: Vec3,
    /// Σ V x × p about the origin, N m s.
    pub angular: Vec3,
}

impl Simulation {
    /// Energies at the time of the positions.
    #[must_use]
    pub fn energies(&self) -> Energies {
        let reference = &self.reference;
        let kinetic_of = |momentum: &[Vec3]| {
            parallel::sum(momentum.len(), 0.0, |a| {
                0.5 * reference.volume[a] * momentum[a].norm_squared() / reference.density[a]
            })
        };
        let after = kinetic_of(&self.state.momentum);
        let kinetic = if self.synchronised {
            after
        } else {
            0.5 * (kinetic_of(&self.ledger.momentum_before) + after)
        };
        let work = parallel::sum(reference.volume.len(), Work::default(), |a| {
            self.ledger.work(a) * reference.volume[a]
        });
        let coefficient = self.scheme.stabilisation.hourglass;
        let heat = |of: fn(&HeatProcess) -> &Vec<f64>| {
            self.heat.as_ref().map_or(0.0, |heat| {
                let per_volume = of(heat);
                parallel::sum(per_volume.len(), 0.0, |a| {
                    reference.volume[a] * per_volume[a]
                })
            })
        };
        Energies {
            kinetic,
            elastic: stress::elastic_energy(
                self.strains(),
                reference,
                &self.state,
                &self.materials,
            ),
            plastic: parallel::sum(reference.point_volume.len(), 0.0, |q| {
                reference.point_volume[q] * self.ledger.plastic_dissipation[q]
            }),
            numerical: -work.numerical,
            hourglass: if coefficient == 0.0 {
                0.0
            } else {
                force::hourglass_energy(reference, &self.state, coefficient)
            },
            external: work.external,
            contact: work.contact,
            friction: work.friction,
            thermal: self
                .heat
                .as_ref()
                .map_or(0.0, |heat| heat.content(reference, &self.state)),
            heat_generated: heat(|heat| &heat.generated),
            heat_supplied: heat(|heat| &heat.supplied),
            initial: self.initial_energy,
        }
    }

    /// The paper's (4.1) for the last step; of points that make sub-steps, the plastic part of the last of them.
    #[must_use]
    pub fn paper_energies(&self) -> PaperEnergies {
        let (reference, work) = (&self.reference, &self.work);
        let per_particle = |force: &[Vec3], weighted: bool| {
            parallel::sum(force.len(), 0.0, |a| {
                let speed = if weighted {
                    self.state.momentum[a].norm()
                } else {
                    1.0
                };
                reference.volume[a] * self.dt / reference.density[a] * speed * force[a].norm()
            })
        };
        let plastic = parallel::sum(reference.point_volume.len(), 0.0, |q| {
            let volume = reference.point_volume[q];
            // τ = P Fᵀ; Δε_p = (τ_eq Δε_p)/τ_eq.
            let kirchhoff =
                work.scaled_stress[q] * self.state.deformation_gradient[q].transpose() / volume;
            let equivalent = jstsph_tensor::von_mises(&kirchhoff);
            if work.plastic_work[q] > 0.0 && equivalent > 0.0 {
                volume * double_dot(&kirchhoff, &kirchhoff).sqrt() * work.plastic_work[q]
                    / equivalent
            } else {
                0.0
            }
        });
        PaperEnergies {
            internal: per_particle(&work.internal_force, true),
            plastic,
            jst: per_particle(&work.dissipation, false),
        }
    }

    /// Momenta. With the leapfrog these are Σ V pⁿ⁺½ and Σ V xⁿ × pⁿ⁺½ (which are constant for a
    /// free body), half a step ahead of the positions.
    #[must_use]
    pub fn momenta(&self) -> Momenta {
        let (reference, state) = (&self.reference, &self.state);
        let count = reference.position.len();
        Momenta {
            linear: parallel::sum(count, Vec3::zeros(), |a| {
                state.momentum[a] * reference.volume[a]
            }),
            angular: parallel::sum(count, Vec3::zeros(), |a| {
                state.position[a].cross(&state.momentum[a]) * reference.volume[a]
            }),
        }
    }

    /// Impulse that each obstacle has received from the particles so far, N s, by name.
    #[must_use]
    pub fn obstacle_impulses(&self) -> Vec<(&str, Vec3)> {
        let mut totals: Vec<(&str, Vec3)> = self
            .obstacles
            .obstacles()
            .iter()
            .map(|obstacle| (obstacle.obstacle.name.as_str(), Vec3::zeros()))
            .collect();
        for (k, owner) in self.obstacles.owners().enumerate() {
            let on_particles = parallel::sum(self.reference.position.len(), Vec3::zeros(), |a| {
                let slot = self.ledger.slot(a, k);
                slot.map_or_else(Vec3::zeros, |slot| slot.impulse)
            });
            totals[owner].1 -= on_particles;
        }
        totals
    }

    /// Impulse that each prescribed velocity has given to its particles so far, N s, by name.
    #[must_use]
    pub fn condition_impulses(&self) -> Vec<(&str, Vec3)> {
        self.prescribed
            .names()
            .zip(self.ledger.condition_impulse.iter().copied())
            .collect()
    }

    /// How often a particle was put back onto an obstacle's surface.
    #[must_use]
    pub fn position_corrections(&self) -> u64 {
        self.ledger
            .slots()
            .map(|slot| u64::from(slot.corrections))
            .sum()
    }
}

#[cfg(test)]
mod tests;
