//! Several executors of one provider, or several frames of one executor, in one submission: each
//! frame shows what was set when it was encoded.

use crate::support::{
    graphs::{self, open, values},
    meshes,
};
use glam::{DAffine3, DVec3, Vec3};
use skiagraph_gpu::{Executor, Frame, device::Gpu};
use skiagraph_passes::SceneProvider;
use skiagraph_scene::{DirectionalLight, LightKind, Mesh, Movable, PointLight, SpotLight, View};

const VIEWPORT: [u32; 2] = [64, 40];
/// They take lights of all kinds.
const PRESETS: [&str; 3] = ["rt", "light_buffer", "nsm"];

pub(crate) fn sun() -> LightKind {
    DirectionalLight::new(DVec3::new(0.4, -1.0, -0.3)).into()
}

pub(crate) fn lamps() -> [LightKind; 2] {
    [
        LightKind::Spot(SpotLight {
            position: DVec3::new(-3.0, 6.0, 3.0),
            direction: DVec3::new(0.4, -1.0, -0.4),
            cone_degrees: 80.0,
            radius: 0.0,
        }),
        LightKind::Point(PointLight {
            position: DVec3::new(3.0, 4.0, 2.0),
            radius: 0.0,
        }),
    ]
}

pub(crate) fn view(time: f64) -> View {
    View {
        name: String::new(),
        eye: DVec3::new(1.0 + 2.0 * time, 6.0, 9.0),
        direction: DVec3::new(-0.1, -0.6, -1.0),
        fov_y_degrees: 50.0,
        far: 60.0,
        ..View::default()
    }
}

pub(crate) fn parts() -> Movable {
    let floor = meshes::box_over_floor(8.0, Vec3::splat(0.5));
    Movable::joined(&[&floor, &meshes::potato(3, 0.2, 1)])
}

pub(crate) fn places(time: f64) -> [DAffine3; 2] {
    let at = DVec3::new(2.0 - 1.5 * time, 1.0 + 0.5 * time, 0.5 * time);
    [DAffine3::IDENTITY, DAffine3::from_translation(at)]
}

/// The parts at a time as one mesh that never moved.
pub(crate) fn mesh(parts: &Movable, time: f64) -> Mesh {
    parts.moved(&places(time)).unwrap()
}

/// The parts at time 0.
fn provider(parts: &Movable) -> SceneProvider {
    let mut provider = SceneProvider::from_parts(parts.clone(), sun());
    provider.set_camera(&view(0.0).camera(VIEWPORT));
    provider.set_transforms(&places(0.0)).unwrap();
    provider
}

fn start(gpu: &Gpu, preset: &str, provider: &mut SceneProvider) -> Executor {
    let path = format!("pipelines/{preset}.ron");
    let plan = graphs::plan(&path, provider, VIEWPORT, |_| {});
    Executor::on(gpu, plan, provider).unwrap()
}

/// A frame of what is set now.
fn encode(executor: &mut Executor, provider: &mut SceneProvider, to: &mut wgpu::CommandEncoder) {
    executor.refresh(provider).unwrap();
    let frame = Frame::new().with_read(&["visibility"]);
    executor.encode(to, &frame).unwrap();
}

fn encoder(gpu: &Gpu) -> wgpu::CommandEncoder {
    gpu.device.create_command_encoder(&Default::default())
}

/// The oldest frame that was not looked at.
fn seen(executor: &mut Executor) -> Vec<u32> {
    values(&executor.finish().unwrap(), "visibility")
}

/// Renders a mesh that never moved by an executor of its own.
fn alone(gpu: &Gpu, preset: &str, mesh: Mesh, light: LightKind, camera: f64) -> Vec<u32> {
    let mut provider = SceneProvider::from_mesh(mesh, light);
    provider.set_camera(&view(camera).camera(VIEWPORT));
    let mut executor = start(gpu, preset, &mut provider);
    let mut encoder = encoder(gpu);
    encode(&mut executor, &mut provider, &mut encoder);
    gpu.queue.submit([encoder.finish()]);
    let seen = seen(&mut executor);
    assert!(
        seen.contains(&0) && seen.contains(&1),
        "{preset}: {light:?}"
    );
    seen
}

/// How many pixels differ.
#[track_caller]
pub(crate) fn same(seen: &[u32], expected: &[u32], what: &str) {
    let wrong = seen.iter().zip(expected).filter(|(a, b)| a != b).count();
    assert_eq!(wrong, 0, "{what}: so many of {} pixels differ", seen.len());
}

