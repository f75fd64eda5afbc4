//! Arithmetic expressions of time and reference position, e.g. `-tanh(t / 1e-3) + 0.1 * X`.
//!
//! Usual precedence: `^` binds tighter than a sign (`-t^2` is −(t²)) and groups to the right; then
//! `*` and `/`; then `+` and `-`. Evaluation allocates nothing.

use std::fmt;

use crate::units::{Measure, ZERO_CELSIUS};

mod measured;

pub(crate) use measured::Quantity;

/// A function of one argument with its name.
pub type Function = (&'static str, fn(f64) -> f64);
/// A function of two arguments with its name.
pub type FunctionOfTwo = (&'static str, fn(f64, f64) -> f64);

/// Functions of one argument.
pub const FUNCTIONS: &[Function] = &[
    ("abs", f64::abs),
    ("sign", |x| if x == 0.0 { 0.0 } else { x.signum() }),
    ("step", |x| if x < 0.0 { 0.0 } else { 1.0 }),
    ("sqrt", f64::sqrt),
    ("cbrt", f64::cbrt),
    ("exp", f64::exp),
    ("ln", f64::ln),
    ("log10", f64::log10),
    ("sin", f64::sin),
    ("cos", f64::cos),
    ("tan", f64::tan),
    ("asin", f64::asin),
    ("acos", f64::acos),
    ("atan", f64::atan),
    ("sinh", f64::sinh),
    ("cosh", f64::cosh),
    ("tanh", f64::tanh),
    ("floor", f64::floor),
    ("ceil", f64::ceil),
];

/// Functions of two arguments.
pub const FUNCTIONS_OF_TWO: &[FunctionOfTwo] =
    &[("min", f64::min), ("max", f64::max), ("atan2", f64::atan2)];

/// Named constants.
pub const CONSTANTS: &[(&str, f64)] = &[("pi", std::f64::consts::PI)];

/// Deepest nesting accepted; keeps parsing and evaluation off the end of the stack.
const DEEPEST: usize = 100;
/// Longest text accepted, for the same reason: a chain of sums is as deep as it is long.
const LONGEST: usize = 4096;

#[derive(Clone, Copy, Debug)]
enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
}

#[derive(Clone, Debug)]
enum Term {
    Number(f64),
    /// SI value of a number with a unit, and its dimension.
    Quantity(f64, Measure),
    /// Degrees Celsius.
    Celsius(f64),
    Variable(usize),
    Negative(Box<Term>),
    Binary(Binary, Box<Term>, Box<Term>),
    Call(&'static Function, Box<Term>),
    CallTwo(&'static FunctionOfTwo, Box<Term>, Box<Term>),
}

/// A checked expression of named variables.
#[derive(Clone, Debug)]
pub struct Expression {
    root: Term,
}

/// What is wrong with an expression, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExpressionError {
    /// What is wrong.
    pub message: String,
    /// Character (from 1) at which it was noticed.
    pub column: usize,
    /// Unknown name, when that is what is wrong.
    pub unknown: Option<String>,
}

impl fmt::Display for ExpressionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} (character {} of the expression)",
            self.message, self.column
        )
    }
}

impl std::error::Error for ExpressionError {}

impl Expression {
    /// Parses `text` with the given variable names; their order is that of the values of
    /// [`Expression::evaluate`].
    ///
    /// ```
    /// let ramp = jstsph_case::expression::Expression::parse("-2 * min(t / 1e-3, 1)", &["t"])?;
    /// assert_eq!(ramp.evaluate(&[5e-4]), -1.0);
    /// # Ok::<(), jstsph_case::expression::ExpressionError>(())
    /// ```
    ///
    /// # Errors
    /// [`ExpressionError`] with the character where reading stopped.
    pub fn parse(text: &str, variables: &[&str]) -> Result<Self, ExpressionError> {
        Self::parse_with(text, variables, false)
    }

    fn parse_with(
        text: &str,
        variables: &[&str],
        has_units: bool,
    ) -> Result<Self, ExpressionError> {
        let mut parser = Parser {
            characters: text.chars().collect(),
            at: 0,
            depth: 0,
            variables,
            has_units,
        };
        if parser.characters.len() > LONGEST {
            return Err(parser.error(format!("longer than {LONGEST} characters")));
        }
        let root = parser.sum()?;
        parser.skip_space();
        match parser.characters.get(parser.at) {
            None => Ok(Self { root }),
            Some(c) => Err(parser.error(format!("unexpected `{c}`"))),
        }
    }

