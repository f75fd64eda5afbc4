//! The files around a run are not as it left them: damaged states, a folder in use,
//! a full disk.

use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use jstsph_output::{RunRecord, read_latest_restart, read_table, read_vtu};

use crate::common::{Outcome, Place};

/// The restart files of a run, oldest first.
fn states(place: &Place, out: &str) -> Vec<PathBuf> {
    let folder = place.path(&format!("{out}/restart"));
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .collect();
    paths.sort();
    paths
}

#[test]
fn a_damaged_state_is_passed_over_for_the_one_before_it() {
    let place = Place::new();
    let run = "jstsph run @/block.toml --quiet --no-pictures";
    assert_eq!(place.jstsph(&format!("{run} --out @/whole")).code, 0);
    assert_eq!(place.jstsph(&format!("{run} --out @/r")).code, 0);
    type Damage = fn(&mut Vec<u8>);
    let damages: [(&str, Damage, &str); 5] = [
        (
            "truncated",
            |bytes| bytes.truncate(bytes.len() / 2),
            "is damaged",
        ),
        ("a flipped bit", |bytes| bytes[900] ^= 4, "is damaged"),
        ("longer", |bytes| bytes.push(0), "is damaged"),
        (
            "foreign",
            |bytes| *bytes = b"my notes".to_vec(),
            "is not a restart file",
        ),
        ("empty", Vec::clear, "is not a restart file"),
    ];
    for (what, damage, problem) in damages {
        let paths = states(&place, "r");
        assert_eq!(paths.len(), 2, "the two latest are kept");
        let mut bytes = std::fs::read(&paths[1]).expect("a state");
        damage(&mut bytes);
        std::fs::write(&paths[1], &bytes).expect("written");
        let resumed = place.jstsph(&format!("{run} --out @/r --resume"));
        assert_eq!(resumed.code, 0, "{what}: {}", resumed.err);
        let name = paths[1].file_name().expect("a name").to_string_lossy();
        for text in ["warning: ", &*name, problem, "the state before it is used"] {
            assert!(resumed.err.contains(text), "{what}: {}", resumed.err);
        }
        assert!(place.text("r/run.log").contains(problem), "{what}");
        assert_eq!(
            place.text("r/history.csv"),
            place.text("whole/history.csv"),
            "{what}"
        );
    }
    // With no usable state nothing is touched, and the reasons are given.
    for path in states(&place, "r") {
        std::fs::write(path, "").expect("written");
    }
    let refused = place.jstsph(&format!("{run} --out @/r --resume"));
    assert_eq!(refused.code, 2);
    assert_eq!(refused.err.matches("is not a restart file").count(), 2);
    assert_eq!(place.text("r/history.csv"), place.text("whole/history.csv"));
}

#[test]
fn a_run_made_longer_has_every_row_and_frame_once() {
    let place = Place::new();
    let run = "jstsph run @/block.toml --out @/r --quiet --no-pictures";
    assert_eq!(place.jstsph(&format!("{run} --set time.end=8e-6")).code, 0);
    let longer = place.jstsph(&format!("{run} --resume"));
    assert_eq!((longer.code, longer.err.as_str()), (0, ""));
    let table = read_table(&place.path("r/history.csv")).expect("a table");
    let time = table.column("time").expect("times");
    assert!(time.windows(2).all(|pair| pair[0] < pair[1]), "{time:?}");
    // As in a run of this length at once, and the end of the first part.
    assert_eq!((time.len(), time[time.len() - 1]), (69, 20e-6));
    let names = place.text("r/frames/frames.pvd");
    assert_eq!(names.matches("<DataSet").count(), 6);
}

