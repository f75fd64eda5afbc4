//! A strip that should stretch evenly: total Lagrangian kernels let it, Eulerian ones break it
//! (numerical fracture, e.g. Belytschko, Guo, Liu & Xiao, Int. J. Numer. Meth. Engng 48 (2000)).

use crate::{Finished, assert_within, run};

const COARSE: (&str, &str) = ("body.strip.lattice", "{ counts = [21, 6] }");
const VISCOSITY: (&str, &str) = (
    "stabilisation",
    "{ upwind = 0.0, hourglass = 0.05, viscosity = {} }",
);
const NODAL: (&str, &str) = ("scheme.quadrature", "\"particles\"");

/// Largest present distance of two neighbours along the strip over that of an even stretch.
fn largest_gap(finished: &Finished) -> f64 {
    let reference = finished.simulation.reference();
    let body = &finished.case.model.bodies[0].body;
    let position = &finished.simulation.state().position;
    let stretch = finished.probe("length") / 40e-3;
    let bonds = &body.bonds;
    bonds
        .ends
        .iter()
        .zip(&bonds.directions)
        .filter(|(_, direction)| **direction == 0)
        .map(|([a, b], _)| {
            let [a, b] = [*a as usize, *b as usize];
            let before = reference.position[b].x - reference.position[a].x;
            (position[b].x - position[a].x) / (before * stretch)
        })
        .fold(0.0, f64::max)
}

#[test]
fn total_lagrangian_kernels_stretch_the_strip_evenly() {
    let displacement = ("scheme.formulation", "\"displacement\"");
    for overrides in [vec![COARSE], vec![COARSE, NODAL, VISCOSITY, displacement]] {
        let finished = run("tensile-test", &overrides);
        // ln 1.5875 in plane strain is an equivalent strain of 2/√3 of it, less the elastic part.
        let expected = 2.0 / 3f64.sqrt() * (63.5f64 / 40.0).ln();
        let range = 0.95 * expected..=1.02 * expected;
        assert_within(
            "smallest strain",
            finished.probe("smallest_plastic_strain"),
            range.clone(),
        );
        assert_within(
            "largest strain",
            finished.probe("largest_plastic_strain"),
            range,
        );
        assert_within("largest gap", largest_gap(&finished), 0.99..=1.02);
        assert_within("balance", finished.energies.balance(), -1e-3..=1e-3);
    }
}

#[test]
fn eulerian_kernels_break_the_strip() {
    let eulerian = ("scheme.formulation", "\"eulerian-kernel\"");
    let viscosity = ("stabilisation", "{ viscosity = {} }");
    let finished = run("tensile-test", &[COARSE, NODAL, viscosity, eulerian]);
    assert!(
        largest_gap(&finished) > 3.0,
        "the gap is {:.2} mean distances",
        largest_gap(&finished)
    );
    assert!(finished.probe("smallest_plastic_strain") < 0.1);
}
