//! Methods: presets with the values of their params.
//!
//! ```
//! use skiagraph_compare::graphs::method::{Method, load_one};
//! use skiagraph_passes::EmbeddedSources;
//!
//! let (preset, params) = load_one("nsm@cull=front", &[], Some(512), &EmbeddedSources)?;
//! let method = Method::new(preset, params).at([640, 360]);
//! assert_eq!(method.map_size, Some(512));
//! assert_eq!(method.all_params()["cull"], "front");
//! # Ok::<(), skiagraph_compare::error::CompareError>(())
//! ```

use crate::error::{CompareError, Result};
use crate::files::fingerprint::Fingerprint;
use crate::graphs::argument::{Assignment, MethodArgument};
use crate::graphs::planning::Capabilities;
use crate::graphs::preset::{self, Preset};
use crate::graphs::variants::{self, MAP_SIZE, Setting};
use crate::graphs::{contract, openings};
use crate::lists::unique;
use crate::wording::unknown;
use itertools::Itertools;
use skiagraph_gpu::Provider;
use skiagraph_graph::{Diagnostics, ParamValue, Plan, Sources};
use std::{collections::BTreeMap, slice, sync::Arc};

/// Values of a graph's params, by the names of the params.
pub type ParamValues = BTreeMap<String, ParamValue>;

/// A method: a [`Preset`] (a loaded graph) with the params, viewport and adapter features that it
/// runs with.
#[derive(Clone)]
pub struct Method {
    /// Name of the method in results: the preset's name, with the assignments that tell this
    /// setting of its params from others in the same comparison, such as `crsm@n=1`.
    pub name: String,
    /// The preset, with its graph.
    pub preset: Arc<Preset>,
    /// Values of the params that are set; all others have their defaults. A change here does not
    /// reach [`value`](Self::value) and [`map_size`](Self::map_size): create a new method instead.
    pub params: ParamValues,
    /// Width and height of the viewport in pixels.
    pub viewport: [u32; 2],
    /// Features of the adapter that the method runs on. The default values of params may depend on
    /// them.
    pub features: wgpu::Features,
    /// All params; a default may depend on the viewport, and on what the adapter can do.
    values: ParamValues,
    /// Width and height of the shadow map in texels (the param `map_size`); `None` if the graph has
    /// no such param.
    pub map_size: Option<u32>,
}

impl Method {
    /// Creates a method of a preset with `params`, in 1024×1024 pixels on an adapter with all
    /// features. The method is named like the preset ([`on`](Self::on)).
    pub fn new(preset: Arc<Preset>, params: ParamValues) -> Self {
        Self::on(preset, params, [1024, 1024], wgpu::Features::all())
    }

    /// Creates a method of a preset with `params`, for a viewport in pixels on an adapter with
    /// `features`. Params are checked when the method is planned. The method is named like the
    /// preset, without `params`: results are kept by name, so give each of several settings of a
    /// preset a name of its own with [`named`](Self::named).
    pub fn on(
        preset: Arc<Preset>,
        params: ParamValues,
        viewport: [u32; 2],
        features: wgpu::Features,
    ) -> Self {
        // Planning the method tells what is wrong with a value.
        let values = preset.graph.values(&params, viewport, features);
        let values = values.unwrap_or_default();
        let map_size = match values.get(MAP_SIZE) {
            Some(ParamValue::U32(size)) => Some(*size),
            _ => None,
        };
        Self {
            name: preset.name.clone(),
            preset,
            params,
            viewport,
            features,
            values,
            map_size,
        }
    }

    /// Returns the method with another name in results.
    pub fn named(mut self, name: &str) -> Self {
        self.name = name.to_owned();
        self
    }

    /// Returns the method for an adapter with these features. Params that are not set get their
    /// defaults on it.
    pub fn settled(self, features: wgpu::Features) -> Self {
        Self::on(self.preset, self.params, self.viewport, features).named(&self.name)
    }

    /// Returns the method for another viewport, in pixels. Params that are not set get their
    /// defaults in it.
    pub fn at(&self, viewport: [u32; 2]) -> Self {
        let params = self.params.clone();
        Self::on(self.preset.clone(), params, viewport, self.features).named(&self.name)
    }

    /// Returns the method with these values of params in the place of those that it sets.
    pub fn with(&self, params: ParamValues) -> Self {
        Self::on(self.preset.clone(), params, self.viewport, self.features).named(&self.name)
    }

