use proptest::prelude::*;

use super::*;
use crate::testing::{Outline, closed_outline, ecae_die};
use crate::{Chain, Profile, Side};

const DENSITY: f64 = 2800.0;
const INELASTIC: Law = Law::Inelastic { restitution: 0.0 };
const STEP: ContactStep = ContactStep {
    dt: 1e-7,
    tolerance: 1e-9,
    density: DENSITY,
    max_penetration: 1e-7,
};

fn obstacle(surface: Surface, law: Law) -> Obstacle {
    Obstacle {
        name: "wall".into(),
        surface,
        law,
        friction: crate::Friction::default(),
    }
}

fn floor(law: Law) -> Obstacle {
    obstacle(Surface::plane(Vec3::zeros(), Vec3::y()).unwrap(), law)
}

fn at_rest(obstacle: &Obstacle, x: Vec3, v: Vec3, step: &ContactStep) -> Option<Resolution> {
    resolve(
        obstacle,
        0,
        &Vec3::zeros(),
        &Vec3::zeros(),
        &x,
        &(v * DENSITY),
        step,
    )
}

#[test]
fn a_touching_particle_stops_and_keeps_its_tangential_momentum() {
    let v = Vec3::new(1.3, -7.0, 0.1);
    for y in [0.0, 0.9e-9, -0.9e-7] {
        let resolution = at_rest(&floor(INELASTIC), Vec3::new(2.0, y, 3.0), v, &STEP).unwrap();
        let before = v * DENSITY;
        assert_eq!(resolution.momentum, Vec3::new(before.x, 0.0, before.z)); // to the bit
        assert_eq!((resolution.position, resolution.gap), (None, y));
    }
}

#[test]
fn a_particle_ahead_of_the_wall_may_travel_to_it_and_no_farther() {
    let wall = floor(INELASTIC);
    let x = Vec3::new(0.0, 1e-6, 0.0);
    let resolution = at_rest(&wall, x, Vec3::new(1.0, -25.0, 0.0), &STEP).unwrap();
    let travel = resolution.momentum.y / DENSITY * STEP.dt;
    assert!((travel + 1e-6).abs() < 1e-21, "{travel}");
    // Slower than that, it is left alone; so is it when the travel is not known.
    assert_eq!(at_rest(&wall, x, Vec3::new(1.0, -9.9, 0.0), &STEP), None);
    let now = ContactStep { dt: 0.0, ..STEP };
    assert_eq!(at_rest(&wall, x, Vec3::new(1.0, -25.0, 0.0), &now), None);
    let touching = at_rest(&wall, Vec3::zeros(), Vec3::new(1.0, -25.0, 0.0), &now).unwrap();
    assert_eq!(touching.momentum.y, 0.0);
}

#[test]
fn a_separating_particle_is_left_alone() {
    for y in [0.0, 1e-6, -1e-8] {
        assert_eq!(
            at_rest(&floor(INELASTIC), y * Vec3::y(), Vec3::y(), &STEP),
            None
        );
        assert_eq!(
            at_rest(&floor(INELASTIC), y * Vec3::y(), Vec3::zeros(), &STEP),
            None
        );
    }
    assert_eq!(
        at_rest(&floor(Law::Reflection), Vec3::zeros(), -Vec3::y(), &STEP),
        None
    );
}

#[test]
fn restitution_returns_part_of_the_approach_speed() {
    let wall = floor(Law::Inelastic { restitution: 0.25 });
    let touching = at_rest(&wall, Vec3::zeros(), Vec3::new(0.0, -8.0, 0.0), &STEP).unwrap();
    assert!((touching.momentum.y / DENSITY - 2.0).abs() < 1e-15);
    // Not before it touches.
    let ahead = at_rest(&wall, 1e-8 * Vec3::y(), Vec3::new(0.0, -8.0, 0.0), &STEP).unwrap();
    assert!((ahead.momentum.y / DENSITY + 0.1).abs() < 1e-15);
}

