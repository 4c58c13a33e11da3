//! Needs of a host program: views of outputs, provided resources, a lost device, threads.

use crate::given::{KIND, SAMPLED, STORAGE, buffer, content, sums, sums_request};
use crate::host::{GPU, encoder, executor, frame, numbers, planned, request};
use crate::support::Files;
use skiagraph_gpu::{
    ExecuteError, Executor, Frame, FrameReport, Prepared, Provider, ProviderError, device,
};
use skiagraph_graph::{
    Describe, Graph, NoProvider, Plan, PlanRequest, Provided, ProvidedBinding, Registry,
};

/// The host's own pass reads the outputs in the encoder in which the graph made them.
#[test]
fn the_host_binds_what_the_graph_made() {
    let files = Files::graph(
        r#"
    materials: [Texture(name: "image", format: R32Uint), Buffer(name: "items", count: 64)],
    passes: [
        Fullscreen(name: "draw", color: ["image"]),
        Compute(name: "fill", dispatch: Over("items.count")),
    ],
    outputs: ["image", "items"],
"#,
    )
    .with(
        "draw.wgsl",
        "@fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) u32 {
             return u32(at.x) + 8u * u32(at.y);
         }",
    )
    .with(
        "fill.wgsl",
        "var<storage, read_write> items: array<u32>;
         @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
             items[id.x] = 100u;
         }",
    );
    let mut executor = executor(&files, &request(&NoProvider));
    let mut encoder = encoder();
    executor.encode(&mut encoder, &Frame::default()).unwrap();
    let image = executor.output_view("image").expect("it is an output");
    let items = executor.output_buffer("items").expect("it is an output");
    assert!(executor.output_view("items").is_none());
    assert!(executor.output_buffer("image").is_none());
    assert!(executor.output_view("picture").is_none());

    let module = GPU
        .device
        .create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(
                "@group(0) @binding(0) var image: texture_2d<u32>;
             @group(0) @binding(1) var<storage, read_write> sum: array<u32>;
             @compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) at: vec3<u32>) {
                 sum[at.x + 8u * at.y] += textureLoad(image, at.xy, 0).x;
             }"
                .into(),
            ),
        });
    let pipeline = GPU
        .device
        .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: None,
            module: &module,
            entry_point: None,
            compilation_options: Default::default(),
            cache: None,
        });
    let sum = buffer(&[0; 64], STORAGE | wgpu::BufferUsages::COPY_DST);
    encoder.copy_buffer_to_buffer(&items, 0, &sum, 0, None);
    let group = GPU.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[
            wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(&image),
            },
            wgpu::BindGroupEntry {
                binding: 1,
                resource: sum.as_entire_binding(),
            },
        ],
    });
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups(1, 1, 1);
    drop(pass);
    assert_eq!(content(&sum, encoder), (100..164).collect::<Vec<u32>>());
}

/// Gives one number under the name `host.number`, another buffer for each version.
struct Number {
    version: u64,
    is_there: bool,
    built: u32,
}

impl Number {
    fn new() -> Self {
        Self {
            version: 0,
            is_there: true,
            built: 0,
        }
    }
}

/// ```text
/// host.number ─▶ take (OnChange) ─▶ copy
/// ```
fn taker() -> Files {
    Files::graph(
        r#"
    materials: [Buffer(name: "copy", count: 1)],
    passes: [Compute(name: "take", run: OnChange, dispatch: Groups(1, 1, 1))],
    outputs: ["copy"],
"#,
    )
    .with(
        "take.wgsl",
        "var<storage, read> host_number: array<u32>; var<storage, read_write> copy: array<u32>;
         @compute @workgroup_size(1) fn main() { copy[0] = host_number[0]; }",
    )
}

impl Describe for Number {
    fn names(&self) -> Vec<String> {
        vec!["host.number".to_owned(), "host.unused".to_owned()]
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        let is_named = self.names().iter().any(|own_name| own_name == name);
        is_named.then_some(Provided::new(ProvidedBinding::Storage, Some(1), 4))
    }
}

impl Provider for Number {
    fn version(&self, _: &str) -> u64 {
        self.version
    }

    fn build(
        &mut self,
        name: &str,
        _: &wgpu::Device,
        _: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        if name == "host.unused" {
            return Err(ProviderError::new("no pass reads it".to_owned()));
        }
        if !self.is_there {
            return Err(ProviderError::new("it is still loading".to_owned()));
        }
        self.built += 1;
        Ok(buffer(
            &[100 + self.version as u32],
            STORAGE | wgpu::BufferUsages::COPY_DST,
        ))
    }
}

