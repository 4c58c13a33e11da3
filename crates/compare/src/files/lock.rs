//! Locks on files of a folder, so that one process at a time writes them.
//!
//! ```
//! use skiagraph_compare::{files::lock::{STRESS, claim, wait_for}, sink::Silent};
//!
//! let folder = tempfile::tempdir()?;
//! let locked = wait_for(folder.path(), STRESS, &Silent)?;
//! assert!(claim(folder.path(), STRESS, &Silent)?.is_none(), "it is taken");
//! drop(locked);
//! assert!(claim(folder.path(), STRESS, &Silent)?.is_some());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{CompareError, Result};
use crate::sink::Sink;
use std::fs::{File, TryLockError};
use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::Duration;
use std::{io, thread};
use web_time::Instant;

/// Name of the lock file for stress.json, the results of one `skiagraph stress` command. The lock
/// is held to the end of the command. The lock file is never deleted, as that would let two
/// processes lock two files of this name.
pub const STRESS: &str = ".skiagraph-stress.lock";

/// A lock that this process holds until the value is dropped or the process ends. It locks nothing
/// on a file system without locks.
#[derive(Debug)]
pub struct Locked {
    /// Where the file system has no locks: nothing.
    _file: Option<File>,
}

/// How often another try is made.
const RETRY: Duration = Duration::from_millis(20);
/// After so long it is said that something is waited for.
const PATIENCE: Duration = Duration::from_secs(2);

/// Locks the lock file named `files` in `folder`, which must exist, and waits while another
/// process holds it. Tells the sink after two seconds of waiting.
///
/// # Errors
/// [`CompareError::Interrupted`] if the sink asks for an early end and the wait takes more than two
/// seconds; a lock file that cannot be created.
pub fn wait_for(folder: &Path, files: &str, sink: &dyn Sink) -> Result<Locked> {
    let began = Instant::now();
    let mut is_told = false;
    loop {
        if let Some(locked) = claim(folder, files, sink)? {
            return Ok(locked);
        }
        // Finished work is written after a stop, too, but the wait has an end.
        if sink.stop().load(Ordering::Relaxed) && began.elapsed() > PATIENCE {
            return Err(CompareError::interrupted());
        }
        if began.elapsed() > PATIENCE && !is_told {
            sink.note(&format!(
                "waiting for another skiagraph that writes into {}",
                folder.display()
            ));
            is_told = true;
        }
        thread::sleep(RETRY);
    }
}

/// Locks the lock file named `files` in `folder`, which must exist, without waiting; `None` if it
/// is held already, by this process or another. Tells the sink if the file system has no locks.
///
/// # Errors
/// The lock file cannot be created or locked.
pub fn claim(folder: &Path, files: &str, sink: &dyn Sink) -> Result<Option<Locked>> {
    let path = folder.join(files);
    let mut options = File::options();
    options.create(true).truncate(false).write(true);
    let opened = options.open(&path);
    let file = opened.map_err(|error| CompareError::write(&path, error))?;
    match file.try_lock() {
        Ok(()) => Ok(Some(Locked { _file: Some(file) })),
        Err(TryLockError::WouldBlock) => Ok(None),
        Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {
            sink.note(&format!(
                "{} cannot be locked: let one command at a time write into it",
                folder.display()
            ));
            Ok(Some(Locked { _file: None }))
        }
        Err(TryLockError::Error(error)) => Err(CompareError::write(&path, error)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sink::Silent;

    #[test]
    fn one_has_the_files_until_it_lets_go() {
        let folder = tempfile::tempdir().unwrap();
        let claim = |files| claim(folder.path(), files, &Silent).unwrap();
        let first = claim(STRESS);
        assert!(first.is_some());
        assert!(claim(STRESS).is_none());
        assert!(claim(".a.truth.lock").is_some(), "files of their own");
        drop(first);
        assert!(claim(STRESS).is_some());
        let nowhere = folder.path().join("nowhere");
        let error = super::claim(&nowhere, STRESS, &Silent).unwrap_err();
        assert!(error.to_string().contains("nowhere"), "{error}");
    }
}
