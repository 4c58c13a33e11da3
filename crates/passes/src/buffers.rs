//! Uploaded buffers by name, each with the version of its content.

use crate::recorded::{Command, Commands, Kernels, Recorded};
use crate::{built::Work, error::Error, lights, names::*};
use skiagraph_gpu::{ExecuteError, ProviderError};
use std::{collections::BTreeMap, ops::Range, sync::Arc};
use wgpu::util::{BufferInitDescriptor, DeviceExt};

/// How buffers of a resource are made, and how many are kept.
#[derive(Clone, Copy)]
pub(crate) enum Held {
    Storage,
    /// Storage that acceleration structures are built of.
    Traced,
    /// A hierarchy in light space: those of lights that take turns are kept.
    OfLight,
    /// A uniform, for callers that want a buffer of it: executors keep their own.
    Uniform,
    /// A list of lights, or one of them.
    Lights,
}

/// Where to.
#[derive(Clone, Copy)]
pub(crate) struct On<'a> {
    pub device: &'a wgpu::Device,
    pub queue: &'a wgpu::Queue,
}

/// Buffers by the names of resources.
///
/// Writes of the queue come before all that is submitted later, so a frame that was encoded with
/// a buffer and not submitted yet would show what was set for another one. So where the provider
/// submits by itself, none is written again once it was handed out: another content is another
/// buffer, and where only some of it is other, the GPU copies the rest from the buffer before. In a
/// host's encoder, commands come between frames, and write [in place](Self::in_place). Of lists of
/// lights, the last contents are kept: lights that take turns find their own.
#[derive(Clone, Default)]
pub(crate) struct Buffers {
    resources: BTreeMap<&'static str, Held>,
    /// The last one was made last.
    held: BTreeMap<String, Vec<Content>>,
    /// Version of the mesh's shape that the lights were laid over.
    shape: u64,
    /// True if the GPU writes some items, so that none between those that are changed is written.
    pub keeps_gaps: bool,
    /// True if what is recorded comes into an encoder of the host, between the frames there: then
    /// the buffers that no clone shares are written where they are.
    pub in_place: bool,
    /// Bytes that were brought to the device so far.
    pub work: Work,
    recorded: Recorded,
}

/// A buffer with the version of its content.
#[derive(Clone)]
struct Content {
    buffer: wgpu::Buffer,
    version: u64,
    /// Handles of it count the clones of the list that have the buffer.
    owner: Arc<()>,
}

/// Items that a patch has written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Patched {
    /// All items, to a new buffer.
    All,
    /// Some items, to a copy of the buffer before.
    Some,
    /// No item: the buffer is that before.
    Nothing,
}

/// Items that are written apart although others are between them: a copy costs more than so many
/// bytes.
const GAP: usize = 4096;

