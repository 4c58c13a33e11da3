//! Calls a function when documents, shaders or pictures change on disk.
//!
//! ```no_run
//! use skiagraph_compare::files::watch::{Watch, folders};
//!
//! let _watch = Watch::start(&folders(["my/method.ron"].into_iter()), || {
//!     println!("a document or a shader has changed");
//! })?;
//! std::thread::park();
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::files::write::folder_of;
use notify::{EventKind, RecursiveMode, Watcher};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

/// Editors write a file in several steps; after the first one it is waited so long for the rest.
const SETTLING: Duration = Duration::from_millis(60);

/// A watch on folders. It ends when this value is dropped.
pub struct Watch {
    _watcher: notify::RecommendedWatcher,
}

impl Watch {
    /// Starts a thread that calls `changed` after a `.ron`, `.wgsl` or `.png` file has changed
    /// directly in one of `folders`, or anywhere below `pipelines` and `shaders` in the working
    /// directory. Several changes in quick succession are one call.
    ///
    /// # Errors
    /// A folder that cannot be watched.
    pub fn start(
        folders: &BTreeSet<PathBuf>,
        changed: impl Fn() + Send + 'static,
    ) -> Result<Self, notify::Error> {
        let (heard, events) = mpsc::channel();
        let mut watcher = notify::recommended_watcher(move |event: notify::Result<_>| {
            if event.is_ok_and(|event| is_of_interest(&event)) {
                // The receiver goes away only when the watcher is about to go, too.
                let _ = heard.send(());
            }
        })?;
        for folder in folders {
            watcher.watch(folder, RecursiveMode::NonRecursive)?;
        }
        for folder in ["pipelines", "shaders"].map(Path::new) {
            if folder.is_dir() {
                watcher.watch(folder, RecursiveMode::Recursive)?;
            }
        }
        thread::spawn(move || {
            while events.recv().is_ok() {
                while events.recv_timeout(SETTLING).is_ok() {}
                changed();
            }
        });
        Ok(Self { _watcher: watcher })
    }
}

/// Returns the folders to watch for the graphs that `arguments` name: the working directory, the
/// folder of each `.ron` file, and those direct subfolders of a `.ron` file's folder that hold
/// `.ron`, `.wgsl` or `.png` files.
pub fn folders<'a>(arguments: impl Iterator<Item = &'a str>) -> BTreeSet<PathBuf> {
    let mut folders = BTreeSet::from([PathBuf::from(".")]);
    for argument in arguments.filter(|argument| argument.ends_with(".ron")) {
        let folder = folder_of(Path::new(argument));
        let inside = std::fs::read_dir(folder).into_iter().flatten().flatten();
        let inside = inside.map(|entry| entry.path());
        folders.extend(inside.filter(|path| path.is_dir() && holds_shaders(path)));
        folders.insert(folder.to_owned());
    }
    folders.retain(|folder| folder.is_dir());
    folders
}

/// True if documents name files in such a folder: not in one of a build or of git.
fn holds_shaders(folder: &Path) -> bool {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths = entries.map(|entry| entry.path());
    paths.any(|path| is_source(&path))
}

fn is_source(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    matches!(extension, Some("ron" | "wgsl" | "png"))
}

fn is_of_interest(event: &notify::Event) -> bool {
    let is_change = !matches!(event.kind, EventKind::Access(_));
    is_change && event.paths.iter().any(|path| is_source(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_written_or_renamed_shader_is_heard_and_other_files_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().to_path_buf();
        let (sender, heard) = mpsc::channel();
        let _watch = Watch::start(&BTreeSet::from([path.clone()]), move || {
            sender.send(()).unwrap();
        })
        .unwrap();
        std::fs::write(path.join("notes.txt"), "x").unwrap();
        assert!(heard.recv_timeout(Duration::from_millis(500)).is_err());
        std::fs::write(path.join("a.wgsl"), "x").unwrap();
        heard.recv_timeout(Duration::from_secs(20)).unwrap();
        std::fs::write(path.join("b.tmp"), "y").unwrap();
        std::fs::rename(path.join("b.tmp"), path.join("a.wgsl")).unwrap();
        heard.recv_timeout(Duration::from_secs(20)).unwrap();
    }

    #[test]
    fn the_folder_of_a_document_and_its_shaders_are_watched() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["shared", "target"] {
            std::fs::create_dir(folder.path().join(name)).unwrap();
        }
        std::fs::write(folder.path().join("shared/a.wgsl"), "").unwrap();
        let document = folder.path().join("method.ron");
        let folders = folders([document.to_str().unwrap(), "rt"].into_iter());
        assert!(folders.contains(folder.path()));
        assert!(folders.contains(&folder.path().join("shared")));
        assert!(!folders.contains(&folder.path().join("target")));
    }
}
