//! [`Plan`]: a graph on a viewport with values for its params, checked against an adapter's limits.
//! Pure data.

use super::{
    backend::not_proven,
    items::{self, PartSummary},
    make::{CulledPass, Planned, plan_all},
    memory::{Memory, MemoryEntry},
    summary::{OutputSummary, PassSummary},
    uniforms,
};
use crate::{
    compose::loaded::Loaded,
    diagnostics::{diagnostic::Diagnostic, list::Diagnostics, reports::Reports},
    flow::{
        order::{Dependences, dependences},
        schedule::Schedule,
        view::GraphView,
    },
    link::{
        params::words,
        pass::{LinkedPass, PassId},
    },
    param::{ParamType, ParamValue},
    provider::Import,
    request::{PartialBackend, PlanRequest},
    resource::{Growth, Origin, Resource, ResourceId, ResourceKind, Target},
    shader::items::Item,
};
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

/// A graph that is ready to be allocated: live passes in order, every resource with its size and
/// uses.
#[derive(Debug)]
pub struct Plan(pub(super) Planned);

impl Plan {
    /// The plan, or everything that is wrong.
    pub(crate) fn new(graph: &Arc<Loaded>, request: &PlanRequest<'_>) -> Result<Self, Diagnostics> {
        let outcome = plan_all(graph, request);
        let plan = outcome.plan.map(Self);
        plan.ok_or_else(|| graph.diagnostics(outcome.found))
    }

    /// Every resource that a pass may name, by number. Only those with a lifetime are made.
    pub fn resources(&self) -> &[Resource] {
        &self.0.resources
    }

    /// The resource of a number.
    pub fn resource(&self, id: ResourceId) -> &Resource {
        &self.0.resources[id.0]
    }

    /// The resources that live passes use; only these are made.
    pub fn used(&self) -> impl Iterator<Item = &Resource> {
        let used = self.0.schedule.lifetimes.keys();
        used.map(|id| self.resource(*id))
    }

    /// Every pass in the order of the file, those that do not run included.
    pub fn all_passes(&self) -> &[LinkedPass] {
        &self.0.passes
    }

    /// The pass of a number.
    pub fn pass(&self, id: PassId) -> &LinkedPass {
        &self.0.passes[id.0]
    }

    /// The live passes in the order in which they run.
    pub fn live(&self) -> impl Iterator<Item = &LinkedPass> + Clone {
        self.0.schedule.passes.iter().map(|id| self.pass(*id))
    }

    /// Which passes run, in which order, and what follows from that.
    pub fn schedule(&self) -> &Schedule {
        &self.0.schedule
    }

    /// Outputs and captures that can be read back, with what they are.
    pub fn readable(&self) -> &[(String, Target)] {
        &self.0.readable
    }

    /// Finds the passes that passes depend on, and the resources that cause it, as if only those
    /// ran of which `runs` is true.
    pub fn dependences(&self, runs: impl Fn(PassId) -> bool) -> Dependences {
        let view = GraphView {
            passes: &self.0.passes,
            resources: &self.0.resources,
        };
        dependences(view, runs)
    }

    /// The `values` of the documents that were computed for this plan, by full name, each with its
    /// result as a document would write it. A value that no expression uses is not among them.
    pub fn named_values(&self) -> &[(String, String)] {
        &self.0.named_values
    }

    /// Returns the imports that the host announced, by name.
    pub fn imports(&self) -> &BTreeMap<String, Import> {
        &self.0.request.imports
    }

    /// Items of growing buffers, and layers of growing textures, that were known to be needed when
    /// the plan was made, by full name.
    pub fn grown(&self) -> &BTreeMap<String, u64> {
        &self.0.request.grown
    }

    /// The byte that memory is filled with between uses, if it is.
    pub fn poison(&self) -> Option<u8> {
        self.0.request.poison
    }

    /// True if the host imports or provides something under this name.
    pub fn offers(&self, name: &str) -> bool {
        let request = &self.0.request;
        request.imports.contains_key(name) || request.provider.0.contains_key(name)
    }

    /// The graph's own textures and buffers with what they take, in the order of the document.
    pub fn memory(&self) -> Vec<MemoryEntry> {
        self.own_memory().entries()
    }

