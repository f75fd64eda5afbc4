//! Hencky elasticity with von Mises plasticity at one point: closed forms, and the order of the
//! return map along paths that turn. docs/theory.md, "Elastic part and yield".

use jstsph_material::hardening::{Hardening, Linear};
use jstsph_material::models::HenckyVonMises;
use jstsph_material::{Kinematics, Material, PlasticHistory, ROOM_TEMPERATURE};
use jstsph_tensor::{Mat3, Vec3, exp_symmetric, von_mises};
use jstsph_tests::Study;

const YOUNG: f64 = 117e9;
const POISSON: f64 = 0.35;
const YIELD: f64 = 0.4e9;
const HARDENING: f64 = 0.1e9;
const SHEAR: f64 = YOUNG / (2.0 * (1.0 + POISSON));

fn copper() -> HenckyVonMises {
    HenckyVonMises::new(
        8930.0,
        YOUNG,
        POISSON,
        Hardening::Linear(Linear {
            initial_yield_stress: YIELD,
            modulus: HARDENING,
        }),
    )
}

/// Kirchhoff stress and history after a step to F, with J = det F.
fn step(model: &HenckyVonMises, f: &Mat3, old: &PlasticHistory) -> (Mat3, PlasticHistory) {
    let now = Kinematics {
        deformation_gradient: *f,
        jacobian: f.determinant(),
        dt: 1e-6,
        temperature: ROOM_TEMPERATURE,
    };
    let response = model.respond(&now, old).expect("a sound deformation");
    let pressure = model.volumetric_stress(now.jacobian, now.temperature);
    (
        response.kirchhoff_stress + Mat3::identity() * pressure,
        response.history,
    )
}

/// Stress and history at the end of a path F(s), s from 0 to 1, in equal steps.
fn travel(path: impl Fn(f64) -> Mat3, steps: usize) -> (Mat3, PlasticHistory) {
    let model = copper();
    let mut history = model.initial_history();
    let mut stress = Mat3::zeros();
    for i in 1..=steps {
        (stress, history) = step(&model, &path(i as f64 / steps as f64), &history);
    }
    (stress, history)
}

/// Simple tension: τ = J σ_Y(ε_p), ln J = (1 − 2ν) τ/E, axial strain τ/E + ε_p, lateral −ν τ/E − ε_p/2.
/// The flow never turns, so that the return map is exact in one step or many.
#[test]
fn simple_tension_is_that_of_the_closed_form() {
    let model = copper();
    for sign in [1.0, -1.0] {
        let mut history = model.initial_history();
        for i in 1..=40 {
            let plastic = 0.05 * f64::from(i);
            let flow = YIELD + HARDENING * plastic;
            // τ = exp((1 − 2ν) τ/E) σ_Y: contracts by about 10⁻³ each time.
            let mut stress = sign * flow;
            for _ in 0..20 {
                stress = sign * flow * ((1.0 - 2.0 * POISSON) * stress / YOUNG).exp();
            }
            let axial = stress / YOUNG + sign * plastic;
            let lateral = -POISSON * stress / YOUNG - 0.5 * sign * plastic;
            let f = Mat3::from_diagonal(&Vec3::new(axial.exp(), lateral.exp(), lateral.exp()));
            let (found, next) = step(&model, &f, &history);
            let expected = Mat3::from_diagonal(&Vec3::new(stress, 0.0, 0.0));
            // Round-off of strains of size 1 times the stiffness 3 μ: 1e-15 · 1.3e11 Pa.
            assert!((found - expected).norm() < 1e-3, "{found} {expected}");
            assert!((next.equivalent_plastic_strain - plastic).abs() < 1e-13);
            history = next;
        }
    }
}

/// Plane strain compression without change of volume, ln F = diag(−ε, ε, 0): the equivalent strain is
/// 2ε/√3, 3 μ (2ε/√3 − ε_p) = σ_Y(ε_p), and with a free side face the pressing stress is 2 σ_Y/√3.
#[test]
fn plane_strain_compression_is_that_of_the_closed_form() {
    let model = copper();
    let mut history = model.initial_history();
    for i in 1..=40 {
        let strain = 0.04 * f64::from(i);
        let equivalent = 2.0 * strain / 3f64.sqrt();
        let plastic = (3.0 * SHEAR * equivalent - YIELD) / (3.0 * SHEAR + HARDENING);
        let flow = YIELD + HARDENING * plastic;
        let f = Mat3::from_diagonal(&Vec3::new((-strain).exp(), strain.exp(), 1.0));
        let (found, next) = step(&model, &f, &history);
        let pressing = found.m22 - found.m11;
        assert!((pressing - 2.0 / 3f64.sqrt() * flow).abs() < 1e-3);
        assert!((found.m33 - 0.5 * (found.m11 + found.m22)).abs() < 1e-3);
        assert!((next.equivalent_plastic_strain - plastic).abs() < 1e-13);
        history = next;
    }
}

