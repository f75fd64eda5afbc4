//! The stability limit of elastic vibrations of the undeformed discrete body.

use jstsph_tensor::{Mat3, Vec3, mean_trace, symmetric_part};

use crate::model::{Quadrature, Scheme};
use crate::parallel;
use crate::reference::{BodyReference, Reference};
use crate::simulation::Simulation;

/// Iterations of the power method: the estimate is then within a few per cent from below, which the
/// margin of whoever uses it has to cover.
const ITERATIONS: usize = 60;

/// The linear elastic operator of one body, A u = −(1/ρ) Div σ(grad u), with its buffers.
struct ElasticOperator<'a> {
    body: &'a BodyReference,
    scheme: &'a Scheme,
    volume: &'a [f64],
    point_volume: &'a [f64],
    bulk_modulus: f64,
    dilation: Vec<f64>,
    particle_dilation: Vec<f64>,
    stress: Vec<Mat3>,
}

impl<'a> ElasticOperator<'a> {
    fn new(reference: &'a Reference, body: &'a BodyReference, scheme: &'a Scheme) -> Self {
        let points = body.points.len();
        Self {
            body,
            scheme,
            volume: &reference.volume[body.particles.clone()],
            point_volume: &reference.point_volume[body.points.clone()],
            bulk_modulus: body.density * body.wave_speed * body.wave_speed
                - 4.0 / 3.0 * body.shear_modulus,
            dilation: vec![0.0; points],
            particle_dilation: vec![0.0; body.particles.len()],
            stress: vec![Mat3::zeros(); points],
        }
    }

    fn apply(&mut self, u: &[Vec3], out: &mut [Vec3]) {
        let body = self.body;
        let shear = 2.0 * body.shear_modulus;
        parallel::for_each_pair(
            &mut self.stress,
            &mut self.dilation,
            |q, stress, dilation| {
                let strain = symmetric_part(&body.gradient.gradient_at(q, u));
                *dilation = strain.trace();
                *stress = (strain - Mat3::identity() * mean_trace(&strain)) * shear;
            },
        );
        // The pressure is that of the particles' J, where J is an unknown of its own.
        let dilation = &self.dilation;
        parallel::fill(&mut self.particle_dilation, |a| {
            body.shares.mean(a, |q| dilation[q])
        });
        let averaged = self.scheme.quadrature == Quadrature::Bonds
            && self.scheme.formulation.integrates_jacobian();
        let (of_particles, bulk) = (&self.particle_dilation, self.bulk_modulus);
        let volume = self.point_volume;
        parallel::for_each(&mut self.stress, |q, stress| {
            let [a, b] = body.ends[q].map(|end| end as usize);
            let dilation = if averaged {
                0.5 * (of_particles[a] + of_particles[b])
            } else {
                dilation[q]
            };
            *stress = (*stress + Mat3::identity() * (bulk * dilation)) * volume[q];
        });
        let stress = &self.stress;
        let volume = self.volume;
        parallel::fill(out, |c| {
            body.gradient.divergence_at(c, stress) / (volume[c] * body.density)
        });
    }
}

/// A vector without structure, the same in every run (splitmix64).
fn start(count: usize) -> Vec<Vec3> {
    let mut seed = 0u64;
    let mut next = || {
        seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = seed;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    (0..count)
        .map(|_| Vec3::new(next(), next(), next()))
        .collect()
}

impl Simulation {
    /// Largest CFL number at which elastic vibrations of the undeformed bodies are stable with the
    /// leapfrog, Δt = 2/ω_max, from the largest frequency of the discrete operator (power method, a
    /// few per cent too large at most).
    ///
    /// Nodes with little volume at a rim that is not on the lattice lower it. Impacts that flow
    /// plastically everywhere run at larger CFL numbers, slow processes do not. [eq:elastic-limit]
    #[must_use]
    pub fn elastic_cfl_limit(&self) -> f64 {
        let reference = self.reference();
        let limit = |body: &BodyReference| {
            let mut operator = ElasticOperator::new(reference, body, self.scheme());
            let volume = &reference.volume[body.particles.clone()];
            let norm = |u: &[Vec3]| {
                parallel::sum(u.len(), 0.0, |a| volume[a] * u[a].norm_squared()).sqrt()
            };
            let mut u = start(volume.len());
            let mut image = vec![Vec3::zeros(); volume.len()];
            let mut largest = 0.0;
            for _ in 0..ITERATIONS {
                let size = norm(&u);
                if size == 0.0 {
                    return f64::INFINITY;
                }
                u.iter_mut().for_each(|v| *v /= size);
                operator.apply(&u, &mut image);
                largest = norm(&image);
                std::mem::swap(&mut u, &mut image);
            }
            2.0 / largest.sqrt() * body.wave_speed / body.spacing
        };
        reference
            .bodies
            .iter()
            .map(limit)
            .fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Formulation, Integrator};
    use crate::testing::{QUADRATURES, elastic, model, scheme};

    /// Largest excursion of a small random motion over a few hundred steps at a CFL number.
    fn growth(quadrature: Quadrature, cfl: f64) -> f64 {
        let mut scheme = scheme(quadrature, Integrator::Leapfrog);
        scheme.formulation = Formulation::MomentumGradientJacobian;
        scheme.cfl = cfl;
        let mut model = model([6, 5, 4], elastic(), scheme);
        let count = model.bodies[0].initial_velocity.len();
        let noise = start(count);
        for (velocity, noise) in model.bodies[0].initial_velocity.iter_mut().zip(noise) {
            *velocity = noise * 1e-6;
        }
        let mut simulation = Simulation::new(model).unwrap();
        let initial = simulation.energies().kinetic;
        for _ in 0..400 {
            if simulation.advance_step(f64::INFINITY).is_err() {
                return f64::INFINITY;
            }
        }
        simulation.energies().kinetic / initial
    }

    #[test]
    fn vibrations_are_stable_below_the_limit_and_grow_above() {
        for quadrature in QUADRATURES {
            let simulation = Simulation::new(model(
                [6, 5, 4],
                elastic(),
                scheme(quadrature, Integrator::Leapfrog),
            ))
            .unwrap();
            let limit = simulation.elastic_cfl_limit();
            assert!(
                growth(quadrature, 0.95 * limit) < 10.0,
                "{quadrature:?}: {limit}"
            );
            assert!(
                growth(quadrature, 1.1 * limit) > 1e6,
                "{quadrature:?}: {limit}"
            );
        }
    }
}
