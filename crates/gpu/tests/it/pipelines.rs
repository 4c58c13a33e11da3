//! Pipelines that executors share, and wgpu's pipeline cache.

use crate::host::{GPU, planned, request, words};
use crate::support::Files;
use skiagraph_gpu::{
    ExecuteError, Executor, Frame, Pipelines,
    device::{self, Gpu, Wanted},
};
use skiagraph_graph::{NoProvider, ParamValue, Plan};
use std::{
    hash::{DefaultHasher, Hasher},
    sync::LazyLock,
};

/// A draw, a full-screen pass and a dispatch, each with the override `add`.
fn graph(image: &str) -> Files {
    Files::graph(
        r#"
    params: [U32(name: "add", default: 1)],
    materials: [
        Texture(name: "drawn", format: R32Uint),
        Texture(name: "image", format: R32Uint),
        Buffer(name: "list", count: 4),
    ],
    passes: [
        Raster(name: "draw", draw: 3, color: ["drawn"]),
        Fullscreen(name: "image", color: ["image"]),
        Compute(name: "count", dispatch: Groups(1, 1, 1)),
    ],
    outputs: ["drawn", "image", "list"],
"#,
    )
    .with(
        "draw.wgsl",
        "override add: u32;
         @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
             let corner = vec2(index & 1u, index >> 1u);
             return vec4<f32>(vec2<f32>(corner) * 4.0 - 1.0, 0.5, 1.0);
         }
         @fragment fn fragment() -> @location(0) u32 { return 10u + add; }",
    )
    .with("image.wgsl", image)
    .with(
        "count.wgsl",
        "override add: u32;
         var<storage, read_write> list: array<u32>;
         @compute @workgroup_size(4) fn main(@builtin(local_invocation_index) i: u32) {
             list[i] = i + add;
         }",
    )
}

const IMAGE: &str = "override add: u32;
     @fragment fn fragment() -> @location(0) u32 { return 20u + add; }";

fn plan() -> Plan {
    planned(&graph(IMAGE), &request(&NoProvider))
}

fn sharing(pipelines: &Pipelines, plan: Plan) -> Executor {
    Executor::with_pipelines(pipelines, &GPU.queue, plan, &mut NoProvider)
        .unwrap_or_else(|error| panic!("{error}"))
}

/// The first numbers of the outputs after a frame on a device.
fn firsts(executor: &mut Executor, gpu: &Gpu) -> Vec<u32> {
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let frame = Frame::new().with_read(&["drawn", "image", "list"]);
    executor.encode(&mut encoder, &frame).unwrap();
    gpu.queue.submit([encoder.finish()]);
    let report = executor.finish().unwrap();
    (0..3).map(|index| words(&report, index)[0]).collect()
}

fn add(executor: &mut Executor, value: u32) {
    let value = ParamValue::U32(value);
    executor.set_param("add", value, &mut NoProvider).unwrap();
}

#[test]
fn a_second_executor_makes_no_pipelines() -> Result<(), ExecuteError> {
    let (pipelines, queue) = (Pipelines::new(&GPU.device), &GPU.queue);
    let mut first = Executor::with_pipelines(&pipelines, queue, plan(), &mut NoProvider)?;
    assert_eq!((pipelines.made(), pipelines.kept()), (3, 3));
    // It was loaded and planned anew: texts are compared, not addresses.
    let mut second = Executor::with_pipelines(first.pipelines(), queue, plan(), &mut NoProvider)?;
    assert_eq!((pipelines.made(), pipelines.kept()), (3, 3));
    for executor in [&mut first, &mut second] {
        assert_eq!(firsts(executor, &GPU), [11, 21, 1]);
    }
    // A change of one is none of the other, and is there for it.
    add(&mut first, 5);
    assert_eq!(pipelines.made(), 6);
    assert_eq!(firsts(&mut first, &GPU), [15, 25, 5]);
    assert_eq!(firsts(&mut second, &GPU), [11, 21, 1]);
    add(&mut second, 5);
    assert_eq!(pipelines.made(), 6);
    assert_eq!(firsts(&mut second, &GPU), [15, 25, 5]);
    // Another object has its own.
    let own = sharing(&Pipelines::new(&GPU.device), plan());
    assert_eq!((own.pipelines().made(), pipelines.made()), (3, 6));
    Ok(())
}

