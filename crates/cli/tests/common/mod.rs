//! The program as a function, in a folder of its own.
#![expect(unreachable_pub, reason = "shared by several test programs")]

use std::io::Write;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

use jstsph_cli::run_until;

/// A copper block that hits a wall: 35 particles, a few hundred steps.
pub const BLOCK: &str = r#"
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

pub struct Place {
    pub folder: tempfile::TempDir,
}

pub struct Outcome {
    pub code: u8,
    pub out: String,
    pub err: String,
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
    pub fn new() -> Self {
        let place = Self {
            folder: tempfile::tempdir().expect("a folder"),
        };
        place.write("block.toml", BLOCK);
        place
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).expect("written");
    }

    pub fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub fn text(&self, name: &str) -> String {
        String::from_utf8(self.bytes(name)).expect("text")
    }

    /// Runs a command line in which `@` stands for the folder.
    pub fn jstsph(&self, line: &str) -> Outcome {
        self.until("\0", line)
    }

    /// The same, interrupted when `text` appears on standard error.
    pub fn until(&self, text: &str, line: &str) -> Outcome {
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
