//! Graphs of any number of passes, built like a frame with many lights: for drawings, benchmarks and bounds.

/// Shaders, and the document `graph.ron` of exactly `passes` passes (at least one), as pairs of path and text.
///
/// ```text
/// position ──────────────────────────────────────────┬───────────────────────────────────┐
/// lightK.draw ─ map ─▶ lightK.blur_x ─ half ─▶ lightK.blur_y ─ soft ─▶ lightK.shade ─ lit ─▶ lightK.add ─▶ sum_0 ⇄ sum_1
///                └────────────────────────▶ debug (every third light; culled)
/// ```
/// The sums take turns, so that all three hazards occur. What is left over is filled with passes that nobody needs.
pub fn graph(passes: usize) -> Vec<(String, String)> {
    let mut texts = Texts::default();
    texts.texture("position", "Viewport");
    texts.pass("gbuffer", "fill", &[], "position");
    let mut result = "position".to_owned();
    let mut light = 0;
    while texts.passes.len() + 6 <= passes {
        let name = |part: &str| format!("light{light}.{part}");
        for part in ["map", "half", "soft"] {
            texts.texture(&name(part), "Square(512)");
        }
        texts.texture(&name("lit"), "Viewport");
        texts.pass(&name("draw"), "fill", &[], &name("map"));
        texts.pass(&name("blur_x"), "one", &[&name("map")], &name("half"));
        texts.pass(&name("blur_y"), "one", &[&name("half")], &name("soft"));
        texts.pass(
            &name("shade"),
            "two",
            &["position", &name("soft")],
            &name("lit"),
        );
        let sum = format!("sum_{}", light % 2);
        if light < 2 {
            texts.texture(&sum, "Viewport");
        }
        texts.pass(&name("add"), "two", &[&result, &name("lit")], &sum);
        if light % 3 == 0 {
            texts.texture(&name("shown"), "Viewport");
            texts.pass(&name("debug"), "one", &[&name("map")], &name("shown"));
        }
        result = sum;
        light += 1;
    }
    for spare in 0..passes.saturating_sub(texts.passes.len()) {
        let name = format!("spare_{spare}");
        texts.texture(&name, "Viewport");
        texts.pass(&name, "one", &["position"], &name);
    }
    let document = format!(
        "(\n    format: 1,\n    materials: [\n{}    ],\n    passes: [\n{}    ],\n    outputs: [(name: \"image\", material: \"{result}\")],\n)\n",
        texts.materials.concat(),
        texts.passes.concat()
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
            "{globals}@fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) vec4<f32> {{\n    \
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
    passes: Vec<String>,
}

impl Texts {
    fn texture(&mut self, name: &str, size: &str) {
        self.materials.push(format!(
            "        Texture(name: \"{name}\", format: Rgba16Float, size: {size}),\n"
        ));
    }

    fn pass(&mut self, name: &str, shader: &str, reads: &[&str], writes: &str) {
        let bind: Vec<String> = reads
            .iter()
            .zip(["a", "b"])
            .map(|(from, global)| format!("\"{global}\": \"{from}\""))
            .collect();
        self.passes.push(format!(
            "        Fullscreen(name: \"{name}\", shader: \"{shader}\", bind: {{{}}}, color: [(target: \"{writes}\", load: Clear(0, 0, 0, 0))]),\n",
            bind.join(", ")
        ));
    }
}
