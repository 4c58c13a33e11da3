//! Requests for plans.

use crate::adapter_facts::AdapterFacts;
use crate::instantiate::params::Surroundings;
use crate::param::ParamValue;
use crate::provider::{Describe, Import};
use std::collections::BTreeMap;

/// A graphics backend that lacks part of WebGPU, such as OpenGL. A graph that passed its checks on
/// another backend may fail on it. `device::partial` of `skiagraph-gpu` returns the description of
/// a wgpu backend.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PartialBackend {
    /// Name of the backend, such as `gl`, as documents list it in `proven_on`.
    pub name: String,
    /// Abilities that the backend lacks, as text for error messages, such as "no 32-bit float
    /// targets".
    pub lacks: String,
}

/// A [`Request`] with a borrowed provider, which [`Graph::plan`](crate::Graph::plan) takes. Create
/// one with [`PlanRequest::new`](Request::new) and change its fields.
pub type PlanRequest<'a> = Request<&'a dyn Describe>;

/// Settings for planning a graph: viewport, params, outputs, the device's limits and features, and
/// imports. `P` is the type of [`provider`](Request::provider): `&dyn Describe` in a
/// [`PlanRequest`], which callers use. A plan keeps a copy of its request with an owned provider.
///
/// ```
/// use skiagraph_graph::{NoProvider, ParamValue, PlanRequest};
///
/// let mut request = PlanRequest::new([64, 32], &NoProvider)
///     .with_param("map_size", ParamValue::U32(512));
/// request.memory_limit = Some(1 << 30);
/// assert_eq!(request.params["map_size"], ParamValue::U32(512));
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Request<P> {
    /// Width and height of the viewport in pixels, each at least 1. A texture without a `size` has
    /// this size.
    pub viewport: [u32; 2],
    /// Values of params by name. A param that is not listed has its default
    /// ([`Param::default`](crate::Param::default)).
    pub params: BTreeMap<String, ParamValue>,
    /// Names of the outputs to compute; the document must declare them. An empty list computes
    /// none. `None` means all that the document declares, except those marked `on_request` that no
    /// capture names.
    pub outputs: Option<Vec<String>>,
    /// Textures and buffers to read back in addition to the outputs, each at the end of a frame or
    /// as it is after one of the passes.
    pub captures: Vec<Capture>,
    /// Limits of the device that will run the graph. Planning reports an error for a graph that
    /// exceeds them ([`any_adapter`](Self::any_adapter): a warning).
    pub limits: wgt::Limits,
    /// Features that the device that will run the graph is created with. Planning reports an error
    /// for a graph that requires others ([`any_adapter`](Self::any_adapter): a warning);
    /// expressions of documents test features by `has(…)`.
    pub features: wgt::Features,
    /// Facts about the adapter of the device that will run the graph, by which documents choose how
    /// they do their work. `device::adapter_facts` of `skiagraph-gpu` returns those of a device.
    pub adapter: AdapterFacts,
    /// The backend of the device, if it lacks part of WebGPU; `None` for any other. Planning
    /// returns an error if the document does not list this backend in `proven_on`. The executor,
    /// which runs the plan on a device, refuses such a plan too, so `None` only delays the error.
    pub partial_backend: Option<PartialBackend>,
    /// Most bytes that the graph's own textures and buffers may take together. A graph that takes
    /// more is refused before anything is allocated: planning returns an error with a table of the
    /// largest allocations. `None` sets no limit. (wgpu does not tell how much memory a device
    /// has.)
    pub memory_limit: Option<u64>,
    /// Descriptions of the textures, buffers and samplers that the host hands over, each under the
    /// name of an input of the loaded document ([`Graph::inputs`](crate::Graph::inputs)), or of a
    /// texture with a picture, in whose place it is then
    /// ([`Graph::pictures`](crate::Graph::pictures)). Planning reports an error for an input
    /// without a description; other names are ignored.
    pub imports: BTreeMap<String, Import>,
    /// Number of [items](crate#terms) that growing buffers (with `grow`) need, or of layers that
    /// growing textures need, by [full name](crate#terms) of the material
    /// ([`Resource::name`](crate::Resource::name)). Each is made at least that large, but not
    /// larger than its `max`; names of other materials are ignored. To keep grown sizes when a
    /// graph is loaded again, pass the result of [`Plan::grown`].
    ///
    /// [`Plan::grown`]: crate::Plan::grown
    pub grown: BTreeMap<String, u64>,
    /// Byte that the memory of the graph's own textures and buffers is filled with before its first
    /// use in a frame; textures with depth or several samples are cleared to a value made of it.
    /// `None` fills nothing. Resources whose content lasts from frame to frame are left out. A
    /// graph whose outputs change with this byte reads memory that it has not written. Filling
    /// costs time; it is meant for finding mistakes.
    pub poison: Option<u8>,
    /// True if the device that will run the graph is not known. Planning then warns of needs beyond
    /// `limits` and `features`, which are errors otherwise.
    pub any_adapter: bool,
    /// Describes the resources that the graph does not make itself, such as scene buffers, camera
    /// and lights ([`NoProvider`](crate::NoProvider) for a graph that needs none).
    pub provider: P,
}

