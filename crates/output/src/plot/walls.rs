//! Lines beside a body: walls of obstacles with their solid side, the undeformed shape.

use jstsph_tensor::Vec3;

use super::canvas::{Canvas, PAPER, STEEL, Stroke, mix};
use super::panels::Panel;
use super::{ParticlePlot, clip};

/// Distance of the hatches that tell the solid side of a wall, and their extent across it.
const HATCH: [f64; 2] = [6.0, 7.0];

/// A line of a rigid obstacle.
#[derive(Debug, Clone, PartialEq)]
pub struct Wall {
    /// Points of the line, m.
    pub line: Vec<Vec3>,
    /// Whether to hatch the side to the right of the line, as seen: the solid one.
    pub is_hatched: bool,
}

/// Draws a line, cut off at the edge of the panel.
pub(super) fn draw_line(
    canvas: &mut Canvas,
    plot: &ParticlePlot,
    line: &[Vec3],
    panel: &Panel,
    stroke: Stroke,
) {
    let places: Vec<[f64; 2]> = line.iter().map(|x| panel.place(plot.project(x))).collect();
    for part in clip::polyline(&places, &panel.frame) {
        canvas.polyline(part, stroke);
    }
}

/// Draws the walls of a plot.
pub(super) fn draw(canvas: &mut Canvas, plot: &ParticlePlot, panel: &Panel) {
    for wall in &plot.walls {
        draw_line(canvas, plot, &wall.line, panel, Stroke::solid(STEEL, 2.0));
        if !wall.is_hatched {
            continue;
        }
        let line: Vec<[f64; 2]> = wall
            .line
            .iter()
            .map(|x| panel.place(plot.project(x)))
            .collect();
        for hatch in hatches(&line) {
            for part in clip::polyline(&hatch, &panel.frame) {
                canvas.polyline(part, Stroke::solid(mix(STEEL, PAPER, 0.25), 0.8));
            }
        }
    }
}

/// Oblique strokes on the right of a line, y downward.
fn hatches(line: &[[f64; 2]]) -> Vec<[[f64; 2]; 2]> {
    let [distance, extent] = HATCH;
    let mut strokes = Vec::new();
    // Arc length to the next stroke, carried over the corners.
    let mut ahead = 0.5 * distance;
    for pair in line.windows(2) {
        let delta = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
        let length = delta[0].hypot(delta[1]);
        if length == 0.0 {
            continue;
        }
        let along = delta.map(|d| d / length);
        let right = [-along[1], along[0]];
        while ahead <= length {
            let from = std::array::from_fn(|i| pair[0][i] + ahead * along[i]);
            let to = std::array::from_fn(|i: usize| from[i] + extent * (right[i] - 0.8 * along[i]));
            strokes.push([from, to]);
            ahead += distance;
        }
        ahead -= length;
    }
    strokes
}

#[cfg(test)]
mod tests {
    use super::hatches;

    #[test]
    fn hatches_stand_on_the_right_of_a_line() {
        // To the right in the picture: the right side is below, where y is larger.
        let below = hatches(&[[0.0, 10.0], [60.0, 10.0]]);
        assert_eq!(below.len(), 10);
        assert!(
            below
                .iter()
                .all(|[from, to]| from[1] == 10.0 && to[1] == 17.0)
        );
        // The distance is kept over a corner.
        let corner = hatches(&[[0.0, 0.0], [10.0, 0.0], [10.0, 50.0]]);
        assert_eq!(corner.len(), 10);
        assert!(corner[2..].iter().all(|[from, to]| to[0] < from[0]));
    }
}
