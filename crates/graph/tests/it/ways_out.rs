//! The ways out that messages offer work: a test takes the code out of a message, puts it where the
//! message says, and checks the document again.

use crate::broken::{Broken, folder, request};
use skiagraph_graph::{Code, Diagnostic, Graph, Picture, Registry, Sources};
use std::sync::Arc;

/// The documents of `tests/broken`, some of the files with another text.
struct Edited<'t> {
    files: &'t [(&'t str, &'t str)],
    rest: Broken,
}

impl Sources for Edited<'_> {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        match self.files.iter().find(|(edited, _)| *edited == path) {
            Some((_, text)) => Ok(Some((*text).into())),
            None => self.rest.read(path),
        }
    }

    fn list(&self, folder: &str) -> Vec<String> {
        self.rest.list(folder)
    }

    fn picture(&self, path: &str) -> Result<Option<Picture>, String> {
        self.rest.picture(path)
    }
}

fn text(path: &str) -> String {
    let text = folder().read(path).expect("it is readable");
    text.expect("it is there").to_string()
}

/// Messages about the document `name` when files have other texts: errors, or the warnings
/// where there are none.
fn said_with(name: &str, files: &[(&str, &str)]) -> Vec<Diagnostic> {
    let files = Edited {
        files,
        rest: folder(),
    };
    let path = format!("{name}.ron");
    match Graph::check(&path, &Registry::standard(), &files, &request()) {
        Err(errors) => errors.iter().cloned().collect(),
        Ok((graph, plan)) => {
            let warnings = graph.warnings().iter().chain(plan.warnings());
            warnings.cloned().collect()
        }
    }
}

/// The only message about a document as it stands, with its help.
fn message(name: &str) -> (String, String) {
    let diagnostics = said_with(name, &[]);
    assert_eq!(diagnostics.len(), 1, "{name}: {diagnostics:?}");
    (
        diagnostics[0].message.clone(),
        diagnostics[0].help.clone().unwrap_or_default(),
    )
}

/// The document, with `from` in it replaced by `to`, has no fault left.
#[track_caller]
fn mended(name: &str, from: &str, to: &str) {
    mended_in(name, &format!("{name}.ron"), from, to);
}

/// The document has no fault left once `from` in its file `path` is replaced by `to`.
#[track_caller]
fn mended_in(name: &str, path: &str, from: &str, to: &str) {
    let text = text(path);
    assert!(text.contains(from), "{path} has no {from}");
    let diagnostics = said_with(name, &[(path, &text.replacen(from, to, 1))]);
    assert!(diagnostics.is_empty(), "{name}, with {to}: {diagnostics:?}");
}

/// The code in the help of a message that begins with `begin`, between its backquotes.
#[track_caller]
fn code<'h>(help: &'h str, begin: &str) -> &'h str {
    let mut codes = help.split('`').skip(1).step_by(2);
    let code = codes.find(|code| code.starts_with(begin));
    code.unwrap_or_else(|| panic!("no {begin} in: {help}"))
}

/// Above the pass stands the `Clear` that the message prints, which clears depths to what its test
/// compares with, and of a texture written in part no more than that part.
#[test]
fn a_material_that_is_changed_is_cleared_above() {
    for (name, pass, clear) in [
        (
            "load_before_write",
            "Fullscreen(name: \"fill\"",
            "Clear(name: \"clear_image\", target: \"image\")",
        ),
        (
            "load_depth_before_write",
            "Raster(name: \"draw\"",
            "Clear(name: \"clear_depth\", target: \"depth\", value: 1)",
        ),
        (
            "load_depth_reversed",
            "Raster(name: \"draw\"",
            "Clear(name: \"reset_depth\", target: \"depth\", value: 0)",
        ),
        (
            "load_depth_of_stencil",
            "Raster(name: \"draw\"",
            "Clear(name: \"clear_depth\", target: \"depth\", value: (1, 0))",
        ),
        (
            "load_layer_before_write",
            "Fullscreen(name: \"second\"",
            "Clear(name: \"clear_maps\", target: \"maps[1]\")",
        ),
        (
            "counter_without_clear",
            "Compute(name: \"count\"",
            "Clear(name: \"clear_total\", target: \"total\")",
        ),
    ] {
        let (_, help) = message(name);
        let printed = code(&help, "Clear(");
        assert_eq!(printed, clear, "{name}");
        mended(name, pass, &format!("{printed},\n{pass}"));
        let printed = code(&help, "overwrites:");
        mended(name, pass, &format!("{pass}, {printed}"));
    }
}