    /// Plans the method for a viewport in pixels, an adapter and the scene of `provider`, with only
    /// the outputs by which methods are judged ([`Preset::judged`]). Other outputs would only cost
    /// time.
    ///
    /// # Errors
    /// All faults of the graph and its params under these conditions; outputs whose size or format
    /// a shadow method must not have ([`contract::check_outputs`]).
    pub fn plan(
        &self,
        viewport: [u32; 2],
        capabilities: Capabilities,
        provider: &dyn Provider,
    ) -> Result<Plan, Diagnostics> {
        self.plan_of(&self.preset.judged(), viewport, capabilities, provider)
    }

    /// Plans the method for a viewport in pixels, an adapter and the scene of `provider`, with only
    /// the outputs named in `outputs`. Params that are not set have their defaults under these
    /// conditions: call [`at`](Self::at) and [`settled`](Self::settled) first, and
    /// [`value`](Self::value) and [`map_size`](Self::map_size) agree with the plan.
    ///
    /// # Errors
    /// Those of [`plan`](Self::plan).
    pub fn plan_of(
        &self,
        outputs: &[&str],
        viewport: [u32; 2],
        capabilities: Capabilities,
        provider: &dyn Provider,
    ) -> Result<Plan, Diagnostics> {
        let mut request = capabilities.request(viewport, provider);
        request.params = self.params.clone();
        request.outputs = Some(outputs.iter().map(|&name| name.to_owned()).collect());
        let plan = self.preset.plan_quietly(&request)?;
        contract::check_outputs(&self.preset.name, &plan, provider)?;
        Ok(plan)
    }

    /// Returns a hash, as 16 hexadecimal digits, of everything that a run of the method depends on,
    /// except for the params: of `scene`, the hash of scene and view, and of the preset's files.
    pub fn fingerprint(&self, scene: Fingerprint) -> String {
        scene.with_all(self.preset.fingerprint).to_string()
    }

    /// Returns the value that a param of the method runs with; `None` for an unknown name, and for
    /// every name if a value in [`params`](Self::params) is not allowed.
    pub fn value(&self, name: &str) -> Option<&ParamValue> {
        self.values.get(name)
    }

    /// Returns the values that were set for all methods of a comparison (`--set`): the entries of
    /// [`params`](Self::params), without the params in the method's name (`bias` in `nsm@bias=0`)
    /// and without `map_size`.
    pub fn given(&self) -> ParamValues {
        let words = self.name.split_once('@').map_or("", |(_, words)| words);
        let named = words.split(',').map(|word| word.split('=').next());
        let named = named.collect_vec();
        let mut given = self.params.clone();
        given.retain(|name, _| name != MAP_SIZE && !named.contains(&Some(name)));
        given
    }

    /// Returns all params, defaults included, with the values that the method runs with, as JSON
    /// values.
    pub fn all_params(&self) -> BTreeMap<String, serde_json::Value> {
        as_json(&self.values)
    }
}

/// Converts values of params, by name, into JSON values as results.json holds them.
pub fn as_json(values: &ParamValues) -> BTreeMap<String, serde_json::Value> {
    let entry = |(name, value): (&String, &ParamValue)| (name.clone(), json(value));
    values.iter().map(entry).collect()
}

/// A param's value for `results.json`. An f32 is written as the short decimal that it was read
/// from, not as the f64 nearest to it.
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

/// A function that loads presets by names or paths, such as [`preset::load_all`].
pub type Load = fn(&[String], &dyn Sources) -> Result<Vec<Arc<Preset>>>;

/// Loads the methods that `words` name (`crsm@n=1,depth=plane`, `my.ron@over=pcf`) with the
/// function `load`. Returns each method in each setting that its word and `params` list, and with
/// each of `map_sizes` (texels along an edge). If `map_sizes` is empty, the preset has no param
/// `map_size` or the word sets it, there is one method for each setting. A word whose document has
/// [`faults`](Preset::faults), if `load` keeps it, is one method, which cannot be planned.
///
/// # Errors
/// The errors of `load`; a value that a param cannot take, a param that no graph has.
pub fn load(
    words: &[impl AsRef<str>],
    params: &[Assignment],
    map_sizes: &[u32],
    sources: &dyn Sources,
    load: Load,
) -> Result<Vec<Method>> {
    let (arguments, params) = openings::arguments(words, params, sources)?;
    let presets = load(&variants::presets(&arguments), sources)?;
    methods(&presets, &arguments, &params, map_sizes)
}

