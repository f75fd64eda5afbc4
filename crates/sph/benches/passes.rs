//! Cost of the two passes of a step, gradient (per evaluation point) and divergence (per particle).

use std::hint::black_box;

use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use jstsph_geometry::{Axis, Body, Dimension, Lattice, Shape, Spacing, build_body};
use jstsph_sph::{GradientOperator, Kernel, LaneRow, LineOperator, Support};
use jstsph_tensor::{Mat3, Vec3};

/// The billet of equal channel angular extrusion, 8 × 50 nodes in plane strain.
fn billet() -> Body {
    let shape = Shape::Box {
        min: Vec3::zeros(),
        max: Vec3::new(8e-3, 56e-3, 0.0),
    };
    let spacing = Spacing::Counts([8, 50, 1]);
    build_body(shape, Lattice::Cubic { spacing }, Dimension::PlaneStrain)
        .expect("a billet has nodes")
}

/// The Taylor bar, 4131 nodes.
fn bar() -> Body {
    let shape = Shape::Cylinder {
        base: Vec3::zeros(),
        axis: Axis::Z,
        radius: 3.2e-3,
        height: 32e-3,
    };
    let spacing = Spacing::Radial {
        per_radius: 5,
        layers: 51,
    };
    build_body(shape, Lattice::Cubic { spacing }, Dimension::Solid).expect("a bar has nodes")
}

fn support(body: &Body, ratio: f64) -> Support {
    Support {
        kernel: Kernel::QuinticSpline,
        smoothing_length: ratio * body.spacing,
        dimension: body.dimension.count(),
    }
}

fn at_particles(body: &Body) -> GradientOperator {
    GradientOperator::at_particles(&body.positions, &body.weights, &support(body, 1.2))
        .expect("lattices have neighbours")
}

fn at_bonds(body: &Body) -> GradientOperator {
    let bonds = &body.bonds;
    GradientOperator::at_points(
        &bonds.midpoints(&body.positions),
        &body.positions,
        &support(body, 0.8),
    )
    .expect("lattices have neighbours")
}

fn passes(c: &mut Criterion) {
    let (billet, bar) = (billet(), bar());
    let cases = [
        ("billet_400_bonds", at_bonds(&billet)),
        ("bar_4131_particles", at_particles(&bar)),
        ("bar_4131_bonds", at_bonds(&bar)),
    ];
    let midpoints = [&billet, &bar].map(|body| body.bonds.midpoints(&body.positions));
    let lines = [
        lines(&billet, &cases[0].1, &midpoints[0]),
        lines(&bar, &cases[1].1, &bar.positions),
        lines(&bar, &cases[2].1, &midpoints[1]),
    ];
    let mut gradients = c.benchmark_group("gradient");
    for (name, operator) in &cases {
        gradient(&mut gradients, name, operator);
    }
    gradient_in_lines::<2, 4>(&mut gradients, cases[0].0, &lines[0]);
    gradient_in_lines::<3, 9>(&mut gradients, cases[1].0, &lines[1]);
    gradient_in_lines::<3, 9>(&mut gradients, cases[2].0, &lines[2]);
    gradients.finish();
    let mut divergences = c.benchmark_group("divergence");
    for (name, operator) in &cases {
        divergence(&mut divergences, name, operator);
    }
    divergence_in_lines::<2, 4>(&mut divergences, cases[0].0, &lines[0]);
    divergence_in_lines::<3, 9>(&mut divergences, cases[1].0, &lines[1]);
    divergence_in_lines::<3, 9>(&mut divergences, cases[2].0, &lines[2]);
    divergences.finish();
}

type Group<'a> = BenchmarkGroup<'a, criterion::measurement::WallTime>;

fn gradient(group: &mut Group<'_>, name: &str, operator: &GradientOperator) {
    let field: Vec<Vec3> = (0..operator.particles())
        .map(|a| Vec3::new((a as f64).sin(), (a as f64).cos(), 0.1))
        .collect();
    let mut gradients = vec![Mat3::zeros(); operator.points()];
    group.throughput(Throughput::Elements(operator.points() as u64));
    group.bench_function(name, |b| {
        b.iter(|| {
            for (q, gradient) in gradients.iter_mut().enumerate() {
                *gradient = operator.gradient_at(q, black_box(&field));
            }
            black_box(gradients.last().copied())
        });
    });
    let padded: Vec<_> = field.iter().map(|f| [f.x, f.y, f.z, 0.0]).collect();
    group.bench_function(format!("{name}_runs"), |b| {
        b.iter(|| {
            operator.scaled_gradients(0, black_box(&padded), 1.0, &mut gradients);
            black_box(gradients.last().copied())
        });
    });
}

