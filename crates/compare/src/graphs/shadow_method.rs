//! Loads and checks shadow methods, the graphs that `compare` can judge, and decodes their outputs.
//!
//! ```
//! use skiagraph_compare::graphs::shadow_method::{load_all, load_methods};
//! use skiagraph_passes::EmbeddedSources;
//!
//! let methods = load_methods(&["nsm"], &["bias=0,0.01".parse()?], &[256, 512], &EmbeddedSources)?;
//! assert_eq!(methods.len(), 4);
//! // A graph without visibility is no shadow method.
//! assert!(load_all(&["pipelines/shared/gbuffer.ron".into()], &EmbeddedSources).is_err());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::Result;
use crate::graphs::argument::Assignment;
use crate::graphs::contract::{FLOATS, INTEGERS, layers};
use crate::graphs::faults::{GraphFaults, is_mistake, reasons};
use crate::graphs::light_kinds;
use crate::graphs::method::{self, Method};
use crate::graphs::planning::Capabilities;
use crate::graphs::preset::{self, Preset, RAY_COUNT, STATUS, VISIBILITY};
use crate::sink::Sink;
use itertools::Itertools;
use skiagraph_gpu::Content;
use skiagraph_graph::{Code, Diagnostic, Diagnostics, Sources};
use skiagraph_passes::SceneProvider;
use skiagraph_reference::{Class, GroundTruthPixels, image::Shown, statistics::status};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Loads graphs by names or paths, and refuses those that are not shadow methods: the output
/// `visibility` is missing, or a kind of light is unknown.
///
/// # Errors
/// The faults of all graphs together; those of [`preset::load_each`].
pub fn load_all(names: &[String], sources: &dyn Sources) -> Result<Vec<Arc<Preset>>> {
    preset::sound(load_each(names, sources)?)
}

/// Loads graphs by names or paths, as [`load_all`] does; one with faults, or that is not a shadow
/// method, becomes a preset that cannot be planned ([`Preset::faults`]).
///
/// # Errors
/// Those of [`preset::load_each`].
pub fn load_each(names: &[String], sources: &dyn Sources) -> Result<Vec<Arc<Preset>>> {
    let mut presets = preset::load_each(names, sources)?;
    for preset in presets.iter_mut().filter_map(Arc::get_mut) {
        if preset.faults.is_none() {
            let mistake = light_kinds::unknown(&preset.graph);
            let mistake = mistake.or_else(|| missing_output(preset));
            preset.faults = mistake.map(Into::into);
        }
    }
    Ok(presets)
}

/// Loads the shadow methods that `words` name, such as `nsm` or `crsm@n=1`
/// ([`MethodArgument`](crate::graphs::argument::MethodArgument)). `params` are set in every method
/// that has them. A value may be a list, `1,2,4`, or a range, `0..0.01/5`
/// ([`variants`](crate::graphs::variants)); each combination is a setting. Each method is returned
/// once for each setting, and for each of `map_sizes`, widths of the shadow map in texels. A method
/// without a shadow map or whose word sets `map_size`, or any method if `map_sizes` is empty, is
/// returned once for each setting. The list is ordered by word, then by setting, then by map size;
/// equal words count once.
///
/// # Errors
/// The errors of [`method::load`]; graphs that are not shadow methods.
pub fn load_methods(
    words: &[impl AsRef<str>],
    params: &[Assignment],
    map_sizes: &[u32],
    sources: &dyn Sources,
) -> Result<Vec<Method>> {
    method::load(words, params, map_sizes, sources, load_all)
}

/// Tells which methods can be planned on an adapter, in any of several viewports or scenes.
#[derive(Default)]
pub struct PlanCheck {
    /// The first refusal of each method, by its name and map size; the first mistake, if there is
    /// one.
    refusals: BTreeMap<MethodKey, Diagnostics>,
    planned: BTreeSet<MethodKey>,
    mistakes: Vec<Diagnostic>,
}

