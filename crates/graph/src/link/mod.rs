//! Phase 4: shaders meet resources. Every name of every step is resolved, every binding and attachment checked, and what
//! each pass reads and writes is written down.

mod attachments;
mod bind;
mod bindings;
mod dispatch;
mod layouts;
mod params;
mod textures;
mod transfers;

use crate::{
    diagnostics::{Code, Diagnostic, Severity},
    document::{Run, located::Located},
    graph::Shaders,
    instantiate::PassScope,
    registry::Params,
    resolve::{Origin, Part, Resource, ResourceId, Resources, Target},
    source::Span,
    step::{Draw, DrawCall, Program, Step},
    wgsl::Shader,
};
pub(crate) use bindings::{BindTarget, LinkedProgram};
use layouts::Layouts;
use naga::ShaderStage;
use std::sync::Arc;

/// A pass with its steps resolved.
#[derive(Clone, Debug)]
pub(crate) struct LinkedPass {
    pub name: Located<String>,
    pub kind: &'static str,
    pub steps: Vec<LinkedStep>,
    pub accesses: Vec<Access>,
    pub run: Run,
    /// The value of the param of [`Run::When`].
    pub enabled: bool,
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

#[derive(Clone, Debug, PartialEq)]
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

impl LinkedStep {
    /// The shader and bindings of a draw or dispatch.
    pub fn program(&self) -> Option<&LinkedProgram> {
        match self {
            Self::Draw(LinkedDraw { program, .. }) | Self::Dispatch { program, .. } => {
                Some(program)
            }
            _ => None,
        }
    }

    /// The bytes of the `params` uniform.
    pub fn params(&self) -> Option<&[u8]> {
        let bindings = &self.program()?.bindings;
        bindings.iter().find_map(|binding| match &binding.target {
            BindTarget::Params(block) => Some(&block.0[..]),
            _ => None,
        })
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LinkedDraw {
    pub program: LinkedProgram,
    pub fullscreen: bool,
    pub colors: Vec<LinkedColor>,
    pub depth: Option<LinkedDepth>,
    pub call: LinkedCall,
    pub primitive: wgpu::PrimitiveState,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LinkedColor {
    pub target: Target,
    pub format: wgpu::TextureFormat,
    pub clear: Option<[f64; 4]>,
    pub blend: Option<wgpu::BlendState>,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LinkedDepth {
    pub target: Target,
    pub clear: Option<f32>,
    pub state: wgpu::DepthStencilState,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum LinkedCall {
    Direct { vertices: u32, instances: u32 },
    Indirect(ResourceId),
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum LinkedGroups {
    Fixed([u32; 3]),
    Indirect(ResourceId),
}

/// What passes are linked against.
pub(crate) struct Linker<'a, 'p> {
    pub resources: &'a mut Resources<'p>,
    pub shaders: &'a Shaders,
    /// The params of the document that the pass stands in.
    pub params: &'a Params,
    /// What the names of the pass's document mean; `None` for passes that no document holds.
    pub scope: Option<&'a PassScope>,
    pub limits: &'a wgpu::Limits,
    pub features: wgpu::Features,
    pub diagnostics: &'a mut Vec<Diagnostic>,
    pub layouts: Layouts,
}

impl<'a, 'p> Linker<'a, 'p> {
    pub fn new(
        resources: &'a mut Resources<'p>,
        shaders: &'a Shaders,
        params: &'a Params,
        (limits, features): (&'a wgpu::Limits, wgpu::Features),
        diagnostics: &'a mut Vec<Diagnostic>,
    ) -> Self {
        Self {
            resources,
            shaders,
            params,
            scope: None,
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
            run: Run::Always,
            enabled: true,
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

    /// From here on, passes of this scope are linked.
    pub fn enter(&mut self, scope: &'a PassScope) {
        self.resources.nearby = Some(scope.clone());
        self.scope = Some(scope);
        self.params = &scope.params;
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
                let program =
                    self.program(&dispatch.program, &[ShaderStage::Compute], false, pass)?;
                let size = self.workgroup_size(&program, &pass.name)?;
                let groups = self.groups(&dispatch.groups, size, pass)?;
                Some(LinkedStep::Dispatch { program, groups })
            }
            Step::Copy { from, to } => self.copy(from, to, pass),
            Step::Clear { target, value } => self.clear(target, *value, pass),
        }
    }

    pub(crate) fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    pub(crate) fn expect(&mut self, name: &Located<String>) -> Option<Target> {
        self.resources.expect(name, self.diagnostics)
    }

    /// The name in the whole graph of what a shader's global means in the pass.
    pub(super) fn global<'n>(&self, name: &'n str) -> &'n str
    where
        'a: 'n,
    {
        self.scope.map_or(name, |scope| scope.global(name))
    }

    /// Last frame's version of a resource is there to be read.
    fn writable(&mut self, target: &Target, name: &str, span: &Span) {
        if let Origin::Previous(base) = self.resources.get(target.id).origin {
            let of = self.resources.get(base).name.clone();
            self.report(
                Diagnostic::error(
                    Code::ResourceKind,
                    format!("last frame's version of `{of}` cannot be written"),
                )
                .at(span.clone(), "written here")
                .help(format!(
                    "write `{of}`: the next frame finds it under `{name}`"
                )),
            );
        }
    }

    fn draw(&mut self, draw: &Draw, pass: &mut LinkedPass) -> Option<LinkedDraw> {
        // Without colours, a fragment shader that yields none may still discard and set depths.
        let mut colourless = || {
            let shader = self.shader(&draw.program);
            shader.is_some_and(|shader| shader.colourless_fragments().next().is_some())
        };
        let fragment = !draw.colors.is_empty()
            || draw.fullscreen
            || draw.program.fragment.is_some()
            || colourless();
        let stages: &[ShaderStage] = match (draw.fullscreen, fragment) {
            (true, _) => &[ShaderStage::Fragment],
            (false, true) => &[ShaderStage::Vertex, ShaderStage::Fragment],
            (false, false) => &[ShaderStage::Vertex],
        };
        let program = self.program(&draw.program, stages, draw.colors.is_empty(), pass);
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
        let needed = wgpu::Features::CONSERVATIVE_RASTERIZATION;
        if draw.primitive.conservative && !self.features.contains(needed) {
            self.report(
                Diagnostic::error(
                    Code::Feature,
                    "this adapter has no conservative rasterisation",
                )
                .at(pass.name.span.clone(), "`conservative: true`")
                .help("list it in `requires: [(feature: \"CONSERVATIVE_RASTERIZATION\")]`, so that devices that have it are opened with it"),
            );
            return None;
        }
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
        let folder = self.scope.map(|scope| Arc::clone(&scope.folder));
        let key = (folder.unwrap_or_default(), name.value.clone());
        let loaded = self.shaders.get(&key);
        if loaded.is_none() {
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
        loaded.cloned().flatten()
    }
}
