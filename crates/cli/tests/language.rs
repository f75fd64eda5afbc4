//! Commands around the case language: schema, keys, completions, manual, sweep.

mod common;

use std::sync::atomic::AtomicBool;

use common::{Outcome, Place};

/// Runs a command line whose words may contain spaces.
fn jstsph(words: &[&str]) -> Outcome {
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let words = ["jstsph"].into_iter().chain(words.iter().copied());
    let code = jstsph_cli::run_until(words, &mut out, &mut err, &AtomicBool::new(false));
    Outcome {
        code,
        out: String::from_utf8(out).expect("text"),
        err: String::from_utf8(err).expect("text"),
    }
}

#[test]
fn the_schema_is_json_and_the_page_of_keys_names_its_keys() {
    let schema = jstsph(&["schema"]);
    assert_eq!(schema.code, 0, "{}", schema.err);
    let json: serde_json::Value = serde_json::from_str(&schema.out).expect("JSON");
    assert!(json["properties"]["time"]["properties"]["cfl"].is_object());
    let page = jstsph(&["list", "--markdown"]);
    assert!(page.out.contains("- `cfl` "), "{}", page.out);
}

#[test]
fn completions_and_manual_know_every_command() {
    let place = Place::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let text = jstsph(&["completions", shell]);
        assert_eq!(text.code, 0, "{}", text.err);
        assert!(
            text.out.contains("sweep") && text.out.contains("reproduce"),
            "{shell}"
        );
    }
    assert_eq!(jstsph(&["completions", "dos"]).code, 2);
    let page = place.jstsph("jstsph man");
    assert!(page.out.contains(".TH jstsph 1"), "{}", page.out);
    let folder = place.folder.path().join("man");
    let written = jstsph(&["man", folder.to_str().expect("a name")]);
    assert_eq!(written.code, 0, "{}", written.err);
    let page = std::fs::read_to_string(folder.join("jstsph-sweep.1")).expect("a page");
    assert!(page.contains("vary"), "{page}");
}

/// Rows of a table with a header, by column.
fn column(csv: &str, name: &str) -> Vec<String> {
    let mut lines = csv.lines();
    let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let at = header
        .iter()
        .position(|column| *column == name)
        .unwrap_or_else(|| panic!("no {name} in {header:?}"));
    lines
        .map(|line| line.split(',').nth(at).unwrap_or_default().to_owned())
        .collect()
}

#[test]
fn a_sweep_runs_every_combination_and_reuses_what_is_finished() {
    let place = Place::new();
    let out = place.folder.path().join("study");
    let arguments = |vary: &'static str| {
        vec![
            "sweep".to_owned(),
            place.folder.path().join("block.toml").display().to_string(),
            "--vary".to_owned(),
            vary.to_owned(),
            "--vary".to_owned(),
            "time.cfl=0.4,0.5".to_owned(),
            "--set".to_owned(),
            "time.end=5 us".to_owned(),
            "--jobs".to_owned(),
            "2".to_owned(),
            "--out".to_owned(),
            out.display().to_string(),
        ]
    };
    let run = |vary| {
        let words = arguments(vary);
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        jstsph(&words)
    };
    let outcome = run("obstacle.wall.friction=0,0.5");
    assert_eq!(outcome.code, 0, "{}{}", outcome.out, outcome.err);
    let csv = place.text("study/sweep.csv");
    assert_eq!(column(&csv, "status"), ["completed"; 4]);
    assert_eq!(
        column(&csv, "obstacle.wall.friction"),
        ["0", "0", "0.5", "0.5"]
    );
    let steps: Vec<u32> = column(&csv, "steps")
        .iter()
        .map(|steps| steps.parse().expect("a number"))
        .collect();
    assert!(
        steps[0] > steps[1],
        "a smaller CFL number makes more steps: {steps:?}"
    );
    // The same number as a run of its own.
    let alone = jstsph(&[
        "run",
        place
            .folder
            .path()
            .join("block.toml")
            .to_str()
            .expect("a name"),
        "--set",
        "time.end=5 us",
        "--set",
        "time.cfl=0.4",
        "--quiet",
        "--out",
        place.folder.path().join("alone").to_str().expect("a name"),
    ]);
    assert_eq!(alone.code, 0, "{}", alone.err);
    let summary =
        std::fs::read_to_string(place.folder.path().join("alone/summary.json")).expect("a summary");
    let summary: serde_json::Value = serde_json::from_str(&summary).expect("JSON");
    let length: f64 = column(&csv, "length")[0].parse().expect("a number");
    assert_eq!(Some(length), summary["probes"]["length"].as_f64());
    assert!(place.bytes("study/sweep.png").len() > 5000);

    let outcome = run("obstacle.wall.friction=0,0.5,1");
    assert_eq!(outcome.code, 0, "{}{}", outcome.out, outcome.err);
    assert_eq!(
        outcome.err.matches("finished earlier").count(),
        4,
        "{}",
        outcome.err
    );
    assert_eq!(outcome.err.matches("done in").count(), 2, "{}", outcome.err);
}

