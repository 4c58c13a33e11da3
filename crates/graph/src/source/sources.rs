//! Stores that documents, shaders and pictures are read from.

use crate::picture::Picture;
use std::collections::{BTreeMap, BTreeSet};
use std::io::Read;
use std::path::PathBuf;
use std::sync::Arc;

/// A store of RON documents, WGSL files and pictures: a folder, embedded files, or a host's own.
///
/// Paths have forward slashes and are relative to the store (`pipelines/nsm.ron`,
/// `shaders/shared/camera.wgsl`), or absolute if the host gave [`Graph::load`](crate::Graph::load)
/// an absolute one. Names in documents and shaders are resolved before: for a shader `nsm` of
/// `pipelines/nsm.ron` the store is asked for `pipelines/nsm.wgsl` and then for `shaders/nsm.wgsl`,
/// until it has the file. Documents that a document includes or extends, and pictures, are looked
/// for beside the document and then in `pipelines`. No name in a document leads out of the store by
/// `..`.
pub trait Sources: Send + Sync {
    /// Reads the text of the document or shader file at `path`; `Ok(None)` if the store has no such
    /// file. Loading refuses a text that is longer than 8 MiB.
    ///
    /// # Errors
    /// The reason as text, if the file is there but cannot be read.
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String>;

    /// Returns the names of the files directly in `folder` (empty for the store's root), sorted,
    /// without the folder in front. Empty if there is no such folder. Used for listings and for
    /// suggestions on misspelt names.
    fn list(&self, folder: &str) -> Vec<String>;

    /// Reads and decodes the picture at `path`, for a `Texture` with a `file`; `Ok(None)` if the
    /// store has no such file. Each store decides which picture formats it decodes; this default
    /// implementation decodes none and returns an error for a file that is there.
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
/// longer than 8 MiB is an error, and so is a picture: none is decoded.
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
            Ok(metadata) if metadata.is_file() => match metadata.len() {
                0..=LONGEST_FILE => {}
                length => return Err(too_long(&format!("{} MiB", length.div_ceil(1 << 20)))),
            },
            Ok(metadata) if !metadata.is_dir() => {
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

/// A store of files in memory: texts and decoded pictures by their paths.
///
/// ```
/// use skiagraph_graph::{Graph, MemorySources, Registry, Sources};
///
/// let sources = MemorySources::new([
///     (
///         "ramp.ron",
///         r#"(format: 3, materials: [Texture(name: "image", format: R32Float)],
///             passes: [Fullscreen(name: "ramp", color: ["image"])], outputs: ["image"])"#,
///     ),
///     ("shaders/ramp.wgsl", "@fragment fn fragment() -> @location(0) f32 { return 0.5; }"),
/// ]);
/// assert_eq!(sources.list("shaders"), ["ramp.wgsl"]);
/// Graph::load("ramp.ron", &Registry::standard(), &sources)?;
/// # Ok::<(), skiagraph_graph::Diagnostics>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct MemorySources {
    texts: BTreeMap<String, Arc<str>>,
    pictures: BTreeMap<String, Picture>,
}

impl MemorySources {
    /// Creates a store of documents and shaders: pairs of path and text. Of two pairs with one path
    /// the last counts.
    pub fn new<P: Into<String>, T: Into<Arc<str>>>(
        files: impl IntoIterator<Item = (P, T)>,
    ) -> Self {
        let files = files.into_iter();
        Self {
            texts: files
                .map(|(path, text)| (path.into(), text.into()))
                .collect(),
            pictures: BTreeMap::new(),
        }
    }

    /// Adds a document or shader, or replaces the one at this path.
    #[must_use]
    pub fn with(mut self, path: impl Into<String>, text: impl Into<Arc<str>>) -> Self {
        self.texts.insert(path.into(), text.into());
        self
    }

    /// Adds a decoded picture, or replaces the one at this path.
    #[must_use]
    pub fn with_picture(mut self, path: impl Into<String>, picture: Picture) -> Self {
        self.pictures.insert(path.into(), picture);
        self
    }

    /// Returns a store that takes from `below`, such as the presets, each file that this one lacks.
    pub fn over(self, below: impl Sources + 'static) -> LayeredSources {
        LayeredSources(vec![Box::new(self), Box::new(below)])
    }
}

impl Sources for MemorySources {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        Ok(self.texts.get(path).cloned())
    }

    fn list(&self, folder: &str) -> Vec<String> {
        let inside = |path: &String| {
            let (parent, name) = path.rsplit_once('/').unwrap_or(("", path));
            (parent == folder).then(|| name.to_owned())
        };
        let paths = self.texts.keys().chain(self.pictures.keys());
        let names: BTreeSet<String> = paths.filter_map(inside).collect();
        names.into_iter().collect()
    }

    fn picture(&self, path: &str) -> Result<Option<Picture>, String> {
        Ok(self.pictures.get(path).cloned())
    }
}

/// Several stores as one: each file comes from the first store that has it. If this store cannot
/// read its file, its error is returned, and later stores are not asked.
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
        if let Some(content) = ask(&**layer)? {
            return Ok(Some(content));
        }
    }
    Ok(None)
}
