//! Answers of a provider's executors after its camera, light or mesh was changed: those that they
//! would give had they been made then.

use crate::support::graphs::{self, open, values};
use glam::{DAffine3, DMat3, DVec3};
use skiagraph_gpu::{Executor, FrameReport, device::Gpu};
use skiagraph_graph::{Graph, LayeredSources, PlanRequest, Sources};
use skiagraph_passes::{EmbeddedSources, How, SceneProvider, registry};
use skiagraph_scene::{DirectionalLight, Movable, Scene, SceneLibrary, View};
use std::sync::Arc;

const VIEWPORT: [u32; 2] = [48, 32];
const PRESETS: [&str; 4] = ["rt", "light_buffer", "crsm", "nsm"];

/// Parts that move: the lamp rigidly, a tree with the wind.
const PARTS: [&str; 2] = ["lamp", "tree 1"];

struct Park {
    scene: Arc<Scene>,
    movable: Movable,
}

impl Park {
    fn new() -> Self {
        let scene = SceneLibrary::default().load("park").unwrap().0;
        let movable = Movable::new(&scene.mesh, &PARTS).unwrap();
        let scene = Arc::new(Scene {
            mesh: movable.rest.clone(),
            ..scene
        });
        Self { scene, movable }
    }

    /// Returns a view that shows both parts or their shadows.
    fn view(&self) -> View {
        View {
            eye: DVec3::new(-10.0, 60.0, 60.0),
            direction: DVec3::new(0.5, -0.7, -0.6),
            ..self.scene.views[0].clone()
        }
    }

    fn provider(&self) -> SceneProvider {
        let mut provider = graphs::provider(&self.scene, &self.view(), VIEWPORT);
        provider.set_parts(self.movable.clone());
        provider
    }

    fn lean(&self, degrees: f64) -> [DAffine3; 2] {
        let lean = degrees.to_radians().tan();
        let along_x = DMat3::from_cols(DVec3::X, DVec3::new(lean, 1.0, 0.0), DVec3::Z);
        [
            DAffine3::from_translation(DVec3::new(degrees, 0.0, -0.5 * degrees)),
            DAffine3::from_mat3(along_x),
        ]
    }
}

fn graph(preset: &str) -> Graph {
    Graph::load(
        &format!("pipelines/{preset}.ron"),
        &registry(),
        &EmbeddedSources,
    )
    .unwrap_or_else(|errors| panic!("{errors}"))
}

fn start(gpu: &Gpu, graph: &Graph, provider: &mut SceneProvider) -> Executor {
    let plan = graph.plan(&PlanRequest::new(VIEWPORT, provider));
    let plan = plan.unwrap_or_else(|errors| panic!("{errors}"));
    Executor::on(gpu, plan, provider).unwrap()
}

fn next(gpu: &Gpu, executor: &mut Executor) -> FrameReport {
    graphs::frame(gpu, executor, &["visibility", "status"])
}

/// Renders with another provider of the same scene, which has changed nothing, and a new executor.
fn anew(gpu: &Gpu, graph: &Graph, provider: &SceneProvider, view: &View) -> FrameReport {
    let scene = Scene {
        lights: vec![skiagraph_scene::Light::only(provider.light())],
        ..(**provider.scene()).clone()
    };
    let mut fresh = graphs::provider(&Arc::new(scene), view, VIEWPORT);
    let mut executor = start(gpu, graph, &mut fresh);
    next(gpu, &mut executor)
}

