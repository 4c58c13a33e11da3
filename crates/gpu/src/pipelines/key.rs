//! Keys of pipelines: all that a pipeline is made from.

use skiagraph_graph::step::{Draw, Step};
use skiagraph_graph::{Ids, Shader};
use std::sync::Arc;

/// All that a pipeline is made from. Steps of equal keys can use the same pipeline.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(crate) struct PipelineKey {
    /// Equal for equal texts, with imports in place.
    pub shader: Arc<Shader>,
    /// Indices of the entry points in the shader's module.
    pub entries: Vec<usize>,
    pub bindings: Vec<Slot>,
    /// Overrides by key, with the bits of their values.
    constants: Vec<(String, u64)>,
    /// State of a draw; `None` for a dispatch.
    pub draw: Option<DrawKey>,
}

/// One binding of a bind group layout.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Slot {
    pub group: u32,
    pub binding: u32,
    pub ty: wgpu::BindingType,
    pub visibility: wgpu::ShaderStages,
}

/// The fixed-function state of a draw's pipeline.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(crate) struct DrawKey {
    /// True if the vertex stage is that of a full-screen pass.
    pub fullscreen: bool,
    pub primitive: wgpu::PrimitiveState,
    /// By location; `None` for one that nothing is written to.
    pub colors: Vec<Option<wgpu::ColorTargetState>>,
    pub depth_stencil: Option<wgpu::DepthStencilState>,
    /// Samples of the attachments, which all have as many.
    pub samples: u32,
}

impl PipelineKey {
    /// Returns the key of a step's pipeline; `None` for copies, clears and work on the CPU.
    pub fn new(step: &Step<Ids>) -> Option<Self> {
        let program = step.program()?;
        let draw = match step {
            Step::Draw(draw) => Some(DrawKey::new(draw)),
            _ => None,
        };
        let slots = program.bindings.iter().map(|bound| Slot {
            group: bound.group,
            binding: bound.binding,
            ty: bound.ty,
            visibility: bound.visibility,
        });
        let constants = program.constants.iter();
        let constants = constants.map(|(name, value)| (name.clone(), value.to_bits()));
        Some(Self {
            shader: Arc::clone(&program.shader),
            entries: program.entries.clone(),
            bindings: slots.collect(),
            constants: constants.collect(),
            draw,
        })
    }

    /// Returns the overrides by key, as wgpu takes them.
    pub fn constants(&self) -> Vec<(&str, f64)> {
        let constants = self.constants.iter();
        constants
            .map(|(name, bits)| (name.as_str(), f64::from_bits(*bits)))
            .collect()
    }

    /// Returns the name of the entry point of a stage; `None` if the program has none.
    pub fn entry(&self, stage: naga::ShaderStage) -> Option<&str> {
        let points = &self.shader.module().entry_points;
        let mut entries = self.entries.iter();
        let entry = entries.find(|entry| points[**entry].stage == stage)?;
        Some(self.shader.entry_name(*entry))
    }
}

impl DrawKey {
    fn new(draw: &Draw<Ids>) -> Self {
        let colors = draw.colors.iter().map(|color| {
            color.as_ref().map(|color| wgpu::ColorTargetState {
                format: color.target.format,
                blend: color.blend,
                write_mask: color.write,
            })
        });
        let canvas = draw.canvas.iter().map(|canvas| {
            Some(wgpu::ColorTargetState {
                format: canvas.format,
                blend: None,
                write_mask: wgpu::ColorWrites::empty(),
            })
        });
        Self {
            fullscreen: draw.fullscreen,
            primitive: draw.primitive,
            colors: colors.chain(canvas).collect(),
            depth_stencil: depth_stencil(draw),
            samples: samples(draw),
        }
    }
}

/// True if two steps can use the same pipeline.
pub(crate) fn same_pipeline(a: &Step<Ids>, b: &Step<Ids>) -> bool {
    let key = PipelineKey::new(a);
    key.is_some() && key == PipelineKey::new(b)
}

/// Depth and stencil of a draw, as its pipeline has them.
fn depth_stencil(draw: &Draw<Ids>) -> Option<wgpu::DepthStencilState> {
    let (depth, stencil) = (draw.depth.as_ref(), draw.stencil.as_ref());
    let target = depth.map(|depth| &depth.target);
    let target = target.or(stencil.map(|stencil| &stencil.target))?;
    let has_depth = target.format.has_depth_aspect();
    let compare = depth.map_or(wgpu::CompareFunction::Always, |depth| depth.compare);
    Some(wgpu::DepthStencilState {
        format: target.format,
        // An aspect that no field names is left alone.
        depth_write_enabled: has_depth.then_some(depth.is_some_and(|depth| depth.write)),
        depth_compare: has_depth.then_some(compare),
        stencil: stencil.map_or_else(Default::default, |stencil| stencil.state.clone()),
        bias: depth.map(|depth| depth.bias).unwrap_or_default(),
    })
}

/// Samples of the attachments, which all have as many.
fn samples(draw: &Draw<Ids>) -> u32 {
    let colors = draw.colors.iter().flatten();
    let colors = colors.map(|color| color.target.samples);
    let depth = draw.depth.iter().map(|depth| depth.target.samples);
    let stencil = draw.stencil.iter().map(|stencil| stencil.target.samples);
    colors.chain(depth).chain(stencil).next().unwrap_or(1)
}