/// A `load` that may clear does not go with an `area`; without it, and with a `Clear` above, the
/// document is right.
#[test]
fn an_area_is_cleared_above() {
    for (name, load) in [
        ("area_cleared", "load: Clear(0)"),
        ("area_cleared_if", "load: LoadIf(\"wide\")"),
        ("area_of_depth_cleared_if", "load: LoadIf(\"false\")"),
        ("area_of_stencil_cleared_if", "load: LoadIf(\"wide\")"),
    ] {
        let (message, help) = message(name);
        assert_eq!(message, "clearing knows no area", "{name}");
        assert!(
            help.contains("leave `load` out") && help.contains("`Clear`"),
            "{help}"
        );
        // A `Clear` stands above already.
        mended(name, &format!(", {load}"), "");
    }
}

/// A number below 0 is kept above it by the `max` that the message prints.
#[test]
fn a_negative_number_is_kept_above() {
    for (name, expr, way_out) in [
        (
            "negative_size_of_viewport",
            "viewport.width - 100",
            "max(viewport.width - 100, 1)",
        ),
        (
            "negative_factor",
            "-1 * viewport.size",
            "max(-1 * viewport.size, 1)",
        ),
        ("index_negative", "index - 1", "max(index - 1, 0)"),
    ] {
        let (message, help) = message(name);
        assert!(message.contains("below 0"), "{message}");
        assert_eq!(code(&help, "max("), way_out, "{name}");
        mended(name, expr, way_out);
    }
}

/// A misspelt attribute has its suggestion, of whatever it is asked.
#[test]
fn a_misspelt_attribute_has_a_suggestion() {
    for (name, misspelt, attribute) in [
        ("attribute_of_viewport", "sise", "size"),
        ("attribute_of_material", "szie", "size"),
        ("attribute_of_scene", "cuont", "count"),
        ("attribute_in_default", "widht", "width"),
    ] {
        let (message, help) = message(name);
        assert!(
            message.contains(&format!("no attribute `{misspelt}`")),
            "{message}"
        );
        assert_eq!(help, format!("did you mean `{attribute}`?"), "{name}");
        mended(name, misspelt, attribute);
    }
}

/// A number where a condition stands is compared.
#[test]
fn a_number_as_a_condition_is_compared() {
    let (_, help) = message("condition_number");
    mended(
        "condition_number",
        "if: \"cascades\"",
        &format!("if: \"{}\"", code(&help, "cascades")),
    );
}

