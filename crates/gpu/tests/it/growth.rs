//! Buffers and textures that grow between frames.

use crate::given::{with_more, write};
use crate::host::{self, GPU, encoder, executor, frame, planned, request, set, submit, words};
use crate::support::Files;
use skiagraph_gpu::{
    ExecuteError, Executor, Frame, FrameReport, Provider, ProviderError, ReplanReport, device,
};
use skiagraph_graph::{
    Describe, NoProvider, ParamValue, Plan, PlanRequest, Provided, ProvidedBinding, ResourceKind,
};

/// As many threads as are wanted count themselves, and write an item each while there is room.
///
/// ```text
/// reset ─▶ fill ─▶ items
///            └───▶ needed
/// ```
fn filled() -> Files {
    Files::graph(
        r#"
    params: [U32(name: "wanted", default: 4), U32(name: "most", default: 64)],
    materials: [
        Buffer(name: "needed"),
        Buffer(name: "items", count: 4, grow: (counter: "needed", max: "most")),
    ],
    passes: [
        Clear(name: "reset", target: "needed"),
        Compute(name: "fill", dispatch: Over("wanted")),
    ],
    outputs: ["items", "needed"],
"#,
    )
    .with("fill.wgsl", FILL)
}

const FILL: &str = "
    struct Params { wanted: u32 }
    var<uniform> params: Params;
    var<storage, read_write> needed: atomic<u32>;
    var<storage, read_write> items: array<u32>;
    @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
        if id.x >= params.wanted {
            return;
        }
        atomicAdd(&needed, 1u);
        if id.x < arrayLength(&items) {
            items[id.x] = 100u + id.x;
        }
    }";

fn wanting(wanted: u32) -> Executor {
    let mut executor = executor(&filled(), &request(&NoProvider));
    set(&mut executor, "wanted", ParamValue::U32(wanted));
    executor
}

#[track_caller]
fn grow(executor: &mut Executor) -> Option<ReplanReport> {
    let report = executor.grow(&mut NoProvider);
    report.unwrap_or_else(|error| panic!("{error}"))
}

/// The same where a counter says that there is no room. Another test's thread that polls the device
/// may be about to hand the counter on.
#[track_caller]
fn grown(executor: &mut Executor) -> ReplanReport {
    grown_with(executor, &mut NoProvider).unwrap_or_else(|error| panic!("{error}"))
}

#[track_caller]
fn grown_with(
    executor: &mut Executor,
    provider: &mut dyn Provider,
) -> Result<ReplanReport, ExecuteError> {
    for _ in 0..1_000_000 {
        if let Some(report) = executor.grow(provider).transpose() {
            return report;
        }
        std::thread::yield_now();
    }
    panic!("no counter says that a buffer has no room")
}

/// Returns the items that the frame writes if it wants `wanted` of them and has room for `items`;
/// the rest is zero.
fn numbered(wanted: u32, items: u32) -> Vec<u32> {
    let number = |item: u32| if item < wanted { 100 + item } else { 0 };
    (0..items).map(number).collect()
}

#[track_caller]
fn shows(executor: &mut Executor, wanted: u32, items: u32) {
    let report = frame(executor, &["items", "needed"]);
    assert_eq!(words(&report, 0), numbered(wanted, items));
    assert_eq!(words(&report, 1), [wanted]);
}

/// Runs `frames` until the items that they read have grown from `before` to `after`. Another test's
/// thread that polls the device may be about to hand the counter on.
#[track_caller]
fn come_to_show(
    executor: &mut Executor,
    wanted: u32,
    [before, after]: [u32; 2],
    frames: impl Fn(&mut Executor) -> FrameReport,
) {
    for _ in 0..1000 {
        let seen = words(&frames(executor), 0);
        if seen == numbered(wanted, after) {
            return;
        }
        assert_eq!(seen, numbered(wanted, before));
    }
    panic!("the buffer does not grow");
}

