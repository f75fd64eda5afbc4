//! Numbers read off a running simulation: extents, radii, statistics and values along lines.

use jstsph_tensor::Vec3;

/// A scalar field of the particles, as written to output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    /// Equivalent plastic strain.
    EquivalentPlasticStrain,
    /// Von Mises stress, Pa.
    VonMisesStress,
    /// Pressure (mean Cauchy stress, tension positive), Pa.
    Pressure,
    /// The unknown J.
    Jacobian,
    /// Wave speed (3.17), m/s.
    WaveSpeed,
    /// Temperature, K.
    Temperature,
    /// Component of the displacement, m.
    Displacement(usize),
    /// Component of the position, m.
    Position(usize),
    /// Component of the velocity, m/s.
    Velocity(usize),
}

/// How the values of a selection become one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Statistic {
    /// Mean weighted with the reference volume.
    Mean,
    /// Median of the values.
    Median,
    /// Smallest value.
    Minimum,
    /// Largest value.
    Maximum,
}

/// A named reading.
#[derive(Clone, Debug)]
pub struct Probe {
    /// Column name.
    pub name: String,
    /// What is read.
    pub kind: ProbeKind,
}

/// What a [`Probe`] reads. Particles are indices into the whole simulation, ascending.
#[derive(Clone, Debug)]
pub enum ProbeKind {
    /// Largest minus smallest current coordinate along an axis (0, 1, 2), m.
    Extent {
        /// Particles.
        particles: Vec<u32>,
        /// Axis.
        axis: usize,
    },
    /// Mean current distance from a fixed line through `point` along an axis, m.
    Radius {
        /// Particles.
        particles: Vec<u32>,
        /// A point of the line.
        point: Vec3,
        /// Axis of the line.
        axis: usize,
    },
    /// Mean current distance of an edge of a body from a fixed line, m: every node of the edge is
    /// carried to the true edge by its deformation gradient, x + F (X_edge − X), so that the answer does
    /// not depend on how far inside of it the nodes of a staircase lie.
    EdgeRadius {
        /// Parts of the edge.
        edge: Vec<EdgePart>,
        /// A point of the line.
        point: Vec3,
        /// Axis of the line.
        axis: usize,
    },
    /// A statistic of a field over particles.
    Statistic {
        /// Particles.
        particles: Vec<u32>,
        /// Field.
        field: Field,
        /// Statistic.
        statistic: Statistic,
    },
    /// Shepard-corrected SPH interpolation of a field at a fixed point of space; NaN where no
    /// particle is near.
    Point {
        /// Position, m.
        position: Vec3,
        /// Field.
        field: Field,
    },
    /// The same at equally spaced points of a line, ends included; columns `name_1`, `name_2`, ...
    Line {
        /// First point, m.
        from: Vec3,
        /// Last point, m.
        to: Vec3,
        /// Number of points, at least two.
        count: usize,
        /// Field.
        field: Field,
    },
}

/// Part of an edge that belongs to one particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgePart {
    /// The particle, an index into the whole simulation.
    pub particle: u32,
    /// From the particle to the true edge in the undeformed body, m.
    pub arm: Vec3,
    /// Length or area of the part, in any unit.
    pub weight: f64,
}

impl crate::Simulation {
    /// Column names of a probe: its name, or `name_1`, `name_2`, ... for a line.
    #[must_use]
    pub fn probe_columns(probe: &Probe) -> Vec<String> {
        match &probe.kind {
            ProbeKind::Line { count, .. } => (1..=*count)
                .map(|i| format!("{}_{i}", probe.name))
                .collect(),
            _ => vec![probe.name.clone()],
        }
    }

