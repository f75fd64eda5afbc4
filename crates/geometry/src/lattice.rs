//! How a shape is filled with particles.

use crate::shape::positive;
use crate::{Dimension, GeometryError, Shape};

/// Arrangement of the particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lattice {
    /// Axis-parallel lattice with nodes on the boundary; round bodies are cut out of it.
    Cubic {
        /// Its density.
        spacing: Spacing,
    },
    /// Concentric rings of `per_ring`, 2 `per_ring`, 3 `per_ring` ... nodes around a central one,
    /// stacked in layers. Discs and cylinders only; such a body has neither bonds nor cells.
    Rings {
        /// Rings around the central node, at least 1; their distance is radius / rings.
        rings: usize,
        /// Nodes of the innermost ring, at least 3; 8 gives all inner nodes the same volume.
        per_ring: usize,
        /// Layers along the axis including both ends, at least 2; 1 for a disc.
        layers: usize,
    },
}

/// Density of a cubic lattice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spacing {
    /// Wanted distance of neighbouring nodes, m. The number of intervals that comes nearest is
    /// chosen for each direction so that nodes lie on both faces.
    Length(f64),
    /// Nodes along x, y and z of a box, each at least 2; the last is ignored in plane strain.
    Counts([usize; 3]),
    /// Nodes of a disc or cylinder.
    Radial {
        /// n: the spacing in the section is radius / n, and the nodes are the lattice points with
        /// i² + j² ≤ n² (81 for n = 5, 253 for n = 9). At least 1.
        per_radius: usize,
        /// Layers along the axis including both ends, at least 2; 1 for a disc. The axial spacing
        /// may differ from the one in the section.
        layers: usize,
    },
}

/// Largest relative difference between the spacing asked for and the one that fits.
const SPACING_TOLERANCE: f64 = 0.2;

/// More nodes than this are taken for a mistake in the spacing: their neighbour lists alone would
/// need tens of gigabytes.
const NODE_LIMIT: usize = 100_000_000;

/// Nodes along each axis of the bounding box (1 along z in plane strain).
pub(crate) fn box_counts(
    spacing: Spacing,
    shape: &Shape,
    dimension: Dimension,
) -> Result<[usize; 3], GeometryError> {
    const QUANTITIES: [&str; 3] = ["nodes along x", "nodes along y", "nodes along z"];
    const DIRECTIONS: [&str; 3] = ["size along x", "size along y", "size along z"];
    let (min, max) = shape.bounds();
    let mut counts = [1; 3];
    for i in 0..dimension.count() {
        counts[i] = match spacing {
            Spacing::Length(length) => intervals(length, max[i] - min[i], DIRECTIONS[i])? + 1,
            Spacing::Counts(counts) => at_least(2, QUANTITIES[i], counts[i])?,
            Spacing::Radial { .. } => {
                return Err(GeometryError::LatticeMismatch {
                    lattice: "nodes per radius",
                    shape: shape.name(),
                    remedy: "a spacing or counts along the axes",
                });
            }
        };
    }
    limited(counts.map(|n| n as f64).iter().product())?;
    Ok(counts)
}

/// Intervals per radius and layers (1 for a disc) of a clipped cubic lattice.
pub(crate) fn radial_counts(
    spacing: Spacing,
    shape: &Shape,
    radius: f64,
    height: Option<f64>,
) -> Result<(usize, usize), GeometryError> {
    let (per_radius, layers) = match spacing {
        Spacing::Length(length) => (
            intervals(length, radius, "radius")?,
            match height {
                Some(height) => intervals(length, height, "height")? + 1,
                None => 1,
            },
        ),
        Spacing::Radial { per_radius, layers } => (
            at_least(1, "nodes per radius", per_radius)?,
            checked_layers(layers, height)?,
        ),
        Spacing::Counts(_) => {
            return Err(GeometryError::LatticeMismatch {
                lattice: "counts along the axes",
                shape: shape.name(),
                remedy: "a spacing, or nodes per radius and layers",
            });
        }
    };
    limited((2.0 * per_radius as f64 + 1.0).powi(2) * layers as f64)?;
    Ok((per_radius, layers))
}

