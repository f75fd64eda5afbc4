//! Layers and lints of the crates, read from their manifests.

use std::collections::BTreeMap;

use crate::{entries, manifest, root};

/// The layers, lowest first: a crate depends on lower ranks only. docs/architecture.md.
const RANKS: &[(&str, &[&str])] = &[
    ("vocabulary", &["jstsph-tensor"]),
    ("ingredients", &["jstsph-geometry", "jstsph-material"]),
    ("operators", &["jstsph-sph", "jstsph-contact"]),
    ("scheme", &["jstsph-solver"]),
    ("files written", &["jstsph-output"]),
    ("files read", &["jstsph-case"]),
    ("command line", &["jstsph-cli"]),
];

fn ranks() -> BTreeMap<&'static str, usize> {
    RANKS
        .iter()
        .enumerate()
        .flat_map(|(rank, (_, names))| names.iter().map(move |name| (*name, rank)))
        .collect()
}

/// Names of the dependencies of this workspace in a table of a manifest.
fn own_dependencies(manifest: &toml::Table, table: &str) -> Vec<String> {
    manifest
        .get(table)
        .and_then(toml::Value::as_table)
        .into_iter()
        .flat_map(toml::Table::keys)
        .filter(|name| name.starts_with("jstsph-"))
        .cloned()
        .collect()
}

#[test]
fn crates_depend_on_lower_ranks_only() {
    let ranks = ranks();
    let mut seen = 0;
    for folder in entries(&root().join("crates")) {
        let manifest = manifest(&folder.join("Cargo.toml"));
        let name = manifest["package"]["name"]
            .as_str()
            .expect("a name")
            .to_owned();
        let short = folder
            .file_name()
            .expect("a folder")
            .to_string_lossy()
            .into_owned();
        assert_eq!(
            name,
            format!("jstsph-{short}"),
            "folder and package name differ"
        );
        let rank = ranks
            .get(name.as_str())
            .unwrap_or_else(|| panic!("{name} has no rank"));
        for table in ["dependencies", "dev-dependencies", "build-dependencies"] {
            for dependency in own_dependencies(&manifest, table) {
                let below = ranks
                    .get(dependency.as_str())
                    .unwrap_or_else(|| panic!("{dependency} of {name} has no rank"));
                assert!(
                    below < rank,
                    "{name} must not depend on {dependency} ({table})"
                );
            }
        }
        seen += 1;
    }
    assert_eq!(seen, ranks.len(), "a crate with a rank is missing");
}

#[test]
fn every_member_forbids_unsafe_code_through_the_workspace_lints() {
    let workspace = manifest(&root().join("Cargo.toml"));
    let unsafe_code = &workspace["workspace"]["lints"]["rust"]["unsafe_code"];
    assert_eq!(unsafe_code.as_str(), Some("forbid"));
    let mut folders = entries(&root().join("crates"));
    folders.push(root().join("tests"));
    for folder in folders {
        let manifest = manifest(&folder.join("Cargo.toml"));
        let inherited = manifest
            .get("lints")
            .and_then(|lints| lints.get("workspace"))
            .and_then(toml::Value::as_bool);
        assert_eq!(
            inherited,
            Some(true),
            "{} does not inherit the lints",
            folder.display()
        );
    }
}

#[test]
fn every_crate_says_what_it_is_for() {
    for folder in entries(&root().join("crates")) {
        let readme = crate::read(&folder.join("README.md"));
        let manifest = manifest(&folder.join("Cargo.toml"));
        let name = manifest["package"]["name"].as_str().expect("a name");
        assert!(
            readme.starts_with(&format!("# {name}\n")),
            "{name}: README has another title"
        );
        assert!(readme.lines().count() > 2, "{name}: README is empty");
        let description = manifest["package"]["description"]
            .as_str()
            .expect("a description");
        assert!(description.len() > 20, "{name}: no description");
    }
}

/// Only the crates that may: files, terminals and TOML have their places.
#[test]
fn numerics_do_no_input_or_output() {
    for short in ["tensor", "geometry", "material", "sph", "contact", "solver"] {
        let folder = root().join("crates").join(short);
        for table in ["dependencies", "build-dependencies"] {
            let manifest = manifest(&folder.join("Cargo.toml"));
            let names = manifest.get(table).and_then(toml::Value::as_table);
            for name in names.into_iter().flat_map(toml::Table::keys) {
                assert!(
                    !["toml", "clap", "indicatif"].contains(&name.as_str()),
                    "{short}: {name}"
                );
            }
        }
        for file in crate::files_below(&folder.join("src"), &["rs"]) {
            let text = crate::read(&file);
            for call in ["std::fs", "std::env", "println!", "eprintln!", "std::time"] {
                assert!(!text.contains(call), "{} uses {call}", file.display());
            }
        }
    }
}
