//! Curves of `history.csv` over time.

use jstsph_case::Case;
use jstsph_geometry::Dimension;
use jstsph_output::plot::{LinePlot, Quantity, Series, SeriesStyle};
use jstsph_output::{HISTORY_COLUMNS, OutputError, Table};
use jstsph_solver::{ProbeKind, Simulation};

use super::derived::{rate_unit, rated};
use super::probes::described;
use crate::error::CliError;

/// Sets of columns with a name.
const SETS: [&str; 4] = ["energies", "balance", "time_step", "probes"];

/// Part of the largest energy from which a kind of energy is worth a curve.
const VISIBLE: f64 = 1e-4;

/// The table of a run with what the case says about its columns.
pub(crate) struct History<'a> {
    pub(crate) case: &'a Case,
    pub(crate) table: &'a Table,
    /// Column of the horizontal axis in place of time.
    pub(super) over: Option<&'a str>,
    /// Time of profiles, s; the last with values unless given.
    pub(super) at: Option<f64>,
}

impl<'a> History<'a> {
    /// The table over time.
    pub(crate) fn new(case: &'a Case, table: &'a Table) -> Self {
        Self {
            case,
            table,
            over: None,
            at: None,
        }
    }
}

impl History<'_> {
    pub(super) fn energies(&self) -> Result<LinePlot, CliError> {
        let stored = [
            "kinetic",
            "elastic",
            "plastic",
            "numerical",
            "hourglass",
            "friction",
        ];
        let columns = stored
            .map(|kind| self.column(&format!("{kind}_energy")))
            .into_iter()
            .collect::<Result<Vec<_>, _>>()?;
        let work = [
            self.column("external_energy")?,
            self.column("contact_energy")?,
        ];
        let rows = self.table.rows.len();
        let sum = |columns: &[Vec<f64>], row: usize| columns.iter().map(|c| c[row]).sum::<f64>();
        let total: Vec<f64> = (0..rows).map(|row| sum(&columns, row)).collect();
        let start = total.first().copied().unwrap_or(0.0);
        let supplied: Vec<f64> = (0..rows).map(|row| start + sum(&work, row)).collect();
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let mut series = Vec::new();
        for (kind, column) in stored.iter().zip(&columns) {
            if largest(column) > VISIBLE * largest(&total) {
                series.push(self.series(kind, column)?);
            }
        }
        series.push(self.series("sum", &total)?);
        series.push(Series {
            style: SeriesStyle::Dashed,
            ..self.series("initial + work", &supplied)?
        });
        Ok(LinePlot {
            x: self.abscissa(),
            y: Quantity::new("energy", self.per_thickness("J")),
            series,
            ..LinePlot::default()
        })
    }

    pub(super) fn balance(&self) -> Result<LinePlot, CliError> {
        let mut percent = self.column("energy_balance")?;
        percent.iter_mut().for_each(|value| *value *= 100.0);
        Ok(LinePlot {
            x: self.abscissa(),
            y: Quantity::new("energy balance, % of the largest energy", ""),
            series: vec![self.series("balance", &percent)?],
            ..LinePlot::default()
        })
    }

    pub(super) fn time_step(&self) -> Result<LinePlot, CliError> {
        let mut steps = self.column("dt")?;
        // Before the first step there is none.
        steps.iter_mut().for_each(|dt| {
            if *dt == 0.0 {
                *dt = f64::NAN;
            }
        });
        Ok(LinePlot {
            x: self.abscissa(),
            y: Quantity::new("time step", "s"),
            series: vec![self.series("time step", &steps)?],
            ..LinePlot::default()
        })
    }

    /// One diagram for each unit among the columns, in their order.
    pub(super) fn by_unit(&self, names: &[&str]) -> Result<Vec<LinePlot>, CliError> {
        let mut plots: Vec<LinePlot> = Vec::new();
        for name in names {
            let unit = self.unit(name);
            let series = self.series(name, &self.column(name)?)?;
            if series.points.is_empty() {
                continue;
            }
            match plots.iter_mut().find(|plot| plot.y.unit == unit) {
                Some(plot) => {
                    plot.series.push(series);
                    plot.y.name = common_name(&plot.series, &unit);
                }
                None => plots.push(LinePlot {
                    x: self.abscissa(),
                    y: Quantity::new(series.label.clone(), unit),
                    series: vec![series],
                    ..LinePlot::default()
                }),
            }
        }
        Ok(plots)
    }

    /// What the horizontal axis shows.
    fn abscissa(&self) -> Quantity {
        match self.over {
            None => Quantity::new("time", "s"),
            Some(column) => Quantity::new(shown(column), self.unit(column)),
        }
    }

    /// A curve, without the rows in which one of the columns has no value.
    fn series(&self, name: &str, values: &[f64]) -> Result<Series, CliError> {
        let abscissas = self.column(self.over.unwrap_or("time"))?;
        let points = abscissas.into_iter().zip(values.iter().copied());
        Ok(Series {
            label: shown(name),
            points: points
                .filter(|(x, value)| x.is_finite() && value.is_finite())
                .collect(),
            ..Series::default()
        })
    }

    pub(super) fn column(&self, name: &str) -> Result<Vec<f64>, CliError> {
        self.table.column(name).ok_or_else(|| {
            CliError::Picture(OutputError::NoColumn {
                column: name.to_owned(),
                columns: self.table.columns.clone(),
            })
        })
    }

    pub(super) fn known(&self, name: &str) -> Result<(), CliError> {
        if self.table.columns.iter().any(|column| column == name) {
            return Ok(());
        }
        let sets = SETS.map(str::to_owned).into_iter();
        Err(CliError::UnknownName {
            what: "set or column of history.csv",
            name: name.to_owned(),
            allowed: sets.chain(self.table.columns.iter().cloned()).collect(),
        })
    }

    /// SI unit of a column, empty for a pure number.
    pub(crate) fn unit(&self, name: &str) -> String {
        if let Some(column) = rated(name) {
            return rate_unit(&self.unit(column));
        }
        if let Some(column) = HISTORY_COLUMNS.iter().find(|column| column.name == name) {
            return match column.unit {
                "-" => String::new(),
                "J" => self.per_thickness("J"),
                unit => unit.to_owned(),
            };
        }
        for probe in &self.case.probes {
            if Simulation::probe_columns(probe).iter().any(|c| c == name) {
                return match &probe.kind {
                    ProbeKind::Extent { .. }
                    | ProbeKind::Radius { .. }
                    | ProbeKind::EdgeRadius { .. } => "m",
                    ProbeKind::Statistic { field, .. }
                    | ProbeKind::Point { field, .. }
                    | ProbeKind::Line { field, .. } => described(*field).1,
                }
                .to_owned();
            }
        }
        if name.starts_with("force_") {
            self.per_thickness("N")
        } else if name.starts_with("angular_momentum_") {
            self.per_thickness("N m s")
        } else if name.starts_with("momentum_") {
            self.per_thickness("N s")
        } else {
            String::new()
        }
    }

    /// A unit of a whole body: per metre of thickness in plane strain.
    pub(crate) fn per_thickness(&self, unit: &str) -> String {
        match self.case.model.dimension {
            Dimension::PlaneStrain => format!("{unit}/m"),
            Dimension::Solid => unit.to_owned(),
        }
    }
}

