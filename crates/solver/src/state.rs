//! The unknowns, the buffers of a step, and the books kept beside them.

use jstsph_material::ROOM_TEMPERATURE;
use std::ops::Range;

use jstsph_tensor::lanes::TILE;
use jstsph_tensor::{Mat3, Vec3, cofactor, double_dot};

use crate::lines::LineFields;
use crate::model::{Formulation, Integrator, Quadrature, Scheme};
use crate::reference::{BodyReference, Reference};

/// The unknowns of the mixed scheme: x, p and J of the particles, F and H of the evaluation points.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Current positions x, m.
    pub position: Vec<Vec3>,
    /// Linear momentum p per unit reference volume, kg m⁻² s⁻¹. With the leapfrog, half a step
    /// ahead of the positions unless [`Simulation::is_synchronised`](crate::Simulation::is_synchronised).
    pub momentum: Vec<Vec3>,
    /// Jacobian J of the particles.
    pub jacobian: Vec<f64>,
    /// Temperature T of the particles, K.
    pub temperature: Vec<f64>,
    /// Deformation gradient F of the points.
    pub deformation_gradient: Vec<Mat3>,
    /// Cofactor H of the points; empty where it is cof F at all times: with the leapfrog, which advances
    /// it exactly, and in the formulations without an H of its own.
    pub cofactor: Vec<Mat3>,
}

impl State {
    /// The undeformed state with the given momenta, at room temperature.
    pub(crate) fn undeformed(reference: &Reference, scheme: &Scheme, momentum: Vec<Vec3>) -> Self {
        let points = reference.point_volume.len();
        let cofactors = if keeps_cofactor(scheme) { points } else { 0 };
        Self {
            position: reference.position.to_vec(),
            momentum,
            temperature: vec![ROOM_TEMPERATURE; reference.position.len()],
            jacobian: vec![1.0; reference.position.len()],
            deformation_gradient: vec![Mat3::identity(); points],
            cofactor: vec![Mat3::identity(); cofactors],
        }
    }

    /// Overwrites every array with that of `other`, without allocating.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.position.copy_from_slice(&other.position);
        self.momentum.copy_from_slice(&other.momentum);
        self.jacobian.copy_from_slice(&other.jacobian);
        self.temperature.copy_from_slice(&other.temperature);
        self.deformation_gradient
            .copy_from_slice(&other.deformation_gradient);
        self.cofactor.copy_from_slice(&other.cofactor);
    }

    /// H of a point, wherever it comes from.
    ///
    /// # Panics
    /// If there is no such point.
    #[must_use]
    pub fn cofactor_at(&self, point: usize) -> Mat3 {
        let all = self.deformation(0..self.deformation_gradient.len());
        all.cofactor(point)
    }

    /// F and H of a run of points.
    pub(crate) fn deformation(&self, points: Range<usize>) -> Deformation<'_> {
        Deformation {
            cofactor: self.cofactor.get(points.clone()).unwrap_or_default(),
            gradient: &self.deformation_gradient[points],
        }
    }
}

/// Whether H is integrated, and is cof F only up to the order of the method.
fn keeps_cofactor(scheme: &Scheme) -> bool {
    scheme.formulation == Formulation::MomentumGradientCofactorJacobian
        && scheme.integrator != Integrator::Leapfrog
}

/// F and H of some points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Deformation<'a> {
    pub(crate) gradient: &'a [Mat3],
    /// H where it is integrated, else nothing.
    pub(crate) cofactor: &'a [Mat3],
}

impl Deformation<'_> {
    /// H.
    #[inline]
    pub(crate) fn cofactor(&self, q: usize) -> Mat3 {
        match self.cofactor.get(q) {
            Some(cofactor) => *cofactor,
            None => cofactor(&self.gradient[q]),
        }
    }

    /// H, and det F by F and H, ⅓ H : F.
    #[inline]
    pub(crate) fn cofactor_and_determinant(&self, q: usize) -> (Mat3, f64) {
        let cofactor = self.cofactor(q);
        (cofactor, double_dot(&cofactor, &self.gradient[q]) / 3.0)
    }

    /// The points of a run.
    pub(crate) fn of(&self, points: Range<usize>) -> Self {
        Self {
            cofactor: self.cofactor.get(points.clone()).unwrap_or_default(),
            gradient: &self.gradient[points],
        }
    }
}

