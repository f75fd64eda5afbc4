//! `[parameters]`: named numbers, and texts that begin with `=` and calculate with them.

use crate::document::{Calculated, Entry, Node, Value};
use crate::error::{Origin, Problem};
use crate::expression::{CONSTANTS, Expression, FUNCTIONS, FUNCTIONS_OF_TWO, Quantity};
use crate::signal::VARIABLES;
use crate::units::{Measure, parse_quantity};

/// Calculates every text that begins with `=`, and puts the numbers of parameters into expressions
/// of time and place.
pub(crate) fn resolve(document: &mut Node) -> Result<(), Problem> {
    let entries: Vec<Entry> = match document.entry("parameters").map(|entry| &entry.node) {
        None => Vec::new(),
        Some(Node {
            value: Value::Table(entries),
            ..
        }) => entries.clone(),
        Some(node) => {
            return Err(Problem::new(
                &node.origin,
                format!(
                    "`parameters` must be a table of named numbers, but is {}",
                    node.value.kind()
                ),
            ));
        }
    };
    check_names(&entries)?;
    let mut parameters = Parameters {
        names: entries.iter().map(|entry| entry.key.as_str()).collect(),
        entries: &entries,
        values: vec![None; entries.len()],
        open: Vec::new(),
    };
    for index in 0..entries.len() {
        parameters.value(index)?;
    }
    let Value::Table(top) = &mut document.value else {
        return Ok(());
    };
    for entry in top {
        if !matches!(entry.key.as_str(), "parameters" | "title" | "include") {
            parameters.walk(&entry.key, &mut entry.node)?;
        }
    }
    Ok(())
}

/// Names must not hide others, and overrides must not invent new ones.
fn check_names(entries: &[Entry]) -> Result<(), Problem> {
    let reserved = || {
        let functions = FUNCTIONS.iter().map(|(name, _)| *name);
        VARIABLES
            .into_iter()
            .chain(CONSTANTS.iter().map(|(name, _)| *name))
            .chain(functions)
            .chain(FUNCTIONS_OF_TWO.iter().map(|(name, _)| *name))
    };
    for entry in entries {
        let name = entry.key.as_str();
        if matches!(entry.key_origin, Origin::Override(_)) {
            let written = entries
                .iter()
                .filter(|entry| !matches!(entry.key_origin, Origin::Override(_)));
            return Err(Problem::new(
                &entry.key_origin,
                format!("the case has no parameter `{name}`"),
            )
            .allowed(name, written.map(|entry| entry.key.as_str())));
        }
        let mut characters = name.chars();
        let is_name = characters
            .next()
            .is_some_and(|c| c.is_alphabetic() || c == '_')
            && characters.all(|c| c.is_alphanumeric() || c == '_');
        if !is_name {
            return Err(Problem::new(
                &entry.key_origin,
                format!(
                    "`{name}` cannot name a parameter: names are letters, digits and _, no digit first"
                ),
            ));
        }
        if reserved().any(|other| other == name) {
            return Err(Problem::new(
                &entry.key_origin,
                format!("`{name}` cannot name a parameter: expressions know it as something else"),
            )
            .help(format!(
                "taken: {}",
                reserved().collect::<Vec<_>>().join(", ")
            )));
        }
    }
    Ok(())
}

struct Parameters<'a> {
    entries: &'a [Entry],
    names: Vec<&'a str>,
    values: Vec<Option<Quantity>>,
    /// Parameters being calculated, outermost first.
    open: Vec<usize>,
}

