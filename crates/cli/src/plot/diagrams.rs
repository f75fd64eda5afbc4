//! The diagrams of a report.

use jstsph_output::OutputError;
use jstsph_output::plot::LinePlot;

use super::history::History;
use crate::error::CliError;

/// Columns of the table that are worth a diagram of their own, by the beginnings of their names.
const GROUPS: [(&str, &[&str]); 5] = [
    ("Reactions", &["force_"]),
    ("Largest plastic strain", &["equivalent_plastic_strain"]),
    ("Extremes of the volume ratio", &["jacobian_"]),
    ("Momentum", &["momentum_"]),
    ("Angular momentum", &["angular_momentum_"]),
];

impl History<'_> {
    /// Energies, balance, time step, probes, reactions and extremes, with titles.
    pub(crate) fn diagrams(&self) -> Result<Vec<LinePlot>, CliError> {
        let titled = |title: &str, plot: LinePlot| LinePlot {
            title: title.to_owned(),
            ..plot
        };
        let mut diagrams = vec![
            titled("Energies", self.energies()?),
            titled("Energy balance", self.balance()?),
            titled("Time step", self.time_step()?),
        ];
        match self.probes() {
            Ok(probes) => diagrams.extend(probes.into_iter().map(|plot| {
                let title = format!("Probes: {}", plot.y.name);
                titled(&title, plot)
            })),
            // A case without probes, or a run that ended before they had values.
            Err(CliError::Picture(OutputError::NothingToDraw { .. })) => {}
            Err(error) => return Err(error),
        }
        let probes: Vec<&str> = self.case.probes.iter().map(|p| p.name.as_str()).collect();
        for (title, beginnings) in GROUPS {
            let columns = self.table.columns.iter().map(String::as_str);
            let names: Vec<&str> = columns
                .filter(|name| beginnings.iter().any(|start| name.starts_with(start)))
                .filter(|name| !probes.contains(name))
                .collect();
            let plots = self.by_unit(&names)?;
            diagrams.extend(plots.into_iter().map(|plot| titled(title, plot)));
        }
        // A curve needs two points.
        diagrams.retain(|plot| plot.series.iter().any(|series| series.points.len() > 1));
        Ok(diagrams)
    }
}
