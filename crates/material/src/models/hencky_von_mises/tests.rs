//! The fast update against closed forms and against the paper's own formulation.

use super::*;
use crate::hardening::Linear;
use crate::library;
use crate::models::MaterialSpec;
use jstsph_tensor::{Vec3, symmetric_eigen};
use proptest::prelude::*;

const YIELD_STRESS: f64 = 0.4e9;
const MODULUS: f64 = 0.1e9;

fn copper() -> HenckyVonMises {
    HenckyVonMises::new(
        8930.0,
        117e9,
        0.35,
        Hardening::Linear(Linear {
            initial_yield_stress: YIELD_STRESS,
            modulus: MODULUS,
        }),
    )
}

fn now(f: Mat3, jacobian: f64) -> Kinematics {
    Kinematics {
        deformation_gradient: f,
        jacobian,
        dt: 1e-6,
        temperature: crate::ROOM_TEMPERATURE,
    }
}

/// The update in principal Hencky strains, as Greto & Kulasegaram 2019, Appendix A, writes it, for
/// linear hardening: (A.7)-(A.19), for Kirchhoff stresses and with the √(2/3) that (A.11) lacks.
fn by_principal_strains(
    model: &HenckyVonMises,
    now: &Kinematics,
    old: &PlasticHistory,
) -> Response<PlasticHistory> {
    let f = now.deformation_gradient;
    let mu = model.shear_modulus();
    let spectral = symmetric_eigen(&(f * old.inverse_plastic_cauchy_green() * f.transpose()));
    let mut strain = spectral
        .values
        .map(|squared_stretch| 0.5 * squared_stretch.ln());
    let mut stress = strain.add_scalar(-strain.mean()) * (2.0 * mu);
    let trial_stress = (1.5 * stress.norm_squared()).sqrt();
    let flow_stress = YIELD_STRESS + MODULUS * old.equivalent_plastic_strain;
    let overstress = trial_stress - now.jacobian * flow_stress;
    if overstress <= 0.0 {
        return Response {
            kirchhoff_stress: spectral.compose(&stress),
            plastic_increment: 0.0,
            plastic_work: 0.0,
            history: *old,
        };
    }
    let increment = overstress / (3.0 * mu + now.jacobian * MODULUS);
    let flow_direction = stress / ((2.0f64 / 3.0).sqrt() * stress.norm());
    strain -= flow_direction * increment;
    stress *= 1.0 - 3.0 * mu * increment / trial_stress;
    let b = spectral.compose(&strain.map(|strain| (2.0 * strain).exp()));
    let f_inverse = f.try_inverse().unwrap();
    Response {
        kirchhoff_stress: spectral.compose(&stress),
        plastic_increment: increment,
        plastic_work: (trial_stress - 3.0 * mu * increment) * increment,
        history: PlasticHistory::new(
            old.equivalent_plastic_strain + increment,
            &(f_inverse * b * f_inverse.transpose()),
        ),
    }
}

fn matrix(v: [f64; 9]) -> Mat3 {
    Mat3::from_row_slice(&v)
}

proptest! {
    #[test]
    fn agrees_with_the_update_in_principal_strains(
        first in prop::array::uniform9(-0.25f64..0.25),
        second in prop::array::uniform9(-1.0f64..1.0),
        size in -6i32..0, drift in 0.95f64..1.05, plane in prop::bool::ANY,
    ) {
        let model = copper();
        let block = |mut a: Mat3| {
            if plane {
                for i in 0..3 {
                    a[(i, 2)] = 0.0;
                    a[(2, i)] = 0.0;
                }
            }
            a
        };
        let f = Mat3::identity() + block(matrix(first));
        prop_assume!(f.determinant() > 0.2);
        let old = model.respond(&now(f, f.determinant()), &model.initial_history()).unwrap().history;
        let f = f + block(matrix(second)) * (0.2 * 10f64.powi(size));
        prop_assume!(f.determinant() > 0.2);
        let now = now(f, drift * f.determinant());

        let fast = model.respond(&now, &old).unwrap();
        let oracle = by_principal_strains(&model, &now, &old);
        // Both carry the round-off of b through F, whose condition number stays below a hundred here.
        prop_assert!((fast.kirchhoff_stress - oracle.kirchhoff_stress).norm() < 1e-13 * model.shear_modulus());
        prop_assert!((fast.plastic_increment - oracle.plastic_increment).abs() < 1e-13);
        prop_assert!((fast.plastic_work - oracle.plastic_work).abs() < 1e-13 * model.shear_modulus());
        let difference = fast.history.inverse_plastic_cauchy_green() - oracle.history.inverse_plastic_cauchy_green();
        prop_assert!(difference.norm() < 1e-12 * old.inverse_plastic_cauchy_green().norm());
        if plane {
            let c = fast.history.inverse_plastic_cauchy_green();
            prop_assert_eq!((c.m13, c.m23), (0.0, 0.0));
        }
    }
}