#[test]
fn fields_and_intervals_in_steps_are_those_of_the_case() {
    let place = Place::new();
    place.write(
        "steps.toml",
        &place
            .text("block.toml")
            .replace("frame_interval = \"5 us\"", "frame_steps = 40")
            .replace("restart_interval = \"7 us\"", "restart_steps = 25")
            .replace(
                "history_interval = \"0.3 us\"",
                "history_steps = 10\nfields = [\"velocity\", \"pressure\"]",
            ),
    );
    let run = place.jstsph("jstsph run @/steps.toml --out @/r --set time.end=1e-5");
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(run.out.contains("final.png"), "{}", run.out);
    let table = read_table(&place.path("r/history.csv")).expect("a table");
    let steps = table.column("step").expect("steps");
    let (last, regular) = steps.split_last().expect("rows");
    assert!(*last > 100.0, "{last} steps are too few for this test");
    assert!(
        regular
            .iter()
            .enumerate()
            .all(|(k, s)| *s == 10.0 * k as f64)
    );
    let frame = read_vtu(&place.path("r/frames/frame_000002.vtu")).expect("a frame");
    assert_eq!(frame.step, 80);
    let names: Vec<&str> = frame
        .scalars
        .iter()
        .map(|(name, _)| name.as_str())
        .collect();
    assert_eq!(names, ["pressure"]);
    assert_eq!((frame.vectors.len(), frame.tensors.len()), (1, 0));
    // The last state is that of the end, the one before it a multiple of 25.
    let before = states(&place, "r")[0].display().to_string();
    let step: u64 = before[before.len() - 19..before.len() - 7]
        .parse()
        .expect("a step");
    assert!(step > 0 && step.is_multiple_of(25), "{before}");

    // The words of the author are kept beside the resolved case.
    assert_eq!(place.text("r/case.original.toml"), place.text("steps.toml"));
    assert!(
        place
            .text("r/case.toml")
            .contains("fields = [\"velocity\", \"pressure\"]")
    );
}