impl<'a> PlanRequest<'a> {
    /// Creates a request with wgpu's default limits, no features, default params and outputs, and
    /// all else empty, `None` or false. `viewport` is width and height in pixels; `provider`
    /// describes scene buffers, camera and lights ([`NoProvider`](crate::NoProvider) for a graph
    /// that needs none).
    pub fn new(viewport: [u32; 2], provider: &'a dyn Describe) -> Self {
        Self {
            viewport,
            params: BTreeMap::new(),
            outputs: None,
            captures: Vec::new(),
            limits: wgt::Limits::default(),
            features: wgt::Features::empty(),
            adapter: AdapterFacts::default(),
            partial_backend: None,
            memory_limit: None,
            imports: BTreeMap::new(),
            grown: BTreeMap::new(),
            poison: None,
            any_adapter: false,
            provider,
        }
    }

    /// Sets the [`limits`](Request::limits) and [`features`](Request::features) of the device that
    /// will run the graph.
    #[must_use]
    pub fn with_device(mut self, limits: wgt::Limits, features: wgt::Features) -> Self {
        self.limits = limits;
        self.features = features;
        self
    }

    /// Sets the value of the param `name` ([`params`](Request::params)).
    #[must_use]
    pub fn with_param(mut self, name: impl Into<String>, value: ParamValue) -> Self {
        self.params.insert(name.into(), value);
        self
    }

    /// Adds the description of an import for the input `name` ([`imports`](Request::imports)).
    #[must_use]
    pub fn with_import(mut self, name: impl Into<String>, import: Import) -> Self {
        self.imports.insert(name.into(), import);
        self
    }

    /// Sets [`any_adapter`](Request::any_adapter).
    #[must_use]
    pub fn with_any_adapter(mut self, any_adapter: bool) -> Self {
        self.any_adapter = any_adapter;
        self
    }

    pub(crate) fn surroundings(&self) -> Surroundings {
        Surroundings {
            viewport: self.viewport,
            features: self.features,
            adapter: self.adapter,
            storage_binding: self.limits.max_storage_buffer_binding_size,
        }
    }
}

impl<P> Request<P> {
    /// Copies the request with another provider. A plan stores its request with the descriptions
    /// that the provider gave, so that it can be sent to another thread and planned again with a
    /// change.
    pub(crate) fn to<Q>(&self, provider: Q) -> Request<Q> {
        Request {
            viewport: self.viewport,
            params: self.params.clone(),
            outputs: self.outputs.clone(),
            captures: self.captures.clone(),
            limits: self.limits.clone(),
            features: self.features,
            adapter: self.adapter,
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

/// A material (texture or buffer) whose content is to be read back after a frame, as it is at the
/// end of the frame or after one of its passes. Planning reports an error for an unknown name, for
/// a material of the graph that no pass has written by then, and for content that cannot be read
/// back, such as a multisampled texture.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub struct Capture {
    /// [Full name](crate#terms) of a material ([`Resource::name`](crate::Resource::name)), such as
    /// `left.depth` for the output `depth` of the [include](crate#terms) `left`, or a part of one,
    /// such as `maps[2]`. Without `after` also the name of an output; with `after` also the name of
    /// a provided buffer whose number of [items](crate#terms) is known.
    pub material: String,
    /// [Full name](crate#terms) of the pass after which the content is captured, as in
    /// [`PassSummary::name`](crate::PassSummary::name); `None` captures it at the end of the frame.
    pub after: Option<String>,
}

impl Capture {
    /// Creates the capture of a [`material`](Self::material) at the end of the frame.
    pub fn new(material: impl Into<String>) -> Self {
        Self {
            material: material.into(),
            after: None,
        }
    }

    /// Sets the pass [`after`](Self::after) which the content is captured.
    #[must_use]
    pub fn with_after(mut self, pass: impl Into<String>) -> Self {
        self.after = Some(pass.into());
        self
    }

    /// Returns the name under which the content is read back: `material`, or `material@pass` for a
    /// [capture](crate#terms) after a pass.
    pub fn name(&self) -> String {
        match &self.after {
            Some(pass) => format!("{}@{pass}", self.material),
            None => self.material.clone(),
        }
    }
}
