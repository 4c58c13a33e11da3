//! [`Plan`]: a graph on a viewport with values for its params, checked against an adapter's limits. Pure data.

mod imports;
mod memory;
mod origin;
mod request;

pub use memory::MemoryEntry;
pub use origin::{Field, Item, Scalar};
use request::Request;
pub use request::{Capture, CulledPass, OutputSummary, PassSummary, PlanRequest};

use crate::{
    conditions::{Conditions, conditions},
    cull,
    diagnostics::{Code, Diagnostic, Diagnostics, Severity},
    document::{located::Located, params::ParamValue},
    graph::Graph,
    instantiate::{Fallback, LoweredPass, Purpose, instantiate},
    lifetime::{Lifetime, lifetimes},
    link::{Access, BindTarget, LinkedPass, LinkedStep, Linker},
    order::{Order, order, order_of_live},
    pool::{Slots, slots},
    provider::Provided,
    resolve::{
        Buffer, Environment, Origin, Part, Resource, ResourceId, ResourceKind, Resources, Target,
        resolve,
    },
    schedule::schedule,
    step::Step,
};
use std::collections::{BTreeMap, BTreeSet};

/// The kind of a pass that keeps a material as it stands after another pass.
pub(crate) const CAPTURE: &str = "Capture";

/// A graph that is ready to be allocated: live passes in order, every resource with its size and uses.
#[derive(Debug)]
pub struct Plan {
    pub(crate) resources: Vec<Resource>,
    pub(crate) passes: Vec<LinkedPass>,
    pub(crate) schedule: Vec<usize>,
    pub(crate) lifetimes: BTreeMap<ResourceId, Lifetime>,
    pub(crate) readable: Vec<(String, Target)>,
    pub(crate) conditions: Conditions,
    pub(crate) slots: Slots,
    /// The resources that are also read as they were in the frame before.
    pub(crate) histories: BTreeSet<ResourceId>,
    pub(crate) graph: Graph,
    pub(crate) request: Request,
    culled: Vec<CulledPass>,
    fallbacks: Vec<Fallback>,
    warnings: Vec<Diagnostic>,
}

impl Graph {
    /// Plans the graph: resolves names and sizes, links shaders, orders and culls passes. Touches no GPU.
    ///
    /// # Errors
    /// Everything that is wrong, with its place.
    pub fn plan(&self, request: &PlanRequest<'_>) -> Result<Plan, Diagnostics> {
        let (plan, errors) = self.plan_all(request);
        plan.ok_or_else(|| self.diagnostics(errors))
    }

