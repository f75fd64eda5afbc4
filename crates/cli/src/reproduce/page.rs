//! The page as headings, paragraphs, tables and pictures; how they are written is for
//! [`super::markdown`] and [`super::html`].

use super::findings::{Findings, QuantityFinding, Row, RunStatus, series};
use super::judge::{Expectation, Verdict};
use super::study::{Quantity, Study};
use crate::verdict::duration;

/// A part of the page. Texts may hold `code`, **bold** and [links](#anchor).
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Block {
    /// With its level, 1 for the title.
    Heading(u8, String),
    Text(String),
    Table {
        head: Vec<String>,
        rows: Vec<Vec<String>>,
    },
    Picture {
        file: String,
        caption: String,
    },
}

/// The whole page.
pub(super) fn blocks(study: &Study, findings: &Findings) -> Vec<Block> {
    let mut blocks = vec![
        Block::Heading(1, study.title.clone()),
        Block::Text(study.citation.clone()),
        Block::Text(study.introduction.trim().to_owned()),
        Block::Text(provenance(findings)),
        Block::Heading(2, "Overview".to_owned()),
        Block::Text(counts(findings)),
        overview(study, findings),
    ];
    for (quantity, found) in study.quantities.iter().zip(&findings.quantities) {
        if let Some(part) = &quantity.part {
            blocks.push(Block::Heading(2, part.clone()));
        }
        quantity_blocks(&mut blocks, quantity, found);
    }
    blocks.push(Block::Heading(2, "Runs".to_owned()));
    blocks.push(runs(findings));
    blocks
}

fn provenance(findings: &Findings) -> String {
    let commit = findings.commit.as_ref().map_or(String::new(), |commit| {
        format!(" (commit {})", short(commit))
    });
    format!(
        "{} of jstsph {}{commit}, {}, {}.",
        if findings.quick {
            "Coarse resolutions (`--quick`)"
        } else {
            "Full study"
        },
        findings.version,
        findings.date,
        findings.cpu
    )
}

/// A commit as people write it, with what follows the hash.
fn short(commit: &str) -> String {
    match commit.split_once(' ') {
        Some((hash, rest)) => format!("{:.10} {rest}", hash),
        None => format!("{commit:.10}"),
    }
}

fn counts(findings: &Findings) -> String {
    let counted = Verdict::ALL.iter().filter_map(|verdict| {
        let count = findings.count(*verdict);
        (count > 0).then(|| format!("{count} {}", verdict.text()))
    });
    let counted: Vec<String> = counted.collect();
    format!(
        "{} quantities: {}.",
        findings.quantities.len(),
        counted.join(", ")
    )
}

fn overview(study: &Study, findings: &Findings) -> Block {
    let rows = study.quantities.iter().zip(&findings.quantities);
    let rows = rows.map(|(quantity, found)| {
        vec![
            format!("[{}](#{})", quantity.title, anchor(&quantity.title)),
            quantity.source.clone(),
            claim(quantity),
            answer(quantity, found),
            found.verdict.text().to_owned(),
        ]
    });
    Block::Table {
        head: head(&["quantity", "source", "the paper", "jstsph", "verdict"]),
        rows: rows.collect(),
    }
}

