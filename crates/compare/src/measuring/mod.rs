//! Runs graphs on a GPU, times them, and judges them against the reference. What comes out is
//! plain data, in `records`.

pub mod camera_pose;
pub mod date;
pub mod device;
pub mod frame;
pub mod ground_truth;
pub mod guarantee;
pub mod hard_case;
pub mod mesh_frames;
pub mod poison;
pub mod profiling;
mod results_folder;
pub mod resume;
mod run;
mod sequence;
pub mod series;
mod steady;
mod stop;
mod timing;
pub mod view_or_path;
