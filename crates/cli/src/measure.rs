//! One method on one view: run it, time it, judge it, picture it.

use crate::{
    contract::Outputs,
    date,
    error::CliError,
    fingerprint::Fingerprint,
    parse::{Assignment, unique},
    picture,
    preset::{self, Preset},
    progress::Step,
    render::{self, Abilities, Times},
    results::{Cached, Images, Measured, Run},
};
use skiagraph_graph::{
    Diagnostic, Diagnostics, ExecuteError, Executor, Param, ParamValue, Plan, PlanRequest,
    Provider, Severity, gpu::Gpu,
};
use skiagraph_reference::{Image, Reference, Statistics};
use std::{collections::BTreeMap, path::Path};

/// A preset with the params that it runs with.
pub struct Method<'a> {
    /// The preset.
    pub preset: &'a Preset,
    /// Its params that are not at their defaults.
    pub params: BTreeMap<String, ParamValue>,
    /// The size of its shadow map, if it has that param.
    pub map_size: Option<u32>,
}

impl<'a> Method<'a> {
    /// Of a preset and what was set of its params.
    pub fn new(preset: &'a Preset, params: BTreeMap<String, ParamValue>) -> Self {
        let default = || {
            preset
                .graph
                .params()
                .iter()
                .find(|param| param.name.as_str() == preset::MAP_SIZE)
                .map(|p| &p.default)
        };
        let map_size = match params.get(preset::MAP_SIZE).or_else(default) {
            Some(ParamValue::U32(size)) => Some(*size),
            _ => None,
        };
        Self {
            preset,
            params,
            map_size,
        }
    }

    /// The plan on a viewport for an adapter with these limits and features.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn plan(
        &self,
        viewport: [u32; 2],
        abilities: Abilities,
        provider: &dyn Provider,
    ) -> Result<Plan, Diagnostics> {
        let mut request = PlanRequest::new(viewport, provider);
        request.params = self.params.clone();
        abilities.ask(&mut request);
        self.preset.graph.plan(&request)
    }

    /// Of all that a run on a scene and view depends on, but the params.
    pub fn fingerprint(&self, scene: Fingerprint) -> String {
        scene.with_all(self.preset.fingerprint).to_string()
    }

    /// All params with the values that it runs with.
    pub fn all_params(&self) -> BTreeMap<String, serde_json::Value> {
        let params = self.preset.graph.params().iter();
        let value = |param: &Param| {
            json(
                self.params
                    .get(param.name.as_str())
                    .unwrap_or(&param.default),
            )
        };
        params
            .map(|param| (param.name.to_string(), value(param)))
            .collect()
    }
}

/// Each preset with each map size; a preset without that param once.
///
/// # Errors
/// A value that a param cannot take, and a name that no preset has.
pub fn methods<'a>(
    presets: &'a [Preset],
    params: &[Assignment],
    map_sizes: &[u32],
) -> Result<Vec<Method<'a>>, CliError> {
    preset::check_names(presets, params)?;
    let mut methods = Vec::new();
    for preset in presets {
        let mut sizes: Vec<Option<u32>> = unique(map_sizes).into_iter().map(Some).collect();
        if sizes.is_empty() || !preset::has_param(preset, preset::MAP_SIZE) {
            sizes = vec![None];
        }
        for size in sizes {
            methods.push(Method::new(preset, preset::params(preset, params, size)?));
        }
    }
    Ok(methods)
}

/// A param's value for `results.json`. An f32 is written as the short decimal that it was read from, not as the f64
/// nearest to it.
fn json(value: &ParamValue) -> serde_json::Value {
    let float = |value: &f32| value.to_string().parse::<f64>().unwrap_or(f64::NAN);
    match value {
        ParamValue::F32(number) => float(number).into(),
        ParamValue::Vec(numbers) => numbers.iter().map(float).collect(),
        ParamValue::I32(number) => (*number).into(),
        ParamValue::U32(number) => (*number).into(),
        ParamValue::Bool(flag) => (*flag).into(),
        ParamValue::Choice(word) => word.as_str().into(),
    }
}

/// What all methods on one view and viewport share.
pub struct Setting<'a> {
    /// The GPU.
    pub gpu: &'a Gpu,
    /// Whether its timestamps are true.
    pub timestamps: bool,
    /// Name of the view.
    pub view: &'a str,
    /// Of mesh, light and view.
    pub fingerprint: Fingerprint,
    /// The right answer.
    pub reference: &'a Reference,
    /// Timed frames.
    pub frames: u32,
    /// Frames before them.
    pub warmup: u32,
    /// Timed frames in which only the camera moves.
    pub cached_frames: u32,
    /// Folder for pictures, if there are to be any.
    pub pictures: Option<&'a Path>,
}

