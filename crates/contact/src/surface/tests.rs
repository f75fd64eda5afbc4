use proptest::prelude::*;

use super::*;
use crate::testing::ecae_die;

const CENTRE: Vec3 = Vec3::new(0.1, -0.2, 0.3);

/// One of each solid, each containing the ball of radius 0.2 around `CENTRE`.
fn solids(inside: bool) -> Vec<Surface> {
    let axis = Vec3::new(1.0, 2.0, -2.0);
    let (min, max) = (Vec3::new(-0.2, -0.5, -0.1), Vec3::new(0.4, 0.1, 1.0));
    vec![
        Surface::Sphere {
            centre: CENTRE,
            radius: 0.5,
            inside,
        },
        Surface::cylinder(CENTRE, axis, 0.4, None, inside).unwrap(),
        Surface::cylinder(CENTRE, axis, 0.4, Some(0.6), inside).unwrap(),
        Surface::Box { min, max, inside },
    ]
}

fn point() -> impl Strategy<Value = Vec3> {
    [-1.5..1.5, -1.5..1.5, -1.5..1.5].prop_map(Vec3::from)
}

proptest! {
    #[test]
    fn normal_is_the_gradient_and_leads_to_the_surface(x in point(), inside in any::<bool>()) {
        let plane = Surface::plane(CENTRE, Vec3::new(3.0, -1.0, 2.0)).unwrap();
        for surface in solids(inside).iter().chain([&plane]) {
            for part in 0..surface.parts() {
                let gap = surface.gap_of(part, &x);
                prop_assert!((gap.normal.norm() - 1.0).abs() < 1e-14);
                let foot = surface.gap_of(part, &(x - gap.distance * gap.normal));
                prop_assert!(foot.distance.abs() < 1e-14, "{surface:?} {part} {foot:?}");
            }
        }
    }

    #[test]
    fn distance_never_changes_faster_than_the_point_moves(
        x in point(), y in point(), inside in any::<bool>()
    ) {
        for surface in solids(inside) {
            for part in 0..surface.parts() {
                let change = surface.gap_of(part, &x).distance - surface.gap_of(part, &y).distance;
                prop_assert!(change.abs() <= (x - y).norm() + 1e-14, "{surface:?} {part}");
            }
        }
    }

    #[test]
    fn inside_and_outside_have_opposite_signs(x in point()) {
        for (inside, outside) in solids(true).iter().zip(&solids(false)) {
            let (inside, outside) = (inside.gap(&x).distance, outside.gap(&x).distance);
            prop_assert!(inside * outside <= 0.0);
            // Within the solid both are distances to its boundary.
            prop_assert!(inside < 0.0 || (inside + outside).abs() < 1e-14);
        }
    }
}

#[test]
fn distances_to_solids_are_those_of_hand_calculation() {
    let cylinder = |inside| {
        Surface::cylinder(
            Vec3::zeros(),
            Vec3::new(0.0, 0.0, 5.0),
            1.0,
            Some(2.0),
            inside,
        )
        .unwrap()
    };
    let outside = cylinder(false);
    let rim = outside.gap(&Vec3::new(4.0, 0.0, -6.0));
    assert_eq!((rim.distance, rim.normal), (5.0, Vec3::new(0.6, 0.0, -0.8)));
    let wall = outside.gap(&Vec3::new(0.0, 3.0, 1.0));
    assert_eq!((wall.distance, wall.normal), (2.0, Vec3::y()));
    let cap = outside.gap(&Vec3::new(0.5, 0.0, 3.0));
    assert_eq!((cap.distance, cap.normal), (1.0, Vec3::z()));
    assert_eq!(outside.gap(&Vec3::new(0.5, 0.0, 0.0)).distance, -0.5);

    let inside = cylinder(true);
    let gaps = [0, 1, 2].map(|part| inside.gap_of(part, &Vec3::new(0.0, 0.25, 1.5)));
    assert_eq!(gaps.map(|gap| gap.distance), [0.75, 0.5, 3.5]);
    assert_eq!(
        gaps.map(|gap| gap.normal),
        [-Vec3::y(), -Vec3::z(), Vec3::z()]
    );

    let (min, max) = (Vec3::new(-1.0, -1.0, -1.0), Vec3::new(1.0, 1.0, 1.0));
    let solid = Surface::Box {
        min,
        max,
        inside: false,
    };
    let edge = solid.gap(&Vec3::new(4.0, -5.0, 0.5));
    assert_eq!(
        (edge.distance, edge.normal),
        (5.0, Vec3::new(0.6, -0.8, 0.0))
    );
    let buried = solid.gap(&Vec3::new(0.0, -0.75, 0.5));
    assert_eq!((buried.distance, buried.normal), (-0.25, -Vec3::y()));
    let room = Surface::Box {
        min,
        max,
        inside: true,
    };
    let x = Vec3::new(0.5, -0.25, 0.0);
    let gaps = [0, 1, 2, 3, 4, 5].map(|face| room.gap_of(face, &x).distance);
    assert_eq!(gaps, [1.5, 0.5, 0.75, 1.25, 1.0, 1.0]);
}

#[test]
fn where_all_directions_are_equal_the_normal_is_still_one() {
    for surface in solids(true).iter().chain(&solids(false)) {
        let gap = surface.gap_of(0, &CENTRE);
        assert!(
            (gap.normal.norm() - 1.0).abs() < 1e-14,
            "{surface:?} {gap:?}"
        );
    }
}

