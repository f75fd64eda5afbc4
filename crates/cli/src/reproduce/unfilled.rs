//! How much of a place the material has not filled.

use jstsph_output::{StoredCells, StoredFrame};
use jstsph_tensor::Vec3;

/// Sample points along each side of the box: a thousandth of its area is three hundred of them.
const SAMPLES: usize = 560;

/// Part of the free area of a box in the x-y plane that no cell covers, by sampling.
pub(super) fn part(
    frame: &StoredFrame,
    x: [f64; 2],
    y: [f64; 2],
    is_free: impl Fn(&Vec3) -> bool,
) -> f64 {
    let StoredCells::Quads(cells) = &frame.cells else {
        return f64::NAN;
    };
    let corners: Vec<[Vec3; 4]> = cells
        .iter()
        .map(|cell| cell.map(|a| frame.positions[a]))
        .filter(|corners| overlaps(corners, x, y))
        .collect();
    let (mut free, mut empty) = (0_u32, 0_u32);
    for i in 0..SAMPLES {
        for j in 0..SAMPLES {
            let at = |k: usize, [from, to]: [f64; 2]| {
                from + (to - from) * (k as f64 + 0.5) / SAMPLES as f64
            };
            let point = Vec3::new(at(i, x), at(j, y), 0.0);
            if is_free(&point) {
                free += 1;
                empty += u32::from(!corners.iter().any(|cell| contains(cell, &point)));
            }
        }
    }
    f64::from(empty) / f64::from(free)
}

fn overlaps(corners: &[Vec3; 4], x: [f64; 2], y: [f64; 2]) -> bool {
    let spans = |axis: usize, [from, to]: [f64; 2]| {
        corners.iter().any(|corner| corner[axis] >= from)
            && corners.iter().any(|corner| corner[axis] <= to)
    };
    spans(0, x) && spans(1, y)
}

/// Whether a ray from the point crosses the outline an odd number of times.
fn contains(corners: &[Vec3; 4], point: &Vec3) -> bool {
    let mut is_inside = false;
    for side in 0..4 {
        let (a, b) = (&corners[side], &corners[(side + 1) % 4]);
        if (a.y > point.y) != (b.y > point.y)
            && point.x < a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y)
        {
            is_inside = !is_inside;
        }
    }
    is_inside
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_neither_wall_nor_material_is_unfilled() {
        // A unit square; the box is 2 x 1, of which a wall takes x > 1.5.
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let frame = StoredFrame {
            positions: corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec(),
            cells: StoredCells::Quads(vec![[0, 1, 2, 3]]),
            ..StoredFrame::default()
        };
        let part_of =
            |is_free: &dyn Fn(&Vec3) -> bool| part(&frame, [0.0, 2.0], [0.0, 1.0], is_free);
        // Half a sample column of 560.
        assert!((part_of(&|_| true) - 0.5).abs() < 2e-3);
        assert!((part_of(&|x| x.x < 1.5) - 1.0 / 3.0).abs() < 2e-3);
        let empty = StoredFrame::default();
        assert!(part(&empty, [0.0, 1.0], [0.0, 1.0], |_| true).is_nan());
    }

    #[test]
    fn a_skewed_cell_contains_what_its_outline_encloses() {
        let cell =
            [(0.0, 0.0), (2.0, 1.0), (3.0, 3.0), (1.0, 2.0)].map(|(x, y)| Vec3::new(x, y, 0.0));
        assert!(contains(&cell, &Vec3::new(1.5, 1.5, 0.0)));
        assert!(!contains(&cell, &Vec3::new(2.5, 1.0, 0.0)));
        assert!(!contains(&cell, &Vec3::new(0.0, 1.0, 0.0)));
    }
}