#[test]
fn simple_tension_has_its_closed_form() {
    let model = copper();
    let mu = model.shear_modulus();
    for (strain, jacobian) in [(0.05f64, 1.0), (0.4, 1.0), (0.05, 0.98), (1.2, 1.03)] {
        let stretches = Vec3::new(strain.exp(), (-0.5 * strain).exp(), (-0.5 * strain).exp());
        let response = model
            .respond(
                &now(Mat3::from_diagonal(&stretches), jacobian),
                &PlasticHistory::INITIAL,
            )
            .unwrap();
        // τ_eq = 3 μ ε of an isochoric extension; (A.15) for Kirchhoff stresses.
        let increment =
            (3.0 * mu * strain - jacobian * YIELD_STRESS) / (3.0 * mu + jacobian * MODULUS);
        let axial_deviator = 2.0 * mu * (strain - increment);
        assert!((response.plastic_increment - increment).abs() < 1e-14);
        assert!((response.kirchhoff_stress.m11 - axial_deviator).abs() < 1e-13 * mu);
        assert!((response.kirchhoff_stress.m22 + 0.5 * axial_deviator).abs() < 1e-13 * mu);
        let plastic = response.history.inverse_plastic_cauchy_green();
        assert!((plastic.m11 - (-2.0 * increment).exp()).abs() < 1e-14);
        assert!((plastic.m22 - increment.exp()).abs() < 1e-14);
    }
}

#[test]
fn simple_shear_in_one_step_has_its_closed_form() {
    let model = copper();
    let mu = model.shear_modulus();
    for (shear, jacobian) in [(0.01f64, 1.0), (0.1, 1.0), (0.1, 1.02), (2.0, 0.97)] {
        let mut f = Mat3::identity();
        f.m12 = shear;
        let response = model
            .respond(&now(f, jacobian), &PlasticHistory::INITIAL)
            .unwrap();
        // Principal logarithmic strains ± asinh(γ/2), 0.
        let trial_stress = 2.0 * 3f64.sqrt() * mu * (0.5 * shear).asinh();
        let increment = (trial_stress - jacobian * YIELD_STRESS) / (3.0 * mu + jacobian * MODULUS);
        assert!(
            (response.plastic_increment - increment).abs() < 1e-14,
            "{shear}"
        );
        let work = jacobian * (YIELD_STRESS + MODULUS * increment) * increment;
        assert!((response.plastic_work - work).abs() < 1e-14 * mu);
    }
}

#[test]
fn below_yield_the_history_is_unchanged_bit_for_bit() {
    let model = copper();
    let c = Mat3::new(1.3, 0.1, -0.2, 0.1, 0.9, 0.07, -0.2, 0.07, 0.9);
    let old = PlasticHistory::new(0.3, &(c / c.determinant().cbrt()));
    // F = C_p^(1/2) relieves all elastic strain; a thousandth more is below yield.
    let spectral = symmetric_eigen(&old.inverse_plastic_cauchy_green());
    let f = spectral.compose(&spectral.values.map(|value| value.powf(-0.5)));
    let mut strained = f;
    strained.m12 += 1e-3;
    for f in [f, strained] {
        let response = model.respond(&now(f, 1.0), &old).unwrap();
        assert_eq!(response.history, old);
        assert_eq!(response.plastic_work, 0.0);
    }
}

#[test]
fn plastic_flow_keeps_its_volume_over_a_hundred_thousand_steps() {
    for entry in library() {
        let MaterialSpec::HenckyVonMises(model) = &entry.spec else {
            continue;
        };
        let mut history = model.initial_history();
        let mut worst = 0.0f64;
        for step in 0..100_000 {
            // A body sheared to and fro while it is stretched and turned, yielding at every step; its
            // stretches range from 0.5 to 2.
            let t = 1e-3 * f64::from(step);
            let shear = Mat3::new(
                1.0 + 0.4 * (1.1 * t).sin(),
                0.7 * t.sin(),
                0.2 * (1.7 * t).sin(),
                0.3 * (0.6 * t).sin(),
                1.0 - 0.3 * (0.9 * t).sin(),
                0.3 * (1.3 * t).sin(),
                0.1 * (2.3 * t).sin(),
                0.2 * (0.7 * t).sin(),
                1.0,
            );
            let response = model
                .respond(&now(shear, shear.determinant()), &history)
                .unwrap();
            history = response.history;
            worst = worst.max((history.inverse_plastic_cauchy_green().determinant() - 1.0).abs());
        }
        let strain = history.equivalent_plastic_strain;
        assert!(strain > 20.0, "{}: only {strain}", entry.name);
        // Round-off only: a random walk of steps of a few 1e-16, not their sum of 1e-11.
        assert!(
            worst < 1e-12,
            "{}: |det C_p⁻¹ − 1| reached {worst:e}",
            entry.name
        );
    }
}

#[test]
fn wrong_parameters_name_their_dotted_key() {
    let mut model = copper();
    model.hardening = Hardening::Linear(Linear {
        initial_yield_stress: -1.0,
        modulus: 0.0,
    });
    assert_eq!(
        model.validate().unwrap_err().to_string(),
        "hardening.linear.initial_yield_stress = -1 is out of range: it must be greater than 0"
    );
    model.poisson_ratio = 0.5.into();
    assert_eq!(
        model.validate().unwrap_err().to_string(),
        "poisson_ratio = 0.5 is out of range: it must be greater than -1 and less than 0.5"
    );
}

#[test]
fn a_history_that_is_no_metric_is_an_error_and_not_a_stress() {
    let model = copper();
    let old = PlasticHistory::new(0.1, &Mat3::from_diagonal(&Vec3::new(1.0, -1.0, -1.0)));
    let error = model
        .respond(&now(Mat3::identity(), 1.0), &old)
        .unwrap_err();
    assert!(matches!(error, MaterialError::NotFinite { .. }), "{error}");
}
