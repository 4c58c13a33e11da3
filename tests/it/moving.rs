//! Parts that a host moves: in which order it says so, what costs nothing, and what is refused.

use crate::support::{
    graphs::{self, open, values},
    meshes,
};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use skiagraph_gpu::{ExecuteError, Executor, Frame, device::Gpu};
use skiagraph_passes::{Error, How, SceneProvider};
use skiagraph_scene::{DirectionalLight, LightKind, Movable, MoveError, PointLight, View};

const VIEWPORT: [u32; 2] = [48, 32];
const PRESETS: [&str; 3] = ["light_buffer", "rt", "nsm"];

fn sun() -> DirectionalLight {
    DirectionalLight::new(DVec3::new(0.4, -1.0, -0.3))
}

/// So many stones, each around the origin of its own space.
fn stones(count: usize) -> Movable {
    let stone = meshes::potato(2, 0.2, 1);
    Movable::joined(&vec![&stone; count])
}

/// In rows on the ground.
fn rows(count: usize) -> Vec<DAffine3> {
    let place = |index: usize| DVec3::new((index % 6) as f64, 0.0, (index / 6) as f64);
    let map = |index| DAffine3::from_translation(3.0 * place(index));
    (0..count).map(map).collect()
}

fn provider(parts: Movable) -> SceneProvider {
    let view = View {
        name: String::new(),
        eye: DVec3::new(7.0, 9.0, 24.0),
        direction: DVec3::new(0.0, -0.5, -1.0),
        up: DVec3::Y,
        fov_y_degrees: 50.0,
        near: 0.1,
        far: 60.0,
        light: None,
    };
    let mut provider = SceneProvider::from_parts(parts, sun());
    provider.set_camera(&view.camera(VIEWPORT));
    provider
}

fn start(gpu: &Gpu, preset: &str, provider: &mut SceneProvider) -> Executor {
    let path = format!("pipelines/{preset}.ron");
    let plan = graphs::plan(&path, provider, VIEWPORT, |_| {});
    Executor::on(gpu, plan, provider).unwrap()
}

fn shown(gpu: &Gpu, executor: &mut Executor) -> Vec<u32> {
    values(&graphs::frame(gpu, executor, &["visibility"]), "visibility")
}

/// Returns the resources that were made: names, how, how often.
fn made(provider: &SceneProvider) -> Vec<(&'static str, How, u32)> {
    let built = provider.built().iter();
    let mut made: Vec<_> = built.map(|it| (it.name, it.how, it.times)).collect();
    made.sort_unstable_by_key(|made| made.0);
    made
}

#[test]
fn an_executor_may_be_made_before_the_parts_have_places() {
    let (gpu, count) = (open(), 30);
    for preset in PRESETS {
        let mut before = provider(stones(count));
        let mut executor = start(&gpu, preset, &mut before);
        let of_places = [
            "scene.positions",
            "scene.normals",
            "scene.bvh_nodes",
            "light",
        ];
        let early = made(&before);
        assert!(
            early.iter().all(|(name, ..)| !of_places.contains(name)),
            "{preset}: over parts that lie on each other: {early:?}"
        );
        // Nothing is shown that is not there.
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let error = executor
            .encode(&mut encoder, &Frame::default())
            .unwrap_err();
        assert!(matches!(error, ExecuteError::NotProvided { .. }), "{error}");
        assert!(
            error
                .to_string()
                .contains("`SceneProvider::set_transforms`"),
            "{error}"
        );

        before.set_transforms(&rows(count)).unwrap();
        executor.refresh(&mut before).unwrap();
        let mut after = provider(stones(count));
        after.set_transforms(&rows(count)).unwrap();
        let mut made_after = start(&gpu, preset, &mut after);
        let (seen, expected) = (shown(&gpu, &mut executor), shown(&gpu, &mut made_after));
        assert!(expected.contains(&0) && expected.contains(&1), "{preset}");
        assert!(seen == expected, "{preset}");
        assert_eq!(made(&before), made(&after), "{preset}");
    }
}

#[test]
fn parts_that_stand_still_cost_nothing() {
    let (gpu, count) = (open(), 12);
    for preset in PRESETS {
        let mut provider = provider(stones(count));
        let mut maps = rows(count);
        provider.set_transforms(&maps).unwrap();
        let mut executor = start(&gpu, preset, &mut provider);
        let first = made(&provider);
        let expected = shown(&gpu, &mut executor);
        for _ in 0..3 {
            provider.set_transforms(&maps).unwrap();
            let mesh = provider.scene().mesh.clone();
            executor.refresh(&mut provider).unwrap();
            assert!(shown(&gpu, &mut executor) == expected, "{preset}");
            provider.deform(mesh.positions, mesh.normals).unwrap();
            executor.refresh(&mut provider).unwrap();
        }
        assert_eq!(made(&provider), first, "{preset}");
        for map in &mut maps[1..] {
            map.translation.y += 2.0;
        }
        provider.set_transforms(&maps).unwrap();
        executor.refresh(&mut provider).unwrap();
        assert_ne!(made(&provider), first, "{preset}");
        let mut anew = self::provider(stones(count));
        anew.set_transforms(&maps).unwrap();
        let moved = shown(&gpu, &mut start(&gpu, preset, &mut anew));
        assert!(shown(&gpu, &mut executor) == moved, "{preset}");
        let changed = moved.iter().zip(&expected).filter(|(a, b)| a != b).count();
        assert!(changed > 0, "{preset}");
    }
}

