//! Expressions whose numbers carry units, with their dimensions checked: `2 * radius + 1 mm`.

use super::{Binary, Expression, ExpressionError, Parser, Term};
use crate::units::{CELSIUS, Measure, UnitError, ZERO_CELSIUS, parse_quantity};

/// A number in SI units and its dimension.
pub(crate) type Quantity = (f64, Measure);

impl Expression {
    /// Parses an expression whose numbers may be followed by a unit. Units are written without
    /// spaces: in `10 m/s` seconds are part of the unit, in `10 m / s` a variable `s` divides.
    pub(crate) fn parse_measured(text: &str, variables: &[&str]) -> Result<Self, ExpressionError> {
        Self::parse_with(text, variables, true)
    }

    /// Value and dimension for the given ones of the variables.
    ///
    /// # Errors
    /// A sentence about the first operation whose operands do not fit.
    pub(crate) fn measured(&self, values: &[Quantity]) -> Result<Quantity, String> {
        self.root.measured(values)
    }
}

impl Term {
    fn measured(&self, values: &[Quantity]) -> Result<Quantity, String> {
        match self {
            Self::Number(value) => Ok((*value, Measure::NUMBER)),
            Self::Quantity(value, measure) => Ok((*value, *measure)),
            Self::Celsius(value) => Ok((value + ZERO_CELSIUS, Measure::TEMPERATURE)),
            Self::Variable(index) => Ok(values[*index]),
            Self::Negative(term) => match **term {
                // A minus belongs to the reading of the thermometer, not to the kelvins.
                Self::Celsius(value) => Ok((ZERO_CELSIUS - value, Measure::TEMPERATURE)),
                _ => term.measured(values).map(|(value, of)| (-value, of)),
            },
            Self::Call((name, function), term) => {
                let (value, of) = term.measured(values)?;
                Ok((function(value), measure_of_call(name, of)?))
            }
            Self::CallTwo((name, function), a, b) => {
                let (a, b) = (a.measured(values)?, b.measured(values)?);
                same(
                    a.1,
                    b.1,
                    &format!("`{name}` needs two quantities of a kind, not"),
                )?;
                let of = if *name == "atan2" {
                    Measure::NUMBER
                } else {
                    a.1
                };
                Ok((function(a.0, b.0), of))
            }
            Self::Binary(operator, a, b) => {
                binary(*operator, a.measured(values)?, b.measured(values)?)
            }
        }
    }
}

fn binary(operator: Binary, a: Quantity, b: Quantity) -> Result<Quantity, String> {
    let beyond = || "the dimension of the result is beyond anything physical".to_owned();
    let of = match operator {
        Binary::Add => same(a.1, b.1, "cannot add"),
        Binary::Subtract => same(a.1, b.1, "cannot subtract"),
        Binary::Multiply => a.1.combine(b.1, 1).ok_or_else(beyond),
        Binary::Divide => a.1.combine(b.1, -1).ok_or_else(beyond),
        Binary::Power if b.1 != Measure::NUMBER => Err(format!(
            "an exponent must be a number without unit, not {}",
            b.1.description()
        )),
        Binary::Power if a.1 == Measure::NUMBER => Ok(Measure::NUMBER),
        Binary::Power => {
            let whole = (-9..=9).find(|power| f64::from(*power) == b.0);
            let power = whole.ok_or_else(|| {
                format!(
                    "{} can only be raised to a small whole power, not {}",
                    a.1.description(),
                    b.0
                )
            })?;
            Measure::NUMBER.combine(a.1, power).ok_or_else(beyond)
        }
    }?;
    let value = match operator {
        Binary::Add => a.0 + b.0,
        Binary::Subtract => a.0 - b.0,
        Binary::Multiply => a.0 * b.0,
        Binary::Divide => a.0 / b.0,
        Binary::Power => a.0.powf(b.0),
    };
    Ok((value, of))
}

fn same(a: Measure, b: Measure, what: &str) -> Result<Measure, String> {
    if a == b {
        return Ok(a);
    }
    Err(format!(
        "{what} {} and {}",
        a.description(),
        b.description()
    ))
}

fn measure_of_call(name: &str, of: Measure) -> Result<Measure, String> {
    let root = |degree| {
        of.root(degree)
            .ok_or_else(|| format!("`{name}` of {} has no unit", of.description()))
    };
    match name {
        "abs" => Ok(of),
        "sign" | "step" => Ok(Measure::NUMBER),
        "sqrt" => root(2),
        "cbrt" => root(3),
        _ if of == Measure::NUMBER => Ok(of),
        _ => Err(format!(
            "`{name}` needs a number without unit, not {}",
            of.description()
        )),
    }
}

