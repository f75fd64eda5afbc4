//! The finite elements of the Taylor bar's reference: patch tests, motion, waves, the table in docs/data.

use std::f64::consts::PI;

use jstsph_tests::axisymmetric::{Base, Body, Impact, Mesh, Metal, TaylorBar, TaylorRow};
use jstsph_tests::observed_order;

/// Homogeneous compression of a mesh with displaced nodes, far into plastic flow: no force inside, and on the
/// top that of the closed form. Strains stay coaxial, so ε_p = (3 μ e − J σ_0)/(3 μ + J H).
#[test]
fn homogeneous_compression_is_exact_on_a_distorted_mesh() {
    let (radius, height) = (3.0e-3, 4.0e-3);
    let mut mesh = Mesh::cylinder(radius, height, 3, 4);
    let inside = |x: &[f64; 2]| {
        let margin = 1e-6;
        x[0] > margin && x[0] < radius - margin && x[1] > margin && x[1] < height - margin
    };
    let mut count = 0.0_f64;
    for x in mesh.nodes.iter_mut().filter(|x| inside(x)) {
        count += 1.0;
        x[0] += 0.2e-3 * (7.0 * count).sin();
        x[1] += 0.2e-3 * (11.0 * count).cos();
    }
    let metal = Metal::copper();
    let mut body = Body::new(mesh, metal);
    let (radial, axial): (f64, f64) = (0.24, -0.5);
    for step in 1..=5 {
        let share = f64::from(step) / 5.0;
        let stretches = [(share * radial).exp(), (share * axial).exp()];
        for (x, origin) in body.position.iter_mut().zip(&body.mesh.nodes) {
            *x = [stretches[0] * origin[0], stretches[1] * origin[1]];
        }
        body.deform().expect("no inverted element");
    }

    let logarithm = 2.0 * radial + axial;
    let jacobian = logarithm.exp();
    let equivalent = 2.0 / 3.0 * (radial - axial);
    let stiffness = 3.0 * metal.shear_modulus;
    let plastic_strain = (stiffness * equivalent - jacobian * metal.initial_yield_stress)
        / (stiffness + jacobian * metal.hardening_modulus);
    for strain in body.plastic_strain() {
        assert!((strain / plastic_strain - 1.0).abs() < 1e-11, "{strain}");
    }
    let flow_stress = metal.initial_yield_stress + metal.hardening_modulus * plastic_strain;
    let stress = metal.bulk_modulus * logarithm - 2.0 / 3.0 * jacobian * flow_stress;
    // The Kirchhoff stress over the axial stretch acts on the undeformed area.
    let exact = -stress / axial.exp() * PI * radius * radius;
    let top: f64 = body
        .mesh
        .nodes
        .iter()
        .zip(&body.force)
        .filter(|(x, _)| x[1] > height - 1e-6)
        .map(|(_, force)| force[1])
        .sum();
    assert!(
        (top / exact - 1.0).abs() < 1e-9,
        "{top} N, exactly {exact} N"
    );
    for (x, force) in body.mesh.nodes.iter().zip(&body.force) {
        if inside(x) {
            assert!(force[0].hypot(force[1]) < 1e-10 * exact.abs(), "{force:?}");
        }
    }
}

#[test]
fn a_bar_that_flies_away_feels_nothing() {
    let mesh = Mesh::cylinder(3.2e-3, 32e-3, 3, 30);
    let mut impact = Impact::new(mesh, Metal::copper(), Base::Free, 227.0, 1.0);
    impact.run_to(40e-6).expect("no inverted element");
    let energies = impact.energies();
    assert!(energies.balance().abs() < 1e-12);
    assert!(energies.elastic < 1e-12 * energies.initial);
    assert_eq!(energies.wall, 0.0);
    for (x, origin) in impact.body.position.iter().zip(&impact.body.mesh.nodes) {
        assert!((x[0] - origin[0]).abs() < 1e-14);
        assert!((x[1] - origin[1] - 227.0 * 40e-6).abs() < 1e-14);
    }
}

