//! The largest frequency of the discrete elastic operator, undeformed and deformed: what the time step
//! of an explicit integrator really has to resolve.

use jstsph_tensor::{Mat3, Vec3, mean_trace, symmetric_part};

use crate::local_steps::{Groups, Levels};
use crate::model::{Quadrature, Scheme};
use crate::reference::{BodyReference, Reference};
use crate::simulation::Simulation;
use crate::state::{Deformation, State, Workspace};
use crate::{force, parallel, strain};

use lanczos::Tridiagonal;
use region::for_each_run;

mod lanczos;
mod region;

pub(crate) use region::Region;

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
    /// Leaves out the stiffness of the points and particles that make sub-steps.
    without: Option<&'a Groups>,
    /// Where particles may move, if not everywhere.
    region: Option<&'a Region>,
}

/// Change of ω² in a Lanczos step below which nothing is gained by another one: the fastest vibration of
/// a deformed body sits in one place and is found within a few.
pub(crate) const CONVERGED: f64 = 1e-4;

/// Lanczos steps that are always made.
const FEWEST: usize = 4;

/// Which vibrations of a part of the bodies are looked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vibrations<'a> {
    /// Without the stiffness of what makes sub-steps.
    pub(crate) without: Option<&'a [Groups]>,
    /// Of a region, everything else being held: if that is where the fastest is.
    pub(crate) region: Option<&'a [Region]>,
    /// Relative change of ω² in a Lanczos step by which it is known well enough.
    pub(crate) tolerance: f64,
}

impl Default for Vibrations<'_> {
    /// All, to within the accuracy of the method.
    fn default() -> Self {
        Self {
            without: None,
            region: None,
            tolerance: CONVERGED,
        }
    }
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
        self.without
            .is_some_and(|groups| groups.points.level(q) > 0)
    }

    /// Whether the pressure of a particle is left out.
    #[inline]
    fn leaves_out_particle(&self, a: usize) -> bool {
        self.without.is_some_and(|groups| groups.jacobian[a] > 0)
    }
}

