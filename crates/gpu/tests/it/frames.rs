//! State from frame to frame: last frame's versions, skipped passes; and random documents against
//! an interpreter.

use crate::buffers::{INPUT, OLD, SEED, SEED_PARAM, compute, document, writes};
use crate::host::{self, GPU, executor, frame, request, set, submit, words};
use crate::program::{Event, ITEMS, Value, any_program};
use crate::support::{Files, load, right};
use proptest::prelude::*;
use skiagraph_gpu::{Executor, FaultKind, Frame, import};
use skiagraph_graph::{Code, NoProvider, ParamValue};
use std::{collections::BTreeMap, time::Instant};

/// The first number of an output after a frame.
fn number(executor: &mut Executor, output: &str) -> u32 {
    host::numbers(executor, output)[0]
}

/// ```text
/// total.previous ─▶ count ─▶ total
/// ```
#[test]
fn a_sum_over_frames_starts_from_zero() {
    let bind = r#""old": "total.previous", "out": "total""#;
    let files = document("", &["total"], &[compute("count", "", bind)], &["total"])
        .with("count.wgsl", writes(OLD, "old[0] + 1u"));
    let mut executor = executor(&files, &request(&NoProvider));
    let counted: Vec<u32> = (0..5).map(|_| number(&mut executor, "total")).collect();
    assert_eq!(counted, [1, 2, 3, 4, 5]);
    // The buffer does not follow the viewport: it is kept.
    executor
        .resize([16, 16], &mut NoProvider)
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(number(&mut executor, "total"), 6);
}

/// The same on a texture of the viewport's size, through a copy: after a resize it is zero again.
#[test]
fn last_frame_is_zero_after_a_resize() {
    let files = Files::graph(
        r#"
    materials: [Texture(name: "age", format: R32Uint), Texture(name: "was", format: R32Uint)],
    passes: [
        Copy(name: "keep", from: "age.previous", to: "was"),
        Fullscreen(name: "grow", color: ["age"]),
    ],
    outputs: ["age"],
"#,
    )
    .with(
        "grow.wgsl",
        "var was: texture_2d<u32>;
         @fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) u32 {
             return textureLoad(was, vec2<u32>(at.xy), 0).x + 2u;
         }",
    );
    let mut executor = executor(&files, &request(&NoProvider));
    assert_eq!([0; 3].map(|_| number(&mut executor, "age")), [2, 4, 6]);
    let report = executor
        .resize([4, 2], &mut NoProvider)
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(report.resources, ["age", "was"]);
    assert!(report.pipelines.is_empty());
    assert_eq!([0; 3].map(|_| number(&mut executor, "age")), [2, 4, 6]);
    assert_eq!(executor.plan().outputs()[0].size, [4, 2]);
}

