//! Tests of a draw: faces, depths and stencils, each feature by itself on the device, to the bit.

use crate::featured::{GPU, VALUE, floats, words};
use crate::support::Files;

/// A triangle over everything, at the depth `params.z`, wound clockwise where `params.turned`; it
/// writes 1.
const COVER: &str = "struct Params { z: f32, turned: u32 }
    var<uniform> params: Params;
    @vertex fn vertex(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4<f32> {
        var corners = array(vec2(-1.0, -1.0), vec2(3.0, -1.0), vec2(-1.0, 3.0));
        let at = select(corner, 2u - corner, params.turned != 0u);
        return vec4(corners[at], params.z, 1.0);
    }
    @fragment fn fragment() -> @location(0) f32 { return 1.0; }";

/// Draws [`COVER`] with these fields into `image`, which is cleared to 0: its first texel.
fn covered(fields: &str, materials: &str, before: &str) -> f32 {
    let files = Files::graph(&format!(
        r#"
        params: [Choice(name: "side", words: [none, front, back], default: back)],
        materials: [Texture(name: "image", format: R32Float), {materials}],
        passes: [{before} Raster(name: "cover", draw: 3, color: ["image"], {fields})],
        outputs: ["image"],
        "#
    ));
    floats(&files.with("cover.wgsl", COVER), "image")[0]
}

#[test]
fn faces_are_culled_as_their_winding_says() {
    for (turned, cull, expected) in [
        (false, "cull: None", 1.0),
        (false, "cull: Back", 1.0),
        (false, "cull: Front", 0.0),
        (true, "cull: Back", 0.0),
        (true, "cull: Front", 1.0),
        (true, "cull: Back, front_face: Cw", 1.0),
        (false, "cull: Back, front_face: Cw", 0.0),
        (true, r#"cull: "side""#, 0.0),
        (false, r#"cull: "side""#, 1.0),
    ] {
        let fields = format!(r#"set: {{"z": 0.5, "turned": {turned}}}, {cull}"#);
        assert_eq!(covered(&fields, "", ""), expected, "{turned}, {cull}");
    }
}

#[test]
fn depths_are_compared_with_what_stands_there() {
    let depth = r#"Texture(name: "depth", format: Depth32Float)"#;
    let before = r#"Clear(name: "reset", target: "depth", value: 0.5),"#;
    for (compare, passes) in [
        ("Less", [true, false, false]),
        ("LessEqual", [true, true, false]),
        ("Greater", [false, false, true]),
        ("GreaterEqual", [false, true, true]),
        ("Equal", [false, true, false]),
        ("NotEqual", [true, false, true]),
        ("Always", [true; 3]),
        ("Never", [false; 3]),
    ] {
        for (z, passes) in [0.25, 0.5, 0.75].into_iter().zip(passes) {
            let fields = format!(
                r#"set: {{"z": {z}, "turned": false}},
                depth: (target: "depth", load: Load, compare: {compare})"#
            );
            let coverage = covered(&fields, depth, before);
            assert_eq!(coverage, f32::from(passes), "{z} {compare} 0.5");
        }
    }
}

/// Compares the depth after the draw.
#[test]
fn a_depth_is_cleared_kept_and_written_as_its_fields_say() {
    for (fields, expected) in [
        ("", 0.25),
        ("load: Clear(0.125)", 0.125),
        ("write: false", 1.0),
        ("write: false, load: Clear(0.75)", 0.75),
        ("load: Load", 0.25),
        ("load: Load, compare: Greater", 0.5),
        // A unit of bias is one step of the f32 depth, which is 2^-25 below a half.
        ("bias: (constant: 2)", 0.25 + 2.0 * 2f32.powi(-25)),
    ] {
        let files = Files::graph(&format!(
            r#"
            materials: [Texture(name: "depth", format: Depth32Float)],
            passes: [
                Clear(name: "reset", target: "depth", value: 0.5),
                Raster(name: "cover", draw: 3, depth: (target: "depth", {fields}),
                    set: {{"z": 0.25, "turned": false}}),
            ],
            outputs: ["depth"],
            "#
        ));
        let files = files.with("cover.wgsl", COVER);
        assert_eq!(floats(&files, "depth"), [expected; 16], "{fields}");
    }
}

#[test]
fn what_lies_behind_the_far_plane_is_drawn_where_nothing_is_clipped() {
    let depth = r#"Texture(name: "depth", format: Depth32Float)"#;
    assert!(
        GPU.device
            .features()
            .contains(wgpu::Features::DEPTH_CLIP_CONTROL)
    );
    for (unclipped, expected) in [(true, 1.0), (false, 0.0)] {
        let fields = format!(
            r#"set: {{"z": 1.5, "turned": false}}, unclipped: {unclipped},
            depth: (target: "depth", compare: LessEqual)"#
        );
        assert_eq!(covered(&fields, depth, ""), expected, "{unclipped}");
    }
}

/// The stencil after a triangle at depth 0.5 was drawn; it was `start`, and the depth was `depth`.
fn stencil_after(start: u32, depth: f32, turned: bool, fields: &str) -> Vec<u32> {
    let files = Files::graph(&format!(
        r#"
        materials: [
            Texture(name: "ds", format: Depth24PlusStencil8),
            Texture(name: "seen", format: R32Uint),
        ],
        passes: [
            Clear(name: "reset", target: "ds", value: ({depth}, {start})),
            Raster(name: "cover", draw: 3, set: {{"z": 0.5, "turned": {turned}}},
                depth: (target: "ds", load: Load, write: false),
                stencil: (target: "ds", load: Load, {fields})),
            Fullscreen(name: "see", color: ["seen"], bind: {{"stencil": "ds"}}),
        ],
        outputs: ["seen"],
        "#
    ));
    let see = "var stencil: texture_2d<u32>;
        @fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) u32 {
            return textureLoad(stencil, vec2<u32>(centre.xy), 0).x;
        }";
    let files = files.with("cover.wgsl", COVER).with("see.wgsl", see);
    words(&files, "seen")
}

#[test]
fn the_stencil_is_written_and_tested() {
    for (start, fields, expected) in [
        (7, "", 7),
        (7, "front: (pass: Zero)", 0),
        (7, "front: (pass: Replace), reference: 9", 9),
        (7, "front: (pass: Invert)", 248),
        (7, "front: (pass: IncrementClamp)", 8),
        (255, "front: (pass: IncrementClamp)", 255),
        (255, "front: (pass: IncrementWrap)", 0),
        (0, "front: (pass: DecrementClamp)", 0),
        (0, "front: (pass: DecrementWrap)", 255),
        (7, "front: (compare: Never, fail: Zero, pass: Invert)", 0),
        (
            7,
            "front: (compare: Equal, fail: Zero, pass: Invert), reference: 7",
            248,
        ),
        (
            7,
            "front: (compare: Less, fail: Zero, pass: Invert), reference: 7",
            0,
        ),
        (
            7,
            "front: (compare: Less, fail: Zero, pass: Invert), reference: 6",
            248,
        ),
        (
            0x17,
            "front: (compare: Equal, pass: Zero), reference: 7, read_mask: 15",
            0,
        ),
        (
            0x70,
            "front: (pass: Replace), reference: 255, write_mask: 15",
            0x7f,
        ),
        (7, "front: (depth_fail: Zero)", 7),
        (7, "back: (pass: Zero)", 7),
    ] {
        let stencil = stencil_after(start, 1.0, false, fields);
        assert_eq!(stencil, [expected; 16], "{start} with {fields}");
    }
    // Behind what is there, and of the other side.
    let z_fail = "front: (depth_fail: DecrementWrap), back: (depth_fail: IncrementWrap)";
    assert_eq!(stencil_after(7, 0.25, false, z_fail), [6; 16]);
    assert_eq!(stencil_after(7, 0.25, true, z_fail), [8; 16]);
    assert_eq!(stencil_after(7, 1.0, true, z_fail), [7; 16]);
}

#[test]
fn a_stencil_says_where_a_later_pass_draws() {
    let files = Files::graph(
        r#"
        materials: [
            Texture(name: "mask", format: Stencil8),
            Texture(name: "image", format: R32Float),
        ],
        passes: [
            Clear(name: "reset", target: "mask"),
            Fullscreen(name: "mark", area: (1, 0, 2, 4),
                stencil: (target: "mask", front: (pass: Replace), reference: 3)),
            Fullscreen(name: "fill", color: ["image"], set: {"value": 0.5},
                stencil: (target: "mask", load: Load, front: (compare: Equal), reference: 3)),
        ],
        outputs: ["image"],
        "#,
    );
    let files = files
        .with("mark.wgsl", "@fragment fn fragment() {}")
        .with("fill.wgsl", VALUE);
    assert_eq!(floats(&files, "image"), [0.0, 0.5, 0.5, 0.0].repeat(4));
}

#[test]
fn both_aspects_of_one_texture_are_bound() {
    let files = Files::graph(
        r#"
        materials: [
            Texture(name: "ds", format: Depth24PlusStencil8),
            Texture(name: "seen", format: Rg32Float),
        ],
        passes: [
            Clear(name: "reset", target: "ds", value: (1, 200)),
            Fullscreen(name: "see", color: ["seen"], bind: {"depth": "ds", "stencil": "ds"}),
        ],
        outputs: ["seen"],
        "#,
    );
    let see = "var depth: texture_depth_2d;
        var stencil: texture_2d<u32>;
        @fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) vec2<f32> {
            let pixel = vec2<u32>(centre.xy);
            return vec2(textureLoad(depth, pixel, 0), f32(textureLoad(stencil, pixel, 0).x));
        }";
    assert_eq!(
        floats(&files.with("see.wgsl", see), "seen"),
        [1.0, 200.0].repeat(16)
    );
}

/// A plane that rises by an eighth per texel.
#[test]
fn a_depth_bias_grows_with_the_slope_up_to_its_clamp() {
    for (bias, expected) in [
        ("", 0.0),
        ("bias: (slope_scale: 1)", 0.125),
        ("bias: (slope_scale: \"steps / 4\")", 0.0625),
        ("bias: (slope_scale: -2)", -0.25),
        ("bias: (slope_scale: 1, clamp: 0.03125)", 0.03125),
    ] {
        let files = Files::graph(&format!(
            r#"
            params: [F32(name: "steps", default: 2)],
            materials: [Texture(name: "depth", format: Depth32Float)],
            passes: [Raster(name: "plane", draw: 3, depth: (target: "depth", {bias}))],
            outputs: ["depth"],
            "#
        ));
        let plane = "@vertex fn vertex(@builtin(vertex_index) corner: u32)
                -> @builtin(position) vec4<f32> {
                let at = vec2(f32(corner & 1u), f32(corner >> 1u)) * 4.0 - 1.0;
                return vec4(at, 0.5 + 0.25 * at.x, 1.0);
            }";
        let depths = floats(&files.with("plane.wgsl", plane), "depth");
        let row = [0.3125, 0.4375, 0.5625, 0.6875].map(|depth| depth + expected);
        assert_eq!(depths, row.repeat(4), "{bias}");
    }
}

#[test]
fn a_fragment_shader_says_its_own_depth() {
    let files = Files::graph(
        r#"
        materials: [Texture(name: "depths", format: Depth32Float, size: 4, layers: 2)],
        passes: [
            Clear(name: "reset", target: "depths", value: 0.5),
            Raster(name: "near", draw: 3, depth: (target: "depths[1]", load: Load)),
        ],
        outputs: ["depths"],
        "#,
    );
    let near = "@vertex fn vertex(@builtin(vertex_index) corner: u32)
            -> @builtin(position) vec4<f32> {
            return vec4(vec2(f32(corner & 1u), f32(corner >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
        }
        @fragment fn fragment(@builtin(position) centre: vec4<f32>)
            -> @builtin(frag_depth) f32 {
            return floor(centre.x) / 4.0;
        }";
    let depths = floats(&files.with("near.wgsl", near), "depths");
    let drawn = [0.0, 0.25, 0.5, 0.5].repeat(4);
    assert_eq!(depths, [&[0.5; 16][..], &drawn].concat());
}

#[test]
fn a_depth_that_is_not_written_is_tested_and_sampled_in_one_pass() {
    let files = Files::graph(
        r#"
        materials: [
            Texture(name: "depth", format: Depth16Unorm),
            Texture(name: "image", format: R32Float),
        ],
        passes: [
            Clear(name: "reset", target: "depth", value: 1),
            Raster(name: "corner", draw: 3, set: {"z": 0}, fragment: "nothing",
                area: (0, 0, 2, 2), depth: "depth"),
            Raster(name: "look", shader: "corner", draw: 3, set: {"z": 0.5}, fragment: "look",
                color: ["image"], depth: (target: "depth", load: Load, write: false)),
        ],
        outputs: ["image"],
        "#,
    );
    let corner = "struct Params { z: f32 }
        var<uniform> params: Params;
        var depth: texture_depth_2d;
        @vertex fn vertex(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4<f32> {
            let at = vec2(f32(corner & 1u), f32(corner >> 1u));
            return vec4(at * 4.0 - 1.0, params.z, 1.0);
        }
        @fragment fn nothing() {}
        @fragment fn look(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
            return 7.0 * textureLoad(depth, vec2<u32>(centre.xy), 0);
        }";
    let texels = floats(&files.with("corner.wgsl", corner), "image");
    let upper = [0.0, 0.0, 7.0, 7.0].repeat(2);
    assert_eq!(texels, [upper, vec![7.0; 8]].concat());
}