    /// The plan, or everything that is wrong, even if some of the document could not be read.
    pub(crate) fn plan_all(&self, request: &PlanRequest<'_>) -> (Option<Plan>, Vec<Diagnostic>) {
        let mut diagnostics = Vec::new();
        self.check_params(&request.params, &mut diagnostics);
        if request.viewport.contains(&0) {
            diagnostics.push(
                Diagnostic::error(Code::Size, "the viewport has no pixels").at(self.place(), ""),
            );
        }
        if !diagnostics.is_empty() {
            return (None, diagnostics);
        }
        let outside = request.imports.keys().cloned();
        let purpose = Purpose::Plan {
            values: &request.params,
            features: request.features,
            outside: outside.chain(request.provider.names()).collect(),
        };
        let instance = instantiate(&self.document, purpose, &mut diagnostics);
        let lacks = |diagnostic: &Diagnostic| {
            diagnostic.code == Code::Feature && diagnostic.severity == Severity::Error
        };
        if diagnostics.iter().any(lacks) {
            // On a device that cannot run the graph nothing else is worth knowing.
            diagnostics.retain(lacks);
            return (None, diagnostics);
        }
        let environment = Environment {
            viewport: request.viewport,
            limits: &request.limits,
            provider: request.provider,
            imports: &request.imports,
        };
        let lowered = &instance.passes;
        let mut resources = resolve(
            &instance.materials,
            &instance.unread,
            &instance.params,
            &environment,
            &mut diagnostics,
        );
        resources.hide(&instance.hidden);
        for (name, bytes) in lowered.iter().flat_map(|pass| &pass.scratch) {
            let kind = ResourceKind::Buffer(Buffer {
                count: Some(bytes / 4),
                bytes: 0,
            });
            resources.add(name.clone(), None, kind);
        }
        let mut linker = Linker::new(
            &mut resources,
            &self.shaders,
            &instance.params,
            (&request.limits, request.features),
            &mut diagnostics,
        );
        let mut passes = Vec::new();
        // How many passes stand above the first one with a mistake: what that one writes is not known.
        let mut sound: Option<usize> = None;
        for (index, pass) in lowered.iter().enumerate() {
            if instance.first_broken == Some(index) {
                sound.get_or_insert(passes.len());
            }
            linker.enter(&pass.scope);
            match linker.pass(&pass.name, pass.kind, &pass.steps) {
                Some(mut linked) => {
                    linked.enabled = pass.enabled;
                    linked.run = pass.run.clone();
                    linker.overwrites(&mut linked, &pass.overwrites);
                    passes.push(linked);
                }
                None => {
                    sound.get_or_insert(passes.len());
                }
            }
            let after = |capture: &&Capture| capture.after.as_deref() == Some(pass.name.as_str());
            let captures: BTreeSet<&Capture> = request.captures.iter().filter(after).collect();
            for capture in captures {
                passes.extend(linker.capture(capture, pass, self));
            }
        }
        linker.resources.nearby.clear();
        let layouts = std::mem::take(&mut linker.layouts);
        layouts.settle(&mut resources, &request.limits, &mut diagnostics);
        check_captures(request, lowered, &mut diagnostics);
        let complete = sound.is_none() && instance.first_broken.is_none();
        let judged = sound.unwrap_or(passes.len());
        let order = order(&passes, judged, &resources, &mut diagnostics);
        if complete {
            never_written(&passes, &resources, &order, &mut diagnostics);
        }
        let written = |target: &Target| !complete || !order.final_writers(target).is_empty();
        let readable = self.readable(request, &mut resources, written, &mut diagnostics);
        if !complete || has_errors(&diagnostics) {
            return (None, diagnostics);
        }
        // What the host imports is written for the host.
        let imports = passes.iter().enumerate().filter(|(_, pass)| {
            let is_import = |access: &Access| {
                access.writes && resources.get(access.resource).origin == Origin::Host
            };
            pass.accesses.iter().any(is_import)
        });
        let roots: BTreeSet<usize> = readable
            .iter()
            .flat_map(|(_, target)| order.final_writers(target))
            .chain(imports.map(|(index, _)| index))
            .collect();
        let live = cull::live(&order, roots, |pass| {
            let of = |access: &Access| match resources.get(access.resource).origin {
                Origin::Previous(id) => order.final_writers(&Target {
                    id,
                    part: access.part.clone(),
                }),
                _ => BTreeSet::new(),
            };
            passes[pass]
                .accesses
                .iter()
                .flat_map(of)
                .collect::<Vec<_>>()
        });
        let schedule = schedule(&order_of_live(&passes, &resources, &live), &live);
        let mut lifetimes = lifetimes(&passes, &schedule);
        unsized_buffers(&lifetimes, &resources, &mut diagnostics);
        // Whether conditions agree must not depend on which outputs are asked for.
        let all: Vec<usize> = (0..passes.len()).collect();
        conditions(&passes, &all, &resources.list, &mut diagnostics);
        let conditions = conditions(&passes, &schedule, &resources.list, &mut Vec::new());
        for (_, target) in &readable {
            let Some(lifetime) = lifetimes.get_mut(&target.id) else {
                continue;
            };
            lifetime.textures |=
                wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::TEXTURE_BINDING;
            lifetime.buffers |= wgpu::BufferUsages::COPY_SRC;
        }
        if request.poison.is_some() {
            for (id, lifetime) in &mut lifetimes {
                poisonable(&resources.get(*id).kind, lifetime);
            }
        }
        // Two versions of one resource are made alike, and a version can be read although nobody asks for the other.
        let previous: Vec<(ResourceId, ResourceId)> = lifetimes
            .keys()
            .filter_map(|id| match resources.get(*id).origin {
                Origin::Previous(base) => Some((*id, base)),
                _ => None,
            })
            .collect();
        for (id, base) in &previous {
            let (textures, buffers) = (lifetimes[id].textures, lifetimes[id].buffers);
            let Some(of_base) = lifetimes.get_mut(base) else {
                continue;
            };
            of_base.textures |= textures;
            of_base.buffers |= buffers;
        }
        imports::check(
            &passes,
            &schedule,
            &resources.list,
            request,
            &mut diagnostics,
        );
        if has_errors(&diagnostics) {
            return (None, diagnostics);
        }
        let kept: BTreeSet<ResourceId> = conditions
            .kept
            .iter()
            .copied()
            .chain(readable.iter().map(|(_, target)| target.id))
            .chain(previous.iter().map(|(_, base)| *base))
            .collect();
        let slots = slots(&passes, &schedule, &resources.list, &lifetimes, &kept);
        let culled = passes
            .iter()
            .zip(&live)
            .filter(|(_, live)| !**live)
            .map(|(pass, _)| CulledPass {
                name: pass.name.value.clone(),
                reason: reason(pass, &resources.list),
            })
            .collect();
        let plan = Plan {
            resources: resources.list,
            passes,
            schedule,
            lifetimes,
            readable,
            conditions,
            slots,
            histories: previous.iter().map(|(_, base)| *base).collect(),
            graph: self.clone(),
            request: Request::of(request),
            culled,
            fallbacks: instance.fallbacks,
            warnings: diagnostics,
        };
        (Some(plan), Vec::new())
    }