impl Setting<'_> {
    /// Runs a method. One that this adapter cannot run yields a [`Run`] that says why.
    ///
    /// # Errors
    /// Ctrl-C, a lost device, outputs that break the contract ([`CliError::Contract`]), a picture that cannot be written.
    pub fn measure(&self, method: &Method, provider: &mut dyn Provider) -> Result<Run, CliError> {
        let viewport = self.reference.viewport;
        let plan = match method.plan(viewport, render::abilities(self.gpu), provider) {
            Ok(plan) => plan,
            // The graph itself is sound: that was checked before anything ran.
            Err(diagnostics) => return Ok(self.unavailable(method, reasons(&diagnostics))),
        };
        let what = format!("{}, {}", method.preset.name, self.where_(method));
        let step = Step::begin(
            what,
            u64::from(self.warmup) + u64::from(self.frames),
            "frames",
        );
        let executed = self.execute(method, plan, provider, &step);
        let run = match executed {
            Ok(Some(executed)) => Run {
                measured: Some(self.judge(method, executed)?),
                ..self.empty(method)
            },
            Ok(None) => {
                return Err(CliError::Interrupted {
                    kept: String::new(),
                });
            }
            Err(error) if render::is_fatal(&error) => {
                return Err(render::failed(&method.preset.name, error));
            }
            Err(error) => self.unavailable(method, render::explain(&error)),
        };
        step.end();
        Ok(run)
    }

    /// A run that says why there are no measurements.
    pub fn unavailable(&self, method: &Method, reason: String) -> Run {
        Run {
            unavailable: Some(reason),
            ..self.empty(method)
        }
    }

    fn execute(
        &self,
        method: &Method,
        plan: Plan,
        provider: &mut dyn Provider,
        step: &Step,
    ) -> Result<Option<Executed>, ExecuteError> {
        let memory = (plan.memory_bytes(), plan.saved_bytes());
        let mut executor = Executor::new(&self.gpu.device, &self.gpu.queue, plan, provider)?;
        let times = render::time(
            self.gpu,
            &mut executor,
            self.warmup,
            self.frames,
            |frames| step.reach(frames),
        )?;
        let Some(times) = times else { return Ok(None) };
        let cached = render::cached(self.gpu, &mut executor, self.cached_frames)?;
        let Some(cached) = cached else {
            return Ok(None);
        };
        // Only now: a readback would be timed, too.
        let contents = render::read(self.gpu, &mut executor, &Outputs::names(method.preset))?;
        Ok(Some(Executed {
            times,
            cached,
            outputs: Outputs::decode(&contents),
            memory,
        }))
    }

    fn judge(&self, method: &Method, executed: Executed) -> Result<Measured, CliError> {
        let Executed {
            mut times,
            mut cached,
            outputs,
            memory: (memory_bytes, saved_bytes),
        } = executed;
        let (outputs, counts) = judged(method.preset, outputs, self.reference)?;
        if !self.timestamps {
            times.frame.gpu_ms = None;
            cached
                .iter_mut()
                .for_each(|cached| cached.frame.gpu_ms = None);
            times.passes.iter_mut().for_each(|pass| pass.gpu_ms = None);
        }
        Ok(Measured {
            certain: counts.certain,
            uncertain: counts.uncertain,
            split: counts.split,
            rays: outputs.rays,
            wrong: counts.wrong,
            facing_mismatch: counts.facing_mismatch,
            passes: times.passes,
            frame: times.frame,
            cached,
            memory_bytes,
            saved_bytes,
            images: match self.pictures {
                None => None,
                Some(folder) => {
                    let stem = stem(method, self.view, self.reference.viewport);
                    Some(save_pictures(
                        folder,
                        &stem,
                        self.reference,
                        &outputs,
                        &counts,
                    )?)
                }
            },
        })
    }

    /// The run with nothing measured.
    fn empty(&self, method: &Method) -> Run {
        let counts = Statistics::judged(
            &self.reference.visibility(),
            &self.reference.status(),
            self.reference,
        );
        // The reference's own buffers are as large as the reference and hold the contract's values.
        let counts = counts.unwrap_or_default();
        Run {
            preset: method.preset.name.clone(),
            view: self.view.into(),
            viewport: self.reference.viewport,
            map_size: method.map_size,
            params: method.all_params(),
            fingerprint: method.fingerprint(self.fingerprint),
            date: date::today(),
            pixels: counts.pixels,
            band: counts.band,
            measured: None,
            unavailable: None,
            published: Vec::new(),
        }
    }

    /// View, viewport and map size as in progress lines.
    fn where_(&self, method: &Method) -> String {
        place(method, self.view, self.reference.viewport)
    }
}

/// A frame's outputs beside the reference.
///
/// # Errors
/// [`CliError::Contract`] where they are not what a shadow method's must be.
pub fn judged(
    preset: &Preset,
    outputs: Result<Outputs, String>,
    reference: &Reference,
) -> Result<(Outputs, Statistics), CliError> {
    let broken = |reason: String| {
        let name = &preset.name;
        CliError::Contract(format!("`{name}` breaks the contract of outputs: {reason}"))
    };
    let outputs = outputs.map_err(broken)?;
    let counts = Statistics::judged(&outputs.visibility, &outputs.status, reference)
        .map_err(|error| broken(error.to_string()))?;
    Ok((outputs, counts))
}

