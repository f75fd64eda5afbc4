//! What every registered model is held to, on each of its examples, without being asked.

mod elastic;
mod kinematics;
mod path;
mod table;

pub(crate) use elastic::*;
pub(crate) use path::*;
pub(crate) use table::table_has_the_described_keys;

use crate::{History, Kinematics, Material, ROOM_TEMPERATURE, Response};
use jstsph_tensor::{Mat3, inverse_transpose};

/// The tests of one model, as items of the module in which the macro stands.
macro_rules! conformance_tests {
    ($model:ty: $($test:ident),+ $(,)?) => {
        $(
            #[test]
            fn $test() {
                let examples = <$model as crate::Material>::examples();
                assert!(!examples.is_empty(), "a model without examples is not tested");
                for model in &examples {
                    crate::conformance::$test(model);
                }
            }
        )+
    };
    ($model:ty) => {
        crate::conformance::conformance_tests! { $model:
            undeformed_and_rotated_material_is_free_of_stress_and_history,
            stress_is_the_derivative_of_the_energy,
            volumetric_stress_is_the_derivative_of_the_volumetric_energy,
            thermoelastic_stress_is_the_derivative_in_temperature,
            stress_turns_with_the_observer,
            stress_does_not_depend_on_the_orientation_of_the_material,
            stress_is_symmetric_and_trace_free_if_split,
            wave_speeds_are_those_of_the_acoustic_tensor,
            equal_and_nearly_equal_stretches_give_continuous_stress,
            impossible_kinematics_are_errors,
            same_input_gives_the_same_bits,
            smaller_steps_converge_to_one_answer,
            work_is_stored_or_dissipated,
            plastic_steps_dissipate_and_end_on_the_yield_surface,
        }
    };
}
pub(crate) use conformance_tests;

/// Temperatures of the energy tests, K: that of stress-free examples, and one far from it.
const TEMPERATURES: [f64; 2] = [ROOM_TEMPERATURE, 500.0];

/// Kinematics of a body whose Jacobian is consistent, J = det F, at room temperature.
fn consistent(f: &Mat3) -> Kinematics {
    Kinematics {
        deformation_gradient: *f,
        jacobian: f.determinant(),
        dt: 1e-6,
        temperature: ROOM_TEMPERATURE,
    }
}

/// The response, which must exist.
fn evaluate<M: Material>(model: &M, now: &Kinematics, old: &M::History) -> Response<M::History> {
    model
        .respond(now, old)
        .unwrap_or_else(|error| panic!("{model:?} at F = {}: {error}", now.deformation_gradient))
}

/// The response to a consistent F.
fn respond<M: Material>(model: &M, f: &Mat3, old: &M::History) -> Response<M::History> {
    evaluate(model, &consistent(f), old)
}

/// P = (τ + τ_vol 1) F⁻ᵀ.
fn first_piola_stress<M: Material>(model: &M, now: &Kinematics, old: &M::History) -> Mat3 {
    let kirchhoff_stress = evaluate(model, now, old).kirchhoff_stress
        + Mat3::identity() * model.volumetric_stress(now.jacobian, now.temperature);
    kirchhoff_stress * inverse_transpose(&now.deformation_gradient).0
}

/// The part T ∂τ_vol/∂T F⁻ᵀ of the same, whose work is heat.
fn thermoelastic_piola_stress<M: Material>(model: &M, now: &Kinematics) -> Mat3 {
    inverse_transpose(&now.deformation_gradient).0
        * model.thermoelastic_stress(now.jacobian, now.temperature)
}

/// Ψ + U.
fn stored_energy<M: Material>(model: &M, now: &Kinematics, history: &M::History) -> f64 {
    model.point_energy(now, history) + model.volumetric_energy(now.jacobian, now.temperature)
}

/// Yield stress of undeformed material at room temperature and rate zero.
fn initial_yield_stress<M: Material>(model: &M) -> Option<f64> {
    model.flow_stress(&model.initial_history(), 0.0, ROOM_TEMPERATURE)
}

/// A size of |F − 1| below which the model does not yield, hot or cold: a tenth of the yield strain, or
/// rubber-like.
fn elastic_amplitude<M: Material>(model: &M) -> f64 {
    initial_yield_stress(model).map_or(0.2, |flow| 0.1 * flow / (2.0 * model.shear_modulus()))
}

/// History after a large, twisted deformation, and the deformation gradient it ended at.
fn deformed_state<M: Material>(model: &M) -> (Mat3, M::History) {
    let mut history = model.initial_history();
    let mut f = Mat3::identity();
    for step in 1..=20 {
        f = kinematics::twisted_path(f64::from(step) / 20.0);
        history = respond(model, &f, &history).history;
    }
    assert_eq!(
        history.equivalent_plastic_strain() > 0.1,
        initial_yield_stress(model).is_some(),
        "the path makes metals yield, and only them"
    );
    (f, history)
}
