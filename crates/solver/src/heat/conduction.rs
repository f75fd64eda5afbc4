//! Heat conduction inside one body, conservative to round-off.

use jstsph_material::Property;
use jstsph_sph::{GradientOperator, PairOperator, Support};
use jstsph_tensor::{Mat3, Vec3, cofactor, double_dot};

use crate::model::{ModelBody, Quadrature};
use crate::reference::BodyReference;
use crate::{SolverError, parallel};

/// How heat flows between the particles of one body.
#[derive(Clone, Debug)]
pub(crate) enum Conduction {
    /// Not at all.
    None,
    /// Through the midpoints of the lattice bonds, with the conductivity of the deformed body:
    ///
    /// ```text
    ///   g_q = Σ_c T_c B_qc ,   K_q = k Hᵀ H / J = J k F⁻¹ F⁻ᵀ                    [eq:conduction]
    ///   V_c ρ c dT_c/dt = −Σ_q V_q (K_q g_q) · B_qc
    /// ```
    ///
    /// the weak form with the operator of the internal force. Σ_c B_qc = 0 makes the total heat
    /// exact; the form Σ_q V_q g · K g ≥ 0 only ever evens temperatures out, and a bond sees
    /// every difference of its ends.
    Points {
        /// The operator, where the evaluation points of the body are not the bonds already.
        operator: Option<GradientOperator>,
        /// Particles at the ends of each bond.
        ends: Vec<[u32; 2]>,
        /// Volumes of the bonds, m³.
        volume: Vec<f64>,
    },
    /// Between pairs of particles in the reference configuration, for bodies without bonds:
    ///
    /// ```text
    ///   ρ c dT_a/dt = Σ_b V_b k_ab w_ab (T_b − T_a) ,   k_ab = 2 k_a k_b / (k_a + k_b)  [eq:pair-conduction]
    /// ```
    ///
    /// Conserves heat pair by pair; the deformation does not change the conductivity.
    Pairs(PairOperator),
}

/// State of a body as conduction sees it.
#[derive(Clone, Copy)]
pub(crate) struct Conductor<'a> {
    pub(crate) body: &'a BodyReference,
    pub(crate) quadrature: Quadrature,
    pub(crate) temperature: &'a [f64],
    pub(crate) deformation_gradient: &'a [Mat3],
    pub(crate) cofactor: &'a [Mat3],
    pub(crate) volume: &'a [f64],
    pub(crate) conductivity: &'a Property,
}

impl Conduction {
    /// The operators of one body. `volume` are the volumes of its particles.
    pub(crate) fn new(
        input: &ModelBody,
        body: &BodyReference,
        quadrature: Quadrature,
        volume: &[f64],
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
        Ok(match &input.body.bonds {
            Some(bonds) => Self::Points {
                operator: match quadrature {
                    Quadrature::Bonds => None,
                    Quadrature::Particles => Some(
                        GradientOperator::at_points(&bonds.midpoints, positions, &body.support)
                            .or_else(|_| {
                                GradientOperator::at_points(&bonds.midpoints, positions, &support)
                            })
                            .map_err(failed)?,
                    ),
                },
                ends: bonds.ends.clone(),
                volume: bonds.volumes.clone(),
            },
            None => {
                Self::Pairs(PairOperator::symmetric(positions, volume, &support).map_err(failed)?)
            }
        })
    }

    /// Number of points through which heat flows.
    pub(crate) fn points(&self) -> usize {
        match self {
            Self::Points { ends, .. } => ends.len(),
            _ => 0,
        }
    }

    /// Upper bound of the fastest rate of the undeformed body per unit of k/(ρ c), 1/m² (Gershgorin).
    pub(crate) fn spectral_bound(&self, body: &BodyReference, particle_volume: &[f64]) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Pairs(pairs) => pairs.spectral_bound(),
            Self::Points {
                operator, volume, ..
            } => {
                let operator = operator.as_ref().unwrap_or(&body.gradient);
                let norm = |w: &[f64; 3]| Vec3::from(*w).norm();
                let sums: Vec<f64> = (0..operator.points())
                    .map(|q| operator.row(q).weights.iter().map(norm).sum())
                    .collect();
                (0..operator.particles())
                    .map(|c| {
                        let row = operator
                            .column(c)
                            .entries()
                            .fold(0.0, |sum, (q, w)| sum + volume[q] * norm(w) * sums[q]);
                        row / particle_volume[c]
                    })
                    .fold(0.0, f64::max)
            }
        }
    }

    /// Heat that flows into every particle, W per m³ of reference volume. `flux` is a buffer with
    /// [`points`](Self::points) entries.
    pub(crate) fn rate(&self, of: Conductor<'_>, flux: &mut [Vec3], out: &mut [f64]) {
        match self {
            Self::None => out.fill(0.0),
            Self::Pairs(pairs) => {
                let temperature = of.temperature;
                parallel::fill(out, |a| {
                    let own = of.conductivity.at(temperature[a]);
                    pairs.row(a).entries().fold(0.0, |sum, (b, w)| {
                        let other = of.conductivity.at(temperature[b]);
                        let mean = if own + other > 0.0 {
                            2.0 * own * other / (own + other)
                        } else {
                            0.0
                        };
                        sum + mean * w * (temperature[b] - temperature[a])
                    })
                });
            }
            Self::Points {
                operator,
                ends,
                volume,
            } => {
                let operator = operator.as_ref().unwrap_or(&of.body.gradient);
                parallel::fill(flux, |q| {
                    let [a, b] = ends[q].map(|end| end as usize);
                    let mean = 0.5 * (of.temperature[a] + of.temperature[b]);
                    let gradient = operator.scalar_gradient_at(q, of.temperature);
                    let (h, jacobian) = match of.quadrature {
                        Quadrature::Bonds => {
                            let h = of.cofactor[q];
                            (h, double_dot(&h, &of.deformation_gradient[q]) / 3.0)
                        }
                        Quadrature::Particles => {
                            let f = (of.deformation_gradient[a] + of.deformation_gradient[b]) * 0.5;
                            (cofactor(&f), f.determinant())
                        }
                    };
                    let spatial = h * gradient;
                    (h.transpose() * spatial) * (volume[q] * of.conductivity.at(mean) / jacobian)
                });
                let flux: &[Vec3] = flux;
                parallel::fill(out, |c| {
                    -operator.scalar_divergence_at(c, flux) / of.volume[c]
                });
            }
        }
    }
}
