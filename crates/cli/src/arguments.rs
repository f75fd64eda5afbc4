//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

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
    /// List what can be written in a case file: materials, kernels, shapes, units, ...
    List {
        /// Which list; without it, the lists there are
        what: Option<String>,
    },
    /// Print a shipped case as a commented template
    New {
        /// Which case; without it, the cases there are
        name: Option<String>,
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
    /// Print mistakes only
    #[arg(long)]
    pub(crate) quiet: bool,
    /// Replace the results of an earlier run in the same folder
    #[arg(long, conflicts_with = "resume")]
    pub(crate) force: bool,
    /// Continue an earlier run from its latest restart file
    #[arg(long)]
    pub(crate) resume: bool,
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
    fn overrides_split_at_the_first_equals_sign() {
        assert_eq!(
            key_value("a.b = x=1"),
            Ok(("a.b".to_owned(), "x=1".to_owned()))
        );
        assert!(key_value("a.b").is_err());
        assert!(key_value("=1").is_err());
    }
}
