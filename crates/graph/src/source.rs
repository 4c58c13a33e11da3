//! Where documents and shaders come from, and places in them.

use std::{
    fmt,
    io::Read,
    ops::Range,
    path::{Path, PathBuf},
    sync::Arc,
};

/// A store of RON documents and WGSL files: a folder, embedded files, or a host's own.
///
/// Paths have forward slashes and are relative to the store (`pipelines/nsm.ron`, `shaders/shared/camera.wgsl`), or absolute.
pub trait Sources: Send + Sync {
    /// The text at `path`; `Ok(None)` if the store has no such file.
    ///
    /// # Errors
    /// The reason, if the file is there but cannot be read.
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String>;

    /// Names of the files that stand directly in `folder`, sorted; for listings and for suggestions on misspelt names.
    fn list(&self, folder: &str) -> Vec<String>;
}

/// Longest document or shader file, in bytes; far above any that was written by hand, far below what memory holds.
const LONGEST_FILE: u64 = 8 << 20;

/// Reads a text from a store.
///
/// # Errors
/// Why it cannot be read; it may be too long.
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
        "it has {length}, a document or shader {} at most: split it into several (`Include`, `#import`), or let `repeat` say what is alike",
        LONGEST_FILE >> 20
    )
}

/// Files below a folder on disk. Absolute paths are read as they are.
#[derive(Clone, Debug)]
pub struct FolderSources {
    /// The folder that relative paths start from.
    pub root: PathBuf,
}

impl Sources for FolderSources {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        let path = self.root.join(path);
        // Looked at before it is opened, which a pipe can block; a file of many gigabytes is not read to find that out.
        match std::fs::metadata(&path) {
            Ok(found) if found.is_file() => match found.len() {
                0..=LONGEST_FILE => {}
                length => return Err(too_long(&format!("{} MiB", length.div_ceil(1 << 20)))),
            },
            Ok(found) if !found.is_dir() => {
                return Err(
                    "it is a device, a pipe or a socket: copy what it gives into a file".to_owned(),
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
            Err(_) => Err("it is no text in UTF-8".to_owned()),
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

/// Several stores; the first that has a file wins.
#[derive(Default)]
pub struct LayeredSources(
    /// The stores, in order of precedence.
    pub Vec<Box<dyn Sources>>,
);

impl Sources for LayeredSources {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        for layer in &self.0 {
            if let Some(text) = layer.read(path)? {
                return Ok(Some(text));
            }
        }
        Ok(None)
    }

    fn list(&self, folder: &str) -> Vec<String> {
        let mut names: Vec<String> = self.0.iter().flat_map(|layer| layer.list(folder)).collect();
        names.sort();
        names.dedup();
        names
    }
}

/// A file that was read: its name as the author knows it, and its text. Cheap to clone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SourceFile {
    /// Path as given to [`Sources::read`].
    pub name: Arc<str>,
    /// Whole text.
    pub text: Arc<str>,
}

impl SourceFile {
    /// A file of that name and text.
    pub fn new(name: impl Into<Arc<str>>, text: impl Into<Arc<str>>) -> Self {
        Self {
            name: name.into(),
            text: text.into(),
        }
    }

    /// The place of `range` (bytes) in this file.
    pub fn span(&self, range: Range<usize>) -> Span {
        Span {
            file: self.clone(),
            range,
        }
    }
}

/// A place in a file.
#[derive(Clone, PartialEq, Eq)]
pub struct Span {
    /// The file.
    pub file: SourceFile,
    /// Bytes of its text.
    pub range: Range<usize>,
}

impl Span {
    /// Line and column of the start, counted from 1, columns in characters.
    pub fn line_column(&self) -> (usize, usize) {
        let before = self
            .file
            .text
            .get(..self.range.start)
            .unwrap_or(&self.file.text);
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
        (line, column)
    }
}

impl fmt::Display for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (line, column) = self.line_column();
        write!(f, "{}:{line}:{column}", self.file.name)
    }
}

impl fmt::Debug for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

/// Where the shader called `name` may stand for a document in `folder`, in the order in which it is looked for: beside
/// the document, in the `shaders` folder beside the document's folder, in the store's `shaders` folder.
pub(crate) fn shader_candidates(folder: &str, name: &str) -> Vec<String> {
    let folder = Path::new(folder);
    let file = format!("{name}.wgsl");
    let mut candidates = vec![join(folder, &file)];
    if let Some(parent) = folder.parent() {
        candidates.push(join(parent, &format!("shaders/{file}")));
        // A document in a sub-folder of pipelines (a shared sub-graph) finds the shaders of its house too.
        if let Some(grandparent) = parent.parent() {
            candidates.push(join(grandparent, &format!("shaders/{file}")));
        }
    }
    candidates.push(format!("shaders/{file}"));
    candidates.dedup();
    candidates
}

/// Where `#import "path"` of the file `importer` may stand: beside the importer, above it, and in the store's `shaders`.
pub(crate) fn import_candidates(importer: &str, path: &str) -> Vec<String> {
    let folder = Path::new(importer).parent().unwrap_or(Path::new(""));
    let mut candidates = vec![join(folder, path)];
    if let Some(parent) = folder.parent() {
        candidates.push(join(parent, path));
    }
    candidates.push(format!("shaders/{path}"));
    candidates.dedup();
    candidates
}

/// Where `Include(graph: "path")` of the document `includer` may stand: beside it, and in the store's `pipelines`.
pub(crate) fn include_candidates(includer: &str, path: &str) -> Vec<String> {
    // One file under one name, or a cycle would not be seen as one.
    let parts: Vec<&str> = path
        .split('/')
        .filter(|part| !matches!(*part, "" | "."))
        .collect();
    let path = parts.join("/");
    let mut candidates = vec![
        join(Path::new(folder_of(includer)), &path),
        format!("pipelines/{path}"),
    ];
    candidates.dedup();
    candidates
}

/// The folder of a path, empty for a bare name.
pub(crate) fn folder_of(path: &str) -> &str {
    let folder = Path::new(path).parent();
    folder.and_then(Path::to_str).unwrap_or("")
}

/// Whether a path leads out of the folder it is looked for in (backslashes and drives: on Windows).
pub(crate) fn escapes(path: &str) -> bool {
    path.split('/').any(|part| part == "..") || path.starts_with('/') || path.contains(['\\', ':'])
}

fn join(folder: &Path, file: &str) -> String {
    folder.join(file).to_string_lossy().replace('\\', "/")
}