/// Two devices that wgpu takes for one another: the first ones of two instances.
#[test]
fn executors_share_the_pipelines_of_their_device_by_default() {
    let gpus = [(); 2].map(|()| device::open(None).unwrap());
    let new = |gpu: &Gpu| {
        Executor::new(&gpu.device, &gpu.queue, plan(), &mut NoProvider)
            .unwrap_or_else(|error| panic!("{error}"))
    };
    let mut executors = Vec::new();
    for gpu in &gpus {
        executors.extend([new(gpu), new(gpu)]);
        assert_eq!(gpu.pipelines.made(), 3);
    }
    for (executor, gpu) in executors
        .iter_mut()
        .zip([&gpus[0], &gpus[0], &gpus[1], &gpus[1]])
    {
        assert_eq!(executor.pipelines().made(), 3);
        assert_eq!(firsts(executor, gpu), [11, 21, 1]);
    }
}

/// A clone is the same plan, whatever becomes of the other.
#[test]
fn a_plan_and_its_clone_serve_an_executor_each() {
    let plan = plan();
    let pipelines = Pipelines::new(&GPU.device);
    let mut first = sharing(&pipelines, plan.clone());
    add(&mut first, 5);
    let mut second = sharing(&pipelines, plan);
    assert_eq!(firsts(&mut first, &GPU), [15, 25, 5]);
    assert_eq!(firsts(&mut second, &GPU), [11, 21, 1]);
}

/// Each part of a pipeline makes another one of it; the others are shared.
#[test]
fn only_what_differs_is_made() {
    let edits = [
        ("image.wgsl", "20u", "30u", 1),
        (
            "graph.ron",
            "name: \"image\", format: R32Uint",
            "name: \"image\", format: R16Uint",
            1,
        ),
        ("graph.ron", "draw: 3,", "draw: 3, cull: Front,", 1),
        ("graph.ron", "draw: 3,", "draw: 6,", 0),
        ("graph.ron", "default: 1", "default: 2", 3),
        ("count.wgsl", "fn main", "fn other", 1),
    ];
    let pipelines = Pipelines::new(&GPU.device);
    let _first = sharing(&pipelines, plan());
    for (path, from, to, made) in edits {
        let before = pipelines.made();
        let files = graph(IMAGE).edited(path, from, to);
        let _other = sharing(&pipelines, planned(&files, &request(&NoProvider)));
        assert_eq!(pipelines.made() - before, made, "{path}: {from} -> {to}");
    }
}

#[test]
fn a_prepared_plan_finds_the_shared_pipelines() {
    let pipelines = Pipelines::new(&GPU.device);
    let mut drawing = sharing(&pipelines, plan());
    let other = plan().with_param("add", ParamValue::U32(7)).unwrap();
    let other_again = plan().with_param("add", ParamValue::U32(7)).unwrap();
    let _another = sharing(&pipelines, other);
    assert_eq!(pipelines.made(), 6);
    let preparer = drawing.preparer();
    let making = std::thread::spawn(move || preparer.prepare(other_again));
    let prepared = making.join().unwrap().unwrap();
    let report = drawing.replace(prepared, &mut NoProvider).unwrap();
    assert_eq!(report.pipelines, ["draw", "image", "count"]);
    assert_eq!(pipelines.made(), 6, "all were there");
    assert_eq!(firsts(&mut drawing, &GPU), [17, 27, 7]);
}

/// A slider over an override makes a pipeline for each value, of which not all are kept.
#[test]
fn pipelines_without_a_user_do_not_pile_up() {
    let pipelines = Pipelines::new(&GPU.device);
    let mut executor = sharing(&pipelines, plan());
    for value in 2..50 {
        add(&mut executor, value);
    }
    assert_eq!(pipelines.made(), 3 * 49);
    // At the last change, those of the plan before were still in use.
    assert_eq!(pipelines.kept(), 64 + 3 + 3);
    // The last ones are still there, the first ones are made again.
    add(&mut executor, 40);
    assert_eq!(pipelines.made(), 3 * 49);
    add(&mut executor, 2);
    assert_eq!(pipelines.made(), 3 * 50);
    assert_eq!(firsts(&mut executor, &GPU), [12, 22, 2]);
}

