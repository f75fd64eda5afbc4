//! A round body in bilinear quadrilaterals of mean dilatation: strains, stresses and forces.

use std::f64::consts::PI;
use std::fmt;

use super::{Lanes, Mesh, Metal, Symmetric};

/// An element turned inside out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Inverted {
    /// Number of the element.
    pub element: usize,
}

impl fmt::Display for Inverted {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "element {} is inverted", self.element)
    }
}

impl std::error::Error for Inverted {}

/// Deformation gradient without torsion: ∂r/∂R, ∂r/∂Z, ∂z/∂R, ∂z/∂Z and r/R; or its inverse.
#[derive(Clone, Copy, Debug, Default)]
struct Gradient {
    plane: [[Lanes; 2]; 2],
    hoop: Lanes,
}

impl Gradient {
    #[inline]
    fn plane_determinant(&self) -> Lanes {
        self.plane[0][0] * self.plane[1][1] - self.plane[0][1] * self.plane[1][0]
    }

    #[inline]
    fn inverse(&self) -> Self {
        let factor = Lanes::of(1.0) / self.plane_determinant();
        let [[a, b], [c, d]] = self.plane;
        Self {
            plane: [[d * factor, -b * factor], [-c * factor, a * factor]],
            hoop: Lanes::of(1.0) / self.hoop,
        }
    }

    /// f b fᵀ with the deformation f that leads from the state whose inverse gradient is given to `self`.
    #[inline]
    fn push(&self, inverse_before: &Self, b: &Symmetric) -> Symmetric {
        let before = &inverse_before.plane;
        let step =
            |i: usize, j: usize| self.plane[i][0] * before[0][j] + self.plane[i][1] * before[1][j];
        let [[rr, rz], [zr, zz]] = [[step(0, 0), step(0, 1)], [step(1, 0), step(1, 1)]];
        let hoop = self.hoop * inverse_before.hoop;
        Symmetric {
            rr: rr * (rr * b.rr + 2.0 * rz * b.rz) + rz * rz * b.zz,
            zz: zz * (zz * b.zz + 2.0 * zr * b.rz) + zr * zr * b.rr,
            rz: rr * (zr * b.rr + zz * b.rz) + rz * (zr * b.rz + zz * b.zz),
            tt: hoop * hoop * b.tt,
        }
    }
}

/// The points of Gauss of an element: geometry of the undeformed body and the history of the metal.
#[derive(Clone, Debug)]
struct Points {
    /// ∂N/∂R and ∂N/∂Z of the four shape functions, 1/m.
    slope: [[Lanes; 2]; 4],
    /// N/R, 1/m.
    hoop_slope: [Lanes; 4],
    /// Undeformed volumes of the whole rings, m³.
    volume: Lanes,
    inverse: Gradient,
    elastic_strain: Symmetric,
    plastic_strain: Lanes,
}

/// Energies of the body, J.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stored {
    /// Elastic energy.
    pub elastic: f64,
    /// Plastic work since the start.
    pub plastic: f64,
}

/// A body of revolution in four-node elements.
///
/// Two by two points of Gauss carry the deviator, so that no zero-energy mode is left; the dilatation of an
/// element is the mean of its points, J̄ = Σ V_g J_g/Σ V_g, so that incompressible flow does not lock
/// (Nagtegaal, Parks and Rice 1974; Simo, Taylor and Pister 1985). Stored energy of an element:
///
/// ```text
///   Σ_g V_g μ |e_g|² + V U(J̄) ,   U = ½ κ (ln J̄)² ,   yield q ≤ J̄ σ_Y .
/// ```
///
/// Its derivative gives the forces of the stress τ' + (J_g/J̄) κ ln J̄ 1. Integrals run over the whole turn
/// with the radius as weight; masses are the row sums ∫ ρ N 2πR dR dZ.
#[derive(Clone, Debug)]
pub struct Body {
    /// The undeformed mesh.
    pub mesh: Mesh,
    /// The material.
    pub metal: Metal,
    /// Lumped masses of the nodes, kg.
    pub mass: Vec<f64>,
    /// Places (radius, height) of the nodes, m.
    pub position: Vec<[f64; 2]>,
    /// Internal forces on the nodes (radial, axial), N; of the whole ring.
    pub force: Vec<[f64; 2]>,
    points: Vec<Points>,
    stored: Stored,
    stable_step: f64,
}

