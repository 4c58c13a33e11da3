//! Comparisons as the arguments of `compare` ask for them: methods, scenes with their views, and
//! folders for results.

use crate::args::commands::{CompareArgs, Images};
use crate::args::shared::{GpuArgs, SceneArgs, SweepArgs};
use crate::error::CliError;
use crate::scene_selection::{SceneSelection, paths};
use crate::terminal::console::note;
use crate::terminal::{Terminal, interrupt};
use skiagraph_compare::comparison::{Comparison, Protocol};
use skiagraph_compare::graphs::method::{self, Method};
use skiagraph_compare::graphs::planning::Capabilities;
use skiagraph_compare::graphs::{preset, shadow_method};
use skiagraph_compare::lists::unique;
use skiagraph_compare::measuring::device;
use skiagraph_compare::measuring::frame_sequence::MovingParts;
use skiagraph_compare::measuring::ground_truth::PrimaryVisibility;
use skiagraph_compare::measuring::scene_folders::{check_kind, scene_folders};
use skiagraph_compare::measuring::view_or_path::{ViewOrPath, under_lights};
use skiagraph_compare::records::{budgets::Budgets, published};
use skiagraph_compare::sink::Session;
use skiagraph_compare::size::Size;
use skiagraph_compare::wording::command_line;
use skiagraph_gpu::device::Gpu;
use skiagraph_passes::SceneProvider;
use skiagraph_report::gate::Gate;
use skiagraph_scene::{CameraPath, Scene};
use std::{ffi::OsString, path::PathBuf, sync::Arc};

/// Commit that the program was built from.
pub const COMMIT: Option<&str> = option_env!("SKIAGRAPH_COMMIT");

/// The comparisons that the arguments ask for, not checked yet.
pub struct Loaded {
    /// The GPU that they run on.
    pub gpu: Gpu,
    /// One for each scene.
    pub comparisons: Vec<Comparison>,
    /// The folder of each.
    pub targets: Vec<Target>,
}

impl Loaded {
    /// Loads methods and scenes, and opens the GPU. `words` are those of the command line.
    pub fn new(
        args: &CompareArgs,
        gpu: &GpuArgs,
        words: impl Iterator<Item = OsString>,
    ) -> Result<Self, CliError> {
        interrupt::install()?;
        let scenes = args.scene.each()?;
        let published = published::read(&args.published)?;
        let sources = preset::sources(&Terminal);
        let names = match &args.presets[..] {
            [] if !args.all => preset::shipped_and_own(&sources),
            presets => preset::named_or_all(presets, &sources),
        };
        let (timing, SweepArgs { map_size, params }) = (&args.timing, &args.timing.sweep);
        let sizes = if args.map_curve {
            &MAP_CURVE[..]
        } else {
            map_size
        };
        let load = shadow_method::load_each;
        let methods = method::load(&names, params, sizes, &sources, load)?;
        note_without_map(&methods, map_size);
        Gate::check(&args.fail_if, &methods).map_err(CliError::Input)?;
        let primary = PrimaryVisibility::load(&sources)?;
        let loaded = methods.iter().map(|method| &method.preset.graph);
        let gpu = device::open(&gpu.request(), loaded)?;
        let session = Session::new(&gpu, &Terminal);
        let targets = Target::all(args)?;
        let command = command_line(words);
        let comparison = |scene| -> Result<Comparison, CliError> {
            let mut selection = SceneSelection::load(scene)?;
            let notes = std::mem::take(&mut selection.notes);
            // Without timed frames of regimes the mesh stays in one piece.
            let regime_frames = args.regime_frames.unwrap_or(timing.frames);
            let moving = (regime_frames > 0).then(|| moving(&selection.paths, &selection.scene));
            let (scene, views) = views(args, scene, selection, &methods, session)?;
            Ok(Comparison {
                views,
                moving: moving.flatten(),
                viewports: unique(timing.size.iter().map(|Size(size)| *size)),
                methods: methods.clone(),
                tuned: Default::default(),
                protocol: Protocol {
                    frames: timing.frames,
                    warmup: timing.warmup,
                    regime_frames,
                    jitter: args.jitter,
                    oracle: args.reference.oracle,
                    reference_samples: args.reference.reference_samples,
                    pictures: args.images == Images::All,
                    data: args.data,
                },
                primary: primary.clone(),
                budgets: Budgets {
                    frame_ms: args.under,
                    wrong_percent: args.below,
                    memory_bytes: args.memory,
                },
                published: published.clone(),
                command: Some(command.clone()),
                commit: COMMIT.map(str::to_owned),
                notes,
                scene,
            })
        };
        let comparisons = scenes.iter().map(comparison).collect::<Result<_, _>>()?;
        Ok(Self {
            gpu,
            comparisons,
            targets,
        })
    }
}

