//! Hashes of what a run depends on. `compare --resume` measures a run again if its hash has
//! changed.
//!
//! ```
//! use skiagraph_compare::files::fingerprint::{Fingerprint, RecordedSources};
//! use skiagraph_graph::Graph;
//! use skiagraph_passes::{EmbeddedSources, registry};
//!
//! let sources = RecordedSources::new(&EmbeddedSources);
//! let nothing = sources.fingerprint();
//! Graph::load("pipelines/nsm.ron", &registry(), &sources)?;
//! assert_ne!(sources.fingerprint().to_string(), nothing.to_string());
//!
//! let run = Fingerprint::EMPTY.with_all(sources.fingerprint()).with_text("view main");
//! println!("{run}");
//! # Ok::<(), skiagraph_graph::Diagnostics>(())
//! ```

use skiagraph_graph::{Picture, Sources};
use skiagraph_scene::packed_masks::{mask_words, shadow_words};
use skiagraph_scene::{Light, Mesh};
use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// A hash of texts and numbers, the same on every machine. FNV-1a of 64 bits (Fowler, Noll, Vo): it
/// detects changes, not forgeries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fingerprint(u64);

impl Fingerprint {
    /// The hash of an empty input, to which the `with_…` functions add.
    pub const EMPTY: Self = Self(0xcbf2_9ce4_8422_2325);

    /// Returns the hash extended by bytes, without their number.
    pub(crate) fn with_bytes(self, bytes: &[u8]) -> Self {
        let with = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        Self(bytes.iter().fold(self.0, with))
    }

    /// Returns the hash as bytes, the least significant one first.
    pub(crate) fn bytes(self) -> [u8; 8] {
        self.0.to_le_bytes()
    }

    /// Returns the hash extended by a text and, before it, its length, so that a word moved from
    /// one text to the next changes the hash.
    pub fn with_text(self, text: &str) -> Self {
        let length = (text.len() as u64).to_le_bytes();
        self.with_bytes(&length).with_bytes(text.as_bytes())
    }

    /// Returns the hash extended by another hash.
    pub fn with_all(self, other: Self) -> Self {
        self.with_bytes(&other.bytes())
    }

    /// Returns the hash extended by a mesh (positions, triangles, normals, masks, roles in shadows)
    /// and lights.
    pub fn with_scene(self, mesh: &Mesh, lights: &[Light]) -> Self {
        let list = |bytes: &[u8]| Self::EMPTY.with_bytes(bytes);
        let facts = [mask_words(mesh), shadow_words(mesh)].into_iter();
        let facts = facts.filter(|words| !words.is_empty());
        facts
            .fold(self, |hash, words| {
                hash.with_all(list(bytemuck::cast_slice(&words)))
            })
            .with_all(list(bytemuck::cast_slice(&mesh.positions)))
            .with_all(list(bytemuck::cast_slice(&mesh.triangles)))
            .with_all(list(bytemuck::cast_slice(&mesh.normals)))
            .with_all(list(bytemuck::cast_slice(&mesh.normal_indices)))
            .with_text(&format!("{lights:?}"))
    }
}

impl fmt::Display for Fingerprint {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

/// [`Sources`] (documents, shaders and pictures by path) that read from other sources and record a
/// hash of each file that is read. Load a graph through them to hash it with its includes and
/// shaders.
pub struct RecordedSources<'a> {
    sources: &'a dyn Sources,
    /// Texts and pictures by path.
    texts: Mutex<BTreeMap<String, Fingerprint>>,
}

impl<'a> RecordedSources<'a> {
    /// Creates sources that read from `sources`, with nothing recorded yet.
    pub fn new(sources: &'a dyn Sources) -> Self {
        Self {
            sources,
            texts: Mutex::default(),
        }
    }

    /// Returns one hash of the paths and contents of everything that was read.
    pub fn fingerprint(&self) -> Fingerprint {
        let texts = self.texts.lock().unwrap_or_else(PoisonError::into_inner);
        let with = |hash: Fingerprint, (path, text): (&String, &Fingerprint)| {
            hash.with_text(path).with_all(*text)
        };
        texts.iter().fold(Fingerprint::EMPTY, with)
    }

    fn record(&self, path: &str, content: Fingerprint) {
        let mut texts = self.texts.lock().unwrap_or_else(PoisonError::into_inner);
        texts.insert(path.to_owned(), content);
    }
}

impl Sources for RecordedSources<'_> {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        let text = self.sources.read(path)?;
        if let Some(text) = &text {
            self.record(path, Fingerprint::EMPTY.with_text(text));
        }
        Ok(text)
    }

    fn picture(&self, path: &str) -> Result<Option<Picture>, String> {
        let picture = self.sources.picture(path)?;
        if let Some(Picture { size, texels }) = &picture {
            let content = Fingerprint::EMPTY
                .with_text(&format!("{size:?}"))
                .with_bytes(bytemuck::cast_slice(texels));
            self.record(path, content);
        }
        Ok(picture)
    }

    fn list(&self, folder: &str) -> Vec<String> {
        self.sources.list(folder)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graphs::preset;
    use skiagraph_graph::{FolderSources, Graph, LayeredSources};

    #[test]
    fn it_is_the_published_hash() {
        // Landon Curt Noll's test vectors.
        for (text, hash) in [
            ("", "cbf29ce484222325"),
            ("a", "af63dc4c8601ec8c"),
            ("foobar", "85944171f73967e8"),
        ] {
            assert_eq!(
                Fingerprint::EMPTY.with_bytes(text.as_bytes()).to_string(),
                hash
            );
        }
    }

    #[test]
    fn words_do_not_move_from_text_to_text_unseen() {
        let fingerprint = |texts: [&str; 2]| {
            texts
                .into_iter()
                .fold(Fingerprint::EMPTY, Fingerprint::with_text)
        };
        assert_ne!(fingerprint(["ab", "c"]), fingerprint(["a", "bc"]));
        assert_ne!(fingerprint(["ab", "c"]), fingerprint(["c", "ab"]));
    }

    #[test]
    fn an_included_shader_is_part_of_a_graph() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().to_path_buf();
        let of_nsm = || {
            let sources = LayeredSources(vec![
                Box::new(FolderSources { root: root.clone() }),
                Box::new(skiagraph_passes::EmbeddedSources),
            ]);
            let recorded = RecordedSources::new(&sources);
            let path = preset::locate("nsm", &sources).unwrap();
            Graph::load(&path, &skiagraph_passes::registry(), &recorded).unwrap();
            recorded.fingerprint()
        };
        let built_in = of_nsm();
        assert_eq!(built_in, of_nsm());
        let shared = "shaders/shared/light.wgsl";
        let text = skiagraph_passes::EmbeddedSources
            .read(shared)
            .unwrap()
            .unwrap();
        std::fs::create_dir_all(root.join("shaders/shared")).unwrap();
        std::fs::write(root.join(shared), &*text).unwrap();
        assert_eq!(built_in, of_nsm(), "the same text from another place");
        std::fs::write(root.join(shared), format!("{text}// changed\n")).unwrap();
        assert_ne!(built_in, of_nsm());
    }
}
