//! Clears of buffers that may run ahead of other passes.

use skiagraph_graph::{LinkedPass, Origin, Plan, ResourceId, ResourceKind, step::Step};

/// Returns for each pass of the schedule the first position that its clears may be moved to: no
/// step between there and the clears uses memory that they clear. It is 0 for a pass without
/// clears, and `None` for one that has other steps than dispatches and clears of the plan's
/// buffers, or that clears a buffer which its own dispatches have used.
pub(super) fn earliest(plan: &Plan) -> Vec<Option<usize>> {
    let passes = &plan.schedule().passes;
    let mut found: Vec<Option<usize>> = Vec::new();
    for (at, &pass) in passes.iter().enumerate() {
        let earliest = cleared(plan, plan.pass(pass)).map(|cleared| {
            let is_cleared = |id| allocation(plan, id).is_some_and(|it| cleared.contains(&it));
            let uses = |before: &LinkedPass| {
                let mut used = before.accesses.iter();
                used.any(|access| is_cleared(access.resource))
            };
            // Nothing is moved past a pass with other steps, so it needs no look.
            let mut before = passes[..at].iter().zip(&found);
            let stops = |(&pass, found): (_, &Option<_>)| found.is_none() || uses(plan.pass(pass));
            let last = (!cleared.is_empty()).then(|| before.rposition(stops));
            last.flatten().map_or(0, |last| last + 1)
        });
        found.push(earliest);
    }
    found
}

/// Returns the allocations that a pass clears before its dispatches use them; `None` if it has
/// other steps.
fn cleared(plan: &Plan, pass: &LinkedPass) -> Option<Vec<usize>> {
    let mut cleared = Vec::new();
    for (index, step) in pass.steps.iter().enumerate() {
        let id = match step {
            Step::Dispatch(_) => continue,
            Step::Clear { target, .. } => target.id,
            Step::Draw(_) | Step::Copy { .. } | Step::Cpu(_) => return None,
        };
        // A buffer of the host has none: two of its names may stand for one buffer.
        let memory = allocation(plan, id)?;
        let mut before = pass.accesses.iter().filter(|access| access.step < index);
        let is_used = before.any(|access| allocation(plan, access.resource) == Some(memory));
        if is_used || !matches!(plan.resource(id).kind, ResourceKind::Buffer(_)) {
            return None;
        }
        cleared.push(memory);
    }
    Some(cleared)
}

/// Returns the index of the allocation that holds a resource; with two versions both have one.
fn allocation(plan: &Plan, id: ResourceId) -> Option<usize> {
    let base = match plan.resource(id).origin {
        Origin::Previous(base) => base,
        _ => id,
    };
    plan.schedule().aliases.of.get(&base).copied()
}
