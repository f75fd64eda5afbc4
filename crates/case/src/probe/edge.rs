//! The edge of a round body that is only a part of one: the nodes of its staircase and their shares.

use std::collections::HashSet;
use std::f64::consts::PI;

use jstsph_solver::EdgePart;
use jstsph_tensor::Vec3;

/// The selected nodes that lack a neighbour outwards, within one and a half spacings of the edge, each with
/// the way to the edge along its ray from the axis and the angle that is nearest to it. Of an arc that is
/// not closed (a quarter between two planes of symmetry) the nodes at its ends have the angle on one side
/// only. The numbers of the particles are those of `nodes`.
pub(super) fn parts(
    nodes: &[(u32, Vec3)],
    spacing: f64,
    axis: usize,
    point: &Vec3,
    radius: f64,
) -> Vec<EdgePart> {
    let (one, other) = ((axis + 1) % 3, (axis + 2) % 3);
    let place = |x: &Vec3| [x[one] - point[one], x[other] - point[other]];
    #[expect(clippy::cast_possible_truncation, reason = "numbers of lattice cells")]
    let cell = |[x, y]: [f64; 2]| [(x / spacing).round() as i64, (y / spacing).round() as i64];
    let present: HashSet<[i64; 2]> = nodes.iter().map(|(_, x)| cell(place(x))).collect();
    let outward = |x: f64| {
        if x.abs() < 0.5 * spacing {
            0.0
        } else {
            x.signum() * spacing
        }
    };

    let mut edge: Vec<(f64, u32, Vec3)> = Vec::new();
    for (node, x) in nodes {
        let [a, b] = place(x);
        let distance = a.hypot(b);
        let near = distance > 0.0 && (distance - radius).abs() < 1.5 * spacing;
        let neighbours = [[a + outward(a), b], [a, b + outward(b)]];
        if near
            && neighbours
                .iter()
                .any(|place| !present.contains(&cell(*place)))
        {
            let mut arm = Vec3::zeros();
            arm[one] = a * (radius / distance - 1.0);
            arm[other] = b * (radius / distance - 1.0);
            edge.push((b.atan2(a), *node, arm));
        }
    }
    edge.sort_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)));

    let count = edge.len();
    let gap = |k: usize| {
        let gap = edge[(k + 1) % count].0 - edge[k].0;
        // The arc is open where nothing is for half a turn.
        let gap = if k + 1 == count { gap + 2.0 * PI } else { gap };
        if gap > PI * (1.0 - 1e-9) { 0.0 } else { gap }
    };
    (0..count)
        .map(|k| EdgePart {
            particle: edge[k].1,
            arm: edge[k].2,
            weight: if count == 1 {
                1.0
            } else {
                0.5 * (gap(k) + gap((k + count - 1) % count))
            },
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nodes of the section of a cylinder of radius 4 h about z, all of them or those of a quarter.
    fn section(quarter: bool) -> Vec<(u32, Vec3)> {
        let h = 0.5;
        let from = if quarter { 0 } else { -4 };
        let mut nodes = Vec::new();
        for i in from..=4_i32 {
            for j in from..=4_i32 {
                if i * i + j * j <= 16 {
                    let x = Vec3::new(f64::from(i) * h + 1.0, f64::from(j) * h, 3.0);
                    nodes.push((u32::try_from(nodes.len()).unwrap(), x));
                }
            }
        }
        nodes
    }

    fn parts_of(nodes: &[(u32, Vec3)]) -> Vec<EdgePart> {
        parts(nodes, 0.5, 2, &Vec3::new(1.0, 0.0, 0.0), 2.0)
    }

    #[test]
    fn every_part_reaches_the_edge_and_the_angles_add_up() {
        for (quarter, angle, count) in [(false, 2.0 * PI, 20), (true, 0.5 * PI, 6)] {
            let nodes = section(quarter);
            let parts = parts_of(&nodes);
            assert_eq!(parts.len(), count);
            let total: f64 = parts.iter().map(|part| part.weight).sum();
            assert!((total - angle).abs() < 1e-12, "{total}");
            for part in &parts {
                let end = nodes[part.particle as usize].1 + part.arm;
                assert!(((end.x - 1.0).hypot(end.y) - 2.0).abs() < 1e-14);
                assert_eq!(end.z, 3.0);
            }
        }
    }

    #[test]
    fn a_quarter_has_the_mean_of_the_whole() {
        // A quantity with the symmetry of the quarter, weighted.
        let mean = |nodes: &[(u32, Vec3)]| {
            let (mut sum, mut total) = (0.0, 0.0);
            for part in parts_of(nodes) {
                let x = nodes[part.particle as usize].1;
                sum += part.weight * (x.x - 1.0).abs().powi(3);
                total += part.weight;
            }
            sum / total
        };
        let (whole, quarter) = (mean(&section(false)), mean(&section(true)));
        assert!((quarter / whole - 1.0).abs() < 1e-12, "{quarter} {whole}");
    }

    #[test]
    fn nothing_lies_on_an_edge_far_outside() {
        let parts = parts(&section(true), 0.5, 2, &Vec3::new(1.0, 0.0, 0.0), 4.0);
        assert!(parts.is_empty());
    }
}
