//! The files that a case reads beside itself, so that results can hold copies of them.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::case::Case;
use crate::document::{Node, Value};
use crate::error::{Origin, Problem};

/// Tables whose `file` is read.
const WITH_FILES: &[&str] = &["stl", "drawing"];

/// A file that a case includes or takes a shape from.
#[derive(Clone, Debug)]
pub struct InputFile {
    /// Name of a copy, different from that of every other: a number, `-`, and the file's own name.
    pub name: String,
    /// Contents when the case was read.
    pub bytes: Arc<[u8]>,
    path: PathBuf,
    /// Where the case names it.
    origins: Vec<Origin>,
}

/// All files that a document names, each once.
pub(crate) fn collect(document: &Node, folder: &Path) -> Result<Vec<InputFile>, Problem> {
    let mut named: Vec<(&str, &Origin)> = Vec::new();
    // Included files last: a resolved case, which has none, gives the others the same numbers.
    search(document, &mut named);
    if let Some(include) = document.entry("include") {
        texts(&include.node, &mut named);
    }
    let mut files: Vec<InputFile> = Vec::new();
    for (name, origin) in named {
        let path = folder.join(name);
        let path = std::fs::canonicalize(&path).unwrap_or(path);
        if let Some(known) = files.iter_mut().find(|file| file.path == path) {
            known.origins.push(origin.clone());
            continue;
        }
        let bytes = std::fs::read(&path).map_err(|error| {
            Problem::new(origin, format!("cannot read {}: {error}", path.display()))
        })?;
        files.push(InputFile {
            name: format!("{}-{}", files.len() + 1, own_name(&path)),
            bytes: bytes.into(),
            path,
            origins: vec![origin.clone()],
        });
    }
    Ok(files)
}

/// The name of a file, without the number that a copy has before it.
fn own_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let rest = name.trim_start_matches(|c: char| c.is_ascii_digit());
    match rest.strip_prefix('-') {
        Some(rest) if rest.len() + 1 < name.len() && !rest.is_empty() => rest.to_owned(),
        _ => name.into_owned(),
    }
}

fn texts<'a>(node: &'a Node, found: &mut Vec<(&'a str, &'a Origin)>) {
    match &node.value {
        Value::Text(text) => found.push((text, &node.origin)),
        Value::Array(items) => items.iter().for_each(|item| texts(item, found)),
        _ => {}
    }
}

fn search<'a>(node: &'a Node, found: &mut Vec<(&'a str, &'a Origin)>) {
    match &node.value {
        Value::Array(items) => items.iter().for_each(|item| search(item, found)),
        Value::Table(entries) => {
            for entry in entries {
                if WITH_FILES.contains(&entry.key.as_str())
                    && let Some(file) = entry.node.entry("file")
                {
                    texts(&file.node, found);
                }
                search(&entry.node, found);
            }
        }
        _ => {}
    }
}

impl Case {
    /// [`Self::original`] with copies in a folder beside it in the place of the files that it reads.
    #[must_use]
    pub fn original_with_copies(&self, folder: &str) -> String {
        let mut places: Vec<(std::ops::Range<usize>, &str)> = Vec::new();
        for input in &self.inputs {
            for origin in &input.origins {
                if let Origin::File(range) = origin {
                    places.push((range.clone(), &input.name));
                }
            }
        }
        // From the end, so that the places before stay where they are.
        places.sort_by_key(|(range, _)| std::cmp::Reverse(range.start));
        let mut text = self.original().to_owned();
        for (range, name) in places {
            text.replace_range(range, &quoted(&format!("{folder}/{name}")));
        }
        text
    }

    /// The resolved case with copies in a folder beside it in the place of the files that it reads.
    #[must_use]
    pub fn resolved_with_copies(&self, folder: &str) -> String {
        let mut text = self.resolved.clone();
        for input in &self.inputs {
            let copy = quoted(&format!("{folder}/{}", input.name));
            text = text.replace(&quoted(&input.path.display().to_string()), &copy);
        }
        text
    }
}

/// A text as TOML.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_of_copies_keep_their_names() {
        assert_eq!(own_name(Path::new("a/steel.toml")), "steel.toml");
        assert_eq!(own_name(Path::new("inputs/12-steel.toml")), "steel.toml");
        assert_eq!(own_name(Path::new("2024.toml")), "2024.toml");
        assert_eq!(own_name(Path::new("7-")), "7-");
        assert_eq!(own_name(Path::new("-x")), "-x");
    }
}
