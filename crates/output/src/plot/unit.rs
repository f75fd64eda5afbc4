//! Quantities with units, shown with a prefix that keeps numbers short.

/// A named quantity in SI units, for an axis or a colour bar.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Quantity {
    /// Name as shown.
    pub name: String,
    /// SI unit of the values; empty for a pure number.
    pub unit: String,
}

impl Quantity {
    /// A quantity.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            unit: unit.into(),
        }
    }

    /// The factor from the SI value to the shown one, and the label that tells it, for values up to
    /// `largest`: stresses in MPa, lengths in mm, other units with a power of ten where needed.
    pub(crate) fn shown(&self, largest: f64) -> (f64, String) {
        let exponent = exponent_of(largest);
        if TAKES_PREFIX.contains(&self.unit.as_str()) {
            let thousands = exponent.div_euclid(3).clamp(-4, 4);
            let prefix = PREFIXES[(thousands + 4) as usize];
            return (
                10_f64.powi(-3 * thousands),
                self.label(&format!("{prefix}{}", self.unit)),
            );
        }
        // Numbers of up to four digits before and three after the point need no power.
        if (-2..=3).contains(&exponent) {
            return (1.0, self.label(&self.unit));
        }
        let power = format!("10{} {}", superscript(exponent), self.unit);
        (10_f64.powi(-exponent), self.label(power.trim()))
    }

    /// The label without any scaling.
    pub(crate) fn plain(&self) -> String {
        self.label(&self.unit)
    }

    fn label(&self, unit: &str) -> String {
        if unit.is_empty() {
            self.name.clone()
        } else {
            format!("{} ({unit})", self.name)
        }
    }
}

/// Units that are usual with a prefix.
const TAKES_PREFIX: [&str; 10] = ["Pa", "J", "N", "s", "m", "W", "Hz", "J/m", "N/m", "W/m"];
const PREFIXES: [&str; 9] = ["p", "n", "µ", "m", "", "k", "M", "G", "T"];

/// Decimal exponent of a positive number, zero for zero.
pub(crate) fn exponent_of(value: f64) -> i32 {
    if value > 0.0 {
        // A little above, so that 1000 counts as such in spite of rounding.
        (value.log10() + 1e-9).floor() as i32
    } else {
        0
    }
}

/// An integer in superscript digits.
pub(crate) fn superscript(number: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    number
        .to_string()
        .chars()
        .map(|c| c.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize]))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(unit: &str, largest: f64) -> (f64, String) {
        Quantity::new("q", unit).shown(largest)
    }

    #[test]
    fn prefixes_keep_numbers_between_one_and_a_thousand() {
        assert_eq!(shown("Pa", 3.2e8), (1e-6, "q (MPa)".to_owned()));
        assert_eq!(shown("Pa", 1e9), (1e-9, "q (GPa)".to_owned()));
        assert_eq!(shown("m", 0.032), (1e3, "q (mm)".to_owned()));
        assert_eq!(shown("s", 8e-5), (1e6, "q (µs)".to_owned()));
        assert_eq!(shown("J", 0.0), (1.0, "q (J)".to_owned()));
        assert_eq!(shown("Pa", 1e30).1, "q (TPa)");
    }

    #[test]
    fn other_units_get_a_power_of_ten_only_where_needed() {
        assert_eq!(shown("", 2.5), (1.0, "q".to_owned()));
        assert_eq!(shown("m/s", 227.0), (1.0, "q (m/s)".to_owned()));
        assert_eq!(shown("1/s", 4.0e5), (1e-5, "q (10⁵ 1/s)".to_owned()));
        assert_eq!(shown("", 3e-4), (1e4, "q (10⁻⁴)".to_owned()));
    }
}
