//! The JSON Schema of a case file, made from the tables by which it is read.

use jstsph_material::{Description, MODELS, Range};
use serde_json::{Map, Value, json};

use crate::material::measure_of;
use crate::schema::{self, Form, Key, Kind, Limit, Presence};
use crate::units::{CELSIUS, Measure, PREFIXES, UNITS};

/// A number as JSON Schema's regular expressions see it.
const NUMBER: &str = r"[-+]?([0-9]+[.]?[0-9]*|[.][0-9]+)([eE][-+]?[0-9]+)?";
/// A text that is an expression of parameters.
const CALCULATED: &str = "^ *=";
/// Sets of keys of which a table has exactly one.
const EXCLUSIVE: &[&[&str]] = &[
    schema::CONDITIONS,
    schema::FILLINGS,
    schema::OBSTACLE_FORMS,
    schema::PROBE_QUANTITIES,
];

/// JSON Schema (draft 2020-12) of a case file, indented.
///
/// It knows every key, which keys are required or exclude each other, limits of plain numbers and,
/// for single units, their dimension (`"45 mm"` is no time). What needs more than one place of the
/// file, such as names of bodies or compound units, is left to [`parse`](crate::parse).
#[must_use]
pub fn json_schema() -> String {
    let mut writer = Writer {
        definitions: Map::new(),
    };
    let mut root = writer.table(schema::CASE);
    writer.define("shape", |writer| writer.one_of(schema::SHAPES));
    writer.define("selection", Writer::selection);
    let head = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": concat!("https://jstsph.org/schema/", env!("CARGO_PKG_VERSION"), "/case.json"),
        "title": "Case file of jstsph",
        "description": "Plain numbers are in SI units; texts carry their unit (\"8 mm\") or are expressions of parameters (\"= 2 * radius\").",
    });
    if let (Value::Object(root), Value::Object(head)) = (&mut root, head) {
        root.extend(head);
        root.insert("$defs".to_owned(), Value::Object(writer.definitions));
    }
    let mut text = serde_json::to_string_pretty(&root).expect("names and numbers are always JSON");
    text.push('\n');
    text
}

struct Writer {
    definitions: Map<String, Value>,
}

impl Writer {
    /// Makes a definition once.
    fn define(&mut self, name: &str, make: impl FnOnce(&mut Self) -> Value) -> Value {
        if !self.definitions.contains_key(name) {
            // The place is taken first: definitions may contain themselves.
            self.definitions.insert(name.to_owned(), Value::Null);
            let made = make(self);
            self.definitions.insert(name.to_owned(), made);
        }
        json!({ "$ref": format!("#/$defs/{name}") })
    }

    fn table(&mut self, keys: &[Key]) -> Value {
        let mut properties = Map::new();
        for key in keys {
            let mut value = self.kind(&key.kind);
            describe(
                &mut value,
                &format!("{} ({})", key.meaning, key.kind.description()),
            );
            if let Presence::Default(text) = key.presence
                && let Ok(default) = text.parse::<toml::Value>()
                && let Some(object) = value.as_object_mut()
            {
                object.insert("default".to_owned(), json!(default));
            }
            properties.insert(key.name.to_owned(), value);
        }
        let required: Vec<&str> = keys
            .iter()
            .filter(|key| key.presence == Presence::Required)
            .map(|key| key.name)
            .collect();
        let mut table = json!({
            "type": "object",
            "properties": properties,
            "required": required,
            "additionalProperties": false,
        });
        let has = |name: &&str| keys.iter().any(|key| key.name == *name);
        if let Some(set) = EXCLUSIVE.iter().find(|set| set.iter().all(&has)) {
            table["oneOf"] = exactly_one(set);
        }
        table
    }

    /// A table with exactly one of the keys.
    fn one_of(&mut self, keys: &[Key]) -> Value {
        let mut table = self.table(keys);
        table["minProperties"] = json!(1);
        table["maxProperties"] = json!(1);
        table
    }

