//! Numbers with units: `"8 mm"`, `"69 GPa"`, `"2800 kg/m^3"` become SI values with a checked dimension.

use std::fmt;

/// Physical dimension of a quantity as exponents of metre, kilogram, second and kelvin.
///
/// Angles count as plain numbers (radians).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Measure {
    /// Exponent of the metre.
    pub length: i8,
    /// Exponent of the kilogram.
    pub mass: i8,
    /// Exponent of the second.
    pub time: i8,
    /// Exponent of the kelvin.
    pub temperature: i8,
}

impl Measure {
    /// A plain number or an angle.
    pub const NUMBER: Self = Self::of(0, 0, 0);
    /// Metre.
    pub const LENGTH: Self = Self::of(1, 0, 0);
    /// Second.
    pub const TIME: Self = Self::of(0, 0, 1);
    /// Metre per second.
    pub const VELOCITY: Self = Self::of(1, 0, -1);
    /// Metre per second squared.
    pub const ACCELERATION: Self = Self::of(1, 0, -2);
    /// Per second; also radians per second.
    pub const RATE: Self = Self::of(0, 0, -1);
    /// Pascal.
    pub const STRESS: Self = Self::of(-1, 1, -2);
    /// Kilogram per cubic metre.
    pub const DENSITY: Self = Self::of(-3, 1, 0);
    /// Kelvin.
    pub const TEMPERATURE: Self = Self::thermal(0, 0, 0, 1);
    /// Watt per square metre.
    pub const HEAT_FLUX: Self = Self::of(0, 1, -3);
    /// Watt per square metre and kelvin.
    pub const HEAT_TRANSFER: Self = Self::thermal(0, 1, -3, -1);

    const fn of(length: i8, mass: i8, time: i8) -> Self {
        Self::thermal(length, mass, time, 0)
    }

    const fn thermal(length: i8, mass: i8, time: i8, temperature: i8) -> Self {
        Self {
            length,
            mass,
            time,
            temperature,
        }
    }

    /// What a user calls it, with units that fit: `length (m, mm, um)`.
    #[must_use]
    pub fn description(self) -> String {
        match NAMED.iter().find(|named| named.0 == self) {
            Some((_, name, units)) => format!("{name} ({units})"),
            None => format!("a quantity in {self}"),
        }
    }

    /// One word for it, for names of definitions: `length`, `heat_flux`, or the unit spelt out.
    pub(crate) fn word(self) -> String {
        let name = match NAMED.iter().find(|named| named.0 == self) {
            _ if self == Self::NUMBER => "number".to_owned(),
            Some((_, name, _)) => name
                .split_once(' ')
                .map_or(*name, |(_, noun)| noun)
                .to_owned(),
            None => format!("quantity in {self}"),
        };
        name.replace('/', " per ")
            .replace('^', "")
            .split_whitespace()
            .collect::<Vec<_>>()
            .join("_")
    }

    /// Exponents of metre, kilogram, second and kelvin.
    fn exponents(self) -> [i8; 4] {
        [self.length, self.mass, self.time, self.temperature]
    }

    fn from_exponents([length, mass, time, temperature]: [i8; 4]) -> Self {
        Self::thermal(length, mass, time, temperature)
    }

    /// Product with a power of another; `None` for exponents beyond anything physical.
    pub(crate) fn combine(self, other: Self, power: i8) -> Option<Self> {
        let mut exponents = self.exponents();
        for (exponent, of) in exponents.iter_mut().zip(other.exponents()) {
            *exponent = exponent.checked_add(of.checked_mul(power)?)?;
        }
        Some(Self::from_exponents(exponents))
    }

    /// The root, when every exponent is a multiple.
    pub(crate) fn root(self, degree: i8) -> Option<Self> {
        let exponents = self.exponents();
        exponents
            .iter()
            .all(|exponent| exponent % degree == 0)
            .then(|| Self::from_exponents(exponents.map(|exponent| exponent / degree)))
    }
}

