//! What a picture shows of the plane of view.

use super::ParticlePlot;
use super::particles::Dot;

/// The undeformed body is shown if it makes the picture's area larger by this factor at most.
const MOST_GROWTH: f64 = 2.0;

/// The smallest upright rectangle about some points.
pub(super) struct Extent {
    pub(super) lower: [f64; 2],
    pub(super) upper: [f64; 2],
}

impl Default for Extent {
    fn default() -> Self {
        Self {
            lower: [f64::MAX; 2],
            upper: [f64::MIN; 2],
        }
    }
}

impl Extent {
    pub(super) fn add(&mut self, point: [f64; 2]) {
        for (i, coordinate) in point.into_iter().enumerate() {
            self.lower[i] = self.lower[i].min(coordinate);
            self.upper[i] = self.upper[i].max(coordinate);
        }
    }

    pub(super) fn size(&self) -> [f64; 2] {
        std::array::from_fn(|i| self.upper[i] - self.lower[i])
    }

    /// With a border of half a spacing, so that a single line of particles has an area.
    pub(super) fn area(&self, spacing: f64) -> f64 {
        self.size().iter().map(|size| size + spacing).product()
    }
}

/// What the picture shows of the plane of view (m), and whether that includes the undeformed body.
pub(super) fn window(plots: &[ParticlePlot], dots: &[Vec<Dot>]) -> ([[f64; 2]; 2], bool) {
    if let Some(window) = plots[0].window {
        return (window, true);
    }
    let mut body = Extent::default();
    let mut both = Extent::default();
    for (plot, dots) in plots.iter().zip(dots) {
        for dot in dots {
            body.add(dot.place);
            both.add(dot.place);
        }
        for point in plot.undeformed.iter().flatten() {
            both.add(plot.project(point));
        }
        if plot.view.plane().is_none() {
            // A surface seen at an angle is only understood as a whole.
            for point in plot.walls.iter().flat_map(|wall| &wall.line) {
                body.add(plot.project(point));
                both.add(plot.project(point));
            }
        }
    }
    let spacing = plots[0].spacing;
    let is_near = both.area(spacing) <= MOST_GROWTH * body.area(spacing);
    let shown = if is_near { both } else { body };
    let size = shown.size();
    let margin = spacing + 0.04 * size[0].max(size[1]);
    (
        [
            shown.lower.map(|x| x - margin),
            shown.upper.map(|x| x + margin),
        ],
        is_near,
    )
}
