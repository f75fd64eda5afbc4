//! The history of a run: `history.csv`.

use std::path::Path;

use crate::{Energies, Extremes, OutputError, TableWriter};

/// A column that every history has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HistoryColumn {
    /// Name in the header.
    pub name: &'static str,
    /// SI unit, `-` for a pure number.
    pub unit: &'static str,
    /// What it is.
    pub meaning: &'static str,
}

/// The columns of `history.csv` before the probes, in order.
pub const HISTORY_COLUMNS: [HistoryColumn; 16] = [
    column("time", "s", "simulated time"),
    column("step", "-", "steps done"),
    column("dt", "s", "size of the last time step"),
    column("kinetic_energy", "J", "energy of motion"),
    column("elastic_energy", "J", "energy stored in elastic strain"),
    column(
        "plastic_energy",
        "J",
        "work turned into heat by plastic flow",
    ),
    column(
        "numerical_energy",
        "J",
        "energy removed by the numerical dissipation",
    ),
    column(
        "hourglass_energy",
        "J",
        "energy of the control of spurious modes",
    ),
    column(
        "external_energy",
        "J",
        "work done on the body by loads and prescribed motion",
    ),
    column("contact_energy", "J", "work done on the body by obstacles"),
    column(
        "friction_energy",
        "J",
        "energy dissipated by friction at obstacles",
    ),
    column(
        "energy_balance",
        "-",
        "defect of the energy balance over the largest energy",
    ),
    column(
        "equivalent_plastic_strain",
        "-",
        "largest equivalent plastic strain",
    ),
    column("jacobian_min", "-", "smallest volume ratio"),
    column("jacobian_max", "-", "largest volume ratio"),
    column(
        "kinetic_to_internal",
        "-",
        "kinetic over elastic and plastic energy; empty while these are zero",
    ),
];

const fn column(name: &'static str, unit: &'static str, meaning: &'static str) -> HistoryColumn {
    HistoryColumn {
        name,
        unit,
        meaning,
    }
}

/// One row of the history.
#[derive(Debug, Clone, Copy)]
pub struct HistoryRow<'a> {
    /// Simulated time, s.
    pub time: f64,
    /// Steps done.
    pub step: u64,
    /// Size of the last time step, s; zero in the first row.
    pub dt: f64,
    /// Energies, J.
    pub energies: Energies,
    /// Extremes over the particles.
    pub extremes: Extremes,
    /// Values of the probes, in SI units, in the order given when the history was created; NaN
    /// where a probe has no value, for instance at a point that no particle has reached.
    pub probes: &'a [f64],
}

/// Writes `history.csv`: [`HISTORY_COLUMNS`], then one column per probe, all in SI units.
#[derive(Debug)]
pub struct HistoryWriter {
    table: TableWriter,
}

impl HistoryWriter {
    /// Starts a history with the given probes, replacing an existing file.
    ///
    /// # Errors
    /// Those of [`TableWriter::create`].
    pub fn create(path: &Path, probes: &[String]) -> Result<Self, OutputError> {
        let table = TableWriter::create(path, columns(probes))?;
        Ok(Self { table })
    }

    /// Continues a history after `time` (s), removing later rows.
    ///
    /// # Errors
    /// Those of [`TableWriter::resume`].
    pub fn resume(path: &Path, probes: &[String], time: f64) -> Result<Self, OutputError> {
        let table = TableWriter::resume(path, columns(probes), time)?;
        Ok(Self { table })
    }

    /// Appends a row.
    ///
    /// # Errors
    /// Those of [`TableWriter::append`].
    pub fn append(&mut self, row: &HistoryRow) -> Result<(), OutputError> {
        let HistoryRow {
            energies: e,
            extremes: x,
            ..
        } = row;
        let mut values = vec![
            row.time,
            row.step as f64,
            row.dt,
            e.kinetic,
            e.elastic,
            e.plastic,
            e.numerical,
            e.hourglass,
            e.external,
            e.contact,
            e.friction,
            e.balance,
            x.equivalent_plastic_strain,
            x.jacobian_min,
            x.jacobian_max,
        ];
        let required = values.len();
        values.push(e.kinetic_to_internal());
        values.extend_from_slice(row.probes);
        self.table.append_with_gaps(&values, required)
    }

