//! Runs graphs on a GPU, times them, and judges them against the reference. The results are plain
//! data of the types in `records`.
//!
//! ```no_run
//! use skiagraph_compare::{
//!     graphs::{method::{Method, load_one}, planning::Capabilities},
//!     measuring::{device::{self, GpuRequest}, frame},
//!     sink::{Session, Silent},
//! };
//! use skiagraph_passes::{EmbeddedSources, SceneProvider};
//!
//! # async fn wrong(mut provider: SceneProvider) -> Result<(), Box<dyn std::error::Error>> {
//! let (preset, params) = load_one("nsm", &[], Some(1024), &EmbeddedSources)?;
//! let gpu = device::open(&GpuRequest::default(), [&preset.graph])?;
//! let method = Method::new(preset, params).settled(gpu.device.features());
//! let plan = method.plan([512, 512], Capabilities::new(&gpu), &provider)?;
//! let session = Session::new(&gpu, &Silent);
//! let (contents, _) = frame::render(session, plan, &mut provider, &["visibility"]).await?;
//! println!("{:?}", contents["visibility"].size());
//! # Ok(())
//! # }
//! ```

pub mod abilities;
pub mod camera_pose;
pub mod cell;
pub mod date;
pub mod device;
mod diagnostics;
pub mod frame;
pub mod frame_sequence;
pub mod ground_truth;
pub mod guarantee;
pub mod hard_case;
pub mod hard_cases;
mod hint;
pub mod many_machines;
pub mod poison;
pub mod profiling;
pub mod resume;
mod run;
pub mod scene_folders;
mod scene_motion;
mod search;
mod sequence;
pub mod series;
mod steady;
mod stop;
mod store;
mod timing;
mod trial;
mod truth_folder;
pub mod tune;
pub mod view_or_path;
mod view_warnings;
