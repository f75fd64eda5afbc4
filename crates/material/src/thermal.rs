//! Heat capacity, conductivity and what couples heat to deformation.

use serde::{Deserialize, Serialize};

/// A material property that may depend on the temperature.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(untagged)]
pub enum Property {
    /// The same at all temperatures.
    Constant(f64),
    /// Piecewise linear in T. Temperatures ascend strictly; both lists have the same length, two or
    /// more. Not defined outside: [`range`](Self::range).
    Table {
        /// T, K.
        temperatures: Vec<f64>,
        /// The property at these temperatures.
        values: Vec<f64>,
    },
}

impl Property {
    /// The property at `temperature`, K; outside its table the value at the table's end.
    #[inline]
    #[must_use]
    pub fn at(&self, temperature: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Table {
                temperatures,
                values,
            } => {
                let next = temperatures.partition_point(|t| *t <= temperature);
                if next == 0 {
                    values[0]
                } else if next == temperatures.len() {
                    values[next - 1]
                } else {
                    let (t0, t1) = (temperatures[next - 1], temperatures[next]);
                    let (v0, v1) = (values[next - 1], values[next]);
                    v0 + (v1 - v0) * (temperature - t0) / (t1 - t0)
                }
            }
        }
    }

    /// ∫ of the property from `from` to `to`, exact for the piecewise linear function.
    #[must_use]
    pub fn integral(&self, from: f64, to: f64) -> f64 {
        match self {
            Self::Constant(value) => value * (to - from),
            Self::Table { temperatures, .. } => {
                if to < from {
                    return -self.integral(to, from);
                }
                let mut total = 0.0;
                let mut start = from;
                for &knot in temperatures.iter().filter(|t| **t > from && **t < to) {
                    total += 0.5 * (self.at(start) + self.at(knot)) * (knot - start);
                    start = knot;
                }
                total + 0.5 * (self.at(start) + self.at(to)) * (to - start)
            }
        }
    }

    /// Temperatures between which the property is defined, K; `None` if everywhere.
    #[must_use]
    pub fn range(&self) -> Option<(f64, f64)> {
        match self {
            Self::Constant(_) => None,
            Self::Table { temperatures, .. } => {
                Some((*temperatures.first()?, *temperatures.last()?))
            }
        }
    }

    /// Smallest value it takes.
    #[must_use]
    pub fn smallest(&self) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Table { values, .. } => values.iter().copied().fold(f64::INFINITY, f64::min),
        }
    }

    /// Largest value it takes.
    #[must_use]
    pub fn largest(&self) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Table { values, .. } => values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        }
    }
}

/// Thermal properties of a material.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Thermal {
    /// c, J/(kg K), positive.
    pub heat_capacity: Property,
    /// k, W/(m K), zero or positive.
    pub conductivity: Property,
    /// β, the share of the plastic work that becomes heat (Taylor & Quinney 1934), from 0 to 1.
    pub taylor_quinney: f64,
    /// α, linear thermal expansion, 1/K.
    pub expansion: f64,
    /// Temperature at which the undeformed body is free of stress, K.
    pub reference_temperature: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Property {
        Property::Table {
            temperatures: vec![300.0, 400.0, 800.0],
            values: vec![10.0, 20.0, 0.0],
        }
    }

    #[test]
    fn table_is_linear_between_and_constant_outside_its_range() {
        for (temperature, value) in [
            (200.0, 10.0),
            (350.0, 15.0),
            (400.0, 20.0),
            (600.0, 10.0),
            (900.0, 0.0),
        ] {
            assert_eq!(table().at(temperature), value);
        }
        assert_eq!(table().range(), Some((300.0, 800.0)));
        assert_eq!((table().smallest(), table().largest()), (0.0, 20.0));
    }

    #[test]
    fn integral_is_that_of_the_piecewise_linear_function() {
        // Trapezia by hand: 200-300 constant, 300-400 mean 15, 400-600 mean 15.
        let expected = 10.0 * 100.0 + 15.0 * 100.0 + 15.0 * 200.0;
        assert!((table().integral(200.0, 600.0) - expected).abs() < 1e-9);
        assert!((table().integral(600.0, 200.0) + expected).abs() < 1e-9);
        assert_eq!(Property::Constant(3.0).integral(300.0, 302.0), 6.0);
    }
}
