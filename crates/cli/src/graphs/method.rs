//! A preset with the params that it runs with.

use crate::args::shared::MethodArgs;
use crate::args::values::{Assignment, unique};
use crate::error::CliError;
use crate::files::fingerprint::Fingerprint;
use crate::graphs::argument::MethodArgument;
use crate::graphs::openings;
use crate::graphs::planning::Capabilities;
use crate::graphs::preset::{self, Preset};
use crate::graphs::variants::{self, MAP_SIZE, Setting};
use crate::terminal::console::note;
use crate::wording::did_you_mean;
use skiagraph_gpu::Provider;
use skiagraph_graph::{Diagnostics, ParamValue, Plan, Sources};
use std::{collections::BTreeMap, slice};

/// Values of params, by their names.
pub type ParamValues = BTreeMap<String, ParamValue>;

/// A preset with the params that it runs with.
pub struct Method<'a> {
    /// The preset's name, with what tells this setting from its others: `crsm@n=1`.
    pub name: String,
    /// The preset.
    pub preset: &'a Preset,
    /// Its params that are not at their defaults.
    pub params: ParamValues,
    /// In how many pixels it runs.
    pub viewport: [u32; 2],
    /// Features of the adapter.
    pub features: wgpu::Features,
    /// All params; a default may depend on the viewport, and on what the adapter can do.
    values: ParamValues,
    /// The size of its shadow map, if it has that param.
    pub map_size: Option<u32>,
}

impl<'a> Method<'a> {
    /// Creates a method of a preset and the params set for it, in 1024×1024 pixels on the most able
    /// adapter.
    pub fn new(preset: &'a Preset, params: ParamValues) -> Self {
        Self::on(preset, params, [1024, 1024], wgpu::Features::all())
    }

    /// Creates a method of a preset and the params set for it, in so many pixels on an adapter with
    /// these features.
    pub fn on(
        preset: &'a Preset,
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

    /// The same under another name.
    pub fn named(self, name: &str) -> Self {
        Self {
            name: name.to_owned(),
            ..self
        }
    }

    /// The same on an adapter with these features.
    pub fn settled(self, features: wgpu::Features) -> Self {
        Self::on(self.preset, self.params, self.viewport, features).named(&self.name)
    }

    /// The same in so many pixels.
    pub fn at(&self, viewport: [u32; 2]) -> Self {
        let params = self.params.clone();
        Self::on(self.preset, params, viewport, self.features).named(&self.name)
    }

    /// The plan on a viewport for such an adapter, of the outputs that are judged: what else the
    /// graph shows would only cost time.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn plan(
        &self,
        viewport: [u32; 2],
        capabilities: Capabilities,
        provider: &dyn Provider,
    ) -> Result<Plan, Diagnostics> {
        let mut request = capabilities.request(viewport, provider);
        request.params = self.params.clone();
        let judged = self.preset.judged().into_iter();
        request.outputs = Some(judged.map(str::to_owned).collect());
        self.preset.graph.plan(&request)
    }

    /// Hashes everything that a run on a scene and view depends on, but the params.
    pub fn fingerprint(&self, scene: Fingerprint) -> String {
        scene.with_all(self.preset.fingerprint).to_string()
    }

