//! The shaders of all presets are WGSL to other compilers than naga: what naga writes of them reads
//! back alike, and Tint takes their texts (`tests/tint/tint.mjs`). No GPU.

use glam::DVec3;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use serde_json::{Value, json};
use skiagraph_graph::{
    Attachment, Graph, Ids, LinkedProgram, ParamType, ParamValue, PlanRequest,
    step::{Draw, Step},
};
use skiagraph_passes::{EmbeddedSources, SceneProvider, presets, registry};
use skiagraph_scene::{
    DirectionalLight, Light, LightKind, PointLight, SceneLibrary, SpotLight, View,
};
use std::{collections::BTreeSet, env, fs, sync::Arc};

/// Values of the params of which each makes another plan: all words, yes and no.
fn words(ty: &ParamType) -> Vec<ParamValue> {
    match ty {
        ParamType::Choice(words) => {
            let word = |word: &_| ParamValue::Choice(ToString::to_string(word));
            words.iter().map(word).collect()
        }
        ParamType::Bool => [false, true].map(ParamValue::Bool).to_vec(),
        _ => Vec::new(),
    }
}

/// One of each kind, of an extent.
fn lights(radius: f64) -> [LightKind; 3] {
    let (position, direction) = (DVec3::new(1.5, 6.0, -1.0), DVec3::new(-0.25, -1.0, 0.2));
    let sun = DirectionalLight {
        angle_degrees: radius,
        ..DirectionalLight::new(direction)
    };
    let spot = SpotLight {
        position,
        direction,
        cone_degrees: 100.0,
        radius,
    };
    let point = PointLight { position, radius };
    [sun.into(), LightKind::Spot(spot), LightKind::Point(point)]
}

/// Calls `visit` with each step of the presets that has a program, under each kind of light, with
/// the defaults of their params and each other word of one. None needs more than WebGPU has.
fn programs(visit: &mut dyn FnMut(&Step<Ids>, &LinkedProgram)) {
    let (scene, _) = SceneLibrary::default().load("park").unwrap();
    let scene = Arc::new(scene);
    let lights = [0.0, 0.7].into_iter().flat_map(lights);
    let lights: Vec<Light> = lights.map(Light::only).collect();
    for preset in presets() {
        let graph = Graph::load(&preset.path, &registry(), &EmbeddedSources);
        let graph = graph.unwrap_or_else(|error| panic!("{error}"));
        for light in &lights {
            let mut provider = SceneProvider::new(Arc::clone(&scene));
            let view = View {
                light: Some(light.clone()),
                ..scene.views[0].clone()
            };
            provider.set_view(&view, [64, 48]);
            let params = graph.params().iter();
            let sets = params.flat_map(|param| {
                let name = || param.name.to_string();
                let words = words(&param.ty).into_iter();
                words.map(move |word| (name(), word))
            });
            for set in std::iter::once(None).chain(sets.map(Some)) {
                let mut request = PlanRequest::new([64, 48], &provider);
                request.params.extend(set);
                // Some lights and words ask for more than there is.
                let Ok(plan) = graph.plan(&request) else {
                    continue;
                };
                for step in plan.live().flat_map(|pass| &pass.steps) {
                    if let Some(program) = step.program() {
                        visit(step, program);
                    }
                }
            }
        }
    }
}

fn read(text: &str) -> (naga::Module, ModuleInfo) {
    let module = naga::front::wgsl::parse_str(text);
    let module = module.unwrap_or_else(|error| panic!("{}", error.emit_to_string(text)));
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    let info = validator.validate(&module).unwrap();
    (module, info)
}

/// Facts that a host relies on: bindings, overrides by name, places of the members of structs.
fn facts(module: &naga::Module) -> BTreeSet<String> {
    let globals = module.global_variables.iter();
    let bindings = globals.filter_map(|(_, global)| {
        let size = module.types[global.ty].inner.size(module.to_ctx());
        Some(format!("{:?}, {size} bytes", global.binding?))
    });
    let overrides = module.overrides.iter();
    let overrides = overrides.map(|(_, value)| format!("override {:?}", value.name));
    let structs = module.types.iter().filter_map(|(_, ty)| match &ty.inner {
        naga::TypeInner::Struct { members, span } => {
            let places: Vec<u32> = members.iter().map(|member| member.offset).collect();
            Some(format!("{places:?} of {span}"))
        }
        _ => None,
    });
    bindings.chain(overrides).chain(structs).collect()
}

/// The shader's file and text, the names and stages of the entry points, the values of overrides,
/// and the formats that a draw writes.
fn record(step: &Step<Ids>, program: &LinkedProgram, wgsl: &str) -> String {
    let module = program.shader.module();
    let entries = program.entries.iter().map(|entry| {
        let entry = &module.entry_points[*entry];
        json!({"name": entry.name, "stage": format!("{:?}", entry.stage)})
    });
    let record = json!({
        "file": program.shader.file(),
        "wgsl": wgsl,
        "entries": entries.collect::<Vec<_>>(),
        "constants": program.constants,
        "draw": match step {
            Step::Draw(draw) => targets(draw),
            _ => Value::Null,
        },
    });
    record.to_string()
}

fn targets(draw: &Draw<Ids>) -> Value {
    let format = |target: &Attachment| format!("{:?}", target.format);
    let colors = draw
        .colors
        .iter()
        .flatten()
        .map(|color| format(&color.target));
    let canvas = draw
        .canvas
        .iter()
        .map(|canvas| format!("{:?}", canvas.format));
    let depth = draw.depth.as_ref().map(|depth| &depth.target);
    let depth = depth.or(draw.stencil.as_ref().map(|stencil| &stencil.target));
    let colored = draw
        .colors
        .iter()
        .flatten()
        .next()
        .map(|color| &color.target);
    json!({
        "fullscreen": draw.fullscreen,
        "colors": colors.chain(canvas).collect::<Vec<_>>(),
        "depth": depth.map(format),
        "samples": colored.or(depth).map_or(1, |target| target.samples),
        "topology": format!("{:?}", draw.primitive.topology),
    })
}

/// The programs are written into the file that `SKIAGRAPH_PROGRAMS` names, if it is set: a line
/// each, which tint.mjs reads.
#[test]
fn what_naga_writes_is_what_it_read() {
    let (mut texts, mut records) = (BTreeSet::new(), BTreeSet::new());
    programs(&mut |step, program| {
        let (shader, text) = (&program.shader, program.shader.wgsl());
        records.insert(record(step, program, &text));
        if !texts.insert(text.clone()) {
            return;
        }
        let (module, info) = read(&text);
        assert_eq!(facts(&module), facts(shader.module()), "{}", shader.file());
        let flags = naga::back::wgsl::WriterFlags::empty();
        let written = naga::back::wgsl::write_string(&module, &info, flags).unwrap();
        assert_eq!(
            facts(&read(&written).0),
            facts(&module),
            "{}",
            shader.file()
        );
    });
    assert!(texts.len() >= 50, "{}", texts.len());
    if let Some(file) = env::var_os("SKIAGRAPH_PROGRAMS") {
        fs::write(file, records.into_iter().collect::<Vec<_>>().join("\n")).unwrap();
    }
}
