//! What came out: `reproduction.json`.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use jstsph_output::Machine;
use serde::{Deserialize, Serialize};

use super::judge::Verdict;
use super::measure::Results;
use super::study::{Quantity, Study};
use crate::error::CliError;

/// Everything measured for a study, and how it compares.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Findings {
    /// Name of the study.
    pub(super) study: String,
    /// Coarse resolutions.
    pub(super) quick: bool,
    /// Version of the program that compared.
    pub(super) version: String,
    /// Its commit, if known.
    pub(super) commit: Option<String>,
    /// Processor.
    pub(super) cpu: String,
    /// When, ISO 8601 in UTC.
    pub(super) date: String,
    /// One per run of the study, full or quick, in its order.
    pub(super) runs: Vec<RunFinding>,
    /// One per quantity of the study, in its order.
    pub(super) quantities: Vec<QuantityFinding>,
}

/// How a run went.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum RunStatus {
    /// To the end.
    Completed,
    /// It broke down, or could not start.
    Failed,
    /// Not asked for.
    NotRun,
}

/// One run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct RunFinding {
    pub(super) id: String,
    pub(super) case: String,
    pub(super) scheme: String,
    pub(super) settings: BTreeMap<String, String>,
    pub(super) status: RunStatus,
    /// Why it failed or was not run; empty otherwise.
    pub(super) note: String,
    pub(super) particles: u64,
    pub(super) steps: u64,
    /// Wall-clock time of the time loop, s.
    pub(super) wall_seconds: f64,
    /// Version and commit of the program that ran it; none without a run.
    pub(super) version: Option<String>,
    pub(super) commit: Option<String>,
}

/// One published number, statement or figure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct QuantityFinding {
    pub(super) id: String,
    pub(super) title: String,
    pub(super) source: String,
    pub(super) paper: String,
    /// What the values below are.
    pub(super) measured: String,
    /// Their unit.
    pub(super) unit: String,
    /// That of the first row, or of its scheme.
    pub(super) verdict: Verdict,
    /// Why it differs, or what to know.
    pub(super) reason: String,
    pub(super) rows: Vec<Row>,
    pub(super) pictures: Vec<Drawn>,
}

/// What one run gives.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Row {
    pub(super) run: String,
    pub(super) scheme: String,
    pub(super) particles: u64,
    /// One number, ten for a line of ten points; `null` where there is none.
    pub(super) values: Vec<Option<f64>>,
    /// Relative, from the paper's number.
    pub(super) difference: Option<f64>,
    pub(super) verdict: Verdict,
    /// Why there is no number.
    pub(super) note: String,
}

/// A picture, in the folder of the page.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Drawn {
    pub(super) file: String,
    pub(super) caption: String,
}

impl Findings {
    /// What a program has found at this moment on this machine, without runs and quantities.
    pub(super) fn new(study: &Study, is_quick: bool) -> Self {
        Self {
            study: study.name.clone(),
            quick: is_quick,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            commit: option_env!("JSTSPH_COMMIT").map(str::to_owned),
            cpu: Machine::detect().cpu,
            date: jstsph_output::iso8601(std::time::SystemTime::now()),
            runs: Vec::new(),
            quantities: Vec::new(),
        }
    }

    /// Reads an earlier file, takes the words from the study as it is now, and judges again.
    ///
    /// # Errors
    /// [`CliError::Study`] when the file cannot be read or has other runs or quantities than the study.
    pub(super) fn read(study: &Study, path: &Path) -> Result<Self, CliError> {
        let fail = |reason: String| CliError::Study {
            name: path.display().to_string(),
            reason,
        };
        let text = std::fs::read_to_string(path).map_err(|error| fail(error.to_string()))?;
        let mut findings: Self =
            serde_json::from_str(&text).map_err(|error| fail(error.to_string()))?;
        findings.fit(study).map_err(|what| {
            fail(format!(
                "{what}; run `jstsph reproduce {}` again",
                study.name
            ))
        })?;
        Ok(findings)
    }

    fn fit(&mut self, study: &Study) -> Result<(), String> {
        if self.study != study.name {
            return Err(format!("it belongs to study {}", self.study));
        }
        for run in study.part(self.quick) {
            let Some(found) = self.runs.iter().find(|found| found.id == run.id) else {
                return Err(format!("run `{}` is missing", run.id));
            };
            let settings = run.overrides(self.quick).cloned().unwrap_or_default();
            if found.case != run.case || found.scheme != run.scheme || found.settings != settings {
                return Err(format!("run `{}` has changed", run.id));
            }
        }
        if self.runs.len() != study.part(self.quick).count()
            || self.quantities.len() != study.quantities.len()
        {
            return Err("it has runs or quantities that the study has not".to_owned());
        }
        for quantity in &study.quantities {
            let found = self
                .quantities
                .iter_mut()
                .find(|found| found.id == quantity.id);
            let found = found.ok_or_else(|| format!("quantity `{}` is missing", quantity.id))?;
            let runs = found.rows.iter().map(|row| &row.run);
            let known = |id: &&String| self.runs.iter().any(|run| run.id == **id);
            if !runs.eq(quantity.runs.iter().filter(known))
                || (&found.measured, &found.unit) != (&quantity.measured, &quantity.unit)
            {
                return Err(format!("quantity `{}` has changed", quantity.id));
            }
            *found = QuantityFinding::new(quantity, std::mem::take(&mut found.rows));
        }
        let place = |id: &str| {
            study
                .quantities
                .iter()
                .position(|quantity| quantity.id == id)
        };
        self.quantities.sort_by_key(|found| place(&found.id));
        Ok(())
    }