    fn check_params(
        &self,
        params: &BTreeMap<String, ParamValue>,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        for (name, value) in params {
            let problem = match self.param(name) {
                Ok(param) => param.check(value).err().map(|why| {
                    Diagnostic::error(Code::ParamValue, format!("param `{name}` = {value}: {why}"))
                        .at(param.name.span.clone(), "declared here")
                }),
                Err(error) => Some(Diagnostic::error(Code::UnknownParam, error.to_string())),
            };
            diagnostics.extend(problem);
        }
    }

    /// The targets of all outputs and captures that are wanted.
    fn readable(
        &self,
        request: &PlanRequest<'_>,
        resources: &mut Resources<'_>,
        written: impl Fn(&Target) -> bool,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Vec<(String, Target)> {
        let mut readable = Vec::new();
        let declared = self.outputs();
        for wanted in request.outputs.iter().flatten() {
            if !declared.contains(&wanted.as_str()) {
                diagnostics.push(
                    Diagnostic::error(
                        Code::Output,
                        format!("`{}` has no output `{wanted}`", self.path()),
                    )
                    .suggest(wanted, declared.iter().copied()),
                );
            }
        }
        for output in &self.document.outputs {
            let wanted = request
                .outputs
                .as_ref()
                .is_none_or(|wanted| wanted.contains(&output.name.value));
            let material = output.material.as_ref().unwrap_or(&output.name);
            let Some(target) = resources.expect(material, diagnostics) else {
                continue;
            };
            if !written(&target) {
                diagnostics.push(
                    Diagnostic::error(
                        Code::ReadBeforeWrite,
                        format!("no pass writes the output `{}`", *output.name),
                    )
                    .at(
                        material.span.clone(),
                        format!("`{}` is never written", material.value),
                    )
                    .help("let a pass write it, or name another `material`"),
                );
            } else if let Some(why) = unreadable(resources, &target) {
                diagnostics.push(
                    Diagnostic::error(
                        Code::FormatMismatch,
                        format!("the output `{}` cannot be read back", *output.name),
                    )
                    .at(material.span.clone(), why)
                    .help("use Depth32Float or Depth16Unorm"),
                );
            } else if wanted {
                readable.push((output.name.value.clone(), target));
            }
        }
        for capture in &request.captures {
            let name = capture.name();
            // Those after a pass were entered as resources of their own; an output of that name is there already.
            let found = resources.find(&name);
            match found {
                Some(target)
                    if matches!(resources.get(target.id).kind, ResourceKind::Provided(_)) =>
                {
                    let help = format!("name a pass that binds it: `{name}@PASS`");
                    let message = format!("`{name}` is provided, not written by a pass");
                    diagnostics.push(Diagnostic::error(Code::Output, message).help(help));
                }
                Some(target) if !written(&target) => diagnostics.push(Diagnostic::error(
                    Code::Output,
                    format!("`{name}` cannot be read back: no pass writes it"),
                )),
                Some(target) if unreadable(resources, &target).is_some() => {
                    let why = unreadable(resources, &target).unwrap_or_default();
                    diagnostics.push(Diagnostic::error(
                        Code::Output,
                        format!("`{name}` cannot be read back: it is {why}"),
                    ));
                }
                Some(target) if readable.iter().all(|(known, _)| *known != name) => {
                    readable.push((name, target))
                }
                Some(_) => {}
                None if capture.after.is_some() => {}
                None => {
                    let known = resources.known();
                    diagnostics.push(
                        Diagnostic::error(
                            Code::Output,
                            format!("`{}` has no output or material `{name}`", self.path()),
                        )
                        .suggest(&name, known.iter().map(String::as_str)),
                    );
                }
            }
        }
        readable
    }
}

fn check_captures(
    request: &PlanRequest<'_>,
    lowered: &[LoweredPass],
    diagnostics: &mut Vec<Diagnostic>,
) {
    let passes: Vec<&str> = lowered.iter().map(|pass| pass.name.as_str()).collect();
    for pass in request
        .captures
        .iter()
        .filter_map(|capture| capture.after.as_deref())
    {
        if !passes.contains(&pass) {
            diagnostics.push(
                Diagnostic::error(
                    Code::Output,
                    format!("there is no pass `{pass}` to read a material after"),
                )
                .suggest(pass, passes.iter().copied()),
            );
        }
    }
}

fn has_errors(diagnostics: &[Diagnostic]) -> bool {
    diagnostics
        .iter()
        .any(|diagnostic| diagnostic.severity == Severity::Error)
}

/// A buffer that is only cleared or copied has no size: no shader says what its items are.
fn unsized_buffers(
    lifetimes: &BTreeMap<ResourceId, Lifetime>,
    resources: &Resources<'_>,
    diagnostics: &mut Vec<Diagnostic>,
) {
    for resource in lifetimes.keys().map(|id| resources.get(*id)) {
        let ResourceKind::Buffer(Buffer { bytes: 0, .. }) = resource.kind else {
            continue;
        };
        let error = Diagnostic::error(
            Code::Size,
            format!(
                "the size of `{}` is not known: no shader sees it",
                resource.name
            ),
        )
        .help("let a pass bind it: the size of its items comes from the shader's type");
        diagnostics.push(match &resource.declared {
            Some(span) => error.at(span.clone(), ""),
            None => error,
        });
    }
}

/// Reads of last frame's version of what no frame writes.
fn never_written(
    passes: &[LinkedPass],
    resources: &Resources<'_>,
    order: &Order,
    diagnostics: &mut Vec<Diagnostic>,
) {
    for pass in passes {
        for access in &pass.accesses {
            let Origin::Previous(id) = resources.get(access.resource).origin else {
                continue;
            };
            let part = access.part.clone();
            if !order.final_writers(&Target { id, part }).is_empty() {
                continue;
            }
            let name = &resources.get(id).name;
            diagnostics.push(
                Diagnostic::error(
                    Code::ReadBeforeWrite,
                    format!(
                        "pass `{}` reads `{name}` of the frame before, but no pass writes it",
                        *pass.name
                    ),
                )
                .at(access.span.clone(), "read here")
                .at(pass.name.span.clone(), "by this pass")
                .help(format!("let a pass write `{name}`")),
            );
        }
    }
}

/// Adds the usages by which memory is filled with a pattern: depths are cleared, all else is copied to.
fn poisonable(kind: &ResourceKind, lifetime: &mut Lifetime) {
    match kind {
        ResourceKind::Texture(texture) if texture.format.is_depth_stencil_format() => {
            lifetime.textures |= wgpu::TextureUsages::RENDER_ATTACHMENT;
        }
        ResourceKind::Texture(_) => lifetime.textures |= wgpu::TextureUsages::COPY_DST,
        ResourceKind::Buffer(_) => lifetime.buffers |= wgpu::BufferUsages::COPY_DST,
        _ => {}
    }
}

/// Why the content of a resource cannot come back to the host.
fn unreadable(resources: &Resources<'_>, target: &Target) -> Option<String> {
    match &resources.get(target.id).kind {
        ResourceKind::Texture(texture) if texture.format.block_copy_size(None).is_none() => {
            Some(format!(
                "a texture of format {:?}, whose layout is the driver's own",
                texture.format
            ))
        }
        _ => None,
    }
}

impl Linker<'_, '_> {
    /// A copy of a material as it stands after the pass that was linked last.
    fn capture(
        &mut self,
        capture: &Capture,
        after: &LoweredPass,
        graph: &Graph,
    ) -> Option<LinkedPass> {
        let name = Located::new(capture.name(), graph.place());
        let from = Located::new(capture.material.clone(), graph.place());
        let Some(target) = self.resources.find(&from) else {
            if !self.resources.is_broken(&from) {
                let known = self.resources.known();
                let message = format!(
                    "`{}` has no material `{}` to read back",
                    graph.path(),
                    from.value
                );
                self.report(
                    Diagnostic::error(Code::Output, message)
                        .suggest(&from, known.iter().map(String::as_str)),
                );
            }
            return None;
        };
        let kind = match &self.resources.get(target.id).kind {
            ResourceKind::Texture(texture) => {
                let mut copy = texture.clone();
                let Part { mips, layers } = &target.part;
                copy.size = copy.size.map(|edge| (edge >> mips.start).max(1));
                (copy.mips, copy.layers) = (mips.len() as u32, layers.len() as u32);
                ResourceKind::Texture(copy)
            }
            ResourceKind::Buffer(buffer) => ResourceKind::Buffer(buffer.clone()),
            ResourceKind::Provided(Provided { items: None, .. }) => {
                let message = format!("`{}` cannot be read back", from.value);
                let help =
                    "its size is known only once it is built, and the copy is planned before";
                self.report(Diagnostic::error(Code::Output, message).help(help));
                return None;
            }
            ResourceKind::Provided(_) => ResourceKind::Buffer(Buffer::default()),
            ResourceKind::Sampler(_) => {
                self.diagnostics.push(Diagnostic::error(
                    Code::Output,
                    format!("`{}` is a sampler and has no content", from.value),
                ));
                return None;
            }
        };
        self.resources.add(name.value.clone(), None, kind);
        let steps = [Step::Copy {
            from,
            to: name.clone(),
        }];
        let mut pass = self.pass(&name, CAPTURE, &steps)?;
        pass.enabled = after.enabled;
        pass.run = after.run.clone();
        Some(pass)
    }