#[test]
fn the_die_is_a_channel_of_eight_millimetres() {
    let die = ecae_die();
    assert_eq!(die.parts(), 2);
    // Across the three channels the two gaps add up to the width.
    for (x, y) in [
        (0.003, 0.05),
        (0.016, 0.002),
        (0.0335, -0.03),
        (0.001, 0.5),
        (0.039, -0.5),
    ] {
        let [lower, upper] = [0, 1].map(|part| die.gap_of(part, &Vec3::new(x, y, 0.0)).distance);
        assert!(lower > 0.0 && upper > 0.0, "({x}, {y}): {lower} {upper}");
        assert!(
            (lower + upper - 0.008).abs() < 1e-16,
            "({x}, {y}): {lower} {upper}"
        );
    }
    // Beyond either wall.
    assert_eq!(die.gap(&Vec3::new(-0.001, 0.04, 0.0)).distance, -0.001);
    assert!((die.gap(&Vec3::new(0.010, 0.04, 0.0)).distance + 0.002).abs() < 1e-17);
    assert!((die.gap(&Vec3::new(0.020, -0.001, 0.0)).distance + 0.001).abs() < 1e-17);
}

#[test]
fn the_fillets_of_the_die_are_where_they_belong() {
    let die = ecae_die();
    let diagonal = std::f64::consts::FRAC_1_SQRT_2;
    // Part, corner, direction from the corner to the centre of the fillet, radius, +1 if convex.
    let fillets = [
        (0, [0.0, 0.0], [1.0, 1.0], 1.5e-3, -1.0),
        (0, [0.032, 0.0], [-1.0, -1.0], 1.0e-3, 1.0),
        (1, [0.008, 0.008], [1.0, 1.0], 1.0e-3, 1.0),
        (1, [0.040, 0.008], [-1.0, -1.0], 1.5e-3, -1.0),
    ];
    for (part, [cx, cy], [dx, dy], radius, sign) in fillets {
        let corner = Vec3::new(cx, cy, 0.0);
        let centre = corner + radius * Vec3::new(dx, dy, 0.0);
        let outward = diagonal * Vec3::new(-dx, -dy, 0.0);
        let on_arc = die.gap_of(part, &(centre + radius * outward));
        assert!(on_arc.distance.abs() < 1e-17, "{on_arc:?}");
        assert!(
            (on_arc.normal - sign * outward).norm() < 1e-12,
            "{on_arc:?}"
        );
        // The sharp corner is cut off: it is in the wall where the arc is concave.
        let at_corner = die.gap_of(part, &corner).distance;
        let expected = sign * radius * (2.0_f64.sqrt() - 1.0);
        assert!(
            (at_corner - expected).abs() < 1e-17,
            "{at_corner} {expected}"
        );
        // Where the arc begins and ends, on the edges, the normal is that of the edge.
        for tangent in [Vec3::new(dx, 0.0, 0.0), Vec3::new(0.0, dy, 0.0)] {
            let joint = die.gap_of(part, &(corner + radius * tangent));
            assert!(joint.distance.abs() < 1e-17);
            assert!(joint.normal.dot(&tangent).abs() < 1e-12, "{joint:?}");
        }
    }
}

#[test]
fn no_point_of_the_channel_is_outside_the_die() {
    let die = ecae_die();
    // The channel shrunk by half a millimetre, in steps of a quarter.
    let inside =
        |x: f64, y: f64| (x < 7.5 && y > 0.5) || (x > 32.5 && y < 7.5) || (y > 0.5 && y < 7.5);
    for i in 2..=158 {
        for j in -100..=200 {
            let (x, y) = (0.25 * f64::from(i), 0.25 * f64::from(j));
            if inside(x, y) && x <= 39.5 {
                // Half a millimetre from a rounded corner of 1.5 mm is 0.086 mm from the arc.
                let gap = die.gap(&Vec3::new(x * 1e-3, y * 1e-3, 0.0)).distance;
                assert!(gap > 0.08e-3, "({x}, {y}) mm: {gap}");
            }
        }
    }
}

#[test]
fn mistakes_in_a_solid_are_named() {
    let plane = |normal| {
        Surface::Plane {
            point: Vec3::zeros(),
            normal,
        }
        .validate()
    };
    assert_eq!(
        plane(Vec3::new(0.0, 2.0, 0.0)),
        Err(ContactError::NotUnit {
            what: "the normal of a plane",
            length: 2.0
        })
    );
    assert!(matches!(
        Surface::plane(Vec3::zeros(), Vec3::zeros()),
        Err(ContactError::NotUnit { .. })
    ));
    assert!(Surface::plane(Vec3::zeros(), Vec3::new(1e-300, 0.0, 1e-300)).is_ok());
    let sphere = |radius| {
        Surface::Sphere {
            centre: Vec3::zeros(),
            radius,
            inside: true,
        }
        .validate()
    };
    assert_eq!(
        sphere(0.0),
        Err(ContactError::NotPositive {
            what: "the radius of a sphere",
            value: 0.0
        })
    );
    assert!(matches!(
        sphere(f64::NAN),
        Err(ContactError::NotFinite { .. })
    ));
    let cylinder = Surface::cylinder(Vec3::zeros(), Vec3::x(), 1.0, Some(-1.0), true);
    assert!(matches!(cylinder, Err(ContactError::NotPositive { .. })));
    let flat = Surface::Box {
        min: Vec3::zeros(),
        max: Vec3::new(1.0, 0.0, 1.0),
        inside: false,
    };
    assert_eq!(
        flat.validate(),
        Err(ContactError::EmptyBox {
            axis: 'y',
            min: 0.0,
            max: 0.0
        })
    );
    assert!(solids(true).iter().all(|solid| solid.validate().is_ok()));
}
