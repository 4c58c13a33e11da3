//! Files that a host hands over instead of a file system, such as those dropped on a page.
//!
//! ```
//! use skiagraph_scene::{MeshFile, MeshFileOptions, hand_over};
//! use std::path::Path;
//!
//! hand_over("dropped/./tiles/../tile.obj", b"v 0 0 0\nv 0 0 1\nv 1 0 0\nf 1 2 3\n".to_vec());
//! let tile = MeshFile::load(Path::new("dropped/tile.obj"), &MeshFileOptions::default())?;
//! assert_eq!(tile.mesh.triangles.len(), 1);
//! # Ok::<(), skiagraph_scene::SceneError>(())
//! ```

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, PoisonError, RwLock};

static FILES: RwLock<BTreeMap<PathBuf, Arc<[u8]>>> = RwLock::new(BTreeMap::new());

/// Hands over the content of a file: meshes, materials and textures that name this path are read
/// from it, whatever the file system has there. A later content replaces it.
pub fn hand_over(path: impl AsRef<Path>, bytes: Vec<u8>) {
    let mut files = FILES.write().unwrap_or_else(PoisonError::into_inner);
    files.insert(plain(path.as_ref()), bytes.into());
}

/// Forgets all files that were handed over.
pub fn forget_handed() {
    let mut files = FILES.write().unwrap_or_else(PoisonError::into_inner);
    files.clear();
}

/// Returns the content of a file that was handed over.
pub(crate) fn handed(path: &Path) -> Option<Arc<[u8]>> {
    let files = FILES.read().unwrap_or_else(PoisonError::into_inner);
    files.get(&plain(path)).cloned()
}

/// A path without `.`, and without `..` behind a folder.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => (),
            Component::ParentDir if plain.file_name().is_some() => drop(plain.pop()),
            part => plain.push(part),
        }
    }
    plain
}

/// True if a file was handed over, or is in the file system.
pub(crate) fn is_file(path: &Path) -> bool {
    handed(path).is_some() || path.is_file()
}