impl Parser<'_> {
    /// The number ending before `end`, with the unit that follows it, if one does.
    pub(super) fn with_unit(
        &mut self,
        number: &str,
        end: usize,
    ) -> Result<Option<Term>, ExpressionError> {
        let after = |at: usize| self.characters.get(at).copied();
        let mut start = end;
        while after(start).is_some_and(char::is_whitespace) {
            start += 1;
        }
        let is_letter = |c: char| c.is_alphabetic() || matches!(c, '°' | '%');
        let is_inverse = after(start) == Some('1')
            && after(start + 1) == Some('/')
            && after(start + 2).is_some_and(is_letter);
        if !(is_inverse && start > end || after(start).is_some_and(is_letter)) {
            return Ok(None);
        }
        let mut stop = start;
        while let Some(c) = after(stop) {
            let is_sign = c == '-' && after(stop - 1) == Some('^');
            if !(is_letter(c)
                || c.is_ascii_digit()
                || matches!(c, '^' | '/' | '*' | '·' | '²' | '³' | '_')
                || (stop > start && is_sign))
            {
                break;
            }
            stop += 1;
        }
        while matches!(after(stop - 1), Some('/' | '*' | '·' | '^')) {
            stop -= 1;
        }
        let unit: String = self.characters[start..stop].iter().collect();
        self.at = start;
        if CELSIUS.contains(&unit.as_str()) {
            let value = number
                .parse()
                .map_err(|_| self.error(format!("`{number}` is not a number")))?;
            self.at = stop;
            return Ok(Some(Term::Celsius(value)));
        }
        let (value, measure) = parse_quantity(&format!("{number} {unit}")).map_err(|error| {
            self.error(match error {
                UnitError::UnknownUnit { symbol, .. } => format!(
                    "unknown unit `{symbol}`; what follows a number is its unit: write {number} * {symbol} \
                     to multiply, with spaces around the sign"
                ),
                other => other.to_string(),
            })
        })?;
        self.at = stop;
        Ok(Some(Term::Quantity(value, measure)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VARIABLES: [(&str, Quantity); 3] = [
        ("radius", (0.002, Measure::LENGTH)),
        ("speed", (10.0, Measure::VELOCITY)),
        ("n", (3.0, Measure::NUMBER)),
    ];

    fn value(text: &str) -> Result<Quantity, String> {
        let expression = Expression::parse_measured(text, &VARIABLES.map(|(name, _)| name))
            .map_err(|error| error.to_string())?;
        expression.measured(&VARIABLES.map(|(_, value)| value))
    }

    #[test]
    fn dimensions_follow_the_arithmetic() {
        for (text, expected, measure) in [
            ("2 * radius + 1 mm", 0.005, Measure::LENGTH),
            ("-speed", -10.0, Measure::VELOCITY),
            ("radius / speed", 2e-4, Measure::TIME),
            ("sqrt(radius^2)", 0.002, Measure::LENGTH),
            ("2*n", 6.0, Measure::NUMBER),
            ("10 m/s / radius", 5e3, Measure::RATE),
            ("3 1/s * 2 s", 6.0, Measure::NUMBER),
            ("7.8 g/cm^3", 7800.0, Measure::DENSITY),
            ("20 degC + 5 K", 298.15, Measure::TEMPERATURE),
            ("-20 degC", 253.14999999999998, Measure::TEMPERATURE),
            ("max(radius, 57.42 mm)", 0.05742, Measure::LENGTH),
            ("sin(90 deg)", 1.0, Measure::NUMBER),
            ("6 mm/(n - 1)", 0.003, Measure::LENGTH),
        ] {
            let (found, of) = value(text).expect(text);
            assert_eq!(of, measure, "{text}");
            // A few operations, each correctly rounded.
            assert!(
                (found - expected).abs() <= 1e-15 * expected.abs(),
                "{text}: {found}"
            );
        }
    }

    #[test]
    fn dimensions_that_do_not_fit_are_explained() {
        for (text, message) in [
            (
                "radius + speed",
                "cannot add a length (m, cm, mm, um) and a velocity",
            ),
            (
                "radius - 1",
                "cannot subtract a length (m, cm, mm, um) and a number without unit",
            ),
            (
                "sin(radius)",
                "`sin` needs a number without unit, not a length",
            ),
            ("sqrt(radius)", "`sqrt` of a length"),
            ("2^radius", "an exponent must be a number without unit"),
            ("radius^0.5", "small whole power, not 0.5"),
            ("min(radius, n)", "`min` needs two quantities of a kind"),
            (
                "2 radius",
                "unknown unit `radius`; what follows a number is its unit: write 2 * radius",
            ),
            ("2 mm*radius", "unknown unit `radius`"),
            (
                "((((((radius^9)^9)^9)^9)^9)^9)^9",
                "beyond anything physical",
            ),
        ] {
            let error = value(text).expect_err(text);
            assert!(error.contains(message), "{text}: {error}");
        }
    }
}