/// A device with `PIPELINE_CACHE`, which Vulkan always offers.
static CACHING: LazyLock<Gpu> = LazyLock::new(|| {
    let wanted = Wanted::default().with_features(wgpu::Features::PIPELINE_CACHE);
    let gpu = device::open_with(&wanted).unwrap_or_else(|error| panic!("{error}"));
    let features = gpu.device.features();
    assert!(
        features.contains(wgpu::Features::PIPELINE_CACHE),
        "these tests need an adapter with pipeline caches: run them on Vulkan"
    );
    gpu
});

fn cache_of(gpu: &Gpu, data: Option<&[u8]>) -> wgpu::PipelineCache {
    #[expect(unsafe_code, reason = "wgpu has the host vouch for the data")]
    // SAFETY: the data are those of `get_data` or have a header that wgpu refuses.
    unsafe {
        gpu.device
            .create_pipeline_cache(&wgpu::PipelineCacheDescriptor {
                label: None,
                data,
                fallback: true,
            })
    }
}

fn with_cache(gpu: &Gpu, data: Option<&[u8]>) -> (Pipelines, Executor) {
    let pipelines = Pipelines::with_cache(&gpu.device, cache_of(gpu, data));
    let executor = Executor::with_pipelines(&pipelines, &gpu.queue, plan(), &mut NoProvider);
    let executor = executor.unwrap_or_else(|error| panic!("{error}"));
    (pipelines, executor)
}

#[test]
fn a_pipeline_cache_is_taken_and_given_back() {
    let (pipelines, mut cold) = with_cache(&CACHING, None);
    assert_eq!(firsts(&mut cold, &CACHING), [11, 21, 1]);
    let data = pipelines.cache().and_then(wgpu::PipelineCache::get_data);
    let data = data.expect("wgpu gives data of a cache that it takes");
    let (pipelines, mut warm) = with_cache(&CACHING, Some(&data));
    assert_eq!(pipelines.made(), 3);
    assert_eq!(firsts(&mut warm, &CACHING), [11, 21, 1]);
}

/// With `fallback`, wgpu takes broken data and those of another driver for none; data of another
/// adapter it refuses, where the host makes the cache.
#[test]
fn data_of_another_driver_make_an_empty_cache() {
    let (pipelines, _) = with_cache(&CACHING, None);
    let data = pipelines.cache().and_then(wgpu::PipelineCache::get_data);
    let data = data.expect("wgpu gives data of a cache that it takes");
    let changed = |at: usize| {
        let mut data = data.clone();
        data[at] ^= 0xff;
        data
    };
    // wgpu's header: 8 bytes of magic, 4 of its version, 4 of ABI, 1 of the backend, 15 of the
    // adapter, 16 of the driver.
    for data in [changed(0), changed(8), changed(40), data[..20].to_vec()] {
        let (pipelines, mut executor) = with_cache(&CACHING, Some(&data));
        assert_eq!(pipelines.made(), 3);
        assert_eq!(firsts(&mut executor, &CACHING), [11, 21, 1]);
    }
    let scope = CACHING
        .device
        .push_error_scope(wgpu::ErrorFilter::Validation);
    let refused = cache_of(&CACHING, Some(&changed(20)));
    let error = pollster::block_on(scope.pop()).expect("the adapter is another one");
    assert!(error.to_string().contains("different device"), "{error}");
    // A host that goes on with it hears of it again, by the pass.
    assert_refused(&Pipelines::with_cache(&CACHING.device, refused));
}

/// An object with kept shaders, after a frame; returns what it hands out when all handles are gone.
fn keeps(gpu: &Gpu, kept: Vec<u8>) -> Option<Vec<u8>> {
    let (sender, receiver) = std::sync::mpsc::channel();
    let keep = move |bytes| sender.send(bytes).unwrap();
    let pipelines = Pipelines::with_kept(&gpu.device, kept, keep);
    let executor = Executor::with_pipelines(&pipelines, &gpu.queue, plan(), &mut NoProvider);
    let mut executor = executor.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(pipelines.made(), 3);
    drop(pipelines);
    assert_eq!(firsts(&mut executor, gpu), [11, 21, 1]);
    assert!(receiver.try_recv().is_err(), "the executor has a handle");
    drop(executor);
    receiver.try_recv().ok()
}

