//! Materials: tables of the case converted to SI, and the shipped parameter sets.

use jstsph_material::{Description, Key, MODELS, MaterialSpec, NamedMaterial, Range, library};
use serde::Deserialize;

use crate::document::{Node, Value};
use crate::error::{Origin, Problem};
use crate::schema::Limit;
use crate::section::Field;
use crate::units::{Measure, parse_unit};
use crate::value::number;

/// The materials of one case by name.
pub(crate) struct Materials {
    tables: Vec<(String, MaterialSpec)>,
}

impl Materials {
    /// Reads and checks every `[material.NAME.MODEL]` table, used or not.
    pub(crate) fn read(node: Option<&Node>) -> Result<Self, Problem> {
        let mut tables = Vec::new();
        let Some(node) = node else {
            return Ok(Self { tables });
        };
        for (name, material) in entries(node, "material", "tables [material.NAME.MODEL]")? {
            tables.push((
                name.to_owned(),
                read_material(material, &format!("material.{name}"))?,
            ));
        }
        Ok(Self { tables })
    }

    /// The material a body names.
    pub(crate) fn find(&self, field: &Field<'_>) -> Result<MaterialSpec, Problem> {
        let name = field.text()?;
        let own = self
            .tables
            .iter()
            .find(|(known, _)| known == name)
            .map(|(_, spec)| spec);
        let shipped = || {
            shipped()
                .find(|material| material.name == name)
                .map(|material| &material.spec)
        };
        own.or_else(shipped).cloned().ok_or_else(|| {
            let names = self.tables.iter().map(|(known, _)| known.as_str());
            field
                .problem(format!("unknown material `{name}`"))
                .allowed(name, names.chain(self::shipped().map(|material| material.name)))
                .help("a material of your own is a table [material.NAME.MODEL]; see `jstsph list materials`")
        })
    }
}

/// `[material]` with the tables of the given materials, shipped ones included, in SI units.
pub(crate) fn resolved<'a>(used: impl Iterator<Item = (&'a str, &'a MaterialSpec)>) -> toml::Table {
    used.map(|(name, spec)| {
        let table =
            toml::Value::try_from(spec).expect("a material is a table of numbers and tables");
        (name.to_owned(), table)
    })
    .collect()
}

fn shipped() -> impl Iterator<Item = &'static NamedMaterial> {
    library().iter()
}

fn entries<'n>(
    node: &'n Node,
    path: &str,
    wanted: &str,
) -> Result<Vec<(&'n str, &'n Node)>, Problem> {
    match &node.value {
        Value::Table(entries) => Ok(entries
            .iter()
            .map(|entry| (entry.key.as_str(), &entry.node))
            .collect()),
        other => Err(Problem::new(
            &node.origin,
            format!("`{path}` must be {wanted}, but is {}", other.kind()),
        )),
    }
}

fn read_material(node: &Node, path: &str) -> Result<MaterialSpec, Problem> {
    let table = choice(node, path, MODELS, "model")?;
    let spec = MaterialSpec::deserialize(table).map_err(|error| {
        let message = error.to_string();
        Problem::new(&node.origin, format!("`{path}`: {}", message.trim()))
    })?;
    spec.validate().map_err(|error| {
        let at = format!("{}.{}", spec.name(), error.key());
        Problem::new(
            deepest(node, &at),
            format!("{path}.{}: {error}", spec.name()),
        )
    })?;
    Ok(spec)
}

/// Place of the value at a dotted path, as far down as it exists.
fn deepest<'n>(node: &'n Node, path: &str) -> &'n Origin {
    let mut found = node;
    for key in path.split('.') {
        match found.entry(key) {
            Some(entry) => found = &entry.node,
            None => break,
        }
    }
    &found.origin
}