/// A value that a shader's type does not hold is written as the message says, and an array is no
/// member of `params`.
#[test]
fn a_value_is_written_for_its_type() {
    let (wording, help) = message("set_fraction");
    assert_eq!(wording, "`count` takes a whole number from 0 (u32)");
    mended("set_fraction", "1.0", code(&help, "1"));
    let (_, help) = message("set_fraction_of");
    let way_out = code(&help, "\"floor(");
    mended("set_fraction_of", "\"viewport.width / 2.0\"", way_out);
    let (_, help) = message("set_negative");
    mended("set_negative", "-1", code(&help, "0"));
    let (_, help) = message("set_vector");
    assert_eq!(help, "write one number");
    for (name, member, ty) in [
        ("params_array", "weights", "vec4<f32>, 2"),
        ("set_matrix", "rotation", "vec4<f32>, 4"),
    ] {
        let (_, help) = message(name);
        let shader = if name == "set_matrix" { "matrix" } else { name };
        let shader = format!("{shader}.wgsl");
        let buffer = code(&help, "Buffer(name: ");
        assert_eq!(buffer, format!("Buffer(name: \"{member}\", data: […])"));
        let global = code(&help, "var<storage, read> ").replace('…', ty);
        let of_shader = text(&shader).replace("struct Params", "struct Unused");
        let of_shader = of_shader.replace("var<uniform> params: Params;", &global);
        let of_shader = of_shader.replace(&format!("params.{member}"), member);
        let document = text(&format!("{name}.ron"));
        let rows = if name == "set_matrix" { 4 } else { 2 };
        let data = format!("[{}]", vec!["(1, 0, 0, 0)"; rows].join(", "));
        let buffer = buffer.replace("[…]", &data);
        let document = document.replacen("materials: [", &format!("materials: [{buffer}, "), 1);
        let set = document.find(", set: {").map(|at| {
            let end = at + document[at..].find('}').expect("it is closed") + 1;
            document[at..end].to_owned()
        });
        let document = set.map_or(document.clone(), |set| document.replace(&set, ""));
        let diagnostics = said_with(
            name,
            &[(&format!("{name}.ron"), &document), (&shader, &of_shader)],
        );
        assert!(diagnostics.is_empty(), "{name}: {diagnostics:?}");
    }
}

/// A param and the member of `params` of its name get one type, the one or the other.
#[test]
fn a_param_and_its_member_have_one_type() {
    let (wording, help) = message("params_member");
    assert_eq!(
        wording,
        "`params.bias` is u32 in the shader, but the param `bias` needs f32 there"
    );
    let (member, param) = (code(&help, "bias: "), code(&help, "U32(name: \"bias\""));
    let shader = text("params_member.wgsl").replace("bias: u32", member);
    let shader = shader.replace(
        "params.bias + params.edge",
        "params.bias + f32(params.edge)",
    );
    let diagnostics = said_with("params_member", &[("params_member.wgsl", &shader)]);
    assert!(diagnostics.is_empty(), "{diagnostics:?}");
    let param = param.replace('…', "default: 1");
    mended("params_member", "F32(name: \"bias\", default: 0.5)", &param);
}

/// The type of a global is told before the functions that use it, of which only that is wrong.
#[test]
fn a_global_has_the_type_of_what_is_bound() {
    for (name, expected, from, to) in [
        (
            "binding_scalar",
            "the texture `seen` cannot be the shader's `seen`",
            "texture_2d<u32>",
            "texture_2d<f32>",
        ),
        (
            "binding_layers",
            "the texture `seen` cannot be the shader's `seen`",
            "texture_2d<f32>",
            "texture_2d_array<f32>",
        ),
        (
            "binding_params",
            "`params.share` is u32 in the shader, but the param `share` needs f32 there",
            "share: u32",
            "share: f32",
        ),
    ] {
        assert_eq!(message(name).0, expected, "{name}");
        mended_in(name, &format!("{name}.wgsl"), from, to);
    }
}

/// A name that a shader does not know is that of a word of a `Choice`, or of a module's.
#[test]
fn an_unknown_name_is_a_word_or_in_a_module() {
    let (_, help) = message("choice_misspelt");
    assert_eq!(help, "did you mean `MODE_EXACT`?");
    mended_in(
        "choice_misspelt",
        "choice_misspelt.wgsl",
        "MODE_EXCAT",
        "MODE_EXACT",
    );
    for name in ["import_forgotten", "type_forgotten"] {
        let (_, help) = message(name);
        let import = code(&help, "#import");
        assert_eq!(import, "#import \"shared/interval.wgsl\"", "{name}");
        let path = format!("{name}.wgsl");
        let shader = format!("{import}\n{}", text(&path));
        let diagnostics = said_with(name, &[(&path, &shader)]);
        assert!(diagnostics.is_empty(), "{name}: {diagnostics:?}");
    }
}

