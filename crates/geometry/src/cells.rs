//! Lattice cells, for counting inverted ones and for drawing.

use jstsph_tensor::Vec3;

/// Full cells of a lattice, corners in VTK order: counter-clockwise in the plane, bottom square
/// then top square in space, so that an undeformed cell has a positive volume.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Cells {
    /// Quadrilaterals (VTK type 9) of plane strain.
    Quads(Vec<[u32; 4]>),
    /// Hexahedra (VTK type 12) of three dimensions.
    Hexes(Vec<[u32; 8]>),
}

impl Cells {
    /// Number of cells.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Quads(cells) => cells.len(),
            Self::Hexes(cells) => cells.len(),
        }
    }

    /// Whether there are none, as in bodies made of rings.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Numbers of degenerate cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CellDefects {
    /// Cells whose total area or volume is not positive (or not a number).
    pub inverted: usize,
    /// Cells with a Jacobian that is not positive at some corner; contains the inverted ones.
    pub not_convex: usize,
}

/// Counts the cells that the deformation has turned inside out or made non-convex.
///
/// A quadrilateral is convex when all four corner triangles are positively oriented; its area is
/// half the cross product of its diagonals. The volume of a hexahedron is that of the trilinear
/// map. In space a positive Jacobian at the corners is necessary, not sufficient, for a Jacobian
/// positive throughout.
///
/// # Panics
/// If a cell names a node that `positions` does not have.
#[must_use]
pub fn inverted_cells(cells: &Cells, positions: &[Vec3]) -> CellDefects {
    match cells {
        Cells::Quads(cells) => count(cells, positions, quad_area, quad_is_convex),
        Cells::Hexes(cells) => count(cells, positions, hex_volume, hex_is_convex),
    }
}

fn count<const N: usize>(
    cells: &[[u32; N]],
    positions: &[Vec3],
    volume: fn(&[Vec3; N]) -> f64,
    is_convex: fn(&[Vec3; N]) -> bool,
) -> CellDefects {
    let mut defects = CellDefects::default();
    for cell in cells {
        let corners = cell.map(|node| positions[node as usize]);
        // Written so that NaN counts as a defect.
        let upright = volume(&corners) > 0.0;
        defects.inverted += usize::from(!upright);
        defects.not_convex += usize::from(!(upright && is_convex(&corners)));
    }
    defects
}

fn quad_area([a, b, c, d]: &[Vec3; 4]) -> f64 {
    0.5 * (c - a).xy().perp(&(d - b).xy())
}

fn quad_is_convex(x: &[Vec3; 4]) -> bool {
    (0..4).all(|i| {
        let (next, previous) = (x[(i + 1) % 4] - x[i], x[(i + 3) % 4] - x[i]);
        next.xy().perp(&previous.xy()) > 0.0
    })
}

/// Faces of a hexahedron, corners counter-clockwise seen from outside.
const HEX_FACES: [[usize; 4]; 6] = [
    [0, 3, 2, 1],
    [4, 5, 6, 7],
    [0, 1, 5, 4],
    [1, 2, 6, 5],
    [2, 3, 7, 6],
    [3, 0, 4, 7],
];

/// Neighbours of each corner of a hexahedron, right-handed.
const HEX_EDGES: [[usize; 3]; 8] = [
    [1, 3, 4],
    [2, 0, 5],
    [3, 1, 6],
    [0, 2, 7],
    [7, 5, 0],
    [4, 6, 1],
    [5, 7, 2],
    [6, 4, 3],
];

/// Volume below the six bilinear faces; each is the mean of its two triangulations.
fn hex_volume(x: &[Vec3; 8]) -> f64 {
    let triple = |a: Vec3, b: Vec3, c: Vec3| a.dot(&b.cross(&c));
    let sum: f64 = HEX_FACES
        .iter()
        .map(|face| {
            // Relative to a corner, so that round-off scales with the cell.
            let [a, b, c, d] = face.map(|corner| x[corner] - x[0]);
            triple(a, b, c) + triple(a, c, d) + triple(a, b, d) + triple(b, c, d)
        })
        .sum();
    sum / 12.0
}

fn hex_is_convex(x: &[Vec3; 8]) -> bool {
    HEX_EDGES.iter().enumerate().all(|(corner, edges)| {
        let [a, b, c] = edges.map(|other| x[other] - x[corner]);
        a.dot(&b.cross(&c)) > 0.0
    })
}

