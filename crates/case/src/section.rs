//! Reading tables by their schema: types, units, limits, defaults and unknown keys in one place.

use std::borrow::Cow;

use jstsph_geometry::Dimension;
use jstsph_tensor::Vec3;

use crate::document::{self, Node, Value};
use crate::error::{Origin, Problem};
use crate::schema::{Key, Kind, Presence};
use crate::value::{components, count, number, per_axis, to_integer, vector, wrong_type};

/// A table being read, and beside it the same table with every default written out in SI units.
pub(crate) struct Section<'a> {
    node: &'a Node,
    path: String,
    keys: &'static [Key],
    resolved: toml::Table,
}

/// A value with its schema.
#[derive(Clone)]
pub(crate) struct Field<'a> {
    pub(crate) node: Cow<'a, Node>,
    pub(crate) path: String,
    pub(crate) kind: Kind,
}

impl<'a> Section<'a> {
    /// Opens a table and refuses keys that the schema does not know.
    pub(crate) fn open(node: &'a Node, path: &str, keys: &'static [Key]) -> Result<Self, Problem> {
        let Value::Table(entries) = &node.value else {
            return Err(
                wrong_type(node, path, "a table").allowed("", keys.iter().map(|key| key.name))
            );
        };
        for entry in entries {
            if !keys.iter().any(|key| key.name == entry.key) {
                let place = if path.is_empty() {
                    "at the top level".to_owned()
                } else {
                    format!("in {path}")
                };
                return Err(Problem::new(
                    &entry.key_origin,
                    format!("unknown key `{}` {place}", entry.key),
                )
                .allowed(&entry.key, keys.iter().map(|key| key.name)));
            }
        }
        Ok(Self {
            node,
            path: path.to_owned(),
            keys,
            resolved: toml::Table::new(),
        })
    }

