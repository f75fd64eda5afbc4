//! The jstsph command: run, check and inspect total Lagrangian SPH simulations of metals.
//!
//! [`run`] is the whole program as a function: arguments in, text out, exit code back.
//!
//! ```
//! let (mut out, mut err) = (Vec::new(), Vec::new());
//! let code = jstsph_cli::run(["jstsph", "list", "kernels"], &mut out, &mut err);
//! assert_eq!(code, 0);
//! assert!(String::from_utf8(out)?.contains("quintic-spline"));
//!
//! let code = jstsph_cli::run(["jstsph", "run", "no-such-case.toml"], &mut Vec::new(), &mut err);
//! assert_eq!(code, 2);
//! assert!(String::from_utf8(err)?.starts_with("error: cannot read case file no-such-case.toml"));
//! # Ok::<(), std::string::FromUtf8Error>(())
//! ```
//!
//! Exit codes: 0 done, 1 the run failed, 2 the input is wrong, 130 interrupted (with a restart file
//! written).

mod arguments;
mod check;
mod console;
mod copies;
mod error;
mod frame;
mod interrupt;
mod list;
mod plot;
mod profile;
mod progress;
mod recorder;
mod report;
mod reproduce;
mod restart;
mod shells;
mod simulate;
mod stability;
mod sweep;
mod templates;
mod verdict;
mod writer;

use std::ffi::OsString;
use std::sync::atomic::AtomicBool;

use clap::Parser as _;

use arguments::{Arguments, Command};
use console::Console;

pub use console::Output;

/// Runs the program and returns its exit code. Ctrl-C and SIGTERM end a simulation in good order.
///
/// A progress bar is drawn only when the process's standard error is a terminal.
pub fn run<I>(arguments: I, stdout: &mut dyn Output, stderr: &mut dyn Output) -> u8
where
    I: IntoIterator,
    I::Item: Into<OsString> + Clone,
{
    run_until(arguments, stdout, stderr, interrupt::flag())
}

/// The same, ending a simulation in good order (exit code 130) once `interrupted` is set.
pub fn run_until<I>(
    arguments: I,
    stdout: &mut dyn Output,
    stderr: &mut dyn Output,
    interrupted: &AtomicBool,
) -> u8
where
    I: IntoIterator,
    I::Item: Into<OsString> + Clone,
{
    let words: Vec<OsString> = arguments.into_iter().map(Into::into).collect();
    let mut console = Console { stdout, stderr };
    let parsed = match Arguments::try_parse_from(&words) {
        Ok(parsed) => parsed,
        Err(error) if error.use_stderr() => {
            console.error(error.render());
            return 2;
        }
        // Help and version are asked for, not wrong.
        Err(error) => {
            console.print(error.render());
            return 0;
        }
    };
    let result = match parsed.command {
        Command::Run(options) => simulate::run(&options, &words, &mut console, interrupted),
        Command::Check(options) => check::run(&options, &mut console),
        Command::Plot(options) => plot::run(&options, &mut console),
        Command::Report(options) => report::run(&options, &mut console),
        Command::Reproduce(options) => reproduce::run(&options, &words, &mut console, interrupted),
        Command::List { markdown: true, .. } => {
            console.print(jstsph_case::markdown());
            Ok(0)
        }
        Command::List { what, .. } => list::run(what.as_deref(), &mut console),
        Command::Sweep(options) => sweep::run(&options, &words, &mut console, interrupted),
        Command::Schema => {
            console.print(jstsph_case::json_schema());
            Ok(0)
        }
        Command::Completions { shell } => shells::completions(shell, &mut console),
        Command::Man { folder } => shells::manual(folder.as_deref(), &mut console),
        Command::New { name } => templates::run(name.as_deref(), &mut console),
    };
    match result {
        Ok(code) => code,
        Err(error) => {
            console.error(format_args!("error: {error}\n"));
            error.exit_code()
        }
    }
}
