//! What a case file becomes: models, resolved files, overrides, warnings.

use jstsph_case::schema::FRAME_FIELDS;
use jstsph_case::{Case, CaseError, Interval, parse};
use jstsph_contact::Law;
use jstsph_solver::{Biharmonic, ConditionKind, ProbeKind, Quadrature, Signal, SmoothingReference};
use jstsph_tensor::Vec3;

/// A case that uses every table of the schema.
const FULL: &str = r#"
title = "every table"
dimension = "plane-strain"
[time]
end = "45 ms"
integrator = "tvd-rk2"
[scheme]
quadrature = "particles"
formulation = "pFJ"
kernel = "wendland-c4"
[stabilisation]
hourglass = 0.02
jst = { biharmonic = { initial = 0.015625 }, on_jacobian = true }
[[body]]
name = "billet"
shape = { box = { min = ["0 mm", "1.42 mm"], max = ["8 mm", "57.42 mm"] } }
lattice = { counts = [8, 50] }
material = "al1100_ecae"
velocity = ["1 m/s", { expression = "2 * Y" }]
body_force = [0, "-9.81 m/s^2"]
[[body]]
name = "wheel"
shape = { disc = { centre = [1, 1], radius = "5 cm" } }
lattice = { per_radius = 5 }
material = "my copper"
velocity = { rotation = { rate = "105 rad/s", centre = [1, 1] } }
[material."my copper".hencky_von_mises]
density = "8.93 g/cm^3"
young_modulus = "117 GPa"
poisson_ratio = 0.35
hardening = { tabulated = { plastic_strain = [0, 0.5], flow_stress = ["400 MPa", "450 MPa"] } }
[[boundary]]
where = "billet.top"
velocity = { y = { table = [[0, 0], ["1 ms", "-1 m/s"]] } }
[[boundary]]
name = "right half of the bottom"
where = { body = "billet", and = ["bottom", { not = { box = { min = [-1, 0], max = ["3 mm", "10 mm"] } } }] }
roller = "y"
[[boundary]]
where = "billet.left"
traction = [{ expression = "1e6 * sin(2 * pi * t / 1e-3)" }, 0]
[[boundary]]
where = { body = "wheel", boundary = true }
fixed = true
[[obstacle]]
name = "die"
allowed_overlap = "3 um" # the corner of the billet stands 2.13 um in the fillet
profile = { chains = [
  { points = [[0, 0.08], [0, 0], [0.032, 0], [0.032, -0.06]], fillets = [0, "1.5 mm", "1.0 mm", 0], free_side = "left" },
  { points = [[0.008, 0.08], [0.008, 0.008], [0.040, 0.008], [0.040, -0.06]], fillets = [0, 1e-3, 1.5e-3, 0], free_side = "right" } ] }
[[obstacle]]
plane = { point = [2, 0], normal = [-2, 0] }
law = "reflection"
friction = 0.15
velocity = { x = { expression = "-t" } }
[[probe]]
name = "length"
extent = { where = "billet", axis = "y" }
[[probe]]
name = "strain"
statistic = { where = "wheel", field = "equivalent_plastic_strain", of = "median" }
[[probe]]
name = "section"
line = { from = [0, 0], to = [0, 1], count = 10, field = "pressure" }
[[probe]]
name = "here"
point = { position = [0, 0], field = "velocity_x" }
[[probe]]
name = "rim"
radius = { where = "wheel.rim", point = [1, 1] }
[output]
precision = "single"
"#;

fn full(overrides: &[(&str, &str)]) -> Result<Case, CaseError> {
    // Only the billet may meet the die; the wheel stands outside its free side.
    let text = FULL
        .replace("centre = [1, 1]", "centre = [0.004, 10]")
        .replace("point = [1, 1]", "point = [0.004, 10]");
    let text = text.replace("radius = \"5 cm\"", "radius = \"3 mm\"");
    let overrides: Vec<(String, String)> = overrides
        .iter()
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
        .collect();
    parse("full", "full.toml", &text, &overrides)
}

