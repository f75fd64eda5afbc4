//! Lines around a body: obstacles and the undeformed shape.

use std::f64::consts::TAU;

use jstsph_case::Case;
use jstsph_geometry::Shape;
use jstsph_output::plot::Wall;
use jstsph_solver::ModelObstacle;
use jstsph_tensor::Vec3;

use super::body::Sight;

/// Steps of the integral of an obstacle's velocity.
const STEPS: u32 = 2000;
/// Straight pieces of a drawn circle.
const CIRCLE_PIECES: u32 = 96;
/// Distance from a wall's line, over the size of the picture, at which its sides are looked at: farther
/// than the pieces of a drawn circle are from the circle.
const ASIDE: f64 = 1e-3;
/// Part of a line that must have the solid on one and the same side to be hatched.
const AGREEMENT: f64 = 0.9;

/// Outlines of the obstacles where they are at `time` (s), around a body between the two corners.
pub(super) fn walls(
    case: &Case,
    sight: Sight,
    middle: &Vec3,
    corners: (Vec3, Vec3),
    time: f64,
) -> Vec<Wall> {
    let obstacles = case.model.obstacles.iter();
    obstacles
        .flat_map(|obstacle| {
            let shift = displacement(obstacle, time);
            walls_of(obstacle, sight, middle, corners, &shift)
        })
        .collect()
}

/// Outlines of an obstacle that has moved by `shift`.
pub(crate) fn walls_of(
    obstacle: &ModelObstacle,
    sight: Sight,
    middle: &Vec3,
    (mut low, mut high): (Vec3, Vec3),
    shift: &Vec3,
) -> Vec<Wall> {
    let size = (high - low).norm();
    // In a view along an axis lines may reach as far as any picture, which cuts them off; the
    // oblique view shows a part of a plane as large as the body.
    let margin = if sight.plane.is_some() {
        10.0 * size
    } else {
        0.1 * size
    };
    low.add_scalar_mut(-margin);
    high.add_scalar_mut(margin);
    if let Some([_, _, normal]) = sight.plane {
        low[normal] = middle[normal];
        high[normal] = middle[normal];
    }
    let surface = &obstacle.obstacle.surface;
    let is_solid = |x: &Vec3| surface.gap(&(x - shift)).distance < 0.0;
    let lines = surface.outline(&[low - shift, high - shift]).into_iter();
    lines
        .map(|line| {
            let line: Vec<Vec3> = line.iter().map(|x| x + shift).collect();
            oriented(line, sight, middle, size, is_solid)
        })
        .collect()
}

/// The line with the solid to its right, if it is on one side all along.
fn oriented(
    mut line: Vec<Vec3>,
    sight: Sight,
    middle: &Vec3,
    size: f64,
    is_solid: impl Fn(&Vec3) -> bool,
) -> Wall {
    let Some([right, up, normal]) = sight.plane else {
        return Wall {
            line,
            is_hatched: false,
        };
    };
    let (mut on_left, mut on_right, mut whole) = (0.0, 0.0, 0.0);
    for pair in line.windows(2) {
        let along = pair[1] - pair[0];
        let length = along[right].hypot(along[up]);
        if length <= ASIDE * size {
            continue;
        }
        let mut aside = Vec3::zeros();
        aside[right] = along[up] / length * ASIDE * size;
        aside[up] = -along[right] / length * ASIDE * size;
        let mut centre = 0.5 * (pair[0] + pair[1]);
        centre[normal] = middle[normal];
        whole += length;
        match (is_solid(&(centre - aside)), is_solid(&(centre + aside))) {
            (true, false) => on_left += length,
            (false, true) => on_right += length,
            _ => {}
        }
    }
    if on_left > on_right {
        line.reverse();
    }
    Wall {
        line,
        is_hatched: whole > 0.0 && f64::max(on_left, on_right) >= AGREEMENT * whole,
    }
}

/// How far an obstacle has moved at `time` (s): its velocity, integrated with the midpoint rule.
pub(crate) fn displacement(obstacle: &ModelObstacle, time: f64) -> Vec3 {
    let Some(velocity) = &obstacle.velocity else {
        return Vec3::zeros();
    };
    let step = time / f64::from(STEPS);
    let mut moved = Vec3::zeros();
    for i in 0..STEPS {
        let now = (f64::from(i) + 0.5) * step;
        for axis in 0..3 {
            moved[axis] += step * velocity[axis].at(now, &Vec3::zeros());
        }
    }
    moved
}