/// Buffers of one evaluation of the right-hand side; allocated once.
#[derive(Clone, Debug, Default)]
pub(crate) struct Workspace {
    /// The momenta with a fourth number, zero, for vector loads.
    pub(crate) padded_momentum: Vec<[f64; 4]>,
    /// G = grad(p/ρ) at the points, 1/s; empty where only the drift of the leapfrog needs it, which does not
    /// keep it.
    pub(crate) velocity_gradient: Vec<Mat3>,
    /// Fields in the order of the lines of bodies.
    pub(crate) lines: LineFields,
    /// Bounds of the smallest stretches, left by the drift of the leapfrog.
    pub(crate) stretch_bounds: StretchBounds,
    /// Change of volume of a point over the step or per second, see the strain pass.
    pub(crate) volume_change: Vec<f64>,
    /// V_q P_q at the points, N m.
    pub(crate) scaled_stress: Vec<Mat3>,
    /// Kirchhoff pressure part τ_vol = J U'(J) of the particles, Pa.
    pub(crate) volumetric_stress: Vec<f64>,
    /// Plastic work of the last evaluation at the points, J/m³.
    pub(crate) plastic_work: Vec<f64>,
    /// T per unit reference volume, N/m³, hourglass stiffness included, after the projection.
    pub(crate) internal_force: Vec<Vec3>,
    /// D(p) of JST and upwind together, N/m³, after the projection; empty without them.
    pub(crate) dissipation: Vec<Vec3>,
    /// D(J), 1/s.
    pub(crate) jacobian_dissipation: Vec<f64>,
    /// Heat made by the artificial viscosity, W/m³ of reference volume; empty without it.
    pub(crate) viscous_heating: Vec<f64>,
    /// x − X, for the formulation that takes F from it; empty otherwise.
    pub(crate) displacement: Vec<Vec3>,
    /// Tractions and body forces per unit reference volume, N/m³; empty without them.
    pub(crate) external_force: Vec<Vec3>,
    /// First differences (Laplacians) of p and J; that of p is empty without JST.
    pub(crate) laplacian: Vec<Vec3>,
    pub(crate) jacobian_laplacian: Vec<f64>,
    /// G and F averaged to the particles, for the pair stabilisations with bonds; else empty.
    pub(crate) particle_velocity_gradient: Vec<Mat3>,
    pub(crate) particle_deformation_gradient: Vec<Mat3>,
    /// Stress of the hourglass stiffness: P at the particles, V P at the points; empty without it.
    pub(crate) hourglass_stress: Vec<Mat3>,
    pub(crate) hourglass_point_stress: Vec<Mat3>,
}

impl Workspace {
    /// What the frequency of the bodies needs.
    pub(crate) fn of_strains(reference: &Reference) -> Self {
        Self::with(reference, true)
    }

    fn with(reference: &Reference, keeps_rates: bool) -> Self {
        let (particles, points) = (reference.position.len(), reference.point_volume.len());
        let rates = if keeps_rates { points } else { 0 };
        Self {
            padded_momentum: vec![[0.0; 4]; particles],
            velocity_gradient: vec![Mat3::zeros(); rates],
            volume_change: vec![0.0; points],
            lines: LineFields::new(reference),
            ..Self::default()
        }
    }

    /// `keeps_rates` tells whether G has a place of its own.
    pub(crate) fn new(reference: &Reference, keeps_rates: bool) -> Self {
        let (particles, points) = (reference.position.len(), reference.point_volume.len());
        let pairs = reference.bodies.iter().any(|body| body.pairs.is_some());
        let averaged = if pairs { particles } else { 0 };
        let of_bonds = match reference.quadrature {
            Quadrature::Particles => 0,
            Quadrature::Bonds => averaged,
        };
        let laplacian = reference.bodies.iter().any(|body| body.laplacian.is_some());
        let differences = if laplacian { particles } else { 0 };
        Self {
            scaled_stress: vec![Mat3::zeros(); points],
            volumetric_stress: vec![0.0; particles],
            plastic_work: vec![0.0; points],
            internal_force: vec![Vec3::zeros(); particles],
            dissipation: vec![Vec3::zeros(); averaged.max(differences)],
            jacobian_dissipation: vec![0.0; particles],
            viscous_heating: vec![0.0; averaged],
            displacement: Vec::new(),
            external_force: Vec::new(),
            laplacian: vec![Vec3::zeros(); differences],
            jacobian_laplacian: vec![0.0; particles],
            particle_velocity_gradient: vec![Mat3::zeros(); of_bonds],
            particle_deformation_gradient: vec![Mat3::zeros(); of_bonds],
            hourglass_stress: Vec::new(),
            hourglass_point_stress: Vec::new(),
            stretch_bounds: StretchBounds::new(reference),
            ..Self::with(reference, keeps_rates)
        }
    }
}

/// Bounds of 1/λ² of the points, the largest of every tile: what the next time step looks at first.
#[derive(Clone, Debug, Default)]
pub(crate) struct StretchBounds {
    /// One for each tile of the points of each body; not a number where a strain is not finite.
    pub(crate) bodies: Vec<Vec<f64>>,
    /// Whether they are those of the present F.
    pub(crate) are_fresh: bool,
}

impl StretchBounds {
    fn new(reference: &Reference) -> Self {
        let tiles = |body: &BodyReference| vec![f64::NAN; body.points.len().div_ceil(TILE)];
        Self {
            bodies: reference.bodies.iter().map(tiles).collect(),
            are_fresh: false,
        }
    }

    /// Those of a body, if they are fresh.
    pub(crate) fn of(&self, body: usize) -> Option<&[f64]> {
        let bounds = self.bodies.get(body).filter(|_| self.are_fresh);
        bounds.map(Vec::as_slice)
    }
}

/// An entry of a field that is empty where nothing acts.
#[inline]
pub(crate) fn or_zero(field: &[Vec3], a: usize) -> Vec3 {
    field.get(a).copied().unwrap_or_else(Vec3::zeros)
}