#[test]
fn every_table_reaches_the_model() {
    let case = full(&[]).expect("valid");
    let model = &case.model;
    assert_eq!(model.scheme.quadrature, Quadrature::Particles);
    assert_eq!(model.scheme.smoothing_reference, SmoothingReference::Volume);
    assert_eq!(model.scheme.smoothing_ratio, 1.2);
    assert!(model.scheme.projection);
    assert_eq!(model.scheme.cfl, 0.3);
    let jst = model.scheme.stabilisation.jst.expect("jst");
    assert_eq!(
        jst.biharmonic,
        Biharmonic::FallingWithPlasticStrain {
            initial: 1.0 / 64.0,
            last: 1.0 / 4096.0,
            strain: 0.5
        }
    );
    assert_eq!(model.scheme.stabilisation.upwind, 0.0);

    let billet = &model.bodies[0];
    assert_eq!(billet.body.positions.len(), 400);
    assert_eq!(billet.material.density(), 2800.0);
    for (x, v) in billet.body.positions.iter().zip(&billet.initial_velocity) {
        assert_eq!(*v, Vec3::new(1.0, 2.0 * x.y, 0.0));
    }
    let force = billet.body_force.as_ref().expect("weight");
    assert_eq!(force[1].at(0.0, &Vec3::zeros()), -9.81);
    let wheel = &model.bodies[1];
    assert_eq!(wheel.body.positions.len(), 81);
    assert_eq!(wheel.material.density(), 8930.0);
    for (x, v) in wheel.body.positions.iter().zip(&wheel.initial_velocity) {
        assert_eq!(
            *v,
            Vec3::new(-105.0 * (x.y - 10.0), 105.0 * (x.x - 0.004), 0.0)
        );
    }

    let [top, bottom, left, rim] = &model.conditions[..] else {
        panic!("four conditions")
    };
    assert_eq!((top.name.as_str(), top.particles.len()), ("billet.top", 8));
    let ConditionKind::Velocity([None, Some(push), None]) = &top.kind else {
        panic!("{:?}", top.kind)
    };
    assert_eq!(push.at(0.5e-3, &Vec3::zeros()), -0.5);
    // Of eight bottom nodes, 8/7 mm apart, five lie beyond 3 mm.
    assert_eq!(
        (bottom.name.as_str(), bottom.particles.len()),
        ("right half of the bottom", 5)
    );
    assert!(matches!(
        bottom.kind,
        ConditionKind::Velocity([None, Some(Signal::Constant(0.0)), None])
    ));
    let ConditionKind::Traction { areas, traction } = &left.kind else {
        panic!("{:?}", left.kind)
    };
    assert!((areas.iter().sum::<f64>() - 0.056).abs() < 1e-15);
    assert!((traction[0].at(0.25e-3, &Vec3::zeros()) - 1e6).abs() < 1e-6);
    assert_eq!(rim.body, 1);
    assert!(matches!(
        rim.kind,
        ConditionKind::Velocity([Some(_), Some(_), None])
    ));

    let [die, wall] = &model.obstacles[..] else {
        panic!("two obstacles")
    };
    assert!(die.velocity.is_none());
    assert_eq!(die.obstacle.law, Law::Inelastic { restitution: 0.0 });
    let (name, law) = (wall.obstacle.name.as_str(), wall.obstacle.law);
    assert_eq!((name, law), ("obstacle-1", Law::Reflection));
    let coefficients = [die, wall].map(|o| o.obstacle.friction.coefficient);
    assert_eq!(coefficients, [0.0, 0.15]);
    let moving = wall.velocity.as_ref().expect("moving");
    assert_eq!(moving[0].at(2.0, &Vec3::zeros()), -2.0);

    assert_eq!(case.probes.len(), 5);
    let ProbeKind::Statistic { particles, .. } = &case.probes[1].kind else {
        panic!("a statistic")
    };
    assert_eq!(
        (particles[0], particles.len()),
        (400, 81),
        "particles count through all bodies"
    );
    assert_eq!(case.output.frame_interval, Interval::Time(45e-3 / 50.0));
    assert_eq!(case.output.fields, FRAME_FIELDS);
    assert!(case.output.compression);
}

