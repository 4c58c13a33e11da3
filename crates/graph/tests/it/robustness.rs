//! Whatever stands in a file: an answer, never a panic.

use crate::everything::{DOCUMENT, files};
use crate::support::{Files, Triangle, load, right};
use proptest::prelude::*;
use skiagraph_graph::{Graph, PlanRequest, Registry};

/// How many texts there are.
const FILES: usize = 8;

/// Loads, plans and renders whatever is said; it only has to come back.
fn judge(files: &Files) -> Result<usize, String> {
    let graph = Graph::load("graph.ron", &Registry::standard(), files)
        .map_err(|errors| errors.to_string())?;
    let plan = graph
        .plan(&PlanRequest::new([33, 17], &Triangle))
        .map_err(|errors| errors.to_string())?;
    assert!(plan.memory_bytes() >= plan.saved_bytes());
    Ok(plan.passes().len() + plan.culled().len())
}

#[test]
fn the_document_is_right_as_it_stands() {
    assert_eq!(judge(&files()), Ok(12));
}

/// Cut off anywhere, in a character or not, it is wrong and says so.
#[test]
fn cut_off_anywhere() {
    for end in (0..DOCUMENT.trim_end().len()).filter(|&end| DOCUMENT.is_char_boundary(end)) {
        let text = judge(&files().with("graph.ron", &DOCUMENT[..end])).expect_err("it is cut off");
        assert!(!text.is_empty());
    }
}

/// Words that a file may hold in the place of any other.
const WORDS: &[&str] = &[
    "",
    "0",
    "-1",
    "4294967295",
    "4294967296",
    "18446744073709551616",
    "1e38",
    "1e39",
    "NaN",
    "inf",
    "-inf",
    "0.5",
    "\"",
    "\"image\"",
    "\"image[0]\"",
    "\"image[index]\"",
    "Include(graph: \"graph.ron\", name: \"a\")",
    "Group(name: \"g\", repeat: 2, passes: [])",
    "\"small\"",
    "\"total\"",
    "\"nearest\"",
    "\"scene.positions\"",
    "\"camera\"",
    "\"params\"",
    "\"ö\"",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    ",",
    ":",
    "()",
    "[]",
    "{}",
    "\"edge\"",
    "\"sun\"",
    "\"viewport.size\"",
    "\"image.count\"",
    "\"image.mip[0]\"",
    "\"image.mip[1..9]\"",
    "\"image.previous\"",
    "\"index\"",
    "\"ring.index\"",
    "\"has(SUBGROUP)\"",
    "\"1 / (edge - 16)\"",
    "\"twice ? 1 : sun\"",
    "\"CULL_BACK\"",
    "Change(pass: \"shade\")",
    "Remove(pass: \"shade\")",
    "extends: \"blur.ron\"",
    "Choice",
    "Load",
    "None",
    "Clear(1)",
    "true",
    "'x'",
    "r#\"raw\"#",
    "/*",
    "//",
    "#import \"graph.ron\"\n",
    "#import \"shared/scene.wgsl\"\n",
    "#import",
    "@group(4294967295)",
    "@binding(1000000)",
    "array<u32, 1000000000>",
    "texture_3d<f32>",
    "vec4<f32>",
    "ptr<function, u32>",
    "f16",
    "1u << 99u",
    "🙂",
    "\u{feff}",
    "\u{0}",
    "\r\n",
    "\\",
];

prop_compose! {
    /// A file, a place in it (as a share of its words), how many words go, and what comes
    /// instead.
    fn any_change()(
        file in 0..FILES,
        at in 0.0..1.0f64,
        gone in 0..4usize,
        word in 0..WORDS.len(),
    ) -> (usize, f64, usize, usize) {
        (file, at, gone, word)
    }
}

/// Replaces some words of a text: runs of letters and digits, or single characters.
fn change(text: &str, at: f64, gone: usize, word: &str) -> String {
    let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
    let mut borders = vec![0];
    let mut before = None;
    for (index, c) in text.char_indices() {
        if index > 0 && !(is_word(c) && before.is_some_and(is_word)) {
            borders.push(index);
        }
        before = Some(c);
    }
    borders.push(text.len());
    let first = ((borders.len() - 1) as f64 * at) as usize;
    let last = (first + gone).min(borders.len() - 1);
    format!(
        "{}{word}{}",
        &text[..borders[first]],
        &text[borders[last]..]
    )
}

