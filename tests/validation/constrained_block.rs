//! Constrained block, half of its top pushed. Source of the mean strains: an independent
//! implementation of the particle scheme, 0.377 for 21 x 11 and 0.362 for 41 x 21, hence 0.36 to 0.39;
//! the largest strain belongs to a singular corner and does not converge.

use crate::{Finished, assert_within, run};

/// Runs to 15 ms and checks the balance, as a fraction of the work done.
fn block(counts: &str, more: &[(&str, &str)]) -> Finished {
    let mut overrides = vec![("body.block.lattice.counts", counts), ("time.end", "15 ms")];
    overrides.extend(more);
    let finished = run("constrained-block", &overrides);
    let balance = finished.energies.error() / finished.energies.external;
    assert_within("balance", balance, -1e-3..=1e-3);
    finished
}

#[test]
fn particles_give_the_mean_plastic_strain_of_the_reference() {
    let particles = [
        ("scheme.quadrature", "particles"),
        ("scheme.smoothing_ratio", "1.2"),
        ("stabilisation.upwind", "0.15"),
        ("time.cfl", "0.6"),
    ];
    for counts in ["[21, 11]", "[41, 21]"] {
        let finished = block(counts, &particles);
        assert_within(counts, finished.probe("mean_plastic_strain"), 0.36..=0.39);
    }
}

/// Known deviation: bonds are stiffer around the corner of the punch and come down to the range from
/// above: 0.416, 0.403, 0.391 for 21 x 11, 41 x 21, 81 x 41 nodes (docs/validation.md). The test fails when
/// that changes, for better or worse.
#[test]
fn bonds_approach_the_mean_plastic_strain_from_above() {
    for (counts, measured) in [("[21, 11]", 0.416), ("[41, 21]", 0.403)] {
        let finished = block(counts, &[]);
        let range = measured - 0.002..=measured + 0.002;
        assert_within(counts, finished.probe("mean_plastic_strain"), range);
    }
}

#[test]
fn rollers_hold_and_the_punch_is_where_its_velocity_took_it() {
    let finished = block("[21, 11]", &[]);
    let (state, reference) = (finished.simulation.state(), finished.simulation.reference());
    for (x, start) in state.position.iter().zip(reference.position.iter()) {
        if start.x == 0.0 || start.x == 1.0 {
            assert_eq!(x.x, start.x);
        }
        if start.y == 0.0 {
            assert_eq!(x.y, 0.0);
        }
        if start.y == 0.5 && start.x >= 0.5 {
            // -10 m/s over 15 ms; round-off of thousands of steps.
            assert!((x.y - 0.35).abs() < 1e-12, "{x}");
        }
    }
}