fn head(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

/// The paper's statement in a few words.
fn claim(quantity: &Quantity) -> String {
    match &quantity.expect {
        Expectation::Value { paper, .. } if quantity.claim.is_empty() => {
            with_unit(&paper.to_string(), &quantity.unit)
        }
        _ => quantity.claim.clone(),
    }
}

/// Our number in a few words: that of the first run, or of all runs of its scheme.
fn answer(quantity: &Quantity, found: &QuantityFinding) -> String {
    let Some(first) = found.rows.first() else {
        return String::new();
    };
    if quantity.expect.is_of_series() {
        let values = series(&found.rows, &first.scheme);
        let values: Vec<String> = values.iter().map(|(_, value)| number(*value)).collect();
        return with_unit(&values.join(" → "), &quantity.unit);
    }
    match &first.values[..] {
        [Some(value)] => {
            let value = with_unit(&number(*value), &quantity.unit);
            match first.difference {
                Some(difference) => format!("{value} ({})", percent(difference)),
                None => value,
            }
        }
        [] => "–".to_owned(),
        [.., last] => {
            let shown = |value: &Option<f64>| value.map_or("–".to_owned(), number);
            format!("{} ... {}", shown(&first.values[0]), shown(last))
        }
    }
}

fn with_unit(value: &str, unit: &str) -> String {
    if unit.is_empty() || value.is_empty() {
        value.to_owned()
    } else {
        format!("{value} {unit}")
    }
}

/// What is measured, with its unit.
pub(super) fn labelled(quantity: &Quantity) -> String {
    if quantity.unit.is_empty() {
        quantity.measured.clone()
    } else {
        format!("{}, {}", quantity.measured, quantity.unit)
    }
}

fn quantity_blocks(blocks: &mut Vec<Block>, quantity: &Quantity, found: &QuantityFinding) {
    blocks.push(Block::Heading(3, quantity.title.clone()));
    blocks.push(Block::Text(format!(
        "**The paper** ({}): {}",
        quantity.source, quantity.paper
    )));
    let values = found
        .rows
        .iter()
        .map(|row| row.values.len())
        .max()
        .unwrap_or(0);
    let is_number = matches!(quantity.expect, Expectation::Value { .. });
    let mut table = head(&["", "particles"]);
    if values > 1 {
        table.extend((1..=values).map(|point| point.to_string()));
    } else {
        table.push(labelled(quantity));
    }
    if is_number {
        table.push("difference".to_owned());
    }
    table.push("verdict".to_owned());
    let columns = table.len();
    let references = quantity.references.iter().map(|reference| {
        let mut row = vec![
            reference.label.clone(),
            String::new(),
            reference.value.to_string(),
        ];
        row.resize(columns, String::new());
        row
    });
    let ours = found
        .rows
        .iter()
        .map(|row| cells(row, values.max(1), is_number));
    blocks.push(Block::Table {
        head: table,
        rows: references.chain(ours).collect(),
    });
    if values > 1 {
        blocks.push(Block::Text(format!("Columns: {}.", labelled(quantity))));
    }
    if !quantity.reason.is_empty() {
        let heading = match found.verdict {
            Verdict::Differs | Verdict::Close => "Why",
            _ => "Note",
        };
        blocks.push(Block::Text(format!(
            "**{heading}**: {}",
            quantity.reason.trim()
        )));
    }
    for picture in &found.pictures {
        blocks.push(Block::Picture {
            file: picture.file.clone(),
            caption: picture.caption.clone(),
        });
    }
}

fn cells(row: &Row, values: usize, is_number: bool) -> Vec<String> {
    let particles = if row.particles == 0 {
        String::new()
    } else {
        row.particles.to_string()
    };
    let mut cells = vec![format!("jstsph, {}", row.scheme), particles];
    for i in 0..values {
        cells.push(match row.values.get(i) {
            Some(Some(value)) => number(*value),
            _ => "–".to_owned(),
        });
    }
    if is_number {
        cells.push(row.difference.map_or(String::new(), percent));
    }
    let verdict = if row.verdict == Verdict::NotRun && !row.values.is_empty() {
        "too few resolutions"
    } else {
        row.verdict.text()
    };
    cells.push(if row.note.is_empty() || row.verdict == Verdict::NotRun {
        verdict.to_owned()
    } else {
        format!("{verdict}: {}", row.note)
    });
    cells
}

fn runs(findings: &Findings) -> Block {
    let rows = findings.runs.iter().map(|run| {
        let settings = run.settings.iter();
        let settings: Vec<String> = settings
            .map(|(key, value)| format!("`{key}={value}`"))
            .collect();
        let of = |value: String| {
            if run.version.is_none() {
                String::new()
            } else {
                value
            }
        };
        vec![
            format!("`{}`", run.id),
            format!("`{}`", run.case),
            settings.join(" "),
            of(run.particles.to_string()),
            of(run.steps.to_string()),
            of(duration(run.wall_seconds)),
            match run.status {
                RunStatus::Completed => "completed".to_owned(),
                RunStatus::Failed => run.note.clone(),
                RunStatus::NotRun => Verdict::NotRun.text().to_owned(),
            },
        ]
    });
    Block::Table {
        head: head(&[
            "run",
            "case",
            "settings",
            "particles",
            "steps",
            "wall time",
            "end",
        ]),
        rows: rows.collect(),
    }
}

/// Four digits; whole numbers as they are.
pub(super) fn number(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 || (magnitude < 1e6 && value.fract() == 0.0) {
        return format!("{}", value + 0.0);
    }
    if !(1e-3..1e5).contains(&magnitude) {
        return format!("{value:.3e}");
    }
    #[expect(clippy::cast_possible_truncation, reason = "between -3 and 4")]
    let decimals = 3 - magnitude.log10().floor() as i32;
    format!("{value:.*}", usize::try_from(decimals).unwrap_or(0))
}

fn percent(part: f64) -> String {
    format!("{:+.1} %", 100.0 * part)
}

/// The anchor that Markdown readers give a heading.
pub(super) fn anchor(heading: &str) -> String {
    let kept = heading.trim().to_lowercase();
    kept.chars()
        .filter(|c| c.is_alphanumeric() || [' ', '-', '_'].contains(c))
        .map(|c| if c == ' ' { '-' } else { c })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits() {
        for (value, text) in [
            (7.218_94, "7.219"),
            (0.416_04, "0.4160"),
            (21.204, "21.20"),
            (12_345.6, "12346"),
            (4.881e6, "4.881e6"),
            (-2e-5, "-2.000e-5"),
            (58.0, "58"),
            (-0.0, "0"),
        ] {
            assert_eq!(number(value), text);
        }
        assert_eq!(percent(0.0342), "+3.4 %");
        assert_eq!(
            short("0123456789abcdef with changes"),
            "0123456789 with changes"
        );
    }

    #[test]
    fn anchors_are_those_of_markdown() {
        assert_eq!(
            anchor("Radius at 80 µs (Table 1)"),
            "radius-at-80-µs-table-1"
        );
    }
}
