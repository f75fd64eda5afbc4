//! Killed at any moment: nothing half-written is believed, little is lost, and what
//! is resumed ends with the same bits.

use std::path::Path;
use std::process::{Child, Command, ExitStatus};
use std::time::{Duration, Instant};

use jstsph_output::{
    Collection, RestartData, RunRecord, Summary, read_latest_restart, read_table, read_vtu,
};

use crate::common::{BLOCK, Place};

/// Restart files every few milliseconds of wall time, frames and rows more often.
const SETTINGS: [&str; 4] = [
    "time.end=20e-6",
    "output.restart_interval=1.5e-6",
    "output.frame_interval=1.2e-6",
    "output.history_interval=0.2e-6",
];
const RESTART_INTERVAL: f64 = 1.5e-6;
const FRAMES: usize = 18;
const KILLS: usize = 50;

/// Marsaglia's xorshift: the same moments every time, as fractions of the length of a run.
struct Moments(u64);

impl Moments {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A folder in memory where there is one: waiting for a busy disk is not what is tested.
fn place() -> Place {
    let memory = Path::new("/dev/shm");
    match tempfile::tempdir_in(memory) {
        Ok(folder) => {
            let place = Place { folder };
            place.write("block.toml", BLOCK);
            place
        }
        Err(_) => Place::new(),
    }
}

fn start(place: &Place, out: &str, resume: bool) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_jstsph"));
    command.args([
        "run",
        "block.toml",
        "--out",
        out,
        "--quiet",
        "--no-pictures",
    ]);
    for setting in SETTINGS {
        command.args(["--set", setting]);
    }
    if resume {
        command.arg("--resume");
    }
    command
        .current_dir(place.folder.path())
        .spawn()
        .expect("started")
}

/// Waits for the end or kills the process, which has no chance to notice.
fn kill_after(mut child: Child, delay: Duration) -> Option<ExitStatus> {
    let moment = Instant::now() + delay;
    while Instant::now() < moment {
        if let Some(status) = child.try_wait().expect("a status") {
            return Some(status);
        }
        std::thread::sleep(Duration::from_micros(500));
    }
    child.kill().expect("killed");
    child.wait().expect("ended");
    None
}

/// Simulated time of a state, s.
fn time_of(data: &RestartData) -> f64 {
    data.header["time"].as_f64().expect("a time")
}

/// Files that end as the name does, temporary ones left out.
fn files(folder: &Path, suffix: &str) -> Vec<std::path::PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    entries
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.to_string_lossy().ends_with(suffix))
        .collect()
}

/// Everything that a killed run left is whole, and its last state is not far behind its last row.
/// Returns the time of that state, if one was written.
fn inspect(folder: &Path) -> Option<f64> {
    for path in files(&folder.join("frames"), ".vtu") {
        let frame = read_vtu(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(frame.positions.len(), 35);
    }
    let collection = Collection::read(&folder.join("frames/frames.pvd")).expect("a collection");
    for (time, file) in collection.entries() {
        let frame = read_vtu(&folder.join("frames").join(file)).expect("a frame of the list");
        assert_eq!(frame.time, *time);
    }
    if folder.join("run.json").exists() {
        RunRecord::read(folder).expect("a record");
    }
    if folder.join("summary.json").exists() {
        Summary::read(folder).expect("a summary");
    }
    let states = files(&folder.join("restart"), ".jstsph").len();
    if states == 0 {
        return None;
    }
    // Three for the moment between the newest and the removal of the oldest.
    assert!(states <= 3, "{states} states");
    let (latest, damaged) = read_latest_restart(&folder.join("restart")).expect("a state");
    assert!(damaged.is_empty(), "{damaged:?}");
    let history = folder.join("history.csv");
    if time_of(&latest) == 0.0 && !history.exists() {
        return Some(0.0);
    }
    let rows = read_table(&history).expect("a table");
    let times = rows.column("time").expect("times");
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
    // A row is due every 2e-7 s, a step is about 7e-8 s. The run does not wait for a state to be on the disk
    // before the next one is due.
    let lost = times.last().map_or(0.0, |last| last - time_of(&latest));
    assert!(
        (-3e-7..2.0 * RESTART_INTERVAL + 3e-7).contains(&lost),
        "{lost} s are lost"
    );
    Some(time_of(&latest))
}

#[test]
fn a_run_killed_at_fifty_moments_ends_with_the_same_bits() {
    let place = place();
    let clock = Instant::now();
    assert!(
        start(&place, "whole", false)
            .wait()
            .expect("ended")
            .success()
    );
    let length = clock.elapsed();
    let same_as_whole = |out: &str| {
        let compare = |name: &str| {
            let (whole, parts) = (format!("whole/{name}"), format!("{out}/{name}"));
            assert!(
                place.bytes(&whole) == place.bytes(&parts),
                "{parts} differs"
            );
        };
        compare("history.csv");
        compare("frames/frames.pvd");
        let names = |out: &str, folder: &str, suffix: &str| {
            let mut names: Vec<_> = files(&place.path(&format!("{out}/{folder}")), suffix)
                .into_iter()
                .map(|path| {
                    path.file_name()
                        .expect("a name")
                        .to_string_lossy()
                        .into_owned()
                })
                .collect();
            names.sort();
            names
        };
        for (folder, suffix, count) in [("frames", ".vtu", FRAMES), ("restart", ".jstsph", 2)] {
            let expected = names("whole", folder, suffix);
            assert_eq!(expected.len(), count);
            assert_eq!(names(out, folder, suffix), expected);
            for name in expected {
                compare(&format!("{folder}/{name}"));
            }
        }
        assert!(files(&place.path(out), ".tmp").is_empty());
    };

    let mut moments = Moments(0x9e37_79b9_7f4a_7c15);
    let (mut kills, mut runs) = (0, 0);
    let (mut state, mut furthest) = (None, 0.0_f64);
    while kills < KILLS {
        let out = format!("parts_{runs}");
        let begun = place.path(&out).join("run.lock").exists();
        // Short parts in a row and long ones, so that every phase of a run is met.
        let delay = length.mul_f64(moments.next() * if kills % 2 == 0 { 0.5 } else { 1.2 });
        match kill_after(start(&place, &out, begun), delay) {
            Some(status) => {
                assert!(status.success(), "{status}");
                same_as_whole(&out);
                runs += 1;
                state = None;
            }
            None => {
                kills += 1;
                if place.path(&out).join("restart").exists() {
                    let after = inspect(&place.path(&out));
                    // Nothing that was saved is lost again.
                    assert!(after >= state, "{after:?} after {state:?}");
                    furthest = furthest.max(after.unwrap_or(0.0));
                    state = after;
                }
            }
        }
    }
    let out = format!("parts_{runs}");
    let begun = place.path(&out).join("run.lock").exists();
    assert!(start(&place, &out, begun).wait().expect("ended").success());
    same_as_whole(&out);
    assert!(
        furthest > 0.0,
        "no run came as far as its first restart file"
    );
}
