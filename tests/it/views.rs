//! One scene for several views and lights, all of which move: each shows what it would show with a
//! scene of its own.

use crate::{
    one_submission::{lamps, mesh, parts, places, same, sun, view},
    support::graphs::{self, open, values},
};
use glam::DVec3;
use skiagraph_gpu::{Content, ExecuteError, Executor, Frame, Pipelines, device::Gpu};
use skiagraph_graph::{Graph, ParamValue, Plan, PlanRequest};
use skiagraph_passes::{EmbeddedSources, Error, How, SceneProvider, SceneView, registry};
use skiagraph_scene::{Camera, DirectionalLight, LightKind, Mesh, PointLight};
use std::{error::Error as _, iter::successors};

const SIZES: [[u32; 2]; 2] = [[64, 40], [48, 48]];

/// Two suns, a spot and a bulb, all of them elsewhere at another time.
fn lights(time: f64) -> [LightKind; 4] {
    let moved = |mut light: LightKind| {
        let parameters = light.parameters();
        match (parameters.position, parameters.direction) {
            (None, Some(direction)) => direction.x -= 0.2 * time,
            (Some(position), Some(_)) => position.x += 0.5 * time,
            (Some(position), None) => position.z -= 0.5 * time,
            (None, None) => {}
        }
        light
    };
    let evening = DirectionalLight::new(DVec3::new(-0.7, -0.8, 0.2));
    let [spot, bulb] = lamps();
    [sun(), evening.into(), spot, bulb].map(moved)
}

/// The camera of each view at a time.
fn camera(number: usize, time: f64) -> Camera {
    let at = if number == 0 { time } else { 0.5 - time };
    view(at).camera(SIZES[number])
}

fn planned(preset: &str, provider: &SceneProvider, size: [u32; 2]) -> Plan {
    graphs::plan(&format!("pipelines/{preset}.ron"), provider, size, |_| {})
}

fn sharing(pipelines: &Pipelines, gpu: &Gpu, plan: Plan, provider: &mut SceneProvider) -> Executor {
    Executor::with_pipelines(pipelines, &gpu.queue, plan, provider).unwrap()
}

const READ: Frame<'_> = Frame::new().with_read(&["visibility"]);

fn encoder(gpu: &Gpu) -> wgpu::CommandEncoder {
    gpu.device.create_command_encoder(&Default::default())
}

fn submitted(gpu: &Gpu, executor: &mut Executor, frame: &Frame<'_>) {
    let mut encoder = encoder(gpu);
    executor.encode(&mut encoder, frame).unwrap();
    gpu.queue.submit([encoder.finish()]);
}

/// The picture of a scene that has this mesh, this light and this camera from the first.
fn alone(
    on: (&Pipelines, &Gpu),
    preset: &str,
    mesh: &Mesh,
    light: LightKind,
    camera: &Camera,
) -> Vec<u32> {
    let (pipelines, gpu) = on;
    let mut provider = SceneProvider::from_mesh(mesh.clone(), light);
    provider.set_camera(camera);
    let plan = planned(preset, &provider, camera.viewport);
    let mut executor = sharing(pipelines, gpu, plan, &mut provider);
    submitted(gpu, &mut executor, &READ);
    let seen = values(&executor.finish().unwrap(), "visibility");
    assert!(
        seen.contains(&0) && seen.contains(&1),
        "{preset}: {light:?}"
    );
    seen
}

type Failed = Box<dyn std::error::Error>;

/// An executor for a view, as a host makes it.
fn executor_of(
    view: &SceneView,
    graph: &Graph,
    (pipelines, queue): (&Pipelines, &wgpu::Queue),
    provider: &mut SceneProvider,
) -> Result<Executor, Failed> {
    let plan = graph.plan(&PlanRequest::new(view.size(), view.apply(provider)))?;
    let executor = Executor::with_pipelines(pipelines, queue, plan, provider)?;
    Ok(executor)
}

/// One frame of all views, as a host encodes it; `now` says where camera and light of a view are.
fn frame(
    views: &mut [(SceneView, Executor)],
    provider: &mut SceneProvider,
    (queue, mut encoder): (&wgpu::Queue, wgpu::CommandEncoder),
    mut now: impl FnMut(&SceneView) -> (Camera, LightKind),
) -> Result<(), Failed> {
    for (view, executor) in &mut *views {
        let (camera, light) = now(view);
        view.set_camera(&camera);
        view.set_light(light)?;
        view.refresh_in(executor, provider, &mut encoder)?;
        executor.encode(&mut encoder, &READ)?;
    }
    queue.submit([encoder.finish()]);
    Ok(())
}

