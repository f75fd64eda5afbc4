//! What is wrong with a case file, with the place and the remedy.

use std::fmt;
use std::ops::Range;

/// Why a case could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CaseError {
    /// The file cannot be read (or is not UTF-8 text).
    #[error("cannot read case file {file}: {source}")]
    Unreadable {
        /// Path as given.
        file: String,
        /// Cause.
        source: std::io::Error,
    },
    /// Something written in the file or on the command line is wrong.
    #[error("{0}")]
    Input(Box<InputError>),
}

/// One mistake: what, where, what is allowed.
///
/// `Display` prints file, line and column, the offending line with the place underlined, and help:
///
/// ```text
/// cases/block.toml:12:1: unknown key `clf` in [time]
///    |
/// 12 | clf = 0.3
///    | ^^^
///    = allowed: end, cfl, integrator, smallest_step
///    = did you mean `cfl`?
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputError {
    /// Path of the case file as given.
    pub file: String,
    /// Where the mistake is.
    pub place: Place,
    /// What is wrong, with value and limit.
    pub message: String,
    /// What is allowed, and what may have been meant; one entry per line.
    pub help: Vec<String>,
}

/// Where a mistake is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// In the file.
    File {
        /// Line, from 1.
        line: usize,
        /// Character in the line, from 1.
        column: usize,
        /// The whole line.
        text: String,
        /// Number of characters to underline, at least one.
        width: usize,
    },
    /// In a `key=value` of the command line.
    Override {
        /// Dotted key.
        key: String,
        /// Value as given.
        value: String,
    },
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let margin = match &self.place {
            Place::File {
                line,
                column,
                text,
                width,
            } => {
                let number = line.to_string();
                let margin = " ".repeat(number.len());
                // Tabs stay tabs below the line, so that the carets stand below the text.
                let indent: String = text
                    .chars()
                    .take(column - 1)
                    .map(|c| if c == '\t' { '\t' } else { ' ' })
                    .collect();
                writeln!(f, "{}:{line}:{column}: {}", self.file, self.message)?;
                writeln!(f, "{margin} |")?;
                writeln!(f, "{number} | {text}")?;
                write!(f, "{margin} | {indent}{}", "^".repeat(*width))?;
                margin
            }
            Place::Override { key, value } => {
                write!(f, "{}: in --set {key}={value}: {}", self.file, self.message)?;
                String::new()
            }
        };
        for line in &self.help {
            write!(f, "\n{margin} = {line}")?;
        }
        Ok(())
    }
}

impl std::error::Error for InputError {}

/// Where a value came from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// Byte range of the case file.
    File(Range<usize>),
    /// Byte range of included file number so-and-so.
    Included(usize, Range<usize>),
    /// Number of the override.
    Override(usize),
}

/// A mistake before it is known what the file looks like.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Problem {
    pub(crate) origin: Origin,
    pub(crate) message: String,
    pub(crate) help: Vec<String>,
}

impl Problem {
    pub(crate) fn new(origin: &Origin, message: impl Into<String>) -> Self {
        Self {
            origin: origin.clone(),
            message: message.into(),
            help: Vec::new(),
        }
    }

    pub(crate) fn help(mut self, line: impl Into<String>) -> Self {
        self.help.push(line.into());
        self
    }

    /// Lists what is allowed and, when one is near, the name that may have been meant.
    pub(crate) fn allowed<'a>(self, found: &str, names: impl IntoIterator<Item = &'a str>) -> Self {
        let names: Vec<&str> = names.into_iter().collect();
        let list = if names.is_empty() {
            "nothing".to_owned()
        } else {
            names.join(", ")
        };
        let problem = self.help(format!("allowed: {list}"));
        match crate::suggestion::nearest(found, names) {
            Some(name) => problem.help(format!("did you mean `{name}`?")),
            None => problem,
        }
    }
}

/// The text of a case file and the overrides, from which places are made.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    pub(crate) file: String,
    pub(crate) text: String,
    pub(crate) overrides: Vec<(String, String)>,
    /// Path and text of included files.
    pub(crate) included: Vec<(String, String)>,
}

impl Source {
    pub(crate) fn locate(&self, problem: Problem) -> CaseError {
        let mut file = &self.file;
        let place = match problem.origin {
            Origin::Override(index) => Place::Override {
                key: self.overrides[index].0.clone(),
                value: self.overrides[index].1.clone(),
            },
            Origin::File(range) => place(&self.text, &range),
            Origin::Included(number, range) => {
                let (path, text) = &self.included[number];
                file = path;
                place(text, &range)
            }
        };
        CaseError::Input(Box::new(InputError {
            file: file.clone(),
            place,
            message: problem.message,
            help: problem.help,
        }))
    }
}

fn place(source: &str, range: &Range<usize>) -> Place {
    let start = boundary(source, range.start);
    let line_start = source[..start].rfind('\n').map_or(0, |at| at + 1);
    let line_end = source[start..]
        .find('\n')
        .map_or(source.len(), |at| start + at);
    let end = boundary(source, range.end).clamp(start, line_end);
    Place::File {
        line: source[..start].matches('\n').count() + 1,
        column: source[line_start..start].chars().count() + 1,
        text: source[line_start..line_end].trim_end().to_owned(),
        width: source[start..end].trim_end().chars().count().max(1),
    }
}

/// The nearest character boundary at or below a byte position.
fn boundary(text: &str, mut at: usize) -> usize {
    at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(text: &str) -> Source {
        Source {
            file: "a.toml".to_owned(),
            text: text.to_owned(),
            overrides: vec![("time.end".to_owned(), "0".to_owned())],
            included: Vec::new(),
        }
    }

    #[test]
    fn place_in_the_file_is_underlined() {
        let source = source("title = \"ü\"\n[time]\nclf = 0.3\n");
        let start = source.text.find("clf").expect("in the text");
        let problem = Problem::new(
            &Origin::File(start..start + 3),
            "unknown key `clf` in [time]",
        )
        .allowed("clf", ["end", "cfl"]);
        assert_eq!(
            source.locate(problem).to_string(),
            "a.toml:3:1: unknown key `clf` in [time]\n  |\n3 | clf = 0.3\n  | ^^^\n  = allowed: end, cfl\n  = did you mean `cfl`?"
        );
    }

    #[test]
    fn columns_count_characters_and_ranges_stop_at_the_line() {
        let source = source("title = \"ü\" x\nnext\n");
        let at = source.text.find('x').expect("in the text");
        let problem = Problem::new(&Origin::File(at..source.text.len()), "m");
        let text = source.locate(problem).to_string();
        assert!(text.starts_with("a.toml:1:13: m\n"), "{text}");
        assert!(text.ends_with("|             ^"), "{text}");
    }

    #[test]
    fn overrides_are_named_instead_of_a_line() {
        let problem = Problem::new(&Origin::Override(0), "must be positive");
        assert_eq!(
            source("").locate(problem).to_string(),
            "a.toml: in --set time.end=0: must be positive"
        );
    }

    #[test]
    fn end_of_file_is_a_place() {
        let text = source("x")
            .locate(Problem::new(&Origin::File(5..9), "m"))
            .to_string();
        assert!(text.starts_with("a.toml:1:2: m"), "{text}");
    }
}
