//! Filled cells of a body, the field interpolated between their corners.

use std::collections::HashMap;

use super::ParticlePlot;
use super::canvas::{Canvas, INK, Rect, Stroke, mix};
use super::colorbar::ColourBar;
use super::panels::Panel;

/// Smallest side of the pieces a cell is cut into, and the most pieces along a side.
const PIECE: f64 = 2.5;
const MOST_PIECES: f64 = 48.0;
/// Shades between the ends of the colour bar that pieces tell apart.
const SHADES: f64 = 80.0;
/// How far what is below the pieces reaches beyond the cell: less than half of the outline's width.
const BELOW: f64 = 0.4;
/// Smallest side of a cell whose edges are drawn.
const SIDE_WITH_EDGES: f64 = 7.0;

/// Fills the cells from the farthest to the nearest.
pub(super) fn draw(
    canvas: &mut Canvas,
    plot: &ParticlePlot,
    cells: &[[usize; 4]],
    panel: &Panel,
    bar: &ColourBar,
) {
    let mut sorted: Vec<(f64, &[usize; 4])> = cells
        .iter()
        .map(|cell| {
            let depths = cell.iter().map(|&a| plot.depth(&plot.positions[a]));
            (depths.sum(), cell)
        })
        .collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let sorted: Vec<Cell> = sorted
        .into_iter()
        .map(|(_, cell)| Cell {
            corners: cell.map(|a| panel.place(plot.project(&plot.positions[a]))),
            values: cell.map(|a| plot.values[a]),
        })
        .collect();
    for cell in &sorted {
        cell.draw_below(canvas, &panel.frame, bar);
    }
    for cell in &sorted {
        cell.draw(canvas, &panel.frame, bar);
    }
}

/// A cell in the picture.
struct Cell {
    corners: [[f64; 2]; 4],
    values: [f64; 4],
}

impl Cell {
    /// Something of the right colour below the pieces: where two cells cut their common side
    /// differently, rounding leaves pixels between them that belong to neither.
    fn draw_below(&self, canvas: &mut Canvas, frame: &Rect, bar: &ColourBar) {
        let middle = self.place(0.5, 0.5);
        let points = self.corners.map(|corner| {
            let away = [corner[0] - middle[0], corner[1] - middle[1]];
            let grown = 1.0 + BELOW / away[0].hypot(away[1]).max(BELOW);
            [middle[0] + grown * away[0], middle[1] + grown * away[1]]
        });
        if points.iter().all(|&place| frame.contains(place)) {
            canvas.patch(points.to_vec(), bar.colour(self.value(0.5, 0.5)));
        }
    }

    fn draw(&self, canvas: &mut Canvas, frame: &Rect, bar: &ColourBar) {
        let [across, along] = [[0, 1, 3, 2], [0, 3, 1, 2]].map(|ends| self.pieces(ends, bar));
        let at = |step: usize, pieces: usize| step as f64 / pieces as f64;
        for (i, j) in (0..across).flat_map(|i| (0..along).map(move |j| (i, j))) {
            let steps = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
            let points = steps.map(|[i, j]| self.place(at(i, across), at(j, along)));
            if !points.iter().all(|&place| frame.contains(place)) {
                continue;
            }
            let middle = [at(2 * i + 1, 2 * across), at(2 * j + 1, 2 * along)];
            let colour = bar.colour(self.value(middle[0], middle[1]));
            canvas.patch(points.to_vec(), colour);
        }
        if self.longest_side() < SIDE_WITH_EDGES {
            return;
        }
        for (pieces, is_across) in [(across, true), (along, false)] {
            for (step, edge) in (0..pieces).flat_map(|step| [(step, 0.0), (step, 1.0)]) {
                let [a, b] = [at(step, pieces), at(step + 1, pieces)].map(|place| {
                    if is_across {
                        [place, edge]
                    } else {
                        [edge, place]
                    }
                });
                let ends = [a, b].map(|[s, t]| self.place(s, t));
                if !ends.iter().all(|&place| frame.contains(place)) {
                    continue;
                }
                let value = self.value(0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]));
                let stroke = Stroke::solid(mix(bar.colour(value), INK, 0.28), 0.5);
                canvas.line(ends[0], ends[1], stroke);
            }
        }
    }

    /// Number of pieces along the two opposite sides with these ends.
    fn pieces(&self, [a, b, c, d]: [usize; 4], bar: &ColourBar) -> usize {
        let shades = |a: usize, b: usize| bar.share(self.values[b] - self.values[a]).abs() * SHADES;
        let length = self.side(a, b).max(self.side(c, d));
        let count = shades(a, b).max(shades(c, d)).min(length / PIECE);
        count.ceil().clamp(1.0, MOST_PIECES) as usize
    }

    fn side(&self, a: usize, b: usize) -> f64 {
        let [a, b] = [self.corners[a], self.corners[b]];
        (b[0] - a[0]).hypot(b[1] - a[1])
    }

    fn longest_side(&self) -> f64 {
        (0..4)
            .map(|i| self.side(i, (i + 1) % 4))
            .fold(0.0, f64::max)
    }

    fn place(&self, s: f64, t: f64) -> [f64; 2] {
        std::array::from_fn(|i| bilinear(self.corners.map(|corner| corner[i]), s, t))
    }

    fn value(&self, s: f64, t: f64) -> f64 {
        bilinear(self.values, s, t)
    }
}

