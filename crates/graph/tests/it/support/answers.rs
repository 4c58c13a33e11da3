//! Common parts of the tests of hostile files: the messages about one, within bounds of time and
//! memory.

use crate::{
    bounds::bounded,
    support::{Files, Triangle},
};
use skiagraph_graph::{Diagnostics, Graph, PlanRequest, Registry};

/// A document that only runs a compute shader called `index`.
pub const COMPUTE: &str = r#"(format: 3, materials: [Buffer(name: "items", count: 4)],
    passes: [Compute(name: "index", dispatch: Over("items.count"))], outputs: ["items"])"#;

/// Checks `graph.ron` within the bounds; the longest of the files is the hostile one.
#[track_caller]
pub fn answer(files: &Files) -> Result<(), Diagnostics> {
    let request = PlanRequest::new([64, 48], &Triangle);
    let hostile = files.texts.values().max_by_key(|text| text.len());
    bounded(hostile.expect("there are files"), || {
        Graph::check("graph.ron", &Registry::standard(), files, &request).map(drop)
    })
}

/// Returns the messages about a shader: declarations, and the body of its function, which has an
/// array `items` of u32.
#[track_caller]
pub fn of_shader(declarations: &str, body: &str) -> String {
    let shader = format!(
        "var<storage, read_write> items: array<u32>;\n{declarations}\n\
         @compute @workgroup_size(1) fn main() {{ items[0] = 1u;\n{body}\n}}\n"
    );
    let files = Files::new([("graph.ron", COMPUTE), ("index.wgsl", &shader)]);
    answer(&files)
        .err()
        .map_or("nothing".to_owned(), |errors| errors.to_string())
}

/// Asserts that what is said stands at `place` and holds `parts`.
pub fn assert_said(text: &str, place: &str, parts: &[&str]) {
    for part in parts.iter().chain([&place]) {
        assert!(
            text.contains(part),
            "no {part:?} in\n{}",
            text.chars().take(2000).collect::<String>()
        );
    }
}