    /// All params with the values that it runs with.
    pub fn all_params(&self) -> BTreeMap<String, serde_json::Value> {
        let entry = |(name, value): (&String, &ParamValue)| (name.clone(), json(value));
        self.values.iter().map(entry).collect()
    }
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

/// Each method in each of its settings, with each map size; a preset without that param once.
///
/// # Errors
/// A value that a param cannot take, and a name that no preset has.
pub fn methods<'a>(
    presets: &'a [Preset],
    arguments: &[MethodArgument],
    params: &[Assignment],
    map_sizes: &[u32],
) -> Result<Vec<Method<'a>>, CliError> {
    check_names(presets, params)?;
    let mut methods: Vec<Method> = Vec::new();
    for argument in unique(arguments) {
        let named = presets.iter().find(|preset| preset.name == argument.preset);
        let Some(preset) = named else {
            continue;
        };
        let mut sizes: Vec<Option<u32>> = unique(map_sizes).into_iter().map(Some).collect();
        if sizes.is_empty() || preset.param(MAP_SIZE).is_none() {
            sizes = vec![None];
        }
        for Setting { label, set } in variants::settings(preset, &argument, params)? {
            let name = match label.as_str() {
                "" => preset.name.clone(),
                label if is_over_another(&preset.name) => format!("{},{label}", preset.name),
                label => format!("{}@{label}", preset.name),
            };
            let set = set
                .into_iter()
                .map(|(name, value)| Assignment { name, value });
            let set: Vec<Assignment> = set.collect();
            let has_size = argument.own.iter().any(|own| own.name == MAP_SIZE);
            for &size in if has_size { &[None][..] } else { &sizes } {
                let params = param_values(preset, &set, size)?;
                methods.push(Method::new(preset, params).named(&name));
            }
        }
    }
    Ok(methods)
}

/// True if a preset's name says what stands in an open include of it.
fn is_over_another(name: &str) -> bool {
    !MethodArgument::new(name).own.is_empty()
}

/// Says on which methods `--map-size` has no effect.
pub fn note_without_map(methods: &[Method], map_sizes: &[u32]) {
    let without = methods.iter().filter(|method| method.map_size.is_none());
    let without: Vec<&str> = without.map(|method| method.name.as_str()).collect();
    if !map_sizes.is_empty() && !without.is_empty() {
        note(&format!(
            "--map-size has no effect on {}: no param `map_size`",
            without.join(", ")
        ));
    }
}

/// Loads the one graph that the arguments name, with the params that they set.
///
/// # Errors
/// Its faults, a param that it does not have, a value that a param cannot take.
pub fn load_one(
    args: &MethodArgs,
    sources: &dyn Sources,
) -> Result<(Preset, ParamValues), CliError> {
    let (arguments, params) = openings::arguments([&args.preset], &args.params, sources)?;
    let [argument] = &arguments[..] else {
        return Err(CliError::Usage(
            "name one document for an open include here".into(),
        ));
    };
    let mut presets = preset::load_all(slice::from_ref(&argument.preset), sources)?;
    check_names(&presets, &params)?;
    let preset = presets
        .pop()
        .ok_or_else(|| CliError::Input("no graph".into()))?;
    let set = [&params[..], &argument.own].concat();
    check_names(slice::from_ref(&preset), &argument.own)?;
    let params = param_values(&preset, &set, args.map_size)?;
    Ok((preset, params))
}

/// The params of a preset from `--set` and `--map-size`.
///
/// # Errors
/// A value that a param cannot take, and a map size where there is no such param.
pub fn param_values(
    preset: &Preset,
    assignments: &[Assignment],
    map_size: Option<u32>,
) -> Result<ParamValues, CliError> {
    let own = assignments
        .iter()
        .filter(|set| preset.param(&set.name).is_some());
    let own = own.map(|set| (set.name.as_str(), set.value.clone()));
    let size = map_size.map(|size| (MAP_SIZE, size.to_string()));
    let parsed = own.chain(size).map(|(name, value)| {
        let parsed = preset.graph.parse_param(name, &value);
        parsed
            .map(|value| (name.to_owned(), value))
            .map_err(|error| CliError::Input(error.to_string()))
    });
    parsed.collect()
}

/// Refuses an assignment that no preset has a param for.
fn check_names(presets: &[Preset], assignments: &[Assignment]) -> Result<(), CliError> {
    for Assignment { name, .. } in assignments {
        if presets.iter().any(|preset| preset.param(name).is_some()) {
            continue;
        }
        let mut known: Vec<&str> = presets.iter().flat_map(Preset::settable).collect();
        known.sort_unstable();
        known.dedup();
        let list = match &known[..] {
            [] => "none".into(),
            known => known.join(", "),
        };
        return Err(CliError::Input(format!(
            "--set {name}: unknown param{}\n  params: {list}",
            did_you_mean(name, known.iter().copied())
        )));
    }
    Ok(())
}