/// Interpolation between values at the corners (0, 0), (1, 0), (1, 1), (0, 1).
fn bilinear(values: [f64; 4], s: f64, t: f64) -> f64 {
    let [a, b, c, d] = values;
    (1.0 - t) * ((1.0 - s) * a + s * b) + t * ((1.0 - s) * d + s * c)
}

/// The lines around the cells, by particle: the edges that only one cell has, joined.
pub(super) fn outline(cells: &[[usize; 4]]) -> Vec<Vec<usize>> {
    let mut count: HashMap<[usize; 2], usize> = HashMap::new();
    let edges = || {
        cells
            .iter()
            .flat_map(|cell| (0..4).map(|i| [cell[i], cell[(i + 1) % 4]]))
    };
    let key = |[a, b]: [usize; 2]| [a.min(b), a.max(b)];
    for edge in edges() {
        *count.entry(key(edge)).or_default() += 1;
    }
    // In the cells' order of edges, so that the picture does not depend on the map's.
    let free: Vec<[usize; 2]> = edges().filter(|edge| count[&key(*edge)] == 1).collect();
    let mut leaving: HashMap<usize, Vec<usize>> = HashMap::new();
    for (index, [from, _]) in free.iter().enumerate() {
        leaving.entry(*from).or_default().push(index);
    }
    let mut is_used = vec![false; free.len()];
    let mut lines = Vec::new();
    for start in 0..free.len() {
        let mut line = vec![free[start][0]];
        let mut next = Some(start);
        while let Some(edge) = next.filter(|&edge| !is_used[edge]) {
            is_used[edge] = true;
            let end = free[edge][1];
            line.push(end);
            let onward = leaving.get(&end);
            next = onward.and_then(|edges| edges.iter().copied().find(|&edge| !is_used[edge]));
        }
        if line.len() > 1 {
            lines.push(line);
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_outline_of_a_block_is_one_closed_line() {
        // Three by two cells: twelve nodes, of which two lie inside.
        let cells: Vec<[usize; 4]> = (0..6)
            .map(|i| {
                let a = i % 3 + 4 * (i / 3);
                [a, a + 1, a + 5, a + 4]
            })
            .collect();
        let lines = outline(&cells);
        assert_eq!(lines, [vec![0, 1, 2, 3, 7, 11, 10, 9, 8, 4, 0]]);
        // Without the middle of the lower row the line is longer by two edges.
        let notched: Vec<[usize; 4]> = cells.iter().copied().filter(|cell| cell[0] != 1).collect();
        assert_eq!(outline(&notched)[0].len(), 13);
    }

    #[test]
    fn interpolation_meets_the_corners_and_is_linear() {
        let values = [1.0, 3.0, 6.0, 4.0];
        for (value, [s, t]) in values
            .iter()
            .zip([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
        {
            assert_eq!(bilinear(values, s, t), *value);
        }
        // 1 + 2 s + 3 t.
        assert!((bilinear(values, 0.25, 0.75) - 3.75).abs() < 1e-15);
    }
}
