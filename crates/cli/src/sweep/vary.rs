//! What a sweep varies: keys with values, and their combinations.

use jstsph_case::Case;
use jstsph_case::schema::{BODY, CASE};
use jstsph_case::units::parse_quantity;

use crate::error::CliError;

/// A key and its values, as texts of `--set`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Varied {
    /// As given, for tables and legends.
    pub(super) name: String,
    /// Dotted key of the case.
    pub(super) key: String,
    pub(super) values: Vec<String>,
}

impl Varied {
    /// Splits the values; a key of a body may be written without `body.0.` when there is only one.
    pub(super) fn new((key, values): &(String, String), case: &Case) -> Result<Self, CliError> {
        let bad = |reason: &str| CliError::Vary {
            key: key.clone(),
            values: values.clone(),
            reason: reason.to_owned(),
        };
        let texts =
            split(values).ok_or_else(|| bad("a bracket or quotation mark is not closed"))?;
        if texts.iter().any(String::is_empty) {
            return Err(bad("a value is empty"));
        }
        if (1..texts.len()).any(|at| texts[..at].contains(&texts[at])) {
            return Err(bad("a value is there twice"));
        }
        let first = key.split('.').next().unwrap_or_default();
        let is_short = CASE.iter().all(|known| known.name != first)
            && BODY.iter().any(|known| known.name == first);
        if is_short && case.model.bodies.len() > 1 {
            return Err(bad(&format!(
                "the case has several bodies; write body.NAME.{key}"
            )));
        }
        Ok(Self {
            name: key.clone(),
            key: if is_short {
                format!("body.0.{key}")
            } else {
                key.clone()
            },
            values: texts,
        })
    }

    /// The values as numbers in SI units, when all of them are.
    pub(super) fn numbers(&self) -> Option<Vec<f64>> {
        self.values
            .iter()
            .map(|text| {
                let text = text.trim_matches('"');
                let plain = text.parse().ok();
                plain.or_else(|| parse_quantity(text).ok().map(|(value, _)| value))
            })
            .collect()
    }

    /// SI unit of the values, empty for pure numbers and for what is no number.
    pub(super) fn unit(&self) -> String {
        let measured = self
            .values
            .first()
            .map(|text| parse_quantity(text.trim_matches('"')));
        match measured {
            Some(Ok((_, measure))) if measure.to_string() != "1" => measure.to_string(),
            _ => String::new(),
        }
    }
}

/// Every combination of values, the last key varying fastest; numbers of values.
pub(super) fn combinations(varied: &[Varied]) -> Vec<Vec<usize>> {
    varied.iter().fold(vec![Vec::new()], |all, varied| {
        all.iter()
            .flat_map(|before| {
                (0..varied.values.len()).map(move |at| {
                    let mut next = before.clone();
                    next.push(at);
                    next
                })
            })
            .collect()
    })
}

/// Name of the folder of a combination: keys and values without signs that file systems mind.
pub(super) fn folder_name(varied: &[Varied], combination: &[usize]) -> String {
    let part = |text: &str| -> String {
        let clean: String = text
            .chars()
            .map(|c| {
                if c.is_alphanumeric() || matches!(c, '.' | '-' | '_' | '+') {
                    c
                } else {
                    ' '
                }
            })
            .collect();
        clean.split_whitespace().collect::<Vec<_>>().join("-")
    };
    varied
        .iter()
        .zip(combination)
        .map(|(varied, at)| format!("{}={}", part(&varied.name), part(&varied.values[*at])))
        .collect::<Vec<_>>()
        .join(",")
}

/// Parts at semicolons, or at commas where there are none, outside of brackets and quotation marks.
fn split(text: &str) -> Option<Vec<String>> {
    let mut parts = [vec![String::new()], vec![String::new()]];
    let (mut depth, mut is_quoted) = (0_i32, false);
    for c in text.chars() {
        is_quoted ^= c == '"';
        if !is_quoted {
            depth += i32::from(matches!(c, '[' | '{' | '('));
            depth -= i32::from(matches!(c, ']' | '}' | ')'));
        }
        for (parts, separator) in parts.iter_mut().zip([';', ',']) {
            if c == separator && depth == 0 && !is_quoted {
                parts.push(String::new());
            } else if let Some(last) = parts.last_mut() {
                last.push(c);
            }
        }
    }
    if depth != 0 || is_quoted {
        return None;
    }
    let [semicolons, commas] = parts;
    let parts = if semicolons.len() > 1 {
        semicolons
    } else {
        commas
    };
    Some(parts.iter().map(|part| part.trim().to_owned()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn varied(values: &[&str]) -> Varied {
        Varied {
            name: "time.end".to_owned(),
            key: "time.end".to_owned(),
            values: values.iter().map(|value| (*value).to_owned()).collect(),
        }
    }

    #[test]
    fn values_split_outside_of_brackets_and_quotation_marks() {
        for (text, parts) in [
            ("0.001,0.0005", vec!["0.001", "0.0005"]),
            ("[4,22];[6,36]", vec!["[4,22]", "[6,36]"]),
            ("[4,22], [6,36]", vec!["[4,22]", "[6,36]"]),
            ("\"a,b\",c", vec!["\"a,b\"", "c"]),
            ("1 ms", vec!["1 ms"]),
            ("1,", vec!["1", ""]),
        ] {
            assert_eq!(
                split(text),
                Some(parts.iter().map(|s| (*s).to_owned()).collect()),
                "{text}"
            );
        }
        assert_eq!(split("[4,22"), None);
    }

    #[test]
    fn the_last_key_varies_fastest() {
        let all = combinations(&[varied(&["a", "b"]), varied(&["c", "d", "e"])]);
        assert_eq!(all.len(), 6);
        assert_eq!(all[1], [0, 1]);
        assert_eq!(all[3], [1, 0]);
    }

    #[test]
    fn numbers_have_units_and_folders_no_brackets() {
        let times = varied(&["1 ms", "\"20 us\""]);
        assert_eq!(times.numbers(), Some(vec![1e-3, 2e-5]));
        assert_eq!(times.unit(), "s");
        assert_eq!(folder_name(&[times], &[1]), "time.end=20-us");
        let counts = varied(&["[4, 22]"]);
        assert_eq!(counts.numbers(), None);
        assert_eq!(folder_name(&[counts], &[0]), "time.end=4-22");
    }
}
