//! What a plan is asked for, and what it tells.

use crate::{
    document::params::ParamValue,
    provider::{Described, Import, Provider},
};
use std::collections::BTreeMap;

/// What a plan is made for.
pub struct PlanRequest<'a> {
    /// Width and height in pixels.
    pub viewport: [u32; 2],
    /// Values of params; where missing, the document's default.
    pub params: BTreeMap<String, ParamValue>,
    /// The outputs that are wanted; `None` = all that the document declares.
    pub outputs: Option<Vec<String>>,
    /// Materials that are to be read back beside the outputs.
    pub captures: Vec<Capture>,
    /// Limits that the device will have.
    pub limits: wgpu::Limits,
    /// Features that the device will have.
    pub features: wgpu::Features,
    /// Bytes that the graph's own textures and buffers may take together; one that takes more is refused with a table of what
    /// takes the most, before anything is allocated. `None`: whatever the device gives. (wgpu does not tell how much memory there is.)
    pub memory_limit: Option<u64>,
    /// What the host will import, by name.
    pub imports: BTreeMap<String, Import>,
    /// Fills memory between uses with a pattern made of this byte: a graph whose outputs change with it reads what it has not
    /// written. Costs time; for finding mistakes.
    pub poison: Option<u8>,
    /// Describes the provided resources.
    pub provider: &'a dyn Provider,
}

impl<'a> PlanRequest<'a> {
    /// A request with wgpu's default limits, no features, default params and all outputs.
    pub fn new(viewport: [u32; 2], provider: &'a dyn Provider) -> Self {
        Self {
            viewport,
            params: BTreeMap::new(),
            outputs: None,
            captures: Vec::new(),
            limits: wgpu::Limits::default(),
            features: wgpu::Features::empty(),
            memory_limit: None,
            imports: BTreeMap::new(),
            poison: None,
            provider,
        }
    }
}

/// A [`PlanRequest`] that a plan keeps, so that it can be made again with something changed.
#[derive(Clone, Debug)]
pub(crate) struct Request {
    pub viewport: [u32; 2],
    pub params: BTreeMap<String, ParamValue>,
    pub outputs: Option<Vec<String>>,
    pub captures: Vec<Capture>,
    pub limits: wgpu::Limits,
    pub features: wgpu::Features,
    pub memory_limit: Option<u64>,
    pub imports: BTreeMap<String, Import>,
    pub poison: Option<u8>,
    provider: Described,
}

impl Request {
    pub fn of(request: &PlanRequest<'_>) -> Self {
        Self {
            viewport: request.viewport,
            params: request.params.clone(),
            outputs: request.outputs.clone(),
            captures: request.captures.clone(),
            limits: request.limits.clone(),
            features: request.features,
            memory_limit: request.memory_limit,
            imports: request.imports.clone(),
            poison: request.poison,
            provider: Described::by(request.provider),
        }
    }

    /// Whether the host imports or provides something under this name.
    pub fn offers(&self, name: &str) -> bool {
        self.imports.contains_key(name) || self.provider.0.contains_key(name)
    }

    /// The request to plan with; provided resources are as they were described.
    pub fn again(&self) -> PlanRequest<'_> {
        PlanRequest {
            viewport: self.viewport,
            params: self.params.clone(),
            outputs: self.outputs.clone(),
            captures: self.captures.clone(),
            limits: self.limits.clone(),
            features: self.features,
            memory_limit: self.memory_limit,
            imports: self.imports.clone(),
            poison: self.poison,
            provider: &self.provider,
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

/// A live pass.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PassSummary {
    /// Name.
    pub name: String,
    /// Kind, as the document writes it.
    pub kind: String,
}

/// A pass that does not run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CulledPass {
    /// Name.
    pub name: String,
    /// Why.
    pub reason: String,
}

/// Something that can be read back.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputSummary {
    /// Name of the output or capture.
    pub name: String,
    /// Format of a texture; `None` for a buffer.
    pub format: Option<wgpu::TextureFormat>,
    /// Texels of a texture; `[bytes, 1]` of a buffer.
    pub size: [u32; 2],
}