impl Buffers {
    /// Creates the list for these resources, without any buffer.
    pub fn new(resources: impl Iterator<Item = (&'static str, Held)>) -> Self {
        Self {
            resources: resources.collect(),
            ..Self::default()
        }
    }

    /// Drops all buffers.
    pub fn clear(&mut self) {
        (self.held, self.shape, self.recorded) = Default::default();
        self.in_place = false;
    }

    fn held_as(&self, name: &str) -> Held {
        let name = lights::list_of(name).unwrap_or(name);
        self.resources.get(name).copied().unwrap_or(Held::Storage)
    }

    /// Makes a buffer as graphs and later contents need it.
    fn create(&self, name: &str, size: u64, device: &wgpu::Device) -> wgpu::Buffer {
        let features = device.features();
        let usage = match self.held_as(name) {
            Held::Uniform => wgpu::BufferUsages::UNIFORM,
            Held::Lights => wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::STORAGE,
            Held::Traced if features.contains(wgpu::Features::EXPERIMENTAL_RAY_QUERY) => {
                wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::BLAS_INPUT
            }
            Held::Storage | Held::Traced | Held::OfLight => wgpu::BufferUsages::STORAGE,
        };
        device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(name),
            size,
            usage: usage | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    }

    /// Drops what was laid over another shape of the mesh, but for hierarchies of parts, which the
    /// next ones are made from.
    pub fn lay_over(&mut self, shape: u64, is_parted: bool) {
        if self.shape != shape {
            self.shape = shape;
            let is_laid = |name: &str| {
                name == LIGHT
                    || name == LIGHT_SPACE_NODES && !is_parted
                    || lights::list_of(name) == Some(lights::LIGHTS)
            };
            self.held.retain(|name, _| !is_laid(name));
        }
    }

    /// The buffer of that name, if there is one whose content is of that version.
    pub fn get(&self, name: &str, version: u64) -> Option<&wgpu::Buffer> {
        let mut held = self.held.get(name)?.iter();
        let content = held.find(|content| content.version == version);
        content.map(|content| &content.buffer)
    }

    /// Marks the content of the buffer of that name that was made last, if there is one, as being
    /// of that version now.
    pub fn still_hold(&mut self, name: &str, version: u64) {
        if let Some(last) = self.held.get_mut(name).and_then(|held| held.last_mut()) {
            last.version = version;
        }
    }

    /// Makes the buffer of that name whose content is of a version the last one that was made;
    /// false if there is none.
    pub fn take_up(&mut self, name: &str, version: u64) -> bool {
        let Some(held) = self.held.get_mut(name) else {
            return false;
        };
        let at = held.iter().position(|content| content.version == version);
        if let Some(at) = at {
            held[at..].rotate_left(1);
        }
        at.is_some()
    }

    /// Drops the buffer of that name whose content is of a version, which another one has replaced.
    pub fn leave(&mut self, name: &str, version: u64, by: u64) {
        if let Some(held) = self.held.get_mut(name).filter(|_| version != by) {
            held.retain(|content| content.version != version);
        }
    }

    /// Makes the buffer of that name with these items, one zero item if there are none.
    pub fn make<T: bytemuck::NoUninit>(
        &mut self,
        name: &str,
        items: &[T],
        version: u64,
        on: On,
    ) -> Result<(), Error> {
        let append = |range: Range<usize>, to: &mut Vec<T>| to.extend_from_slice(&items[range]);
        self.fill(name, (items.len(), append), version, on)
    }

    /// Does what [`make`](Self::make) does with a number of items, of which a function appends
    /// those of a range.
    fn fill<T: bytemuck::NoUninit>(
        &mut self,
        name: &str,
        (count, items): (usize, impl Fn(Range<usize>, &mut Vec<T>)),
        version: u64,
        on: On,
    ) -> Result<(), Error> {
        /// Items that are brought at once, so that no list of all is made.
        const PIECE: usize = 4096;
        /// Bytes that wait in memory of their own until they are submitted.
        const STAGED: usize = 16 << 20;
        let stride = size_of::<T>();
        let bytes = (count.max(1) * stride) as u64;
        check_binding(name, bytes, on.device)?;
        let buffer = self.create(name, bytes, on.device);
        let mut piece = Vec::with_capacity(PIECE.min(count));
        // Nothing that was encoded reads it yet; without items it stays zero.
        let most = (STAGED / stride).max(1);
        for begin in (0..count).step_by(most) {
            let end = count.min(begin + most);
            let size = wgpu::BufferSize::new(((end - begin) * stride) as u64);
            let offset = (begin * stride) as u64;
            let view = size.and_then(|size| on.queue.write_buffer_with(&buffer, offset, size));
            let Some(mut view) = view else {
                continue;
            };
            for first in (begin..end).step_by(PIECE) {
                let range = first..end.min(first + PIECE);
                piece.clear();
                items(range.clone(), &mut piece);
                let mut to = view.slice(stride * (first - begin)..stride * (range.end - begin));
                to.copy_from_slice(bytemuck::cast_slice(&piece));
            }
            drop(view);
            if end < count {
                on.queue.submit([]);
            }
        }
        self.work.uploaded += bytes;
        self.hold(name, buffer, version);
        Ok(())
    }

    /// Submits what was recorded, behind what encoders of the host hold that is not known to have
    /// run.
    ///
    /// # Errors
    /// If the device refuses them; the buffers are then made anew when they are asked for.
    pub fn submit(&mut self, on: On) -> Result<(), Error> {
        let commands = self.recorded.open();
        self.recorded.next = Commands::default();
        if commands.list.is_empty() {
            return Ok(());
        }
        let label = Some("changed items");
        let begun = wgpu::CommandEncoderDescriptor { label };
        let submit = || {
            let mut encoder = on.device.create_command_encoder(&begun);
            commands.record(&mut encoder);
            on.queue.submit([encoder.finish()]);
        };
        let submitted = refused(on.device, submit);
        submitted.map_err(|why| {
            let names = commands.names;
            names.iter().for_each(|name| self.forget(name));
            Error::Copies { names, why }
        })
    }

    /// Records what was recorded into an encoder of the host.
    ///
    /// # Errors
    /// Those of [`follow`](Self::follow).
    pub fn record_into(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        device: &wgpu::Device,
    ) -> Result<(), ProviderError> {
        self.recorded.next.record(encoder);
        if self.recorded.next.list.is_empty() {
            return Ok(());
        }
        self.follow(encoder, device)
    }

    /// Keeps what was recorded into an encoder of the host until that is known to have run, or
    /// follows the encoder where nothing was.
    ///
    /// # Errors
    /// If the device refuses the buffers by which it tells that; the buffers that were to be
    /// written are then made anew when they are asked for.
    pub fn follow(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        device: &wgpu::Device,
    ) -> Result<(), ProviderError> {
        let commands = std::mem::take(&mut self.recorded.next);
        let names = commands.names.clone();
        let kept = self.recorded.in_encoders.keep(commands, device, encoder);
        kept.map_err(|error| {
            names.iter().for_each(|name| self.forget(name));
            ProviderError::from_error(error)
        })
    }

    /// True if encoders of the host hold commands that are not known to have run.
    pub fn is_open(&self) -> bool {
        self.recorded.is_open()
    }

    /// Records once more what was in encoders of the host that were dropped, or submitted in
    /// another order; returns true if there is any. Buffers whose commands were lost twice, such as
    /// those that wgpu refuses, are made anew.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn record_lost(&mut self, device: &wgpu::Device) -> Result<bool, ExecuteError> {
        /// Encoders that are followed at most.
        const MOST: usize = 256;
        let Recorded { in_encoders, .. } = &mut self.recorded;
        let mut lost = in_encoders.lost(device)?;
        if in_encoders.iter().count() > MOST {
            lost.splice(..0, in_encoders.take());
        }
        if !lost.is_empty() {
            let mut again: Commands = lost.into_iter().collect();
            if again.is_again {
                again.names.iter().for_each(|name| self.forget(name));
                again = Commands::default();
            }
            again.is_again = !again.list.is_empty();
            let next = std::mem::take(&mut self.recorded.next);
            self.recorded.next = [again, next].into_iter().collect();
            self.recorded.is_lost = true;
        }
        Ok(std::mem::take(&mut self.recorded.is_lost))
    }

