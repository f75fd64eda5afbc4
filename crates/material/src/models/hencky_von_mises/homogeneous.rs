//! Uniaxial compression of one point against the closed forms of Johnson and Cook, and failure.

use super::*;
use crate::hardening::{HardeningLaw, JohnsonCook, Perfect};
use jstsph_tensor::{Vec3, von_mises};

/// Strain rate, 1/s.
const RATE: f64 = 1e3;
/// True strain at the end.
const END: f64 = 0.5;

/// OFHC copper of Johnson & Cook 1983, but with m = 1, for which adiabatic heating has a closed form.
fn law() -> JohnsonCook {
    JohnsonCook {
        m: 1.0,
        ..JohnsonCook::examples()[0].clone()
    }
}

fn copper() -> HenckyVonMises {
    HenckyVonMises::new(8960.0, 124e9, 0.34, Hardening::JohnsonCook(law()))
}

/// Isochoric uniaxial compression to a true strain.
fn compressed(strain: f64, dt: f64, temperature: f64) -> Kinematics {
    let across = (0.5 * strain).exp();
    Kinematics {
        deformation_gradient: Mat3::from_diagonal(&Vec3::new(across, across, (-strain).exp())),
        jacobian: 1.0,
        dt,
        temperature,
    }
}

/// σ of σ = σ_Y(ε − σ/3μ, ε̇, T), the elastic strain taken off.
fn closed_form(model: &HenckyVonMises, strain: f64, rate: f64, temperature: f64) -> f64 {
    let mut stress = 0.0;
    for _ in 0..50 {
        stress = model
            .hardening
            .flow_stress(&FlowState {
                plastic_strain: strain - stress / (3.0 * model.shear_modulus()),
                rate,
                temperature,
            })
            .value;
    }
    stress
}

/// True stress and temperature at the end, the point heated after every step by a share of the plastic
/// work over the heat capacity per volume, m³ K/J.
fn compress(model: &HenckyVonMises, steps: u32, mut temperature: f64, heating: f64) -> (f64, f64) {
    let step = END / f64::from(steps);
    let mut history = model.initial_history();
    let mut stress = 0.0;
    for i in 1..=steps {
        let now = compressed(step * f64::from(i), step / RATE, temperature);
        let response = model.respond(&now, &history).unwrap();
        history = response.history;
        stress = von_mises(&response.kirchhoff_stress);
        temperature += heating * response.plastic_work;
    }
    (stress, temperature)
}

#[test]
fn isothermal_compression_follows_johnson_and_cook() {
    let model = copper();
    for temperature in [293.15, 600.0, 1000.0] {
        let (stress, _) = compress(&model, 200, temperature, 0.0);
        let expected = closed_form(&model, END, RATE, temperature);
        // The closed form takes the total rate for the plastic one, which is less by the slope over
        // 3 μ, 2e-3; the strength feels 0.025 of that.
        assert!(
            (stress / expected - 1.0).abs() < 5e-5,
            "{temperature} K: {stress} Pa, {expected} Pa"
        );
    }
}

#[test]
fn adiabatic_compression_converges_to_its_closed_form_in_first_order() {
    let (model, law) = (copper(), law());
    let heating = 0.9 / (8960.0 * 383.0);
    // dT*/dε_p = h (A + B ε_pⁿ)(1 − T*), h = β (1 + C ln ε̇*)/(ρ c (T_m − T_r)).
    let per_stress = heating * (1.0 + law.c * RATE.ln()) / (1356.0 - 293.15);
    let expected = |strain: f64| {
        let work = law.a * strain + law.b * strain.powf(law.n + 1.0) / (law.n + 1.0);
        293.15 + (1356.0 - 293.15) * (1.0 - (-per_stress * work).exp())
    };
    let errors = [100, 200, 400].map(|steps| {
        let (stress, temperature) = compress(&model, steps, 293.15, heating);
        let strain = END - stress / (3.0 * model.shear_modulus());
        (
            temperature - expected(strain),
            stress / closed_form(&model, END, RATE, expected(strain)) - 1.0,
        )
    });
    for pair in errors.windows(2) {
        assert!((1.8..2.2).contains(&(pair[0].0 / pair[1].0)), "{errors:?}");
    }
    // 30 K of heating, 130 MPa.
    assert!(expected(END) - 293.15 > 30.0);
    assert!(
        errors[2].0.abs() < 0.05 && errors[2].1.abs() < 1e-4,
        "{errors:?}"
    );
}

