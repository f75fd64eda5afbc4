//! Every mistake of a user is one message with file, line, offending text, what is allowed, and the
//! nearest name for misspellings.

mod common;

use common::{GOOD, expect, message};
use jstsph_case::parse;

#[test]
fn the_good_case_is_good() {
    let case = parse("c", "c.toml", GOOD, &[]).expect("valid");
    assert_eq!(case.particles(), 400);
    assert_eq!(case.warnings, Vec::<String>::new());
}

#[test]
fn the_whole_message_reads_like_this() {
    assert_eq!(
        message("cfl = 0.3", "clf = 0.3"),
        "c.toml:5:1: unknown key `clf` in time\n  \
           |\n\
         5 | clf = 0.3\n  \
           | ^^^\n  \
           = allowed: end, cfl, limit, substeps, integrator, smallest_step, rate_scale, mass_scale\n  \
           = did you mean `cfl`?"
    );
}

#[test]
fn unknown_keys_are_refused_everywhere() {
    expect(
        "title",
        "titel",
        &[
            "c.toml:1:1: unknown key `titel` at the top level",
            "did you mean `title`?",
        ],
    );
    expect(
        "counts",
        "count",
        &[
            "c.toml:9:13: unknown key `count` in body.billet.lattice",
            "did you mean `counts`?",
        ],
    );
    expect(
        "offset =",
        "ofset =",
        &[
            "c.toml:15:",
            "unknown key `ofset` in material.al.hencky_von_mises.hardening.swift",
            "did you mean `offset`?",
        ],
    );
    expect(
        "density =",
        "denisty =",
        &[
            "c.toml:12:1: unknown key `denisty`",
            "did you mean `density`?",
        ],
    );
    expect(
        "{ swift",
        "{ swfit",
        &[
            "c.toml:15:",
            "unknown hardening `swfit`",
            "did you mean `swift`?",
        ],
    );
    expect(
        "hencky_von_mises",
        "hencky_von_misses",
        &[
            "c.toml:11:",
            "unknown model",
            "did you mean `hencky_von_mises`?",
        ],
    );
    expect(
        "{ y =",
        "{ w =",
        &[
            "c.toml:18:",
            "unknown key `w` in boundary.0.velocity",
            "allowed: x, y, z",
        ],
    );
    expect(
        "normal",
        "norml",
        &[
            "c.toml:21:",
            "unknown key `norml` in obstacle.floor.plane",
            "did you mean `normal`?",
        ],
    );
    expect(
        "axis = \"y\"",
        "axes = \"y\"",
        &[
            "c.toml:24:",
            "unknown key `axes` in probe.length.extent",
            "did you mean `axis`?",
        ],
    );
}

#[test]
fn missing_keys_are_named_with_their_meaning() {
    expect(
        "end = \"45 ms\"\n",
        "",
        &[
            "c.toml:3:1: `end` is missing in time",
            "simulated time (a time (s, ms, us, ns), positive)",
        ],
    );
    expect(
        "dimension = \"plane-strain\"\n",
        "",
        &[
            "c.toml:1:1: `dimension` is missing in the case",
            "plane-strain | 3d",
        ],
    );
    expect(
        "density = \"2800 kg/m^3\"\n",
        "",
        &[
            "c.toml:11:",
            "`density` is missing in material.al.hencky_von_mises",
            "kg/m^3",
        ],
    );
    expect(
        "name = \"billet\"\n",
        "",
        &["c.toml:6:1: `name` is missing in body.0"],
    );
    expect(
        "where = \"billet.top\"\n",
        "",
        &[
            "c.toml:16:1: `where` is missing in boundary.0",
            "a selection",
        ],
    );
    expect(
        "velocity = { y = \"-1 m/s\" }\n",
        "",
        &["c.toml:16:1: boundary.0 needs one of: fixed, roller, velocity, traction"],
    );
    expect(
        "plane = { point = [0, 0], normal = [0, 1] }\n",
        "",
        &["c.toml:19:1: obstacle.floor needs one of: profile, drawing, plane"],
    );
}

#[test]
fn wrong_types_say_what_is_wanted_and_what_was_found() {
    expect(
        "cfl = 0.3",
        "cfl = true",
        &[
            "c.toml:5:7: `time.cfl` must be a number",
            "but is a boolean",
        ],
    );
    expect(
        "title = \"billet\"",
        "title = 3",
        &["c.toml:1:9: `title` must be a text, but is an integer"],
    );
    expect(
        "counts = [8, 50]",
        "counts = [8.5, 50]",
        &[
            "c.toml:9:",
            "`body.billet.lattice.counts.0` must be an integer, but is a number",
        ],
    );
    expect(
        "counts = [8, 50]",
        "counts = [8]",
        &["`body.billet.lattice.counts` must have 2 entries, one per axis, but has 1"],
    );
    expect(
        "[[body]]",
        "[body]",
        &[
            "c.toml:6:1: `body` must be a list of tables, but is a table",
            "[[body]]",
        ],
    );
    expect(
        "material = \"al\"",
        "material = 7",
        &["c.toml:10:12: `body.billet.material` must be a text"],
    );
}