/// The files with some words replaced.
fn changed(changes: Vec<(usize, f64, usize, usize)>) -> Files {
    let mut files = files();
    let names: Vec<String> = files.texts.keys().cloned().collect();
    for (file, at, gone, word) in changes {
        let name = &names[file];
        let text = change(&files.texts[name], at, gone, WORDS[word]);
        files.texts.insert(name.clone(), text);
    }
    files
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 1500,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// Words are lost, added and swapped anywhere in the documents and shaders.
    #[test]
    #[ignore = "a suite: `./test.sh --all` runs it"]
    fn changed_anywhere(changes in prop::collection::vec(any_change(), 1..4)) {
        let files = changed(changes);
        // Right or wrong, it is an answer.
        if let Err(text) = judge(&files) {
            prop_assert!(!text.is_empty());
        }
    }

    /// Anything at all.
    #[test]
    #[ignore = "a suite: `./test.sh --all` runs it"]
    fn no_document_at_all(text in "\\PC{0,200}", shader in "\\PC{0,200}") {
        prop_assert!(judge(&files().with("graph.ron", text)).is_err());
        let _ = judge(&files().with("shade.wgsl", shader));
    }

    /// Sizes and counts up to where numbers end, on viewports up to where they end.
    #[test]
    #[ignore = "a suite: `./test.sh --all` runs it"]
    fn any_size(
        width in any::<u32>(),
        height in any::<u32>(),
        count in any::<u32>(),
        factor in any::<f32>(),
        mips in any::<u32>(),
        layers in any::<u32>(),
    ) {
        let small = format!("viewport.size * {factor:e}");
        let image = format!("mips: {}, layers: {}", mips % 40, layers % 3000);
        let files = files()
            .edited("graph.ron", "max(viewport.size / 2, 1)", &small)
            .edited("graph.ron", "2 * small.count", &format!("{count} * small.count"))
            .edited("graph.ron", "mips: 2, layers: 1", &image)
            .edited("graph.ron", "image.mip[0]", &format!("image.mip[{}]", mips % 3));
        // Sizes are not known yet.
        let graph = right(load(&files));
        let boundless = wgt::Limits {
            max_texture_dimension_2d: u32::MAX,
            max_texture_array_layers: u32::MAX,
            max_buffer_size: u64::MAX,
            max_storage_buffer_binding_size: u64::MAX,
            max_compute_workgroups_per_dimension: u32::MAX,
            ..wgt::Limits::default()
        };
        for viewport in [[width, height], [width % 8193, height % 8193], [1, 1]] {
            let mut request = PlanRequest::new(viewport, &Triangle);
            for limits in [wgt::Limits::default(), boundless.clone()] {
                request.limits = limits;
                if let Ok(plan) = graph.plan(&request) {
                    let _ = (plan.memory_bytes(), plan.outputs());
                }
            }
        }
    }
}

/// As many bytes as 64 bits cannot count, where a host's limits allow for them.
#[test]
fn more_bytes_than_can_be_counted() {
    let files = Files::graph(
        r#"
    materials: [
        Texture(
            name: "image",
            format: Rgba32Float,
            size: (4294967295, 4294967295),
            mips: 32,
            layers: 64,
        ),
        Buffer(name: "items", count: "4294967295 * 1073741823"),
    ],
    passes: [
        Clear(name: "reset", target: "image"),
        Compute(name: "number", dispatch: Groups(1, 1, 1)),
    ],
    outputs: ["image", "items"],
"#,
    )
    .with(
        "number.wgsl",
        "var<storage, read_write> items: array<u32>;
         @compute @workgroup_size(1) fn main() { items[0] = 1u; }",
    );
    let mut request = PlanRequest::new([1, 1], &Triangle);
    request.limits = wgt::Limits {
        max_texture_dimension_2d: u32::MAX,
        max_buffer_size: u64::MAX,
        max_storage_buffer_binding_size: u64::MAX,
        ..wgt::Limits::default()
    };
    let plan = right(right(load(&files)).plan(&request));
    assert_eq!(plan.memory_bytes(), u64::MAX);
    assert_eq!(plan.outputs()[1].size, [u32::MAX, 1]);
}
