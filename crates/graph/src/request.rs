//! Requests for plans.

use crate::{
    instantiate::params::Surroundings,
    param::ParamValue,
    provider::{Describe, Import},
};
use std::collections::BTreeMap;

/// A backend that gives less than WebGPU. Checks and proofs of a graph elsewhere need not hold
/// there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PartialBackend {
    /// The word by which documents list it in `proven_on`.
    pub name: String,
    /// Abilities that it lacks, for a message: "no …".
    pub lacks: String,
}

/// Request for a plan.
pub type PlanRequest<'a> = Request<&'a dyn Describe>;

/// Viewport, params, limits and imports to plan a graph with. `P` describes the resources that the
/// scene provides: a borrowed `&dyn Describe` in a [`PlanRequest`], which callers use, and a stored
/// copy inside of a plan, to plan again.
#[derive(Clone, Debug)]
pub struct Request<P> {
    /// Width and height in pixels.
    pub viewport: [u32; 2],
    /// Values of params; where missing, the document's default.
    pub params: BTreeMap<String, ParamValue>,
    /// The outputs that are wanted; `None` = all that the document declares, but for those on
    /// request that no capture names.
    pub outputs: Option<Vec<String>>,
    /// Materials that are to be read back beside the outputs.
    pub captures: Vec<Capture>,
    /// Limits that the device will have.
    pub limits: wgt::Limits,
    /// Features that the device will have.
    pub features: wgt::Features,
    /// The backend that the device will have, if it gives less than WebGPU: graphs that do not list
    /// it in `proven_on` are refused. An executor refuses them too, so what is left out here is
    /// only told later.
    pub partial_backend: Option<PartialBackend>,
    /// Bytes that the graph's own textures and buffers may take together; one that takes more is
    /// refused with a table of what takes the most, before anything is allocated. `None`: whatever
    /// the device gives. (wgpu does not tell how much memory there is.)
    pub memory_limit: Option<u64>,
    /// Imports of the host for the inputs of the root document, by name.
    pub imports: BTreeMap<String, Import>,
    /// Items that buffers with `grow`, and layers that textures with it, are known to need, by full
    /// name: they are made as large, up to their `max`. A graph that was loaded again goes on with
    /// what [`Plan::grown`] says.
    ///
    /// [`Plan::grown`]: crate::Plan::grown
    pub grown: BTreeMap<String, u64>,
    /// Fills memory between uses with a pattern made of this byte: a graph whose outputs change
    /// with it reads what it has not written. Costs time; for finding mistakes.
    pub poison: Option<u8>,
    /// True if the device that will run the graph is not known: exceeding `limits` and `features`
    /// is then a warning.
    pub any_adapter: bool,
    /// Describes the provided resources.
    pub provider: P,
}

impl<'a> PlanRequest<'a> {
    /// A request with wgpu's default limits, no features, default params and all outputs.
    pub fn new(viewport: [u32; 2], provider: &'a dyn Describe) -> Self {
        Self {
            viewport,
            params: BTreeMap::new(),
            outputs: None,
            captures: Vec::new(),
            limits: wgt::Limits::default(),
            features: wgt::Features::empty(),
            partial_backend: None,
            memory_limit: None,
            imports: BTreeMap::new(),
            grown: BTreeMap::new(),
            poison: None,
            any_adapter: false,
            provider,
        }
    }

    pub(crate) fn surroundings(&self) -> Surroundings {
        Surroundings {
            viewport: self.viewport,
            features: self.features,
        }
    }
}

impl<P> Request<P> {
    /// The same request to another provider. A plan keeps its request with what was described, so
    /// that it can be sent to another thread and made again with something changed.
    pub(crate) fn to<Q>(&self, provider: Q) -> Request<Q> {
        Request {
            viewport: self.viewport,
            params: self.params.clone(),
            outputs: self.outputs.clone(),
            captures: self.captures.clone(),
            limits: self.limits.clone(),
            features: self.features,
            partial_backend: self.partial_backend.clone(),
            memory_limit: self.memory_limit,
            imports: self.imports.clone(),
            grown: self.grown.clone(),
            poison: self.poison,
            any_adapter: self.any_adapter,
            provider,
        }
    }
}

/// A material to be read back.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Capture {
    /// Material, view or provided resource.
    pub material: String,
    /// The pass after which its content is wanted; `None` = at the end of the frame.
    pub after: Option<String>,
}

impl Capture {
    /// The name under which it is read back: `material` or `material@pass`.
    pub fn name(&self) -> String {
        match &self.after {
            Some(pass) => format!("{}@{pass}", self.material),
            None => self.material.clone(),
        }
    }
}
