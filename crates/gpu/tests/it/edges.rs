//! What an author meets in the first week: each feature by itself on the device, to the bit.

use crate::featured::{Running, buffer_floats};
use crate::support::Files;
use skiagraph_graph::ParamValue;

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
