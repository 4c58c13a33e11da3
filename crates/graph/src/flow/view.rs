//! Input of the steps of this phase: linked passes, and the resources that they use.

use crate::link::{LinkedPass, PassId};
use crate::resource::{Resource, ResourceId, ResourceKind, SubresourceRange};
use petgraph::graph::{DiGraph, NodeIndex};
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

    /// Returns a graph of the passes with these edges.
    pub fn graph<E>(self, edges: impl Iterator<Item = (PassId, PassId, E)>) -> DiGraph<(), E> {
        let mut graph = DiGraph::with_capacity(self.passes.len(), edges.size_hint().0);
        for _ in self.passes {
            graph.add_node(());
        }
        for (from, to, edge) in edges {
            graph.add_edge(NodeIndex::new(from.0), NodeIndex::new(to.0), edge);
        }
        graph
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
    /// By index of the resource.
    kinds: Vec<ResourceKind>,
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
            kinds: view.resources.iter().map(|it| it.kind.clone()).collect(),
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
        let kind = &self.kinds[id.index()];
        // Depth and stencil have versions of their own.
        let is_combined = matches!(kind, ResourceKind::Texture(texture)
            if texture.format.is_combined_depth_stencil_format());
        let aspects = match (part.aspect, is_combined) {
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
            let mips = mips.filter(move |mip| begin < kind.layers(*mip));
            mips.flat_map(move |mip| aspects.clone().map(move |aspect| [mip, begin, aspect]))
        })
    }
}