#[test]
fn a_buffer_grows_to_what_a_frame_needs() {
    let mut executor = wanting(4);
    shows(&mut executor, 4, 4);
    assert_eq!(grow(&mut executor), None, "there is room");
    set(&mut executor, "wanted", ParamValue::U32(10));
    shows(&mut executor, 10, 4);
    let report = grown(&mut executor);
    // The pipelines stay, and so does all other memory.
    let mut only_items = ReplanReport::default();
    only_items.resources.push("items".to_owned());
    assert_eq!(report, only_items);
    for _ in 0..3 {
        // A quarter more than the frame needed.
        shows(&mut executor, 10, 12);
        assert_eq!(grow(&mut executor), None, "there is room now");
    }
    set(&mut executor, "wanted", ParamValue::U32(12));
    shows(&mut executor, 12, 12);
    assert_eq!(grow(&mut executor), None, "the quarter is for this");
    set(&mut executor, "wanted", ParamValue::U32(2));
    frame(&mut executor, &[]);
    assert_eq!(grow(&mut executor), None, "it does not shrink");
    assert_eq!(executor.plan().grown()["items"], 12);
}

/// A host need not ask for it.
#[test]
fn frames_make_buffers_grow_by_themselves() {
    let mut executor = wanting(10);
    let alone = |executor: &mut Executor| frame(executor, &["items"]);
    shows(&mut executor, 10, 4);
    come_to_show(&mut executor, 10, [4, 12], alone);
    set(&mut executor, "wanted", ParamValue::U32(20));
    shows(&mut executor, 20, 12);
    come_to_show(&mut executor, 20, [12, 25], alone);
    assert_eq!(grow(&mut executor), None);
    assert_eq!(executor.plan().grown()["items"], 25);
    // Also between two frames of one submission, of which the second may be the larger one.
    set(&mut executor, "wanted", ParamValue::U32(30));
    come_to_show(&mut executor, 30, [25, 37], |executor| {
        let mut encoder = encoder();
        for read in [&[][..], &["items"]] {
            let frame = Frame::new().with_read(read);
            executor.encode(&mut encoder, &frame).unwrap();
        }
        GPU.queue.submit([encoder.finish()]);
        executor.finish().unwrap()
    });
}

#[test]
fn a_buffer_grows_no_further_than_it_may() {
    let mut executor = wanting(1000);
    frame(&mut executor, &[]);
    grown(&mut executor);
    shows(&mut executor, 1000, 64);
    assert_eq!(grow(&mut executor), None);
    // The device's limits bound it where the document's would not.
    let mut request = request(&NoProvider);
    request.limits.max_buffer_size = 40;
    let mut executor = host::executor(&filled(), &request);
    set(&mut executor, "wanted", ParamValue::U32(1000));
    frame(&mut executor, &[]);
    grown(&mut executor);
    shows(&mut executor, 1000, 10);
    assert_eq!(grow(&mut executor), None);
}

/// The counter of the first frame is on its way while others follow.
#[test]
fn frames_in_flight_are_not_waited_for() {
    let mut executor = wanting(10);
    let mut encoders = Vec::new();
    for _ in 0..3 {
        let mut encoder = encoder();
        executor.encode(&mut encoder, &Frame::default()).unwrap();
        encoders.push(encoder);
        assert_eq!(grow(&mut executor), None, "nothing was submitted");
    }
    for encoder in encoders {
        GPU.queue.submit([encoder.finish()]);
    }
    // Earlier submissions may be done behind this, or not; a frame between does no harm.
    frame(&mut executor, &[]);
    grow(&mut executor);
    assert_eq!(executor.plan().grown()["items"], 12);
    shows(&mut executor, 10, 12);
    assert_eq!(grow(&mut executor), None);
    // A frame that is dropped counts nothing, and the next one is counted.
    set(&mut executor, "wanted", ParamValue::U32(20));
    let mut dropped = encoder();
    executor.encode(&mut dropped, &Frame::default()).unwrap();
    drop(dropped);
    assert_eq!(grow(&mut executor), None);
    shows(&mut executor, 20, 12);
    grown(&mut executor);
    shows(&mut executor, 20, 25);
}

