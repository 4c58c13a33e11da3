//! A pass kind of a host's own crate, used from RON: `cargo run -p skiagraph-gpu --example
//! custom_pass`.
//!
//! `Equalize` spreads the brightness of a picture over the whole range. It becomes three steps:
//! clear a histogram, which is a buffer of the pass alone, count into it, and map every texel
//! through it. Its shader comes with the kind.

use serde::Deserialize;
use skiagraph_gpu::{Executor, Frame, device};
use skiagraph_graph::{
    Code, Diagnostic, Expr, FolderSources, Graph, LayeredSources, Lowering, MemorySources,
    NoProvider, ParamValue, PassKind, PlanRequest, Reference, Registry,
    step::{Dispatch, Groups, Operand, Program, Step},
};
use std::error::Error;

/// The body of an `Equalize` pass: what its RON entry holds beside the fields that every pass has.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Equalize {
    from: Reference,
    to: Reference,
    bins: Expr,
}

impl PassKind for Equalize {
    fn lower(&self, pass: &mut Lowering<'_>) {
        const MOST: u32 = 4096;
        let mut bins = pass.count32(&self.bins);
        if bins == 0 || bins > MOST {
            pass.report(
                Diagnostic::error(Code::Size, format!("a histogram of {bins} bins"))
                    .at(self.bins.span().clone(), "this many")
                    .help(format!("give it 1 to {MOST}")),
            );
            bins = 1; // so that what else is wrong with the pass is found too
        }
        let histogram = Operand::from(pass.scratch("histogram", u64::from(bins) * 4));
        pass.step(Step::Clear {
            target: histogram.clone(),
            value: [0.0; 4],
        });
        for entry in ["count", "spread"] {
            let mut program = Program {
                compute: Some(pass.named(entry)),
                constants: vec![("BINS".to_owned(), f64::from(bins))],
                ..pass.program_of("equalize")
            };
            for (global, operand) in [
                ("source", Operand::from(&self.from)),
                ("result", Operand::from(&self.to)),
                ("histogram", histogram.clone()),
            ] {
                program.bind.push((pass.named(global), operand));
            }
            let groups = Groups::Direct(pass.texels(&self.from));
            pass.step(Step::Dispatch(Dispatch { program, groups }));
        }
    }
}

/// The shader that comes with the host's pass kind.
const SHADER: &str = include_str!("custom_pass/equalize.wgsl");

fn main() -> Result<(), Box<dyn Error>> {
    let mut registry = Registry::standard();
    registry.register::<Equalize>("Equalize");
    let folder = FolderSources {
        root: concat!(env!("CARGO_MANIFEST_DIR"), "/examples/custom_pass").into(),
    };
    let own = MemorySources::new([("shaders/equalize.wgsl", SHADER)]);
    let sources = LayeredSources(vec![Box::new(folder), Box::new(own)]);
    let graph = Graph::load("dim.ron", &registry, &sources)?;

    // The kind's own mistakes look like all others.
    let mut request = PlanRequest::new([64, 24], &NoProvider);
    request.params.insert("bins".to_owned(), ParamValue::U32(0));
    let Err(wrong) = graph.plan(&request) else {
        return Err("a histogram of no bins went unnoticed".into());
    };
    println!("{wrong}");

    let device::Gpu { device, queue, .. } = device::open(None)?;
    request.params.clear();
    request.limits = device.limits();
    let mut executor = Executor::new(&device, &queue, graph.plan(&request)?, &mut NoProvider)?;
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let frame = Frame::new().with_read(&["dim", "clear"]);
    executor.encode(&mut encoder, &frame)?;
    queue.submit([encoder.finish()]);

    let mut ranges = Vec::new();
    for readback in executor.finish()?.readbacks {
        let texels = readback
            .content
            .as_f32()
            .ok_or("it is not a texture of floats")?;
        println!("{}:", readback.name);
        for row in texels.chunks(64) {
            let shade = |texel: &f32| char::from(b" .:-=+*#%@"[(texel * 9.99) as usize]);
            println!("{}", row.iter().map(shade).collect::<String>());
        }
        let (darkest, brightest) = texels
            .iter()
            .fold((1.0_f32, 0.0_f32), |(low, high), texel| {
                (low.min(*texel), high.max(*texel))
            });
        ranges.push(brightest - darkest);
    }
    println!(
        "range of brightness: {:.2} before, {:.2} after",
        ranges[0], ranges[1]
    );
    if ranges[0] < 0.2 && ranges[1] > 0.9 {
        Ok(())
    } else {
        Err("the picture was not equalised".into())
    }
}
