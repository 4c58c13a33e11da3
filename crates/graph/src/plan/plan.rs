//! [`Plan`]: a graph for a viewport, with values for its params, checked against an adapter's
//! limits. It holds no GPU objects.

use super::backend::not_proven;
use super::items::{self, PartSummary};
use super::make::{CulledPass, Planned, plan_all};
use super::memory::MemoryEntry;
use super::summary::{OutputSummary, PassSummary};
use super::uniforms;
use crate::{
    compose::Loaded,
    diagnostics::{Diagnostic, Diagnostics, Reports},
    flow::{Dependences, GraphView, Schedule, discard::discarded, order::dependences},
    language::least_common_multiple,
    link::{LinkedPass, PassId, params::words},
    param::{ParamType, ParamValue},
    provider::{Describe, Import, Provided},
    request::{PartialBackend, PlanRequest},
    resource::{Growth, Origin, Resource, ResourceId, ResourceKind, Target},
    shader::Item,
};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// A graph that is planned for one viewport, one set of param values and one device: its
/// [live](crate#terms) passes in the order in which they run, and every resource with its size and
/// usages. It holds no GPU objects. A clone serves another executor; it shares the graph and its
/// shaders.
#[derive(Clone, Debug)]
pub struct Plan(pub(super) Planned);

impl Plan {
    /// Plans a graph; the error lists all mistakes.
    pub(crate) fn new(graph: &Arc<Loaded>, request: &PlanRequest<'_>) -> Result<Self, Diagnostics> {
        let outcome = plan_all(graph, request);
        let plan = outcome.plan.map(Self);
        plan.ok_or_else(|| graph.diagnostics(outcome.found))
    }

    /// Returns every resource that a pass may name; [`ResourceId::index`] is the index in this
    /// list. Resources that no [live](Self::live) pass uses are in the list, but are not created on
    /// the device.
    pub fn resources(&self) -> &[Resource] {
        &self.0.resources
    }

    /// Returns the resource with this id, which must be an id of this plan.
    ///
    /// # Panics
    /// If the plan has no resource of this index.
    pub fn resource(&self, id: ResourceId) -> &Resource {
        &self.0.resources[id.0]
    }

    /// Iterates over the resources that [live](Self::live) passes use, in the order of
    /// [`resources`](Self::resources). Only these are created on the device.
    pub fn used(&self) -> impl Iterator<Item = &Resource> {
        let used = self.0.schedule.lifetimes.keys();
        used.map(|id| self.resource(*id))
    }

    /// Returns every pass, each behind the passes that it depends on, with the passes that planning
    /// adds for captures, and those that do not run included. [`PassId::index`] is the index in
    /// this list.
    pub fn all_passes(&self) -> &[LinkedPass] {
        &self.0.passes
    }

    /// Returns the pass with this id, which must be an id of this plan.
    ///
    /// # Panics
    /// If the plan has no pass of this index.
    pub fn pass(&self, id: PassId) -> &LinkedPass {
        &self.0.passes[id.0]
    }

    /// Iterates over the [live](crate#terms) passes in the order in which they run.
    pub fn live(&self) -> impl Iterator<Item = &LinkedPass> + Clone {
        self.0.schedule.passes.iter().map(|id| self.pass(*id))
    }

    /// Returns the order of the [live](Self::live) passes, with the lifetimes of resources, run
    /// conditions and allocations that follow from it.
    pub fn schedule(&self) -> &Schedule {
        &self.0.schedule
    }

    /// Returns the name of every output and capture that can be read back after a frame, with the
    /// texture or buffer, or part of it, that holds its content: first the outputs in the order of
    /// the document, then the [captures](crate#terms) in the order of the request.
    pub fn readable(&self) -> &[(String, Target)] {
        &self.0.readable
    }

    /// Finds the dependences between the passes for which `runs` returns true, as if the plan had
    /// no other passes: the pairs of passes whose order matters.
    pub fn dependences(&self, runs: impl Fn(PassId) -> bool) -> Dependences {
        dependences(self.view(), runs)
    }

    /// Returns the attachments of the pass at position `at` of the [`Schedule`] whose content a
    /// device need not store: nothing uses it after the pass.
    ///
    /// # Panics
    /// If the schedule has no such position.
    pub fn discarded(&self, at: usize) -> Vec<Target> {
        discarded(self.view(), &self.0.schedule, at)
    }

