//! Materials between a graph's begin and its outputs, as files.

use crate::support::{gpu, mesh, park, sources};
use glam::DVec3;
use skiagraph_compare::{
    error::CompareError,
    graphs::{method::load_one, planning::Capabilities},
    measuring::frame,
    pictures::{
        colours::ClipPlanes,
        save::{Decoding, Save, captures, check_encodings, write},
    },
    sink::{Session, Silent},
};
use skiagraph_gpu::block_on;
use skiagraph_passes::SceneProvider;
use skiagraph_scene::{DirectionalLight, Scene, View};
use std::{collections::BTreeSet, fs, path::Path, sync::Arc};

/// Two mips of two layers, each of another grey; odd values; a buffer of items.
const GRAPH: &str = r#"(
    format: 3,
    materials: [
        Texture(name: "stack", format: R32Float, size: 8, mips: 2, layers: 2),
        Texture(name: "odd", format: Rg32Float),
        Buffer(name: "pairs", count: 3),
    ],
    passes: [
        Clear(name: "all", target: "stack"),
        Clear(name: "first", target: "stack[0].mip[0]", value: 1.5),
        Clear(name: "small", target: "stack[1].mip[1]", value: 2.5),
        Clear(name: "again", target: "stack[0].mip[0]", value: 3.5),
        Fullscreen(name: "odd", color: ["odd"]),
        Compute(name: "pairs", dispatch: Groups(1, 1, 1)),
    ],
    outputs: [
        (name: "first", material: "stack[0].mip[0]"),
        (name: "small", material: "stack[1].mip[1]"),
        "stack",
        "odd",
        "pairs",
    ],
)"#;

const ODD: &str = "
    @fragment fn fragment(@builtin(position) place: vec4<f32>) -> @location(0) vec2<f32> {
        // not known to the compiler, which may refuse constants that are no numbers
        let zero = u32(place.x) / 1000u;
        if place.x < 1.0 { return vec2(0.0, bitcast<f32>(0x7fc00000u + zero)); }
        if place.x < 2.0 { return vec2(bitcast<f32>(0x7f800000u + zero), 1.0); }
        return vec2(place.x, 2.0);
    }";

const PAIRS: &str = "
    struct Pair { id: u32, height: f32 }
    var<storage, read_write> pairs: array<Pair>;
    @compute @workgroup_size(1) fn main() {
        for (var i = 0u; i < 3u; i++) { pairs[i] = Pair(7u * i, f32(i) * 0.5); }
    }";

/// Layers and mips written one by one, out of order.
const STEPWISE: &str = r#"(
    format: 3,
    materials: [
        Texture(name: "stack", format: R32Float, size: 8, mips: 2, layers: 2),
        Texture(name: "other", format: R32Float, size: 8),
    ],
    passes: [
        Clear(name: "one", target: "stack[1].mip[0]", value: 1.5),
        Clear(name: "two", target: "stack[0].mip[0]", value: 2.5),
        Clear(name: "small", target: "stack[1].mip[1]", value: 3.5),
        Clear(name: "aside", target: "other"),
        Clear(name: "rest", target: "stack[0].mip[1]", value: 4.5),
    ],
    outputs: ["stack", "other"],
)"#;

/// Saves materials of one frame of a method on the first view of a scene, each as `run --save` has
/// it; returns what is said of the files.
fn saved_of(
    scene: Arc<Scene>,
    folder: &Path,
    (method, viewport): (&str, [u32; 2]),
    saves: &[&str],
) -> Result<String, CompareError> {
    let in_folder = |save: &&str| {
        let save: Save = save.parse().unwrap();
        let file = folder.join(&save.file);
        Save { file, ..save }
    };
    let saves: Vec<Save> = saves.iter().map(in_folder).collect();
    let view = scene.views[0].clone();
    let mut provider = SceneProvider::new(scene);
    provider.set_view(&view, viewport);
    let (preset, params) = load_one(method, &[], None, &sources(folder))?;
    let mut request = Capabilities::new(gpu()).request(viewport, &provider);
    request.params = params;
    request.captures = captures(&preset.graph.outputs(), &saves);
    let plan = preset.plan(&request, &Silent)?;
    check_encodings(&plan, &saves)?;
    let decodings = saves.iter().map(|save| {
        let name = save.capture.name();
        (
            save,
            Decoding::new(&plan, &name, ClipPlanes::new(&view)),
            name,
        )
    });
    let decodings: Vec<_> = decodings.collect();
    let names: BTreeSet<&str> = decodings.iter().map(|(.., name)| name.as_str()).collect();
    let names: Vec<&str> = names.into_iter().collect();
    let session = Session::new(gpu(), &Silent);
    let (contents, _) = block_on(frame::render(session, plan, &mut provider, &names)).unwrap();
    let write =
        |(save, decoding, name): &(&Save, Decoding, String)| write(save, &contents[name], decoding);
    decodings.iter().map(write).collect()
}

