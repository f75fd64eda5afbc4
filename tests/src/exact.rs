//! Comparison of a run with an exact solution of linear elasticity.

use std::f64::consts::PI;

use jstsph_solver::{Model, Simulation};
use jstsph_tensor::{Mat3, Vec3};

use crate::saved::first_piola_stress;
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
    fn run(&self, periods: f64) -> (Simulation, f64) {
        let phase = periods * 2.0 * PI;
        let end = phase / self.frequency;
        (setup::run(self.model.clone(), end), phase)
    }

    /// Relative L2 errors of the stress over the points for which `inside(X)` holds, and over the others.
    #[must_use]
    pub fn stress_errors_after(self, periods: f64, inside: impl Fn(&Vec3) -> bool) -> [f64; 2] {
        let (simulation, phase) = self.run(periods);
        let displacement = self.amplitude * phase.sin();
        let reference = simulation.reference();
        let stresses = first_piola_stress(&simulation);
        let points = reference.point_positions();
        [true, false].map(|wanted| {
            let squares = stresses.iter().zip(&points).map(|(stress, x)| {
                let exact = (self.stress)(x) * displacement;
                let chosen = f64::from(u8::from(inside(x) == wanted));
                (
                    chosen * (stress - exact).norm_squared(),
                    chosen * exact.norm_squared(),
                )
            });
            relative_error(squares, &reference.point_volume)
        })
    }

    /// Runs over `periods` and compares.
    #[must_use]
    pub fn errors_after(self, periods: f64) -> Errors {
        let (simulation, phase) = self.run(periods);
        let speed = self.amplitude * self.frequency * phase.cos();
        let displacement = self.amplitude * phase.sin();
        let reference = simulation.reference();
        let fields = simulation.particle_fields();
        let velocity =
            fields
                .velocity
                .iter()
                .zip(reference.position.iter())
                .map(|(velocity, x)| {
                    let exact = (self.shape)(x) * speed;
                    ((velocity - exact).norm_squared(), exact.norm_squared())
                });
        let stresses = first_piola_stress(&simulation);
        let points = reference.point_positions();
        let stress = stresses.iter().zip(&points).map(|(stress, x)| {
            let exact = (self.stress)(x) * displacement;
            ((stress - exact).norm_squared(), exact.norm_squared())
        });
        Errors {
            velocity: relative_error(velocity, &reference.volume),
            stress: relative_error(stress, &reference.point_volume),
        }
    }
}

/// √(Σ V |computed − exact|² / Σ V |exact|²) over squares (|computed − exact|², |exact|²).
fn relative_error(squares: impl Iterator<Item = (f64, f64)>, volumes: &[f64]) -> f64 {
    let (error, size) = squares
        .zip(volumes)
        .fold((0.0, 0.0), |(error, size), (square, volume)| {
            (error + volume * square.0, size + volume * square.1)
        });
    (error / size).sqrt()
}
