//! Params, conditions, dispatches, frames and calls of documents: each feature by itself on the
//! device, to the bit.

use crate::featured::{COUNT, GPU, Running, VALUE, buffer_floats, floats, words};
use crate::support::Files;
use skiagraph_graph::ParamValue;

#[test]
fn one_shader_blurs_in_two_directions() {
    let files = Files::graph(
        r#"
        materials: [
            Texture(name: "image", format: R32Float),
            Texture(name: "across", format: "image.format", size: "image.size"),
        ],
        passes: [
            Fullscreen(name: "dot", color: ["image"]),
            Fullscreen(name: "x", shader: "blur", color: ["across"],
                bind: {"source": "image"}, set: {"direction": (1, 0)}),
            Fullscreen(name: "y", shader: "blur", color: ["image"],
                bind: {"source": "across"}, set: {"direction": (0, 1), "WEIGHT": 2}),
        ],
        outputs: ["image", "across"],
        "#,
    );
    let dot = "@fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
            return select(0.0, 8.0, all(centre.xy == vec2(1.5, 2.5)));
        }";
    let blur = "struct Params { direction: vec2<i32> }
        var<uniform> params: Params;
        override WEIGHT: i32 = 1;
        var source: texture_2d<f32>;
        @fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
            let at = vec2<i32>(centre.xy);
            return f32(WEIGHT) * (textureLoad(source, at - params.direction, 0).x
                + 2.0 * textureLoad(source, at, 0).x
                + textureLoad(source, at + params.direction, 0).x) / 4.0;
        }";
    let files = files.with("dot.wgsl", dot).with("blur.wgsl", blur);
    let mut running = Running::new(&files);
    #[rustfmt::skip]
    assert_eq!(running.floats("across"), [
        0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0,
        2.0, 4.0, 2.0, 0.0,
        0.0, 0.0, 0.0, 0.0,
    ]);
    #[rustfmt::skip]
    assert_eq!(running.floats("image"), [
        0.0, 0.0, 0.0, 0.0,
        1.0, 2.0, 1.0, 0.0,
        2.0, 4.0, 2.0, 0.0,
        1.0, 2.0, 1.0, 0.0,
    ]);
}

#[test]
fn params_of_every_type_arrive_in_the_shader() {
    let files = Files::graph(
        r#"
        params: [
            F32(name: "f", default: -0.5), I32(name: "i", default: -7), U32(name: "u", default: 9),
            Bool(name: "b", default: true), Choice(name: "c", words: [x, y, z], default: z),
            Vec2(name: "v2", default: (1, 2)), Vec3(name: "v3", default: (3, 4, 5)),
            Vec4(name: "v4", default: (6, 7, 8, 9)), F32(name: "twice", default: "2 * u + i"),
        ],
        materials: [Buffer(name: "found", count: 16)],
        passes: [Compute(name: "gather", dispatch: Groups(1, 1, 1), overwrites: ["found"])],
        outputs: ["found"],
        "#,
    );
    let gather = "struct Params {
            f: f32, v2: vec2<f32>, i: i32, v3: vec3<f32>, u: u32, b: u32, v4: vec4<f32>, c: u32,
        }
        var<uniform> params: Params;
        override twice: f32;
        var<storage, read_write> found: array<f32>;
        @compute @workgroup_size(1) fn main() {
            let p = params;
            found[0] = p.f; found[1] = f32(p.i); found[2] = f32(p.u); found[3] = f32(p.b);
            found[4] = f32(p.c); found[5] = p.v2.x; found[6] = p.v2.y; found[7] = p.v3.x;
            found[8] = p.v3.y; found[9] = p.v3.z; found[10] = p.v4.x; found[11] = p.v4.y;
            found[12] = p.v4.z; found[13] = p.v4.w; found[14] = twice;
            found[15] = f32(C_X) + 10.0 * f32(C_Y) + 100.0 * f32(C_Z);
        }";
    let values = buffer_floats(&files.with("gather.wgsl", gather), "found");
    let params = [-0.5, -7.0, 9.0, 1.0, 2.0];
    let vectors = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];
    assert_eq!(values, [&params[..], &vectors, &[11.0, 210.0]].concat());
}

