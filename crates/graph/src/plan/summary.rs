//! Summaries of a plan, and plans made from it.

use super::plan::{CulledPass, Plan};
use crate::{
    diagnostics::{diagnostic::Diagnostic, list::Diagnostics},
    document::params::ParamValue,
    errors::plan::OutputError,
    graph::Graph,
    link::pass::LinkedPass,
    provided_kind::ProvidedKind,
    request::PlanRequest,
    resource::{Origin, ResourceKind, Target},
};

/// A live pass.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PassSummary {
    /// Name.
    pub name: String,
    /// Kind, as the document writes it.
    pub kind: String,
}

/// Something that can be read back.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputSummary {
    /// Name of the output or capture.
    pub name: String,
    /// Format of a texture; `None` for a buffer.
    pub format: Option<wgt::TextureFormat>,
    /// Texels of a texture; `[bytes, 1]` of a buffer.
    pub size: [u32; 2],
    /// Layers of a texture; 1 of a buffer.
    pub layers: u32,
}

impl Plan {
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
        &self.culled
    }

    /// The provided resources that live passes bind; only these are built.
    pub fn provided(&self) -> Vec<&str> {
        self.schedule()
            .lifetimes
            .keys()
            .map(|id| self.resource(*id))
            .filter(|resource| {
                matches!(
                    resource.kind,
                    ResourceKind::Provided(_) | ResourceKind::AccelerationStructure
                )
            })
            .map(|resource| resource.name.as_str())
            .collect()
    }

    /// True if a frame may depend on those before it though the host changes nothing: live passes
    /// read what the graph left in the frame before, or the frame's number.
    pub fn remembers(&self) -> bool {
        let used = self.schedule().lifetimes.keys();
        used.map(|id| self.resource(*id))
            .any(|resource| match (&resource.kind, resource.origin) {
                _ if resource.keep => true,
                (ResourceKind::Frame, _) => true,
                (ResourceKind::Provided(_), _) => false,
                (_, origin) => matches!(origin, Origin::Previous(_)),
            })
    }

    /// The light that live passes bind, if it is of a kind that the document does not take: of
    /// those that there are it takes the first, unless it says otherwise.
    pub(crate) fn refused_light(&self) -> Option<OutputError> {
        let document = &self.graph.document;
        let bound = self
            .schedule()
            .lifetimes
            .keys()
            .map(|id| self.resource(*id));
        let kinds = bound.filter_map(|resource| match &resource.kind {
            ResourceKind::Provided(provided) if is_light(&resource.name) => provided.kind,
            _ => None,
        });
        let takes = |kind: &ProvidedKind| {
            if document.lights.is_empty() {
                kind.number == 0
            } else {
                document
                    .lights
                    .iter()
                    .any(|word| word.as_str() == kind.word())
            }
        };
        let kind = kinds.into_iter().find(|kind| !takes(kind))?;
        let words = document.lights.iter().map(|word| word.value.to_string());
        let takes = if document.lights.is_empty() {
            kind.words
                .iter()
                .take(1)
                .map(|word| (*word).to_owned())
                .collect()
        } else {
            words.collect()
        };
        let place = document.lights.first().map(|word| word.span.clone());
        Some(OutputError::Light {
            graph: document.file.name.to_string(),
            kind: kind.word(),
            takes,
            place: place.unwrap_or_else(|| self.graph.place()),
        })
    }

    /// Returns the outputs that can be read back after a frame.
    pub fn outputs(&self) -> Vec<OutputSummary> {
        let summary = |(name, target): &(String, Target)| {
            let (format, size) = match &self.resource(target.id).kind {
                ResourceKind::Texture(texture) => (
                    Some(texture.format),
                    texture.mip_size(target.part.mips.start),
                ),
                ResourceKind::Buffer(buffer) => {
                    let items = target.part.items();
                    let bytes = items.map_or(buffer.bytes, |items| {
                        buffer.stride.saturating_mul(items.len() as u64)
                    });
                    (None, [u32::try_from(bytes).unwrap_or(u32::MAX), 1])
                }
                _ => (None, [0, 0]),
            };
            OutputSummary {
                name: name.clone(),
                format,
                size,
                layers: match target.part.layers.len() {
                    layers if format.is_some() => layers as u32,
                    _ => 1,
                },
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
        self.values.get(name)
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
        let mut request = self.request.again();
        change(&mut request);
        self.graph.plan(&request)
    }

    /// Returns the warnings.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }
}

/// `light`, and those of `lights`.
fn is_light(name: &str) -> bool {
    name == "light" || name.starts_with("lights.")
}