    /// Number of quantities with a verdict.
    pub(super) fn count(&self, verdict: Verdict) -> usize {
        let found = self.quantities.iter();
        found.filter(|quantity| quantity.verdict == verdict).count()
    }
}

impl QuantityFinding {
    /// Reads a quantity off the runs that have finished.
    pub(super) fn measure(
        quantity: &Quantity,
        runs: &[RunFinding],
        results: &HashMap<String, Results>,
    ) -> Self {
        let rows = quantity.runs.iter().filter_map(|id| {
            let run = runs.iter().find(|run| run.id == *id)?;
            let mut row = Row {
                run: id.clone(),
                scheme: run.scheme.clone(),
                particles: run.particles,
                values: Vec::new(),
                difference: None,
                verdict: Verdict::NotRun,
                note: run.note.clone(),
            };
            match (run.status, results.get(id)) {
                (RunStatus::Completed, Some(results)) => match quantity.measure.evaluate(results) {
                    Ok(values) => {
                        let shown = values.iter().map(|value| value / quantity.unit_in_si());
                        row.values = shown.map(|v| v.is_finite().then_some(v)).collect();
                    }
                    Err(error) => {
                        row.note = error.to_string();
                        row.verdict = Verdict::Failed;
                    }
                },
                (RunStatus::NotRun, _) => {}
                _ => row.verdict = Verdict::Failed,
            }
            Some(row)
        });
        Self::new(quantity, rows.collect())
    }

    /// Judges rows, whose values are in the unit of the quantity.
    fn new(quantity: &Quantity, mut rows: Vec<Row>) -> Self {
        let expectation = &quantity.expect;
        for row in &mut rows {
            let values: Vec<f64> = row.values.iter().map(|v| v.unwrap_or(f64::NAN)).collect();
            if let Some(verdict) = expectation.judge(&values) {
                row.verdict = if values.is_empty() {
                    row.verdict
                } else {
                    verdict
                };
            }
            row.difference = match values[..] {
                [value] => expectation.difference(value).filter(|d| d.is_finite()),
                _ => None,
            };
        }
        if expectation.is_of_series() {
            let schemes: Vec<String> = rows.iter().map(|row| row.scheme.clone()).collect();
            for scheme in schemes {
                let series = series(&rows, &scheme);
                let values: Vec<f64> = series.iter().map(|(_, value)| *value).collect();
                let verdict = expectation.judge_series(&values);
                let measured = |row: &&mut Row| row.scheme == scheme && !row.values.is_empty();
                for row in rows.iter_mut().filter(measured) {
                    row.verdict = verdict;
                }
            }
        }
        Self {
            id: quantity.id.clone(),
            title: quantity.title.clone(),
            source: quantity.source.clone(),
            paper: quantity.paper.clone(),
            measured: quantity.measured.clone(),
            unit: quantity.unit.clone(),
            verdict: rows.first().map_or(Verdict::NotRun, |row| row.verdict),
            reason: quantity.reason.clone(),
            rows,
            pictures: Vec::new(),
        }
    }
}

/// Particles and first values of the runs of a scheme, coarse to fine.
pub(super) fn series(rows: &[Row], scheme: &str) -> Vec<(u64, f64)> {
    let of_scheme = rows.iter().filter(|row| row.scheme == scheme);
    let mut points: Vec<(u64, f64)> = of_scheme
        .filter_map(|row| Some((row.particles, row.values.first().copied()??)))
        .collect();
    points.sort_by_key(|(particles, _)| *particles);
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quantity(expect: &str) -> Quantity {
        let text = format!(
            "id = \"q\"\ntitle = \"t\"\nsource = \"s\"\npaper = \"p\"\nmeasured = \"m\"\nruns = [\"a\"]\n\
             measure.probe = \"x\"\n{expect}\n"
        );
        toml::from_str(&text).unwrap()
    }

    fn row(scheme: &str, particles: u64, value: Option<f64>) -> Row {
        Row {
            run: format!("{scheme}-{particles}"),
            scheme: scheme.to_owned(),
            particles,
            values: value.map(Some).into_iter().collect(),
            difference: None,
            verdict: Verdict::NotRun,
            note: String::new(),
        }
    }

    #[test]
    fn the_first_run_gives_the_verdict() {
        let quantity = quantity("expect.value = { paper = 2.0, met = 0.01, close = 0.1 }");
        let rows = vec![
            row("a", 10, Some(2.1)),
            row("b", 10, Some(2.0)),
            row("b", 20, None),
        ];
        let found = QuantityFinding::new(&quantity, rows);
        assert_eq!(found.verdict, Verdict::Close);
        assert!((found.rows[0].difference.unwrap() - 0.05).abs() < 1e-12);
        assert_eq!(found.rows[1].verdict, Verdict::Met);
        assert_eq!(found.rows[2].verdict, Verdict::NotRun);
        assert_eq!(found.rows[2].difference, None);
    }

    #[test]
    fn series_are_judged_by_scheme_and_resolution_whatever_the_order_of_the_runs() {
        let quantity = quantity("expect = \"monotone\"");
        let rows = vec![
            row("a", 30, Some(1.5)),
            row("a", 10, Some(3.0)),
            row("b", 10, Some(1.0)),
            row("a", 20, Some(2.0)),
            row("b", 20, Some(2.0)),
            row("a", 40, None),
        ];
        let found = QuantityFinding::new(&quantity, rows);
        let verdicts: Vec<Verdict> = found.rows.iter().map(|row| row.verdict).collect();
        assert_eq!(verdicts[..2], [Verdict::Met; 2]);
        assert_eq!(verdicts[2], Verdict::NotRun);
        assert_eq!(verdicts[5], Verdict::NotRun);
        assert_eq!(series(&found.rows, "a"), [(10, 3.0), (20, 2.0), (30, 1.5)]);
    }
}