    /// Place of the table.
    pub(crate) fn origin(&self) -> &'a Origin {
        &self.node.origin
    }

    /// Dotted path of the table.
    pub(crate) fn path(&self) -> &str {
        &self.path
    }

    /// Calls the table by another path from now on.
    pub(crate) fn rename(&mut self, path: String) {
        self.path = path;
    }

    fn key(&self, name: &str) -> &'static Key {
        let found = self.keys.iter().find(|key| key.name == name);
        found.unwrap_or_else(|| panic!("`{name}` is not in the schema of `{}`", self.path))
    }

    fn path_of(&self, name: &str) -> String {
        if self.path.is_empty() {
            name.to_owned()
        } else {
            format!("{}.{name}", self.path)
        }
    }

    /// Whether the key is written.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.node.entry(name).is_some()
    }

    /// The node of a table key, when it is written.
    pub(crate) fn node(&self, name: &str) -> Option<&'a Node> {
        self.node.entry(name).map(|entry| &entry.node)
    }

    /// The value of a key or its constant default.
    pub(crate) fn field(&self, name: &str) -> Result<Option<Field<'a>>, Problem> {
        let key = self.key(name);
        let node = match (self.node(name), key.presence) {
            (Some(node), _) => Cow::Borrowed(node),
            (None, Presence::Required) => return Err(self.missing(name)),
            (None, Presence::Default(text)) => {
                Cow::Owned(document::default_value(text, self.origin()))
            }
            (None, Presence::Optional | Presence::Derived(_)) => return Ok(None),
        };
        Ok(Some(Field {
            node,
            path: self.path_of(name),
            kind: key.kind,
        }))
    }

    /// The value of a key that must be there or has a constant default.
    pub(crate) fn need(&self, name: &str) -> Result<Field<'a>, Problem> {
        self.field(name)?.ok_or_else(|| self.missing(name))
    }

    fn missing(&self, name: &str) -> Problem {
        let place = if self.path.is_empty() {
            "the case".to_owned()
        } else {
            self.path.clone()
        };
        let key = self.key(name);
        Problem::new(self.origin(), format!("`{name}` is missing in {place}")).help(format!(
            "{name}: {} ({})",
            key.meaning,
            key.kind.description()
        ))
    }

    /// A problem with the value of a key, or with the table when the key is not written.
    pub(crate) fn problem(&self, name: &str, message: impl Into<String>) -> Problem {
        let origin = self.node(name).map_or(self.origin(), |node| &node.origin);
        Problem::new(origin, message)
    }

    /// Notes the value of a key in the resolved case.
    pub(crate) fn record(&mut self, name: &str, value: impl Into<toml::Value>) {
        let key = self.key(name);
        self.resolved.insert(key.name.to_owned(), value.into());
    }

    /// The resolved table.
    pub(crate) fn finish(self) -> toml::Table {
        self.resolved
    }

    /// A number that must be there or has a constant default.
    pub(crate) fn number(&mut self, name: &str) -> Result<f64, Problem> {
        let value = self.need(name)?.number()?;
        self.record(name, value);
        Ok(value)
    }

    /// A number, or the given one.
    pub(crate) fn number_or(&mut self, name: &str, otherwise: f64) -> Result<f64, Problem> {
        let value = self
            .field(name)?
            .map_or(Ok(otherwise), |field| field.number())?;
        self.record(name, value);
        Ok(value)
    }

    /// An integer, when it is written or has a constant default.
    pub(crate) fn count(&mut self, name: &str) -> Result<Option<usize>, Problem> {
        let Some(field) = self.field(name)? else {
            return Ok(None);
        };
        let value = field.count()?;
        self.record(name, to_integer(value));
        Ok(Some(value))
    }

    /// A flag that must be there or has a constant default.
    pub(crate) fn flag(&mut self, name: &str) -> Result<bool, Problem> {
        let value = self.need(name)?.flag()?;
        self.record(name, value);
        Ok(value)
    }

    /// A flag, or the given one.
    pub(crate) fn flag_or(&mut self, name: &str, otherwise: bool) -> Result<bool, Problem> {
        let value = self
            .field(name)?
            .map_or(Ok(otherwise), |field| field.flag())?;
        self.record(name, value);
        Ok(value)
    }

    /// A text that must be there or has a constant default.
    pub(crate) fn text(&mut self, name: &str) -> Result<String, Problem> {
        let value = self.need(name)?.text()?.to_owned();
        self.record(name, value.as_str());
        Ok(value)
    }

    /// A choice that must be there or has a constant default.
    pub(crate) fn choice<T: Copy>(
        &mut self,
        name: &str,
        choices: &[(&str, T)],
    ) -> Result<T, Problem> {
        let (text, value) = self.need(name)?.choice(choices)?;
        self.record(name, text);
        Ok(value)
    }

    /// A choice, or the one with the given name.
    pub(crate) fn choice_or<T: Copy>(
        &mut self,
        name: &str,
        choices: &[(&str, T)],
        otherwise: &str,
    ) -> Result<T, Problem> {
        if self.has(name) {
            return self.choice(name, choices);
        }
        let found = choices.iter().find(|(text, _)| *text == otherwise);
        let (text, value) =
            found.unwrap_or_else(|| panic!("`{otherwise}` is no choice of `{name}`"));
        self.record(name, *text);
        Ok(*value)
    }

    /// A position or direction that must be there.
    pub(crate) fn vector(&mut self, name: &str, dimension: Dimension) -> Result<Vec3, Problem> {
        let value = self.need(name)?.vector(dimension)?;
        self.record(name, components(&value, dimension));
        Ok(value)
    }

    /// A direction that must be there, made a unit vector.
    pub(crate) fn direction(&mut self, name: &str, dimension: Dimension) -> Result<Vec3, Problem> {
        let value = self.vector(name, dimension)?;
        value.try_normalize(f64::MIN_POSITIVE).ok_or_else(|| {
            self.problem(
                name,
                format!(
                    "`{}` must not be zero: it gives a direction",
                    self.path_of(name)
                ),
            )
        })
    }

    /// The one of these keys that is written.
    pub(crate) fn one_of(&self, names: &[&'static str]) -> Result<&'static str, Problem> {
        let written: Vec<&'static str> = names
            .iter()
            .copied()
            .filter(|name| self.has(name))
            .collect();
        match written[..] {
            [name] => Ok(name),
            [] => Err(Problem::new(
                self.origin(),
                format!("{} needs one of: {}", self.path, names.join(", ")),
            )),
            [first, second, ..] => Err(self.problem(
                second,
                format!(
                    "{} has both `{first}` and `{second}`, but needs exactly one of: {}",
                    self.path,
                    names.join(", ")
                ),
            )),
        }
    }

    /// The single entry of a table that must hold exactly one of its schema's keys.
    pub(crate) fn variant(&self) -> Result<&'static str, Problem> {
        let names: Vec<&'static str> = self.keys.iter().map(|key| key.name).collect();
        self.one_of(&names)
    }
}