/// The same on `park`, with the documents of this file in the folder.
fn saved(folder: &Path, method: (&str, [u32; 2]), saves: &[&str]) -> Result<String, CompareError> {
    for (name, text) in [
        ("graph.ron", GRAPH),
        ("odd.wgsl", ODD),
        ("pairs.wgsl", PAIRS),
        ("stepwise.ron", STEPWISE),
    ] {
        fs::write(folder.join(name), text).unwrap();
    }
    saved_of(park(), folder, method, saves)
}

/// Numbers in a file.
fn floats(folder: &Path, name: &str) -> Vec<f32> {
    let bytes = fs::read(folder.join(name)).unwrap();
    let words = bytes.chunks_exact(4);
    words
        .map(|it| f32::from_le_bytes(it.try_into().unwrap()))
        .collect()
}

fn png(folder: &Path, name: &str) -> image::RgbImage {
    image::open(folder.join(name)).unwrap().to_rgb8()
}

const GRAPH_RON: (&str, [u32; 2]) = ("graph.ron", [4, 2]);

#[test]
fn layers_and_mips_are_saved_by_themselves_and_together_at_any_pass() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let saves = [
        "stack[0].mip[0]@first=before.bin",
        "first=after.bin",
        "small=small.png",
        "stack=all.bin",
        "stack=all.png",
    ];
    let text = saved(folder, GRAPH_RON, &saves).unwrap();
    assert_eq!(floats(folder, "before.bin"), [1.5; 64]);
    assert_eq!(floats(folder, "after.bin"), [3.5; 64]);
    let small = "small.png: 4x4, mip 1 of 2, layer 1 of 2, 2.5 … 2.5";
    assert!(text.contains(small), "{text}");
    let texels = [&[3.5; 64][..], &[0.0; 64], &[0.0; 16], &[2.5; 16]].concat();
    assert_eq!(floats(folder, "all.bin"), texels);
    let sheet = "all.png: 8x24, 4 mips and layers one below the other, 0 … 3.5";
    assert!(text.contains(sheet), "{text}");
}

#[test]
fn odd_values_are_marked_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    let text = saved(folder.path(), GRAPH_RON, &["odd=odd.png"]).unwrap();
    let legend = "red 0 … 3.5, green 1 … 2, magenta NaN (2), orange +∞ (2)";
    assert!(text.contains(legend), "{text}");
    let picture = png(folder.path(), "odd.png");
    assert_eq!(picture.get_pixel(0, 1).0, [255, 0, 255]);
    assert_eq!(picture.get_pixel(1, 0).0, [255, 128, 0]);
    assert_eq!(picture.get_pixel(3, 0).0, [255, 255, 0]);
}

#[test]
fn buffers_become_tables_of_their_items() {
    let folder = tempfile::tempdir().unwrap();
    saved(folder.path(), GRAPH_RON, &["pairs=pairs.csv"]).unwrap();
    let table = fs::read_to_string(folder.path().join("pairs.csv")).unwrap();
    assert_eq!(table, "item,id,height\n0,0,0\n1,7,0.5\n2,14,1\n");
    let text = refused(folder.path(), GRAPH_RON, "odd=odd.csv");
    assert!(text.contains("is a texture and has no items"), "{text}");
}

/// Why a material is not saved.
fn refused(folder: &Path, method: (&str, [u32; 2]), save: &str) -> String {
    saved(folder, method, &[save]).unwrap_err().to_string()
}

#[test]
fn a_buffer_has_no_picture_but_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let rt = ("rt", [8, 8]);
    let text = refused(folder.path(), rt, "ray_count=count.png");
    assert!(text.contains("save it as .csv or .bin"), "{text}");
    saved(folder.path(), rt, &["ray_count=count.bin"]).unwrap();
    let count = fs::read(folder.path().join("count.bin")).unwrap();
    let count = u32::from_le_bytes(count.try_into().unwrap());
    assert!(count > 0 && count <= 64, "{count} rays for 64 pixels");
}

#[test]
fn a_cameras_depths_are_distances_and_a_lights_are_not() {
    let folder = tempfile::tempdir().unwrap();
    let saves = ["depth=d.png", "shadow_map@create_shadow_map.draw[0]=m.png"];
    let text = saved(folder.path(), ("nsm@map_size=32", [32, 32]), &saves).unwrap();
    assert!(
        text.contains("d.png: 32x32, distance along the view, black to white "),
        "{text}"
    );
    assert!(
        text.contains("m.png: 32x32, stored depth, black to white 0."),
        "{text}"
    );
    assert!(text.contains("grey 1, nothing there ("), "{text}");
}

