//! Drawing passes: targets, vertices and stages, each feature by itself on the device, to the bit.

use crate::featured::{Running, VALUE, buffer_floats, floats};
use crate::support::Files;
use skiagraph_graph::ParamValue;

/// Where the triangle's parameter is 0 at the rectangle's left and 1 at its right.
#[test]
fn an_area_is_the_viewport_and_cuts_what_lies_outside() {
    let files = Files::graph(
        r#"
        params: [U32(name: "edge", default: 1)],
        materials: [Texture(name: "image", format: Rg32Float)],
        passes: [
            Clear(name: "reset", target: "image", value: 9),
            Raster(name: "quad", draw: 3, color: ["image"], area: ("edge", 1, "2 * edge", 2)),
        ],
        outputs: ["image"],
        "#,
    );
    let quad = "struct Corner { @builtin(position) clip: vec4<f32>, @location(0) at: vec2<f32> }
        @vertex fn vertex(@builtin(vertex_index) corner: u32) -> Corner {
            let at = vec2(f32(corner & 1u), f32(corner >> 1u)) * 2.0;
            return Corner(vec4(at * 2.0 - 1.0, 0.0, 1.0), vec2(at.x, 1.0 - at.y));
        }
        @fragment fn fragment(corner: Corner) -> @location(0) vec2<f32> { return corner.at; }";
    let texels = floats(&files.with("quad.wgsl", quad), "image");
    let texel = |x: usize, y: usize| [texels[8 * y + 2 * x], texels[8 * y + 2 * x + 1]];
    for (y, row) in [None, Some(0.25), Some(0.75), None].into_iter().enumerate() {
        for (x, column) in [None, Some(0.25), Some(0.75), None].into_iter().enumerate() {
            let expected = column.zip(row).map_or([9.0, 9.0], |(x, y)| [x, y]);
            assert_eq!(texel(x, y), expected, "{x}, {y}");
        }
    }
}

#[test]
fn only_the_channels_that_are_named_are_written() {
    for (write, expected) in [
        ("", [1.0, 1.0, 1.0, 1.0]),
        ("write: true", [1.0, 1.0, 1.0, 1.0]),
        ("write: r", [1.0, 0.5, 0.5, 0.5]),
        ("write: ga", [0.5, 1.0, 0.5, 1.0]),
        ("write: rgb", [1.0, 1.0, 1.0, 0.5]),
        ("write: false", [0.5, 0.5, 0.5, 0.5]),
    ] {
        let files = Files::graph(&format!(
            r#"
            materials: [Texture(name: "image", format: Rgba32Float)],
            passes: [Fullscreen(name: "ones",
                color: [(target: "image", load: Clear(0.5), {write})])],
            outputs: ["image"],
            "#
        ));
        let ones = "@fragment fn fragment() -> @location(0) vec4<f32> { return vec4(1.0); }";
        let texels = floats(&files.with("ones.wgsl", ones), "image");
        assert_eq!(texels, expected.repeat(16), "{write}");
    }
}

