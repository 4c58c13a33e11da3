//! Describes textures and buffers of the host program for
//! [`PlanRequest::imports`](skiagraph_graph::PlanRequest::imports), which the host later sets in
//! the executor under the same names. Samplers are described by [`Import::sampler`].
//!
//! ```no_run
//! use skiagraph_gpu::{Executor, device::Gpu, import};
//! use skiagraph_graph::{Graph, NoProvider, PlanRequest};
//!
//! # type Done = Result<(), Box<dyn std::error::Error>>;
//! # fn executor(graph: &Graph, gpu: &Gpu, depth: wgpu::Texture) -> Done {
//! // `graph` has `inputs: [Texture(name: "depth")]`.
//! let mut request = PlanRequest::new([1024, 768], &NoProvider);
//! request.limits = gpu.device.limits();
//! request.imports.insert("depth".into(), import::texture(&depth));
//! let plan = graph.plan(&request)?;
//! let mut executor = Executor::new(&gpu.device, &gpu.queue, plan, &mut NoProvider)?;
//! executor.import_texture("depth", &depth)?;
//! # Ok(())
//! # }
//! ```

use skiagraph_graph::Import;

/// Returns the description of a texture that the host will hand over with
/// [`Executor::import_texture`](crate::Executor::import_texture): its format, size, mips, layers,
/// samples and usages.
pub fn texture(texture: &wgpu::Texture) -> Import {
    Import::texture(&wgpu::TextureDescriptor {
        label: None,
        size: texture.size(),
        mip_level_count: texture.mip_level_count(),
        sample_count: texture.sample_count(),
        dimension: texture.dimension(),
        format: texture.format(),
        usage: texture.usage(),
        view_formats: &[],
    })
}

/// Returns the description of a buffer that the host will hand over with
/// [`Executor::import_buffer`](crate::Executor::import_buffer): its size in bytes and usages.
/// `items` is the number of array items that it holds; `None` is enough unless a pass of the graph
/// is dispatched over the items or uses their number.
pub fn buffer(buffer: &wgpu::Buffer, items: Option<u64>) -> Import {
    Import::buffer(buffer.size(), items, buffer.usage())
}