#[test]
fn four_lights_and_two_views_share_a_scene() {
    let (gpu, parts) = (open(), parts());
    for preset in ["rt", "light_buffer", "nsm"] {
        let path = format!("pipelines/{preset}.ron");
        let graph = Graph::load(&path, &registry(), &EmbeddedSources);
        let graph = graph.unwrap_or_else(|error| panic!("{error}"));
        let pipelines = Pipelines::new(&gpu.device);
        let mut provider = SceneProvider::from_parts(parts.clone(), sun());
        provider.set_transforms(&places(0.0)).unwrap();
        let pairs = || (0..2).flat_map(|number| (0..4).map(move |light| (number, light)));
        let at =
            |(number, light): (usize, usize), time| (camera(number, time), lights(time)[light]);
        let view = |pair| {
            let (camera, light) = at(pair, 0.0);
            let view = SceneView::from_camera(&camera, light);
            let on = (&pipelines, &gpu.queue);
            let executor = executor_of(&view, &graph, on, &mut provider).unwrap();
            (view, executor)
        };
        let mut views: Vec<(SceneView, Executor)> = pairs().map(view).collect();
        let made = pipelines.made();
        for time in [0.0, 1.0] {
            provider.set_transforms(&places(time)).unwrap();
            let mut turns = pairs();
            let now = |_: &SceneView| at(turns.next().unwrap(), time);
            let on = (&gpu.queue, encoder(&gpu));
            frame(&mut views, &mut provider, on, now).unwrap();
            let mesh = mesh(&parts, time);
            for (pair, (_, executor)) in pairs().zip(&mut views) {
                let seen = values(&executor.finish().unwrap(), "visibility");
                let (camera, light) = at(pair, time);
                let expected = alone((&pipelines, &gpu), preset, &mesh, light, &camera);
                let what = format!("{preset}, {time}, view {}, {}", pair.0, light.word());
                same(&seen, &expected, &what);
            }
        }
        // A kind of light is a constant of the shaders, a place is none.
        assert_eq!(pipelines.made(), made, "{preset}");
    }
}

/// Views of one sun find its hierarchy in light space, whatever the order.
#[test]
fn a_light_is_laid_once_for_all_views() {
    let (gpu, parts) = (open(), parts());
    let mut provider = SceneProvider::from_parts(parts, sun());
    provider.set_transforms(&places(0.0)).unwrap();
    let suns = |time| [lights(time)[0], lights(time)[1]];
    let mut views = Vec::new();
    for number in 0..2 {
        for light in suns(0.0) {
            let view = SceneView::from_camera(&camera(number, 0.0), light);
            let engine = ParamValue::Choice("light_space".into());
            let provider = view.apply(&mut provider);
            let plan = graphs::plan("pipelines/rt.ron", provider, view.size(), |request| {
                request.params.insert("engine".into(), engine);
            });
            let executor = Executor::on(&gpu, plan, provider).unwrap();
            views.push((view, executor));
        }
    }
    let times = |provider: &SceneProvider, name: &str| {
        let built = provider.built().iter().find(|built| built.name == name);
        built.map(|built| (built.times, built.how))
    };
    let nodes = "scene.light_space_nodes";
    assert_eq!(times(&provider, nodes), Some((2, How::Made)));
    for frame in 1..4 {
        provider.set_transforms(&places(f64::from(frame))).unwrap();
        for (view, executor) in &mut views {
            view.refresh(executor, &mut provider).unwrap();
        }
        assert_eq!(
            times(&provider, nodes),
            Some((2 + 2 * frame as u32, How::Refitted))
        );
    }
    // Nothing has moved.
    let before = provider.built().to_vec();
    for (view, executor) in &mut views {
        view.refresh(executor, &mut provider).unwrap();
    }
    assert_eq!(provider.built(), before);
}

