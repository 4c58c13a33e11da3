//! Textures, buffers and samplers: each feature by itself on the device, to the bit.

use crate::featured::{COUNT, Running, VALUE, buffer_floats, floats, words};
use crate::support::Files;

/// Writes what `source` holds in the same place, in mip 0 of what is bound.
const READ: &str = "var source: texture_2d<f32>;
    @fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
        return textureLoad(source, vec2<u32>(centre.xy), 0).x;
    }";

#[test]
fn a_solid_texture_is_written_by_slice_and_by_texel_and_read_everywhere() {
    let files = Files::graph(
        r#"
        materials: [
            Texture(name: "solid", format: R32Float, size: (4, 2, 3)),
            Texture(name: "other", format: R32Float, size: (4, 2, 2)),
            Texture(name: "sum", format: R32Float, size: (4, 2)),
        ],
        passes: [
            Compute(name: "fill", dispatch: Over("solid.size"), overwrites: ["solid"]),
            Fullscreen(name: "value", color: ["solid[1]"], set: {"value": 1000}),
            Clear(name: "reset", target: "other"),
            Copy(name: "take", from: "solid[2]", to: "other[1]"),
            Fullscreen(name: "add", color: ["sum"]),
        ],
        outputs: ["solid", "other", "sum"],
        "#,
    );
    let fill = "var solid: texture_storage_3d<r32float, write>;
        @compute @workgroup_size(2, 2, 2) fn main(@builtin(global_invocation_id) at: vec3<u32>) {
            if all(at < textureDimensions(solid)) {
                textureStore(solid, at, vec4(f32(at.x + 10u * at.y + 100u * at.z)));
            }
        }";
    let add = "var solid: texture_3d<f32>;
        @fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
            let at = vec2<u32>(centre.xy);
            return textureLoad(solid, vec3(at, 0u), 0).x + textureLoad(solid, vec3(at, 1u), 0).x
                + textureLoad(solid, vec3(at, 2u), 0).x;
        }";
    let files = files.with("fill.wgsl", fill).with("add.wgsl", add);
    let mut running = Running::new(&files.with("value.wgsl", VALUE));
    let first = [0.0, 1.0, 2.0, 3.0, 10.0, 11.0, 12.0, 13.0];
    let last = first.map(|value| value + 200.0);
    let texels = [first, [1000.0; 8], last].concat();
    assert_eq!(running.floats("solid"), texels);
    assert_eq!(running.floats("other"), [[0.0; 8], last].concat());
    let sum: Vec<f32> = (0..8).map(|at| first[at] + 1000.0 + last[at]).collect();
    assert_eq!(running.floats("sum"), sum);
}

#[test]
fn a_texture_from_a_file_holds_its_picture() {
    for format in ["R8Unorm", "R16Float", "R32Float"] {
        let files = Files::graph(&format!(
            r#"
            materials: [
                Texture(name: "noise", format: {format}, file: "noise.png"),
                Texture(name: "image", format: R32Float, size: "noise.size"),
            ],
            passes: [Fullscreen(name: "read", color: ["image"], bind: {{"source": "noise"}})],
            outputs: ["image"],
            "#
        ));
        let files = files.picture("noise.png", 3, &[0, 51, 102, 153, 204, 255]);
        let texels = floats(&files.with("read.wgsl", READ), "image");
        // Rounded to the picture's steps: 0.2 is none of a texture's.
        let steps: Vec<f32> = texels.iter().map(|value| (value * 255.0).round()).collect();
        assert_eq!(steps, [0.0, 51.0, 102.0, 153.0, 204.0, 255.0], "{format}");
    }
}

