//! What a host program relies on: imports, views of outputs, provided resources, errors before
//! anything is encoded.

#[path = "support/host.rs"]
mod host;
#[path = "../../graph/tests/support/mod.rs"]
mod support;

use skiagraph_graph::{
    ExecuteError, Executor, Frame, Graph, Import, NoProvider, Plan, PlanRequest, Provided,
    Provider, ProviderError, gpu,
};
use support::{
    Files,
    host::{GPU, encoder, executor, frame, numbers, planned, request},
};
use wgpu::util::DeviceExt;

/// The numbers in a buffer of the host.
fn content(buffer: &wgpu::Buffer, mut encoder: wgpu::CommandEncoder) -> Vec<u32> {
    let arrived = GPU.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: buffer.size(),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    encoder.copy_buffer_to_buffer(buffer, 0, &arrived, 0, None);
    GPU.queue.submit([encoder.finish()]);
    arrived.map_async(wgpu::MapMode::Read, .., |result| {
        result.expect("a buffer that was just made can be mapped");
    });
    GPU.device
        .poll(wgpu::PollType::wait_indefinitely())
        .expect("the device is there");
    let bytes = arrived
        .get_mapped_range(..)
        .expect("it was mapped")
        .to_vec();
    bytemuck::pod_collect_to_vec(&bytes)
}

const SAMPLED: wgpu::TextureUsages = wgpu::TextureUsages::TEXTURE_BINDING;
const STORAGE: wgpu::BufferUsages = wgpu::BufferUsages::STORAGE;

struct Kind {
    format: wgpu::TextureFormat,
    edge: u32,
    mips: u32,
    layers: u32,
    usage: wgpu::TextureUsages,
}

/// What `WORN` reads.
const KIND: Kind = Kind {
    format: wgpu::TextureFormat::R32Uint,
    edge: 8,
    mips: 1,
    layers: 1,
    usage: SAMPLED,
};

/// A texture of the host, every texel of its first mip and layer `value`.
fn texture(kind: &Kind, value: u32) -> wgpu::Texture {
    let texture = GPU.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d {
            width: kind.edge,
            height: kind.edge,
            depth_or_array_layers: kind.layers,
        },
        mip_level_count: kind.mips,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: kind.format,
        usage: kind.usage | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let texels = vec![value; (kind.edge * kind.edge) as usize];
    GPU.queue.write_texture(
        texture.as_image_copy(),
        bytemuck::cast_slice(&texels),
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(kind.edge * 4),
            rows_per_image: None,
        },
        wgpu::Extent3d {
            width: kind.edge,
            height: kind.edge,
            depth_or_array_layers: 1,
        },
    );
    texture
}

fn buffer(numbers: &[u32], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    GPU.device
        .create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents: bytemuck::cast_slice(numbers),
            usage: usage | wgpu::BufferUsages::COPY_SRC,
        })
}

/// ```text
/// host.image, host.more ─▶ add ─▶ sum
/// ```
fn sums() -> Files {
    Files::new([
        (
            "graph.ron",
            "(format: 2, materials: [Texture(name: \"sum\", format: R32Uint)],
              passes: [Fullscreen(name: \"add\", color: [\"sum\"])], outputs: [(name: \
                  \"sum\")])",
        ),
        (
            "add.wgsl",
            "var host_image: texture_2d<u32>;
             var<storage, read> host_more: array<u32>;
             @fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) u32 {
                 return textureLoad(host_image, vec2<u32>(at.xy), 0).x + host_more[0];
             }",
        ),
    ])
}

fn sums_request() -> PlanRequest<'static> {
    let mut request = request(&NoProvider);
    let (image, more) = (texture(&KIND, 0), buffer(&[0], STORAGE));
    request.imports.extend([
        ("host.image".to_owned(), import::texture(&image)),
        ("host.more".to_owned(), import::buffer(&more, None)),
    ]);
    request
}

