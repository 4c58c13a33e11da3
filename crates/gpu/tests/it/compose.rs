//! Documents made of documents, on the device. (Their names and sizes:
//! `crates/graph/tests/it/compose.rs`.)

use crate::support::Files;
use crate::tiny::{f32s, run};

/// Writes `value`, a param, into a texture of `edge`² texels; `smooth` reads the `image` of its
/// document.
const INNER: &str = r#"
    params: [F32(name: "value", default: 1), U32(name: "edge", default: 4)],
    materials: [
        Texture(name: "image", format: R32Float, size: "edge"),
        Texture(name: "result", format: R32Float, size: "image.size"),
    ],
    passes: [
        Fullscreen(name: "fill", color: ["image"]),
        Fullscreen(name: "smooth", color: ["result"]),
    ],
    outputs: ["result", "image"],
"#;

const FILL: &str = "struct Params { value: f32 } var<uniform> params: Params;
    @fragment fn fragment() -> @location(0) f32 { return params.value; }";

const SMOOTH: &str = "var image: texture_2d<f32>;
    @fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) f32 {
        return textureLoad(image, vec2<u32>(at.xy), 0).x;
    }";

const NUMBER: &str = "override index: u32;
    @fragment fn fragment() -> @location(0) f32 { return 10.0 + f32(index); }";

fn files(sections: &str) -> Files {
    Files::graph(sections)
        .document("inner.ron", INNER)
        .with("fill.wgsl", FILL)
        .with("smooth.wgsl", SMOOTH)
        .with("number.wgsl", NUMBER)
}

#[test]
fn one_document_twice() {
    let files = files(
        r#"
    params: [F32(name: "value", default: 7)],
    passes: [
        Include(graph: "inner.ron", name: "left", set: {"value": "value"}),
        Include(graph: "inner.ron", name: "right", set: {"value": 3.5, "edge": 2}),
    ],
    outputs: [
        (name: "left", material: "left.result"),
        (name: "right", material: "right.result"),
        (name: "source", material: "left.image"),
    ],
"#,
    );
    let contents = run(&files, &["left", "right", "source"]);
    assert_eq!(f32s(&contents[0]), [7.0; 16]);
    assert_eq!(f32s(&contents[1]), [3.5; 4]);
    assert_eq!(f32s(&contents[2]), [7.0; 16]);
}

/// The middle document passes on what the inner one gives; the outermost says where it is written.
#[test]
fn an_output_is_written_where_the_outermost_document_says() {
    let middle = r#"
    passes: [Include(graph: "inner.ron"), Include(graph: "inner.ron", name: "b")],
    outputs: ["image", (name: "b", material: "b.result")],
"#;
    let outer = r#"
    params: [F32(name: "value", default: 7)],
    materials: [
        Texture(name: "maps", format: R32Float, size: 2, layers: 2),
        Texture(name: "other", format: R32Float, size: 3),
    ],
    passes: [
        Clear(name: "reset", target: "maps", value: 5),
        Include(graph: "middle.ron", bind: {"image": "maps[1]", "b": "other"}),
    ],
    outputs: ["maps", "other"],
"#;
    let files = files(outer).document("middle.ron", middle);
    let contents = run(&files, &["maps", "other"]);
    let maps = [[5.0; 4], [1.0; 4]].concat();
    assert_eq!(f32s(&contents[0]), maps);
    assert_eq!(f32s(&contents[1]), [1.0; 9]);
}

#[test]
fn layers_of_an_array() {
    let files = files(
        r#"
    materials: [Texture(name: "maps", format: R32Float, size: 2, layers: 3)],
    passes: [Fullscreen(name: "number", color: ["maps[index]"], repeat: 3)],
    outputs: [
        (name: "first", material: "maps[0]"),
        (name: "middle", material: "maps[1]"),
        (name: "last", material: "maps[2]"),
    ],
"#,
    );
    let contents = run(&files, &["first", "middle", "last"]);
    for (content, value) in contents.iter().zip([10.0, 11.0, 12.0]) {
        assert_eq!(f32s(content), [value; 4]);
    }
}
