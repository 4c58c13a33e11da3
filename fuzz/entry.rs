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
    let answer = checked("graph.ron", &files);
    // One that can be planned can be written out.
    assert!(flat.is_ok() || !answer.is_empty());
    answer
}

/// The bytes as the shader of all three kinds of programs in a fixed graph. Returns as [`document`]
/// does.
pub fn wgsl(bytes: &[u8]) -> String {
    let files = Files {
        path: "shaders/fuzzed.wgsl",
        bytes,
    };
    checked("pipelines/fixed.ron", &files)
}

/// Loads, checks and plans a document. Returns what its author reads; empty if nothing is wrong.
fn checked(path: &str, files: &Files<'_>) -> String {
    let request = PlanRequest::new([33, 17], &SmallScene);
    match Graph::check(path, &Registry::standard(), files, &request) {
        Err(errors) => said(&errors),
        Ok((_, plan)) => {
            use_up(&plan);
            String::new()
        }
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
                    let mut indices = indices.as_flattened().iter();
                    indices.all(|&index| (index as usize) < count)
                };
                assert!(within(&mesh.triangles, mesh.positions.len()));
                assert!(within(&mesh.normal_indices, mesh.normals.len()));
                let bvh = Bvh::build(&mesh);
                assert_eq!(bvh.primitives.len(), mesh.triangles.len());
                let opposite = Adjacency::new(&mesh).opposite;
                assert_eq!(opposite.len(), 3 * mesh.triangles.len());
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
    let panics = errors.iter();
    for error in panics.filter(|error| error.code == Code::LibraryPanic) {
        let help = error.help.as_deref().unwrap_or_default();
        assert!(help.contains("(naga-"), "{}: {help}", error.message);
    }
    errors.to_string()
}

/// Everything that a plan tells without a GPU.
fn use_up(plan: &Plan) {
    assert!(plan.memory_bytes() >= plan.saved_bytes());
    let _ = (plan.passes(), plan.culled(), plan.outputs(), plan.memory());
    let _ = to_svg(&from_plan(plan));
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
            let text = text.map_err(|_| "it is not UTF-8 text".to_owned())?;
            return Ok(Some(text.into()));
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

/// Makes a list of the files on the shelf, each with its path and text.
macro_rules! shelf {
    ($($path:literal),+ $(,)?) => {
        &[$(($path, include_str!(concat!("shelf/", $path)))),+]
    };
}

/// Files that documents and shaders find beside them.
const SHELF: &[(&str, &str)] = shelf![
    "pipelines/fixed.ron",
    "pipelines/shared/half.ron",
    "pipelines/shared/twice.ron",
    "shaders/fill.wgsl",
    "shaders/index.wgsl",
    "shaders/draw.wgsl",
    "shaders/blur.wgsl",
    "shaders/shared/scene.wgsl",
];

/// Describes a scene of one triangle.
struct SmallScene;

impl Describe for SmallScene {
    fn names(&self) -> Vec<String> {
        let names = ["scene.positions", "scene.indices", "camera"];
        names.map(str::to_owned).into()
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
