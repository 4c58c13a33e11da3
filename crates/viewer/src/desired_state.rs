//! The desired state and the frames that come of it: the messages between the window and the thread
//! of the graphs.

use crate::ground_truth::Question;
use skiagraph_compare::graphs::method::ParamValues;
use skiagraph_compare::measuring::frame::Contents;
use skiagraph_compare::pictures::save::Decoding;
use skiagraph_gpu::PassStatistics;
use skiagraph_graph::{Capture, Param, ParamValue};
use skiagraph_reference::GroundTruthPixels;
use skiagraph_scene::{Scene, View};
use std::{collections::BTreeMap, sync::Arc};

/// The state that the window asks for.
#[derive(Clone, Debug, PartialEq)]
pub struct DesiredState {
    /// The scene, as on the command line.
    pub scene: String,
    /// From where, and under which light; `None`: the scene's first view.
    pub view: Option<View>,
    /// In how many pixels the methods run.
    pub size: [u32; 2],
    /// One, or two side by side.
    pub methods: Vec<DesiredMethod>,
    /// Run passes that have no reason to run, too.
    pub all_passes: bool,
    /// Counts up to ask for another frame of the same.
    pub frame: u64,
}

/// A method of the desired state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DesiredMethod {
    /// Preset or path.
    pub name: String,
    /// Params that are not at their defaults.
    pub params: ParamValues,
    /// A material besides the outputs.
    pub material: Option<Capture>,
}

/// Messages of the thread of the graphs.
pub enum Event {
    /// A scene was loaded, or could not be.
    Scene(String, Result<Loaded, String>),
    /// A frame.
    Frame(Box<FrameSnapshot>),
    /// Nothing more can be drawn.
    Broken(String),
}

/// A scene that is there.
#[derive(Clone)]
pub struct Loaded {
    /// The scene.
    pub scene: Arc<Scene>,
    /// Its views.
    pub views: Vec<View>,
}

/// A frame of each method.
pub struct FrameSnapshot {
    /// The state that it shows.
    pub desired: DesiredState,
    /// The question to the oracle about it: of this scene, camera, light and these primitives.
    pub question: Question,
    /// Which of the view's lights it is under.
    pub light_number: usize,
    /// Pixels that face the light, as if nothing stood in its way.
    pub facing: Arc<GroundTruthPixels>,
    /// One for each method.
    pub methods: Vec<MethodSnapshot>,
}

/// A frame of one method.
#[derive(Clone, Default)]
pub struct MethodSnapshot {
    /// The name in the desired state.
    pub name: String,
    /// The document's description of itself.
    pub description: String,
    /// The params that its document declares.
    pub params: Vec<Param>,
    /// The value of each.
    pub values: BTreeMap<String, ParamValue>,
    /// The live passes in their order.
    pub passes: Vec<PassSnapshot>,
    /// Bytes of the graph's own memory, and what sharing saved.
    pub memory: [u64; 2],
    /// GPU time of the frame, milliseconds.
    pub gpu_ms: Option<f64>,
    /// Time from the begin of encoding to the end of the frame, milliseconds.
    pub wall_ms: f64,
    /// Contents that were read back.
    pub contents: Arc<Contents>,
    /// How depths and buffers among it are to be read.
    pub readings: BTreeMap<String, Decoding>,
    /// Why it is not as desired: what is shown is the last that ran.
    pub error: Option<String>,
    /// How often it was read from its files.
    pub reads: u64,
}

/// A pass of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct PassSnapshot {
    /// Its name.
    pub name: String,
    /// Its kind, as documents write it.
    pub kind: String,
    /// The materials that it writes.
    pub writes: Vec<String>,
    /// True if it had no reason to run.
    pub skipped: bool,
    /// GPU time, milliseconds.
    pub gpu_ms: Option<f64>,
    /// How often its shaders ran, where the adapter counts.
    pub statistics: Option<PassStatistics>,
}
