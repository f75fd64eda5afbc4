//! Mistakes that are well-formed: things that do not fit together, and damaged texts of every kind.

mod common;

use common::{GOOD, expect};
use jstsph_case::parse;

#[test]
fn an_empty_selection_is_refused_with_the_extent_of_the_body() {
    let selection = "{ half_space = { point = [0, \"60 mm\"], normal = [0, 1] } }";
    expect(
        "\"billet.top\"",
        selection,
        &[
            "c.toml:17:9: `boundary.0.where` selects no particle of body `billet`",
            "its particles lie between (0, 0.001, 0) and (0.008, 0.057, 0) m",
        ],
    );
}

#[test]
fn a_body_in_an_obstacle_is_refused_and_one_that_touches_is_not() {
    expect(
        "point = [0, 0]",
        "point = [0, \"1.1 mm\"]",
        &[
            "c.toml:21:9: body `billet` overlaps obstacle `floor` at the start: particle 0 at (0, 0.001, 0) m is 1.0000e-4 m inside it",
            "free_side",
        ],
    );
    let touching = GOOD.replace("point = [0, 0]", "point = [0, \"1 mm\"]");
    parse("c", "c.toml", &touching, &[]).expect("a gap of zero is allowed");
}

#[test]
fn friction_is_not_negative() {
    expect(
        "name = \"floor\"",
        "name = \"floor\"\nfriction = -0.1",
        &["`obstacle.floor.friction` must be zero or positive, but is -0.1"],
    );
}

#[test]
fn names_must_be_unique_and_simple() {
    expect(
        "name = \"billet\"",
        "name = \"my.billet\"",
        &["c.toml:7:8: `my.billet` cannot be a name"],
    );
    let twice = GOOD.replace(
        "[[probe]]",
        "[[probe]]\nname = \"length\"\nextent = { where = \"billet\", axis = \"x\" }\n[[probe]]",
    );
    let message = parse("c", "c.toml", &twice, &[])
        .expect_err("twice")
        .to_string();
    assert!(
        message.starts_with("c.toml:26:8: two probes are called `length`"),
        "{message}"
    );
}

#[test]
fn exactly_one_form_is_allowed() {
    expect(
        "velocity = { y",
        "roller = \"x\"\nvelocity = { y",
        &["boundary.0 has both `roller` and `velocity`, but needs exactly one of"],
    );
    expect(
        "counts = [8, 50]",
        "counts = [8, 50], spacing = 1",
        &["c.toml:9:", "has both `spacing` and `counts`"],
    );
    expect(
        "counts = [8, 50]",
        "counts = [8, 50], layers = 3",
        &["`body.billet.lattice.layers` belongs to per_radius and rings, not to counts"],
    );
}

#[test]
fn signals_are_checked() {
    let y = "\"-1 m/s\"";
    expect(
        y,
        "{ expression = \"-x\" }",
        &[
            "c.toml:18:33: `boundary.0.velocity.y`: unknown name `x` (character 2 of the expression)",
            "did you mean `X`?",
        ],
    );
    expect(
        y,
        "{ expression = \"1 / t\" }",
        &["is inf at t = 0 and reference position (0, 0.057, 0) m, but must be finite"],
    );
    expect(
        y,
        "{ table = [[0, 1], [0, 2]] }",
        &["c.toml:18:", "must ascend, but 0 s follows 0 s"],
    );
    expect(y, "{ table = [] }", &["is empty"]);
    expect(y, "{ table = [[0]] }", &["must be a pair [time, value]"]);
    expect(y, "{ table = [[\"1 m\", 0]] }", &["must be a time"]);
}

#[test]
fn three_dimensional_things_are_refused_in_plane_strain() {
    expect(
        "{ y = \"-1 m/s\" }",
        "{ z = 1 }",
        &["there is no z axis in plane strain"],
    );
    expect(
        "axis = \"y\"",
        "axis = \"z\"",
        &[
            "`probe.length.extent.axis` cannot be \"z\"",
            "allowed: x, y",
        ],
    );
    expect(
        "box = { min = [\"0 mm\", \"1 mm\"], max = [\"8 mm\", \"57 mm\"] }",
        "cylinder = { base = [0, 0], radius = 1, height = 1 }",
        &["c.toml:8:9:", "cylinder cannot be used in plane-strain"],
    );
}

#[test]
fn set_up_errors_of_the_solver_point_at_the_body() {
    let text = GOOD.replace("cfl = 0.3", "cfl = 0.3\n[scheme]\nsmoothing_ratio = 0.1");
    let case = parse("c", "c.toml", &text, &[]).expect("valid so far");
    let error = jstsph_solver::Simulation::new(case.model.clone()).expect_err("too few neighbours");
    let message = case.setup_error(&error).to_string();
    assert!(
        message.starts_with("c.toml:11:11: body \"billet\": "),
        "{message}"
    );
    assert!(message.contains("smoothing_ratio (now 0.1)"), "{message}");
}