#[test]
fn provided_resources_change_when_the_host_says_so() {
    let mut provider = Number::new();
    let plan = planned(&taker(), &request(&provider));
    let mut executor = Executor::new(&GPU.device, &GPU.queue, plan, &mut provider).unwrap();
    let step = |executor: &mut Executor, ran: bool, number: u32| {
        let report = frame(executor, &["copy"]);
        let skipped: &[&str] = if ran { &[] } else { &["take"] };
        assert_eq!(report.skipped, skipped);
        assert_eq!(report.readbacks[0].content.as_u32().unwrap(), [number]);
    };
    step(&mut executor, true, 100);
    step(&mut executor, false, 100);
    executor.refresh(&mut provider).unwrap();
    step(&mut executor, false, 100);
    provider.version = 1;
    step(&mut executor, false, 100); // not refreshed yet
    provider.is_there = false;
    let error = executor.refresh(&mut provider).expect_err("it fails");
    assert!(
        error
            .to_string()
            .contains("`host.number` could not be built: it is still loading"),
        "{error}"
    );
    step(&mut executor, false, 100);
    provider.is_there = true;
    executor.refresh(&mut provider).unwrap();
    step(&mut executor, true, 101);
    step(&mut executor, false, 101);
    executor.touch("host.number").unwrap();
    step(&mut executor, true, 101);
    step(&mut executor, false, 101);
    assert_eq!(provider.built, 2, "once for each version");
    executor
        .touch("host.unused")
        .expect("that no live pass uses it is no mistake");
    for name in ["host.numbers", "copy"] {
        let error = executor.touch(name).expect_err("it is not the host's");
        assert_eq!(
            error.to_string(),
            format!(
                "neither an import nor a provided resource is called `{name}`; live passes use \
                 host.number"
            )
        );
    }
}

#[test]
fn a_lost_device_comes_back_as_an_error() {
    lose_the_device(true);
    lose_the_device(false);
}