#[test]
fn the_rate_of_a_step_is_of_first_order_in_its_length() {
    // From rest with constant acceleration of the strain: the rate at the end is twice the mean.
    let model = copper();
    let stress = |steps: u32| {
        let dt = END / RATE / f64::from(steps);
        let mut history = model.initial_history();
        let mut stress = 0.0;
        for i in 1..=steps {
            let part = f64::from(i) / f64::from(steps);
            let now = compressed(END * part * part, dt, 293.15);
            let response = model.respond(&now, &history).unwrap();
            history = response.history;
            stress = von_mises(&response.kirchhoff_stress);
        }
        stress
    };
    let stresses = [50, 100, 200, 400].map(stress);
    for s in stresses.windows(3) {
        let ratio = (s[0] - s[1]) / (s[1] - s[2]);
        assert!((1.9..2.1).contains(&ratio), "{stresses:?}: {ratio}");
    }
    let expected = closed_form(&model, END, 2.0 * RATE, 293.15);
    assert!(
        (stresses[3] / expected - 1.0).abs() < 1e-4,
        "{stresses:?} {expected}"
    );
}

#[test]
fn molten_metal_flows_without_stress_and_keeps_its_volume() {
    let model = copper();
    let solid = model
        .respond(&compressed(0.1, 1e-6, 293.15), &model.initial_history())
        .unwrap();
    let molten = model
        .respond(&compressed(0.1, 1e-6, 1400.0), &solid.history)
        .unwrap();
    assert_eq!(molten.kirchhoff_stress, Mat3::zeros());
    // It gives up the elastic energy it had, τ_eq²/(6 μ).
    let stress = von_mises(&solid.kirchhoff_stress);
    let energy = stress * stress / (6.0 * model.shear_modulus());
    assert!((molten.plastic_work / energy - 1.0).abs() < 1e-12);
    let left = model.point_energy(&compressed(0.1, 1e-6, 1400.0), &molten.history);
    assert!(
        left < 1e-20 * energy.max(1.0) * model.shear_modulus(),
        "{left}"
    );
    let plastic = molten.history.inverse_plastic_cauchy_green();
    assert!((plastic.determinant() - 1.0).abs() < 1e-14);
}

#[test]
fn damage_grows_with_strain_and_tension_and_takes_the_strength() {
    let fracture_strain = 0.1;
    let model = HenckyVonMises {
        hardening: Hardening::Perfect(Perfect {
            initial_yield_stress: 0.4e9,
        }),
        damage: Some(Damage::JohnsonCook(JohnsonCookDamage {
            d1: fracture_strain,
            d2: 0.5,
            d3: -2.0,
            d4: 0.0,
            d5: 0.0,
            reference_rate: 1.0,
            reference_temperature: 293.15,
            melting_temperature: 1356.0,
        })),
        ..copper()
    };
    assert_eq!(model.validate(), Ok(()));
    for jacobian in [0.999, 1.0, 1.002] {
        let at = |strain: f64| Kinematics {
            jacobian,
            ..compressed(strain, 1e-6, 293.15)
        };
        let one = model.respond(&at(0.05), &model.initial_history()).unwrap();
        let triaxiality = model.volumetric_stress(jacobian, 293.15) / (0.4e9 * jacobian);
        let expected = one.plastic_increment / (0.1 + 0.5 * (-2.0 * triaxiality.min(1.5)).exp());
        assert!(
            (one.history.damage / expected - 1.0).abs() < 1e-9,
            "{jacobian}"
        );
    }

    let mut history = model.initial_history();
    let mut failed_at = None;
    for i in 1..=100 {
        let now = compressed(0.01 * f64::from(i), 1e-6, 293.15);
        let strength = model.flow_stress(&history, 0.0, 293.15).unwrap();
        let response = model.respond(&now, &history).unwrap();
        assert_eq!(strength == 0.0, !model.carries_tension(&history));
        // The flow stress is met to the tolerance of the return, relative to its trial stress.
        assert!((von_mises(&response.kirchhoff_stress) - strength).abs() < 1e-2);
        history = response.history;
        if history.damage >= 1.0 && failed_at.is_none() {
            failed_at = Some(history.equivalent_plastic_strain);
        }
    }
    // J = 1: no mean stress, so the fracture strain is d1 + d2; it is met to one step of 0.01.
    let failed_at = failed_at.expect("the metal fails");
    assert!((0.6..0.61).contains(&failed_at), "{failed_at}");
    assert_eq!(history.damage, 1.0);
}

#[test]
fn compression_beyond_the_equation_of_state_is_an_error() {
    let model = HenckyVonMises::examples()
        .into_iter()
        .find(|model| model.equation_of_state.is_some())
        .expect("an example");
    let now = Kinematics {
        jacobian: 0.45,
        ..compressed(0.0, 1e-6, 293.15)
    };
    let error = model.respond(&now, &model.initial_history()).unwrap_err();
    assert!(matches!(error, MaterialError::Compressed { .. }), "{error}");
}
