//! Chains of passes of one kind, as a graph and by hand in plain wgpu. Both hand the texture
//! `source` on through `ping` and `pong` and back, pass by pass; every pass has a pipeline, a
//! layout and a bind group of its own, as the passes of a frame do, and its name as label.

use crate::{Generated, STORE, planned};
use skiagraph_gpu::{ExecuteError, Executor, device::Gpu};
use skiagraph_graph::{Import, NoProvider, Plan, PlanRequest, Registry};

/// Width and height of the textures: encoding does not depend on it.
const EDGE: u32 = 16;
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
const USAGE: wgpu::TextureUsages = wgpu::TextureUsages::COPY_SRC
    .union(wgpu::TextureUsages::COPY_DST)
    .union(wgpu::TextureUsages::TEXTURE_BINDING)
    .union(wgpu::TextureUsages::STORAGE_BINDING)
    .union(wgpu::TextureUsages::RENDER_ATTACHMENT);
/// Invocations per side of a workgroup.
const GROUP: u32 = 8;

const DRAW: &str = include_str!("shaders/half.wgsl");

const TRIANGLE: &str = include_str!("shaders/triangle.wgsl");

/// Kind of a chain's passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Compute passes of one dispatch.
    Dispatch,
    /// Render passes of one full-screen triangle.
    Draw,
    /// Copies of a whole texture.
    Copy,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Dispatch, Self::Draw, Self::Copy];

    /// The kind of its passes in a document.
    fn tag(self) -> &'static str {
        match self {
            Self::Dispatch => "Compute",
            Self::Draw => "Fullscreen",
            Self::Copy => "Copy",
        }
    }

    /// Returns the name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Dispatch => "dispatch",
            Self::Draw => "draw",
            Self::Copy => "copy",
        }
    }
}

/// Returns the materials that pass `at` reads and writes, as indices of `source`, `ping`, `pong`.
fn ends(at: usize) -> [usize; 2] {
    let written = 1 + at % 2;
    match at {
        0 => [0, written],
        _ => [3 - written, written],
    }
}

fn label(kind: Kind, at: usize) -> String {
    format!("{}_{at}", kind.name())
}

/// The chain as a document.
fn document(kind: Kind, passes: usize) -> Generated {
    let names = ["source", "ping", "pong"];
    let pass = |at: usize| {
        let [from, to] = ends(at).map(|end| names[end]);
        let name = label(kind, at);
        match kind {
            Kind::Dispatch => format!(
                "        Compute(name: \"{name}\", shader: \"store\", dispatch: \
                 Over(\"{to}.size\"), \
                 bind: {{\"a\": \"{from}\", \"made\": \"{to}\"}}, overwrites: [\"{to}\"]),\n"
            ),
            Kind::Draw => format!(
                "        Fullscreen(name: \"{name}\", shader: \"half\", bind: {{\"a\": \
                 \"{from}\"}}, color: [\"{to}\"]),\n"
            ),
            Kind::Copy => {
                format!("        Copy(name: \"{name}\", from: \"{from}\", to: \"{to}\"),\n")
            }
        }
    };
    let body: String = (0..passes).map(pass).collect();
    // A chain of one pass has no use for the second texture.
    let materials: String = names[1..=passes.min(2)]
        .iter()
        .map(|name| format!("        Texture(name: \"{name}\", format: Rgba16Float),\n"))
        .collect();
    let last = names[ends(passes - 1)[1]];
    let document = format!(
        "(\n    format: 3,\n    inputs: [Texture(name: \"source\", format: Rgba16Float)],\n    \
         materials: [\n{materials}    ],\n    passes: [\n{body}    ],\n    \
         outputs: [\"{last}\"],\n)\n"
    );
    let files = [
        ("graph.ron", document.as_str()),
        ("store.wgsl", STORE),
        ("half.wgsl", DRAW),
    ];
    Generated {
        files: files
            .map(|(path, text)| (path.to_owned(), text.to_owned()))
            .into(),
        kinds: [(kind.tag(), passes)].into(),
    }
}

fn texture(gpu: &Gpu, label: &str) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d {
            width: EDGE,
            height: EDGE,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: FORMAT,
        usage: USAGE,
        view_formats: &[],
    })
}

/// The chain as a plan, with the import `source`.
///
/// # Panics
/// If the graph has a mistake, which would be this crate's.
pub fn plan(kind: Kind, passes: usize) -> Plan {
    let mut request = PlanRequest::new([EDGE, EDGE], &NoProvider);
    let source = Import::plain_texture(FORMAT, [EDGE, EDGE], USAGE);
    request.imports.insert("source".to_owned(), source);
    let sources = (&Registry::standard(), &document(kind, passes) as _);
    planned("graph.ron", sources, &request)
}

