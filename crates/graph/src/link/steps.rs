//! Linking of the steps of a pass, one after the other.

use super::pass::{Access, Ids, LinkedPass, Usage};
use super::scope::PassScope;
use super::{attachments, cpu, dispatch, rounds, transfers};
use crate::diagnostics::Reported;
use crate::errors::link::LinkError;
use crate::instantiate::Run;
use crate::kinds::{Names, Step};
use crate::resource::{Origin, name_within};
use crate::source::Located;

/// Links the steps of a pass.
pub(super) fn link(
    name: Located<String>,
    kind: &'static str,
    steps: &[Step<Names>],
    scope: &mut PassScope<'_>,
) -> Reported<LinkedPass> {
    scope.pass = name.clone();
    scope.accesses = Vec::new();
    let mut linked = Vec::with_capacity(steps.len());
    let mut wrong = None;
    let round = scope.round;
    if let Some(round) = round.filter(|round| scope.begun.insert(round.goes)) {
        let begun = rounds::begin(&round, scope);
        wrong = push(begun, 0, &mut linked, scope).err();
    }
    for step in steps {
        let mut first = scope.accesses.len();
        let mut step = self::step(step, scope);
        if let (Ok(linked_step), Some(round)) = (&mut step, &round) {
            let mut own = scope.accesses.split_off(first);
            match rounds::guard(linked_step, round, scope) {
                Err(reported) => step = Err(reported),
                Ok(None) => {}
                Ok(Some((guard, arguments))) => {
                    let guarded = push(Ok(guard), first, &mut linked, scope);
                    wrong = guarded.err().or(wrong);
                    let usage = Usage::Buffer(wgt::BufferUsages::INDIRECT);
                    let (used, span) = ((true, false, false), &round.counter.span);
                    own.push(Access::new(&arguments, used, usage, span));
                }
            }
            first = scope.accesses.len();
            scope.accesses.append(&mut own);
        }
        wrong = push(step, first, &mut linked, scope).err().or(wrong);
    }
    let pass = LinkedPass {
        name,
        kind,
        steps: linked,
        accesses: std::mem::take(&mut scope.accesses),
        run: Run::Always,
        turns: vec![true],
    };
    wrong.map_or(Ok(pass), Err)
}

/// Appends a step, whose accesses are those from `first` on.
fn push(
    step: Reported<Step<Ids>>,
    first: usize,
    linked: &mut Vec<Step<Ids>>,
    scope: &mut PassScope<'_>,
) -> Reported<()> {
    let own = &mut scope.accesses[first..];
    own.iter_mut().for_each(|access| access.step = linked.len());
    let conflicts = feedback(first, scope);
    linked.push(step?);
    conflicts
}

fn step(step: &Step<Names>, scope: &mut PassScope<'_>) -> Reported<Step<Ids>> {
    match step {
        Step::Draw(draw) => attachments::link(draw, scope).map(Step::Draw),
        Step::Dispatch(step) => dispatch::link(step, scope).map(Step::Dispatch),
        Step::Copy { from, to } => transfers::copy(from, to, scope),
        Step::Clear { target, value } => transfers::clear(target, *value, scope),
        Step::Cpu(call) => cpu::link(call, scope).map(Step::Cpu),
    }
}

/// Reports a step that uses a part of a resource in two ways, one of which writes: wgpu forbids it.
/// `first` is the index of the step's first access.
fn feedback(first: usize, scope: &mut PassScope<'_>) -> Reported<()> {
    let mut wrong = Vec::new();
    for (index, a) in scope.accesses[first..].iter().enumerate() {
        for b in &scope.accesses[first..][..index] {
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
                let resource = scope.get(a.resource);
                let has_previous =
                    !reader.writes && !resource.keep && resource.origin == Origin::Own;
                let previous = name_within(&scope.pass, &resource.name).to_owned();
                wrong.push(LinkError::Feedback {
                    pass: scope.pass.value.clone(),
                    previous: has_previous.then_some(previous),
                    name: resource.name.clone(),
                    reader: reader.span.clone(),
                    reads: !reader.writes,
                    writer: writer.span.clone(),
                });
            }
        }
    }
    let reported = wrong.into_iter().map(|error| scope.report(error));
    reported.last().map_or(Ok(()), Err)
}
