//! Source files: no stubs, no skipped tests, no long files, no machine paths.

use crate::{files_below, read, root};

/// Longest file; one concept each keeps them far below.
const LONGEST: usize = 700;

fn sources() -> Vec<std::path::PathBuf> {
    let mut sources = files_below(&root().join("crates"), &["rs"]);
    sources.extend(files_below(&root().join("tests"), &["rs"]));
    assert!(sources.len() > 100, "only {} sources found", sources.len());
    sources
}

/// The words are split here so that this file does not find itself.
#[test]
fn sources_have_no_stubs_and_no_skipped_tests() {
    let words = [
        concat!("todo", "!("),
        concat!("unimplemented", "!("),
        concat!("#[", "ignore"),
        concat!("TO", "DO"),
        concat!("FIX", "ME"),
        concat!("dbg", "!("),
    ];
    for file in sources() {
        let text = read(&file);
        for (number, line) in text.lines().enumerate() {
            for word in words {
                assert!(
                    !line.contains(word),
                    "{}:{}: {word}",
                    file.display(),
                    number + 1
                );
            }
        }
    }
}

#[test]
fn no_source_is_longer_than_a_reader_likes() {
    for file in sources() {
        let lines = read(&file).lines().count();
        assert!(
            lines <= LONGEST,
            "{} has {lines} lines, the limit is {LONGEST}",
            file.display()
        );
    }
}

/// A path of somebody's machine means that a test runs there only.
#[test]
fn nothing_refers_to_a_machine() {
    let mut files = sources();
    files.extend(files_below(&root().join("crates"), &["toml", "md"]));
    files.extend(files_below(&root().join("docs"), &["md"]));
    files.extend(files_below(&root().join("cases"), &["toml"]));
    let paths = [
        concat!("/wo", "rk/"),
        concat!("/ho", "me/"),
        concat!("/Us", "ers/"),
    ];
    for file in files {
        let text = read(&file);
        for path in paths {
            assert!(!text.contains(path), "{} mentions {path}", file.display());
        }
    }
}
