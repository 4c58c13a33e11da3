//! A device and a scene for all tests, and comparisons of them.

use serde_json::Value;
use skiagraph_compare::{
    comparison::{Comparison, Protocol},
    error::CompareError,
    graphs::shadow_method::load_methods,
    measuring::{
        device::{self, GpuRequest},
        resume::Kept,
        series::{self, Series},
        view_or_path::ViewOrPath,
    },
    sink::{Session, Silent, Sink},
};
use skiagraph_gpu::block_on;
use skiagraph_gpu::device::Gpu;
use skiagraph_graph::{FolderSources, LayeredSources};
use skiagraph_passes::EmbeddedSources;
use skiagraph_scene::{Light, MeshFile, MeshFileOptions, Scene, SceneLibrary, View};
use std::{
    fs,
    path::Path,
    sync::{Arc, LazyLock, Mutex},
};

/// A graph that lights everything and is sure of it.
pub const LIT: &str = include_str!("../../../cli/tests/it/support/lit.ron");

/// A folder without documents: methods are built in.
pub const NOWHERE: &str = "no folder of documents";

/// The folder of `temporal.ron`, a method that remembers.
pub const TEMPORAL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/foreign/temporal");

/// The device of all tests.
pub fn gpu() -> &'static Gpu {
    static GPU: LazyLock<Gpu> = LazyLock::new(|| {
        let names = ["rt", "light_buffer", "nsm", "crsm"];
        let methods = load_methods(&names, &[], &[], &EmbeddedSources).unwrap();
        let graphs = methods.iter().map(|method| &method.preset.graph);
        device::open(&GpuRequest::default(), graphs).unwrap_or_else(|error| panic!("{error}"))
    });
    &GPU
}

/// The scene `park`.
pub fn park() -> Arc<Scene> {
    static PARK: LazyLock<Arc<Scene>> = LazyLock::new(|| scene("park"));
    PARK.clone()
}

/// The scene of a name.
pub fn scene(argument: &str) -> Arc<Scene> {
    let loaded = SceneLibrary::default().load(argument);
    Arc::new(loaded.unwrap_or_else(|error| panic!("{error}")).0)
}

/// Writes the text of a mesh file into a folder, and loads it under a light and seen so.
pub fn mesh(folder: &Path, text: &str, view: View, light: impl Into<Light>) -> Arc<Scene> {
    let file = folder.join("mesh.obj");
    fs::write(&file, text).unwrap();
    mesh_file(&file, view, light)
}

/// The mesh of a file under a light and seen so.
pub fn mesh_file(file: &Path, view: View, light: impl Into<Light>) -> Arc<Scene> {
    let loaded = MeshFile::load(file, &MeshFileOptions::default());
    let loaded = loaded.unwrap_or_else(|error| panic!("{error}"));
    Arc::new(Scene {
        name: loaded.name,
        mesh: loaded.mesh,
        views: vec![view],
        lights: vec![light.into()],
    })
}

/// Documents of a folder, and those that are built in.
pub fn sources(folder: &Path) -> LayeredSources {
    let own = FolderSources {
        root: folder.to_owned(),
    };
    LayeredSources(vec![Box::new(own), Box::new(EmbeddedSources)])
}

/// Compares methods of a folder, or built in, on the first view of a scene, with maps of these
/// sides; a frame of each.
pub fn comparison(
    scene: Arc<Scene>,
    methods: &[&str],
    folder: &Path,
    map_sizes: &[u32],
) -> Comparison {
    let methods = load_methods(methods, &[], map_sizes, &sources(folder))
        .unwrap_or_else(|error| panic!("{error}"));
    let mut comparison = Comparison::new(scene, methods).unwrap();
    comparison.views.truncate(1);
    timed(comparison, [0, 1, 0])
}

/// The same on `park`, with maps of 128².
pub fn park_comparison(methods: &[&str], folder: &Path, side: u32) -> Comparison {
    let mut comparison = comparison(park(), methods, folder, &[128]);
    comparison.viewports = vec![[side; 2]];
    comparison
}

/// Follows one of the paths of `park`.
pub fn along(mut comparison: Comparison, path: &str) -> Comparison {
    let paths = SceneLibrary::default().paths("park").unwrap();
    comparison.views = ViewOrPath::paths(&comparison.scene, paths, path, None).unwrap();
    comparison
}

/// Takes so many frames, before the timed ones, timed, and timed while only the camera moves.
pub fn timed(mut comparison: Comparison, [warmup, frames, regime_frames]: [u32; 3]) -> Comparison {
    comparison.protocol = Protocol {
        warmup,
        frames,
        regime_frames,
        ..comparison.protocol
    };
    comparison
}

/// The runs of a comparison, as `results.json` has them.
pub fn runs(comparison: &Comparison) -> Vec<Value> {
    let results = block_on(series::run(comparison, Session::new(gpu(), &Silent)));
    let results = results.unwrap_or_else(|error| panic!("{error}"));
    let runs = results.runs.iter();
    runs.map(|run| serde_json::to_value(run).unwrap()).collect()
}

/// Keeps notes, the names of steps that begin, and the progress of runs.
#[derive(Default)]
pub struct Heard {
    notes: Mutex<String>,
    steps: Mutex<Vec<String>>,
    runs: Mutex<String>,
}

impl Heard {
    /// The notes so far.
    pub fn notes(&self) -> String {
        self.notes.lock().unwrap().clone()
    }

    /// The names of the steps that began so far.
    pub fn steps(&self) -> Vec<String> {
        self.steps.lock().unwrap().clone()
    }

    /// The progress of runs so far: `2 begin, one done, one done, all end, `.
    pub fn runs(&self) -> String {
        self.runs.lock().unwrap().clone()
    }
}

impl Sink for Heard {
    fn note(&self, text: &str) {
        *self.notes.lock().unwrap() += text;
    }

    fn begin_runs(&self, total: u64) {
        *self.runs.lock().unwrap() += &format!("{total} begin, ");
    }

    fn count_run(&self) {
        *self.runs.lock().unwrap() += "one done, ";
    }

    fn end_runs(&self) {
        *self.runs.lock().unwrap() += "all end, ";
    }

    fn begin_step(&self, name: &str, _total: u64, _unit: &'static str) {
        self.steps.lock().unwrap().push(name.to_owned());
    }
}

/// Measures a comparison and keeps the results in a folder; returns what was heard, and the file.
pub fn keep(
    comparison: &Comparison,
    out: &Path,
    kept: Kept,
) -> Result<(Heard, Value), CompareError> {
    let heard = Heard::default();
    let session = Session::new(gpu(), &heard);
    comparison.check(session)?;
    fs::create_dir_all(out).unwrap();
    let mut series = block_on(Series::new(comparison, session, Some((out, kept))))?;
    for view in 0..comparison.views.len() {
        for viewport in 0..comparison.viewports.len() {
            block_on(series.measure(view, viewport))?;
        }
    }
    series.save(&[])?;
    drop(series);
    let text = fs::read_to_string(out.join("results.json")).unwrap();
    Ok((heard, serde_json::from_str(&text).unwrap()))
}

/// A number of pixels or frames.
pub fn count(value: &Value) -> u64 {
    value
        .as_u64()
        .unwrap_or_else(|| panic!("{value} is not a count"))
}