/// The chain as an executor.
///
/// # Errors
/// If the device refuses something of it.
pub fn executor(gpu: &Gpu, kind: Kind, passes: usize) -> Result<Executor, ExecuteError> {
    let plan = plan(kind, passes);
    let mut executor = Executor::new(&gpu.device, &gpu.queue, plan, &mut NoProvider)?;
    executor.import_texture("source", &texture(gpu, "source"))?;
    Ok(executor)
}

/// The chain by hand.
pub struct ByHand(Vec<Pass>);

struct Pass {
    label: String,
    work: Work,
}

enum Work {
    Dispatch {
        pipeline: wgpu::ComputePipeline,
        group: wgpu::BindGroup,
    },
    Draw {
        pipeline: wgpu::RenderPipeline,
        group: wgpu::BindGroup,
        target: wgpu::TextureView,
    },
    Copy([wgpu::Texture; 2]),
}

impl ByHand {
    /// Makes textures, pipelines and bind groups.
    pub fn new(gpu: &Gpu, kind: Kind, passes: usize) -> Self {
        let textures = ["source", "ping", "pong"].map(|name| texture(gpu, name));
        let pass = |at: usize| {
            let [from, to] = ends(at).map(|end| &textures[end]);
            let label = label(kind, at);
            let work = match kind {
                Kind::Dispatch => dispatch(gpu, &label, from, to),
                Kind::Draw => draw(gpu, &label, from, to),
                Kind::Copy => Work::Copy([from, to].map(Clone::clone)),
            };
            Pass { label, work }
        };
        Self((0..passes).map(pass).collect())
    }

    /// Encodes the frame; with a debug group around every pass if `grouped`.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder, grouped: bool) {
        for Pass { label, work } in &self.0 {
            if grouped {
                encoder.push_debug_group(label);
            }
            match work {
                Work::Dispatch { pipeline, group } => {
                    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                        label: Some(label),
                        timestamp_writes: None,
                    });
                    pass.set_pipeline(pipeline);
                    pass.set_bind_group(0, group, &[]);
                    pass.dispatch_workgroups(EDGE / GROUP, EDGE / GROUP, 1);
                }
                Work::Draw {
                    pipeline,
                    group,
                    target,
                } => {
                    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                        label: Some(label),
                        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                            view: target,
                            depth_slice: None,
                            resolve_target: None,
                            ops: wgpu::Operations {
                                load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                                store: wgpu::StoreOp::Store,
                            },
                        })],
                        ..wgpu::RenderPassDescriptor::default()
                    });
                    pass.set_pipeline(pipeline);
                    pass.set_bind_group(0, group, &[]);
                    pass.draw(0..3, 0..1);
                }
                Work::Copy(ends) => {
                    let [from, to] = ends.each_ref().map(wgpu::Texture::as_image_copy);
                    encoder.copy_texture_to_texture(from, to, ends[0].size());
                }
            }
            if grouped {
                encoder.pop_debug_group();
            }
        }
    }
}

fn view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// WGSL with the group and binding numbers that the graph would give.
fn module(gpu: &Gpu, text: &str) -> wgpu::ShaderModule {
    let text = text
        .replacen("var a:", "@group(0) @binding(0) var a:", 1)
        .replacen("var made:", "@group(0) @binding(1) var made:", 1);
    let device = &gpu.device;
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(text.into()),
    })
}

fn group(
    gpu: &Gpu,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    textures: &[&wgpu::Texture],
) -> wgpu::BindGroup {
    let views: Vec<wgpu::TextureView> = textures.iter().map(|texture| view(texture)).collect();
    let entries = (0..)
        .zip(&views)
        .map(|(binding, view)| wgpu::BindGroupEntry {
            binding,
            resource: wgpu::BindingResource::TextureView(view),
        });
    let entries: Vec<_> = entries.collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some(label),
        layout,
        entries: &entries,
    })
}

fn dispatch(gpu: &Gpu, label: &str, from: &wgpu::Texture, to: &wgpu::Texture) -> Work {
    let device = &gpu.device;
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(label),
        layout: None,
        module: &module(gpu, STORE),
        entry_point: None,
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    let group = group(gpu, label, &pipeline.get_bind_group_layout(0), &[from, to]);
    Work::Dispatch { pipeline, group }
}

fn draw(gpu: &Gpu, label: &str, from: &wgpu::Texture, to: &wgpu::Texture) -> Work {
    let module = module(gpu, &[DRAW, TRIANGLE].concat());
    let device = &gpu.device;
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(label),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: None,
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: None,
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(FORMAT.into())],
        }),
        multiview_mask: None,
        cache: None,
    });
    let group = group(gpu, label, &pipeline.get_bind_group_layout(0), &[from]);
    Work::Draw {
        pipeline,
        group,
        target: view(to),
    }
}
