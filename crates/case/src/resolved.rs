//! Writing a resolved case: TOML in the manner of the shipped cases, with units as comments.

use std::fmt::Write as _;

use toml::{Table, Value};

use crate::schema::{self, Key};

const HEADER: &str = "# Every setting of this run, defaults written out, numbers in SI units.\n\
                      # Running this file again gives the same results.\n\n";

/// The text of a resolved case.
pub(crate) fn write(case: &Table) -> String {
    let mut text = HEADER.to_owned();
    // TOML wants the plain values of a table before its sub-tables.
    for (name, value) in case {
        if !matches!(value, Value::Table(_)) && !is_list_of_tables(value) {
            line(&mut text, schema::CASE, name, value);
        }
    }
    for (name, value) in case {
        let keys = schema::CASE
            .iter()
            .find(|key| key.name == name)
            .map_or(&[][..], |key| key.kind.keys());
        match value {
            Value::Table(materials) if name == "material" => {
                for (material, models) in materials {
                    for (model, parameters) in models.as_table().into_iter().flatten() {
                        let path = format!("material.{}.{model}", quoted(material));
                        section(&mut text, &format!("[{path}]"), parameters.as_table(), &[]);
                    }
                }
            }
            Value::Table(table) => section(&mut text, &format!("[{name}]"), Some(table), keys),
            Value::Array(items) if is_list_of_tables(value) => {
                for item in items {
                    section(&mut text, &format!("[[{name}]]"), item.as_table(), keys);
                }
            }
            _ => {}
        }
    }
    text
}

fn is_list_of_tables(value: &Value) -> bool {
    value
        .as_array()
        .is_some_and(|items| items.iter().all(Value::is_table) && !items.is_empty())
}

/// A key as TOML wants it: bare where it can be.
fn quoted(key: &str) -> String {
    let bare = !key.is_empty()
        && key
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-'));
    if bare {
        key.to_owned()
    } else {
        Value::String(key.to_owned()).to_string()
    }
}

fn section(text: &mut String, header: &str, table: Option<&Table>, keys: &[Key]) {
    let _ = writeln!(text, "\n{header}");
    for (name, value) in table.into_iter().flatten() {
        line(text, keys, name, value);
    }
}

fn line(text: &mut String, keys: &[Key], name: &str, value: &Value) {
    let unit = keys
        .iter()
        .find(|key| key.name == name)
        .and_then(|key| key.kind.unit());
    let comment = unit.map_or(String::new(), |unit| format!("  # {unit}"));
    let _ = writeln!(text, "{} = {}{comment}", quoted(name), inline(value));
}

/// A value on one line; very large and very small numbers with an exponent.
fn inline(value: &Value) -> String {
    match value {
        Value::Float(number) => float(*number),
        Value::Array(items) => format!(
            "[{}]",
            items.iter().map(inline).collect::<Vec<_>>().join(", ")
        ),
        Value::Table(table) => {
            let entries: Vec<String> = table
                .iter()
                .map(|(name, value)| format!("{} = {}", quoted(name), inline(value)))
                .collect();
            format!("{{ {} }}", entries.join(", "))
        }
        other => other.to_string(),
    }
}

/// The shortest text that reads back to the same double.
fn float(number: f64) -> String {
    let size = number.abs();
    if size != 0.0 && !(1e-3..1e6).contains(&size) {
        format!("{number:e}")
    } else {
        format!("{number:?}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_toml_floats_that_read_back_exactly() {
        for (number, text) in [
            (69e9, "6.9e10"),
            (0.045, "0.045"),
            (1e-6, "1e-6"),
            (0.0, "0.0"),
            (-2.0, "-2.0"),
            (0.1 + 0.2, "0.30000000000000004"),
        ] {
            assert_eq!(float(number), text);
            let read: toml::Value = text.parse().expect("TOML");
            assert_eq!(read.as_float(), Some(number));
        }
    }
}
