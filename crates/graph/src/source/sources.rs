//! Stores that documents, shaders and pictures are read from.

use crate::picture::Picture;
use std::{io::Read, path::PathBuf, sync::Arc};

/// A store of RON documents, WGSL files and pictures: a folder, embedded files, or a host's own.
///
/// Paths have forward slashes and are relative to the store (`pipelines/nsm.ron`,
/// `shaders/shared/camera.wgsl`), or absolute.
pub trait Sources: Send + Sync {
    /// Reads the text of the document or shader file at `path`; `Ok(None)` if the store has no such
    /// file.
    ///
    /// # Errors
    /// The reason as text, if the file is there but cannot be read.
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String>;

    /// Returns the names of the files directly in `folder`, sorted, without the folder in front.
    /// Empty if there is no such folder. Used for listings and for suggestions on misspelt names.
    fn list(&self, folder: &str) -> Vec<String>;

    /// Reads and decodes the picture at `path`, for a `Texture` with a `file`; `Ok(None)` if the
    /// store has no such file. Each store decides which picture formats it decodes; this default
    /// implementation decodes none.
    ///
    /// # Errors
    /// The reason as text, if the file is there but cannot be read or decoded.
    fn picture(&self, path: &str) -> Result<Option<Picture>, String> {
        match self.read(path) {
            Ok(None) => Ok(None),
            _ => Err("this program decodes no pictures".to_owned()),
        }
    }
}

/// Longest document or shader file, in bytes; far above any that was written by hand, far below
/// what memory holds.
const LONGEST_FILE: u64 = 8 << 20;

/// Reads a text from a store; `Ok(None)` if the store has no such file.
///
/// # Errors
/// The reason, if the file cannot be read or is longer than 8 MiB.
pub(crate) fn read(sources: &dyn Sources, path: &str) -> Result<Option<Arc<str>>, String> {
    match sources.read(path)? {
        Some(text) if text.len() as u64 > LONGEST_FILE => {
            Err(too_long(&format!("{} MiB", text.len().div_ceil(1 << 20))))
        }
        text => Ok(text),
    }
}

fn too_long(length: &str) -> String {
    format!(
        "it has {length}, a document or shader {} at most: split it into several (`Include`, \
         `#import`), or let `repeat` say what is alike",
        LONGEST_FILE >> 20
    )
}

/// A store that reads the files of a folder on disk. Absolute paths are read as they are. A text
/// longer than 8 MiB is an error, and pictures are not decoded.
#[derive(Clone, Debug)]
pub struct FolderSources {
    /// Folder on disk that relative paths start from.
    pub root: PathBuf,
}

impl Sources for FolderSources {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        let path = self.root.join(path);
        // Looked at before it is opened, which a pipe can block; a file of many gigabytes is not
        // read to find that out.
        match std::fs::metadata(&path) {
            Ok(found) if found.is_file() => match found.len() {
                0..=LONGEST_FILE => {}
                length => return Err(too_long(&format!("{} MiB", length.div_ceil(1 << 20)))),
            },
            Ok(found) if !found.is_dir() => {
                return Err(
                    "it is a device, a pipe or a socket: copy its content into a file".to_owned(),
                );
            }
            _ => return Ok(None),
        }
        // Files of the kernel's have length 0 whatever they hold.
        let mut bytes = Vec::new();
        std::fs::File::open(&path)
            .and_then(|file| file.take(LONGEST_FILE + 1).read_to_end(&mut bytes))
            .map_err(|error| error.to_string())?;
        if bytes.len() as u64 > LONGEST_FILE {
            return Err(too_long(&format!("more than {} MiB", LONGEST_FILE >> 20)));
        }
        match String::from_utf8(bytes) {
            Ok(text) => Ok(Some(text.into())),
            Err(_) => Err("it is not text in UTF-8".to_owned()),
        }
    }

    fn list(&self, folder: &str) -> Vec<String> {
        let Ok(entries) = std::fs::read_dir(self.root.join(folder)) else {
            return Vec::new();
        };
        let mut names: Vec<String> = entries
            .flatten()
            .filter(|entry| entry.path().is_file())
            .filter_map(|entry| entry.file_name().into_string().ok())
            .collect();
        names.sort();
        names
    }
}

/// Several stores as one: each file comes from the first store that has it.
#[derive(Default)]
pub struct LayeredSources(
    /// The stores, in the order in which they are searched for a file.
    pub Vec<Box<dyn Sources>>,
);

impl Sources for LayeredSources {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        first(&self.0, |layer| layer.read(path))
    }

    fn list(&self, folder: &str) -> Vec<String> {
        let mut names: Vec<String> = self.0.iter().flat_map(|layer| layer.list(folder)).collect();
        names.sort();
        names.dedup();
        names
    }

    fn picture(&self, path: &str) -> Result<Option<Picture>, String> {
        first(&self.0, |layer| layer.picture(path))
    }
}

/// Returns the answer of the first store that has one.
fn first<T>(
    layers: &[Box<dyn Sources>],
    ask: impl Fn(&dyn Sources) -> Result<Option<T>, String>,
) -> Result<Option<T>, String> {
    for layer in layers {
        if let Some(found) = ask(&**layer)? {
            return Ok(Some(found));
        }
    }
    Ok(None)
}