#[test]
fn what_the_host_hands_over_arrives() {
    let mut executor = executor(&sums(), &sums_request());
    let (image, more) = (texture(&KIND, 5), buffer(&[2], STORAGE));
    executor.import_texture("host.image", &image).unwrap();
    executor.import_buffer("host.more", &more).unwrap();
    assert_eq!(numbers(&mut executor, "sum"), [7; 64]);
    // Another one, and one that was made for more than the plan knows of.
    executor
        .import_texture("host.image", &texture(&KIND, 30))
        .unwrap();
    assert_eq!(numbers(&mut executor, "sum"), [32; 64]);
    let more = buffer(&[4], STORAGE | wgpu::BufferUsages::INDIRECT);
    executor.import_buffer("host.more", &more).unwrap();
    assert_eq!(numbers(&mut executor, "sum"), [34; 64]);
    // A plan with the same imports keeps them.
    let plan = planned(&sums(), &sums_request());
    executor.replace_graph(plan, &mut NoProvider).unwrap();
    assert_eq!(numbers(&mut executor, "sum"), [34; 64]);
}

#[test]
fn what_was_not_planned_for_is_refused_by_name() {
    let mut executor = executor(&sums(), &sums_request());
    let (image, more) = (texture(&KIND, 5), buffer(&[2], STORAGE));
    executor.import_texture("host.image", &image).unwrap();
    executor.import_buffer("host.more", &more).unwrap();
    let format = wgpu::TextureFormat::R32Float;
    let kinds = [
        (Kind { format, ..KIND }, "format is R32Float, not R32Uint"),
        (Kind { edge: 16, ..KIND }, "size is [16, 16], not [8, 8]"),
        (Kind { mips: 2, ..KIND }, "number of mips is 2, not 1"),
        (Kind { layers: 3, ..KIND }, "number of layers is 3, not 1"),
        (
            Kind {
                usage: wgpu::TextureUsages::COPY_SRC,
                ..KIND
            },
            "usage is TextureUsages(COPY_DST), not TextureUsages(COPY_DST | TEXTURE_BINDING)",
        ),
    ];
    let mut refused: Vec<(Result<(), ExecuteError>, &str)> = kinds
        .iter()
        .map(|(kind, why)| {
            let texture = texture(kind, 9);
            (executor.import_texture("host.image", &texture), *why)
        })
        .collect();
    let image = texture(&KIND, 9);
    refused.extend([
        (
            executor.import_buffer("host.more", &buffer(&[9, 9], STORAGE)),
            "size in bytes is 8, not 4",
        ),
        (
            executor.import_buffer("host.more", &buffer(&[9], wgpu::BufferUsages::UNIFORM)),
            "usage is",
        ),
        (
            executor.import_buffer("host.image", &buffer(&[9], STORAGE)),
            "it is a buffer, not a texture",
        ),
        (
            executor.import_texture("host.more", &image),
            "it is a texture, not a buffer",
        ),
        (
            executor.import_texture("host.picture", &image),
            "the plan has no import `host.picture`; it has host.image, host.more",
        ),
        (
            executor.import_texture("sum", &image),
            "the plan has no import `sum`",
        ),
    ]);
    for (result, why) in refused {
        let message = result.expect_err(why).to_string();
        assert!(message.contains(why), "{message}\nshould say: {why}");
    }
    assert_eq!(
        numbers(&mut executor, "sum"),
        [7; 64],
        "what was refused took nobody's place"
    );
}

/// The error comes before anything is encoded: the host's encoder is as good as before.
#[test]
fn a_missing_import_leaves_the_encoder_alone() {
    let mut executor = executor(&sums(), &sums_request());
    executor
        .import_texture("host.image", &texture(&KIND, 5))
        .unwrap();
    let mut host = encoder();
    let error = executor
        .encode(&mut host, &Frame::default())
        .expect_err("host.more is missing");
    assert!(
        matches!(&error, ExecuteError::NotImported { name, pass, .. } if name == "host.more" && pass == "add"),
        "{error}"
    );
    let scope = GPU.device.push_error_scope(wgpu::ErrorFilter::Validation);
    assert_eq!(content(&buffer(&[3, 4], STORAGE), host), [3, 4]);
    let fault = pollster::block_on(scope.pop());
    assert!(fault.is_none(), "{fault:?}");
    executor
        .import_buffer("host.more", &buffer(&[1], STORAGE))
        .unwrap();
    assert_eq!(numbers(&mut executor, "sum"), [6; 64]);
}

