//! Documents of buffers of one number and compute passes of one invocation.

#![allow(dead_code, reason = "each test file uses a part of it")]

use crate::support::Files;

/// Input of an `OnChange` pass, bound as `input`.
pub const INPUT: &str = "var<storage, read> input: array<u32>;";
/// Input from the frame before, bound as `old`.
pub const OLD: &str = "var<storage, read> old: array<u32>;";
/// Output of a pass, bound as `out`.
pub const OUT: &str = "var<storage, read_write> out: array<u32>;";
/// The param `seed` in a shader, and in a document.
pub const SEED: &str = "struct Params { seed: u32 } var<uniform> params: Params;";
pub const SEED_PARAM: &str = "U32(name: \"seed\", default: 5),";

/// A compute shader of one invocation.
pub fn shader(globals: &str, body: &str) -> String {
    format!("{globals} @compute @workgroup_size(1) fn main() {{ {body} }}")
}

/// A compute shader that writes `value` to `out`.
pub fn writes(globals: &str, value: &str) -> String {
    shader(&format!("{globals} {OUT}"), &format!("out[0] = {value};"))
}

/// A pass of one invocation; `more` and `bind` as they stand in the document.
pub fn compute(name: &str, more: &str, bind: &str) -> String {
    format!(
        "        Compute(name: \"{name}\", dispatch: Groups(1, 1, 1), {more} bind: {{{bind}}}),\n"
    )
}

/// A document of params, buffers of one number, passes and outputs.
pub fn document(params: &str, buffers: &[&str], passes: &[String], outputs: &[&str]) -> Files {
    let buffers: String = buffers
        .iter()
        .map(|name| format!("Buffer(name: \"{name}\", count: 1), "))
        .collect();
    Files::graph(&format!(
        "\n    params: [{params}],\n    materials: [{buffers}],\n    passes: [\n{}    ],\n    \
         outputs: {outputs:?},\n",
        passes.concat(),
    ))
}