/// A host may change its plan in every frame, before a counter has arrived.
#[test]
fn a_count_on_its_way_outlives_a_change_of_the_plan() {
    let mut executor = wanting(10);
    frame(&mut executor, &[]);
    set(&mut executor, "wanted", ParamValue::U32(11));
    grown(&mut executor);
    shows(&mut executor, 11, 12);
    assert_eq!(grow(&mut executor), None);
    // The same for a frame that is encoded and not submitted.
    set(&mut executor, "wanted", ParamValue::U32(20));
    let mut encoder = encoder();
    executor.encode(&mut encoder, &Frame::default()).unwrap();
    executor.resize([9, 9], &mut NoProvider).unwrap();
    GPU.queue.submit([encoder.finish()]);
    executor.finish().unwrap();
    grown(&mut executor);
    shows(&mut executor, 20, 25);
}

/// Number of items that a plan gives a buffer.
fn items(plan: &Plan, name: &str) -> u64 {
    let mut resources = plan.resources().iter();
    let resource = resources.find(|resource| resource.name == name);
    match &resource.expect("it is there").kind {
        ResourceKind::Buffer(buffer) => buffer.count.expect("it has a count"),
        other => panic!("{name} is {other:?}"),
    }
}

#[test]
fn what_has_grown_stays() {
    let mut executor = wanting(10);
    frame(&mut executor, &[]);
    grown(&mut executor);
    let report = executor.resize([9, 9], &mut NoProvider).unwrap();
    assert_eq!(report.resources, [""; 0]);
    set(&mut executor, "wanted", ParamValue::U32(11));
    shows(&mut executor, 11, 12);
    // A graph that was loaded again, once with what is known and once without.
    for is_grown in [true, false] {
        let mut request = request(&NoProvider);
        request
            .params
            .insert("wanted".to_owned(), ParamValue::U32(11));
        if is_grown {
            request.grown = executor.plan().grown().clone();
        }
        let again = planned(&filled(), &request);
        executor.replace_graph(again, &mut NoProvider).unwrap();
        let count = items(executor.plan(), "items");
        assert_eq!(count, if is_grown { 12 } else { 4 });
    }
    // The count of a frame of before may tell it already.
    frame(&mut executor, &[]);
    grow(&mut executor);
    shows(&mut executor, 11, 13);
}

/// Where the host's limit for memory refuses it, frames go on with what there is.
#[test]
fn what_is_refused_is_not_tried_again() {
    let mut request = request(&NoProvider);
    request.memory_limit = Some(30);
    let mut executor = executor(&filled(), &request);
    set(&mut executor, "wanted", ParamValue::U32(10));
    for _ in 0..3 {
        shows(&mut executor, 10, 4);
        assert_eq!(grow(&mut executor), None);
    }
    assert!(executor.plan().grown().is_empty());
    // Another plan may have room.
    let plan = executor.plan().with(|request| request.memory_limit = None);
    executor
        .replace_graph(plan.unwrap(), &mut NoProvider)
        .unwrap();
    frame(&mut executor, &[]);
    grown(&mut executor);
    shows(&mut executor, 10, 12);
}

#[test]
fn passes_that_run_on_change_fill_the_larger_buffer() {
    let files = filled()
        .edited(
            "graph.ron",
            "target: \"needed\"",
            "target: \"needed\", run: OnChange",
        )
        .edited(
            "graph.ron",
            "Over(\"wanted\")",
            "Over(\"wanted\"), run: OnChange",
        );
    let mut executor = executor(&files, &request(&NoProvider));
    set(&mut executor, "wanted", ParamValue::U32(10));
    shows(&mut executor, 10, 4);
    grown(&mut executor);
    let report = frame(&mut executor, &["items"]);
    assert_eq!(report.skipped, [""; 0]);
    assert_eq!(words(&report, 0), numbered(10, 12));
    for _ in 0..2 {
        assert_eq!(grow(&mut executor), None);
        let report = frame(&mut executor, &["items"]);
        assert_eq!(report.skipped, ["reset", "fill"]);
        assert_eq!(words(&report, 0), numbered(10, 12));
    }
}

