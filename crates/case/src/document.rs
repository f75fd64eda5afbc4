//! A TOML document whose every value remembers where it was written, with overrides applied.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::error::{Origin, Problem};
use crate::units::Measure;

/// A value and its place.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub(crate) value: Value,
    pub(crate) origin: Origin,
}

/// What a [`Node`] holds.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    Boolean(bool),
    Integer(i64),
    Float(f64),
    Text(String),
    Array(Vec<Node>),
    Table(Vec<Entry>),
    Date,
    /// What an expression of parameters (`"= 2 * radius"`) came to.
    Calculated(Calculated),
}

/// A number in SI units with its dimension, and the expression it comes from.
#[derive(Clone, Debug)]
pub(crate) struct Calculated {
    pub(crate) value: f64,
    pub(crate) measure: Measure,
    pub(crate) text: String,
}

/// One key of a table.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub(crate) key: String,
    pub(crate) key_origin: Origin,
    pub(crate) node: Node,
}

impl Value {
    /// What the value is called in messages.
    pub(crate) fn kind(&self) -> &'static str {
        match self {
            Self::Boolean(_) => "a boolean",
            Self::Integer(_) => "an integer",
            Self::Float(_) => "a number",
            Self::Text(_) => "a text",
            Self::Array(_) => "an array",
            Self::Table(_) => "a table",
            Self::Date => "a date",
            Self::Calculated(_) => "a calculated number",
        }
    }
}

impl Node {
    /// Entry of a table, if this is one and has it.
    pub(crate) fn entry(&self, key: &str) -> Option<&Entry> {
        match &self.value {
            Value::Table(entries) => entries.iter().find(|entry| entry.key == key),
            _ => None,
        }
    }
}

/// Reads the text of a case; `origin` makes places of byte ranges.
pub(crate) fn parse(
    text: &str,
    origin: &dyn Fn(std::ops::Range<usize>) -> Origin,
) -> Result<Node, Problem> {
    let table = DeTable::parse(text).map_err(|error| {
        let origin = origin(error.span().unwrap_or(0..0));
        let mut lines = error.message().lines();
        let problem = Problem::new(
            &origin,
            format!("not TOML: {}", lines.next().unwrap_or("unreadable")),
        );
        lines.fold(problem, |problem, line| problem.help(line.trim()))
    })?;
    table_node(table.get_ref(), origin, table.span())
}

/// Applies override number `index`, `(dotted key, value)`.
pub(crate) fn set(
    document: &mut Node,
    index: usize,
    (key, value): &(String, String),
) -> Result<(), Problem> {
    let node = override_value(value, index)?;
    place(document, key, key.split('.'), node, index)
}

type OriginOf<'a> = &'a dyn Fn(std::ops::Range<usize>) -> Origin;

fn table_node(
    table: &DeTable<'_>,
    origin: OriginOf<'_>,
    span: std::ops::Range<usize>,
) -> Result<Node, Problem> {
    let entries = table
        .iter()
        .map(|(key, value)| {
            Ok(Entry {
                key: key.get_ref().to_string(),
                key_origin: origin(key.span()),
                node: node(value, origin)?,
            })
        })
        .collect::<Result<_, Problem>>()?;
    Ok(Node {
        value: Value::Table(entries),
        origin: origin(span),
    })
}

fn node(value: &Spanned<DeValue<'_>>, origin: OriginOf<'_>) -> Result<Node, Problem> {
    let place = origin(value.span());
    let bad = |text: &str| Problem::new(&place, format!("`{text}` is out of range"));
    let value = match value.get_ref() {
        DeValue::Table(table) => return table_node(table, origin, value.span()),
        DeValue::Boolean(flag) => Value::Boolean(*flag),
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Datetime(_) => Value::Date,
        DeValue::Array(items) => Value::Array(
            items
                .iter()
                .map(|item| node(item, origin))
                .collect::<Result<_, _>>()?,
        ),
        DeValue::Integer(integer) => Value::Integer(
            i64::from_str_radix(integer.as_str(), integer.radix())
                .map_err(|_| bad(integer.as_str()))?,
        ),
        DeValue::Float(float) => {
            Value::Float(float.as_str().parse().map_err(|_| bad(float.as_str()))?)
        }
    };
    Ok(Node {
        value,
        origin: place,
    })
}

/// The value of an override: TOML where it is TOML, a text where it is not (`45 ms`).
fn override_value(text: &str, index: usize) -> Result<Node, Problem> {
    let origin = move |_| Origin::Override(index);
    match DeValue::parse(text) {
        Ok(value) => node(&value, &origin),
        Err(_) => Ok(Node {
            value: Value::Text(text.trim().to_owned()),
            origin: Origin::Override(index),
        }),
    }
}

/// The node of a default, which the schema writes as TOML; it stands where its table stands.
pub(crate) fn default_value(text: &str, origin: &Origin) -> Node {
    let value = DeValue::parse(text).expect("a test reads every default of the schema");
    node(&value, &|_| origin.clone()).expect("a test reads every default of the schema")
}

