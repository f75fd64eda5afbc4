//! Parameters described once: the list shown to users, the units a reader converts from and the
//! range check all come from the same constant.

use crate::ParameterError;
use std::fmt;

/// A model or a law as the user selects it: its name, one line about it and its keys.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Description {
    /// Name in a case file, `snake_case`.
    pub name: &'static str,
    /// One line: what it is.
    pub summary: &'static str,
    /// Its keys, in the order in which they should be shown.
    pub keys: &'static [Key],
}

/// One key of a model's or a law's table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// Name in a case file, `snake_case`.
    pub name: &'static str,
    /// SI unit, `-` for a pure number and for a key that holds a choice.
    pub unit: &'static str,
    /// What it is, in one line.
    pub meaning: &'static str,
    /// Which values make sense.
    pub range: Range,
    /// Whether it may be left out; what that means is in `meaning`.
    pub optional: bool,
}

/// Which values a key may have. Infinite values and NaN are never allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Greater than zero.
    Positive,
    /// Zero or greater.
    NonNegative,
    /// Strictly between two values.
    Between {
        /// Excluded lower end.
        above: f64,
        /// Excluded upper end.
        below: f64,
    },
    /// Greater than zero, up to and including a value.
    PositiveUpTo {
        /// Included upper end.
        most: f64,
    },
    /// From zero up to and including a value.
    UpTo {
        /// Included upper end.
        most: f64,
    },
    /// Any number.
    Any,
    /// A list of numbers, each zero or greater, in ascending order; see the key's meaning.
    Ascending,
    /// A [`Property`](crate::Property): a number in this range, or a table of temperatures and as
    /// many values, each in this range.
    InTemperature(&'static Range),
    /// `true` or `false`.
    Flag,
    /// A table with these keys.
    Table(&'static [Key]),
    /// A table with exactly one of these names as its key, holding that choice's own keys.
    OneOf(&'static [Description]),
}

impl Range {
    /// Whether the number lies in the range; a key that holds no number contains none.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        value.is_finite()
            && match *self {
                Self::Positive => value > 0.0,
                Self::NonNegative | Self::Ascending => value >= 0.0,
                Self::Between { above, below } => above < value && value < below,
                Self::PositiveUpTo { most } => 0.0 < value && value <= most,
                Self::UpTo { most } => 0.0 <= value && value <= most,
                Self::Any => true,
                Self::InTemperature(range) => range.contains(value),
                Self::Flag | Self::Table(_) | Self::OneOf(_) => false,
            }
    }
}

impl Range {
    /// What each value of a table must be, and a single value too.
    #[must_use]
    pub fn of_values(self) -> Self {
        match self {
            Self::InTemperature(range) => *range,
            other => other,
        }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Positive => f.write_str("greater than 0"),
            Self::NonNegative => f.write_str("0 or greater"),
            Self::Between { above, below } => {
                write!(f, "greater than {above} and less than {below}")
            }
            Self::PositiveUpTo { most } => write!(f, "greater than 0 and at most {most}"),
            Self::UpTo { most } => write!(f, "at least 0 and at most {most}"),
            Self::Any => f.write_str("a number"),
            Self::InTemperature(range) => {
                write!(f, "{range}; or a table {{ temperatures, values }}")
            }
            Self::Flag => f.write_str("true or false"),
            Self::Table(keys) => {
                f.write_str("a table of ")?;
                for (i, key) in keys.iter().enumerate() {
                    write!(f, "{}{}", if i == 0 { "" } else { ", " }, key.name)?;
                }
                Ok(())
            }
            Self::Ascending => f.write_str("a list in ascending order, each 0 or greater"),
            Self::OneOf(choices) => {
                f.write_str("one of ")?;
                for (i, choice) in choices.iter().enumerate() {
                    write!(f, "{}{}", if i == 0 { "" } else { ", " }, choice.name)?;
                }
                Ok(())
            }
        }
    }
}

impl Key {
    /// Checks a value, given in the key's unit.
    ///
    /// # Errors
    /// [`ParameterError::OutOfRange`] with this key's name.
    pub fn check(&self, value: f64) -> Result<(), ParameterError> {
        if self.range.contains(value) {
            Ok(())
        } else {
            Err(ParameterError::OutOfRange {
                key: self.name.to_owned(),
                value,
                range: self.range.of_values(),
            })
        }
    }
}

/// Mass per reference volume.
pub(crate) const DENSITY: Key = Key {
    name: "density",
    unit: "kg/m^3",
    meaning: "mass per unit reference volume",
    range: Range::Positive,
    optional: false,
};

/// Young's modulus of the reference state.
pub(crate) const YOUNG_MODULUS: Key = Key {
    name: "young_modulus",
    unit: "Pa",
    meaning: "Young's modulus of small strains",
    range: Range::Positive,
    optional: false,
};

/// The same, which may depend on the temperature.
pub(crate) const YOUNG_MODULUS_IN_TEMPERATURE: Key = Key {
    range: Range::InTemperature(&YOUNG_MODULUS.range),
    ..YOUNG_MODULUS
};

/// Poisson's ratio of the reference state.
pub(crate) const POISSON_RATIO: Key = Key {
    name: "poisson_ratio",
    unit: "-",
    meaning: "Poisson's ratio of small strains",
    range: Range::Between {
        above: -1.0,
        below: 0.5,
    },
    optional: false,
};

/// The same, which may depend on the temperature.
pub(crate) const POISSON_RATIO_IN_TEMPERATURE: Key = Key {
    range: Range::InTemperature(&POISSON_RATIO.range),
    ..POISSON_RATIO
};

/// μ = E / (2 (1 + ν)), Pa.
#[inline]
pub(crate) fn shear_modulus(young_modulus: f64, poisson_ratio: f64) -> f64 {
    young_modulus / (2.0 * (1.0 + poisson_ratio))
}

/// κ = E / (3 (1 − 2 ν)), Pa.
#[inline]
pub(crate) fn bulk_modulus(young_modulus: f64, poisson_ratio: f64) -> f64 {
    young_modulus / (3.0 * (1.0 - 2.0 * poisson_ratio))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn not_a_number_and_the_ends_of_an_open_range_are_refused() {
        for value in [f64::NAN, f64::INFINITY, 0.5, -1.0] {
            assert!(POISSON_RATIO.check(value).is_err(), "{value}");
        }
        assert_eq!(POISSON_RATIO.check(0.49), Ok(()));
        assert_eq!(
            YOUNG_MODULUS.check(-70.0).unwrap_err().to_string(),
            "young_modulus = -70 is out of range: it must be greater than 0"
        );
    }

    #[test]
    fn moduli_of_copper() {
        // 117 GPa, 0.35: Greto & Kulasegaram 2019, Sect. 4.1; μ = 43.33 GPa, κ = 130 GPa by hand.
        assert!((shear_modulus(117e9, 0.35) - 117e9 / 2.7).abs() < 1.0);
        assert!((bulk_modulus(117e9, 0.35) - 130e9).abs() < 1.0);
    }
}
