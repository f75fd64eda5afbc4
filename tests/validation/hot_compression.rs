//! Hot compression of aluminium, after Ba & Gakwaya, against the closed form of homogeneous
//! compression with the law of Johnson & Cook.

use std::f64::consts::PI;

use jstsph_geometry::{Cells, inverted_cells};
use jstsph_material::hardening::{FlowState, Hardening};
use jstsph_material::{MaterialSpec, Thermal};

use crate::{Finished, assert_within, run};

const COARSE: (&str, &str) = ("body.billet.lattice", "{ per_radius = 4, layers = 9 }");

fn metal(finished: &Finished) -> (&Hardening, &Thermal, f64) {
    match &finished.case.model.bodies[0].material {
        MaterialSpec::HenckyVonMises(metal) => (
            &metal.hardening,
            metal.thermal.as_ref().expect("thermal properties"),
            metal.density,
        ),
        other => panic!("{} has no hardening law", other.name()),
    }
}

/// σ and T of homogeneous adiabatic compression at 2.54 mm/s from 25.4 mm to `height`.
///
/// A body that is free to expand has the heat capacity at constant pressure, c + 9 α² κ T/ρ, and an
/// elastic compression by the uniaxial stress σ warms it by α T σ/(ρ c) (Kelvin's formula).
fn closed_form(finished: &Finished, height: f64) -> (f64, f64) {
    let (hardening, thermal, density) = metal(finished);
    let capacity = thermal.heat_capacity.at(700.0);
    let bulk_modulus = 71.7e9 / (3.0 * (1.0 - 2.0 * 0.33));
    let (start, steps) = (25.4e-3, 20_000);
    let (mut temperature, mut stress) = (673.15, 0.0);
    let total = (start / height).ln();
    for step in 0..steps {
        let strain = total * (f64::from(step) + 0.5) / f64::from(steps);
        let rate = 2.54e-3 / (start * (-strain).exp());
        stress = hardening
            .flow_stress(&FlowState {
                plastic_strain: strain,
                rate,
                temperature,
            })
            .value;
        let capacity =
            capacity + 9.0 * thermal.expansion.powi(2) * bulk_modulus * temperature / density;
        temperature +=
            thermal.taylor_quinney * stress * total / f64::from(steps) / (density * capacity);
    }
    let kelvin = thermal.expansion * temperature * stress / (density * capacity);
    (stress, temperature + kelvin)
}

/// The frictionless axial compression is homogeneous: the force on the platen is that of the closed
/// form to 2 %, and the body heats up as it does.
#[test]
fn axial_compression_follows_johnson_and_cook() {
    for end in ["2.6 s", "5.1 s"] {
        let finished = run(
            "hot-compression-axial",
            &[COARSE, ("time.end", &format!("\"{end}\""))],
        );
        let height = finished.probe("height");
        let (stress, temperature) = closed_form(&finished, height);
        // The force at the end of a run is known from the stress of the points: true stress σ_zz.
        let volume = &finished.simulation.reference().volume;
        let total: f64 = volume.iter().sum();
        let mean = finished
            .fields
            .cauchy_stress
            .iter()
            .zip(volume)
            .map(|(stress, v)| -stress.m33 * v)
            .sum::<f64>()
            / total;
        assert_within(
            "true stress over that of the law",
            mean / stress,
            0.98..=1.02,
        );
        // The closed form leaves out the elastic strain (0.4 %) and the work of the expansion (1 %).
        let rise = (finished.probe("mean_temperature") - 673.15) / (temperature - 673.15);
        assert_within(
            "rise of temperature over that of the law",
            rise,
            0.97..=1.02,
        );
        // A cylinder stays one, of nearly its volume.
        let widths = finished.probe("top_width") / finished.probe("middle_width");
        assert_within("top over middle width", widths, 0.999..=1.001);
        let width = (4.0 * total / (PI * height)).sqrt();
        assert_within("width", finished.probe("top_width") / width, 0.995..=1.01);
        let energies = &finished.energies;
        assert_within("balance", energies.balance(), -1e-3..=1e-3);
        assert_within(
            "kinetic over plastic",
            energies.kinetic / energies.plastic,
            0.0..=0.01,
        );
    }
}

/// Friction holds the ends back: the middle becomes wider, and the more so the rougher the platens.
#[test]
fn rough_platens_make_a_barrel() {
    let mut before = 1.0;
    for friction in ["0.1", "0.3"] {
        let finished = run(
            "hot-compression-axial",
            &[
                COARSE,
                ("time.end", "\"3.6 s\""),
                ("obstacle.upper.friction", friction),
                ("obstacle.lower.friction", friction),
            ],
        );
        let barrel = finished.probe("middle_width") / finished.probe("top_width");
        assert!(
            barrel > before + 0.01,
            "friction {friction}: {barrel} after {before}"
        );
        before = barrel;
        assert_within("balance", finished.energies.balance(), -1e-3..=1e-3);
        assert!(finished.energies.friction > 0.0);
    }
}

/// The cylinder on its side is pressed to less than half: neighbours keep their distance and no
/// lattice cell turns inside out.
#[test]
fn lateral_compression_keeps_its_particles_apart() {
    let finished = run("hot-compression-lateral", &[COARSE]);
    assert_within(
        "height over diameter",
        finished.probe("height") / 25.4e-3,
        0.0..=0.5,
    );
    let body = &finished.case.model.bodies[0].body;
    let position = &finished.simulation.state().position;
    assert!(matches!(body.cells, Cells::Hexes(_)));
    assert_eq!(inverted_cells(&body.cells, position).inverted, 0);
    let bonds = &body.bonds;
    let closest = bonds
        .ends
        .iter()
        .map(|[a, b]| (position[*b as usize] - position[*a as usize]).norm() / body.spacing)
        .fold(f64::INFINITY, f64::min);
    // Vertical distances shrink to 0.48 on the mean, to less under the platens; paired particles
    // would be at a hundredth.
    assert_within("closest neighbours over the spacing", closest, 0.2..=0.5);
    assert_within("balance", finished.energies.balance(), -2e-3..=2e-3);
}
