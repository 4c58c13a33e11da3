//! Checks that the README's commands and code work as they stand there, and that what pages name is
//! there.

use crate::support::graphs::{frame, open, provider};
use skiagraph_gpu::{Executor, Frame};
use skiagraph_graph::{FolderSources, Graph, LayeredSources, PlanRequest, Sources};
use skiagraph_passes::{EmbeddedSources, SceneProvider, registry};
use skiagraph_scene::{SceneFile, SceneLibrary};
use std::{collections::VecDeque, fs, path::Path, sync::Arc};

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// The code blocks of that language.
fn blocks<const COUNT: usize>(language: &str) -> [String; COUNT] {
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    let opening = format!("```{language}\n");
    let blocks = readme.split(&opening).skip(1);
    let blocks = blocks.map(|block| block.split("```").next().unwrap().to_owned());
    let blocks: Vec<String> = blocks.collect();
    blocks
        .try_into()
        .unwrap_or_else(|blocks| panic!("blocks of {language}: {blocks:?}"))
}

#[test]
fn the_method_of_the_readme_is_complete_and_runs() {
    let folder = tempfile::tempdir().unwrap();
    let [facing] = blocks("ron");
    let [shader] = blocks("wgsl");
    fs::write(folder.path().join("facing.ron"), facing).unwrap();
    fs::write(folder.path().join("facing.wgsl"), shader).unwrap();
    let own = FolderSources {
        root: folder.path().to_owned(),
    };
    let sources = LayeredSources(vec![Box::new(own), Box::new(EmbeddedSources)]);
    let graph =
        Graph::load("facing.ron", &registry(), &sources).unwrap_or_else(|error| panic!("{error}"));
    assert!(graph.warnings().is_empty(), "{:?}", graph.warnings());

    let (scene, _) = SceneLibrary::default().load("park").unwrap();
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

    let gpu = open();
    let mut executor = Executor::new(&gpu.device, &gpu.queue, plan, &mut provider).unwrap();
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    executor
        .encode(
            &mut encoder,
            &Frame::new().with_read(&["visibility", "status"]),
        )
        .unwrap();
    gpu.queue.submit([encoder.finish()]);
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

/// Every piece of Rust in it stands word for word, in one piece, in code that the tests or
/// `.ci/run` run.
#[test]
fn the_rust_of_the_documents_is_code_that_runs() {
    let read = |path: &str| fs::read_to_string(root().join(path)).unwrap();
    let bare = |text: &str| -> Vec<String> {
        let lines = text.lines().map(str::trim);
        let lines = lines.filter(|line| !line.is_empty());
        lines.map(str::to_owned).collect()
    };
    let running = [
        "crates/compare/tests/it/engine.rs",
        "crates/gpu/examples/embed.rs",
        "crates/gpu/examples/custom_pass.rs",
        "crates/gpu/tests/it/embedding.rs",
        "crates/gpu/tests/it/pipelines.rs",
        "crates/passes/examples/preset/shadows.rs",
        "tests/it/host.rs",
        "tests/it/host_buffers.rs",
        "tests/it/moved_device.rs",
        "tests/it/moving.rs",
        "tests/it/unit_visibility.rs",
        "tests/it/views.rs",
    ]
    .map(|path| bare(&read(path)));
    for (document, least) in [("README.md", 2), ("docs/embedding.md", 16)] {
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

/// The documents of the authoring guide in their order, as it calls them, with their passes.
const DOCUMENTS: [(&str, usize); 16] = [
    ("depth.ron", 2),
    ("blur.ron", 2),
    ("halvings.ron", 65),
    ("cascades.ron", 5),
    ("softer.ron", 22),
    ("darkened.ron", 8),
    ("extended.ron", 4),
    ("history.ron", 1),
    ("age.ron", 4),
    ("bands.ron", 4),
    ("kept.ron", 1),
    ("settled.ron", 1),
    ("works.ron", 11),
    ("filtered.ron", 7),
    ("every_light.ron", 9),
    ("claims.ron", 7),
];

/// Every document of the authoring guide, as a file beside the shaders that it shows.
#[test]
fn the_documents_of_the_authoring_guide_are_right() {
    let guide = fs::read_to_string(root().join("docs/authoring.md")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    // A block of WGSL is the file that the prose before it names.
    let (mut names, mut documents) = (VecDeque::new(), Vec::new());
    for (at, part) in guide.split("```").enumerate() {
        if at % 2 == 0 {
            let shown = part
                .lines()
                .filter(|line| ["with `", "and `"].iter().any(|w| line.starts_with(w)));
            names.extend(
                shown
                    .flat_map(|line| line.split('`'))
                    .filter(|word| word.ends_with(".wgsl")),
            );
        } else if let Some(text) = part.strip_prefix("wgsl\n") {
            let name = names.pop_front().expect("the guide names its shaders");
            fs::write(folder.path().join(name), text).unwrap();
        } else if let Some(text) = part.strip_prefix("ron\n") {
            assert!(text.starts_with("(\n    format: 3,"), "{text}");
            documents.push(text);
        }
    }
    assert!(names.is_empty(), "named and not shown: {names:?}");
    assert_eq!(documents.len(), DOCUMENTS.len());
    for ((name, _), text) in DOCUMENTS.iter().zip(documents) {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let own = FolderSources {
        root: folder.path().to_owned(),
    };
    let sources = LayeredSources(vec![Box::new(own), Box::new(EmbeddedSources)]);
    let (scene, _) = SceneLibrary::default().load("park").unwrap();
    let scene = Arc::new(scene);
    let provider = provider(&scene, &scene.views[0], [64, 64]);
    for (name, passes) in DOCUMENTS {
        let request = PlanRequest::new([64, 64], &provider);
        let (graph, plan) = Graph::check(name, &registry(), &sources, &request)
            .unwrap_or_else(|errors| panic!("{errors}"));
        let warnings: Vec<_> = graph.warnings().iter().chain(plan.warnings()).collect();
        assert!(warnings.is_empty(), "{name}: {warnings:?}");
        let planned = plan.passes().len() + plan.culled().len();
        assert_eq!(planned, passes, "{name}");
    }
    runs_without_words(&sources, provider);
}

/// The document of what needs no word of its own, in its second frame: nothing has moved, and every
/// receiver is where the frame before has found it.
fn runs_without_words(sources: &dyn Sources, mut provider: SceneProvider) {
    let gpu = open();
    let request = PlanRequest::new([64, 64], &provider);
    let request = request.with_device(gpu.device.limits(), gpu.device.features());
    let graph = Graph::load("works.ron", &registry(), sources).unwrap();
    let plan = graph.plan(&request).unwrap();
    let mut executor = Executor::on(&gpu, plan, &mut provider).unwrap();
    frame(&gpu, &mut executor, &[]);
    let report = frame(&gpu, &mut executor, &["seen_again"]);
    let texels = report.readbacks[0].content.as_f32().unwrap();
    let drawn: Vec<&[f32]> = texels.chunks(4).filter(|texel| texel[1] > 0.0).collect();
    assert!(drawn.len() > 1000, "{}", drawn.len());
    for texel in &drawn {
        assert!(texel[0] == 0.0 && texel[2].abs() <= 1.0, "{texel:?}");
    }
    // The second camera has drawn, and the cube is read in several directions.
    let seen = drawn.iter().filter(|texel| texel[3] > 0.0).count();
    assert!(seen > 100, "{seen}");
}

/// The scene file that the page shows is one.
#[test]
fn the_scene_file_of_the_docs_is_right() {
    let page = fs::read_to_string(root().join("docs/scenes.md")).unwrap();
    let text = page.split("```ron\n").nth(1).expect("it shows one");
    let text = text.split("```").next().unwrap();
    let scene = SceneFile::parse(text, "docs/scenes.md").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((scene.lights.len(), scene.views.len()), (3, 1));
}

/// Files, test binaries, benchmarks and examples that a page names, and that are not there.
fn missing(page: &str, files: &[String]) -> Vec<String> {
    let text = fs::read_to_string(root().join(page)).unwrap();
    let is_there = |path: &str| {
        let end = format!("/{path}");
        files
            .iter()
            .any(|file| file == path || file.ends_with(&end))
    };
    let quoted = text.split('`').skip(1).step_by(2);
    let quoted = quoted.map(|word| word.trim_start_matches("./"));
    let paths = quoted.filter(|word| {
        let kinds = [".rs", ".py", ".sh", ".wgsl", ".csv"];
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "._/-".contains(c);
        word.contains('/') && word.chars().all(is_plain) && kinds.iter().any(|k| word.ends_with(k))
    });
    let mut missing: Vec<String> = paths
        .filter(|path| !is_there(path))
        .map(str::to_owned)
        .collect();
    let manifests = files.iter().filter(|file| file.ends_with("Cargo.toml"));
    let manifests: Vec<String> = manifests
        .map(|file| fs::read_to_string(root().join(file)).unwrap())
        .collect();
    for (option, folder) in [
        ("test", "tests"),
        ("bench", "benches"),
        ("example", "examples"),
    ] {
        let option_text = format!("--{option} ");
        let named = text.split(&option_text).skip(1);
        let names = named.map(|rest| {
            let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_' && c != '-');
            &rest[..end.unwrap_or(rest.len())]
        });
        missing.extend(names.filter_map(|name| {
            let is_declared = manifests
                .iter()
                .any(|m| m.contains(&format!("name = \"{name}\"")));
            let is_file = is_there(&format!("{folder}/{name}.rs"))
                || is_there(&format!("{folder}/{name}/main.rs"));
            (!name.is_empty() && !is_declared && !is_file).then(|| format!("--{option} {name}"))
        }));
    }
    missing
}

#[test]
fn what_the_pages_point_at_is_there() {
    let mut files = Vec::new();
    let mut folders = vec![root().to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_str().unwrap();
            if path.is_dir() && !["target", ".git", "out", "node_modules"].contains(&name) {
                folders.push(path);
            } else if path.is_file() {
                let path = path.strip_prefix(root()).unwrap();
                files.push(path.to_str().unwrap().replace('\\', "/"));
            }
        }
    }
    let is_page = |file: &&String| {
        let is_written = !["docs/diagnostics.md", "docs/reference.md"].contains(&file.as_str());
        let is_ours = ["README.md", "CONTRIBUTING.md"].contains(&file.as_str());
        is_written && (is_ours || file.starts_with("docs/") && file.ends_with(".md"))
    };
    let pages: Vec<&String> = files.iter().filter(is_page).collect();
    assert!(pages.len() > 30, "{pages:?}");
    let missing: Vec<(&String, Vec<String>)> = pages
        .into_iter()
        .map(|page| (page, missing(page, &files)))
        .filter(|(_, missing)| !missing.is_empty())
        .collect();
    assert!(missing.is_empty(), "{missing:#?}");
}

/// Lights of `park_soft`, as docs/tutorial.md tells them.
#[test]
fn the_tutorials_suns_are_as_wide_as_it_says() {
    let (scene, _) = SceneLibrary::default().load("park_soft").unwrap();
    let wide = scene.views.iter().filter(|view| view.light.is_some());
    let wide: Vec<&str> = wide.map(|view| view.name.as_str()).collect();
    assert_eq!(wide, ["bench_wide", "flowers_wide", "trees_wide"]);
    let file = include_str!("../../scenes/park_soft.ron");
    let wide_suns = file.matches("angle_degrees: 5)").count();
    assert_eq!(
        (file.matches("angle_degrees: 0.53").count(), wide_suns),
        (1, 4),
        "three views and a path"
    );
    let tutorial = fs::read_to_string(root().join("docs/tutorial.md")).unwrap();
    let tutorial: Vec<&str> = tutorial.split_whitespace().collect();
    let says = "a sun of half a degree and, in the views called wide, one of five";
    assert!(tutorial.join(" ").contains(says));
}