#[test]
fn kept_shaders_are_handed_out_at_the_end_and_taken_again() {
    let first = keeps(&CACHING, Vec::new()).expect("there was nothing before");
    // A driver may order them anew.
    assert_ne!(keeps(&CACHING, first.clone()).as_ref(), Some(&first));
    let torn = first[..first.len() - 1].to_vec();
    let longer = [&first[..], &[0]].concat();
    for broken in [torn, longer, b"no shaders".to_vec()] {
        assert!(keeps(&CACHING, broken).is_some(), "they are made anew");
    }
    // A device without the feature keeps nothing.
    assert_eq!(keeps(&GPU, Vec::new()), None);
}

/// Shaders of another adapter are whole, and wgpu refuses them: as if there were none.
#[test]
fn kept_shaders_of_another_adapter_do_no_harm() {
    let first = keeps(&CACHING, Vec::new()).expect("there was nothing before");
    let mut other = first[..first.len() - 8].to_vec();
    other[20] ^= 0xff;
    let mut hasher = DefaultHasher::new();
    hasher.write(&other);
    other.extend(hasher.finish().to_le_bytes());
    assert!(keeps(&CACHING, other).is_some());
}

/// They are made at the same time, and each once: modules that several use, too.
#[test]
fn many_pipelines_are_made_once_each() {
    let passes = (0..90).map(|at| {
        let dispatch = "dispatch: Groups(1, 1, 1)";
        let (shader, entry) = (at / 2 % 40, ["main", "other"][at % 2]);
        format!(r#"Compute(name: "p{at}", shader: "s{shader}", entry: "{entry}", {dispatch}),"#)
    });
    let document = format!(
        r#"
    materials: [Buffer(name: "list", count: 4, keep: true)],
    passes: [{}],
    outputs: ["list"],
"#,
        passes.collect::<String>()
    );
    let shader = |files: Files, at: u32| {
        let text = format!(
            "var<storage, read_write> list: array<u32>;
             @compute @workgroup_size(1) fn main() {{ list[{}] += {at}u; }}
             @compute @workgroup_size(1) fn other() {{ list[{}] += 1u; }}",
            at % 4,
            at % 2,
        );
        files.with(&format!("s{at}.wgsl"), &text)
    };
    let files = (0..40).fold(Files::graph(&document), shader);
    let pipelines = Pipelines::new(&GPU.device);
    let plan = planned(&files, &request(&NoProvider));
    let preparer = sharing(&pipelines, plan.clone()).preparer();
    assert_eq!((pipelines.made(), pipelines.kept()), (80, 80));
    preparer.prepare(plan.clone()).unwrap();
    drop(sharing(&pipelines, plan));
    assert_eq!(pipelines.made(), 80);
}

#[test]
fn a_cache_of_another_device_is_refused_by_name() {
    let mut other = CACHING.clone();
    let descriptor = wgpu::DeviceDescriptor {
        required_features: wgpu::Features::PIPELINE_CACHE,
        ..wgpu::DeviceDescriptor::default()
    };
    let made = pollster::block_on(other.adapter.request_device(&descriptor));
    (other.device, other.queue) = made.unwrap_or_else(|error| panic!("{error}"));
    assert_refused(&Pipelines::with_cache(
        &CACHING.device,
        cache_of(&other, None),
    ));
}

fn assert_refused(pipelines: &Pipelines) {
    let made = Executor::with_pipelines(pipelines, &CACHING.queue, plan(), &mut NoProvider);
    match made.map(drop) {
        Err(ExecuteError::Gpu { pass, message, .. }) => assert_eq!(pass, "draw", "{message}"),
        other => panic!("a cache that is none of the device's: {other:?}"),
    }
    // Refused ones are not kept.
    assert_eq!((pipelines.made(), pipelines.kept()), (0, 0));
}