/// Each method in each of its settings, with each map size; a preset without that param once.
///
/// # Errors
/// A value that a param cannot take, and a name that no preset has.
fn methods(
    presets: &[Arc<Preset>],
    arguments: &[MethodArgument],
    params: &[Assignment],
    map_sizes: &[u32],
) -> Result<Vec<Method>> {
    check_names(presets, params)?;
    let mut methods: Vec<Method> = Vec::new();
    for argument in unique(arguments) {
        let named = presets.iter().find(|preset| preset.name == argument.preset);
        let Some(preset) = named else {
            continue;
        };
        if preset.faults.is_some() {
            // Which params it has is not known.
            let name = argument.to_string();
            methods.push(Method::new(preset.clone(), ParamValues::new()).named(&name));
            continue;
        }
        let mut sizes = unique(map_sizes.iter().copied().map(Some));
        if sizes.is_empty() || preset.param(MAP_SIZE).is_none() {
            sizes = vec![None];
        }
        // The preset's name says then what stands in an open include of it.
        let is_over_another = !MethodArgument::new(&preset.name).own.is_empty();
        for Setting { label, set } in variants::settings(preset, argument, params)? {
            let name = match label.as_str() {
                "" => preset.name.clone(),
                label if is_over_another => format!("{},{label}", preset.name),
                label => format!("{}@{label}", preset.name),
            };

            let has_size = argument.own.iter().any(|own| own.name == MAP_SIZE);
            for &size in if has_size { &[None][..] } else { &sizes } {
                let params = param_values(preset, &set, size)?;
                methods.push(Method::new(preset.clone(), params).named(&name));
            }
        }
    }
    Ok(methods)
}

/// Loads the one graph that `word` names, such as `crsm@n=1`. Returns the preset, and the values of
/// the params that `word`, `params` and `map_size` (texels along an edge) set; a value in `word`
/// wins over one in `params`, and `map_size` over both.
///
/// # Errors
/// Faults of the graph; a param that it does not have; a value that a param cannot take; a list of
/// documents for an include whose document can be exchanged, as each would be a graph of its own.
pub fn load_one(
    word: &str,
    params: &[Assignment],
    map_size: Option<u32>,
    sources: &dyn Sources,
) -> Result<(Arc<Preset>, ParamValues)> {
    let (arguments, params) = openings::arguments([word], params, sources)?;
    let [argument] = &arguments[..] else {
        return Err(CompareError::Request(
            "name one document for an open include here".into(),
        ));
    };
    let mut presets = preset::load_all(slice::from_ref(&argument.preset), sources)?;
    check_names(&presets, &params)?;
    let none = || CompareError::Input("no graph".into());
    let preset = presets.pop().ok_or_else(none)?;
    let set = [&params[..], &argument.own].concat();
    check_names(slice::from_ref(&preset), &argument.own)?;
    let params = param_values(&preset, &set, map_size)?;
    Ok((preset, params))
}

/// Returns the values that `assignments` and `map_size` (texels along an edge) set for the params
/// of a preset; the last value of a param wins. Assignments to params that the preset does not have
/// are ignored.
///
/// # Errors
/// A value that a param cannot take; a map size for a preset without the param `map_size`.
pub fn param_values(
    preset: &Preset,
    assignments: &[Assignment],
    map_size: Option<u32>,
) -> Result<ParamValues> {
    let is_own = |set: &&Assignment| preset.param(&set.name).is_some();
    let own = assignments.iter().filter(is_own);
    let own = own.map(|set| (set.name.as_str(), set.value.clone()));
    let size = map_size.map(|size| (MAP_SIZE, size.to_string()));
    let parsed = own.chain(size).map(|(name, value)| {
        let value = preset.graph.parse_param(name, &value);
        let value = value.map_err(|error| CompareError::Input(error.to_string()))?;
        Ok((name.to_owned(), value))
    });
    parsed.collect()
}

/// Refuses an assignment that no preset has a param for. Where all have faults, none is known.
fn check_names(presets: &[Arc<Preset>], assignments: &[Assignment]) -> Result<()> {
    if presets.iter().all(|preset| preset.faults.is_some()) {
        return Ok(());
    }
    for Assignment { name, .. } in assignments {
        if presets.iter().any(|preset| preset.param(name).is_some()) {
            continue;
        }
        let params = presets.iter().flat_map(|preset| preset.settable());
        let mut params: Vec<&str> = params.sorted_unstable().dedup().collect();
        if params.is_empty() {
            params.push("none");
        }
        let faulty = presets.iter().find(|preset| preset.faults.is_some());
        let faulty = faulty.map(|preset| format!("; those of `{}` are unknown", preset.name));
        let what = format!("unknown param `{name}`{}", faulty.unwrap_or_default());
        return Err(CompareError::Input(unknown(&what, name, "params", &params)));
    }
    Ok(())
}