type Change = (&'static str, fn(&Park, &mut SceneProvider));

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn after_each_change_the_picture_is_a_new_executors() {
    let changes: [Change; 6] = [
        ("light", |_, provider| {
            let light = DirectionalLight::new(DVec3::new(0.3, -0.6, 0.6));
            provider.set_light(light.into());
        }),
        ("camera", |park, provider| {
            let moved = View {
                eye: DVec3::new(-13.0, 58.0, 60.0),
                ..park.view()
            };
            provider.set_camera(&moved.camera(VIEWPORT));
        }),
        ("transforms", |park, provider| {
            let maps = park.lean(4.0);
            provider.set_transforms(&maps).unwrap();
        }),
        ("deformed", |park, provider| {
            let mesh = park.movable.moved(&park.lean(-6.0)).unwrap();
            provider.deform(mesh.positions, mesh.normals).unwrap();
        }),
        ("deformed badly", |park, provider| {
            let bent = park.movable.bent(|_, place| {
                let turned = DMat3::from_rotation_y(0.02 * place.x);
                (turned * place, turned)
            });
            let mesh = bent.unwrap();
            provider.deform(mesh.positions, mesh.normals).unwrap();
        }),
        ("mesh", |park, provider| {
            let mut mesh = park.scene.mesh.clone();
            mesh.triangles.reverse();
            mesh.normal_indices.reverse();
            provider.set_mesh(mesh);
        }),
    ];
    let (gpu, park) = (open(), Park::new());
    for preset in PRESETS {
        let graph = graph(preset);
        let mut provider = park.provider();
        let mut executor = start(&gpu, &graph, &mut provider);
        let mut before = next(&gpu, &mut executor);
        for (name, change) in &changes {
            change(&park, &mut provider);
            executor.refresh(&mut provider).unwrap();
            let view = match *name {
                "light" => park.view(),
                _ => View {
                    eye: DVec3::new(-13.0, 58.0, 60.0),
                    ..park.view()
                },
            };
            let now = next(&gpu, &mut executor);
            let expected = anew(&gpu, &graph, &provider, &view);
            assert!(now.readbacks == expected.readbacks, "{preset}, {name}");
            if *name != "mesh" {
                assert!(
                    now.readbacks != before.readbacks,
                    "{preset}, {name}: no change"
                );
            }
            before = now;
        }
    }
}

#[test]
fn passes_that_read_nothing_of_a_change_are_skipped() {
    let (gpu, park) = (open(), Park::new());
    let graph = graph("nsm");
    let mut provider = park.provider();
    let mut executor = start(&gpu, &graph, &mut provider);
    let of_map = [
        "create_shadow_map.fit_map.over_scene",
        "create_shadow_map.draw[0]",
    ];
    assert_eq!(next(&gpu, &mut executor).skipped, [""; 0]);
    let passes: Vec<String> = executor
        .plan()
        .live()
        .map(|pass| pass.name.value.clone())
        .collect();
    assert_eq!(next(&gpu, &mut executor).skipped, passes);

    // The same again is no change.
    let light = provider.light();
    provider.set_light(light);
    provider.set_view(&park.view(), VIEWPORT);
    executor.refresh(&mut provider).unwrap();
    assert_eq!(next(&gpu, &mut executor).skipped, passes);

    provider.set_camera(&park.scene.views[1].camera(VIEWPORT));
    executor.refresh(&mut provider).unwrap();
    assert_eq!(next(&gpu, &mut executor).skipped, of_map);

    provider.set_transforms(&park.lean(1.0)).unwrap();
    executor.refresh(&mut provider).unwrap();
    assert_eq!(next(&gpu, &mut executor).skipped, [""; 0]);
    assert_eq!(next(&gpu, &mut executor).skipped, passes);
}

#[test]
fn another_provider_is_seen_though_it_has_changed_nothing_itself() {
    let (gpu, park) = (open(), Park::new());
    let graph = graph("nsm");
    let mut executor = start(&gpu, &graph, &mut park.provider());
    next(&gpu, &mut executor);
    let scene = Scene {
        lights: vec![DirectionalLight::new(DVec3::new(0.3, -0.6, 0.6)).into()],
        ..(*park.scene).clone()
    };
    let mut other = graphs::provider(&Arc::new(scene), &park.view(), VIEWPORT);
    executor.refresh(&mut other).unwrap();
    let now = next(&gpu, &mut executor);
    assert_eq!(now.skipped, [""; 0]);
    let expected = anew(&gpu, &graph, &other, &park.view());
    assert!(now.readbacks == expected.readbacks);
}

#[test]
fn only_what_is_read_is_made_and_trees_are_refitted() {
    let (gpu, park) = (open(), Park::new());
    let how = |provider: &SceneProvider, name: &str| {
        let built = provider.built().iter().find(|built| built.name == name);
        built.map(|built| (built.how, built.times))
    };
    for preset in PRESETS.into_iter().chain(["crsma"]) {
        let mut provider = park.provider();
        let mut executor = start(&gpu, &graph(preset), &mut provider);
        let names = |provider: &SceneProvider| -> Vec<&str> {
            provider.built().iter().map(|built| built.name).collect()
        };
        let first = names(&provider);
        for degrees in [1.0, 2.0, 3.0] {
            let maps = park.lean(degrees);
            provider.set_transforms(&maps).unwrap();
            executor.refresh(&mut provider).unwrap();
        }
        assert_eq!(names(&provider), first, "{preset}");
        assert_eq!(how(&provider, "scene.positions"), Some((How::Made, 4)));
        assert_eq!(how(&provider, "scene.indices"), Some((How::Made, 1)));
        // It has parts, so the first tree is kept.
        let traces = !["nsm", "light_buffer"].contains(&preset);
        let expected = traces.then_some((How::Refitted, 4));
        assert_eq!(how(&provider, "scene.bvh_nodes"), expected, "{preset}");
        let adjacency = (preset == "crsma").then_some((How::Made, 1));
        assert_eq!(how(&provider, "scene.adjacency"), adjacency, "{preset}");
    }
}

#[test]
fn a_branch_is_prepared_on_a_thread_while_frames_go_on() {
    let (gpu, park) = (open(), Park::new());
    let graph = graph("rt");
    let mut provider = park.provider();
    let mut executor = start(&gpu, &graph, &mut provider);
    let before = next(&gpu, &mut executor);
    let mut branch = provider.branch();
    let plan = executor.plan();
    let maps = park.lean(5.0);
    std::thread::scope(|scope| {
        let (branch, gpu) = (&mut branch, &gpu);
        scope.spawn(move || {
            branch.set_transforms(&maps).unwrap();
            branch.prepare(plan, &gpu.device, &gpu.queue).unwrap();
        });
    });
    executor.refresh(&mut provider).unwrap();
    assert!(next(&gpu, &mut executor).readbacks == before.readbacks);

    let made = branch.built().to_vec();
    executor.refresh(&mut branch).unwrap();
    assert_eq!(branch.built(), made, "nothing was left to make");
    let indices = made.iter().find(|built| built.name == "scene.indices");
    assert_eq!(indices.unwrap().times, 1, "shared with the one before");
    let now = next(&gpu, &mut executor);
    let expected = anew(&gpu, &graph, &branch, &park.view());
    assert!(now.readbacks == expected.readbacks && now.readbacks != before.readbacks);
}

#[test]
fn what_does_not_fit_the_mesh_is_refused() {
    let (gpu, park) = (open(), Park::new());
    let mut provider = park.provider();
    let mut executor = start(&gpu, &graph("nsm"), &mut provider);
    let error = provider.deform(vec![], vec![]).unwrap_err().to_string();
    assert!(error.contains("`set_mesh`"), "{error}");
    let rest = &park.movable.rest;
    let (mut positions, normals) = (rest.positions.clone(), rest.normals.clone());
    positions[3].y = f32::NAN;
    let error = provider.deform(positions, normals).unwrap_err().to_string();
    assert!(error.contains("position 3 of the mesh is ["), "{error}");

    let mut mesh = park.scene.mesh.clone();
    mesh.triangles.pop();
    mesh.normal_indices.pop();
    // One triangle less is planned for.
    provider.set_mesh(mesh);
    executor.refresh(&mut provider).unwrap();
    let shown = |executor: &mut Executor| {
        values(
            &graphs::frame(&gpu, executor, &["visibility"]),
            "visibility",
        )
    };
    let seen = shown(&mut executor);
    assert!(seen == shown(&mut start(&gpu, &graph("nsm"), &mut provider)));

    let twice = Movable::new(&park.scene.mesh, &["tree 1", "tree 2", "tree 1"]).unwrap_err();
    assert_eq!(twice, "the part `tree 1` is given twice");
    let unknown = Movable::new(&park.scene.mesh, &["tree 3"]).unwrap_err();
    assert!(
        unknown.contains("\"tree 3\"") && unknown.contains("tree 2"),
        "{unknown}"
    );
}

/// A document that writes down the flags of `frame`, and reads nothing of the scene.
struct Flags;

impl Sources for Flags {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        let text = match path {
            "flags.ron" => {
                r#"(
                    format: 3,
                    materials: [Buffer(name: "flags", count: 2)],
                    passes: [Compute(name: "tell", dispatch: Groups(1, 1, 1))],
                    outputs: ["flags"],
                )"#
            }
            "tell.wgsl" => {
                r#"
                #import "shared/frame.wgsl"
                var<storage, read_write> flags: array<u32>;
                @compute @workgroup_size(1) fn main() {
                    flags[0] = frame.changed_scene;
                    flags[1] = frame.changed_light;
                }"#
            }
            _ => return Ok(None),
        };
        Ok(Some(text.into()))
    }

    fn list(&self, _: &str) -> Vec<String> {
        Vec::new()
    }
}

