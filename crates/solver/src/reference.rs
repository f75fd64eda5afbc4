//! What the reference configuration determines: computed once, never changed.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use jstsph_geometry::{Body, Dimension};
use jstsph_sph::{Correction, GradientOperator, JumpOperator, LineOperator, PairOperator, Support};
use jstsph_tensor::{Mat3, Vec3};

use crate::SolverError;
use crate::boundary;
use crate::model::{Laplacian, Model, ModelBody, Quadrature, Scheme, SmoothingReference, Weights};

/// Most bonds of a body whose gradients and forces go along lines: fields that are brought into lines
/// and back must stay in the caches. Measured (docs/decisions/lines-beside-rows.md): 21 % less time for a
/// step with 11,000 bonds, 13 % with 47,000, 3 % with 91,000, and 7 % more with 374,000. Sums over three
/// times as many neighbours, of stresses at particles, are worth it for any body.
const BONDS_IN_LINES: usize = 100_000;

/// Particles, points and operators of all bodies in the undeformed state.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Plane strain or solid.
    pub dimension: Dimension,
    /// Where strains and stresses live.
    pub quadrature: Quadrature,
    /// Weights of the gradient at particles.
    pub weights: Weights,
    /// Reference positions X of all particles, m.
    pub position: Arc<Vec<Vec3>>,
    /// Tributary volumes V_a of all particles, m³ (per metre of thickness in plane strain).
    pub volume: Vec<f64>,
    /// Volumes V_q of all evaluation points, m³.
    pub point_volume: Arc<Vec<f64>>,
    /// Density of every particle in the inertia, p = ρ v: that of the material times the mass
    /// scaling, kg/m³.
    pub density: Vec<f64>,
    /// The bodies.
    pub bodies: Vec<BodyReference>,
}

/// One body: its ranges in the arrays of the simulation, its operators and constants.
#[derive(Clone, Debug)]
pub struct BodyReference {
    /// Name.
    pub name: String,
    /// Its particles.
    pub particles: Range<usize>,
    /// Its evaluation points.
    pub points: Range<usize>,
    /// Density in the inertia: that of the material times the mass scaling, kg/m³.
    pub density: f64,
    /// Density of the material, which body forces and heat see, kg/m³.
    pub material_density: f64,
    /// Pressure wave speed of the undeformed material with the density of the inertia, m/s.
    pub wave_speed: f64,
    /// Shear modulus, Pa.
    pub shear_modulus: f64,
    /// Smallest distance of two particles, m.
    pub spacing: f64,
    /// Kernel and smoothing length.
    pub support: Support,
    /// The operator B from particles to points.
    pub gradient: GradientOperator,
    /// The same for many neighbours at once, where the body has lines of particles.
    pub lines: Option<LineOperator>,
    /// How B was made to sum by parts, where it did not do so by itself.
    pub correction: Option<Correction>,
    /// Laplacian of the JST dissipation, when it is used.
    pub laplacian: Option<PairOperator>,
    /// Symmetric pair weights of upwind dissipation, hourglass stiffness and viscosity, when they are
    /// used.
    pub pairs: Option<Arc<PairOperator>>,
    /// Jumps of the upwind dissipation, when it is used.
    pub jumps: Option<JumpOperator>,
    /// Particles whose J a point sees, body indices: the two ends of a bond, or twice the particle.
    pub ends: Arc<Vec<[u32; 2]>>,
    /// Points that make up a particle, with their shares (adding to one).
    pub shares: Shares,
    /// The body as it was given: lattice cells, bonds.
    pub body: Arc<Body>,
}

/// The points that belong to each particle and the share of each, V_q / (ends V_a).
#[derive(Clone, Debug)]
pub struct Shares {
    offsets: Vec<u32>,
    points: Vec<u32>,
    /// Where the shares of each particle begin in the list.
    starts: Vec<u32>,
    /// Runs of shares; equal ones, as inside a lattice, are there once.
    shares: Vec<f64>,
}

