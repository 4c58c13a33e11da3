//! Frames before which nothing has changed: the outputs of an earlier frame are still there, and no
//! pass need run.

use crate::signal::{Progress, Signal};
use skiagraph_graph::{Origin, Plan, ResourceId};

/// Tells whether a plan's next frame would compute nothing new.
pub(super) struct Idle {
    /// True if each frame computes the same until the host makes or reports a change.
    repeats: bool,
    /// Number of these changes.
    changes: u64,
    /// Number of changes before the frame that `done` follows; `None` before the first one.
    followed: Option<u64>,
    done: Signal,
}

impl Idle {
    pub fn new(plan: &Plan) -> Self {
        Self {
            repeats: repeats(plan),
            changes: 0,
            followed: None,
            done: Signal::default(),
        }
    }

    /// Returns the number of changes that were noted.
    pub fn changes(&self) -> u64 {
        self.changes
    }

    /// Notes that the host has made or reported a change.
    pub fn note_change(&mut self) {
        self.changes += 1;
    }

    /// True if the GPU is done with a frame since which nothing has changed. One whose encoder was
    /// dropped is never done.
    pub fn is_settled(&self) -> bool {
        self.followed == Some(self.changes) && self.done.progress() == Progress::Done
    }

    /// Follows a frame that was encoded, unless an earlier one is not done.
    pub fn follow(&mut self, encoder: &wgpu::CommandEncoder) {
        if self.repeats && self.done.progress() != Progress::UnderWay {
            self.followed = Some(self.changes);
            self.done.when_done(encoder);
        }
    }
}

/// True if each frame of a plan computes the same until the host makes or reports a change. A host
/// may write to its imports without a word.
fn repeats(plan: &Plan) -> bool {
    let mut live = plan.schedule().lifetimes.keys();
    let is_previous = |id: &ResourceId| matches!(plan.resource(*id).origin, Origin::Previous(_));
    !plan.remembers() && plan.imports().is_empty() && !live.any(is_previous)
}