#[test]
fn a_buffer_with_data_holds_numbers_in_the_layout_of_its_shaders() {
    let files = Files::graph(
        r#"
        materials: [
            Buffer(name: "kernel", data: [0.25, 0.5, -1]),
            Buffer(name: "items", data: [((1, 2, 3), 4), ((5, 6, 7), 8)]),
            Buffer(name: "table", data: [(7, 9)]),
            Buffer(name: "found", count: 12),
        ],
        passes: [Compute(name: "gather", dispatch: Groups(1, 1, 1), overwrites: ["found"])],
        outputs: ["found"],
        "#,
    );
    let gather = "struct Item { at: vec3<f32>, number: u32 }
        var<storage, read> kernel: array<f32>;
        var<storage, read> items: array<Item>;
        var<uniform> table: vec2<i32>;
        var<storage, read_write> found: array<f32>;
        @compute @workgroup_size(1) fn main() {
            for (var at = 0u; at < arrayLength(&kernel); at++) { found[at] = kernel[at]; }
            for (var at = 0u; at < arrayLength(&items); at++) {
                found[3u + 4u * at] = items[at].at.x;
                found[4u + 4u * at] = items[at].at.y;
                found[5u + 4u * at] = items[at].at.z;
                found[6u + 4u * at] = f32(items[at].number);
            }
            found[11] = f32(table.x * table.y);
        }";
    let values = buffer_floats(&files.with("gather.wgsl", gather), "found");
    let items = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0];
    assert_eq!(values, [&[0.25, 0.5, -1.0][..], &items, &[63.0]].concat());
}

/// 4 · row + column, and the means of four, of sixteen.
#[test]
fn each_mip_of_a_full_chain_is_made_of_the_one_before() {
    let files = Files::graph(
        r#"
        materials: [Texture(name: "chain", format: R32Float, mips: All)],
        passes: [
            Fullscreen(name: "count", color: ["chain.mip[0]"]),
            Fullscreen(name: "halve", repeat: "chain.mips - 1",
                color: ["chain.mip[index + 1]"], bind: {"source": "chain.mip[index]"}),
        ],
        outputs: ["chain"],
        "#,
    );
    let halve = "var source: texture_2d<f32>;
        @fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
            let at = 2u * vec2<u32>(centre.xy);
            return (textureLoad(source, at, 0).x + textureLoad(source, at + vec2(1u, 0u), 0).x
                + textureLoad(source, at + vec2(0u, 1u), 0).x
                + textureLoad(source, at + vec2(1u, 1u), 0).x) / 4.0;
        }";
    let files = files.with("count.wgsl", COUNT).with("halve.wgsl", halve);
    let first: Vec<f32> = (0..16).map(|at| at as f32).collect();
    let rest = [2.5, 4.5, 10.5, 12.5, 7.5];
    assert_eq!(floats(&files, "chain"), [&first[..], &rest].concat());
}

#[test]
fn layers_are_written_one_by_one_and_read_as_an_array() {
    let files = Files::graph(
        r#"
        params: [U32(name: "count", default: 3)],
        materials: [
            Texture(name: "maps", format: R32Float, layers: "count"),
            Texture(name: "sum", format: R32Float),
            Texture(name: "two", format: R32Float),
        ],
        passes: [
            Fullscreen(name: "fill", shader: "value", repeat: "count", color: ["maps[index]"],
                set: {"value": "index + 1"}),
            Fullscreen(name: "add", color: ["sum"]),
            Fullscreen(name: "some", shader: "add", color: ["two"], bind: {"maps": "maps[1..3]"}),
        ],
        outputs: ["sum", "two"],
        "#,
    );
    let add = "var maps: texture_2d_array<f32>;
        @fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
            var sum = 0.0;
            for (var layer = 0u; layer < textureNumLayers(maps); layer++) {
                sum = 10.0 * sum + textureLoad(maps, vec2<u32>(centre.xy), layer, 0).x;
            }
            return sum;
        }";
    // `count` is an attribute's word, but params have a namespace of their own.
    let mut running = Running::new(&files.with("value.wgsl", VALUE).with("add.wgsl", add));
    assert_eq!(running.floats("sum"), [123.0; 16]);
    assert_eq!(running.floats("two"), [23.0; 16]);
}