impl Body {
    /// The undeformed body.
    ///
    /// # Panics
    /// If an element of the mesh is inverted.
    #[must_use]
    pub fn new(mesh: Mesh, metal: Metal) -> Self {
        let mut mass = vec![0.0; mesh.nodes.len()];
        let mut all_points = Vec::with_capacity(mesh.elements.len());
        for element in &mesh.elements {
            let (points, shape) = undeformed(&element.map(|node| mesh.nodes[node]));
            for (node, shape) in element.iter().zip(shape) {
                mass[*node] += metal.density * (points.volume * shape).sum();
            }
            all_points.push(points);
        }
        let mut body = Self {
            position: mesh.nodes.clone(),
            force: vec![[0.0; 2]; mesh.nodes.len()],
            mesh,
            metal,
            mass,
            points: all_points,
            stored: Stored::default(),
            stable_step: 0.0,
        };
        body.deform()
            .expect("an undeformed mesh without inverted elements");
        body
    }

    /// Energies at the last [`deform`](Self::deform).
    #[must_use]
    pub fn stored(&self) -> Stored {
        self.stored
    }

    /// Estimate of the largest stable step of central differences, s: for every point 1/(c_p √λ) with the
    /// largest eigenvalue λ of Σ_a ∇N_a ⊗ ∇N_a in the deformed body (Flanagan and Belytschko 1984).
    #[must_use]
    pub fn stable_step(&self) -> f64 {
        self.stable_step
    }

    /// Mean equivalent plastic strain of every element.
    #[must_use]
    pub fn plastic_strain(&self) -> Vec<f64> {
        self.points
            .iter()
            .map(|points| 0.25 * points.plastic_strain.sum())
            .collect()
    }

    /// Stresses, history and forces at the present positions; the increment is that since the last call.
    ///
    /// # Errors
    /// If an element is inverted at a point of Gauss.
    pub fn deform(&mut self) -> Result<(), Inverted> {
        self.force.fill([0.0; 2]);
        self.stored.elastic = 0.0;
        let mut largest = Lanes::of(0.0);
        let all = self.mesh.elements.iter().zip(&mut self.points);
        for (number, (element, points)) in all.enumerate() {
            let corners = element.map(|node| self.position[node]);
            let gradient = points.deformation(&corners);
            let determinant = gradient.plane_determinant() * gradient.hoop;
            // Not `<=`: a position that is not a number counts as well.
            if !(determinant.smallest() > 0.0 && gradient.hoop.smallest() > 0.0) {
                return Err(Inverted { element: number });
            }
            let volume = points.volume.sum();
            let jacobian = (points.volume * determinant).sum() / volume;
            let logarithm = jacobian.ln();
            let pressure = self.metal.bulk_modulus * logarithm;

            let trial = gradient.push(&points.inverse, &points.elastic_strain);
            let response = self.metal.respond(&trial, jacobian, points.plastic_strain);
            points.inverse = gradient.inverse();
            points.elastic_strain = response.elastic_strain;
            points.plastic_strain += response.plastic_increment;
            self.stored.elastic += 0.5 * volume * pressure * logarithm
                + (points.volume * response.distortion_energy).sum();
            self.stored.plastic += (points.volume * response.plastic_work).sum();

            let spherical = pressure / jacobian * determinant;
            let (forces, squares) = points.forces(&response.deviator, spherical);
            largest = largest.max(squares);
            for (node, [radial, axial]) in element.iter().zip(forces) {
                self.force[*node][0] += radial;
                self.force[*node][1] += axial;
            }
        }
        self.stable_step = 1.0 / (self.metal.pressure_wave_speed() * largest.largest().sqrt());
        Ok(())
    }
}