/// Makes the inputs of [`sums`] on another device.
fn made(device: &wgpu::Device) -> (wgpu::Texture, wgpu::Buffer) {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d {
            width: 8,
            height: 8,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: KIND.format,
        usage: SAMPLED | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 4,
        usage: STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    (texture, buffer)
}

/// Every method that needs the device says that it is lost; none panics.
fn lose_the_device(before: bool) {
    let gpu = device::open(None).unwrap_or_else(|error| panic!("{error}"));
    let request = sums_request();
    let plan = |files: &Files, request: &PlanRequest<'_>| planned(files, request);
    let ((image, more), (late, later)) = (made(&gpu.device), made(&gpu.device));
    let mut executor = Executor::new(
        &gpu.device,
        &gpu.queue,
        plan(&sums(), &request),
        &mut NoProvider,
    )
    .unwrap();
    executor.import_texture("image", &image).unwrap();
    executor.import_buffer("more", &more).unwrap();
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let read = Frame::new().with_read(&["sum"]).with_timing(true);
    executor.encode(&mut encoder, &read).unwrap();
    gpu.queue.submit([encoder.finish()]);
    // It is asked what the frame brings before the loss in one run, after it in the other.
    let early = before.then(|| executor.poll().unwrap()).flatten();
    let mut encoder = gpu.device.create_command_encoder(&Default::default());

    gpu.device.destroy();
    // Work done in time may still come.
    if early.is_none() {
        let outcome =
            std::iter::repeat_with(|| executor.poll()).find(|outcome| !matches!(outcome, Ok(None)));
        assert!(
            matches!(outcome, Some(Ok(_) | Err(ExecuteError::DeviceLost(_)))),
            "{outcome:?}"
        );
    }
    let none = &mut NoProvider;
    let results = [
        ("encode", executor.encode(&mut encoder, &read).map(|_| ())),
        ("import_texture", executor.import_texture("image", &late)),
        ("import_buffer", executor.import_buffer("more", &later)),
        ("finish", executor.finish().map(|_| ())),
        ("finish again", executor.finish().map(|_| ())),
        // Although nothing is under way.
        ("poll", executor.poll().map(|_| ())),
        ("take_faults", executor.take_faults().map(|_| ())),
        ("grow", executor.grow(none).map(|_| ())),
        ("refresh", executor.refresh(none)),
        ("resize", executor.resize([9, 9], none).map(|_| ())),
        (
            "replace_graph",
            executor
                .replace_graph(plan(&sums(), &request), none)
                .map(|_| ()),
        ),
        (
            "new",
            Executor::new(&gpu.device, &gpu.queue, plan(&sums(), &request), none).map(|_| ()),
        ),
    ];
    for (method, result) in results {
        let error = result.expect_err(method);
        assert!(
            matches!(error, ExecuteError::DeviceLost(_)),
            "{method}: {error}"
        );
    }
    // Nothing to be said, and nothing to go wrong.
    executor.touch("image").unwrap();
    assert!(executor.output_view("sum").is_some());
}

/// An executor asks for a mapping to find out if its device is there, which a poll may bring.
#[test]
fn other_threads_may_poll_while_frames_are_encoded() {
    let gpu = device::open(None).unwrap_or_else(|error| panic!("{error}"));
    let plan = planned(&sums(), &sums_request());
    let mut executor = Executor::new(&gpu.device, &gpu.queue, plan, &mut NoProvider).unwrap();
    let is_over = std::sync::atomic::AtomicBool::new(false);
    std::thread::scope(|threads| {
        for _ in 0..2 {
            threads.spawn(|| {
                while !is_over.load(std::sync::atomic::Ordering::Relaxed) {
                    gpu.device.poll(wgpu::PollType::Poll).unwrap();
                }
            });
        }
        let lost = (0..5000).find_map(|_| {
            let (image, _) = made(&gpu.device);
            executor.import_texture("image", &image).err()
        });
        is_over.store(true, std::sync::atomic::Ordering::Relaxed);
        assert!(lost.is_none(), "{lost:?}");
    });
}

/// A host may plan on one thread and encode on another.
#[test]
fn plans_and_executors_can_go_to_other_threads() {
    fn sent<T: Send>() {}
    fn shared<T: Sync>() {}
    sent::<Executor>();
    sent::<Plan>();
    shared::<Plan>();
    sent::<Graph>();
    shared::<Graph>();
    let planning = std::thread::spawn(|| planned(&taker(), &request(&Number::new())));
    let plan = planning.join().expect("planning does not panic");
    let mut executor = Executor::new(&GPU.device, &GPU.queue, plan, &mut Number::new()).unwrap();
    let frames = std::thread::spawn(move || numbers(&mut executor, "copy"));
    assert_eq!(frames.join().expect("encoding does not panic"), [100]);
}

/// As a host's loop does it: at most so many frames ahead of the GPU, and reports as they come.
#[test]
fn a_host_that_does_not_wait() {
    const AHEAD: usize = 3;
    let mut provider = Number::new();
    let plan = planned(&taker(), &request(&provider));
    let mut executor = Executor::new(&GPU.device, &GPU.queue, plan, &mut provider).unwrap();
    let mut seen = Vec::new();
    let mut show = |report: FrameReport| seen.push(report.index);
    let wanted = Frame::new().with_timing(true).with_read(&["copy"]);
    for _ in 0..10 {
        if executor.under_way() >= AHEAD {
            show(executor.finish().unwrap()); // the only call that waits
        }
        let mut encoder = encoder();
        executor.encode(&mut encoder, &wanted).unwrap();
        GPU.queue.submit([encoder.finish()]);
        while let Some(report) = executor.poll().unwrap() {
            show(report);
        }
    }
    while executor.under_way() > 0 {
        show(executor.finish().unwrap());
    }
    assert_eq!(seen, (0..10).collect::<Vec<u32>>());
}

/// A graph that is edited while it is drawn: made ready on another thread, put in when it is, and
/// the last good one stays where it has a mistake.
#[test]
fn a_graph_is_made_ready_on_another_thread() {
    let mut provider = Number::new();
    let plan = planned(&taker(), &request(&provider));
    let mut executor = Executor::new(&GPU.device, &GPU.queue, plan, &mut provider).unwrap();
    assert_eq!(numbers(&mut executor, "copy"), [100]);
    let reload = |files: Files| {
        move || -> Result<Plan, ExecuteError> {
            let graph = Graph::load("graph.ron", &Registry::standard(), &files)?;
            Ok(graph.plan(&request(&Number::new()))?)
        }
    };
    for (text, expected) in [
        ("host_number[0] + 1u", Some(101)),
        ("host_number[0] +", None),
        ("host_number[0] + 2u", Some(102)),
    ] {
        let load = reload(taker().edited("take.wgsl", "host_number[0]", text));
        let preparer = executor.preparer();
        let making = std::thread::spawn(move || -> Result<Prepared, ExecuteError> {
            preparer.prepare(load()?)
        });
        while !making.is_finished() {
            frame(&mut executor, &["copy"]); // the graph that there is
        }
        let before = numbers(&mut executor, "copy");
        match making.join().expect("preparing does not panic") {
            Ok(prepared) => {
                let report = executor.replace(prepared, &mut provider).unwrap();
                assert_eq!(report.pipelines, ["take"]);
            }
            Err(error) => assert!(error.to_string().contains("take.wgsl"), "{error}"),
        }
        let now = numbers(&mut executor, "copy");
        assert_eq!(now, expected.map_or(before, |number| vec![number]));
    }
}