    /// Value for the given values of the variables.
    ///
    /// # Panics
    /// If fewer values than variables are given.
    #[must_use]
    pub fn evaluate(&self, values: &[f64]) -> f64 {
        self.root.evaluate(values)
    }

    /// Whether variable number `index` appears.
    #[must_use]
    pub fn uses(&self, index: usize) -> bool {
        self.root.uses(index)
    }
}

impl Term {
    fn evaluate(&self, values: &[f64]) -> f64 {
        match self {
            Self::Number(value) | Self::Quantity(value, _) => *value,
            Self::Celsius(value) => value + ZERO_CELSIUS,
            Self::Variable(index) => values[*index],
            Self::Negative(term) => -term.evaluate(values),
            Self::Call((_, function), term) => function(term.evaluate(values)),
            Self::CallTwo((_, function), a, b) => function(a.evaluate(values), b.evaluate(values)),
            Self::Binary(operator, a, b) => {
                let (a, b) = (a.evaluate(values), b.evaluate(values));
                match operator {
                    Binary::Add => a + b,
                    Binary::Subtract => a - b,
                    Binary::Multiply => a * b,
                    Binary::Divide => a / b,
                    Binary::Power => a.powf(b),
                }
            }
        }
    }

    fn uses(&self, index: usize) -> bool {
        match self {
            Self::Number(_) | Self::Quantity(..) | Self::Celsius(_) => false,
            Self::Variable(variable) => *variable == index,
            Self::Negative(term) | Self::Call(_, term) => term.uses(index),
            Self::Binary(_, a, b) | Self::CallTwo(_, a, b) => a.uses(index) || b.uses(index),
        }
    }
}

struct Parser<'a> {
    characters: Vec<char>,
    at: usize,
    depth: usize,
    variables: &'a [&'a str],
    has_units: bool,
}

