//! `jstsph list`.

use std::fmt::Write as _;

use jstsph_case::{ListEntry, lists};

use crate::console::Console;
use crate::error::CliError;
use crate::templates;

/// Prints one list, or the names of all.
pub(crate) fn run(what: Option<&str>, console: &mut Console<'_>) -> Result<u8, CliError> {
    let lists = lists();
    let cases = ("cases", "shipped cases, for `jstsph new` and to learn from");
    let Some(what) = what else {
        let mut text = String::from("jstsph list ...\n");
        for (name, summary) in lists
            .iter()
            .map(|list| (list.name, list.summary))
            .chain([cases])
        {
            let _ = writeln!(text, "  {name:<12} {summary}");
        }
        console.print(text);
        return Ok(0);
    };
    if what == cases.0 {
        return templates::run(None, console);
    }
    let Some(list) = lists.iter().find(|list| list.name == what) else {
        return Err(CliError::UnknownName {
            what: "list",
            name: what.to_owned(),
            allowed: lists
                .iter()
                .map(|list| list.name.to_owned())
                .chain([cases.0.to_owned()])
                .collect(),
        });
    };
    let mut text = format!("{}: {}\n\n", list.name, list.summary);
    write_entries(&mut text, &list.entries, 0);
    console.print(text);
    Ok(0)
}

fn write_entries(text: &mut String, entries: &[ListEntry], depth: usize) {
    let indent = "  ".repeat(depth);
    let width = entries
        .iter()
        .map(|entry| entry.name.chars().count())
        .max()
        .unwrap_or(0)
        .min(32);
    for entry in entries {
        let line = format!("{indent}{:<width$}  {}", entry.name, entry.meaning);
        let _ = writeln!(text, "{}", line.trim_end());
        write_entries(text, &entry.keys, depth + 1);
    }
}
