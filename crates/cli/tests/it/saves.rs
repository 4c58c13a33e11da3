//! `run --save` for what lies between a graph's begin and its outputs. Needs an adapter.

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

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

fn run(folder: &Path, arguments: &[&str]) -> Output {
    for (name, text) in [
        ("graph.ron", GRAPH),
        ("odd.wgsl", ODD),
        ("pairs.wgsl", PAIRS),
    ] {
        fs::write(folder.join(name), text).unwrap();
    }
    Command::new(env!("CARGO_BIN_EXE_skiagraph"))
        .args(["run"])
        .args(arguments)
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .output()
        .expect("the program was built for this test")
}

#[track_caller]
fn saved(folder: &Path, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[track_caller]
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    assert_eq!(output.status.code(), Some(1));
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn layers_and_mips_are_saved_by_themselves_and_together_at_any_pass() {
    let folder = tempfile::tempdir().unwrap();
    let line = "graph.ron --size 4x2 --save stack[0].mip[0]@first=before.bin --save \
        first=after.bin --save small=small.png --save stack=all.bin --save stack=all.png";
    let text = saved(folder.path(), &line.split(' ').collect::<Vec<_>>());
    let floats = |name: &str| -> Vec<f32> {
        let bytes = fs::read(folder.path().join(name)).unwrap();
        bytes
            .chunks_exact(4)
            .map(|b| f32::from_le_bytes(b.try_into().unwrap()))
            .collect()
    };
    assert_eq!(floats("before.bin"), [1.5; 64]);
    assert_eq!(floats("after.bin"), [3.5; 64]);
    let small = "small.png: 4x4, mip 1 of 2, layer 1 of 2, 2.5 … 2.5";
    assert!(text.contains(small), "{text}");
    let all = [&[3.5; 64][..], &[0.0; 64], &[0.0; 16], &[2.5; 16]].concat();
    assert_eq!(floats("all.bin"), all);
    let sheet = "all.png: 8x24, 4 mips and layers one below the other, 0 … 3.5";
    assert!(text.contains(sheet), "{text}");
}

#[test]
fn odd_values_are_marked_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    let text = saved(
        folder.path(),
        &["graph.ron", "--size", "4x2", "--save", "odd=odd.png"],
    );
    let legend = "red 0 … 3.5, green 1 … 2, magenta NaN (2), orange +∞ (2)";
    assert!(text.contains(legend), "{text}");
    let picture = image::open(folder.path().join("odd.png"))
        .unwrap()
        .to_rgb8();
    assert_eq!(picture.get_pixel(0, 1).0, [255, 0, 255]);
    assert_eq!(picture.get_pixel(1, 0).0, [255, 128, 0]);
    assert_eq!(picture.get_pixel(3, 0).0, [255, 255, 0]);
}

#[test]
fn buffers_become_tables_of_their_items() {
    let folder = tempfile::tempdir().unwrap();
    saved(
        folder.path(),
        &["graph.ron", "--size", "4x2", "--save", "pairs=pairs.csv"],
    );
    let table = fs::read_to_string(folder.path().join("pairs.csv")).unwrap();
    assert_eq!(table, "item,id,height\n0,0,0\n1,7,0.5\n2,14,1\n");
    let text = refused(folder.path(), &["graph.ron", "--save", "odd=odd.csv"]);
    assert!(text.contains("is a texture and has no items"), "{text}");
}

#[test]
fn a_cameras_depths_are_distances_and_a_lights_are_not() {
    let folder = tempfile::tempdir().unwrap();
    let line = "nsm --size 32x32 --map-size 32 --save depth=d.png --save \
        shadow_map@create_shadow_map.draw[0]=m.png";
    let text = saved(folder.path(), &line.split(' ').collect::<Vec<_>>());
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
        let text = refused(
            folder.path(),
            &["graph.ron", "--size", "4x2", "--save", save],
        );
        assert!(text.contains(part), "{save}: {text}");
    }
}

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

#[test]
fn what_is_saved_after_a_pass_is_what_has_been_written_by_then() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("stepwise.ron"), STEPWISE).unwrap();
    let (small, large) = ([0.0f32; 16], [0.0f32; 64]);
    let of = |values: &[(&[f32], f32)]| -> Vec<f32> {
        let parts = values.iter();
        parts
            .flat_map(|(part, value)| part.iter().map(move |_| *value))
            .collect()
    };
    for (pass, expected, part) in [
        ("one", of(&[(&large, 1.5)]), "mip 0 of 2, layer 1 of 2, "),
        (
            "two",
            of(&[(&large, 2.5), (&large, 1.5)]),
            "mip 0 of 2, layers 0 to 1 of 2, ",
        ),
        // The four are not whole: what the pass itself has written.
        ("small", of(&[(&small, 3.5)]), "mip 1 of 2, layer 1 of 2, "),
        (
            "rest",
            of(&[(&large, 2.5), (&large, 1.5), (&small, 4.5), (&small, 3.5)]),
            "",
        ),
    ] {
        let save = format!("stack@{pass}=part.bin");
        let text = saved(folder, &["stepwise.ron", "--size", "4x2", "--save", &save]);
        let bytes = fs::read(folder.join("part.bin")).unwrap();
        let floats = bytes.chunks_exact(4);
        let floats = floats.map(|b| f32::from_le_bytes(b.try_into().unwrap()));
        assert_eq!(floats.collect::<Vec<f32>>(), expected, "{pass}");
        match part {
            "" => assert!(!text.contains(" of 2"), "{text}"),
            part => assert!(text.contains(part), "{pass}: {text}"),
        }
    }
    let text = refused(folder, &["stepwise.ron", "--save", "stack@aside=x.png"]);
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
    for (layer, part) in [(0, "layer 0 of 4, "), (1, "layers 0 to 1 of 4, ")] {
        let save = format!("shadow_maps@create_shadow_map.draw[{layer}]=x.png");
        let line = format!("pssm --scene park --size 64x64 --map-size 64 --save {save}");
        let arguments: Vec<&str> = line.split(' ').collect();
        let text = saved(folder.path(), &arguments);
        assert!(
            text.contains(part) && text.contains("stored depth"),
            "{text}"
        );
        let picture = image::open(folder.path().join("x.png")).unwrap();
        assert_eq!(picture.height(), (layer + 1) * picture.width());
    }
}