    /// The live buffers and textures that may grow, each with where its frame counts the items or
    /// layers that it would have needed, and the most that it may have: by the document, and by the
    /// device's limits.
    pub fn growing(&self) -> Vec<(ResourceId, Growth)> {
        self.own_memory().growing(&self.0.request.limits)
    }

    /// Bytes of the graph's own textures and buffers. One that is also read as it was in the frame
    /// before takes its size twice.
    pub fn memory_bytes(&self) -> u64 {
        self.own_memory().bytes()
    }

    /// Bytes that would be needed besides if no two resources shared memory.
    pub fn saved_bytes(&self) -> u64 {
        self.own_memory().saved_bytes()
    }

    /// Returns a table of the largest uses of memory: a line per allocation, the largest first,
    /// then the rest in one, then the sum. Materials that take turns in one allocation stand
    /// together.
    pub fn memory_table(&self) -> String {
        self.own_memory().table()
    }

    /// How many textures or buffers a resource takes: two if it is also read as it was in the frame
    /// before.
    pub fn versions(&self, id: ResourceId) -> usize {
        self.own_memory().versions(id)
    }

    /// Finds out if the plan may run on a backend that gives less than WebGPU, whichever it was
    /// made for.
    ///
    /// # Errors
    /// If the graph's document does not list the backend in `proven_on`.
    pub fn check_backend(&self, backend: &PartialBackend) -> Result<(), Diagnostics> {
        let Some(error) = not_proven(&self.0.graph, backend) else {
            return Ok(());
        };
        let mut reports = Reports::default();
        reports.report(error);
        Err(self.0.graph.diagnostics(reports.into_list()))
    }

    /// Params that the request sets and that change nothing in this plan: with their defaults a
    /// frame would run the same passes, and shaders read the same values. For example the `fit` of
    /// a shadow map changes nothing under a light whose map has one fit alone.
    pub fn idle_params(&self) -> Vec<&str> {
        let by_default = |name: &&String| {
            let others = self.with(|request| {
                request.params.remove(*name);
            });
            others.is_ok_and(|others| {
                self.0.values.get(*name) != others.0.values.get(*name)
                    && self.does_the_same_as(&others)
            })
        };
        let asked = self.0.request.params.keys();
        asked.filter(by_default).map(String::as_str).collect()
    }

    /// True if a frame would do the same with another value of a param. False for a value that it
    /// cannot have.
    pub fn is_same_with(&self, name: &str, value: ParamValue) -> bool {
        self.with_param(name, value)
            .is_ok_and(|other| self.does_the_same_as(&other))
    }

    fn does_the_same_as(&self, other: &Self) -> bool {
        self.0.readable == other.0.readable
            && self.live().count() == other.live().count()
            && self.live().zip(other.live()).all(is_same_pass)
            && self
                .used()
                .map(|it| &it.kind)
                .eq(other.used().map(|it| &it.kind))
    }

    /// The provided resources that are bound by the passes that write an output or capture: depths
    /// that are written with a `camera` bound are that camera's.
    pub fn provided_behind(&self, output: &str) -> BTreeSet<&str> {
        let target = self.readable_target(output);
        let behind = |target| items::provided_behind(self.live(), target, &self.0.resources);
        target.map_or_else(BTreeSet::new, behind)
    }

    /// The layout of an item of an output or capture that is a buffer; `None` of a texture, or if
    /// no live pass binds it as an array of plain items or as a single one.
    pub fn item(&self, output: &str) -> Option<Item> {
        items::item_of(self.live(), self.readable_target(output)?)
    }

    /// Which mips and layers of a texture, or items of a buffer, an output or capture holds. A
    /// capture after a pass holds what has been written by then, which may be less than was named.
    pub fn part(&self, output: &str) -> Option<PartSummary> {
        let target = self.readable_target(output)?;
        Some(items::part(self.live(), target, &self.0.resources))
    }

    /// The resource or part that an output or capture is.
    pub fn readable_target(&self, output: &str) -> Option<&Target> {
        let (_, target) = self.0.readable.iter().find(|(name, _)| name == output)?;
        Some(target)
    }

