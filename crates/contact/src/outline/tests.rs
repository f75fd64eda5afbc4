use super::*;
use crate::Surface;
use crate::testing::ecae_die;

const BOUNDS: [Vec3; 2] = [Vec3::new(-1.0, -1.0, -1.0), Vec3::new(1.0, 1.0, 1.0)];

/// Every point of a drawing of a surface is on the surface.
fn assert_on_surface(surface: &Surface, lines: &[Vec<Vec3>]) {
    assert!(!lines.is_empty());
    for point in lines.iter().flatten() {
        let distance = surface.gap(point).distance;
        assert!(distance.abs() < 1e-14, "{point} is {distance} m off");
    }
}

#[test]
fn drawings_lie_on_their_surfaces() {
    let point = Vec3::new(0.1, 0.2, 0.3);
    let axis = Vec3::new(1.0, 1.0, 0.5);
    let surfaces = [
        ecae_die(),
        Surface::plane(point, axis).unwrap(),
        Surface::Sphere {
            centre: point,
            radius: 0.4,
            inside: false,
        },
        Surface::cylinder(point, axis, 0.4, Some(0.3), false).unwrap(),
        Surface::cylinder(point, axis, 0.4, None, false).unwrap(),
        Surface::Box {
            min: Vec3::zeros(),
            max: point,
            inside: true,
        },
    ];
    for surface in &surfaces {
        assert_on_surface(surface, &surface.outline(&BOUNDS));
    }
}

#[test]
fn open_chains_are_drawn_up_to_the_bounds() {
    let lines = ecae_die().outline(&BOUNDS);
    assert_eq!(lines.len(), 2);
    assert_eq!(lines[0][0], Vec3::new(0.0, 1.0, 0.0));
    assert_eq!(lines[0][lines[0].len() - 1], Vec3::new(0.032, -1.0, 0.0));
    // Not where they end beyond the bounds.
    let near = [Vec3::new(0.0, 0.0, 0.0), Vec3::new(0.04, 0.01, 0.0)];
    assert_eq!(ecae_die().outline(&near)[0][0], Vec3::new(0.0, 0.08, 0.0));
}

#[test]
fn a_plane_is_cut_to_the_bounds() {
    let lines = plane(
        &Vec3::zeros(),
        &Vec3::new(1.0, 1.0, 1.0).normalize(),
        &BOUNDS,
    );
    // A regular hexagon, closed.
    assert_eq!((lines.len(), lines[0].len()), (1, 7));
    for pair in lines[0].windows(2) {
        assert!(((pair[1] - pair[0]).norm() - 2.0_f64.sqrt()).abs() < 1e-14);
    }
    // Plane strain: a line. Missed: nothing.
    let flat = [Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, 1.0, 0.0)];
    assert_eq!(plane(&Vec3::zeros(), &Vec3::y(), &flat)[0].len(), 2);
    assert!(plane(&(3.0 * Vec3::y()), &Vec3::y(), &flat).is_empty());
}

#[test]
fn an_infinite_cylinder_is_drawn_as_long_as_the_bounds() {
    let lines = cylinder(&Vec3::zeros(), &Vec3::x(), 0.5, None, &BOUNDS);
    let ends = lines.iter().flatten().map(|point| point.x);
    assert_eq!(ends.clone().fold(f64::INFINITY, f64::min), -1.0);
    assert_eq!(ends.fold(f64::NEG_INFINITY, f64::max), 1.0);
}