    /// Keeps a buffer as the last one of that name.
    fn hold(&mut self, name: &str, buffer: wgpu::Buffer, version: u64) {
        let most = match self.held_as(name) {
            Held::Storage | Held::Traced | Held::Uniform => 1,
            Held::OfLight => 4,
            Held::Lights => 16,
        };
        let held = self.held.entry(name.to_owned()).or_default();
        let content = Content {
            buffer,
            version,
            owner: Arc::default(),
        };
        remember(held, content, most);
    }

    /// Returns the buffer of that name that was made last.
    fn last(&self, name: &str) -> Option<&Content> {
        self.held.get(name)?.last()
    }

    /// Returns the version of the content of the buffer of that name that was made last.
    pub fn version(&self, name: &str) -> Option<u64> {
        self.last(name).map(|last| last.version)
    }

    /// Returns a buffer of that size that begins with the content of the one that was made last,
    /// and may be written: that one itself, or a copy.
    fn successor(&mut self, name: &str, size: u64, on: On) -> Option<wgpu::Buffer> {
        let last = self.last(name)?;
        let is_own = Arc::strong_count(&last.owner) == 1;
        if self.in_place && is_own && last.buffer.size() == size {
            return Some(last.buffer.clone());
        }
        let Content {
            buffer: last,
            version,
            owner,
        } = last.clone();
        let buffer = self.create(name, size, on.device);
        self.work.copied += last.size();
        self.copy([(&last, 0), (&buffer, 0)], last.size());
        self.recorded.next.owners.push(owner);
        self.hold(name, buffer.clone(), version);
        Some(buffer)
    }

