//! Fills memory with a pattern before a resource is first used in a frame. A pass that reads
//! something unwritten then reads the pattern, so its outputs differ between two patterns.

use super::encode::clear_view;
use super::fetch::{MipCopy, mips};
use crate::buffer;
use crate::error::{ExecuteError, scoped};
use crate::memory::memory::{InFrame, Memory};
use crate::memory::physical::{PingPong, Versions};
use crate::pipelines::bind::Binder;
use crate::pipelines::handles::GpuAttachment;
use skiagraph_graph::{Origin, Plan, ResourceId, ResourceKind, SubresourceRange, Target, Texture};
use std::ops::Range;

/// Fills of the resources: the position in the schedule before which each is filled, and a fill for
/// each of its allocations.
pub(super) struct Poison {
    pattern: wgpu::Buffer,
    fills: Vec<(usize, ResourceId, Vec<Fill>)>,
}

/// How a resource is filled.
enum Fill {
    Buffer(wgpu::Buffer, Range<u64>),
    /// A texture with all layers of each mip.
    Texture(wgpu::Texture, Vec<MipCopy>),
    /// Attachments that nothing can be copied to are cleared: depths, and texels of several
    /// samples.
    Views(Vec<GpuAttachment>, wgpu::TextureFormat, [f64; 4]),
}

impl Fill {
    /// Bytes of the pattern that are needed.
    fn bytes(&self) -> u64 {
        match self {
            Self::Buffer(_, place) => place.end - place.start,
            Self::Texture(_, mips) => mips.iter().map(MipCopy::bytes).max().unwrap_or(0),
            Self::Views(..) => 0,
        }
    }

    fn encode(&self, pattern: &wgpu::Buffer, encoder: &mut wgpu::CommandEncoder) {
        match self {
            Self::Buffer(buffer, place) => {
                encoder.copy_buffer_to_buffer(pattern, 0, buffer, place.start, self.bytes());
            }
            Self::Texture(texture, mips) => {
                for copy in mips {
                    let (from, to) = (copy.in_buffer(pattern, 0), copy.in_texture(texture));
                    encoder.copy_buffer_to_texture(from, to, copy.size);
                }
            }
            Self::Views(views, format, value) => {
                for view in views {
                    clear_view(view, *format, *value, "pattern", encoder, None);
                }
            }
        }
    }
}

impl Poison {
    /// Returns the fills of a plan; `None` if it does not ask for a pattern. Resources that outlive
    /// the frame are not filled. Of two allocations, the one that the frame writes is filled, the
    /// one read as `.previous` is not.
    pub fn new(
        plan: &Plan,
        memory: &Memory,
        device: &wgpu::Device,
    ) -> Result<Option<Self>, ExecuteError> {
        let Some(byte) = plan.poison() else {
            return Ok(None);
        };
        let mut fills = Vec::new();
        for (&id, lifetime) in &plan.schedule().lifetimes {
            let is_kept = plan.schedule().conditions.kept.contains(&id);
            let outlives = is_kept && plan.versions(id) == 1;
            if plan.resource(id).origin != Origin::Own || outlives {
                continue;
            }
            let versions = (0..plan.versions(id)).map(|current| {
                let previous = current;
                let ping_pong = PingPong::from([(id, Versions { current, previous })]);
                let binder = Binder {
                    device,
                    frame: InFrame::new(plan, memory, &ping_pong),
                    discarded: &[],
                };
                fill(&binder, id, byte)
            });
            let versions: Vec<Option<Fill>> = versions.collect::<Result<_, _>>()?;
            fills.push((lifetime.first, id, versions.into_iter().flatten().collect()));
        }
        let each_fill = fills
            .iter()
            .flat_map(|(.., fills): &(_, _, Vec<Fill>)| fills);
        let most = each_fill.map(Fill::bytes).fold(4, u64::max);
        let pattern = scoped(device, "pattern", || {
            let (bytes, usage) = (vec![byte; most as usize], wgpu::BufferUsages::COPY_SRC);
            let failed = "the pattern could not be uploaded";
            buffer::filled(device, "pattern", &bytes, usage, failed)
        })??;
        Ok(Some(Self { pattern, fills }))
    }

    /// Fills the resources that the pass at position `at` is the first to use.
    pub fn fill(&self, at: usize, ping_pong: &PingPong, encoder: &mut wgpu::CommandEncoder) {
        for (_, id, fills) in self.fills.iter().filter(|(first, ..)| *first == at) {
            let current = ping_pong.get(id).map_or(0, |versions| versions.current);
            if let Some(fill) = fills.get(current) {
                fill.encode(&self.pattern, encoder);
            }
        }
    }
}

/// Returns the way to fill a resource with a byte; `None` if it has no bytes.
fn fill(binder: &Binder<'_>, id: ResourceId, byte: u8) -> Result<Option<Fill>, ExecuteError> {
    Ok(Some(match &binder.frame.plan.resource(id).kind {
        ResourceKind::Buffer(_) => {
            let part = SubresourceRange::WHOLE;
            let target = Target { id, part };
            let (buffer, place) = binder.frame.bytes(&target)?;
            Fill::Buffer(buffer.clone(), place)
        }
        ResourceKind::Texture(texture) => {
            let part = texture.whole();
            if texture.format.is_depth_stencil_format() || texture.samples > 1 {
                let views = binder.single_views(&Target { id, part })?;
                let value = cleared_to(texture, byte);
                return Ok(Some(Fill::Views(views, texture.format, value)));
            }
            Fill::Texture(binder.frame.texture(id)?.clone(), mips(texture, &part))
        }
        _ => return Ok(None),
    }))
}

/// Returns the clear value that stands for a byte; the second number is for stencils.
fn cleared_to(texture: &Texture, byte: u8) -> [f64; 4] {
    let (whole, share) = (f64::from(byte), f64::from(byte) / 255.0);
    match texture.format.sample_type(None, None) {
        _ if texture.format.is_depth_stencil_format() => [share, whole, 0.0, 0.0],
        Some(wgpu::TextureSampleType::Uint | wgpu::TextureSampleType::Sint) => [whole; 4],
        _ => [share; 4],
    }
}