#[test]
fn a_word_of_a_choice_is_a_constant_of_the_shader() {
    let files = Files::graph(
        r#"
        params: [Choice(name: "mode", words: [off, half, full], default: half)],
        materials: [Texture(name: "image", format: R32Float)],
        passes: [Fullscreen(name: "choose", color: ["image"])],
        outputs: ["image"],
        "#,
    );
    let choose = "struct Params { mode: u32 }
        var<uniform> params: Params;
        @fragment fn fragment() -> @location(0) f32 {
            if params.mode == MODE_HALF { return 0.5; }
            return select(0.0, 1.0, params.mode == MODE_FULL);
        }";
    let files = files.with("choose.wgsl", choose);
    for (word, expected) in [("off", 0.0), ("half", 0.5), ("full", 1.0)] {
        let params = [("mode", ParamValue::Choice(word.into()))];
        assert_eq!(
            Running::with(&files, &params).floats("image"),
            [expected; 16],
            "{word}"
        );
    }
    assert_eq!(floats(&files, "image"), [0.5; 16]);
}

/// Each `if` is decided when the graph is planned: by params, words, sizes, the device.
#[test]
fn what_is_there_depends_on_params_sizes_and_the_device() {
    let has = |feature| GPU.device.features().contains(feature);
    for (condition, is_there) in [
        ("n > 2", true),
        ("n > 3", false),
        ("mode == slow", true),
        ("mode != slow", false),
        ("image.width == viewport.height && n % 2 == 1", true),
        (
            "has(FLOAT32_FILTERABLE)",
            has(wgpu::Features::FLOAT32_FILTERABLE),
        ),
        ("has(SUBGROUP)", has(wgpu::Features::SUBGROUP)),
        ("false", false),
    ] {
        let files = Files::graph(&format!(
            r#"
            params: [
                U32(name: "n", default: 3),
                Choice(name: "mode", words: [quick, slow], default: slow),
            ],
            materials: [Texture(name: "image", format: R32Float)],
            passes: [
                Clear(name: "reset", target: "image", value: 1),
                Fullscreen(name: "value", if: "{condition}", color: ["image"], set: {{"value": 2}}),
            ],
            outputs: ["image"],
            "#
        ));
        let texels = floats(&files.with("value.wgsl", VALUE), "image");
        assert_eq!(texels, [1.0 + f32::from(is_there); 16], "{condition}");
    }
}

#[test]
fn as_many_items_are_made_as_are_counted_and_dispatched_over() {
    let files = Files::graph(
        r#"
        params: [U32(name: "n", default: 70)],
        materials: [
            Buffer(name: "items", count: "n + 1"),
            Buffer(name: "half", count: "ceil_div(items.count, 2)"),
            Texture(name: "image", format: R32Float, size: (7, 3)),
            Buffer(name: "pixels", count: "image.count"),
        ],
        passes: [
            Compute(name: "a", shader: "fill", dispatch: Over("items.count"),
                bind: {"out": "items"}, overwrites: ["items"]),
            Compute(name: "b", shader: "fill", dispatch: Groups(1, "min(1, n)", 1),
                bind: {"out": "half"}, overwrites: ["half"]),
            Compute(name: "c", dispatch: Over("image.size"), overwrites: ["pixels"]),
        ],
        outputs: ["items", "half", "pixels"],
        "#,
    );
    let fill = "var<storage, read_write> out: array<u32>;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) at: vec3<u32>) {
            if at.x < arrayLength(&out) { out[at.x] = at.x + 1u; }
        }";
    let c = "var<storage, read_write> pixels: array<u32>;
        @compute @workgroup_size(4, 4) fn main(@builtin(global_invocation_id) at: vec3<u32>) {
            if all(at.xy < vec2(7u, 3u)) { pixels[7u * at.y + at.x] = at.x + 10u * at.y; }
        }";
    let mut running = Running::new(&files.with("fill.wgsl", fill).with("c.wgsl", c));
    assert_eq!(running.words("items"), (1..=71).collect::<Vec<u32>>());
    assert_eq!(running.words("half"), (1..=36).collect::<Vec<u32>>());
    let pixels = (0..21)
        .map(|at| at % 7 + 10 * (at / 7))
        .collect::<Vec<u32>>();
    assert_eq!(running.words("pixels"), pixels);
}

