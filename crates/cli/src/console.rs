//! Where text goes.

use std::fmt::Display;
use std::io::Write;

/// Something text can be written to from the thread of the time loop.
pub trait Output: Write + Send {}

impl<T: Write + Send> Output for T {}

/// Standard output for results, standard error for progress and mistakes.
///
/// Write errors are ignored: a reader who closes the pipe does not want the rest.
pub(crate) struct Console<'a> {
    pub(crate) stdout: &'a mut dyn Output,
    pub(crate) stderr: &'a mut dyn Output,
}

impl Console<'_> {
    /// Writes a result.
    pub(crate) fn print(&mut self, text: impl Display) {
        let _ = write!(self.stdout, "{text}");
        let _ = self.stdout.flush();
    }

    /// Writes progress or a mistake.
    pub(crate) fn error(&mut self, text: impl Display) {
        let _ = write!(self.stderr, "{text}");
        let _ = self.stderr.flush();
    }
}
