//! `include = ["materials/steel.toml"]`: material tables of other files.

use std::path::Path;

use crate::document::{self, Entry, Node, Value};
use crate::error::{Origin, Problem, Source};

/// Adds the material tables of the included files to the document.
pub(crate) fn merge(document: &mut Node, source: &mut Source) -> Result<(), Problem> {
    for (path, origin) in paths(document)? {
        let folder = Path::new(&source.file).parent().unwrap_or(Path::new(""));
        let file = folder.join(&path);
        let text = std::fs::read_to_string(&file).map_err(|error| {
            Problem::new(&origin, format!("cannot read {}: {error}", file.display()))
                .help("the path is relative to the folder of the case")
        })?;
        let number = source.included.len();
        let name = file.display().to_string();
        source.included.push((name.clone(), text));
        let read = document::parse(&source.included[number].1, &|range| {
            Origin::Included(number, range)
        })?;
        let Value::Table(entries) = read.value else {
            continue;
        };
        for entry in entries {
            if entry.key != "material" {
                return Err(Problem::new(
                    &entry.key_origin,
                    format!(
                        "`{}` cannot stand in an included file, which holds materials only",
                        entry.key
                    ),
                )
                .allowed(&entry.key, ["material"]));
            }
            add(document, entry, &name)?;
        }
    }
    Ok(())
}

fn paths(document: &Node) -> Result<Vec<(String, Origin)>, Problem> {
    let Some(entry) = document.entry("include") else {
        return Ok(Vec::new());
    };
    let wrong = |node: &Node| {
        Problem::new(
            &node.origin,
            format!(
                "`include` must be a list of paths, but is or holds {}",
                node.value.kind()
            ),
        )
        .help("write include = [\"materials/steel.toml\"]")
    };
    let Value::Array(items) = &entry.node.value else {
        return Err(wrong(&entry.node));
    };
    items
        .iter()
        .map(|item| match &item.value {
            Value::Text(path) => Ok((path.clone(), item.origin.clone())),
            _ => Err(wrong(item)),
        })
        .collect()
}

/// Adds `[material]` of an included file.
fn add(document: &mut Node, entry: Entry, file: &str) -> Result<(), Problem> {
    let Value::Table(top) = &mut document.value else {
        return Ok(());
    };
    let Some(known) = top.iter_mut().find(|known| known.key == "material") else {
        top.push(entry);
        return Ok(());
    };
    if let (Value::Table(known), Value::Table(new)) = (&mut known.node.value, entry.node.value) {
        for material in new {
            if let Some(first) = known.iter().find(|known| known.key == material.key) {
                return Err(Problem::new(
                    &first.key_origin,
                    format!("material `{}` is also in {file}", material.key),
                )
                .help("rename one of them"));
            }
            known.push(material);
        }
    }
    Ok(())
}
