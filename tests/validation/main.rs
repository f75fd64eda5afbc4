//! The shipped cases at resolutions that fit the default test command, against numbers with a
//! source. Each test runs the file that a user runs. The full-resolution table is in
//! docs/validation.md.

mod constrained_block;
mod ecae;
mod hot_compression;
mod l_shaped_block;
mod taylor_bar;
mod tensile_test;

use std::path::Path;

use jstsph_case::Case;
use jstsph_solver::{Energies, ParticleFields, Simulation};

/// A finished run of a shipped case.
struct Finished {
    simulation: Simulation,
    fields: ParticleFields,
    energies: Energies,
    case: Case,
}

impl Finished {
    /// First column of a probe.
    fn probe(&self, name: &str) -> f64 {
        let probe = self.case.probes.iter().find(|probe| probe.name == name);
        let probe = probe.unwrap_or_else(|| panic!("the case has no probe {name}"));
        self.simulation.probe(probe)[0]
    }

    fn largest_plastic_strain(&self) -> f64 {
        self.fields
            .equivalent_plastic_strain
            .iter()
            .copied()
            .fold(0.0, f64::max)
    }
}

/// Runs `cases/<name>.toml` with overrides to its end.
fn run(name: &str, overrides: &[(&str, &str)]) -> Finished {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../cases/{name}.toml"));
    let overrides: Vec<(String, String)> = overrides
        .iter()
        .map(|(key, value)| ((*key).into(), (*value).into()))
        .collect();
    let case = jstsph_case::load(&path, &overrides).unwrap_or_else(|error| panic!("{error}"));
    let end = case.time.end;
    let model = case.model.clone();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a thread pool");
    let simulation = pool.install(|| {
        let mut simulation = Simulation::new(model).unwrap_or_else(|error| panic!("{error}"));
        while simulation.time() < end {
            simulation
                .advance_step(end)
                .unwrap_or_else(|error| panic!("{error}"));
        }
        simulation
    });
    Finished {
        fields: simulation.particle_fields(),
        energies: simulation.energies(),
        simulation,
        case,
    }
}

/// Fails with the number and the range when it is outside.
#[track_caller]
fn assert_within(what: &str, value: f64, range: std::ops::RangeInclusive<f64>) {
    assert!(
        range.contains(&value),
        "{what} is {value:.6e}, expected {range:?}"
    );
}
