//! Observed order of the corrected gradient on a quadratic and a trigonometric field, inside and at
//! the boundary apart, on lattices and on jittered particles. docs/theory.md, "Corrected gradient".

use jstsph_geometry::{Body, Dimension};
use jstsph_solver::Scheme;
use jstsph_tensor::{Mat3, Vec3};
use jstsph_tests::{Study, setup};

/// A field with its gradient.
struct Field {
    name: &'static str,
    value: fn(&Vec3) -> Vec3,
    gradient: fn(&Vec3) -> Mat3,
}

const QUADRATIC: Field = Field {
    name: "quadratic",
    value: |x| Vec3::new(x.x * x.y + x.y * x.y, x.x * x.x - x.x * x.y, x.x * x.y),
    gradient: |x| {
        Mat3::new(
            x.y,
            x.x + 2.0 * x.y,
            0.0,
            2.0 * x.x - x.y,
            -x.x,
            0.0,
            x.y,
            x.x,
            0.0,
        )
    },
};

const TRIGONOMETRIC: Field = Field {
    name: "trigonometric",
    value: |x| {
        let phase = 2.0 * x.x + 1.5 * x.y;
        Vec3::new(phase.sin(), phase.cos(), 0.0)
    },
    gradient: |x| {
        let phase = 2.0 * x.x + 1.5 * x.y;
        Vec3::new(phase.cos(), -phase.sin(), 0.0) * Vec3::new(2.0, 1.5, 0.0).transpose()
    },
};

const COLUMNS: [&str; 2] = ["inside", "boundary"];

fn unit_box(intervals: usize, dimension: Dimension) -> Body {
    let depth = if dimension == Dimension::Solid {
        1.0
    } else {
        0.0
    };
    setup::block([1.0, 1.0, depth], [intervals; 3], dimension)
}

/// Root mean square errors over the points farther than `margin` from the boundary, and over those
/// within two and a half spacings of it.
fn errors(body: Body, scheme: Scheme, field: &Field, margin: f64) -> Vec<f64> {
    let d = body.dimension.count();
    let near = 2.5 * body.spacing;
    let model = setup::free_body(body, setup::rubber(0.3), |_| Vec3::zeros(), scheme);
    let simulation = setup::start(model);
    let reference = simulation.reference();
    let values: Vec<Vec3> = reference
        .position
        .iter()
        .map(|x| {
            let mut value = (field.value)(x);
            if d == 2 {
                value.z = 0.0;
            }
            value
        })
        .collect();
    let (mut sums, mut counts) = ([0.0; 2], [0.0; 2]);
    for (q, x) in reference.point_positions().iter().enumerate() {
        let distance = x
            .iter()
            .take(d)
            .fold(f64::INFINITY, |m, c| m.min(*c).min(1.0 - c));
        let mut exact = (field.gradient)(x);
        if d == 2 {
            exact.set_row(2, &Vec3::zeros().transpose());
        }
        let error = (reference.bodies[0].gradient.gradient_at(q, &values) - exact).norm_squared();
        for (i, chosen) in [distance > margin, distance < near].into_iter().enumerate() {
            if chosen {
                sums[i] += error;
                counts[i] += 1.0;
            }
        }
    }
    [0, 1].map(|i| f64::sqrt(sums[i] / counts[i])).to_vec()
}

fn study(name: &str, field: &Field, scheme: Scheme, dimension: Dimension, jitter: f64) -> Study {
    let intervals: &[usize] = match dimension {
        Dimension::PlaneStrain => &[16, 32, 64],
        Dimension::Solid => &[10, 20],
    };
    let margin = 2.5 / intervals[0] as f64;
    let title = format!(
        "gradient, {}, {dimension:?}, jitter {jitter}, {name}",
        field.name
    );
    let study = Study::over(title, &COLUMNS, intervals, |n| {
        let body = setup::jittered(unit_box(n, dimension), jitter);
        errors(body, scheme, field, margin)
    });
    study.show();
    study
}

fn schemes() -> [(&'static str, Scheme); 3] {
    [
        ("particles, h = 0.9", setup::particles(0.9)),
        ("particles, h = 1.2", setup::particles(1.2)),
        ("bonds, h = 1.0", setup::bonds(1.0)),
    ]
}

/// Stencils inside a lattice are symmetric about their point: exact for quadratics and second order in
/// general. Near the boundary they are one-sided: first order.
#[test]
fn lattice_gradients_are_second_order_inside_and_first_at_the_boundary() {
    for dimension in [Dimension::PlaneStrain, Dimension::Solid] {
        for (name, scheme) in schemes() {
            let quadratic = study(name, &QUADRATIC, scheme, dimension, 0.0);
            quadratic.assert_finest_error("inside", 1e-12);
            quadratic.assert_order("boundary", 0.9..1.3);
            let trigonometric = study(name, &TRIGONOMETRIC, scheme, dimension, 0.0);
            trigonometric.assert_order("inside", 1.9..2.1);
            trigonometric.assert_order("boundary", 0.9..1.5);
        }
    }
}

/// Without symmetry only linear fields are exact: first order everywhere.
#[test]
fn gradients_on_jittered_particles_are_first_order() {
    for dimension in [Dimension::PlaneStrain, Dimension::Solid] {
        for (name, scheme) in schemes() {
            for field in [&QUADRATIC, &TRIGONOMETRIC] {
                let study = study(name, field, scheme, dimension, 0.2);
                study.assert_order("inside", 0.85..1.3);
                study.assert_order("boundary", 0.8..1.4);
            }
        }
    }
}
