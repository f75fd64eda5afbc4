//! One run at a time in a results folder.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Seek, Write};
use std::path::Path;
use std::time::SystemTime;

use crate::{OutputError, iso8601};

/// Name of the lock file; it stays when the run ends, the lock on it does not.
pub(crate) const LOCK: &str = "run.lock";

/// The right to write into a results folder, until it is dropped or the process ends in any way.
///
/// A lock of the operating system on the open file, not the existence of the file: nothing is left
/// behind by a crash that someone has to clear away.
#[derive(Debug)]
pub(crate) struct FolderLock {
    _file: File,
}

impl FolderLock {
    /// Locks a folder and notes in the lock file who did.
    ///
    /// # Errors
    /// [`OutputError::FolderInUse`] while another run holds the lock, [`OutputError::Io`].
    ///
    /// # Limits
    /// A file system without locks (some network file systems) does not keep a second run away.
    pub(crate) fn acquire(folder: &Path) -> Result<Self, OutputError> {
        let path = folder.join(LOCK);
        let file = OpenOptions::new()
            .create(true)
            .truncate(false)
            .read(true)
            .write(true)
            .open(&path)
            .map_err(OutputError::io("write into", folder))?;
        let mut file = Self::lock(folder, file)?;
        let holder = format!(
            "process {} since {}",
            std::process::id(),
            iso8601(SystemTime::now())
        );
        file.set_len(0)
            .and_then(|()| file.rewind())
            .and_then(|()| file.write_all(holder.as_bytes()))
            .map_err(OutputError::io("write into", folder))?;
        Ok(Self { _file: file })
    }

    /// Fails while a run holds the lock of the folder; creates nothing.
    ///
    /// # Errors
    /// [`OutputError::FolderInUse`], [`OutputError::Io`].
    pub(crate) fn probe(folder: &Path) -> Result<(), OutputError> {
        match File::open(folder.join(LOCK)) {
            Ok(file) => Self::lock(folder, file).map(drop),
            // Without a lock file nobody holds it; what cannot be read is found when writing.
            Err(_) => Ok(()),
        }
    }

    fn lock(folder: &Path, file: File) -> Result<File, OutputError> {
        match file.try_lock() {
            Ok(()) => Ok(file),
            Err(TryLockError::WouldBlock) => Err(OutputError::FolderInUse {
                path: folder.to_path_buf(),
                holder: holder(folder),
            }),
            Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {
                Ok(file)
            }
            Err(TryLockError::Error(error)) => Err(OutputError::io("lock", folder)(error)),
        }
    }
}

/// Who holds the lock, as far as the lock file tells.
fn holder(folder: &Path) -> String {
    let text = std::fs::read_to_string(folder.join(LOCK)).unwrap_or_default();
    if text.starts_with("process ") {
        text
    } else {
        "another process".to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_is_refused_with_the_name_of_the_first_until_that_ends() {
        let folder = tempfile::tempdir().unwrap();
        FolderLock::probe(folder.path()).unwrap();
        assert!(!folder.path().join(LOCK).exists());
        let first = FolderLock::acquire(folder.path()).unwrap();
        let process = format!("process {} since 20", std::process::id());
        for result in [
            FolderLock::acquire(folder.path()).map(drop),
            FolderLock::probe(folder.path()),
        ] {
            let text = result.unwrap_err().to_string();
            assert!(text.contains(&process), "{text}");
        }
        drop(first);
        FolderLock::probe(folder.path()).unwrap();
        FolderLock::acquire(folder.path()).unwrap();
    }
}
