//! What a host program relies on: imports, views of outputs, changes of a plan, errors that leave everything as it was.

mod support;

use skiagraph_graph::{
    ExecuteError, Executor, Frame, FrameReport, Graph, Import, NoProvider, ParamValue, Plan,
    PlanRequest, Provided, Provider, ProviderError, Renewed, gpu,
};
use std::sync::LazyLock;
use support::{Files, load};
use wgpu::util::DeviceExt;

static GPU: LazyLock<gpu::Gpu> =
    LazyLock::new(|| gpu::open(None).unwrap_or_else(|error| panic!("{error}")));

fn request(provider: &dyn Provider) -> PlanRequest<'_> {
    let mut request = PlanRequest::new([8, 8], provider);
    request.limits = GPU.device.limits();
    request
}

fn planned(files: &Files, request: &PlanRequest<'_>) -> Plan {
    let graph = load(files).unwrap_or_else(|errors| panic!("{errors}"));
    graph
        .plan(request)
        .unwrap_or_else(|errors| panic!("{errors}"))
}

fn executor(files: &Files, request: &PlanRequest<'_>) -> Executor {
    let plan = planned(files, request);
    Executor::new(&GPU.device, &GPU.queue, plan, &mut NoProvider)
        .unwrap_or_else(|error| panic!("{error}"))
}

fn encoder() -> wgpu::CommandEncoder {
    GPU.device.create_command_encoder(&Default::default())
}

fn frame(executor: &mut Executor, read: &[&str]) -> FrameReport {
    let mut encoder = encoder();
    let frame = Frame {
        read,
        ..Frame::default()
    };
    executor
        .encode(&mut encoder, &frame)
        .unwrap_or_else(|error| panic!("{error}"));
    GPU.queue.submit([encoder.finish()]);
    executor
        .submitted(&GPU.queue)
        .unwrap_or_else(|error| panic!("{error}"));
    executor.finish().unwrap_or_else(|error| panic!("{error}"))
}