    /// True if a param may have this value without planning anew: it has the type and lies in the
    /// range, and nothing but members of `var<uniform> params` follows from it.
    pub fn is_in_uniforms(&self, name: &str, value: &ParamValue) -> bool {
        self.0.graph.param(name).is_ok_and(|param| {
            // A document that is included may count its words in another order.
            let is_counted = matches!(param.ty, ParamType::Choice(_));
            !is_counted && !self.0.depends_on.contains(name) && param.check(value).is_ok()
        })
    }

    /// Gives a param that [`is_in_uniforms`](Self::is_in_uniforms) another value. Returns the
    /// positions in the schedule of the passes that read other bytes now. Other params are left as
    /// they are.
    pub fn set_in_uniforms(&mut self, name: &str, value: ParamValue) -> Vec<usize> {
        let Ok(param) = self.0.graph.param(name) else {
            return Vec::new();
        };
        if !self.is_in_uniforms(name, &value) {
            return Vec::new();
        }
        let (_, words) = words(param, &value);
        let changed = uniforms::write(&mut self.0.passes, name, &words);
        self.0.values.insert(name.to_owned(), value.clone());
        self.0.request.params.insert(name.to_owned(), value);
        let live = self.0.schedule.passes.iter().enumerate();
        live.filter(|(_, id)| changed[id.0])
            .map(|(position, _)| position)
            .collect()
    }

    /// The live passes in the order in which they run.
    pub fn passes(&self) -> Vec<PassSummary> {
        let summary = |pass: &LinkedPass| PassSummary {
            name: pass.name.value.clone(),
            kind: pass.kind.to_owned(),
        };
        self.live().map(summary).collect()
    }

    /// The passes that do not run.
    pub fn culled(&self) -> &[CulledPass] {
        &self.0.culled
    }

    /// The provided resources that live passes bind; only these are built.
    pub fn provided(&self) -> Vec<&str> {
        let is_provided = |resource: &&Resource| {
            matches!(
                resource.kind,
                ResourceKind::Provided(_) | ResourceKind::AccelerationStructure
            )
        };
        let provided = self.used().filter(is_provided);
        provided.map(|resource| resource.name.as_str()).collect()
    }

    /// True if a frame may depend on those before it though the host changes nothing: live passes
    /// read what the graph left in the frame before, or the frame's number.
    pub fn remembers(&self) -> bool {
        self.used().any(|resource| match resource.kind {
            _ if resource.keep => true,
            ResourceKind::Frame => true,
            ResourceKind::Provided(_) => false,
            _ => matches!(resource.origin, Origin::Previous(_)),
        })
    }

    /// Returns the outputs that can be read back after a frame.
    pub fn outputs(&self) -> Vec<OutputSummary> {
        let summary = |(name, target): &(String, Target)| {
            OutputSummary::new(name, target, &self.resource(target.id).kind)
        };
        self.0.readable.iter().map(summary).collect()
    }

    /// Width and height of the viewport in pixels.
    pub fn viewport(&self) -> [u32; 2] {
        self.0.request.viewport
    }

    /// The value of a param in this plan.
    pub fn param(&self, name: &str) -> Option<&ParamValue> {
        self.0.values.get(name)
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

    /// Plans anew with several parts of the request changed at once, such as the viewport and the
    /// imports that follow it. The provider's descriptions stay, unless another provider is put in.
    ///
    /// # Errors
    /// Everything that is wrong then.
    pub fn with<'a>(
        &'a self,
        change: impl FnOnce(&mut PlanRequest<'a>),
    ) -> Result<Self, Diagnostics> {
        let mut request: PlanRequest<'a> = self.0.request.to(&self.0.request.provider);
        change(&mut request);
        Self::new(&self.0.graph, &request)
    }

    /// Returns the warnings.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.0.warnings
    }

    fn own_memory(&self) -> Memory<'_> {
        self.0.memory()
    }
}

fn is_same_pass((one, other): (&LinkedPass, &LinkedPass)) -> bool {
    one.name.value == other.name.value
        && (one.enabled, &one.run) == (other.enabled, &other.run)
        && one.steps == other.steps
        && one.params().eq(other.params())
}
