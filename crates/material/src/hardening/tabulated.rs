//! A measured curve.

use super::{FlowState, FlowStress, HardeningLaw};
use crate::{Key, ParameterError, Range};
use serde::{Deserialize, Serialize};

/// σ_Y through measured points: linear between them, constant before the first and after the last.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Tabulated {
    /// ε_p of the points, strictly ascending, zero or positive.
    pub plastic_strain: Vec<f64>,
    /// σ_Y of the points, Pa, positive and never falling; as many as strains.
    pub flow_stress: Vec<f64>,
}

const PLASTIC_STRAIN: Key = Key {
    name: "plastic_strain",
    unit: "-",
    meaning: "equivalent plastic strains of the points, each greater than the one before",
    range: Range::Ascending,
    optional: false,
};
const FLOW_STRESS: Key = Key {
    name: "flow_stress",
    unit: "Pa",
    meaning: "flow stresses of the points, the first greater than 0, never falling; constant outside the table",
    range: Range::Ascending,
    optional: false,
};

impl HardeningLaw for Tabulated {
    const NAME: &'static str = "tabulated";
    const SUMMARY: &'static str = "piecewise linear through points (plastic_strain, flow_stress)";
    const KEYS: &'static [Key] = &[PLASTIC_STRAIN, FLOW_STRESS];

    fn validate(&self) -> Result<(), ParameterError> {
        if self.flow_stress.len() != self.plastic_strain.len() || self.flow_stress.is_empty() {
            return Err(ParameterError::Length {
                key: FLOW_STRESS.name.to_owned(),
                found: self.flow_stress.len(),
                other: PLASTIC_STRAIN.name,
                expected: self.plastic_strain.len(),
                least: 1,
            });
        }
        for &strain in &self.plastic_strain {
            PLASTIC_STRAIN.check(strain)?;
        }
        for &stress in &self.flow_stress {
            FLOW_STRESS.check(stress)?;
        }
        if self.flow_stress[0] == 0.0 {
            return Err(ParameterError::Order {
                key: FLOW_STRESS.name.to_owned(),
                value: 0.0,
                relation: "greater than",
                bound: 0.0,
                reason: "a metal without initial strength has no elastic range",
            });
        }
        for pair in self.plastic_strain.windows(2) {
            if pair[1] <= pair[0] {
                return Err(ParameterError::Order {
                    key: PLASTIC_STRAIN.name.to_owned(),
                    value: pair[1],
                    relation: "greater than",
                    bound: pair[0],
                    reason: "sort the points by strain, and give each strain once",
                });
            }
        }
        for pair in self.flow_stress.windows(2) {
            if pair[1] < pair[0] {
                return Err(ParameterError::Order {
                    key: FLOW_STRESS.name.to_owned(),
                    value: pair[1],
                    relation: "at least",
                    bound: pair[0],
                    reason: "a falling curve would soften, which depends on the spacing",
                });
            }
        }
        Ok(())
    }

    #[inline]
    fn flow_stress(&self, at: &FlowState) -> FlowStress {
        let (strains, stresses) = (&self.plastic_strain[..], &self.flow_stress[..]);
        let after = strains.partition_point(|&strain| strain <= at.plastic_strain);
        if after == 0 || after == strains.len() {
            return FlowStress::rate_independent(stresses[after.saturating_sub(1)], 0.0);
        }
        let slope = (stresses[after] - stresses[after - 1]) / (strains[after] - strains[after - 1]);
        FlowStress::rate_independent(
            stresses[after - 1] + slope * (at.plastic_strain - strains[after - 1]),
            slope,
        )
    }

    fn examples() -> Vec<Self> {
        vec![Self {
            plastic_strain: vec![0.0, 0.05, 0.2, 1.0],
            flow_stress: vec![0.3e9, 0.36e9, 0.42e9, 0.5e9],
        }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_met_and_the_ends_are_constant() {
        let at = |plastic_strain| FlowState {
            plastic_strain,
            rate: 0.0,
            temperature: crate::ROOM_TEMPERATURE,
        };
        let law = &Tabulated::examples()[0];
        for (strain, stress) in [
            (0.0, 0.3e9),
            (0.05, 0.36e9),
            (0.125, 0.39e9),
            (1.0, 0.5e9),
            (7.0, 0.5e9),
        ] {
            assert!(
                (law.flow_stress(&at(strain)).value - stress).abs() < 1e-6 * stress,
                "{strain}"
            );
        }
        let late = Tabulated {
            plastic_strain: vec![0.1, 0.2],
            flow_stress: vec![1e8, 2e8],
        };
        assert_eq!(
            late.flow_stress(&at(0.0)),
            FlowStress::rate_independent(1e8, 0.0)
        );
    }

    #[test]
    fn tables_that_are_no_curve_are_refused_with_the_key() {
        let table = |strain: &[f64], stress: &[f64]| {
            Tabulated {
                plastic_strain: strain.to_vec(),
                flow_stress: stress.to_vec(),
            }
            .validate()
            .map_err(|error| error.key().to_owned())
        };
        assert_eq!(table(&[0.0, 0.1], &[1e8, 1e8]), Ok(()));
        assert_eq!(table(&[], &[]), Err("flow_stress".into()));
        assert_eq!(table(&[0.0, 0.1], &[1e8]), Err("flow_stress".into()));
        assert_eq!(
            table(&[0.0, 0.0], &[1e8, 2e8]),
            Err("plastic_strain".into())
        );
        assert_eq!(table(&[0.0, 0.1], &[2e8, 1e8]), Err("flow_stress".into()));
        assert_eq!(table(&[0.0, 0.1], &[0.0, 1e8]), Err("flow_stress".into()));
        assert_eq!(
            table(&[0.0, f64::NAN], &[1e8, 2e8]),
            Err("plastic_strain".into())
        );
    }
}
