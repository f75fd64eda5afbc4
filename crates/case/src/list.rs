//! Everything that can be written in a case file, for `jstsph list` and the documentation.

use jstsph_material::hardening::LAWS;
use jstsph_material::{Description, MODELS, Range, library};
use jstsph_sph::Kernel;

use crate::expression::{CONSTANTS, FUNCTIONS, FUNCTIONS_OF_TWO};
use crate::schema::{self, Key, Presence};
use crate::signal::VARIABLES;
use crate::units::{PREFIXES, UNITS};

/// A named list.
#[derive(Clone, Debug)]
pub struct List {
    /// Name on the command line.
    pub name: &'static str,
    /// What it lists.
    pub summary: &'static str,
    /// Its entries.
    pub entries: Vec<ListEntry>,
}

/// One entry of a [`List`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ListEntry {
    /// As written in a case file.
    pub name: String,
    /// What it is, with unit, range and default where there are any.
    pub meaning: String,
    /// Keys inside it.
    pub keys: Vec<ListEntry>,
}

fn entry(name: impl Into<String>, meaning: impl Into<String>) -> ListEntry {
    ListEntry {
        name: name.into(),
        meaning: meaning.into(),
        keys: Vec::new(),
    }
}

/// Every list.
#[must_use]
pub fn lists() -> Vec<List> {
    let list = |name, summary, entries| List {
        name,
        summary,
        entries,
    };
    vec![
        list(
            "keys",
            "every table and key of a case file",
            keys(schema::CASE),
        ),
        list(
            "materials",
            "shipped materials and the models for your own",
            materials(),
        ),
        list(
            "hardening",
            "hardening laws of plastic models",
            described(LAWS),
        ),
        list(
            "kernels",
            "kernel functions",
            Kernel::ALL
                .iter()
                .map(|kernel| entry(kernel.name(), ""))
                .collect(),
        ),
        list(
            "shapes",
            "shapes of bodies and their faces",
            keys(schema::SHAPES),
        ),
        list(
            "lattices",
            "how a shape is filled with particles",
            keys(schema::LATTICE),
        ),
        list(
            "selections",
            "tables for `where`, beside \"body\" and \"body.face\"",
            keys(schema::SELECTION),
        ),
        list(
            "boundaries",
            "conditions on selections",
            keys(schema::BOUNDARY),
        ),
        list("obstacles", "rigid obstacles", keys(schema::OBSTACLE)),
        list(
            "probes",
            "numbers read off the simulation",
            keys(schema::PROBE),
        ),
        list(
            "fields",
            "fields a probe can read",
            schema::FIELDS
                .iter()
                .map(|(name, _)| entry(*name, ""))
                .collect(),
        ),
        list(
            "signals",
            "values that change with time or place",
            keys(schema::SIGNAL),
        ),
        list(
            "expressions",
            "what expressions understand, beside + - * / ^ and parentheses",
            expressions(),
        ),
        list(
            "units",
            "units; a number without one is in SI units",
            units(),
        ),
    ]
}

fn keys(keys: &[Key]) -> Vec<ListEntry> {
    keys.iter()
        .map(|key| {
            let presence = match key.presence {
                Presence::Required => "required".to_owned(),
                Presence::Optional => "optional".to_owned(),
                Presence::Default(value) => format!("default {value}"),
                Presence::Derived(value) => format!("default: {value}"),
            };
            ListEntry {
                name: key.name.to_owned(),
                meaning: format!("{} [{}; {presence}]", key.meaning, key.kind.description()),
                keys: self::keys(key.kind.keys()),
            }
        })
        .collect()
}

fn described(descriptions: &[Description]) -> Vec<ListEntry> {
    descriptions
        .iter()
        .map(|description| ListEntry {
            name: description.name.to_owned(),
            meaning: description.summary.to_owned(),
            keys: parameters(description.keys),
        })
        .collect()
}

/// Keys of a material's or a law's table.
fn parameters(keys: &[jstsph_material::Key]) -> Vec<ListEntry> {
    keys.iter()
        .map(|key| {
            let optional = if key.optional { ", optional" } else { "" };
            let (range, inner) = match key.range {
                Range::Table(keys) => ("a table".to_owned(), parameters(keys)),
                range => (range.to_string(), Vec::new()),
            };
            ListEntry {
                name: key.name.to_owned(),
                meaning: format!("{} [{}, {range}{optional}]", key.meaning, key.unit),
                keys: inner,
            }
        })
        .collect()
}

fn materials() -> Vec<ListEntry> {
    let shipped = library().iter().map(|material| {
        entry(
            format!("material = \"{}\"", material.name),
            format!("{}; {}", material.spec.name(), material.source),
        )
    });
    let models = described(MODELS).into_iter().map(|model| ListEntry {
        name: format!("[material.NAME.{}]", model.name),
        ..model
    });
    shipped.chain(models).collect()
}

fn expressions() -> Vec<ListEntry> {
    let meanings = [
        "time, s",
        "reference position, m",
        "reference position, m",
        "reference position, m",
    ];
    let variables = VARIABLES
        .iter()
        .zip(meanings)
        .map(|(name, meaning)| entry(*name, meaning));
    let constants = CONSTANTS
        .iter()
        .map(|(name, value)| entry(*name, value.to_string()));
    let functions = FUNCTIONS
        .iter()
        .map(|(name, _)| entry(format!("{name}(a)"), ""));
    let of_two = FUNCTIONS_OF_TWO
        .iter()
        .map(|(name, _)| entry(format!("{name}(a, b)"), ""));
    variables
        .chain(constants)
        .chain(functions)
        .chain(of_two)
        .collect()
}

fn units() -> Vec<ListEntry> {
    let prefixes: Vec<&str> = PREFIXES.iter().map(|(prefix, _)| *prefix).collect();
    UNITS
        .iter()
        .filter(|unit| unit.symbol != "1")
        .map(|unit| {
            let with = if unit.prefixed {
                format!(", also with {}", prefixes.join(" "))
            } else {
                String::new()
            };
            entry(
                unit.symbol,
                format!("{} {}{with}", unit.factor, unit.measure),
            )
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_show_what_the_schema_and_the_registries_hold() {
        let lists = lists();
        let find = |name: &str| lists.iter().find(|list| list.name == name).expect(name);
        let time = find("keys")
            .entries
            .iter()
            .find(|entry| entry.name == "time")
            .expect("time")
            .clone();
        assert!(
            time.keys
                .iter()
                .any(|key| key.name == "end" && key.meaning.contains("required"))
        );
        assert!(
            find("materials")
                .entries
                .iter()
                .any(|entry| entry.name == "material = \"copper_taylor\"")
        );
        assert!(
            find("materials")
                .entries
                .iter()
                .any(|entry| entry.name == "[material.NAME.neo_hookean]")
        );
        assert!(
            find("hardening")
                .entries
                .iter()
                .any(|entry| entry.name == "swift" && entry.keys.len() == 3)
        );
        assert_eq!(find("kernels").entries.len(), 4);
        assert!(
            find("units")
                .entries
                .iter()
                .all(|entry| !entry.meaning.is_empty())
        );
    }
}
