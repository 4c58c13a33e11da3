//! Keeps the reference's answers in a folder that several machines share.

use crate::comparison::Comparison;
use crate::error::{CompareError, Result};
use crate::files::fingerprint::Fingerprint;
use crate::files::lock;
use crate::files::truth_file::Truth;
use crate::files::write::{write_new, write_whole};
use crate::measuring::cell::light_text;
use crate::records::cell_files::TRUTHS;
use crate::records::results::PROGRAM;
use crate::sink::Sink;
use crate::wording::{plural, thousands};
use skiagraph_scene::{Camera, LightKind, Mesh};
use std::path::{Path, PathBuf};
use std::{fs, io};

/// A folder with a file for each frame of which the reference's answers are known.
pub struct TruthFolder {
    folder: PathBuf,
    /// Hash of the scene and of how its pixels are sampled.
    scene: Fingerprint,
    /// The reference's mode.
    oracle: String,
}

/// All that the answers for a frame depend on, besides the scene.
pub struct SeenFrame<'a> {
    /// The mesh, if parts of it have moved.
    pub moved: Option<&'a Mesh>,
    /// The frame's camera.
    pub camera: &'a Camera,
    /// The light.
    pub light: LightKind,
    /// Visible primitive of each pixel, which is the GPU's answer.
    pub primitives: &'a [u32],
}

impl TruthFolder {
    /// Names the folder below `folder` for the answers of a comparison.
    pub fn new(folder: &Path, comparison: &Comparison) -> Self {
        Self {
            folder: folder.join(TRUTHS),
            scene: comparison.fingerprint(),
            oracle: comparison.protocol.oracle.to_string(),
        }
    }

    /// Makes the folder.
    ///
    /// # Errors
    /// It cannot be made.
    pub fn make(&self) -> Result<()> {
        fs::create_dir_all(&self.folder).map_err(|error| CompareError::write(&self.folder, error))
    }

    /// Returns the answers for a frame: those in the folder, or else those that `trace` finds,
    /// which are then written into the folder. Waits while another process traces the same, if the
    /// file system shares locks. `id` is that of the truth, `what` and the sink are for messages.
    ///
    /// # Errors
    /// Those of `trace`; a file that cannot be written; other answers of a machine that has traced
    /// the same meanwhile.
    pub fn find(
        &self,
        id: &str,
        seen: &SeenFrame,
        (what, sink): (&str, &dyn Sink),
        trace: impl FnOnce() -> Result<Truth>,
    ) -> Result<Truth> {
        let name = format!("{id}-{}.truth", self.fingerprint(seen));
        let path = self.folder.join(&name);
        if let Some(truth) = read(&path)?.and_then(Result::ok) {
            return Ok(truth);
        }
        let _locked = lock::wait_for(&self.folder, &format!(".{name}.lock"), sink)?;
        match read(&path)? {
            Some(Ok(truth)) => return Ok(truth),
            Some(Err(why)) => sink.note(&format!("{}: {why}; traced anew", path.display())),
            None => {}
        }
        let truth = trace()?;
        keep(&path, &truth, what)?;
        Ok(truth)
    }

    fn fingerprint(&self, seen: &SeenFrame) -> Fingerprint {
        let Camera {
            eye,
            right,
            up,
            forward,
            half_width,
            half_height,
            near,
            far,
            viewport,
            jitter,
        } = seen.camera;
        let vectors = [eye, right, up, forward].map(|vector| vector.to_array());
        let numbers = vectors.as_flattened().iter();
        let numbers = numbers.chain([half_width, half_height, near, far]);
        let numbers: Vec<f64> = numbers.chain(&jitter.to_array()).copied().collect();
        let scene = match seen.moved {
            Some(mesh) => self.scene.with_scene(mesh, &[]),
            None => self.scene,
        };
        scene
            .with_text(PROGRAM)
            .with_text(&self.oracle)
            .with_text(&light_text(seen.light))
            .with_text(&format!("{viewport:?}"))
            .with_bytes(bytemuck::cast_slice(&numbers))
            .with_bytes(bytemuck::cast_slice(seen.primitives))
    }
}

/// The answers in a file, or why it has none; `None` without one.
fn read(path: &Path) -> Result<Option<Result<Truth, String>>> {
    match fs::read(path) {
        Ok(bytes) => Ok(Some(Truth::from_bytes(&bytes))),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(CompareError::Input(format!(
            "cannot read {}: {error}",
            path.display()
        ))),
    }
}

/// Writes a file of answers, unless one is there that holds the same.
fn keep(path: &Path, truth: &Truth, what: &str) -> Result<()> {
    let bytes = truth.bytes();
    if write_new(path, &bytes)? {
        return Ok(());
    }
    match read(path)? {
        Some(Ok(other)) if other.bytes() == bytes => Ok(()),
        Some(Ok(other)) => Err(CompareError::Input(format!(
            "the reference of {what} is {} here than in {}, where another machine has traced \
             it\n  measure all cells on machines that agree: the same program on processors of \
             one kind; then delete that file",
            differing(truth, &other),
            path.display()
        ))),
        _ => write_whole(path, &bytes),
    }
}

/// How many pixels have another answer.
fn differing(one: &Truth, other: &Truth) -> String {
    let [classes, theirs] = [one, other].map(|truth| &truth.ground_truth.pixels.classes);
    let count = classes.iter().zip(theirs).filter(|(a, b)| a != b).count();
    match count {
        0 => "another one".to_owned(),
        count => format!(
            "another one in {} of {}",
            plural(count, "pixel"),
            thousands(classes.len() as u64)
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use skiagraph_reference::{Class, GroundTruth, GroundTruthPixels};

    fn truth(class: Class) -> Truth {
        let pixels = GroundTruthPixels {
            viewport: [2, 1],
            classes: vec![Class::Lit, class],
            indeterminate: vec![false; 2],
            n_dot_l: vec![1.0; 2],
            base_colors: Vec::new(),
        };
        let ground_truth = GroundTruth { pixels, area: None };
        Truth {
            ground_truth,
            wrong_surfaces: 0,
        }
    }

    #[test]
    fn two_machines_may_trace_the_same_and_must_agree() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.truth");
        let keep = |class| keep(&path, &truth(class), "main 2x1");
        keep(Class::Lit).unwrap();
        keep(Class::Lit).unwrap();
        let error = keep(Class::Shadow).unwrap_err().to_string();
        assert!(
            error.contains("main 2x1 is another one in 1 pixel of 2 here"),
            "{error}"
        );
        assert!(error.contains("a.truth, where another machine"), "{error}");
        // A torn one is replaced.
        let bytes = fs::read(&path).unwrap();
        fs::write(&path, &bytes[..20]).unwrap();
        keep(Class::Shadow).unwrap();
        assert_eq!(read(&path).unwrap(), Some(Ok(truth(Class::Shadow))));
    }
}