fn divergence(group: &mut Group<'_>, name: &str, operator: &GradientOperator) {
    let stresses: Vec<Mat3> = (0..operator.points())
        .map(|q| Mat3::from_element((q as f64).sin()))
        .collect();
    let mut forces = vec![Vec3::zeros(); operator.particles()];
    group.throughput(Throughput::Elements(operator.points() as u64));
    group.bench_function(name, |b| {
        b.iter(|| {
            for (c, force) in forces.iter_mut().enumerate() {
                *force = operator.divergence_at(c, black_box(&stresses));
            }
            black_box(forces.last().copied())
        });
    });
    group.bench_function(format!("{name}_runs"), |b| {
        b.iter(|| {
            operator.divergences(0, black_box(&stresses), &mut forces);
            black_box(forces.last().copied())
        });
    });
}

fn lines(body: &Body, operator: &GradientOperator, points: &[Vec3]) -> LineOperator {
    LineOperator::new(operator, &body.positions, points, body.spacing).expect("a long body")
}

/// A field brought into its lines, and its gradients there; those of points that are alone are left out.
fn gradient_in_lines<const D: usize, const T: usize>(
    group: &mut Group<'_>,
    name: &str,
    lines: &LineOperator,
) {
    let (particles, points) = (lines.particles(), lines.points());
    let values: Vec<[f64; D]> = (0..particles.slots().len())
        .map(|a| std::array::from_fn(|k| ((a + k) as f64).sin()))
        .collect();
    let mut field = vec![LaneRow::<D>::ZERO; particles.rows()];
    let mut gradients = vec![LaneRow::<T>::ZERO; points.rows()];
    group.throughput(Throughput::Elements(points.slots().len() as u64));
    group.bench_function(format!("{name}_lines"), |b| {
        b.iter(|| {
            for (piece, rows) in field.chunks_mut(particles.rows_of_piece()).enumerate() {
                particles.arrange(piece, |a| black_box(&values)[a], rows);
            }
            for (piece, rows) in gradients.chunks_mut(points.rows_of_piece()).enumerate() {
                lines.gradients(piece, &field, 1.0, rows);
            }
            black_box(gradients.last().copied())
        });
    });
}

/// The same for divergences.
fn divergence_in_lines<const D: usize, const T: usize>(
    group: &mut Group<'_>,
    name: &str,
    lines: &LineOperator,
) {
    let (particles, points) = (lines.particles(), lines.points());
    let values: Vec<[f64; T]> = (0..points.slots().len())
        .map(|q| std::array::from_fn(|k| ((q + k) as f64).sin()))
        .collect();
    let mut tensors = vec![LaneRow::<T>::ZERO; points.rows()];
    let mut forces = vec![LaneRow::<D>::ZERO; particles.rows()];
    group.throughput(Throughput::Elements(points.slots().len() as u64));
    group.bench_function(format!("{name}_lines"), |b| {
        b.iter(|| {
            for (piece, rows) in tensors.chunks_mut(points.rows_of_piece()).enumerate() {
                points.arrange(piece, |q| black_box(&values)[q], rows);
            }
            for (piece, rows) in forces.chunks_mut(particles.rows_of_piece()).enumerate() {
                lines.divergences(piece, &tensors, rows);
            }
            black_box(forces.last().copied())
        });
    });
}

fn setup(c: &mut Criterion) {
    let bar = bar();
    let mut group = c.benchmark_group("build");
    group.sample_size(10);
    group.bench_function("bar_4131_particles", |b| {
        b.iter(|| at_particles(black_box(&bar)))
    });
    group.bench_function("bar_4131_bonds", |b| b.iter(|| at_bonds(black_box(&bar))));
    group.finish();
}

criterion_group!(benches, passes, setup);
criterion_main!(benches);