#[test]
fn a_moving_wall_takes_particles_along() {
    let wall = floor(INELASTIC);
    let (displacement, velocity) = (Vec3::new(9.0, 0.5, 0.0), Vec3::new(-3.0, 2.0, 0.0));
    let x = Vec3::new(0.0, 0.5, 0.0);
    let p = Vec3::new(100.0, 0.0, 0.0);
    let carried = resolve(&wall, 0, &displacement, &velocity, &x, &p, &STEP).unwrap();
    assert_eq!(carried.momentum, Vec3::new(100.0, 2.0 * DENSITY, 0.0));
    let away = resolve(&wall, 0, &displacement, &-velocity, &x, &p, &STEP);
    assert_eq!(away, None);
    let mirrored = floor(Law::Reflection);
    let x = Vec3::new(0.0, 0.4, 0.0);
    let bounced = resolve(&mirrored, 0, &displacement, &velocity, &x, &p, &STEP).unwrap();
    assert_eq!(bounced.momentum, Vec3::new(100.0, 4.0 * DENSITY, 0.0));
    assert_eq!(bounced.position, Some(Vec3::new(0.0, 0.5, 0.0)));
}

#[test]
fn only_a_deep_particle_is_put_back() {
    let deep = at_rest(
        &floor(INELASTIC),
        Vec3::new(1.0, -2e-7, 0.0),
        Vec3::x(),
        &STEP,
    )
    .unwrap();
    assert_eq!(deep.position, Some(Vec3::x()));
    assert_eq!(deep.momentum, Vec3::x() * DENSITY);
    assert_eq!(deep.gap, -2e-7);
}

#[test]
fn reflection_at_a_resting_wall_keeps_the_kinetic_energy() {
    let ball = Surface::Sphere {
        centre: Vec3::new(0.1, 0.2, 0.3),
        radius: 0.5,
        inside: true,
    };
    let wall = obstacle(ball, Law::Reflection);
    let x = Vec3::new(0.5, 0.5, 0.5);
    let v = Vec3::new(3.0, -1.0, 4.0);
    let bounced = at_rest(&wall, x, v, &STEP).unwrap();
    let normal = wall.surface.gap(&x).normal;
    let after = bounced.momentum / DENSITY;
    assert!((after.norm_squared() - 26.0).abs() < 1e-13);
    assert!((after.dot(&normal) + v.dot(&normal)).abs() < 1e-14);
    let tangential = |v: &Vec3| v - v.dot(&normal) * normal;
    assert!((tangential(&after) - tangential(&v)).norm() < 1e-14);
    assert!(wall.surface.gap(&bounced.position.unwrap()).distance.abs() < 1e-16);
}

fn sharp_corner(turn: f64) -> Obstacle {
    let end = [turn.cos(), turn.sin()];
    let points = [[-1.0, 0.0], [0.0, 0.0], end];
    let chain = Chain::new(&points, &[0.0; 3], false, Side::Left).unwrap();
    obstacle(
        Surface::Profile(Profile::new(vec![chain]).unwrap()),
        INELASTIC,
    )
}

