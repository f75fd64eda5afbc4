//! Numbers read off one frame.

use jstsph_geometry::{Cells, inverted_cells};
use jstsph_output::{StoredCells, StoredFrame};
use serde::Deserialize;

use super::measure::MeasureError;

/// Of the coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Axis {
    X,
    Y,
    Z,
}

/// Of many values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Statistic {
    Median,
    Largest,
    Mean,
}

/// Number of lattice cells turned inside out; NaN for a body without cells.
#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    reason = "lattices are far below 2^32"
)]
pub(super) fn inverted(frame: &StoredFrame) -> f64 {
    let cells = match &frame.cells {
        StoredCells::None => return f64::NAN,
        StoredCells::Quads(cells) => {
            Cells::Quads(cells.iter().map(|cell| cell.map(|a| a as u32)).collect())
        }
        StoredCells::Hexahedra(cells) => {
            Cells::Hexes(cells.iter().map(|cell| cell.map(|a| a as u32)).collect())
        }
    };
    inverted_cells(&cells, &frame.positions).inverted as f64
}

fn scalar<'a>(frame: &'a StoredFrame, field: &str) -> Result<&'a [f64], MeasureError> {
    frame.scalar(field).ok_or_else(|| MeasureError::Missing {
        what: "scalar field",
        name: field.to_owned(),
    })
}

/// Largest coordinate, in the undeformed body, of a particle whose field exceeds a value.
///
/// # Errors
/// [`MeasureError::Missing`], [`MeasureError::NoParticle`].
pub(super) fn front(
    frame: &StoredFrame,
    field: &str,
    above: f64,
    axis: Axis,
) -> Result<f64, MeasureError> {
    let displacement = frame
        .vector("displacement")
        .ok_or_else(|| MeasureError::Missing {
            what: "vector field",
            name: "displacement".to_owned(),
        })?;
    let start = frame.positions.iter().zip(displacement).map(|(x, u)| x - u);
    start
        .zip(scalar(frame, field)?)
        .filter(|(_, value)| **value > above)
        .map(|(start, _)| start[axis as usize])
        .max_by(f64::total_cmp)
        .ok_or(MeasureError::NoParticle)
}

/// Values of a field at the particles in a box of the x-y plane.
///
/// # Errors
/// [`MeasureError::Missing`].
pub(super) fn in_box(
    frame: &StoredFrame,
    field: &str,
    x: [f64; 2],
    y: [f64; 2],
) -> Result<Vec<f64>, MeasureError> {
    let within = |value: f64, [from, to]: [f64; 2]| (from..=to).contains(&value);
    Ok(frame
        .positions
        .iter()
        .zip(scalar(frame, field)?)
        .filter(|(position, _)| within(position.x, x) && within(position.y, y))
        .map(|(_, value)| *value)
        .collect())
}

impl Statistic {
    /// Of the values of some particles.
    ///
    /// # Errors
    /// [`MeasureError::NoParticle`] without values.
    #[expect(clippy::cast_precision_loss, reason = "particles are far below 2^53")]
    pub(super) fn over(self, mut values: Vec<f64>) -> Result<f64, MeasureError> {
        values.sort_by(f64::total_cmp);
        let count = values.len();
        let largest = *values.last().ok_or(MeasureError::NoParticle)?;
        Ok(match self {
            Self::Median => 0.5 * (values[(count - 1) / 2] + values[count / 2]),
            Self::Largest => largest,
            Self::Mean => values.iter().sum::<f64>() / count as f64,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jstsph_tensor::Vec3;

    #[test]
    fn statistics_of_values() {
        let values = vec![4.0, 1.0, 2.0, 9.0];
        assert_eq!(Statistic::Median.over(values.clone()).unwrap(), 3.0);
        assert_eq!(Statistic::Largest.over(values.clone()).unwrap(), 9.0);
        assert_eq!(Statistic::Mean.over(values).unwrap(), 4.0);
        assert!(Statistic::Median.over(Vec::new()).is_err());
    }

    #[test]
    fn cells_that_turned_over_are_counted() {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let mut frame = StoredFrame {
            positions: corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec(),
            cells: StoredCells::Quads(vec![[0, 1, 2, 3]]),
            ..StoredFrame::default()
        };
        assert_eq!(inverted(&frame), 0.0);
        frame.positions.swap(0, 2);
        frame.positions.swap(0, 1);
        assert_eq!(inverted(&frame), 1.0);
        assert!(inverted(&StoredFrame::default()).is_nan());
    }

    #[test]
    fn a_box_takes_the_particles_in_it() {
        let frame = StoredFrame {
            positions: vec![Vec3::new(0.0, 0.0, 0.0), Vec3::new(1.0, 2.0, 0.0)],
            scalars: vec![("strain".to_owned(), vec![0.5, 0.7])],
            ..StoredFrame::default()
        };
        let found = |x, y| in_box(&frame, "strain", x, y).unwrap();
        assert_eq!(found([0.5, 2.0], [2.0, 3.0]), [0.7]);
        assert_eq!(found([-1.0, 2.0], [-1.0, 2.0]), [0.5, 0.7]);
        assert!(found([5.0, 6.0], [0.0, 1.0]).is_empty());
        let deformed = StoredFrame {
            vectors: vec![(
                "displacement".to_owned(),
                vec![Vec3::zeros(), Vec3::new(0.0, -1.0, 0.0)],
            )],
            ..frame.clone()
        };
        assert_eq!(front(&deformed, "strain", 0.6, Axis::Y).unwrap(), 3.0);
        assert_eq!(front(&deformed, "strain", 0.4, Axis::X).unwrap(), 1.0);
        assert!(front(&deformed, "strain", 0.8, Axis::X).is_err());
        assert!(in_box(&frame, "stress", [0.0, 1.0], [0.0, 1.0]).is_err());
    }
}
