//! Words of charts and graphs about every kind of material, and parts of them.

use crate::support::{Files, Triangle, load, right};
use skiagraph_draw::{Drawing, Origin, from_plan, to_dot, to_svg};
use skiagraph_graph::{Capture, Import, PlanRequest};
use std::collections::BTreeSet;

const DOCUMENT: &str = r#"
    inputs: [Texture(name: "tint", format: Rgba8Unorm)],
    materials: [
        Texture(name: "fog", format: Rgba16Float, size: (16, 8, 4), mips: 2),
        Texture(name: "fine", format: Rgba8Unorm, samples: 4),
        Texture(name: "image", format: Rgba8Unorm),
        Texture(name: "noise", format: R8Unorm, file: "noise.png"),
        Texture(name: "volumes", format: Depth24PlusStencil8),
        Texture(name: "maps", format: R8Unorm, layers: 3),
        Buffer(name: "kernel", data: [0.25, 0.5, 0.25]),
        Buffer(name: "rays", count: 2),
    ],
    passes: [
        Compute(name: "aim", dispatch: Over("rays.count"), bind: {"light": "lights[1]"}),
        Group(name: "sample", repeat: 2, bind: {"ray": "rays[index]"}, passes: [
            Compute(name: "fill", dispatch: Over("fog.size"), bind: {"fog": "fog.mip[index]"}),
        ]),
        Fullscreen(name: "map", repeat: 3, color: ["maps[index]"]),
        Raster(name: "mark", draw: 3, depth: "volumes",
            stencil: (target: "volumes", load: Clear(0), front: (pass: IncrementWrap))),
        Fullscreen(name: "blend", color: [(target: "fine", resolve: "image")],
            bind: {"fog": "fog.mip[0]", "map": "maps[1..3]", "stencil": "volumes"}),
    ],
    outputs: ["image"],
"#;

const AIM: &str = "
struct Slot { @size(256) value: vec4<f32> }
struct Frame { index: u32, seconds: f32 }
var<uniform> light: Slot;
var<uniform> frame: Frame;
var<storage, read_write> rays: array<Slot>;
@compute @workgroup_size(1) fn main() { rays[0].value = light.value * frame.seconds; }
";

const FILL: &str = "
struct Slot { @size(256) value: vec4<f32> }
var fog: texture_storage_3d<rgba16float, write>;
var<storage, read> ray: Slot;
@compute @workgroup_size(1) fn main(@builtin(global_invocation_id) texel: vec3<u32>) {
    textureStore(fog, texel, ray.value);
}
";

const MAP: &str = "@fragment fn fragment() -> @location(0) vec4<f32> { return vec4(1.0); }";

const MARK: &str = "
var<uniform> camera: array<vec4<f32>, 4>;
var<uniform> camera_previous: array<vec4<f32>, 4>;
@vertex fn vertex() -> @builtin(position) vec4<f32> { return camera[0] + camera_previous[0]; }
";

const BLEND: &str = "
var fog: texture_3d<f32>;
var map: texture_2d_array<f32>;
var stencil: texture_2d<u32>;
var noise: texture_2d<f32>;
var tint: texture_2d<f32>;
var image_previous: texture_2d<f32>;
var<storage, read> kernel: array<f32>;
@fragment fn fragment() -> @location(0) vec4<f32> {
    let at = vec2(0);
    let old = textureLoad(image_previous, at, 0) * kernel[1] + textureLoad(tint, at, 0);
    let now = textureLoad(fog, vec3(0), 0) + textureLoad(noise, at, 0);
    return old + now * textureLoad(map, at, 0, 0) * f32(textureLoad(stencil, at, 0).x);
}
";