#[test]
fn what_cannot_be_saved_says_why_and_what_else_there_is() {
    let folder = tempfile::tempdir().unwrap();
    for (save, part) in [
        ("frist=x.png", "did you mean `first`?"),
        ("odd@od=x.png", "did you mean `odd`?"),
        ("od@odd=x.png", "did you mean `odd`?"),
        ("odd@first=x.png", "first written by `odd`"),
        ("camera=x.bin", "`camera@PASS`"),
    ] {
        let text = refused(folder.path(), GRAPH_RON, save);
        assert!(text.contains(part), "{save}: {text}");
    }
}

#[test]
fn what_is_saved_after_a_pass_is_what_has_been_written_by_then() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let stepwise = ("stepwise.ron", [4, 2]);
    let (small, large) = ([0.0f32; 16], [0.0f32; 64]);
    let filled = |values: &[(&[f32], f32)]| -> Vec<f32> {
        let parts = values.iter();
        parts
            .flat_map(|(part, value)| part.iter().map(move |_| *value))
            .collect()
    };
    for (pass, expected, part) in [
        (
            "one",
            filled(&[(&large, 1.5)]),
            "mip 0 of 2, layer 1 of 2, ",
        ),
        (
            "two",
            filled(&[(&large, 2.5), (&large, 1.5)]),
            "mip 0 of 2, layers 0 to 1 of 2, ",
        ),
        // The four are not whole: what the pass itself has written.
        (
            "small",
            filled(&[(&small, 3.5)]),
            "mip 1 of 2, layer 1 of 2, ",
        ),
        (
            "rest",
            filled(&[(&large, 2.5), (&large, 1.5), (&small, 4.5), (&small, 3.5)]),
            "",
        ),
    ] {
        let text = saved(folder, stepwise, &[&format!("stack@{pass}=part.bin")]).unwrap();
        assert_eq!(floats(folder, "part.bin"), expected, "{pass}");
        match part {
            "" => assert!(!text.contains(" of 2"), "{text}"),
            part => assert!(text.contains(part), "{pass}: {text}"),
        }
    }
    let text = refused(folder, stepwise, "stack@aside=x.png");
    assert!(
        text.contains("something has written some of it, but not all")
            && text.contains("name a mip or layer")
            && text.contains("`rest` writes others"),
        "{text}"
    );
}

#[test]
fn the_maps_of_a_layered_group_are_saved_as_they_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let pssm = ("pssm@map_size=64", [64, 64]);
    for (layer, part) in [(0, "layer 0 of 4, "), (1, "layers 0 to 1 of 4, ")] {
        let save = format!("shadow_maps@create_shadow_map.draw[{layer}]=x.png");
        let text = saved(folder.path(), pssm, &[&save]).unwrap();
        assert!(
            text.contains(part) && text.contains("stored depth"),
            "{text}"
        );
        let picture = png(folder.path(), "x.png");
        assert_eq!(picture.height(), (layer + 1) * picture.width());
    }
}

#[test]
fn a_mesh_of_ones_own_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    // A floor at y = 0 and a lid over its middle at y = 1, seen from above and lit from above.
    let quad = |y: f32, half: f32| {
        format!(
            "v {0} {y} {0}\nv {1} {y} {0}\nv {1} {y} {1}\nv {0} {y} {1}\n",
            -half, half
        )
    };
    let text = format!("{}{}f 4 3 2 1\nf 8 7 6 5\n", quad(0.0, 2.0), quad(1.0, 0.5));
    let view = View {
        name: "above".into(),
        eye: DVec3::new(-3.0, 5.0, 0.0),
        direction: DVec3::new(3.0, -5.0, 0.0),
        far: 100.0,
        ..View::default()
    };
    let light = DirectionalLight::new(DVec3::NEG_Y);
    let scene = mesh(folder.path(), &text, view, light);
    let saves = ["visibility=v.png", "status=s.png"];
    saved_of(scene, folder.path(), ("rt", [64, 64]), &saves).unwrap();
    let picture = png(folder.path(), "s.png");
    let statuses: BTreeSet<_> = picture.pixels().map(|pixel| pixel.0).collect();
    assert!(statuses.len() > 1, "floor and background: {statuses:?}");
    let visibility = png(folder.path(), "v.png");
    let lit = visibility.pixels().filter(|pixel| pixel.0 == [255; 3]);
    let lit = lit.count();
    assert!(lit > 100 && lit < 64 * 64, "{lit} lit pixels");
}