/// Puts a node at a dotted path. Tables on the way are made; items of arrays are named by their
/// number (from 0) or by their `name`.
fn place<'a>(
    target: &mut Node,
    path: &str,
    mut keys: impl Iterator<Item = &'a str> + Clone,
    node: Node,
    index: usize,
) -> Result<(), Problem> {
    let origin = Origin::Override(index);
    let Some(key) = keys.next() else {
        *target = node;
        return Ok(());
    };
    if key.is_empty() {
        return Err(Problem::new(
            &origin,
            format!("`{path}` is not a dotted key such as time.end"),
        ));
    }
    match &mut target.value {
        Value::Table(entries) => {
            let at = entries
                .iter()
                .position(|entry| entry.key == key)
                .unwrap_or_else(|| {
                    entries.push(Entry {
                        key: key.to_owned(),
                        key_origin: origin.clone(),
                        node: Node {
                            value: Value::Table(Vec::new()),
                            origin: origin.clone(),
                        },
                    });
                    entries.len() - 1
                });
            place(&mut entries[at].node, path, keys, node, index)
        }
        Value::Array(items) => {
            let names: Vec<String> = items
                .iter()
                .enumerate()
                .map(|(i, item)| item_name(item, i))
                .collect();
            let at = match key.parse::<usize>() {
                Ok(number) if number < items.len() => Some(number),
                _ => names.iter().position(|name| name == key),
            };
            match at {
                Some(at) => place(&mut items[at], path, keys, node, index),
                None => Err(Problem::new(
                    &origin,
                    format!("`{key}` in `{path}` is no item of that list"),
                )
                .allowed(key, names.iter().map(String::as_str))
                .help(format!(
                    "numbers run from 0 to {}",
                    items.len().saturating_sub(1)
                ))),
            }
        }
        other => Err(Problem::new(
            &origin,
            format!(
                "`{path}` goes through {}, which has no `{key}`",
                other.kind()
            ),
        )),
    }
}

fn item_name(item: &Node, number: usize) -> String {
    match item.entry("name").map(|entry| &entry.node.value) {
        Some(Value::Text(name)) => name.clone(),
        _ => number.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str =
        "[time]\nend = \"45 ms\"\n[[body]]\nname = \"billet\"\nlattice = { counts = [8, 50] }\n";

    fn with(key: &str, value: &str) -> Result<Node, Problem> {
        let mut document = parse(TEXT, &Origin::File)?;
        set(&mut document, 0, &(key.to_owned(), value.to_owned()))?;
        Ok(document)
    }

    fn get<'a>(node: &'a Node, path: &str) -> &'a Node {
        path.split('.').fold(node, |node, key| match &node.value {
            Value::Array(items) => &items[key.parse::<usize>().expect("a number")],
            _ => &node.entry(key).unwrap_or_else(|| panic!("no {key}")).node,
        })
    }

    #[test]
    fn values_remember_their_place() {
        let document = parse(TEXT, &Origin::File).expect("valid");
        let end = get(&document, "time.end");
        let Origin::File(range) = &end.origin else {
            panic!("in the file")
        };
        assert_eq!(&TEXT[range.clone()], "\"45 ms\"");
    }

    #[test]
    fn overrides_replace_by_path_number_and_name() {
        for key in ["body.0.lattice.counts", "body.billet.lattice.counts"] {
            let document = with(key, "[4, 22]").expect(key);
            let counts = get(&document, "body.0.lattice.counts");
            assert_eq!(counts.origin, Origin::Override(0));
            assert!(
                matches!(&counts.value, Value::Array(items) if matches!(items[1].value, Value::Integer(22)))
            );
        }
        let document = with("time.end", "10 ms").expect("bare text");
        assert!(matches!(&get(&document, "time.end").value, Value::Text(text) if text == "10 ms"));
        let document = with("scheme.kernel", "wendland-c2").expect("tables are made");
        assert!(
            matches!(&get(&document, "scheme.kernel").value, Value::Text(text) if text == "wendland-c2")
        );
    }

    #[test]
    fn impossible_override_paths_say_why() {
        let problem = with("body.bilet.material", "x").expect_err("no such body");
        assert!(
            problem.message.contains("`bilet` in `body.bilet.material`"),
            "{problem:?}"
        );
        assert!(
            problem.help.contains(&"did you mean `billet`?".to_owned()),
            "{problem:?}"
        );
        let problem = with("time.end.value", "1").expect_err("through a text");
        assert!(
            problem
                .message
                .contains("goes through a text, which has no `value`"),
            "{problem:?}"
        );
        assert!(with("time..end", "1").is_err());
    }

    #[test]
    fn broken_toml_is_located() {
        let problem = parse("a = 1\nb = = 2\n", &Origin::File).expect_err("not TOML");
        assert!(problem.message.starts_with("not TOML"), "{problem:?}");
        assert!(matches!(problem.origin, Origin::File(range) if (10..=11).contains(&range.start)));
    }
}