impl Parameters<'_> {
    /// Value of a parameter, calculating those it needs.
    fn value(&mut self, index: usize) -> Result<Quantity, Problem> {
        if let Some(value) = self.values[index] {
            return Ok(value);
        }
        let entries = self.entries;
        let (name, node) = (&entries[index].key, &entries[index].node);
        if let Some(start) = self.open.iter().position(|open| *open == index) {
            let circle: Vec<&str> = self.open[start..]
                .iter()
                .chain([&index])
                .map(|index| self.names[*index])
                .collect();
            return Err(Problem::new(
                &node.origin,
                format!(
                    "parameters depend on each other in a circle: {}",
                    circle.join(" -> ")
                ),
            ));
        }
        self.open.push(index);
        let value = match &node.value {
            #[expect(
                clippy::cast_precision_loss,
                reason = "integers of case files are small"
            )]
            Value::Integer(value) => (*value as f64, Measure::NUMBER),
            Value::Float(value) => (*value, Measure::NUMBER),
            Value::Text(text) if is_calculated(text) => self.calculate(text, &node.origin)?,
            Value::Text(text) => parse_quantity(text).map_err(|error| {
                Problem::new(&node.origin, format!("`parameters.{name}`: {error}"))
                    .help("a calculated parameter begins with `=`, as in \"= 2 * radius\"")
            })?,
            other => {
                return Err(Problem::new(
                    &node.origin,
                    format!(
                        "`parameters.{name}` must be a number, a text with unit or an expression \"= ...\", \
                         but is {}",
                        other.kind()
                    ),
                ));
            }
        };
        self.open.pop();
        if !value.0.is_finite() {
            return Err(Problem::new(
                &node.origin,
                format!("`parameters.{name}` is {}, but must be finite", value.0),
            ));
        }
        self.values[index] = Some(value);
        Ok(value)
    }

    fn calculate(&mut self, text: &str, origin: &Origin) -> Result<Quantity, Problem> {
        let problem = |message: String| Problem::new(origin, format!("\"{text}\": {message}"));
        // The sign becomes a space, so that columns count from the first character.
        let formula = text.replacen('=', " ", 1);
        let expression = Expression::parse_measured(&formula, &self.names).map_err(|error| {
            let problem = problem(error.to_string());
            match &error.unknown {
                None => problem,
                Some(name) => self.meant(name, problem),
            }
        })?;
        let mut values = Vec::with_capacity(self.names.len());
        for index in 0..self.names.len() {
            values.push(if expression.uses(index) {
                self.value(index)?
            } else {
                (0.0, Measure::NUMBER)
            });
        }
        expression.measured(&values).map_err(problem)
    }

    /// Replaces expressions in a value and all below it.
    fn walk(&mut self, key: &str, node: &mut Node) -> Result<(), Problem> {
        match &mut node.value {
            Value::Text(text) if key == "expression" => {
                self.check_expression(text, &node.origin)?;
                *text = self.with_numbers(text);
            }
            Value::Text(text) if is_calculated(text) => {
                let (value, measure) = self.calculate(text, &node.origin)?;
                node.value = Value::Calculated(Calculated {
                    value,
                    measure,
                    text: text.clone(),
                });
            }
            Value::Array(items) => {
                for item in items {
                    self.walk("", item)?;
                }
            }
            Value::Table(entries) => {
                for entry in entries {
                    self.walk(&entry.key, &mut entry.node)?;
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn meant(&self, name: &str, problem: Problem) -> Problem {
        let functions = FUNCTIONS.iter().map(|(name, _)| *name);
        let known = self.names.iter().copied().chain(functions);
        match crate::nearest(name, known) {
            Some(near) => problem.help(format!("did you mean `{near}`?")),
            None if self.names.is_empty() => problem.help("the case has no [parameters]"),
            None => problem.help(format!("parameters: {}", self.names.join(", "))),
        }
    }

    /// Names that an expression of time and place does not know are found before its parameters
    /// become numbers, so that the message counts characters as they are written.
    fn check_expression(&self, text: &str, origin: &Origin) -> Result<(), Problem> {
        if self.names.is_empty() {
            return Ok(());
        }
        let known: Vec<&str> = VARIABLES.iter().chain(&self.names).copied().collect();
        match Expression::parse(text, &known) {
            Err(error) if error.unknown.is_some() => {
                let problem = Problem::new(origin, format!("\"{text}\": {error}"));
                let name = error.unknown.unwrap_or_default();
                Err(self.meant(&name, problem))
            }
            _ => Ok(()),
        }
    }

    /// An expression of time and place with the SI numbers of parameters in place of their names.
    fn with_numbers(&self, text: &str) -> String {
        let is_part = |c: char| c.is_alphanumeric() || c == '_';
        let mut result = String::new();
        let mut rest = text;
        while let Some(first) = rest.chars().next() {
            let end = rest
                .find(|c| is_part(c) != is_part(first))
                .unwrap_or(rest.len());
            let (word, after) = rest.split_at(end);
            let found = self.names.iter().position(|name| *name == word);
            match found.and_then(|index| self.values[index]) {
                Some((value, _)) if value < 0.0 => result += &format!("({value:?})"),
                Some((value, _)) => result += &format!("{value:?}"),
                None => result += word,
            }
            rest = after;
        }
        result
    }
}

fn is_calculated(text: &str) -> bool {
    text.trim_start().starts_with('=')
}
