//! Neighbour search on a lattice of 100,000 nodes, and building a large cylinder.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use jstsph_geometry::{
    Axis, Body, Dimension, Lattice, Shape, Spacing, build_body, neighbours, neighbours_of,
};
use jstsph_tensor::Vec3;

fn cube(nodes: usize) -> Body {
    let shape = Shape::Box {
        min: Vec3::zeros(),
        max: Vec3::repeat(1.0),
    };
    let spacing = Spacing::Counts([nodes; 3]);
    build_body(shape, Lattice::Cubic { spacing }, Dimension::Solid).expect("a cube has nodes")
}

fn plate(nodes: usize) -> Body {
    let shape = Shape::Box {
        min: Vec3::zeros(),
        max: Vec3::new(1.0, 1.0, 0.0),
    };
    let spacing = Spacing::Counts([nodes, nodes, 1]);
    build_body(shape, Lattice::Cubic { spacing }, Dimension::PlaneStrain)
        .expect("plates have nodes")
}

fn cylinder(per_radius: usize, layers: usize) -> Body {
    let shape = Shape::Cylinder {
        base: Vec3::zeros(),
        axis: Axis::Z,
        radius: 3.2e-3,
        height: 32e-3,
    };
    let spacing = Spacing::Radial { per_radius, layers };
    build_body(shape, Lattice::Cubic { spacing }, Dimension::Solid).expect("a cylinder has nodes")
}

fn searches(criterion: &mut Criterion) {
    let body = cube(46);
    let mut group = criterion.benchmark_group("97,336 nodes");
    group.sample_size(10);
    group.bench_function("particles, radius 2.4 spacings", |bencher| {
        bencher.iter(|| neighbours(black_box(&body.positions), 2.4 * body.spacing));
    });
    let midpoints = &body.bonds.midpoints(&body.positions);
    group.bench_function("bond midpoints, radius 1.6 spacings", |bencher| {
        bencher.iter(|| neighbours_of(black_box(midpoints), &body.positions, 1.6 * body.spacing));
    });
    let plate = plate(312);
    group.bench_function("plane strain, radius 2.4 spacings", |bencher| {
        bencher.iter(|| neighbours(black_box(&plate.positions), 2.4 * plate.spacing));
    });
    group.finish();
}

fn bodies(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("bodies");
    group.sample_size(10);
    group.bench_function("cylinder of 1,000,000 nodes", |bencher| {
        bencher.iter(|| cylinder(black_box(31), 331));
    });
    group.finish();
}

criterion_group!(benches, searches, bodies);
criterion_main!(benches);