#[cfg(test)]
mod tests {
    use jstsph_tensor::Mat3;

    use super::*;

    fn cube() -> [Vec3; 8] {
        [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 0.0, 1.0],
            [1.0, 1.0, 1.0],
            [0.0, 1.0, 1.0],
        ]
        .map(Vec3::from)
    }

    fn hexes(x: &[Vec3]) -> CellDefects {
        inverted_cells(&Cells::Hexes(vec![[0, 1, 2, 3, 4, 5, 6, 7]]), x)
    }

    fn quads(x: [[f64; 2]; 4]) -> CellDefects {
        let x = x.map(|[x, y]| Vec3::new(x, y, 0.0));
        inverted_cells(&Cells::Quads(vec![[0, 1, 2, 3]]), &x)
    }

    #[test]
    fn quads_are_sorted_into_sound_not_convex_and_inverted() {
        let defects = |inverted, not_convex| CellDefects {
            inverted,
            not_convex,
        };
        assert_eq!(
            quads([[0., 0.], [1., 0.], [1., 1.], [0., 1.]]),
            defects(0, 0)
        );
        assert_eq!(
            quads([[0., 0.], [1., 0.], [0.2, 0.2], [0., 1.]]),
            defects(0, 1)
        );
        assert_eq!(
            quads([[0., 0.], [0., 1.], [1., 1.], [1., 0.]]),
            defects(1, 1)
        );
        assert_eq!(
            quads([[0., 0.], [f64::NAN, 0.], [1., 1.], [0., 1.]]),
            defects(1, 1)
        );
    }

    #[test]
    fn hexahedra_follow_the_determinant_of_a_linear_map() {
        let map = Mat3::new(1.2, 0.3, -0.1, 0.2, 0.8, 0.4, 0.1, -0.2, 1.5);
        let x = cube().map(|x| map * x + Vec3::new(5.0, 6.0, 7.0));
        assert!((hex_volume(&x) - map.determinant()).abs() < 1e-14);
        assert_eq!(hexes(&x), CellDefects::default());
        let mirrored = cube().map(|x| Vec3::new(-x.x, x.y, x.z));
        assert_eq!(
            hexes(&mirrored),
            CellDefects {
                inverted: 1,
                not_convex: 1
            }
        );
    }

    #[test]
    fn hex_volume_is_that_of_the_trilinear_map() {
        let mut x = cube();
        x[6] = Vec3::new(1.7, 1.3, 1.4);
        x[1] = Vec3::new(0.9, -0.3, 0.2);
        // det of the trilinear Jacobian is quadratic in each variable: two Gauss points are exact.
        let gauss = [0.5 - 0.5 / 3.0_f64.sqrt(), 0.5 + 0.5 / 3.0_f64.sqrt()];
        let mut expected = 0.0;
        for u in gauss {
            for v in gauss {
                for w in gauss {
                    let along_u = (x[1] - x[0]) * (1.0 - v) * (1.0 - w)
                        + (x[2] - x[3]) * v * (1.0 - w)
                        + (x[5] - x[4]) * (1.0 - v) * w
                        + (x[6] - x[7]) * v * w;
                    let along_v = (x[3] - x[0]) * (1.0 - u) * (1.0 - w)
                        + (x[2] - x[1]) * u * (1.0 - w)
                        + (x[7] - x[4]) * (1.0 - u) * w
                        + (x[6] - x[5]) * u * w;
                    let along_w = (x[4] - x[0]) * (1.0 - u) * (1.0 - v)
                        + (x[5] - x[1]) * u * (1.0 - v)
                        + (x[7] - x[3]) * (1.0 - u) * v
                        + (x[6] - x[2]) * u * v;
                    expected += along_u.dot(&along_v.cross(&along_w)) / 8.0;
                }
            }
        }
        assert!((hex_volume(&x) - expected).abs() < 1e-14);
    }

    #[test]
    fn a_corner_pushed_through_its_neighbours_is_not_convex() {
        let mut x = cube();
        x[6] = Vec3::new(0.1, 0.1, 0.1);
        assert_eq!(
            hexes(&x),
            CellDefects {
                inverted: 0,
                not_convex: 1
            }
        );
    }
}
