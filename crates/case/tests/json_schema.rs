//! The JSON Schema: it accepts what is right, refuses the usual mistakes and knows every key.

use jstsph_case::schema::{self, Key};
use jstsph_material::{Description, MODELS, Range};
use serde_json::Value;

fn read(text: &str) -> Value {
    let table: toml::Value = text.parse::<toml::Table>().expect("TOML").into();
    serde_json::to_value(table).expect("JSON")
}

fn validator() -> jsonschema::Validator {
    let schema: Value = serde_json::from_str(&jstsph_case::json_schema()).expect("JSON");
    jsonschema::draft202012::meta::validate(&schema).expect("a schema of the draft");
    jsonschema::draft202012::new(&schema).expect("a schema")
}

#[test]
fn every_shipped_case_and_its_resolved_form_are_valid() {
    let validator = validator();
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../cases");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("the cases") {
        let path = entry.expect("readable").path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        count += 1;
        let text = std::fs::read_to_string(&path).expect("readable");
        let errors: Vec<String> = validator
            .iter_errors(&read(&text))
            .map(|error| format!("{}: {error}", error.instance_path()))
            .collect();
        assert!(errors.is_empty(), "{}: {errors:#?}", path.display());
    }
    assert!(count > 10, "{count} cases");
    let case = jstsph_case::parse("case", "case.toml", RICH, &[]).expect("sound");
    for text in [RICH, &case.resolved] {
        let errors: Vec<String> = validator
            .iter_errors(&read(text))
            .map(|error| format!("{}: {error}", error.instance_path()))
            .collect();
        assert!(errors.is_empty(), "{text}\n{errors:#?}");
    }
}

/// A case with what the shipped ones do not show.
const RICH: &str = r#"
dimension = "plane-strain"
[parameters]
half = "0.5 m"
[time]
end = "10 ms"
[heat]
[stabilisation]
jst = { biharmonic = { initial = 0.01 } }
[material.soft.hencky_von_mises]
density = "2.7 g/cm^3"
young_modulus = { temperatures = ["20 degC", "400 degC"], values = ["70 GPa", "50 GPa"] }
poisson_ratio = 0.33
thermal = { heat_capacity = "0.9 kJ/kg/K", conductivity = "180 W/m/K", taylor_quinney = 0.9, expansion = "23e-6 1/K", reference_temperature = "20 degC" }
hardening = { linear = { initial_yield_stress = "0.1 GPa", modulus = 0 } }
[[body]]
name = "block"
shape = { difference = [{ box = { min = [0, 0], max = ["1 m", "= 2 * half"] } }, { disc = { centre = [0.5, 0.5], radius = "10 cm" } }] }
lattice = { spacing = "5 cm" }
material = "soft"
velocity = { rotation = { rate = "10 rad/s", centre = [0, 0] } }
[[boundary]]
where = { and = ["bottom", { not = { half_space = { point = [0.5, 0], normal = [1, 0] } } }] }
roller = ["x", "y"]
[[boundary]]
where = "block.top"
velocity = { y = { table = [[0, 0], ["1 ms", "-1 m/s"]] } }
[[boundary]]
where = "block.top"
convection = { coefficient = "10 W/m^2/K", ambient = "20 degC" }
[[obstacle]]
profile = { points = [[2, 0], [2, 1]], free_side = "left" }
"#;

#[test]
fn usual_mistakes_are_not_valid() {
    let validator = validator();
    let is_valid = |text: &str| validator.is_valid(&read(text));
    assert!(is_valid(RICH));
    for (from, to) in [
        ("[time]\nend", "[time]\nedn"),
        ("\"10 ms\"", "\"10 mm\""),
        ("\"10 ms\"", "\"10\""),
        ("\"10 ms\"", "\"10 msec\""),
        ("\"10 ms\"", "-1"),
        ("\"10 ms\"", "true"),
        ("\"plane-strain\"", "\"2d\""),
        ("material = \"soft\"\n", ""),
        ("[heat]", "[heat]\nconduction = \"no\""),
        ("hencky_von_mises]", "hencky_von_misses]"),
        ("poisson_ratio = 0.33", "poisson_ratio = 0.6"),
        ("poisson_ratio = 0.33", "poisson_ratio = 0.3\npoisson = 0.3"),
        ("linear = {", "liner = {"),
        ("taylor_quinney = 0.9, ", ""),
        ("roller = [\"x\", \"y\"]", "roller = \"w\""),
        ("roller = [\"x\", \"y\"]", "roller = \"x\"\nfixed = true"),
        ("spacing = \"5 cm\"", "spacing = \"5 cm\", counts = [3, 3]"),
        ("radius = \"10 cm\"", "radius = 0"),
        ("min = [0, 0]", "min = 0"),
        ("half_space", "halfspace"),
        ("difference = [", "diference = ["),
        ("{ table = [[0, 0]", "{ tabel = [[0, 0]"),
        ("free_side = \"left\"", "free_side = \"top\""),
        ("initial = 0.01", "inital = 0.01"),
        ("rate = \"10 rad/s\", ", ""),
    ] {
        assert!(RICH.contains(from), "{from}");
        assert!(!is_valid(&RICH.replacen(from, to, 1)), "{from} -> {to}");
    }
}

/// Names of properties with their descriptions, anywhere in the schema.
fn properties(value: &Value, found: &mut Vec<(String, String)>) {
    match value {
        Value::Array(items) => items.iter().for_each(|item| properties(item, found)),
        Value::Object(object) => {
            if let Some(Value::Object(inner)) = object.get("properties") {
                for (name, property) in inner {
                    if let Some(text) = property["description"].as_str() {
                        found.push((name.clone(), text.to_owned()));
                    }
                }
            }
            object.values().for_each(|item| properties(item, found));
        }
        _ => {}
    }
}

fn keys(table: &[Key], wanted: &mut Vec<(String, String)>) {
    for key in table {
        wanted.push((key.name.to_owned(), key.meaning.to_owned()));
        keys(key.kind.keys(), wanted);
    }
}

fn parameters(descriptions: &[Description], wanted: &mut Vec<(String, String)>) {
    for description in descriptions {
        wanted.push((description.name.to_owned(), description.summary.to_owned()));
        for key in description.keys {
            wanted.push((key.name.to_owned(), key.meaning.to_owned()));
            match key.range {
                Range::OneOf(choices) => parameters(choices, wanted),
                Range::Table(keys) => wanted.extend(
                    keys.iter()
                        .map(|key| (key.name.to_owned(), key.meaning.to_owned())),
                ),
                _ => {}
            }
        }
    }
}

#[test]
fn every_key_of_the_tables_is_in_the_schema() {
    let schema: Value = serde_json::from_str(&jstsph_case::json_schema()).expect("JSON");
    let (mut found, mut wanted) = (Vec::new(), Vec::new());
    properties(&schema, &mut found);
    keys(schema::CASE, &mut wanted);
    keys(schema::SELECTION, &mut wanted);
    keys(schema::CHAIN, &mut wanted);
    parameters(MODELS, &mut wanted);
    assert!(wanted.len() > 150, "{}", wanted.len());
    for (name, meaning) in wanted {
        assert!(
            found
                .iter()
                .any(|(found, text)| *found == name && text.starts_with(&meaning)),
            "`{name}` ({meaning}) is missing"
        );
    }
}