/// Measures with a name of their own, and units to suggest for them.
const NAMED: &[(Measure, &str, &str)] = &[
    (Measure::NUMBER, "a number without unit", "angles: rad, deg"),
    (Measure::LENGTH, "a length", "m, cm, mm, um"),
    (Measure::TIME, "a time", "s, ms, us, ns"),
    (Measure::VELOCITY, "a velocity", "m/s, mm/s, km/s"),
    (Measure::ACCELERATION, "an acceleration", "m/s^2"),
    (Measure::RATE, "a rate", "1/s, rad/s"),
    (Measure::STRESS, "a stress", "Pa, kPa, MPa, GPa"),
    (Measure::DENSITY, "a density", "kg/m^3, g/cm^3"),
    (Measure::TEMPERATURE, "a temperature", "K, degC"),
    (Measure::HEAT_FLUX, "a heat flux", "W/m^2, kW/m^2"),
    (
        Measure::HEAT_TRANSFER,
        "a heat transfer coefficient",
        "W/m^2/K",
    ),
    (
        Measure::thermal(2, 0, -2, -1),
        "a specific heat",
        "J/kg/K, kJ/kg/K",
    ),
    (Measure::thermal(1, 1, -3, -1), "a conductivity", "W/m/K"),
];

/// SI units, e.g. `kg/m^3`; derived names where there is one (`Pa`), `1` for a plain number.
impl fmt::Display for Measure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if *self == Self::STRESS {
            return f.write_str("Pa");
        }
        let parts = [
            ("kg", self.mass),
            ("m", self.length),
            ("s", self.time),
            ("K", self.temperature),
        ];
        let list = |sign: i8| {
            parts
                .iter()
                .filter(|(_, power)| power * sign > 0)
                .map(|(unit, power)| match power.abs() {
                    1 => (*unit).to_owned(),
                    power => format!("{unit}^{power}"),
                })
                .collect::<Vec<_>>()
        };
        let (above, below) = (list(1), list(-1));
        f.write_str(&if above.is_empty() {
            "1".to_owned()
        } else {
            above.join(" ")
        })?;
        for unit in below {
            write!(f, "/{unit}")?;
        }
        Ok(())
    }
}

/// A unit that can be written in a case file.
#[derive(Clone, Copy, Debug)]
pub struct Unit {
    /// Symbol.
    pub symbol: &'static str,
    /// SI value of one unit.
    pub factor: f64,
    /// Dimension.
    pub measure: Measure,
    /// Whether [`PREFIXES`] may stand before it.
    pub prefixed: bool,
}

const fn unit(symbol: &'static str, factor: f64, measure: Measure, prefixed: bool) -> Unit {
    Unit {
        symbol,
        factor,
        measure,
        prefixed,
    }
}

/// Every unit symbol understood.
pub const UNITS: &[Unit] = &[
    unit("m", 1.0, Measure::LENGTH, true),
    unit("g", 1e-3, Measure::of(0, 1, 0), true),
    unit("s", 1.0, Measure::TIME, true),
    unit("K", 1.0, Measure::TEMPERATURE, false),
    unit("N", 1.0, Measure::of(1, 1, -2), true),
    unit("Pa", 1.0, Measure::STRESS, true),
    unit("bar", 1e5, Measure::STRESS, true),
    unit("J", 1.0, Measure::of(2, 1, -2), true),
    unit("W", 1.0, Measure::of(2, 1, -3), true),
    unit("Hz", 1.0, Measure::RATE, true),
    unit("min", 60.0, Measure::TIME, false),
    unit("rad", 1.0, Measure::NUMBER, false),
    unit("deg", std::f64::consts::PI / 180.0, Measure::NUMBER, false),
    unit("%", 1e-2, Measure::NUMBER, false),
    unit("1", 1.0, Measure::NUMBER, false),
];

/// The one unit with an offset, by its spellings.
pub(crate) const CELSIUS: [&str; 2] = ["degC", "°C"];

/// 0 °C in K.
pub(crate) const ZERO_CELSIUS: f64 = 273.15;

/// Decimal prefixes and their factors.
pub const PREFIXES: &[(&str, f64)] = &[
    ("G", 1e9),
    ("M", 1e6),
    ("k", 1e3),
    ("c", 1e-2),
    ("m", 1e-3),
    ("u", 1e-6),
    ("µ", 1e-6),
    ("μ", 1e-6),
    ("n", 1e-9),
];

/// Why a text is not a quantity.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum UnitError {
    /// The text does not start with a number.
    #[error("`{text}` does not start with a number")]
    NoNumber {
        /// The whole text.
        text: String,
    },
    /// A number in quotes, without a unit.
    #[error("`{text}` is a text without a unit; write {number} without quotes for SI units")]
    NoUnit {
        /// The whole text.
        text: String,
        /// The number in it.
        number: String,
    },
    /// A unit symbol that is not in [`UNITS`].
    #[error("unknown unit `{symbol}` in `{text}`")]
    UnknownUnit {
        /// The symbol.
        symbol: String,
        /// The whole text.
        text: String,
    },
}