/// A method for each light of the scene.
fn of_each(method: &str) -> String {
    format!(
        r#"(
            format: 3,
            materials: [
                Texture(name: "visibility", format: R32Uint, layers: "lights.count"),
                Texture(name: "status", format: R32Uint, layers: "lights.count"),
            ],
            passes: [
                Include(
                    graph: "{method}.ron", name: "lit", repeat: "lights.count",
                    bind: {{
                        "light": "lights[index]",
                        "visibility": "visibility[index]",
                        "status": "status[index]",
                    }},
                ),
            ],
            outputs: ["visibility", "status"],
            lights: [directional, spot, point],
        )"#
    )
}

fn of_each_planned(method: &str, provider: &SceneProvider) -> Plan {
    planned_lit(&of_each(method), provider)
}

fn planned_lit(document: &str, provider: &SceneProvider) -> Plan {
    let sources = graphs::layered(&[("pipelines/test.ron", document)]);
    Graph::load("pipelines/test.ron", &registry(), &sources)
        .and_then(|graph| graph.plan(&PlanRequest::new(SIZES[0], provider)))
        .unwrap_or_else(|faults| panic!("{faults}"))
}

/// The provider of the scene with four lights.
fn lit() -> SceneProvider {
    let mut provider = SceneProvider::from_parts(parts(), sun());
    provider.set_lights(&lights(0.0)).unwrap();
    provider.set_transforms(&places(0.0)).unwrap();
    provider.set_camera(&camera(0, 0.0));
    provider
}

#[test]
fn lights_of_a_list_move() {
    let (gpu, parts) = (open(), parts());
    for method in ["rt", "nsm"] {
        let mut provider = lit();
        let plan = of_each_planned(method, &provider);
        let pipelines = Pipelines::new(&gpu.device);
        let mut executor = sharing(&pipelines, &gpu, plan, &mut provider);
        for time in [0.0, 1.0, 2.0] {
            provider.set_lights(&lights(time)).unwrap();
            executor.refresh(&mut provider).unwrap();
            submitted(&gpu, &mut executor, &READ);
            let report = executor.finish().unwrap();
            let layers = words(&report.readbacks[0].content);
            let layers: Vec<&[u32]> = layers.chunks(64 * 40).collect();
            assert_eq!(layers.len(), 4);
            let mesh = mesh(&parts, 0.0);
            for (light, seen) in lights(time).into_iter().zip(layers) {
                let expected = alone((&pipelines, &gpu), method, &mesh, light, &camera(0, 0.0));
                same(
                    seen,
                    &expected,
                    &format!("{method}, {time}, {}", light.word()),
                );
            }
        }
    }
}

fn words(content: &Content) -> Vec<u32> {
    content.as_u32().expect("it holds numbers")
}

/// The maps of the other lights stay.
#[test]
fn a_light_that_moves_changes_no_other() {
    let gpu = open();
    let mut provider = lit();
    let plan = of_each_planned("nsm", &provider);
    let mut executor = sharing(&Pipelines::new(&gpu.device), &gpu, plan, &mut provider);
    let mut drawn = |provider: &mut SceneProvider| {
        executor.refresh(provider).unwrap();
        submitted(&gpu, &mut executor, &Frame::default());
        let skipped = executor.finish().unwrap().skipped;
        let has_map = |number: &usize| {
            let lit = format!("lit[{number}]");
            let is_map = |pass: &&String| pass.starts_with(&lit) && pass.contains(".draw");
            let passes = executor.plan().passes();
            let mut maps = passes.iter().map(|pass| &pass.name).filter(is_map);
            let first = maps
                .next()
                .unwrap_or_else(|| panic!("{lit} draws: {skipped:?}"));
            !skipped.contains(first)
        };
        (0..4).filter(has_map).collect::<Vec<usize>>()
    };
    assert_eq!(drawn(&mut provider), [0, 1, 2, 3]);
    for number in 0..4 {
        let mut now = provider.lights().to_vec();
        now[number] = lights(1.0)[number];
        provider.set_lights(&now).unwrap();
        assert_eq!(drawn(&mut provider), [number]);
    }
    provider.set_lights(&lights(1.0)).unwrap();
    assert!(drawn(&mut provider).is_empty(), "they were set before");
}

