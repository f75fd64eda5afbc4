//! What the program says: lists, checks, refusals.

mod common;

use common::Place;

#[test]
fn quiet_prints_nothing() {
    let place = Place::new();
    let run = place.jstsph("jstsph run @/block.toml --out @/r --quiet --set time.end=1e-6");
    assert_eq!((run.code, run.out.as_str(), run.err.as_str()), (0, "", ""));
}

#[test]
fn wrong_input_ends_with_code_2_and_writes_nothing() {
    let place = Place::new();
    place.write("file", "");
    for (line, text) in [
        ("jstsph run @/none.toml --out @/r", "cannot read case file"),
        (
            "jstsph run @/block.toml --out @/r --set time.end=0",
            "in --set time.end=0: `time.end` must be positive",
        ),
        (
            "jstsph run @/block.toml --out @/r --set time.edn=1",
            "did you mean `end`?",
        ),
        (
            "jstsph run @/block.toml --out @/r --set body.block.material=coper_taylor",
            "did you mean `copper_taylor`?",
        ),
        (
            "jstsph run @/block.toml --out @/r --set scheme.smoothing_ratio=0.1",
            "block.toml:9:11: body \"block\": ",
        ),
        (
            "jstsph run @/block.toml --out @/r --set probe.length.name=dt",
            "probe `dt` has the name of another column",
        ),
        ("jstsph run @/block.toml --out @/r --threads 0", "--threads"),
        (
            "jstsph run @/block.toml --out @/r --set nonsense",
            "KEY=VALUE",
        ),
        (
            "jstsph run @/block.toml --out @/r --force --resume",
            "cannot be used with",
        ),
        ("jstsph run @/block.toml --out @/file/r", "/file/r"),
        ("jstsph run @/block.toml --out @/file", "is not a folder"),
        ("jstsph list materails", "did you mean `materials`?"),
        ("jstsph new tailor-bar", "unknown case `tailor-bar`"),
        ("jstsph walk", "unrecognized subcommand"),
    ] {
        let run = place.jstsph(line);
        assert_eq!(run.code, 2, "{line}: {}", run.err);
        assert!(
            run.err.starts_with("error: ") && run.err.contains(text),
            "{line}:\n{}",
            run.err
        );
        assert_eq!(run.out, "", "{line}");
        assert!(!place.path("r").exists(), "{line} wrote something");
    }
}

#[test]
fn results_are_only_replaced_by_force_and_foreign_files_never() {
    let place = Place::new();
    let short = "jstsph run @/block.toml --out @/r --quiet --set time.end=1e-6";
    assert_eq!(place.jstsph(short).code, 0);
    place.write("r/notes.txt", "mine");
    let again = place.jstsph(short);
    assert_eq!(again.code, 2);
    assert!(
        again.err.contains("--force") && again.err.contains("--resume"),
        "{}",
        again.err
    );
    assert_eq!(place.jstsph(&format!("{short} --force")).code, 0);
    assert_eq!(place.text("r/notes.txt"), "mine");
}

#[test]
fn check_describes_the_case_and_writes_nothing() {
    let place = Place::new();
    let check = place.jstsph("jstsph check @/block.toml");
    assert_eq!(check.code, 0, "{}", check.err);
    for text in [
        "35 particles, 58 evaluation points at the bonds",
        "20.0000 us in about",
        "obstacle wall",
    ] {
        assert!(
            check.out.contains(text),
            "`{text}` is not in:\n{}",
            check.out
        );
    }
    let resolved = place.jstsph("jstsph check @/block.toml --resolved");
    assert!(
        resolved.out.contains("smoothing_ratio = 0.8"),
        "{}",
        resolved.out
    );
    assert_eq!(
        std::fs::read_dir(place.folder.path())
            .expect("a folder")
            .count(),
        1
    );
}

#[test]
fn lists_and_help_are_printed() {
    let place = Place::new();
    let lists = place.jstsph("jstsph list");
    for name in [
        "keys",
        "materials",
        "kernels",
        "shapes",
        "boundaries",
        "obstacles",
        "probes",
        "units",
        "cases",
    ] {
        assert!(
            lists.out.contains(&format!("\n  {name} ")),
            "{name} is not in:\n{}",
            lists.out
        );
        assert_eq!(place.jstsph(&format!("jstsph list {name}")).code, 0);
    }
    let help = place.jstsph("jstsph run --help");
    assert_eq!(help.code, 0);
    for option in [
        "--out",
        "--threads",
        "--set",
        "--quiet",
        "--force",
        "--resume",
    ] {
        assert!(help.out.contains(option), "{option}");
    }
}

#[test]
fn every_shipped_case_is_a_template_that_passes_its_own_check() {
    let place = Place::new();
    // What a template reads beside itself is not printed.
    let drawings = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/drawings");
    std::fs::create_dir(place.folder.path().join("drawings")).expect("a folder");
    for entry in std::fs::read_dir(drawings).expect("drawings") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name");
        std::fs::copy(&path, place.folder.path().join("drawings").join(name)).expect("copied");
    }
    let names = place.jstsph("jstsph new").out;
    for name in names
        .lines()
        .filter_map(|line| line.split_whitespace().next())
    {
        place.write(
            "template.toml",
            &place.jstsph(&format!("jstsph new {name}")).out,
        );
        let check = place.jstsph("jstsph check @/template.toml");
        assert_eq!(check.code, 0, "{name}: {}", check.err);
        assert!(
            !check.out.contains("the first steps fail"),
            "{name}: {}",
            check.out
        );
    }
}
