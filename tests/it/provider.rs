//! Resources that the provider describes and builds, and those that it refuses.

use crate::support::{
    graphs::{self, open},
    meshes,
};
use glam::DVec3;
use skiagraph_gpu::{Executor, Provider, device::Gpu};
use skiagraph_graph::{
    Describe, Graph, LayeredSources, ParamValue, PlanRequest, Provided, ProvidedBinding, Sources,
};
use skiagraph_passes::{EmbeddedSources, SceneProvider, registry};
use skiagraph_scene::{
    DirectionalLight, Light, LightKind, Mesh, Scene, SceneLibrary, SpotLight, View,
};
use std::sync::Arc;

fn provider(mesh: Mesh) -> SceneProvider {
    let light = DirectionalLight::new(DVec3::NEG_Y);
    SceneProvider::new(Arc::new(Scene {
        name: "test".into(),
        mesh,
        views: vec![],
        lights: vec![light.into()],
    }))
}

fn build(provider: &mut SceneProvider, gpu: &Gpu, name: &str) -> Result<wgpu::Buffer, String> {
    provider
        .build(name, &gpu.device, &gpu.queue)
        .map_err(|error| error.to_string())
}

/// All names but that of the acceleration structure.
fn buffers(provider: &SceneProvider) -> Vec<String> {
    let mut names = provider.names();
    names.retain(|name| provider.describe(name) != Some(Provided::ACCELERATION_STRUCTURE));
    assert_eq!(names.len() + 1, provider.names().len());
    names
}

#[test]
fn buffers_are_as_large_as_described() {
    let gpu = open();
    for mesh in [meshes::soup(50, 0.2, 1), meshes::foliage(50, 0.2, 2.0, 1)] {
        let mut provider = provider(mesh);
        for name in buffers(&provider) {
            let described = provider.describe(&name).unwrap();
            let size = build(&mut provider, &gpu, &name).unwrap().size();
            match described.items {
                // A buffer without items is one zero item.
                Some(items) => assert_eq!(size, items.max(1) * described.stride, "{name}"),
                None => assert_eq!(size % described.stride, 0, "{name}"),
            }
            let is_uniform = described.binding == ProvidedBinding::Uniform;
            let is_array =
                name.starts_with("scene.") || ["lights", "light_areas"].contains(&&*name);
            assert_eq!(is_uniform, !is_array, "{name}");
        }
    }
}

#[test]
fn an_empty_scene_has_nothing_to_draw_and_something_to_bind() {
    let gpu = open();
    let mut provider = provider(Mesh::default());
    assert_eq!(provider.describe("scene.indices").unwrap().items, Some(0));
    for name in buffers(&provider) {
        let stride = provider.describe(&name).unwrap().stride;
        // The light's space has its centre behind the nodes.
        let items = if name == "scene.light_space_nodes" {
            2
        } else {
            1
        };
        let size = build(&mut provider, &gpu, &name).unwrap().size();
        assert_eq!(size, items * stride, "{name}");
    }
}

#[test]
fn an_unknown_resource_is_named_with_those_that_there_are() {
    let gpu = open();
    let mut provider = provider(Mesh::default());
    assert!(provider.describe("scene.position").is_none());
    let error = build(&mut provider, &gpu, "scene.position").unwrap_err();
    assert!(
        error.contains("`scene.position`") && error.contains("scene.positions"),
        "{error}"
    );
    assert!(provider.built().is_empty());
}

/// `nsm` as it is, and with every pass run `OnChange`.
struct Cached;

impl Sources for Cached {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        let text = EmbeddedSources.read(path)?;
        Ok(text.filter(|_| path.ends_with(".ron")).map(|text| {
            ["primitive", "surface", "shadow_lookup"]
                .iter()
                .fold(text.to_string(), |text, name| {
                    // Materials have no run condition: only a pass is named before anything but a
                    // format.
                    let named = format!("name: \"{name}\",");
                    let material = format!("{named} format");
                    text.replace(&material, "MATERIAL")
                        .replace(&named, &format!("{named} run: OnChange,"))
                        .replace("MATERIAL", &material)
                })
                .into()
        }))
    }

    fn list(&self, folder: &str) -> Vec<String> {
        EmbeddedSources.list(folder)
    }
}

fn park() -> Scene {
    SceneLibrary::default().load("park").unwrap().0
}

