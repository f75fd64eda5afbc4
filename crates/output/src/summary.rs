//! The result of a run in a few numbers: `summary.json`.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::OutputError;
use crate::json::{null_as_nan, nulls_as_nan, read_json, write_json};

/// File name in the results folder.
pub(crate) const SUMMARY: &str = "summary.json";

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// The end time was reached.
    Completed,
    /// The run broke down; the warnings say why.
    Failed,
    /// The user stopped it; a restart file was written.
    Interrupted,
}

/// Energies of the whole system at one instant, J (of 1 m thickness in two dimensions).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Energies {
    /// Energy of motion.
    #[serde(deserialize_with = "null_as_nan")]
    pub kinetic: f64,
    /// Energy stored in elastic strain.
    #[serde(deserialize_with = "null_as_nan")]
    pub elastic: f64,
    /// Work turned into heat by plastic flow.
    #[serde(deserialize_with = "null_as_nan")]
    pub plastic: f64,
    /// Energy removed by the numerical dissipation.
    #[serde(deserialize_with = "null_as_nan")]
    pub numerical: f64,
    /// Energy of the control of spurious modes.
    #[serde(deserialize_with = "null_as_nan")]
    pub hourglass: f64,
    /// Work done on the body by loads and prescribed motion.
    #[serde(deserialize_with = "null_as_nan")]
    pub external: f64,
    /// Work done on the body by obstacles.
    #[serde(deserialize_with = "null_as_nan")]
    pub contact: f64,
    /// Energy dissipated by friction at obstacles; zero in files of versions without friction.
    #[serde(default, deserialize_with = "null_as_nan")]
    pub friction: f64,
    /// Defect of the energy balance as a fraction of the largest energy (not in J); zero for an exact
    /// balance.
    #[serde(deserialize_with = "null_as_nan")]
    pub balance: f64,
}

impl Energies {
    /// Kinetic over internal (elastic and plastic) energy: below a few percent a process is slow, and
    /// its forces are those of equilibrium. NaN while there is no internal energy.
    #[must_use]
    pub fn kinetic_to_internal(&self) -> f64 {
        let internal = self.elastic + self.plastic;
        if internal > 0.0 {
            self.kinetic / internal
        } else {
            f64::NAN
        }
    }
}

/// Extremes over all particles at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Extremes {
    /// Largest equivalent plastic strain.
    #[serde(deserialize_with = "null_as_nan")]
    pub equivalent_plastic_strain: f64,
    /// Smallest volume ratio J.
    #[serde(deserialize_with = "null_as_nan")]
    pub jacobian_min: f64,
    /// Largest volume ratio J.
    #[serde(deserialize_with = "null_as_nan")]
    pub jacobian_max: f64,
}

impl Default for Extremes {
    /// The undeformed body.
    fn default() -> Self {
        Self {
            equivalent_plastic_strain: 0.0,
            jacobian_min: 1.0,
            jacobian_max: 1.0,
        }
    }
}

/// The numbers of a finished run, in SI units; the fields are written in this order.
///
/// A number that is not finite, such as an extreme of a run that broke down, is written as `null`
/// and read back as NaN.
///
/// ```
/// # fn main() -> Result<(), jstsph_output::OutputError> {
/// use jstsph_output::{Status, Summary};
///
/// let folder = tempfile::tempdir().unwrap();
/// let mut summary = Summary::new("taylor", Status::Completed);
/// summary.particles = 4131;
/// summary.probes.insert("base_radius".to_owned(), 6.98e-3);
/// summary.write(folder.path())?;
/// assert_eq!(Summary::read(folder.path())?, summary);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Name of the case.
    pub case: String,
    /// Version of the program.
    pub version: String,
    /// How the run ended.
    pub status: Status,
    /// Number of particles.
    pub particles: u64,
    /// Number of points at which the material is evaluated.
    pub points: u64,
    /// Average number of neighbours of a particle.
    #[serde(deserialize_with = "null_as_nan")]
    pub neighbours_per_particle: f64,
    /// Steps done.
    pub steps: u64,
    /// Simulated time, s.
    #[serde(deserialize_with = "null_as_nan")]
    pub simulated_time: f64,
    /// Wall-clock time of the time loop, s.
    #[serde(deserialize_with = "null_as_nan")]
    pub wall_seconds: f64,
    /// Particles times steps over wall-clock time, 1/s.
    #[serde(deserialize_with = "null_as_nan")]
    pub particle_steps_per_second: f64,
    /// Energies at the end.
    pub energies: Energies,
    /// [`Energies::kinetic_to_internal`] at the end; none without internal energy, and in files of
    /// versions without it.
    #[serde(default)]
    pub kinetic_to_internal: Option<f64>,
    /// Extremes at the end.
    pub extremes: Extremes,
    /// Lattice cells turned inside out at the end.
    pub inverted_cells: u64,
    /// Last value of each probe, SI units.
    #[serde(deserialize_with = "nulls_as_nan")]
    pub probes: BTreeMap<String, f64>,
    /// What the user should know about this run.
    pub warnings: Vec<String>,
}

