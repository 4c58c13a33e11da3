//! Lowers passes to steps: each pass kind turns its body into GPU work, with the values of this
//! plan.

use super::flat::{Flat, FlatPass};
use super::scopes::InstanceId;
use crate::kinds::{Lowering, Names, Operand, ShaderUse, Step};
use crate::resource::{Origin, Resource, ResourceId, ResourceKind};
use crate::source::Located;

/// A pass with its body lowered to steps.
pub(crate) struct LoweredPass<'a> {
    pub flat: FlatPass<'a>,
    /// GPU work of the pass, in the order in which it runs.
    pub steps: Vec<Step<Names>>,
    /// Buffers that only this pass uses, in the order in which its kind added them.
    pub scratch: Vec<ResourceId>,
    /// Use of a document (the loaded one or an include) that the pass belongs to.
    pub instance: InstanceId,
    /// Name of the shader that the entry's `bind` is for: the one in the field `shader`, or else
    /// the one with the pass's name.
    pub shader: Located<String>,
    /// True if a value of the body has a mistake, which was reported.
    pub is_broken: bool,
}

/// Lowers every pass.
pub(crate) fn lower<'a>(flat: &mut Flat<'a>, passes: Vec<FlatPass<'a>>) -> Vec<LoweredPass<'a>> {
    let passes = passes.into_iter().map(|pass| lower_pass(pass, flat));
    passes.collect()
}

fn lower_pass<'a>(pass: FlatPass<'a>, flat: &mut Flat<'a>) -> LoweredPass<'a> {
    let (symbols, plan_inputs) = (&mut flat.symbols, &mut flat.plan_inputs);
    let (entry, position, fields) = (pass.entry, pass.position, pass.pass);
    let before = symbols.reports.errors();
    let instance = symbols.scopes.document(position.scope);
    // Constants are those of the pass's own shader, or of the first that its kind brings.
    let is_own = |shader: &&ShaderUse| fields.shader.as_ref() == Some(&shader.name);
    let own = fields.shaders.iter().find(is_own);
    let shader = own.or(fields.shaders.first()).and_then(|shader| {
        let shaders = &symbols.graph.shaders;
        shaders.get(&instance.document, shader, &instance.replaced)
    });
    let mut at = symbols.at(position, shader);
    let shader = fields.shader.as_ref();
    let mut lowering = Lowering::new(&entry.name, shader, &entry.bind, Some(&mut at));
    for material in &fields.clear {
        lowering.step(Step::Clear {
            target: Operand::from(material),
            value: [0.0; 4],
        });
    }
    fields.body.lower(&mut lowering);
    let (steps, scratch, diagnostics) = (lowering.steps, lowering.scratch, lowering.diagnostics);
    for condition in lowering.conditions {
        plan_inputs.note(&condition, symbols, position.scope);
    }
    for diagnostic in diagnostics {
        symbols.reports.report(diagnostic);
    }
    // A slash stands in no name: nothing in a document can mean this buffer.
    let scratch = scratch.into_iter().map(|(name, bytes)| {
        let name = format!("{}/{name}", pass.name.value);
        let kind = ResourceKind::buffer_of(bytes.div_ceil(4));
        symbols.add(Resource::new(name, kind, Origin::Own))
    });
    LoweredPass {
        scratch: scratch.collect(),
        instance: symbols.scopes.instance_of(position.scope),
        steps,
        shader: shader.cloned().unwrap_or_else(|| entry.name.text()),
        is_broken: symbols.reports.errors() > before,
        flat: pass,
    }
}