#[test]
fn a_failed_run_is_a_row_and_a_wrong_value_an_error() {
    let place = Place::new();
    let case = place.folder.path().join("block.toml").display().to_string();
    let out = place.folder.path().join("study").display().to_string();
    let sweep =
        |vary: &str| jstsph(&["sweep", &case, "--vary", vary, "--out", &out, "--jobs", "1"]);
    // A hundred times the stable step breaks down at once.
    let outcome = sweep("time.cfl=0.5,100");
    assert_eq!(outcome.code, 1, "{}{}", outcome.out, outcome.err);
    let csv =
        std::fs::read_to_string(place.folder.path().join("study/sweep.csv")).expect("a table");
    assert_eq!(column(&csv, "status"), ["completed", "failed"]);
    assert!(outcome.out.contains("failed"), "{}", outcome.out);

    for (vary, message) in [
        ("time.clf=0.5", "did you mean `cfl`?"),
        ("time.cfl=-1", "must be positive"),
        ("time.cfl=0.5,", "a value is empty"),
        ("time.cfl=0.5,0.5", "a value is there twice"),
        ("lattice.counts=[5,7", "not closed"),
    ] {
        let outcome = sweep(vary);
        assert_eq!(outcome.code, 2, "{vary}: {}", outcome.err);
        assert!(outcome.err.contains(message), "{vary}: {}", outcome.err);
    }
    // A key of the only body.
    let outcome = sweep("lattice.counts=[5,7];[7,10]");
    assert_eq!(outcome.code, 0, "{}{}", outcome.out, outcome.err);
    assert!(
        place
            .folder
            .path()
            .join("study/lattice.counts=7-10/summary.json")
            .is_file()
    );
}

#[test]
fn a_run_can_be_repeated_from_its_results_alone() {
    let place = Place::new();
    let root = place.folder.path();
    std::fs::create_dir(root.join("drawings")).expect("a folder");
    let drawing =
        "<svg xmlns=\"http://www.w3.org/2000/svg\"><path d=\"M 0 0 H 4 V -6 H 0 Z\"/></svg>";
    std::fs::write(root.join("drawings/block.svg"), drawing).expect("written");
    let text = common::BLOCK.replace(
        r#"shape = { box = { min = [0, 0], max = ["4 mm", "6 mm"] } }"#,
        r#"shape = { drawing = { file = "drawings/block.svg", unit = "mm" } }"#,
    );
    std::fs::write(root.join("drawn.toml"), text).expect("written");
    let run = |case: &str, out: &str| {
        let (case, out) = (root.join(case), root.join(out));
        let (case, out) = (
            case.to_str().expect("a name"),
            out.to_str().expect("a name"),
        );
        let outcome = jstsph(&[
            "run",
            case,
            "--out",
            out,
            "--quiet",
            "--force",
            "--no-pictures",
        ]);
        assert_eq!(outcome.code, 0, "{}{}", outcome.out, outcome.err);
    };
    run("drawn.toml", "first");
    std::fs::rename(root.join("first"), root.join("moved")).expect("moved");
    std::fs::remove_dir_all(root.join("drawings")).expect("removed");
    run("moved/case.original.toml", "second");
    run("moved/case.toml", "third");
    assert_eq!(
        place.text("moved/history.csv"),
        place.text("second/history.csv")
    );
    assert_eq!(
        place.text("moved/history.csv"),
        place.text("third/history.csv")
    );
    // Into the folder from which it was read, whose copies are removed at the start.
    run("second/case.original.toml", "second");
    assert_eq!(place.text("second/inputs/1-block.svg"), drawing);
    assert_eq!(
        place.text("moved/history.csv"),
        place.text("second/history.csv")
    );
}

#[test]
fn vtkhdf_frames_are_written_or_refused_before_anything_is() {
    let place = Place::new();
    let path = |name: &str| place.folder.path().join(name).display().to_string();
    let outcome = jstsph(&[
        "run",
        &path("block.toml"),
        "--out",
        &path("results"),
        "--set",
        "output.format=vtkhdf",
        "--quiet",
        "--no-pictures",
    ]);
    let frame = |end: &str| {
        place
            .folder
            .path()
            .join("results/frames/frame_000001")
            .with_extension(end)
    };
    if jstsph_output::HAS_VTKHDF {
        assert_eq!(outcome.code, 0, "{}", outcome.err);
        assert!(frame("vtkhdf").exists() && frame("vtu").exists());
    } else {
        assert_eq!(outcome.code, 2);
        assert!(outcome.err.contains("--features vtkhdf"), "{}", outcome.err);
        assert!(!place.folder.path().join("results").exists());
    }
}