proptest! {
    #[test]
    fn in_a_sharp_corner_momentum_points_into_neither_edge(
        turn in 0.1..3.0, u in -1.0..1.0, v in -1.0..1.0, restitution in 0.0..1.0
    ) {
        let mut corner = sharp_corner(turn);
        corner.law = Law::Inelastic { restitution };
        let normals = [Vec3::y(), Vec3::new(-turn.sin(), turn.cos(), 0.0)];
        let before = Vec3::new(u, v, 0.5) * DENSITY;
        let resolution = at_rest(&corner, Vec3::zeros(), before / DENSITY, &STEP);
        let after = resolution.map_or(before, |resolution| resolution.momentum);
        for normal in &normals {
            // A sharp corner divides rounding by the square of its sine.
            prop_assert!(after.dot(normal) / DENSITY > -1e-13, "{after}");
        }
        prop_assert_eq!(after.z, before.z);
        if restitution == 0.0 {
            prop_assert!(after.norm() <= before.norm() * (1.0 + 1e-13));
        }
        let enters = normals.iter().any(|normal| before.dot(normal) < 0.0);
        prop_assert_eq!(resolution.is_some(), enters);
    }

    #[test]
    fn momentum_never_points_into_the_die_after_contact(
        i in 0_usize..2, s in 0.0..1.0, y in -0.06..0.08, u in -10.0..10.0, v in -10.0..10.0,
    ) {
        let die = obstacle(ecae_die(), INELASTIC);
        // On the wall: the nearest point to any point of the channel's surroundings.
        let start = Vec3::new(0.04 * s, y, 0.0);
        let gap = die.surface.gap_of(i, &start);
        let x = start - gap.distance * gap.normal;
        let before = Vec3::new(u, v, 0.3) * DENSITY;
        let resolution = resolve(&die, i, &Vec3::zeros(), &Vec3::zeros(), &x, &before, &STEP);
        let after = resolution.map_or(before, |resolution| resolution.momentum);
        let normal = die.surface.gap_of(i, &x).normal;
        prop_assert!(after.dot(&normal) / DENSITY > -1e-14);
        let tangent = Vec3::new(-normal.y, normal.x, 0.0);
        prop_assert!((after - before).dot(&tangent).abs() / DENSITY < 1e-14);
    }

    #[test]
    fn a_particle_that_moves_with_its_momentum_does_not_pass_sharp_walls(
        outline in closed_outline(), u in -1.0..1.0, v in -1.0..1.0
    ) {
        let mut outline = outline;
        outline.fillets.fill(0.0);
        let wall = |side| {
            let outline = Outline { free_side: side, ..outline.clone() };
            let profile = Profile::new(vec![outline.chain()]).unwrap();
            obstacle(Surface::Profile(profile), INELASTIC)
        };
        // Free inside; the origin is in all of these chains.
        let wall = [wall(Side::Left), wall(Side::Right)]
            .into_iter()
            .find(|wall| wall.surface.gap(&Vec3::zeros()).distance > 0.0)
            .unwrap();
        let step = ContactStep { dt: 1e-3, ..STEP };
        let mut x = Vec3::zeros();
        // Driven on and on in the same direction.
        for _ in 0..2000 {
            let v = Vec3::new(u, v, 0.0);
            let resolution = at_rest(&wall, x, v, &step);
            prop_assert!(resolution.is_none_or(|resolution| resolution.position.is_none()));
            let p = resolution.map_or(v * DENSITY, |resolution| resolution.momentum);
            x += p * (step.dt / DENSITY);
            let gap = wall.surface.gap(&x).distance;
            // Rounding may add up over the steps, unseen below the tolerance.
            prop_assert!(gap > -step.tolerance, "{x} {gap}");
        }
    }

    #[test]
    fn the_cache_never_changes_a_result(
        jumps in prop::collection::vec((-1.0..1.0, -1.0..1.0, -9.0..-4.0), 1..60),
        law in prop_oneof![Just(INELASTIC), Just(Law::Reflection)],
    ) {
        let die = obstacle(ecae_die(), law);
        let mut caches = [CachedGap::UNKNOWN; 2];
        let (mut x, mut shift) = (Vec3::new(0.004, 0.02, 0.0), 0.0);
        for (u, v, exponent) in jumps {
            let size = 10.0_f64.powf(exponent) * 10.0;
            x += size * Vec3::new(u, v, 0.0);
            shift += 0.1 * size;
            for (part, cache) in caches.iter_mut().enumerate() {
                let displacement = Vec3::new(0.0, shift, 0.0);
                let wall = Wall { obstacle: &die, part, displacement, velocity: Vec3::y() };
                let p = Vec3::new(v, u, 0.0) * (1e3 * DENSITY);
                let cached = wall.resolve_cached(cache, &x, &p, &STEP);
                prop_assert_eq!(cached, wall.resolve(&x, &p, &STEP));
                if let Some(position) = cached.and_then(|resolution| resolution.position) {
                    x = position;
                }
            }
        }
    }
}

#[test]
fn the_cache_spares_the_evaluations_of_a_distant_particle() {
    let die = obstacle(ecae_die(), INELASTIC);
    let wall = Wall {
        obstacle: &die,
        part: 0,
        displacement: Vec3::zeros(),
        velocity: Vec3::zeros(),
    };
    let mut cache = CachedGap::UNKNOWN;
    let (mut x, mut evaluations) = (Vec3::new(0.004, 0.06, 0.0), 0);
    for _ in 0..10_000 {
        let before = cache;
        assert_eq!(
            wall.resolve_cached(&mut cache, &x, &(-DENSITY * Vec3::y()), &STEP),
            None
        );
        evaluations += usize::from(before != cache);
        x.y -= STEP.dt;
    }
    // One millimetre at 4 mm from the wall.
    assert_eq!(evaluations, 1);
}

#[test]
fn broken_numbers_pass_through_without_panic() {
    let nan = Vec3::new(f64::NAN, 0.0, 0.0);
    for surface in [
        ecae_die(),
        Surface::plane(Vec3::zeros(), Vec3::y()).unwrap(),
    ] {
        let wall = obstacle(surface, INELASTIC);
        assert_eq!(at_rest(&wall, nan, -Vec3::y(), &STEP), None);
        let _ = at_rest(&wall, Vec3::zeros(), nan, &STEP);
    }
}