type MethodKey = (String, Option<u32>);

impl PlanCheck {
    /// Plans methods in all viewports on an adapter, with the scene and light of `provider`.
    pub fn add<'m>(
        &mut self,
        methods: impl IntoIterator<Item = &'m Method>,
        viewports: &[[u32; 2]],
        provider: &SceneProvider,
        device: &Capabilities,
    ) {
        for (method, &viewport) in methods.into_iter().cartesian_product(viewports) {
            let key = (method.name.clone(), method.map_size);
            let names = method.preset.diagnostics();
            let diagnostics = || method.plan_of(&names, viewport, device.clone(), provider);
            let plan = method.plan(viewport, device.clone(), provider);
            let mistake = match plan {
                Ok(_) => {
                    self.planned.insert(key);
                    diagnostics().err()
                }
                Err(refusal) => {
                    let first = self.refusals.entry(key);
                    let first = first.or_insert_with(|| refusal.clone());
                    if is_mistake(refusal.iter()) && !is_mistake(first.iter()) {
                        first.clone_from(&refusal);
                    }
                    Some(refusal)
                }
            };
            let mistake = mistake.filter(|faults| is_mistake(faults.iter()));
            let mistakes = mistake.iter().flat_map(Diagnostics::iter);
            self.mistakes.extend(mistakes.cloned());
        }
    }

    /// Tells the sink the mistakes of documents, each once, if any method can be planned. Otherwise
    /// returns the reasons why none can.
    pub fn end(&self, sink: &dyn Sink) -> GraphFaults {
        let mut faults = GraphFaults::default();
        if self.planned.is_empty() {
            for ((name, _), refusal) in &self.refusals {
                faults.add(name, refusal);
            }
            return faults;
        }
        let mistakes = self.mistakes.iter().cloned();
        let mistakes = mistakes.unique_by(|mistake| (mistake.brief(), mistake.help.clone()));
        let mistakes: Vec<Diagnostic> = mistakes.collect();
        if !mistakes.is_empty() {
            sink.warnings(&mistakes);
        }
        faults
    }

    /// True if a document has mistakes, be it only in an output that describes its shadow map.
    pub fn has_mistakes(&self) -> bool {
        !self.mistakes.is_empty()
    }

    /// Returns why a method could nowhere be planned, and whether its document is at fault; `None`
    /// if it could be somewhere.
    pub fn refusal(&self, method: &Method) -> Option<(String, bool)> {
        let key = (method.name.clone(), method.map_size);
        let refusal = self.refusals.get(&key)?;
        let is_refused = !self.planned.contains(&key);
        is_refused.then(|| (reasons(refusal.iter()), is_mistake(refusal.iter())))
    }
}

/// True if a method computes the shadows of all lights in one frame: its output `visibility` has
/// several layers, one for each light. False if the method cannot be planned on `device`.
pub fn is_layered(method: &Method, device: &Capabilities, provider: &SceneProvider) -> bool {
    let plan = method.plan(method.viewport, device.clone(), provider);
    plan.is_ok_and(|plan| layers(&plan) > 1)
}

/// Returns the mistake of a graph without the output `visibility`.
fn missing_output(preset: &Preset) -> Option<Diagnostic> {
    if preset.graph.outputs().contains(&VISIBILITY) {
        return None;
    }
    let what = format!(
        "`{}` has no output `{VISIBILITY}`, so it cannot be compared",
        preset.name
    );
    Some(Diagnostic::error(Code::Output, what).help(format!(
        "a shadow method declares\n  \
         outputs: [\"{VISIBILITY}\"] or [\"{VISIBILITY}\", \"{STATUS}\"]\n\
         {VISIBILITY}: per pixel 0 in shadow to 1 in light, {INTEGERS} for a hard answer, 0 or 1, \
         or {FLOATS} for a graded one\n\
         {STATUS}: per pixel 0 background, 1 facing away from the light, 2 certain light, \
         3 certain shadow, 4 uncertain, {INTEGERS}; without it the reference says what faces the \
         light, and all else counts as certain\n\
         all of the viewport's size",
    )))
}

