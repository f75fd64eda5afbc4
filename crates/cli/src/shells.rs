//! `jstsph completions` and `jstsph man`.

use std::path::Path;

use clap::CommandFactory as _;
use clap_complete::Shell;
use clap_mangen::Man;

use crate::arguments::Arguments;
use crate::console::Console;
use crate::error::CliError;

/// Prints the completions of a shell.
pub(crate) fn completions(shell: Shell, console: &mut Console<'_>) -> Result<u8, CliError> {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "jstsph", &mut text);
    console.print(String::from_utf8_lossy(&text));
    Ok(0)
}

/// Writes `jstsph.1`, `jstsph-run.1`, ... or prints the first.
pub(crate) fn manual(folder: Option<&Path>, console: &mut Console<'_>) -> Result<u8, CliError> {
    let mut command = Arguments::command();
    command.build();
    let Some(folder) = folder else {
        let mut text = Vec::new();
        Man::new(command)
            .render(&mut text)
            .map_err(|source| CliError::Unwritable {
                path: "the manual page".into(),
                source,
            })?;
        console.print(String::from_utf8_lossy(&text));
        return Ok(0);
    };
    std::fs::create_dir_all(folder)
        .and_then(|()| clap_mangen::generate_to(command, folder))
        .map_err(|source| CliError::Unwritable {
            path: folder.to_path_buf(),
            source,
        })?;
    console.print(format_args!(
        "wrote the manual pages to {}\n",
        folder.display()
    ));
    Ok(0)
}
