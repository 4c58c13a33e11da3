//! Entries of the fuzz targets and of their stable twin (`tests/it/hostile.rs`): bytes in, an
//! answer out, and no panic on the way.

use skiagraph_draw::{from_plan, to_svg};
use skiagraph_graph::{
    Code, Describe, Diagnostics, Graph, Plan, PlanRequest, Provided, ProvidedBinding, Registry,
    Sources,
};
use skiagraph_scene::{Adjacency, Bvh, ObjOptions, QuadDiagonal, SceneFile, obj::parse_obj};
use std::{path::Path, sync::Arc};

/// The bytes as a document, loaded, checked, written out and planned beside a few shaders and
/// sub-graphs. Returns what its author reads; empty if nothing is wrong.
pub fn document(bytes: &[u8]) -> String {
    let files = Files {
        path: "graph.ron",
        bytes,
    };
    let flat = Graph::flat("graph.ron", &Registry::standard(), &files);
    let request = PlanRequest::new([33, 17], &SmallScene);
    match Graph::check("graph.ron", &Registry::standard(), &files, &request) {
        Err(errors) => said(&errors),
        Ok((_, plan)) => {
            assert!(
                flat.is_ok(),
                "a document that can be planned can be written out"
            );
            use_up(&plan)
        }
    }
}

/// The bytes as the shader of all three kinds of programs in a fixed graph. Returns as [`document`]
/// does.
pub fn wgsl(bytes: &[u8]) -> String {
    let files = Files {
        path: "shaders/fuzzed.wgsl",
        bytes,
    };
    let request = PlanRequest::new([33, 17], &SmallScene);
    match Graph::check(
        "pipelines/fixed.ron",
        &Registry::standard(),
        &files,
        &request,
    ) {
        Err(errors) => said(&errors),
        Ok((_, plan)) => use_up(&plan),
    }
}

/// The bytes as an OBJ file, and as a scene file. Returns what is wrong with them as either.
pub fn scene(bytes: &[u8]) -> String {
    let mut answer = String::new();
    for quads in [QuadDiagonal::FirstThird, QuadDiagonal::SecondFourth] {
        let options = ObjOptions {
            quads,
            ..ObjOptions::default()
        };
        match parse_obj(bytes, Path::new("house.obj"), &options) {
            Err(error) => answer = error.to_string(),
            Ok((mesh, report)) => {
                let _ = report.to_string();
                assert!(!mesh.triangles.is_empty() && mesh.bounds().is_some());
                assert_eq!(mesh.triangles.len(), mesh.normal_indices.len());
                assert!(mesh.positions.iter().all(|position| position.is_finite()));
                assert!(mesh.normals.iter().all(|normal| normal.is_normalized()));
                let within = |indices: &[[u32; 3]], count| {
                    indices
                        .iter()
                        .flatten()
                        .all(|&index| (index as usize) < count)
                };
                assert!(within(&mesh.triangles, mesh.positions.len()));
                assert!(within(&mesh.normal_indices, mesh.normals.len()));
                let bvh = Bvh::build(&mesh);
                assert_eq!(bvh.primitives.len(), mesh.triangles.len());
                assert_eq!(
                    Adjacency::new(&mesh).opposite.len(),
                    3 * mesh.triangles.len()
                );
            }
        }
    }
    match std::str::from_utf8(bytes).map(|text| SceneFile::parse(text, "house.ron")) {
        Err(_) => {}
        Ok(Err(error)) => answer.push_str(&format!("\n{error}")),
        Ok(Ok(scene)) => {
            for view in &scene.views {
                let camera = view.camera([640, 480]);
                let frame = [camera.right, camera.up, camera.forward];
                assert!(frame.iter().all(|axis| axis.is_normalized()), "{view:?}");
                assert!(camera.view_projection().as_mat4().is_finite(), "{view:?}");
            }
            assert!(scene.lights.iter().all(|light| light.check().is_ok()));
        }
    }
    answer
}

/// The fault of a graph. A panic that was caught is naga's, which has some; one of ours is a
/// finding.
fn said(errors: &Diagnostics) -> String {
    for error in errors
        .iter()
        .filter(|error| error.code == Code::LibraryPanic)
    {
        let help = error.help.as_deref().unwrap_or_default();
        assert!(help.contains("(naga-"), "{}: {help}", error.message);
    }
    errors.to_string()
}

/// Everything that a plan tells without a GPU.
fn use_up(plan: &Plan) -> String {
    assert!(plan.memory_bytes() >= plan.saved_bytes());
    let _ = (plan.passes(), plan.culled(), plan.outputs(), plan.memory());
    let _ = to_svg(&from_plan(plan));
    String::new()
}

/// Files in memory: those of [`SHELF`], and the bytes under their path.
struct Files<'a> {
    path: &'static str,
    bytes: &'a [u8],
}