    /// Reads a probe, one value per column.
    #[must_use]
    pub fn probe(&self, probe: &Probe) -> Vec<f64> {
        let position = &self.state().position;
        match &probe.kind {
            ProbeKind::Extent { particles, axis } => {
                let coordinates = || particles.iter().map(|&a| position[a as usize][*axis]);
                let highest = coordinates().fold(f64::NEG_INFINITY, f64::max);
                let lowest = coordinates().fold(f64::INFINITY, f64::min);
                vec![highest - lowest]
            }
            ProbeKind::Radius {
                particles,
                point,
                axis,
            } => {
                let total: f64 = particles
                    .iter()
                    .map(|&a| distance(&position[a as usize], point, *axis))
                    .sum();
                vec![total / particles.len() as f64]
            }
            ProbeKind::EdgeRadius { edge, point, axis } => {
                let (mut sum, mut total) = (0.0, 0.0);
                for part in edge {
                    let a = part.particle as usize;
                    let place = position[a] + self.particle(a).deformation_gradient() * part.arm;
                    sum += part.weight * distance(&place, point, *axis);
                    total += part.weight;
                }
                vec![sum / total]
            }
            ProbeKind::Statistic {
                particles,
                field,
                statistic,
            } => {
                let value = |a: u32| self.field_value(*field, a as usize);
                vec![self.statistic(particles, *statistic, &value)]
            }
            ProbeKind::Point { position, field } => {
                vec![self.interpolated(position, *field)]
            }
            ProbeKind::Line {
                from,
                to,
                count,
                field,
            } => (0..*count)
                .map(|i| {
                    let fraction = i as f64 / (*count - 1) as f64;
                    self.interpolated(&(from + (to - from) * fraction), *field)
                })
                .collect(),
        }
    }

    fn statistic(
        &self,
        particles: &[u32],
        statistic: Statistic,
        value: &dyn Fn(u32) -> f64,
    ) -> f64 {
        let values = particles.iter().map(|&a| value(a));
        match statistic {
            Statistic::Minimum => values.fold(f64::INFINITY, f64::min),
            Statistic::Maximum => values.fold(f64::NEG_INFINITY, f64::max),
            Statistic::Mean => {
                let volume = |a: u32| self.reference().volume[a as usize];
                let total: f64 = particles.iter().map(|&a| volume(a)).sum();
                particles.iter().map(|&a| volume(a) * value(a)).sum::<f64>() / total
            }
            Statistic::Median => {
                let mut sorted: Vec<f64> = values.collect();
                sorted.sort_by(f64::total_cmp);
                let middle = sorted.len() / 2;
                if sorted.is_empty() {
                    f64::NAN
                } else if sorted.len() % 2 == 1 {
                    sorted[middle]
                } else {
                    0.5 * (sorted[middle - 1] + sorted[middle])
                }
            }
        }
    }

    fn field_value(&self, field: Field, a: usize) -> f64 {
        let particle = self.particle(a);
        match field {
            Field::EquivalentPlasticStrain => particle.equivalent_plastic_strain(),
            Field::VonMisesStress => particle.von_mises_stress(),
            Field::Pressure => particle.pressure(),
            Field::Jacobian => self.state().jacobian[a],
            Field::WaveSpeed => particle.wave_speed(),
            Field::Temperature => self.state().temperature[a],
            Field::Displacement(axis) => particle.displacement()[axis],
            Field::Position(axis) => self.state().position[a][axis],
            Field::Velocity(axis) => particle.velocity()[axis],
        }
    }

    /// Shepard interpolation in the current configuration, over all bodies, with the largest
    /// support of any.
    fn interpolated(&self, point: &Vec3, field: Field) -> f64 {
        let reference = self.reference();
        let (mut sum, mut total) = (0.0, 0.0);
        for body in &reference.bodies {
            let support = jstsph_sph::Support {
                // Particles move apart: at least one and a half spacings.
                smoothing_length: body.support.smoothing_length.max(1.5 * body.spacing),
                ..body.support
            };
            for a in body.particles.clone() {
                let r = (self.state().position[a] - point).norm();
                if r < support.radius() {
                    let weight = reference.volume[a] * support.value(r);
                    sum += weight * self.field_value(field, a);
                    total += weight;
                }
            }
        }
        sum / total
    }
}

/// Distance of a place from the line through `point` along an axis, m.
fn distance(place: &Vec3, point: &Vec3, axis: usize) -> f64 {
    let mut arm = place - point;
    arm[axis] = 0.0;
    arm.norm()
}