#[test]
fn six_layers_are_a_cube() {
    let files = Files::graph(
        r#"
        materials: [
            Texture(name: "sky", format: R16Float, size: 4, layers: 6),
            Sampler(name: "nearest"),
            Buffer(name: "found", count: 6),
        ],
        passes: [
            Fullscreen(name: "side", repeat: 6, shader: "value", color: ["sky[index]"],
                set: {"value": "index"}),
            Compute(name: "look", dispatch: Groups(1, 1, 1), overwrites: ["found"]),
        ],
        outputs: ["found"],
        "#,
    );
    let look = "var sky: texture_cube<f32>;
        var nearest: sampler;
        var<storage, read_write> found: array<f32>;
        @compute @workgroup_size(1) fn main() {
            for (var axis = 0u; axis < 3u; axis++) {
                let way = vec3<f32>(vec3(axis) == vec3(0u, 1u, 2u));
                found[2u * axis] = textureSampleLevel(sky, nearest, way, 0.0).x;
                found[2u * axis + 1u] = textureSampleLevel(sky, nearest, -way, 0.0).x;
            }
        }";
    let files = files.with("value.wgsl", VALUE).with("look.wgsl", look);
    assert_eq!(
        buffer_floats(&files, "found"),
        [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    );
}

/// A texture of 0 and 1, and the place between them, outside at the left, and at three quarters.
#[test]
fn a_sampler_filters_repeats_and_compares() {
    for (sampler, expected) in [
        ("filter: Nearest", [1.0, 0.0, 1.0]),
        ("filter: Linear", [0.5, 0.0, 1.0]),
        ("address: Repeat", [1.0, 1.0, 1.0]),
        ("filter: Linear, address: Repeat", [0.5, 1.0, 1.0]),
        ("filter: Nearest, address: MirrorRepeat", [1.0, 0.0, 1.0]),
    ] {
        let files = Files::graph(&format!(
            r#"
            materials: [
                Texture(name: "pair", format: R16Float, file: "pair.png"),
                Sampler(name: "at", {sampler}),
                Buffer(name: "found", count: 3),
            ],
            passes: [Compute(name: "look", dispatch: Groups(1, 1, 1), overwrites: ["found"])],
            outputs: ["found"],
            "#
        ));
        let look = "var pair: texture_2d<f32>;
            var at: sampler;
            var<storage, read_write> found: array<f32>;
            @compute @workgroup_size(1) fn main() {
                found[0] = textureSampleLevel(pair, at, vec2(0.5, 0.5), 0.0).x;
                found[1] = textureSampleLevel(pair, at, vec2(-0.25, 0.5), 0.0).x;
                found[2] = textureSampleLevel(pair, at, vec2(0.75, 0.5), 0.0).x;
            }";
        let files = files
            .picture("pair.png", 2, &[0, 255])
            .with("look.wgsl", look);
        assert_eq!(buffer_floats(&files, "found"), expected, "{sampler}");
    }
}

#[test]
fn a_comparison_sampler_says_how_a_depth_compares() {
    for (compare, expected) in [("LessEqual", [1.0, 0.0]), ("Greater", [0.0, 1.0])] {
        let files = Files::graph(&format!(
            r#"
            materials: [
                Texture(name: "depth", format: Depth32Float),
                Sampler(name: "closer", filter: Linear, compare: {compare}),
                Buffer(name: "found", count: 2),
            ],
            passes: [
                Clear(name: "reset", target: "depth", value: 0.5),
                Compute(name: "look", dispatch: Groups(1, 1, 1), overwrites: ["found"]),
            ],
            outputs: ["found"],
            "#
        ));
        let look = "var depth: texture_depth_2d;
            var closer: sampler_comparison;
            var<storage, read_write> found: array<f32>;
            @compute @workgroup_size(1) fn main() {
                found[0] = textureSampleCompareLevel(depth, closer, vec2(0.5), 0.25);
                found[1] = textureSampleCompareLevel(depth, closer, vec2(0.5), 0.75);
            }";
        let values = buffer_floats(&files.with("look.wgsl", look), "found");
        assert_eq!(values, expected, "{compare}");
    }
}

#[test]
fn copies_move_parts_of_textures_and_buffers() {
    let files = Files::graph(
        r#"
        materials: [
            Texture(name: "maps", format: R32Float, layers: 2, mips: 2),
            Texture(name: "small", format: R32Float, size: 2),
            Buffer(name: "kernel", data: [1, 2, 3]),
            Buffer(name: "copied", count: 3),
        ],
        passes: [
            Clear(name: "reset", target: "maps", value: 5),
            Fullscreen(name: "count", color: ["maps[0].mip[0]"]),
            Copy(name: "layer", from: "maps[0].mip[0]", to: "maps[1].mip[0]"),
            Fullscreen(name: "value", color: ["maps[1].mip[1]"], set: {"value": 7}),
            Copy(name: "mip", from: "maps[1].mip[1]", to: "small"),
            Copy(name: "numbers", from: "kernel", to: "copied"),
            Compute(name: "double", dispatch: Groups(1, 1, 1)),
        ],
        outputs: ["maps", "small", "copied"],
        "#,
    );
    let double = "var<storage, read> kernel: array<u32>;
        var<storage, read_write> copied: array<u32>;
        @compute @workgroup_size(1) fn main() { copied[1] = 2u * copied[1] + kernel[2]; }";
    let files = files.with("count.wgsl", COUNT).with("value.wgsl", VALUE);
    let mut running = Running::new(&files.with("double.wgsl", double));
    let counted: Vec<f32> = (0..16).map(|at| at as f32).collect();
    let (kept, written) = ([5.0; 4], [7.0; 4]);
    assert_eq!(
        running.floats("maps"),
        [&counted[..], &counted, &kept, &written].concat()
    );
    assert_eq!(running.floats("small"), written);
    assert_eq!(running.words("copied"), [1, 7, 3]);
}

#[test]
fn an_item_of_a_buffer_is_bound_where_it_lies() {
    let files = Files::graph(
        r#"
        materials: [
            Buffer(name: "slots", count: 3),
            Texture(name: "image", format: R32Float, layers: 3),
        ],
        passes: [
            Compute(name: "fill", dispatch: Groups(1, 1, 1), overwrites: ["slots"]),
            Fullscreen(name: "show", repeat: 3, color: ["image[index]"],
                bind: {"slot": "slots[2 - index]"}),
        ],
        outputs: ["image"],
        "#,
    );
    let slot = "struct Slot { @size(256) value: f32 }\n";
    let fill = "var<storage, read_write> slots: array<Slot>;
        @compute @workgroup_size(1) fn main() {
            for (var at = 0u; at < 3u; at++) { slots[at].value = f32(at) + 0.5; }
        }";
    let show = "var<uniform> slot: Slot;
        @fragment fn fragment() -> @location(0) f32 { return slot.value; }";
    let files = files
        .with("fill.wgsl", format!("{slot}{fill}"))
        .with("show.wgsl", format!("{slot}{show}"));
    let expected = [[2.5; 16], [1.5; 16], [0.5; 16]].concat();
    assert_eq!(floats(&files, "image"), expected);
}

#[test]
fn a_linear_sampler_mixes_two_mips() {
    let files = Files::graph(
        r#"
        materials: [
            Texture(name: "chain", format: R16Float, mips: All),
            Sampler(name: "mixed", filter: Linear),
            Buffer(name: "found", count: "2 * chain.mips - 1"),
        ],
        passes: [
            Fullscreen(name: "value", repeat: "chain.mips", color: ["chain.mip[index]"],
                set: {"value": "8 * index"}),
            Compute(name: "look", dispatch: Groups(1, 1, 1), overwrites: ["found"]),
        ],
        outputs: ["found"],
        "#,
    );
    let look = "var chain: texture_2d<f32>;
        var mixed: sampler;
        var<storage, read_write> found: array<f32>;
        @compute @workgroup_size(1) fn main() {
            for (var at = 0u; at < arrayLength(&found); at++) {
                found[at] = textureSampleLevel(chain, mixed, vec2(0.5), f32(at) / 2.0).x;
            }
        }";
    let files = files.with("value.wgsl", VALUE).with("look.wgsl", look);
    assert_eq!(buffer_floats(&files, "found"), [0.0, 4.0, 8.0, 12.0, 16.0]);
}

#[test]
fn a_part_of_a_texture_is_stored_into_and_changed_in_place() {
    let files = Files::graph(
        r#"
        materials: [Texture(name: "maps", format: R32Uint, size: 2, layers: 3, mips: 2)],
        passes: [
            Clear(name: "reset", target: "maps", value: 5),
            Compute(name: "fill", dispatch: Groups(1, 1, 1),
                bind: {"layers": "maps[1..3].mip[1]", "image": "maps[0].mip[0]"}),
        ],
        outputs: ["maps"],
        "#,
    );
    let fill = "var layers: texture_storage_2d_array<r32uint, write>;
        var image: texture_storage_2d<r32uint, read_write>;
        @compute @workgroup_size(1) fn main() {
            textureStore(layers, vec2(0u), 0u, vec4(10u));
            textureStore(layers, vec2(0u), 1u, vec4(20u));
            let before = textureLoad(image, vec2(1u)).x;
            textureStore(image, vec2(1u), vec4(2u * before));
        }";
    let texels = words(&files.with("fill.wgsl", fill), "maps");
    assert_eq!(texels, [&[5, 5, 5, 10][..], &[5; 8], &[5, 10, 20]].concat());
}

#[test]
fn every_shape_of_texture_can_be_cleared() {
    for (texture, value, expected) in [
        ("format: R32Float", "-1.5", -1.5),
        ("format: R16Float, mips: All, layers: 3", "-1", -1.0),
        ("format: R16Float, size: (4, 4, 3)", "0.25", 0.25),
        ("format: Depth32Float, layers: 2", "0.75", 0.75),
        ("format: Rgba8Unorm", "(1, 1, 1, 1)", 1.0),
    ] {
        let files = Files::graph(&format!(
            r#"
            materials: [Texture(name: "image", {texture})],
            passes: [Clear(name: "fill", target: "image", value: {value})],
            outputs: ["image"],
            "#
        ));
        let texels = floats(&files, "image");
        assert!(
            texels.iter().all(|&texel| texel == expected),
            "{texture}: {texels:?}"
        );
        assert!(texels.len() >= 16, "{texture}");
    }
}

#[test]
fn an_output_may_be_a_part() {
    let files = Files::graph(
        r#"
        materials: [Texture(name: "maps", format: R32Float, layers: 3, mips: 2)],
        passes: [
            Clear(name: "reset", target: "maps", value: 1),
            Fullscreen(name: "value", color: ["maps[1].mip[1]"], set: {"value": 2}),
        ],
        outputs: [
            (name: "layer", material: "maps[1]"),
            (name: "some", material: "maps[1..3].mip[1]"),
            (name: "mip", material: "maps.mip[0]"),
        ],
        "#,
    );
    let mut running = Running::new(&files.with("value.wgsl", VALUE));
    assert_eq!(
        running.floats("layer"),
        [&[1.0; 16][..], &[2.0; 4]].concat()
    );
    assert_eq!(running.floats("some"), [[2.0; 4], [1.0; 4]].concat());
    assert_eq!(running.floats("mip"), [1.0; 48]);
}

#[test]
fn items_of_a_buffer_are_cleared_and_copied_one_by_one() {
    let files = Files::graph(
        r#"
        materials: [Buffer(name: "items", count: 5), Buffer(name: "two", count: 2)],
        passes: [
            Compute(name: "count", dispatch: Groups(1, 1, 1), overwrites: ["items"]),
            Clear(name: "zero", target: "items[1]"),
            Copy(name: "last", from: "items[4]", to: "two[0]"),
            Copy(name: "first", from: "items[0]", to: "two[1]"),
            Compute(name: "see", dispatch: Groups(1, 1, 1)),
        ],
        outputs: ["items", "two"],
        "#,
    );
    let count = "var<storage, read_write> items: array<vec2<u32>>;
        @compute @workgroup_size(1) fn main() {
            for (var at = 0u; at < 5u; at++) { items[at] = vec2(at + 1u, 10u * at + 10u); }
        }";
    let see = "var<storage, read_write> two: array<vec2<u32>>;
        @compute @workgroup_size(1) fn main() { two[0].x += 100u; }";
    let files = files.with("count.wgsl", count).with("see.wgsl", see);
    let mut running = Running::new(&files);
    assert_eq!(running.words("items"), [1, 10, 0, 0, 3, 30, 4, 40, 5, 50]);
    assert_eq!(running.words("two"), [105, 50, 1, 10]);
}

/// Binds parts of the version of the frame before.
#[test]
fn parts_of_what_was_before_are_bound() {
    let files = Files::graph(
        r#"
        materials: [Texture(name: "maps", format: R32Float, layers: 2, mips: 2)],
        passes: [
            Fullscreen(name: "add", repeat: 2, color: ["maps[index].mip[0]"],
                bind: {"source": "maps[1 - index].previous.mip[1]"}),
            Fullscreen(name: "half", repeat: 2, color: ["maps[index].mip[1]"],
                bind: {"source": "maps[index].mip[0]"}),
        ],
        outputs: ["maps"],
        "#,
    );
    let add = "struct Params { index: u32 }
        var<uniform> params: Params;
        var source: texture_2d<f32>;
        @fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
            let at = vec2<u32>(centre.xy) / 2u;
            return 1.0 + 9.0 * f32(params.index) + textureLoad(source, at, 0).x;
        }";
    let half = READ.replace("vec2<u32>(centre.xy)", "2u * vec2<u32>(centre.xy)");
    let mut running = Running::new(&files.with("add.wgsl", add).with("half.wgsl", half));
    for [first, second] in [[1.0, 10.0], [11.0, 11.0], [12.0, 21.0]] {
        let expected = [&[first; 16][..], &[second; 16], &[first; 4], &[second; 4]].concat();
        assert_eq!(running.floats("maps"), expected);
    }
}

