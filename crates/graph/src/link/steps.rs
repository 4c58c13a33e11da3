//! The steps of a pass, linked one after the other.

use super::{
    attachments, dispatch,
    layouts::Layouts,
    pass::{Access, Ids, LinkedPass},
    scope::PassScope,
    transfers,
};
use crate::{
    diagnostics::reports::{ErrorGuaranteed, Reports},
    errors::link::LinkError,
    instantiate::flat::Run,
    kinds::step::{Names, Step},
    source::span::Located,
};

/// The pass of these steps.
pub(super) fn link(
    name: Located<String>,
    kind: &'static str,
    steps: &[Step<Names>],
    scope: &mut PassScope<'_>,
    layouts: &mut Layouts,
    reports: &mut Reports,
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
        let linked = self::step(step, &mut pass, scope, layouts, reports);
        let own = &mut pass.accesses[first..];
        own.iter_mut().for_each(|access| access.step = index);
        let looped = feedback(&pass.name, &pass.accesses[first..], scope, reports);
        match linked {
            Ok(step) => pass.steps.push(step),
            Err(reported) => wrong = Some(reported),
        }
        wrong = looped.err().or(wrong);
    }
    wrong.map_or(Ok(pass), Err)
}

fn step(
    step: &Step<Names>,
    pass: &mut LinkedPass,
    scope: &mut PassScope<'_>,
    layouts: &mut Layouts,
    reports: &mut Reports,
) -> Result<Step<Ids>, ErrorGuaranteed> {
    match step {
        Step::Draw(draw) => attachments::link(draw, pass, scope, layouts, reports).map(Step::Draw),
        Step::Dispatch(step) => {
            dispatch::link(step, pass, scope, layouts, reports).map(Step::Dispatch)
        }
        Step::Copy { from, to } => transfers::copy(from, to, pass, scope, layouts, reports),
        Step::Clear { target, value } => transfers::clear(target, *value, pass, scope, reports),
    }
}

/// A step that uses one part of a resource in two ways of which one writes: wgpu forbids it.
fn feedback(
    pass: &Located<String>,
    accesses: &[Access],
    scope: &PassScope<'_>,
    reports: &mut Reports,
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
                wrong = Some(reports.report(LinkError::Feedback {
                    pass: pass.value.clone(),
                    name: scope.get(a.resource).name.clone(),
                    reader: reader.span.clone(),
                    reads: !reader.writes,
                    writer: writer.span.clone(),
                }));
            }
        }
    }
    wrong.map_or(Ok(()), Err)
}