/// One buffer counts for two others; each grows by its own item.
#[test]
fn a_counter_may_be_an_item() {
    let files = Files::graph(
        r#"
    materials: [
        Buffer(name: "counts", count: 2),
        Buffer(name: "few", count: 4, grow: (counter: "counts[0]", max: 64)),
        Buffer(name: "many", count: 4, grow: (counter: "counts[1]", max: 64)),
    ],
    passes: [Compute(name: "fill", dispatch: Groups(1, 1, 1))],
    outputs: ["few", "many"],
"#,
    )
    .with(
        "fill.wgsl",
        "var<storage, read_write> counts: array<u32>;
         var<storage, read_write> few: array<u32>;
         var<storage, read_write> many: array<u32>;
         @compute @workgroup_size(1) fn main() {
             counts[0] = 3u;
             counts[1] = 20u;
             few[arrayLength(&few) - 1u] = 1u;
             many[arrayLength(&many) - 1u] = 2u;
         }",
    );
    let mut executor = executor(&files, &request(&NoProvider));
    frame(&mut executor, &[]);
    let report = grown(&mut executor);
    assert_eq!(report.resources, ["many"]);
    let report = frame(&mut executor, &["few", "many"]);
    assert_eq!(words(&report, 0), [0, 0, 0, 1]);
    assert_eq!((words(&report, 1).len(), words(&report, 1)[24]), (25, 2));
    assert_eq!(grow(&mut executor), None);
}

/// As many layers of four texels as are wanted, while there is room; `sums` has one number per
/// layer.
fn layered() -> Files {
    filled()
        .edited(
            "graph.ron",
            r#"Buffer(name: "items", count: 4,"#,
            r#"Buffer(name: "sums", count: "items.layers"),
        Texture(name: "items", format: R32Uint, size: 2, layers: 4,"#,
        )
        .edited(
            "graph.ron",
            r#"dispatch: Over("wanted")),"#,
            r#"dispatch: Over("wanted")),
        Compute(name: "add", dispatch: Over("sums.count")),"#,
        )
        .edited("graph.ron", r#"["items", "#, r#"["items", "sums", "#)
        .edited(
            "fill.wgsl",
            "var<storage, read_write> items: array<u32>;",
            "var items: texture_storage_2d_array<r32uint, write>;",
        )
        .edited(
            "fill.wgsl",
            "arrayLength(&items)",
            "textureNumLayers(items)",
        )
        .edited(
            "fill.wgsl",
            "items[id.x] = 100u + id.x;",
            "for (var texel = 0u; texel < 4u; texel++) {
                textureStore(items, vec2(texel & 1u, texel >> 1u), id.x, vec4(100u + id.x));
            }",
        )
        .with(
            "add.wgsl",
            "var items: texture_2d_array<u32>;
             var<storage, read_write> sums: array<u32>;
             @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
                 if id.x < textureNumLayers(items) {
                     sums[id.x] = textureLoad(items, vec2(0u), id.x, 0).x
                         + textureLoad(items, vec2(1u), id.x, 0).x;
                 }
             }",
        )
}

#[track_caller]
fn shows_layers(executor: &mut Executor, wanted: u32, layers: u32) {
    let report = frame(executor, &["items", "sums", "needed"]);
    let expected = numbered(wanted, layers);
    let texels = expected.iter().flat_map(|number| [*number; 4]);
    assert_eq!(words(&report, 0), texels.collect::<Vec<_>>());
    let sums = expected.iter().map(|number| 2 * number);
    assert_eq!(words(&report, 1), sums.collect::<Vec<_>>());
    assert_eq!(words(&report, 2), [wanted]);
}

