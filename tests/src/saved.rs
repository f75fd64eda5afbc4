//! Quantities of the evaluation points that only a saved state shows.

use jstsph_material::{History, PlasticHistory};
use jstsph_solver::Simulation;
use jstsph_tensor::Mat3;

/// First Piola-Kirchhoff stress of every evaluation point, Pa.
#[must_use]
pub fn first_piola_stress(simulation: &Simulation) -> Vec<Mat3> {
    array(simulation, "scaled_stress")
        .chunks_exact(9)
        .zip(simulation.reference().point_volume.iter())
        .map(|(scaled, volume)| Mat3::from_column_slice(scaled) / *volume)
        .collect()
}

/// Plastic history of every evaluation point of the first body.
#[must_use]
pub fn plastic_history(simulation: &Simulation) -> Vec<PlasticHistory> {
    array(simulation, "history_0")
        .chunks_exact(PlasticHistory::FIELDS.len())
        .map(PlasticHistory::read)
        .collect()
}

fn array(simulation: &Simulation, name: &str) -> Vec<f64> {
    let saved = simulation.save();
    let found = saved.arrays.into_iter().find(|(known, _)| known == name);
    found
        .unwrap_or_else(|| panic!("a saved state has no array {name}"))
        .1
}
