use jstsph_tensor::Vec3;
use proptest::prelude::*;

use super::*;
use crate::testing::{Outline, SAMPLING_ERROR, closed_outline, open_outline};

/// Rounding of a distance between points of order one.
const ROUNDING: f64 = 1e-13;

fn gap(chain: &Chain, x: f64, y: f64) -> Gap {
    // The third coordinate must not matter.
    chain.gap(&Vec3::new(x, y, 7.0))
}

fn check_distance(outline: &Outline, x: [f64; 2]) -> Result<(), TestCaseError> {
    let found = gap(&outline.chain(), x[0], x[1]);
    let expected = outline.brute_force(x);
    if expected.abs() > SAMPLING_ERROR {
        prop_assert!(
            (found.distance - expected).abs() < SAMPLING_ERROR,
            "{found:?} {expected}"
        );
    } else {
        prop_assert!(
            found.distance.abs() < 2.0 * SAMPLING_ERROR,
            "{found:?} {expected}"
        );
    }
    prop_assert!((found.normal.norm() - 1.0).abs() < 1e-14);
    // The foot is on the curve, and the distance grows along the normal.
    let (d, n) = (found.distance, found.normal);
    let foot = gap(&outline.chain(), x[0] - d * n.x, x[1] - d * n.y);
    prop_assert!(foot.distance.abs() < ROUNDING, "{foot:?}");
    Ok(())
}

fn check_lipschitz(outline: &Outline, x: [f64; 2], y: [f64; 2]) -> Result<(), TestCaseError> {
    let chain = outline.chain();
    let pieces = 200;
    let step = (y[0] - x[0]).hypot(y[1] - x[1]) / f64::from(pieces);
    let at = |piece: i32| {
        let part = f64::from(piece) / f64::from(pieces);
        gap(
            &chain,
            x[0] + part * (y[0] - x[0]),
            x[1] + part * (y[1] - x[1]),
        )
        .distance
    };
    for piece in 0..pieces {
        let change = (at(piece + 1) - at(piece)).abs();
        prop_assert!(change <= step + ROUNDING, "{change} over {step}");
    }
    Ok(())
}

proptest! {
    #[test]
    fn distance_to_a_closed_chain_is_that_of_dense_sampling(
        outline in closed_outline(), x in -1.5..1.5, y in -1.5..1.5
    ) {
        check_distance(&outline, [x, y])?;
    }

    #[test]
    fn distance_to_an_open_chain_is_that_of_dense_sampling(
        outline in open_outline(), x in -2.5..2.5, y in -2.0..2.0
    ) {
        check_distance(&outline, [x, y])?;
    }

    #[test]
    fn distance_never_changes_faster_than_the_point_moves(
        outline in prop_oneof![closed_outline(), open_outline()],
        x in -1.5..1.5, y in -1.5..1.5, u in -1.5..1.5, v in -1.5..1.5,
    ) {
        check_lipschitz(&outline, [x, y], [u, v])?;
    }

    #[test]
    fn exchanging_the_sides_changes_the_sign(
        outline in closed_outline(), x in -1.5..1.5, y in -1.5..1.5
    ) {
        let mut other = outline.clone();
        other.free_side = match outline.free_side {
            Side::Left => Side::Right,
            Side::Right => Side::Left,
        };
        let (one, other) = (gap(&outline.chain(), x, y), gap(&other.chain(), x, y));
        prop_assert!((one.distance + other.distance).abs() < ROUNDING);
    }

    #[test]
    fn in_a_reentrant_corner_both_lines_are_at_least_as_far_as_the_chain(
        outline in prop_oneof![closed_outline(), open_outline()], x in -1.5..1.5, y in -1.5..1.5
    ) {
        let chain = outline.chain();
        let point = Vec3::new(x, y, 0.0);
        let nearest = chain.gap(&point).distance;
        if let Some(faces) = chain.corner_faces(&point) && nearest > 0.0 {
            for face in faces {
                prop_assert!(face.distance >= nearest - ROUNDING, "{face:?} {nearest}");
            }
        }
    }
}

/// Free in the quadrant x > 0, y > 0: down the y axis, then along the x axis.
fn reentrant() -> Chain {
    Chain::new(
        &[[0.0, 1.0], [0.0, 0.0], [1.0, 0.0]],
        &[0.0; 3],
        false,
        Side::Left,
    )
    .unwrap()
}

#[test]
fn a_sharp_corner_into_the_wall_has_two_faces() {
    let chain = reentrant();
    let inside = gap(&chain, 0.2, 0.3);
    assert_eq!((inside.distance, inside.normal), (0.2, Vec3::x()));
    let behind = gap(&chain, -3.0, -4.0);
    assert_eq!(
        (behind.distance, behind.normal),
        (-5.0, Vec3::new(0.6, 0.8, 0.0))
    );
    let [near, far] = chain.corner_faces(&Vec3::new(0.2, 0.3, 0.0)).unwrap();
    assert_eq!((near.distance, near.normal), (0.2, Vec3::x()));
    assert_eq!((far.distance, far.normal), (0.3, Vec3::y()));
}

#[test]
fn a_sharp_corner_into_the_free_side_is_round_to_a_particle() {
    let chain = Chain::new(
        &[[0.0, 1.0], [0.0, 0.0], [1.0, 0.0]],
        &[0.0; 3],
        false,
        Side::Right,
    )
    .unwrap();
    let outside = gap(&chain, -3.0, -4.0);
    assert_eq!(
        (outside.distance, outside.normal),
        (5.0, Vec3::new(-0.6, -0.8, 0.0))
    );
    let inside = gap(&chain, 0.2, 0.3);
    assert_eq!((inside.distance, inside.normal), (-0.2, -Vec3::x()));
    assert_eq!(chain.corner_faces(&Vec3::new(-3.0, -4.0, 0.0)), None);
    // So close to the vertex that the direction is rounding, the normal halves the corner.
    let at = gap(&chain, -3e-16, -4e-16);
    assert!((at.distance - 5e-16).abs() < 1e-30);
    assert!((at.normal + Vec3::new(1.0, 1.0, 0.0).normalize()).norm() < 1e-15);
}