/// The points of an undeformed element, and the four shape functions there.
fn undeformed(corners: &[[f64; 2]; 4]) -> (Points, [Lanes; 4]) {
    const SIGNS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let one = Lanes::of(1.0);
    let [xi, eta] = [0, 1].map(|k| Lanes(SIGNS.map(|signs| signs[k] / 3.0_f64.sqrt())));
    let shape = SIGNS.map(|[s, t]| 0.25 * ((one + s * xi) * (one + t * eta)));
    let local = SIGNS.map(|[s, t]| [0.25 * s * (one + t * eta), 0.25 * t * (one + s * xi)]);
    let mut map = [[Lanes::default(); 2]; 2];
    let mut radius = Lanes::default();
    for (corner, (shape, local)) in corners.iter().zip(shape.iter().zip(&local)) {
        radius += corner[0] * *shape;
        for (row, place) in map.iter_mut().zip(corner) {
            row[0] += *place * local[0];
            row[1] += *place * local[1];
        }
    }
    let [[a, b], [c, d]] = map;
    let determinant = a * d - b * c;
    let points = Points {
        slope: local.map(|[s, t]| [(s * d - t * c) / determinant, (t * a - s * b) / determinant]),
        hoop_slope: shape.map(|value| value / radius),
        volume: 2.0 * PI * (radius * determinant),
        inverse: Gradient {
            plane: [[one, Lanes::default()], [Lanes::default(), one]],
            hoop: one,
        },
        elastic_strain: Symmetric::unit(),
        plastic_strain: Lanes::default(),
    };
    (points, shape)
}

impl Points {
    #[inline]
    fn deformation(&self, corners: &[[f64; 2]; 4]) -> Gradient {
        let mut gradient = Gradient::default();
        let slopes = self.slope.iter().zip(&self.hoop_slope);
        for ([r, z], (slope, hoop)) in corners.iter().zip(slopes) {
            gradient.plane[0][0] += *r * slope[0];
            gradient.plane[0][1] += *r * slope[1];
            gradient.plane[1][0] += *z * slope[0];
            gradient.plane[1][1] += *z * slope[1];
            gradient.hoop += *r * *hoop;
        }
        gradient
    }

    /// Forces −V (τ ∇N + τ_θθ N/r e_r) on the nodes; the largest eigenvalue of Σ ∇N ⊗ ∇N, 1/m².
    #[inline]
    fn forces(&self, deviator: &Symmetric, spherical: Lanes) -> ([[f64; 2]; 4], Lanes) {
        let inverse = &self.inverse.plane;
        let volume = -self.volume;
        let [rr, zz] = [deviator.rr + spherical, deviator.zz + spherical].map(|s| volume * s);
        let rz = volume * deviator.rz;
        let hoop = volume * (deviator.tt + spherical);
        let mut squares = Symmetric::default();
        let mut forces = [[0.0; 2]; 4];
        let slopes = self.slope.iter().zip(&self.hoop_slope);
        for (force, ([s, t], around)) in forces.iter_mut().zip(slopes) {
            let r = *s * inverse[0][0] + *t * inverse[1][0];
            let z = *s * inverse[0][1] + *t * inverse[1][1];
            let around = *around * self.inverse.hoop;
            squares.rr += r * r + around * around;
            squares.zz += z * z;
            squares.rz += r * z;
            *force = [
                (rr * r + rz * z + hoop * around).sum(),
                (rz * r + zz * z).sum(),
            ];
        }
        let mean = 0.5 * (squares.rr + squares.zz);
        let half = 0.5 * (squares.rr - squares.zz);
        (
            forces,
            mean + (half * half + squares.rz * squares.rz).sqrt(),
        )
    }
}
