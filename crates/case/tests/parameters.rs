//! `[parameters]`, expressions of them, and included files.

use jstsph_case::{Case, CaseError, load, parse};
use jstsph_solver::{ConditionKind, Signal};
use jstsph_tensor::Vec3;

const TEXT: &str = r#"
dimension = "plane-strain"
[parameters]
width = "10 mm"
height = "= 2 * width + 1 mm"
punch_speed = "5 m/s"
rise = "= 0.1 * height / punch_speed"
n = 5
[time]
end = "= 4 * rise"
[[body]]
name = "block"
shape = { box = { min = ["= -width / 2", 0], max = ["= width / 2", "= height"] } }
lattice = { counts = ["= n", "= 2 * n + 1"] }
material = "al1100_ecae"
[[boundary]]
where = "block.bottom"
roller = "y"
[[boundary]]
where = "block.top"
velocity = { y = "= -punch_speed" }
[[boundary]]
where = "block.left"
velocity = { x = { expression = "-punch_speed * tanh(t / rise)" } }
"#;

fn read(text: &str, overrides: &[(&str, &str)]) -> Result<Case, CaseError> {
    let overrides: Vec<(String, String)> = overrides
        .iter()
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
        .collect();
    parse("case", "case.toml", text, &overrides)
}

#[test]
fn expressions_become_numbers() {
    let case = read(TEXT, &[]).expect("sound");
    // rise = 0.1 * 21 mm / (5 m/s) up to rounding.
    assert!((case.time.end - 1.68e-3).abs() < 1e-17, "{}", case.time.end);
    assert_eq!(case.particles(), 5 * 11);
    let top = &case.model.conditions[1].kind;
    let ConditionKind::Velocity(components) = top else {
        panic!("{top:?}")
    };
    assert!(
        matches!(components[1], Some(Signal::Constant(-5.0))),
        "{components:?}"
    );
    let left = &case.model.conditions[2].kind;
    let ConditionKind::Velocity(components) = left else {
        panic!("{left:?}")
    };
    let signal = components[0].as_ref().expect("along x");
    let expected = -5.0 * (1e-4f64 / 4.2e-4).tanh();
    assert!((signal.at(1e-4, &Vec3::zeros()) - expected).abs() < 1e-14);

    assert!(!case.resolved.contains("punch_speed"), "{}", case.resolved);
    let again = read(&case.resolved, &[]).expect("its own text");
    assert_eq!(again.resolved, case.resolved);
}

#[test]
fn parameters_are_overridden_by_name() {
    let case = read(
        TEXT,
        &[("parameters.width", "20 mm"), ("parameters.n", "7")],
    )
    .expect("sound");
    assert_eq!(case.particles(), 7 * 15);
    let highest = case.model.bodies[0].body.positions.iter().map(|x| x.y);
    assert!((highest.fold(0.0, f64::max) - 0.041).abs() < 1e-15);
    let error = read(TEXT, &[("parameters.widht", "20 mm")]).expect_err("no such");
    let text = error.to_string();
    assert!(
        text.contains("in --set parameters.widht=20 mm: the case has no parameter `widht`")
            && text.contains("did you mean `width`?"),
        "{text}"
    );
}

