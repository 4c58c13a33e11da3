//! Outputs that are more than one picture come back whole, and parts of them as parts.

use crate::support::Files;
use crate::tiny::{self, frame, made, run, run_with, u32s};
use skiagraph_gpu::Content;

/// Every texel says where it is.
const PLACE: &str = "
struct Params { layer: u32, mip: u32 }
var<uniform> params: Params;
@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) u32 {
    let at = vec2<u32>(position.xy);
    return 1000u * params.mip + 100u * params.layer + 10u * at.y + at.x;
}";

/// Returns the texels that [`PLACE`] writes into a mip of a layer.
fn place(mip: u32, layer: u32, [width, height]: [u32; 2]) -> Vec<u32> {
    tiny::pixels([width, height], |x, y| {
        1000 * mip + 100 * layer + 10 * y + x
    })
}

#[track_caller]
fn is(content: &Content, expected: &[(u32, u32, [u32; 2])]) {
    let Content::Texture { parts, .. } = content else {
        panic!("it is a buffer");
    };
    let sizes: Vec<[u32; 2]> = expected.iter().map(|(.., size)| *size).collect();
    assert_eq!(*parts, sizes);
    let split: Vec<Vec<u32>> = content.split().iter().map(u32s).collect();
    let places = expected
        .iter()
        .map(|&(mip, layer, size)| place(mip, layer, size));
    assert_eq!(split, places.collect::<Vec<_>>());
    assert_eq!(u32s(content), split.concat());
}

/// The layers of the first mip, then those of the next.
#[test]
fn every_layer_and_mip_of_an_output_comes_back() {
    let files = Files::graph(
        r#"
    materials: [Texture(name: "maps", format: R32Uint, size: (3, 2), layers: 3, mips: 2)],
    passes: [
        Fullscreen(
            name: "fill",
            shader: "place",
            repeat: 6,
            set: {"layer": "index % 3", "mip": "index / 3"},
            color: ["maps[index % 3].mip[index / 3]"],
        ),
    ],
    outputs: [
        "maps",
        (name: "second", material: "maps[1]"),
        (name: "fine", material: "maps[1..3].mip[0]"),
        (name: "coarse", material: "maps.mip[1]"),
        (name: "one", material: "maps[2].mip[0]"),
    ],
"#,
    )
    .with("place.wgsl", PLACE);
    let contents = run(&files, &["maps", "second", "fine", "coarse", "one"]);
    let (fine, coarse) = ([3, 2], [1, 1]);
    let parts = [
        (0, 0, fine),
        (0, 1, fine),
        (0, 2, fine),
        (1, 0, coarse),
        (1, 1, coarse),
        (1, 2, coarse),
    ];
    is(&contents[0], &parts);
    is(&contents[1], &[(0, 1, fine), (1, 1, coarse)]);
    is(&contents[2], &[(0, 1, fine), (0, 2, fine)]);
    is(&contents[3], &parts[3..]);
    is(&contents[4], &[(0, 2, fine)]);
}

/// A mip of a 3D texture has half the slices.
#[test]
fn every_slice_of_a_3d_output_comes_back() {
    let files = Files::graph(
        r#"
    materials: [Texture(name: "volume", format: R32Uint, size: (5, 3, 4), mips: 2)],
    passes: [
        Fullscreen(
            name: "fill",
            shader: "place",
            repeat: 4,
            set: {"layer": "index", "mip": 0},
            color: ["volume[index].mip[0]"],
        ),
        Fullscreen(
            name: "reduce",
            shader: "place",
            repeat: 2,
            set: {"layer": "index", "mip": 1},
            color: ["volume[index].mip[1]"],
        ),
    ],
    outputs: [
        "volume",
        (name: "middle", material: "volume[1..3].mip[0]"),
        (name: "coarse", material: "volume.mip[1]"),
    ],
"#,
    )
    .with("place.wgsl", PLACE);
    let contents = run(&files, &["volume", "middle", "coarse"]);
    let (fine, coarse) = ([5, 3], [2, 1]);
    let parts = [
        (0, 0, fine),
        (0, 1, fine),
        (0, 2, fine),
        (0, 3, fine),
        (1, 0, coarse),
        (1, 1, coarse),
    ];
    is(&contents[0], &parts);
    is(&contents[1], &parts[1..3]);
    is(&contents[2], &parts[4..]);
}

