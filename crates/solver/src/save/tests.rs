use super::*;
use crate::model::{
    Biharmonic, Integrator, Jst, Laplacian, Model, Quadrature, Stabilisation, StepLimit,
};
use crate::testing::{INTEGRATORS, QUADRATURES, impact, in_pool, model, scheme};

/// Plates in plastic impact with everything that a scheme can have switched on somewhere.
fn models(nodes: [usize; 3]) -> Vec<Model> {
    let mut models = Vec::new();
    for quadrature in QUADRATURES {
        for integrator in INTEGRATORS {
            for stabilised in [false, true] {
                let mut scheme = scheme(quadrature, integrator);
                if stabilised {
                    scheme.step_limit = StepLimit::Acoustic;
                    scheme.stabilisation = Stabilisation {
                        jst: Some(Jst {
                            harmonic: 1e-3,
                            biharmonic: Biharmonic::FallingWithPlasticStrain {
                                initial: 1.0 / 256.0,
                                last: 1.0 / 4096.0,
                                strain: 0.02,
                            },
                            on_jacobian: true,
                            laplacian: Laplacian::Symmetric,
                        }),
                        upwind: 0.05,
                        hourglass: 0.01,
                        viscosity: None,
                    };
                }
                models.push(impact(nodes, scheme));
            }
        }
    }
    models
}

fn run(simulation: &mut Simulation, steps: usize) {
    for _ in 0..steps {
        simulation.advance_step(1.0).unwrap();
    }
}

/// Bits of everything saved: `==` would take 0 for −0.
fn bits(simulation: &Simulation) -> Vec<(String, Vec<u64>)> {
    let saved = simulation.save();
    let scalars = vec![saved.time, saved.time_step, saved.step as f64];
    let mut arrays = saved.arrays;
    arrays.push(("clock".into(), scalars));
    arrays
        .into_iter()
        .map(|(name, values)| (name, values.iter().map(|v| v.to_bits()).collect()))
        .collect()
}

fn assert_same_bits(one: &Simulation, other: &Simulation, what: &str) {
    for ((name, one), (_, other)) in bits(one).iter().zip(&bits(other)) {
        assert!(one == other, "{what}: {name} differs");
    }
}

fn describe(model: &Model) -> String {
    format!(
        "{:?}, {:?}",
        model.scheme.quadrature, model.scheme.integrator
    )
}

#[test]
fn a_restored_run_goes_on_with_the_same_bits() {
    for model in models([9, 6, 1]) {
        let what = describe(&model);
        let mut whole = Simulation::new(model.clone()).unwrap();
        run(&mut whole, 60);
        let saved = whole.save();
        let mut resumed = Simulation::new(model).unwrap();
        resumed.restore(&saved).unwrap();
        assert_eq!(resumed.save(), saved, "{what}");
        run(&mut whole, 50);
        run(&mut resumed, 50);
        assert_same_bits(&whole, &resumed, &what);
        assert_eq!(whole.energies(), resumed.energies(), "{what}");
        assert_eq!(
            whole.obstacle_impulses(),
            resumed.obstacle_impulses(),
            "{what}"
        );
        // The comparison is one of plastic flow and contact, not of a body at rest.
        assert!(
            whole.energies().plastic > 0.01 * whole.energies().initial,
            "{what}"
        );
        assert!(whole.obstacle_impulses()[0].1.y < 0.0, "{what}");
    }
}

#[test]
fn a_restored_simulation_reports_the_same_numbers_before_its_next_step() {
    for model in models([9, 6, 1]) {
        let what = describe(&model);
        let mut run_on = Simulation::new(model.clone()).unwrap();
        run(&mut run_on, 40);
        let mut restored = Simulation::new(model).unwrap();
        restored.restore(&run_on.save()).unwrap();
        let paper = run_on.paper_energies();
        assert!(paper.internal > 0.0 && paper.plastic > 0.0, "{what}");
        assert_eq!(restored.paper_energies(), paper, "{what}");
        assert_eq!(restored.momenta(), run_on.momenta(), "{what}");
        assert_eq!(restored.energies(), run_on.energies(), "{what}");
        assert_eq!(restored.time_step(), run_on.time_step(), "{what}");
        assert_eq!(
            restored.stable_time_step(),
            run_on.stable_time_step(),
            "{what}"
        );
        let [here, there] = [&restored, &run_on].map(Simulation::particle_fields);
        assert_eq!(format!("{here:?}"), format!("{there:?}"), "{what}");
    }
}

#[test]
fn a_run_stopped_at_its_end_is_restored_synchronised() {
    for integrator in INTEGRATORS {
        let model = impact([6, 5, 1], scheme(Quadrature::Bonds, integrator));
        let mut whole = Simulation::new(model.clone()).unwrap();
        let end = 10.5 * whole.stable_time_step();
        while whole.time() < end {
            whole.advance_step(end).unwrap();
        }
        assert_eq!(whole.time(), end);
        assert!(whole.is_synchronised());
        let mut resumed = Simulation::new(model).unwrap();
        resumed.restore(&whole.save()).unwrap();
        run(&mut whole, 20);
        run(&mut resumed, 20);
        assert_same_bits(&whole, &resumed, &format!("{integrator:?}"));
    }
}

#[test]
fn results_have_the_same_bits_with_one_and_three_threads() {
    // Above 2048 particles, where loops run in parallel.
    for model in models([50, 45, 1]) {
        let what = describe(&model);
        let [serial, parallel] = [1, 3].map(|threads| {
            in_pool(threads, || {
                let mut simulation = Simulation::new(model.clone()).unwrap();
                run(&mut simulation, 12);
                simulation
            })
        });
        assert_same_bits(&serial, &parallel, &what);
        assert_eq!(serial.energies().elastic.to_bits(), {
            in_pool(3, || parallel.energies().elastic.to_bits())
        });
    }
}

#[test]
fn foreign_states_are_refused_with_what_does_not_fit() {
    let scheme = scheme(Quadrature::Particles, Integrator::Leapfrog);
    let saved = Simulation::new(impact([5, 4, 1], scheme)).unwrap().save();
    let mut larger = Simulation::new(impact([6, 4, 1], scheme)).unwrap();
    assert_eq!(
        larger.restore(&saved).unwrap_err().to_string(),
        "the saved state does not fit this case: position has 60 numbers, this case has 72"
    );
    let mut elastic = Simulation::new({
        let mut model = model([5, 4, 1], crate::testing::elastic(), scheme);
        model.obstacles = impact([5, 4, 1], scheme).obstacles;
        model
    })
    .unwrap();
    assert_eq!(
        elastic.restore(&saved).unwrap_err().to_string(),
        "the saved state does not fit this case: history_0 belongs to another material or resolution"
    );
    let mut incomplete = saved.clone();
    incomplete.arrays.retain(|(name, _)| name != "cofactor");
    let mut same = Simulation::new(impact([5, 4, 1], scheme)).unwrap();
    assert_eq!(
        same.restore(&incomplete).unwrap_err().to_string(),
        "the saved state does not fit this case: cofactor is missing"
    );
}
