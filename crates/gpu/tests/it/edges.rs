//! Features that shader authors expect of any graph: each by itself on the device, to the bit.

use crate::featured::{Running, VALUE, buffer_floats, floats, words};
use crate::host::{GPU, executor, frame, numbers, request, submit};
use crate::support::{Files, load, right};
use skiagraph_gpu::{Executor, Frame};
use skiagraph_graph::{Graph, Import, NoProvider, ParamValue, Registry};
use wgpu::util::DeviceExt;

#[test]
fn data_are_expressions_over_params_and_sizes() {
    let files = Files::graph(
        r#"
        params: [U32(name: "radius", default: 3), Vec2(name: "pair", default: (0.5, 8))],
        values: {"last": "pair.y"},
        materials: [
            Texture(name: "image", format: R32Float, size: (6, 2)),
            Buffer(name: "kernel", data: [
                ("1 << radius", "pow(radius, 2)"), "image.size", "pair", ("last", "1 / pair.x"),
            ]),
            Buffer(name: "copied", count: 4),
        ],
        passes: [Compute(name: "copy", dispatch: Groups(1, 1, 1))],
        outputs: ["copied"],
        "#,
    );
    let copy = "var<storage, read> kernel: array<vec2<f32>>;
        var<storage, read_write> copied: array<vec2<f32>>;
        @compute @workgroup_size(4) fn main(@builtin(local_invocation_index) at: u32) {
            copied[at] = kernel[at];
        }";
    let files = files.with("copy.wgsl", copy);
    let expected = [8.0, 9.0, 6.0, 2.0, 0.5, 8.0, 8.0, 2.0];
    assert_eq!(buffer_floats(&files, "copied"), expected);
    let mut running = Running::with(&files, &[("radius", ParamValue::U32(1))]);
    let words = running.words("copied").into_iter().map(f32::from_bits);
    let expected = [2.0, 1.0, 6.0, 2.0, 0.5, 8.0, 8.0, 2.0];
    assert_eq!(words.collect::<Vec<f32>>(), expected);
}

/// Reset to (0.25, 0.25, 0.25, 0.5), below (1, 0.5, 0, 0.5).
#[test]
fn factors_operation_and_constant_of_blending_are_free() {
    for (blend, expected) in [
        (
            "(source: SrcAlpha, target: OneMinusSrcAlpha, alpha: (source: One, \
          target: OneMinusSrcAlpha))",
            [0.625, 0.375, 0.125, 0.75],
        ),
        ("(target: Zero)", [1.0, 0.5, 0.0, 0.5]),
        ("(source: Zero, target: Src)", [0.25, 0.125, 0.0, 0.25]),
        ("(operation: ReverseSubtract)", [-0.75, -0.25, 0.25, 0.0]),
        (
            "(operation: Min, alpha: (operation: Max))",
            [0.25, 0.25, 0.0, 0.5],
        ),
        (
            "(source: Constant, target: OneMinusConstant, constant: 0.75)",
            [0.8125, 0.4375, 0.0625, 0.5],
        ),
        (
            "(source: Constant, target: Zero, constant: (\"half\", 1, 1, \"half / 2\"))",
            [0.5, 0.5, 0.0, 0.125],
        ),
    ] {
        let files = Files::graph(&format!(
            r#"
            params: [F32(name: "half", default: 0.5)],
            materials: [Texture(name: "image", format: Rgba16Float)],
            passes: [
                Clear(name: "reset", target: "image", value: (0.25, 0.25, 0.25, 0.5)),
                Fullscreen(name: "over", color: [(target: "image", load: Load, blend: {blend})]),
            ],
            outputs: ["image"],
            "#
        ));
        let over = "@fragment fn fragment() -> @location(0) vec4<f32> {
                return vec4(1.0, 0.5, 0.0, 0.5);
            }";
        let texels = floats(&files.with("over.wgsl", over), "image");
        assert_eq!(texels, expected.repeat(16), "{blend}");
    }
}

