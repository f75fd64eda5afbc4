//! Heat capacity, conductivity and what couples heat to deformation: `[eq:thermal-energy]`.

use crate::ParameterError;
use crate::parameter::{Key, Range};
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
            } => interpolated(temperatures, values, temperature),
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

    /// Slope in T at `temperature`, per kelvin; at a corner of the table that of the piece above, zero
    /// outside the table.
    #[must_use]
    pub fn slope(&self, temperature: f64) -> f64 {
        match self {
            Self::Constant(_) => 0.0,
            Self::Table {
                temperatures,
                values,
            } => {
                let next = temperatures.partition_point(|t| *t <= temperature);
                if next == 0 || next == temperatures.len() {
                    0.0
                } else {
                    (values[next] - values[next - 1])
                        / (temperatures[next] - temperatures[next - 1])
                }
            }
        }
    }

    /// Checks the values against the key's range, and that a table is one.
    ///
    /// # Errors
    /// The key, or the list of the table, that cannot be used.
    pub(crate) fn check(&self, key: &Key) -> Result<(), ParameterError> {
        let (temperatures, values) = match self {
            Self::Constant(value) => return key.check(*value),
            Self::Table {
                temperatures,
                values,
            } => (temperatures, values),
        };
        let list = |name: &str| format!("{}.{name}", key.name);
        if temperatures.len() != values.len() || values.len() < 2 {
            return Err(ParameterError::Length {
                key: list("values"),
                found: values.len(),
                other: "temperatures",
                expected: temperatures.len(),
                least: 2,
            });
        }
        for &temperature in temperatures {
            TEMPERATURES
                .check(temperature)
                .map_err(|error| error.within(key.name))?;
        }
        for &value in values {
            if !key.range.contains(value) {
                return Err(ParameterError::OutOfRange {
                    key: list("values"),
                    value,
                    range: key.range.of_values(),
                });
            }
        }
        for pair in temperatures.windows(2) {
            if pair[1] <= pair[0] {
                return Err(ParameterError::Order {
                    key: list("temperatures"),
                    value: pair[1],
                    relation: "greater than",
                    bound: pair[0],
                    reason: "sort the table by temperature, and give each once",
                });
            }
        }
        Ok(())
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

/// Apart, so that constants cost the stress loop no more than a comparison.
#[inline(never)]
fn interpolated(temperatures: &[f64], values: &[f64], temperature: f64) -> f64 {
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

impl From<f64> for Property {
    fn from(value: f64) -> Self {
        Self::Constant(value)
    }
}

/// The temperatures of a table.
const TEMPERATURES: Key = Key {
    name: "temperatures",
    unit: "K",
    meaning: "temperatures of the table, each greater than the one before",
    range: Range::Positive,
    optional: false,
};

const HEAT_CAPACITY: Key = Key {
    name: "heat_capacity",
    unit: "J/kg/K",
    meaning: "specific heat",
    range: Range::InTemperature(&Range::Positive),
    optional: false,
};
const CONDUCTIVITY: Key = Key {
    name: "conductivity",
    unit: "W/m/K",
    meaning: "thermal conductivity",
    range: Range::InTemperature(&Range::NonNegative),
    optional: false,
};
const TAYLOR_QUINNEY: Key = Key {
    name: "taylor_quinney",
    unit: "-",
    meaning: "share of the plastic work that becomes heat",
    range: Range::UpTo { most: 1.0 },
    optional: false,
};
const EXPANSION: Key = Key {
    name: "expansion",
    unit: "1/K",
    meaning: "linear thermal expansion",
    range: Range::NonNegative,
    optional: false,
};
const REFERENCE_TEMPERATURE: Key = Key {
    name: "reference_temperature",
    unit: "K",
    meaning: "temperature at which the undeformed body is free of stress",
    range: Range::Positive,
    optional: false,
};

/// The optional table of a model with thermal properties.
pub(crate) const THERMAL: Key = Key {
    name: "thermal",
    unit: "-",
    meaning: "thermal properties; without them a body keeps its temperature and does not expand",
    range: Range::Table(&[
        HEAT_CAPACITY,
        CONDUCTIVITY,
        TAYLOR_QUINNEY,
        EXPANSION,
        REFERENCE_TEMPERATURE,
    ]),
    optional: true,
};

impl Thermal {
    /// Checks the values.
    ///
    /// # Errors
    /// The first key whose value cannot be used, as `thermal.<key>`.
    pub fn validate(&self) -> Result<(), ParameterError> {
        self.check().map_err(|error| error.within(THERMAL.name))
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.heat_capacity.check(&HEAT_CAPACITY)?;
        self.conductivity.check(&CONDUCTIVITY)?;
        TAYLOR_QUINNEY.check(self.taylor_quinney)?;
        EXPANSION.check(self.expansion)?;
        REFERENCE_TEMPERATURE.check(self.reference_temperature)
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
