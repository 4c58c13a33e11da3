//! Frames one after the other: what grows has room, and what is remembered fills.

use crate::support::{NOWHERE, TEMPORAL, gpu, park, park_comparison, sources, timed};
use skiagraph_compare::{
    graphs::{method::load_one, planning::Capabilities},
    measuring::frame::{self, Contents},
    sink::{Session, Silent},
};
use skiagraph_gpu::{Frame, block_on};
use skiagraph_graph::Plan;
use skiagraph_passes::SceneProvider;
use std::{fs, path::Path};

/// Plans a graph of a folder, or one that is built in, on the first view of `park`.
fn planned(name: &str, folder: &Path, side: u32) -> (Plan, SceneProvider) {
    let mut provider = SceneProvider::new(park());
    provider.set_view(&park().views[0], [side; 2]);
    let (preset, params) = load_one(name, &[], None, &sources(folder)).unwrap();
    let mut request = Capabilities::new(gpu()).request([side; 2], &provider);
    request.params = params;
    let plan = preset.plan(&request, &Silent).unwrap();
    (plan, provider)
}

/// Reads outputs of so many frames; returns what is said of those before them, too.
fn frames(
    name: &str,
    folder: &Path,
    side: u32,
    read: &[&str],
    count: u32,
) -> (String, Vec<Contents>) {
    let session = Session::new(gpu(), &Silent);
    let (plan, mut provider) = planned(name, folder, side);
    let (mut executor, growth) = block_on(frame::settled(session, plan, &mut provider)).unwrap();
    let frames = (0..count).map(|_| {
        let frame = Frame::new().with_read(read);
        let (report, _) = block_on(frame::run(session, &mut executor, &frame)).unwrap();
        frame::contents(report.readbacks)
    });
    let frames = frames.collect();
    (growth.text(), frames)
}

#[test]
fn a_still_view_is_right_once_its_memory_is_filled() {
    let five_frames = |name: &str| {
        let (_, frames) = frames(name, TEMPORAL.as_ref(), 48, &["visibility"], 5);
        frames
    };
    let (late, right) = (five_frames("temporal.ron"), five_frames("rt"));
    let bytes = |frame: &Contents| frame["visibility"].bytes().to_vec();
    assert!(bytes(&late[0]) != bytes(&right[0]));
    assert_eq!(bytes(&late[4]), bytes(&right[0]));
    assert_eq!(bytes(&right[4]), bytes(&right[0]));
}

/// Ten items are wanted and four have room at first; how many frames there were is remembered.
const GROWS: &str = r#"(
    format: 3,
    materials: [
        Buffer(name: "needed"),
        Buffer(name: "items", count: 4, grow: (counter: "needed", max: 64)),
        Buffer(name: "turns"),
    ],
    passes: [
        Clear(name: "reset", target: "needed"),
        Compute(name: "fill", dispatch: Groups(1, 1, 1)),
        Compute(name: "turn", dispatch: Groups(1, 1, 1)),
    ],
    outputs: ["items", "turns"],
)"#;

const FILL: &str = "
    var<storage, read_write> needed: atomic<u32>;
    var<storage, read_write> items: array<u32>;
    @compute @workgroup_size(16) fn main(@builtin(local_invocation_index) id: u32) {
        if id >= 10u { return; }
        let item = atomicAdd(&needed, 1u);
        if item < arrayLength(&items) { items[item] = 100u + id; }
    }";

const TURN: &str = "
    var<storage, read> turns_previous: u32;
    var<storage, read_write> turns: u32;
    @compute @workgroup_size(1) fn main() { turns = turns_previous + 1u; }";

#[test]
fn buffers_that_grow_have_room_in_the_first_frame_whose_memory_is_empty() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [
        ("grows.ron", GROWS),
        ("fill.wgsl", FILL),
        ("turn.wgsl", TURN),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let (growth, frames) = frames("grows.ron", folder.path(), 4, &["items", "turns"], 2);
    let warmed = "warmed up: 2 frames before this one, until items had room";
    assert!(growth.contains(warmed), "{growth}");
    let items = frames[0]["items"].as_u32().unwrap();
    assert!((100..110).all(|item| items.contains(&item)), "{items:?}");
    let turns = frames.iter().map(|frame| frame["turns"].as_u32().unwrap());
    assert_eq!(turns.collect::<Vec<_>>(), [[1], [2]]);
}

#[test]
fn what_a_first_frame_leaves_uncertain_is_the_same_in_every_run() {
    let first = |name: &str, side| {
        let (growth, frames) = frames(name, NOWHERE.as_ref(), side, &["status"], 1);
        (growth, frames[0]["status"].as_u32().unwrap())
    };
    let (growth, status) = first("light_buffer", 128);
    assert!(growth.contains("warmed up: "), "{growth}");
    assert!(!status.contains(&4), "none is uncertain");
    assert_eq!(first("light_buffer", 128).1, status);
    assert_eq!(first("nsm", 16).0, "", "nothing of it grows");
}

#[test]
fn a_comparison_without_timed_frames_is_refused() {
    let comparison = timed(park_comparison(&["nsm"], NOWHERE.as_ref(), 16), [1, 0, 1]);
    let error = comparison.check(Session::new(gpu(), &Silent)).unwrap_err();
    let expected = "a comparison needs at least one timed frame (`Protocol::frames`)";
    assert_eq!(error.to_string(), expected);
}