#[test]
fn resolved_case_reads_to_the_same_case() {
    let case = full(&[]).expect("valid");
    let again = parse("full", "case.toml", &case.resolved, &[])
        .unwrap_or_else(|error| panic!("{error}\n{}", case.resolved));
    assert_eq!(again.resolved, case.resolved);
    // `Debug` shows every number of the model; functions are compared through their text above.
    assert_eq!(format!("{:?}", again.model), format!("{:?}", case.model));
    assert_eq!(format!("{:?}", again.probes), format!("{:?}", case.probes));
    assert_eq!(
        (again.time, &again.output, &again.title),
        (case.time, &case.output, &case.title)
    );
}

#[test]
fn output_is_by_time_or_steps_with_chosen_fields() {
    let case = full(&[
        ("output.frame_steps", "20"),
        ("output.fields", "[\"velocity\", \"jacobian\"]"),
    ])
    .expect("valid");
    assert_eq!(case.output.frame_interval, Interval::Steps(20));
    assert_eq!(case.output.history_interval, Interval::Time(45e-3 / 500.0));
    assert_eq!(case.output.fields, ["velocity", "jacobian"]);
    let again = parse("full", "case.toml", &case.resolved, &[]).expect("valid");
    assert_eq!(again.output, case.output);
    assert_eq!(again.original(), case.resolved);
    for (overrides, message) in [
        (
            vec![
                ("output.frame_steps", "20"),
                ("output.frame_interval", "1 ms"),
            ],
            "`output` has both frame_interval and frame_steps",
        ),
        (vec![("output.restart_steps", "0")], "restart_steps"),
        (
            vec![("output.fields", "[\"velocty\"]")],
            "did you mean `velocity`?",
        ),
        (
            vec![("output.fields", "velocity")],
            "must be a list of names",
        ),
    ] {
        let error = full(&overrides).expect_err("refused").to_string();
        assert!(error.contains(message), "{error}");
    }
}

#[test]
fn resolved_case_writes_defaults_units_and_shipped_materials() {
    let resolved = full(&[]).expect("valid").resolved;
    for line in [
        "end = 0.045  # s",
        "cfl = 0.3",
        "smallest_step = 1e-6",
        "restart_interval = 0.0045  # s",
        "smoothing_ratio = 1.2",
        "weights = \"interpolation\"",
        "[material.al1100_ecae.hencky_von_mises]",
        "[material.\"my copper\".hencky_von_mises]",
        "density = 8930.0",
        "law = \"inelastic\"",
        "frame_interval = 9e-4  # s",
    ] {
        assert!(
            resolved.lines().any(|found| found == line),
            "`{line}` is not in:\n{resolved}"
        );
    }
}

#[test]
fn overrides_reach_every_kind_of_key() {
    let case = full(&[
        ("time.end", "10 ms"),
        ("time.cfl", "0.25"),
        ("scheme.weights", "volume"),
        ("body.billet.lattice.counts", "[4, 22]"),
        ("body.1.lattice.per_radius", "9"),
        ("material.my copper.hencky_von_mises.density", "9 g/cm^3"),
        ("stabilisation.jst.biharmonic", "0.001"),
    ])
    .expect("valid");
    assert_eq!(
        (case.time.end, case.time.cfl, case.model.scheme.cfl),
        (10e-3, 0.25, 0.25)
    );
    assert_eq!(case.particles(), 88 + 253);
    assert_eq!(case.model.bodies[1].material.density(), 9000.0);
    let jst = case.model.scheme.stabilisation.jst.expect("jst");
    assert_eq!(jst.biharmonic, Biharmonic::Constant(0.001));
}

