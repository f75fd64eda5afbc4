//! The largest frequency of the discrete elastic operator, undeformed and deformed: what the time step
//! of an explicit integrator really has to resolve.

use jstsph_tensor::{Mat3, Vec3, mean_trace, symmetric_part};

use crate::local_steps::Groups;
use crate::model::{Quadrature, Scheme};
use crate::reference::{BodyReference, Reference};
use crate::simulation::Simulation;
use crate::state::{Deformation, State, Workspace};
use crate::{force, parallel, strain};

use lanczos::Tridiagonal;

mod lanczos;

/// Buffers of [`Frequency::largest`], as long as the largest body needs; allocated once. Those of the
/// points, which are larger, are borrowed from the workspace between two steps.
#[derive(Clone, Debug)]
pub(crate) struct Frequency {
    particle_dilation: Vec<f64>,
    vector: Vec<Vec3>,
    previous: Vec<Vec3>,
    image: Vec<Vec3>,
}

/// Which operator of a body: its stiffness averages dilations as the scheme does, and follows F and
/// H where they are given.
#[derive(Clone, Copy)]
struct Elasticity<'a> {
    body: &'a BodyReference,
    volume: &'a [f64],
    point_volume: &'a [f64],
    /// Whether the pressure is that of the particles' J, with bonds.
    averaged: bool,
    deformation: Option<Deformation<'a>>,
    /// Leaves out the stiffness of the fine points and particles.
    without_fine: Option<&'a Groups>,
}

impl Elasticity<'_> {
    /// F⁻ᵀ of a point, when the body is deformed.
    #[inline]
    fn inverse_transpose(&self, q: usize) -> Option<Mat3> {
        self.deformation.map(|deformation| {
            let (cofactor, determinant) = deformation.cofactor_and_determinant(q);
            cofactor * (1.0 / determinant)
        })
    }

    /// Whether the stiffness of a point is left out.
    #[inline]
    fn leaves_out_point(&self, q: usize) -> bool {
        self.without_fine
            .is_some_and(|groups| groups.fine.contains(q))
    }

    /// Whether the pressure of a particle is left out.
    #[inline]
    fn leaves_out_particle(&self, a: usize) -> bool {
        self.without_fine
            .is_some_and(|groups| groups.fine_jacobian[a])
    }
}

impl Frequency {
    pub(crate) fn new(reference: &Reference) -> Self {
        let most = |of: fn(&BodyReference) -> usize| reference.bodies.iter().map(of).max();
        let particles = most(|body| body.particles.len()).unwrap_or(0);
        Self {
            particle_dilation: vec![0.0; particles],
            vector: vec![Vec3::zeros(); particles],
            previous: vec![Vec3::zeros(); particles],
            image: vec![Vec3::zeros(); particles],
        }
    }

    /// The limit 2/ω_max of the deformed bodies, or of what is not fine in them, s.
    pub(crate) fn limit(
        &mut self,
        work: &mut Workspace,
        reference: &Reference,
        scheme: &Scheme,
        state: &State,
        without_fine: Option<&[Groups]>,
    ) -> f64 {
        let mut limit = f64::INFINITY;
        for (index, body) in reference.bodies.iter().enumerate() {
            let groups = without_fine.map(|groups| &groups[index]);
            let largest = self.largest(work, reference, body, scheme, Some(state), groups);
            limit = limit.min(2.0 / largest);
        }
        limit
    }

    /// ω_max of one body, 1/s: square root of the largest eigenvalue of
    ///
    /// ```text
    ///   A u = −(1/ρ) Div( σ(sym(grad u F⁻¹)) F⁻ᵀ )        [eq:elastic-limit], [eq:acoustic-step]
    /// ```
    ///
    /// with the isotropic elasticity of the undeformed material, by a few Lanczos steps from a vector
    /// without structure: within a per cent, from below. With `state` that of the deformed body, else
    /// F = 1; `without_fine` leaves out what makes sub-steps. Stresses themselves (of the order of the
    /// flow stress over the moduli) and the softening by plastic flow are left out; the latter only lowers
    /// frequencies. Overwrites the momenta with a fourth number, the velocity gradient and the volume
    /// change of the workspace.
    fn largest(
        &mut self,
        work: &mut Workspace,
        reference: &Reference,
        body: &BodyReference,
        scheme: &Scheme,
        state: Option<&State>,
        without_fine: Option<&Groups>,
    ) -> f64 {
        let points = body.points.clone();
        let elasticity = Elasticity {
            body,
            volume: &reference.volume[body.particles.clone()],
            point_volume: &reference.point_volume[points.clone()],
            averaged: scheme.quadrature == Quadrature::Bonds
                && scheme.formulation.integrates_jacobian(),
            deformation: state.map(|state| state.deformation(points.clone())),
            without_fine,
        };
        let volume = elasticity.volume;
        let count = volume.len();
        self.start(count);
        let norm = |u: &[Vec3]| weighted(volume, u, u).sqrt();
        let size = norm(&self.vector[..count]);
        parallel::for_each(&mut self.vector[..count], |_, v| *v /= size);
        let mut matrix = Tridiagonal::default();
        while !matrix.is_full() {
            self.apply(work, &elasticity);
            let (vector, image) = (&self.vector[..count], &mut self.image[..count]);
            let diagonal = weighted(volume, vector, image);
            let (previous, coupling) = (&self.previous[..count], matrix.last_coupling());
            parallel::for_each(image, |a, w| {
                *w -= vector[a] * diagonal + previous[a] * coupling;
            });
            let next = norm(image);
            // An invariant subspace is exhausted, by bodies with few particles; NaN ends here too.
            if !matrix.extend(diagonal, next) {
                break;
            }
            parallel::for_each(image, |_, w| *w /= next);
            std::mem::swap(&mut self.previous, &mut self.vector);
            std::mem::swap(&mut self.vector, &mut self.image);
        }
        matrix.largest_eigenvalue().sqrt()
    }