impl Shares {
    /// One point per particle, the particle itself.
    fn identity(particles: usize) -> Self {
        Self {
            offsets: (0..=particles as u32).collect(),
            points: (0..particles as u32).collect(),
            starts: vec![0; particles],
            shares: vec![1.0],
        }
    }

    /// Half of every bond to each of its ends.
    fn of_bonds(particles: usize, ends: &[[u32; 2]], bond_volumes: &[f64]) -> Self {
        let mut offsets = vec![0u32; particles + 1];
        for &a in ends.iter().flatten() {
            offsets[a as usize + 1] += 1;
        }
        for a in 0..particles {
            offsets[a + 1] += offsets[a];
        }
        let mut next = offsets.clone();
        let mut points = vec![0; 2 * ends.len()];
        for (q, pair) in ends.iter().enumerate() {
            for &a in pair {
                let place = &mut next[a as usize];
                points[*place as usize] = q as u32;
                *place += 1;
            }
        }
        let (mut starts, mut shares) = (Vec::with_capacity(particles), Vec::new());
        let mut known: HashMap<Vec<u64>, u32> = HashMap::new();
        for a in 0..particles {
            let list = &points[offsets[a] as usize..offsets[a + 1] as usize];
            let total: f64 = list.iter().map(|&q| bond_volumes[q as usize]).sum();
            let run: Vec<f64> = list
                .iter()
                .map(|&q| bond_volumes[q as usize] / total)
                .collect();
            let key = run.iter().map(|share| share.to_bits()).collect();
            starts.push(*known.entry(key).or_insert_with(|| {
                let start = shares.len() as u32;
                shares.extend_from_slice(&run);
                start
            }));
        }
        Self {
            offsets,
            points,
            starts,
            shares,
        }
    }

    /// Points and shares of one particle.
    #[inline]
    #[must_use]
    pub fn of(&self, particle: usize) -> (&[u32], &[f64]) {
        let range = self.offsets[particle] as usize..self.offsets[particle + 1] as usize;
        let start = self.starts[particle] as usize;
        let shares = start..start + range.len();
        (&self.points[range], &self.shares[shares])
    }

    /// Volume-weighted mean of a scalar field of the points.
    #[inline]
    #[must_use]
    pub fn mean(&self, particle: usize, field: impl Fn(usize) -> f64) -> f64 {
        let (points, shares) = self.of(particle);
        points
            .iter()
            .zip(shares)
            .fold(0.0, |sum, (&q, share)| sum + field(q as usize) * share)
    }

    /// Volume-weighted mean of a tensor field of the points.
    #[inline]
    #[must_use]
    pub fn mean_tensor(&self, particle: usize, field: impl Fn(usize) -> Mat3) -> Mat3 {
        let (points, shares) = self.of(particle);
        points
            .iter()
            .zip(shares)
            .fold(Mat3::zeros(), |sum, (&q, share)| {
                sum + field(q as usize) * *share
            })
    }
}

/// Appends to a list, which is shared as long as it is the same.
fn append<T: Clone>(list: &mut Arc<Vec<T>>, more: &Arc<Vec<T>>) {
    if list.is_empty() {
        *list = Arc::clone(more);
    } else {
        Arc::make_mut(list).extend_from_slice(more);
    }
}

impl Reference {
    /// Whether nothing happens out of the plane.
    pub(crate) fn is_plane(&self) -> bool {
        self.dimension == Dimension::PlaneStrain
    }

    /// Builds the operators of every body.
    ///
    /// # Errors
    /// When a body lacks bonds that the quadrature needs, or neighbours that gradients need.
    pub fn new(model: &Model) -> Result<Self, SolverError> {
        let mut reference = Self {
            dimension: model.dimension,
            quadrature: model.scheme.quadrature,
            weights: model.scheme.weights,
            position: Arc::default(),
            volume: Vec::new(),
            point_volume: Arc::default(),
            density: Vec::new(),
            bodies: Vec::new(),
        };
        for body in &model.bodies {
            reference.add(body, model)?;
        }
        Ok(reference)
    }