    fn view(&self) -> GraphView<'_> {
        GraphView {
            passes: &self.0.passes,
            resources: &self.0.resources,
        }
    }

    /// Returns the named expressions in the section `values` of the documents, in the order of the
    /// documents: pairs of full name (with the names of includes in front) and result, the result
    /// as text in the language of documents. A value that nothing uses is not listed.
    pub fn named_values(&self) -> &[(String, String)] {
        &self.0.named_values
    }

    /// Returns the [`imports`](crate::Request::imports) of the request: descriptions of the
    /// resources that the host hands over, by name of the document's input.
    pub fn imports(&self) -> &BTreeMap<String, Import> {
        &self.0.request.imports
    }

    /// Returns the number of [items](crate#terms) that growing buffers need, and of layers that
    /// growing textures need, by [full name](crate#terms) of the material ([`Resource::name`]): the
    /// [`grown`](crate::Request::grown) of the request, and in the plan of an executor all that has
    /// grown since.
    pub fn grown(&self) -> &BTreeMap<String, u64> {
        &self.0.request.grown
    }

    /// Returns the [`poison`](crate::Request::poison) of the request: the byte that the memory of
    /// the graph's own resources is filled with before its first use in a frame; `None` if memory
    /// is not filled.
    pub fn poison(&self) -> Option<u8> {
        self.0.request.poison
    }

    /// Returns true if the request imports a resource under this name, or its provider describes
    /// one, such as `light`, even if no pass uses it.
    pub fn offers(&self, name: &str) -> bool {
        let request = &self.0.request;
        request.imports.contains_key(name) || request.provider.0.contains_key(name)
    }

    /// Returns an entry for each texture and buffer of the graph that a [live](Self::live) pass
    /// uses, with its size in memory, in the order of [`resources`](Self::resources). Imported and
    /// provided resources, which the host makes, are left out.
    pub fn memory(&self) -> Vec<MemoryEntry> {
        self.0.memory().entries()
    }

    /// Returns the buffers and textures that [live](Self::live) passes use and that may grow
    /// (`grow`), in the order of [`resources`](Self::resources), each with its counter and its
    /// greatest number of [items](crate#terms) or layers. The device's limits may lower the number
    /// that the document gives.
    pub fn growing(&self) -> Vec<(ResourceId, Growth)> {
        self.0.memory().growing(&self.0.request.limits)
    }

    /// Returns the size in bytes of all textures and buffers in [`memory`](Self::memory) together;
    /// memory that they share counts once. A resource that a pass also reads as it was in the frame
    /// before (`.previous`) counts twice.
    pub fn memory_bytes(&self) -> u64 {
        self.0.memory().bytes()
    }

    /// Returns the number of bytes that sharing memory between resources saves, compared with an
    /// allocation for each resource.
    pub fn saved_bytes(&self) -> u64 {
        self.0.memory().saved_bytes()
    }

    /// Returns a table as text, for people to read, of the memory that the graph takes. It has one
    /// line for each of the 12 largest allocations, with the names of its materials, size, format
    /// and bytes; then a line for all smaller allocations together; then the sum.
    pub fn memory_table(&self) -> String {
        self.0.memory().table()
    }

    /// Returns the number of textures or buffers that are made on the device for a resource of the
    /// graph: 2 if a pass also reads it as it was in the frame before (`.previous`), otherwise 1.
    /// Each frame writes one of the two and reads the other.
    pub fn versions(&self, id: ResourceId) -> usize {
        self.0.memory().versions(id)
    }

    /// Checks that the plan may run on a backend that lacks part of WebGPU, even if its request
    /// named no such backend.
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

    /// Returns the names of the params that the request sets without effect, in alphabetical order:
    /// the value differs from the param's default, but with the default the plan would have the
    /// same passes, and shaders would read the same values. Plans the graph again for each param of
    /// the request.
    pub fn idle_params(&self) -> Vec<&str> {
        let by_default = |name: &&String| {
            let defaulted = self.with(|request| {
                request.params.remove(*name);
            });
            defaulted.is_ok_and(|plan| {
                self.0.values.get(*name) != plan.0.values.get(*name) && self.does_the_same_as(&plan)
            })
        };
        let asked = self.0.request.params.keys();
        asked.filter(by_default).map(String::as_str).collect()
    }

    /// Returns true if frames would do the same work with `value` for the param `name` as with this
    /// plan: the same passes, and the same values for shaders. Plans the graph again; returns false
    /// if that fails, for example because the param cannot have this value.
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

    /// Returns the names of the buffers of the host's [provider](crate#terms) that are bound by the
    /// passes that write the output or [capture](crate#terms) called `output`. For example, if
    /// these passes bind a `camera`, depths in the output are that camera's. Empty for an unknown
    /// name.
    pub fn provided_behind(&self, output: &str) -> BTreeSet<&str> {
        let target = self.readable_target(output);
        let behind = |target| items::provided_behind(self.live(), target, &self.0.resources);
        target.map_or_else(BTreeSet::new, behind)
    }

    /// Returns the layout of one item of the buffer that holds the output or [capture](crate#terms)
    /// called `output`, as a shader declares it. Returns `None` for a texture or an unknown name,
    /// or if no [live](Self::live) pass binds the whole buffer with items of 32-bit numbers, at
    /// most 64 in an item.
    pub fn item(&self, output: &str) -> Option<Item> {
        items::item_of(self.live(), self.readable_target(output)?)
    }

    /// Returns the mips and layers of a texture, or the [items](crate#terms) of a buffer, that the
    /// output or [capture](crate#terms) called `output` holds; `None` for an unknown name. A
    /// capture after a pass holds only the part that has been written by then.
    pub fn part(&self, output: &str) -> Option<PartSummary> {
        let target = self.readable_target(output)?;
        Some(items::part(self.live(), target, &self.0.resources))
    }

    /// Returns the texture or buffer, or part of it, that holds the output or
    /// [capture](crate#terms) called `output`; `None` for an unknown name.
    pub fn readable_target(&self, output: &str) -> Option<&Target> {
        let (_, target) = self.0.readable.iter().find(|(name, _)| name == output)?;
        Some(target)
    }

    /// Returns true if [`set_in_uniforms`](Self::set_in_uniforms) can set the param `name` to this
    /// value without planning again: the value has the right type and range, and the param affects
    /// nothing but the bytes of `params` uniforms. Always false for a `Choice` param.
    pub fn is_in_uniforms(&self, name: &str, value: &ParamValue) -> bool {
        self.0.graph.param(name).is_ok_and(|param| {
            // A document that is included may count its words in another order.
            let is_counted = matches!(param.ty, ParamType::Choice(_));
            !is_counted && !self.0.depends_on.contains(name) && param.check(value).is_ok()
        })
    }

    /// Sets the param `name` to `value` without planning again, if
    /// [`is_in_uniforms`](Self::is_in_uniforms) allows it; otherwise changes nothing and returns an
    /// empty list. Returns the indices in [`Schedule::passes`] of the passes whose `params`
    /// uniforms have other bytes now and must be uploaded to the device.
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
        let live = live.filter(|(_, id)| changed[id.0]);
        live.map(|(position, _)| position).collect()
    }

    /// Returns the name and kind of each [live](Self::live) pass, in the order in which they run.
    pub fn passes(&self) -> Vec<PassSummary> {
        let summary = |pass: &LinkedPass| PassSummary {
            name: pass.name.value.clone(),
            kind: pass.kind.to_owned(),
        };
        self.live().map(summary).collect()
    }

    /// Returns the passes that do not run because they are not [live](crate#terms), each with the
    /// reason, in the order of [`all_passes`](Self::all_passes). Entries whose `if` is false are no
    /// passes of the plan and not listed.
    pub fn culled(&self) -> &[CulledPass] {
        &self.0.culled
    }

    /// Returns the names of the provider's resources that [live](Self::live) passes bind, in the
    /// order of [`resources`](Self::resources). The host needs to make only these.
    pub fn provided(&self) -> Vec<&str> {
        let provided = self.used().filter(|resource| resource.is_provided());
        provided.map(|resource| resource.name.as_str()).collect()
    }

    /// Returns the provider's descriptions for which this plan was made, as they were then.
    pub fn descriptions(&self) -> &dyn Describe {
        &self.0.request.provider
    }

    /// Returns the provider's resources that no [live](Self::live) pass uses, but whose number of
    /// [items](crate#terms), kind or presence planning has asked for (as for the condition
    /// `"scene.masks.count > 0"`), by name, each with the description for which this plan was made;
    /// `None` if the provider had no resource of the name. If the provider describes one otherwise
    /// later, the graph must be planned anew.
    pub fn relies_on(&self) -> &BTreeMap<String, Option<Provided>> {
        &self.0.relies_on
    }

    /// Returns true if the outputs may differ from frame to frame although the host changes
    /// nothing: a [live](Self::live) pass uses a resource with `keep`, reads a material of the
    /// graph as it was in the frame before (`.previous`), binds the uniform `frame`, which holds
    /// the frame's index and time, or runs in some frames by their number.
    pub fn remembers(&self) -> bool {
        let remembered = self.used().any(|resource| match resource.kind {
            _ if resource.keep => true,
            ResourceKind::Frame => true,
            ResourceKind::Provided(_) => false,
            _ => matches!(resource.origin, Origin::Previous(_)),
        });
        remembered || self.period() > 1
    }

    /// Returns the number of frames, 1 to 64, after which the same [live](Self::live) passes run
    /// again by their conditions on the frame's number; 1 without such conditions.
    pub fn period(&self) -> usize {
        let turns = self.live().map(|pass| pass.turns.len() as u64);
        turns.fold(1, least_common_multiple) as usize
    }

    /// Returns the name, format and size of the outputs and captures that can be read back after a
    /// frame, in the order of [`readable`](Self::readable).
    pub fn outputs(&self) -> Vec<OutputSummary> {
        let summary = |(name, target): &(String, Target)| {
            OutputSummary::new(name, target, &self.resource(target.id).kind)
        };
        self.0.readable.iter().map(summary).collect()
    }

    /// Returns the width and height in pixels of the viewport that the plan is made for.
    pub fn viewport(&self) -> [u32; 2] {
        self.0.request.viewport
    }

    /// Returns the value of the param `name` in this plan, whether set or its default; `None` for
    /// an unknown name.
    pub fn param(&self, name: &str) -> Option<&ParamValue> {
        self.0.values.get(name)
    }

    /// Returns a plan of the same graph for another viewport, width and height in pixels. This plan
    /// stays as it is. Imports keep the sizes that the request describes: if they follow the
    /// viewport, change both by [`with`](Self::with).
    ///
    /// # Errors
    /// All mistakes of the graph with this viewport.
    pub fn with_viewport(&self, viewport: [u32; 2]) -> Result<Self, Diagnostics> {
        self.with(|request| request.viewport = viewport)
    }

    /// Returns a plan of the same graph with `value` for the param `name`, set or not before. This
    /// plan stays as it is.
    ///
    /// # Errors
    /// All mistakes of the graph with this value, such as an unknown name or a value out of range.
    pub fn with_param(&self, name: &str, value: ParamValue) -> Result<Self, Diagnostics> {
        self.with(|request| {
            request.params.insert(name.to_owned(), value);
        })
    }

    /// Returns a plan of the same graph for a changed request. `change` gets a copy of this plan's
    /// request and may change several parts at once, such as the viewport and the imports that
    /// depend on it. The descriptions that the provider gave for this plan stay, unless `change`
    /// sets another provider.
    ///
    /// # Errors
    /// All mistakes of the graph with the changed request.
    pub fn with<'a>(
        &'a self,
        change: impl FnOnce(&mut PlanRequest<'a>),
    ) -> Result<Self, Diagnostics> {
        let mut request: PlanRequest<'a> = self.0.request.to(&self.0.request.provider);
        change(&mut request);
        Self::new(&self.0.graph, &request)
    }

    /// Returns the warnings that planning gave, in the order in which they were found; empty
    /// without warnings. [`Graph::warnings`](crate::Graph::warnings) has those of loading.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.0.warnings
    }
}

fn is_same_pass((one, other): (&LinkedPass, &LinkedPass)) -> bool {
    one.name.value == other.name.value
        && (&one.turns, &one.run) == (&other.turns, &other.run)
        && one.steps == other.steps
        && one.params().eq(other.params())
}
