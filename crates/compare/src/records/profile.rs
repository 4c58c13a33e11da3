//! The schema of `profile --json`, version 1. `--baseline` reads it: extend it, rename nothing.
//!
//! ```
//! use skiagraph_compare::records::read_back;
//!
//! # let out = tempfile::tempdir()?;
//! # let name = "skiagraph_compare__records__profile__tests__the_schema_is_pinned_and_reads_back";
//! # let pinned = std::fs::read_to_string(format!("src/records/snapshots/{name}.snap"))?;
//! # std::fs::write(out.path().join("nsm.json"), &pinned[pinned.find('{').unwrap_or(0)..])?;
//! let (old, new) = (out.path().join("nsm.json"), out.path().join("nsm.json"));
//! let profile = read_back::profile(&new)?;
//! println!("{} on {}", profile.conditions.preset, profile.conditions.adapter);
//! let beside = profile.against(&old, &read_back::profile(&old)?);
//! assert_eq!(beside.frame.wall.old_ms, beside.frame.wall.new_ms);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::records::baseline::{Comparison, Difference, FrameRatio, PassRatio, Ratio};
use crate::records::results::{Adapter, Scene};
use crate::records::samples::{PassSamples, Samples};
use crate::records::statistics::{Series, Spread};
use crate::wording::size;
use serde::{Deserialize, Serialize};
use skiagraph_graph::{MemoryEntry, PassSummary};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Value of [`Profile::kind`], which tells a profile from the results of `compare`.
pub const KIND: &str = "profile";

/// Measurements of one `profile` command.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Profile {
    /// Version of this schema: 1.
    pub schema: u32,
    /// Kind of the file, always [`KIND`].
    pub kind: String,
    /// Conditions under which everything was measured.
    pub conditions: Conditions,
    /// Times of each pass, in the order in which the passes ran.
    pub passes: Vec<PassProfile>,
    /// Times of whole frames.
    pub frame: FrameProfile,
    /// Memory of the graph's own textures and buffers.
    pub memory: Memory,
    /// Comparison with an older profile; absent without `--baseline`. Not read back.
    #[serde(default, skip_serializing_if = "Option::is_none", skip_deserializing)]
    pub baseline: Option<Comparison>,
}

/// Conditions under which a profile was measured: program, GPU, scene, method and settings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Conditions {
    /// The program, `skiagraph 0.1.0`.
    pub program: String,
    /// `release`, or `debug`, whose CPU times are those of unoptimised code.
    pub build: String,
    /// Time of the measurement, ISO 8601 in UTC.
    pub date: String,
    /// GPU that was measured. [`Adapter::gpu_unavailable`] gives the reason if GPU times are null.
    pub adapter: Adapter,
    /// The scene that was drawn.
    pub scene: Scene,
    /// Name of the preset, or path of the graph, with the assignments that tell settings of its
    /// params apart: `crsm@n=1`.
    pub preset: String,
    /// Name of the view.
    pub view: String,
    /// Width and height of the viewport in pixels.
    pub viewport: [u32; 2],
    /// All params of the graph, defaults included, with the values that it ran with.
    pub params: BTreeMap<String, serde_json::Value>,
    /// Number of timed frames that were requested. There are fewer samples if the work ended early.
    pub frames: u32,
    /// Number of untimed warm-up frames before the timed ones.
    pub warmup: u32,
}

impl Conditions {
    /// Returns each param's name, such as `cull`, and its value as text, such as `front`.
    pub fn params(&self) -> impl Iterator<Item = (&str, String)> {
        self.params.iter().map(|(name, value)| {
            let word = value.as_str().map(str::to_owned);
            (name.as_str(), word.unwrap_or_else(|| value.to_string()))
        })
    }