#[test]
fn the_layers_of_a_texture_grow_as_items_do() {
    let mut executor = executor(&layered(), &request(&NoProvider));
    shows_layers(&mut executor, 4, 4);
    assert_eq!(grow(&mut executor), None, "there is room");
    set(&mut executor, "wanted", ParamValue::U32(10));
    shows_layers(&mut executor, 10, 4);
    let report = grown(&mut executor);
    // A count taken from its layers follows; pipelines stay.
    assert_eq!(report.pipelines, [""; 0]);
    assert_eq!(report.resources, ["sums", "items"]);
    for _ in 0..3 {
        // A quarter more than the frame needed.
        shows_layers(&mut executor, 10, 12);
        assert_eq!(grow(&mut executor), None, "there is room now");
    }
    assert_eq!(executor.plan().grown()["items"], 12);
    // Frames do it by themselves, as far as the document lets them.
    set(&mut executor, "wanted", ParamValue::U32(1000));
    shows_layers(&mut executor, 1000, 12);
    shows_layers(&mut executor, 1000, 64);
    assert_eq!(grow(&mut executor), None);
    // The adapter's limit bounds it where the document's would not; patterns change nothing.
    let mut request = request(&NoProvider);
    request.limits.max_texture_array_layers = 9;
    request.poison = Some(0xff);
    let mut executor = host::executor(&layered(), &request);
    set(&mut executor, "wanted", ParamValue::U32(1000));
    frame(&mut executor, &[]);
    grown(&mut executor);
    shows_layers(&mut executor, 1000, 9);
    assert_eq!(grow(&mut executor), None);
}

/// Memory that is filled with a pattern before each frame, and times, know nothing of it.
#[test]
fn patterns_and_times_are_not_disturbed() {
    let mut request = request(&NoProvider);
    request.poison = Some(0xff);
    let mut executor = executor(&filled(), &request);
    set(&mut executor, "wanted", ParamValue::U32(10));
    frame(&mut executor, &[]);
    grown(&mut executor);
    let timed = Frame::new().with_timing(true).with_read(&["items"]);
    let report = submit(&mut executor, &timed);
    let mut expected = numbered(10, 12);
    expected[10..].fill(u32::MAX);
    assert_eq!(words(&report, 0), expected);
    let timing = report.timing.expect("it was asked for");
    let passes: Vec<&str> = timing
        .passes
        .iter()
        .map(|pass| pass.name.as_str())
        .collect();
    assert_eq!(passes, ["reset", "fill"]);
    assert_eq!(grow(&mut executor), None);
}

/// Gives `host.wanted`, unless it is still loading.
struct Wanted {
    version: u64,
    is_there: bool,
    number: u32,
}

impl Describe for Wanted {
    fn names(&self) -> Vec<String> {
        vec!["host.wanted".to_owned()]
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        (name == "host.wanted").then_some(Provided::new(ProvidedBinding::Storage, Some(1), 4))
    }
}

impl Provider for Wanted {
    fn version(&self, _: &str) -> u64 {
        self.version
    }

    fn has_versions(&self) -> bool {
        true
    }

    fn build(
        &mut self,
        _: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        if !self.is_there {
            return Err(ProviderError::new("it is still loading".to_owned()));
        }
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 4,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        queue.write_buffer(&buffer, 0, &self.number.to_ne_bytes());
        Ok(buffer)
    }
}

/// As [`filled`], where the number that is wanted stands in a buffer.
fn filled_from(buffer: &str) -> Files {
    let global = format!("var<storage, read> {buffer}: u32");
    filled()
        .edited("graph.ron", "Over(\"wanted\")", "Over(64)")
        .edited("fill.wgsl", "struct Params { wanted: u32 }", "")
        .edited("fill.wgsl", "var<uniform> params: Params", &global)
        .edited("fill.wgsl", "params.wanted", buffer)
}

/// A change comes while the count of the frame before is on its way, and no pass runs later.
#[test]
fn a_count_that_was_missed_is_made_up_for() {
    let on_change = |file: Files, at: &str| {
        let with_run = format!("{at}, run: OnChange");
        file.edited("graph.ron", at, &with_run)
    };
    let files = filled().edited("graph.ron", "Over(\"wanted\")", "Over(64)");
    let files = on_change(on_change(files, "target: \"needed\""), "Over(64)");
    let mut executor = executor(&files, &request(&NoProvider));
    let mut encoders = Vec::new();
    for wanted in [4, 10] {
        set(&mut executor, "wanted", ParamValue::U32(wanted));
        let mut encoder = encoder();
        executor.encode(&mut encoder, &Frame::default()).unwrap();
        encoders.push(encoder);
    }
    for encoder in encoders {
        GPU.queue.submit([encoder.finish()]);
    }
    come_to_show(&mut executor, 10, [4, 12], |executor| {
        frame(executor, &["items"])
    });
    has_room(&mut executor, 10, 12);
}