impl<'a> Field<'a> {
    /// Place of the value.
    pub(crate) fn origin(&self) -> &Origin {
        &self.node.origin
    }

    /// A problem with this value.
    pub(crate) fn problem(&self, message: impl Into<String>) -> Problem {
        Problem::new(&self.node.origin, message)
    }

    fn wrong_type(&self, wanted: &str) -> Problem {
        wrong_type(&self.node, &self.path, wanted)
    }

    /// Number in SI units, checked against the schema.
    pub(crate) fn number(&self) -> Result<f64, Problem> {
        match self.kind {
            Kind::Number(measure, limit) => number(&self.node, &self.path, measure, limit),
            other => panic!(
                "`{}` is read as a number but is {}",
                self.path,
                other.description()
            ),
        }
    }

    /// Integer, checked against the schema.
    pub(crate) fn count(&self) -> Result<usize, Problem> {
        let least = if let Kind::Count(least) = self.kind {
            least
        } else {
            0
        };
        count(&self.node, &self.path, least)
    }

    /// `true` or `false`.
    pub(crate) fn flag(&self) -> Result<bool, Problem> {
        match self.node.value {
            Value::Boolean(flag) => Ok(flag),
            _ => Err(self.wrong_type("true or false")),
        }
    }

    /// A text.
    pub(crate) fn text(&self) -> Result<&str, Problem> {
        match &self.node.value {
            Value::Text(text) => Ok(text),
            _ => Err(self.wrong_type("a text")),
        }
    }

    /// One of the named values.
    pub(crate) fn choice<T: Copy, N: AsRef<str> + Clone>(
        &self,
        choices: &[(N, T)],
    ) -> Result<(String, T), Problem> {
        let Value::Text(text) = &self.node.value else {
            let names: Vec<&str> = choices.iter().map(|(name, _)| name.as_ref()).collect();
            return Err(self.wrong_type(&format!("one of: {}", names.join(", "))));
        };
        match choices.iter().find(|(name, _)| name.as_ref() == text) {
            Some((_, value)) => Ok((text.clone(), *value)),
            None => Err(self
                .problem(format!("`{}` cannot be \"{text}\"", self.path))
                .allowed(text, choices.iter().map(|(name, _)| name.as_ref()))),
        }
    }

    /// Items of an array, each under the path of the array.
    pub(crate) fn items(&self) -> Result<Vec<&Node>, Problem> {
        match &self.node.value {
            Value::Array(items) => Ok(items.iter().collect()),
            _ => Err(self.wrong_type("an array")),
        }
    }

    /// One number per axis.
    pub(crate) fn vector(&self, dimension: Dimension) -> Result<Vec3, Problem> {
        match self.kind {
            Kind::Vector(measure) => vector(&self.node, &self.path, measure, dimension),
            other => panic!(
                "`{}` is read as a vector but is {}",
                self.path,
                other.description()
            ),
        }
    }

    /// Items of an array with one entry per axis.
    pub(crate) fn per_axis(&self, dimension: Dimension) -> Result<Vec<&Node>, Problem> {
        per_axis(&self.node, &self.path, dimension)
    }
}
