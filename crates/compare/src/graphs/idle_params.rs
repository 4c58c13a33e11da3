//! Finds params that are set but have no effect, mostly because the light has no use for them.
//!
//! ```
//! use skiagraph_compare::graphs::{idle_params::under_other_lights, preset};
//! use skiagraph_passes::EmbeddedSources;
//!
//! let (graph, _) = preset::load("light_buffer", &EmbeddedSources)?;
//! let idle = under_other_lights(&graph?);
//! assert!(idle.contains("fit"), "{idle}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::graphs::method::Method;
use crate::graphs::planning::{Capabilities, placeholder, stand_ins};
use crate::sink::Sink;
use skiagraph_graph::{Graph, ParamValue, Plan, PlanRequest};
use skiagraph_passes::SceneProvider;
use skiagraph_scene::LightKind;
use std::collections::BTreeSet;

/// Tells a sink about params that the user set but that have no effect, about each only once.
#[derive(Default)]
pub struct IdleParams {
    told: BTreeSet<String>,
}

impl IdleParams {
    /// Tells the sink which params the user set without an effect on `plan`, the plan of the method
    /// `name` under `light`. A note that was given before is not repeated.
    pub fn note_of(&mut self, sink: &dyn Sink, name: &str, plan: &Plan, light: LightKind) {
        for param in plan.idle_params() {
            let value = plan.param(param).map(ParamValue::to_string);
            let (value, kind) = (value.unwrap_or_default(), light.word());
            let text = format!("{param}={value} has no effect on {name} under a {kind} light");
            if self.told.insert(text.clone()) {
                sink.note(&text);
            }
        }
    }

    /// Plans each method for the adapter `on` and the scene and light of `provider`, and tells the
    /// sink which params the user set without an effect. Methods that the adapter cannot run are
    /// skipped.
    pub fn note(
        &mut self,
        sink: &dyn Sink,
        methods: &[Method],
        on: &Capabilities,
        provider: &SceneProvider,
    ) {
        for method in methods {
            if let Ok(plan) = method.plan(method.viewport, on.clone(), provider) {
                self.note_of(sink, &method.name, &plan, provider.light());
            }
        }
    }
}

/// Names the params, among those whose values are words, that have an effect under the first kind
/// of light that a graph takes (directional, spot, point) but none under a later one. The text is
/// the end of a sentence, `; under a spot light fit has no effect`, and empty if there are no such
/// params.
pub fn under_other_lights(graph: &Graph) -> String {
    let viewport = [64, 64];
    let mut provider = placeholder(viewport, graph);
    let choosing = |provider: &_| {
        let plan = graph.plan(&PlanRequest::new(viewport, provider).with_any_adapter(true));
        plan.map_or(BTreeSet::new(), |plan| choosing(graph, &plan))
    };
    let under_first = choosing(&provider);
    let mut notes = String::new();
    for light in stand_ins(graph).into_iter().skip(1) {
        provider.set_light(light);
        let there = choosing(&provider);
        let idle: Vec<&str> = under_first.difference(&there).map(String::as_str).collect();
        if !idle.is_empty() {
            let (kind, idle) = (light.word(), idle.join(", "));
            notes += &format!("; under a {kind} light {idle} has no effect");
        }
    }
    notes
}

/// Params of words that do not all mean the same in a plan.
fn choosing(graph: &Graph, plan: &Plan) -> BTreeSet<String> {
    let choices = graph.params().iter().filter(|param| {
        param.words().any(|word| {
            let value = ParamValue::Choice(word.to_string());
            !plan.is_same_with(param.name.as_str(), value)
        })
    });
    choices.map(|param| param.name.value.to_string()).collect()
}
