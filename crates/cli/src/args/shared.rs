//! Arguments that several commands share.

use crate::args::values::{self, LightArgument, frames, texels};
use crate::error::CliError;
use clap::{ArgAction, Args, ValueEnum};
use glam::DVec3;
use skiagraph_compare::error::CompareError;
use skiagraph_compare::graphs::argument::Assignment;
use skiagraph_compare::graphs::method::{self, ParamValues};
use skiagraph_compare::graphs::preset::Preset;
use skiagraph_compare::measuring::{device::GpuRequest, ground_truth::REFERENCE_SAMPLES};
use skiagraph_compare::own_camera::OwnCamera;
use skiagraph_compare::own_scene::MeshSceneOptions;
use skiagraph_compare::quantities::{bytes, degrees, direction, positive, vector};
use skiagraph_compare::size::Size;
use skiagraph_graph::Sources;
use skiagraph_reference::OracleMode;
use skiagraph_scene::{Concave, MaterialUse, MeshFileOptions, QuadDiagonal, cache_folder};
use std::{path::PathBuf, sync::Arc, time::Duration};

/// The GPU, and how much of it and of our time a graph may take.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "GPU")]
pub struct GpuArgs {
    /// GPU to use: part of its name or of its driver's, in any case, which tells two drivers of one
    /// GPU apart. Without it: $WGPU_ADAPTER_NAME, else the best one found.
    #[arg(long, global = true, value_name = "NAME")]
    pub adapter: Option<String>,
    /// Interface through which the GPU is used. Without it: those that $WGPU_BACKEND lists, else
    /// Vulkan, Metal or Direct3D 12. On GL a method that is not proven there is refused.
    #[arg(long, global = true, value_name = "BACKEND",
          value_parser = ["vulkan", "metal", "dx12", "gl"])]
    pub backend: Option<String>,
    /// Most memory for the textures and buffers of a graph: 512MiB, 2GiB, or bytes. A graph that
    /// needs more is refused, with a table of the largest. Without it: on a software adapter the
    /// machine's free memory, else no limit.
    #[arg(long, global = true, value_name = "SIZE", value_parser = bytes)]
    pub memory_limit: Option<u64>,
    /// Seconds after which an unfinished frame is given up, and the device with it: a shader may
    /// never end. 0 waits for ever.
    #[arg(long, global = true, value_name = "SECONDS", default_value_t = 300,
          value_parser = clap::value_parser!(u64).range(..=MAX_SECONDS))]
    pub timeout: u64,
}

impl GpuArgs {
    /// Returns the request for the GPU that these arguments choose.
    pub fn request(&self) -> GpuRequest {
        let mut request = GpuRequest::default();
        request.adapter.clone_from(&self.adapter);
        request.backends = self.backend.as_deref().map(wgpu::Backends::from_comma_list);
        request.memory_limit = self.memory_limit;
        request.timeout = (self.timeout > 0).then(|| Duration::from_secs(self.timeout));
        request.shader_cache = match std::env::var_os("SKIAGRAPH_SHADER_CACHE") {
            Some(folder) => Some(folder.into()).filter(|it: &PathBuf| *it != PathBuf::new()),
            None => cache_folder().map(|folder| folder.join("shaders")),
        };
        request
    }
}

/// A day: far above any frame, and far below what a clock can add.
const MAX_SECONDS: u64 = 86_400;

