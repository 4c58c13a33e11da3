//! Input of the steps of this phase: linked passes, and the resources that they use.

use crate::{
    link::{LinkedPass, PassId},
    resource::{Resource, ResourceId, ResourceKind, SubresourceRange},
};
use std::collections::BTreeMap;

/// Linked passes and the resources of a plan.
#[derive(Clone, Copy)]
pub(crate) struct GraphView<'p> {
    pub passes: &'p [LinkedPass],
    pub resources: &'p [Resource],
}

impl<'p> GraphView<'p> {
    /// Iterates over all passes, each with its id.
    pub fn ids(self) -> impl Iterator<Item = (PassId, &'p LinkedPass)> {
        let passes = self.passes.iter().enumerate();
        passes.map(|(index, pass)| (PassId(index), pass))
    }

    pub fn pass(self, id: PassId) -> &'p LinkedPass {
        &self.passes[id.0]
    }

    pub fn resource(self, id: ResourceId) -> &'p Resource {
        &self.resources[id.index()]
    }
}

/// Divides resources into the parts that passes write independently: mips, layers and aspects of
/// textures, and ranges of a buffer's items that accesses tell apart.
#[derive(Debug)]
pub(crate) struct Subresources {
    /// Bounds between the ranges of layers or items of each resource, sorted; every access begins
    /// and ends at one.
    cuts: BTreeMap<ResourceId, Vec<u32>>,
    /// Extent of each resource in layers or items, by index of the resource.
    reach: Vec<Reach>,
}

/// Extent of a texture in layers or of a buffer in items, and the aspects that have versions of
/// their own.
#[derive(Clone, Copy, Debug)]
struct Reach {
    /// Number of layers of a texture, of slices of mip 0 of a 3D texture, or of items of a buffer.
    layers: u32,
    is_3d: bool,
    /// True if depth and stencil have versions of their own.
    is_combined: bool,
}

impl Reach {
    fn new(resource: &Resource) -> Self {
        let (layers, is_3d, is_combined) = match &resource.kind {
            ResourceKind::Texture(texture) => {
                let is_combined = texture.format.is_combined_depth_stencil_format();
                (texture.layers, texture.is_3d, is_combined)
            }
            // Without a count the end of a buffer's items is not known.
            ResourceKind::Buffer(buffer) => {
                let items = buffer.count.and_then(|items| u32::try_from(items).ok());
                (items.unwrap_or(u32::MAX), false, false)
            }
            _ => (u32::MAX, false, false),
        };
        Self {
            layers,
            is_3d,
            is_combined,
        }
    }

    /// Returns the number of layers of a mip; the slices of a 3D texture are halved with each mip.
    fn layers(self, mip: u32) -> u32 {
        if self.is_3d {
            (self.layers >> mip).max(1)
        } else {
            self.layers
        }
    }
}

impl Subresources {
    pub fn new(view: GraphView<'_>) -> Self {
        let mut cuts: BTreeMap<ResourceId, Vec<u32>> = BTreeMap::new();
        for access in view.passes.iter().flat_map(|pass| &pass.accesses) {
            let layers = &access.part.layers;
            let cuts = cuts.entry(access.resource).or_default();
            cuts.extend([layers.start, layers.end]);
        }
        for cuts in cuts.values_mut() {
            cuts.sort_unstable();
            cuts.dedup();
        }
        Self {
            cuts,
            reach: view.resources.iter().map(Reach::new).collect(),
        }
    }

    /// Returns the parts of a resource that overlap `part`, each as mip, first layer or item (which
    /// may lie before `part`), and aspect (1 for stencil, otherwise 0). Parts that nothing accesses
    /// are left out.
    pub fn within(
        &self,
        id: ResourceId,
        part: &SubresourceRange,
    ) -> impl Iterator<Item = [u32; 3]> + use<'_> {
        let cuts = self.cuts.get(&id).map_or(&[][..], Vec::as_slice);
        let part = part.clone();
        let reach = self.reach[id.index()];
        let aspects = match (part.aspect, reach.is_combined) {
            (wgt::TextureAspect::StencilOnly, true) => 1..2,
            (wgt::TextureAspect::All, true) => 0..2,
            _ => 0..1,
        };
        // A part without an access of its own consists of parts that have one.
        let covers =
            move |begin: &u32, end: &u32| *begin < part.layers.end && part.layers.start < *end;
        let stretches = cuts.iter().zip(cuts.iter().skip(1));
        let stretches = stretches.filter(move |(begin, end)| covers(begin, end));
        stretches.flat_map(move |(begin, _)| {
            let (begin, aspects) = (*begin, aspects.clone());
            let mips = part.mips.clone();
            let mips = mips.filter(move |mip| begin < reach.layers(*mip));
            mips.flat_map(move |mip| aspects.clone().map(move |aspect| [mip, begin, aspect]))
        })
    }
}
