//! Messages between the window and the thread that runs the graphs: the desired state, and the
//! frames that show it.

use crate::ground_truth::Question;
use skiagraph_compare::graphs::method::ParamValues;
use skiagraph_compare::measuring::frame::Contents;
use skiagraph_compare::pictures::save::Decoding;
use skiagraph_gpu::PassStatistics;
use skiagraph_graph::{Capture, Param, ParamValue};
use skiagraph_reference::GroundTruthPixels;
use skiagraph_scene::{Scene, View};
use std::{collections::BTreeMap, sync::Arc};

/// Request of the window to the thread that runs the graphs: scene, view and methods to show.
#[derive(Clone, Debug, PartialEq)]
pub struct DesiredState {
    /// Name of the scene, as on the command line.
    pub scene: String,
    /// Camera and light to show the scene with; `None` for the scene's first view. The light is the
    /// scene's if the view has none.
    pub view: Option<View>,
    /// Width and height of each method's picture in pixels.
    pub size: [u32; 2],
    /// Methods to run, from left to right: one or two.
    pub methods: Vec<DesiredMethod>,
    /// True to run every pass, even if its inputs have not changed.
    pub all_passes: bool,
    /// Counter that the window increases to get another frame of the same state.
    pub frame: u64,
}

/// A method of the desired state, with its settings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DesiredMethod {
    /// Name of a preset, or path of a graph.
    pub name: String,
    /// Values of the params that were set; all others have their defaults.
    pub params: ParamValues,
    /// A material to read back, at the end of the frame or after a pass, besides the outputs;
    /// `None` for outputs only.
    pub material: Option<Capture>,
}

/// Messages from the thread that runs the graphs to the window.
pub enum Event {
    /// The scene of this name was loaded, or could not be loaded; the error is text for the user.
    Scene(String, Result<Loaded, String>),
    /// A frame of each method of the desired state.
    Frame(Box<FrameSnapshot>),
    /// The desired state cannot be drawn, for example since the GPU cannot be opened again; the
    /// text for the user is the reason.
    Broken(String),
}

/// A loaded scene with its views.
#[derive(Clone)]
pub struct Loaded {
    /// The scene.
    pub scene: Arc<Scene>,
    /// Views to choose from; the first one is shown first.
    pub views: Vec<View>,
}

/// A frame of each method for one desired state.
pub struct FrameSnapshot {
    /// The desired state that the frame shows.
    pub desired: DesiredState,
    /// Question to the reference ray tracer about this frame: its scene, camera, light and visible
    /// primitives.
    pub question: Question,
    /// Classes of the pixels as if nothing cast shadows: lit wherever the surface faces the light.
    pub facing: Arc<GroundTruthPixels>,
    /// A frame of each method, in the order of the desired state.
    pub methods: Vec<MethodSnapshot>,
}

/// A frame of one method, with its passes and read-back contents.
#[derive(Clone, Default)]
pub struct MethodSnapshot {
    /// Name of the method in the desired state.
    pub name: String,
    /// The method's description in its document.
    pub description: String,
    /// Params that the method's document declares.
    pub params: Vec<Param>,
    /// Value of each param, by name.
    pub values: BTreeMap<String, ParamValue>,
    /// The passes of the plan in the order in which they run, without those whose results are not
    /// needed.
    pub passes: Vec<PassSnapshot>,
    /// Bytes of the textures and buffers that the graph makes, then bytes that sharing memory among
    /// them saves.
    pub memory: [u64; 2],
    /// GPU time of the frame in milliseconds; `None` without timestamps that can be trusted.
    pub gpu_ms: Option<f64>,
    /// Time from the begin of encoding to the end of the frame in milliseconds.
    pub wall_ms: f64,
    /// Contents of the outputs and materials that were read back, by name.
    pub contents: Arc<Contents>,
    /// Layer of the visibility that holds the answer for the frame's light; `None` if the method
    /// answers for other lights alone.
    pub layer: Option<usize>,
    /// Decoding of each content, by name: how depths and buffer items become numbers.
    pub readings: BTreeMap<String, Decoding>,
    /// Errors for the user: the reason why the desired state could not be planned or run (the frame
    /// then shows the last state that could), or mistakes in the method's files. `None` without
    /// errors.
    pub error: Option<String>,
    /// Number of times that the method has been read from its files so far.
    pub reads: u64,
}

/// A pass of a method's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct PassSnapshot {
    /// Full name of the pass.
    pub name: String,
    /// Kind of the pass, as documents write it.
    pub kind: String,
    /// Names of the materials that the pass writes.
    pub writes: Vec<String>,
    /// True if the pass did not run in this frame because its inputs had not changed.
    pub skipped: bool,
    /// GPU time of the pass in milliseconds; `None` if it did not run or was not timed.
    pub gpu_ms: Option<f64>,
    /// Numbers of shader invocations of the pass; `None` if it did not run or the adapter does not
    /// count them.
    pub statistics: Option<PassStatistics>,
}