/// ```text
/// seed ─▶ make ─▶ b ;  b.previous ─▶ watch ─▶ c
/// ```
/// Content not written in a frame is still that of the end of the frame before.
#[test]
fn a_version_that_was_not_written_stays_the_last_one() {
    let files = document(
        &format!("{SEED_PARAM} Bool(name: \"on\", default: true)"),
        &["b", "c"],
        &[
            compute("make", r#"run: When("on"),"#, r#""out": "b""#),
            compute("watch", "", r#""old": "b.previous", "out": "c""#),
        ],
        &["b", "c"],
    )
    .with("make.wgsl", writes(SEED, "params.seed"))
    .with("watch.wgsl", writes(OLD, "old[0]"));
    let mut executor = executor(&files, &request(&NoProvider));
    let both = |executor: &mut Executor| {
        let report = frame(executor, &["b", "c"]);
        (words(&report, 0)[0], words(&report, 1)[0], report.skipped)
    };
    let skipped = vec!["make".to_owned()];
    assert_eq!(both(&mut executor), (5, 0, vec![]));
    set(&mut executor, "seed", ParamValue::U32(6));
    assert_eq!(both(&mut executor), (6, 5, vec![]));
    set(&mut executor, "on", ParamValue::Bool(false));
    set(&mut executor, "seed", ParamValue::U32(7));
    assert_eq!(both(&mut executor), (6, 6, skipped.clone()));
    assert_eq!(both(&mut executor), (6, 6, skipped));
    set(&mut executor, "on", ParamValue::Bool(true));
    assert_eq!(both(&mut executor), (7, 6, vec![]));
    assert_eq!(both(&mut executor), (7, 7, vec![]));
}

/// ```text
/// seed ─▶ first (Once) ─▶ a ─┐
/// seed ─▶ second ────────▶ b ┴▶ third ─▶ c ─▶ fourth (Always) ─▶ d ;  host ─▶ fifth ─▶ e
/// ```
/// second, third, fifth run `OnChange`.
fn cached() -> Files {
    let files = document(
        &format!("{SEED_PARAM} U32(name: \"other\", default: 1)"),
        &["a", "b", "c", "d", "e"],
        &[
            compute("first", "run: Once,", r#""out": "a""#),
            compute("second", "run: OnChange,", r#""out": "b""#),
            compute(
                "third",
                "run: OnChange,",
                r#""input": "a", "more": "b", "out": "c""#,
            ),
            compute(
                "fourth",
                r#"shader: "pass_on","#,
                r#""input": "c", "out": "d""#,
            ),
            compute(
                "fifth",
                r#"shader: "pass_on", run: OnChange,"#,
                r#""input": "host", "out": "e""#,
            ),
        ],
        &["d", "e"],
    );
    let more = format!("{INPUT} var<storage, read> more: array<u32>;");
    files
        .edited(
            "graph.ron",
            "params:",
            r#"inputs: [Buffer(name: "host")], params:"#,
        )
        .with("first.wgsl", writes(SEED, "params.seed"))
        .with("second.wgsl", writes(SEED, "params.seed * 10u"))
        .with("third.wgsl", writes(&more, "input[0] + more[0]"))
        .with("pass_on.wgsl", writes(INPUT, "input[0]"))
}

/// A buffer of the host, every item `value`.
fn host_buffer(items: usize, value: u32) -> wgpu::Buffer {
    let buffer = GPU.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 4 * items as u64,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    fill(&buffer, value);
    buffer
}

fn fill(buffer: &wgpu::Buffer, value: u32) {
    let items = buffer.size() as usize / 4;
    let bytes = value.to_le_bytes().repeat(items);
    GPU.queue.write_buffer(buffer, 0, &bytes);
}

#[test]
fn what_did_not_change_is_not_made_again() {
    let host = host_buffer(1, 9);
    let mut request = request(&NoProvider);
    let described = import::buffer(&host, Some(1));
    request.imports.insert("host".to_owned(), described);
    let mut executor = executor(&cached(), &request);
    executor
        .import_buffer("host", &host)
        .unwrap_or_else(|error| panic!("{error}"));
    let step =
        |executor: &mut Executor, full: bool, what: &str, values: [u32; 2], skipped: &[&str]| {
            let read = Frame::new().with_all(full).with_read(&["d", "e"]);
            let report = submit(executor, &read);
            assert_eq!([0, 1].map(|at| words(&report, at)[0]), values, "{what}");
            assert_eq!(report.skipped, skipped, "{what}");
        };
    let cached = ["first", "second", "third", "fifth"];
    let executor = &mut executor;
    step(executor, false, "the first frame", [55, 9], &[]);
    step(executor, false, "nothing changed", [55, 9], &cached);
    step(executor, true, "everything is asked for", [55, 9], &[]);
    set(executor, "other", ParamValue::U32(2));
    step(
        executor,
        false,
        "a param that nobody reads",
        [55, 9],
        &cached,
    );
    // The first pass runs once: it keeps the seed that it saw.
    set(executor, "seed", ParamValue::U32(6));
    step(executor, false, "the seed", [65, 9], &["first", "fifth"]);
    step(executor, false, "nothing changed again", [65, 9], &cached);
    fill(&host, 8);
    executor
        .touch("host")
        .unwrap_or_else(|error| panic!("{error}"));
    let rest = ["first", "second", "third"];
    step(executor, false, "the host's buffer", [65, 8], &rest);
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 256,
        max_global_rejects: 8192,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// Culling, order, sharing, two versions, skipped passes, uploads, passes that come and go,
    /// frames that never run: none of it may be seen in a value.
    #[test]
    fn frames_mean_what_the_file_says(program in any_program()) {
        let host = host_buffer(ITEMS, 9);
        let mut request = request(&NoProvider);
        request.poison = program.poison;
        if program.reads_host() {
            request.imports = BTreeMap::from([("host".to_owned(), import::buffer(&host, None))]);
        }
        // Writers of several conditions that meet in one group are refused; that is tested
        // elsewhere.
        let plan = match right(load(&program.files())).plan(&request) {
            Ok(plan) => plan,
            Err(errors) => {
                let refused = errors.iter().all(|error| error.code == Code::RunCondition);
                prop_assert!(refused, "{}", errors);
                return Err(TestCaseError::reject("mixed run conditions"));
            }
        };
        let mut executor = Executor::new(&GPU.device, &GPU.queue, plan, &mut NoProvider)
            .unwrap_or_else(|error| panic!("{error}"));
        if program.reads_host() {
            let imported = executor.import_buffer("host", &host);
            imported.unwrap_or_else(|error| panic!("{error}"));
        }
        let names: Vec<String> = program.outputs.iter().map(|at| format!("m{at}")).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let expected = program.interpret().into_iter().zip(&program.losses);
        let (mut lost, mut faults) = (Vec::new(), Vec::new());
        for (number, (event, (expected, loss))) in program.events.iter().zip(expected).enumerate() {
            match *event {
                Event::Nothing => {}
                Event::Seed(value) => set(&mut executor, "seed", ParamValue::U32(value)),
                Event::Flag(value) => set(&mut executor, "flag", ParamValue::Bool(value)),
                Event::Extra(value) => set(&mut executor, "extra", ParamValue::Bool(value)),
                Event::Host(_) if !program.reads_host() => {}
                Event::Host(value) => {
                    fill(&host, value);
                    let touched = executor.touch("host");
                    touched.unwrap_or_else(|error| panic!("{error}"));
                }
                // No buffer follows the viewport, so nothing changes.
                Event::Resize(edge) => {
                    let resized = executor.resize([edge, edge], &mut NoProvider);
                    resized.unwrap_or_else(|error| panic!("{error}"));
                }
            }
            if let Some(loss) = loss {
                let wanted = Frame::new().with_read(&names);
                lost.push(host::lost(&mut executor, &wanted, *loss));
                // A thread of another test that polls the device may be about to tell of it.
                let began = Instant::now();
                while faults.len() < lost.len() && began.elapsed().as_secs() < 10 {
                    let taken = executor.take_faults().unwrap().into_iter();
                    faults.extend(taken.map(|fault| (fault.index, fault.kind)));
                    std::thread::yield_now();
                }
                continue;
            }
            let report = frame(&mut executor, &names);
            let values = (0..names.len()).map(|at| {
                let words = words(&report, at);
                *words.first_chunk().expect("as many as there are items")
            });
            let values: Vec<Value> = values.collect();
            prop_assert_eq!(
                values, expected,
                "frame {} after {:?}, skipped {:?}", number, event, report.skipped
            );
        }
        prop_assert_eq!(executor.take_faults().unwrap(), []);
        let lost: Vec<_> = lost.into_iter().map(|index| (index, FaultKind::NeverRan)).collect();
        prop_assert_eq!(faults, lost);
    }
}