#[test]
fn mistakes_are_explained_where_they_are() {
    for (from, to, start, part) in [
        (
            "\"= 4 * rise\"",
            "\"= 4 * rice\"",
            "case.toml:10:7: \"= 4 * rice\": unknown name `rice` (character 7 of the expression)",
            "did you mean `rise`?",
        ),
        (
            "\"= 4 * rise\"",
            "\"= 4 * width\"",
            "case.toml:10:7: `time.end` must be a time (s, ms, us, ns), but \"= 4 * width\" is a length",
            "",
        ),
        (
            "\"= 4 * rise\"",
            "\"= n\"",
            "case.toml:10:7: `time.end` must be a time (s, ms, us, ns), but \"= n\" is a number",
            "has no dimension: write \"8 mm\"",
        ),
        (
            "2 * width + 1 mm",
            "2 * width + rise",
            "case.toml:5:10: parameters depend on each other in a circle: height -> rise -> height",
            "",
        ),
        (
            "2 * width + 1 mm",
            "2 * width + 1 s",
            "case.toml:5:10: \"= 2 * width + 1 s\": cannot add a length (m, cm, mm, um) and a time",
            "",
        ),
        (
            "n = 5",
            "t = 5",
            "case.toml:8:1: `t` cannot name a parameter",
            "taken: t, X, Y, Z, pi",
        ),
        (
            "n = 5",
            "n = [5]",
            "case.toml:8:5: `parameters.n` must be a number",
            "",
        ),
        (
            "n = 5",
            "n = \"5 widths\"",
            "case.toml:8:5: `parameters.n`: unknown unit `widths`",
            "begins with `=`",
        ),
        (
            "n = 5",
            "n = \"= 1 / 0\"",
            "case.toml:8:5: `parameters.n` is inf, but must be finite",
            "",
        ),
        (
            "2 * n + 1",
            "n / 2",
            "case.toml:14:30: `body.block.lattice.counts.1` must be an integer, but \"= n / 2\" is 2.5",
            "floor()",
        ),
        (
            "tanh(t / rise)",
            "tanh(t / rice)",
            "case.toml:24:33: \"-punch_speed * tanh(t / rice)\": unknown name `rice` (character 25",
            "did you mean `rise`?",
        ),
    ] {
        assert!(TEXT.contains(from), "{from}");
        let text = read(&TEXT.replacen(from, to, 1), &[])
            .expect_err(to)
            .to_string();
        assert!(
            text.starts_with(start) && text.contains(part),
            "{to}: {text}"
        );
    }
}

const STEEL: &str = "[material.steel.hencky_von_mises]\ndensity = 7800\nyoung_modulus = \"210 GPa\"\n\
    poisson_ratio = 0.3\nhardening = { linear = { initial_yield_stress = \"0.4 GPa\", modulus = 0 } }\n";

#[test]
fn materials_are_included_and_their_mistakes_name_their_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).expect("writable");
    };
    let text = TEXT
        .replacen(
            "\n[parameters]",
            "\ninclude = [\"steel.toml\"]\n[parameters]",
            1,
        )
        .replace("al1100_ecae", "steel");
    write("steel.toml", STEEL);
    write("case.toml", &text);
    let path = folder.path().join("case.toml");
    let case = load(&path, &[]).expect("sound");
    assert!(case.resolved.contains("[material.steel.hencky_von_mises]"));
    assert!(!case.resolved.contains("include"));
    let harder = [(
        "material.steel.hencky_von_mises.poisson_ratio".to_owned(),
        "0.25".to_owned(),
    )];
    let case = load(&path, &harder).expect("overrides reach into included files");
    assert!(case.resolved.contains("poisson_ratio = 0.25"));

    let message = || load(&path, &[]).expect_err("wrong").to_string();
    write("steel.toml", &STEEL.replace("7800", "-1"));
    let text_of = message();
    assert!(text_of.contains("steel.toml:2:11: "), "{text_of}");
    write("steel.toml", &format!("{STEEL}[time]\nend = 1\n"));
    let text_of = message();
    assert!(
        text_of.contains("steel.toml:6:2: `time` cannot stand in an included file"),
        "{text_of}"
    );
    write("steel.toml", STEEL);
    write("case.toml", &(text.clone() + STEEL));
    let text_of = message();
    assert!(
        text_of.contains("case.toml:26:") && text_of.contains("material `steel` is also in "),
        "{text_of}"
    );
    write("case.toml", &text.replace("steel.toml", "stele.toml"));
    let text_of = message();
    assert!(
        text_of.contains("case.toml:3:12: cannot read "),
        "{text_of}"
    );
}