    fn copy(&mut self, [(from, begin), (to, at)]: [(&wgpu::Buffer, u64); 2], size: u64) {
        let copy = Command::Copy([(from.clone(), begin), (to.clone(), at)], size);
        self.recorded.next.list.push(copy);
    }

    /// Records kernels that write the buffer of that name.
    pub fn run(&mut self, name: &str, record: Arc<Kernels>) {
        self.recorded.next.names.push(name.to_owned());
        self.recorded.next.list.push(Command::Kernels(record));
    }

    /// Does what [`patch`](Self::patch) does, with items that are there as a list.
    pub fn patch_list<T: bytemuck::NoUninit>(
        &mut self,
        name: &str,
        items: &[T],
        changed: &[Range<usize>],
        version: u64,
        on: On,
    ) -> Result<Patched, Error> {
        let append = |range: Range<usize>, to: &mut Vec<T>| to.extend_from_slice(&items[range]);
        self.patch(name, (items.len(), changed), append, version, on)
    }

    /// Makes the buffer of that name with some items of the one that there is, and these at the
    /// `changed` ranges: `items` appends those of a range of all `count`.
    pub fn patch<T: bytemuck::NoUninit>(
        &mut self,
        name: &str,
        (count, changed): (usize, &[Range<usize>]),
        items: impl Fn(Range<usize>, &mut Vec<T>),
        version: u64,
        on: On,
    ) -> Result<Patched, Error> {
        let stride = size_of::<T>();
        let gap = if self.keeps_gaps { 1 } else { GAP / stride };
        let ranges = joined(changed, gap);
        let written: usize = ranges.iter().map(Range::len).sum();
        let size = (count * stride) as u64;
        let is_there = self
            .last(name)
            .is_some_and(|last| last.buffer.size() == size);
        if written == 0 && is_there {
            self.still_hold(name, version);
            return Ok(Patched::Nothing);
        }
        if !is_there || 2 * written > count {
            self.fill(name, (count, items), version, on)?;
            return Ok(Patched::All);
        }
        let mut content = Vec::with_capacity(written);
        for range in &ranges {
            items(range.clone(), &mut content);
        }
        self.succeed(name, (count, &ranges, &content), version, on);
        Ok(Patched::Some)
    }

    /// Makes the buffer of that name with these items, of which the first ones are those of the one
    /// that there is.
    pub fn extend<T: bytemuck::NoUninit>(
        &mut self,
        name: &str,
        items: &[T],
        version: u64,
        on: On,
    ) -> Result<(), Error> {
        let last = self.last(name).map(|last| last.buffer.size());
        // One item may stand for none.
        let count = last.map_or(0, |size| size as usize / size_of::<T>());
        if count <= 1 || count > items.len() {
            return self.make(name, items, version, on);
        }
        if count == items.len() {
            self.still_hold(name, version);
            return Ok(());
        }
        check_binding(name, size_of_val(items) as u64, on.device)?;
        let (range, content) = (count..items.len(), &items[count..]);
        let changed = (items.len(), std::slice::from_ref(&range), content);
        self.succeed(name, changed, version, on);
        Ok(())
    }

