//! Content of materials and how shaders see it: 3D textures, pictures, constant numbers, uniform
//! buffers, items of buffers, a pass kind's own buffers, sizes by copies.

use crate::support::{Files, Triangle, checked, codes, load, plan, right};
use serde::Deserialize;
use skiagraph_graph::{
    BindTarget, Buffer, Code, Graph, LinkedBinding, Lowering, NoProvider, Origin, PassKind, Plan,
    PlanRequest, Reference, Registry, Resource, ResourceKind,
    step::{Dispatch, Groups, Operand, Step, Threads},
};
use wgt::{ShaderStages, TextureViewDimension};

/// Materials, and a compute pass `look` with this shader that writes the buffer `found`.
fn looking(materials: &str, passes: &str, declarations: &str, body: &str) -> Files {
    let sections = format!(
        r#"materials: [{materials}, Buffer(name: "found", count: 4)],
        passes: [{passes} Compute(name: "look", dispatch: Groups(1, 1, 1))],
        outputs: ["found"]"#
    );
    let shader = format!(
        "{declarations} var<storage, read_write> found: array<f32>;
        @compute @workgroup_size(1) fn main() {{ found[0] = {body}; }}"
    );
    Files::graph(&sections).with("look.wgsl", shader)
}

fn resource<'p>(plan: &'p Plan, name: &str) -> &'p Resource {
    let mut resources = plan.resources().iter();
    let resource = resources.find(|resource| resource.name == name);
    resource.unwrap_or_else(|| panic!("no material is called {name}"))
}

fn buffer<'p>(plan: &'p Plan, name: &str) -> &'p Buffer {
    match &resource(plan, name).kind {
        ResourceKind::Buffer(buffer) => buffer,
        other => panic!("{name} is no buffer: {other:?}"),
    }
}