    /// Lists the conditions that were not alike in an older profile.
    fn differences(&self, old: &Self) -> Vec<Difference> {
        let facts = |conditions: &Self| {
            [
                ("program", conditions.program.clone()),
                ("build", conditions.build.clone()),
                ("adapter", conditions.adapter.to_string()),
                ("scene", conditions.scene.to_string()),
                ("method", conditions.preset.clone()),
                ("view", conditions.view.clone()),
                ("viewport", size(conditions.viewport)),
            ]
        };
        let names = old.params().chain(self.params()).map(|(name, _)| name);
        let names: BTreeSet<&str> = names.collect();
        let param = |conditions: &Self, name: &str| {
            let value = conditions.params().find(|(key, _)| *key == name);
            value.map_or_else(|| "–".to_owned(), |(_, value)| value)
        };
        let params = names.into_iter().map(|name| Difference {
            what: format!("param {name}"),
            old: param(old, name),
            new: param(self, name),
        });
        let facts = facts(old).into_iter().zip(facts(self));
        let facts = facts.map(|((what, old), (_, new))| Difference {
            what: what.into(),
            old,
            new,
        });
        let pairs = facts.chain(params);
        pairs.filter(|fact| fact.old != fact.new).collect()
    }
}

/// Times of one pass.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PassProfile {
    /// Name of the pass in the graph.
    pub name: String,
    /// Kind of the pass in the words of graph documents, such as `Raster`.
    pub kind: String,
    /// Milliseconds between the pass's GPU timestamps; null if there are no timestamps or they
    /// cannot be trusted.
    pub gpu_ms: Option<Series>,
    /// Share of the frame's GPU time that the pass takes, 0 to 1, as the median over the frames;
    /// null without GPU times. Passes may overlap, so that shares need not add up to 1.
    pub share: Option<f64>,
    /// CPU time of encoding the pass, in milliseconds, for each frame.
    pub cpu_ms: Series,
}

/// Times of whole frames, in milliseconds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrameProfile {
    /// GPU time from the start of a frame's first pass to the end of its last, in milliseconds;
    /// null if there are no timestamps or they cannot be trusted.
    pub gpu_ms: Option<Series>,
    /// CPU time of encoding all passes of a frame, in milliseconds.
    pub cpu_ms: Series,
    /// Time from the start of encoding a frame until the GPU was done, by the CPU's clock, in
    /// milliseconds.
    pub wall_ms: Series,
}

/// Times of a pass, or of whole frames without one: of the GPU, if there are any, and of the CPU.
pub type Line<'a> = (Option<&'a PassProfile>, Option<&'a Series>, &'a Series);

/// Memory of the graph's own textures and buffers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// Bytes of all textures and buffers together.
    pub bytes: u64,
    /// Bytes saved because materials share memory: those that `bytes` would be more without it.
    pub saved_bytes: u64,
    /// Textures and buffers, in the order of the document.
    pub materials: Vec<Material>,
}

/// Memory of one texture or buffer of the graph.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Name of the material, or of a buffer that belongs to a pass.
    pub name: String,
    /// Format of a texture; null for a buffer.
    pub format: Option<String>,
    /// Width and height of a texture's mip 0 in texels; for a buffer `[n, 1]`, where n is its size
    /// in bytes.
    pub size: [u32; 2],
    /// Number of mip levels of a texture; 1 for a buffer.
    pub mips: u32,
    /// Number of array layers of a texture, or of slices of mip 0 of a 3D texture; 1 for a buffer.
    pub layers: u32,
    /// Memory in bytes that all texels or items take ([`MemoryEntry::bytes`]).
    pub bytes: u64,
    /// Names of the materials that use the same memory at other times of the frame; empty if there
    /// are none.
    pub shared_with: Vec<String>,
}

