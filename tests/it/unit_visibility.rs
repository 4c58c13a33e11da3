//! The answer of every method in one format for hosts.

use crate::{
    one_submission::{mesh, parts, sun, view},
    support::graphs::{open, values},
};
use skiagraph_gpu::{Content, Executor, Frame};
use skiagraph_graph::{Diagnostics, Graph, Plan, PlanRequest};
use skiagraph_passes::{EmbeddedSources, SceneProvider, load_unit_visibility, presets, registry};

const VIEWPORT: [u32; 2] = [64, 40];

fn provider() -> SceneProvider {
    let mut provider = SceneProvider::from_mesh(mesh(&parts(), 0.0), sun());
    provider.set_camera(&view(0.0).camera(VIEWPORT));
    provider
}

fn planned(graph: &Graph, provider: &SceneProvider, outputs: &[&str]) -> Result<Plan, Diagnostics> {
    let mut request = PlanRequest::new(VIEWPORT, provider).with_any_adapter(true);
    request.outputs = Some(outputs.iter().map(|name| (*name).to_owned()).collect());
    graph.plan(&request)
}

/// It is one pass more where it is asked for, and none where it is not.
#[test]
fn every_preset_has_it_for_one_pass() -> Result<(), Diagnostics> {
    let provider = provider();
    for preset in presets() {
        let own = Graph::load(&preset.path, &registry(), &EmbeddedSources)?;
        let passes = planned(&own, &provider, &["visibility"])?.live().count();
        let graph = load_unit_visibility(&preset.path, &registry(), &EmbeddedSources)?;
        let asked = planned(&graph, &provider, &["unit_visibility"])?;
        assert_eq!(asked.live().count(), passes + 1, "{}", preset.name);
        let format = asked.outputs()[0].format;
        assert_eq!(
            format,
            Some(wgpu::TextureFormat::R8Unorm),
            "{}",
            preset.name
        );
        let unasked = planned(&graph, &provider, &["visibility"])?;
        assert_eq!(unasked.live().count(), passes, "{}", preset.name);
        let params = |graph: &Graph| {
            let names = graph.params().iter().map(|param| param.name.clone());
            names.collect::<Vec<_>>()
        };
        assert_eq!(params(&graph), params(&own), "{}", preset.name);
    }
    Ok(())
}

/// A method of each format: R8Uint, R32Uint, R32Float.
#[test]
fn it_is_what_the_method_answers() -> Result<(), Diagnostics> {
    let gpu = open();
    for (path, is_graded) in [
        ("pipelines/nsm.ron", false),
        ("pipelines/rt.ron", false),
        ("pipelines/pcf.ron", true),
    ] {
        let graph = load_unit_visibility(path, &registry(), &EmbeddedSources)?;
        let mut provider = provider();
        let plan = planned(&graph, &provider, &["unit_visibility", "visibility"])?;
        let mut executor = Executor::new(&gpu.device, &gpu.queue, plan, &mut provider).unwrap();
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let frame = Frame::new().with_read(&["unit_visibility", "visibility"]);
        executor.encode(&mut encoder, &frame).unwrap();
        gpu.queue.submit([encoder.finish()]);
        let report = executor.finish().unwrap();
        let Content::Texture { bytes, .. } = &report.readbacks[0].content else {
            panic!("{path}: it is a texture");
        };
        let shares: Vec<f32> = if is_graded {
            report.readbacks[1].content.as_f32().unwrap()
        } else {
            let answers = values(&report, "visibility");
            answers.into_iter().map(|answer| answer as f32).collect()
        };
        assert_eq!(bytes.len(), 64 * 40, "{path}");
        assert!(shares.contains(&0.0) && shares.contains(&1.0), "{path}");
        assert_eq!(
            is_graded,
            shares.iter().any(|share| share.fract() != 0.0),
            "{path}"
        );
        for (unit, share) in bytes.iter().zip(&shares) {
            let off = (f32::from(*unit) - 255.0 * share).abs();
            assert!(off <= 0.51, "{path}: {unit} for {share}");
        }
    }
    Ok(())
}
