//! Methods over many frames, beside an older profile.

use crate::support::{gpu, park};
use skiagraph_compare::{
    files::json::to_text,
    graphs::shadow_method::load_methods,
    measuring::profiling,
    records::{profile::Profile, read_back},
    sink::{Session, Silent},
};
use skiagraph_gpu::block_on;
use skiagraph_passes::EmbeddedSources;
use std::{fs, path::Path};

/// Times eight frames of a method on the first view of `park`, with a map of that side.
fn profile(name: &str, viewport: [u32; 2], map_size: &[u32]) -> Profile {
    let method = load_methods(&[name], &[], map_size, &EmbeddedSources).unwrap();
    let method = method[0].at(viewport).settled(gpu().device.features());
    let session = Session::new(gpu(), &Silent);
    let timed = block_on(profiling::profile(
        session,
        [0, 8],
        &method,
        &park(),
        &park().views[0],
    ));
    timed.unwrap_or_else(|error| panic!("{error}")).0
}

#[test]
fn a_baseline_stands_beside_and_other_conditions_are_called_out() {
    let nsm = || profile("nsm", [32, 24], &[32]);
    let file = Path::new("old.json");
    let old = nsm();
    assert_eq!(nsm().against(file, &old).differences, []);

    let mut rt = profile("rt", [16, 16], &[]);
    let beside = rt.against(file, &old);
    assert_eq!(beside.file, "old.json");
    let differences = beside.differences.iter();
    let differences =
        differences.map(|difference| [difference.what.as_str(), &difference.old, &difference.new]);
    let differences: Vec<_> = differences.collect();
    for expected in [["viewport", "32x24", "16x16"], ["method", "nsm", "rt"]] {
        assert!(differences.contains(&expected), "{differences:?}");
    }
    let of_nsm = [
        "gbuffer.surface",
        "create_shadow_map.fit_map.over_scene",
        "create_shadow_map.draw[0]",
        "shadow_lookup",
    ];
    assert_eq!(beside.only_old, of_nsm);
    let of_rt = [
        "detect_facing",
        "turn[0].fill_rays.compact",
        "turn[0].fill_rays.dispatch_arguments",
        "turn[0].trace_rays",
        "turn[0].fix_pixels",
    ];
    assert_eq!(beside.only_new, of_rt);
    let names: Vec<_> = beside
        .passes
        .iter()
        .map(|pass| pass.name.as_str())
        .collect();
    assert_eq!(names, ["gbuffer.visibility_buffer.primitive"]);
    for pass in &beside.passes {
        let [low, ratio, high] = [pass.cpu.low, pass.cpu.ratio, pass.cpu.high].map(Option::unwrap);
        assert!(low <= ratio && ratio <= high, "{pass:?}");
    }
    // A file with a comparison in it is a baseline itself.
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("new.json");
    rt.baseline = Some(beside);
    fs::write(&file, to_text(&rt)).unwrap();
    let read = read_back::profile(&file).unwrap();
    assert_eq!(rt.against(&file, &read).differences, []);
}
