//! A host program with its own device, G-buffer and shading has its shadows from a graph, in one
//! encoder with all the rest: `cargo run -p skiagraph-gpu --example embed`.
//!
//! The scene is a box on a ground, seen from straight above, so that the area of the shadow is
//! known: a box of edge w and height h under a light that travels along (x, -1, z) shades w·h·(|x|
//! + |z|) of the ground around it.

use skiagraph_gpu::{ExecuteError, Executor, Frame, FrameReport, Provider, ProviderError, import};
use skiagraph_graph::{
    Describe, FolderSources, Graph, Import, ParamValue, PlanRequest, Provided, ProvidedBinding,
    Registry,
};
use std::error::Error;

#[path = "embed/host.rs"]
mod host;
use host::{BOX, GBuffer, GROUND, Host, Scene};

fn main() -> Result<(), Box<dyn Error>> {
    let mut host = Host::new([1.0, 0.5])?;
    let gbuffer = host.gbuffer([64, 32]);

    // No GPU needed: read the document and its shaders, then plan for a viewport, the device's
    // limits and what the host imports.
    let sources = FolderSources {
        root: concat!(env!("CARGO_MANIFEST_DIR"), "/examples/embed").into(),
    };
    let graph = Graph::load("shadow.ron", &Registry::standard(), &sources)?;
    let mut request = PlanRequest::new([64, 32], &host.scene);
    request.limits = host.device.limits();
    request.features = host.device.features();
    request.imports.extend(gbuffer.describe());
    let plan = graph.plan(&request)?;
    let mut executor = Executor::new(&host.device, &host.queue, plan, &mut host.scene)?;

    // Errors come back before the encoder is touched, so the host can go on with it.
    let mut encoder = host.device.create_command_encoder(&Default::default());
    let Err(error) = executor.encode(&mut encoder, &Frame::default()) else {
        return Err("a missing import went unnoticed".into());
    };
    println!("without the G-buffer: {error}\n");
    gbuffer.hand_over(&mut executor)?;
    let report = frame(&host, encoder, &gbuffer, &mut executor)?;
    expect("the first frame runs everything", &report, &[])?;

    let encoder = host.device.create_command_encoder(&Default::default());
    let report = frame(&host, encoder, &gbuffer, &mut executor)?;
    expect("nothing moved", &report, &["create_map"])?;

    // The light's buffer is the host's: it writes it and says so.
    host.set_light([-0.6, -1.2]);
    executor.touch("light")?;
    let encoder = host.device.create_command_encoder(&Default::default());
    let report = frame(&host, encoder, &gbuffer, &mut executor)?;
    expect("the light moved", &report, &[])?;

    let report = executor.set_param("map_size", ParamValue::U32(1024), &mut host.scene)?;
    println!("a larger map: {report:?}\n");
    assert_eq!(report.resources, ["shadow_map"]);

    // Another size: the imports follow it, so both change at once.
    let gbuffer = host.gbuffer([96, 48]);
    let plan = executor.plan().with(|request| {
        request.viewport = [96, 48];
        request.imports.extend(gbuffer.describe());
    })?;
    executor.replace_graph(plan, &mut host.scene)?;
    gbuffer.hand_over(&mut executor)?;
    let encoder = host.device.create_command_encoder(&Default::default());
    let report = frame(&host, encoder, &gbuffer, &mut executor)?;
    expect("another map and another size", &report, &[])
}

/// The host's frame: G-buffer, the graph's passes, shading; all in one encoder and one submission.
fn frame(
    host: &Host,
    mut encoder: wgpu::CommandEncoder,
    gbuffer: &GBuffer,
    executor: &mut Executor,
) -> Result<FrameReport, Box<dyn Error>> {
    host.draw(&mut encoder, gbuffer); // the G-buffer
    executor.encode(&mut encoder, &Frame::default())?;
    let visibility = executor
        .output_view("visibility")
        .ok_or("the graph has no visibility")?;
    let letters = host.shade(&mut encoder, gbuffer, &visibility);
    host.queue.submit([encoder.finish()]);
    // waits; a host that wants neither times nor readbacks need not call it
    let report = executor.finish()?;
    judge(host, &letters, gbuffer.position.width())?;
    Ok(report)
}

/// Prints the picture, and compares the area of the shadow with what it must be.
fn judge(host: &Host, letters: &wgpu::Buffer, width: u32) -> Result<(), Box<dyn Error>> {
    letters.map_async(wgpu::MapMode::Read, .., |_| {});
    host.device.poll(wgpu::PollType::wait_indefinitely())?;
    let bytes = letters.get_mapped_range(..)?.to_vec();
    let letters: Vec<u8> = bytes.chunks_exact(4).map(|letter| letter[0]).collect();
    for row in letters.chunks(width as usize) {
        println!("{}", String::from_utf8_lossy(row));
    }
    let pixel = (2.0 * GROUND).powi(2) / letters.len() as f32;
    let shaded = letters.iter().filter(|letter| **letter == b'#').count() as f32 * pixel;
    let exact = BOX[0] * BOX[1] * (host.light[0].abs() + host.light[1].abs());
    println!("area in shadow: {shaded:.3}, exact: {exact:.3}");
    if (shaded - exact).abs() < 0.05 * exact {
        Ok(())
    } else {
        Err("the shadow has the wrong size".into())
    }
}

fn expect(what: &str, report: &FrameReport, skipped: &[&str]) -> Result<(), Box<dyn Error>> {
    println!("{what}; skipped: {:?}\n", report.skipped);
    if report.skipped == skipped {
        Ok(())
    } else {
        Err(format!("{skipped:?} should have been skipped").into())
    }
}

/// Describes the resources that the graph gets by name, instead of importing them, for planning.
impl Describe for Scene {
    fn names(&self) -> Vec<String> {
        vec!["scene.vertices".to_owned(), "light".to_owned()]
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        let (items, stride, binding) = match name {
            "scene.vertices" => (self.vertices.size() / 16, 16, ProvidedBinding::Storage),
            "light" => (1, 64, ProvidedBinding::Uniform),
            _ => return None,
        };
        Some(Provided::new(binding, Some(items), stride))
    }
}

/// The buffers themselves, handed out when a live pass binds them.
impl Provider for Scene {
    fn build(
        &mut self,
        name: &str,
        _: &wgpu::Device,
        _: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        match name {
            "scene.vertices" => Ok(self.vertices.clone()),
            "light" => Ok(self.light.clone()),
            _ => Err(format!("the scene has no `{name}`").into()),
        }
    }
}

impl GBuffer {
    fn describe(&self) -> [(String, Import); 2] {
        [
            ("depth".to_owned(), import::texture(&self.depth)),
            ("position".to_owned(), import::texture(&self.position)),
        ]
    }

    fn hand_over(&self, executor: &mut Executor) -> Result<(), ExecuteError> {
        executor.import_texture("depth", &self.depth)?;
        executor.import_texture("position", &self.position)
    }
}