    /// Makes the buffer that follows the last one: of `count` items, of which `content` has those
    /// in `ranges`.
    fn succeed<T: bytemuck::NoUninit>(
        &mut self,
        name: &str,
        (count, ranges, content): (usize, &[Range<usize>], &[T]),
        version: u64,
        on: On,
    ) {
        let stride = size_of::<T>();
        let Some(buffer) = self.successor(name, (count * stride) as u64, on) else {
            return;
        };
        self.recorded.next.names.push(name.to_owned());
        let (content, usage) = (bytemuck::cast_slice(content), wgpu::BufferUsages::COPY_SRC);
        let staging = upload(on.device, "changed items", content, usage);
        let mut from = 0;
        for range in ranges {
            let [to, size] = [range.start, range.len()].map(|items| (items * stride) as u64);
            self.copy([(&staging, from), (&buffer, to)], size);
            from += size;
        }
        self.work.uploaded += from;
        self.still_hold(name, version);
    }

    /// Drops what was made of that name.
    pub fn forget(&mut self, name: &str) {
        self.held.remove(name);
    }

    /// Makes the buffer of that name that was made last one that the GPU may write.
    pub fn renew(&mut self, name: &str, patched: Patched, on: On) -> Option<wgpu::Buffer> {
        let last = self.last(name)?.buffer.clone();
        match patched {
            Patched::Nothing => self.successor(name, last.size(), on),
            _ => Some(last),
        }
    }
}

/// Ranges in ascending order that hold all of `ranges`; those with less than `gap` between them are
/// one.
fn joined(ranges: &[Range<usize>], gap: usize) -> Vec<Range<usize>> {
    let ranges = ranges.iter().filter(|range| !range.is_empty());
    let mut ranges: Vec<Range<usize>> = ranges.cloned().collect();
    ranges.sort_unstable_by_key(|range| range.start);
    let mut joined: Vec<Range<usize>> = Vec::new();
    for range in ranges {
        match joined.last_mut() {
            Some(last) if range.start < last.end + gap => last.end = last.end.max(range.end),
            _ => joined.push(range),
        }
    }
    joined
}

/// Does something with a device, or returns why the device refuses it, if that is known at once: on
/// native platforms it is.
pub(crate) fn refused<T>(device: &wgpu::Device, act: impl FnOnce() -> T) -> Result<T, String> {
    let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let done = act();
    let mut outcome = std::pin::pin!(scope.pop());
    let mut context = std::task::Context::from_waker(std::task::Waker::noop());
    match outcome.as_mut().poll(&mut context) {
        std::task::Poll::Ready(Some(why)) => Err(why.to_string()),
        _ => Ok(done),
    }
}

/// Makes a buffer with a content.
pub(crate) fn upload(
    device: &wgpu::Device,
    label: &str,
    contents: &[u8],
    usage: wgpu::BufferUsages,
) -> wgpu::Buffer {
    device.create_buffer_init(&BufferInitDescriptor {
        label: Some(label),
        contents,
        usage,
    })
}

/// The most bytes that a storage buffer can have and be bound whole.
pub(crate) fn binding_limit(limits: &wgpu::Limits) -> u64 {
    let whole = limits.max_buffer_size;
    whole.min(limits.max_storage_buffer_binding_size)
}

/// Refuses a buffer of more bytes than a device binds.
pub(crate) fn check_binding(name: &str, bytes: u64, device: &wgpu::Device) -> Result<(), Error> {
    check_size(name, bytes, binding_limit(&device.limits()))
}

/// Refuses a buffer of more bytes than the limit.
pub(crate) fn check_size(name: &str, bytes: u64, limit: u64) -> Result<(), Error> {
    if bytes <= limit {
        return Ok(());
    }
    let name = name.to_owned();
    Err(Error::TooLarge { name, bytes, limit })
}
