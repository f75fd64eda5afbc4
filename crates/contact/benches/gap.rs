//! Cost of a signed distance and of a whole contact evaluation, per particle.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use jstsph_contact::{
    CachedGap, Chain, ContactError, ContactStep, Friction, Law, Obstacle, Profile, Side, Surface,
    Wall,
};
use jstsph_tensor::Vec3;

/// The die of equal channel angular extrusion: two chains of three segments and two arcs.
fn die() -> Result<Obstacle, ContactError> {
    let lower = Chain::new(
        &[[0.0, 0.08], [0.0, 0.0], [0.032, 0.0], [0.032, -0.06]],
        &[0.0, 1.5e-3, 1.0e-3, 0.0],
        false,
        Side::Left,
    )?;
    let upper = Chain::new(
        &[
            [0.008, 0.08],
            [0.008, 0.008],
            [0.040, 0.008],
            [0.040, -0.06],
        ],
        &[0.0, 1.0e-3, 1.5e-3, 0.0],
        false,
        Side::Right,
    )?;
    Ok(Obstacle {
        name: "die".into(),
        surface: Surface::Profile(Profile::new(vec![lower, upper])?),
        law: Law::default(),
        friction: Friction::default(),
    })
}

/// A closed chain of many segments with rounded corners: a cog wheel.
fn cog_wheel(teeth: u32) -> Result<Surface, ContactError> {
    let points: Vec<[f64; 2]> = (0..2 * teeth)
        .map(|i| {
            let angle = std::f64::consts::PI * f64::from(i) / f64::from(teeth);
            let radius = if i % 2 == 0 { 0.05 } else { 0.04 };
            [radius * angle.cos(), radius * angle.sin()]
        })
        .collect();
    let fillets = vec![1e-5; points.len()];
    Ok(Surface::Profile(Profile::new(vec![Chain::new(
        &points,
        &fillets,
        true,
        Side::Left,
    )?])?))
}

/// Points of the three channels in the order of a lattice.
fn particles() -> Vec<Vec3> {
    let mut points = Vec::new();
    for i in 0..40 {
        for j in 0..140 {
            let (x, y) = (f64::from(i) * 1e-3 + 5e-4, f64::from(j) * 1e-3 - 0.0595);
            if (x < 0.008 && y > 0.0) || (x > 0.032 && y < 0.008) || (y > 0.0 && y < 0.008) {
                points.push(Vec3::new(x, y, 0.0));
            }
        }
    }
    points
}

fn gaps(criterion: &mut Criterion) {
    let points = particles();
    let die = die().expect("the die is well defined");
    let wheel = cog_wheel(100).expect("the wheel is well defined");
    let mut group = criterion.benchmark_group("gap");
    group.throughput(Throughput::Elements(points.len() as u64));
    for (name, surface) in [("ecae_die", &die.surface), ("cog_wheel", &wheel)] {
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let mut sum = 0.0;
                for x in black_box(&points) {
                    for part in 0..surface.parts() {
                        sum += surface.gap_of(part, x).distance;
                    }
                }
                sum
            });
        });
    }
    group.finish();

    let step = ContactStep {
        dt: 1e-8,
        tolerance: 1e-9,
        density: 2800.0,
        max_penetration: 1e-7,
    };
    let momentum = Vec3::new(100.0, -2800.0, 0.0);
    let walls = [0, 1].map(|part| Wall {
        obstacle: &die,
        part,
        displacement: Vec3::zeros(),
        velocity: Vec3::zeros(),
    });
    let mut group = criterion.benchmark_group("resolve_ecae_die");
    group.throughput(Throughput::Elements(points.len() as u64));
    group.bench_function("plain", |bencher| {
        bencher.iter(|| {
            let touched = |x: &&Vec3| {
                walls
                    .iter()
                    .any(|wall| wall.resolve(x, &momentum, &step).is_some())
            };
            black_box(&points).iter().filter(touched).count()
        });
    });
    let mut caches = vec![[CachedGap::UNKNOWN; 2]; points.len()];
    group.bench_function("cached", |bencher| {
        bencher.iter(|| {
            let mut touched = 0;
            for (x, caches) in black_box(&points).iter().zip(&mut caches) {
                for (wall, cache) in walls.iter().zip(caches) {
                    touched +=
                        usize::from(wall.resolve_cached(cache, x, &momentum, &step).is_some());
                }
            }
            touched
        });
    });
    group.finish();
}

criterion_group!(benches, gaps);
criterion_main!(benches);