/// Where the frame before is meant, the message says how to read it.
#[test]
fn the_frame_before_is_read_as_the_message_says() {
    for (name, pass) in [
        ("feedback", "name: \"blur\""),
        ("read_before_write", "name: \"blur\""),
    ] {
        let (_, help) = message(name);
        mended(name, pass, &format!("{pass}, {}", code(&help, "bind:")));
    }
    let (_, help) = message("copy_to_itself");
    let previous = format!("from: {}", code(&help, "\"image.previous\""));
    mended("copy_to_itself", "from: \"image\"", &previous);
}

/// A bracket that is not closed is named where it is opened.
#[test]
fn a_bracket_is_closed() {
    for (name, from, to) in [
        ("bracket_of_list", "    passes:", "    ],\n    passes:"),
        ("bracket_of_field", "\"image\")", "\"image\"])"),
        ("bracket_of_output", "\"image\"\n", "\"image\"]\n"),
        ("unclosed", "", ""),
    ] {
        let (message, help) = message(name);
        assert_eq!(
            (&*message, &*help),
            ("`[` is not closed", "close it with `]`"),
            "{name}"
        );
        if !from.is_empty() {
            mended(name, from, to);
        }
    }
    assert_eq!(message("bracket_of_map").0, "`{` is not closed");
}

/// An unused thing is used or taken out; members of one name stand at one place.
#[test]
fn warnings_have_ways_out() {
    let (wording, _) = message("pass_unneeded");
    assert_eq!(wording, "nothing needs the pass `look`");
    mended("pass_unneeded", "outputs: [", "outputs: [\"debug\", ");
    message("output_without_target");
    let document =
        text("output_without_target.ron").replace("[\"image\"])]", "[\"image\", \"other\"])]");
    let other = "materials: [Texture(name: \"other\", format: R32Float), ";
    let document = document.replace("materials: [", other);
    let files = [("output_without_target.ron", &*document)];
    assert!(said_with("output_without_target", &files).is_empty());
    let (wording, _) = message("layout_swapped");
    assert_eq!(
        wording,
        "`near` stands at two places in the items of `spans`"
    );
    mended_in(
        "layout_swapped",
        "span_read.wgsl",
        "far: f32, near: f32",
        "near: f32, far: f32",
    );
    // Another layout behind these two is an error all the same.
    let read = "Compute(name: \"span_read\", dispatch: Over(4)),";
    let third = read.to_owned() + &read.replace("read", "third");
    let document = text("layout_swapped.ron").replace(read, &third);
    let shader = text("span_read.wgsl").replace("far: f32, near: f32", "far: u32, near: f32");
    let files = [
        ("layout_swapped.ron", &*document),
        ("span_third.wgsl", &*shader),
    ];
    assert!(
        said_with("layout_swapped", &files)
            .iter()
            .any(|diagnostic| diagnostic.code == Code::LayoutMismatch)
    );
    message("samples_only_bound");
    let edited = text("samples_only_bound.ron").replace(", samples: 4", "");
    let shader = text("count_samples.wgsl")
        .replace("multisampled_", "")
        .replace("Samples", "Levels");
    let files = [
        ("samples_only_bound.ron", &*edited),
        ("count_samples.wgsl", &*shader),
    ];
    assert!(said_with("samples_only_bound", &files).is_empty());
}

/// Types in naga's messages are WGSL's.
#[test]
fn types_are_those_of_wgsl() {
    let (wording, _) = message("types_of_naga");
    assert!(
        wording.contains("`f32`") && wording.contains("`vec2<u32>`"),
        "{wording}"
    );
    assert!(!wording.contains("Scalar"), "{wording}");
}

/// A document says what it needs of viewport, scene and lights, as an included one does; what
/// follows is not told.
#[test]
fn a_document_needs_what_it_says() {
    let (wording, _) = message("needs_unmet");
    assert_eq!(
        wording,
        "`needs_unmet.ron` needs `lights.count > 3 && viewport.width >= 64`"
    );
    let (wording, _) = message("needs_included");
    assert_eq!(
        wording,
        "`included/needs_many.ron` needs `lights.count >= least`"
    );
    mended(
        "needs_included",
        "many.ron\"",
        "many.ron\", set: {\"least\": 3}",
    );
}
