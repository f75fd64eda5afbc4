//! Energy, symmetry, invariance and failure: properties of one evaluation.

use super::kinematics::Numbers;
use super::{
    TEMPERATURES, consistent, deformed_state, elastic_amplitude, first_piola_stress, respond,
    stored_energy, thermoelastic_piola_stress,
};
use crate::{Kinematics, Material, MaterialError};
use jstsph_tensor::{Mat3, Vec3};

pub(crate) fn undeformed_and_rotated_material_is_free_of_stress_and_history<M: Material>(
    model: &M,
) {
    let initial = model.initial_history();
    assert_eq!(model.validate(), Ok(()));
    assert_eq!(model.volumetric_stress(1.0, crate::ROOM_TEMPERATURE), 0.0);
    assert_eq!(model.volumetric_energy(1.0, crate::ROOM_TEMPERATURE), 0.0);
    assert_eq!(
        respond(model, &Mat3::identity(), &initial).kirchhoff_stress,
        Mat3::zeros()
    );

    let mut numbers = Numbers::new();
    for _ in 0..50 {
        let response = respond(model, &numbers.rotation(), &initial);
        // Round-off of F Fᵀ.
        assert!(
            response.kirchhoff_stress.norm()
                < 1e-14 * model.wave_speeds().pressure.powi(2) * model.density()
        );
        assert_eq!(response.history, initial);
        assert_eq!(response.plastic_increment, 0.0);
    }
}

pub(crate) fn stress_is_the_derivative_of_the_energy<M: Material>(model: &M) {
    let (initial, amplitude) = (model.initial_history(), elastic_amplitude(model));
    let mut numbers = Numbers::new();
    for temperature in TEMPERATURES {
        for _ in 0..20 {
            let f = numbers.rotation() * (Mat3::identity() + numbers.matrix() * amplitude);
            let direction = numbers.matrix();
            let at = |f: Mat3| Kinematics {
                temperature,
                ..consistent(&f)
            };
            // The rest of the work is heat.
            let stress = first_piola_stress(model, &at(f), &initial)
                - thermoelastic_piola_stress(model, &at(f));
            // Energies carry the round-off of F, 1e-16 of stiffness × strain, divided here by h;
            // truncation is h⁴ of the stiffness, h² where a derivative jumps.
            let h = 1e-5;
            let energy =
                |step: f64| stored_energy(model, &at(f + direction * (step * h)), &initial);
            let difference =
                (8.0 * (energy(1.0) - energy(-1.0)) - (energy(2.0) - energy(-2.0))) / (12.0 * h);
            let scale = model.wave_speeds().pressure.powi(2) * model.density();
            assert!(
                (stress.dot(&direction) - difference).abs() < scale * (1e-8 * amplitude + h * h),
                "{model:?} at {f}, {temperature} K: P : dF = {}, dΨ = {difference}",
                stress.dot(&direction)
            );
        }
    }
}

pub(crate) fn volumetric_stress_is_the_derivative_of_the_volumetric_energy<M: Material>(model: &M) {
    let scale = model.wave_speeds().pressure.powi(2) * model.density();
    for temperature in TEMPERATURES {
        for jacobian in [0.5, 0.9, 0.999, 1.0, 1.001, 1.2, 2.5] {
            let h = 1e-5;
            let energy = |step| model.volumetric_energy(jacobian + step * h, temperature);
            let slope =
                (8.0 * (energy(1.0) - energy(-1.0)) - (energy(2.0) - energy(-2.0))) / (12.0 * h);
            let stored = model.volumetric_stress(jacobian, temperature)
                - model.thermoelastic_stress(jacobian, temperature);
            // Round-off 1e-16/h = 1e-11, with factors up to a hundred; truncation is h⁴.
            assert!(
                (stored - jacobian * slope).abs() < 1e-8 * scale,
                "{model:?} at J = {jacobian}, {temperature} K"
            );
        }
    }
}

pub(crate) fn thermoelastic_stress_is_the_derivative_in_temperature<M: Material>(model: &M) {
    let scale = model.wave_speeds().pressure.powi(2) * model.density();
    for temperature in [350.0, 500.0, 1200.0] {
        for jacobian in [0.9, 1.0, 1.02] {
            let h = 1e-2;
            let stress = |temperature| model.volumetric_stress(jacobian, temperature);
            let slope = (stress(temperature + h) - stress(temperature - h)) / (2.0 * h);
            let found = model.thermoelastic_stress(jacobian, temperature);
            // Round-off 1e-16/h × T; the stress is at most quadratic in T between corners.
            let expected = if model.thermal().is_some() {
                temperature * slope
            } else {
                0.0
            };
            assert!(
                (found - expected).abs() < 1e-9 * scale,
                "{model:?} at J = {jacobian}, {temperature} K: {found} is not {expected}"
            );
        }
    }
}

pub(crate) fn stress_turns_with_the_observer<M: Material>(model: &M) {
    let (f, history) = deformed_state(model);
    let mut numbers = Numbers::new();
    for _ in 0..20 {
        let f = f + numbers.matrix() * 0.05;
        let q = numbers.rotation();
        let here = respond(model, &f, &history);
        let there = respond(model, &(q * f), &history);
        let turned = q * here.kirchhoff_stress * q.transpose();
        // Round-off of b of order 1e-15, times the stiffness.
        assert!((there.kirchhoff_stress - turned).norm() < 1e-13 * model.shear_modulus());
        assert!((there.plastic_increment - here.plastic_increment).abs() < 1e-13);
        assert!(
            (model.point_energy(&consistent(&(q * f)), &there.history)
                - model.point_energy(&consistent(&f), &here.history))
            .abs()
                < 1e-13 * model.shear_modulus()
        );
    }
}