#[test]
fn mistakes_in_overrides_name_the_override() {
    let message = |key, value| full(&[(key, value)]).expect_err("a mistake").to_string();
    let text = message("time.end", "0");
    assert_eq!(
        text,
        "full.toml: in --set time.end=0: `time.end` must be positive, but is 0 s"
    );
    let text = message("time.edn", "1");
    assert!(
        text.starts_with("full.toml: in --set time.edn=1: unknown key `edn` in time"),
        "{text}"
    );
    assert!(text.ends_with("did you mean `end`?"), "{text}");
    let text = message("body.bilet.material", "x");
    assert!(
        text.contains(
            "in --set body.bilet.material=x: `bilet` in `body.bilet.material` is no item"
        ),
        "{text}"
    );
    let text = message("time.end", "3 mm");
    assert!(text.contains("\"3 mm\" is a length"), "{text}");
}

fn warnings(overrides: &[(&str, &str)]) -> Vec<String> {
    full(overrides).expect("valid").warnings
}

fn has(warnings: &[String], piece: &str) -> bool {
    warnings.iter().any(|warning| warning.contains(piece))
}

#[test]
fn implausible_settings_are_warned_of_once_and_plausible_ones_are_not() {
    // Spacing 8/7 mm against a fillet of 1 mm is the paper's own choice, and worth a warning.
    let plain = warnings(&[]);
    assert_eq!(plain.len(), 1, "{plain:?}");
    assert!(has(
        &plain,
        "larger than the smallest fillet of obstacle `die`"
    ));

    let soft = warnings(&[("material.my copper.hencky_von_mises.young_modulus", "117")]);
    assert!(
        has(&soft, "Young's modulus of body `wheel` is 117 Pa"),
        "{soft:?}"
    );
    let short = warnings(&[("time.end", "1 us")]);
    assert!(
        has(&short, "shorter than one wave transit of body `billet`"),
        "{short:?}"
    );
    // kappa4 = 1/1024 needs cfl below (4/1024)^(1/3) = 0.157.
    let growing = warnings(&[("stabilisation.jst", "{}")]);
    assert!(
        has(&growing, "reduce time.cfl below 0.16 or use the leapfrog"),
        "{growing:?}"
    );
    let leapfrog = warnings(&[("stabilisation.jst", "{}"), ("time.integrator", "leapfrog")]);
    assert!(!has(&leapfrog, "tvd-rk2"), "{leapfrog:?}");
    let strong = warnings(&[("stabilisation.upwind", "5")]);
    assert!(
        has(
            &strong,
            "stabilisation.upwind = 5 with time.cfl = 0.3 may be unstable"
        ),
        "{strong:?}"
    );
}

#[test]
fn the_taylor_bar_of_the_paper_has_4131_particles() {
    let text = r#"
dimension = "3d"
time = { end = "80 us" }
[[body]]
name = "bar"
shape = { cylinder = { base = [0, 0, 0], radius = "3.2 mm", height = "32 mm" } }
lattice = { per_radius = 5, layers = 51 }
material = "copper_taylor"
velocity = [0, 0, "-227 m/s"]
[[obstacle]]
name = "wall"
plane = { point = [0, 0, 0], normal = [0, 0, 1] }
[[probe]]
name = "base_radius"
radius = { where = "bar.rim_base" }
"#;
    let case = parse("bar", "bar.toml", text, &[]).expect("valid");
    assert_eq!(case.particles(), 4131);
    assert_eq!(case.model.scheme.quadrature, Quadrature::Bonds);
    assert_eq!(
        case.model.scheme.smoothing_reference,
        SmoothingReference::Spacing
    );
    assert_eq!(case.warnings, Vec::<String>::new());
    assert!(
        case.model.bodies[0]
            .initial_velocity
            .iter()
            .all(|v| *v == Vec3::new(0.0, 0.0, -227.0))
    );
    let mistake = text
        .replace("layers = 51", "")
        .replace("per_radius = 5,", "per_radius = 5");
    let message = parse("bar", "bar.toml", &mistake, &[])
        .expect_err("no layers")
        .to_string();
    assert!(
        message.contains("`layers` is missing in body.bar.lattice"),
        "{message}"
    );
}
