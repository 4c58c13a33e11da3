//! Pipeline statistics of frames: how often the shaders of each pass ran.

use super::read_buffer::ReadBuffer;
use crate::buffer;
use crate::error::{ExecuteError, scoped};
use skiagraph_graph::{Plan, step::Step};
use std::{cell::Cell, mem::size_of, ops::Range, sync::Arc};

/// Number of shader runs of one pass in one frame, summed over its draws and dispatches, as the
/// device counted them. Only the first 4096 draws and dispatches of a frame are counted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct PassStatistics {
    /// Name of the pass, as in [`PassSummary::name`](skiagraph_graph::PassSummary::name).
    pub name: String,
    /// Runs of vertex shaders. A device may run the shader once for a vertex that several triangles
    /// share.
    pub vertices: u64,
    /// Primitives that remained after clipping. Clipping may cut a primitive into several, each of
    /// which counts.
    pub primitives: u64,
    /// Runs of fragment shaders. A device may count helper invocations as well.
    pub fragments: u64,
    /// Runs of compute shaders: all threads of every workgroup, including those in the last
    /// workgroup that have no item to work on.
    pub threads: u64,
}

/// Counted quantities: wgpu writes one u64 for each, in this order.
const COUNTED: wgpu::PipelineStatisticsTypes =
    wgpu::PipelineStatisticsTypes::VERTEX_SHADER_INVOCATIONS
        .union(wgpu::PipelineStatisticsTypes::CLIPPER_PRIMITIVES_OUT)
        .union(wgpu::PipelineStatisticsTypes::FRAGMENT_SHADER_INVOCATIONS)
        .union(wgpu::PipelineStatisticsTypes::COMPUTE_SHADER_INVOCATIONS);

/// Bytes of a query.
const BYTES: u64 = 4 * size_of::<u64>() as u64;

/// Counters of frames, one after another, with a query for each draw and dispatch.
pub(crate) struct Counters {
    set: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    staging: ReadBuffer,
    count: u32,
    used: Cell<u32>,
    passes: Vec<(Arc<str>, Range<u32>)>,
}

impl Counters {
    /// Creates the counters for the frames of a plan; `None` if the device does not count.
    pub fn new(plan: &Plan, device: &wgpu::Device) -> Result<Option<Self>, ExecuteError> {
        let steps = plan.live().flat_map(|pass| &pass.steps);
        let counted = steps.filter(|step| matches!(step, Step::Draw(_) | Step::Dispatch(_)));
        // Passes beyond that are not counted.
        let count = counted.take(wgpu::QUERY_SET_MAX_QUERIES as usize).count() as u32;
        let features = device.features();
        if count == 0 || !features.contains(wgpu::Features::PIPELINE_STATISTICS_QUERY) {
            return Ok(None);
        }
        let name = "pipeline statistics";
        let bytes = u64::from(count) * BYTES;
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        let staging = ReadBuffer::new(device, name, name, bytes)?;
        let make = || Self {
            set: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some(name),
                ty: wgpu::QueryType::PipelineStatistics(COUNTED),
                count,
            }),
            resolved: buffer::make(device, name, bytes, usage),
            staging,
            count,
            used: Cell::new(0),
            passes: Vec::new(),
        };
        scoped(device, name, make).map(Some)
    }

    /// Returns the query set and the index of the next query; `None` if all queries are used.
    pub fn next(&self) -> Option<(&wgpu::QuerySet, u32)> {
        let index = self.used.get();
        (index < self.count).then(|| {
            self.used.set(index + 1);
            (&self.set, index)
        })
    }

    /// Returns the number of queries used so far.
    pub fn used(&self) -> u32 {
        self.used.get()
    }

    /// Assigns the queries from index `first` on to a pass.
    pub fn pass(&mut self, name: Arc<str>, first: u32) {
        self.passes.push((name, first..self.used.get()));
    }

    /// Encodes the copy of the counts, which are mapped when the encoder is submitted.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        let used = self.used.get();
        if used > 0 {
            encoder.resolve_query_set(&self.set, 0..used, &self.resolved, 0);
            let bytes = u64::from(used) * BYTES;
            encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.staging.buffer, 0, bytes);
        }
        self.staging.map(encoder);
    }

    /// True until the mapping of the counts is known to be done or refused.
    pub fn is_being_mapped(&self) -> bool {
        self.staging.is_being_mapped()
    }

    /// Returns the counts of a finished frame, in the order of its passes.
    pub fn take(&mut self) -> Result<Vec<PassStatistics>, ExecuteError> {
        let failed = || ExecuteError::Readback {
            name: "pipeline statistics".to_owned(),
        };
        if self.is_being_mapped() {
            return Err(failed());
        }
        let word = |word: &[u8; 8]| u64::from_ne_bytes(*word);
        let words = self
            .staging
            .take(|bytes| bytes.as_chunks().0.iter().map(word).collect());
        let words: Vec<u64> = words.ok_or_else(failed)?;
        let sum = |queries: &Range<u32>, at: usize| -> u64 {
            let queries = queries.clone();
            queries.map(|query| words[4 * query as usize + at]).sum()
        };
        let passes = self.passes.iter().map(|(name, queries)| PassStatistics {
            name: name.to_string(),
            vertices: sum(queries, 0),
            primitives: sum(queries, 1),
            fragments: sum(queries, 2),
            threads: sum(queries, 3),
        });
        Ok(passes.collect())
    }
}
