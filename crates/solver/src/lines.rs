//! Gradients and forces of bodies with lines of particles: fields in those lines, for as many sums at
//! once as a vector has lanes.

use jstsph_sph::{LaneRow, LineOperator, Lines};
use jstsph_tensor::lanes::TensorTile;
use jstsph_tensor::{Mat3, Vec3};

use crate::parallel;
use crate::reference::{BodyReference, Reference};

/// Fields in lines, as long as the largest body with lines needs; allocated once.
#[derive(Clone, Debug)]
pub(crate) enum LineFields {
    Plane(Fields<2, 4>),
    Space(Fields<3, 9>),
}

/// Vectors of D and tensors of T = D² components.
#[derive(Clone, Debug)]
pub(crate) struct Fields<const D: usize, const T: usize> {
    /// A vector field of the particles.
    vector: Vec<LaneRow<D>>,
    /// A tensor field of the points, column by column.
    tensor: Vec<LaneRow<T>>,
}

impl Default for LineFields {
    fn default() -> Self {
        Self::Space(Fields {
            vector: Vec::new(),
            tensor: Vec::new(),
        })
    }
}

impl LineFields {
    pub(crate) fn new(reference: &Reference) -> Self {
        if reference.is_plane() {
            Self::Plane(Fields::new(reference))
        } else {
            Self::Space(Fields::new(reference))
        }
    }

    /// The tensor field becomes the gradient of a vector field over the particles of a body, times
    /// `factor`.
    pub(crate) fn gradients(&mut self, lines: &LineOperator, field: &[[f64; 4]], factor: f64) {
        match self {
            Self::Plane(fields) => fields.gradients(lines, field, factor),
            Self::Space(fields) => fields.gradients(lines, field, factor),
        }
    }

    /// Forces on the particles of a body by tensors at its points, divided by `divisor`.
    pub(crate) fn divergences(
        &mut self,
        lines: (&BodyReference, &LineOperator),
        tensors: &[Mat3],
        divisor: impl Fn(usize) -> f64 + Sync,
        forces: &mut [Vec3],
    ) {
        match self {
            Self::Plane(fields) => fields.divergences(lines, tensors, divisor, forces),
            Self::Space(fields) => fields.divergences(lines, tensors, divisor, forces),
        }
    }

    /// The tensors of a tile of points by their slots; what `alone` tells of those that have none.
    pub(crate) fn read_tile(
        &self,
        slots: &[u32],
        tile: &mut TensorTile,
        alone: impl Fn(usize) -> Mat3,
    ) {
        match self {
            Self::Plane(fields) => fields.read_tile(slots, tile, alone),
            Self::Space(fields) => fields.read_tile(slots, tile, alone),
        }
    }

    /// The tensor of a point by its slot, or what `alone` tells if it has none.
    pub(crate) fn tensor(&self, slot: u32, alone: impl Fn() -> Mat3) -> Mat3 {
        if slot == LineOperator::ALONE {
            return alone();
        }
        match self {
            Self::Plane(fields) => fields.tensor(slot),
            Self::Space(fields) => fields.tensor(slot),
        }
    }
}

/// Calls `action(piece, rows)` for the pieces of a field.
fn for_each_piece<const N: usize>(
    lines: Lines<'_>,
    rows: &mut [LaneRow<N>],
    action: impl Fn(usize, &mut [LaneRow<N>]) + Sync,
) {
    let rows = &mut rows[..lines.rows()];
    parallel::for_each_piece(rows, lines.rows_of_piece(), lines.slots().len(), action);
}

impl<const D: usize, const T: usize> Fields<D, T> {
    fn new(reference: &Reference) -> Self {
        let most = |of: fn(&LineOperator) -> Lines<'_>| {
            let lines = reference
                .bodies
                .iter()
                .filter_map(|body| body.lines.as_ref());
            lines.map(|lines| of(lines).rows()).max().unwrap_or(0)
        };
        Self {
            vector: vec![LaneRow::ZERO; most(LineOperator::particles)],
            tensor: vec![LaneRow::ZERO; most(LineOperator::points)],
        }
    }

    fn gradients(&mut self, lines: &LineOperator, field: &[[f64; 4]], factor: f64) {
        let Self { vector, tensor } = self;
        let particles = lines.particles();
        for_each_piece(particles, vector, |piece, out| {
            let value = |a: usize| std::array::from_fn(|k| field[a][k]);
            particles.arrange(piece, value, out);
        });
        for_each_piece(lines.points(), tensor, |piece, out| {
            lines.gradients(piece, vector, factor, out);
        });
    }

    fn divergences(
        &mut self,
        (body, lines): (&BodyReference, &LineOperator),
        tensors: &[Mat3],
        divisor: impl Fn(usize) -> f64 + Sync,
        forces: &mut [Vec3],
    ) {
        let Self { vector, tensor } = self;
        let (points, particles) = (lines.points(), lines.particles());
        for_each_piece(points, tensor, |piece, out| {
            let value = |q: usize| {
                let columns: &[[f64; 3]; 3] = tensors[q].as_ref();
                std::array::from_fn(|k| columns[k / D][k % D])
            };
            points.arrange(piece, value, out);
        });
        for_each_piece(particles, vector, |piece, out| {
            lines.divergences(piece, tensor, out);
        });
        let slots = particles.slots();
        parallel::for_each(forces, |a, force| {
            if slots[a] == LineOperator::ALONE {
                let force = std::slice::from_mut(force);
                body.gradient.divergences(a, tensors, force);
            } else {
                *force = Vec3::zeros();
                let components = LaneRow::at(vector, slots[a]);
                for (component, value) in force.iter_mut().zip(components) {
                    *component = value;
                }
            }
            *force /= divisor(a);
        });
    }

    fn read_tile(&self, slots: &[u32], tile: &mut TensorTile, alone: impl Fn(usize) -> Mat3) {
        for (i, &slot) in slots.iter().enumerate() {
            if slot == LineOperator::ALONE {
                let tensor = alone(i);
                for (tile, component) in tile.0.iter_mut().zip(tensor.as_slice()) {
                    tile[i] = *component;
                }
                continue;
            }
            let components = LaneRow::at(&self.tensor, slot);
            for (k, component) in components.into_iter().enumerate() {
                tile.0[3 * (k / D) + k % D][i] = component;
            }
            if D == 2 {
                tile.0[8][i] = 0.0;
            }
        }
    }

    fn tensor(&self, slot: u32) -> Mat3 {
        let components = LaneRow::at(&self.tensor, slot);
        Mat3::from_fn(|r, c| {
            if r < D && c < D {
                components[D * c + r]
            } else {
                0.0
            }
        })
    }
}
