//! Files that are either complete or not there.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use crate::OutputError;

/// Prefix and suffix of the temporary files, so that those left by a killed run can be recognised.
const TEMPORARY: (&str, &str) = (".jstsph-", ".tmp");

/// Writes a file so that a reader, or a crash at any moment, sees the old content or the new one.
///
/// A temporary file in the same folder is written, flushed and synchronised to disk, renamed over
/// `path`, and the folder is synchronised. If `write` fails nothing changes and the temporary
/// file is removed.
///
/// # Errors
/// [`OutputError::Io`] naming `path` and the system's cause: folder missing, permission, disk full.
///
/// # Limits
/// The folder is synchronised on Unix only. A symbolic link at `path` is replaced, not followed.
pub fn atomic_write(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), OutputError> {
    atomic_file(path, |file| {
        write(file).map_err(OutputError::io("write", path))
    })
}

/// [`atomic_write`] for those who come back to an earlier place of the file.
///
/// # Errors
/// Those of `write` and of [`atomic_write`].
pub(crate) fn atomic_file(
    path: &Path,
    write: impl FnOnce(&mut TemporaryFile) -> Result<(), OutputError>,
) -> Result<(), OutputError> {
    let failed = OutputError::io("write", path);
    let mut writer = match temporary(path) {
        Ok(file) => BufWriter::new(file),
        Err(error) => return Err(failed(error)),
    };
    write(&mut writer)?;
    persist(writer, path).map_err(failed)
}

/// A file that is not yet where it is going to be.
pub(crate) type TemporaryFile = BufWriter<tempfile::NamedTempFile>;

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

fn temporary(path: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut temporary = tempfile::Builder::new();
    temporary.prefix(TEMPORARY.0).suffix(TEMPORARY.1);
    // Temporary files are private by default; results get the permissions of any new file.
    #[cfg(unix)]
    let public = std::os::unix::fs::PermissionsExt::from_mode(0o666);
    #[cfg(unix)]
    temporary.permissions(public);

    temporary.tempfile_in(folder_of(path))
}

fn persist(writer: TemporaryFile, path: &Path) -> io::Result<()> {
    let temporary = writer.into_inner().map_err(|error| error.into_error())?;
    temporary.as_file().sync_all()?;
    temporary.persist(path).map_err(|error| error.error)?;
    #[cfg(unix)]
    File::open(folder_of(path))?.sync_all()?;
    Ok(())
}

/// Whether a file name is that of a temporary file of [`atomic_write`].
pub(crate) fn is_temporary(name: &str) -> bool {
    name.starts_with(TEMPORARY.0) && name.ends_with(TEMPORARY.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        std::fs::read_dir(folder)
            .unwrap()
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect()
    }

    #[test]
    fn a_failing_closure_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        atomic_write(&path, |w| w.write_all(b"old")).unwrap();
        let error = atomic_write(&path, |w| {
            w.write_all(b"half of the new")?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        })
        .unwrap_err();
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["a.txt"]);
        let text = error.to_string();
        assert!(
            text.contains("a.txt") && text.contains("no storage space"),
            "{text}"
        );
    }

    #[test]
    fn an_existing_file_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        std::fs::write(&path, "something longer than the new content").unwrap();
        atomic_write(&path, |w| w.write_all(b"new")).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn a_missing_folder_is_an_error_that_names_the_path() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("missing").join("a.txt");
        let error = atomic_write(&path, |_| Ok(())).unwrap_err();
        assert!(error.to_string().contains("missing"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn files_are_as_readable_as_any_new_file() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (ours, plain) = (folder.path().join("a"), folder.path().join("b"));
        atomic_write(&ours, |_| Ok(())).unwrap();
        std::fs::write(&plain, "").unwrap();
        let mode = |p: &Path| std::fs::metadata(p).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }
}