    fn add(&mut self, input: &ModelBody, model: &Model) -> Result<(), SolverError> {
        let (body, scheme) = (&input.body, &model.scheme);
        let failed = |source| SolverError::Operator {
            body: input.name.clone(),
            source,
        };
        let support = support(input, model.dimension, scheme);
        let weights = scheme.weights.of(body);
        let particles = body.positions.len();
        let at_particles =
            || GradientOperator::at_particles(&body.positions, weights, &support).map_err(failed);

        let first_point = self.point_volume.len();
        let (gradient, ends, shares) = match scheme.quadrature {
            Quadrature::Particles => {
                Arc::make_mut(&mut self.point_volume).extend_from_slice(&body.volumes);
                let ends = (0..particles as u32).map(|a| [a, a]).collect();
                (at_particles()?, Arc::new(ends), Shares::identity(particles))
            }
            Quadrature::Bonds => {
                let bonds = &body.bonds;
                append(&mut self.point_volume, &bonds.volumes);
                let midpoints = bonds.midpoints(&body.positions);
                let gradient = GradientOperator::at_points(&midpoints, &body.positions, &support)
                    .map_err(failed)?;
                drop(midpoints);
                let shares = Shares::of_bonds(particles, &bonds.ends, &bonds.volumes);
                (gradient, Arc::clone(&bonds.ends), shares)
            }
        };
        let (gradient, correction) = if scheme.boundary_correction {
            let area_vectors = boundary::area_vectors(body, weights, &support);
            let point_volumes = &self.point_volume[first_point..];
            boundary::corrected(gradient, body, point_volumes, &area_vectors)
        } else {
            (gradient, None)
        };
        let few = gradient.points() <= BONDS_IN_LINES;
        let lines = (few || scheme.quadrature == Quadrature::Particles)
            .then(|| {
                let midpoints = match scheme.quadrature {
                    Quadrature::Particles => None,
                    Quadrature::Bonds => Some(body.bonds.midpoints(&body.positions)),
                };
                let points = midpoints.as_deref().unwrap_or(&body.positions);
                LineOperator::new(&gradient, &body.positions, points, body.spacing)
            })
            .flatten();
        // Half of each bond to each end: masses follow from the same volumes as the stresses.
        let volume: Vec<f64> = match scheme.quadrature {
            Quadrature::Particles => body.volumes.clone(),
            Quadrature::Bonds => {
                let mut volume = vec![0.0; particles];
                for (pair, v) in ends.iter().zip(&self.point_volume[first_point..]) {
                    volume[pair[0] as usize] += 0.5 * v;
                    volume[pair[1] as usize] += 0.5 * v;
                }
                volume
            }
        };

        let pair_support = Support {
            smoothing_length: support.smoothing_length.max(body.spacing),
            ..support
        };
        let stabilisation = &scheme.stabilisation;
        let symmetric =
            || PairOperator::symmetric(&body.positions, &volume, &pair_support).map_err(failed);
        let laplacian = match stabilisation.jst.map(|jst| jst.laplacian) {
            None => None,
            Some(Laplacian::Symmetric) => Some(symmetric()?),
            Some(Laplacian::Corrected) => {
                let nodal = GradientOperator::at_particles(&body.positions, weights, &pair_support)
                    .map_err(failed)?;
                Some(
                    PairOperator::corrected(&body.positions, &volume, &nodal, &pair_support)
                        .map_err(failed)?,
                )
            }
        };
        let pairs = (stabilisation.upwind != 0.0
            || stabilisation.hourglass != 0.0
            || stabilisation.viscosity.is_some())
        .then(symmetric)
        .transpose()?
        .map(Arc::new);
        let jumps = pairs.as_ref().filter(|_| stabilisation.upwind != 0.0);
        let jumps =
            jumps.map(|pairs| JumpOperator::new(Arc::clone(pairs), &body.positions, &pair_support));

        let material_density = input.material.density();
        let density = material_density * scheme.inertia_scale;
        let first = self.position.len();
        append(&mut self.position, &body.positions);
        self.volume.extend_from_slice(&volume);
        self.density.extend(std::iter::repeat_n(density, particles));
        self.bodies.push(BodyReference {
            name: input.name.clone(),
            particles: first..self.position.len(),
            points: first_point..self.point_volume.len(),
            density,
            material_density,
            wave_speed: input.material.wave_speeds().pressure / scheme.inertia_scale.sqrt(),
            shear_modulus: input.material.shear_modulus(),
            spacing: body.spacing,
            support,
            gradient,
            lines,
            correction,
            laplacian,
            pairs,
            jumps,
            ends,
            shares,
            body: Arc::clone(body),
        });
        Ok(())
    }

