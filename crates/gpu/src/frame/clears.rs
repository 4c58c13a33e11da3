//! Clears of buffers that may run ahead of other passes.

use skiagraph_graph::{LinkedPass, Origin, Plan, ResourceId, ResourceKind, step::Step};

/// Returns for each pass of the schedule a position that its clears may be moved to: no step
/// between there and the clears uses memory that they clear, and no pass there has the result
/// `None`. The position is 0 for a pass without clears; `None` stands for a pass with other steps
/// than dispatches and clears of the plan's buffers, or with a clear of memory that one of its
/// steps before uses.
pub(super) fn earliest(plan: &Plan) -> Vec<Option<usize>> {
    let passes = &plan.schedule().passes;
    let mut positions: Vec<Option<usize>> = Vec::new();
    for (at, &pass) in passes.iter().enumerate() {
        let earliest = cleared(plan, plan.pass(pass)).map(|cleared| {
            let is_cleared = |id| {
                let mut cleared = cleared.iter();
                cleared.any(|it| share(plan, *it, id)) || is_import(plan, id)
            };
            let uses = |before: &LinkedPass| {
                let mut used = before.accesses.iter();
                used.any(|access| is_cleared(access.resource))
            };
            let mut before = passes[..at].iter().zip(&positions);
            let stops = |(&pass, place): (_, &Option<_>)| place.is_none() || uses(plan.pass(pass));
            let last = (!cleared.is_empty()).then(|| before.rposition(stops));
            last.flatten().map_or(0, |last| last + 1)
        });
        positions.push(earliest);
    }
    positions
}

/// Returns the buffers that a pass clears before other steps of it use their memory; `None` if it
/// has other steps than dispatches and such clears of the plan's buffers.
fn cleared(plan: &Plan, pass: &LinkedPass) -> Option<Vec<ResourceId>> {
    let mut cleared = Vec::new();
    for (index, step) in pass.steps.iter().enumerate() {
        let id = match step {
            Step::Dispatch(_) => continue,
            Step::Clear { target, .. } => target.id,
            Step::Draw(_) | Step::Copy { .. } | Step::Cpu(_) => return None,
        };
        // A buffer of the host has no allocation: two of its names may stand for one buffer.
        plan.schedule().aliases.of.get(&id)?;
        let mut before = pass.accesses.iter().filter(|access| access.step < index);
        let is_used = before.any(|access| share(plan, id, access.resource));
        if is_used || !matches!(plan.resource(id).kind, ResourceKind::Buffer(_)) {
            return None;
        }
        cleared.push(id);
    }
    Some(cleared)
}

/// True for a buffer that the host hands in. It may be any other one, such as the buffer of an
/// output of the frame before.
fn is_import(plan: &Plan, id: ResourceId) -> bool {
    let resource = plan.resource(id);
    resource.origin == Origin::Host && matches!(resource.kind, ResourceKind::Buffer(_))
}

/// True if two resources, or those that they are the `.previous` of, have bytes in common.
fn share(plan: &Plan, a: ResourceId, b: ResourceId) -> bool {
    let base = |id| match plan.resource(id).origin {
        Origin::Previous(base) => base,
        _ => id,
    };
    plan.schedule().aliases.overlap(base(a), base(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use skiagraph_graph::{Graph, MemorySources, NoProvider, PlanRequest, Registry};

    #[test]
    fn clears_move_ahead_of_passes_that_do_not_use_their_memory() {
        let pass = |name: &str, more: &str, bind: &str| {
            let dispatch = "dispatch: Groups(1, 1, 1)";
            format!("Compute(name: \"{name}\", {dispatch}, {more} bind: {{{bind}}}), ")
        };
        let set = |name: &str, out: &str| {
            let more = format!("shader: \"set\", clear: [\"{out}\"],");
            pass(name, &more, &format!("\"out\": \"{out}\""))
        };
        let passes = [
            set("first", "a"),
            pass("add", "clear: [\"b\"],", r#""input": "a", "out": "b""#),
            set("again", "a"),
            r#"Copy(name: "copy", from: "a", to: "d"), "#.to_owned(),
            set("last", "c"),
        ];
        let buffers = ["a", "b", "c", "d"].map(|it| format!("Buffer(name: \"{it}\", count: 1), "));
        let document = format!(
            "(format: 3, materials: [{}], passes: [{}], outputs: [\"a\", \"b\", \"c\", \"d\"])",
            buffers.concat(),
            passes.concat()
        );
        let shader = |globals: &str, value: &str| {
            format!(
                "{globals} var<storage, read_write> out: array<u32>;
                @compute @workgroup_size(1) fn main() {{ out[0] = {value}; }}"
            )
        };
        let input = "var<storage, read> input: array<u32>;";
        let sources = MemorySources::new([
            ("graph.ron", document),
            ("shaders/set.wgsl", shader("", "1u")),
            ("shaders/add.wgsl", shader(input, "input[0]")),
        ]);
        let graph = Graph::load("graph.ron", &Registry::standard(), &sources).unwrap();
        let plan = graph.plan(&PlanRequest::new([1, 1], &NoProvider)).unwrap();
        let names: Vec<_> = plan.live().map(|pass| pass.name.value.as_str()).collect();
        assert_eq!(names, ["first", "add", "again", "copy", "last"]);
        // `again` stays behind `add`, `last` behind the copy.
        let expected = [Some(0), Some(0), Some(2), None, Some(4)];
        assert_eq!(earliest(&plan), expected);
    }
}