#[test]
fn a_dispatch_may_come_from_a_buffer() {
    let files = Files::graph(
        r#"
        materials: [Buffer(name: "groups", count: 2), Buffer(name: "visited")],
        passes: [
            Clear(name: "reset", target: "visited"),
            Compute(name: "ask", dispatch: Groups(1, 1, 1), overwrites: ["groups"]),
            Compute(name: "visit", dispatch: Indirect("groups")),
            Compute(name: "again", shader: "visit", dispatch: Indirect("groups[1]")),
        ],
        outputs: ["visited"],
        "#,
    );
    let ask = "var<storage, read_write> groups: array<vec3<u32>>;
        @compute @workgroup_size(1) fn main() {
            groups[0] = vec3(3u, 2u, 1u);
            groups[1] = vec3(1u, 1u, 5u);
        }";
    let visit = "var<storage, read_write> visited: atomic<u32>;
        @compute @workgroup_size(8) fn main() { atomicAdd(&visited, 1u); }";
    let files = files.with("ask.wgsl", ask).with("visit.wgsl", visit);
    assert_eq!(words(&files, "visited"), [8 * (6 + 5)]);
}

/// Cases that Vulkan leaves open, a hanging driver included: the device was opened with wgpu's
/// check.
#[test]
fn an_indirect_dispatch_of_more_groups_than_there_may_be_does_nothing() {
    let files = Files::graph(
        r#"
        materials: [Buffer(name: "groups"), Buffer(name: "visited")],
        passes: [
            Clear(name: "reset", target: "visited"),
            Compute(name: "ask", dispatch: Groups(1, 1, 1), overwrites: ["groups"]),
            Compute(name: "visit", dispatch: Indirect("groups")),
        ],
        outputs: ["visited"],
        "#,
    );
    let most = GPU.device.limits().max_compute_workgroups_per_dimension;
    let visit = "var<storage, read_write> visited: atomic<u32>;
        @compute @workgroup_size(1) fn main() { atomicAdd(&visited, 1u); }";
    let files = files.with("visit.wgsl", visit);
    for (groups, expected) in [(most, most), (most + 1, 0)] {
        let ask = format!(
            "var<storage, read_write> groups: vec3<u32>;
            @compute @workgroup_size(1) fn main() {{ groups = vec3({groups}u, 1u, 1u); }}"
        );
        let files = files.clone().with("ask.wgsl", ask);
        assert_eq!(words(&files, "visited"), [expected], "{groups} groups");
    }
}

#[test]
fn a_graph_knows_its_frame_and_what_was_before() {
    let files = Files::graph(
        r#"
        materials: [
            Texture(name: "history", format: Rg32Float),
            Buffer(name: "total"),
        ],
        passes: [
            Fullscreen(name: "add", color: ["history"]),
            Compute(name: "tick", dispatch: Groups(1, 1, 1), overwrites: ["total"]),
        ],
        outputs: ["history", "total"],
        "#,
    );
    let frame = "struct Frame { index: u32, seconds: f32 }
        var<uniform> frame: Frame;\n";
    let add = "var history_previous: texture_2d<f32>;
        @fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) vec2<f32> {
            let before = textureLoad(history_previous, vec2<u32>(centre.xy), 0).y;
            return vec2(f32(frame.index), before + frame.seconds);
        }";
    let tick = "var<storage, read> total_previous: u32;
        var<storage, read_write> total: u32;
        @compute @workgroup_size(1) fn main() { total = total_previous + 10u + frame.index; }";
    let files = files.with("add.wgsl", format!("{frame}{add}"));
    let mut running = Running::new(&files.with("tick.wgsl", format!("{frame}{tick}")));
    // The first frames are not read back.
    for (seconds, read, history, total) in [
        (0.5, true, [0.0, 0.5], 10),
        (0.25, false, [1.0, 0.75], 21),
        (2.0, true, [2.0, 2.75], 33),
        (0.0, true, [3.0, 2.75], 46),
    ] {
        let names = if read { &["history", "total"][..] } else { &[] };
        let report = running.frame_at(seconds, names);
        if let [texels, counted] = &report.readbacks[..] {
            assert_eq!(texels.content.as_f32(), Some(history.repeat(16)));
            assert_eq!(counted.content.as_u32(), Some(vec![total]));
        }
    }
}

