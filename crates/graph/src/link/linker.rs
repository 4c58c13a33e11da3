//! Links passes one after the other.

use super::{
    layouts::Layouts,
    pass::{Access, Ids, LinkedPass},
};
use crate::{
    diagnostics::reports::{ErrorGuaranteed, Reports},
    errors::{instantiate::InterfaceError, link::LinkError},
    instantiate::{
        flat::{Inherited, Interface, Merge, PlanInputs, Run},
        lower::{Lowered, LoweredPass},
        scopes::{InstanceId, Position},
        symbols::SymbolTable,
    },
    kinds::step::{Dispatch, Groups, Names, Operand, Program, ShaderUse, Step},
    language::syntax::{Expr, Reference},
    request::Capture,
    resource::{Origin, ResourceId, ResourceKind, SubresourceRange, Target},
    shader::reflect::Shader,
    source::span::{Located, Span},
};
use naga::ShaderStage;
use std::{collections::BTreeSet, sync::Arc};

/// All passes of a graph, linked with its resources.
pub(crate) struct Linked<'a> {
    pub symbols: SymbolTable<'a>,
    pub passes: Vec<LinkedPass>,
    /// Instance of the document that each pass stands in; none for a capture.
    pub instances: Vec<Option<InstanceId>>,
    /// Number here of each pass, by its number before captures are put in.
    pub numbers: Vec<usize>,
    /// Includes that others stand for.
    pub merged: Vec<Merge>,
    /// How many of the passes stand above the first mistake, if there is one: writes below are not
    /// known.
    pub first_invalid: Option<usize>,
    pub interfaces: Vec<Interface>,
    pub plan_inputs: PlanInputs,
}

/// Surroundings in which passes are linked.
pub(super) struct Linker<'a, 'r> {
    pub symbols: SymbolTable<'a>,
    pub reports: &'r mut Reports,
    pub layouts: Layouts,
    /// Meaning of the names of the pass.
    pub pass: PassScope<'a>,
}

/// The pass that is being linked, as far as its names are concerned.
#[derive(Default)]
pub(super) struct PassScope<'a> {
    pub position: Option<Position>,
    pub scratch: Vec<ResourceId>,
    pub set: &'a [(Located<String>, Expr)],
    pub inherited_bind: Vec<Inherited<'a, Reference>>,
    pub inherited_set: Vec<Inherited<'a, Expr>>,
    /// The shader that has the pass's own bindings.
    pub shader: Option<Located<String>>,
    /// The bindings and values that a shader of the pass has asked for.
    pub asked: BTreeSet<String>,
    /// Source and destination of a capture: the two operands of its step.
    pub captured: Vec<Target>,
}

/// Links all passes with their captures.
pub(crate) fn link<'a>(lowered: Lowered<'a>, reports: &mut Reports) -> Linked<'a> {
    let request = lowered.symbols.request;
    let mut linker = Linker {
        symbols: lowered.symbols,
        reports,
        layouts: Layouts::default(),
        pass: PassScope::default(),
    };
    let (mut passes, mut instances) = (Vec::new(), Vec::new());
    // The writes of a pass with a mistake are not known.
    let mut first_invalid: Option<usize> = None;
    let mut numbers = Vec::new();
    for (index, pass) in lowered.passes.into_iter().enumerate() {
        numbers.push(passes.len());
        // For each mistake all names are searched for what was meant.
        if linker.reports.has_enough() {
            first_invalid.get_or_insert(passes.len());
            break;
        }
        if lowered.first_invalid == Some(index) {
            first_invalid.get_or_insert(passes.len());
        }
        let (name, instance, is_broken) = (pass.flat.name.clone(), pass.instance, pass.is_broken);
        match linker.pass(pass) {
            Ok(linked) if !is_broken => {
                passes.push(linked);
                instances.push(Some(instance));
            }
            _ => drop(first_invalid.get_or_insert(passes.len())),
        }
        let after = |capture: &&Capture| capture.after.as_deref() == Some(name.as_str());
        let captures: BTreeSet<&Capture> = request.captures.iter().filter(after).collect();
        for capture in captures {
            // A capture that cannot be was reported, and nothing needs it.
            if let Ok(captured) = linker.capture(capture, &passes) {
                passes.push(captured);
                instances.push(None);
            }
        }
    }
    if lowered.first_invalid.is_some() {
        first_invalid.get_or_insert(passes.len());
    }
    let layouts = std::mem::take(&mut linker.layouts);
    layouts.finalize(&mut linker.symbols, linker.reports);
    Linked {
        symbols: linker.symbols,
        passes,
        instances,
        numbers,
        merged: lowered.merged,
        first_invalid,
        interfaces: lowered.interfaces,
        plan_inputs: lowered.plan_inputs,
    }
}