#[test]
fn a_draw_begins_at_any_vertex_and_instance() {
    let files = Files::graph(
        r#"
        params: [U32(name: "row", default: 2)],
        materials: [Texture(name: "image", format: R32Float)],
        passes: [Raster(name: "rows", draw: 6, first_vertex: "6 * row", instances: 2,
            first_instance: 1, color: ["image"])],
        outputs: ["image"],
        "#,
    );
    // A rectangle for every six vertices, a row each; a column for each instance.
    let rows = "struct Out { @builtin(position) clip: vec4<f32>, @location(0) value: f32 }
        @vertex fn vertex(@builtin(vertex_index) vertex: u32,
            @builtin(instance_index) instance: u32) -> Out {
            let corner = vertex % 6u;
            let x = f32(instance) + select(0.0, 1.0, corner == 1u || corner == 2u || corner == 4u);
            let y = f32(vertex / 6u) + select(0.0, 1.0, corner == 2u || corner >= 4u);
            let clip = vec2(x, y) / 2.0 - 1.0;
            return Out(vec4(clip.x, -clip.y, 0.0, 1.0), f32(10u * instance + vertex / 6u));
        }
        @fragment fn fragment(in: Out) -> @location(0) f32 { return in.value; }";
    let mut expected = [0.0; 16];
    (expected[9], expected[10]) = (12.0, 22.0);
    assert_eq!(floats(&files.with("rows.wgsl", rows), "image"), expected);
}

#[test]
fn a_colour_target_is_there_under_a_condition() {
    let files = Files::graph(
        r#"
        params: [Bool(name: "detailed", default: false)],
        materials: [
            Texture(name: "a", format: R32Float), Texture(name: "b", format: Rg32Float),
            Texture(name: "c", format: R32Uint),
        ],
        passes: [Fullscreen(name: "three",
            color: ["a", (target: "b", if: "detailed"), "c"])],
        outputs: ["a", (name: "b", if: "detailed"), "c"],
        "#,
    );
    let three = "struct Out { @location(0) a: f32, @location(1) b: vec2<f32>, @location(2) c: u32 }
        @fragment fn fragment() -> Out { return Out(0.5, vec2(2.0, 3.0), 7u); }";
    let files = files.with("three.wgsl", three);
    let mut plain = Running::new(&files);
    assert_eq!(plain.floats("a"), [0.5; 16]);
    assert_eq!(plain.words("c"), [7; 16]);
    let mut detailed = Running::with(&files, &[("detailed", ParamValue::Bool(true))]);
    assert_eq!(detailed.floats("a"), [0.5; 16]);
    assert_eq!(detailed.floats("b"), [2.0, 3.0].repeat(16));
    assert_eq!(detailed.words("c"), [7; 16]);
}

/// Each frame draws one of four layers; none is left out, and the others stay.
#[test]
fn passes_take_turns_by_the_number_of_the_frame() {
    let files = Files::graph(
        r#"
        materials: [Texture(name: "maps", format: R32Float, size: 1, layers: 4, keep: true)],
        passes: [Fullscreen(name: "fill", repeat: 4, color: ["maps[index]"],
            run: When("frame.index % 4 == index"))],
        outputs: ["maps"],
        "#,
    );
    let fill = "struct Frame { index: u32, seconds: f32 }
        var<uniform> frame: Frame;
        @fragment fn fragment() -> @location(0) f32 { return f32(frame.index); }";
    let mut executor = executor(&files.with("fill.wgsl", fill), &request(&NoProvider));
    assert_eq!(executor.plan().period(), 4);
    for number in 0..9_u16 {
        let report = frame(&mut executor, &["maps"]);
        let ran = usize::from(number % 4);
        let names = (0..4).filter(|layer| *layer != ran);
        let names: Vec<String> = names.map(|layer| format!("fill[{layer}]")).collect();
        assert_eq!(report.skipped, names, "{number}");
        let newest = |layer: u16| {
            let frames = (0..=number).filter(|frame| frame % 4 == layer);
            f32::from(frames.max().unwrap_or(0))
        };
        let texels = report.readbacks[0].content.as_f32();
        assert_eq!(texels, Some((0..4).map(newest).collect()), "{number}");
    }
}