#[test]
fn what_is_drawn_is_blended_with_what_is_there() {
    for (blend, expected) in [
        ("", [1.0, 0.5, 0.0, 0.5]),
        ("blend: Alpha", [0.625, 0.375, 0.125, 0.75]),
        ("blend: Premultiplied", [1.125, 0.625, 0.125, 0.75]),
        ("blend: Additive", [1.25, 0.75, 0.25, 1.0]),
        ("blend: Min", [0.25, 0.25, 0.0, 0.5]),
        ("blend: Max", [1.0, 0.5, 0.25, 0.5]),
    ] {
        let files = Files::graph(&format!(
            r#"
            materials: [Texture(name: "image", format: Rgba16Float)],
            passes: [
                Clear(name: "reset", target: "image", value: (0.25, 0.25, 0.25, 0.5)),
                Fullscreen(name: "over", color: [(target: "image", load: Load, {blend})]),
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
fn every_target_has_its_own_clear_value() {
    let files = Files::graph(
        r#"
        materials: [
            Texture(name: "a", format: R32Float),
            Texture(name: "b", format: Rg32Uint),
            Texture(name: "c", format: R32Sint),
        ],
        passes: [Raster(name: "nothing", draw: 0, color: [
            (target: "a", load: Clear(-0.5)),
            (target: "b", load: Clear("NOTHING", 7, 0, 0)),
            (target: "c", load: Clear(-3)),
        ])],
        outputs: ["a", "b", "c"],
        "#,
    );
    let nothing = "const NOTHING: u32 = 0xffffffffu;
        struct Out { @location(0) a: f32, @location(1) b: vec2<u32>, @location(2) c: i32 }
        @vertex fn vertex() -> @builtin(position) vec4<f32> { return vec4(0.0); }
        @fragment fn fragment() -> Out { return Out(0.0, vec2(0u), 0); }";
    let mut running = Running::new(&files.with("nothing.wgsl", nothing));
    assert_eq!(running.floats("a"), [-0.5; 16]);
    assert_eq!(running.words("b"), [u32::MAX, 7].repeat(16));
    assert_eq!(running.content("c").as_i32(), Some(vec![-3; 16]));
}

/// Two of four samples of each pixel are drawn.
#[test]
fn samples_are_resolved_to_their_mean_and_read_one_by_one() {
    let files = Files::graph(
        r#"
        materials: [
            Texture(name: "fine", format: R16Float, samples: 4),
            Texture(name: "mean", format: R16Float),
            Texture(name: "each", format: Rgba32Float),
        ],
        passes: [
            Raster(name: "half", draw: 3, color: [(target: "fine", resolve: "mean")]),
            Fullscreen(name: "look", color: ["each"]),
        ],
        outputs: ["mean", "each"],
        "#,
    );
    let half = "struct Out { @location(0) value: f32, @builtin(sample_mask) mask: u32 }
        @vertex fn vertex(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4<f32> {
            return vec4(vec2(f32(corner & 1u), f32(corner >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
        }
        @fragment fn fragment() -> Out { return Out(1.0, 5u); }";
    let look = "var fine: texture_multisampled_2d<f32>;
        @fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) vec4<f32> {
            let pixel = vec2<u32>(centre.xy);
            return vec4(textureLoad(fine, pixel, 0).x, textureLoad(fine, pixel, 1).x,
                textureLoad(fine, pixel, 2).x, textureLoad(fine, pixel, 3).x);
        }";
    let mut running = Running::new(&files.with("half.wgsl", half).with("look.wgsl", look));
    assert_eq!(running.floats("mean"), [0.5; 16]);
    assert_eq!(running.floats("each"), [1.0, 0.0, 1.0, 0.0].repeat(16));
}

#[test]
fn a_topology_makes_triangles_lines_or_points_of_vertices() {
    // Four vertices: the corners of the target, left ones first, upper ones first of these.
    let corners = "@vertex fn vertex(@builtin(vertex_index) corner: u32)
            -> @builtin(position) vec4<f32> {
            let at = vec2(f32(corner >> 1u), 1.0 - f32(corner & 1u));
            return vec4(at * 1.5 - 0.75, 0.0, 1.0);
        }
        @fragment fn fragment() -> @location(0) f32 { return 1.0; }";
    for (fields, expected) in [
        ("draw: 1, topology: PointList", 1),
        ("draw: 4, topology: PointList", 4),
        ("draw: 4, topology: TriangleStrip", 9),
        ("draw: 2, topology: TriangleList", 0),
        ("draw: 2, topology: LineList", 3),
    ] {
        let files = Files::graph(&format!(
            r#"
            materials: [Texture(name: "image", format: R32Float)],
            passes: [Raster(name: "corners", color: ["image"], {fields})],
            outputs: ["image"],
            "#
        ));
        let texels = floats(&files.with("corners.wgsl", corners), "image");
        let drawn = texels.iter().filter(|&&value| value == 1.0).count();
        assert_eq!(drawn, expected, "{fields}: {texels:?}");
    }
}

/// Each instance adds its number plus one.
const INSTANCES: &str = "struct Corner {
        @builtin(position) clip: vec4<f32>,
        @location(0) @interpolate(flat) instance: u32,
    }
    @vertex fn vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) i: u32)
        -> Corner {
        let at = vec2(f32(corner & 1u), f32(corner >> 1u)) * 4.0 - 1.0;
        return Corner(vec4(at, 0.0, 1.0), i);
    }
    @fragment fn fragment(corner: Corner) -> @location(0) f32 {
        return f32(corner.instance + 1u);
    }";

#[test]
fn instances_are_drawn_one_after_the_other() {
    for (instances, expected) in [("1", 1.0), ("3", 6.0), ("\"n * n\"", 10.0), ("0", 0.0)] {
        let files = Files::graph(&format!(
            r#"
            params: [U32(name: "n", default: 2)],
            materials: [Texture(name: "image", format: R16Float)],
            passes: [
                Clear(name: "reset", target: "image"),
                Raster(name: "all", draw: 3, instances: {instances},
                    color: [(target: "image", load: Load, blend: Additive)]),
            ],
            outputs: ["image"],
            "#
        ));
        let texels = floats(&files.with("all.wgsl", INSTANCES), "image");
        assert_eq!(texels, [expected; 16], "{instances}");
    }
}

#[test]
fn a_draw_call_may_come_from_a_buffer() {
    let files = Files::graph(
        r#"
        materials: [
            Texture(name: "image", format: R16Float),
            Buffer(name: "call"),
        ],
        passes: [
            Compute(name: "ask", dispatch: Groups(1, 1, 1)),
            Clear(name: "reset", target: "image"),
            Raster(name: "all", draw: Indirect("call"),
                color: [(target: "image", load: Load, blend: Additive)]),
        ],
        outputs: ["image"],
        "#,
    );
    let ask = "var<storage, read_write> call: array<u32, 4>;
        @compute @workgroup_size(1) fn main() { call = array(3u, 2u, 0u, 0u); }";
    let files = files.with("ask.wgsl", ask).with("all.wgsl", INSTANCES);
    assert_eq!(floats(&files, "image"), [3.0; 16]);
}

#[test]
fn each_layer_and_mip_is_a_target() {
    let files = Files::graph(
        r#"
        materials: [Texture(name: "maps", format: R32Float, layers: 3, mips: 2)],
        passes: [
            Clear(name: "reset", target: "maps", value: -1),
            Fullscreen(name: "fill", repeat: 2, color: ["maps[index + 1].mip[index]"],
                set: {"value": "10 * (index + 1)"}),
        ],
        outputs: ["maps"],
        "#,
    );
    let content = Running::new(&files.with("fill.wgsl", VALUE)).content("maps");
    let parts = content.split();
    let parts: Vec<Vec<f32>> = parts.iter().filter_map(|part| part.as_f32()).collect();
    // The layers of mip 0, then those of mip 1.
    let expected = [
        (16, -1.0),
        (16, 10.0),
        (16, -1.0),
        (4, -1.0),
        (4, -1.0),
        (4, 20.0),
    ];
    assert_eq!(parts, expected.map(|(texels, value)| vec![value; texels]));
}

#[test]
fn a_fragment_shader_writes_a_buffer_and_a_texture() {
    let files = Files::graph(
        r#"
        materials: [
            Texture(name: "image", format: R32Float),
            Texture(name: "swapped", format: R32Uint),
            Buffer(name: "seen", count: "image.count"),
        ],
        passes: [
            Clear(name: "reset", target: "seen"),
            Fullscreen(name: "write", color: ["image"], overwrites: ["swapped"]),
        ],
        outputs: ["image", "swapped", "seen"],
        "#,
    );
    let write = "var<storage, read_write> seen: array<u32>;
        var swapped: texture_storage_2d<r32uint, write>;
        @fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
            let pixel = vec2<u32>(centre.xy);
            seen[4u * pixel.y + pixel.x] += 100u + pixel.x;
            textureStore(swapped, pixel.yx, vec4(10u * pixel.y + pixel.x));
            return 1.0;
        }";
    let mut running = Running::new(&files.with("write.wgsl", write));
    assert_eq!(running.words("seen"), [100, 101, 102, 103].repeat(4));
    let swapped = (0..16)
        .map(|at| 10 * (at % 4) + at / 4)
        .collect::<Vec<u32>>();
    assert_eq!(running.words("swapped"), swapped);
    assert_eq!(running.floats("image"), [1.0; 16]);
}

/// The vertices come from a buffer that the fragment shader does not know, and the other way round.
#[test]
fn a_binding_is_seen_by_the_stage_that_uses_it() {
    let files = Files::graph(
        r#"
        materials: [
            Buffer(name: "corners", data: [(-1, -1), (3, -1), (-1, 3)]),
            Buffer(name: "shade", data: [0.75]),
            Texture(name: "image", format: R32Float),
        ],
        passes: [Raster(name: "pull", draw: "corners.count", color: ["image"])],
        outputs: ["image"],
        "#,
    );
    let pull = "var<storage, read> corners: array<vec2<f32>>;
        var<uniform> shade: f32;
        @vertex fn vertex(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4<f32> {
            return vec4(corners[corner], 0.0, 1.0);
        }
        @fragment fn fragment() -> @location(0) f32 { return shade; }";
    assert_eq!(floats(&files.with("pull.wgsl", pull), "image"), [0.75; 16]);
}

#[test]
fn a_vertex_shader_writes_where_the_graph_asks_for_that() {
    let files = Files::graph(
        r#"
        requires: ["VERTEX_WRITABLE_STORAGE"],
        materials: [Buffer(name: "seen", count: 3), Texture(name: "image", format: R32Float)],
        passes: [
            Clear(name: "reset", target: "seen"),
            Raster(name: "write", draw: 3, color: ["image"]),
        ],
        outputs: ["seen"],
        "#,
    );
    let write = "var<storage, read_write> seen: array<f32>;
        @vertex fn vertex(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4<f32> {
            seen[corner] = 1.5 * f32(corner);
            return vec4(0.0);
        }
        @fragment fn fragment() -> @location(0) f32 { return 1.0; }";
    let values = buffer_floats(&files.with("write.wgsl", write), "seen");
    assert_eq!(values, [0.0, 1.5, 3.0]);
}

#[test]
fn a_pass_names_its_entry_points() {
    let files = Files::graph(
        r#"
        params: [Bool(name: "negative", default: false)],
        materials: [Texture(name: "image", format: R32Float)],
        passes: [
            Fullscreen(name: "one", if: "!negative", shader: "two", fragment: "plus",
                color: ["image"]),
            Fullscreen(name: "other", if: "negative", shader: "two", fragment: "minus",
                color: ["image"]),
        ],
        outputs: ["image"],
        "#,
    );
    let two = "@fragment fn plus() -> @location(0) f32 { return 1.0; }
        @fragment fn minus() -> @location(0) f32 { return -1.0; }";
    let files = files.with("two.wgsl", two);
    for (negative, expected) in [(false, 1.0), (true, -1.0)] {
        let params = [("negative", ParamValue::Bool(negative))];
        assert_eq!(
            Running::with(&files, &params).floats("image"),
            [expected; 16]
        );
    }
}

/// A mip is as large as it is, and what something is resolved into may be a part. (A layer is left
/// out here: lavapipe of Mesa 22.3 resolves into the first, whatever the view says.)
#[test]
fn an_area_and_a_resolve_may_be_of_a_mip() {
    let files = Files::graph(
        r#"
        materials: [
            Texture(name: "fine", format: R16Float, size: 2, samples: 4),
            Texture(name: "chain", format: R16Float, mips: 2),
            Texture(name: "maps", format: R16Float, layers: 2, mips: 2),
        ],
        passes: [
            Clear(name: "reset_fine", target: "fine", value: 2),
            Clear(name: "reset_chain", target: "chain", value: 3),
            Clear(name: "reset_maps", target: "maps", value: 4),
            Fullscreen(name: "part", shader: "value", set: {"value": 0.5}, area: (1, 0, 1, 2),
                color: [(target: "fine", resolve: "chain.mip[1]")]),
            Fullscreen(name: "corner", shader: "value", set: {"value": 7},
                area: ("maps.width / 4", 1, 1, 1), color: ["maps[1].mip[1]"]),
        ],
        outputs: ["chain", "maps"],
        "#,
    );
    let mut running = Running::new(&files.with("value.wgsl", VALUE));
    let chain = [&[3.0; 16][..], &[2.0, 0.5, 2.0, 0.5]].concat();
    assert_eq!(running.floats("chain"), chain);
    let maps = [&[4.0; 36][..], &[4.0, 4.0, 4.0, 7.0]].concat();
    assert_eq!(running.floats("maps"), maps);
}

/// A triangle that covers some of 37×23 texels, and what its fragment shader does.
fn triangle(globals: &str, fragment: &str) -> String {
    format!(
        "{globals}
        @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {{
            let corners = array(vec2(-0.9, -0.7), vec2(0.8, -0.3), vec2(-0.1, 0.95));
            return vec4(corners[index], 0.5, 1.0);
        }}
        {fragment}"
    )
}

const TOUCHED: &str = "var<storage, read_write> total: atomic<u32>;
    var marks: texture_storage_2d<r32uint, write>;";

/// Two passes without a target: one counts by atomics, one writes a storage texture, and each
/// touches the texels that the triangle fills in a target of that size.
#[test]
fn a_pass_without_a_target_touches_what_a_target_of_its_size_would_show() {
    let files = Files::graph(
        r#"
        params: [U32(name: "width", default: 37)],
        materials: [
            Texture(name: "image", format: R32Uint, size: ("width", 23)),
            Texture(name: "marks", format: R32Uint, size: "image.size"),
            Buffer(name: "total"),
            Buffer(name: "part"),
        ],
        passes: [
            Raster(name: "fill", draw: 3, color: ["image"]),
            Clear(name: "reset", target: "total"),
            Clear(name: "unmark", target: "marks"),
            Clear(name: "none", target: "part"),
            Raster(name: "touch", draw: 3, size: "image.size"),
            Raster(name: "touch_part", shader: "touch", fragment: "counted", draw: 3,
                size: "image.size", area: (9, 4, 20, 11), bind: {"total": "part"}),
        ],
        outputs: ["image", "marks", "total", "part"],
        "#,
    )
    .with(
        "fill.wgsl",
        triangle(
            "",
            "@fragment fn fragment() -> @location(0) u32 { return 1u; }",
        ),
    )
    .with(
        "touch.wgsl",
        triangle(
            TOUCHED,
            "@fragment fn fragment(@builtin(position) at: vec4<f32>) {
                atomicAdd(&total, 1u);
                textureStore(marks, vec2<u32>(at.xy), vec4(1u));
            }
            @fragment fn counted() { atomicAdd(&total, 1u); }",
        ),
    )
    .edited(
        "graph.ron",
        r#"name: "touch", draw"#,
        r#"name: "touch", fragment: "fragment", draw"#,
    );
    for width in [37, 64] {
        let mut running = Running::with(&files, &[("width", ParamValue::U32(width))]);
        let image = running.words("image");
        assert_eq!(image.len(), width as usize * 23);
        let filled: u32 = image.iter().sum();
        assert!(
            filled > 100 && (filled as usize) < image.len() / 2,
            "{filled}"
        );
        assert_eq!(running.words("marks"), image);
        // Every frame alike: the content of before is of no account.
        assert_eq!([0; 2].map(|_| running.words("total")[0]), [filled; 2]);
        // The viewport is the area, so the triangle is as much smaller.
        let part = running.words("part")[0];
        assert!((40..filled).contains(&part), "{part} of {filled}");
    }
}