impl Summary {
    /// A summary of a run that did nothing yet, with the version of this crate.
    pub fn new(case: impl Into<String>, status: Status) -> Self {
        Self {
            case: case.into(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            status,
            particles: 0,
            points: 0,
            neighbours_per_particle: 0.0,
            steps: 0,
            simulated_time: 0.0,
            wall_seconds: 0.0,
            particle_steps_per_second: 0.0,
            energies: Energies::default(),
            kinetic_to_internal: None,
            extremes: Extremes::default(),
            inverted_cells: 0,
            probes: BTreeMap::new(),
            warnings: Vec::new(),
        }
    }

    /// Writes `summary.json` into `folder`, atomically.
    ///
    /// # Errors
    /// [`OutputError::Io`].
    pub fn write(&self, folder: &Path) -> Result<(), OutputError> {
        write_json(&folder.join(SUMMARY), self)
    }

    /// Reads `summary.json` of `folder`.
    ///
    /// # Errors
    /// [`OutputError::Io`], [`OutputError::Json`].
    pub fn read(folder: &Path) -> Result<Self, OutputError> {
        read_json(&folder.join(SUMMARY))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_the_fields_is_fixed() {
        let folder = tempfile::tempdir().unwrap();
        Summary::new("taylor", Status::Interrupted)
            .write(folder.path())
            .unwrap();
        let text = std::fs::read_to_string(folder.path().join(SUMMARY)).unwrap();
        let keys: Vec<&str> = text
            .lines()
            .filter_map(|line| line.trim().strip_prefix('"')?.split('"').next())
            .collect();
        assert_eq!(
            keys,
            [
                "case",
                "version",
                "status",
                "particles",
                "points",
                "neighbours_per_particle",
                "steps",
                "simulated_time",
                "wall_seconds",
                "particle_steps_per_second",
                "energies",
                "kinetic",
                "elastic",
                "plastic",
                "numerical",
                "hourglass",
                "external",
                "contact",
                "friction",
                "balance",
                "kinetic_to_internal",
                "extremes",
                "equivalent_plastic_strain",
                "jacobian_min",
                "jacobian_max",
                "inverted_cells",
                "probes",
                "warnings",
            ]
        );
        assert!(text.contains("\"status\": \"interrupted\""), "{text}");
    }

    #[test]
    fn kinetic_energy_is_compared_with_what_the_material_took_up() {
        let energies = Energies {
            kinetic: 1.0,
            elastic: 2.0,
            plastic: 18.0,
            numerical: 100.0,
            ..Energies::default()
        };
        assert_eq!(energies.kinetic_to_internal(), 0.05);
        assert!(Energies::default().kinetic_to_internal().is_nan());
    }

    #[test]
    fn a_number_that_is_not_finite_is_null_and_comes_back_as_nan() {
        let folder = tempfile::tempdir().unwrap();
        let mut summary = Summary::new("broken", Status::Failed);
        summary.energies.kinetic = f64::INFINITY;
        summary.probes.insert("radius".to_owned(), f64::NAN);
        summary.probes.insert("length".to_owned(), 0.1 + 0.2);
        summary.write(folder.path()).unwrap();
        let text = std::fs::read_to_string(folder.path().join(SUMMARY)).unwrap();
        assert!(text.contains("\"kinetic\": null"), "{text}");
        assert!(text.contains("\"radius\": null"), "{text}");
        let read = Summary::read(folder.path()).unwrap();
        assert!(read.energies.kinetic.is_nan() && read.probes["radius"].is_nan());
        assert_eq!(read.probes["length"], 0.1 + 0.2);
    }

    #[test]
    fn a_damaged_file_is_an_error_with_its_place() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(SUMMARY), "{\n\"case\": 3}").unwrap();
        let text = Summary::read(folder.path()).unwrap_err().to_string();
        assert!(
            text.contains("summary.json") && text.contains("line 2"),
            "{text}"
        );
    }
}