    /// Takes the author's word that a pass writes all of some resources.
    fn overwrites(&mut self, pass: &mut LinkedPass, names: &[Located<String>]) {
        for name in names {
            let Some(target) = self.expect(name) else {
                continue;
            };
            let mut written = false;
            for access in &mut pass.accesses {
                if access.writes && access.resource == target.id && access.part == target.part {
                    written = true;
                    access.covers = true;
                }
            }
            if !written {
                self.report(
                    Diagnostic::error(
                        Code::ResourceKind,
                        format!("pass `{}` does not write `{}`", *pass.name, name.value),
                    )
                    .at(name.span.clone(), "said to be overwritten"),
                );
            }
        }
    }
}

fn reason(pass: &LinkedPass, resources: &[Resource]) -> String {
    let written: BTreeSet<&str> = pass
        .accesses
        .iter()
        .filter(|access| access.writes)
        .map(|access| resources[access.resource.0].name.as_str())
        .collect();
    let names: Vec<String> = written.iter().map(|name| format!("`{name}`")).collect();
    match names.is_empty() {
        true => "it writes nothing".to_owned(),
        false => format!(
            "nothing that an output needs reads what it writes ({})",
            names.join(", ")
        ),
    }
}

impl Plan {
    /// The live passes in the order in which they run.
    pub fn passes(&self) -> Vec<PassSummary> {
        let summary = |&pass: &usize| PassSummary {
            name: self.passes[pass].name.value.clone(),
            kind: self.passes[pass].kind.to_owned(),
        };
        self.schedule.iter().map(summary).collect()
    }