/// An output that is an item of a buffer is not the rest of it.
#[test]
fn an_item_of_a_buffer_comes_back_alone() {
    let files = Files::graph(
        r#"
    materials: [Buffer(name: "items", count: 3)],
    passes: [
        Compute(
            name: "fill",
            repeat: 3,
            dispatch: Groups(1, 1, 1),
            bind: {"item": "items[index]"},
        ),
        Compute(name: "sum", dispatch: Over("items.count")),
    ],
    outputs: [
        "items",
        (name: "second", material: "items[1]"),
        (name: "rest", material: "items[1..3]"),
    ],
"#,
    )
    .with(
        "fill.wgsl",
        "struct Params { index: u32 } var<uniform> params: Params;
         var<storage, read_write> item: array<u32, 64>;
         @compute @workgroup_size(64) fn main(@builtin(local_invocation_index) at: u32) {
             item[at] = 100u * params.index + at;
         }",
    )
    .with(
        "sum.wgsl",
        "var<storage, read_write> items: array<array<u32, 64>>;
         @compute @workgroup_size(1) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
             if id.x < arrayLength(&items) { items[id.x][0] = 1000u * id.x; }
         }",
    );
    let mut executor = made(&files);
    let sizes: Vec<[u32; 2]> = executor
        .plan()
        .outputs()
        .iter()
        .map(|output| output.size)
        .collect();
    assert_eq!(sizes, [[768, 1], [256, 1], [512, 1]]);
    let report = frame(&mut executor, false, &["items", "second", "rest"]);
    let numbers: Vec<Vec<u32>> = report
        .readbacks
        .iter()
        .map(|readback| u32s(&readback.content))
        .collect();
    let item = |index: u32| {
        let rest = (1..64).map(move |at| 100 * index + at);
        [1000 * index].into_iter().chain(rest)
    };
    assert_eq!(
        numbers[0],
        (0..3).flat_map(item).collect::<Vec<_>>(),
        "all of it"
    );
    assert_eq!(numbers[1], item(1).collect::<Vec<_>>());
    assert_eq!(numbers[2], (1..3).flat_map(item).collect::<Vec<_>>());
}

/// The host binds what it asks for: 2D, layers, slices.
#[test]
fn views_of_outputs_are_as_the_output_is() {
    let files = Files::graph(
        r#"
    materials: [
        Texture(name: "maps", format: R32Uint, size: 2, layers: 3),
        Texture(name: "volume", format: R32Uint, size: (2, 2, 2)),
    ],
    passes: [Clear(name: "reset", target: "maps"), Clear(name: "wipe", target: "volume")],
    outputs: ["maps", (name: "one", material: "maps[1]"), "volume"],
"#,
    );
    let mut executor = made(&files);
    frame(&mut executor, false, &[]);
    // A view of a wrong dimension is refused by wgpu, which panics outside of error scopes.
    for name in ["maps", "one", "volume"] {
        assert!(executor.output_view(name).is_some(), "{name}");
    }
}

/// A part as it stood after the pass that wrote it, before the last one wrote over it.
#[test]
fn parts_are_captured_as_they_stood_after_a_pass() {
    let files = Files::graph(
        r#"
    materials: [
        Texture(name: "maps", format: R32Uint, size: (3, 2), layers: 3, mips: 2),
        Texture(name: "volume", format: R32Uint, size: (3, 2, 4)),
        Buffer(name: "items", count: 2),
    ],
    passes: [
        Fullscreen(
            name: "maps",
            shader: "place",
            repeat: 6,
            set: {"layer": "index % 3", "mip": "index / 3"},
            color: ["maps[index % 3].mip[index / 3]"],
        ),
        Fullscreen(
            name: "volume",
            shader: "place",
            repeat: 4,
            set: {"layer": "index", "mip": 0},
            color: ["volume[index]"],
        ),
        Compute(name: "start", dispatch: Over("items.count")),
        Compute(
            name: "items",
            repeat: 2,
            dispatch: Groups(1, 1, 1),
            bind: {"item": "items[index]"},
        ),
        Clear(name: "wipe_maps", target: "maps"),
        Clear(name: "wipe_volume", target: "volume"),
        Clear(name: "wipe_items", target: "items"),
    ],
    outputs: ["maps", "volume", "items"],
"#,
    )
    .with("place.wgsl", PLACE)
    .with(
        "start.wgsl",
        "var<storage, read_write> items: array<array<u32, 64>>;
         @compute @workgroup_size(2) fn main(@builtin(local_invocation_index) at: u32) {
             items[at][0] = 9u;
         }",
    )
    .with(
        "items.wgsl",
        "struct Params { index: u32 } var<uniform> params: Params;
         var<storage, read_write> item: array<u32, 64>;
         @compute @workgroup_size(64) fn main(@builtin(local_invocation_index) at: u32) {
             item[at] = 100u * params.index + at;
         }",
    );
    let captures = [
        ("maps[1]", Some("maps[5]")),
        ("maps[0..2].mip[0]", Some("maps[1]")),
        ("volume[2]", Some("volume[3]")),
        ("volume[1..3]", Some("volume[3]")),
        ("volume", Some("volume[3]")),
        ("items[1]", Some("items[1]")),
        ("items[1]", None),
    ];
    let read = [
        "maps[1]@maps[5]",
        "maps[0..2].mip[0]@maps[1]",
        "volume[2]@volume[3]",
        "volume[1..3]@volume[3]",
        "volume@volume[3]",
        "items[1]@items[1]",
        "items[1]",
    ];
    let contents = run_with(&files, &captures, &read);
    let fine = [3, 2];
    is(&contents[0], &[(0, 1, fine), (1, 1, [1, 1])]);
    is(&contents[1], &[(0, 0, fine), (0, 1, fine)]);
    is(&contents[2], &[(0, 2, fine)]);
    is(&contents[3], &[(0, 1, fine), (0, 2, fine)]);
    is(&contents[4], &[0, 1, 2, 3].map(|slice| (0, slice, fine)));
    assert_eq!(u32s(&contents[5]), (100..164).collect::<Vec<_>>());
    assert_eq!(u32s(&contents[6]), [0; 64], "at the end it is cleared");
}