/// Checks the counts of a lattice of rings.
pub(crate) fn check_rings(
    rings: usize,
    per_ring: usize,
    layers: usize,
    height: Option<f64>,
) -> Result<(), GeometryError> {
    at_least(1, "number of rings", rings)?;
    at_least(3, "nodes of the first ring", per_ring)?;
    checked_layers(layers, height)?;
    limited(per_ring as f64 * (rings as f64 + 1.0).powi(2) * layers as f64)
}

fn checked_layers(layers: usize, height: Option<f64>) -> Result<usize, GeometryError> {
    if height.is_some() {
        return at_least(2, "number of layers", layers);
    }
    if layers == 1 {
        return Ok(1);
    }
    Err(GeometryError::LatticeMismatch {
        lattice: "several layers",
        shape: "disc",
        remedy: "layers = 1",
    })
}

/// Number of intervals of about `spacing` in `length`.
fn intervals(spacing: f64, length: f64, direction: &'static str) -> Result<usize, GeometryError> {
    positive("lattice", "spacing", spacing)?;
    let count = (length / spacing).round().max(1.0);
    limited(count)?;
    let nearest = length / count;
    if (nearest / spacing - 1.0).abs() > SPACING_TOLERANCE {
        return Err(GeometryError::SpacingDeviates {
            spacing,
            direction,
            length,
            nearest,
            limit_percent: 100.0 * SPACING_TOLERANCE,
        });
    }
    Ok(count as usize)
}

fn at_least(minimum: usize, quantity: &'static str, value: usize) -> Result<usize, GeometryError> {
    if value >= minimum {
        Ok(value)
    } else {
        Err(GeometryError::TooFew {
            quantity,
            value,
            minimum,
        })
    }
}

fn limited(count: f64) -> Result<(), GeometryError> {
    if count <= NODE_LIMIT as f64 {
        Ok(())
    } else {
        Err(GeometryError::TooManyNodes {
            count,
            limit: NODE_LIMIT,
        })
    }
}

#[cfg(test)]
mod tests {
    use jstsph_tensor::Vec3;

    use super::*;

    fn rectangle() -> Shape {
        Shape::Box {
            min: Vec3::zeros(),
            max: Vec3::new(1.0, 0.5, 0.0),
        }
    }

    fn counts(spacing: Spacing) -> Result<[usize; 3], GeometryError> {
        box_counts(spacing, &rectangle(), Dimension::PlaneStrain)
    }

    #[test]
    fn the_nearest_count_is_chosen_for_each_axis() {
        assert_eq!(counts(Spacing::Length(0.05)).unwrap(), [21, 11, 1]);
        // 1/0.19 = 5.3 and 0.5/0.19 = 2.6 intervals: 0.2 m and 0.167 m.
        assert_eq!(counts(Spacing::Length(0.19)).unwrap(), [6, 4, 1]);
    }

    #[test]
    fn a_spacing_that_does_not_fit_is_refused() {
        // Fits x (3 intervals) but half a metre has 1.5 intervals.
        assert_eq!(
            counts(Spacing::Length(0.34)).unwrap_err().to_string(),
            "spacing 0.34 m does not divide the size along y of 0.5 m: the nearest is 0.5 m, \
             more than 20 % off; choose another spacing or give counts"
        );
        assert!(matches!(
            counts(Spacing::Length(0.0)),
            Err(GeometryError::NotPositive { value: 0.0, .. })
        ));
        assert!(matches!(
            counts(Spacing::Length(1e-7)),
            Err(GeometryError::TooManyNodes { .. })
        ));
    }

    #[test]
    fn counts_must_suit_the_shape() {
        assert!(matches!(
            counts(Spacing::Counts([5, 1, 0])),
            Err(GeometryError::TooFew {
                value: 1,
                minimum: 2,
                ..
            })
        ));
        assert!(
            counts(Spacing::Radial {
                per_radius: 3,
                layers: 1
            })
            .is_err()
        );
        let disc = Shape::Disc {
            centre: Vec3::zeros(),
            radius: 1.0,
        };
        assert!(radial_counts(Spacing::Counts([3; 3]), &disc, 1.0, None).is_err());
        assert!(check_rings(4, 8, 3, None).is_err());
        assert!(check_rings(4, 8, 1, Some(1.0)).is_err());
        assert!(check_rings(4, 8, 2, Some(1.0)).is_ok());
    }
}
