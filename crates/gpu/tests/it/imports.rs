//! Imports: textures and buffers by name, checked against the plan, missing ones told before
//! anything is encoded.

use crate::given::{KIND, Kind, SAMPLED, STORAGE, buffer, content, sums, sums_request, texture};
use crate::host::{GPU, encoder, executor, frame, numbers, planned, request};
use crate::support::{Files, names};
use skiagraph_gpu::{ExecuteError, Frame, import};
use skiagraph_graph::{Filter, Import, NoProvider};

#[test]
fn what_the_host_hands_over_arrives() {
    let mut executor = executor(&sums(), &sums_request());
    let (image, more) = (texture(&KIND, 5), buffer(&[2], STORAGE));
    executor.import_texture("image", &image).unwrap();
    executor.import_buffer("more", &more).unwrap();
    assert_eq!(numbers(&mut executor, "sum"), [7; 64]);
    // Another one, and one that was made for more than the plan knows of.
    executor
        .import_texture("image", &texture(&KIND, 30))
        .unwrap();
    assert_eq!(numbers(&mut executor, "sum"), [32; 64]);
    let more = buffer(&[4], STORAGE | wgpu::BufferUsages::INDIRECT);
    executor.import_buffer("more", &more).unwrap();
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
    executor.import_texture("image", &image).unwrap();
    executor.import_buffer("more", &more).unwrap();
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
            (executor.import_texture("image", &texture), *why)
        })
        .collect();
    let image = texture(&KIND, 9);
    refused.extend([
        (
            executor.import_buffer("more", &buffer(&[9, 9], STORAGE)),
            "size in bytes is 8, not 4",
        ),
        (
            executor.import_buffer("more", &buffer(&[9], wgpu::BufferUsages::UNIFORM)),
            "usage is",
        ),
        (
            executor.import_buffer("image", &buffer(&[9], STORAGE)),
            "it is a buffer, not a texture",
        ),
        (
            executor.import_texture("more", &image),
            "it is a texture, not a buffer",
        ),
        (
            executor.import_texture("picture", &image),
            "the plan has no import `picture`; it has image, more",
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
        .import_texture("image", &texture(&KIND, 5))
        .unwrap();
    let mut host = encoder();
    let error = executor
        .encode(&mut host, &Frame::default())
        .expect_err("more is missing");
    let ExecuteError::NotImported { name, pass, .. } = &error else {
        panic!("{error}");
    };
    assert_eq!([name.as_str(), pass.as_str()], ["more", "add"]);
    let scope = GPU.device.push_error_scope(wgpu::ErrorFilter::Validation);
    assert_eq!(content(&buffer(&[3, 4], STORAGE), host), [3, 4]);
    let fault = pollster::block_on(scope.pop());
    assert!(fault.is_none(), "{fault:?}");
    executor
        .import_buffer("more", &buffer(&[1], STORAGE))
        .unwrap();
    assert_eq!(numbers(&mut executor, "sum"), [6; 64]);
}

/// ```text
/// count ─▶ counter ;  idle ─▶ (no reader)
/// ```
/// Even if the host wants another output only.
#[test]
fn a_pass_that_writes_for_the_host_runs() {
    let files = Files::graph(
        r#"
    inputs: [Buffer(name: "counter")],
    materials: [Texture(name: "image", format: R32Uint), Texture(name: "nobody", format: R32Uint)],
    passes: [
        Compute(name: "count", dispatch: Groups(1, 1, 1)),
        Fullscreen(name: "idle", shader: "draw", color: ["nobody"]),
        Fullscreen(name: "draw", color: ["image"]),
    ],
    outputs: ["image", "counter"],
"#,
    )
    .with(
        "count.wgsl",
        "var<storage, read_write> counter: array<u32>;
         @compute @workgroup_size(1) fn main() { counter[0] += 10u; }",
    )
    .with(
        "draw.wgsl",
        "@fragment fn fragment() -> @location(0) u32 { return 1u; }",
    );
    let counter = buffer(&[5, 6], STORAGE);
    let mut request = request(&NoProvider);
    request
        .imports
        .insert("counter".to_owned(), import::buffer(&counter, Some(2)));
    request.outputs = Some(vec!["image".to_owned()]);
    let mut executor = executor(&files, &request);
    assert_eq!(names(executor.plan()), ["count", "draw"]);
    executor.import_buffer("counter", &counter).unwrap();
    frame(&mut executor, &[]);
    frame(&mut executor, &[]);
    assert_eq!(content(&counter, encoder()), [25, 6]);
    // It goes on from what is there, which no version of the host's tells.
    executor.set_import_version("counter", 1).unwrap();
    frame(&mut executor, &[]);
    frame(&mut executor, &[]);
    assert_eq!(content(&counter, encoder()), [45, 6]);
}

/// An output may be an import. The host decides if it can be read back, and an error comes before
/// anything is encoded.
#[test]
fn an_import_is_read_back_if_it_was_made_for_that() {
    let files = Files::graph(
        r#"
    inputs: [Texture(name: "image", format: R32Uint)],
    passes: [Fullscreen(name: "draw", color: ["image"])],
    outputs: ["image"],
"#,
    )
    .with(
        "draw.wgsl",
        "@fragment fn fragment() -> @location(0) u32 { return 3u; }",
    );
    let drawn = wgpu::TextureUsages::RENDER_ATTACHMENT;
    for (usage, is_readable) in [
        (drawn, false),
        (drawn | wgpu::TextureUsages::COPY_SRC, true),
    ] {
        let image = texture(&Kind { usage, ..KIND }, 0);
        let mut request = request(&NoProvider);
        let described = import::texture(&image);
        request.imports.insert("image".to_owned(), described);
        let mut executor = executor(&files, &request);
        executor.import_texture("image", &image).unwrap();
        let read = Frame::new().with_read(&["image"]);
        match executor.encode(&mut encoder(), &read) {
            Ok(_) => assert!(is_readable),
            Err(error) => {
                assert!(!is_readable);
                let why = "`image` cannot be read back: the host must make it with \
                    TextureUsages::COPY_SRC";
                assert_eq!(error.to_string(), why);
                frame(&mut executor, &[]);
                continue;
            }
        }
        assert_eq!(numbers(&mut executor, "image"), [3; 64]);
    }
}

/// A host's imports follow its viewport, so both change at once, and the imports are handed over
/// again.
#[test]
fn another_viewport_with_other_imports() {
    let mut executor = executor(&sums(), &sums_request());
    let more = buffer(&[2], STORAGE);
    executor
        .import_texture("image", &texture(&KIND, 5))
        .unwrap();
    executor.import_buffer("more", &more).unwrap();
    assert_eq!(numbers(&mut executor, "sum"), [7; 64]);

    let image = texture(&Kind { edge: 16, ..KIND }, 40);
    let plan = executor
        .plan()
        .with(|request| {
            request.viewport = [16, 16];
            let image = import::texture(&image);
            request.imports.insert("image".to_owned(), image);
        })
        .unwrap();
    let report = executor.replace_graph(plan, &mut NoProvider).unwrap();
    assert_eq!(report.resources, ["sum"]);
    let error = executor
        .encode(&mut encoder(), &Frame::default())
        .expect_err("the image of the old size does not serve any more");
    assert!(
        matches!(&error, ExecuteError::NotImported { name, .. } if name == "image"),
        "{error}"
    );
    executor.import_texture("image", &image).unwrap();
    assert_eq!(
        numbers(&mut executor, "sum"),
        [42; 256],
        "more stayed as it was"
    );
}

/// A texture of one texel on each of its layers or slices.
fn stack(
    dimension: wgpu::TextureDimension,
    format: wgpu::TextureFormat,
    bytes: &[u8],
) -> wgpu::Texture {
    let texel = format.block_copy_size(None).expect("it can be copied");
    let size = wgpu::Extent3d {
        width: 1,
        height: 1,
        depth_or_array_layers: bytes.len() as u32 / texel,
    };
    let texture = GPU.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension,
        format,
        usage: SAMPLED | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(texel),
        rows_per_image: Some(1),
    };
    GPU.queue
        .write_texture(texture.as_image_copy(), bytes, layout, size);
    texture
}

/// A sampler, the slices of a 3D texture and the layers of an array come in as textures and buffers
/// do.
#[test]
fn samplers_slices_and_layers_come_in() {
    let files = Files::graph(
        r#"
    inputs: [
        Sampler(name: "soft"),
        Texture(name: "volume", format: R8Unorm),
        Texture(name: "maps", format: R32Uint),
    ],
    materials: [Texture(name: "image", format: Rgba32Float, size: 1)],
    passes: [Fullscreen(name: "look", color: ["image"])],
    outputs: ["image"],
"#,
    )
    .with(
        "look.wgsl",
        "var soft: sampler;
         var volume: texture_3d<f32>;
         var maps: texture_2d_array<u32>;
         @fragment fn fragment() -> @location(0) vec4<f32> {
             let middle = textureSampleLevel(volume, soft, vec3(0.5), 0.0).x;
             let layer = textureNumLayers(maps) - 1u;
             return vec4(middle, f32(textureLoad(maps, vec2(0u), layer, 0).x), f32(layer), 0.0);
         }",
    );
    let volume = stack(
        wgpu::TextureDimension::D3,
        wgpu::TextureFormat::R8Unorm,
        &[0, 255],
    );
    let numbers = [5u32, 6, 7];
    let maps = stack(
        wgpu::TextureDimension::D2,
        wgpu::TextureFormat::R32Uint,
        bytemuck::cast_slice(&numbers),
    );
    let soft = Import::sampler(Filter::Linear, false);
    let mut request = request(&NoProvider);
    request.imports.extend([
        ("soft".to_owned(), soft),
        ("volume".to_owned(), import::texture(&volume)),
        ("maps".to_owned(), import::texture(&maps)),
    ]);
    let mut executor = executor(&files, &request);
    let sampler = GPU.device.create_sampler(&wgpu::SamplerDescriptor {
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    });
    executor.import_sampler("soft", &sampler).unwrap();
    executor.import_texture("volume", &volume).unwrap();
    executor.import_texture("maps", &maps).unwrap();
    let report = frame(&mut executor, &["image"]);
    let [middle, layer, last, _] = report.readbacks[0].content.as_f32().unwrap()[..] else {
        panic!("it is one texel of four channels");
    };
    assert!((middle - 0.5).abs() <= 1.0 / 255.0, "{middle}");
    assert_eq!([layer, last], [7.0, 2.0]);
    // One dimension is not the other.
    let error = executor
        .import_texture("volume", &maps)
        .expect_err("these are layers");
    let error = error.to_string();
    assert!(error.contains("its dimension is D2, not D3"), "{error}");
    let error = executor
        .import_sampler("maps", &sampler)
        .expect_err("that is a texture");
    let error = error.to_string();
    assert!(error.contains("it is a sampler, not a texture"), "{error}");
}