/// A column's name as text.
pub(super) fn shown(column: &str) -> String {
    if let Some(column) = rated(column) {
        return format!("rate of {}", shown(column));
    }
    match column {
        // Equations of Greto & Kulasegaram 2019.
        "paper_internal_energy" => "internal energy (4.1a)".to_owned(),
        "paper_plastic_dissipation" => "plastic dissipation (4.1b)".to_owned(),
        "paper_jst_dissipation" => "JST dissipation (4.1c)".to_owned(),
        other => other.replace('_', " "),
    }
}

/// What several columns of one unit have in common: the last words of their names, or else what
/// the unit measures.
fn common_name(series: &[Series], unit: &str) -> String {
    let words = |series: &Series| -> Vec<String> {
        let words = series.label.split(' ').rev().map(str::to_owned);
        words.collect()
    };
    let mut common = words(&series[0]);
    for other in &series[1..] {
        let other = words(other);
        let same = common.iter().zip(&other).take_while(|(a, b)| a == b);
        let same = same.count();
        common.truncate(same);
    }
    if common.iter().any(|word| word.len() > 1) {
        common.reverse();
        return common.join(" ");
    }
    measured(unit).to_owned()
}

/// What a unit measures.
fn measured(unit: &str) -> &'static str {
    match unit {
        "J" | "J/m" => "energy",
        "N" | "N/m" => "force",
        "Pa" => "stress",
        "m" => "length",
        "s" => "time",
        "m/s" => "velocity",
        "N s" | "N s/m" => "momentum",
        "N m s" | "N m s/m" => "angular momentum",
        _ => "value",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::testing::block;

    const TABLES: &str = r#"
[[probe]]
name = "length"
extent = { where = "block", axis = "y" }
[[probe]]
name = "peak"
statistic = { where = "block", field = "pressure", of = "max" }
[[probe]]
name = "cut"
line = { from = [0, 0.003], to = [0.004, 0.003], count = 3, field = "pressure" }
"#;

    fn case() -> Case {
        block(TABLES)
    }

    /// Three rows in which column `i` grows from `i`; the profile has no value in the last.
    fn table() -> Table {
        let mut columns: Vec<String> = HISTORY_COLUMNS.iter().map(|c| c.name.to_owned()).collect();
        for name in ["force_die_y", "length", "peak", "cut_1", "cut_2", "cut_3"] {
            columns.push(name.to_owned());
        }
        let rows = (0..3).map(|row| {
            let value = |(i, name): (usize, &String)| match row {
                2 if name.starts_with("cut") => f64::NAN,
                _ => i as f64 + f64::from(row),
            };
            columns.iter().enumerate().map(value).collect()
        });
        Table {
            rows: rows.collect(),
            columns: columns.clone(),
        }
    }

    fn drawn(what: &str) -> Result<(), CliError> {
        let told = crate::plot::curves::Told {
            case: &case(),
            table: &table(),
            label: "",
        };
        let wanted = crate::plot::curves::Wanted {
            what,
            look: &crate::arguments::CurveLook::default(),
            title: None,
            folders: &[],
        };
        crate::plot::curves::figure(&[told], wanted).map(|_| ())
    }

    #[test]
    fn energies_are_per_thickness_and_compared_with_what_was_supplied() {
        let (case, table) = (case(), table());
        let history = History::new(&case, &table);
        let plot = history.energies().unwrap();
        assert_eq!(plot.y, Quantity::new("energy", "J/m"));
        let last = |label: &str| {
            let series = plot.series.iter().find(|series| series.label == label);
            series.unwrap().points[2].1
        };
        // Six kinds that start at 3 to 7 and 10, work that starts at 8 and 9.
        assert_eq!(last("sum"), 35.0 + 6.0 * 2.0);
        assert_eq!(last("initial + work"), 35.0 + 17.0 + 2.0 * 2.0);
        assert_eq!(plot.series.len(), 8);
    }

    #[test]
    fn probes_are_grouped_by_unit_and_lines_are_profiles() {
        let (case, table) = (case(), table());
        let history = History::new(&case, &table);
        let plots = history.probes().unwrap();
        let labels: Vec<String> = plots
            .iter()
            .map(|plot| format!("{} ({})", plot.y.name, plot.y.unit))
            .collect();
        assert_eq!(
            labels,
            ["length (m)", "peak (Pa)", "pressure, tension positive (Pa)"]
        );
        let first = table.columns.iter().position(|c| c == "cut_1").unwrap() as f64;
        let profile = &plots[2].series[0];
        assert_eq!(profile.label, "cut, t = 1 s");
        let expected = [
            (0.0, first + 1.0),
            (0.002, first + 2.0),
            (0.004, first + 3.0),
        ];
        for (point, expected) in profile.points.iter().zip(expected) {
            assert!((point.0 - expected.0).abs() < 1e-15 && point.1 == expected.1);
        }
    }

    #[test]
    fn curves_in_common_are_named_after_their_last_words() {
        let series = |labels: &[&str]| -> Vec<Series> {
            let series = labels.iter().map(|label| Series {
                label: (*label).to_owned(),
                ..Series::default()
            });
            series.collect()
        };
        let strains = series(&["largest plastic strain", "mean plastic strain"]);
        assert_eq!(common_name(&strains, ""), "plastic strain");
        assert_eq!(common_name(&series(&["length", "radius"]), "m"), "length");
        assert_eq!(
            common_name(&series(&["force a x", "force b x"]), "N"),
            "force"
        );
    }

    #[test]
    fn unknown_columns_are_refused_with_all_names() {
        let message = drawn("dt,kinetic").unwrap_err().to_string();
        assert!(
            message.starts_with("unknown set or column of history.csv `kinetic`"),
            "{message}"
        );
        for name in [
            "energies, balance, time_step, probes",
            "kinetic_energy",
            "cut_3",
        ] {
            assert!(message.contains(name), "{message}");
        }
        assert!(drawn("dt, force_die_y").is_ok());
    }
}