#[test]
fn a_depth_of_several_samples_is_drawn_and_read() {
    let files = Files::graph(
        r#"
        params: [U32(name: "samples", default: 4)],
        materials: [
            Texture(name: "depth", format: Depth32Float, samples: "samples"),
            Texture(name: "seen", format: Rg32Float),
        ],
        passes: [
            Raster(name: "half", draw: 3, depth: "depth"),
            Fullscreen(name: "look", color: ["seen"], set: {"last": "depth.samples - 1"}),
        ],
        outputs: ["seen"],
        "#,
    );
    let half = "@vertex fn vertex(@builtin(vertex_index) corner: u32)
            -> @builtin(position) vec4<f32> {
            return vec4(vec2(f32(corner & 1u), f32(corner >> 1u)) * 4.0 - 1.0, 0.25, 1.0);
        }
        @fragment fn fragment() -> @builtin(sample_mask) u32 { return 7u; }";
    let look = "struct Params { last: u32 }
        var<uniform> params: Params;
        var depth: texture_depth_multisampled_2d;
        @fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) vec2<f32> {
            let at = vec2<u32>(centre.xy);
            return vec2(textureLoad(depth, at, 0), textureLoad(depth, at, params.last));
        }";
    let files = files.with("half.wgsl", half).with("look.wgsl", look);
    assert_eq!(floats(&files, "seen"), [0.25, 1.0].repeat(16));
}