impl<'a> Linker<'a, '_> {
    fn pass(&mut self, pass: LoweredPass<'a>) -> Result<LinkedPass, ErrorGuaranteed> {
        let flat = pass.flat;
        self.pass = PassScope {
            position: Some(flat.position),
            scratch: pass.scratch,
            set: &flat.entry.set,
            inherited_bind: flat.bind,
            inherited_set: flat.set,
            shader: Some(pass.shader),
            asked: BTreeSet::new(),
            captured: Vec::new(),
        };
        let mut linked = self.steps(flat.name, flat.pass.kind, &pass.steps)?;
        linked.run = flat.run;
        linked.enabled = flat.enabled;
        self.unasked()?;
        self.overwrites(&mut linked, &flat.pass.overwrites)?;
        if let Some(reads) = &flat.pass.reads {
            self.reads(&linked, reads)?;
        }
        Ok(linked)
    }

    /// The pass of these steps.
    pub fn steps(
        &mut self,
        name: Located<String>,
        kind: &'static str,
        steps: &[Step<Names>],
    ) -> Result<LinkedPass, ErrorGuaranteed> {
        let mut pass = LinkedPass {
            name,
            kind,
            steps: Vec::with_capacity(steps.len()),
            accesses: Vec::new(),
            run: Run::Always,
            enabled: true,
        };
        let mut wrong = None;
        for (index, step) in steps.iter().enumerate() {
            let first = pass.accesses.len();
            let linked = self.step(step, &mut pass);
            let own = &mut pass.accesses[first..];
            own.iter_mut().for_each(|access| access.step = index);
            let looped = self.feedback(&pass.name, &pass.accesses[first..]);
            match linked {
                Ok(step) => pass.steps.push(step),
                Err(reported) => wrong = Some(reported),
            }
            wrong = looped.err().or(wrong);
        }
        wrong.map_or(Ok(pass), Err)
    }

    fn step(
        &mut self,
        step: &Step<Names>,
        pass: &mut LinkedPass,
    ) -> Result<Step<Ids>, ErrorGuaranteed> {
        match step {
            Step::Draw(draw) => self.draw(draw, pass).map(Step::Draw),
            Step::Dispatch(dispatch) => {
                let stages = [ShaderStage::Compute];
                let program = self.program(&dispatch.program, &stages, false, pass)?;
                let size = self.workgroup_size(&program, &pass.name)?;
                let groups = match &dispatch.groups {
                    Groups::Direct(threads) => {
                        Groups::Direct(self.workgroups(threads, size, &pass.name)?)
                    }
                    Groups::Indirect(buffer) => Groups::Indirect(self.indirect(buffer, 12, pass)?),
                };
                Ok(Step::Dispatch(Dispatch { program, groups }))
            }
            Step::Copy { from, to } => self.copy(from, to, pass),
            Step::Clear { target, value } => self.clear(target, *value, pass),
        }
    }

    pub fn report(&mut self, error: LinkError) -> ErrorGuaranteed {
        self.reports.report(error)
    }

    /// Resolves a reference of the pass's document.
    pub fn resolve(&mut self, reference: &Reference) -> Result<Target, ErrorGuaranteed> {
        let position = self.pass.position.unwrap_or_else(|| self.symbols.root());
        self.symbols.resolve(reference, position, self.reports)
    }

    /// Resolves an operand of a step. Returns its name and place, too, for messages.
    pub fn operand(
        &mut self,
        operand: &Operand,
        pass: &Located<String>,
    ) -> Result<(Target, Located<String>), ErrorGuaranteed> {
        match operand {
            Operand::Named(reference) => {
                let target = self.resolve(reference)?;
                let name = reference.text().to_owned();
                Ok((target, Located::new(name, reference.span.clone())))
            }
            Operand::Scratch(scratch) if !self.pass.captured.is_empty() => {
                let target = self.pass.captured[scratch.0].clone();
                let name = self.symbols.get(target.id).name.clone();
                Ok((target, Located::new(name, pass.span.clone())))
            }
            Operand::Scratch(scratch) => {
                let id = self.pass.scratch[scratch.0];
                let name = self.symbols.get(id).name.clone();
                Ok((
                    self.symbols.whole(id),
                    Located::new(name, pass.span.clone()),
                ))
            }
        }
    }

    /// Last frame's version of a resource is there to be read, and so is what the document holds.
    pub fn writable(&mut self, id: ResourceId, span: &Span) -> Result<(), ErrorGuaranteed> {
        let name = self.symbols.get(id).name.clone();
        match self.symbols.get(id).origin {
            Origin::Previous(base) => {
                let of = self.symbols.get(base).name.clone();
                Err(self.report(LinkError::WritesPrevious {
                    of,
                    span: span.clone(),
                }))
            }
            Origin::Constant => Err(self.report(LinkError::WritesConstant {
                name,
                span: span.clone(),
            })),
            Origin::Own | Origin::Host => Ok(()),
        }
    }

    /// A step that uses one part of a resource in two ways of which one writes: wgpu forbids it.
    fn feedback(
        &mut self,
        pass: &Located<String>,
        accesses: &[Access],
    ) -> Result<(), ErrorGuaranteed> {
        let mut wrong = None;
        for (index, a) in accesses.iter().enumerate() {
            for b in &accesses[..index] {
                let conflict =
                    a.resource == b.resource && a.part.overlaps(&b.part) && (a.writes || b.writes);
                // A depth attachment that is tested and written counts once; so does one global
                // used by both stages.
                if conflict {
                    let (reader, writer) = if a.writes && !b.writes {
                        (b, a)
                    } else {
                        (a, b)
                    };
                    wrong = Some(self.report(LinkError::Feedback {
                        pass: pass.value.clone(),
                        name: self.symbols.get(a.resource).name.clone(),
                        reader: reader.span.clone(),
                        reads: !reader.writes,
                        writer: writer.span.clone(),
                    }));
                }
            }
        }
        wrong.map_or(Ok(()), Err)
    }

    /// The shader of a program; those that the document names were loaded with it.
    pub fn shader(&mut self, program: &Program) -> Result<Arc<Shader>, ErrorGuaranteed> {
        let (Some(name), Some(position)) = (&program.shader, self.pass.position) else {
            return Err(self.report(LinkError::NoShader));
        };
        let instance = self.symbols.scopes.document(position.scope);
        let shader = ShaderUse {
            name: name.clone(),
            imports: program.imports.clone(),
        };
        let shaders = &self.symbols.graph.shaders;
        match shaders.get(&instance.document, &shader, &instance.replaced) {
            Some(shader) => shader.clone(),
            // A kind names another one for other values.
            None => match shaders.incomplete {
                Some(reported) => Err(reported),
                None => Err(self.report(LinkError::ShaderNotLoaded(name.clone()))),
            },
        }
    }

    /// Reports what the entry binds or sets and no shader of it asks for.
    fn unasked(&mut self) -> Result<(), ErrorGuaranteed> {
        let mut wrong = None;
        for (name, _) in self.pass.set {
            if !self.pass.asked.contains(name.as_str()) {
                let shader = self.pass.shader.as_ref();
                wrong = Some(self.report(LinkError::UnusedSet {
                    shader: shader.map_or(String::new(), |shader| shader.value.clone()),
                    name: name.clone(),
                    known: self.pass.asked.iter().cloned().collect(),
                }));
            }
        }
        wrong.map_or(Ok(()), Err)
    }

    /// Holds what the author says that a pass reads against what it reads.
    fn reads(
        &mut self,
        pass: &LinkedPass,
        references: &[Reference],
    ) -> Result<(), ErrorGuaranteed> {
        let mut stated = BTreeSet::new();
        for reference in references {
            let id = self.resolve(reference)?.id;
            stated.insert(id);
            let mut read = pass.accesses.iter().filter(|access| access.reads);
            if !read.any(|access| access.resource == id) {
                return Err(self.report(LinkError::ReadsNot {
                    pass: pass.name.value.clone(),
                    name: Located::new(reference.text().to_owned(), reference.span.clone()),
                }));
            }
        }
        let unstated = pass.accesses.iter().find(|access| {
            let kind = &self.symbols.get(access.resource).kind;
            let is_given = matches!(kind, ResourceKind::Provided(_) | ResourceKind::Frame)
                || matches!(kind, ResourceKind::AccelerationStructure);
            access.reads && !is_given && !stated.contains(&access.resource)
        });
        match unstated {
            None => Ok(()),
            Some(access) => {
                let name = self.symbols.get(access.resource).name.clone();
                Err(self.report(LinkError::ReadsMore {
                    pass: pass.name.clone(),
                    name,
                    read: access.span.clone(),
                }))
            }
        }
    }

    /// Takes the author's word that a pass writes all of some resources.
    fn overwrites(
        &mut self,
        pass: &mut LinkedPass,
        references: &[Reference],
    ) -> Result<(), ErrorGuaranteed> {
        for reference in references {
            let target = self.resolve(reference)?;
            let mut is_written = false;
            for access in &mut pass.accesses {
                if access.writes && access.resource == target.id && access.part == target.part {
                    is_written = true;
                    access.fully_overwrites = true;
                    // The pass reads only what it has written itself.
                    access.reads = false;
                }
            }
            if !is_written {
                return Err(self.report(LinkError::Overwrites {
                    pass: pass.name.value.clone(),
                    name: Located::new(reference.text().to_owned(), reference.span.clone()),
                }));
            }
        }
        Ok(())
    }
}

