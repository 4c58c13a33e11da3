//! What the README tells its readers to type works as it stands there.

use skiagraph_graph::{Executor, FolderSources, Frame, Graph, LayeredSources, PlanRequest, gpu};
use skiagraph_passes::{EmbeddedSources, SceneProvider, registry};
use skiagraph_scene::{SceneLibrary, SceneRequest};
use std::{fs, path::Path, sync::Arc};

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// The only code block of that language.
fn block(language: &str) -> String {
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    let opening = format!("```{language}\n");
    let mut blocks = readme.split(&opening).skip(1);
    let block = blocks
        .next()
        .unwrap_or_else(|| panic!("no {language} block in the README"));
    assert!(
        blocks.next().is_none(),
        "two {language} blocks in the README"
    );
    block.split("```").next().unwrap().to_owned()
}

#[test]
fn the_method_of_the_readme_is_complete_and_runs() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("facing.ron"), block("ron")).unwrap();
    fs::write(folder.path().join("facing.wgsl"), block("wgsl")).unwrap();
    let own = FolderSources {
        root: folder.path().to_owned(),
    };
    let sources = LayeredSources(vec![Box::new(own), Box::new(EmbeddedSources)]);
    let graph =
        Graph::load("facing.ron", &registry(), &sources).unwrap_or_else(|error| panic!("{error}"));
    assert!(graph.warnings().is_empty(), "{:?}", graph.warnings());

    let request = SceneRequest {
        argument: "park".to_owned(),
        obj: None,
    };
    let (scene, _) = SceneLibrary::default().load(&request).unwrap();
    let scene = Arc::new(scene);
    let viewport = [64, 64];
    let mut provider = SceneProvider::new(Arc::clone(&scene));
    provider.set_view(&scene.views[0], viewport);
    let plan = graph
        .plan(&PlanRequest::new(viewport, &provider))
        .unwrap_or_else(|error| panic!("{error}"));
    assert!(
        !plan.provided().iter().any(|name| name.contains("bvh")),
        "nothing here traces rays"
    );

    let gpu = gpu::open(None).unwrap_or_else(|error| panic!("{error}"));
    let mut executor = Executor::new(&gpu.device, &gpu.queue, plan, &mut provider).unwrap();
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    executor
        .encode(
            &mut encoder,
            &Frame {
                timing: false,
                read: &["visibility", "status"],
                ..Frame::default()
            },
        )
        .unwrap();
    gpu.queue.submit([encoder.finish()]);
    executor.submitted(&gpu.queue).unwrap();
    let report = executor.finish().unwrap();
    let values = |index: usize| report.readbacks[index].content.as_u32().unwrap();
    for (visibility, status) in values(0).into_iter().zip(values(1)) {
        assert_eq!(
            visibility,
            u32::from(status != 1),
            "lit is what faces the light"
        );
    }
    assert!(values(1).contains(&1) && values(1).contains(&2));
}

/// What is shown as Rust stands word for word, in one piece, in code that the tests or `.ci/run` run.
#[test]
fn the_rust_of_the_documents_is_code_that_runs() {
    let read = |path: &str| fs::read_to_string(root().join(path)).unwrap();
    let bare = |text: &str| -> Vec<String> {
        let lines = text.lines().map(str::trim);
        let lines = lines.filter(|line| !line.is_empty());
        lines.map(str::to_owned).collect()
    };
    let running = [
        "crates/graph/examples/embed.rs",
        "crates/graph/examples/custom_pass.rs",
        "crates/graph/tests/embedding.rs",
    ]
    .map(|path| bare(&read(path)));
    for (document, least) in [("README.md", 2), ("docs/embedding.md", 15)] {
        let text = read(document);
        let blocks: Vec<&str> = text.split("```rust\n").skip(1).collect();
        assert!(blocks.len() >= least, "{document}: {} blocks", blocks.len());
        for block in blocks {
            let block = bare(block.split("```").next().unwrap());
            let stands = |file: &Vec<String>| file.windows(block.len()).any(|lines| lines == block);
            assert!(
                !block.is_empty() && running.iter().any(stands),
                "{document} shows what nobody runs:\n{}",
                block.join("\n")
            );
        }
    }
}

/// Every document of the authoring guide, as a file beside the shaders that it speaks of.
#[test]
fn the_documents_of_the_authoring_guide_are_right() {
    const LEVEL: &str = "struct Params { value: f32 } var<uniform> params: Params;
        @fragment fn fragment() -> @location(0) f32 { return params.value; }";
    const FACING: &str = "var position: texture_2d<f32>;
        var visibility: texture_storage_2d<r32uint, write>;
        var status: texture_storage_2d<r32uint, write>;
        @compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
            let lit = u32(textureLoad(position, id.xy, 0).w > 0.0);
            textureStore(visibility, id.xy, vec4(lit));
            textureStore(status, id.xy, vec4(1u + lit));
        }";
    let guide = fs::read_to_string(root().join("docs/authoring.md")).unwrap();
    let blocks: Vec<&str> = guide
        .split("```ron\n")
        .skip(1)
        .filter_map(|rest| rest.split("```").next())
        // Others are parts of documents.
        .filter(|block| block.starts_with("(\n    format: 1,"))
        .collect();
    let level = blocks
        .iter()
        .find(|block| block.contains("name: \"image\")],\n)") && !block.contains("requires"))
        .expect("the guide shows level.ron");
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("level.ron"), level).unwrap();
    fs::write(folder.path().join("level.wgsl"), LEVEL).unwrap();
    fs::write(folder.path().join("facing.wgsl"), FACING).unwrap();
    let blend = guide
        .split("```wgsl\n")
        .nth(1)
        .and_then(|rest| rest.split("```").next());
    fs::write(
        folder.path().join("blend.wgsl"),
        blend.expect("the guide shows blend.wgsl"),
    )
    .unwrap();
    let own = FolderSources {
        root: folder.path().to_owned(),
    };
    let sources = LayeredSources(vec![Box::new(own), Box::new(EmbeddedSources)]);
    let request = SceneRequest {
        argument: "park".to_owned(),
        obj: None,
    };
    let (scene, _) = SceneLibrary::default().load(&request).unwrap();
    let provider = SceneProvider::new(Arc::new(scene));
    let mut passes = Vec::new();
    for (number, block) in blocks.iter().enumerate() {
        let path = format!("block{number}.ron");
        fs::write(folder.path().join(&path), block).unwrap();
        let request = PlanRequest::new([64, 64], &provider);
        let (graph, plan) = Graph::check(&path, &registry(), &sources, &request)
            .unwrap_or_else(|errors| panic!("{errors}"));
        assert!(graph.warnings().is_empty(), "{:?}", graph.warnings());
        let lacking = usize::from(!graph.features().is_empty());
        assert_eq!(plan.fallbacks().len(), lacking);
        assert_eq!(plan.warnings().len(), lacking, "{:?}", plan.warnings());
        passes.push(plan.passes().len() + plan.culled().len());
    }
    assert_eq!(passes, [1, 3, 3, 1, 8, 1]);
}
