//! Planning: runs one phase after the other, each on the result of the phase before.

use super::backend::not_proven;
use super::memory::{Memory, growing};
use super::readable::{check_captures, readable};
use super::summary::{is_light, refused_light};
use super::usages;
use crate::{
    compose::Loaded,
    diagnostics::{Diagnostic, Reports},
    errors::{
        flow::OrderError, instantiate::InterfaceError, plan::OutputError, resource::SizeError,
    },
    flow::{
        GraphView, Lifetime, Lifetimes, Order, Schedule, aliases::aliases, arrange::arrange,
        conditions::conditions, cull, lifetimes::lifetimes, order::order, schedule::sequence,
    },
    instantiate::{Merge, PlanInputs, build::flatten, lower::lower, params::checked},
    link::{Access, Linked, LinkedPass, PassId, linker::link},
    param::ParamValue,
    provider::{Described, Provided},
    request::{PlanRequest, Request},
    resource::{Buffer, Growth, Origin, Resource, ResourceId, ResourceKind, Target},
    source::Located,
};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Content of a [`Plan`](super::plan::Plan).
#[derive(Clone, Debug)]
pub(super) struct Planned {
    pub graph: Arc<Loaded>,
    pub request: Request<Described>,
    pub values: BTreeMap<String, ParamValue>,
    pub named_values: Vec<(String, String)>,
    pub resources: Vec<Resource>,
    pub passes: Vec<LinkedPass>,
    pub schedule: Schedule,
    pub readable: Vec<(String, Target)>,
    pub culled: Vec<CulledPass>,
    pub warnings: Vec<Diagnostic>,
    /// Params of the loaded document of which another value may need another plan. The values of
    /// all other params stand only in the bytes of `params` uniforms.
    pub depends_on: BTreeSet<String>,
    /// Provided resources that no live pass uses and whose number of items, kind or presence was
    /// asked for; `None` for those that the provider did not know.
    pub relies_on: BTreeMap<String, Option<Provided>>,
}

/// A pass that a plan does not run because nothing needs its results, with the reason.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct CulledPass {
    /// Full name of the pass ([`LinkedPass::name`]), with the names of the groups and includes
    /// around it in front: `blur.x`.
    pub name: String,
    /// Reason for which the pass does not run, as a clause for messages: "it writes nothing".
    pub reason: String,
}

/// Result of planning: the plan if there are no mistakes, or else the mistakes; and the values that
/// decide which entries exist.
#[derive(Default)]
pub(super) struct Outcome {
    pub plan: Option<Planned>,
    pub found: Vec<Diagnostic>,
    pub plan_inputs: PlanInputs,
}

/// Plans a graph, and collects all mistakes, even if some of the document could not be read.
pub(super) fn plan_all(graph: &Arc<Loaded>, request: &PlanRequest<'_>) -> Outcome {
    let mut reports = Reports::default();
    reports.any_adapter = request.any_adapter;
    let params = checked(
        &graph.document,
        &request.params,
        request.surroundings(),
        &mut reports,
    );
    if request.viewport.contains(&0) {
        reports.report(OutputError::NoViewport(graph.place()));
    }
    let backend = request.partial_backend.as_ref();
    if let Some(error) = backend.and_then(|backend| not_proven(graph, backend)) {
        reports.report(error);
        return Outcome::lacking(reports, PlanInputs::default());
    }
    let (Ok(params), 0) = (params, reports.errors()) else {
        return Outcome::failed(reports, PlanInputs::default());
    };
    let values = params.values();
    let before = reports.clone();
    let mut merges = true;
    let mut linked = loop {
        let (mut flat, passes) = flatten(graph, request, params.clone(), merges, reports);
        if flat.symbols.reports.iter().any(is_lacking) {
            return Outcome::lacking(flat.symbols.reports, flat.plan_inputs);
        }
        let lowered = lower(&mut flat, passes);
        check_captures(request, &lowered, &mut flat.symbols.reports);
        let linked = link(flat, lowered, |passes, resources, above, reports| {
            arrange(GraphView { passes, resources }, above, reports)
        });
        let Some(copies) = linked.two_copies() else {
            break linked;
        };
        // Something between two includes of one content changes what they read or write.
        reports = before.clone();
        reports.warn(copies);
        merges = false;
    };
    let mut plan_inputs = std::mem::take(&mut linked.flat.plan_inputs);
    let mut reports = std::mem::take(&mut linked.flat.symbols.reports);
    let refused = refused_light(&graph.document, linked.flat.symbols.kinds());
    let inputs = &mut plan_inputs;
    match (
        schedule(graph, linked, request, values, inputs, &mut reports),
        refused,
    ) {
        (Some(plan), _) => finish(plan, request, reports, plan_inputs),
        // Whatever else is wrong under a light that the document does not take may be fine under
        // one that it takes.
        (None, Some(refused)) => {
            reports = before;
            reports.report(refused);
            Outcome::failed(reports, plan_inputs)
        }
        (None, None) => Outcome::failed(reports, plan_inputs),
    }
}