#[test]
fn a_document_is_called_with_other_materials_and_values() {
    let files = Files::graph(
        r#"
        params: [U32(name: "factor", default: 3)],
        materials: [
            Texture(name: "left", format: R32Float),
            Texture(name: "maps", format: R32Float, layers: 2),
        ],
        passes: [
            Fullscreen(name: "count", color: ["left"]),
            Group(name: "each", repeat: 2, passes: [
                Include(graph: "scale.ron", bind: {"image": "left", "scaled": "maps[index]"},
                    set: {"bias": "100 * each.index"}),
            ]),
            Include(graph: "scale.ron", name: "other", bind: {"image": "left"},
                set: {"factor": 10}),
        ],
        outputs: ["maps", (name: "other", material: "other.scaled")],
        "#,
    );
    let scale = r#"
        params: [U32(name: "factor"), F32(name: "bias", default: 0.5)],
        inputs: [Texture(name: "image")],
        materials: [Texture(name: "scaled", format: "image.format", size: "image.size")],
        passes: [Fullscreen(name: "scale", color: ["scaled"])],
        outputs: ["scaled"],
    "#;
    let shader = "struct Params { factor: u32, bias: f32 }
        var<uniform> params: Params;
        var image: texture_2d<f32>;
        @fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
            let value = textureLoad(image, vec2<u32>(centre.xy), 0).x;
            return params.bias + f32(params.factor) * value;
        }";
    let files = files
        .document("scale.ron", scale)
        .with("scale.wgsl", shader);
    let mut running = Running::new(&files.with("count.wgsl", COUNT));
    let line = |bias: f32, factor: f32| (0..16).map(move |at| bias + factor * at as f32);
    let maps: Vec<f32> = line(0.0, 3.0).chain(line(100.0, 3.0)).collect();
    assert_eq!(running.floats("maps"), maps);
    assert_eq!(
        running.floats("other"),
        line(0.5, 10.0).collect::<Vec<f32>>()
    );
}

#[test]
fn a_repeated_pass_knows_its_index_and_those_around_it() {
    let files = Files::graph(
        r#"
        params: [U32(name: "rows", default: 3), U32(name: "none", default: 0)],
        materials: [Buffer(name: "found", count: "2 * rows")],
        passes: [
            Clear(name: "reset", target: "found"),
            Group(name: "row", repeat: "rows", set: {"scale": 100}, passes: [
                Compute(name: "column", repeat: 2, dispatch: Groups(1, 1, 1),
                    set: {"row": "row.index", "at": "2 * row.index + index"}),
            ]),
            Compute(name: "never", shader: "column", repeat: "none", dispatch: Groups(1, 1, 1),
                set: {"row": 0, "at": 0, "scale": 0}),
        ],
        outputs: ["found"],
        "#,
    );
    let column = "struct Params { at: u32, row: u32, scale: u32 }
        var<uniform> params: Params;
        override index: u32 = 9;
        var<storage, read_write> found: array<u32>;
        @compute @workgroup_size(1) fn main() {
            found[params.at] = params.scale + 10u * params.row + index;
        }";
    let values = words(&files.with("column.wgsl", column), "found");
    assert_eq!(values, [100, 101, 110, 111, 120, 121]);
}