#[test]
fn executors_of_one_provider_show_their_own_lights_and_meshes() {
    let (gpu, parts) = (open(), parts());
    let [spot, bulb] = lamps();
    let cases = [
        ("rt", bulb),
        ("light_buffer", spot),
        ("light_buffer", bulb),
        ("nsm", spot),
    ];
    for (preset, lamp) in cases {
        let mut provider = provider(&parts);
        let mut of_sun = start(&gpu, preset, &mut provider);
        provider.set_light(lamp);
        let mut of_lamp = start(&gpu, preset, &mut provider);
        for time in [0.0, 2.0] {
            let mut encoder = encoder(&gpu);
            provider.set_transforms(&places(time)).unwrap();
            provider.set_light(sun());
            encode(&mut of_sun, &mut provider, &mut encoder);
            provider.set_transforms(&places(time + 1.0)).unwrap();
            provider.set_light(lamp);
            encode(&mut of_lamp, &mut provider, &mut encoder);
            gpu.queue.submit([encoder.finish()]);
            let what = format!("{preset}, {time}, {}", lamp.word());
            let expected = alone(&gpu, preset, mesh(&parts, time), sun(), 0.0);
            same(&seen(&mut of_sun), &expected, &format!("{what}: sun"));
            let expected = alone(&gpu, preset, mesh(&parts, time + 1.0), lamp, 0.0);
            same(&seen(&mut of_lamp), &expected, &format!("{what}: lamp"));
        }
    }
}

#[test]
fn frames_of_one_executor_show_their_own_cameras_and_meshes() {
    let (gpu, parts) = (open(), parts());
    for preset in PRESETS {
        let mut provider = provider(&parts);
        let mut executor = start(&gpu, preset, &mut provider);
        let mut encoder = encoder(&gpu);
        let frames = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (2.0, 2.0)];
        for (camera, time) in frames {
            provider.set_camera(&view(camera).camera(VIEWPORT));
            provider.set_transforms(&places(time)).unwrap();
            encode(&mut executor, &mut provider, &mut encoder);
        }
        gpu.queue.submit([encoder.finish()]);
        for (camera, time) in frames {
            let expected = alone(&gpu, preset, mesh(&parts, time), sun(), camera);
            let what = format!("{preset}: camera at {camera}, mesh at {time}");
            same(&seen(&mut executor), &expected, &what);
        }
    }
}

#[test]
fn an_executor_that_is_not_refreshed_shows_what_it_showed() {
    let (gpu, parts) = (open(), parts());
    for preset in PRESETS {
        let mut provider = provider(&parts);
        let mut still = start(&gpu, preset, &mut provider);
        let mut moving = start(&gpu, preset, &mut provider);
        let expected = alone(&gpu, preset, mesh(&parts, 0.0), sun(), 0.0);
        provider.set_camera(&view(1.0).camera(VIEWPORT));
        provider.set_transforms(&places(2.0)).unwrap();
        let mut encoder = encoder(&gpu);
        encode(&mut moving, &mut provider, &mut encoder);
        let frame = Frame::new().with_read(&["visibility"]);
        still.encode(&mut encoder, &frame).unwrap();
        gpu.queue.submit([encoder.finish()]);
        same(&seen(&mut still), &expected, preset);
    }
}

/// A branch is the scene as it was: it shows that, whatever becomes of the provider.
#[test]
fn a_branch_for_each_light_shows_its_own_mesh() {
    let (gpu, parts) = (open(), parts());
    for preset in PRESETS {
        let mut provider = provider(&parts);
        let mut of_sun = start(&gpu, preset, &mut provider);
        let mut branch = provider.branch();
        branch.set_light(lamps()[0]);
        let mut of_lamp = start(&gpu, preset, &mut branch);
        for (sun_at, lamp_at) in [(1.0, 0.0), (2.0, 1.0)] {
            let mut encoder = encoder(&gpu);
            provider.set_transforms(&places(sun_at)).unwrap();
            branch.set_transforms(&places(lamp_at)).unwrap();
            encode(&mut of_sun, &mut provider, &mut encoder);
            encode(&mut of_lamp, &mut branch, &mut encoder);
            gpu.queue.submit([encoder.finish()]);
            let expected = alone(&gpu, preset, mesh(&parts, sun_at), sun(), 0.0);
            same(
                &seen(&mut of_sun),
                &expected,
                &format!("{preset}, {sun_at}: sun"),
            );
            let expected = alone(&gpu, preset, mesh(&parts, lamp_at), lamps()[0], 0.0);
            same(
                &seen(&mut of_lamp),
                &expected,
                &format!("{preset}, {lamp_at}: lamp"),
            );
        }
    }
}

/// Lights that take turns are no change for the executor of each: its map stays.
#[test]
fn what_is_set_again_runs_nothing_again() {
    let (gpu, parts) = (open(), parts());
    let mut provider = provider(&parts);
    let mut of_sun = start(&gpu, "nsm", &mut provider);
    provider.set_light(lamps()[0]);
    provider.set_camera(&view(1.0).camera(VIEWPORT));
    let mut of_lamp = start(&gpu, "nsm", &mut provider);
    for turn in 0..3 {
        let frames = [(&mut of_sun, sun(), 0.0), (&mut of_lamp, lamps()[0], 1.0)];
        for (executor, light, camera) in frames {
            provider.set_light(light);
            provider.set_camera(&view(camera).camera(VIEWPORT));
            let mut encoder = encoder(&gpu);
            encode(executor, &mut provider, &mut encoder);
            gpu.queue.submit([encoder.finish()]);
            let skipped = executor.finish().unwrap().skipped;
            let has_map = skipped.iter().any(|pass| pass.contains(".draw"));
            assert_eq!(has_map, turn > 0, "{turn}, {}: {skipped:?}", light.word());
        }
    }
    let lights = provider.built().iter().find(|built| built.name == "light");
    assert_eq!(lights.map(|built| built.times), Some(2));
}