/// Orders and culls the linked passes; `None` after a mistake. Warnings, and the params that the
/// plan depends on, are filled in later.
fn schedule(
    graph: &Arc<Loaded>,
    mut linked: Linked<'_>,
    request: &PlanRequest<'_>,
    values: BTreeMap<String, ParamValue>,
    plan_inputs: &mut PlanInputs,
    reports: &mut Reports,
) -> Option<Planned> {
    let is_complete = linked.flat.first_invalid.is_none();
    let first_invalid = linked.flat.first_invalid.unwrap_or(linked.passes.len());
    let order = order(view(&linked), first_invalid, reports);
    if is_complete {
        never_written(view(&linked), &order, reports);
        check_counters(view(&linked), &order, reports);
        interfaces(&linked, reports);
    }
    let written = |target: &Target| !is_complete || !order.final_writers(target).is_empty();
    // Outputs are found as names in documents are, and so are their mistakes.
    std::mem::swap(&mut linked.flat.symbols.reports, reports);
    let root = linked.flat.symbols.root();
    let at = &mut linked.flat.symbols.at(root, None);
    let readable = readable(graph, request, at, written, plan_inputs);
    std::mem::swap(&mut linked.flat.symbols.reports, reports);
    if !is_complete || reports.errors() > 0 {
        return None;
    }
    let named_values = linked.flat.symbols.found_values();
    let mut asked = linked.flat.symbols.take_asked();
    let (passes, mut resources) = (linked.passes, linked.flat.symbols.resources);
    drop_kinds(&mut resources, &asked);
    let view = GraphView {
        passes: &passes,
        resources: &resources,
    };
    let live = live(view, &readable, &order);
    let sequence = sequence(&live);
    let mut lifetimes = lifetimes(view, &sequence);
    unmade(&lifetimes, view, reports);
    // Conditions must agree for any choice of outputs.
    let pass_ids: Vec<PassId> = view.ids().map(|(id, _)| id).collect();
    conditions(view, &pass_ids, reports);
    let conditions = conditions(view, &sequence, &mut Reports::default());
    let previous = previous(&lifetimes, view);
    for (id, base) in &previous {
        // A resource of the host is copied behind the frame, so it must exist then.
        let lifetime = lifetimes[id].clone();
        lifetimes.entry(*base).or_insert(lifetime);
    }
    further_uses(&mut lifetimes, &readable, &previous, request, view);
    usages::check(view, &sequence, request, reports);
    if reports.errors() > 0 {
        return None;
    }
    let is_constant = |id: &&ResourceId| view.resource(**id).origin == Origin::Constant;
    let kept = conditions.kept.iter();
    let kept: BTreeSet<ResourceId> = kept
        .chain(lifetimes.keys().filter(is_constant))
        .copied()
        .chain(readable.iter().map(|(_, target)| target.id))
        .chain(previous.values().copied())
        .chain(counters(&lifetimes, view))
        .collect();
    let most = request.limits.max_buffer_size;
    let aliases = aliases(view, &sequence, &lifetimes, &kept, most);
    let culled = culled(view, &live);
    // Not those that live passes bind.
    let used = lifetimes.keys().map(|id| view.resource(*id));
    for resource in used.filter(|resource| resource.is_provided()) {
        asked.remove(&resource.name);
    }
    let is_own = |base: &&ResourceId| view.resource(**base).origin == Origin::Own;
    let schedule = Schedule {
        ping_pong: previous.values().filter(is_own).copied().collect(),
        passes: sequence,
        lifetimes,
        conditions,
        aliases,
    };
    Some(Planned {
        graph: Arc::clone(graph),
        request: request.to(Described::by(request.provider)),
        values,
        named_values,
        resources,
        passes,
        schedule,
        readable,
        culled,
        warnings: Vec::new(),
        depends_on: BTreeSet::new(),
        relies_on: asked,
    })
}

