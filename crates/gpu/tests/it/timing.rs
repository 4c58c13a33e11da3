//! GPU timestamps are true, or the adapter is not trusted with a reason; and every frame has its
//! own.

use crate::support::Files;
use crate::tiny::{GPU, NUMBER, encoder, frame, made, u32s};
use skiagraph_gpu::{
    ExecuteError, Frame, block_on, device,
    timing::{Trust, check},
};
use std::time::Duration;

#[test]
fn a_long_dispatch_after_a_raster_pass_is_timed_truly_or_not_at_all() {
    let gpu = device::open(None).unwrap_or_else(|error| panic!("{error}"));
    let adapter = gpu.adapter.get_info().name;
    match block_on(check(&gpu.device, &gpu.queue)).expect("the check's graph runs") {
        Trust::Trusted => {}
        // The software adapter of CI has the trap and the way around it, so there is no excuse.
        Trust::Untrusted { reason } => assert!(
            !adapter.contains("llvmpipe") && !reason.is_empty(),
            "{adapter}: {reason}"
        ),
    }
}

#[test]
fn every_pass_is_timed_or_the_reason_is_known() {
    let files = Files::graph(
        r#"
    materials: [Texture(name: "image", format: R32Float), Texture(name: "copy", format: R32Float)],
    passes: [
        Fullscreen(name: "number", color: ["image"]),
        Copy(name: "keep", from: "image", to: "copy"),
    ],
    outputs: ["copy"],
"#,
    )
    .with("number.wgsl", NUMBER);
    let mut executor = made(&files);
    for timing in [false, true, false, true, true] {
        let report = frame(&mut executor, timing, &[]);
        assert_eq!(report.timing.is_some(), timing);
        let Some(times) = report.timing else { continue };
        let names: Vec<&str> = times.passes.iter().map(|pass| pass.name.as_str()).collect();
        assert_eq!(names, ["number", "keep"]);
        // A copy is timed between passes, which not every adapter can.
        let features = GPU.device.features();
        let times_copies = features.contains(wgpu::Features::TIMESTAMP_QUERY_INSIDE_ENCODERS);
        let mut timed = times.passes.iter();
        let untimed = timed.any(|pass| pass.gpu.is_none() && (times_copies || pass.name != "keep"));
        if untimed {
            match block_on(check(&GPU.device, &GPU.queue)).unwrap_or_else(|error| panic!("{error}"))
            {
                Trust::Untrusted { reason } => assert!(!reason.is_empty()),
                Trust::Trusted => panic!("timestamps are trusted, but a pass has none"),
            }
        } else {
            let longest = times.passes.iter().filter_map(|pass| pass.gpu).max();
            assert!(
                times.gpu() >= longest,
                "the frame is as long as its longest pass"
            );
            let begins = times.passes.iter().filter_map(|pass| pass.begin);
            assert_eq!(begins.min(), Some(Duration::ZERO));
            let ends = times
                .passes
                .iter()
                .map(|pass| Some(pass.begin? + pass.gpu?));
            assert_eq!(
                ends.max(),
                Some(times.gpu()),
                "the frame ends with its last pass"
            );
        }
    }
}

/// A host that waited long enough is told what ran, and may go on waiting.
#[test]
fn a_frame_that_is_not_done_in_time_is_waited_for_again() {
    let files = Files::graph(
        r#"
    materials: [Buffer(name: "sums", count: 16384)],
    passes: [Compute(name: "work", dispatch: Over("sums.count"))],
    outputs: ["sums"],
"#,
    )
    .with(
        "work.wgsl",
        "var<storage, read_write> sums: array<u32>;
         @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
             var sum = id.x;
             for (var round = 0u; round < 20000u; round++) { sum = sum * 1664525u + 1013904223u; }
             sums[id.x] = sum;
         }",
    );
    let mut executor = made(&files);
    let wanted = Frame::new().with_read(&["sums"]);
    // A thread that got no core after its submission may find that the frame is done.
    let passes = (0..20).find_map(|_| {
        let mut commands = encoder();
        executor
            .encode(&mut commands, &wanted)
            .unwrap_or_else(|error| panic!("{error}"));
        GPU.queue.submit([commands.finish()]);
        match executor.finish_within(Some(Duration::ZERO)) {
            Err(ExecuteError::Unfinished { passes, .. }) => Some(passes),
            Err(error) => panic!("{error}"),
            Ok(_) => None,
        }
    });
    assert_eq!(passes.as_deref(), Some("work"));
    let report = executor.finish().unwrap_or_else(|error| panic!("{error}"));
    let expected = |first: u32| {
        let step = |sum: u32, _| sum.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (0..20_000).fold(first, step)
    };
    let sums: Vec<u32> = (0..16_384).map(expected).collect();
    assert_eq!(u32s(&report.readbacks[0].content), sums);
}

/// Shader invocations of each pass are counted where the device can; no frame has another's counts.
#[test]
fn runs_of_shaders_are_counted_by_pass() {
    let files = Files::graph(
        r#"
    materials: [
        Texture(name: "image", format: R32Float),
        Texture(name: "copy", format: R32Float),
        Buffer(name: "items", count: 100),
    ],
    passes: [
        Fullscreen(name: "number", color: ["image"]),
        Copy(name: "keep", from: "image", to: "copy"),
        Compute(name: "fill", dispatch: Over("items.count")),
        Fullscreen(name: "again", shader: "number", color: ["copy"], area: (0, 0, 4, 4)),
    ],
    outputs: ["copy", "items"],
"#,
    )
    .with("number.wgsl", NUMBER)
    .with(
        "fill.wgsl",
        "var<storage, read_write> items: array<u32>;
         @compute @workgroup_size(64) fn fill(@builtin(global_invocation_id) id: vec3<u32>) {
             if id.x < arrayLength(&items) { items[id.x] = id.x; }
         }",
    );
    let mut executor = made(&files);
    for statistics in [true, false, true, true] {
        let mut encoder = encoder();
        let wanted = Frame::new().with_statistics(statistics);
        let encoded = executor.encode(&mut encoder, &wanted);
        encoded.unwrap_or_else(|error| panic!("{error}"));
        GPU.queue.submit([encoder.finish()]);
        let report = executor.finish();
        let report = report.unwrap_or_else(|error| panic!("{error}"));
        let counts = GPU
            .device
            .features()
            .contains(wgpu::Features::PIPELINE_STATISTICS_QUERY);
        assert_eq!(report.statistics.is_some(), statistics && counts);
        let Some(passes) = report.statistics else {
            continue;
        };
        let names: Vec<&str> = passes.iter().map(|pass| pass.name.as_str()).collect();
        assert_eq!(names, ["number", "keep", "fill", "again"]);
        let [number, keep, fill, again] = &passes[..] else {
            unreachable!()
        };
        // A device may count what it runs beside the pixels that are asked for.
        assert!(
            (13 * 7..=4 * 13 * 7).contains(&number.fragments),
            "{number:?}"
        );
        assert!((16..13 * 7).contains(&again.fragments), "{again:?}");
        assert_eq!([number.vertices, number.threads], [3, 0]);
        assert!(number.primitives > 0, "{number:?}");
        assert_eq!([keep.fragments, keep.threads], [0, 0]);
        assert_eq!([fill.fragments, fill.threads], [0, 128], "two workgroups");
    }
}
