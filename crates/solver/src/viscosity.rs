//! Artificial viscosity of Monaghan 1992, pulled back to the reference configuration.

use jstsph_tensor::Vec3;

use crate::model::Viscosity;
use crate::parallel;
use crate::reference::Reference;
use crate::state::{State, Workspace};

/// Keeps the viscosity finite where two particles meet, as a fraction of h² (Monaghan 1992).
const SOFTENING: f64 = 0.01;

/// Adds the viscous force to the dissipation, N/m³, and writes the heat it makes, W/m³:
///
/// ```text
///   m_ab = h v_ab·x_ab / (|x_ab|² + 0.01 h²) ,   v_ab·x_ab < 0                  [eq:viscosity]
///   Π_ab = −α c m_ab + β m_ab² ≥ 0
///   f_a  = ρ Σ_b V_b Π_ab ½ w_ab |X_ab| x_ab/|x_ab| ,   heat_a = ½ ρ Σ_b V_b Π_ab ½ w_ab |X_ab| (−v_ab·x_ab)/|x_ab|
/// ```
///
/// with ½ w_ab |X_ab| = |grad W_ab| of the reference configuration and x_ab, v_ab the present
/// difference of the two. The force of a pair is opposite and along its line: both momenta are
/// exact, and it can only take energy. c is the pressure wave speed of the undeformed material.
pub(crate) fn add(
    viscosity: &Viscosity,
    reference: &Reference,
    state: &State,
    work: &mut Workspace,
) {
    for body in &reference.bodies {
        let Some(pairs) = &body.pairs else { continue };
        let range = body.particles.clone();
        let (momentum, position, start) = (
            &state.momentum[range.clone()],
            &state.position[range.clone()],
            &reference.position[range.clone()],
        );
        let h = body.support.smoothing_length.max(body.spacing);
        let law = PairViscosity {
            viscosity: *viscosity,
            wave_speed: body.wave_speed,
            smoothing_length: h,
        };
        let inverse_density = 1.0 / body.density;
        parallel::for_each_pair(
            &mut work.dissipation[range.clone()],
            &mut work.viscous_heating[range],
            |a, dissipation, heating| {
                let (mut force, mut power) = (Vec3::zeros(), 0.0);
                for (b, weight) in pairs.row(a).entries() {
                    let offset = position[a] - position[b];
                    let velocity = (momentum[a] - momentum[b]) * inverse_density;
                    let approach = velocity.dot(&offset);
                    if approach >= 0.0 {
                        continue;
                    }
                    let steepness = 0.5 * weight * (start[a] - start[b]).norm();
                    let scale = law.pressure(approach, &offset) * steepness / offset.norm();
                    force += offset * scale;
                    power -= 0.5 * scale * approach;
                }
                *dissipation += force * body.density;
                *heating = power * body.density;
            },
        );
    }
}

/// Π over ρ⁰: the viscous pressure of a pair per unit density, m²/s².
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairViscosity {
    pub(crate) viscosity: Viscosity,
    pub(crate) wave_speed: f64,
    pub(crate) smoothing_length: f64,
}

impl PairViscosity {
    /// −α c m + β m² for v·x < 0.
    #[inline]
    pub(crate) fn pressure(&self, approach: f64, offset: &Vec3) -> f64 {
        let h = self.smoothing_length;
        let m = h * approach / (offset.norm_squared() + SOFTENING * h * h);
        m * (self.viscosity.quadratic * m - self.viscosity.linear * self.wave_speed)
    }
}
