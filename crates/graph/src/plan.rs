//! [`Plan`]: a graph on a viewport with values for its params, checked against an adapter's limits. Pure data.

mod imports;
mod memory;
mod origin;
mod readable;
mod report;
mod request;

pub use memory::MemoryEntry;
pub use origin::{Field, Item, Scalar};
use request::Request;
pub use request::{Capture, CulledPass, OutputSummary, PassSummary, PlanRequest};

use crate::{
    conditions::{Conditions, conditions},
    cull,
    diagnostics::{Code, Diagnostic, Diagnostics, Severity},
    document::params::ParamValue,
    graph::Graph,
    instantiate::{Fallback, Instance, Purpose, instantiate},
    lifetime::{Lifetime, lifetimes},
    link::{Access, BindTarget, LinkedPass, LinkedStep, Linker},
    order::{Order, order, order_of_live},
    pool::{Slots, slots},
    resolve::{
        Buffer, Environment, Origin, Resource, ResourceId, ResourceKind, Resources, Target, resolve,
    },
    schedule::schedule,
};
use std::collections::{BTreeMap, BTreeSet};

/// With so many mistakes nobody misses those further down.
const ENOUGH: usize = 1000;

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
        let mut resources = resolve(
            &instance.materials,
            &instance.unread,
            &instance.params,
            &environment,
            &mut diagnostics,
        );
        resources.hide(&instance.hidden);
        for (name, bytes) in instance.passes.iter().flat_map(|pass| &pass.scratch) {
            let kind = ResourceKind::Buffer(Buffer {
                count: Some(bytes / 4),
                bytes: 0,
            });
            resources.add(name.clone(), None, kind);
        }
        let (passes, sound) = self.link(request, &instance, &mut resources, &mut diagnostics);
        readable::check_captures(request, &instance.passes, &mut diagnostics);
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
        let live = live(&passes, &resources, &readable, &order);
        let schedule = schedule(&order_of_live(&passes, &resources, &live), &live);
        let mut lifetimes = lifetimes(&passes, &schedule);
        unsized_buffers(&lifetimes, &resources, &mut diagnostics);
        // Whether conditions agree must not depend on which outputs are asked for.
        let all: Vec<usize> = (0..passes.len()).collect();
        conditions(&passes, &all, &resources.list, &mut diagnostics);
        let conditions = conditions(&passes, &schedule, &resources.list, &mut Vec::new());
        let histories = histories(&lifetimes, &resources);
        further_uses(&mut lifetimes, &readable, &histories, request, &resources);
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
            .chain(histories.values().copied())
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
            histories: histories.into_values().collect(),
            graph: self.clone(),
            request: Request::of(request),
            culled,
            fallbacks: instance.fallbacks,
            warnings: diagnostics,
        };
        match plan.check_memory(request.memory_limit) {
            Some(too_much) => (None, vec![too_much]),
            None => (Some(plan), Vec::new()),
        }
    }

    /// All passes with their captures, and how many of them stand above the first one with a mistake, if one has.
    fn link(
        &self,
        request: &PlanRequest<'_>,
        instance: &Instance,
        resources: &mut Resources<'_>,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> (Vec<LinkedPass>, Option<usize>) {
        let mut linker = Linker::new(
            resources,
            &self.shaders,
            &instance.params,
            (&request.limits, request.features),
            diagnostics,
        );
        let mut passes = Vec::new();
        // How many passes stand above the first one with a mistake: what that one writes is not known.
        let mut sound: Option<usize> = None;
        for (index, pass) in instance.passes.iter().enumerate() {
            // For each mistake all names are searched for what was meant.
            if linker.diagnostics.len() > ENOUGH {
                sound.get_or_insert(passes.len());
                break;
            }
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
                passes.extend(linker.capture(capture, self));
            }
        }
        linker.resources.nearby = None;
        let layouts = std::mem::take(&mut linker.layouts);
        layouts.settle(resources, &request.limits, diagnostics);
        (passes, sound)
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
}

fn has_errors(diagnostics: &[Diagnostic]) -> bool {
    diagnostics
        .iter()
        .any(|diagnostic| diagnostic.severity == Severity::Error)
}

/// Whether each pass is needed, by an output or by the host.
fn live(
    passes: &[LinkedPass],
    resources: &Resources<'_>,
    readable: &[(String, Target)],
    order: &Order,
) -> Vec<bool> {
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
    cull::live(order, roots, |pass| {
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
    })
}

/// The resources that are last frame's version of another one, with that one.
fn histories(
    lifetimes: &BTreeMap<ResourceId, Lifetime>,
    resources: &Resources<'_>,
) -> BTreeMap<ResourceId, ResourceId> {
    let of = |id: &ResourceId| match resources.get(*id).origin {
        Origin::Previous(base) => Some((*id, base)),
        _ => None,
    };
    lifetimes.keys().filter_map(of).collect()
}

/// Adds what is done to resources besides the passes' work: reading back, filling with a pattern, two versions taking turns.
fn further_uses(
    lifetimes: &mut BTreeMap<ResourceId, Lifetime>,
    readable: &[(String, Target)],
    histories: &BTreeMap<ResourceId, ResourceId>,
    request: &PlanRequest<'_>,
    resources: &Resources<'_>,
) {
    for (_, target) in readable {
        let Some(lifetime) = lifetimes.get_mut(&target.id) else {
            continue;
        };
        lifetime.textures |= wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::TEXTURE_BINDING;
        lifetime.buffers |= wgpu::BufferUsages::COPY_SRC;
    }
    if request.poison.is_some() {
        for (id, lifetime) in lifetimes.iter_mut() {
            poisonable(&resources.get(*id).kind, lifetime);
        }
    }
    // Two versions of one resource are made alike, and a version can be read although nobody asks for the other.
    for (id, base) in histories {
        let (textures, buffers) = (lifetimes[id].textures, lifetimes[id].buffers);
        let Some(of_base) = lifetimes.get_mut(base) else {
            continue;
        };
        of_base.textures |= textures;
        of_base.buffers |= buffers;
    }
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
