//! Frames before which nothing has changed: the outputs of an earlier frame are still there, and no
//! pass need run.

use skiagraph_graph::{Origin, Plan, ResourceId};

/// Tells whether a plan's next frame would compute nothing new.
pub(super) struct Idle {
    /// True if each frame computes the same until the host makes or reports a change.
    repeats: bool,
    /// Number of these changes.
    pub changes: u64,
    /// Number of changes before the last frame that ran; `None` before the first one.
    pub settled: Option<u64>,
}

impl Idle {
    pub fn new(plan: &Plan) -> Self {
        Self {
            repeats: repeats(plan),
            changes: 0,
            settled: None,
        }
    }

    /// Notes that the host has made or reported a change.
    pub fn note_change(&mut self) {
        self.changes += 1;
    }

    /// True if a frame ran since which nothing has changed.
    pub fn is_settled(&self) -> bool {
        self.repeats && self.settled == Some(self.changes)
    }
}

/// True if each frame of a plan computes the same until the host makes or reports a change. What a
/// pass writes into an import of the host stays there, as in a material with `keep`.
fn repeats(plan: &Plan) -> bool {
    let mut live = plan.schedule().lifetimes.keys();
    let is_previous = |id: &ResourceId| matches!(plan.resource(*id).origin, Origin::Previous(_));
    let mut accesses = plan.live().flat_map(|pass| &pass.accesses);
    let is_of_host = |id| plan.resource(id).origin == Origin::Host;
    let writes_import = accesses.any(|access| access.writes && is_of_host(access.resource));
    !plan.remembers() && !writes_import && !live.any(is_previous)
}