/// The scene to draw, and the place that it is seen from.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Scene")]
pub struct SceneArgs {
    /// Built-in scene, scene file (.ron), name of one in scenes/, or mesh file (.obj, .gltf, .glb).
    #[arg(long = "scene", default_value = "park", value_name = "SCENE", action = ArgAction::Set)]
    pub scenes: Vec<String>,
    /// A view of the scene, or `all`. Without it: the scene's first view, and of `compare`
    /// all that are chosen for a mesh without cameras. Cameras of a glTF file are views.
    #[arg(long, value_name = "NAME")]
    pub view: Option<String>,
    /// Eye position, instead of the view's. Without it, for a mesh without cameras: outside, in a
    /// room, or in the street of a town.
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    pub eye: Option<DVec3>,
    /// Direction in which the eye looks, instead of the view's. Without it, for a mesh without
    /// cameras: where light and shadow are, or with --eye to the mesh's middle.
    #[arg(long, value_name = "X,Y,Z", value_parser = direction, allow_hyphen_values = true)]
    pub look: Option<DVec3>,
    /// A light of the scene, or `all`: each view under each. Without it: the scene's first light,
    /// or all if `compare` has a graph with a layer of `visibility` for each. Three numbers are the
    /// direction in which the light of a sun of your own travels.
    #[arg(long, value_name = "NAME|X,Y,Z", value_parser = values::light,
          allow_hyphen_values = true)]
    pub light: Option<LightArgument>,
    /// Up direction, instead of the view's. Without it, for a mesh: 0,1,0.
    #[arg(long, value_name = "X,Y,Z", value_parser = direction, allow_hyphen_values = true)]
    pub up: Option<DVec3>,
    /// Vertical field of view in degrees, instead of the view's. Without it, for a mesh: 60.
    #[arg(long, value_name = "DEGREES", value_parser = degrees)]
    pub fov: Option<f64>,
    /// Near plane distance in scene units. Without it, with --eye or for a mesh: 1/10,000 of --far.
    #[arg(long, value_name = "LENGTH", value_parser = positive)]
    pub near: Option<f64>,
    /// Far plane distance in scene units. Without it, with --eye or for a mesh: just behind the
    /// mesh.
    #[arg(long, value_name = "LENGTH", value_parser = positive)]
    pub far: Option<f64>,
    /// Add a ground below a mesh that has no floor, a square slab just below its lowest point, and
    /// choose views from outside alone.
    #[arg(long)]
    pub ground: bool,
    /// Scene file to write, to be edited: mesh, and lights, views and paths as they were chosen.
    #[arg(long, value_name = "FILE.ron")]
    pub write_scene: Option<PathBuf>,
    /// Materials of a mesh file to read. Without it: all.
    #[arg(long, value_name = "WHAT")]
    pub materials: Option<Materials>,
    /// Way in which concave polygons of an OBJ file become triangles. Without it: cut.
    #[arg(long, value_name = "HOW")]
    pub concave: Option<ConcavePolygons>,
}

/// Choice of the materials of a mesh file that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Materials {
    /// Colours and alpha masks; a missing mask file is an error.
    All,
    /// Colours; every surface is opaque, and missing files are warnings.
    Color,
    /// None; files of materials and textures may be missing.
    Ignore,
    /// As `all`, and what a glTF file blends is masked: cut out where alpha is below 0.5.
    #[value(name = "blend=mask")]
    BlendMask,
}

/// Ways in which concave polygons of an OBJ file become triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ConcavePolygons {
    /// They are cut so that their outline stays; one that crosses itself is an error.
    Cut,
    /// They become fans around their first corner, which may cover more than the polygon.
    Fan,
}

impl SceneArgs {
    /// Returns the scene's argument; of several scenes the first.
    pub fn scene(&self) -> &str {
        self.scenes.first().map_or("park", String::as_str)
    }

    /// Returns the same arguments for one scene, `scene`.
    pub fn of(&self, scene: &str) -> Self {
        Self {
            scenes: vec![scene.to_owned()],
            ..self.clone()
        }
    }

    /// Returns the arguments for each scene by itself.
    ///
    /// # Errors
    /// If there are several scenes, and `--eye`, `--look` or `--write-scene`.
    pub fn each(&self) -> Result<Vec<Self>, CliError> {
        let single = [
            ("--eye", self.eye.is_some()),
            ("--look", self.look.is_some()),
            ("--write-scene", self.write_scene.is_some()),
        ];
        let single = single.iter().find(|(_, is_given)| *is_given);
        if let Some((name, _)) = single.filter(|_| self.scenes.len() > 1) {
            return Err(CliError::Usage(format!(
                "{name} is of one scene, and {} are asked for; write a scene file of each with its \
                 own view (skiagraph run rt --scene SCENE --eye … --look … --write-scene \
                 FILE.ron), and compare these",
                self.scenes.len()
            )));
        }
        Ok(self.scenes.iter().map(|scene| self.of(scene)).collect())
    }

    /// Returns the settings that turn a mesh file into a scene.
    pub fn mesh_scene(&self) -> MeshSceneOptions {
        let concave = self.concave.map(|concave| match concave {
            ConcavePolygons::Cut => Concave::Cut,
            ConcavePolygons::Fan => Concave::Fan,
        });
        let materials = self.materials.map(|materials| match materials {
            Materials::All => MaterialUse::All,
            Materials::Color => MaterialUse::Color,
            Materials::Ignore => MaterialUse::Ignore,
            Materials::BlendMask => MaterialUse::BlendMask,
        });
        MeshSceneOptions {
            file: MeshFileOptions {
                quads: QuadDiagonal::default(),
                concave: concave.unwrap_or_default(),
                materials: materials.unwrap_or_default(),
            },
            camera: self.camera(),
            sun: self.own_light(),
            ground: self.ground,
        }
    }

