//! Passes become steps: each kind says what its body is, with values of this plan.

use super::{
    flat::{Border, Deciding, Flat, FlatPass},
    frames::InstanceId,
    world::World,
};
use crate::{
    diagnostics::reports::Reports,
    kinds::{
        kind::Lowering,
        step::{Names, Step},
    },
    resource::{Buffer, Origin, Resource, ResourceId, ResourceKind},
    source::span::Located,
};

/// A pass with its body lowered to steps.
pub(crate) struct LoweredPass<'a> {
    pub flat: FlatPass<'a>,
    pub steps: Vec<Step<Names>>,
    /// The pass's own buffers.
    pub scratch: Vec<ResourceId>,
    pub instance: InstanceId,
    /// The name of the shader that has the pass's own bindings.
    pub shader: Located<String>,
    /// A value of the body has a mistake that was reported.
    pub is_broken: bool,
}

/// A graph of passes that are lowered.
pub(crate) struct Lowered<'a> {
    pub world: World<'a>,
    pub passes: Vec<LoweredPass<'a>>,
    pub first_broken: Option<usize>,
    pub borders: Vec<Border>,
    pub deciding: Deciding,
}

/// Lowers every pass.
pub(crate) fn lower<'a>(flat: Flat<'a>, reports: &mut Reports) -> Lowered<'a> {
    let mut world = flat.world;
    let passes = flat
        .passes
        .into_iter()
        .map(|pass| lower_pass(pass, &mut world, reports));
    let passes = passes.collect();
    Lowered {
        world,
        passes,
        first_broken: flat.first_broken,
        borders: flat.borders,
        deciding: flat.deciding,
    }
}

fn lower_pass<'a>(
    flat: FlatPass<'a>,
    world: &mut World<'a>,
    reports: &mut Reports,
) -> LoweredPass<'a> {
    let (entry, pass) = (flat.entry, flat.pass);
    let before = reports.errors();
    let document = &world.frames.document(flat.place.frame).document;
    // Constants are those of the pass's own shader, or of the first that its kind brings.
    let shader = pass.shader.as_ref().or(pass.shaders.first());
    let shader = shader
        .and_then(|name| world.graph.shaders.get(document, name))
        .cloned();
    let mut environment = world.at(flat.place, shader, reports);
    let mut lowering = Lowering::new(
        &entry.name,
        pass.shader.as_ref(),
        &entry.bind,
        Some(&mut environment),
    );
    pass.body.lower(&mut lowering);
    let (steps, scratch, diagnostics) = (lowering.steps, lowering.scratch, lowering.diagnostics);
    for diagnostic in diagnostics {
        reports.tell(diagnostic);
    }
    let own = Located::new(entry.name.value.to_string(), entry.name.span.clone());
    // A slash stands in no name: nothing in a document can mean this buffer.
    let scratch = scratch.into_iter().map(|(name, bytes)| {
        world.add(Resource {
            name: format!("{}/{name}", flat.name.value),
            declared: None,
            kind: ResourceKind::Buffer(Buffer {
                count: Some(bytes / 4),
                ..Buffer::default()
            }),
            origin: Origin::Own,
        })
    });
    LoweredPass {
        scratch: scratch.collect(),
        instance: world.frames.instance_of(flat.place.frame),
        steps,
        shader: pass.shader.clone().unwrap_or(own),
        is_broken: reports.errors() > before,
        flat,
    }
}