/// Value in SI units and dimension of a text such as `"8 mm"`, `"-1 m/s"` or `"2.8 g/cm^3"`.
///
/// A unit is a product of symbols with optional integer powers (`^2`, `²`), separated by spaces,
/// `*` or `·`; what follows a `/` is divided by, one symbol per stroke (`J/kg/K`). `degC` (or `°C`)
/// is a temperature above that of melting ice and stands alone: differences are in `K`.
///
/// ```
/// use jstsph_case::units::{Measure, parse_quantity};
///
/// let (density, measure) = parse_quantity("2.8 g/cm^3")?;
/// assert!((density - 2800.0).abs() < 1e-9);
/// assert_eq!(measure, Measure::DENSITY);
/// # Ok::<(), jstsph_case::units::UnitError>(())
/// ```
///
/// # Errors
/// [`UnitError`] when there is no number, no unit, or a unit nobody knows.
pub fn parse_quantity(text: &str) -> Result<(f64, Measure), UnitError> {
    let trimmed = text.trim();
    let (number, unit) = split_number(trimmed).ok_or_else(|| UnitError::NoNumber {
        text: text.to_owned(),
    })?;
    if unit.is_empty() {
        return Err(UnitError::NoUnit {
            text: text.to_owned(),
            number: trimmed.to_owned(),
        });
    }
    if CELSIUS.contains(&unit) {
        let value: f64 = number.parse().map_err(|_| UnitError::NoNumber {
            text: text.to_owned(),
        })?;
        return Ok((value + ZERO_CELSIUS, Measure::TEMPERATURE));
    }
    let (factor, measure) = parse_unit(unit).map_err(|symbol| UnitError::UnknownUnit {
        symbol,
        text: text.to_owned(),
    })?;
    let value = scaled(number, factor).ok_or_else(|| UnitError::NoNumber {
        text: text.to_owned(),
    })?;
    Ok((value, measure))
}

/// The number in SI units. Decimal factors move the decimal point of the text, so that `"57.42 mm"`
/// is the same double as `0.05742`.
fn scaled(number: &str, factor: f64) -> Option<f64> {
    let power = factor.log10().round();
    if (factor / 10f64.powf(power) - 1.0).abs() > 1e-12 {
        return Some(number.parse::<f64>().ok()? * factor);
    }
    let (mantissa, exponent) = match number.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<f64>().ok()?),
        None => (number, 0.0),
    };
    format!("{mantissa}e{}", exponent + power).parse().ok()
}

/// Splits at the end of the longest prefix that is a number.
fn split_number(text: &str) -> Option<(&str, &str)> {
    let longest = text
        .char_indices()
        .find(|(_, c)| !matches!(c, '0'..='9' | '+' | '-' | '.' | 'e' | 'E'))
        .map_or(text.len(), |(at, _)| at);
    (1..=longest)
        .rev()
        .find(|end| text[..*end].parse::<f64>().is_ok())
        .map(|end| (&text[..end], text[end..].trim_start()))
}

/// Factor and dimension of a unit, or the symbol that is not known.
pub(crate) fn parse_unit(text: &str) -> Result<(f64, Measure), String> {
    let mut factor = 1.0;
    let mut measure = Measure::NUMBER;
    for (stroke, group) in text.split('/').enumerate() {
        let mut sign = if stroke == 0 { 1 } else { -1 };
        let mut symbols = group
            .split([' ', '*', '·'])
            .filter(|s| !s.is_empty())
            .peekable();
        if symbols.peek().is_none() {
            return Err(text.to_owned());
        }
        for symbol in symbols {
            let (name, power) = split_power(symbol).ok_or_else(|| symbol.to_owned())?;
            let (value, of) = find_unit(name).ok_or_else(|| name.to_owned())?;
            factor *= f64::powi(value, i32::from(sign * power));
            measure = measure
                .combine(of, sign * power)
                .ok_or_else(|| symbol.to_owned())?;
            // `J/kg K` is read left to right: only the first symbol after a stroke is divided by.
            sign = 1;
        }
    }
    Ok((factor, measure))
}

/// `m^-3`, `m3`-free: the symbol and its power, at most ±9.
fn split_power(symbol: &str) -> Option<(&str, i8)> {
    if let Some((name, power)) = symbol.split_once('^') {
        let power: i8 = power.parse().ok()?;
        return (power.abs() <= 9).then_some((name, power));
    }
    for (sign, power) in [('²', 2), ('³', 3)] {
        if let Some(name) = symbol.strip_suffix(sign) {
            return Some((name, power));
        }
    }
    Some((symbol, 1))
}

