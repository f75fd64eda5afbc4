//! The description of a model against what its table really reads.

use crate::{Key, MaterialSpec, Property, Range};
use serde_json::{Map, Value};

/// The table of the spec is named and keyed as described, survives a round trip, and refuses a key
/// nobody described, on every level.
pub(crate) fn table_has_the_described_keys(spec: &MaterialSpec, name: &str, keys: &[Key]) {
    let written = serde_json::to_value(spec).unwrap();
    assert_eq!(spec.name(), name);
    assert_eq!(
        &serde_json::from_value::<MaterialSpec>(written.clone()).unwrap(),
        spec
    );
    let fields = choice(&written, name);
    assert_keys(fields, keys);

    let mut with_unknown = written.clone();
    with_unknown[name]["shear_moduls"] = Value::from(1.0);
    let message = serde_json::from_value::<MaterialSpec>(with_unknown)
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("unknown field `shear_moduls`"),
        "{message}"
    );
}

fn choice<'a>(value: &'a Value, name: &str) -> &'a Map<String, Value> {
    let choice = value.as_object().expect("a table");
    assert_eq!(choice.keys().collect::<Vec<_>>(), [name]);
    choice[name].as_object().expect("a table of keys")
}

/// Every written key is described, and every one that is not optional is written.
fn assert_keys(fields: &Map<String, Value>, keys: &[Key]) {
    for name in fields.keys() {
        assert!(keys.iter().any(|key| key.name == name), "{name}");
    }
    for key in keys {
        let Some(value) = fields.get(key.name) else {
            assert!(key.optional, "{} is missing", key.name);
            continue;
        };
        match key.range {
            Range::OneOf(choices) => {
                let chosen = value.as_object().unwrap().keys().next().unwrap();
                let law = choices.iter().find(|law| law.name == chosen).unwrap();
                assert_keys(choice(value, chosen), law.keys);
            }
            Range::Table(keys) => assert_keys(value.as_object().unwrap(), keys),
            Range::InTemperature(_) => {
                let property: Property = serde_json::from_value(value.clone()).unwrap();
                property.check(key).unwrap();
            }
            Range::Ascending => assert!(value.is_array(), "{}", key.name),
            Range::Flag => assert!(value.is_boolean(), "{}", key.name),
            _ => key.check(value.as_f64().unwrap()).unwrap(),
        }
    }
}