    /// The passes that do not run.
    pub fn culled(&self) -> &[CulledPass] {
        &self.culled
    }

    /// The params that got another value because the device lacks a feature.
    pub fn fallbacks(&self) -> &[Fallback] {
        &self.fallbacks
    }

    /// The provided resources that live passes bind; only these are built.
    pub fn provided(&self) -> Vec<&str> {
        self.lifetimes
            .keys()
            .map(|id| &self.resources[id.0])
            .filter(|resource| matches!(resource.kind, ResourceKind::Provided(_)))
            .map(|resource| resource.name.as_str())
            .collect()
    }

    /// What can be read back after a frame.
    pub fn outputs(&self) -> Vec<OutputSummary> {
        let summary = |(name, target): &(String, Target)| {
            let (format, size) = match &self.resources[target.id.0].kind {
                ResourceKind::Texture(texture) => (
                    Some(texture.format),
                    texture
                        .size
                        .map(|edge| (edge >> target.part.mips.start).max(1)),
                ),
                ResourceKind::Buffer(buffer) => {
                    (None, [u32::try_from(buffer.bytes).unwrap_or(u32::MAX), 1])
                }
                _ => (None, [0, 0]),
            };
            OutputSummary {
                name: name.clone(),
                format,
                size,
            }
        };
        self.readable.iter().map(summary).collect()
    }

