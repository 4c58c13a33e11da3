//! From the arguments to running threads and the state that shows what they do.

use crate::args::commands::ViewArgs;
use crate::args::shared::GpuArgs;
use crate::error::CliError;
use crate::files::watch::{self, Watch};
use crate::graphs::argument::MethodArgument;
use crate::graphs::openings;
use crate::graphs::variants;
use crate::graphs::{method, preset};
use crate::measuring::device;
use crate::viewer::desired_state::{DesiredMethod, DesiredState};
use crate::viewer::ground_truth::GroundTruthThread;
use crate::viewer::state::{Channels, Choices, Viewer};
use crate::viewer::worker::{Command, Worker};
use skiagraph_gpu::timing::Trust;
use skiagraph_scene::SceneLibrary;
use std::{
    collections::BTreeSet,
    sync::{Arc, mpsc},
    thread,
};

/// Wakes the window when something has happened.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// Starts the threads, and makes the state that shows what they do. The methods of the arguments
/// need not be faultless: what is wrong with them is shown.
///
/// # Errors
/// No GPU, a method that there is not, a param that it has not.
pub fn start(
    args: &ViewArgs,
    gpu: &GpuArgs,
    wake: Wake,
) -> Result<(Viewer, Option<Watch>), CliError> {
    let sources = preset::sources();
    let methods = desired_methods(args)?;
    let opened = device::open(gpu, [])?;
    let choices = choices(args, &opened);
    let (commands, command_receiver) = mpsc::channel();
    let (tell, events) = mpsc::channel();
    let woken = Arc::clone(&wake);
    // A failed send is passed over: the window that no longer listens is about to end.
    let tell = move |event| {
        let _ = tell.send(event);
        woken();
    };
    let worker = Worker::new(
        opened,
        (gpu, &args.scene),
        Box::new(sources),
        Box::new(tell),
    );
    let failed = |error: std::io::Error| CliError::Input(format!("no thread: {error}"));
    thread::Builder::new()
        .name("methods".into())
        .spawn(move || worker.work(&command_receiver))
        .map_err(failed)?;
    let (tell, answers) = mpsc::channel();
    let ground_truth = GroundTruthThread::start(move |answer| {
        let _ = tell.send(answer);
        wake();
    });
    let again = commands.clone();
    let folders = watch::folders(
        args.methods
            .iter()
            .map(|it| it.split('@').next().unwrap_or(it)),
    );
    let watch = Watch::start(&folders, move || {
        let _ = again.send(Command::Reload);
    });
    let desired = DesiredState {
        scene: args.scene.scene.clone(),
        view: None,
        size: args.size.0,
        methods,
        all_passes: false,
        frame: 0,
    };
    let channels = Channels {
        commands,
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

/// The methods of the command line with their settings. Without settings they need not be read
/// before the window is there, which then shows what is wrong with them.
fn desired_methods(args: &ViewArgs) -> Result<Vec<DesiredMethod>, CliError> {
    let sources = preset::sources();
    let (arguments, params) = openings::arguments(&args.methods, &args.params, &sources)?;
    for argument in &arguments {
        preset::locate(&MethodArgument::new(&argument.preset).preset, &sources)?;
    }
    let map_sizes: Vec<u32> = args.map_size.into_iter().collect();
    let own = arguments.iter().any(|argument| !argument.own.is_empty());
    if !own && map_sizes.is_empty() && params.is_empty() {
        let plain = arguments.into_iter().map(|argument| DesiredMethod {
            name: argument.preset,
            params: Default::default(),
            material: None,
        });
        return Ok(plain.collect());
    }
    let presets = preset::load_all(&variants::presets(&arguments), &sources)?;
    let methods = method::methods(&presets, &arguments, &params, &map_sizes)?;
    if methods.len() > 2 {
        return Err(CliError::Usage(format!(
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

fn choices(args: &ViewArgs, gpu: &skiagraph_gpu::device::Gpu) -> Choices {
    let presets = preset::names(&preset::sources());
    let named = args.methods.iter().map(|it| MethodArgument::new(it).preset);
    let methods: BTreeSet<String> = presets.into_iter().chain(named).collect();
    let listed = SceneLibrary::from_environment().list();
    let listed = listed.into_iter().filter(|scene| scene.mesh_found);
    let mut scenes: BTreeSet<String> = listed.map(|scene| scene.name).collect();
    scenes.insert(args.scene.scene.clone());
    let info = gpu.adapter.get_info();
    let adapter = match device::timestamp_trust(gpu) {
        Trust::Trusted => info.name,
        Trust::Untrusted { reason } => format!("{}; no GPU times: {reason}", info.name),
    };
    Choices {
        scenes: scenes.into_iter().collect(),
        methods: methods.into_iter().collect(),
        adapter,
    }
}