    fn kind(&mut self, kind: &Kind) -> Value {
        match *kind {
            Kind::Number(measure, limit) => self.number(measure, limits(limit)),
            Kind::Count(least) => any_of([
                json!({ "type": "integer", "minimum": least }),
                json!({ "type": "string", "pattern": CALCULATED }),
            ]),
            Kind::Flag => json!({ "type": "boolean" }),
            Kind::Text => json!({ "type": "string" }),
            Kind::Choice(names) => json!({ "enum": names() }),
            Kind::Vector(measure) => {
                let item = self.number(measure, Map::new());
                json!({ "type": "array", "items": item, "minItems": 2, "maxItems": 3 })
            }
            Kind::Signal(measure) => self.signal(measure),
            Kind::Signals(measure) => {
                let item = self.signal(measure);
                json!({ "type": "array", "items": item, "minItems": 2, "maxItems": 3 })
            }
            Kind::OneOf(_) => json!({ "$ref": "#/$defs/shape" }),
            Kind::Table(keys) => self.table(keys),
            Kind::Tables(keys) => {
                let item = self.table(keys);
                json!({ "type": "array", "items": item })
            }
            Kind::TableOr(keys, _, other) => {
                let table = self.table(keys);
                any_of([table, self.kind(other)])
            }
            Kind::Other(_, form) => self.form(form),
        }
    }

    fn form(&mut self, form: Form) -> Value {
        let list = |item: Value, least: usize| json!({ "type": "array", "items": item, "minItems": least });
        match form {
            Form::Materials => {
                let model = self.choice(MODELS);
                json!({ "type": "object", "additionalProperties": model })
            }
            Form::Parameters => json!({
                "type": "object",
                "additionalProperties": { "type": ["number", "string"] },
            }),
            Form::Paths => list(json!({ "type": "string" }), 0),
            Form::Selection => self.define("selection", Self::selection),
            Form::Selections => list(self.define("selection", Self::selection), 1),
            Form::Shapes => list(json!({ "$ref": "#/$defs/shape" }), 2),
            Form::Points => {
                let item = self.number(Measure::LENGTH, Map::new());
                list(
                    json!({ "type": "array", "items": item, "minItems": 2, "maxItems": 2 }),
                    2,
                )
            }
            Form::Radii => list(self.number(Measure::LENGTH, limits(Limit::NotNegative)), 0),
            Form::Interval => {
                let item = self.number(Measure::LENGTH, Map::new());
                json!({ "type": "array", "items": item, "minItems": 2, "maxItems": 2 })
            }
            Form::Counts => {
                let item = self.kind(&Kind::Count(1));
                json!({ "type": "array", "items": item, "minItems": 2, "maxItems": 3 })
            }
            Form::Direction => {
                let item = self.number(Measure::NUMBER, Map::new());
                json!({ "type": "array", "items": item, "minItems": 3, "maxItems": 3 })
            }
            Form::TimeTable => list(
                json!({ "type": "array", "items": { "type": ["number", "string"] }, "minItems": 2, "maxItems": 2 }),
                1,
            ),
            Form::Fields => list(json!({ "enum": crate::schema::FRAME_FIELDS }), 0),
            Form::Axes => any_of([
                json!({ "enum": ["x", "y", "z"] }),
                list(json!({ "enum": ["x", "y", "z"] }), 1),
            ]),
        }
    }

    /// A plain number within its limits, or a text with a unit of this dimension.
    fn number(&mut self, measure: Measure, mut limits: Map<String, Value>) -> Value {
        let text = self.define(&format!("{}_as_text", measure.word()), |_| {
            json!({
                "type": "string",
                "pattern": quantity_pattern(measure),
                "description": format!("as a text: {}", measure.description()),
            })
        });
        limits.insert("type".to_owned(), json!("number"));
        any_of([Value::Object(limits), text])
    }

    fn signal(&mut self, measure: Measure) -> Value {
        let constant = self.number(measure, Map::new());
        let varying = self.define("signal", |writer| writer.one_of(schema::SIGNAL));
        any_of([constant, varying])
    }

    fn selection(&mut self) -> Value {
        let mut table = self.table(schema::SELECTION);
        let names: Vec<&str> = schema::SELECTION
            .iter()
            .map(|key| key.name)
            .filter(|name| *name != "body")
            .collect();
        table["oneOf"] = exactly_one(&names);
        any_of([json!({ "type": "string" }), table])
    }

    /// A table with exactly one of the described names.
    fn choice(&mut self, choices: &[Description]) -> Value {
        let mut properties = Map::new();
        for choice in choices {
            let mut table = self.parameters(choice.keys);
            describe(&mut table, choice.summary);
            properties.insert(choice.name.to_owned(), table);
        }
        json!({
            "type": "object",
            "properties": properties,
            "additionalProperties": false,
            "minProperties": 1,
            "maxProperties": 1,
        })
    }

