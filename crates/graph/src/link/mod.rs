//! Phase 4: shaders meet resources. Every name of every step is resolved, every binding and attachment checked, and what
//! each pass reads and writes is written down.

mod attachments;
mod bindings;
mod layouts;

use crate::{
    diagnostics::{Code, Diagnostic, Severity},
    document::located::Located,
    registry::Params,
    resolve::{Part, Resource, ResourceId, ResourceKind, Resources, Target},
    source::Span,
    step::{Draw, DrawCall, Groups, Program, Step},
    wgsl::Shader,
};
pub(crate) use bindings::{BindTarget, LinkedProgram};
use layouts::Layouts;
use naga::ShaderStage;
use std::{collections::HashMap, sync::Arc};

/// A pass with its steps resolved.
#[derive(Clone, Debug)]
pub(crate) struct LinkedPass {
    pub name: Located<String>,
    pub kind: &'static str,
    pub steps: Vec<LinkedStep>,
    pub accesses: Vec<Access>,
}

/// One use of a part of a resource by a step.
#[derive(Clone, Debug)]
pub(crate) struct Access {
    pub resource: ResourceId,
    pub part: Part,
    pub reads: bool,
    pub writes: bool,
    /// Everything in the part is overwritten.
    pub covers: bool,
    pub usage: Usage,
    /// Place in the document or the shader that causes it.
    pub span: Span,
    pub step: usize,
}

/// How a resource is bound; decides the usages it is created with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Usage {
    Texture(wgpu::TextureUsages),
    Buffer(wgpu::BufferUsages),
    None,
}

#[derive(Clone, Debug)]
pub(crate) enum LinkedStep {
    Draw(LinkedDraw),
    Dispatch {
        program: LinkedProgram,
        groups: LinkedGroups,
    },
    CopyTexture {
        from: Target,
        to: Target,
    },
    CopyBuffer {
        from: ResourceId,
        to: ResourceId,
    },
    ClearTexture {
        target: Target,
        value: [f64; 4],
    },
    ClearBuffer(ResourceId),
}

#[derive(Clone, Debug)]
pub(crate) struct LinkedDraw {
    pub program: LinkedProgram,
    pub fullscreen: bool,
    pub colors: Vec<LinkedColor>,
    pub depth: Option<LinkedDepth>,
    pub call: LinkedCall,
    pub primitive: wgpu::PrimitiveState,
}

#[derive(Clone, Debug)]
pub(crate) struct LinkedColor {
    pub target: Target,
    pub format: wgpu::TextureFormat,
    pub clear: Option<[f64; 4]>,
    pub blend: Option<wgpu::BlendState>,
}

#[derive(Clone, Debug)]
pub(crate) struct LinkedDepth {
    pub target: Target,
    pub clear: Option<f32>,
    pub state: wgpu::DepthStencilState,
}

#[derive(Clone, Debug)]
pub(crate) enum LinkedCall {
    Direct { vertices: u32, instances: u32 },
    Indirect(ResourceId),
}

#[derive(Clone, Debug)]
pub(crate) enum LinkedGroups {
    Fixed([u32; 3]),
    Indirect(ResourceId),
}

/// What passes are linked against.
pub(crate) struct Linker<'a, 'p> {
    pub resources: &'a mut Resources<'p>,
    pub shaders: &'a HashMap<String, Arc<Shader>>,
    pub params: &'a Params<'a>,
    pub limits: &'a wgpu::Limits,
    pub features: wgpu::Features,
    pub diagnostics: &'a mut Vec<Diagnostic>,
    pub layouts: Layouts,
}