/// A pass runs again if what it depends on has changed, and no other pass does.
#[test]
fn a_new_camera_renews_what_depends_on_the_camera() {
    let gpu = open();
    let scene = Arc::new(park());
    let viewport = [48, 32];
    let sources = LayeredSources(vec![Box::new(Cached), Box::new(EmbeddedSources)]);
    let graph = Graph::load("pipelines/nsm.ron", &registry(), &sources)
        .unwrap_or_else(|errors| panic!("{errors}"));
    let start = |provider: &mut SceneProvider| {
        let plan = graph
            .plan(&PlanRequest::new(viewport, provider))
            .unwrap_or_else(|errors| panic!("{errors}"));
        Executor::on(&gpu, plan, provider).unwrap()
    };
    let mut provider = graphs::provider(&scene, &scene.views[0], viewport);
    let mut executor = start(&mut provider);
    let outputs = ["visibility", "status"];
    let next = |executor: &mut Executor| graphs::frame(&gpu, executor, &outputs);

    let first = next(&mut executor);
    assert_eq!(first.skipped, [""; 0]);
    let everything = [
        "gbuffer.visibility_buffer.primitive",
        "gbuffer.surface",
        "create_shadow_map.fit_map.over_scene",
        "create_shadow_map.draw[0]",
        "shadow_lookup",
    ];
    let second = next(&mut executor);
    assert_eq!(second.skipped, everything);
    assert_eq!(second.readbacks, first.readbacks);

    provider.set_view(&scene.views[3], viewport);
    executor.refresh(&mut provider).unwrap();
    let moved = next(&mut executor);
    assert_eq!(moved.skipped, everything[2..4]);
    let anew = next(&mut start(&mut graphs::provider(
        &scene,
        &scene.views[3],
        viewport,
    )));
    assert_eq!(moved.readbacks, anew.readbacks);
    assert_ne!(moved.readbacks, first.readbacks);

    // The map and what looks it up depend on these; what the camera sees does not.
    for (param, value, skipped) in [
        ("cull", ParamValue::Choice("none".into()), &everything[..3]),
        ("slope_bias", ParamValue::F32(2.0), &everything[..4]),
        (
            "map_size",
            ParamValue::U32(64),
            &["gbuffer.visibility_buffer.primitive", "gbuffer.surface"],
        ),
    ] {
        executor.set_param(param, value, &mut provider).unwrap();
        assert_eq!(next(&mut executor).skipped, skipped, "{param}");
        assert_eq!(next(&mut executor).skipped, everything, "{param}");
    }
    executor.touch("light").unwrap();
    assert_eq!(
        next(&mut executor).skipped,
        ["gbuffer.visibility_buffer.primitive"]
    );
}

/// Everything that depends on the light follows a view that has one of its own, also if it is used
/// with executors that are there already.
#[test]
fn a_view_with_its_own_light_is_drawn_as_its_scene_would_be_under_that_light() {
    let gpu = open();
    let viewport = [48, 32];
    let mut scene = park();
    let own = DirectionalLight::new(DVec3::new(-0.4, -0.8, 0.3));
    scene.views[3].light = Some(own.into());
    let under_it = Arc::new(Scene {
        lights: vec![own.into()],
        ..scene.clone()
    });
    let scene = Arc::new(scene);
    let engine = |name: &str| ("engine", ParamValue::Choice(name.into()));
    for (preset, params) in [
        ("nsm", vec![]),
        ("light_buffer", vec![]),
        ("rt", vec![engine("light_space")]),
    ] {
        let path = format!("pipelines/{preset}.ron");
        let graph = Graph::load(&path, &registry(), &EmbeddedSources)
            .unwrap_or_else(|errors| panic!("{errors}"));
        let start = |provider: &mut SceneProvider| {
            let mut request = PlanRequest::new(viewport, provider);
            for (name, value) in &params {
                request.params.insert((*name).to_owned(), value.clone());
            }
            let plan = graph
                .plan(&request)
                .unwrap_or_else(|errors| panic!("{errors}"));
            Executor::on(&gpu, plan, provider).unwrap()
        };
        let next = |executor: &mut Executor| {
            let report = graphs::frame(&gpu, executor, &["visibility", "status"]);
            report.readbacks
        };
        let readbacks = |scene: &Arc<Scene>| {
            let mut provider = graphs::provider(scene, &scene.views[3], viewport);
            next(&mut start(&mut provider))
        };
        let expected = readbacks(&under_it);
        assert_eq!(readbacks(&scene), expected, "{preset}");

        let mut provider = graphs::provider(&scene, &scene.views[0], viewport);
        let mut executor = start(&mut provider);
        let first = next(&mut executor);
        for (view, expected) in [(3, &expected), (0, &first), (3, &expected)] {
            provider.set_view(&scene.views[view], viewport);
            executor.refresh(&mut provider).unwrap();
            assert_eq!(next(&mut executor), *expected, "{preset}, view {view}");
        }
        provider.set_view(
            &View {
                light: None,
                ..scene.views[3].clone()
            },
            viewport,
        );
        executor.refresh(&mut provider).unwrap();
        assert_ne!(next(&mut executor), expected, "{preset}: the scene's light");
    }
}