#[test]
fn what_is_made_in_a_repeated_entry_is_called_from_outside() {
    let files = Files::graph(
        r#"
        materials: [Texture(name: "sum", format: R32Float)],
        passes: [
            Include(graph: "make.ron", name: "made", repeat: 2, set: {"value": "index + 1"}),
            Fullscreen(name: "add", color: ["sum"],
                bind: {"a": "made[0].image", "b": "made[1].image"}),
        ],
        outputs: ["sum"],
        "#,
    );
    let make = r#"
        params: [F32(name: "value")],
        materials: [Texture(name: "image", format: R32Float)],
        passes: [Fullscreen(name: "value", color: ["image"])],
        outputs: ["image"],
    "#;
    let add = "var a: texture_2d<f32>;
        var b: texture_2d<f32>;
        @fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
            let at = vec2<u32>(centre.xy);
            return textureLoad(a, at, 0).x + 10.0 * textureLoad(b, at, 0).x;
        }";
    let files = files.document("make.ron", make).with("add.wgsl", add);
    assert_eq!(floats(&files.with("value.wgsl", VALUE), "sum"), [21.0; 16]);
}

/// `base.ron` gives 1, then adds 10 and 100.
#[test]
fn an_extended_document_runs_as_if_it_had_been_written_out() {
    let base = r#"
        params: [F32(name: "start", default: 1)],
        materials: [Texture(name: "image", format: R16Float)],
        passes: [
            Fullscreen(name: "value", color: ["image"], set: {"value": "start"}),
            Group(name: "more", passes: [
                Fullscreen(name: "ten", shader: "value", set: {"value": 10},
                    color: [(target: "image", load: Load, blend: Additive)]),
                Fullscreen(name: "hundred", shader: "value", set: {"value": 100},
                    color: [(target: "image", load: Load, blend: Additive)]),
            ]),
        ],
        outputs: ["image"],
    "#;
    for (edits, expected) in [
        ("", 111.0),
        (r#"set: {"start": 2},"#, 112.0),
        (r#"passes: [Remove(pass: "more.ten")],"#, 101.0),
        (
            r#"passes: [Change(pass: "more.ten", set: {"value": 20})],"#,
            121.0,
        ),
        (r#"passes: [Change(pass: "more", if: "start > 1")],"#, 1.0),
        (r#"passes: [Change(pass: "more", repeat: 2)],"#, 221.0),
        (
            r#"passes: [Clear(name: "nine", instead: "value", target: "image", value: 9)],"#,
            119.0,
        ),
        (
            r#"passes: [Clear(name: "nine", after: "more.ten", target: "image", value: 9)],"#,
            109.0,
        ),
    ] {
        let files = Files::graph(&format!(r#"extends: "base.ron", {edits}"#));
        let files = files.document("base.ron", base).with("value.wgsl", VALUE);
        assert_eq!(floats(&files, "image"), [expected; 16], "{edits}");
    }
}

#[test]
fn a_pass_sets_constants_words_and_vectors() {
    let files = Files::graph(
        r#"
        params: [
            U32(name: "n", default: 3),
            Choice(name: "mode", words: [off, on], default: off),
        ],
        materials: [Buffer(name: "found", count: 8)],
        passes: [Compute(name: "gather", entry: "second", dispatch: Groups(1, 1, 1),
            overwrites: ["found"], set: {
                "mode": on, "at": ("n - 1", "n / 2.0", 0.5), "flag": true, "shift": -2,
                "half": "n / 2.0",
            })],
        outputs: ["found"],
        "#,
    );
    let gather = "struct Params { mode: u32, at: vec3<f32>, n: u32 }
        var<uniform> params: Params;
        override flag: bool = false;
        override shift: i32 = 0;
        override half: f32;
        var<storage, read_write> found: array<f32>;
        @compute @workgroup_size(1) fn first() { found[0] = -1.0; }
        @compute @workgroup_size(1) fn second() {
            found[0] = f32(params.mode == MODE_ON);
            found[1] = params.at.x; found[2] = params.at.y; found[3] = params.at.z;
            found[4] = f32(params.n); found[5] = f32(flag); found[6] = f32(shift);
            found[7] = half;
        }";
    let values = buffer_floats(&files.with("gather.wgsl", gather), "found");
    assert_eq!(values, [1.0, 2.0, 1.5, 0.5, 3.0, 1.0, -2.0, 1.5]);
}

#[test]
fn a_constant_of_the_shader_says_how_much_is_done() {
    let files = Files::graph(
        r#"
        materials: [
            Buffer(name: "visited"),
            Texture(name: "image", format: R32Float),
        ],
        passes: [
            Clear(name: "reset", target: "visited"),
            Compute(name: "visit", dispatch: Groups("ROWS", "ROWS + 1", 1)),
            Raster(name: "points", topology: PointList, draw: "POINTS", color: ["image"]),
        ],
        outputs: ["visited", "image"],
        "#,
    );
    let visit = "#import \"rows.wgsl\"
        var<storage, read_write> visited: atomic<u32>;
        @compute @workgroup_size(1) fn main() { atomicAdd(&visited, 1u); }";
    let points = "const POINTS: u32 = 3u;
        @vertex fn vertex(@builtin(vertex_index) point: u32) -> @builtin(position) vec4<f32> {
            return vec4(f32(point) / 2.0 - 0.75, 0.75, 0.0, 1.0);
        }
        @fragment fn fragment() -> @location(0) f32 { return 1.0; }";
    let files = files
        .with("rows.wgsl", "const ROWS: u32 = 3;")
        .with("visit.wgsl", visit)
        .with("points.wgsl", points);
    let mut running = Running::new(&files);
    assert_eq!(running.words("visited"), [12]);
    assert_eq!(running.floats("image").iter().sum::<f32>(), 3.0);
}

#[test]
fn nothing_is_done_over_nothing() {
    let files = Files::graph(
        r#"
        params: [U32(name: "n", default: 0)],
        materials: [Buffer(name: "visited")],
        passes: [
            Clear(name: "reset", target: "visited"),
            Compute(name: "line", shader: "visit", dispatch: Over("n")),
            Compute(name: "area", shader: "visit", dispatch: Groups(1, "n", 1)),
        ],
        outputs: ["visited"],
        "#,
    );
    let visit = "var<storage, read_write> visited: atomic<u32>;
        @compute @workgroup_size(1) fn main() { atomicAdd(&visited, 1u); }";
    let files = files.with("visit.wgsl", visit);
    assert_eq!(words(&files, "visited"), [0]);
    let two = [("n", ParamValue::U32(2))];
    assert_eq!(Running::with(&files, &two).words("visited"), [4]);
}

/// A global's underscores are the dots of what an include gives.
#[test]
fn a_shader_finds_what_an_include_gives_by_its_name() {
    let files = Files::graph(
        r#"
        params: [F32(name: "gain", default: 3)],
        materials: [Texture(name: "sum", format: R32Float)],
        passes: [
            Include(graph: "make.ron", name: "left", expose: ["offset"]),
            Include(graph: "make.ron", name: "right", set: {"gain": "left.offset * 4"}),
            Fullscreen(name: "add", color: ["sum"]),
        ],
        outputs: ["sum"],
        "#,
    );
    let make = r#"
        params: [F32(name: "gain"), F32(name: "offset", default: 0.5)],
        materials: [Texture(name: "image", format: R32Float)],
        passes: [Fullscreen(name: "value", color: ["image"], set: {"value": "gain + offset"})],
        outputs: ["image"],
    "#;
    let add = "var left_image: texture_2d<f32>;
        var right_image: texture_2d<f32>;
        @fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
            let at = vec2<u32>(centre.xy);
            return textureLoad(left_image, at, 0).x + 100.0 * textureLoad(right_image, at, 0).x;
        }";
    let files = files.document("make.ron", make).with("add.wgsl", add);
    let files = files.with("value.wgsl", VALUE);
    assert_eq!(floats(&files, "sum"), [253.5; 16]);
    let offset = [("left.offset", ParamValue::F32(1.0))];
    assert_eq!(Running::with(&files, &offset).floats("sum"), [454.0; 16]);
}