fn command(place: &Place, words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_jstsph"));
    command
        .args(words)
        .current_dir(place.folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

fn outcome(child: Child) -> Outcome {
    let output = child.wait_with_output().expect("ended");
    let text = |bytes| String::from_utf8(bytes).expect("text");
    Outcome {
        code: output.status.code().map_or(255, |code| code as u8),
        out: text(output.stdout),
        err: text(output.stderr),
    }
}

/// A run that goes on until it is stopped, past its second frame.
fn endless(place: &Place, out: &str) -> Child {
    let words = [
        "run",
        "block.toml",
        "--out",
        out,
        "--set",
        "time.end=1",
        "--no-pictures",
    ];
    let mut child = command(place, &words).spawn().expect("started");
    let patience = Instant::now() + Duration::from_secs(60);
    while !place.path(out).join("frames/frame_000001.vtu").exists() {
        assert!(Instant::now() < patience, "the run did not start");
        assert_eq!(child.try_wait().expect("a status"), None, "the run ended");
        std::thread::sleep(Duration::from_millis(5));
    }
    child
}

#[test]
fn a_folder_belongs_to_one_run_at_a_time() {
    let place = Place::new();
    let mut first = endless(&place, "r");
    let holder = format!("is in use by a run (process {} since ", first.id());
    for option in ["", "--force", "--resume"] {
        let second = place.jstsph(&format!("jstsph run @/block.toml --out @/r {option}"));
        assert_eq!(second.code, 2, "{}", second.err);
        assert!(second.err.contains(&holder), "{}", second.err);
    }
    // Looking is allowed.
    for line in ["jstsph report @/r", "jstsph plot @/r --history energies"] {
        let look = place.jstsph(line);
        assert_eq!(look.code, 0, "{line}: {}", look.err);
    }
    // A crash releases the folder.
    first.kill().expect("killed");
    first.wait().expect("ended");
    let resumed = place.jstsph("jstsph run @/block.toml --out @/r --resume --no-pictures");
    assert_eq!(resumed.code, 0, "{}", resumed.err);
}

/// Runs with files limited to some blocks of 512 bytes, as a full disk limits them.
#[cfg(target_os = "linux")]
fn limited(place: &Place, blocks: u32, words: &str) -> Outcome {
    let shell = format!(
        "trap '' XFSZ; ulimit -f {blocks}; exec {} {words}",
        env!("CARGO_BIN_EXE_jstsph")
    );
    let child = Command::new("sh")
        .args(["-c", &shell])
        .current_dir(place.folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("started");
    outcome(child)
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_ends_the_run_with_its_last_good_state() {
    let place = Place::new();
    let whole = place.jstsph("jstsph run @/block.toml --out @/whole --quiet --no-pictures");
    assert_eq!(whole.code, 0, "{}", whole.err);
    // Above the size of every other file, so that a row of the history is the one that is cut.
    let largest = |place: &Place, folder: &str| {
        let entries = std::fs::read_dir(place.path(folder)).expect("a folder");
        let sizes = entries.map(|e| e.expect("an entry").metadata().expect("data").len());
        sizes.max().unwrap_or(0)
    };
    let state = largest(&place, "whole/restart");
    let blocks = u32::try_from(state / 512 + 1).expect("small");
    let many = "output.history_interval=0.5e-7";
    let run = format!("run block.toml --out r --no-pictures --set {many}");
    let full = limited(&place, blocks, &run);
    assert_eq!(full.code, 1, "{}{}", full.out, full.err);
    for text in [
        "error: the run stopped at t = ",
        "cannot append to r/history.csv: ",
        "the last good state is r/restart/state-0",
        "continue with --resume",
    ] {
        assert!(full.err.contains(text), "`{text}` is not in:\n{}", full.err);
    }
    let history = place.text("r/history.csv");
    assert!(history.ends_with('\n'), "half a row was left");
    assert!(!place.path("r/summary.json").exists());
    let record = RunRecord::read(&place.path("r")).expect("a record");
    assert!(
        record
            .exit_reason
            .expect("a reason")
            .starts_with("stopped: cannot append")
    );
    let (_, damaged) = read_latest_restart(&place.path("r/restart")).expect("a state");
    assert!(damaged.is_empty(), "{damaged:?}");

    // With room again it ends as if nothing had been.
    let resumed = place.jstsph(&format!(
        "jstsph run @/block.toml --out @/r --quiet --no-pictures --resume --set {many}"
    ));
    assert_eq!((resumed.code, resumed.err.as_str()), (0, ""));
    let straight = place.jstsph(&format!(
        "jstsph run @/block.toml --out @/s --quiet --no-pictures --set {many}"
    ));
    assert_eq!(straight.code, 0);
    assert_eq!(place.text("r/history.csv"), place.text("s/history.csv"));

    // No room for a single state: nothing is left that could be taken for one.
    let blocks = u32::try_from(state / 1024).expect("small");
    let none = limited(&place, blocks, "run block.toml --out none --no-pictures");
    assert_eq!(none.code, 1, "{}{}", none.out, none.err);
    assert!(none.err.contains("no state was saved"), "{}", none.err);
    assert!(states(&place, "none").is_empty());
}

#[cfg(unix)]
#[test]
fn a_folder_that_vanishes_under_a_run_ends_it_with_its_last_good_state() {
    let place = Place::new();
    let child = endless(&place, "r");
    std::fs::rename(place.path("r/frames"), place.path("frames")).expect("renamed");
    place.write("r/frames", "in the way");
    let stopped = outcome(child);
    assert_eq!(stopped.code, 1, "{}", stopped.err);
    for text in [
        "cannot write r/frames/",
        "the last good state is r/restart/state-0",
    ] {
        assert!(
            stopped.err.contains(text),
            "`{text}` is not in:\n{}",
            stopped.err
        );
    }
    let refused = place.jstsph("jstsph run @/block.toml --out @/r --resume");
    assert_eq!(refused.code, 2, "{}", refused.err);
    assert!(refused.err.contains("r/frames"), "{}", refused.err);
    // Put back, it goes on.
    std::fs::remove_file(place.path("r/frames")).expect("removed");
    std::fs::rename(place.path("frames"), place.path("r/frames")).expect("renamed");
    let resumed = command(
        &place,
        &[
            "run",
            "block.toml",
            "--out",
            "r",
            "--resume",
            "--no-pictures",
        ],
    );
    let state = read_latest_restart(&place.path("r/restart"))
        .expect("a state")
        .0;
    let end = state.header["time"].as_f64().expect("a time") + 1e-6;
    let mut resumed = resumed;
    resumed.args(["--set", &format!("time.end={end:e}")]);
    let resumed = outcome(resumed.spawn().expect("started"));
    assert_eq!(resumed.code, 0, "{}", resumed.err);
}