pub(crate) fn stress_does_not_depend_on_the_orientation_of_the_material<M: Material>(model: &M) {
    let initial = model.initial_history();
    let mut numbers = Numbers::new();
    for _ in 0..20 {
        let f = Mat3::identity() + numbers.matrix() * 0.2;
        let q = numbers.rotation();
        let stress = respond(model, &f, &initial).kirchhoff_stress;
        let turned = respond(model, &(f * q), &initial).kirchhoff_stress;
        assert!((turned - stress).norm() < 1e-13 * model.shear_modulus());
    }
}

pub(crate) fn stress_is_symmetric_and_trace_free_if_split<M: Material>(model: &M) {
    let (f, history) = deformed_state(model);
    let mut numbers = Numbers::new();
    for _ in 0..50 {
        let f = f + numbers.matrix() * 0.05;
        // An independent Jacobian that has drifted away from det F.
        let now = Kinematics {
            jacobian: 1.05 * f.determinant(),
            ..consistent(&f)
        };
        let stress = model.respond(&now, &history).unwrap().kirchhoff_stress;
        assert_eq!(stress, stress.transpose());
        if M::VOLUMETRIC_SPLIT {
            assert!(stress.trace().abs() < 1e-14 * model.shear_modulus());
        } else {
            assert_eq!(model.volumetric_stress(1.3, crate::ROOM_TEMPERATURE), 0.0);
        }
    }
}

pub(crate) fn wave_speeds_are_those_of_the_acoustic_tensor<M: Material>(model: &M) {
    let initial = model.initial_history();
    let mut numbers = Numbers::new();
    for _ in 0..5 {
        let normal = numbers.vector().normalize();
        let across = normal.cross(&numbers.vector()).normalize();
        // ρ c² = a · (∂P/∂F : a ⊗ N) N; small enough to stay below yield, truncation h², round-off
        // 1e-16/h.
        let h = 1e-5;
        let stiffness = |amplitude: &Vec3| {
            let change = amplitude * normal.transpose() * h;
            let stress = |f| first_piola_stress(model, &consistent(&f), &initial);
            let change = stress(Mat3::identity() + change) - stress(Mat3::identity() - change);
            amplitude.dot(&(change * normal)) / (2.0 * h)
        };
        // Heat does not flow as fast as a wave: ρ c dT = (T ∂τ_vol/∂T) dJ/J.
        let heating = model.thermal().map_or(0.0, |thermal| {
            let temperature = crate::ROOM_TEMPERATURE;
            model.thermoelastic_stress(1.0, temperature).powi(2)
                / (temperature * model.density() * thermal.heat_capacity.at(temperature))
        });
        let speeds = model.wave_speeds();
        for (amplitude, heating, speed) in [
            (normal, heating, speeds.pressure),
            (across, 0.0, speeds.shear),
        ] {
            let found = ((stiffness(&amplitude) + heating) / model.density()).sqrt();
            assert!(
                (found / speed - 1.0).abs() < 1e-8,
                "{model:?}: {found} m/s is not {speed}"
            );
        }
    }
}

pub(crate) fn equal_and_nearly_equal_stretches_give_continuous_stress<M: Material>(model: &M) {
    let initial = model.initial_history();
    let mut numbers = Numbers::new();
    for stretch in [0.8, 0.999, 1.0, 1.003, 1.4] {
        for other in [stretch, 1.1] {
            let (q, r) = (numbers.rotation(), numbers.rotation());
            let stretched =
                |gap: f64| q * Mat3::from_diagonal(&Vec3::new(stretch + gap, stretch, other)) * r;
            let equal = respond(model, &stretched(0.0), &initial).kirchhoff_stress;
            for exponent in -17..-2 {
                let gap = 10f64.powi(exponent);
                let near = respond(model, &stretched(gap), &initial).kirchhoff_stress;
                let bound =
                    model.wave_speeds().pressure.powi(2) * model.density() * (10.0 * gap + 1e-13);
                assert!(
                    (near - equal).norm() < bound,
                    "{model:?}: {stretch} + {gap}, {other}"
                );
            }
        }
    }
}

pub(crate) fn impossible_kinematics_are_errors<M: Material>(model: &M) {
    let initial = model.initial_history();
    let now = |f: Mat3, jacobian: f64| Kinematics {
        deformation_gradient: f,
        jacobian,
        dt: 1e-6,
        temperature: crate::ROOM_TEMPERATURE,
    };
    let mirrored = Mat3::from_diagonal(&Vec3::new(1.0, -1.0, 1.0));
    for now in [
        now(Mat3::identity(), 0.0),
        now(Mat3::identity(), -0.02),
        now(mirrored, 1.0),
        now(Mat3::zeros(), 1.0),
    ] {
        let error = model.respond(&now, &initial).unwrap_err();
        assert!(matches!(error, MaterialError::Inverted { .. }), "{error}");
    }
    let mut undefined = Mat3::identity();
    undefined.m23 = f64::NAN;
    let mut infinite = Mat3::identity();
    infinite.m11 = f64::INFINITY;
    for now in [
        now(Mat3::identity(), f64::NAN),
        now(Mat3::identity(), f64::INFINITY),
        now(undefined, 1.0),
        now(infinite, 1.0),
    ] {
        let error = model.respond(&now, &initial).unwrap_err();
        assert!(matches!(error, MaterialError::NotFinite { .. }), "{error}");
    }
}

pub(crate) fn same_input_gives_the_same_bits<M: Material>(model: &M) {
    let (f, history) = deformed_state(model);
    let before = history;
    let now = consistent(&(f * 1.01));
    let first = model.respond(&now, &history).unwrap();
    assert_eq!(model.respond(&now, &history).unwrap(), first);
    assert_eq!(history, before);
}
