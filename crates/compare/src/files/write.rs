//! Writes files whole or not at all, and checks in advance that they can be written.
//!
//! ```
//! use skiagraph_compare::files::write::{check_writable, write_new, write_whole};
//!
//! let folder = tempfile::tempdir()?;
//! let csv = folder.path().join("results.csv");
//! check_writable(&[("--csv".into(), &csv)])?;
//! write_whole(&csv, b"preset,wrong\n")?;
//! assert!(!write_new(&csv, b"")?, "it is there");
//! assert!(check_writable(&[("--csv".into(), &csv), ("--json".into(), &csv)]).is_err());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{CompareError, Result};
use std::io::{self, Write};
use std::path::{Component, Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::{fs, mem};

/// Checks, before anything runs, that files can be written: their folders exist and are writable,
/// and no two files are the same. Each item is a file with the name of the option or work that
/// writes it, such as `--csv`, for messages.
///
/// # Errors
/// Names the two writers of one file, or the file that cannot be written and the reason.
pub fn check_writable(files: &[(String, &Path)]) -> Result<()> {
    let place = |file: &Path| -> PathBuf {
        let parts = file.components();
        parts.filter(|part| *part != Component::CurDir).collect()
    };
    for (index, (writer, file)) in files.iter().enumerate() {
        let is_same = |(_, other): &&(String, &Path)| place(other) == place(file);
        if let Some((other, _)) = files[..index].iter().find(is_same) {
            return Err(CompareError::Request(format!(
                "{other} and {writer} both write {}; give each a file of its own",
                file.display()
            )));
        }
        let folder = folder_of(file);
        let why = if folder.is_dir() {
            file.is_dir().then(|| "it is a folder".to_owned())
        } else {
            Some(format!("there is no folder {}", folder.display()))
        };
        if let Some(why) = why {
            let file = file.display();
            let message = format!("{writer}: cannot write {file}: {why}");
            return Err(CompareError::Input(message));
        }
        if is_replaced(file) {
            try_out(folder).map_err(|error| CompareError::write(file, error))?;
        }
    }
    Ok(())
}

/// Creates a folder if it is missing, and checks with a temporary file that files can be created in
/// it.
///
/// # Errors
/// The folder cannot be created, or no file can be created in it.
pub fn check_folder(folder: &Path) -> Result<()> {
    let made = fs::create_dir_all(folder).and_then(|()| try_out(folder));
    made.map_err(|error| CompareError::write(folder, error))
}

/// Writes a few bytes into a folder and takes them away again: permissions alone do not say whether
/// that works, and a full disk has room for an empty file.
fn try_out(folder: &Path) -> io::Result<()> {
    beside(&folder.join("a"))?.write_all(&[0; 4096])
}

/// True if a path holds a file, or nothing yet. Devices and pipes (`/dev/stdout`) are written into;
/// a file in their place would take them away from all other processes.
fn is_replaced(path: &Path) -> bool {
    fs::metadata(path).map_or(true, |metadata| metadata.is_file())
}

/// Returns the folder that a file is in; `.` for a bare name.
pub(crate) fn folder_of(file: &Path) -> &Path {
    match file.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    }
}

/// A new file in the same folder, of a name that nothing has.
fn beside(path: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    // Temporary files are private by default; a result should be as readable as any file the user
    // makes.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut unfinished = unfinished();
    let file = builder.prefix(".skiagraph-").tempfile_in(folder_of(path))?;
    unfinished.retain(|path| path.exists());
    unfinished.push(file.path().to_owned());
    Ok(file)
}

/// The temporary files that were made, as far as they may be there yet.
fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the temporary files of all files that are being written, and lets no further one begin:
/// for a process that ends at once, in the middle of work.
pub fn remove_unfinished() {
    let files = unfinished();
    for file in &*files {
        let _ = fs::remove_file(file);
    }
    mem::forget(files);
}

/// Writes a file whole or not at all. It writes a temporary file beside `path` and renames it to
/// `path`, so that an interrupted write leaves the old file. Devices and pipes are written
/// directly.
///
/// # Errors
/// The file cannot be written.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    let write = || -> io::Result<()> {
        if !is_replaced(path) {
            return fs::write(path, bytes);
        }
        // A link stays what it is; the file behind it is replaced.
        let path = &fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
        let mut file = beside(path)?;
        file.write_all(bytes)?;
        file.persist(path)?;
        Ok(())
    };
    write().map_err(|error| CompareError::write(path, error))
}

/// Writes a file whole or not at all, in place of one of that name. It is on the disk before it has
/// its name, so that not even a machine that loses its power leaves a part.
///
/// # Errors
/// The file cannot be written.
pub fn write_durable(path: &Path, bytes: &[u8]) -> Result<()> {
    let written = durable(path, bytes).and_then(|file| Ok(file.persist(path)?));
    written.map_err(|error| CompareError::write(path, error))?;
    Ok(())
}

/// Writes a file as [`write_durable`] does, unless a file of that name exists. Returns true if the
/// file was written, false if the name was in use.
///
/// # Errors
/// The file cannot be written.
pub fn write_new(path: &Path, bytes: &[u8]) -> Result<bool> {
    let failed = |error| CompareError::write(path, error);
    let file = durable(path, bytes).map_err(failed)?;
    match file.persist_noclobber(path) {
        Ok(_) => Ok(true),
        Err(kept) if kept.error.kind() == io::ErrorKind::AlreadyExists => Ok(false),
        Err(kept) => Err(failed(kept.error)),
    }
}

/// A file beside `path` that is on the disk, and has no name of its own yet.
fn durable(path: &Path, bytes: &[u8]) -> io::Result<tempfile::NamedTempFile> {
    let mut file = beside(path)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_clash_or_have_no_folder_are_refused_beforehand() {
        let check = |files: &[&'static str]| {
            let files: Vec<_> = files
                .iter()
                .map(|file| (format!("--{file}"), Path::new(*file)))
                .collect();
            check_writable(&files)
        };
        check(&["a", "b", "./c"]).unwrap();
        let clash = check(&["a", "./a"]).unwrap_err();
        assert!(matches!(clash, CompareError::Request(_)));
        assert!(clash.to_string().starts_with("--a and --./a both write"));
        let nowhere = check(&["nowhere/at/all.json"]).unwrap_err().to_string();
        assert!(
            nowhere.ends_with("there is no folder nowhere/at"),
            "{nowhere}"
        );
    }

    #[test]
    fn a_file_is_replaced_whole_and_a_bad_path_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_whole(&path, b"old and long").unwrap();
        write_whole(&path, b"new").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        assert_eq!(
            std::fs::read_dir(folder.path()).unwrap().count(),
            1,
            "no temporary file stays"
        );
        assert!(!write_new(&path, b"newer").unwrap());
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        assert!(write_new(&folder.path().join("b.txt"), b"b").unwrap());
        let missing = folder.path().join("missing").join("a.txt");
        assert!(
            write_whole(&missing, b"x")
                .unwrap_err()
                .to_string()
                .contains("a.txt")
        );
    }
}
