//! What a plan tells of itself, and plans made from it.

use super::{CulledPass, OutputSummary, PassSummary, Plan, PlanRequest};
use crate::{
    diagnostics::{Diagnostic, Diagnostics},
    document::params::ParamValue,
    graph::Graph,
    instantiate::Fallback,
    resolve::{ResourceKind, Target},
};

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
