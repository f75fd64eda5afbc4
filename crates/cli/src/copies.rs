//! The case of a run in its results folder, with all that is needed to run it again.

use jstsph_case::Case;
use jstsph_output::{OutputError, ResultsFolder, atomic_write};

/// Writes copies of the files that a case reads, the resolved case, and the case as it was written.
pub(crate) fn write(folder: &ResultsFolder, case: &Case) -> Result<(), OutputError> {
    for input in &case.inputs {
        folder.write_input(&input.name, &input.bytes)?;
    }
    let original = case.original_with_copies(ResultsFolder::INPUTS);
    atomic_write(&folder.case(), |writer| {
        writer.write_all(resolved(case).as_bytes())
    })?;
    atomic_write(&folder.original_case(), |writer| {
        writer.write_all(original.as_bytes())
    })
}

/// The resolved case as it stands in the results folder.
pub(crate) fn resolved(case: &Case) -> String {
    case.resolved_with_copies(ResultsFolder::INPUTS)
}