    /// Mean number of particles in the sum of one evaluation point.
    #[must_use]
    pub fn neighbours_per_point(&self) -> f64 {
        let entries: usize = self
            .bodies
            .iter()
            .map(|body| body.gradient.entry_count())
            .sum();
        entries as f64 / self.point_volume.len() as f64
    }

    /// Largest defect of summation by parts, |Σ_q V_q B_qa − N_a| over the particles of a body for which
    /// `chosen(a)` holds, in units of one lattice face area: zero when a constant stress gives no force
    /// inside and the exact traction at the boundary. docs/theory.md lists what to expect. Works out the
    /// boundary anew.
    #[must_use]
    pub fn summation_defect(&self, body: usize, chosen: impl Fn(usize) -> bool) -> f64 {
        let body = &self.bodies[body];
        boundary::largest_defect(
            &body.gradient,
            &self.point_volume[body.points.clone()],
            &boundary::area_vectors(&body.body, self.weights.of(&body.body), &body.support),
            chosen,
        ) / body.spacing.powi(self.dimension.count() as i32 - 1)
    }

    /// Reference positions of all evaluation points, m; put together anew.
    #[must_use]
    pub fn point_positions(&self) -> Vec<Vec3> {
        let points = self.bodies.iter().enumerate().flat_map(|(body, owner)| {
            (0..owner.points.len()).map(move |point| self.point_position(body, point))
        });
        points.collect()
    }

    /// Reference position of a point of a body, m: of a particle, or in the middle of a bond.
    pub(crate) fn point_position(&self, body: usize, point: usize) -> Vec3 {
        let body = &self.bodies[body];
        let [a, b] = body.ends[point].map(|end| body.body.positions[end as usize]);
        (a + b) * 0.5
    }

    /// The body that owns a particle, and the index within it.
    #[must_use]
    pub fn owner_of_particle(&self, particle: usize) -> (usize, usize) {
        let body = self
            .bodies
            .iter()
            .position(|body| body.particles.contains(&particle))
            .unwrap_or_default();
        (body, particle - self.bodies[body].particles.start)
    }

    /// The body that owns an evaluation point, and the index within it.
    #[must_use]
    pub fn owner_of_point(&self, point: usize) -> (usize, usize) {
        let body = self
            .bodies
            .iter()
            .position(|body| body.points.contains(&point))
            .unwrap_or_default();
        (body, point - self.bodies[body].points.start)
    }
}

impl Weights {
    /// The weights of a body, m³.
    fn of(self, body: &Body) -> &[f64] {
        match self {
            Self::Interpolation => &body.weights,
            Self::Volume => &body.volumes,
        }
    }
}

/// Kernel support of one body: h = ratio times (V/N)^(1/d) or times the spacing.
fn support(input: &ModelBody, dimension: Dimension, scheme: &Scheme) -> Support {
    let body = &input.body;
    let length = match scheme.smoothing_reference {
        SmoothingReference::Spacing => body.support_spacing,
        SmoothingReference::Volume => {
            let total: f64 = body.volumes.iter().sum();
            (total / body.volumes.len() as f64).powf(1.0 / dimension.count() as f64)
        }
    };
    Support {
        kernel: scheme.kernel,
        smoothing_length: scheme.smoothing_ratio * length,
        dimension: dimension.count(),
    }
}
