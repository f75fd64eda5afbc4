//! The shipped cases, and `jstsph new`.

use std::fmt::Write as _;

use crate::console::Console;
use crate::error::CliError;

/// Names and texts of the shipped cases.
pub(crate) const CASES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/cases.rs"));

/// Prints one case, or names and titles of all.
pub(crate) fn run(name: Option<&str>, console: &mut Console<'_>) -> Result<u8, CliError> {
    let Some(name) = name else {
        let width = CASES.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
        let mut text = String::new();
        for (name, case) in CASES {
            let _ = writeln!(text, "{name:<width$}  {}", title(case));
        }
        console.print(text);
        return Ok(0);
    };
    match CASES.iter().find(|(known, _)| *known == name) {
        Some((_, text)) => {
            console.print(text);
            Ok(0)
        }
        None => Err(CliError::UnknownName {
            what: "case",
            name: name.to_owned(),
            allowed: CASES.iter().map(|(name, _)| (*name).to_owned()).collect(),
        }),
    }
}

fn title(case: &str) -> &str {
    let line = case.lines().find_map(|line| line.strip_prefix("title"));
    line.and_then(|line| line.split('"').nth(1)).unwrap_or("")
}