/// A host that begins with all parts in one place has the tree of where they are, not that of where
/// they were.
#[test]
fn the_tree_of_parts_that_lay_on_each_other_is_built_anew() {
    let (gpu, count) = (open(), 30);
    let mut provider = provider(stones(count));
    provider
        .set_transforms(&vec![DAffine3::IDENTITY; count])
        .unwrap();
    let mut executor = start(&gpu, "rt", &mut provider);
    let tree = |provider: &SceneProvider| {
        let made = made(provider);
        let tree = made.iter().find(|made| made.0 == "scene.bvh_nodes");
        tree.map(|(_, how, times)| (*how, *times))
    };
    assert_eq!(tree(&provider), Some((How::Made, 1)));
    provider.set_transforms(&rows(count)).unwrap();
    executor.refresh(&mut provider).unwrap();
    assert_eq!(tree(&provider), Some((How::Made, 2)));
    // From there on it is fitted.
    let mut maps = rows(count);
    for map in &mut maps {
        map.translation.x += 0.5;
    }
    provider.set_transforms(&maps).unwrap();
    executor.refresh(&mut provider).unwrap();
    assert_eq!(tree(&provider), Some((How::Refitted, 3)));
}

#[test]
fn maps_by_which_nothing_can_be_moved_are_named() {
    let (count, bad) = (300, 217);
    let mut provider = provider(stones(count));
    let wrong = |change: fn(&mut DAffine3)| {
        let mut maps = rows(count);
        change(&mut maps[bad]);
        maps
    };
    let mut error = |maps: &[DAffine3]| {
        let error = provider.set_transforms(maps).unwrap_err();
        let Error::Move(error) = error else {
            panic!("{error}");
        };
        error
    };
    let nan = error(&wrong(|map| map.translation.x = f64::NAN));
    assert!(
        matches!(nan, MoveError::NotFinite { part: 217, .. }),
        "{nan}"
    );
    assert!(nan.to_string().contains("part 217"), "{nan}");
    let flat = error(&wrong(|map| {
        map.matrix3 = DMat3::from_diagonal(DVec3::new(1.0, 0.0, 1.0))
    }));
    assert_eq!(flat, MoveError::Singular { part: bad });
    let far = error(&wrong(|map| map.translation.y = 1e39));
    assert!(
        matches!(far, MoveError::OutOfRange { part: 217, .. }),
        "{far}"
    );
    for maps in [0, count - 1, count + 1] {
        let expected = MoveError::Count { parts: count, maps };
        assert_eq!(error(&rows(maps)), expected);
    }
    // Nothing has changed: the parts still have no places.
    let places = provider.scene().mesh.positions.iter();
    assert!(places.map(|p| p.abs().max_element()).fold(0.0, f32::max) < 2.0);
    provider.set_transforms(&rows(count)).unwrap();

    let mut whole = SceneProvider::from_mesh(meshes::potato(1, 0.2, 1), sun());
    let error = whole.set_transforms(&rows(1)).unwrap_err().to_string();
    assert!(error.contains("`SceneProvider::from_parts`"), "{error}");
    let mesh = whole.scene().mesh.clone();
    let mut normals = mesh.normals.clone();
    normals[5] = Vec3::INFINITY;
    let error = whole.deform(mesh.positions, normals).unwrap_err();
    assert!(
        error.to_string().contains("normal 5 of a deformed mesh"),
        "{error}"
    );
}

#[test]
fn a_light_of_another_kind_is_an_error_of_its_own() {
    let gpu = open();
    let mut provider = provider(stones(2));
    provider.set_transforms(&rows(2)).unwrap();
    let mut executor = start(&gpu, "rt", &mut provider);
    let expected = shown(&gpu, &mut executor);
    let lamp = PointLight {
        position: DVec3::new(0.0, 9.0, 0.0),
        radius: 0.0,
    };
    provider.set_light(LightKind::Point(lamp));
    let error = executor.refresh(&mut provider).unwrap_err();
    let ExecuteError::OtherThanPlanned {
        name,
        planned,
        given,
    } = &error
    else {
        panic!("{error}");
    };
    let word = |kind: &skiagraph_graph::Provided| kind.kind.map(|kind| kind.word());
    assert_eq!(name, "light");
    assert_eq!(
        [word(planned), word(given)],
        [Some("directional"), Some("point")]
    );
    let text = error.to_string();
    assert!(
        text.starts_with("`light` is point now, but the graph was planned for directional: plan"),
        "{text}"
    );
    // The way out that it names.
    let plan = executor.plan().with(|request| request.provider = &provider);
    executor
        .replace_graph(plan.unwrap(), &mut provider)
        .unwrap();
    assert!(shown(&gpu, &mut executor) != expected);
}
