//! L-shaped block: what must not change once the loads are gone, and the angular momentum they
//! leave, which no coarser or finer lattice changes by much.

use jstsph_solver::Simulation;
use jstsph_tensor::Vec3;

/// Runs the shipped case with a spacing and returns the angular momentum and the energy at the
/// first step after the loads and at the end, and the largest linear momentum.
fn fly(spacing: &str) -> ([Vec3; 2], [f64; 2], f64) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../cases/l-shaped-block.toml");
    let overrides = [("body.block.lattice.spacing".to_owned(), spacing.to_owned())];
    let case = jstsph_case::load(path.as_ref(), &overrides).unwrap_or_else(|e| panic!("{e}"));
    let mut simulation = Simulation::new(case.model).unwrap_or_else(|e| panic!("{e}"));
    let (mut angular, mut energy) = (None, None);
    let mut linear = 0.0_f64;
    let stored = |simulation: &Simulation| {
        let energies = simulation.energies();
        energies.kinetic + energies.elastic
    };
    while simulation.time() < case.time.end {
        simulation
            .advance_step(case.time.end)
            .unwrap_or_else(|error| panic!("{error}"));
        linear = linear.max(simulation.momenta().linear.norm());
        if simulation.time() > 5.1 {
            angular.get_or_insert(simulation.momenta().angular);
            energy.get_or_insert(stored(&simulation));
        }
    }
    let ends = |first: Option<Vec3>| [first.expect("5.1 s"), simulation.momenta().angular];
    let energies = [energy.expect("5.1 s"), stored(&simulation)];
    (ends(angular), energies, linear)
}

#[test]
fn a_free_block_keeps_both_momenta_and_its_energy() {
    let (angular, energy, linear) = fly("1.0");
    // 10^5 kg at metres per second: round-off of some hundred steps.
    assert!(linear < 1e-9, "{linear}");
    let change = (angular[1] - angular[0]).norm() / angular[0].norm();
    assert!(change < 1e-13, "{change}");
    // Leapfrog at CFL 0.5: measured 4.5e-4 with three intervals across a leg.
    assert!((energy[1] / energy[0] - 1.0).abs() < 1e-3, "{energy:?}");
}

/// Measured with 12 intervals across a leg: (201882, 114272, -143475) N m s. A block that neither
/// bent nor turned while it is loaded would get 6.25 s² × (-4.5, 8.5, 0) m × (1350, 2700, 4050) N/s
/// = (215156, 113906, -147656) N m s.
#[test]
fn the_angular_momentum_hardly_depends_on_the_lattice() {
    let fine = Vec3::new(201_882.0, 114_272.0, -143_475.0);
    let (angular, ..) = fly("1.0");
    assert!(
        (angular[1] - fine).norm() < 2e-3 * fine.norm(),
        "{}",
        angular[1]
    );
}