#[test]
fn units_and_dimensions_are_checked() {
    expect(
        "\"45 ms\"",
        "\"45 mm\"",
        &["c.toml:4:7: `time.end` must be a time (s, ms, us, ns), but \"45 mm\" is a length"],
    );
    expect(
        "\"45 ms\"",
        "\"45 mss\"",
        &[
            "c.toml:4:7:",
            "unknown unit `mss` in `45 mss`",
            "did you mean `ms`?",
        ],
    );
    expect(
        "\"45 ms\"",
        "\"45\"",
        &["`45` is a text without a unit; write 45 without quotes"],
    );
    expect(
        "\"45 ms\"",
        "\"soon\"",
        &["`soon` does not start with a number"],
    );
    expect(
        "\"2800 kg/m^3\"",
        "\"2800 kg/m^2\"",
        &[
            "c.toml:12:11:",
            "must be a density (kg/m^3, g/cm^3)",
            "a quantity in kg/m^2",
        ],
    );
    expect(
        "\"69 GPa\"",
        "\"69 Gpa\"",
        &["c.toml:13:17:", "unknown unit `Gpa`", "did you mean `GPa`?"],
    );
    expect(
        "\"-1 m/s\"",
        "\"-1 m\"",
        &["c.toml:18:18: `boundary.0.velocity.y` must be a velocity"],
    );
}

#[test]
fn values_out_of_range_are_refused() {
    expect(
        "\"45 ms\"",
        "0",
        &["c.toml:4:7: `time.end` must be positive, but is 0 s"],
    );
    expect(
        "\"45 ms\"",
        "inf",
        &["`time.end` must be finite, but is inf"],
    );
    expect(
        "cfl = 0.3",
        "cfl = -0.3",
        &["`time.cfl` must be positive, but is -0.3"],
    );
    expect(
        "\"2800 kg/m^3\"",
        "-2800",
        &[
            "c.toml:12:11: `material.al.hencky_von_mises.density` must be greater than 0, but is -2800",
        ],
    );
    expect(
        "poisson_ratio = 0.33",
        "poisson_ratio = 0.5",
        &[
            "c.toml:14:17:",
            "`material.al.hencky_von_mises.poisson_ratio` must be greater than -1 and less than 0.5, but is 0.5",
        ],
    );
    expect(
        "counts = [8, 50]",
        "spacing = 0",
        &["c.toml:9:23: `body.billet.lattice.spacing` must be positive, but is 0 m"],
    );
    expect(
        "counts = [8, 50]",
        "counts = [1, 50]",
        &["`body.billet.lattice.counts.0` must be at least 2, but is 1"],
    );
    expect(
        "counts = [8, 50]",
        "spacing = \"1 nm\"",
        &["c.toml:9:", "nodes, the limit is", "enlarge the spacing"],
    );
    expect(
        "max = [\"8 mm\"",
        "max = [\"-8 mm\"",
        &["c.toml:8:", "size along x of the box is -0.008 m"],
    );
    expect(
        "normal = [0, 1]",
        "normal = [0, 0]",
        &["c.toml:21:9:", "the normal of a plane"],
    );
}

#[test]
fn unknown_names_suggest_the_nearest() {
    expect(
        "material = \"al\"",
        "material = \"al1100_ecea\"",
        &[
            "c.toml:10:12: unknown material `al1100_ecea`",
            "allowed: al, copper_taylor, al1100_ecae",
            "did you mean `al1100_ecae`?",
        ],
    );
    expect(
        "\"billet.top\"",
        "\"bilet.top\"",
        &[
            "c.toml:17:9: unknown body `bilet`",
            "did you mean `billet`?",
        ],
    );
    expect(
        "\"billet.top\"",
        "\"billet.topp\"",
        &[
            "c.toml:17:9: body `billet` is a box and has no face `topp`",
            "allowed: left, right, bottom, top",
            "did you mean `top`?",
        ],
    );
    expect(
        "\"plane-strain\"",
        "\"plane-stress\"",
        &[
            "c.toml:2:13: `dimension` cannot be \"plane-stress\"",
            "did you mean `plane-strain`?",
        ],
    );
    expect(
        "cfl = 0.3",
        "integrator = \"leap-frog\"",
        &[
            "c.toml:5:14: `time.integrator` cannot be \"leap-frog\"",
            "did you mean `leapfrog`?",
        ],
    );
}

#[test]
fn broken_toml_and_unreadable_files_are_reported() {
    expect("cfl = 0.3", "cfl = = 0.3", &["c.toml:5:", "not TOML"]);
    expect(
        "cfl = 0.3",
        "cfl = 0.3\ncfl = 0.4",
        &["c.toml:6:1: not TOML: duplicate key"],
    );
    let error = jstsph_case::load("no/such/case.toml".as_ref(), &[])
        .expect_err("no file")
        .to_string();
    assert!(
        error.starts_with("cannot read case file no/such/case.toml: "),
        "{error}"
    );
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("binary.toml");
    std::fs::write(&path, [0xff, 0xfe, 0x00]).expect("written");
    let error = jstsph_case::load(&path, &[])
        .expect_err("not text")
        .to_string();
    assert!(
        error.contains("cannot read case file") && error.contains("UTF-8"),
        "{error}"
    );
}
