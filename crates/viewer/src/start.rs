//! Starts the viewer's threads and creates the state that shows their results.

use crate::desired_state::{DesiredMethod, DesiredState};
use crate::ground_truth::GroundTruthThread;
use crate::state::{Channels, Choices, Viewer};
use crate::worker::{Command, LoadScene, Worker, WorkerThread};
use skiagraph_compare::error::CompareError;
use skiagraph_compare::files::watch::{self, Watch};
use skiagraph_compare::graphs::argument::{Assignment, MethodArgument};
use skiagraph_compare::graphs::{method, openings, preset};
use skiagraph_compare::measuring::device::{self, GpuRequest};
use skiagraph_compare::sink::Sink;
use skiagraph_gpu::{block_on, timing::Trust};
use skiagraph_scene::SceneLibrary;
use std::collections::BTreeSet;
use std::sync::{Arc, mpsc};

/// Callback that makes the window call [`Viewer::update`]; the threads call it after each event or
/// answer.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// Methods, scene and settings with which [`open`](crate::open) opens the window.
pub struct Opening {
    /// One or two methods, each as the command line writes it: `PRESET[@PARAM=VALUE,…]`, with the
    /// name of a preset or the path of a graph document.
    pub methods: Vec<String>,
    /// Values of params that are set in every method, unless the method's own `@PARAM=VALUE` sets
    /// them.
    pub params: Vec<Assignment>,
    /// Width and height of the methods' shadow maps in texels; `None` for their defaults.
    pub map_size: Option<u32>,
    /// Width and height of the methods' pictures in pixels.
    pub size: [u32; 2],
    /// Name of the scene to show first, for [`load_scene`](Self::load_scene).
    pub scene: String,
    /// Function that loads the first scene, and scenes that the user chooses in the window, by
    /// name.
    pub load_scene: LoadScene,
    /// Choice of the GPU that runs the methods.
    pub gpu: GpuRequest,
}

/// Starts the threads and creates the state that shows their results. Methods may contain errors;
/// the window shows them. Returns the state, and the watch on the methods' files; `None` if it
/// could not be started, so that changed files are not read again.
///
/// # Errors
/// If no GPU can be opened, a method is unknown, or a method lacks a given param.
pub fn start(
    opening: Opening,
    sink: &dyn Sink,
    wake: Wake,
) -> Result<(Viewer, Option<Watch>), CompareError> {
    let methods = desired_methods(&opening, sink)?;
    let opened = device::open(&opening.gpu, [])?;
    let choices = choices(&opening, &opened, sink);
    let (tell, events) = mpsc::channel();
    let woken = Arc::clone(&wake);
    // A failed send is passed over: the window that no longer listens is about to end.
    let tell = move |event| {
        let _ = tell.send(event);
        woken();
    };
    let worker = Worker::new(
        opened,
        (opening.gpu, opening.load_scene),
        Box::new(preset::sources(sink)),
        Box::new(tell),
    );
    let failed = |error: std::io::Error| CompareError::Input(format!("no thread: {error}"));
    let worker = WorkerThread::start(worker).map_err(failed)?;
    let (tell, answers) = mpsc::channel();
    let ground_truth = GroundTruthThread::start(move |answer| {
        let _ = tell.send(answer);
        wake();
    });
    let again = worker.commands().clone();
    let named = opening.methods.iter();
    let folders = watch::folders(named.map(|it| it.split('@').next().unwrap_or(it)));
    let watch = Watch::start(&folders, move || {
        let _ = again.send(Command::Reload);
    });
    let desired = DesiredState {
        scene: opening.scene,
        view: None,
        size: opening.size,
        methods,
        all_passes: false,
        frame: 0,
    };
    let channels = Channels {
        worker,
        events,
        ground_truth: ground_truth.map_err(failed)?,
        answers,
    };
    let mut viewer = Viewer::new(channels, choices, desired);
    let watch = match watch {
        Ok(watch) => Some(watch),
        Err(error) => {
            viewer.notify_error(&format!("changed files are not noticed: {error}"));
            None
        }
    };
    Ok((viewer, watch))
}

/// The methods that are asked for with their settings. Without settings they need not be read
/// before the window is there, which then shows what is wrong with them.
fn desired_methods(opening: &Opening, sink: &dyn Sink) -> Result<Vec<DesiredMethod>, CompareError> {
    let sources = preset::sources(sink);
    let (arguments, params) = openings::arguments(&opening.methods, &opening.params, &sources)?;
    for argument in &arguments {
        preset::locate(&MethodArgument::new(&argument.preset).preset, &sources)?;
    }
    let map_sizes: Vec<u32> = opening.map_size.into_iter().collect();
    let own = arguments.iter().any(|argument| !argument.own.is_empty());
    if !own && map_sizes.is_empty() && params.is_empty() {
        let plain = arguments.into_iter().map(|argument| DesiredMethod {
            name: argument.preset,
            ..DesiredMethod::default()
        });
        return Ok(plain.collect());
    }
    let (methods, params) = (&opening.methods, &opening.params);
    let methods = method::load(methods, params, &map_sizes, &sources, preset::load_each)?;
    if methods.len() > 2 {
        return Err(CompareError::Request(format!(
            "these are {} methods and settings; the window shows two side by side",
            methods.len()
        )));
    }
    let desired = methods.into_iter().map(|method| DesiredMethod {
        name: method.preset.name.clone(),
        params: method.params,
        material: None,
    });
    Ok(desired.collect())
}

fn choices(opening: &Opening, gpu: &skiagraph_gpu::device::Gpu, sink: &dyn Sink) -> Choices {
    let presets = preset::names(&preset::sources(sink));
    let named = opening.methods.iter();
    let named = named.map(|it| MethodArgument::new(it).preset);
    let methods: BTreeSet<String> = presets.into_iter().chain(named).collect();
    let listed = SceneLibrary::from_environment().list();
    let listed = listed.into_iter().filter(|scene| scene.mesh_found);
    let mut scenes: BTreeSet<String> = listed.map(|scene| scene.name).collect();
    scenes.insert(opening.scene.clone());
    let info = gpu.adapter.get_info();
    let adapter = match block_on(device::timestamp_trust(gpu)) {
        Trust::Trusted => info.name,
        Trust::Untrusted { reason } => format!("{}; no GPU times: {reason}", info.name),
    };
    Choices {
        scenes: scenes.into_iter().collect(),
        methods: methods.into_iter().collect(),
        adapter,
    }
}
