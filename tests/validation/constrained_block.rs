//! Constrained block, half of its top pushed. Source of the mean strains: an independent prototype of the
//! particle scheme, 0.377 for 21 x 11 and 0.362 for 41 x 21; the largest strain belongs to a singular
//! corner and does not converge.

use crate::{assert_within, run};

fn block(counts: &str) -> crate::Finished {
    run(
        "constrained-block",
        &[("body.block.lattice.counts", counts), ("time.end", "15 ms")],
    )
}

#[test]
fn mean_plastic_strain_at_15_ms_hardly_depends_on_the_resolution() {
    for counts in ["[21, 11]", "[41, 21]"] {
        let finished = block(counts);
        assert_within(counts, finished.probe("mean_plastic_strain"), 0.36..=0.39);
        // Of the work done.
        let balance = finished.energies.error() / finished.energies.external;
        assert_within("balance", balance, -1e-3..=1e-3);
    }
}

#[test]
fn rollers_hold_and_the_punch_is_where_its_velocity_took_it() {
    let finished = block("[21, 11]");
    let (state, reference) = (finished.simulation.state(), finished.simulation.reference());
    for (x, start) in state.position.iter().zip(&reference.position) {
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
