//! The pages generated from measured numbers are current: every run and quantity of a study has its
//! entry, and the page is what the program prints.

use crate::{entries, read, root};

#[test]
fn generated_pages_are_what_the_program_prints_of_the_numbers() {
    let studies: Vec<String> = entries(&root().join("crates/cli/studies"))
        .iter()
        .filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned()))
        .collect();
    assert!(!studies.is_empty(), "there is no study");
    for study in studies {
        let numbers = format!("docs/data/reproduction-{study}.json");
        let page = format!("docs/reproduction-{study}.md");
        let file = root().join(&numbers).display().to_string();
        let (mut out, mut err) = (Vec::new(), Vec::new());
        let words = ["jstsph", "reproduce", &study, "--from", &file];
        let code = jstsph_cli::run(words, &mut out, &mut err);
        assert_eq!(code, 0, "{}", String::from_utf8_lossy(&err));
        assert!(
            read(&root().join(&page)) == String::from_utf8_lossy(&out),
            "{page} is stale; write it again with\n  \
             jstsph reproduce {study} --from {numbers} > {page}"
        );
    }
}
