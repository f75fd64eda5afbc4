//! Consistency along a path: steps, work and dissipation.

use super::kinematics::{Numbers, twisted_path};
use super::{
    consistent, evaluate, first_piola_stress, initial_yield_stress, respond, stored_energy,
    thermoelastic_piola_stress,
};
use crate::{History, Kinematics, Material, ROOM_TEMPERATURE};
use jstsph_tensor::{Mat3, von_mises};

/// Time in which the twisted path is travelled, s: strain rates of 1e4/s.
const DURATION: f64 = 1e-4;

/// The twisted path in a number of equal steps.
struct Journey<H> {
    stress: Mat3,
    history: H,
    /// ∫ P : dF by the trapezoidal rule, without the work that becomes heat, J/m³.
    work: f64,
    /// Σ plastic work, J/m³.
    dissipated: f64,
    stored: f64,
}

/// At constant temperature: the heat of expansion leaves the body.
fn travel<M: Material>(model: &M, steps: u32) -> Journey<M::History> {
    let mut history = model.initial_history();
    let mut now = consistent(&Mat3::identity());
    now.dt = DURATION / f64::from(steps);
    let mut stress = Mat3::zeros();
    let mut stored_stress = -thermoelastic_piola_stress(model, &now);
    let (mut work, mut dissipated) = (0.0, 0.0);
    for step in 1..=steps {
        let f = twisted_path(f64::from(step) / f64::from(steps));
        let next = Kinematics {
            dt: now.dt,
            ..consistent(&f)
        };
        stress = first_piola_stress(model, &next, &history);
        let next_stored_stress = stress - thermoelastic_piola_stress(model, &next);
        let response = evaluate(model, &next, &history);
        work += 0.5 * (stored_stress + next_stored_stress).dot(&(f - now.deformation_gradient));
        dissipated += response.plastic_work;
        (now, stored_stress, history) = (next, next_stored_stress, response.history);
    }
    Journey {
        stress,
        history,
        work,
        dissipated,
        stored: stored_energy(model, &now, &history),
    }
}

pub(crate) fn smaller_steps_converge_to_one_answer<M: Material>(model: &M) {
    let reference = travel(model, 2048);
    let error = |steps: u32| {
        let coarse = travel(model, steps);
        (
            (coarse.stress - reference.stress).norm() / reference.stress.norm(),
            (coarse.history.equivalent_plastic_strain()
                - reference.history.equivalent_plastic_strain())
            .abs(),
        )
    };
    let errors = [16, 32, 64, 128].map(error);
    for pair in errors.windows(2) {
        // Backward Euler is of first order; elastic models do not depend on the path at all.
        assert!(
            pair[1].0 <= 0.6 * pair[0].0 + 1e-12,
            "{model:?}: stress {errors:?}"
        );
        assert!(
            pair[1].1 <= 0.6 * pair[0].1 + 1e-12,
            "{model:?}: plastic strain {errors:?}"
        );
    }
    assert!(errors[3].0 < 0.01, "{model:?}: {errors:?}");
}

pub(crate) fn work_is_stored_or_dissipated<M: Material>(model: &M) {
    let imbalance = |steps: u32| {
        let journey = travel(model, steps);
        (journey.work - journey.stored - journey.dissipated).abs() / journey.work
    };
    // First order where the material flows, second where it is elastic; the two may have opposite
    // signs, so the decrease is asserted over four halvings and not over each.
    let errors = [128, 2048].map(imbalance);
    assert!(errors[1] <= 0.1 * errors[0], "{model:?}: {errors:?}");
    assert!(errors[1] < 2e-4, "{model:?}: {errors:?}");
}

pub(crate) fn plastic_steps_dissipate_and_end_on_the_yield_surface<M: Material>(model: &M) {
    let mut history = model.initial_history();
    let mut numbers = Numbers::new();
    let mut f = Mat3::identity();
    let mut yielded = 0;
    for _ in 0..200 {
        // A random walk around the identity, with steps from far below to far above yield.
        let size = 10f64.powf(-2.5 + 1.5 * numbers.next());
        f += numbers.matrix() * size - (f - Mat3::identity()) * 0.02;
        let now = consistent(&f);
        let response = respond(model, &f, &history);
        assert!(response.plastic_increment >= 0.0 && response.plastic_work >= 0.0);
        let grown =
            response.history.equivalent_plastic_strain() - history.equivalent_plastic_strain();
        assert!(
            (grown - response.plastic_increment).abs()
                <= 1e-15 * (1.0 + history.equivalent_plastic_strain())
        );

        let rate = response.plastic_increment / now.dt;
        let flow_stress = |rate| model.flow_stress(&response.history, rate, ROOM_TEMPERATURE);
        let Some(limit) = flow_stress(rate) else {
            assert_eq!(response.plastic_increment, 0.0);
            continue;
        };
        let equivalent_stress = von_mises(&response.kirchhoff_stress);
        let limit = now.jacobian * limit;
        if response.plastic_increment > 0.0 {
            yielded += 1;
            // The residual is bounded relative to the trial stress τ_eq + 3 μ Δε_p.
            let trial_stress =
                equivalent_stress + 3.0 * model.shear_modulus() * response.plastic_increment;
            assert!(
                (equivalent_stress - limit).abs() < 2e-12 * trial_stress,
                "{model:?}: {equivalent_stress} Pa, yield at {limit} Pa"
            );
            assert!(
                (response.plastic_work - equivalent_stress * response.plastic_increment).abs()
                    <= 1e-11 * response.plastic_work
            );
            // The history is the one that belongs to the stress: the same F from it is elastic, unless
            // the strength falls as soon as the point stops.
            if flow_stress(rate) == flow_stress(0.0) {
                let again = respond(model, &f, &response.history);
                assert!(
                    (again.kirchhoff_stress - response.kirchhoff_stress).norm()
                        < 1e-12 * model.shear_modulus()
                );
                assert!(again.plastic_increment < 1e-12);
            }
        } else {
            assert!(equivalent_stress <= limit * (1.0 + 1e-14));
            assert_eq!(response.history, history);
        }
        history = response.history;
    }
    assert_eq!(yielded > 20, initial_yield_stress(model).is_some());
}