#[test]
fn an_open_chain_extends_beyond_its_ends() {
    let chain = Chain::new(&[[0.0, 0.0], [1.0, 0.0]], &[0.0; 2], false, Side::Left).unwrap();
    for x in [-1e6, 0.5, 1e6] {
        let above = gap(&chain, x, 0.25);
        assert_eq!((above.distance, above.normal), (0.25, Vec3::y()));
        assert_eq!(gap(&chain, x, -0.25).distance, -0.25);
    }
}

#[test]
fn fillets_that_meet_leave_no_gap_between_them() {
    // An S of two quarter circles of radius 1 around (-1, 0) and (1, 0), which meet at the origin.
    let chain = Chain::new(
        &[[-5.0, 1.0], [0.0, 1.0], [0.0, -1.0], [5.0, -1.0]],
        &[0.0, 1.0, 1.0, 0.0],
        false,
        Side::Left,
    )
    .unwrap();
    let at = gap(&chain, 0.0, 0.0);
    assert!(
        at.distance.abs() < 1e-15 && (at.normal - Vec3::x()).norm() < 1e-15,
        "{at:?}"
    );
    assert!((gap(&chain, -0.5, 0.0).distance + 0.5).abs() < 1e-15);
    // Beyond the centres, where neither arc faces the point.
    let far = gap(&chain, 1.5, 0.0);
    assert!((far.distance - 1.0).abs() < 1e-15, "{far:?}");
    // On the fillet around (1, 0), seen from its centre.
    let centre = gap(&chain, 1.0, 0.0);
    assert!((centre.distance - 1.0).abs() < 1e-15 && (centre.normal.norm() - 1.0).abs() < 1e-15);
}

#[test]
fn mistakes_in_a_chain_are_named() {
    let build = |points: &[[f64; 2]], fillets: &[f64], closed| {
        Chain::new(points, fillets, closed, Side::Right).unwrap_err()
    };
    let corner = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]];
    assert_eq!(
        build(&corner[..1], &[0.0], false),
        ContactError::TooFewPoints {
            count: 1,
            needed: 2
        }
    );
    assert_eq!(
        build(&corner[..2], &[0.0; 2], true),
        ContactError::TooFewPoints {
            count: 2,
            needed: 3
        }
    );
    assert_eq!(
        build(&corner, &[0.0; 2], false),
        ContactError::FilletCount {
            fillets: 2,
            points: 3
        }
    );
    assert_eq!(
        build(&corner, &[0.0, -1.0, 0.0], false),
        ContactError::NegativeFillet {
            index: 1,
            radius: -1.0
        }
    );
    assert_eq!(
        build(&corner, &[0.0, 0.0, 1.0], false),
        ContactError::EndFillet {
            index: 2,
            radius: 1.0
        }
    );
    assert!(matches!(
        build(&[[0.0, f64::NAN], [1.0, 0.0]], &[0.0; 2], false),
        ContactError::NotFinite { .. }
    ));
    assert!(matches!(
        build(&corner, &[0.0, f64::INFINITY, 0.0], false),
        ContactError::NotFinite { .. }
    ));
    // Indices count as given, although the right side is built backwards.
    assert_eq!(
        build(
            &[[0.0, 0.0], [2.0, 0.0], [2.0, 0.0], [3.0, 0.0]],
            &[0.0; 4],
            false
        ),
        ContactError::CoincidentPoints {
            index: 1,
            x: 2.0,
            y: 0.0
        }
    );
    assert_eq!(
        build(
            &[[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 5.0]],
            &[0.0; 4],
            false
        ),
        ContactError::DoublesBack {
            index: 1,
            x: 2.0,
            y: 0.0
        }
    );
    let ContactError::FilletTooLarge {
        index,
        needed,
        available,
    } = build(&corner, &[0.0, 1.5, 0.0], false)
    else {
        panic!("another error");
    };
    assert_eq!((index, available), (1, 1.0));
    assert!((needed - 1.5).abs() < 1e-15);
}

#[test]
fn a_chain_that_crosses_itself_is_refused() {
    let bow_tie = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
    assert_eq!(
        Chain::new(&bow_tie, &[0.0; 4], true, Side::Left),
        Err(ContactError::CrossesItself { x: 0.5, y: 0.5 })
    );
    // A cup whose sides lean inwards: their extensions meet above it.
    let cup = [[0.4, 1.0], [0.0, 0.0], [1.0, 0.0], [0.6, 1.0]];
    let error = Chain::new(&cup, &[0.0; 4], false, Side::Left).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("extended straight beyond both ends"),
        "{error}"
    );
    assert!(Chain::new(&cup, &[0.0; 4], true, Side::Left).is_ok());
}

#[test]
fn fillets_may_take_the_whole_of_an_edge() {
    let square = [[0.1, 0.1], [1.1, 0.1], [1.1, 1.1], [0.1, 1.1]];
    let circle = Chain::new(&square, &[0.5; 4], true, Side::Left).unwrap();
    for (x, y) in [(0.6, 0.3), (0.9, 0.8), (0.2, 0.6), (1.5, -0.3)] {
        let expected = 0.5 - f64::hypot(x - 0.6, y - 0.6);
        assert!((gap(&circle, x, y).distance - expected).abs() < 1e-15);
    }
}