/// Decoded outputs of one frame under one light. Each list has one entry per pixel, row by row from
/// the top left.
pub struct Outputs {
    /// Visibility of each pixel: 0 in shadow, 1 lit. A share of light of 0.5 or more counts as lit.
    pub visibility: Vec<u32>,
    /// Share of the light that reaches each pixel, 0 to 1 unless the method is faulty; `None` if
    /// the method answers only 0 or 1.
    pub shares: Option<Vec<f32>>,
    /// Status of each pixel: 0 background, 1 facing away from the light, 2 certainly lit, 3
    /// certainly in shadow, 4 uncertain (the shadow map does not decide it).
    pub status: Vec<u32>,
    /// Number of rays traced in the frame; `None` if the graph does not count them.
    pub rays: Option<u64>,
}

impl Outputs {
    /// Decodes the outputs that were read back from a frame, for one light. `layer` is the index of
    /// the layer that is read of outputs with several
    /// ([`layer_of`](crate::graphs::contract::layer_of)); an output of one layer holds for every
    /// light. If the graph has no output `status`, the [reference](crate#terms) `truth` of the same
    /// view says which pixels face the light, and these count as certainly lit or certainly in
    /// shadow.
    ///
    /// # Errors
    /// An output that is not there or not in one of the allowed formats.
    pub fn from_contents(
        mut contents: BTreeMap<String, Content>,
        layer: usize,
        truth: &GroundTruthPixels,
    ) -> Result<Self, String> {
        let mut output = |name: &str| Some(of_layer(contents.remove(name)?, layer));
        let shown = output(VISIBILITY);
        let shares = shown.as_ref().and_then(Content::as_f32);
        let visibility = match &shares {
            Some(shares) => Some(lit(shares)),
            None => shown.as_ref().and_then(Content::as_u32),
        };
        let visibility = visibility.ok_or("`visibility` cannot be read as numbers")?;
        let status = match output(STATUS).map(|status| status.as_u32()) {
            Some(status) => status.ok_or("`status` cannot be read as integers")?,
            None => certain(&visibility, truth),
        };
        let rays = output(RAY_COUNT).as_ref().and_then(Content::as_u32);
        Ok(Self {
            visibility,
            shares,
            status,
            rays: rays.and_then(|count| count.first().copied()).map(u64::from),
        })
    }

    /// Creates outputs from [shares of light](crate#terms), 0 to 1, one per pixel. There is no
    /// `status`: pixels that face the light by the [reference](crate#terms) `truth` count as
    /// certainly lit or certainly in shadow. If each share is 0 or 1, the answer is hard, and
    /// [`shares`](Self::shares) is `None`.
    pub fn from_shares(shares: Vec<f32>, truth: &GroundTruthPixels) -> Self {
        let is_hard = shares.iter().all(|share| matches!(share, 0.0 | 1.0));
        let visibility = lit(&shares);
        Self {
            status: certain(&visibility, truth),
            visibility,
            shares: (!is_hard).then_some(shares),
            rays: None,
        }
    }

    /// Returns the [share of light](crate#terms) that each pixel shows, 0 to 1: the method's
    /// shares, or exactly 0 or 1 if it answers only 0 or 1.
    pub fn shown(&self) -> Cow<'_, [f32]> {
        match &self.shares {
            Some(shares) => Cow::Borrowed(shares),
            None => Cow::Owned(self.visibility.iter().map(|&lit| lit.share()).collect()),
        }
    }
}

/// Counts a pixel as lit if it sees half of the light or more.
fn lit(shares: &[f32]) -> Vec<u32> {
    let lit = shares.iter().map(|share| u32::from(*share >= 0.5));
    lit.collect()
}

