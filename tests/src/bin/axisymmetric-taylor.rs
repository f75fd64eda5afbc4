//! Writes docs/data/taylor-reference.csv: the Taylor bars of the shipped cases in finite elements.
//!
//! ```sh
//! cargo run --release -p jstsph-tests --bin axisymmetric-taylor -- docs/data/taylor-reference.csv
//! ```
//!
//! A second argument is the largest number of elements per radius (40 otherwise; every doubling takes eight to
//! ten times as long). Rows that the file already has are kept, so that an interrupted run goes on; to redo
//! all of it, delete the file first.

use std::error::Error;
use std::fs::{OpenOptions, read_to_string};
use std::io::Write as _;
use std::path::Path;

use jstsph_tests::axisymmetric::{Base, TaylorBar, TaylorRow};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments
        .next()
        .ok_or("usage: axisymmetric-taylor FILE.csv [LARGEST]")?;
    let largest = match arguments.next() {
        Some(number) => number.parse()?,
        None => 40,
    };
    if !Path::new(&path).exists() {
        std::fs::write(&path, format!("{}\n", TaylorRow::HEADER))?;
    }
    let mut out = std::io::stdout().lock();
    for radial in [5, 10, 20, 40, 80] {
        for height in [32.0e-3, 32.4e-3] {
            for base in [Base::Free, Base::Held] {
                let bar = TaylorBar {
                    height,
                    base,
                    radial,
                };
                let there = read_to_string(&path)?
                    .lines()
                    .any(|line| line.starts_with(&bar.key()));
                if radial <= largest && !there {
                    let row = bar.run(1.1)?.to_string();
                    writeln!(OpenOptions::new().append(true).open(&path)?, "{row}")?;
                    writeln!(out, "{row}")?;
                }
            }
        }
    }
    Ok(())
}
