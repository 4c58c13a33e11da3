//! The steps of a pass, linked one after the other.

use super::{attachments, dispatch, pass::Ids, scope::PassScope, transfers};
use crate::{
    diagnostics::reports::Reported,
    errors::link::LinkError,
    kinds::step::{Names, Step},
};

/// Links the steps of the scope's pass.
pub(super) fn link(steps: &[Step<Names>], scope: &mut PassScope<'_, '_>) -> Reported<()> {
    let mut wrong = None;
    for (index, step) in steps.iter().enumerate() {
        let first = scope.pass.accesses.len();
        let linked = self::step(step, scope);
        let own = &mut scope.pass.accesses[first..];
        own.iter_mut().for_each(|access| access.step = index);
        let looped = feedback(first, scope);
        match linked {
            Ok(step) => scope.pass.steps.push(step),
            Err(reported) => wrong = Some(reported),
        }
        wrong = looped.err().or(wrong);
    }
    wrong.map_or(Ok(()), Err)
}

fn step(step: &Step<Names>, scope: &mut PassScope<'_, '_>) -> Reported<Step<Ids>> {
    match step {
        Step::Draw(draw) => attachments::link(draw, scope).map(Step::Draw),
        Step::Dispatch(step) => dispatch::link(step, scope).map(Step::Dispatch),
        Step::Copy { from, to } => transfers::copy(from, to, scope),
        Step::Clear { target, value } => transfers::clear(target, *value, scope),
    }
}

/// A step that uses one part of a resource in two ways of which one writes: wgpu forbids it. `first`:
/// the number of its first access.
fn feedback(first: usize, scope: &mut PassScope<'_, '_>) -> Reported<()> {
    let pass = &scope.pass;
    let mut wrong = Vec::new();
    for (index, a) in pass.accesses[first..].iter().enumerate() {
        for b in &pass.accesses[first..][..index] {
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
                wrong.push(LinkError::Feedback {
                    pass: pass.name.value.clone(),
                    name: scope.get(a.resource).name.clone(),
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
