//! Rounds of a group that ends early: their dispatches and draws take their arguments from buffers,
//! which hold 0 in the rounds that do not run.

use super::bindings::buffer;
use super::pass::{BindTarget, Ids, LinkedBinding, LinkedProgram, Usage};
use super::scope::PassScope;
use crate::diagnostics::{ErrorGuaranteed, Reported};
use crate::errors::link::LinkError;
use crate::instantiate::Round;
use crate::kinds::{Dispatch, DrawCall, Groups, Step};
use crate::resource::{ResourceKind, SubresourceRange, Target};
use crate::shader::{Expanded, Shader};
use crate::source::SourceFile;
use std::sync::{Arc, LazyLock};

/// The shader of all rounds; `None` if it is not valid, which a test excludes.
static SHADER: LazyLock<Option<Arc<Shader>>> = LazyLock::new(|| {
    let text = include_str!("rounds.wgsl");
    let file = SourceFile::new("rounds.wgsl", Arc::from(text));
    let mut source = Expanded::new(file.clone());
    source.push(text, &file.span(0..0));
    Shader::new(source).ok().map(Arc::new)
});

/// Returns the first step of a round: it reads the counter.
pub(super) fn begin(round: &Round<'_>, scope: &mut PassScope<'_>) -> Reported<Step<Ids>> {
    let counter = counter(round, scope)?;
    let goes = scope.symbols.whole(round.goes);
    let bound = [("counter", &counter), ("goes", &goes)];
    dispatch("begin", &bound, &[], round, scope)
}

/// Gives a step arguments of its own. Returns the step before it that makes them, and their buffer;
/// `None` for a step that may run in every round: clearing the counter.
///
/// # Errors
/// A step that cannot be left out by its arguments.
pub(super) fn guard(
    step: &mut Step<Ids>,
    round: &Round<'_>,
    scope: &mut PassScope<'_>,
) -> Reported<Option<(Step<Ids>, Target)>> {
    let refusal = match &*step {
        Step::Clear { target, .. } if *target == counter(round, scope)? => return Ok(None),
        Step::Clear { .. } => Some("clearing a material"),
        Step::Copy { .. } => Some("a copy"),
        Step::Cpu(_) => Some("work of the CPU"),
        Step::Draw(draw) => {
            let mut colors = draw.colors.iter().flatten();
            let clears = colors.any(|color| color.clear.is_some())
                || draw.depth.as_ref().is_some_and(|it| it.clear.is_some())
                || draw.stencil.as_ref().is_some_and(|it| it.clear.is_some());
            let starts_late =
                matches!(&draw.call, DrawCall::Direct { instances, .. } if instances.start > 0);
            let clears = clears.then_some("clearing a target, which `load: Load` leaves out");
            clears.or(starts_late.then_some("a `first_instance`"))
        }
        Step::Dispatch(_) => None,
    };
    if let Some(what) = refusal {
        return Err(refused(what, round, scope));
    }
    let is_part = |target: &Target| target.part != SubresourceRange::WHOLE;
    let is_part = match &*step {
        Step::Draw(draw) => matches!(&draw.call, DrawCall::Indirect(asked) if is_part(asked)),
        Step::Dispatch(it) => matches!(&it.groups, Groups::Indirect(asked) if is_part(asked)),
        _ => false,
    };
    if is_part {
        return Err(refused("arguments in a part of a buffer", round, scope));
    }
    let number = scope.accesses.len();
    let name = format!("{}/arguments{number}", scope.pass.value);
    let arguments = scope.add(name, ResourceKind::buffer_of(4));
    let call = match step {
        Step::Draw(draw) => {
            let call = DrawCall::Indirect(arguments.clone());
            match std::mem::replace(&mut draw.call, call) {
                DrawCall::Direct {
                    vertices: v,
                    instances,
                } => Ok([v.len() as u32, instances.len() as u32, v.start, 0]),
                DrawCall::Indirect(asked) => Err(asked),
            }
        }
        Step::Dispatch(dispatch) => {
            let groups = Groups::Indirect(arguments.clone());
            match std::mem::replace(&mut dispatch.groups, groups) {
                Groups::Direct([x, y, z]) => Ok([x, y, z, 0]),
                Groups::Indirect(asked) => Err(asked),
            }
        }
        _ => return Ok(None),
    };
    let goes = scope.symbols.whole(round.goes);
    let bound = [("goes", &goes), ("arguments", &arguments)];
    let guard = match &call {
        Ok(numbers) => dispatch("direct", &bound, numbers, round, scope)?,
        Err(asked) => {
            let [goes, arguments] = bound;
            let bound = [goes, ("asked", asked), arguments];
            dispatch("indirect", &bound, &[], round, scope)?
        }
    };
    Ok(Some((guard, arguments)))
}

