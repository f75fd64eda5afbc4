//! The program as a function: what it prints, writes and returns.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use jstsph_cli::run_until;
use jstsph_output::{Status, Summary, read_table};

/// A copper block that hits a wall: 35 particles, a few hundred steps.
const BLOCK: &str = r#"
title = "a block against a wall"
dimension = "plane-strain"
[time]
end = "20 us"
[[body]]
name = "block"
shape = { box = { min = [0, 0], max = ["4 mm", "6 mm"] } }
lattice = { counts = [5, 7] }
material = "copper_taylor"
velocity = [0, "-150 m/s"]
[[obstacle]]
name = "wall"
plane = { point = [0, 0], normal = [0, 1] }
[[probe]]
name = "length"
extent = { where = "block", axis = "y" }
[[probe]]
name = "above"
point = { position = [0, 1], field = "pressure" }
[output]
history_interval = "0.3 us"
frame_interval = "5 us"
restart_interval = "7 us"
"#;

struct Place {
    folder: tempfile::TempDir,
}

struct Outcome {
    code: u8,
    out: String,
    err: String,
}

/// Sets a flag when a text passes by.
struct Trigger<'a> {
    text: &'a str,
    flag: &'a AtomicBool,
    seen: Vec<u8>,
}

impl Write for Trigger<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.seen.extend_from_slice(bytes);
        if String::from_utf8_lossy(&self.seen).contains(self.text) {
            self.flag.store(true, Ordering::Relaxed);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl Place {
    fn new() -> Self {
        let place = Self {
            folder: tempfile::tempdir().expect("a folder"),
        };
        place.write("block.toml", BLOCK);
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).expect("written");
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    fn text(&self, name: &str) -> String {
        String::from_utf8(self.bytes(name)).expect("text")
    }

    /// Runs a command line in which `@` stands for the folder.
    fn jstsph(&self, line: &str) -> Outcome {
        self.until("\0", line)
    }

    /// The same, interrupted when `text` appears on standard error.
    fn until(&self, text: &str, line: &str) -> Outcome {
        let folder = self.folder.path().display().to_string();
        let words: Vec<String> = line
            .split_whitespace()
            .map(|word| word.replace('@', &folder))
            .collect();
        let flag = AtomicBool::new(false);
        let (mut out, mut err) = (
            Vec::new(),
            Trigger {
                text,
                flag: &flag,
                seen: Vec::new(),
            },
        );
        let code = run_until(words, &mut out, &mut err, &flag);
        Outcome {
            code,
            out: String::from_utf8(out).expect("text"),
            err: String::from_utf8(err.seen).expect("text"),
        }
    }
}

fn summary(path: &Path) -> Summary {
    Summary::read(path).expect("a summary")
}

#[test]
fn a_run_writes_every_file_and_says_what_came_out() {
    let place = Place::new();
    let run = place.jstsph("jstsph run @/block.toml --out @/r");
    assert_eq!(run.code, 0, "{}", run.err);
    for text in [
        "block: completed 20.0000 us",
        "energy balance",
        "length ",
        "frames.pvd in ParaView",
    ] {
        assert!(run.out.contains(text), "`{text}` is not in:\n{}", run.out);
    }
    assert!(
        run.err.contains("35 particles, 58 evaluation points"),
        "{}",
        run.err
    );
    assert!(
        run.err.contains("steps/s") && run.err.contains("balance"),
        "{}",
        run.err
    );

    let summary = summary(&place.path("r"));
    assert_eq!(
        (summary.case.as_str(), summary.status, summary.particles),
        ("block", Status::Completed, 35)
    );
    assert_eq!(summary.simulated_time, 20e-6);
    assert!(
        summary.energies.balance.abs() < 0.01,
        "{}",
        summary.energies.balance
    );
    assert!(
        (4e-3..6e-3).contains(&summary.probes["length"]),
        "{:?}",
        summary.probes
    );
    assert!(summary.probes["above"].is_nan(), "no particle is up there");

    let history = read_table(&place.path("r/history.csv")).expect("a table");
    let time = history.column("time").expect("time");
    assert_eq!((time[0], time[time.len() - 1]), (0.0, 20e-6));
    // A row at the start, one for each of the 66 whole intervals and one at the end.
    assert_eq!(time.len(), 68);
    // The wall takes the whole momentum of the block and more: Σ force × time = change of momentum.
    let force = history.column("force_wall_y").expect("reaction");
    let momentum = history.column("momentum_y").expect("momentum");
    let impulse: f64 = (1..time.len())
        .map(|row| force[row] * (time[row] - time[row - 1]))
        .sum();
    let change = momentum[time.len() - 1] - momentum[0];
    assert!(
        (impulse + change).abs() < 1e-9 * change.abs(),
        "{impulse} and {change}"
    );
    assert!(history.column("momentum_z").is_none(), "plane strain");

    let collection = place.text("r/frames/frames.pvd");
    assert_eq!(collection.matches("<DataSet").count(), 5);
    assert!(
        place
            .bytes("r/frames/frame_000004.vtu")
            .starts_with(b"<?xml")
    );
    let record: serde_json::Value =
        serde_json::from_slice(&place.bytes("r/run.json")).expect("JSON");
    assert_eq!(record["exit_reason"], "completed");
    assert_eq!(record["threads"], 1);
    assert!(place.text("r/run.log").contains("completed"));
}

#[test]
fn the_resolved_case_gives_the_same_bits() {
    let place = Place::new();
    assert_eq!(
        place
            .jstsph("jstsph run @/block.toml --out @/a --quiet")
            .code,
        0
    );
    assert_eq!(
        place
            .jstsph("jstsph run @/a/case.toml --out @/b --quiet")
            .code,
        0
    );
    assert_eq!(place.bytes("a/history.csv"), place.bytes("b/history.csv"));
    assert_eq!(place.bytes("a/case.toml"), place.bytes("b/case.toml"));
}

#[test]
fn threads_do_not_change_the_bits() {
    let place = Place::new();
    // More particles than the solver's threshold for parallel loops.
    let finer = "--set body.block.lattice.counts=[50,60] --set time.end=5e-7 --quiet";
    assert_eq!(
        place
            .jstsph(&format!(
                "jstsph run @/block.toml --out @/a --threads 1 {finer}"
            ))
            .code,
        0
    );
    assert_eq!(
        place
            .jstsph(&format!(
                "jstsph run @/block.toml --out @/b --threads 3 {finer}"
            ))
            .code,
        0
    );
    assert_eq!(place.bytes("a/history.csv"), place.bytes("b/history.csv"));
}

#[test]
fn quiet_prints_nothing() {
    let place = Place::new();
    let run = place.jstsph("jstsph run @/block.toml --out @/r --quiet --set time.end=1e-6");
    assert_eq!((run.code, run.out.as_str(), run.err.as_str()), (0, "", ""));
}

#[test]
fn an_interrupted_run_continues_with_the_same_bits() {
    let place = Place::new();
    assert_eq!(
        place
            .jstsph("jstsph run @/block.toml --out @/whole --quiet")
            .code,
        0
    );
    let stopped = place.until(" 50.", "jstsph run @/block.toml --out @/parts");
    assert_eq!(stopped.code, 130, "{}", stopped.err);
    assert!(
        stopped.out.contains("continue with --resume"),
        "{}",
        stopped.out
    );
    assert_eq!(summary(&place.path("parts")).status, Status::Interrupted);

    let resumed = place.jstsph("jstsph run @/block.toml --out @/parts --resume");
    assert_eq!(resumed.code, 0, "{}", resumed.err);
    assert!(!resumed.err.contains("differs"), "{}", resumed.err);
    assert_eq!(
        place.text("parts/history.csv"),
        place.text("whole/history.csv")
    );
    for frame in 0..5 {
        let name = format!("frames/frame_00000{frame}.vtu");
        assert_eq!(
            place.bytes(&format!("parts/{name}")),
            place.bytes(&format!("whole/{name}")),
            "{name}"
        );
    }
}

#[test]
fn a_finished_run_can_be_made_longer_and_a_changed_case_is_noticed() {
    let place = Place::new();
    assert_eq!(
        place
            .jstsph("jstsph run @/block.toml --out @/r --quiet --set time.end=5e-6")
            .code,
        0
    );
    let longer = place.jstsph(
        "jstsph run @/block.toml --out @/r --resume --set time.end=6e-6 --set time.cfl=0.4",
    );
    assert_eq!(longer.code, 0, "{}", longer.err);
    assert!(
        longer
            .err
            .contains("the case differs from the one that is continued, first in: cfl = 0.4"),
        "{}",
        longer.err
    );
    assert_eq!(summary(&place.path("r")).simulated_time, 6e-6);
    let other = place
        .jstsph("jstsph run @/block.toml --out @/r --resume --set body.block.lattice.counts=[6,7]");
    assert_eq!(other.code, 2);
    assert!(
        other.err.contains("cannot continue the run in"),
        "{}",
        other.err
    );
    let none = place.jstsph("jstsph run @/block.toml --out @/nothing --resume");
    assert_eq!(none.code, 2);
    assert!(none.err.contains("start without --resume"), "{}", none.err);
}

#[test]
fn a_failing_run_says_where_and_leaves_its_last_good_state() {
    let place = Place::new();
    let run = place.jstsph("jstsph run @/block.toml --out @/r --set time.cfl=4");
    assert_eq!(run.code, 1, "{}{}", run.out, run.err);
    for text in [
        "error: the run failed: ",
        "of body \"block\" at (",
        "at t = ",
        "time.cfl (now 4)",
        "the last good state",
    ] {
        assert!(run.err.contains(text), "`{text}` is not in:\n{}", run.err);
    }
    let summary = summary(&place.path("r"));
    assert_eq!(summary.status, Status::Failed);
    assert!(
        summary
            .warnings
            .iter()
            .any(|warning| warning.contains("failed: ")),
        "{:?}",
        summary.warnings
    );
    assert!(summary.extremes.jacobian_min > 0.0 && summary.energies.kinetic.is_finite());
    assert!(
        std::fs::read_dir(place.path("r/restart"))
            .expect("a folder")
            .next()
            .is_some()
    );
    let record: serde_json::Value =
        serde_json::from_slice(&place.bytes("r/run.json")).expect("JSON");
    assert!(
        record["exit_reason"]
            .as_str()
            .expect("text")
            .starts_with("failed: ")
    );
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

#[cfg(unix)]
#[test]
fn a_signal_ends_the_process_in_good_order() {
    let place = Place::new();
    let mut child = Command::new(env!("CARGO_BIN_EXE_jstsph"))
        .args([
            "run",
            "block.toml",
            "--out",
            "r",
            "--quiet",
            "--set",
            "time.end=1",
            "--set",
            "output.restart_interval=1",
        ])
        .current_dir(place.folder.path())
        .spawn()
        .expect("started");
    // The record is written before the time loop; the handler is installed before everything.
    let patience = Instant::now() + Duration::from_secs(60);
    while !place.path("r/run.log").exists() {
        assert!(Instant::now() < patience, "the run did not start");
        std::thread::sleep(Duration::from_millis(10));
    }
    let signal = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .expect("kill");
    assert!(signal.success());
    assert_eq!(child.wait().expect("ended").code(), Some(130));
    assert_eq!(summary(&place.path("r")).status, Status::Interrupted);
    assert!(
        std::fs::read_dir(place.path("r/restart"))
            .expect("a folder")
            .next()
            .is_some()
    );
}
