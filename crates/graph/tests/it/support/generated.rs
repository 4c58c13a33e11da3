//! Graphs of any number of passes, built like a frame with many lights: for drawings, benchmarks
//! and bounds.

/// Shaders, and the document `graph.ron` of exactly `passes` passes (at least one), as pairs of
/// path and text.
///
/// ```text
/// position ──────────────────────────────────────────┬───────────────────────────────────┐
/// lightK.draw ─ map ─▶ lightK.blur_x ─ half ─▶ lightK.blur_y ─ soft ─▶ lightK.shade ─ lit ─▶
/// lightK.add ─▶ sum_0 ⇄ sum_1
///                └────────────────────────▶ debug (every third light; culled)
/// ```
/// A light is a group. The sums take turns, so that all three hazards occur. Passes without a use
/// fill the rest.
pub fn graph(passes: usize) -> Vec<(String, String)> {
    let mut texts = Texts::default();
    texts.texture("position", "viewport.size");
    let mut entries = vec![texts.pass("gbuffer", "fill", &[], "position")];
    let mut result = "position".to_owned();
    let mut light = 0;
    while texts.passes + 6 <= passes {
        let name = |part: &str| format!("light{light}_{part}");
        for part in ["map", "half", "soft"] {
            texts.texture(&name(part), "512");
        }
        texts.texture(&name("lit"), "viewport.size");
        let sum = format!("sum_{}", light % 2);
        if light < 2 {
            texts.texture(&sum, "viewport.size");
        }
        let (map, half, soft, lit) = (name("map"), name("half"), name("soft"), name("lit"));
        let mut group = vec![
            texts.pass("draw", "fill", &[], &map),
            texts.pass("blur_x", "one", &[&map], &half),
            texts.pass("blur_y", "one", &[&half], &soft),
            texts.pass("shade", "two", &["position", &soft], &lit),
            texts.pass("add", "two", &[&result, &lit], &sum),
        ];
        if light % 3 == 0 {
            texts.texture(&name("shown"), "viewport.size");
            group.push(texts.pass("debug", "one", &[&map], &name("shown")));
        }
        entries.push(format!(
            "        Group(name: \"light{light}\", passes: [\n{}        ]),\n",
            group.concat()
        ));
        result = sum;
        light += 1;
    }
    for spare in 0..passes.saturating_sub(texts.passes) {
        let name = format!("spare_{spare}");
        texts.texture(&name, "viewport.size");
        entries.push(texts.pass(&name, "one", &["position"], &name));
    }
    let document = format!(
        "(\n    format: 3,\n    materials: [\n{}    ],\n    passes: [\n{}    ],\n    outputs: \
         [(name: \"image\", material: \"{result}\")],\n)\n",
        texts.materials.concat(),
        entries.concat()
    );
    let read = |names: &[&str]| {
        let globals: String = names
            .iter()
            .map(|name| format!("var {name}: texture_2d<f32>;\n"))
            .collect();
        let loads: String = names
            .iter()
            .map(|name| format!(" + textureLoad({name}, pixel, 0)"))
            .collect();
        format!(
            "{globals}@fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) \
             vec4<f32> {{\n    \
             let pixel = vec2<u32>(centre.xy);\n    return vec4(1.0){loads};\n}}\n"
        )
    };
    [
        ("fill.wgsl", read(&[])),
        ("one.wgsl", read(&["a"])),
        ("two.wgsl", read(&["a", "b"])),
        ("graph.ron", document),
    ]
    .map(|(path, text)| (path.to_owned(), text))
    .to_vec()
}

#[derive(Default)]
struct Texts {
    materials: Vec<String>,
    /// How many passes there are so far.
    passes: usize,
}

impl Texts {
    fn texture(&mut self, name: &str, size: &str) {
        self.materials.push(format!(
            "        Texture(name: \"{name}\", format: Rgba16Float, size: \"{size}\"),\n"
        ));
    }

    fn pass(&mut self, name: &str, shader: &str, reads: &[&str], writes: &str) -> String {
        self.passes += 1;
        let bind: Vec<String> = reads
            .iter()
            .zip(["a", "b"])
            .map(|(from, global)| format!("\"{global}\": \"{from}\""))
            .collect();
        format!(
            "        Fullscreen(name: \"{name}\", shader: \"{shader}\", bind: {{{}}}, color: \
             [\"{writes}\"]),\n",
            bind.join(", ")
        )
    }
}
