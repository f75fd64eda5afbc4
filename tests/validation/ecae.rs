//! Equal channel angular extrusion at the paper's coarsest resolution, to the end. Theory: a turn by
//! a right angle shears by an equivalent strain of 2/√3 = 1.155 (Segal 1995).

use jstsph_geometry::inverted_cells;

use crate::{assert_within, run};

#[test]
fn the_billet_goes_round_both_turns_inside_the_die() {
    let finished = run("ecae", &[("body.billet.lattice.counts", "[4, 22]")]);
    let simulation = &finished.simulation;
    let body = &simulation.reference().bodies[0];
    let position = &simulation.state().position;

    let defects = inverted_cells(&body.body.cells, position);
    assert_eq!(defects.inverted, 0);

    let die = &finished.case.model.obstacles[0].obstacle.surface;
    let deepest = position
        .iter()
        .map(|x| die.gap(x).distance)
        .fold(f64::INFINITY, f64::min);
    assert!(
        deepest > -1e-3 * body.spacing,
        "a particle is {deepest} m inside the die"
    );

    // Middle third of the middle channel. With four particles across the billet the median is 1.31; 216,
    // 400 and 640 particles give 1.18, 1.11 and 1.09 (docs/validation.md).
    let mut strains: Vec<f64> = position
        .iter()
        .zip(&finished.fields.equivalent_plastic_strain)
        .filter(|(x, _)| (16e-3..=24e-3).contains(&x.x))
        .map(|(_, strain)| *strain)
        .collect();
    strains.sort_by(f64::total_cmp);
    assert_within(
        "median strain after one turn",
        strains[strains.len() / 2],
        1.05..=1.35,
    );
    assert!(
        position.iter().any(|x| x.y < -5e-3),
        "the billet has left the second turn"
    );

    assert_eq!(finished.energies.numerical, 0.0);
    assert_eq!(finished.energies.hourglass, 0.0);
    assert_within("balance", finished.energies.balance(), -0.005..=0.005);
}