    fn parameters(&mut self, keys: &[jstsph_material::Key]) -> Value {
        let mut properties = Map::new();
        for key in keys {
            let mut value = self.parameter(key, key.range);
            describe(
                &mut value,
                &format!("{} ({}, {})", key.meaning, key.unit, key.range),
            );
            properties.insert(key.name.to_owned(), value);
        }
        let required: Vec<&str> = keys
            .iter()
            .filter(|key| !key.optional)
            .map(|key| key.name)
            .collect();
        json!({
            "type": "object",
            "properties": properties,
            "required": required,
            "additionalProperties": false,
        })
    }

    fn parameter(&mut self, key: &jstsph_material::Key, range: Range) -> Value {
        let column = |item: Value| json!({ "type": "array", "items": item });
        match range {
            Range::OneOf(choices) => self.choice(choices),
            Range::Table(keys) => self.parameters(keys),
            Range::Flag => json!({ "type": "boolean" }),
            Range::Ascending => column(self.number(measure_of(key), limits(Limit::NotNegative))),
            Range::InTemperature(range) => {
                let single = self.number(measure_of(key), range_limits(*range));
                let temperatures = self.number(Measure::TEMPERATURE, Map::new());
                any_of([
                    single.clone(),
                    json!({
                        "type": "object",
                        "properties": { "temperatures": column(temperatures), "values": column(single) },
                        "required": ["temperatures", "values"],
                        "additionalProperties": false,
                    }),
                ])
            }
            range => self.number(measure_of(key), range_limits(range)),
        }
    }
}

fn any_of<const N: usize>(choices: [Value; N]) -> Value {
    json!({ "anyOf": choices.to_vec() })
}

fn exactly_one(names: &[&str]) -> Value {
    let required = |name: &&str| json!({ "required": [name] });
    names.iter().map(required).collect()
}

/// Also describes the first of several choices, since completion in editors shows that of a choice.
fn describe(value: &mut Value, text: &str) {
    let Some(object) = value.as_object_mut() else {
        return;
    };
    object.insert("description".to_owned(), json!(text));
    if let Some(choice) = object.get_mut("anyOf").and_then(|of| of.get_mut(0)) {
        describe(choice, text);
    }
}

fn map<const N: usize>(entries: [(&str, f64); N]) -> Map<String, Value> {
    entries
        .into_iter()
        .map(|(name, value)| (name.to_owned(), json!(value)))
        .collect()
}

fn limits(limit: Limit) -> Map<String, Value> {
    match limit {
        Limit::Any => Map::new(),
        Limit::Positive => map([("exclusiveMinimum", 0.0)]),
        Limit::NotNegative => map([("minimum", 0.0)]),
        Limit::Within(least, most) => map([("minimum", least), ("maximum", most)]),
    }
}

fn range_limits(range: Range) -> Map<String, Value> {
    match range {
        Range::Positive => limits(Limit::Positive),
        Range::NonNegative => limits(Limit::NotNegative),
        Range::Between { above, below } => {
            map([("exclusiveMinimum", above), ("exclusiveMaximum", below)])
        }
        Range::PositiveUpTo { most } => map([("exclusiveMinimum", 0.0), ("maximum", most)]),
        Range::UpTo { most } => limits(Limit::Within(0.0, most)),
        _ => Map::new(),
    }
}

/// Texts with a unit of this dimension, or with a compound unit of any; or an expression.
fn quantity_pattern(measure: Measure) -> String {
    let symbols = |fits: &dyn Fn(Measure) -> bool| {
        let mut found = Vec::new();
        for unit in UNITS.iter().filter(|unit| fits(unit.measure)) {
            if unit.prefixed {
                let prefixes: String = PREFIXES.iter().map(|(prefix, _)| *prefix).collect();
                found.push(format!("[{prefixes}]?{}", unit.symbol));
            } else {
                found.push(unit.symbol.to_owned());
            }
        }
        found
    };
    let mut single = symbols(&|of| of == measure);
    if measure == Measure::TEMPERATURE {
        single.extend(CELSIUS.map(str::to_owned));
    }
    let power = "(\\^-?[0-9]|[²³])";
    let symbol = format!("({})", symbols(&|_| true).join("|"));
    let compound = format!("{symbol}{power}?([ */·]+{symbol}{power}?)+|{symbol}{power}");
    single.push(compound);
    format!("{CALCULATED}|^ *{NUMBER} *({}) *$", single.join("|"))
}