impl Elasticity<'_> {
    /// sym(grad u F⁻¹).
    #[inline]
    fn strain(&self, q: usize, gradient: &Mat3) -> Mat3 {
        match self.inverse_transpose(q) {
            Some(inverse) => symmetric_part(&(gradient * inverse.transpose())),
            None => symmetric_part(gradient),
        }
    }

    /// V σ F⁻ᵀ of a point by its strain and the dilation that its pressure follows.
    #[inline]
    fn scaled_stress(&self, q: usize, strain: &Mat3, dilation: f64) -> Mat3 {
        let body = self.body;
        let shear = if self.leaves_out_point(q) {
            0.0
        } else {
            2.0 * body.shear_modulus
        };
        let bulk =
            body.density * body.wave_speed * body.wave_speed - 4.0 / 3.0 * body.shear_modulus;
        let deviator = *strain - Mat3::identity() * mean_trace(strain);
        let stress = deviator * shear + Mat3::identity() * (bulk * dilation);
        let stress = match self.inverse_transpose(q) {
            Some(inverse) => stress * inverse,
            None => stress,
        };
        stress * self.point_volume[q]
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

    /// The limit 2/ω_max of the deformed bodies, or of some of their vibrations, s.
    pub(crate) fn limit(
        &mut self,
        work: &mut Workspace,
        reference: &Reference,
        scheme: &Scheme,
        state: &State,
        vibrations: Vibrations<'_>,
    ) -> f64 {
        let mut limit = f64::INFINITY;
        for (index, body) in reference.bodies.iter().enumerate() {
            if vibrations
                .region
                .is_some_and(|regions| regions[index].is_empty())
            {
                continue;
            }
            let state = (Some(state), vibrations, index);
            let largest = self.largest(work, reference, body, scheme, state);
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
    /// F = 1; `without` leaves out the stiffness of what makes sub-steps. Stresses themselves (of the order of the
    /// flow stress over the moduli) and the softening by plastic flow are left out; the latter only lowers
    /// frequencies. Overwrites the momenta with a fourth number, the velocity gradient and the volume
    /// change of the workspace.
    fn largest(
        &mut self,
        work: &mut Workspace,
        reference: &Reference,
        body: &BodyReference,
        scheme: &Scheme,
        (state, vibrations, index): (Option<&State>, Vibrations<'_>, usize),
    ) -> f64 {
        let without = vibrations.without.map(|groups| &groups[index]);
        let region = vibrations.region.map(|regions| &regions[index]);
        let tolerance = vibrations.tolerance;
        let points = body.points.clone();
        let elasticity = Elasticity {
            body,
            volume: &reference.volume[body.particles.clone()],
            point_volume: &reference.point_volume[points.clone()],
            averaged: scheme.quadrature == Quadrature::Bonds
                && scheme.formulation.integrates_jacobian(),
            deformation: state.map(|state| state.deformation(points.clone())),
            without,
            region,
        };
        let volume = elasticity.volume;
        let count = volume.len();
        self.start(count);
        if let Some(region) = region {
            self.hold(work, region, (count, body.points.len()));
        }
        let norm = |u: &[Vec3]| weighted(volume, u, u).sqrt();
        let size = norm(&self.vector[..count]);
        parallel::for_each(&mut self.vector[..count], |_, v| *v /= size);
        let mut matrix = Tridiagonal::default();
        let mut estimate = 0.0;
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
            let goes_on = matrix.extend(diagonal, next);
            let last = std::mem::replace(&mut estimate, matrix.largest_eigenvalue());
            // Estimates grow.
            let converged = matrix.size() > FEWEST && estimate <= last * (1.0 + tolerance);
            if !goes_on || converged {
                break;
            }
            parallel::for_each(image, |_, w| *w /= next);
            std::mem::swap(&mut self.previous, &mut self.vector);
            std::mem::swap(&mut self.vector, &mut self.image);
        }
        estimate.sqrt()
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

    /// Makes everything zero outside a region.
    fn hold(&mut self, work: &mut Workspace, region: &Region, (particles, points): (usize, usize)) {
        let outside = Levels::only(0);
        let hold = |_, run: &mut [Vec3]| run.fill(Vec3::zeros());
        let vector = &mut self.vector[..particles];
        region.particles.for_each_run(outside, vector, hold);
        self.image[..particles].fill(Vec3::zeros());
        work.padded_momentum[..particles].fill([0.0; 4]);
        work.volume_change[..points].fill(0.0);
    }

    /// `image` = A `vector`.
    fn apply(&mut self, work: &mut Workspace, elasticity: &Elasticity<'_>) {
        let body = elasticity.body;
        let (particles, points) = (body.particles.len(), body.points.len());
        let region = elasticity.region;
        let moving = region.map(|region| &region.particles);
        let feeling = region.map(|region| &region.points);
        let vector = &self.vector[..particles];
        let padded = &mut work.padded_momentum[..particles];
        for_each_run(moving, padded, |first, padded| {
            for (padded, v) in padded.iter_mut().zip(&vector[first..]) {
                *padded = strain::padded(v);
            }
        });
        let padded = &*padded;
        let tensor = &mut work.velocity_gradient[..points];
        match feeling {
            None => strain::gradients(body, (padded, 1.0), &mut work.lines, tensor),
            Some(tiles) => tiles.for_each_run(Levels::from(1), tensor, |first, tensor| {
                body.gradient.scaled_gradients(first, padded, 1.0, tensor);
            }),
        }
        for_each_run(feeling, tensor, |first, tensor| {
            for (k, tensor) in tensor.iter_mut().enumerate() {
                *tensor = elasticity.strain(first + k, tensor);
            }
        });
        let strain = &*tensor;
        let dilation = &mut work.volume_change[..points];
        for_each_run(feeling, dilation, |first, dilation| {
            for (dilation, strain) in dilation.iter_mut().zip(&strain[first..]) {
                *dilation = strain.trace();
            }
        });
        let dilation = &*dilation;
        let of_particles = &mut self.particle_dilation[..particles];
        if elasticity.averaged {
            let ends = region.map(|region| &region.ends);
            for_each_run(ends, of_particles, |first, of_particles| {
                for (k, mean) in of_particles.iter_mut().enumerate() {
                    *mean = if elasticity.leaves_out_particle(first + k) {
                        0.0
                    } else {
                        body.shares.mean(first + k, |q| dilation[q])
                    };
                }
            });
        }
        let of_particles = &*of_particles;
        for_each_run(feeling, tensor, |first, tensor| {
            for (k, tensor) in tensor.iter_mut().enumerate() {
                let q = first + k;
                let dilation = if elasticity.averaged {
                    let [a, b] = body.ends[q].map(|end| end as usize);
                    0.5 * (of_particles[a] + of_particles[b])
                } else {
                    dilation[q]
                };
                *tensor = elasticity.scaled_stress(q, tensor, dilation);
            }
        });
        let (tensor, volume) = (&*tensor, elasticity.volume);
        let image = &mut self.image[..particles];
        let divisor = |a: usize| volume[a] * body.density;
        match moving {
            None => force::divergences(body, tensor, &divisor, &mut work.lines, image),
            Some(tiles) => tiles.for_each_run(Levels::from(1), image, |first, image| {
                force::divergences_of_run(body, first, tensor, &divisor, image);
            }),
        }
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
                let largest = frequency.largest(
                    &mut work,
                    reference,
                    body,
                    self.scheme(),
                    (None, Vibrations::default(), 0),
                );
                2.0 / largest * body.wave_speed / body.spacing
            })
            .fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests;