/// Frames that would compute the same again count nothing.
#[test]
fn a_change_after_frames_that_had_room_is_counted() {
    // A param that is in uniforms only, so that the plan stays.
    let files = filled().edited("graph.ron", "Over(\"wanted\")", "Over(64)");
    let mut executor = executor(&files, &request(&NoProvider));
    has_room(&mut executor, 4, 4);
    set(&mut executor, "wanted", ParamValue::U32(10));
    shows(&mut executor, 10, 4);
    grown(&mut executor);
    has_room(&mut executor, 10, 12);
    // The count of the frame before the change does not speak for those after it.
    let mut frames = encoder();
    for wanted in [11, 20] {
        set(&mut executor, "wanted", ParamValue::U32(wanted));
        executor.encode(&mut frames, &Frame::default()).unwrap();
    }
    GPU.queue.submit([frames.finish()]);
    executor.finish().unwrap();
    come_to_show(&mut executor, 20, [12, 25], |executor| {
        frame(executor, &["items"])
    });
    has_room(&mut executor, 20, 25);
}

#[track_caller]
fn has_room(executor: &mut Executor, wanted: u32, items: u32) {
    for _ in 0..3 {
        shows(executor, wanted, items);
        assert_eq!(grow(executor), None);
    }
}

#[test]
fn a_change_of_the_host_after_frames_that_had_room_is_counted() {
    let files = filled_from("host_wanted");
    let mut provider = Wanted {
        version: 0,
        is_there: true,
        number: 4,
    };
    let plan = planned(&files, &request(&provider));
    let mut executor = Executor::new(&GPU.device, &GPU.queue, plan, &mut provider).unwrap();
    for (version, (number, items)) in [(4, 4), (10, 12), (30, 37)].into_iter().enumerate() {
        (provider.version, provider.number) = (version as u64, number);
        executor.refresh(&mut provider).unwrap();
        if number > 4 {
            frame(&mut executor, &[]);
            grown_with(&mut executor, &mut provider).unwrap();
        }
        has_room(&mut executor, number, items);
    }
    // A host writes to a buffer of its own without a word.
    let (mut executor, more) = with_more(filled_from("more"), 4);
    has_room(&mut executor, 4, 4);
    write(&more, 10);
    frame(&mut executor, &[]);
    grown(&mut executor);
    has_room(&mut executor, 10, 12);
}

/// That is the host's affair, and no reason to give up.
#[test]
fn a_provider_that_fails_is_told_and_asked_again() {
    let mut provider = Wanted {
        version: 0,
        is_there: true,
        number: 10,
    };
    let files = filled_from("host_wanted");
    let plan = planned(&files, &request(&provider));
    let mut executor = Executor::new(&GPU.device, &GPU.queue, plan, &mut provider).unwrap();
    frame(&mut executor, &[]);
    (provider.version, provider.is_there) = (1, false);
    let error = grown_with(&mut executor, &mut provider).expect_err("it cannot be built");
    assert!(matches!(error, ExecuteError::Provider { .. }), "{error}");
    shows(&mut executor, 10, 4);
    provider.is_there = true;
    grown_with(&mut executor, &mut provider).unwrap();
    shows(&mut executor, 10, 12);
}

#[test]
fn a_lost_device_is_no_panic() {
    let gpu = device::open(None).unwrap_or_else(|error| panic!("{error}"));
    let mut request = PlanRequest::new([8, 8], &NoProvider);
    request
        .params
        .insert("wanted".to_owned(), ParamValue::U32(10));
    let plan = planned(&filled(), &request);
    let mut executor = Executor::new(&gpu.device, &gpu.queue, plan, &mut NoProvider).unwrap();
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    executor.encode(&mut encoder, &Frame::default()).unwrap();
    gpu.queue.submit([encoder.finish()]);
    gpu.device.destroy();
    for _ in 0..2 {
        let grown = executor.grow(&mut NoProvider);
        assert!(
            matches!(grown, Ok(None) | Err(ExecuteError::DeviceLost(_))),
            "{grown:?}"
        );
    }
}