/// Nothing changes, and nothing is remembered but which frame it is.
#[test]
fn a_pass_that_takes_turns_never_rests() {
    let files = Files::graph(
        r#"
        params: [F32(name: "value", default: 2)],
        materials: [Texture(name: "image", format: R32Float)],
        passes: [Fullscreen(name: "fill", color: ["image"],
            run: When("(frame.index % 2 == 1 && value > 1) || frame.index % 3 == 2"))],
        outputs: ["image"],
        "#,
    );
    let mut executor = executor(&files.with("fill.wgsl", VALUE), &request(&NoProvider));
    assert_eq!(executor.plan().period(), 6);
    let ran = (0..12).map(|_| frame(&mut executor, &[]).skipped.is_empty());
    let turn = [false, true, true, true, false, true];
    assert_eq!(ran.collect::<Vec<bool>>(), [turn, turn].concat());
    // A frame of all passes, as those that are timed, whatever its number.
    let whole = submit(
        &mut executor,
        &Frame::new().with_all(true).with_read(&["image"]),
    );
    assert_eq!(whole.skipped, [""; 0]);
    assert_eq!(whole.readbacks[0].content.as_f32(), Some(vec![2.0; 64]));
}

/// Writes the size of a picture and the sum of its first channel, in steps of eight bits.
fn effect() -> Files {
    let files = Files::graph(
        r#"
        materials: [
            Texture(name: "noise", format: R8Unorm, file: "noise.png"),
            Buffer(name: "sum", count: "noise.width"),
        ],
        passes: [Compute(name: "add", dispatch: Groups(1, 1, 1))],
        outputs: ["sum"],
        "#,
    );
    let add = "var noise: texture_2d<f32>;
        var<storage, read_write> sum: array<f32>;
        @compute @workgroup_size(1) fn main() {
            let size = textureDimensions(noise);
            for (var x = 0u; x < size.x; x++) {
                var all = 0.0;
                for (var y = 0u; y < size.y; y++) {
                    all += 255.0 * textureLoad(noise, vec2(x, y), 0).x;
                }
                sum[x] = all;
            }
        }";
    let files = files.with("add.wgsl", add);
    let files = files.picture("noise.png", 2, &[1, 2, 3, 4]);
    files.picture("pictures/other.png", 3, &[10, 20, 30])
}

fn sums(graph: &Graph) -> Vec<f32> {
    let plan = right(graph.plan(&request(&NoProvider)));
    let mut executor = Executor::new(&GPU.device, &GPU.queue, plan, &mut NoProvider).unwrap();
    let words = numbers(&mut executor, "sum").into_iter();
    words.map(|word| f32::from_bits(word).round()).collect()
}

#[test]
fn a_picture_is_chosen_when_a_graph_is_loaded() {
    let chosen = |name: &str, path: &str| {
        let chosen = [(name.to_owned(), path.to_owned())].into();
        Graph::load_over("graph.ron", &Registry::standard(), &effect(), &chosen)
    };
    let graph = right(load(&effect()));
    assert_eq!(
        graph.pictures().collect::<Vec<_>>(),
        [("noise", "noise.png")]
    );
    assert_eq!(sums(&graph), [4.0, 6.0]);
    let other = right(chosen("noise", "pictures/other.png"));
    assert_eq!(sums(&other), [10.0, 20.0, 30.0]);
    for (name, path, says) in [
        ("noise", "none.png", "picture `none.png` not found"),
        ("nois", "pictures/other.png", "did you mean `noise`?"),
    ] {
        let errors = chosen(name, path).expect_err("it is wrong").to_string();
        assert!(errors.contains(says), "{errors}");
    }
}

#[test]
fn a_hosts_texture_stands_for_a_picture() {
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let size = wgpu::Extent3d {
        width: 4,
        height: 1,
        depth_or_array_layers: 1,
    };
    let texture = GPU.device.create_texture_with_data(
        &GPU.queue,
        &wgpu::TextureDescriptor {
            label: None,
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R8Unorm,
            usage,
            view_formats: &[],
        },
        wgpu::util::TextureDataOrder::LayerMajor,
        &[7, 8, 9, 10],
    );
    let graph = right(load(&effect()));
    let import = |format, size| Import::plain_texture(format, size, usage);
    let with = |import| graph.plan(&request(&NoProvider).with_import("noise", import));
    let plan = right(with(import(wgpu::TextureFormat::R8Unorm, [4, 1])));
    let mut executor = Executor::new(&GPU.device, &GPU.queue, plan, &mut NoProvider).unwrap();
    executor.import_texture("noise", &texture).unwrap();
    let words = numbers(&mut executor, "sum").into_iter();
    let sums: Vec<f32> = words.map(|word| f32::from_bits(word).round()).collect();
    assert_eq!(sums, [7.0, 8.0, 9.0, 10.0]);
    // The document's format holds for the host, too.
    let errors = with(import(wgpu::TextureFormat::R16Float, [4, 1]));
    let errors = errors.expect_err("it has another format").to_string();
    assert!(errors.contains("a texture R8Unorm"), "{errors}");
}

