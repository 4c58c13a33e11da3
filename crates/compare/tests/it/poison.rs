//! Memory that no pass has written, and outputs that depend on it.

use crate::support::{LIT, NOWHERE, comparison, gpu, park};
use skiagraph_compare::{
    error::CompareError,
    graphs::planning::Capabilities,
    measuring::{poison, view_or_path::ViewOrPath},
    sink::{Session, Silent},
};
use skiagraph_gpu::block_on;
use skiagraph_passes::SceneProvider;
use std::{fs, path::Path};

/// Checks a method of a folder, or one that is built in.
fn checked(name: &str, folder: &Path) -> Result<String, CompareError> {
    let comparison = comparison(park(), &[name], folder, &[]);
    let mut provider = SceneProvider::new(comparison.scene.clone());
    let [ViewOrPath::Still(view)] = &comparison.views[..] else {
        panic!("one view");
    };
    let viewport = [64, 48];
    provider.set_view(view, viewport);
    let preset = &comparison.methods[0].preset;
    let request = Capabilities::new(gpu()).request(viewport, &provider);
    let plan = preset.plan(&request, &Silent)?;
    block_on(poison::check(
        Session::new(gpu(), &Silent),
        &plan,
        &mut provider,
        preset,
    ))
}

#[test]
fn poison_finds_what_reads_memory_that_nothing_wrote() {
    for preset in ["rt", "nsm"] {
        let text = checked(preset, NOWHERE.as_ref()).unwrap();
        assert!(text.contains("no output depends"), "{preset}:\n{text}");
    }
    let folder = tempfile::tempdir().unwrap();
    // A promise that does not hold: every second row stays as it was.
    let careless = LIT.replace(
        "Clear(name: \"light\", target: \"visibility\", value: 1),",
        "Compute(name: \"rows\", dispatch: Over(\"visibility.size\"), overwrites: \
         [\"visibility\"]),",
    );
    let careless = careless.replace(
        "name: \"visibility\", format: R8Uint",
        "name: \"visibility\", format: R32Uint",
    );
    let shader = "var visibility: texture_storage_2d<r32uint, write>;
        @compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
            if id.y % 2u == 0u { textureStore(visibility, id.xy, vec4(1u)); }
        }";
    fs::write(folder.path().join("careless.ron"), careless).unwrap();
    fs::write(folder.path().join("rows.wgsl"), shader).unwrap();
    let text = checked("careless.ron", folder.path())
        .unwrap_err()
        .to_string();
    assert!(
        text.contains("`visibility` (50.000 % of its bytes)") && !text.contains("`status`"),
        "{text}"
    );
}

#[test]
fn poison_does_not_take_the_order_of_threads_for_memory_that_nothing_wrote() {
    let folder = tempfile::tempdir().unwrap();
    let racing = LIT
        .replace(
            "materials: [",
            "materials: [Buffer(name: \"turns\", count: 262144), Buffer(name: \"next\"),",
        )
        .replace(
            "passes: [",
            "passes: [Clear(name: \"first\", target: \"next\"),
             Compute(name: \"take_turns\", dispatch: Over(\"turns.count\"), \
             overwrites: [\"turns\"]),",
        )
        .replace("outputs: [", "outputs: [\"turns\", ");
    let shader = "var<storage, read_write> next: atomic<u32>;
        var<storage, read_write> turns: array<u32>;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
            turns[atomicAdd(&next, 1u)] = id.x;
        }";
    fs::write(folder.path().join("racing.ron"), racing).unwrap();
    fs::write(folder.path().join("take_turns.wgsl"), shader).unwrap();
    let text = checked("racing.ron", folder.path()).unwrap();
    assert!(text.contains("no output depends"), "{text}");
}
