use proptest::prelude::*;

use super::*;
use crate::{ContactStep, Law, Obstacle, Surface, resolve};

const DENSITY: f64 = 2000.0;
const STEP: ContactStep = ContactStep {
    dt: 1e-7,
    tolerance: 1e-9,
    density: DENSITY,
    max_penetration: 1e-7,
};

fn floor(coefficient: f64, law: Law) -> Obstacle {
    Obstacle {
        name: "floor".into(),
        surface: Surface::plane(Vec3::zeros(), Vec3::y()).unwrap(),
        law,
        friction: Friction::coulomb(coefficient),
    }
}

/// Velocity after contact with the floor at y = 0, which moves.
fn after(obstacle: &Obstacle, y: f64, v: Vec3, velocity: Vec3) -> Vec3 {
    let x = Vec3::new(0.3, y, -0.2);
    let p = v * DENSITY;
    let resolution = resolve(obstacle, 0, &Vec3::zeros(), &velocity, &x, &p, &STEP);
    resolution.map_or(v, |resolution| resolution.momentum / DENSITY)
}

#[test]
fn a_slow_particle_sticks_and_a_fast_one_slides() {
    let floor = floor(0.25, Law::default());
    let rest = Vec3::zeros();
    // 8 m/s into the floor can hold 2 m/s along it.
    assert_eq!(after(&floor, 0.0, Vec3::new(1.2, -8.0, 1.6), rest), rest);
    let slid = after(&floor, 0.0, Vec3::new(3.0, -8.0, 4.0), rest);
    assert!((slid - Vec3::new(1.8, 0.0, 2.4)).norm() < 1e-15, "{slid}");
    // Not pressed, not held.
    let parting = Vec3::new(3.0, 0.5, 0.0);
    assert_eq!(after(&floor, 0.0, parting, rest), parting);
}

#[test]
fn friction_acts_on_the_velocity_relative_to_the_wall() {
    let floor = floor(0.5, Law::default());
    let belt = Vec3::new(10.0, 3.0, 0.0);
    let carried = after(&floor, 0.0, Vec3::new(8.0, -1.0, 0.0), belt);
    assert_eq!(carried, belt);
    // 4 m/s of normal impulse accelerate by 2 m/s towards the belt.
    let dragged = after(&floor, 0.0, Vec3::new(1.0, -1.0, 0.0), belt);
    assert!((dragged - Vec3::new(3.0, 3.0, 0.0)).norm() < 1e-15);
}

#[test]
fn friction_comes_from_the_normal_impulse_that_was_given() {
    // Ahead of the wall by 0.1 µm the particle keeps 1 m/s of its 5 m/s towards it.
    let slid = after(
        &floor(0.25, Law::default()),
        1e-7,
        Vec3::new(7.0, -5.0, 0.0),
        Vec3::zeros(),
    );
    assert!((slid - Vec3::new(6.0, -1.0, 0.0)).norm() < 1e-14, "{slid}");
    // Reflection gives twice the approach.
    let bounced = after(
        &floor(0.25, Law::Reflection),
        -1e-9,
        Vec3::new(7.0, -2.0, 0.0),
        Vec3::zeros(),
    );
    assert!((bounced - Vec3::new(6.0, 2.0, 0.0)).norm() < 1e-14);
}

#[test]
fn what_a_step_has_left_of_its_friction_stops_the_average_of_two_stages() {
    let obstacle = floor(0.5, Law::default());
    let wall = Wall {
        obstacle: &obstacle,
        part: 0,
        displacement: Vec3::zeros(),
        velocity: Vec3::zeros(),
    };
    let given = |friction| Exchange {
        normal: Vec3::y() * 8.0,
        friction: Vec3::x() * friction,
    };
    let p = Vec3::new(1.5, 0.0, 0.0);
    // 2.5 of 4 are used: 1.5 remain, enough.
    assert_eq!(
        wall.friction(&p, &given(-2.5), DENSITY),
        Some(Vec3::zeros())
    );
    let slower = wall.friction(&p, &given(-3.5), DENSITY).unwrap();
    assert!((slower - Vec3::new(1.0, 0.0, 0.0)).norm() < 1e-15);
    // All is used: the particle slides on.
    let same = wall.friction(&p, &given(-4.0), DENSITY).unwrap_or(p);
    assert!((same - p).norm() < 1e-15);
}

#[test]
fn coefficients_that_are_no_coefficients_are_refused() {
    for value in [-0.1, f64::NAN, f64::INFINITY] {
        let error = floor(value, Law::default()).validate().unwrap_err();
        assert!(error.to_string().contains("friction"), "{error}");
    }
    assert_eq!(floor(1.5, Law::default()).validate(), Ok(()));
}

proptest! {
    #[test]
    fn friction_stays_in_its_cone_and_never_adds_energy(
        v in prop::array::uniform3(-5.0..5.0), wall in prop::array::uniform3(-2.0..2.0),
        coefficient in 0.0..1.2,
    ) {
        let (v, belt) = (Vec3::from(v), Vec3::from(wall));
        let smooth = after(&floor(0.0, Law::default()), 0.0, v, belt);
        let rough = after(&floor(coefficient, Law::default()), 0.0, v, belt);
        let (normal, friction) = (smooth - v, rough - smooth);
        prop_assert!(friction.y.abs() < 1e-14);
        prop_assert!(friction.norm() <= coefficient * normal.norm() * (1.0 + 1e-14) + 1e-14);
        // Sticking, or the whole of the cone.
        let slip = rough - belt - Vec3::y() * (rough - belt).y;
        if normal.norm() > 0.0 && slip.norm() > 1e-12 {
            prop_assert!((friction.norm() - coefficient * normal.norm()).abs() < 1e-13);
            prop_assert!(friction.dot(&slip) <= 0.0);
        }
        prop_assert!(friction.dot(&(0.5 * (smooth + rough) - belt)) <= 1e-14);
    }

    #[test]
    fn a_used_part_of_the_friction_never_adds_energy(
        p in prop::array::uniform2(-5.0..5.0), used in prop::array::uniform2(-1.0..1.0),
        normal in 0.1..9.0, coefficient in 0.01..1.0,
    ) {
        let obstacle = floor(coefficient, Law::default());
        let wall = Wall {
            obstacle: &obstacle, part: 0, displacement: Vec3::zeros(), velocity: Vec3::zeros(),
        };
        let limit = coefficient * normal;
        let used = Vec3::new(used[0], 0.0, used[1]);
        let used = used * (limit / used.norm().max(1.0));
        let p = Vec3::new(p[0], 0.0, p[1]);
        let given = Exchange { normal: Vec3::y() * normal, friction: used };
        let after = wall.friction(&p, &given, DENSITY).unwrap_or(p);
        // Round-off of momenta up to 7.
        prop_assert!((used + after - p).norm() <= limit + 1e-14);
        prop_assert!(after.norm() <= p.norm() + 1e-14);
    }
}
