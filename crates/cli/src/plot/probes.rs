//! Probes: numbers as curves, lines of points as profiles.

use jstsph_output::OutputError;
use jstsph_output::plot::{LinePlot, Quantity, Series, SeriesStyle};
use jstsph_solver::{Field, ProbeKind, Simulation};
use jstsph_tensor::Vec3;

use super::history::History;
use super::{heading, moment};
use crate::error::CliError;

impl History<'_> {
    /// Numbers over time, and lines of points as profiles at the last time they have values.
    pub(super) fn probes(&self) -> Result<Vec<LinePlot>, CliError> {
        let mut numbers = Vec::new();
        let mut profiles = Vec::new();
        for probe in &self.case.probes {
            let columns = Simulation::probe_columns(probe);
            match &probe.kind {
                ProbeKind::Line {
                    from, to, field, ..
                } => profiles.extend(self.profile(&probe.name, &columns, *field, [from, to])?),
                _ => numbers.extend(columns),
            }
        }
        let names: Vec<&str> = numbers.iter().map(String::as_str).collect();
        self.with_profiles(self.by_unit(&names)?, profiles)
    }

    /// Columns over time, and probes along a line as profiles, by their names.
    pub(super) fn named(&self, names: &[&str]) -> Result<Vec<LinePlot>, CliError> {
        let mut columns = Vec::new();
        let mut profiles = Vec::new();
        for name in names {
            let line = self.case.probes.iter().find(|probe| probe.name == *name);
            match line.map(|probe| (&probe.kind, Simulation::probe_columns(probe))) {
                Some((
                    ProbeKind::Line {
                        from, to, field, ..
                    },
                    of,
                )) => profiles.extend(self.profile(name, &of, *field, [from, to])?),
                _ => {
                    self.known(name)?;
                    columns.push(*name);
                }
            }
        }
        self.with_profiles(self.by_unit(&columns)?, profiles)
    }

    /// Diagrams and profiles; profiles of one quantity share a diagram.
    fn with_profiles(
        &self,
        mut plots: Vec<LinePlot>,
        profiles: Vec<LinePlot>,
    ) -> Result<Vec<LinePlot>, CliError> {
        for profile in profiles {
            let mut others = plots.iter_mut();
            match others.find(|plot| plot.x == profile.x && plot.y == profile.y) {
                Some(plot) => plot.series.extend(profile.series),
                None => plots.push(profile),
            }
        }
        if plots.is_empty() {
            return Err(CliError::Picture(OutputError::NothingToDraw {
                title: heading(self.case).to_owned(),
                reason: "no probe or column has a value",
            }));
        }
        Ok(plots)
    }

    fn profile(
        &self,
        name: &str,
        columns: &[String],
        field: Field,
        [from, to]: [&Vec3; 2],
    ) -> Result<Option<LinePlot>, CliError> {
        let values = columns
            .iter()
            .map(|column| self.column(column))
            .collect::<Result<Vec<_>, _>>()?;
        let times = self.column("time")?;
        let has_values = |row: &usize| values.iter().any(|column| column[*row].is_finite());
        let mut rows = (0..times.len()).rev().filter(has_values);
        let row = match self.at {
            None => rows.next(),
            Some(at) => {
                let distance = |row: &usize| (times[*row] - at).abs();
                rows.min_by(|a, b| distance(a).total_cmp(&distance(b)))
            }
        };
        let Some(row) = row else {
            return Ok(None);
        };
        let length = (to - from).norm();
        let last = (columns.len().max(2) - 1) as f64;
        let points = values
            .iter()
            .enumerate()
            .map(|(i, column)| (length * i as f64 / last, column[row]))
            .filter(|(_, value)| value.is_finite());
        let (number, unit) = moment(times[row]);
        let (label, field_unit) = described(field);
        Ok(Some(LinePlot {
            x: Quantity::new("distance along the line", "m"),
            y: Quantity::new(label, field_unit),
            series: vec![Series {
                label: format!("{}, t = {number} {unit}", name.replace('_', " ")),
                points: points.collect(),
                style: SeriesStyle::LineWithMarkers,
                ..Series::default()
            }],
            ..LinePlot::default()
        }))
    }
}

/// Name and SI unit of a probe's field.
pub(super) fn described(field: Field) -> (&'static str, &'static str) {
    match field {
        Field::EquivalentPlasticStrain => ("equivalent plastic strain", ""),
        Field::VonMisesStress => ("von Mises stress", "Pa"),
        Field::Pressure => ("pressure, tension positive", "Pa"),
        Field::Jacobian => ("volume ratio J", ""),
        Field::WaveSpeed => ("wave speed", "m/s"),
        Field::Temperature => ("temperature", "K"),
        Field::Displacement(_) => ("displacement", "m"),
        Field::Position(_) => ("position", "m"),
        Field::Velocity(_) => ("velocity", "m/s"),
    }
}
