//! Everything that can be written in a case file as a page of the documentation.

use std::fmt::Write as _;

use crate::list::{ListEntry, lists};

const HEAD: &str = "\
# Every key of a case file

This page is made by `jstsph list --markdown` from the tables by which case files are read, checked
and completed (`jstsph schema`); a test keeps it current. [The case file](case-file.md) explains how
the parts work together.

Each line: name, meaning, what it holds, and whether it must be given or what holds without it.
";

/// The page `docs/guide/keys.md`: every list of [`lists`].
#[must_use]
pub fn markdown() -> String {
    let mut text = HEAD.to_owned();
    for list in lists() {
        let _ = writeln!(text, "\n## {}\n\n{}.\n", list.name, capital(list.summary));
        write_entries(&mut text, &list.entries, 0);
    }
    text
}

fn write_entries(text: &mut String, entries: &[ListEntry], depth: usize) {
    for entry in entries {
        let indent = "  ".repeat(depth);
        let line = format!("{indent}- `{}` {}", entry.name, escaped(&entry.meaning));
        let _ = writeln!(text, "{}", line.trim_end());
        write_entries(text, &entry.keys, depth + 1);
    }
}

/// What Markdown would take for emphasis, links or tags stays what it is.
fn escaped(text: &str) -> String {
    let mut result = String::with_capacity(text.len());
    let mut is_code = false;
    for c in text.chars() {
        is_code ^= c == '`';
        if !is_code && matches!(c, '*' | '_' | '[' | ']' | '<' | '>' | '|' | '\\') {
            result.push('\\');
        }
        result.push(c);
    }
    result
}

fn capital(text: &str) -> String {
    let mut characters = text.chars();
    characters
        .next()
        .map(|first| first.to_uppercase().chain(characters).collect())
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_of_the_guide_is_current() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/guide/keys.md");
        let page = std::fs::read_to_string(path).unwrap_or_default();
        assert!(
            page == markdown(),
            "docs/guide/keys.md is stale; write it with: jstsph list --markdown > docs/guide/keys.md"
        );
    }

    #[test]
    fn markdown_signs_are_escaped_outside_of_code() {
        assert_eq!(escaped("a_b `c_d` [e]"), "a\\_b `c_d` \\[e\\]");
    }
}