/// Small simple shear beyond yield: τ_12 = σ_Y/√3 to the square of the elastic strain.
#[test]
fn small_shear_yields_at_the_shear_stress_of_von_mises() {
    let gamma = 0.01;
    let (stress, history) = travel(|s| shear(gamma * s), 100);
    let plastic = (3.0 * SHEAR * gamma / 3f64.sqrt() - YIELD) / (3.0 * SHEAR + HARDENING);
    let flow = YIELD + HARDENING * plastic;
    assert!((stress.m12 * 3f64.sqrt() / flow - 1.0).abs() < 1e-4);
    assert!((history.equivalent_plastic_strain / plastic - 1.0).abs() < 1e-3);
    assert!(
        (von_mises(&stress) / (YIELD + HARDENING * history.equivalent_plastic_strain) - 1.0).abs()
            < 1e-12
    );
}

fn shear(gamma: f64) -> Mat3 {
    Mat3::new(1.0, gamma, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
}

fn axial(strain: f64) -> Mat3 {
    Mat3::from_diagonal(&Vec3::new(
        strain.exp(),
        (-0.5 * strain).exp(),
        (-0.5 * strain).exp(),
    ))
}

/// A loop in the plane of axial and shear strain, which the flow direction follows.
fn turning(angle: f64) -> Mat3 {
    let (a, b) = (0.02 * angle.sin(), 0.02 * (1.0 - angle.cos()));
    let strain = Mat3::new(a, b, 0.0, b, -0.5 * a, 0.0, 0.0, 0.0, -0.5 * a);
    exp_symmetric(&strain)
}

/// Relative errors of stress and plastic strain against 2¹⁵ steps.
fn order_along(name: &str, path: impl Fn(f64) -> Mat3) -> Study {
    let (stress, history) = travel(&path, 1 << 15);
    let study = Study::over(
        format!("return map, {name}"),
        &["stress", "plastic strain"],
        &[64, 128, 256, 512],
        |steps| {
            let (found, coarse) = travel(&path, steps);
            let strain = history.equivalent_plastic_strain;
            vec![
                (found - stress).norm() / stress.norm(),
                (coarse.equivalent_plastic_strain - strain).abs() / strain,
            ]
        },
    );
    study.show();
    study
}

/// Backward Euler: first order where the direction of flow turns. Measured 1.00 to 1.02 in all.
#[test]
fn return_map_is_first_order_along_paths_that_turn() {
    type Path = fn(f64) -> Mat3;
    let paths: [(&str, Path); 3] = [
        ("simple shear to 1.5", |s| shear(1.5 * s)),
        (
            "tension, then shear",
            // Whole numbers of steps before and after the turn.
            |s| {
                if s <= 0.5 {
                    axial(0.1 * s)
                } else {
                    shear(0.1 * (s - 0.5)) * axial(0.05)
                }
            },
        ),
        ("two turns of a cycle of tension and shear", |s| {
            turning(4.0 * std::f64::consts::PI * s)
        }),
    ];
    for (name, path) in paths {
        let study = order_along(name, path);
        study.assert_order("stress", 0.9..1.2);
        study.assert_order("plastic strain", 0.9..1.3);
        study.assert_finest_error("stress", 2e-2);
    }
}

/// Cyclic tension and compression: the flow reverses but never turns, so that steps only round the
/// points of reversal off, which all step numbers here hit exactly.
#[test]
fn cyclic_tension_needs_no_small_steps() {
    let path = |s: f64| axial(0.03 * (1.0 - (2.0 * s - 1.0).abs()) - 0.015);
    let triangle = |s: f64| path(0.25 + 3.0 * s - (0.25 + 3.0 * s).floor());
    let (fine, fine_history) = travel(triangle, 24 * 512);
    let (coarse, coarse_history) = travel(triangle, 24);
    assert!(fine_history.equivalent_plastic_strain > 0.05);
    // Round-off over 12,288 steps.
    assert!(
        (coarse - fine).norm() < 1e-9 * fine.norm(),
        "{coarse} {fine}"
    );
    let strain = fine_history.equivalent_plastic_strain;
    assert!((coarse_history.equivalent_plastic_strain - strain).abs() < 1e-9 * strain);
}