/// ```text
/// lights[1], frame ─▶ aim ─▶ rays[0] ─▶ sample[0].fill ─▶ fog.mip[0] ─▶ blend ─▶ [image]
///                      └───▶ rays[1] ─▶ sample[1].fill ─▶ fog.mip[1] ─▶ (captured)
/// ```
/// `blend` reads whatever else there is.
fn drawing() -> Drawing {
    let files = Files::graph(DOCUMENT)
        .picture("noise.png", 2, &[0, 1, 2, 3])
        .with("aim.wgsl", AIM)
        .with("fill.wgsl", FILL)
        .with("map.wgsl", MAP)
        .with("mark.wgsl", MARK)
        .with("blend.wgsl", BLEND);
    let mut request = PlanRequest::new([64, 32], &Triangle);
    let usage = wgt::TextureUsages::TEXTURE_BINDING;
    let tint = Import::plain_texture(wgt::TextureFormat::Rgba8Unorm, [64, 32], usage);
    request.imports.insert("tint".to_owned(), tint);
    request.captures = vec![Capture::new("fog.mip[1]").with_after("sample[1].fill")];
    from_plan(&right(right(load(&files)).plan(&request)))
}

/// The hover titles of a chart.
fn titles(drawing: &Drawing) -> BTreeSet<String> {
    let svg = to_svg(drawing);
    let document = roxmltree::Document::parse(&svg).unwrap_or_else(|error| panic!("{error}"));
    let titles = document
        .descendants()
        .filter(|node| node.has_tag_name("title"));
    titles
        .filter_map(|node| Some(node.text()?.to_owned()))
        .collect()
}

#[track_caller]
fn tells(drawing: &Drawing, expected: &[&str]) {
    let titles = titles(drawing);
    for title in expected {
        assert!(titles.contains(*title), "no {title:?} in {titles:#?}");
    }
}

#[test]
fn a_material_is_told_by_all_that_makes_it_what_it_is() {
    let expected = [
        "fog: Rgba16Float 16×8 × 4 slices, 2 mips, 4.5 KiB; used from sample[0].fill to blend; \
         shares no memory: may be written in part",
        "fine: Rgba8Unorm 64×32, 4 samples, 32.0 KiB; used by blend; \
         shares no memory: overlaps all others",
        "image: Rgba8Unorm 64×32, 2 versions, 16.0 KiB; used by blend; \
         shares no memory: outlives the frame",
        "image.previous: Rgba8Unorm 64×32, of the frame before; used by blend",
        "maps: R8Unorm 64×32 × 3 layers, 6.0 KiB; used from map[1] to blend; \
         shares no memory: may be written in part",
        "noise: R8Unorm 2×2, constant, 4 B; used by blend; \
         shares no memory: outlives the frame",
        "kernel: buffer, constant, 12 B; used by blend; \
         shares no memory: outlives the frame",
        "tint: Rgba8Unorm 64×32, imported; used by blend",
        "frame: buffer, the frame's number and time; used by aim",
        "camera: buffer, provided; used by mark",
        "camera.previous: buffer, of the frame before; used by mark",
    ];
    tells(&drawing(), &expected);
}

/// Each mip of `fog`, each item of `rays` and each layer of `maps` is a part of its own, and so are
/// the depth and the stencil of `volumes`.
#[test]
fn a_mark_tells_which_part_of_a_material_is_used() {
    let expected = [
        "aim reads (item 1) lights",
        "aim writes rays",
        "sample[1].fill reads (item 1) rays",
        "sample[1].fill writes (mip 1) fog",
        "fog.mip[1]@sample[1].fill reads (mip 1) fog",
        "mark writes (depth), writes (stencil) volumes",
        "blend reads (stencil) volumes",
        "blend reads (layers 1–2) maps",
    ];
    tells(&drawing(), &expected);
}

/// Bars of what is there before the frame begin above the first row.
#[test]
fn what_is_there_before_the_frame_is_so_from_its_beginning() {
    let drawing = drawing();
    let origins = |wanted: fn(Origin) -> bool| -> BTreeSet<&str> {
        let materials = drawing.materials.iter();
        let materials = materials.filter(|material| wanted(material.origin));
        materials.map(|material| &*material.name).collect()
    };
    let constant = origins(|origin| origin == Origin::Constant);
    assert_eq!(constant, ["kernel", "noise"].into());
    assert_eq!(origins(|origin| origin == Origin::Frame), ["frame"].into());
    let previous = origins(|origin| origin == Origin::Previous);
    assert_eq!(previous, ["camera.previous", "image.previous"].into());
    let svg = to_svg(&drawing);
    let document = roxmltree::Document::parse(&svg).unwrap_or_else(|error| panic!("{error}"));
    let grey = document
        .descendants()
        .filter(|node| node.attribute("fill") == Some("#999999"));
    let bars = grey.filter_map(|node| {
        let title = node.prev_sibling_element()?;
        let title = title.has_tag_name("title").then(|| title.text())??;
        Some((title.split(':').next()?, node.attribute("y")?))
    });
    let (names, tops): (BTreeSet<&str>, BTreeSet<&str>) = bars.unzip();
    assert_eq!(names, origins(Origin::is_given));
    assert_eq!(tops.len(), 1, "{tops:?}");
}

