//! Cost of one constitutive update, elastic and plastic, in 3D and in plane strain, of the shipped materials; and
//! of every hardening law.

use criterion::measurement::WallTime;
use criterion::{
    BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main,
};
use jstsph_material::models::HenckyVonMises;
use jstsph_material::{
    Kinematics, KinematicsTile, Material, MaterialSpec, PlasticHistory, ResponseTile, library,
};
use jstsph_tensor::Mat3;
use jstsph_tensor::lanes::TILE;
use std::hint::black_box;

/// Whole tiles.
const POINTS: usize = 30 * TILE;

/// Points that have flowed to ε_p of about 0.3 and are then strained further by `size`.
fn points(model: &HenckyVonMises, plane: bool, size: f64) -> Vec<(Kinematics, PlasticHistory)> {
    (0..POINTS)
        .map(|i| {
            let phase = i as f64;
            let warmer = if model.thermal().is_some() {
                phase % 200.0
            } else {
                0.0
            };
            let temperature = jstsph_material::ROOM_TEMPERATURE + warmer;
            let out_of_plane = if plane { 0.0 } else { 0.2 };
            let f = |extra: f64| {
                Mat3::new(
                    1.1,
                    0.3 * phase.sin() + extra,
                    out_of_plane * (1.3 * phase).sin(),
                    0.1 * phase.cos(),
                    0.9,
                    out_of_plane * phase.cos(),
                    out_of_plane * (0.7 * phase).sin(),
                    -out_of_plane * (1.9 * phase).cos(),
                    1.0,
                )
            };
            let kinematics = |f: Mat3| Kinematics {
                deformation_gradient: f,
                jacobian: f.determinant(),
                dt: 1e-7,
                temperature,
            };
            let flowed = model
                .respond(&kinematics(f(0.0)), &model.initial_history())
                .expect("the points are sound");
            (kinematics(f(size)), flowed.history)
        })
        .collect()
}

/// Points that are answered together.
fn tile(
    points: &[(Kinematics, PlasticHistory)],
    plane: bool,
) -> (KinematicsTile, [PlasticHistory; TILE]) {
    let mut tile = KinematicsTile {
        plane,
        ..KinematicsTile::new(points[0].0.dt)
    };
    let gradients: Vec<Mat3> = points.iter().map(|p| p.0.deformation_gradient).collect();
    tile.deformation_gradient.read(&gradients);
    for (i, (now, _)) in points.iter().enumerate() {
        (tile.jacobian[i], tile.temperature[i]) = (now.jacobian, now.temperature);
    }
    (tile, std::array::from_fn(|i| points[i].1))
}

/// Points that flow, or points that do not, in a step of a run: strained on a little they flow, strained back
/// they unload.
fn points_in_step(
    model: &HenckyVonMises,
    plane: bool,
    plastic: bool,
) -> Vec<(Kinematics, PlasticHistory)> {
    let size = if plastic { 1e-4 } else { 1e-3 };
    points(model, plane, size)
        .into_iter()
        .zip(points(model, plane, -size))
        .filter_map(|(one, other)| {
            [one, other].into_iter().find(|(now, old)| {
                let response = model.respond(now, old).expect("sound");
                (response.plastic_increment > 0.0) == plastic
            })
        })
        .cycle()
        .take(POINTS)
        .collect()
}

/// Point by point and tile by tile.
fn measure(
    group: &mut BenchmarkGroup<'_, WallTime>,
    [name, kind]: [&str; 2],
    model: &HenckyVonMises,
    plane: bool,
) {
    group.throughput(Throughput::Elements(POINTS as u64));
    let points = points_in_step(model, plane, kind == "plastic");
    if points.is_empty() {
        // At the rate of this step the points flow on whether they are strained or not.
        return;
    }
    group.bench_function(BenchmarkId::new(name, kind), |bencher| {
        bencher.iter(|| {
            for (now, old) in &points {
                let _ = black_box(model.respond(black_box(now), black_box(old)));
            }
        });
    });
    group.bench_function(BenchmarkId::new(format!("{name}_tiles"), kind), |bencher| {
        let tiles: Vec<_> = points
            .chunks_exact(TILE)
            .map(|points| tile(points, plane))
            .collect();
        let mut response = ResponseTile::ZERO;
        bencher.iter(|| {
            for (now, old) in &tiles {
                let mut new = *old;
                black_box(model.respond_tile(
                    black_box(now),
                    black_box(old),
                    &mut new,
                    &mut response,
                ));
                black_box(&new);
            }
        });
    });
}

fn materials(criterion: &mut Criterion) {
    for entry in library() {
        let MaterialSpec::HenckyVonMises(model) = &entry.spec else {
            continue;
        };
        let mut group = criterion.benchmark_group(entry.name);
        for (dimension, plane) in [("plane", true), ("3d", false)] {
            for kind in ["elastic", "plastic"] {
                measure(&mut group, [dimension, kind], model, plane);
            }
        }
        group.finish();
    }
}

fn laws(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("laws");
    // Without damage, heat and moduli in temperature; laws with several examples are numbered.
    let examples = HenckyVonMises::examples();
    let models = examples.iter().filter(|model| model.thermal.is_none());
    for (i, model) in models.enumerate() {
        let name = format!("{i}_{}", model.hardening.name());
        measure(&mut group, [name.as_str(), "plastic"], model, false);
    }
    group.finish();
}

criterion_group!(benches, materials, laws);
criterion_main!(benches);
