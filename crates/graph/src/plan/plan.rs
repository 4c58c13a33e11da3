//! [`Plan`]: a graph on a viewport with values for its params, checked against an adapter's limits.
//! Pure data.

use crate::{
    diagnostics::diagnostic::Diagnostic,
    document::params::ParamValue,
    flow::{
        order::{Dependences, dependences},
        schedule::Schedule,
        view::GraphView,
    },
    graph::Graph,
    link::pass::{LinkedPass, PassId},
    provider::Import,
    request::Request,
    resource::{Resource, ResourceId, Target},
};
use std::collections::{BTreeMap, BTreeSet};

/// A graph that is ready to be allocated: live passes in order, every resource with its size and
/// uses.
#[derive(Debug)]
pub struct Plan {
    pub(super) graph: Graph,
    pub(super) request: Request,
    pub(super) values: BTreeMap<String, ParamValue>,
    pub(super) named_values: Vec<(String, String)>,
    pub(super) resources: Vec<Resource>,
    pub(super) passes: Vec<LinkedPass>,
    pub(super) schedule: Schedule,
    pub(super) readable: Vec<(String, Target)>,
    pub(super) culled: Vec<CulledPass>,
    pub(super) warnings: Vec<Diagnostic>,
    /// The params of the root document that it depends on; of others, passes' uniforms alone hold
    /// the values.
    pub(super) depends_on: BTreeSet<String>,
}

/// A pass that does not run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CulledPass {
    /// Name.
    pub name: String,
    /// Why.
    pub reason: String,
}

impl Plan {
    /// Every resource that a pass may name, by number. Only those with a lifetime are made.
    pub fn resources(&self) -> &[Resource] {
        &self.resources
    }

    /// The resource of a number.
    pub fn resource(&self, id: ResourceId) -> &Resource {
        &self.resources[id.0]
    }

    /// Every pass in the order of the file, those that do not run included.
    pub fn all_passes(&self) -> &[LinkedPass] {
        &self.passes
    }

    /// The pass of a number.
    pub fn pass(&self, id: PassId) -> &LinkedPass {
        &self.passes[id.0]
    }

    /// The live passes in the order in which they run.
    pub fn live(&self) -> impl Iterator<Item = &LinkedPass> + Clone {
        self.schedule.passes.iter().map(|id| self.pass(*id))
    }

    /// Which passes run, in which order, and what follows from that.
    pub fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    /// Outputs and captures that can be read back, with what they are.
    pub fn readable(&self) -> &[(String, Target)] {
        &self.readable
    }

    /// Finds the passes that passes depend on, and the resources that cause it, as if only those
    /// ran of which `runs` is true.
    pub fn dependences(&self, runs: impl Fn(PassId) -> bool) -> Dependences {
        let view = GraphView {
            passes: &self.passes,
            resources: &self.resources,
        };
        dependences(view, runs)
    }

    /// The `values` of the documents that something asked for, by full name, and what each came to,
    /// as a document would write it.
    pub fn named_values(&self) -> &[(String, String)] {
        &self.named_values
    }

    /// Returns the imports that the host announced, by name.
    pub fn imports(&self) -> &BTreeMap<String, Import> {
        &self.request.imports
    }

    /// Items of growing buffers, and layers of growing textures, that were known to be needed when
    /// the plan was made, by full name.
    pub fn grown(&self) -> &BTreeMap<String, u64> {
        &self.request.grown
    }

    /// The byte that memory is filled with between uses, if it is.
    pub fn poison(&self) -> Option<u8> {
        self.request.poison
    }

    /// True if the host imports or provides something under this name.
    pub fn offers(&self, name: &str) -> bool {
        self.request.offers(name)
    }
}
