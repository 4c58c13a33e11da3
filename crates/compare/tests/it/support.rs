//! A device and a scene for all tests, and comparisons of them.

use serde_json::Value;
use skiagraph_compare::{
    comparison::{Comparison, Protocol},
    graphs::shadow_method::load_methods,
    measuring::{
        device::{self, GpuRequest},
        series,
        view_or_path::ViewOrPath,
    },
    sink::{Session, Silent},
};
use skiagraph_gpu::device::Gpu;
use skiagraph_graph::{FolderSources, LayeredSources};
use skiagraph_passes::EmbeddedSources;
use skiagraph_scene::{Scene, SceneLibrary, SceneRequest};
use std::{
    path::Path,
    sync::{Arc, LazyLock},
};

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
    static PARK: LazyLock<Arc<Scene>> = LazyLock::new(|| {
        let argument = "park".to_owned();
        let request = SceneRequest {
            argument,
            obj: None,
        };
        Arc::new(SceneLibrary::default().load(&request).unwrap().0)
    });
    PARK.clone()
}

/// Documents of a folder, and those that are built in.
pub fn sources(folder: &Path) -> LayeredSources {
    let own = FolderSources {
        root: folder.to_owned(),
    };
    LayeredSources(vec![Box::new(own), Box::new(EmbeddedSources)])
}

/// Compares methods of a folder, or built in, on the first view of `park`, with maps of 128².
pub fn park_comparison(methods: &[&str], folder: &Path, side: u32) -> Comparison {
    let methods = load_methods(methods, &[], &[128], &sources(folder))
        .unwrap_or_else(|error| panic!("{error}"));
    let mut comparison = Comparison::new(park(), methods).unwrap();
    comparison.viewports = vec![[side; 2]];
    comparison.views.truncate(1);
    comparison
}

/// Follows one of the paths of `park`.
pub fn along(mut comparison: Comparison, path: &str) -> Comparison {
    let paths = SceneLibrary::default().paths("park").unwrap();
    comparison.views = ViewOrPath::paths(&comparison.scene, paths, path, None).unwrap();
    comparison
}

/// Takes so many frames, before the timed ones, timed, and timed while only the camera moves.
pub fn timed(mut comparison: Comparison, [warmup, frames, cached_frames]: [u32; 3]) -> Comparison {
    comparison.protocol = Protocol {
        warmup,
        frames,
        cached_frames,
        ..comparison.protocol
    };
    comparison
}

/// The runs of a comparison, as `results.json` has them.
pub fn runs(comparison: &Comparison) -> Vec<Value> {
    let results = series::run(comparison, Session::new(gpu(), &Silent));
    let results = results.unwrap_or_else(|error| panic!("{error}"));
    let runs = results.runs.iter();
    runs.map(|run| serde_json::to_value(run).unwrap()).collect()
}
