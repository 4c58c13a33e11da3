//! Lists the scenes, methods and hard cases that the page offers.

use crate::answer::{Answer, fault, json};
use serde_json::{Value, json};
use skiagraph_compare::graphs::method::Method;
use skiagraph_compare::graphs::preset::{self, Preset};
use skiagraph_compare::graphs::shadow_method;
use skiagraph_compare::measuring::guarantee;
use skiagraph_compare::records::stress::Guarantee;
use skiagraph_graph::{Param, ParamType};
use skiagraph_passes::EmbeddedSources;
use skiagraph_scene::SceneLibrary;
use std::{collections::BTreeMap, sync::Arc};
use wasm_bindgen::prelude::*;

/// Returns JSON with the `version`, the built-in `scenes`, the `methods` with their params, those
/// that claim to be `exact`, those that a comparison takes first (`measured`), and the names of the
/// hard `cases`.
///
/// # Errors
/// A preset that cannot be read.
#[wasm_bindgen]
pub fn catalogue() -> Answer<String> {
    let presets = shadow_method::load_all(&preset::built_in(), &EmbeddedSources).map_err(fault)?;
    let scenes = SceneLibrary::default().list().into_iter();
    let scenes = scenes.filter(|scene| scene.mesh_found);
    let is_exact = |preset: &&Arc<Preset>| {
        let method = Method::new((*preset).clone(), BTreeMap::new());
        let claim = guarantee::find(&method, &[]).ok().flatten();
        claim.is_some_and(|(guarantee, _)| guarantee == Guarantee::Exact)
    };
    let names = |presets: Vec<&Arc<Preset>>| -> Vec<String> {
        presets.iter().map(|preset| preset.name.clone()).collect()
    };
    json(&json!({
        "version": env!("CARGO_PKG_VERSION"),
        "scenes": scenes.map(|scene| scene.name).collect::<Vec<_>>(),
        "methods": presets.iter().map(method).collect::<Vec<_>>(),
        "exact": names(presets.iter().filter(is_exact).collect()),
        "measured": preset::SHIPPED,
        "cases": skiagraph_cases::cases().iter().map(|case| case.name).collect::<Vec<_>>(),
    }))
}

/// A method with its params.
fn method(preset: &Arc<Preset>) -> Value {
    let method = Method::new(preset.clone(), BTreeMap::new());
    let defaults = method.all_params();
    let params = preset.graph.params().iter();
    json!({
        "name": preset.name,
        "about": preset.graph.description(),
        "params": params.map(|it| param(it, defaults.get(&it.name.value))).collect::<Vec<_>>(),
    })
}

fn param(param: &Param, default: Option<&Value>) -> Value {
    let choices: Vec<&str> = param.words().map(|word| word.as_str()).collect();
    let kind = match &param.ty {
        ParamType::Choice(_) => "choice".to_owned(),
        other => other.to_string(),
    };
    json!({
        "name": param.name.value,
        "kind": kind,
        "default": default,
        "min": param.min,
        "max": param.max,
        "choices": choices,
        "doc": param.description,
    })
}