#[test]
fn a_mip_is_stored_from_the_one_before() {
    let files = Files::graph(
        r#"
        materials: [Texture(name: "chain", format: R32Float, mips: All)],
        passes: [
            Fullscreen(name: "value", color: ["chain.mip[0]"], set: {"value": 5}),
            Compute(name: "twice", repeat: "chain.mips - 1", dispatch: Over("chain.size"),
                bind: {"source": "chain.mip[index]", "next": "chain.mip[index + 1]"}),
        ],
        outputs: ["chain"],
        "#,
    );
    let twice = "var source: texture_2d<f32>;
        var next: texture_storage_2d<r32float, write>;
        @compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) at: vec3<u32>) {
            if all(at.xy < textureDimensions(next)) {
                textureStore(next, at.xy, 2.0 * textureLoad(source, 2u * at.xy, 0));
            }
        }";
    let files = files.with("value.wgsl", VALUE).with("twice.wgsl", twice);
    let expected = [&[5.0; 16][..], &[10.0; 4], &[20.0]].concat();
    assert_eq!(floats(&files, "chain"), expected);
}

#[test]
fn a_copy_of_a_whole_texture_has_all_mips_and_layers() {
    let files = Files::graph(
        r#"
        materials: [
            Texture(name: "solid", format: R32Float, size: (4, 4, 4), mips: All),
            Texture(name: "same", format: R32Float, size: (4, 4, 4), mips: All),
        ],
        passes: [
            Clear(name: "reset", target: "solid", value: 1),
            Fullscreen(name: "value", color: ["solid[1].mip[1]"], set: {"value": 5}),
            Copy(name: "all", from: "solid", to: "same"),
        ],
        outputs: ["same"],
        "#,
    );
    // Four slices of 16 texels, two of 4, one.
    let expected = [&[1.0; 68][..], &[5.0; 4], &[1.0]].concat();
    assert_eq!(floats(&files.with("value.wgsl", VALUE), "same"), expected);
}