/// Reports a part of a pass that no arguments can leave out: once, whatever the round.
pub(super) fn refused(
    what: &'static str,
    round: &Round<'_>,
    scope: &mut PassScope<'_>,
) -> ErrorGuaranteed {
    let (pass, counter) = (scope.pass.span.clone(), round.counter.span.clone());
    scope.report(LinkError::InRounds(pass, what, counter))
}

/// Resolves the counter, which must be a buffer, all of it: an item may begin where none is bound.
fn counter(round: &Round<'_>, scope: &mut PassScope<'_>) -> Reported<Target> {
    let target = scope.symbols.resolve(round.counter, round.position)?;
    let wrong = match &scope.get(target.id).kind {
        ResourceKind::Buffer(_) if target.part == SubresourceRange::WHOLE => None,
        ResourceKind::Buffer(_) => Some("a part of a buffer"),
        kind => Some(kind.describe()),
    };
    if let Some(kind) = wrong {
        return Err(scope.report(LinkError::Counter(round.counter.located(), kind)));
    }
    let (base, span) = (scope.symbols.base(target.id), &round.counter.span);
    scope.layouts.at_least(base, &target.part, 4, span);
    Ok(target)
}

/// Returns one thread of the shader of rounds, with these bindings and overrides.
fn dispatch(
    entry: &str,
    bound: &[(&str, &Target)],
    numbers: &[u32],
    round: &Round<'_>,
    scope: &mut PassScope<'_>,
) -> Reported<Step<Ids>> {
    let shader = SHADER
        .clone()
        .ok_or_else(|| scope.report(LinkError::NoShader))?;
    let points = &shader.module().entry_points;
    let index = points.iter().position(|point| point.name == entry);
    let entries: Vec<usize> = index.into_iter().collect();
    let mut bindings = Vec::new();
    for global in shader.globals(&entries) {
        let target = bound.iter().find(|(name, _)| *name == global.name);
        let Some((_, target)) = target else {
            continue;
        };
        let usage = Usage::Buffer(wgt::BufferUsages::STORAGE);
        let used = (global.reads, global.writes, false);
        scope.access(target, used, usage, &round.counter.span);
        let read_only = matches!(global.name.as_str(), "counter" | "asked");
        let least = if global.name == "arguments" { 16 } else { 4 };
        bindings.push(LinkedBinding {
            group: global.group,
            binding: global.binding,
            target: BindTarget::Buffer((*target).clone()),
            ty: buffer(wgt::BufferBindingType::Storage { read_only }, least),
            visibility: global.stages,
        });
    }
    let constants = ["x", "y", "z", "w"].into_iter().zip(numbers);
    let program = LinkedProgram {
        constants: constants
            .map(|(name, number)| (name.to_owned(), f64::from(*number)))
            .collect(),
        bindings,
        shader,
        entries,
    };
    Ok(Step::Dispatch(Dispatch {
        program,
        groups: Groups::Direct([1, 1, 1]),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shader_of_rounds_is_valid() {
        assert!(SHADER.is_some());
    }
}
