//! Fields of the particles as they are written and drawn.

use jstsph_tensor::{Mat3, Vec3, von_mises};

use crate::parallel;
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

impl Simulation {
    /// Computes all fields; allocates, and is meant for output.
    #[must_use]
    pub fn particle_fields(&self) -> ParticleFields {
        let (reference, state, work) = (&self.reference, &self.state, &self.work);
        let (particles, points) = (reference.position.len(), reference.point_volume.len());
        let mut point_strain = vec![0.0; points];
        stress::equivalent_plastic_strain(reference, &self.materials, &mut point_strain);

        let mut point_stress = vec![Mat3::zeros(); points];
        parallel::fill(&mut point_stress, |q| {
            let f = &state.deformation_gradient[q];
            // σ = P Fᵀ / det F.
            let cauchy = work.scaled_stress[q] * f.transpose()
                / (reference.point_volume[q] * f.determinant());
            jstsph_tensor::symmetric_part(&cauchy)
        });

        let mut fields = ParticleFields {
            velocity: vec![Vec3::zeros(); particles],
            displacement: vec![Vec3::zeros(); particles],
            deformation_gradient: vec![Mat3::zeros(); particles],
            determinant: vec![0.0; particles],
            cauchy_stress: vec![Mat3::zeros(); particles],
            von_mises_stress: vec![0.0; particles],
            pressure: vec![0.0; particles],
            equivalent_plastic_strain: vec![0.0; particles],
            temperature: state.temperature.clone(),
            wave_speed: vec![0.0; particles],
        };
        for a in 0..particles {
            let momentum = if self.synchronised {
                state.momentum[a]
            } else {
                (state.momentum[a] + self.ledger.momentum_before[a]) * 0.5
            };
            fields.velocity[a] = momentum / reference.density[a];
            fields.displacement[a] = state.position[a] - reference.position[a];
        }
        for body in &reference.bodies {
            let (start, first) = (body.particles.start, body.points.start);
            for a in 0..body.particles.len() {
                let shares = &body.shares;
                let gradient = shares.mean_tensor(a, |q| state.deformation_gradient[first + q]);
                let stress = shares.mean_tensor(a, |q| point_stress[first + q]);
                let i = start + a;
                fields.determinant[i] =
                    shares.mean(a, |q| state.deformation_gradient[first + q].determinant());
                fields.deformation_gradient[i] = gradient;
                fields.von_mises_stress[i] = von_mises(&stress);
                fields.pressure[i] = jstsph_tensor::mean_trace(&stress);
                fields.cauchy_stress[i] = stress;
                fields.equivalent_plastic_strain[i] = shares.mean(a, |q| point_strain[first + q]);
                let stretch = shares.mean(a, |q| {
                    smallest_stretch(&state.deformation_gradient[first + q])
                });
                fields.wave_speed[i] = body.wave_speed / stretch;
            }
        }
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