/// ```text
/// count ─▶ host.counter ;  idle ─▶ nobody
/// ```
#[test]
fn a_pass_that_writes_for_the_host_runs() {
    let files = Files::new([
        (
            "graph.ron",
            "(format: 2, materials: [Texture(name: \"image\", format: R32Uint), \
             Texture(name: \"nobody\", format: R32Uint)],
              passes: [Compute(name: \"count\", dispatch: Groups(1, 1, 1)), Fullscreen(name: \
                  \"idle\", shader: \"draw\", color: [\"nobody\"]),
                       Fullscreen(name: \"draw\", color: [\"image\"])],
              outputs: [\"image\"])",
        ),
        (
            "count.wgsl",
            "var<storage, read_write> host_counter: array<u32>;
             @compute @workgroup_size(1) fn main() { host_counter[0] += 10u; }",
        ),
        (
            "draw.wgsl",
            "@fragment fn fragment() -> @location(0) u32 { return 1u; }",
        ),
    ]);
    let counter = buffer(&[5, 6], STORAGE);
    let mut request = request(&NoProvider);
    request
        .imports
        .insert("host.counter".to_owned(), import::buffer(&counter, Some(2)));
    let mut executor = executor(&files, &request);
    let live: Vec<String> = executor
        .plan()
        .passes()
        .into_iter()
        .map(|pass| pass.name)
        .collect();
    assert_eq!(live, ["count", "draw"]);
    executor.import_buffer("host.counter", &counter).unwrap();
    frame(&mut executor, &[]);
    frame(&mut executor, &[]);
    assert_eq!(content(&counter, encoder()), [25, 6]);
}

/// An output may be an import. Whether it can be read back is up to the host, and said before
/// anything is encoded.
#[test]
fn an_import_is_read_back_if_it_was_made_for_that() {
    let files = Files::new([
        (
            "graph.ron",
            "(format: 2, passes: [Fullscreen(name: \"draw\", color: [(target: \"host.image\")])], \
             outputs: [(name: \"host.image\")])",
        ),
        (
            "draw.wgsl",
            "@fragment fn fragment() -> @location(0) u32 { return 3u; }",
        ),
    ]);
    let drawn = wgpu::TextureUsages::RENDER_ATTACHMENT;
    for (usage, is_readable) in [
        (drawn, false),
        (drawn | wgpu::TextureUsages::COPY_SRC, true),
    ] {
        let image = texture(&Kind { usage, ..KIND }, 0);
        let mut request = request(&NoProvider);
        let described = import::texture(&image);
        request.imports.insert("host.image".to_owned(), described);
        let mut executor = executor(&files, &request);
        executor.import_texture("host.image", &image).unwrap();
        let read = Frame {
            read: &["host.image"],
            ..Frame::default()
        };
        match executor.encode(&mut encoder(), &read) {
            Ok(()) => assert!(is_readable),
            Err(error) => {
                assert!(!is_readable);
                let why = "`host.image` cannot be read back: the host must make it with \
                    TextureUsages::COPY_SRC";
                assert_eq!(error.to_string(), why);
                frame(&mut executor, &[]);
                continue;
            }
        }
        assert_eq!(numbers(&mut executor, "host.image"), [3; 64]);
    }
}

/// The host's own pass reads the outputs in the encoder in which the graph made them.
#[test]
fn the_host_binds_what_the_graph_made() {
    let files = Files::new([
        (
            "graph.ron",
            "(format: 2, materials: [Texture(name: \"image\", format: R32Uint), \
             Buffer(name: \"items\", count: 64)],
              passes: [Fullscreen(name: \"draw\", color: [\"image\"]), Compute(name: \
                  \"fill\", dispatch: Over(\"items\"))],
              outputs: [\"image\", \"items\"])",
        ),
        (
            "draw.wgsl",
            "@fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) u32 { return \
             u32(at.x) + 8u * u32(at.y); }",
        ),
        (
            "fill.wgsl",
            "var<storage, read_write> items: array<u32>;
             @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) { items[id.x] = 100u; }",
        ),
    ]);
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

/// A host's imports follow its viewport, so both change at once, and the imports are handed over
/// again.
#[test]
fn another_viewport_with_other_imports() {
    let mut executor = executor(&sums(), &sums_request());
    let more = buffer(&[2], STORAGE);
    executor
        .import_texture("host.image", &texture(&KIND, 5))
        .unwrap();
    executor.import_buffer("host.more", &more).unwrap();
    assert_eq!(numbers(&mut executor, "sum"), [7; 64]);

    let image = texture(&Kind { edge: 16, ..KIND }, 40);
    let plan = executor
        .plan()
        .with(|request| {
            request.viewport = [16, 16];
            let image = import::texture(&image);
            request.imports.insert("host.image".to_owned(), image);
        })
        .unwrap();
    let report = executor.replace_graph(plan, &mut NoProvider).unwrap();
    assert_eq!(report.resources, ["sum"]);
    let error = executor
        .encode(&mut encoder(), &Frame::default())
        .expect_err("the image of the old size does not serve any more");
    assert!(
        matches!(&error, ExecuteError::NotImported { name, .. } if name == "host.image"),
        "{error}"
    );
    executor.import_texture("host.image", &image).unwrap();
    assert_eq!(
        numbers(&mut executor, "sum"),
        [42; 256],
        "host.more stayed as it was"
    );
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
    Files::new([
        (
            "graph.ron",
            "(format: 2, materials: [Buffer(name: \"copy\", count: 1)],
              passes: [Compute(name: \"take\", run: OnChange, dispatch: Groups(1, 1, 1))], \
                  outputs: [\"copy\"])",
        ),
        (
            "take.wgsl",
            "var<storage, read> host_number: array<u32>; var<storage, read_write> copy: array<u32>;
             @compute @workgroup_size(1) fn main() { copy[0] = host_number[0]; }",
        ),
    ])
}

impl Provider for Number {
    fn names(&self) -> Vec<String> {
        vec!["host.number".to_owned(), "host.unused".to_owned()]
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        let known = self.names().iter().any(|known| known == name);
        known.then_some(Provided {
            items: Some(1),
            stride: 4,
            uniform: false,
        })
    }

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
            return Err(ProviderError("nobody should ask for it".to_owned()));
        }
        if !self.is_there {
            return Err(ProviderError("it is still loading".to_owned()));
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
    step(&mut executor, false, 100); // nobody has said so yet
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

/// Every method that needs the device says that it is lost; none panics.
fn lose_the_device(before: bool) {
    let gpu = device::open(None).unwrap_or_else(|error| panic!("{error}"));
    let request = sums_request();
    let plan = |files: &Files, request: &PlanRequest<'_>| planned(files, request);
    let made = |name: &str| {
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(name),
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
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(name),
            size: 4,
            usage: STORAGE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        (texture, buffer)
    };
    let ((image, more), (late, later)) = (made("early"), made("late"));
    let mut executor = Executor::new(
        &gpu.device,
        &gpu.queue,
        plan(&sums(), &request),
        &mut NoProvider,
    )
    .unwrap();
    executor.import_texture("host.image", &image).unwrap();
    executor.import_buffer("host.more", &more).unwrap();
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let read = Frame {
        read: &["sum"],
        timing: true,
        ..Frame::default()
    };
    executor.encode(&mut encoder, &read).unwrap();
    gpu.queue.submit([encoder.finish()]);
    // `submitted` comes after the loss in one run, before it in the other.
    if before {
        executor.submitted().unwrap();
    }
    let mut encoder = gpu.device.create_command_encoder(&Default::default());

    gpu.device.destroy();
    if !before {
        // It has no result of its own to wait for, so it may say nothing.
        let submitted = executor.submitted();
        assert!(
            matches!(submitted, Ok(()) | Err(ExecuteError::DeviceLost(_))),
            "{submitted:?}"
        );
    }
    let none = &mut NoProvider;
    let results = [
        ("encode", executor.encode(&mut encoder, &read)),
        (
            "import_texture",
            executor.import_texture("host.image", &late),
        ),
        ("import_buffer", executor.import_buffer("host.more", &later)),
        ("finish", executor.finish().map(|_| ())),
        ("finish again", executor.finish().map(|_| ())),
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
    executor.touch("host.image").unwrap();
    executor.refresh(&mut NoProvider).unwrap();
    assert!(executor.output_view("sum").is_some());
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
