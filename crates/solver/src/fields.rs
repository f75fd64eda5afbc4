//! Fields of the particles as they are written and drawn.

use jstsph_tensor::{Mat3, Vec3, von_mises};

use crate::parallel;
use crate::probe::{Field, Probe, ProbeKind};
use crate::simulation::Simulation;
use crate::stress;
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

/// A vector of `value(i)`.
fn filled<T: Clone + Send>(items: usize, zero: T, value: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let mut filled = vec![zero; items];
    parallel::fill(&mut filled, value);
    filled
}

/// Which fields are computed; the others stay empty. Plastic strain and temperature always are.
#[derive(Clone, Copy, Debug, Default)]
struct Wanted {
    velocity: bool,
    displacement: bool,
    deformation_gradient: bool,
    determinant: bool,
    stress: bool,
    wave_speed: bool,
}

impl Wanted {
    const ALL: Self = Self {
        velocity: true,
        displacement: true,
        deformation_gradient: true,
        determinant: true,
        stress: true,
        wave_speed: true,
    };

    /// What the readings of probes take from the fields, and those of these names.
    fn by(probes: &[Probe], names: &[&str]) -> Self {
        let named = |name: &str| names.contains(&name);
        let mut wanted = Self {
            velocity: named("velocity"),
            displacement: named("displacement"),
            deformation_gradient: named("deformation_gradient"),
            determinant: named("determinant"),
            stress: ["cauchy_stress", "von_mises_stress", "pressure"]
                .into_iter()
                .any(named),
            wave_speed: named("wave_speed"),
        };
        for probe in probes {
            match &probe.kind {
                ProbeKind::EdgeRadius { .. } => wanted.deformation_gradient = true,
                ProbeKind::Statistic { field, .. }
                | ProbeKind::Point { field, .. }
                | ProbeKind::Line { field, .. } => match field {
                    Field::VonMisesStress | Field::Pressure => wanted.stress = true,
                    Field::WaveSpeed => wanted.wave_speed = true,
                    Field::Velocity(_) => wanted.velocity = true,
                    Field::EquivalentPlasticStrain
                    | Field::Temperature
                    | Field::Jacobian
                    | Field::Displacement(_)
                    | Field::Position(_) => {}
                },
                ProbeKind::Extent { .. } | ProbeKind::Radius { .. } => {}
            }
        }
        wanted
    }
}

impl Simulation {
    /// Computes all fields; allocates, and is meant for output.
    #[must_use]
    pub fn particle_fields(&self) -> ParticleFields {
        self.fields(Wanted::ALL)
    }

    /// The fields that these probes read and those with these names (of the entries of
    /// [`ParticleFields`]), the plastic strain and the temperature, with the bits of
    /// [`particle_fields`](Self::particle_fields) in a fraction of its time; the others are empty.
    #[must_use]
    pub fn fields_for(&self, probes: &[Probe], names: &[&str]) -> ParticleFields {
        self.fields(Wanted::by(probes, names))
    }

    fn fields(&self, wanted: Wanted) -> ParticleFields {
        let (reference, state, work) = (&self.reference, &self.state, &self.work);
        let (particles, points) = (reference.position.len(), reference.point_volume.len());
        let mut point_strain = vec![0.0; points];
        stress::equivalent_plastic_strain(reference, &self.materials, &mut point_strain);

        // Computed for both ends of a bond rather than kept: that of the points is three times as long.
        let point_stress = |q: usize| {
            let f = &state.deformation_gradient[q];
            // σ = P Fᵀ / det F.
            let cauchy = work.scaled_stress[q] * f.transpose()
                / (reference.point_volume[q] * f.determinant());
            jstsph_tensor::symmetric_part(&cauchy)
        };
        let of_particles = |wanted: bool| if wanted { particles } else { 0 };
        let mut fields = ParticleFields {
            velocity: filled(of_particles(wanted.velocity), Vec3::zeros(), |a| {
                let momentum = if self.synchronised {
                    state.momentum[a]
                } else {
                    (state.momentum[a] + self.ledger.momentum_before[a]) * 0.5
                };
                momentum / reference.density[a]
            }),
            displacement: filled(of_particles(wanted.displacement), Vec3::zeros(), |a| {
                state.position[a] - reference.position[a]
            }),
            deformation_gradient: vec![Mat3::zeros(); of_particles(wanted.deformation_gradient)],
            determinant: vec![0.0; of_particles(wanted.determinant)],
            cauchy_stress: vec![Mat3::zeros(); of_particles(wanted.stress)],
            von_mises_stress: Vec::new(),
            pressure: Vec::new(),
            equivalent_plastic_strain: vec![0.0; particles],
            temperature: state.temperature.clone(),
            wave_speed: vec![0.0; of_particles(wanted.wave_speed)],
        };
        for body in &reference.bodies {
            let (range, first) = (body.particles.clone(), body.points.start);
            let shares = &body.shares;
            let gradient = |q: usize| &state.deformation_gradient[first + q];
            parallel::fill(&mut fields.equivalent_plastic_strain[range.clone()], |a| {
                shares.mean(a, |q| point_strain[first + q])
            });
            if wanted.deformation_gradient {
                parallel::fill(&mut fields.deformation_gradient[range.clone()], |a| {
                    shares.mean_tensor(a, |q| *gradient(q))
                });
            }
            if wanted.determinant {
                parallel::fill(&mut fields.determinant[range.clone()], |a| {
                    shares.mean(a, |q| gradient(q).determinant())
                });
            }
            if wanted.stress {
                parallel::fill(&mut fields.cauchy_stress[range.clone()], |a| {
                    shares.mean_tensor(a, |q| point_stress(first + q))
                });
            }
            if wanted.wave_speed {
                parallel::fill(&mut fields.wave_speed[range], |a| {
                    body.wave_speed / shares.mean(a, |q| smallest_stretch(gradient(q)))
                });
            }
        }
        let stress = &fields.cauchy_stress;
        fields.von_mises_stress = filled(stress.len(), 0.0, |a| von_mises(&stress[a]));
        fields.pressure = filled(stress.len(), 0.0, |a| jstsph_tensor::mean_trace(&stress[a]));
        fields
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
