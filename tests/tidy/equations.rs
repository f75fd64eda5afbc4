//! Formulas: the code cites those of docs/theory.md, and every one of them is in the code.

use std::collections::{BTreeMap, BTreeSet};

use crate::{files_below, read, root};

/// Every `[eq:...]` of a text.
fn ids(text: &str) -> Vec<String> {
    let cited = text.split("[eq:").skip(1);
    let ids = cited.filter_map(|rest| rest.split_once(']'));
    let is_id = |id: &str| id.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'-');
    ids.map(|(id, _)| id.to_owned())
        .filter(|id| is_id(id))
        .collect()
}

/// How often each id stands at a formula of the manual: in a fenced block, apart from the formula, at the
/// end of a line or before the paper's number. Elsewhere an id is a mention.
fn defined() -> BTreeMap<String, usize> {
    let manual = read(&root().join("docs/theory.md"));
    let mut is_fenced = false;
    let mut defined = BTreeMap::new();
    for line in manual.lines() {
        is_fenced ^= line.starts_with("```");
        let Some((_, named)) = line.split_once("  [eq:") else {
            continue;
        };
        let Some((id, rest)) = named.split_once(']') else {
            continue;
        };
        if is_fenced && (rest.trim().is_empty() || rest.trim().starts_with('(')) {
            *defined.entry(id.to_owned()).or_insert(0) += 1;
        }
    }
    assert!(defined.len() > 20, "only {} formulas found", defined.len());
    defined
}

#[test]
fn every_formula_of_the_manual_has_one_name_and_a_place_in_the_code() {
    let mut cited = BTreeSet::new();
    let defined = defined();
    for file in files_below(&root().join("crates"), &["rs"]) {
        for id in ids(&read(&file)) {
            assert!(
                defined.contains_key(&id),
                "{} cites [eq:{id}], which docs/theory.md does not have",
                file.display()
            );
            cited.insert(id);
        }
    }
    for (id, count) in &defined {
        assert_eq!(*count, 1, "[eq:{id}] stands at {count} formulas");
        assert!(cited.contains(id), "no code cites [eq:{id}]");
    }
}

#[test]
fn documents_mention_formulas_that_exist() {
    let defined = defined();
    for file in files_below(&root().join("docs"), &["md"]) {
        for id in ids(&read(&file)) {
            assert!(defined.contains_key(&id), "{}: [eq:{id}]", file.display());
        }
    }
}

/// The paper's numbers that comments of the code cite, without the letter: (3.16a) is 3.16.
fn paper_numbers(text: &str) -> BTreeSet<String> {
    let comments = text.lines().filter_map(|line| line.split_once("//"));
    let mut numbers = BTreeSet::new();
    for (_, comment) in comments {
        for rest in comment.split('(').skip(1) {
            let Some((inside, _)) = rest.split_once(')') else {
                continue;
            };
            let number = inside.trim_end_matches(|c: char| c.is_ascii_lowercase());
            let is_number = number.split_once('.').is_some_and(|(part, count)| {
                ["2", "3", "4", "A"].contains(&part)
                    && !count.is_empty()
                    && count.bytes().all(|b| b.is_ascii_digit())
                    && count != "0"
            });
            if is_number {
                numbers.insert(number.to_owned());
            }
        }
    }
    numbers
}

#[test]
fn the_papers_numbers_in_the_code_are_in_the_manual() {
    let manual = read(&root().join("docs/theory.md"));
    let of_manual = paper_numbers(&format!("//{}", manual.replace('\n', "\n//")));
    let mut checked = 0;
    for file in files_below(&root().join("crates"), &["rs"]) {
        for number in paper_numbers(&read(&file)) {
            // A range such as (A.16)-(A.19) names its ends.
            let in_range = || {
                let (part, count) = number.split_once('.').expect("it has a point");
                let count: u32 = count.parse().expect("digits");
                manual.match_indices(")-(").any(|(at, _)| {
                    let before = manual[..at].rsplit('(').next();
                    let after = manual[at + 3..].split(')').next();
                    let end = |text: Option<&str>| {
                        let (other, count) = text?.split_once('.')?;
                        let count = count.trim_end_matches(|c: char| c.is_ascii_lowercase());
                        (other == part).then(|| count.parse::<u32>().ok())?
                    };
                    end(before)
                        .zip(end(after))
                        .is_some_and(|(a, b)| (a..=b).contains(&count))
                })
            };
            assert!(
                of_manual.contains(&number) || in_range(),
                "{} cites ({number}) of the paper, which docs/theory.md does not mention",
                file.display()
            );
            checked += 1;
        }
    }
    assert!(checked > 20, "only {checked} citations found");
}
