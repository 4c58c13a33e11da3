//! Experimental features of wgpu. There is `unsafe` code here, in `pipelines/kept.rs` and in the
//! allocator of a test.

#![allow(unsafe_code)]

/// The experimental features whose use was reviewed. Devices are opened without the others.
pub(crate) const REVIEWED: wgpu::Features = wgpu::Features::EXPERIMENTAL_RAY_QUERY;

/// Returns the token that opens a device with these features.
pub(crate) fn token(features: wgpu::Features) -> wgpu::ExperimentalFeatures {
    if !features.intersects(wgpu::Features::all_experimental_mask()) {
        return wgpu::ExperimentalFeatures::disabled();
    }
    // SAFETY: `enabled` has no invariant of its own. Its caller has to accept that wgpu's
    // experimental features may still hold bugs that safe code can reach, and to report them. That
    // is accepted for `REVIEWED` alone, which is all that `device::open_with` asks for; what is
    // done with it here is what wgpu 30 does check:
    // - An acceleration structure is used only after it was built: wgpu-core validates at
    //   submission that what is bound has been built, and that each BLAS of a TLAS is older than
    //   it.
    // - Vertices and indices of a build lie within their buffers (validated), and indices within
    //   the vertices: wgpu does not see that, so `SceneProvider` looks at each index of every mesh
    //   before it builds.
    // - A shader asks a query only between `rayQueryInitialize` and its end, with a finite origin
    //   and direction and 0 ≤ t_min ≤ t_max: what naga writes checks all of these as the shader
    //   runs, and leaves the query empty otherwise (`ray_query_initialization_tracking`, which only
    //   the unsafe `create_shader_module_trusted` can turn off).
    unsafe { wgpu::ExperimentalFeatures::enabled() }
}