/// Drops the kinds that no expression and no shader has asked for; those of lights count always, as
/// documents say which they take.
fn drop_kinds(resources: &mut [Resource], asked: &BTreeMap<String, Option<Provided>>) {
    for resource in resources {
        if let ResourceKind::Provided(provided) = &mut resource.kind
            && !is_light(&resource.name)
            && !asked.contains_key(&resource.name)
        {
            provided.kind = None;
        }
    }
}

fn finish(
    mut plan: Planned,
    request: &PlanRequest<'_>,
    mut reports: Reports,
    plan_inputs: PlanInputs,
) -> Outcome {
    plan.depends_on = std::mem::take(&mut reports.depends_on);
    let memory = plan.memory();
    let too_much = memory.check(request.memory_limit, plan.graph.place());
    let bound = plan.schedule.lifetimes.keys();
    let bound = bound.filter_map(|id| plan.resources[id.0].named_kind());
    if let Some(error) = too_much.or_else(|| refused_light(&plan.graph.document, bound)) {
        reports.report(error);
        return Outcome::failed(reports, plan_inputs);
    }
    plan.warnings = reports.into_list();
    Outcome {
        plan: Some(plan),
        found: Vec::new(),
        plan_inputs,
    }
}

impl Planned {
    pub fn memory(&self) -> Memory<'_> {
        Memory {
            resources: &self.resources,
            schedule: &self.schedule,
        }
    }
}

impl Outcome {
    fn failed(reports: Reports, plan_inputs: PlanInputs) -> Self {
        Self {
            plan: None,
            found: reports.into_list(),
            plan_inputs,
        }
    }

    /// Keeps only the missing features and unmet needs: where the graph cannot run, other mistakes
    /// do not matter.
    fn lacking(reports: Reports, plan_inputs: PlanInputs) -> Self {
        let mut outcome = Self::failed(reports, plan_inputs);
        outcome.found.retain(is_lacking);
        outcome
    }
}

fn is_lacking(diagnostic: &Diagnostic) -> bool {
    use crate::diagnostics::{code::Code, diagnostic::Severity};
    matches!(diagnostic.code, Code::Feature | Code::Need) && diagnostic.severity == Severity::Error
}

fn view<'l>(linked: &'l Linked<'_>) -> GraphView<'l> {
    GraphView {
        passes: &linked.passes,
        resources: &linked.flat.symbols.resources,
    }
}

/// Finds the live passes.
fn live(view: GraphView<'_>, readable: &[(String, Target)], order: &Order) -> Vec<bool> {
    // An import is written for the host.
    let of_host =
        |access: &Access| access.writes && view.resource(access.resource).origin == Origin::Host;
    let passes = view.ids();
    let imports = passes.filter(|(_, pass)| pass.accesses.iter().any(of_host));
    let final_writers = |target: &Target| {
        if view.resource(target.id).keep {
            writers(view, target)
        } else {
            order.final_writers(target)
        }
    };
    let roots: BTreeSet<PassId> = readable
        .iter()
        .flat_map(|(_, target)| final_writers(target))
        .chain(imports.map(|(id, _)| id))
        .collect();
    cull::live(order, roots, |pass| {
        let sources = |access: &Access| {
            let resource = view.resource(access.resource);
            let part = |id| Target {
                id,
                part: access.part.clone(),
            };
            let mut needed = match resource.origin {
                Origin::Previous(id) => return order.final_writers(&part(id)),
                _ if resource.keep && access.reads => writers(view, &part(access.resource)),
                _ => BTreeSet::new(),
            };
            if let Some(growth) = &resource.growth {
                needed.extend(final_writers(&growth.counter));
            }
            needed
        };
        let accesses = view.pass(pass).accesses.iter();
        accesses.flat_map(sources).collect::<Vec<_>>()
    })
}

/// Returns the passes that write a part of a resource, in whichever frame.
fn writers(view: GraphView<'_>, target: &Target) -> BTreeSet<PassId> {
    let passes = view.ids();
    let writers = passes.filter(|(_, pass)| pass.writes_to(target.id, &target.part));
    writers.map(|(id, _)| id).collect()
}

