//! Commands that write the buffers of a scene, kept until they are known to have run.

use skiagraph_gpu::Recordings;
use std::sync::Arc;

/// Records kernels.
pub(crate) type Kernels = dyn Fn(&mut wgpu::CommandEncoder) + Send + Sync;

/// A command that writes a buffer; to do it once more changes nothing.
#[derive(Clone)]
pub(crate) enum Command {
    /// Bytes of one buffer, from an offset, to another one, to an offset; how many.
    Copy([(wgpu::Buffer, u64); 2], u64),
    Kernels(Arc<Kernels>),
}

/// Commands, and the names of the buffers that they write.
#[derive(Clone, Default)]
pub(crate) struct Commands {
    pub list: Vec<Command>,
    pub names: Vec<String>,
    /// Owners of buffers that they copy, which clones of the list must not write until then.
    pub owners: Vec<Arc<()>>,
    /// True if some of them were recorded before, and lost.
    pub is_again: bool,
}

/// Commands that are submitted together, and those that are in encoders of the host. A clone, which
/// shares the buffers, has all of them to record: it does not hear whether they have run.
#[derive(Default)]
pub(crate) struct Recorded {
    pub next: Commands,
    pub in_encoders: Recordings<Commands>,
    /// True in a clone with commands that executors may take for run.
    pub is_lost: bool,
}

impl Clone for Recorded {
    fn clone(&self) -> Self {
        Self {
            next: self.open(),
            in_encoders: Recordings::default(),
            is_lost: self.is_open(),
        }
    }
}

impl Recorded {
    /// True if encoders of the host hold commands that are not known to have run.
    pub fn is_open(&self) -> bool {
        self.is_lost || self.in_encoders.iter().next().is_some()
    }

    /// Returns all commands that are not known to have run.
    pub fn open(&self) -> Commands {
        let in_encoders = self.in_encoders.iter();
        in_encoders.chain([&self.next]).cloned().collect()
    }
}

/// Each behind the one before.
impl FromIterator<Self> for Commands {
    fn from_iter<T: IntoIterator<Item = Self>>(each: T) -> Self {
        each.into_iter().fold(Self::default(), |mut joined, later| {
            joined.list.extend(later.list);
            joined.names.extend(later.names);
            joined.owners.extend(later.owners);
            joined.is_again |= later.is_again;
            joined
        })
    }
}

impl Commands {
    /// Records the commands into an encoder.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        for command in &self.list {
            match command {
                Command::Copy([(from, begin), (to, at)], size) => {
                    encoder.copy_buffer_to_buffer(from, *begin, to, *at, *size);
                }
                Command::Kernels(record) => record(encoder),
            }
        }
    }
}
