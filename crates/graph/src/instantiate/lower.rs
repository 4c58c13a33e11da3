//! Lowers passes to steps: each pass kind turns its body into GPU work, with the values of this
//! plan.

use super::{
    flat::{Flat, FlatPass, Interface, Merge, PlanInputs},
    scopes::InstanceId,
    symbols::SymbolTable,
};
use crate::{
    kinds::{
        kind::Lowering,
        step::{Names, Operand, ShaderUse, Step},
    },
    resource::{Buffer, Origin, Resource, ResourceId, ResourceKind},
    source::span::Located,
};

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

/// A flat graph whose passes are lowered to steps.
pub(crate) struct Lowered<'a> {
    pub symbols: SymbolTable<'a>,
    pub passes: Vec<LoweredPass<'a>>,
    pub first_invalid: Option<usize>,
    pub interfaces: Vec<Interface>,
    pub merged: Vec<Merge>,
    pub plan_inputs: PlanInputs,
}

/// Lowers every pass.
pub(crate) fn lower(flat: Flat<'_>) -> Lowered<'_> {
    let (mut symbols, mut plan_inputs) = (flat.symbols, flat.plan_inputs);
    let passes = flat.passes.into_iter().map(|flat| {
        let (entry, pass) = (flat.entry, flat.pass);
        let before = symbols.reports.errors();
        let instance = symbols.scopes.document(flat.position.scope);
        // Constants are those of the pass's own shader, or of the first that its kind brings.
        let is_own = |shader: &&ShaderUse| pass.shader.as_ref() == Some(&shader.name);
        let own = pass.shaders.iter().find(is_own);
        let shader = own.or(pass.shaders.first()).and_then(|shader| {
            let shaders = &symbols.graph.shaders;
            shaders.get(&instance.document, shader, &instance.replaced)
        });
        let mut environment = symbols.at(flat.position, shader);
        let mut lowering = Lowering::new(
            &entry.name,
            pass.shader.as_ref(),
            &entry.bind,
            Some(&mut environment),
        );
        for material in &pass.clear {
            lowering.step(Step::Clear {
                target: Operand::from(material),
                value: [0.0; 4],
            });
        }
        pass.body.lower(&mut lowering);
        let (steps, scratch, diagnostics) =
            (lowering.steps, lowering.scratch, lowering.diagnostics);
        for condition in lowering.conditions {
            plan_inputs.note(&condition, &symbols, flat.position.scope);
        }
        for diagnostic in diagnostics {
            symbols.reports.report(diagnostic);
        }
        // A slash stands in no name: nothing in a document can mean this buffer.
        let scratch = scratch.into_iter().map(|(name, bytes)| {
            let name = format!("{}/{name}", flat.name.value);
            let kind = ResourceKind::Buffer(Buffer {
                count: Some(bytes.div_ceil(4)),
                ..Buffer::default()
            });
            symbols.add(Resource::new(name, kind, Origin::Own))
        });
        LoweredPass {
            scratch: scratch.collect(),
            instance: symbols.scopes.instance_of(flat.position.scope),
            steps,
            shader: pass.shader.clone().unwrap_or_else(|| entry.name.text()),
            is_broken: symbols.reports.errors() > before,
            flat,
        }
    });
    let passes = passes.collect();
    Lowered {
        symbols,
        passes,
        first_invalid: flat.first_invalid,
        interfaces: flat.interfaces,
        merged: flat.merged,
        plan_inputs,
    }
}