impl<'a, 'p> Linker<'a, 'p> {
    pub fn new(
        resources: &'a mut Resources<'p>,
        shaders: &'a HashMap<String, Arc<Shader>>,
        params: &'a Params<'a>,
        (limits, features): (&'a wgpu::Limits, wgpu::Features),
        diagnostics: &'a mut Vec<Diagnostic>,
    ) -> Self {
        Self {
            resources,
            shaders,
            params,
            limits,
            features,
            diagnostics,
            layouts: Layouts::default(),
        }
    }

    /// Links one pass. `None` if something in it is wrong (and was reported).
    pub fn pass(
        &mut self,
        name: &Located<String>,
        kind: &'static str,
        steps: &[Step],
    ) -> Option<LinkedPass> {
        let mut pass = LinkedPass {
            name: name.clone(),
            kind,
            steps: Vec::new(),
            accesses: Vec::new(),
        };
        let before = self.errors();
        for (index, step) in steps.iter().enumerate() {
            let first = pass.accesses.len();
            let linked = self.step(step, &mut pass);
            pass.accesses[first..]
                .iter_mut()
                .for_each(|access| access.step = index);
            self.feedback(name, &pass.accesses[first..]);
            pass.steps.extend(linked);
        }
        (self.errors() == before).then_some(pass)
    }

    fn errors(&self) -> usize {
        self.diagnostics
            .iter()
            .filter(|diagnostic| diagnostic.severity == Severity::Error)
            .count()
    }

    fn step(&mut self, step: &Step, pass: &mut LinkedPass) -> Option<LinkedStep> {
        match step {
            Step::Draw(draw) => self.draw(draw, pass).map(LinkedStep::Draw),
            Step::Dispatch(dispatch) => {
                let program = self.program(&dispatch.program, &[ShaderStage::Compute], pass)?;
                let size = self.workgroup_size(&program, &pass.name)?;
                let groups = self.groups(&dispatch.groups, size, pass)?;
                Some(LinkedStep::Dispatch { program, groups })
            }
            Step::Copy { from, to } => self.copy(from, to, pass),
            Step::Clear { target, value } => self.clear(target, *value, pass),
        }
    }

    pub(super) fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    pub(super) fn expect(&mut self, name: &Located<String>) -> Option<Target> {
        self.resources.expect(name, self.diagnostics)
    }

    fn draw(&mut self, draw: &Draw, pass: &mut LinkedPass) -> Option<LinkedDraw> {
        let fragment =
            !draw.colors.is_empty() || draw.fullscreen || draw.program.fragment.is_some();
        let stages: &[ShaderStage] = match (draw.fullscreen, fragment) {
            (true, _) => &[ShaderStage::Fragment],
            (false, true) => &[ShaderStage::Vertex, ShaderStage::Fragment],
            (false, false) => &[ShaderStage::Vertex],
        };
        let program = self.program(&draw.program, stages, pass);
        let colors = self.colors(draw, program.as_ref(), pass);
        let depth = draw.depth.as_ref().map(|depth| self.depth(depth, pass));
        let call = match &draw.call {
            DrawCall::Direct { count, instances } => {
                let vertices = self.resources.count(count, self.params, self.diagnostics)?;
                let instances = self
                    .resources
                    .count(instances, self.params, self.diagnostics)?;
                match (u32::try_from(vertices), u32::try_from(instances)) {
                    (Ok(vertices), Ok(instances)) => LinkedCall::Direct {
                        vertices,
                        instances,
                    },
                    _ => {
                        self.report(
                            Diagnostic::error(
                                Code::Size,
                                "the draw has more than 4,294,967,295 vertices or instances",
                            )
                            .at(pass.name.span.clone(), ""),
                        );
                        return None;
                    }
                }
            }
            DrawCall::Indirect(name) => LinkedCall::Indirect(self.indirect(name, 16, pass)?),
        };
        let depth = match depth {
            Some(None) => return None,
            Some(depth) => depth,
            None => None,
        };
        let (program, colors) = (program?, colors?);
        self.attachment_sizes(&colors, depth.as_ref(), pass);
        Some(LinkedDraw {
            program,
            fullscreen: draw.fullscreen,
            colors,
            depth,
            call,
            primitive: draw.primitive,
        })
    }

    /// A buffer of indirect arguments of at least `bytes`.
    fn indirect(
        &mut self,
        name: &Located<String>,
        bytes: u64,
        pass: &mut LinkedPass,
    ) -> Option<ResourceId> {
        let target = self.expect(name)?;
        let resource = self.resources.get(target.id);
        if !matches!(resource.kind, ResourceKind::Buffer(_)) {
            let what = resource.kind.describe();
            self.report(
                Diagnostic::error(
                    Code::ResourceKind,
                    format!("`{}` cannot hold indirect arguments", name.value),
                )
                .at(
                    name.span.clone(),
                    format!("this is {what}, a buffer of the document is needed"),
                ),
            );
            return None;
        }
        self.layouts.at_least(target.id, bytes, name.span.clone());
        pass.accesses.push(Access {
            resource: target.id,
            part: target.part,
            reads: true,
            writes: false,
            covers: false,
            usage: Usage::Buffer(wgpu::BufferUsages::INDIRECT),
            span: name.span.clone(),
            step: 0,
        });
        Some(target.id)
    }

    fn workgroup_size(
        &mut self,
        program: &LinkedProgram,
        pass: &Located<String>,
    ) -> Option<[u32; 3]> {
        let entry = *program.entries.first()?;
        let Some(size) = program.shader.workgroup_size(entry) else {
            self.report(
                Diagnostic::error(
                    Code::Shader,
                    "a workgroup size that is an override is not supported",
                )
                .at(program.shader.entry_span(entry), "")
                .at(pass.span.clone(), "run by this pass")
                .help("write the size as a number or `const`"),
            );
            return None;
        };
        let limits = self.limits;
        let most = [
            limits.max_compute_workgroup_size_x,
            limits.max_compute_workgroup_size_y,
            limits.max_compute_workgroup_size_z,
        ];
        let total: u64 = size.iter().map(|&edge| u64::from(edge)).product();
        if total > u64::from(limits.max_compute_invocations_per_workgroup)
            || size.iter().zip(most).any(|(edge, most)| *edge > most)
        {
            self.report(
                Diagnostic::error(
                    Code::Limit,
                    format!(
                        "a workgroup of {}×{}×{} is more than the adapter can run",
                        size[0], size[1], size[2]
                    ),
                )
                .at(program.shader.entry_span(entry), "")
                .at(pass.span.clone(), "run by this pass")
                .help(format!(
                    "its limits are {}×{}×{} and {} invocations in all",
                    most[0], most[1], most[2], limits.max_compute_invocations_per_workgroup
                )),
            );
            return None;
        }
        Some(size)
    }

    fn groups(
        &mut self,
        groups: &Groups,
        size: [u32; 3],
        pass: &mut LinkedPass,
    ) -> Option<LinkedGroups> {
        let most = self.limits.max_compute_workgroups_per_dimension;
        let groups = match groups {
            Groups::Indirect(name) => {
                return self.indirect(name, 12, pass).map(LinkedGroups::Indirect);
            }
            Groups::Fixed(groups) => *groups,
            Groups::Over(name) => {
                let target = self.expect(name)?;
                let items = match &self.resources.get(target.id).kind {
                    ResourceKind::Texture(texture) => {
                        let mip = target.part.mips.start;
                        let edge = |i: usize| (texture.size[i] >> mip).max(1).div_ceil(size[i]);
                        let layers = u32::try_from(target.part.layers.len()).unwrap_or(u32::MAX);
                        Ok([edge(0), edge(1), layers.div_ceil(size[2])])
                    }
                    ResourceKind::Buffer(buffer) => Err(buffer.count),
                    ResourceKind::Provided(provided) => Err(provided.items),
                    ResourceKind::Sampler(_) => Err(None),
                };
                match items {
                    Ok(groups) => groups,
                    Err(Some(items)) => {
                        let per_group: u64 = size.iter().map(|&edge| u64::from(edge)).product();
                        fold(items.div_ceil(per_group), most)
                    }
                    Err(None) => {
                        let what = self.resources.get(target.id).kind.describe();
                        self.report(
                            Diagnostic::error(Code::Size, format!("a dispatch over `{}` has no size", name.value))
                                .at(name.span.clone(), format!("this is {what} whose number of items is not known"))
                                .help("give the buffer a `count`, or dispatch `Groups(x, y, z)` or `Indirect(…)`"),
                        );
                        return None;
                    }
                }
            }
        };
        if groups.iter().any(|&edge| edge > most) {
            self.report(
                Diagnostic::error(
                    Code::Limit,
                    format!(
                        "{}×{}×{} workgroups are more than the adapter can run",
                        groups[0], groups[1], groups[2]
                    ),
                )
                .at(pass.name.span.clone(), "dispatched by this pass")
                .help(format!("its limit is {most} in each direction")),
            );
            return None;
        }
        Some(LinkedGroups::Fixed(groups))
    }

    fn copy(
        &mut self,
        from: &Located<String>,
        to: &Located<String>,
        pass: &mut LinkedPass,
    ) -> Option<LinkedStep> {
        let (source, target) = (self.expect(from)?, self.expect(to)?);
        let mismatch = |what: String| {
            Diagnostic::error(
                Code::FormatMismatch,
                format!("`{}` cannot be copied onto `{}`", from.value, to.value),
            )
            .at(from.span.clone(), "")
            .at(to.span.clone(), what)
        };
        let resources = (
            self.resources.get(source.id).clone(),
            self.resources.get(target.id).clone(),
        );
        let (usages, step) = match (&resources.0.kind, &resources.1.kind) {
            (ResourceKind::Texture(a), ResourceKind::Texture(b)) => {
                let size = |texture: &crate::resolve::Texture, part: &Part| {
                    let [width, height] = texture.size.map(|edge| (edge >> part.mips.start).max(1));
                    (width, height, part.layers.len(), part.mips.len())
                };
                if a.format != b.format {
                    self.report(mismatch(format!("{:?} is not {:?}", b.format, a.format)));
                    return None;
                }
                let (from_size, to_size) = (size(a, &source.part), size(b, &target.part));
                if from_size != to_size {
                    let words = |(width, height, layers, mips)| match (layers, mips) {
                        (1, 1) => format!("{width}×{height} texels"),
                        _ => format!("{width}×{height} texels, layers: {layers}, mips: {mips}"),
                    };
                    self.report(mismatch(words(to_size)).help(format!(
                        "it must be as large as `{}`: {}",
                        from.value,
                        words(from_size)
                    )));
                    return None;
                }
                let usage = (
                    Usage::Texture(wgpu::TextureUsages::COPY_SRC),
                    Usage::Texture(wgpu::TextureUsages::COPY_DST),
                );
                (
                    usage,
                    LinkedStep::CopyTexture {
                        from: source.clone(),
                        to: target.clone(),
                    },
                )
            }
            (ResourceKind::Buffer(_) | ResourceKind::Provided(_), ResourceKind::Buffer(_)) => {
                self.layouts.same((source.id, from), (target.id, to));
                let usage = (
                    Usage::Buffer(wgpu::BufferUsages::COPY_SRC),
                    Usage::Buffer(wgpu::BufferUsages::COPY_DST),
                );
                (
                    usage,
                    LinkedStep::CopyBuffer {
                        from: source.id,
                        to: target.id,
                    },
                )
            }
            (a, b) => {
                let error = Diagnostic::error(
                    Code::ResourceKind,
                    format!("`{}` cannot be copied onto `{}`", from.value, to.value),
                )
                .at(from.span.clone(), a.describe())
                .at(to.span.clone(), b.describe());
                self.report(error);
                return None;
            }
        };
        let access = |target: &Target, name: &Located<String>, writes: bool, usage| Access {
            resource: target.id,
            part: target.part.clone(),
            reads: !writes,
            writes,
            covers: writes,
            usage,
            span: name.span.clone(),
            step: 0,
        };
        pass.accesses.push(access(&source, from, false, usages.0));
        pass.accesses.push(access(&target, to, true, usages.1));
        Some(step)
    }

    fn clear(
        &mut self,
        name: &Located<String>,
        value: [f64; 4],
        pass: &mut LinkedPass,
    ) -> Option<LinkedStep> {
        let target = self.expect(name)?;
        let (usage, step) = match &self.resources.get(target.id).kind {
            ResourceKind::Texture(texture) => {
                let format = texture.format;
                let usages = wgpu::TextureUsages::RENDER_ATTACHMENT;
                if !format
                    .guaranteed_format_features(self.features)
                    .allowed_usages
                    .contains(usages)
                {
                    self.report(
                        Diagnostic::error(
                            Code::FormatMismatch,
                            format!("a texture of format {format:?} cannot be cleared"),
                        )
                        .at(name.span.clone(), "wgpu clears what can be drawn to")
                        .help("write it whole by a Compute pass instead"),
                    );
                    return None;
                }
                self.clear_value(name, format, value);
                (
                    Usage::Texture(usages),
                    LinkedStep::ClearTexture {
                        target: target.clone(),
                        value,
                    },
                )
            }
            ResourceKind::Buffer(_) => {
                if value != [0.0; 4] {
                    self.report(
                        Diagnostic::error(
                            Code::ResourceKind,
                            format!("the buffer `{}` can only be cleared to zero", name.value),
                        )
                        .at(name.span.clone(), "")
                        .help("leave `value` out, or write the buffer by a Compute pass"),
                    );
                    return None;
                }
                (
                    Usage::Buffer(wgpu::BufferUsages::COPY_DST),
                    LinkedStep::ClearBuffer(target.id),
                )
            }
            other => {
                let what = other.describe();
                self.report(
                    Diagnostic::error(
                        Code::ResourceKind,
                        format!("`{}` cannot be cleared", name.value),
                    )
                    .at(name.span.clone(), format!("this is {what}")),
                );
                return None;
            }
        };
        pass.accesses.push(Access {
            resource: target.id,
            part: target.part,
            reads: false,
            writes: true,
            covers: true,
            usage,
            span: name.span.clone(),
            step: 0,
        });
        Some(step)
    }

    /// A step that uses one part of a resource in two ways of which one writes: wgpu forbids it.
    fn feedback(&mut self, pass: &Located<String>, accesses: &[Access]) {
        for (index, a) in accesses.iter().enumerate() {
            for b in &accesses[..index] {
                let conflict =
                    a.resource == b.resource && a.part.overlaps(&b.part) && (a.writes || b.writes);
                // A depth attachment that is tested and written counts once; so does one global used by both stages.
                if conflict {
                    let resource: &Resource = self.resources.get(a.resource);
                    let (reader, writer) = if a.writes && !b.writes {
                        (b, a)
                    } else {
                        (a, b)
                    };
                    let error = Diagnostic::error(
                        Code::FeedbackLoop,
                        format!(
                            "pass `{}` uses `{}` twice at once, and writes it",
                            pass.value, resource.name
                        ),
                    )
                    .at(
                        reader.span.clone(),
                        if reader.writes {
                            "written here"
                        } else {
                            "read here"
                        },
                    )
                    .at(writer.span.clone(), "written here")
                    .help("read a copy, or a part (view) that this pass does not write");
                    self.report(error);
                }
            }
        }
    }

    pub(super) fn shader(&mut self, program: &Program) -> Option<Arc<Shader>> {
        let name = program.shader.as_ref()?;
        let shader = self.shaders.get(&name.value).cloned();
        if shader.is_none() {
            // Those that the document names were loaded with it; this is a kind that names another one for other params.
            self.report(
                Diagnostic::error(
                    Code::MissingFile,
                    format!(
                        "the shader `{}` was not loaded with the document",
                        name.value
                    ),
                )
                .at(
                    name.span.clone(),
                    "a pass kind must not choose its shaders by params",
                ),
            );
        }
        shader
    }
}

/// Spreads a number of workgroups over two dimensions when one does not hold it: `[min(n, most), ceil(n / most), 1]`.
fn fold(groups: u64, most: u32) -> [u32; 3] {
    let x = groups.min(u64::from(most)).max(1);
    let y = groups.div_ceil(x).max(1);
    [x as u32, u32::try_from(y).unwrap_or(u32::MAX), 1]
}