    /// Waits until all rows are on the disk.
    ///
    /// # Errors
    /// Those of [`TableWriter::sync`].
    pub fn sync(&self) -> Result<(), OutputError> {
        self.table.sync()
    }

    /// What waits, on any thread, until the rows written so far are on the disk.
    ///
    /// # Errors
    /// Those of [`TableWriter::syncing`].
    pub fn syncing(
        &self,
    ) -> Result<impl FnOnce() -> Result<(), OutputError> + Send + 'static, OutputError> {
        self.table.syncing()
    }
}

fn columns(probes: &[String]) -> Vec<String> {
    let fixed = HISTORY_COLUMNS.iter().map(|column| column.name.to_owned());
    fixed.chain(probes.iter().cloned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read_table;

    #[test]
    fn each_value_lands_in_its_column() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let probes = ["base_radius".to_owned()];
        let row = HistoryRow {
            time: 1.0,
            step: 2,
            dt: 3.0,
            energies: Energies {
                kinetic: 4.0,
                elastic: 5.0,
                plastic: 6.0,
                numerical: 7.0,
                hourglass: 8.0,
                external: 9.0,
                contact: 10.0,
                friction: 10.5,
                balance: 11.0,
            },
            extremes: Extremes {
                equivalent_plastic_strain: 12.0,
                jacobian_min: 13.0,
                jacobian_max: 14.0,
            },
            probes: &[15.0],
        };
        HistoryWriter::create(&path, &probes)
            .unwrap()
            .append(&row)
            .unwrap();
        HistoryWriter::resume(&path, &probes, 1.0)
            .unwrap()
            .append(&HistoryRow { time: 1.5, ..row })
            .unwrap();
        let table = read_table(&path).unwrap();
        for (name, value) in [
            ("time", 1.0),
            ("step", 2.0),
            ("kinetic_energy", 4.0),
            ("plastic_energy", 6.0),
            ("contact_energy", 10.0),
            ("friction_energy", 10.5),
            ("energy_balance", 11.0),
            ("jacobian_max", 14.0),
            ("kinetic_to_internal", 4.0 / 11.0),
            ("base_radius", 15.0),
        ] {
            assert_eq!(table.column(name).unwrap()[0], value, "{name}");
        }
        assert_eq!(table.column("time"), Some(vec![1.0, 1.5]));
    }

    #[test]
    fn the_readme_describes_every_column() {
        let readme = include_str!("../README.md");
        for column in HISTORY_COLUMNS {
            assert!(readme.contains(&format!("`{}`", column.name)), "{column:?}");
        }
    }

    #[test]
    fn a_probe_without_a_value_leaves_its_cell_empty_and_survives_a_restart() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let probes = ["section".to_owned(), "length".to_owned()];
        let row = HistoryRow {
            time: 0.0,
            step: 0,
            dt: 0.0,
            energies: Energies::default(),
            extremes: Extremes {
                equivalent_plastic_strain: 0.0,
                jacobian_min: 1.0,
                jacobian_max: 1.0,
            },
            probes: &[f64::NAN, 2.0],
        };
        let mut history = HistoryWriter::create(&path, &probes).unwrap();
        history.append(&row).unwrap();
        let infinite = HistoryRow {
            probes: &[f64::INFINITY, 2.0],
            ..row
        };
        assert!(matches!(
            history.append(&infinite),
            Err(OutputError::NotFinite { .. })
        ));
        let broken = HistoryRow {
            dt: f64::NAN,
            ..row
        };
        assert!(matches!(
            history.append(&broken),
            Err(OutputError::NotFinite { .. })
        ));
        HistoryWriter::resume(&path, &probes, 0.0).unwrap();
        let table = read_table(&path).unwrap();
        assert_eq!(table.rows.len(), 1);
        assert!(table.column("section").unwrap()[0].is_nan());
        // Nothing has moved yet.
        assert!(table.column("kinetic_to_internal").unwrap()[0].is_nan());
        assert_eq!(table.column("length").unwrap(), [2.0]);
    }

    #[test]
    fn a_probe_may_not_take_the_name_of_a_column() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        assert!(matches!(
            HistoryWriter::create(&path, &["dt".to_owned()]),
            Err(OutputError::DuplicateName { .. })
        ));
    }
}