    /// A vector without structure, the same in every run (splitmix64).
    fn start(&mut self, count: usize) {
        let mut seed = 0u64;
        let mut next = || {
            seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = seed;
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            (z >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        for v in &mut self.vector[..count] {
            *v = Vec3::new(next(), next(), next());
        }
        self.previous.fill(Vec3::zeros());
    }

    /// `image` = A `vector`.
    fn apply(&mut self, work: &mut Workspace, elasticity: &Elasticity<'_>) {
        let body = elasticity.body;
        let (particles, points) = (body.particles.len(), body.points.len());
        let vector = &self.vector[..particles];
        let padded = &mut work.padded_momentum[..particles];
        parallel::fill(padded, |a| [vector[a].x, vector[a].y, vector[a].z, 0.0]);
        let padded = &*padded;
        // Gradient, then stress times volume.
        let tensor = &mut work.velocity_gradient[..points];
        strain::gradients(body, (padded, 1.0), &mut work.lines, tensor);
        let shear = 2.0 * body.shear_modulus;
        let bulk =
            body.density * body.wave_speed * body.wave_speed - 4.0 / 3.0 * body.shear_modulus;
        let dilation = &mut work.volume_change[..points];
        parallel::for_each_pair(tensor, dilation, |q, tensor, dilation| {
            let gradient = match elasticity.inverse_transpose(q) {
                Some(inverse) => *tensor * inverse.transpose(),
                None => *tensor,
            };
            let strain = symmetric_part(&gradient);
            *dilation = strain.trace();
            let shear = if elasticity.leaves_out_point(q) {
                0.0
            } else {
                shear
            };
            *tensor = (strain - Mat3::identity() * mean_trace(&strain)) * shear;
        });
        let dilation = &*dilation;
        let of_particles = &mut self.particle_dilation[..particles];
        if elasticity.averaged {
            parallel::fill(of_particles, |a| {
                if elasticity.leaves_out_particle(a) {
                    0.0
                } else {
                    body.shares.mean(a, |q| dilation[q])
                }
            });
        }
        let of_particles = &*of_particles;
        parallel::for_each(tensor, |q, tensor| {
            let dilation = if elasticity.averaged {
                let [a, b] = body.ends[q].map(|end| end as usize);
                0.5 * (of_particles[a] + of_particles[b])
            } else {
                dilation[q]
            };
            let stress = *tensor + Mat3::identity() * (bulk * dilation);
            let stress = match elasticity.inverse_transpose(q) {
                Some(inverse) => stress * inverse,
                None => stress,
            };
            *tensor = stress * elasticity.point_volume[q];
        });
        let (tensor, volume) = (&*tensor, elasticity.volume);
        let image = &mut self.image[..particles];
        let divisor = |a: usize| volume[a] * body.density;
        force::divergences(body, tensor, &divisor, &mut work.lines, image);
    }
}

/// Σ_a V_a u_a · v_a, in which the operator is symmetric.
fn weighted(volume: &[f64], u: &[Vec3], v: &[Vec3]) -> f64 {
    parallel::sum(volume.len(), 0.0, |a| volume[a] * u[a].dot(&v[a]))
}

impl Simulation {
    /// Largest CFL number at which elastic vibrations of the undeformed bodies are stable with the
    /// leapfrog, Δt = 2/ω_max, from the largest frequency of the discrete operator (Lanczos, one per
    /// cent too large at most).
    ///
    /// Nodes with little volume at a rim that is not on the lattice lower it. Impacts that flow
    /// plastically everywhere run at larger CFL numbers, slow processes do not. [eq:elastic-limit]
    #[must_use]
    pub fn elastic_cfl_limit(&self) -> f64 {
        let reference = self.reference();
        let mut frequency = Frequency::new(reference);
        let mut work = Workspace::of_strains(reference);
        reference
            .bodies
            .iter()
            .map(|body| {
                let largest =
                    frequency.largest(&mut work, reference, body, self.scheme(), None, None);
                2.0 / largest * body.wave_speed / body.spacing
            })
            .fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests;
