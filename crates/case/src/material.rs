//! Materials: tables of the case converted to SI, and the shipped parameter sets.

use jstsph_material::{Description, Key, MODELS, MaterialSpec, NamedMaterial, Range, library};
use serde::Deserialize;

use crate::document::{Node, Value};
use crate::error::{Origin, Problem};
use crate::schema::Limit;
use crate::section::Field;
use crate::units::{Measure, parse_unit};
use crate::value::{number, wrong_type};

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
            if key.optional {
                continue;
            }
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
        Range::Table(keys) => parameters(node, path, keys).map(toml::Value::Table),
        Range::Flag => match node.value {
            Value::Boolean(flag) => Ok(flag.into()),
            _ => Err(wrong_type(node, path, "true or false")),
        },
        Range::Ascending => list(node, path, measure),
        Range::InTemperature(range) => match &node.value {
            Value::Table(_) => in_temperature(node, path, key),
            _ => single(node, path, measure, *range),
        },
        range => single(node, path, measure, range),
    }
}

/// A number in its range.
fn single(node: &Node, path: &str, measure: Measure, range: Range) -> Result<toml::Value, Problem> {
    let value = number(node, path, measure, Limit::Any)?;
    if range.contains(value) {
        return Ok(value.into());
    }
    Err(Problem::new(
        &node.origin,
        format!("`{path}` must be {range}, but is {value}"),
    ))
}

/// An array of numbers. Their range is the material's to check.
fn list(node: &Node, path: &str, measure: Measure) -> Result<toml::Value, Problem> {
    match &node.value {
        Value::Array(items) => items
            .iter()
            .map(|item| number(item, path, measure, Limit::Any).map(toml::Value::Float))
            .collect::<Result<Vec<_>, _>>()
            .map(toml::Value::Array),
        _ => Err(wrong_type(node, path, "an array of numbers")),
    }
}

/// `{ temperatures = [...], values = [...] }`.
fn in_temperature(node: &Node, path: &str, key: &Key) -> Result<toml::Value, Problem> {
    const LISTS: [&str; 2] = ["temperatures", "values"];
    for (name, value) in entries(node, path, "a table")? {
        if !LISTS.contains(&name) {
            return Err(
                Problem::new(&value.origin, format!("unknown key `{name}` in {path}"))
                    .allowed(name, LISTS),
            );
        }
    }
    let column = |name: &str, measure| {
        let entry = node.entry(name).ok_or_else(|| {
            Problem::new(&node.origin, format!("`{name}` is missing in {path}")).help(
                "a property that depends on the temperature is { temperatures = [...], values = [...] }, \
                 of the same length",
            )
        })?;
        list(&entry.node, &format!("{path}.{name}"), measure)
    };
    let temperatures = column(LISTS[0], Measure::TEMPERATURE)?;
    let values = column(LISTS[1], measure_of(key))?;
    Ok(toml::Table::from_iter([
        (LISTS[0].to_owned(), temperatures),
        (LISTS[1].to_owned(), values),
    ])
    .into())
}

/// The material crate names units as this crate writes them.
pub(crate) fn measure_of(key: &Key) -> Measure {
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
    use jstsph_material::Property;

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
                match key.range {
                    Range::OneOf(choices) => check(choices),
                    Range::Table(keys) => check(&[Description {
                        name: key.name,
                        summary: key.meaning,
                        keys,
                    }]),
                    _ => {}
                }
            }
        }
    }

    const WARM: &str = r#"