/// Eight rounds at most, of which the counter, 3 at first, lets three run: dispatches, direct and
/// indirect, and draws; a clear of the counter itself runs in all of them.
#[test]
fn a_group_ends_early_by_a_counter() {
    let files = Files::graph(
        r#"
        params: [U32(name: "rounds", default: 3)],
        materials: [
            Buffer(name: "left"), Buffer(name: "ran", count: 2),
            Buffer(name: "arguments", data: [1, 2, 1]),
            Texture(name: "image", format: R16Float),
        ],
        passes: [
            Compute(name: "begin", dispatch: Groups(1, 1, 1), overwrites: ["left", "ran"]),
            Clear(name: "reset", target: "image"),
            Group(name: "round", repeat: 8, while: "left", passes: [
                Fullscreen(name: "light", color: [(target: "image", load: Load, blend: Additive)]),
                Compute(name: "count", dispatch: Groups(1, 3, 1), entry: "rows", clear: ["left"]),
                Group(name: "inner", passes: [
                    Compute(name: "count", dispatch: Indirect("arguments"), entry: "columns"),
                ]),
            ]),
        ],
        outputs: ["left", "ran", "image"],
        "#,
    );
    let begin = "struct Params { rounds: u32 }
        var<uniform> params: Params;
        var<storage, read_write> left: u32;
        var<storage, read_write> ran: array<u32>;
        @compute @workgroup_size(1) fn main() { left = params.rounds; ran[0] = 0u; ran[1] = 0u; }";
    let light = "@fragment fn fragment() -> @location(0) f32 { return 1.0; }";
    let count = "struct Params { rounds: u32 }
        var<uniform> params: Params;
        var<storage, read_write> left: atomic<u32>;
        var<storage, read_write> ran: array<atomic<u32>>;
        @compute @workgroup_size(1) fn rows(@builtin(workgroup_id) id: vec3<u32>) {
            let rows = atomicAdd(&ran[0], 1u) + 1u;
            if rows == 3u * params.rounds { return; }
            atomicMax(&left, 1u);
        }
        @compute @workgroup_size(1) fn columns() { atomicAdd(&ran[1], 1u); }";
    let count = count.replace(
        "atomicMax(&left, 1u);",
        "if rows % 3u == 0u { atomicMax(&left, 1u); }",
    );
    let files = files.with("begin.wgsl", begin).with("light.wgsl", light);
    let files = files.with("count.wgsl", count);
    for rounds in [3, 0, 8, 20] {
        let mut running = Running::with(&files, &[("rounds", ParamValue::U32(rounds))]);
        let ran = rounds.min(8);
        assert_eq!(running.words("ran"), [3 * ran, 2 * ran], "{rounds}");
        assert_eq!(running.words("left"), [u32::from(rounds > 8)], "{rounds}");
        let image = running.floats("image");
        assert_eq!(image, [ran as f32; 16], "{rounds}");
    }
}

/// The counter is read before the pass clears it, in frames whose dispatches share a compute pass,
/// too.
#[test]
fn a_round_begins_before_its_counter_is_cleared() {
    let files = Files::graph(
        r#"
        materials: [Buffer(name: "left"), Buffer(name: "ran")],
        passes: [
            Compute(name: "begin", dispatch: Groups(1, 1, 1), overwrites: ["left", "ran"]),
            Group(name: "round", repeat: 5, while: "left", passes: [
                Compute(name: "count", dispatch: Groups(1, 1, 1), clear: ["left"]),
            ]),
        ],
        outputs: ["ran"],
        "#,
    );
    let globals = "var<storage, read_write> left: u32; var<storage, read_write> ran: u32;";
    let begin =
        format!("{globals} @compute @workgroup_size(1) fn main() {{ left = 7u; ran = 0u; }}");
    let count = format!(
        "{globals} @compute @workgroup_size(1) fn main() {{
            ran += 1u;
            if ran < 3u {{ left += 1u; }}
        }}"
    );
    let files = files.with("begin.wgsl", begin).with("count.wgsl", count);
    assert_eq!(words(&files, "ran"), [3]);
}