/// Quarter-wave of a slender elastic rod on the wall: after half a period, 2 L/c_0 with Rayleigh's correction
/// for the inertia across, all displacements vanish. What is left of them is the error of the period.
#[test]
fn an_elastic_rod_swings_with_its_period() {
    let (radius, length, speed): (f64, f64, f64) = (1e-3, 20e-3, -0.1);
    let metal = Metal::copper();
    let (young, poisson): (f64, f64) = (117e9, 0.35);
    let wave_number = 0.5 * PI / length;
    let half_period = 2.0 * length / (young / metal.density).sqrt()
        * (1.0 + (0.5 * poisson * wave_number * radius).powi(2));
    let error = |radial: usize| {
        let mesh = Mesh::cylinder(radius, length, radial, 4 * radial);
        let mut impact = Impact::new(mesh, metal, Base::Held, speed, 0.8);
        for (v, x) in impact.velocity.iter_mut().zip(&impact.body.mesh.nodes) {
            v[1] = speed * (wave_number * x[1]).sin();
        }
        impact.run_to(half_period).expect("no inverted element");
        assert!(
            impact
                .body
                .plastic_strain()
                .iter()
                .all(|strain| *strain == 0.0)
        );
        let top = impact.body.position[impact.body.mesh.side()[4 * radial]][1];
        ((top - length) / (speed * half_period)).abs()
    };
    let errors = [1, 2, 4].map(|radial| (radial as f64, error(radial)));
    assert!(errors[2].1 < 1e-3, "{errors:?}");
    let order = observed_order(errors[0], errors[1]);
    assert!((order - 2.0).abs() < 0.3, "order {order}: {errors:?}");
}

fn table() -> Vec<Vec<String>> {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../docs/data/taylor-reference.csv"
    );
    let text = std::fs::read_to_string(path).expect("the table of docs/data");
    assert_eq!(text.lines().next(), Some(TaylorRow::HEADER));
    text.lines()
        .skip(1)
        .map(|line| line.split(',').map(str::to_owned).collect())
        .collect()
}

/// The coarsest rows of the table, run again.
#[test]
fn the_table_of_the_taylor_bar_is_that_of_the_program() {
    let table = table();
    for base in [Base::Free, Base::Held] {
        let bar = TaylorBar {
            height: 32e-3,
            base,
            radial: 5,
        };
        let row = bar.run(1.1).expect("no inverted element");
        let cells: Vec<String> = row.to_string().split(',').map(str::to_owned).collect();
        let stored = table.iter().find(|stored| stored[..3] == cells[..3]);
        let stored = stored.expect("a row of the table");
        // Lengths and strains; another compiler may round differently, and the step follows.
        for (one, other) in cells[3..20].iter().zip(&stored[3..20]) {
            let [one, other]: [f64; 2] = [one, other].map(|cell| cell.parse().expect("a number"));
            assert!((one - other).abs() <= 2e-4 * other.abs(), "{one} {other}");
        }
        // Of second order in the step: 6e-4, and 3e-4 at 0.8 of the estimate.
        let balance = row.energies.balance();
        assert!(balance.abs() < 1e-3, "balance {balance}");
    }
}

/// From mesh to mesh the radius and the length change less and less:
/// at the end by less than a per cent of what the impact changed, and at most 0.7 times as much as before.
#[test]
fn the_table_of_the_taylor_bar_converges() {
    let table = table();
    let column = |name: &str| {
        let position = TaylorRow::HEADER.split(',').position(|other| other == name);
        position.expect("a column")
    };
    for height in ["32.0", "32.4"] {
        for base in ["free", "held"] {
            for (name, undeformed) in [("largest_radius", 3.2), ("length", 32.0)] {
                let values: Vec<f64> = table
                    .iter()
                    .filter(|row| row[0] == height && row[1] == base)
                    .map(|row| row[column(name)].parse().expect("a number"))
                    .collect();
                let last = values.len().checked_sub(1).expect("rows of this bar");
                assert!(last >= 2, "{name}, {base}: {values:?}");
                let change = |k: usize| (values[k] - values[k - 1]).abs();
                assert!(
                    change(last) < 0.01 * (values[last] - undeformed).abs()
                        && change(last) < 0.7 * change(last - 1),
                    "{name}, {base}: {values:?}"
                );
            }
        }
    }
}