[hencky_von_mises]
density = 2700
young_modulus = { temperatures = ["20 degC", "400 degC"], values = ["70 GPa", "50 GPa"] }
poisson_ratio = 0.33
thermal = { heat_capacity = "0.9 kJ/kg/K", conductivity = "180 W/m/K", taylor_quinney = 0.9, expansion = "23e-6 1/K", reference_temperature = "20 degC" }
hardening = { johnson_cook = { a = "420 MPa", b = "465 MPa", n = 0.5, c = 0.08, m = 0.86, reference_rate = "0.1 1/s", reference_temperature = "25 degC", melting_temperature = "641 degC" } }
"#;

    fn read(text: &str) -> Result<MaterialSpec, String> {
        let node = crate::document::parse(text, &Origin::File).expect("TOML");
        read_material(&node, "material.al").map_err(|problem| problem.message)
    }

    #[test]
    fn thermal_properties_have_units_and_may_depend_on_the_temperature() {
        let MaterialSpec::HenckyVonMises(metal) = read(WARM).expect("sound") else {
            panic!("another model")
        };
        assert_eq!(
            metal.young_modulus,
            Property::Table {
                temperatures: vec![293.15, 673.15],
                values: vec![70e9, 50e9],
            }
        );
        let thermal = metal.thermal.expect("given");
        assert_eq!(thermal.heat_capacity, Property::Constant(900.0));
        assert_eq!(thermal.conductivity, Property::Constant(180.0));
        assert_eq!(thermal.reference_temperature, 293.15);
    }

    #[test]
    fn damage_and_equation_of_state_survive_their_table_and_miss_what_they_need() {
        let shocked = WARM.replace("\"23e-6 1/K\"", "0")
            + "damage = { johnson_cook = { d1 = 0.05, d2 = 3.44, d3 = -2.12, d4 = 0.002, d5 = 0.61, \
               reference_rate = 1, reference_temperature = 293, melting_temperature = 900 } }\n\
               equation_of_state = { mie_grueneisen = { c0 = \"5.35 km/s\", s = 1.34, gamma0 = 2.0 } }\n";
        let spec = read(&shocked).expect("sound");
        let text = toml::to_string(&spec).expect("a table");
        assert_eq!(read(&text).expect("its own table"), spec);
        let error = read(&shocked.replace("expansion = 0", "expansion = 1e-5")).expect_err("both");
        assert!(
            error.contains("equation_of_state.mie_grueneisen needs thermal.expansion = 0"),
            "{error}"
        );
    }

    #[test]
    fn problems_inside_nested_tables_name_their_key() {
        for (from, to, message) in [
            (
                "taylor_quinney = 0.9",
                "taylor_quinney = 1.5",
                "`material.al.hencky_von_mises.thermal.taylor_quinney` must be at least 0 and at most 1, but is 1.5",
            ),
            (
                "conductivity = \"180 W/m/K\"",
                "conductivity = \"180 W/m\"",
                "`material.al.hencky_von_mises.thermal.conductivity` must be a conductivity (W/m/K), but \"180 W/m\" is",
            ),
            (
                "conductivity = \"180 W/m/K\", ",
                "",
                "`conductivity` is missing in material.al.hencky_von_mises.thermal",
            ),
            (
                "expansion = ",
                "expantion = ",
                "unknown key `expantion` in material.al.hencky_von_mises.thermal",
            ),
            (
                "\"400 degC\"",
                "\"20 degC\"",
                "young_modulus.temperatures = 293.15 must be greater than 293.15",
            ),
            (
                "\"50 GPa\"",
                "-50",
                "young_modulus.values = -50 is out of range: it must be greater than 0",
            ),
            (
                "values = [\"70 GPa\", \"50 GPa\"]",
                "values = [\"70 GPa\"]",
                "young_modulus.values has 1 entries and temperatures has 2",
            ),
            (
                ", values = [\"70 GPa\", \"50 GPa\"]",
                "",
                "`values` is missing in material.al.hencky_von_mises.young_modulus",
            ),
            (
                "m = 0.86",
                "m = 0.86, slow_rates_soften = 1",
                "must be true or false",
            ),
            ("\"641 degC\"", "\"20 degC\"", "melting_temperature"),
        ] {
            assert!(WARM.contains(from), "{from}");
            let error = read(&WARM.replacen(from, to, 1)).expect_err(to);
            assert!(error.contains(message), "{to}: {error}");
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
            let node = crate::document::parse(&text, &Origin::File).expect("TOML");
            assert_eq!(
                read_material(&node, material.name).expect(material.name),
                material.spec
            );
        }
    }
}
