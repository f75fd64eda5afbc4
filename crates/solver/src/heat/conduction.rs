//! Heat conduction inside one body, conservative to round-off.

use std::sync::Arc;

use jstsph_material::Property;
use jstsph_sph::{GradientOperator, Support};
use jstsph_tensor::{Vec3, cofactor};

use crate::model::{ModelBody, Quadrature};
use crate::reference::BodyReference;
use crate::state::Deformation;
use crate::{SolverError, parallel};

/// How heat flows between the particles of one body: through the midpoints of its bonds, with the
/// conductivity of the deformed body,
///
/// ```text
///   g_q = Σ_c T_c B_qc ,   K_q = k Hᵀ H / J = J k F⁻¹ F⁻ᵀ                    [eq:conduction]
///   V_c ρ c dT_c/dt = −Σ_q V_q (K_q g_q) · B_qc
/// ```
///
/// the weak form with the operator of the internal force. Σ_c B_qc = 0 makes the total heat exact; the form
/// Σ_q V_q g · K g ≥ 0 only ever evens temperatures out, and a bond sees every difference of its ends.
#[derive(Clone, Debug)]
pub(crate) struct Conduction {
    /// The operator, where the evaluation points of the body are not the bonds already.
    operator: Option<GradientOperator>,
    /// Particles at the ends of each bond.
    ends: Arc<Vec<[u32; 2]>>,
    /// Volumes of the bonds, m³.
    volume: Arc<Vec<f64>>,
}

/// State of a body as conduction sees it.
#[derive(Clone, Copy)]
pub(crate) struct Conductor<'a> {
    pub(crate) body: &'a BodyReference,
    pub(crate) quadrature: Quadrature,
    pub(crate) temperature: &'a [f64],
    pub(crate) deformation: Deformation<'a>,
    pub(crate) volume: &'a [f64],
    pub(crate) conductivity: &'a Property,
}

impl Conduction {
    /// The operators of one body.
    pub(crate) fn new(
        input: &ModelBody,
        body: &BodyReference,
        quadrature: Quadrature,
    ) -> Result<Self, SolverError> {
        let failed = |source| SolverError::Operator {
            body: input.name.clone(),
            source,
        };
        let positions = &input.body.positions;
        let support = Support {
            smoothing_length: body.support.smoothing_length.max(input.body.spacing),
            ..body.support
        };
        let bonds = &input.body.bonds;
        let operator = match quadrature {
            Quadrature::Bonds => None,
            Quadrature::Particles => {
                let midpoints = bonds.midpoints(positions);
                Some(
                    GradientOperator::at_points(&midpoints, positions, &body.support)
                        .or_else(|_| GradientOperator::at_points(&midpoints, positions, &support))
                        .map_err(failed)?,
                )
            }
        };
        Ok(Self {
            operator,
            ends: bonds.ends.clone(),
            volume: bonds.volumes.clone(),
        })
    }

    /// Number of points through which heat flows.
    pub(crate) fn points(&self) -> usize {
        self.ends.len()
    }

    /// Upper bound of the fastest rate of the undeformed body per unit of k/(ρ c), 1/m² (Gershgorin).
    pub(crate) fn spectral_bound(&self, body: &BodyReference, particle_volume: &[f64]) -> f64 {
        let operator = self.operator.as_ref().unwrap_or(&body.gradient);
        let norm = |w: &[f64; 3]| Vec3::from(*w).norm();
        let sums: Vec<f64> = (0..operator.points())
            .map(|q| operator.row(q).weights.iter().map(norm).sum())
            .collect();
        (0..operator.particles())
            .map(|c| {
                let row = operator
                    .column(c)
                    .entries()
                    .fold(0.0, |sum, (q, w)| sum + self.volume[q] * norm(w) * sums[q]);
                row / particle_volume[c]
            })
            .fold(0.0, f64::max)
    }

    /// Heat that flows into every particle, W per m³ of reference volume. `flux` is a buffer with
    /// [`points`](Self::points) entries.
    pub(crate) fn rate(&self, of: Conductor<'_>, flux: &mut [Vec3], out: &mut [f64]) {
        let operator = self.operator.as_ref().unwrap_or(&of.body.gradient);
        parallel::fill(flux, |q| {
            let [a, b] = self.ends[q].map(|end| end as usize);
            let mean = 0.5 * (of.temperature[a] + of.temperature[b]);
            let gradient = operator.scalar_gradient_at(q, of.temperature);
            let (h, jacobian) = match of.quadrature {
                Quadrature::Bonds => of.deformation.cofactor_and_determinant(q),
                Quadrature::Particles => {
                    let gradient = of.deformation.gradient;
                    let f = (gradient[a] + gradient[b]) * 0.5;
                    (cofactor(&f), f.determinant())
                }
            };
            let spatial = h * gradient;
            (h.transpose() * spatial) * (self.volume[q] * of.conductivity.at(mean) / jacobian)
        });
        let flux: &[Vec3] = flux;
        parallel::fill(out, |c| {
            -operator.scalar_divergence_at(c, flux) / of.volume[c]
        });
    }
}