impl Sources for Files<'_> {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        if path == self.path {
            let text = std::str::from_utf8(self.bytes);
            return match text {
                Ok(text) => Ok(Some(text.into())),
                Err(_) => Err("it is not UTF-8 text".to_owned()),
            };
        }
        let entry = SHELF.iter().find(|(name, _)| *name == path);
        Ok(entry.map(|(_, text)| (*text).into()))
    }

    fn list(&self, folder: &str) -> Vec<String> {
        let inside = |path: &str| {
            let (parent, name) = path.rsplit_once('/').unwrap_or(("", path));
            (parent == folder).then(|| name.to_owned())
        };
        let paths = SHELF.iter().map(|(path, _)| *path).chain([self.path]);
        paths.filter_map(inside).collect()
    }
}

/// Files that documents and shaders find beside them.
const SHELF: &[(&str, &str)] = &[
    (
        "pipelines/fixed.ron",
        r#"(
    format: 3,
    params: [
        U32(name: "edge", default: 16, min: 1, max: 64),
        F32(name: "bias", default: 0.5),
        Vec3(name: "sun", default: (0, 1, 0)),
        Choice(name: "cull", words: [none, front, back], default: front),
    ],
    materials: [
        Texture(name: "image", format: Rgba32Float),
        Texture(name: "number", format: R32Uint),
        Texture(name: "depth", format: Depth32Float, size: "edge"),
        Texture(name: "layers", format: R32Float, size: 8, layers: 6, mips: 2),
        Buffer(name: "items", count: 64),
        Buffer(name: "total"),
        Sampler(name: "nearest"),
        Sampler(name: "compared", compare: Less),
    ],
    passes: [
        Clear(name: "reset", target: "total"),
        Clear(name: "blank", target: "layers"),
        Compute(name: "compute", shader: "fuzzed", dispatch: Over("number.size")),
        Raster(
            name: "raster", shader: "fuzzed", draw: "scene.indices.count", cull: "cull",
            depth: (target: "depth", load: Clear(1.0), compare: Less),
        ),
        Fullscreen(name: "fullscreen", shader: "fuzzed", color: ["image"]),
    ],
    outputs: ["image", "number", "depth", "items", "total"],
)"#,
    ),
    (
        "pipelines/shared/half.ron",
        r#"(
    format: 3,
    params: [U32(name: "factor", default: 2, min: 1)],
    materials: [
        Texture(name: "half", format: Rgba32Float, size: "ceil_div(viewport.size, factor)"),
    ],
    passes: [Fullscreen(name: "halve", shader: "fill", color: ["half"])],
    outputs: ["half"],
)"#,
    ),
    (
        "pipelines/shared/twice.ron",
        r#"(
    format: 3,
    passes: [
        Include(graph: "shared/half.ron", name: "left"),
        Include(graph: "shared/half.ron", name: "right", set: {"factor": 4}),
    ],
    outputs: [(name: "first", material: "left.half"), (name: "second", material: "right.half")],
)"#,
    ),
    (
        "shaders/fill.wgsl",
        "@fragment fn fragment(@builtin(position) place: vec4<f32>) -> @location(0) vec4<f32> { \
         return place; }\n",
    ),
    (
        "shaders/index.wgsl",
        "var<storage, read_write> items: array<u32>;\n\
         @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {\n    \
         items[id.x] = id.x;\n}\n",
    ),
    (
        "shaders/draw.wgsl",
        "#import \"shared/scene.wgsl\"\n\
         @vertex fn vertex(@builtin(vertex_index) index: u32) \
         -> @builtin(position) vec4<f32> {\n    \
         return camera * corner(index);\n}\n",
    ),
    (
        "shaders/blur.wgsl",
        "struct Params { factor: f32 }\nvar<uniform> params: Params;\nvar image: \
         texture_2d<f32>;\nvar nearest: sampler;\n\
         @fragment fn fragment(@builtin(position) place: vec4<f32>) -> @location(0) vec4<f32> \
         {\n    return params.factor * textureSampleLevel(image, nearest, place.xy, 0.0);\n}\n",
    ),
    (
        "shaders/shared/scene.wgsl",
        "var<storage, read> scene_positions: array<vec4<f32>>;\nvar<storage, read> scene_indices: \
         array<u32>;\n\
         var<uniform> camera: mat4x4<f32>;\n\
         fn corner(index: u32) -> vec4<f32> { return scene_positions[scene_indices[index]]; }\n",
    ),
];

/// Describes a scene of one triangle.
struct SmallScene;

impl Describe for SmallScene {
    fn names(&self) -> Vec<String> {
        ["scene.positions", "scene.indices", "camera"]
            .map(str::to_owned)
            .to_vec()
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        let (items, stride, binding) = match name {
            "scene.positions" => (3, 16, ProvidedBinding::Storage),
            "scene.indices" => (3, 4, ProvidedBinding::Storage),
            "camera" => (1, 64, ProvidedBinding::Uniform),
            _ => return None,
        };
        Some(Provided::new(binding, Some(items), stride))
    }
}