impl Parser<'_> {
    fn error(&self, message: String) -> ExpressionError {
        ExpressionError {
            message,
            column: self.at + 1,
            unknown: None,
        }
    }

    fn skip_space(&mut self) {
        while self
            .characters
            .get(self.at)
            .is_some_and(|c| c.is_whitespace())
        {
            self.at += 1;
        }
    }

    fn take(&mut self, wanted: char) -> bool {
        self.skip_space();
        let found = self.characters.get(self.at) == Some(&wanted);
        self.at += usize::from(found);
        found
    }

    fn expect(&mut self, wanted: char) -> Result<(), ExpressionError> {
        if self.take(wanted) {
            Ok(())
        } else {
            Err(self.error(format!("`{wanted}` is missing")))
        }
    }

    fn sum(&mut self) -> Result<Term, ExpressionError> {
        let mut left = self.product()?;
        loop {
            let operator = if self.take('+') {
                Binary::Add
            } else if self.take('-') {
                Binary::Subtract
            } else {
                return Ok(left);
            };
            left = Term::Binary(operator, Box::new(left), Box::new(self.product()?));
        }
    }

    fn product(&mut self) -> Result<Term, ExpressionError> {
        let mut left = self.signed()?;
        loop {
            let operator = if self.take('*') {
                Binary::Multiply
            } else if self.take('/') {
                Binary::Divide
            } else {
                return Ok(left);
            };
            left = Term::Binary(operator, Box::new(left), Box::new(self.signed()?));
        }
    }

    fn signed(&mut self) -> Result<Term, ExpressionError> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.error(format!("nested deeper than {DEEPEST} levels")));
        }
        let term = if self.take('-') {
            Term::Negative(Box::new(self.signed()?))
        } else if self.take('+') {
            self.signed()?
        } else {
            self.power()?
        };
        self.depth -= 1;
        Ok(term)
    }

    fn power(&mut self) -> Result<Term, ExpressionError> {
        let base = self.atom()?;
        if self.take('^') {
            let exponent = self.signed()?;
            return Ok(Term::Binary(
                Binary::Power,
                Box::new(base),
                Box::new(exponent),
            ));
        }
        Ok(base)
    }

    fn atom(&mut self) -> Result<Term, ExpressionError> {
        if self.take('(') {
            let inner = self.sum()?;
            self.expect(')')?;
            return Ok(inner);
        }
        match self.characters.get(self.at) {
            Some(c) if c.is_ascii_digit() || *c == '.' => self.number(),
            Some(c) if c.is_alphabetic() || *c == '_' => self.name(),
            Some(c) => Err(self.error(format!("a number, name or `(` is expected before `{c}`"))),
            None => Err(self.error("a number, name or `(` is expected at the end".to_owned())),
        }
    }

    fn number(&mut self) -> Result<Term, ExpressionError> {
        let start = self.at;
        let mut end = start;
        while let Some(c) = self.characters.get(end) {
            let signed = matches!(c, '+' | '-') && matches!(self.characters[end - 1], 'e' | 'E');
            if !(c.is_ascii_digit() || matches!(c, '.' | 'e' | 'E') || (end > start && signed)) {
                break;
            }
            end += 1;
        }
        let text: String = self.characters[start..end].iter().collect();
        if self.has_units
            && let Some(term) = self.with_unit(&text, end)?
        {
            return Ok(term);
        }
        let value = text
            .parse()
            .map_err(|_| self.error(format!("`{text}` is not a number")))?;
        self.at = end;
        Ok(Term::Number(value))
    }

    fn name(&mut self) -> Result<Term, ExpressionError> {
        let start = self.at;
        while self
            .characters
            .get(self.at)
            .is_some_and(|c| c.is_alphanumeric() || *c == '_')
        {
            self.at += 1;
        }
        let name: String = self.characters[start..self.at].iter().collect();
        if let Some(index) = self.variables.iter().position(|known| *known == name) {
            return Ok(Term::Variable(index));
        }
        if let Some((_, value)) = CONSTANTS.iter().find(|(known, _)| *known == name) {
            return Ok(Term::Number(*value));
        }
        if let Some(function) = FUNCTIONS.iter().find(|(known, _)| *known == name) {
            self.expect('(')?;
            let argument = self.sum()?;
            self.expect(')')?;
            return Ok(Term::Call(function, Box::new(argument)));
        }
        if let Some(function) = FUNCTIONS_OF_TWO.iter().find(|(known, _)| *known == name) {
            self.expect('(')?;
            let first = self.sum()?;
            self.expect(',')?;
            let second = self.sum()?;
            self.expect(')')?;
            return Ok(Term::CallTwo(function, Box::new(first), Box::new(second)));
        }
        Err(ExpressionError {
            message: format!("unknown name `{name}`"),
            column: start + 1,
            unknown: Some(name),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> f64 {
        let expression = Expression::parse(text, &["t", "X"]).expect(text);
        expression.evaluate(&[3.0, 0.5])
    }

    #[test]
    fn precedence_is_that_of_written_mathematics() {
        assert_eq!(value("-t^2"), -9.0);
        assert_eq!(value("2^3^2"), 512.0);
        assert_eq!(value("2^-1"), 0.5);
        assert_eq!(value("1 - 2 - 3"), -4.0);
        assert_eq!(value("12 / 3 / 2"), 2.0);
        assert_eq!(value("1 + 2 * t"), 7.0);
        assert_eq!(value("(1 + 2) * -t"), -9.0);
        assert_eq!(value("1e-3*t + 2.5E+2"), 250.003);
    }

    #[test]
    fn functions_constants_and_variables_are_known() {
        assert_eq!(value("max(t, X) + min(t, X)"), 3.5);
        assert_eq!(value("cos(pi)"), -1.0);
        assert_eq!(value("step(t - 3) + step(t - 3.1)"), 1.0);
        assert_eq!(value("sign(0)"), 0.0);
        let ramp = Expression::parse("-1 * tanh(t / 1e-3) + X", &["t", "X"]).expect("valid");
        assert_eq!(ramp.evaluate(&[1e-3, 0.25]), -(1f64.tanh()) + 0.25);
        assert!(ramp.uses(0) && ramp.uses(1));
    }

    #[test]
    fn mistakes_are_located() {
        for (text, message, column) in [
            ("1 + x", "unknown name `x`", 5),
            ("1 +", "expected at the end", 4),
            ("(1 + 2", "`)` is missing", 7),
            ("sin t", "`(` is missing", 5),
            ("1 2", "unexpected `2`", 3),
            ("1.2.3", "is not a number", 1),
            ("", "expected at the end", 1),
            ("3 % 2", "unexpected `%`", 3),
        ] {
            let error = Expression::parse(text, &["t"]).expect_err(text);
            assert!(error.message.contains(message), "{text}: {error}");
            assert_eq!(error.column, column, "{text}");
        }
    }

    #[test]
    fn hostile_nesting_is_refused_instead_of_overflowing_the_stack() {
        for text in [
            "(".repeat(100_000),
            "-".repeat(100_000),
            "2^".repeat(100_000),
        ] {
            let error = Expression::parse(&text, &[]).expect_err("too deep");
            assert!(error.message.contains("longer than"), "{error}");
        }
        let error = Expression::parse(&"(".repeat(1000), &[]).expect_err("too deep");
        assert!(error.message.contains("nested deeper"), "{error}");
    }
}