/// Checks the comparisons of all scenes: where no method can run on one, they may on another.
///
/// # Errors
/// A scene's folder for results.
pub struct Target {
    /// The folder.
    pub folder: PathBuf,
    /// The folder's name below that of all scenes; `None` of a single scene.
    pub name: Option<String>,
}

impl Target {
    /// The folder of each scene.
    fn all(args: &CompareArgs) -> Result<Vec<Self>, CliError> {
        check_kind(&args.out, args.scene.scenes.len() > 1).map_err(CliError::Input)?;
        if args.scene.scenes.len() == 1 {
            let folder = args.out.clone();
            return Ok(vec![Self { folder, name: None }]);
        }
        let names = scene_folders(&args.scene.scenes).into_iter();
        let target = |name: String| Self {
            folder: args.out.join(&name),
            name: Some(name),
        };
        Ok(names.map(target).collect())
    }
}

/// A scene with the views or paths that the arguments select.
fn views(
    args: &CompareArgs,
    scene_args: &SceneArgs,
    selection: SceneSelection,
    methods: &[Method],
    session: Session,
) -> Result<(Arc<Scene>, Vec<ViewOrPath>), CliError> {
    let scene = Arc::new(selection.scene);
    let light = light_name(scene_args, methods, &scene, session);
    if let Some(name) = &args.path {
        let views = paths(scene_args, &scene, &selection.paths, name, light)?;
        return Ok((scene, views));
    }
    let mut views = [selection.views, selection.further].concat();
    if scene_args.light.is_none() {
        views = under_lights(&scene, views, light)?;
    }
    Ok((scene, views.into_iter().map(ViewOrPath::Still).collect()))
}

/// The parts that move on the scene's paths; a path that cannot move them is noted.
fn moving(paths: &[CameraPath], scene: &Scene) -> Option<Arc<MovingParts>> {
    MovingParts::first(paths, &scene.mesh).unwrap_or_else(|error| {
        note(&format!("{error}: views are timed without moving meshes"));
        None
    })
}

/// Edges of the shadow maps of `--map-curve`, in texels.
const MAP_CURVE: [u32; 5] = [256, 512, 1024, 2048, 4096];

/// Prints a note on the methods without a param `map_size`, unless `map_sizes` is empty.
pub fn note_without_map(methods: &[Method], map_sizes: &[u32]) {
    let without = methods.iter().filter(|method| method.map_size.is_none());
    let without: Vec<&str> = without.map(|method| method.name.as_str()).collect();
    if !map_sizes.is_empty() && !without.is_empty() {
        let names = without.join(", ");
        let text = format!("--map-size has no effect on {names}: no param `map_size`");
        note(&text);
    }
}

/// The light by its name: where a method answers for every light it is judged under every light,
/// unless one is named.
fn light_name<'a>(
    args: &'a SceneArgs,
    methods: &[Method],
    scene: &Arc<Scene>,
    session: Session,
) -> Option<&'a str> {
    let provider = SceneProvider::new(scene.clone());
    let device = Capabilities::new(session.gpu);
    let is_layered = |method: &Method| shadow_method::is_layered(method, &device, &provider);
    match args.light {
        None if methods.iter().any(is_layered) => Some("all"),
        _ => args.light_name(),
    }
}
