//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use jstsph_case::units::{Measure, UnitError, parse_quantity};

/// Total Lagrangian SPH for metals under extreme deformation.
#[derive(Debug, Parser)]
#[command(
    name = "jstsph",
    version,
    after_help = "Start with `jstsph list cases`, then `jstsph new NAME > my-case.toml`."
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run a case and write its results
    Run(RunOptions),
    /// Check a case and say what would run; writes nothing
    Check(CheckOptions),
    /// Draw the results of a run: the body coloured by a field, or curves over time
    Plot(PlotOptions),
    /// Write one HTML file with the numbers, curves and an interactive view of a run
    Report(ReportOptions),
    /// Run every case of a published study and compare with what it reports
    Reproduce(ReproduceOptions),
    /// List what can be written in a case file: materials, kernels, shapes, units, ...
    List {
        /// Which list; without it, the lists there are
        what: Option<String>,
        /// Print all lists as the page `docs/guide/keys.md`
        #[arg(long, hide = true, conflicts_with = "what")]
        markdown: bool,
    },
    /// Print a shipped case as a commented template
    New {
        /// Which case; without it, the cases there are
        name: Option<String>,
    },
    /// Run a case for every combination of values of some keys, and compare
    Sweep(SweepOptions),
    /// Print the JSON Schema of case files, with which editors complete and check them
    Schema,
    /// Print completions for a shell
    Completions {
        /// Which shell
        shell: clap_complete::Shell,
    },
    /// Write manual pages
    Man {
        /// Folder for the pages of the program and its commands; without it, the program's page is printed
        folder: Option<PathBuf>,
    },
}

/// Options of `run`.
#[derive(Debug, Args)]
pub(crate) struct RunOptions {
    /// Case file
    pub(crate) case: PathBuf,
    /// Folder for the results [default: results/NAME-OF-THE-CASE]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Threads [default: 1 below 20,000 evaluation points, else all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) threads: Option<u16>,
    /// Override a key of the case, e.g. time.end="10 ms" or body.billet.lattice.counts=[4,22]; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    pub(crate) overrides: Vec<(String, String)>,
    /// Do not draw final.png and energies.png at the end
    #[arg(long)]
    pub(crate) no_pictures: bool,
    /// Print mistakes only
    #[arg(long)]
    pub(crate) quiet: bool,
    /// Print at the end where the time went, per phase of a step
    #[arg(long)]
    pub(crate) profile: bool,
    /// Replace the results of an earlier run in the same folder
    #[arg(long, conflicts_with = "resume")]
    pub(crate) force: bool,
    /// Continue an earlier run from its latest restart file
    #[arg(long)]
    pub(crate) resume: bool,
}

/// Options of `sweep`.
#[derive(Debug, Args)]
pub(crate) struct SweepOptions {
    /// Case file
    pub(crate) case: PathBuf,
    /// Key and its values, separated by commas, or by semicolons where values contain commas: lattice.counts="[4,22];[6,36]"; may be repeated
    #[arg(long = "vary", value_name = "KEY=VALUES", value_parser = key_value, required = true)]
    pub(crate) vary: Vec<(String, String)>,
    /// Override a key of the case in every run; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    pub(crate) overrides: Vec<(String, String)>,
    /// Runs at the same time, each with one thread [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) jobs: Option<u16>,
    /// Folder for table, plot and runs [default: results/sweep-NAME-OF-THE-CASE]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Probe to draw against the first key [default: the first probe of the case]
    #[arg(long, value_name = "NAME")]
    pub(crate) probe: Option<String>,
}

/// Options of `check`.
#[derive(Debug, Args)]
pub(crate) struct CheckOptions {
    /// Case file
    pub(crate) case: PathBuf,
    /// Threads for the estimate of the run time [default: as in `run`]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) threads: Option<u16>,
    /// Override a key of the case; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    pub(crate) overrides: Vec<(String, String)>,
    /// Print the resolved case, every default written out, instead of the estimate
    #[arg(long)]
    pub(crate) resolved: bool,
    /// Draw the set-up, with conditions and obstacles, to this file, .png or .svg
    #[arg(long, value_name = "FILE")]
    pub(crate) draw: Option<PathBuf>,
    /// Direction of view of the drawing [default: xy in plane strain, oblique in 3d]
    #[arg(long, value_enum, requires = "draw")]
    pub(crate) view: Option<ViewName>,
}