/// Returns the used resources that are last frame's version of another one, with that other
/// resource.
fn previous(lifetimes: &Lifetimes, view: GraphView<'_>) -> BTreeMap<ResourceId, ResourceId> {
    let with_base = |id: &ResourceId| match view.resource(*id).origin {
        Origin::Previous(base) => Some((*id, base)),
        _ => None,
    };
    lifetimes.keys().filter_map(with_base).collect()
}

/// Returns the buffers that count the items or layers that growing resources would have needed.
fn counters(lifetimes: &Lifetimes, view: GraphView<'_>) -> Vec<ResourceId> {
    let growing = growing(lifetimes.keys(), view.resources);
    growing.map(|(_, growth)| growth.counter.id).collect()
}

/// Adds the usages for work besides the passes: reading back, filling with a pattern or with
/// content from the document, and two versions that take turns.
fn further_uses(
    lifetimes: &mut Lifetimes,
    readable: &[(String, Target)],
    previous: &BTreeMap<ResourceId, ResourceId>,
    request: &PlanRequest<'_>,
    view: GraphView<'_>,
) {
    for (_, target) in readable {
        let Some(lifetime) = lifetimes.get_mut(&target.id) else {
            continue;
        };
        lifetime.textures |= wgt::TextureUsages::COPY_SRC | wgt::TextureUsages::TEXTURE_BINDING;
        lifetime.buffers |= wgt::BufferUsages::COPY_SRC;
    }
    for (id, lifetime) in lifetimes.iter_mut() {
        let resource = view.resource(*id);
        let is_constant = resource.origin == Origin::Constant;
        if request.poison.is_some() || is_constant {
            fillable(&resource.kind, lifetime);
        }
        // Its content is copied when it grows.
        if resource.keep && resource.growth.is_some() {
            lifetime.buffers |= wgt::BufferUsages::COPY_SRC | wgt::BufferUsages::COPY_DST;
            lifetime.textures |= wgt::TextureUsages::COPY_SRC | wgt::TextureUsages::COPY_DST;
        }
    }
    // Two versions of one resource are made alike, and a version can be read although no pass asks
    // for the other.
    for (id, base) in previous {
        let (textures, buffers) = (lifetimes[id].textures, lifetimes[id].buffers);
        if let Some(of_base) = lifetimes.get_mut(base) {
            of_base.textures |= textures;
            of_base.buffers |= buffers;
        }
    }
    for counter in counters(lifetimes, view) {
        if let Some(lifetime) = lifetimes.get_mut(&counter) {
            lifetime.buffers |= wgt::BufferUsages::COPY_SRC;
        }
    }
}

/// Adds the usages by which memory is filled: depths and samples are cleared, all else is copied
/// to.
fn fillable(kind: &ResourceKind, lifetime: &mut Lifetime) {
    match kind {
        ResourceKind::Texture(texture)
            if texture.format.is_depth_stencil_format() || texture.samples > 1 =>
        {
            lifetime.textures |= wgt::TextureUsages::RENDER_ATTACHMENT;
        }
        ResourceKind::Texture(_) => lifetime.textures |= wgt::TextureUsages::COPY_DST,
        ResourceKind::Buffer(_) => lifetime.buffers |= wgt::BufferUsages::COPY_DST,
        _ => {}
    }
}

/// Reports resources that no device makes: buffers without a size, which are only cleared or
/// copied, so that no shader declares their items; and multisampled textures that no pass draws to:
/// a shader may ask for the size of one that it does not read.
fn unmade(lifetimes: &Lifetimes, view: GraphView<'_>, reports: &mut Reports) {
    for (id, lifetime) in lifetimes {
        let resource = view.resource(*id);
        let Some(declared) = resource.declared.clone() else {
            continue;
        };
        let drawn = wgt::TextureUsages::RENDER_ATTACHMENT;
        let is_drawn = lifetime.textures.contains(drawn);
        // A history is drawn as the resource itself.
        let is_own = resource.origin == Origin::Own;
        let name = Located::new(resource.name.clone(), declared);
        match &resource.kind {
            ResourceKind::Buffer(Buffer { bytes: 0, .. }) => {
                reports.report(OutputError::UnsizedBuffer(name));
            }
            ResourceKind::Texture(texture) if texture.samples > 1 && is_own && !is_drawn => {
                reports.report(OutputError::Undrawn(name));
            }
            _ => {}
        }
    }
}

