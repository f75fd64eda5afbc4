//! The description of a model against what its table really reads.

use crate::{Key, MaterialSpec, Range};
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

fn assert_keys(fields: &Map<String, Value>, keys: &[Key]) {
    let mut described: Vec<_> = keys.iter().map(|key| key.name).collect();
    described.sort_unstable();
    let mut written: Vec<_> = fields.keys().map(String::as_str).collect();
    written.sort_unstable();
    assert_eq!(written, described);

    for key in keys {
        let value = &fields[key.name];
        match key.range {
            Range::OneOf(choices) => {
                let chosen = value.as_object().unwrap().keys().next().unwrap();
                let law = choices.iter().find(|law| law.name == chosen).unwrap();
                assert_keys(choice(value, chosen), law.keys);
            }
            Range::Ascending => assert!(value.is_array(), "{}", key.name),
            _ => key.check(value.as_f64().unwrap()).unwrap(),
        }
    }
}
