//! Scenes by name.

use skiagraph_scene::{Scene, SceneLibrary};
use std::sync::Arc;

/// A scene of the library; one that is not there fails the test.
pub fn load(name: &str) -> Arc<Scene> {
    let (scene, _) = SceneLibrary::from_environment()
        .load(name)
        .unwrap_or_else(|error| panic!("{error}"));
    Arc::new(scene)
}

/// The real Sponza is too large to come with the sources: the folder above `sponza/sponza.obj` is
/// taken from the environment.
pub fn sponza() -> Option<Arc<Scene>> {
    downloaded("sponza")
}

/// The dissertation's park, from the folder above `bench/bench.obj`, which the environment names.
pub fn bench() -> Option<Arc<Scene>> {
    downloaded("bench")
}

fn downloaded(name: &str) -> Option<Arc<Scene>> {
    if std::env::var_os("SKIAGRAPH_ASSETS").is_none() {
        println!("SKIAGRAPH_ASSETS is not set, so there is no mesh of {name} to test with");
        return None;
    }
    Some(load(name))
}
