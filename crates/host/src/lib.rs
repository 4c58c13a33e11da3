#![doc = include_str!("../README.md")]
//!
//! The names that a host needs first are re-exported here; all others are in the modules. A program
//! with another library for matrices and vectors hands them over as arrays: vectors by `[x, y,
//! z].into()`, matrices by [`matrix`] and [`transform`]. [`graph`](skiagraph_graph#terms) and
//! [`passes`](skiagraph_passes#terms) explain the terms: document, plan, provider, preset.

pub use glam;
pub use naga;
pub use skiagraph_gpu as gpu;
pub use skiagraph_graph as graph;
pub use skiagraph_passes as passes;
pub use skiagraph_scene as scene;
pub use wgpu;

pub use skiagraph_gpu::{ExecuteError, Executor, Frame, FrameReport, Pipelines, Provider};
pub use skiagraph_graph::{
    Diagnostics, Graph, Import, MemorySources, ParamValue, Plan, PlanRequest, Registry, Sources,
};
pub use skiagraph_passes::{
    EmbeddedSources, Eye, SceneProvider, SceneView, load_unit_visibility, presets, registry,
};

/// Returns the matrix with these four columns, for [`Eye::new`](skiagraph_passes::Eye::new). It
/// multiplies column vectors, the convention of WGSL and glam: a translation is in the last column.
///
/// ```
/// let [x, y, z] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
/// let moved = [x, y, z, [5.0, 6.0, 7.0, 1.0]];
/// assert_eq!(skiagraph_host::matrix(moved).w_axis.x, 5.0);
/// ```
pub fn matrix(columns: [[f64; 4]; 4]) -> glam::DMat4 {
    glam::DMat4::from_cols_array_2d(&columns)
}

/// Returns the affine map of the matrix with these four columns, for
/// [`SceneProvider::set_transforms`](skiagraph_passes::SceneProvider::set_transforms). The matrix
/// multiplies column vectors: a translation is in the last column. Its last row must be 0, 0, 0, 1,
/// and is ignored.
///
/// ```
/// let [x, y, z] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
/// let moved = [x, y, z, [5.0, 6.0, 7.0, 1.0]];
/// assert_eq!(skiagraph_host::transform(moved).translation.x, 5.0);
/// ```
pub fn transform(columns: [[f64; 4]; 4]) -> glam::DAffine3 {
    let [x, y, z, w] = columns.map(|[x, y, z, _]| [x, y, z]);
    glam::DAffine3::from_cols_array_2d(&[x, y, z, w])
}
