//! Comparison of a run with an exact solution of linear elasticity.

use std::f64::consts::PI;

use jstsph_solver::{Model, Simulation};
use jstsph_tensor::{Mat3, Vec3};

use crate::setup;

/// Field of a standing wave in space: a function of the reference position.
pub type Shape<T> = Box<dyn Fn(&Vec3) -> T>;

/// A standing wave u = U0 sin(ω t) S(X) of a linear elastic body, started by its velocity.
pub struct StandingWave {
    /// Set-up, with initial velocity U0 ω S(X).
    pub model: Model,
    /// U0, m.
    pub amplitude: f64,
    /// ω, 1/s.
    pub frequency: f64,
    /// S(X).
    pub shape: Shape<Vec3>,
    /// Cauchy stress of the displacement S(X), Pa per metre of amplitude.
    pub stress: Shape<Mat3>,
}

/// Relative L2 errors at the end of a run.
#[derive(Clone, Copy, Debug)]
pub struct Errors {
    /// Of the velocity, over the particles.
    pub velocity: f64,
    /// Of the first Piola-Kirchhoff stress, over the evaluation points.
    pub stress: f64,
}

impl Errors {
    /// As the row of a [`Study`](crate::Study) of [`ERRORS`].
    #[must_use]
    pub fn row(self) -> Vec<f64> {
        vec![self.velocity, self.stress]
    }
}

/// Columns of [`Errors::row`].
pub const ERRORS: [&str; 2] = ["velocity", "stress"];

impl StandingWave {
    /// Runs over `periods` and compares.
    #[must_use]
    pub fn errors_after(self, periods: f64) -> Errors {
        let end = periods * 2.0 * PI / self.frequency;
        let simulation = setup::run(self.model, end);
        let phase = self.frequency * end;
        let speed = self.amplitude * self.frequency * phase.cos();
        let displacement = self.amplitude * phase.sin();
        let reference = simulation.reference();
        Errors {
            velocity: relative_error(
                simulation
                    .particle_fields()
                    .velocity
                    .iter()
                    .zip(&reference.position)
                    .map(|(velocity, x)| (*velocity, (self.shape)(x) * speed)),
                &reference.volume,
            ),
            stress: relative_error(
                first_piola_stress(&simulation)
                    .into_iter()
                    .zip(&reference.point_position)
                    .map(|(stress, x)| (stress, (self.stress)(x) * displacement)),
                &reference.point_volume,
            ),
        }
    }
}

/// √(Σ V |computed − exact|² / Σ V |exact|²) over pairs (computed, exact).
fn relative_error<const COLUMNS: usize>(
    pairs: impl Iterator<Item = (Matrix<COLUMNS>, Matrix<COLUMNS>)>,
    volumes: &[f64],
) -> f64 {
    let (error, size) = pairs.zip(volumes).fold((0.0, 0.0), |(error, size), (pair, volume)| {
        (
            error + volume * (pair.0 - pair.1).norm_squared(),
            size + volume * pair.1.norm_squared(),
        )
    });
    (error / size).sqrt()
}

/// First Piola-Kirchhoff stress of every evaluation point, Pa, from the saved state.
///
/// # Panics
/// If the saved state has no stress.
#[must_use]
pub fn first_piola_stress(simulation: &Simulation) -> Vec<Mat3> {
    let saved = simulation.save();
    let (_, scaled) = saved
        .arrays
        .iter()
        .find(|(name, _)| name == "scaled_stress")
        .expect("V P is part of a saved state");
    scaled
        .chunks_exact(9)
        .zip(&simulation.reference().point_volume)
        .map(|(scaled, volume)| Mat3::from_column_slice(scaled) / *volume)
        .collect()
}