/// The light is laid around the mesh, so it changes with it.
#[test]
fn shaders_are_told_what_has_changed_though_no_pass_reads_it() {
    let (gpu, park) = (open(), Park::new());
    let sources = LayeredSources(vec![Box::new(Flags), Box::new(EmbeddedSources)]);
    let graph =
        Graph::load("flags.ron", &registry(), &sources).unwrap_or_else(|errors| panic!("{errors}"));
    let mut provider = park.provider();
    let mut executor = start(&gpu, &graph, &mut provider);
    let mut expect = |provider: &mut SceneProvider, flags: [u32; 2], when: &str| {
        executor.refresh(provider).unwrap();
        let report = graphs::frame(&gpu, &mut executor, &["flags"]);
        let words = report.readbacks[0].content.as_u32().unwrap();
        assert_eq!(words, flags, "{when}");
    };
    expect(&mut provider, [1, 1], "the first frame");
    expect(&mut provider, [0, 0], "nothing changed");
    provider.set_camera(&park.scene.views[1].camera(VIEWPORT));
    expect(&mut provider, [0, 0], "the camera");
    provider.set_light(DirectionalLight::new(DVec3::new(0.3, -0.6, 0.6)).into());
    expect(&mut provider, [0, 1], "the light");
    provider.set_transforms(&park.lean(2.0)).unwrap();
    expect(&mut provider, [1, 1], "the mesh");
    expect(&mut provider, [0, 0], "nothing changed");
}
