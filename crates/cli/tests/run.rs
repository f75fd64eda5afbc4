//! `jstsph run`: files, bits, interruption, continuation, failure.

mod common;

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use common::Place;
use jstsph_output::{Status, Summary, read_table};

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
        ", t = ",
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

/// Forces of prescribed velocities are written beside those of obstacles, and continued with them.
#[test]
fn a_run_with_a_prescribed_velocity_can_be_continued() {
    let place = Place::new();
    let text = place.text("block.toml")
        + "[[boundary]]\nwhere = \"block.top\"\nvelocity = { y = \"-150 m/s\" }\n";
    place.write("pushed.toml", &text);
    for (out, end) in [("whole", "6e-6"), ("parts", "4e-6")] {
        let line = format!("jstsph run @/pushed.toml --out @/{out} --quiet --set time.end={end}");
        assert_eq!(place.jstsph(&line).code, 0);
    }
    let longer =
        place.jstsph("jstsph run @/pushed.toml --out @/parts --resume --set time.end=6e-6");
    assert_eq!(longer.code, 0, "{}", longer.err);
    let [whole, parts] = ["whole", "parts"].map(|name| summary(&place.path(name)));
    assert_eq!(parts.simulated_time, whole.simulated_time);
    // The shorter run ended with a shorter step than the whole one made there.
    let (a, b) = (whole.energies.plastic, parts.energies.plastic);
    assert!((a / b - 1.0).abs() < 1e-3, "{a} {b}");
}