impl Profile {
    /// Creates a profile from the times of frames. `kinds` are the passes of the plan, from which
    /// each pass's kind is taken by name. Returns `None` if `samples` has no frames.
    pub fn new(
        conditions: Conditions,
        kinds: &[PassSummary],
        samples: Samples,
        memory: Memory,
    ) -> Option<Self> {
        let frame = FrameProfile {
            gpu_ms: samples.gpu.and_then(Series::new),
            cpu_ms: Series::new(samples.cpu)?,
            wall_ms: Series::new(samples.wall)?,
        };
        let pass = |pass: PassSamples| {
            let gpu_ms = pass.gpu.and_then(Series::new);
            let kind = kinds.iter().find(|kind| kind.name == pass.name);
            Some(PassProfile {
                name: pass.name,
                kind: kind.map_or_else(String::new, |kind| kind.kind.clone()),
                share: share(gpu_ms.as_ref(), frame.gpu_ms.as_ref()),
                gpu_ms,
                cpu_ms: Series::new(pass.cpu)?,
            })
        };
        let passes = samples.passes.into_iter().map(pass);
        Some(Self {
            schema: 1,
            kind: KIND.into(),
            passes: passes.collect::<Option<_>>()?,
            conditions,
            frame,
            memory,
            baseline: None,
        })
    }

    /// Compares the profile with an older one that was read from `file`.
    pub fn against(&self, file: &Path, old: &Self) -> Comparison {
        let missing = |from: &Self, other: &Self| {
            let names = from.passes.iter().map(|pass| pass.name.clone());
            let is_missing = |name: &String| other.passes.iter().all(|pass| pass.name != *name);
            names.filter(is_missing).collect()
        };
        let passes = self.passes.iter().filter_map(|pass| {
            let before = old.passes.iter().find(|old| old.name == pass.name)?;
            Some(PassRatio {
                name: pass.name.clone(),
                gpu: Ratio::from_both(before.gpu_ms.as_ref(), pass.gpu_ms.as_ref()),
                cpu: Ratio::new(&before.cpu_ms, &pass.cpu_ms),
            })
        });
        let (before, frame) = (&old.frame, &self.frame);
        Comparison {
            file: file.display().to_string(),
            date: old.conditions.date.clone(),
            differences: self.conditions.differences(&old.conditions),
            passes: passes.collect(),
            frame: FrameRatio {
                gpu: Ratio::from_both(before.gpu_ms.as_ref(), frame.gpu_ms.as_ref()),
                cpu: Ratio::new(&before.cpu_ms, &frame.cpu_ms),
                wall: Ratio::new(&before.wall_ms, &frame.wall_ms),
            },
            only_old: missing(old, self),
            only_new: missing(self, old),
        }
    }

    /// Returns the times of each pass, then those of whole frames.
    pub fn lines(&self) -> impl Iterator<Item = Line<'_>> {
        let passes = self.passes.iter();
        let passes = passes.map(|pass| (Some(pass), pass.gpu_ms.as_ref(), &pass.cpu_ms));
        passes.chain([(None, self.frame.gpu_ms.as_ref(), &self.frame.cpu_ms)])
    }

    /// Returns the number of timed frames.
    pub fn timed(&self) -> usize {
        self.frame.wall_ms.samples.len()
    }
}

fn share(pass: Option<&Series>, frame: Option<&Series>) -> Option<f64> {
    let frames = pass?.samples.iter().zip(&frame?.samples);
    let shares = frames.filter(|(_, frame)| **frame > 0.0);
    Some(Spread::new(shares.map(|(pass, frame)| pass / frame))?.median)
}