    /// Returns the parts of a view's camera that the arguments replace.
    pub fn camera(&self) -> OwnCamera {
        OwnCamera {
            eye: self.eye,
            direction: self.look,
            up: self.up,
            fov_y_degrees: self.fov,
            near: self.near,
            far: self.far,
        }
    }

    /// Returns the direction in which the user's own sun shines; `None` without one.
    pub fn own_light(&self) -> Option<DVec3> {
        match &self.light {
            Some(LightArgument::Direction(direction)) => Some(*direction),
            Some(LightArgument::Name(_)) | None => None,
        }
    }

    /// Returns the name in `--light`, or `all`; `None` without it or for three numbers.
    pub fn light_name(&self) -> Option<&str> {
        match &self.light {
            Some(LightArgument::Name(name)) => Some(name),
            Some(LightArgument::Direction(_)) | None => None,
        }
    }
}

/// Params of several graphs: each graph runs with every value.
#[derive(Args, Clone, Debug)]
pub struct SweepArgs {
    /// Widths of square shadow maps in texels, separated by commas: the param `map_size` of the
    /// graphs that have it.
    #[arg(long, value_name = "N,…", value_delimiter = ',',
          value_parser = texels(), allow_negative_numbers = true)]
    pub map_size: Vec<u32>,
    /// A param of the graphs that have it. Each value of a list (radius=1,2,4; vectors between
    /// semicolons) or a range (bias=0..0.01/5: five values) is tried. May be repeated.
    #[arg(
        long = "set",
        visible_alias = "image",
        value_name = "NAME=VALUE,…",
        allow_hyphen_values = true
    )]
    pub params: Vec<Assignment>,
}

/// Viewports and params that methods are timed with, and for how many frames.
#[derive(Args, Clone, Debug)]
pub struct TimingArgs {
    /// Viewport sizes in pixels, separated by commas.
    #[arg(
        long,
        value_name = "WxH,…",
        value_delimiter = ',',
        default_value = "1024x1024"
    )]
    pub size: Vec<Size>,
    /// Params of the graphs.
    #[command(flatten)]
    pub sweep: SweepArgs,
    /// Timed frames of each method on each view. A frame that is judged and pictured is another
    /// one, so that its readback is not timed.
    #[arg(long, default_value_t = 10, value_name = "N",
          value_parser = frames(1), allow_negative_numbers = true)]
    pub frames: u32,
    /// Untimed frames before the timed ones.
    #[arg(long, default_value_t = 2, value_name = "N",
          value_parser = frames(0), allow_negative_numbers = true)]
    pub warmup: u32,
}

/// How the reference traces.
#[derive(Args, Clone, Debug)]
pub struct ReferenceArgs {
    /// Shadow rays of the reference: `exact` (no offset, the own triangle excluded) or
    /// `offset:LENGTH` (origin moved towards the light by so many scene units).
    #[arg(long, default_value = "exact", value_name = "MODE")]
    pub oracle: OracleMode,
    /// Shadow rays per pixel that the reference traces to a light with an extent.
    #[arg(long, value_name = "N", default_value_t = REFERENCE_SAMPLES,
          value_parser = clap::value_parser!(u32).range(4..=1_048_576))]
    pub reference_samples: u32,
}

/// Arguments that name one graph, its viewport and its params.
#[derive(Args, Debug)]
pub struct MethodArgs {
    /// Preset by name, or a graph (.ron).
    #[arg(value_name = "PRESET|FILE.ron")]
    pub preset: String,
    /// Viewport size in pixels.
    #[arg(long, value_name = "WxH", default_value = "1024x1024")]
    pub size: Size,
    /// Width of the square shadow map in texels: the param `map_size`.
    #[arg(long, value_name = "N", value_parser = texels(), allow_negative_numbers = true)]
    pub map_size: Option<u32>,
    /// A param of the graph. May be repeated.
    #[arg(
        long = "set",
        visible_alias = "image",
        value_name = "NAME=VALUE",
        allow_hyphen_values = true
    )]
    pub params: Vec<Assignment>,
}

impl MethodArgs {
    /// Loads the graph that the arguments name, and the values of the params that they set.
    ///
    /// # Errors
    /// Those of [`method::load_one`].
    pub fn load(&self, sources: &dyn Sources) -> Result<(Arc<Preset>, ParamValues), CompareError> {
        method::load_one(&self.preset, &self.params, self.map_size, sources)
    }
}