/// A table with exactly one of the described names, which holds that choice's keys; in SI units.
fn choice(
    node: &Node,
    path: &str,
    choices: &'static [Description],
    what: &str,
) -> Result<toml::Value, Problem> {
    let names = choices.iter().map(|choice| choice.name);
    let entries = entries(node, path, &format!("a table with the name of a {what}"))?;
    let &[(name, table)] = &entries[..] else {
        let problem = match entries.get(1) {
            None => Problem::new(&node.origin, format!("`{path}` names no {what}")),
            Some((second, table)) => Problem::new(
                &table.origin,
                format!(
                    "`{path}` has `{}` and `{second}`, but needs exactly one {what}",
                    entries[0].0
                ),
            ),
        };
        return Err(problem.allowed("", names));
    };
    let Some(description) = choices.iter().find(|choice| choice.name == name) else {
        let origin = node
            .entry(name)
            .map_or(&node.origin, |entry| &entry.key_origin);
        let problem =
            Problem::new(origin, format!("unknown {what} `{name}` in {path}")).allowed(name, names);
        // `[material.copper]` followed by the parameters themselves is the usual slip.
        return Err(if matches!(table.value, Value::Table(_)) {
            problem
        } else {
            problem.help(format!(
                "the parameters belong in a table named after the {what}, e.g. [{path}.{}]",
                choices[0].name
            ))
        });
    };
    let inner = parameters(table, &format!("{path}.{name}"), description.keys)?;
    Ok(toml::Table::from_iter([(name.to_owned(), toml::Value::Table(inner))]).into())
}

fn parameters(node: &Node, path: &str, keys: &'static [Key]) -> Result<toml::Table, Problem> {
    for (name, _) in entries(node, path, "a table")? {
        if !keys.iter().any(|key| key.name == name) {
            let origin = node
                .entry(name)
                .map_or(&node.origin, |entry| &entry.key_origin);
            return Err(
                Problem::new(origin, format!("unknown key `{name}` in {path}"))
                    .allowed(name, keys.iter().map(|key| key.name)),
            );
        }
    }
    let mut table = toml::Table::new();
    for key in keys {
        let Some(entry) = node.entry(key.name) else {
            return Err(
                Problem::new(&node.origin, format!("`{}` is missing in {path}", key.name)).help(
                    format!(
                        "{}: {} ({})",
                        key.name,
                        key.meaning,
                        measure_of(key).description()
                    ),
                ),
            );
        };
        table.insert(
            key.name.to_owned(),
            parameter(&entry.node, &format!("{path}.{}", key.name), key)?,
        );
    }
    Ok(table)
}

fn parameter(node: &Node, path: &str, key: &Key) -> Result<toml::Value, Problem> {
    let measure = measure_of(key);
    match key.range {
        Range::OneOf(choices) => choice(node, path, choices, key.name),
        Range::Ascending => match &node.value {
            Value::Array(items) => items
                .iter()
                .map(|item| number(item, path, measure, Limit::Any).map(toml::Value::Float))
                .collect::<Result<Vec<_>, _>>()
                .map(toml::Value::Array),
            other => Err(Problem::new(
                &node.origin,
                format!(
                    "`{path}` must be an array of numbers, but is {}",
                    other.kind()
                ),
            )),
        },
        range => {
            let value = number(node, path, measure, Limit::Any)?;
            if range.contains(value) {
                return Ok(value.into());
            }
            Err(Problem::new(
                &node.origin,
                format!("`{path}` must be {range}, but is {value}"),
            ))
        }
    }
}

/// The material crate names units as this crate writes them.
fn measure_of(key: &Key) -> Measure {
    if key.unit == "-" {
        return Measure::NUMBER;
    }
    let (_, measure) = parse_unit(key.unit)
        .unwrap_or_else(|unit| panic!("{}: unit {unit} of the material crate", key.name));
    measure
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(descriptions: &[Description]) {
        for description in descriptions {
            for key in description.keys {
                if key.unit != "-" {
                    let (factor, _) = parse_unit(key.unit).expect(key.unit);
                    assert_eq!(
                        factor, 1.0,
                        "{}.{} is not in SI units",
                        description.name, key.name
                    );
                }
                if let Range::OneOf(choices) = key.range {
                    check(choices);
                }
            }
        }
    }

    #[test]
    fn every_unit_of_the_material_crate_is_an_si_unit_this_crate_knows() {
        check(MODELS);
    }

    #[test]
    fn every_shipped_material_survives_its_own_table() {
        for material in library() {
            let text = toml::to_string(&material.spec).expect("a table");
            let node = crate::document::parse(&text, &[]).expect("TOML");
            assert_eq!(
                read_material(&node, material.name).expect(material.name),
                material.spec
            );
        }
    }
}