/// An access that reads or writes a whole part.
pub(super) fn access(
    target: &Target,
    (reads, writes, fully_overwrites): (bool, bool, bool),
    usage: super::pass::Usage,
    span: &Span,
) -> Access {
    Access {
        resource: target.id,
        part: target.part.clone(),
        reads,
        writes,
        fully_overwrites,
        triggers: true,
        usage,
        span: span.clone(),
        step: 0,
    }
}

impl Linked<'_> {
    /// The first include that another one cannot stand for, because something in between writes
    /// what it reads or writes.
    pub fn two_copies(&self) -> Option<InterfaceError> {
        self.merged.iter().find_map(|merge| {
            // After a mistake the last passes are not there.
            let between = self.numbers.get(merge.between.clone())?.iter();
            between.copied().find_map(|number| {
                let pass = self.passes.get(number)?;
                let written = pass.accesses.iter().find(|access| {
                    let id = access.resource;
                    let is_own = merge.owned.contains(&id.index())
                        && self.symbols.get(id).origin == Origin::Own;
                    access.writes && (is_own || merge.inputs.contains(&id))
                })?;
                Some(InterfaceError::TwoCopies {
                    graph: merge.graph.clone(),
                    pass: pass.name.value.clone(),
                    material: self.symbols.get(written.resource).name.clone(),
                    span: merge.span.clone(),
                    by: pass.name.span.clone(),
                })
            })
        })
    }

    /// True if a pass writes some of a part.
    pub fn writes(&self, pass: usize, id: ResourceId, part: &SubresourceRange) -> bool {
        let writes =
            |access: &Access| access.writes && access.resource == id && access.part.overlaps(part);
        self.passes[pass].accesses.iter().any(writes)
    }
}
