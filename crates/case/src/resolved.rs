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
    let _ = writeln!(text, "{} = {value}{comment}", quoted(name));
}
