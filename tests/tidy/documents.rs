//! The book: links lead somewhere, and every page can be found.

use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};

use crate::{files_below, read, root};

/// Text without fenced blocks and inline code, in which brackets mean something else.
fn prose(text: &str) -> String {
    let mut is_fenced = false;
    let mut prose = String::new();
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            is_fenced = !is_fenced;
        } else if !is_fenced {
            for (number, part) in line.split('`').enumerate() {
                // Every other part stands between backticks.
                prose += if number % 2 == 0 { part } else { "x" };
            }
            prose.push('\n');
        }
    }
    prose
}

/// Targets of the links and pictures of a page.
fn targets(text: &str) -> Vec<String> {
    let prose = prose(text);
    let after = prose.split("](").skip(1);
    after
        .filter_map(|rest| rest.split_once(')'))
        .map(|(target, _)| target.to_owned())
        .collect()
}

/// The anchors of a page's headings, as mdbook and GitHub make them.
fn anchors(text: &str) -> BTreeSet<String> {
    let mut is_fenced = false;
    let mut seen: HashMap<String, usize> = HashMap::new();
    let mut anchors = BTreeSet::new();
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            is_fenced = !is_fenced;
        }
        let heading = line.trim_start_matches('#');
        if is_fenced || !line.starts_with('#') || !heading.starts_with(' ') {
            continue;
        }
        let kept = heading.trim().to_lowercase();
        let anchor: String = kept
            .chars()
            .filter(|c| c.is_alphanumeric() || [' ', '-', '_'].contains(c))
            .map(|c| if c == ' ' { '-' } else { c })
            .collect();
        let count = seen.entry(anchor.clone()).or_insert(0);
        anchors.insert(if *count == 0 {
            anchor
        } else {
            format!("{anchor}-{count}")
        });
        *count += 1;
    }
    anchors
}

/// Why a link of a page leads nowhere.
fn broken(page: &Path, target: &str) -> Option<String> {
    if target.contains("://") || target.starts_with("mailto:") {
        return None;
    }
    let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
    let folder = page.parent().expect("a page lies in a folder");
    let path = if file.is_empty() {
        page.to_path_buf()
    } else {
        folder.join(file)
    };
    if !path.exists() {
        return Some(format!(
            "{} links to {target}: no such file",
            page.display()
        ));
    }
    let is_page = path.extension().is_some_and(|extension| extension == "md");
    if !anchor.is_empty() && is_page && !anchors(&read(&path)).contains(anchor) {
        return Some(format!(
            "{} links to {target}: no such heading",
            page.display()
        ));
    }
    None
}

#[test]
fn links_lead_to_files_and_headings() {
    let mut pages = files_below(&root().join("docs"), &["md"]);
    pages.extend(files_below(&root().join("crates"), &["md"]));
    pages.extend(["README.md", "tests/README.md"].map(|name| root().join(name)));
    let mut count = 0;
    let mut all = Vec::new();
    for page in &pages {
        for target in targets(&read(page)) {
            count += 1;
            all.extend(broken(page, &target));
        }
    }
    assert!(count > 50, "only {count} links found");
    assert!(all.is_empty(), "{}", all.join("\n"));
}

/// Messages quoted in the first column of the tables of a page, cut where they have `...`.
fn quoted_messages(text: &str) -> Vec<String> {
    let mut is_table = false;
    let mut found = Vec::new();
    for line in text.lines() {
        let heads = ["| message |", "| warning |"];
        is_table =
            line.starts_with('|') && (is_table || heads.iter().any(|head| line.starts_with(head)));
        let first = line.split('|').nth(1).unwrap_or_default();
        for code in first.split('`').skip(1).step_by(2).filter(|_| is_table) {
            let parts = code.split("...").map(|part| part.trim().to_owned());
            found.extend(parts.filter(|part| part.len() > 2));
        }
    }
    found
}

/// The sources as one text, with their texts as the program prints them.
fn sources() -> String {
    let mut all = String::new();
    for path in files_below(&root().join("crates"), &["rs"]) {
        // A backslash at the end of a line takes the spaces of the next one away.
        let mut lines = read(&path);
        lines.push('\n');
        let joined = lines.split("\\\n").map(str::trim_start);
        all += &joined.collect::<String>().replace("\\\"", "\"");
    }
    all
}

#[test]
fn messages_of_the_troubleshooting_page_are_those_of_the_program() {
    let page = read(&root().join("docs/guide/troubleshooting.md"));
    // What the operating system says.
    let foreign = ["No such file", "Permission denied"];
    let sources = sources();
    let messages = quoted_messages(&page);
    assert!(messages.len() > 50, "{messages:?}");
    let missing: Vec<&String> = messages
        .iter()
        .filter(|part| !foreign.contains(&part.as_str()) && !sources.contains(part.as_str()))
        .collect();
    assert!(missing.is_empty(), "nothing prints {missing:#?}");
}

#[test]
fn every_case_is_in_the_gallery_with_a_small_picture() {
    let page = read(&root().join("docs/gallery.md"));
    for case in files_below(&root().join("cases"), &["toml"]) {
        let name = case.file_stem().expect("a name").to_string_lossy();
        let heading = format!("\n## {name}\n");
        assert!(page.contains(&heading), "run docs/gallery/make: {name}");
        let picture = root().join(format!("docs/gallery/{name}.png"));
        let size = std::fs::metadata(&picture).map_or(0, |file| file.len());
        assert!((1..150_000).contains(&size), "{name}: {size} bytes");
    }
}

#[test]
fn every_page_is_in_the_summary() {
    let docs = root().join("docs");
    let summary = docs.join("SUMMARY.md");
    let listed: BTreeSet<PathBuf> = targets(&read(&summary))
        .iter()
        .map(|target| docs.join(target))
        .collect();
    for page in files_below(&docs, &["md"]) {
        assert!(
            page == summary || listed.contains(&page),
            "{} is not in docs/SUMMARY.md",
            page.display()
        );
    }
}

#[test]
fn links_are_found_where_markdown_has_them() {
    let text = "See [a](b.md#c) and `[x](no.md)`.\n```\n[y](no.md)\n```\n![p](q.png)\n";
    assert_eq!(targets(text), ["b.md#c", "q.png"]);
    let text = "# A `b` (c.d)\n```\n# no\n```\n## Same\n## Same\n";
    let expected = ["a-b-cd", "same", "same-1"].map(str::to_owned);
    assert_eq!(anchors(text), BTreeSet::from(expected));
}