#[test]
fn rings_are_read_with_either_quadrature() {
    let disc = GOOD.replace(
        "box = { min = [\"0 mm\", \"1 mm\"], max = [\"8 mm\", \"57 mm\"] }",
        "disc = { centre = [0, 1], radius = 0.5 }",
    );
    let rings = disc
        .replace("counts = [8, 50]", "rings = 4")
        .replace("billet.top", "billet.rim");
    for quadrature in ["particles", "bonds"] {
        let scheme = format!("cfl = 0.3\n[scheme]\nquadrature = \"{quadrature}\"");
        let case = parse("c", "c.toml", &rings.replace("cfl = 0.3", &scheme), &[]).expect("valid");
        assert_eq!(case.particles(), 81);
    }
}

#[test]
fn no_damaged_text_makes_the_reader_panic() {
    // Every character left out, doubled, or replaced by a quote or a bracket.
    let characters: Vec<char> = GOOD.chars().collect();
    let mut refused = 0;
    for at in 0..characters.len() {
        for replacement in [
            vec![],
            vec![characters[at]; 2],
            vec!['"'],
            vec!['['],
            vec!['ü'],
        ] {
            let mut damaged = characters.clone();
            damaged.splice(at..=at, replacement);
            let text: String = damaged.into_iter().collect();
            // Ten times the particles are slow, not wrong.
            if text.contains("550]") || text.contains("88, 50") || text.contains("500]") {
                continue;
            }
            if let Err(error) = parse("c", "c.toml", &text, &[]) {
                assert!(error.to_string().starts_with("c.toml:"), "{error}");
                refused += 1;
            }
        }
    }
    assert!(
        refused > characters.len(),
        "only {refused} of {} were refused",
        5 * characters.len()
    );
}

#[test]
fn combinations_of_shapes_are_read_and_their_mistakes_placed() {
    let shape = "shape = { box = { min = [\"0 mm\", \"1 mm\"], max = [\"8 mm\", \"57 mm\"] } }";
    let lattice = "lattice = { counts = [8, 50] }";
    let corner = "{ box = { min = [0.004, 0.02], max = [1, 1] } }";
    let cut = format!(
        "shape = {{ difference = [\n  {{ polygon = {{ points = [[0, 0.001], [0.008, 0.001], [0.008, 0.057], [0, 0.057]], fillets = [0, 0, 0, \"1 mm\"] }} }},\n  {corner},\n] }}"
    );
    let text = GOOD
        .replace(shape, &cut)
        .replace(lattice, "lattice = { counts = [9, 57] }");
    let case = parse("c", "c.toml", &text, &[]).expect("a combination");
    let body = &case.model.bodies[0].body;
    let volume: f64 = body.volumes.iter().sum();
    // The box less the corner less what the fillet cuts off, (1 - pi/4) mm^2 and a little more
    // because the arc is a chain of chords of 5 degrees.
    let whole = 8e-3 * 56e-3 - 4e-3 * 37e-3 - (1.0 - std::f64::consts::FRAC_PI_4) * 1e-6;
    assert!((whole - 2e-9..whole).contains(&volume), "{volume} {whole}");
    let again = parse("c", "c.toml", &case.resolved, &[]).expect("the resolved case");
    assert_eq!(again.model.bodies[0].body.positions, body.positions);

    expect(
        shape,
        "shape = { union = [{ box = { min = [0, 0], max = [0, 1] } }, { disc = { centre = [0, 0], radius = 1 } }] }",
        &["c.toml:8:20: `body.billet.shape.union.0`: size along x of the box is 0 m"],
    );
    expect(
        shape,
        "shape = { union = [{ disc = { centre = [0, 0], radius = 1 } }] }",
        &["number of shapes to combine is 1; at least 2 needed"],
    );
    expect(
        shape,
        "shape = { polygon = { points = [[0, 0], [1, 1], [1, 0], [0, 1]] } }",
        &["edges 0 and 2 of the polygon cross or touch"],
    );
    expect(
        "\"billet.top\"",
        "\"billet.facing_top\"",
        &["body `billet` is a box and has no face `facing_top`"],
    );
}

#[test]
fn substeps_are_a_power_of_two_and_need_the_scheme_they_were_made_for() {
    for count in ["3", "128"] {
        expect(
            "cfl = 0.3",
            &format!("cfl = 0.3\nlimit = \"acoustic\"\nsubsteps = {count}"),
            &[
                &format!("c.toml:7:12: `time.substeps` is {count}"),
                "a power of two from 1 (all steps equal) to 64",
            ],
        );
    }
    expect(
        "cfl = 0.3",
        "substeps = 0",
        &["c.toml:5:12: `time.substeps`"],
    );
    let acoustic = "limit = \"acoustic\"\nsubsteps = 8";
    for (written, needed) in [
        ("substeps = 8", "the acoustic limit of the time step"),
        (&format!("integrator = \"rk4\"\n{acoustic}"), "the leapfrog"),
        (
            &format!("{acoustic}\n[scheme]\nquadrature = \"particles\""),
            "bonds as quadrature",
        ),
        (
            &format!("{acoustic}\n[stabilisation]\nupwind = 0.1"),
            "a scheme without stabilisation",
        ),
    ] {
        expect(
            "cfl = 0.3",
            written,
            &[
                &format!("`time.substeps` is 8, but sub-steps need {needed}"),
                "time.substeps = 1 makes all steps equal",
                "substeps = 8",
            ],
        );
    }
    let case = GOOD.replace("cfl = 0.3", acoustic);
    let case = parse("c", "c.toml", &case, &[]).expect("it has all that is needed");
    assert_eq!(case.model.scheme.substeps, 8);
}