/// A host's light is checked where it is used, alone and among all, and named.
#[test]
fn a_light_that_cannot_be_used_is_told_by_its_name() {
    let gpu = open();
    let sun = |name: &str, angle_degrees| Light {
        name: name.into(),
        kind: LightKind::Directional(DirectionalLight {
            direction: DVec3::NEG_Y,
            angle_degrees,
        }),
    };
    for (angle, fault) in [
        (f64::NAN, "angle_degrees is NaN"),
        (90.0, "angle_degrees is 90"),
        (-1.0, "angle_degrees is -1"),
    ] {
        let scene = Scene {
            name: "two".into(),
            mesh: meshes::soup(3, 0.2, 1),
            views: vec![],
            lights: vec![sun("haze", angle), sun("moon", 0.5)],
        };
        let mut provider = SceneProvider::new(Arc::new(scene));
        for name in ["light", "light_area", "lights", "light_areas"] {
            let error = build(&mut provider, &gpu, name).unwrap_err();
            let named = format!("light \"haze\": the light's {fault}");
            assert!(error.contains(&named), "{name}: {error}");
            assert!(error.contains("less than 90"), "{name}: {error}");
        }
        provider.set_light(sun("moon", 0.5).kind);
        build(&mut provider, &gpu, "light_area").unwrap();
        // One that is not the scene's has no name.
        provider.set_light(sun("", 100.0).kind);
        let error = build(&mut provider, &gpu, "light").unwrap_err();
        assert!(
            error.contains("the light's angle_degrees is 100"),
            "{error}"
        );
    }
}

/// Each light of a scene has a kind of its own, and there are no others.
#[test]
fn lights_have_numbers() {
    let spot = SpotLight {
        position: DVec3::Y,
        direction: DVec3::NEG_Y,
        cone_degrees: 60.0,
        radius: 0.0,
    };
    let scene = Scene {
        name: "two".into(),
        mesh: meshes::soup(3, 0.2, 1),
        views: vec![],
        lights: vec![
            DirectionalLight::new(DVec3::NEG_Y).into(),
            LightKind::Spot(spot).into(),
        ],
    };
    let provider = SceneProvider::new(Arc::new(scene));
    let plan = |number: &str| {
        let document = format!(
            r#"(
                format: 3,
                materials: [Texture(name: "kinds", format: R32Uint, layers: "lights.count")],
                passes: [
                    Fullscreen(
                        name: "kind",
                        color: ["kinds[1]"],
                        bind: {{"light": "lights[{number}]"}},
                    ),
                    Fullscreen(
                        name: "of_spot",
                        color: ["kinds[0]"],
                        shader: "kind",
                        if: "lights[1].kind == spot",
                    ),
                ],
                outputs: ["kinds"],
                lights: [directional, spot],
            )"#
        );
        let shader = "#import \"shared/light.wgsl\"\n\
            @fragment fn fragment() -> @location(0) u32 {\n\
            return light_kind + u32(light.range > 0.0);\n}";
        let files = [("test.ron", document.as_str()), ("kind.wgsl", shader)];
        let graph = Graph::load("test.ron", &registry(), &graphs::layered(&files)).unwrap();
        graph
            .plan(&PlanRequest::new([4, 4], &provider))
            .map_err(|error| error.to_string())
    };
    let planned = plan("1").unwrap();
    assert_eq!(planned.provided(), ["lights.1", "light"]);
    assert_eq!(planned.outputs()[0].layers, 2);
    let wrong = plan("2").unwrap_err();
    assert!(wrong.contains("there are 2 of them"), "{wrong}");
}
