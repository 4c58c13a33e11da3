//! Statements of a plan about the content that is read back, and about memory.

use crate::support::{Files, Triangle, load, right};
use skiagraph_graph::{Capture, Field, ItemScalar, MemoryEntry, Plan, PlanRequest};

/// `draw` writes image and depth with the camera bound; `gather` writes the items without it;
/// `keep` copies both.
const DOCUMENT: &str = r#"
    materials: [
        Texture(name: "image", format: Rgba16Float, size: 8, mips: 2),
        Texture(name: "depth", format: Depth32Float, size: 8),
        Texture(name: "kept_depth", format: Depth32Float, size: 8),
        Buffer(name: "items", count: 5),
        Buffer(name: "kept", count: 5),
        Buffer(name: "total"),
    ],
    passes: [
        Raster(
            name: "draw",
            draw: "scene.positions.count",
            color: ["image.mip[0]"],
            depth: "depth",
        ),
        Compute(name: "gather", dispatch: Groups(1, 1, 1)),
        Copy(name: "keep", from: "items", to: "kept"),
        Copy(name: "keep_depth", from: "depth", to: "kept_depth"),
    ],
    outputs: [(name: "top", material: "image.mip[0]"), "kept", "kept_depth", "total"],
"#;

const DRAW: &str = "
    var<storage, read> scene_positions: array<vec4<f32>>;
    struct Camera { matrix: mat4x4<f32> }
    var<uniform> camera: Camera;
    @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
        return camera.matrix * scene_positions[index];
    }
    @fragment fn fragment() -> @location(0) vec4<f32> { return vec4(1.0); }";

const GATHER: &str = "
    struct Hit { place: vec2<f32>, id: u32, parts: array<i32, 2> }
    struct Item { hit: Hit, normal: vec3<f32> }
    var<storage, read_write> items: array<Item>;
    var<storage, read_write> total: u32;
    @compute @workgroup_size(1) fn main() { items[0].hit.id = 1u; total = 2u; }";

fn plan(captures: &[(&str, &str)]) -> Plan {
    let files = Files::graph(DOCUMENT)
        .with("draw.wgsl", DRAW)
        .with("gather.wgsl", GATHER);
    let mut request = PlanRequest::new([8, 8], &Triangle);
    let capture = |(material, after): &(&str, &str)| Capture::new(*material).with_after(*after);
    request.captures = captures.iter().map(capture).collect();
    right(right(load(&files)).plan(&request))
}

#[test]
fn what_stands_behind_a_content_is_found_through_copies() {
    let plan = plan(&[("depth", "draw"), ("items", "gather")]);
    let behind = |name| plan.provided_behind(name).into_iter().collect::<Vec<_>>();
    for drawn in ["top", "kept_depth", "depth@draw"] {
        assert_eq!(behind(drawn), ["camera", "scene.positions"], "{drawn}");
    }
    for other in ["kept", "items@gather", "total", "nothing"] {
        assert!(behind(other).is_empty(), "{other}");
    }
}

#[test]
fn items_are_those_of_the_shader_that_declares_them() {
    let plan = plan(&[("items", "gather"), ("scene.positions", "draw")]);
    let item = plan.item("kept").unwrap();
    let expected = [
        ("hit.place.x", 0, ItemScalar::F32),
        ("hit.place.y", 4, ItemScalar::F32),
        ("hit.id", 8, ItemScalar::U32),
        ("hit.parts[0]", 12, ItemScalar::I32),
        ("hit.parts[1]", 16, ItemScalar::I32),
        ("normal.x", 32, ItemScalar::F32),
        ("normal.y", 36, ItemScalar::F32),
        ("normal.z", 40, ItemScalar::F32),
    ];
    let expected = expected.map(|(name, offset, scalar)| Field {
        name: name.to_owned(),
        offset,
        scalar,
    });
    assert_eq!((item.stride, &item.fields[..]), (48, &expected[..]));
    assert_eq!(plan.item("items@gather"), Some(item));
    let total = plan.item("total").unwrap();
    assert_eq!((total.stride, total.fields[0].name.as_str()), (4, ""));
    assert_eq!(plan.item("scene.positions@draw").unwrap().stride, 16);
    assert_eq!(plan.item("top"), None, "a texture has no items");
}

#[test]
fn a_capture_says_which_part_it_holds() {
    let plan = plan(&[("image", "draw"), ("items", "gather"), ("depth", "draw")]);
    let part = |name: &str| plan.part(name).unwrap();
    // The first of two mips was written.
    let of_image = part("image@draw");
    assert_eq!((of_image.mips.clone(), of_image.of), (0..1, [2, 1]));
    assert!(of_image.is_less());
    assert_eq!(part("top"), of_image);
    for whole in ["items@gather", "depth@draw", "kept", "total"] {
        assert!(!part(whole).is_less(), "{whole}");
    }
    assert_eq!(part("kept").layers, 0..5);
    assert_eq!(plan.part("nothing"), None);
    let outputs = plan.outputs();
    let image = outputs.iter().find(|output| output.name == "image@draw");
    assert_eq!(image.map(|image| image.size), Some([8, 8]));
}

#[test]
fn memory_is_listed_by_material_and_adds_up() {
    let plan = plan(&[]);
    let entry = |name: &str| {
        let has_name = |entry: &MemoryEntry| entry.name == name;
        plan.memory()
            .into_iter()
            .find(has_name)
            .unwrap_or_else(|| panic!("no `{name}`"))
    };
    let image = entry("image");
    assert_eq!((image.size, image.mips, image.layers), ([8, 8], 2, 1));
    assert_eq!(image.format, Some(wgt::TextureFormat::Rgba16Float));
    assert_eq!(image.bytes, (8 * 8 + 4 * 4) * 8);
    let items = entry("items");
    assert_eq!(
        (items.format, items.size, items.bytes),
        (None, [240, 1], 240)
    );
    let memory = plan.memory();
    assert!(
        memory.iter().all(|entry| !entry.name.starts_with("scene")),
        "what is provided is not the graph's own"
    );
    assert_eq!(
        memory.iter().map(|entry| entry.bytes).sum::<u64>(),
        plan.memory_bytes()
    );
}