/// Materials that the graph does not make take none of its memory, and constants do.
#[test]
fn the_bytes_of_all_materials_are_those_of_the_plan() {
    let drawing = drawing();
    let live = drawing
        .materials
        .iter()
        .filter(|material| material.lifetime.is_some());
    let bytes: u64 = live.filter_map(|material| material.bytes).sum();
    assert_eq!(bytes, drawing.memory_bytes + drawing.saved_bytes);
}

/// The prefix of groups and includes is grey; neither a capture nor a material of the frame before
/// has one.
#[test]
fn a_name_is_told_from_what_stands_before_it() {
    let svg = to_svg(&drawing());
    let document = roxmltree::Document::parse(&svg).unwrap_or_else(|error| panic!("{error}"));
    let grey = document
        .descendants()
        .filter(|node| node.has_tag_name("tspan"));
    let names = grey.map(|node| {
        let own = node.next_sibling().and_then(|name| name.text());
        [node.text(), own].map(Option::unwrap_or_default)
    });
    let expected = [["sample[0].", "fill"], ["sample[1].", "fill"]];
    assert_eq!(names.collect::<Vec<_>>(), expected);
}

/// ```text
/// sample[0] { eye { draw ─▶ image } }   sample[1] { eye { draw ─▶ image } }
/// ```
/// The copy that a capture makes stands in none of them.
#[test]
fn clusters_follow_groups_and_includes() {
    let eye = r#"
    materials: [Texture(name: "image", format: R8Unorm)],
    passes: [Fullscreen(name: "draw", shader: "map", color: ["image"])],
    outputs: ["image"],
"#;
    let document = r#"
    passes: [
        Group(name: "sample", repeat: 2, passes: [Include(graph: "eye.ron", name: "eye")]),
    ],
    outputs: [(name: "left", material: "sample[0].eye.image")],
"#;
    let files = Files::graph(document)
        .document("eye.ron", eye)
        .with("map.wgsl", MAP);
    let mut request = PlanRequest::new([8, 8], &Triangle);
    request.captures = vec![Capture::new("sample[1].eye.image").with_after("sample[1].eye.draw")];
    let drawing = from_plan(&right(right(load(&files)).plan(&request)));
    let dot = to_dot(&drawing);
    let mut clusters: Vec<&str> = Vec::new();
    let mut nodes = BTreeSet::new();
    for line in dot.lines().skip(1).map(str::trim) {
        match line.split('"').collect::<Vec<_>>()[..] {
            ["subgraph ", cluster, ..] => clusters.push(cluster),
            ["", node, attributes, ..] if attributes.starts_with(" [shape") => {
                nodes.insert((clusters.last().copied().unwrap_or_default(), node));
            }
            ["}"] => drop(clusters.pop()),
            _ => {}
        }
    }
    let copy = "sample[1].eye.image@sample[1].eye.draw";
    let expected = [
        ("", format!("pass {copy}")),
        ("", format!("material {copy}")),
        (
            "cluster_sample[0].eye.",
            "pass sample[0].eye.draw".to_owned(),
        ),
        (
            "cluster_sample[0].eye.",
            "material sample[0].eye.image".to_owned(),
        ),
        (
            "cluster_sample[1].eye.",
            "pass sample[1].eye.draw".to_owned(),
        ),
        (
            "cluster_sample[1].eye.",
            "material sample[1].eye.image".to_owned(),
        ),
    ];
    let expected = expected
        .iter()
        .map(|(cluster, node)| (*cluster, node.as_str()));
    assert_eq!(nodes, expected.collect());
}
