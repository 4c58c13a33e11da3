//! A host program with its own device runs a graph inside its own encoder: `cargo run -p skiagraph-graph --example embed`.

use skiagraph_graph::{
    Executor, FolderSources, Frame, Graph, NoProvider, ParamValue, PlanRequest, Registry, gpu,
};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    // Any device will do; this one is opened as Skiagraph's own program does it.
    let gpu::Gpu { device, queue, .. } = gpu::open(None)?;

    // No GPU needed: read the document and its shaders, then plan for a viewport, params and the device's limits.
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
    let sources = FolderSources {
        root: folder.into(),
    };
    let graph = Graph::load("rings.ron", &Registry::standard(), &sources)?;
    let mut request = PlanRequest::new([64, 24], &NoProvider);
    request.limits = device.limits();
    request.features = device.features();
    request
        .params
        .insert("width".to_owned(), ParamValue::F32(3.0));
    let plan = graph.plan(&request)?;

    let mut executor = Executor::new(&device, &queue, plan, &mut NoProvider)?;
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    executor.encode(
        &mut encoder,
        &Frame {
            timing: true,
            read: &["rings"],
            ..Frame::default()
        },
    )?;
    queue.submit([encoder.finish()]); // the host's frame, with whatever else is in it
    executor.submitted(&queue)?;
    let report = executor.finish()?;

    for readback in report.readbacks {
        let texels = readback
            .content
            .as_f32()
            .ok_or("rings is a texture of floats")?;
        for row in texels.chunks(64) {
            let line: String = row
                .iter()
                .map(|&value| if value > 0.5 { '#' } else { '.' })
                .collect();
            println!("{line}");
        }
    }
    for pass in report.timing.iter().flat_map(|timing| &timing.passes) {
        println!(
            "{}: {:?} on the GPU, {:?} to encode",
            pass.name, pass.gpu, pass.cpu
        );
    }
    Ok(())
}