#[test]
fn a_3d_texture_is_bound_whole_and_drawn_to_by_slices() {
    let fill = "@fragment fn fragment() -> @location(0) f32 { return 1.0; }";
    let solid = "var fog: texture_3d<f32>;";
    let load = "textureLoad(fog, vec3(0u), 0).x";
    let files = |passes: &str, declarations: &str, bind: &str| {
        let fog = r#"Texture(name: "fog", format: R32Float, size: (4, 2, 3), mips: 2)"#;
        let files = looking(fog, passes, declarations, load).with("fill.wgsl", fill);
        files.edited(
            "graph.ron",
            r#"name: "look","#,
            &format!(r#"name: "look", {bind}"#),
        )
    };
    let fill = |to: &str| {
        format!(r#"Fullscreen(name: "fill", shader: "fill", repeat: 3, color: ["{to}"]),"#)
    };
    let plan = right(plan(&files(
        &fill("fog[index].mip[0]"),
        solid,
        r#"bind: {"fog": "fog.mip[0]"},"#,
    )));
    let ResourceKind::Texture(fog) = &resource(&plan, "fog").kind else {
        panic!("it is a texture");
    };
    assert!(fog.is_3d);
    assert_eq!((fog.size, fog.layers, fog.mip_layers(1)), ([4, 2], 3, 1));
    assert_eq!((fog.mip_size(40), fog.mip_layers(40)), ([1, 1], 1));
    assert_eq!(fog.bytes(), 4 * (4 * 2 * 3 + 2));
    let look = plan.all_passes().last().expect("there is one");
    let bindings = &look.steps[0].program().expect("it has one").bindings;
    let seen = bindings.iter().find_map(|binding| match &binding.target {
        BindTarget::Texture { dimension, .. } => Some(*dimension),
        _ => None,
    });
    assert_eq!(seen, Some(TextureViewDimension::D3));
    let whole = fill("fog[index].mip[0]");
    let mip = r#"bind: {"fog": "fog.mip[0]"},"#;
    for (files, code) in [
        // No pass writes the other mip; two slices leave the third.
        (files(&whole, solid, ""), Code::ReadBeforeWrite),
        (
            files(&whole.replace("repeat: 3", "repeat: 2"), solid, mip),
            Code::ReadBeforeWrite,
        ),
        (files(&fill("fog[index].mip[1]"), solid, mip), Code::Range),
        (
            files(&whole.replace("repeat: 3", "repeat: 4"), solid, mip),
            Code::Range,
        ),
        (files(&fill("fog"), solid, mip), Code::ResourceKind),
        (
            files(&whole, "var fog: texture_2d_array<f32>;", mip).edited(
                "look.wgsl",
                "vec3(0u), 0",
                "vec2(0u), 0, 0",
            ),
            Code::ResourceKind,
        ),
        (
            files(&whole, solid, r#"bind: {"fog": "fog[0].mip[0]"},"#),
            Code::ResourceKind,
        ),
    ] {
        let diagnostics = checked(&files);
        assert!(
            codes(&diagnostics).contains(&code),
            "{code:?}: {diagnostics:?}"
        );
    }
    let layered = files(&whole, solid, mip).edited("graph.ron", "mips: 2", "mips: 2, layers: 2");
    assert_eq!(codes(&checked(&layered))[0], Code::Size);
}

/// A picture brings its size, is there before the first pass, and is never written.
#[test]
fn a_texture_that_holds_a_picture() {
    let files = |texture: &str, passes: &str| {
        let declarations = "var noise: texture_2d<f32>;";
        let body = "textureLoad(noise, vec2(0u), 0).x";
        let files = looking(texture, passes, declarations, body);
        files.picture("noise.png", 3, &[0, 51, 102, 153, 204, 255])
    };
    let noise = r#"Texture(name: "noise", format: R8Unorm, file: "noise.png")"#;
    let noise_plan = right(plan(&files(noise, "")));
    let noise_texture = resource(&noise_plan, "noise");
    assert_eq!(noise_texture.origin, Origin::Constant);
    let ResourceKind::Texture(texture) = &noise_texture.kind else {
        panic!("it is a texture");
    };
    assert_eq!(texture.size, [3, 2]);
    let picture = texture.picture.as_ref().expect("it holds one");
    let bytes = picture.bytes(texture.format).expect("its format holds one");
    assert_eq!(bytes, [0, 51, 102, 153, 204, 255]);
    // Its size is known to expressions.
    let sized = files(
        &format!(r#"{noise}, Buffer(name: "all", count: "noise.count")"#),
        "",
    );
    let sized = sized.edited(
        "look.wgsl",
        "var noise",
        "var<storage, read_write> all: array<f32>; var noise",
    );
    let sized = sized.edited("look.wgsl", "found[0]", "all[0] = 1.0; found[0]");
    assert_eq!(buffer(&right(plan(&sized)), "all").bytes, 6 * 4);
    for (texture, passes, code) in [
        (
            noise.replace("noise.png", "other.png"),
            "",
            Code::MissingFile,
        ),
        (
            noise.replace("noise.png", "../noise.png"),
            "",
            Code::MissingFile,
        ),
        (noise.replace("R8Unorm", "R8Uint"), "", Code::FormatMismatch),
        (noise.replace("file", "size: 4, file"), "", Code::Size),
        (noise.replace("file", "mips: All, file"), "", Code::Size),
        (
            noise.to_owned(),
            r#"Clear(name: "reset", target: "noise"),"#,
            Code::ResourceKind,
        ),
    ] {
        let diagnostics = checked(&files(&texture, passes));
        assert_eq!(
            diagnostics.first().map(|diagnostic| diagnostic.code),
            Some(code),
            "{texture}: {diagnostics:?}"
        );
    }
}

/// A buffer of constant numbers, and a shader that sees it.
fn constant(data: &str, declaration: &str, body: &str) -> Files {
    let buffer = format!(r#"Buffer(name: "kernel", data: {data})"#);
    looking(&buffer, "", declaration, body)
}

fn array(ty: &str) -> String {
    format!("var<storage, read> kernel: array<{ty}>;")
}

#[test]
fn a_buffer_that_holds_numbers_is_laid_out_as_its_shader_sees_it() {
    let item = "struct Item { weight: f32, at: vec2<i32> }";
    let words = |files: &Files| -> Vec<u32> {
        let plan = right(plan(files));
        assert_eq!(resource(&plan, "kernel").origin, Origin::Constant);
        let content = buffer(&plan, "kernel").content.clone().expect("it has one");
        let word = |word: &[u8]| u32::from_le_bytes(word.try_into().expect("they are four"));
        content.chunks(4).map(word).collect()
    };
    let f = f32::to_bits;
    for (data, declaration, body, expected) in [
        (
            "[0.25, 2, -1]",
            array("f32"),
            "kernel[0]",
            vec![f(0.25), f(2.0), f(-1.0)],
        ),
        ("[1, 2]", array("u32"), "f32(kernel[0])", vec![1, 2]),
        (
            "[1, -2]",
            array("i32"),
            "f32(kernel[0])",
            vec![1, u32::MAX - 1],
        ),
        (
            "[(1, 2, 3), (4, 5, 6)]",
            array("vec3<f32>"),
            "kernel[0].x",
            vec![f(1.0), f(2.0), f(3.0), 0, f(4.0), f(5.0), f(6.0), 0],
        ),
        (
            "[(1, (2, -3)), (4, (5, 6))]",
            format!("{item} {}", array("Item")),
            "kernel[0].weight",
            vec![f(1.0), 0, 2, u32::MAX - 2, f(4.0), 0, 5, 6],
        ),
        (
            "[(1, 2, 3, 4)]",
            "var<uniform> kernel: vec4<f32>;".to_owned(),
            "kernel.x",
            vec![f(1.0), f(2.0), f(3.0), f(4.0)],
        ),
        (
            "[1, 2, 3]",
            "var<storage, read> kernel: array<f32, 3>;".to_owned(),
            "kernel[0]",
            vec![f(1.0), f(2.0), f(3.0)],
        ),
    ] {
        assert_eq!(
            words(&constant(data, &declaration, body)),
            expected,
            "{declaration}"
        );
    }
}

#[test]
fn numbers_that_do_not_fit_their_shader() {
    for (data, declaration, body, code) in [
        (
            "[0.5]",
            array("u32"),
            "f32(kernel[0])",
            Code::LayoutMismatch,
        ),
        ("[-1]", array("u32"), "f32(kernel[0])", Code::LayoutMismatch),
        ("[(1, 2)]", array("f32"), "kernel[0]", Code::LayoutMismatch),
        (
            "[1, 2]",
            "var<storage, read> kernel: array<f32, 3>;".to_owned(),
            "kernel[0]",
            Code::LayoutMismatch,
        ),
        (
            "[1, 2, 3, 4]",
            "var<storage, read> kernel: array<f32, 3>;".to_owned(),
            "kernel[0]",
            Code::LayoutMismatch,
        ),
        ("[]", array("f32"), "kernel[0]", Code::Size),
        ("[\"1 > 0\"]", array("f32"), "kernel[0]", Code::Expression),
        ("[1], count: 1", array("f32"), "kernel[0]", Code::Size),
        (
            "[1]",
            "var<storage, read_write> kernel: array<f32>;".to_owned(),
            "atan2(kernel[0], 1.0); kernel[0] = 1.0",
            Code::ResourceKind,
        ),
    ] {
        let diagnostics = checked(&constant(data, &declaration, body));
        assert_eq!(
            diagnostics.first().map(|diagnostic| diagnostic.code),
            Some(code),
            "{data} {declaration}: {diagnostics:?}"
        );
    }
}

/// A `count` is for those that see an array of any length, and an error where none does.
#[test]
fn a_count_that_no_shader_asks_for_is_refused() {
    let files = |buffer: &str, ty: &str, body: &str| {
        let buffer = format!(r#"Buffer(name: "items"{buffer})"#);
        let clear = r#"Clear(name: "reset", target: "items"),"#;
        looking(
            &buffer,
            clear,
            &format!("var<storage, read> items: {ty};"),
            body,
        )
    };
    let fixed = |count: &str| checked(&files(count, "array<f32, 3>", "items[0]"));
    assert_eq!(codes(&fixed("")), []);
    let diagnostics = fixed(", count: 3");
    assert_eq!(codes(&diagnostics), [Code::Size]);
    assert_eq!(
        diagnostics[0].message,
        "the `count` of `items` has no effect"
    );
    let scalar = checked(&files(", count: 1", "f32", "items"));
    assert_eq!(codes(&scalar), [Code::Size]);
    let any = |count: &str| checked(&files(count, "array<f32>", "items[0]"));
    assert_eq!(codes(&any(", count: 3")), []);
    let diagnostics = any("");
    assert_eq!(codes(&diagnostics), [Code::Size]);
    assert_eq!(
        diagnostics[0].message,
        "`items` does not say how many items it has"
    );
}

/// An item of a buffer is bound where it lies, so it must begin where every device can bind.
#[test]
fn items_of_buffers_are_bound_in_place() {
    let files = |size: u32, bind: &str| {
        let sections = format!(
            r#"materials: [Buffer(name: "slots", count: 3), Buffer(name: "found", count: 4)],
            passes: [
                Compute(name: "fill", dispatch: Over("slots.count")),
                Compute(name: "look", dispatch: Groups(1, 1, 1), bind: {{"slot": "{bind}"}}),
            ],
            outputs: ["found"]"#
        );
        let slot = format!("struct Slot {{ @size({size}) value: vec4<f32> }}");
        let fill = format!(
            "{slot} var<storage, read_write> slots: array<Slot>;
            @compute @workgroup_size(1) fn main() {{ slots[0].value = vec4(1.0); }}"
        );
        let look = format!(
            "{slot} var<uniform> slot: Slot; var<storage, read_write> found: array<f32>;
            @compute @workgroup_size(1) fn main() {{ found[0] = slot.value.x; }}"
        );
        Files::graph(&sections)
            .with("fill.wgsl", fill)
            .with("look.wgsl", look)
    };
    let plan = right(plan(&files(256, "slots[2]")));
    assert_eq!(buffer(&plan, "slots").bytes, 3 * 256);
    let bindings = &plan.all_passes()[1].steps[0]
        .program()
        .expect("it has one")
        .bindings;
    let bound = bindings
        .iter()
        .find_map(|binding| match (&binding.target, binding.ty) {
            (BindTarget::Buffer(target), wgt::BindingType::Buffer { ty, .. }) => {
                (ty == wgt::BufferBindingType::Uniform).then(|| target.part.items())
            }
            _ => None,
        });
    assert_eq!(bound, Some(Some(2..3)));
    assert_eq!(codes(&checked(&files(32, "slots[2]"))), [Code::Alignment]);
    assert_eq!(codes(&checked(&files(256, "slots[3]"))), [Code::Range]);
    // All items are another type than one of them.
    assert_eq!(
        codes(&checked(&files(256, "slots"))),
        [Code::LayoutMismatch]
    );
}

/// Two or four scalars are laid out as the vector of them, so that one shader may count what
/// another reads as one.
#[test]
fn structs_of_scalars_are_vectors() {
    let files = |members: &str, seen: &str| {
        let fill = format!(
            "struct Item {{ count: atomic<u32>, {members} }}
            var<storage, read_write> items: array<Item>;
            @compute @workgroup_size(1) fn main() {{ atomicAdd(&items[0].count, 1u); }}"
        );
        let look = format!(
            "var<storage, read> items: array<{seen}>; var<storage, read_write> found: array<u32>;
            @compute @workgroup_size(1) fn main() {{ found[0] = u32(items[0].y); }}"
        );
        let sections = r#"
            materials: [Buffer(name: "items", count: 2), Buffer(name: "found", count: 1)],
            passes: [
                Clear(name: "reset", target: "items"),
                Compute(name: "fill", dispatch: Groups(1, 1, 1)),
                Compute(name: "look", dispatch: Groups(1, 1, 1)),
            ],
            outputs: ["found"],"#;
        Files::graph(sections)
            .with("fill.wgsl", &fill)
            .with("look.wgsl", &look)
    };
    for (members, seen) in [
        ("b: u32, c: u32, d: u32", "vec4<u32>"),
        ("b: u32", "vec2<u32>"),
    ] {
        assert_eq!(codes(&checked(&files(members, seen))), [], "{seen}");
    }
    for (members, seen) in [
        ("b: u32, c: u32, d: u32", "vec4<i32>"),
        ("b: u32, c: u32, d: f32", "vec4<u32>"),
        ("b: u32, c: u32", "vec4<u32>"),
        ("b: vec2<u32>, d: u32", "vec4<u32>"),
    ] {
        let codes = codes(&checked(&files(members, seen)));
        assert_eq!(codes, [Code::LayoutMismatch], "{members}, {seen}");
    }
}

/// A binding is visible to the stages whose entry points use it, and to no other.
#[test]
fn bindings_are_visible_to_the_stages_that_use_them() {
    let shader = "var<storage, read> corners: array<f32>; var<storage, read> colours: array<f32>;
        var<storage, read> both: array<f32>; var<storage, read_write> counted: array<u32>;
        struct Params { scale: f32 } var<uniform> params: Params;
        @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
            return params.scale * vec4(corners[index] + both[0]);
        }
        @fragment fn fragment() -> @location(0) f32 {
            counted[0] = 1u;
            return colours[0] + both[1];
        }";
    let files = Files::graph(
        r#"params: [F32(name: "scale", default: 1)],
        materials: [
            Buffer(name: "corners", data: [1, 2]), Buffer(name: "colours", data: [1, 2]),
            Buffer(name: "both", data: [1, 2]), Buffer(name: "counted", count: 2),
            Texture(name: "image", format: R32Float),
        ],
        passes: [
            Clear(name: "reset", target: "counted"),
            Raster(name: "draw", draw: 3, color: ["image"]),
        ],
        outputs: ["image", "counted"]"#,
    )
    .with("draw.wgsl", shader);
    let plan = right(plan(&files));
    let program = plan.all_passes()[1].steps[0].program().expect("it has one");
    let seen = |name: &str| {
        let is_it = |binding: &&LinkedBinding| match &binding.target {
            BindTarget::Buffer(target) => plan.resource(target.id).name == name,
            BindTarget::Params(_) => name == "params",
            _ => false,
        };
        program
            .bindings
            .iter()
            .find(is_it)
            .map(|binding| binding.visibility)
    };
    assert_eq!(seen("corners"), Some(ShaderStages::VERTEX));
    assert_eq!(seen("params"), Some(ShaderStages::VERTEX));
    assert_eq!(seen("colours"), Some(ShaderStages::FRAGMENT));
    assert_eq!(seen("both"), Some(ShaderStages::VERTEX_FRAGMENT));
    assert_eq!(seen("counted"), Some(ShaderStages::FRAGMENT));
    // Vertex shaders write only where the document requires it.
    let vertex = files.edited(
        "draw.wgsl",
        "return params.scale",
        "counted[1] = 1u; return params.scale",
    );
    assert_eq!(codes(&checked(&vertex)), [Code::Feature]);
    let requires = vertex.edited(
        "graph.ron",
        "params:",
        r#"requires: ["VERTEX_WRITABLE_STORAGE"], params:"#,
    );
    let graph = right(load(&requires));
    let mut request = PlanRequest::new([8, 8], &NoProvider);
    request.features = graph.features();
    right(graph.plan(&request));
}

/// A buffer that no shader sees has the size of what it is copied from, through any number of
/// copies in any order; a ring of them that has no size ends, too.
#[test]
fn sizes_go_through_copies_of_copies() {
    const LONG: usize = 300;
    let document = |first: &str| {
        let materials: String = (0..=LONG)
            .map(|n| format!(r#"Buffer(name: "b{n}"),"#))
            .collect();
        let copies: String = (0..LONG)
            .map(|n| format!(r#"Copy(name: "c{n}", from: "b{}", to: "b{n}"),"#, n + 1))
            .collect();
        let sections =
            format!(r#"materials: [{materials}], passes: [{first} {copies}], outputs: ["b0"]"#);
        let shader = format!(
            "var<storage, read_write> b{LONG}: array<u32, 7>;
            @compute @workgroup_size(1) fn main() {{ b{LONG}[0] = 1u; }}"
        );
        Files::graph(&sections).with("write.wgsl", shader)
    };
    // Each copy is of what is written below it.
    let plan = right(plan(&document(
        r#"Compute(name: "write", dispatch: Groups(1, 1, 1)),"#,
    )));
    let passes = plan.live().map(|pass| pass.name.value.as_str());
    let copies = (0..LONG).rev().map(|n| format!("c{n}"));
    assert!(passes.eq(std::iter::once("write".to_owned()).chain(copies)));
    assert!((0..=LONG).all(|n| buffer(&plan, &format!("b{n}")).bytes == 28));
    let ring = Files::graph(
        r#"materials: [Buffer(name: "a"), Buffer(name: "b")],
        passes: [
            Copy(name: "x", from: "a", to: "b"), Copy(name: "y", from: "b", to: "a"),
        ],
        outputs: ["a"]"#,
    );
    assert!(!checked(&ring).is_empty());
}

/// A kind with a buffer of its own, of 64 bytes.
#[derive(Debug, Deserialize)]
struct Count {}

impl PassKind for Count {
    fn lower(&self, pass: &mut Lowering<'_>) {
        let scratch = pass.scratch("items", 64);
        pass.step(Step::Clear {
            target: scratch.into(),
            value: [0.0; 4],
        });
    }
}

/// A pass's own buffer is its alone, whatever the document calls its materials.
#[test]
fn a_kinds_own_buffer_is_no_material() {
    let mut registry = Registry::standard();
    registry.register::<Count>("Count");
    let shader = "var<storage, read_write> items: array<u32>;
        @compute @workgroup_size(1) fn main() { items[0] = 1u; }";
    let files = Files::graph(
        r#"materials: [Buffer(name: "items", count: 4), Buffer(name: "own", count: 2)],
        passes: [
            Clear(name: "reset", target: "items"), Compute(name: "use", dispatch: Groups(1, 1, 1)),
            Count(name: "own"), Count(name: "items"),
        ],
        outputs: ["items"]"#,
    )
    .with("use.wgsl", shader);
    let graph = right(Graph::load("graph.ron", &registry, &files));
    let plan = right(graph.plan(&PlanRequest::new([8, 8], &NoProvider)));
    assert_eq!(buffer(&plan, "items").bytes, 16);
    let passes = plan.all_passes();
    let used: Vec<&str> = passes
        .iter()
        .map(|pass| plan.resource(pass.accesses[0].resource).name.as_str())
        .collect();
    assert_eq!(used, ["items", "items", "own/items", "items/items"]);
    let ids: Vec<usize> = passes
        .iter()
        .map(|pass| pass.accesses[0].resource.index())
        .collect();
    assert!(ids[0] == ids[1] && ids[2] != ids[0] && ids[3] != ids[0] && ids[2] != ids[3]);
    assert_eq!(plan.culled().len(), 2, "no output needs what only they see");
}

/// A kind that has a shader fill a buffer of its own, of so many bytes.
#[derive(Debug, Deserialize)]
struct Fill {
    bytes: u64,
    result: Reference,
}

impl PassKind for Fill {
    fn lower(&self, pass: &mut Lowering<'_>) {
        let scratch = Operand::from(pass.scratch("scratch", self.bytes));
        let mut program = pass.program_of("fill");
        program.bind.push((pass.named("items"), scratch.clone()));
        pass.step(Step::Dispatch(Dispatch {
            program,
            groups: Groups::Direct(Threads::Groups([1; 3])),
        }));
        pass.step(Step::Copy {
            from: scratch,
            to: (&self.result).into(),
        });
    }
}

/// Its size is that which the kind gives it, whatever items a shader sees in it, if there is one.
#[test]
fn a_kinds_own_buffer_has_the_size_that_it_asks_for() {
    let mut registry = Registry::standard();
    registry.register::<Fill>("Fill");
    let cases = [
        (64, "u32", 64),
        (64, "vec4<u32>", 64),
        (6, "u32", 8),
        (0, "vec4<u32>", 16),
    ];
    for (bytes, item, expected) in cases {
        let shader = format!(
            "var<storage, read_write> items: array<{item}>;
            @compute @workgroup_size(1) fn main() {{ items[0] = {item}(1); }}"
        );
        let document = format!(
            r#"materials: [Buffer(name: "result")],
            passes: [Fill(name: "fill", bytes: {bytes}, result: "result")], outputs: ["result"]"#
        );
        let files = Files::graph(&document).with("fill.wgsl", shader);
        let graph = right(Graph::load("graph.ron", &registry, &files));
        let plan = right(graph.plan(&PlanRequest::new([8, 8], &NoProvider)));
        for name in ["fill/scratch", "result"] {
            assert_eq!(buffer(&plan, name).bytes, expected, "{name} of {item}");
        }
    }
}

/// An item that is bound as storage needs the alignment of storage buffers, whatever uniforms need.
#[test]
fn items_of_the_host_are_aligned_as_they_are_bound() {
    let files = Files::graph(
        r#"materials: [Texture(name: "image", format: R32Float)],
        passes: [Fullscreen(name: "one", bind: {"one": "scene.positions[1]"}, color: ["image"])],
        outputs: ["image"]"#,
    );
    let shader = "var<storage, read> one: vec4<f32>;
        @fragment fn fragment() -> @location(0) f32 { return one.x; }";
    let graph = right(load(&files.with("one.wgsl", shader)));
    for (uniform, storage, is_planned) in [(256, 16, true), (16, 256, false)] {
        let mut request = PlanRequest::new([8, 8], &Triangle);
        request.limits.min_uniform_buffer_offset_alignment = uniform;
        request.limits.min_storage_buffer_offset_alignment = storage;
        assert_eq!(
            graph.plan(&request).is_ok(),
            is_planned,
            "{uniform}, {storage}"
        );
    }
}