impl From<MemoryEntry> for Material {
    fn from(entry: MemoryEntry) -> Self {
        Self {
            name: entry.name,
            format: entry.format.map(|format| format!("{format:?}")),
            size: entry.size,
            mips: entry.mips,
            layers: entry.layers,
            bytes: entry.bytes,
            shared_with: entry.shared_with,
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::files::json;
    use crate::records::results::tests::{adapter, scene};
    use crate::records::statistics::tests::series;

    /// A profile with every field in use: one pass with all times, one without a GPU time.
    pub(crate) fn sample() -> Profile {
        let ms =
            |list: &[u32]| -> Vec<f64> { list.iter().map(|&us| f64::from(us) / 1e3).collect() };
        let some = |list: &[u32]| Some(ms(list));
        let samples = Samples {
            upkeep: None,
            passes: vec![
                PassSamples {
                    name: "primitive".into(),
                    gpu: some(&[2000, 2500, 1500]),
                    cpu: ms(&[20, 30, 10]),
                },
                PassSamples {
                    name: "clear".into(),
                    gpu: None,
                    cpu: ms(&[2, 3, 1]),
                },
            ],
            gpu: some(&[4000, 5000, 4500]),
            cpu: ms(&[22, 33, 11]),
            wall: ms(&[4100, 5100, 4600]),
        };
        let conditions = Conditions {
            program: "skiagraph 0.1.0".into(),
            build: "release".into(),
            date: "2026-11-21T04:30:12Z".into(),
            adapter: Adapter {
                device_type: "DiscreteGpu".into(),
                ..adapter()
            },
            scene: scene(),
            preset: "nsm".into(),
            view: "main".into(),
            viewport: [512, 256],
            params: BTreeMap::from([("map_size".into(), 1024.into())]),
            frames: 3,
            warmup: 1,
        };
        let kinds = ["primitive", "clear"].map(|name| PassSummary {
            name: name.into(),
            kind: "Raster".into(),
        });
        let memory = Memory {
            bytes: 4 << 20,
            saved_bytes: 1 << 20,
            materials: vec![
                Material {
                    name: "shadow_map".into(),
                    format: Some("Depth32Float".into()),
                    size: [1024, 1024],
                    mips: 1,
                    layers: 1,
                    bytes: 4 << 20,
                    shared_with: vec!["rays".into()],
                },
                Material {
                    name: "rays".into(),
                    format: None,
                    size: [1 << 20, 1],
                    mips: 1,
                    layers: 1,
                    bytes: 1 << 20,
                    shared_with: vec!["shadow_map".into()],
                },
            ],
        };
        Profile::new(conditions, &kinds, samples, memory).unwrap()
    }

    #[test]
    fn the_schema_is_pinned_and_reads_back() {
        let json = json::to_text(&sample());
        insta::assert_snapshot!(json);
        assert_eq!(serde_json::from_str::<Profile>(&json).unwrap(), sample());
    }

    #[test]
    fn a_share_is_taken_frame_by_frame() {
        // 2000/4000, 2500/5000, 1500/4500.
        assert_eq!(sample().passes[0].share, Some(0.5));
        assert_eq!(sample().passes[1].share, None);
        let zero = share(Some(&series(&[0.0])), Some(&series(&[0.0])));
        assert_eq!(zero, None, "no share of nothing");
    }

    #[test]
    fn no_frames_make_no_profile() {
        let none = Profile::new(
            sample().conditions,
            &[],
            Samples::default(),
            sample().memory,
        );
        assert!(none.is_none());
    }

    #[test]
    fn what_differs_and_what_stands_on_one_side_is_listed() {
        let (old, mut new) = (sample(), sample());
        new.conditions.viewport = [64, 64];
        new.conditions.params.insert("bias".into(), 0.5.into());
        new.conditions.date = "2027-01-01T00:00:00Z".into();
        new.passes[1].name = "fill".into();
        let comparison = new.against(Path::new("old.json"), &old);
        let whats: Vec<_> = comparison
            .differences
            .iter()
            .map(|d| d.what.as_str())
            .collect();
        assert_eq!(whats, ["viewport", "param bias"]);
        assert_eq!(comparison.differences[1].old, "–");
        assert_eq!(
            (&comparison.only_old[..], &comparison.only_new[..]),
            (&["clear".to_owned()][..], &["fill".to_owned()][..])
        );
        assert_eq!(comparison.passes.len(), 1);
        assert_eq!(old.against(Path::new("old.json"), &old).differences, []);
    }
}