fn find_unit(symbol: &str) -> Option<(f64, Measure)> {
    let plain = UNITS.iter().find(|unit| unit.symbol == symbol);
    plain.map(|unit| (unit.factor, unit.measure)).or_else(|| {
        PREFIXES.iter().find_map(|(prefix, scale)| {
            let rest = symbol.strip_prefix(prefix)?;
            let unit = UNITS
                .iter()
                .find(|unit| unit.prefixed && unit.symbol == rest)?;
            Some((scale * unit.factor, unit.measure))
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_become_si_values() {
        for (text, value, measure) in [
            ("8 mm", 8e-3, Measure::LENGTH),
            ("8mm", 8e-3, Measure::LENGTH),
            ("57.42 mm", 57.42e-3, Measure::LENGTH),
            ("69 GPa", 69e9, Measure::STRESS),
            ("-1 m/s", -1.0, Measure::VELOCITY),
            ("2800 kg/m^3", 2800.0, Measure::DENSITY),
            ("8.93 g/cm^3", 8930.0, Measure::DENSITY),
            ("80 us", 80e-6, Measure::TIME),
            ("80 µs", 80e-6, Measure::TIME),
            ("1e-3 ms", 1e-6, Measure::TIME),
            ("9.81 m/s^2", 9.81, Measure::ACCELERATION),
            ("9.81 m/s²", 9.81, Measure::ACCELERATION),
            ("105 rad/s", 105.0, Measure::RATE),
            ("400 degC", 673.15, Measure::TEMPERATURE),
            ("-20.5 °C", 252.64999999999998, Measure::TEMPERATURE),
            ("300 K", 300.0, Measure::TEMPERATURE),
            ("180 deg", std::f64::consts::PI, Measure::NUMBER),
            ("3 1/s", 3.0, Measure::RATE),
            ("2 N/mm^2", 2e6, Measure::STRESS),
            ("5 %", 0.05, Measure::NUMBER),
            ("2 min", 120.0, Measure::TIME),
        ] {
            let (found, of) = parse_quantity(text).expect(text);
            // One multiplication and one power: a few units in the last place.
            assert!(
                (found - value).abs() <= 4e-16 * value.abs(),
                "{text}: {found} is not {value}"
            );
            assert_eq!(of, measure, "{text}");
        }
    }

    #[test]
    fn decimal_millimetres_are_the_nearest_double() {
        for (text, value) in [
            ("1.42 mm", 0.00142),
            ("57.42 mm", 0.05742),
            ("45 ms", 0.045),
            ("-1.5e1 us", -15e-6),
            ("159 MPa", 159e6),
            ("8.93 g/cm^3", 8930.0),
        ] {
            assert_eq!(parse_quantity(text).expect(text).0, value, "{text}");
        }
    }

    #[test]
    fn compound_units_are_read_left_to_right() {
        let (value, measure) = parse_quantity("385 J/kg/K").expect("a specific heat");
        assert_eq!(value, 385.0);
        assert_eq!(measure.to_string(), "m^2/s^2/K");
    }

    #[test]
    fn mistakes_name_the_offending_symbol() {
        let unknown = parse_quantity("8 mmm").expect_err("no such unit");
        assert_eq!(unknown.to_string(), "unknown unit `mmm` in `8 mmm`");
        assert!(matches!(
            parse_quantity("mm"),
            Err(UnitError::NoNumber { .. })
        ));
        assert!(matches!(parse_quantity("8"), Err(UnitError::NoUnit { .. })));
        assert!(matches!(
            parse_quantity("8 m/"),
            Err(UnitError::UnknownUnit { .. })
        ));
        assert!(matches!(
            parse_quantity("8 m^x"),
            Err(UnitError::UnknownUnit { .. })
        ));
        assert!(matches!(
            parse_quantity(""),
            Err(UnitError::NoNumber { .. })
        ));
    }

    #[test]
    fn measures_are_shown_in_si_units() {
        assert_eq!(Measure::DENSITY.to_string(), "kg/m^3");
        assert_eq!(Measure::STRESS.to_string(), "Pa");
        assert_eq!(Measure::RATE.to_string(), "1/s");
        assert_eq!(Measure::NUMBER.to_string(), "1");
        assert_eq!(Measure::LENGTH.description(), "a length (m, cm, mm, um)");
    }
}