#[test]
fn other_lights_than_planned_are_named() {
    let gpu = open();
    let mut provider = lit();
    let plan = of_each_planned("rt", &provider);
    let mut executor = sharing(&Pipelines::new(&gpu.device), &gpu, plan, &mut provider);

    let mut of_another_kind = lights(0.0);
    of_another_kind[2] = sun();
    provider.set_lights(&of_another_kind).unwrap();
    let error = executor.refresh(&mut provider).unwrap_err();
    assert!(
        matches!(&error, ExecuteError::OtherThanPlanned { name, .. } if name == "lights.2"),
        "{error}"
    );
    // One that counts them, and one that names four of them.
    let four = of_each("rt").replace("lights.count", "4");
    provider.set_lights(&lights(0.0)).unwrap();
    let plan = planned_lit(&four, &provider);
    let mut of_four = sharing(&Pipelines::new(&gpu.device), &gpu, plan, &mut provider);
    let five = [&lights(0.0)[..], &[sun()]].concat();
    // The light that no pass binds is of no account to either.
    let relies_on = |executor: &Executor| -> Vec<String> {
        executor.plan().relies_on().keys().cloned().collect()
    };
    assert_eq!(
        relies_on(&executor),
        ["lights", "scene.masks", "scene.shadows"]
    );
    assert_eq!(relies_on(&of_four), ["scene.masks", "scene.shadows"]);
    for lights in [&five[..3], &five] {
        provider.set_lights(lights).unwrap();
        executor.refresh(&mut provider).unwrap();
        assert_eq!(
            executor.plan().relies_on()["lights"].unwrap().items,
            Some(lights.len() as u64)
        );
    }
    of_four.refresh(&mut provider).unwrap();
    provider.set_lights(&five[..3]).unwrap();
    let error = of_four.refresh(&mut provider).unwrap_err();
    let mut chain = successors(error.source(), |&error| error.source());
    let cause = chain.find_map(|cause| cause.downcast_ref::<Error>());
    assert!(
        matches!(cause, Some(Error::LightGone { name, lights: 3 }) if name == "lights[3]"),
        "{error}"
    );
    assert!(error.to_string().contains("`lights[3]`"), "{error}");

    let mut broken = lights(0.0);
    broken[1] = PointLight {
        position: DVec3::new(0.0, f64::NAN, 0.0),
        radius: 0.0,
    }
    .into();
    let error = provider.set_lights(&broken).unwrap_err();
    assert!(
        matches!(error, Error::LightNumber { number: 1, .. }),
        "{error}"
    );
    assert!(error.to_string().contains("`lights[1]`"), "{error}");
    let error = provider.set_lights(&[]).unwrap_err();
    assert!(matches!(error, Error::NoLights), "{error}");
    // The refused ones were not set, and planned ones are right again.
    assert_eq!(provider.lights(), &lights(0.0)[..3]);
    provider.set_lights(&lights(1.0)).unwrap();
    executor.refresh(&mut provider).unwrap();
    submitted(&gpu, &mut executor, &READ);
    executor.finish().unwrap();
    // One more is another plan.
    provider
        .set_lights(&[lights(0.0).as_slice(), &[sun()]].concat())
        .unwrap();
    let plan = of_each_planned("rt", &provider);
    executor.replace_graph(plan, &mut provider).unwrap();
    assert_eq!(executor.plan().outputs()[0].layers, 5);
}

#[test]
fn a_view_has_a_size_and_a_light_that_shines() {
    let gpu = open();
    let mut provider = lit();
    let mut view = SceneView::from_camera(&camera(0, 0.0), sun());
    let plan = planned("rt", view.apply(&mut provider), view.size());
    let mut executor = sharing(&Pipelines::new(&gpu.device), &gpu, plan, &mut provider);
    view.set_camera(&camera(1, 0.0));
    view.refresh(&mut executor, &mut provider).unwrap();
    assert_eq!(executor.plan().viewport(), SIZES[1]);
    // A minimised window has no pixels: its view is passed over.
    for size in [[0, 0], [0, 8], [8, 0]] {
        view.set_size(size);
        view.refresh(&mut executor, &mut provider).unwrap();
        assert_eq!(executor.plan().viewport(), SIZES[1]);
    }
    let nowhere = DirectionalLight::new(DVec3::ZERO);
    let error = view.set_light(nowhere).unwrap_err();
    assert!(matches!(error, Error::Light(_)), "{error}");
    assert_eq!(view.light(), sun());
}