/// Returns a layer of an output; the whole output if it has one layer.
pub(crate) fn of_layer(content: Content, layer: usize) -> Content {
    let mut layers = content.split();
    match layers.len() {
        0 | 1 => content,
        count => layers.swap_remove(layer.min(count - 1)),
    }
}

/// The status of a method that has none.
fn certain(visibility: &[u32], truth: &GroundTruthPixels) -> Vec<u32> {
    let verdict = |(&class, &visibility): (&Class, &u32)| match (class, visibility) {
        (Class::Background, _) => status::BACKGROUND,
        (Class::FacingAway, _) => status::FACING_AWAY,
        (Class::Unshadowed, _) => status::CERTAIN_LIGHT,
        (_, 0) => status::CERTAIN_SHADOW,
        _ => status::CERTAIN_LIGHT,
    };
    truth.classes.iter().zip(visibility).map(verdict).collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use wgpu::TextureFormat as F;

    /// A pixel of each class.
    pub(crate) fn truth() -> GroundTruthPixels {
        GroundTruthPixels {
            viewport: [4, 1],
            classes: vec![
                Class::Shadow,
                Class::Lit,
                Class::FacingAway,
                Class::Background,
            ],
            indeterminate: vec![false; 4],
            n_dot_l: vec![0.5; 4],
            base_colors: Vec::new(),
        }
    }

    fn texture(format: F, bytes: &[u8]) -> Content {
        Content::Texture {
            format,
            parts: vec![[4, 1]],
            bytes: bytes.to_vec(),
        }
    }

    fn contents(visibility: Content, status: Option<Content>) -> BTreeMap<String, Content> {
        let status = status.map(|status| (STATUS.to_owned(), status));
        let visibility = (VISIBILITY.to_owned(), visibility);
        [visibility].into_iter().chain(status).collect()
    }

    #[test]
    fn integers_are_hard_and_floats_are_graded() {
        let status = || Some(texture(F::R8Uint, &[3, 2, 1, 0]));
        let hard = texture(F::R8Uint, &[0, 1, 0, 0]);
        let floats = [0.25f32, 0.5, 0.0, f32::NAN];
        let graded = floats.iter().flat_map(|share| share.to_le_bytes());
        let graded = texture(F::R32Float, &graded.collect::<Vec<_>>());
        let eighths = texture(F::R8Unorm, &[51, 255, 0, 0]);
        for (visibility, shares) in [
            (hard, None),
            (graded, Some([0.25, 0.5])),
            (eighths, Some([0.2, 1.0])),
        ] {
            let outputs =
                Outputs::from_contents(contents(visibility, status()), 0, &truth()).unwrap();
            assert_eq!(outputs.visibility, [0, 1, 0, 0]);
            assert_eq!(outputs.status, [3, 2, 1, 0]);
            let first = outputs.shares.as_ref().map(|shares| [shares[0], shares[1]]);
            assert_eq!(first, shares);
            let shown = outputs.shown();
            assert_eq!([shown[0], shown[1]], shares.unwrap_or([0.0, 1.0]));
        }
    }

    #[test]
    fn without_a_status_the_reference_says_what_faces_the_light() {
        let hard = texture(F::R8Uint, &[1, 0, 1, 0]);
        let outputs = Outputs::from_contents(contents(hard, None), 0, &truth()).unwrap();
        assert_eq!(outputs.status, [2, 3, 1, 0]);
    }

    #[test]
    fn a_missing_output_is_named() {
        let missing = Outputs::from_contents(BTreeMap::new(), 0, &truth()).err();
        assert!(missing.unwrap().contains("visibility"));
        let status = Some(texture(F::R8Unorm, &[0; 4]));
        let wrong =
            Outputs::from_contents(contents(texture(F::R8Uint, &[0; 4]), status), 0, &truth());
        assert!(wrong.err().unwrap().contains("status"));
    }
}