/// Outlines of the undeformed bodies; none in the oblique view.
pub(crate) fn undeformed(case: &Case, sight: Sight) -> Vec<Vec<Vec3>> {
    let Some([right, up, normal]) = sight.plane else {
        return Vec::new();
    };
    let bodies = case.model.bodies.iter();
    bodies
        .flat_map(|body| outline(&body.body.shape, right, up, normal))
        .collect()
}

/// Lines of a shape seen along `normal`; of a combination the lines of its parts.
fn outline(shape: &Shape, right: usize, up: usize, normal: usize) -> Vec<Vec<Vec3>> {
    let one = match shape {
        Shape::Box { min, max } => rectangle(*min, *max, right, up),
        Shape::Disc { centre, radius } => circle(centre, *radius, 0, 1),
        Shape::Sphere { centre, radius } => circle(centre, *radius, right, up),
        Shape::Cylinder {
            base, axis, radius, ..
        } if axis.index() == normal => circle(base, *radius, right, up),
        Shape::Polygon(polygon) if normal == 2 => {
            let points = polygon.points().iter().chain(polygon.points().first());
            points.map(|&[x, y]| Vec3::new(x, y, 0.0)).collect()
        }
        Shape::Union(parts) | Shape::Intersection(parts) | Shape::Difference(parts) => {
            let lines = parts.iter().map(|part| outline(part, right, up, normal));
            return lines.flatten().collect();
        }
        Shape::Cylinder { .. } | Shape::Polygon(_) | Shape::Mesh(_) => {
            let (min, max) = shape.bounds();
            rectangle(min, max, right, up)
        }
    };
    vec![one]
}

fn rectangle(min: Vec3, max: Vec3, right: usize, up: usize) -> Vec<Vec3> {
    [
        [false, false],
        [true, false],
        [true, true],
        [false, true],
        [false, false],
    ]
    .iter()
    .map(|[is_right, is_up]| {
        let mut corner = min;
        if *is_right {
            corner[right] = max[right];
        }
        if *is_up {
            corner[up] = max[up];
        }
        corner
    })
    .collect()
}

fn circle(centre: &Vec3, radius: f64, right: usize, up: usize) -> Vec<Vec3> {
    (0..=CIRCLE_PIECES)
        .map(|piece| {
            let angle = TAU * f64::from(piece) / f64::from(CIRCLE_PIECES);
            let mut point = *centre;
            point[right] += radius * angle.cos();
            point[up] += radius * angle.sin();
            point
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::testing::block;

    const TABLES: &str = r#"
[[obstacle]]
name = "wall"
plane = { point = [0, 0], normal = [0, 1] }
velocity = { y = { table = [[0, 0], [2e-3, 4]] } }
[[obstacle]]
name = "roof"
plane = { point = [0, 0.006], normal = [0, -1] }
"#;

    const SIGHT: Sight = Sight {
        plane: Some([0, 1, 2]),
        is_cut: false,
    };

    fn case() -> Case {
        block(TABLES)
    }

    #[test]
    fn walls_have_the_solid_to_their_right_and_move() {
        let case = case();
        let corners = (Vec3::zeros(), Vec3::new(0.004, 0.006, 0.0));
        let walls = walls(&case, SIGHT, &Vec3::zeros(), corners, 1e-3);
        assert_eq!(walls.len(), 2);
        assert!(walls.iter().all(|wall| wall.is_hatched));
        // Below the floor is to the right on the way to larger x; the roof runs back.
        let direction = |wall: &Wall| wall.line[1].x - wall.line[0].x;
        assert!(direction(&walls[0]) > 0.0 && direction(&walls[1]) < 0.0);
        // The floor's speed grows to 2 m/s within 1 ms.
        assert!((walls[0].line[0].y - 1e-3).abs() < 1e-12);
        assert!((walls[1].line[0].y - 0.006).abs() < 1e-12);
    }

    #[test]
    fn the_undeformed_body_is_a_closed_line() {
        let lines = undeformed(&case(), SIGHT);
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0][0], lines[0][4]);
        assert_eq!(lines[0][2], Vec3::new(0.004, 0.006, 0.0));
        let oblique = Sight {
            plane: None,
            is_cut: false,
        };
        assert!(undeformed(&case(), oblique).is_empty());
    }
}