/// Reports reads of content from the frame before that no pass writes in any frame.
fn never_written(view: GraphView<'_>, order: &Order, reports: &mut Reports) {
    for pass in view.passes {
        for access in &pass.accesses {
            let id = match view.resource(access.resource) {
                resource if resource.keep => access.resource,
                Resource {
                    origin: Origin::Previous(id),
                    ..
                } => *id,
                _ => continue,
            };
            let part = access.part.clone();
            let is_host = view.resource(id).origin == Origin::Host;
            if is_host || !order.final_writers(&Target { id, part }).is_empty() {
                continue;
            }
            let (name, reader) = (view.resource(id).name.clone(), pass.name.clone());
            reports.report(OrderError::NeverWritten(name, reader, access.span.clone()));
        }
    }
}

/// Reports growing resources whose counter no pass writes, or whose counter is an item of a size
/// that cannot be copied.
fn check_counters(view: GraphView<'_>, order: &Order, reports: &mut Reports) {
    let ids: Vec<ResourceId> = (0..view.resources.len()).map(ResourceId).collect();
    for (id, Growth { counter, .. }) in growing(ids.iter(), view.resources) {
        let Some(declared) = &view.resource(id).declared else {
            continue;
        };
        let Resource { name, kind, .. } = view.resource(counter.id);
        let stride = match kind {
            ResourceKind::Buffer(buffer) => buffer.stride,
            _ => 0,
        };
        let is_item = counter.part.items().is_some();
        if order.final_writers(counter).is_empty() {
            reports.report(OrderError::NeverCounted {
                name: Located::new(view.resource(id).name.clone(), declared.clone()),
                counter: name.clone(),
            });
        } else if is_item && (stride == 0 || stride % 4 != 0) {
            let what = "a buffer of which no shader says that its items are u32";
            let name = Located::new(name.clone(), declared.clone());
            reports.report(SizeError::Counter(name, what));
        }
    }
}

/// Checks that documents write their outputs, and do not write inputs that are no outputs.
fn interfaces(linked: &Linked<'_>, reports: &mut Reports) {
    for border in &linked.flat.interfaces {
        let within = |pass: &usize| {
            linked.instances[*pass].is_some_and(|instance| {
                linked
                    .flat
                    .symbols
                    .scopes
                    .is_within(instance, border.instance)
            })
        };
        let passes: Vec<usize> = (0..linked.passes.len()).filter(within).collect();
        for (name, target) in &border.outputs {
            let is_merged = |merge: &Merge| merge.owned.contains(&target.id.index());
            let has_content = linked.flat.symbols.get(target.id).origin != Origin::Own
                || linked.flat.merged.iter().any(is_merged);
            let mut passes = passes.iter();
            if !has_content
                && !passes.any(|pass| linked.passes[*pass].writes_to(target.id, &target.part))
            {
                reports.report(InterfaceError::UnwrittenOutput(name.text()));
            }
        }
        for (name, target) in &border.read_only {
            let mut passes = passes.iter();
            let writer =
                passes.find(|pass| linked.passes[**pass].writes_to(target.id, &target.part));
            if let Some(writer) = writer {
                let by = linked.passes[*writer].name.span.clone();
                reports.report(InterfaceError::WrittenInput(name.text(), by));
            }
        }
    }
}

fn culled(view: GraphView<'_>, live: &[bool]) -> Vec<CulledPass> {
    let culled = |(pass, _): (&LinkedPass, _)| {
        let written = pass.accesses.iter().filter(|access| access.writes);
        let written = written.map(|access| format!("`{}`", view.resource(access.resource).name));
        let written: BTreeSet<String> = written.collect();
        let written: Vec<String> = written.into_iter().collect();
        CulledPass {
            name: pass.name.value.clone(),
            reason: match written.join(", ") {
                none if none.is_empty() => "it writes nothing".to_owned(),
                names => format!("nothing that an output needs reads what it writes ({names})"),
            },
        }
    };
    let passes = view.passes.iter().zip(live);
    passes.filter(|(_, live)| !**live).map(culled).collect()
}