/// The numbers of an output after a frame.
fn numbers(executor: &mut Executor, output: &str) -> Vec<u32> {
    let report = frame(executor, &[output]);
    report.readbacks[0]
        .content
        .as_u32()
        .expect("it holds numbers")
}

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
            "(format: 1, materials: [Texture(name: \"sum\", format: R32Uint, size: Viewport)],
              passes: [Fullscreen(name: \"add\", color: [(target: \"sum\")])], outputs: [(name: \"sum\")])",
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
        ("host.image".to_owned(), Import::texture(&image)),
        ("host.more".to_owned(), Import::buffer(&more, None)),
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
            "(format: 1, materials: [Texture(name: \"image\", format: R32Uint, size: Viewport), Texture(name: \"nobody\", format: R32Uint, size: Viewport)],
              passes: [Compute(name: \"count\", dispatch: Groups(1, 1, 1)), Fullscreen(name: \"idle\", shader: \"draw\", color: [(target: \"nobody\")]),
                       Fullscreen(name: \"draw\", color: [(target: \"image\")])],
              outputs: [(name: \"image\")])",
        ),
        (
            "count.wgsl",
            "var<storage, read_write> host_counter: array<u32>;
             @compute @workgroup_size(1) fn main() { host_counter[0] += 10u; }",
        ),
        ("draw.wgsl", "@fragment fn fragment() -> @location(0) u32 { return 1u; }"),
    ]);
    let counter = buffer(&[5, 6], STORAGE);
    let mut request = request(&NoProvider);
    request
        .imports
        .insert("host.counter".to_owned(), Import::buffer(&counter, Some(2)));
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

/// The host's own pass reads the outputs in the encoder in which the graph made them.
#[test]
fn the_host_binds_what_the_graph_made() {
    let files = Files::new([
        (
            "graph.ron",
            "(format: 1, materials: [Texture(name: \"image\", format: R32Uint, size: Viewport), Buffer(name: \"items\", count: 64)],
              passes: [Fullscreen(name: \"draw\", color: [(target: \"image\")]), Compute(name: \"fill\", dispatch: Over(\"items\"))],
              outputs: [(name: \"image\"), (name: \"items\")])",
        ),
        (
            "draw.wgsl",
            "@fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) u32 { return u32(at.x) + 8u * u32(at.y); }",
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

/// A host's imports follow its viewport, so both change at once, and the imports are handed over again.
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
            let image = Import::texture(&image);
            request.imports.insert("host.image".to_owned(), image);
        })
        .unwrap();
    let renewed = executor.replace_graph(plan, &mut NoProvider).unwrap();
    assert_eq!(renewed.resources, ["sum"]);
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

/// Every kind of place that a param can stand in, each with its own.
fn params() -> Files {
    Files::new([
        (
            "graph.ron",
            "(
                format: 1,
                params: [
                    (name: \"gain\", type: U32, default: 1, max: 100),
                    (name: \"offset\", type: U32, default: 0),
                    (name: \"both\", type: U32, default: 0),
                    (name: \"face\", type: Choice([\"none\", \"front\", \"back\"]), default: \"none\"),
                    (name: \"slope\", type: F32, default: 0),
                    (name: \"far\", type: F32, default: 1, min: 0, max: 1),
                    (name: \"edge\", type: U32, default: 8),
                    (name: \"layers\", type: U32, default: 2, min: 2),
                    (name: \"items\", type: U32, default: 64, min: 1),
                    (name: \"corners\", type: U32, default: 3),
                    (name: \"enabled\", type: Bool, default: true),
                ],
                materials: [
                    Texture(name: \"depth\", format: Depth32Float, size: Square(Param(\"edge\"))),
                    Texture(name: \"stack\", format: R32Uint, size: Texels(4, 4), layers: Param(\"layers\")),
                    Buffer(name: \"list\", count: Param(\"items\")),
                    Buffer(name: \"sometimes\", count: 1),
                    Texture(name: \"image\", format: R32Uint, size: Viewport),
                ],
                passes: [
                    Raster(name: \"draw\", draw: Vertices(Param(\"corners\")), cull: Param(\"face\"),
                        depth: (target: \"depth\", load: Clear(Param(\"far\")), bias: (slope_scale: Param(\"slope\")))),
                    Compute(name: \"pile\", dispatch: Over(\"stack\")),
                    Compute(name: \"fill\", dispatch: Over(\"list\")),
                    Compute(name: \"switch\", run: When(\"enabled\"), dispatch: Groups(1, 1, 1), bind: {\"old\": Previous(\"sometimes\")}),
                    Fullscreen(name: \"shade\", color: [(target: \"image\")]),
                ],
                outputs: [(name: \"image\"), (name: \"depth\"), (name: \"stack\"), (name: \"list\"), (name: \"sometimes\")],
            )",
        ),
        (
            "draw.wgsl",
            "@vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
                 return vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.5, 1.0);
             }",
        ),
        (
            "pile.wgsl",
            "var stack: texture_storage_2d_array<r32uint, write>;
             @compute @workgroup_size(4, 4) fn main(@builtin(global_invocation_id) at: vec3<u32>) {
                 for (var layer = 0u; layer < textureNumLayers(stack); layer++) { textureStore(stack, at.xy, layer, vec4(layer)); }
             }",
        ),
        (
            "fill.wgsl",
            "var<storage, read_write> list: array<u32>;
             @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
                 if id.x < arrayLength(&list) { list[id.x] = id.x; }
             }",
        ),
        (
            "switch.wgsl",
            "var<storage, read> old: array<u32>;
             var<storage, read_write> sometimes: array<u32>;
             @compute @workgroup_size(1) fn main() { sometimes[0] = old[0] + 1u; }",
        ),
        (
            "shade.wgsl",
            "struct Params { gain: u32, both: u32 }
             var<uniform> params: Params;
             override offset: u32;
             override both: u32;
             @fragment fn fragment() -> @location(0) u32 { return 7u * params.gain + offset + params.both + both; }",
        ),
    ])
}

/// The table of docs/embedding.md, row by row: what a change of a param comes to, and the image after it.
#[test]
fn a_param_costs_what_follows_from_it() {
    let mut executor = executor(&params(), &request(&NoProvider));
    assert_eq!(numbers(&mut executor, "image"), [7; 64]);
    let number = ParamValue::U32;
    let nothing: &[&str] = &[];
    let rows = [
        // param, value, uploads, pipelines, resources, image
        ("gain", number(2), &["shade"][..], nothing, nothing, 14),
        ("gain", number(2), nothing, nothing, nothing, 14),
        ("offset", number(3), nothing, &["shade"], nothing, 17),
        ("both", number(1), &["shade"], &["shade"], nothing, 19),
        (
            "face",
            ParamValue::Choice("back".to_owned()),
            nothing,
            &["draw"],
            nothing,
            19,
        ),
        (
            "slope",
            ParamValue::F32(1.5),
            nothing,
            &["draw"],
            nothing,
            19,
        ),
        ("far", ParamValue::F32(0.75), nothing, nothing, nothing, 19),
        ("corners", number(6), nothing, nothing, nothing, 19),
        ("edge", number(32), nothing, nothing, &["depth"], 19),
        ("layers", number(4), nothing, nothing, &["stack"], 19),
        ("items", number(100), nothing, nothing, &["list"], 19),
        (
            "enabled",
            ParamValue::Bool(false),
            nothing,
            nothing,
            nothing,
            19,
        ),
    ];
    for (name, value, uploads, pipelines, resources, image) in rows {
        let renewed = executor
            .set_param(name, value.clone(), &mut NoProvider)
            .unwrap_or_else(|error| panic!("{error}"));
        let expected = Renewed {
            uploads: uploads.iter().map(|name| (*name).to_owned()).collect(),
            pipelines: pipelines.iter().map(|name| (*name).to_owned()).collect(),
            resources: resources.iter().map(|name| (*name).to_owned()).collect(),
        };
        assert_eq!(renewed, expected, "{name} = {value}");
        assert_eq!(executor.plan().param(name), Some(&value));
        assert_eq!(
            numbers(&mut executor, "image"),
            [image; 64],
            "{name} = {value}"
        );
    }
    // What these changes were for has happened.
    let report = frame(&mut executor, &["depth", "list", "sometimes"]);
    assert_eq!(report.skipped, ["switch"]);
    let depth = report.readbacks[0].content.as_f32().unwrap();
    assert_eq!(depth.len(), 32 * 32);
    assert_eq!(report.readbacks[1].content.as_u32().unwrap().len(), 100);
    assert_eq!(
        report.readbacks[2].content.as_u32().unwrap(),
        [12],
        "it ran in each frame until it was switched off"
    );
}

/// ```text
/// Previous(total) ─▶ count ─▶ total ; Viewport ─▶ image
/// ```
fn counter(step: &str) -> Files {
    Files::new([
        (
            "graph.ron",
            "(format: 1, params: [(name: \"most\", type: U32, default: 5, max: 9)],
              materials: [Buffer(name: \"total\", count: 1), Texture(name: \"image\", format: R32Uint, size: Viewport)],
              passes: [Compute(name: \"count\", dispatch: Groups(1, 1, 1), bind: {\"old\": Previous(\"total\")}), Fullscreen(name: \"draw\", color: [(target: \"image\")])],
              outputs: [(name: \"total\"), (name: \"image\")])",
        ),
        ("draw.wgsl", "@fragment fn fragment() -> @location(0) u32 { return 1u; }"),
    ])
    .with(
        "count.wgsl",
        format!(
            "struct Params {{ most: u32 }} var<uniform> params: Params;
             var<storage, read> old: array<u32>; var<storage, read_write> total: array<u32>;
             @compute @workgroup_size(1) fn main() {{ total[0] = old[0] + {step}; }}"
        ),
    )
}

/// The device refuses what the plan's limits allowed.
fn boundless() -> PlanRequest<'static> {
    let mut request = request(&NoProvider);
    request.limits.max_texture_dimension_2d = 1 << 20;
    request
}

#[test]
fn what_fails_changes_nothing() {
    let mut executor = executor(&counter("1u"), &boundless());
    let mut expected = 1;
    assert_eq!(numbers(&mut executor, "total"), [expected]);
    type Change = fn(&mut Executor) -> Result<Renewed, ExecuteError>;
    let changes: [(&str, Change); 6] = [
        ("the viewport has no pixels", |executor| {
            executor.resize([0, 8], &mut NoProvider)
        }),
        ("`image` could not be made", |executor| {
            executor.resize([1 << 19, 8], &mut NoProvider)
        }),
        ("did you mean `most`", |executor| {
            executor.set_param("mast", ParamValue::U32(1), &mut NoProvider)
        }),
        ("must be at most 9", |executor| {
            executor.set_param("most", ParamValue::U32(10), &mut NoProvider)
        }),
        ("must be of type u32", |executor| {
            executor.set_param("most", ParamValue::F32(1.0), &mut NoProvider)
        }),
        ("`image` could not be made", |executor| {
            let mut request = boundless();
            request.viewport = [1 << 19, 8];
            executor.replace_graph(planned(&counter("100u"), &request), &mut NoProvider)
        }),
    ];
    for (why, change) in changes {
        let message = change(&mut executor).expect_err(why).to_string();
        assert!(message.contains(why), "{message}\nshould say: {why}");
        expected += 1;
        assert_eq!(numbers(&mut executor, "total"), [expected], "after {why}");
        assert_eq!(numbers(&mut executor, "image"), [1; 64], "after {why}");
        expected += 1;
        assert_eq!(executor.plan().viewport(), [8, 8]);
    }
}

#[test]
fn an_edited_shader_keeps_what_was_there() {
    let mut executor = executor(&counter("1u"), &request(&NoProvider));
    assert_eq!(numbers(&mut executor, "total"), [1]);
    assert_eq!(numbers(&mut executor, "total"), [2]);
    let plan = planned(&counter("10u"), &request(&NoProvider));
    let renewed = executor.replace_graph(plan, &mut NoProvider).unwrap();
    let only = Renewed {
        pipelines: vec!["count".to_owned()],
        ..Renewed::default()
    };
    assert_eq!(renewed, only);
    assert_eq!(numbers(&mut executor, "total"), [12]);
}

/// The report is that of the frame, whatever the executor's plan is by then.
#[test]
fn a_frame_that_was_encoded_before_a_change_is_reported_after_it() {
    let mut executor = executor(&params(), &request(&NoProvider));
    let mut encoder = encoder();
    let timed = Frame {
        timing: true,
        read: &["image"],
        ..Frame::default()
    };
    executor.encode(&mut encoder, &timed).unwrap();
    GPU.queue.submit([encoder.finish()]);
    executor.submitted(&GPU.queue).unwrap();
    let plan = planned(&sums(), &sums_request());
    executor.replace_graph(plan, &mut NoProvider).unwrap();
    let report = executor.finish().unwrap();
    let timing = report.timing.expect("times were asked for");
    let names: Vec<&str> = timing
        .passes
        .iter()
        .map(|pass| pass.name.as_str())
        .collect();
    assert_eq!(names, ["draw", "pile", "fill", "switch", "shade"]);
    assert_eq!(report.readbacks[0].content.as_u32().unwrap(), [7; 64]);
}

/// Gives one number under the name `host.number`, another buffer for each version.
struct Number {
    version: u64,
    built: u32,
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
        self.built += 1;
        Ok(buffer(
            &[100 + self.version as u32],
            STORAGE | wgpu::BufferUsages::COPY_DST,
        ))
    }
}

#[test]
fn provided_resources_change_when_the_host_says_so() {
    let files = Files::new([
        (
            "graph.ron",
            "(format: 1, materials: [Buffer(name: \"copy\", count: 1)],
              passes: [Compute(name: \"take\", run: OnChange, dispatch: Groups(1, 1, 1))], outputs: [(name: \"copy\")])",
        ),
        (
            "take.wgsl",
            "var<storage, read> host_number: array<u32>; var<storage, read_write> copy: array<u32>;
             @compute @workgroup_size(1) fn main() { copy[0] = host_number[0]; }",
        ),
    ]);
    let mut provider = Number {
        version: 0,
        built: 0,
    };
    let plan = planned(&files, &request(&provider));
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
                "neither an import nor a provided resource is called `{name}`; live passes use host.number"
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
    let gpu = gpu::open(None).unwrap_or_else(|error| panic!("{error}"));
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
        executor.submitted(&gpu.queue).unwrap();
    }
    let mut encoder = gpu.device.create_command_encoder(&Default::default());

    gpu.device.destroy();
    if !before {
        // It has no result of its own to wait for, so it may say nothing.
        let submitted = executor.submitted(&gpu.queue);
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
                .replace_graph(plan(&params(), &boundless()), none)
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
    let planning = std::thread::spawn(|| planned(&params(), &request(&NoProvider)));
    let plan = planning.join().expect("planning does not panic");
    let mut executor = Executor::new(&GPU.device, &GPU.queue, plan, &mut NoProvider).unwrap();
    let frames = std::thread::spawn(move || numbers(&mut executor, "image"));
    assert_eq!(frames.join().expect("encoding does not panic"), [7; 64]);
}