    /// The graph that was planned.
    pub fn graph(&self) -> &Graph {
        &self.graph
    }

    /// Width and height of the viewport in pixels.
    pub fn viewport(&self) -> [u32; 2] {
        self.request.viewport
    }

    /// The value of a param in this plan.
    pub fn param(&self, name: &str) -> Option<&ParamValue> {
        let default = || {
            let params = self.graph.params().iter();
            params
                .clone()
                .find(|param| param.name.value == name)
                .map(|param| &param.default)
        };
        self.request.params.get(name).or_else(default)
    }

    /// This plan for another viewport.
    ///
    /// # Errors
    /// Everything that is wrong then.
    pub fn with_viewport(&self, viewport: [u32; 2]) -> Result<Self, Diagnostics> {
        self.with(|request| request.viewport = viewport)
    }

    /// This plan with another value of a param.
    ///
    /// # Errors
    /// Everything that is wrong then.
    pub fn with_param(&self, name: &str, value: ParamValue) -> Result<Self, Diagnostics> {
        self.with(|request| {
            request.params.insert(name.to_owned(), value);
        })
    }

    /// This plan with several things of its request changed at once, such as the viewport and the imports that follow it. What the
    /// provider described is as it was, unless another provider is put in.
    ///
    /// # Errors
    /// Everything that is wrong then.
    pub fn with<'a>(
        &'a self,
        change: impl FnOnce(&mut PlanRequest<'a>),
    ) -> Result<Self, Diagnostics> {
        let mut request = self.request.again();
        change(&mut request);
        self.graph.plan(&request)
    }

    /// What is suspicious.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }
}