/// Options of `plot`.
#[derive(Debug, Args)]
pub(crate) struct PlotOptions {
    /// Folder with the results of a run; several are drawn side by side, or as curves in one diagram
    #[arg(value_name = "OUT_DIR", required = true)]
    pub(crate) results: Vec<PathBuf>,
    /// Field, component (velocity_y, cauchy_stress_xy) or magnitude (velocity) to colour the body by [default: equivalent_plastic_strain]
    #[arg(long, value_name = "NAME")]
    pub(crate) field: Option<String>,
    /// Time such as "40 ms", first or last; several, separated by commas, are drawn side by side [default: last]
    #[arg(long = "time", value_name = "TIME", value_delimiter = ',')]
    pub(crate) times: Vec<String>,
    #[command(flatten)]
    pub(crate) look: Look,
    /// Draw curves over time instead: energies, balance, time_step, probes, or columns of history.csv, rate(COLUMN) and line probes separated by commas
    #[arg(long, value_name = "WHAT", conflicts_with_all = ["field", "times", "range", "view", "section"])]
    pub(crate) history: Option<String>,
    #[command(flatten)]
    pub(crate) curves: CurveLook,
    /// Name of a run in the picture, one for each OUT_DIR in their order [default: the folders]
    #[arg(long = "label", value_name = "NAME", conflicts_with = "animate")]
    pub(crate) labels: Vec<String>,
    /// Title of the picture, "" for none [default: the title of the case]
    #[arg(long, value_name = "TEXT")]
    pub(crate) title: Option<String>,
    /// Write every frame of one run to an animation, .gif or .png (APNG)
    #[arg(long, value_name = "FILE", conflicts_with_all = ["history", "times", "output"])]
    pub(crate) animate: Option<PathBuf>,
    /// Pixels per inch of a PNG file: less for small files, 300 or more for print [default: 192]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(24..=1200), conflicts_with = "animate")]
    pub(crate) dpi: Option<u16>,
    /// File to write, .png or .svg [default: OUT_DIR/NAME-TIME.png]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

/// Options of `report`.
#[derive(Debug, Args)]
pub(crate) struct ReportOptions {
    /// Folder with the results of a run
    #[arg(value_name = "OUT_DIR")]
    pub(crate) results: PathBuf,
    /// File to write [default: OUT_DIR/report.html]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

/// Options of `reproduce`.
#[derive(Debug, Args)]
pub(crate) struct ReproduceOptions {
    /// Which study; without it, the studies there are
    pub(crate) study: Option<String>,
    /// Folder for runs and page [default: results/reproduce-STUDY, with -quick after it for --quick]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Coarse resolutions: minutes instead of an hour
    #[arg(long)]
    pub(crate) quick: bool,
    /// Threads of each run [default: 1 below 20,000 evaluation points, else all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) threads: Option<u16>,
    /// Only these runs of the study; the others are reported as not run unless finished earlier
    #[arg(long, value_name = "RUN", value_delimiter = ',')]
    pub(crate) only: Vec<String>,
    /// Also reuse finished runs of the same case that another version of the program made
    #[arg(long)]
    pub(crate) any_version: bool,
    /// Run nothing: print the page, as Markdown, of an earlier reproduction.json
    #[arg(long, value_name = "FILE", conflicts_with_all = ["out", "quick", "threads", "only", "any_version"])]
    pub(crate) from: Option<PathBuf>,
}

/// How a body is shown.
#[derive(Debug, Default, Args)]
pub(crate) struct Look {
    /// Values of the first and the last colour, in SI units or with a unit: 0,0.5 or "0 MPa,400 MPa" [default: those of the field]
    #[arg(long, value_name = "FROM,TO", value_parser = value_range, allow_hyphen_values = true)]
    pub(crate) range: Option<ValueRange>,
    /// Direction of view [default: xy in plane strain; a solid is cut through its middle]
    #[arg(long, value_enum)]
    pub(crate) view: Option<ViewName>,
    /// Cut a solid through its middle
    #[arg(long)]
    pub(crate) section: bool,
}

/// How curves are shown.
#[derive(Debug, Default, Args)]
pub(crate) struct CurveLook {
    /// Draw over this column of history.csv instead of over time
    #[arg(long, value_name = "COLUMN", requires = "history")]
    pub(crate) over: Option<String>,
    /// Draw one point per run, against this number of summary.json: particles, wall_seconds, ...; runs of one label become a curve
    #[arg(
        long,
        value_name = "NUMBER",
        requires = "history",
        conflicts_with = "over"
    )]
    pub(crate) against: Option<String>,
    /// Time such as "35 ms" of the points of --against and of line probes [default: the last]
    #[arg(long, value_name = "TIME", requires = "history", value_parser = time)]
    pub(crate) at: Option<f64>,
    /// Draw the running mean over this time, such as "0.5 ms"
    #[arg(long, value_name = "TIME", requires = "history", value_parser = time)]
    pub(crate) smooth: Option<f64>,
    /// Logarithmic axes; points that are not positive are left out
    #[arg(long, value_enum, value_name = "AXES", requires = "history")]
    pub(crate) log: Option<LogAxes>,
}