/// Writes the pictures of a frame, their names beginning with `stem`.
///
/// # Errors
/// One cannot be written.
pub fn save_pictures(
    folder: &Path,
    stem: &str,
    reference: &Reference,
    outputs: &Outputs,
    counts: &Statistics,
) -> Result<Images, CliError> {
    let (visibility, status) = (&outputs.visibility, &outputs.status);
    let save = |kind: &str, image| save_picture(folder, format!("{stem}-{kind}.png"), image);
    Ok(Images {
        shaded: save("shaded", Image::shaded(visibility, reference))?,
        visibility: save(
            "visibility",
            Image::visibility(reference.viewport, visibility, status),
        )?,
        error: save("error", Image::error(visibility, status, reference))?,
        uncertain: match counts.certain.lit + counts.certain.shadow + counts.uncertain {
            0 => None,
            _ => {
                let image = Image::uncertain(visibility, status, reference);
                Some(save("uncertain", image)?)
            }
        },
    })
}

/// Writes the picture of the reference, its name beginning with `stem`.
///
/// # Errors
/// It cannot be written.
pub fn save_reference(folder: &Path, stem: &str, reference: &Reference) -> Result<(), CliError> {
    let (visibility, status) = (reference.visibility(), reference.status());
    let image = Image::visibility(reference.viewport, &visibility, &status);
    save_picture(folder, format!("{stem}-visibility.png"), image).map(|_| ())
}

fn save_picture(
    folder: &Path,
    name: String,
    image: Result<Image, skiagraph_reference::Error>,
) -> Result<String, CliError> {
    let image = image.map_err(|error| CliError::Input(format!("no picture {name}: {error}")))?;
    picture::save(&folder.join(&name), &image)?;
    Ok(name)
}

/// Refuses pictures that would overwrite each other, before anything runs: what the name of each begins with, and whose they are.
///
/// # Errors
/// Names both owners; `option` is what says where pictures go.
pub fn check_stems(
    stems: impl IntoIterator<Item = (String, String)>,
    option: &str,
) -> Result<(), CliError> {
    let mut owners: BTreeMap<String, String> = BTreeMap::new();
    for (stem, owner) in stems {
        if let Some(other) = owners.get(&stem) {
            return Err(CliError::Input(format!(
                "the pictures of {other} and of {owner} would overwrite each other: both are called {stem}-….png\n  rename one, or run them one after the other with another {option}"
            )));
        }
        owners.insert(stem, owner);
    }
    Ok(())
}

fn place(method: &Method, view: &str, [width, height]: [u32; 2]) -> String {
    let map = method
        .map_size
        .map_or(String::new(), |size| format!(" map{size}"));
    format!("{} {width}x{height}{map}", slug(view))
}

/// What the names of a run's pictures begin with.
pub fn stem(method: &Method, view: &str, viewport: [u32; 2]) -> String {
    format!(
        "{}-{}",
        slug(&method.preset.name),
        place(method, view, viewport).replace(' ', "-")
    )
}

/// What the name of the reference's picture begins with.
pub fn reference_stem(view: &str, [width, height]: [u32; 2]) -> String {
    format!("reference-{}-{width}x{height}", slug(view))
}

/// The errors in one line each, for a table's footnote; of a help only its first line.
pub fn reasons(diagnostics: &Diagnostics) -> String {
    let errors = diagnostics
        .iter()
        .filter(|diagnostic| diagnostic.severity == Severity::Error);
    let lines: Vec<String> = errors
        .map(|Diagnostic { message, help, .. }| match help {
            Some(help) => {
                let help = help.lines().next().unwrap_or_default();
                format!("{message} ({help})")
            }
            None => message.clone(),
        })
        .collect();
    lines.join("; ")
}

struct Executed {
    times: Times,
    cached: Option<Cached>,
    outputs: Result<Outputs, String>,
    memory: (u64, u64),
}

/// A name as part of a file name: `my/method.ron` becomes `my-method`.
pub fn slug(name: &str) -> String {
    let stem = name.strip_suffix(".ron").unwrap_or(name);
    let text: String = stem
        .chars()
        .map(|c| {
            if c.is_alphanumeric() || matches!(c, '_' | '.') {
                c
            } else {
                '-'
            }
        })
        .collect();
    text.trim_matches(['-', '.']).replace("--", "-")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slugs_are_file_names() {
        let slugs = ["nsm", "pipelines/nsm.ron", "/tmp/a b/../x.ron", "Größe 1"].map(slug);
        assert_eq!(slugs, ["nsm", "pipelines-nsm", "tmp-a-b-..-x", "Größe-1"]);
    }
}