/// Which axes are logarithmic.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum LogAxes {
    /// The horizontal one
    X,
    /// The vertical one
    Y,
    /// Both
    Xy,
}

fn time(text: &str) -> Result<f64, String> {
    match parse_quantity(text) {
        Ok((time, Measure::TIME)) => Ok(time),
        Ok((_, measure)) => Err(format!("it is {}", measure.description())),
        Err(UnitError::NoUnit { number, .. }) => number
            .parse()
            .map_err(|_| format!("`{number}` is not a number")),
        Err(error) => Err(error.to_string()),
    }
}

/// Plane of the picture, first axis to the right, second up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ViewName {
    /// Seen against z
    Xy,
    /// Seen along y
    Xz,
    /// Seen against x
    Yz,
    /// From above and aside
    Oblique,
}

/// Two values with the dimension of their unit, if they have one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ValueRange {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) measures: [Option<Measure>; 2],
}

fn value_range(text: &str) -> Result<ValueRange, String> {
    let value = |text: &str| match parse_quantity(text) {
        Ok((value, measure)) => Ok((value, Some(measure))),
        Err(UnitError::NoUnit { number, .. }) => number
            .parse()
            .map(|value| (value, None))
            .map_err(|_| format!("`{number}` is not a number")),
        Err(error) => Err(error.to_string()),
    };
    let (from, to) = text
        .split_once(',')
        .ok_or("write two values with a comma between, e.g. 0,0.5")?;
    let [(from, first), (to, second)] = [value(from)?, value(to)?];
    if from >= to {
        return Err("the first value must be smaller than the second".to_owned());
    }
    Ok(ValueRange {
        from,
        to,
        measures: [first, second],
    })
}

fn key_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => {
            Ok((key.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("write KEY=VALUE, e.g. time.end=\"10 ms\"".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory as _;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn ranges_are_two_ascending_values_with_or_without_unit() {
        let range = value_range("-1 MPa, 2e6").expect("a range");
        assert_eq!((range.from, range.to), (-1e6, 2e6));
        assert_eq!(range.measures, [Some(Measure::STRESS), None]);
        for wrong in ["1", "2,1", "a,b", "1 Mpa,2 MPa"] {
            assert!(value_range(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn times_have_a_unit_or_are_seconds() {
        assert_eq!(time("0.5 ms"), Ok(0.5e-3));
        assert_eq!(time("2e-3"), Ok(2e-3));
        assert!(time("1 mm").unwrap_err().contains("length"));
    }

    #[test]
    fn overrides_split_at_the_first_equals_sign() {
        assert_eq!(
            key_value("a.b = x=1"),
            Ok(("a.b".to_owned(), "x=1".to_owned()))
        );
        assert!(key_value("a.b").is_err());
        assert!(key_value("=1").is_err());
    }
}
