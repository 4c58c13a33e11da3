//! A small engine: stones in levels of detail, leaves with masks, a stone that the GPU skins, parts
//! that are streamed in and out, an origin that floats, cameras that tremble, lost frames.
//! Each of its pictures is that of a scene that is made of nothing.

use crate::host_buffers::{host_stone, raise_in, raised_stone, stones};
use crate::support::graphs::{self, open, values};
use crate::support::meshes;
use crate::support::random::Random;
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};
use skiagraph_gpu::{ExecuteError, Executor, Frame, device::Gpu};
use skiagraph_passes::{Error, PartId, PartMesh, Room, SceneProvider, SceneView};
use skiagraph_scene::{
    Camera, DirectionalLight, LightKind, Mesh, Movable, MoveError, Shadows, SpotLight, View,
};

const STEP: i32 = -2500;
const SIZES: [[u32; 2]; 2] = [[64, 48], [40, 32]];
const PRESETS: [&str; 2] = ["rt", "light_buffer"];
/// Kinds of parts; the skinned stone has vertices in a buffer of the host.
const FLOOR: usize = 0;
const STONES: [usize; 2] = [1, 2];
const LEAVES: usize = 3;
const SKINNED: usize = 4;

fn meshes() -> [Mesh; 4] {
    [
        meshes::box_over_floor(9.0, Vec3::splat(0.3)),
        meshes::potato(2, 0.2, 1),
        meshes::potato(1, 0.2, 1),
        meshes::foliage(20, 0.5, 0.1, 3),
    ]
}

struct Part {
    id: PartId,
    kind: usize,
    map: DAffine3,
}

struct Engine {
    gpu: Gpu,
    random: Random,
    meshes: [Mesh; 4],
    prepared: [PartMesh; 4],
    stones: crate::host_buffers::MegaBuffer,
    lift: i32,
    provider: SceneProvider,
    parts: Vec<Part>,
    views: Vec<(&'static str, SceneView, Executor)>,
    origin: DVec3,
}

impl Engine {
    fn new() -> Self {
        let (gpu, meshes) = (open(), meshes());
        // As loaders do it, on a thread of their own.
        let prepared = std::thread::scope(|scope| {
            let meshes = &meshes;
            let prepare = |mesh: &Mesh| PartMesh::new(mesh).unwrap().with_hierarchy();
            scope.spawn(move || meshes.each_ref().map(prepare)).join()
        });
        let prepared = prepared.unwrap();
        let stones = stones(&gpu);
        let light = LightKind::from(DirectionalLight::new(DVec3::NEG_Y));
        let mut provider = SceneProvider::from_parts(Movable::joined(&[]), light);
        let host = host_stone(&stones);
        let room = prepared.each_ref().map(|mesh| mesh.room(3)).into_iter();
        let room = room.fold(host.room(1), Room::and);
        provider.reserve(room, &gpu.device.limits()).unwrap();
        let mut random = Random(61);
        let mut parts = Vec::new();
        for kind in [FLOOR, STONES[0], LEAVES, STONES[1], SKINNED] {
            let map = place(kind, &mut random, DVec3::ZERO);
            let id = match kind {
                SKINNED => provider.add_host_part(host, &map),
                _ => provider.add_mesh(&prepared[kind], &map),
            };
            let id = id.unwrap();
            parts.push(Part { id, kind, map });
        }
        let mut engine = Self {
            gpu,
            random,
            meshes,
            prepared,
            stones,
            lift: 0,
            provider,
            parts,
            views: Vec::new(),
            origin: DVec3::ZERO,
        };
        for (number, size) in SIZES.into_iter().enumerate() {
            for (preset, light) in PRESETS.into_iter().zip(engine.lights()) {
                let camera = engine.camera(number, size);
                let view = SceneView::from_camera(&camera, light);
                let executor = start(&engine.gpu, preset, view.apply(&mut engine.provider), size);
                engine.views.push((preset, view, executor));
            }
        }
        engine
    }

    /// A sun and a spot light.
    fn lights(&self) -> [LightKind; 2] {
        let spot = SpotLight {
            position: DVec3::new(3.0, 9.0, 5.0) - self.origin,
            direction: DVec3::new(-0.3, -1.0, -0.5),
            cone_degrees: 80.0,
            radius: 0.0,
        };
        let sun = DirectionalLight::new(DVec3::new(0.4, -1.0, -0.3));
        [sun.into(), spot.into()]
    }

    /// The camera of a view, which trembles by less than a pixel.
    fn camera(&mut self, view: usize, size: [u32; 2]) -> Camera {
        let aside = 3e-3 * self.random.vector().as_dvec3();
        let eye = [DVec3::new(2.0, 8.0, 13.0), DVec3::new(-6.0, 5.0, 10.0)][view];
        let view = View {
            name: String::new(),
            eye: eye + aside - self.origin,
            direction: [DVec3::new(-0.1, -0.55, -1.0), DVec3::new(0.5, -0.4, -1.0)][view],
            fov_y_degrees: 50.0,
            far: 60.0,
            ..View::default()
        };
        view.camera(size)
    }

    fn pick(&mut self, count: usize) -> usize {
        (self.random.unit() * count as f32) as usize
    }

    /// A part of these kinds at random.
    fn part_of(&mut self, kinds: &[usize]) -> Option<usize> {
        let parts = self.parts.iter().enumerate();
        let parts = parts.filter(|(_, part)| kinds.contains(&part.kind));
        let parts: Vec<usize> = parts.map(|(at, _)| at).collect();
        let at = self.pick(parts.len());
        parts.get(at).copied()
    }

    /// One change at random.
    fn change(&mut self, encoder: &mut wgpu::CommandEncoder) {
        match self.pick(8) {
            0 | 1 => {
                let Some(at) = self.part_of(&[STONES[0], STONES[1], LEAVES, SKINNED]) else {
                    return;
                };
                let part = &mut self.parts[at];
                part.map = place(part.kind, &mut self.random, self.origin);
                self.provider.set_transform(part.id, &part.map).unwrap();
            }
            // Another level of detail.
            2 | 3 => {
                let Some(at) = self.part_of(&STONES) else {
                    return;
                };
                let part = &mut self.parts[at];
                part.kind = STONES[0] + STONES[1] - part.kind;
                let (mesh, map) = (&self.prepared[part.kind], &part.map);
                self.provider.replace_part(part.id, mesh, map).unwrap();
            }
            4 => {
                let step = STEP.cast_unsigned() & 0xffff;
                raise_in(&self.gpu, encoder, (&self.stones, 1), step);
                self.lift += STEP;
                let skinned = self.parts.iter().filter(|part| part.kind == SKINNED);
                let bounds = [Vec3::new(-1.0, -2.0, -1.0), Vec3::new(1.0, 2.0, 1.0)];
                for part in skinned {
                    self.provider.rewrite_part(part.id, bounds).unwrap();
                }
            }
            // Streamed in: where there is no room left, a chunk of it comes along.
            5 if self.parts.len() < 12 => {
                let kind = STONES[self.pick(2)];
                let map = place(kind, &mut self.random, self.origin);
                let id = self.provider.add_mesh(&self.prepared[kind], &map).unwrap();
                self.parts.push(Part { id, kind, map });
            }
            5 | 6 => {
                let Some(at) = self.part_of(&STONES) else {
                    return;
                };
                let part = self.parts.remove(at);
                self.provider.remove_part(part.id).unwrap();
            }
            // All is nearer to the origin.
            _ => {
                let shift = DVec3::new(64.0, 0.0, -32.0) * f64::from(self.random.signed());
                self.origin += shift;
                for part in &mut self.parts {
                    part.map = DAffine3::from_translation(-shift) * part.map;
                }
                let maps: Vec<DAffine3> = self.parts.iter().map(|part| part.map).collect();
                self.provider.set_transforms(&maps).unwrap();
            }
        }
    }

    /// Encodes all views, with new plans where the scene has other numbers of items.
    fn encode(&mut self, encoder: &mut wgpu::CommandEncoder, read: &[&str]) -> Vec<Camera> {
        let lights = self.lights();
        let cameras = [0, 1].map(|view| self.camera(view, SIZES[view]));
        for (number, (_, view, executor)) in self.views.iter_mut().enumerate() {
            view.set_camera(&cameras[number / 2]);
            view.set_light(lights[number % 2]).unwrap();
            let provider = &mut self.provider;
            match view.refresh_in(executor, provider, encoder) {
                Err(ExecuteError::OtherThanPlanned { .. }) => {
                    let mut provider = view.apply(provider).in_encoder(encoder).unwrap();
                    let plan = executor.plan().with(|request| request.provider = &provider);
                    let replaced = executor.replace_graph(plan.unwrap(), &mut provider);
                    replaced.unwrap();
                }
                refreshed => refreshed.unwrap(),
            }
            let frame = Frame::new().with_read(read);
            executor.encode(encoder, &frame).unwrap();
        }
        cameras.to_vec()
    }

    /// Pictures of the same parts in a scene that begins with them.
    fn expected(&self, cameras: &[Camera]) -> Vec<Vec<u32>> {
        let skinned = raised_stone(&self.stones, self.lift);
        let mesh = |part: &Part| self.meshes.get(part.kind).unwrap_or(&skinned).clone();
        let meshes: Vec<Mesh> = self.parts.iter().map(mesh).collect();
        let maps: Vec<DAffine3> = self.parts.iter().map(|part| part.map).collect();
        let parts = Movable::joined(&meshes.iter().collect::<Vec<_>>());
        let mut scene = SceneProvider::from_parts(parts, self.lights()[0]);
        scene.set_transforms(&maps).unwrap();
        let views = self.views.iter().enumerate();
        let picture = |(number, (_, _, own)): (usize, &(&str, SceneView, Executor))| {
            let view = SceneView::from_camera(&cameras[number / 2], self.lights()[number % 2]);
            let scene = view.apply(&mut scene);
            // The same graph, as loading it takes longer than all else.
            let plan = own.plan().with(|request| request.provider = scene);
            let mut executor = Executor::on(&self.gpu, plan.unwrap(), scene).unwrap();
            let report = graphs::frame(&self.gpu, &mut executor, &["visibility"]);
            values(&report, "visibility")
        };
        views.map(picture).collect()
    }
}

fn start(gpu: &Gpu, preset: &str, provider: &mut SceneProvider, size: [u32; 2]) -> Executor {
    let path = format!("pipelines/{preset}.ron");
    let plan = graphs::plan(&path, provider, size, |_| {});
    Executor::on(gpu, plan, provider).unwrap()
}

/// Somewhere over the floor; some stones are mirrored.
fn place(kind: usize, random: &mut Random, origin: DVec3) -> DAffine3 {
    if kind == FLOOR {
        return DAffine3::from_translation(-origin);
    }
    let at = random.vector().as_dvec3() * DVec3::new(4.0, 0.8, 3.0) + 1.6 * DVec3::Y;
    let turn = DMat3::from_quat(DQuat::from_rotation_y(f64::from(3.0 * random.signed())));
    let side = if random.unit() < 0.2 { -1.0 } else { 1.0 };
    let size = DMat3::from_diagonal(DVec3::new(0.9, 0.7, 0.8 * side));
    DAffine3::from_mat3_translation(turn * size, at - origin)
}

#[test]
fn pictures_of_an_engine_are_those_of_scenes_made_of_nothing() {
    const FRAMES: usize = 300;
    let mut engine = Engine::new();
    let mut shadows = 0;
    for turn in 0..FRAMES {
        if engine.random.unit() < 0.15 {
            // It is encoded, and never submitted.
            let mut lost = engine
                .gpu
                .device
                .create_command_encoder(&Default::default());
            if let Some(at) = engine.part_of(&STONES) {
                let part = &mut engine.parts[at];
                part.map = place(part.kind, &mut engine.random, engine.origin);
                engine.provider.set_transform(part.id, &part.map).unwrap();
            }
            engine.encode(&mut lost, &[]);
        }
        let mut encoder = engine
            .gpu
            .device
            .create_command_encoder(&Default::default());
        for _ in 0..engine.pick(4) {
            engine.change(&mut encoder);
        }
        let cameras = engine.encode(&mut encoder, &["visibility"]);
        engine.gpu.queue.submit([encoder.finish()]);
        let expected = engine.expected(&cameras);
        for (number, (preset, _, executor)) in engine.views.iter_mut().enumerate() {
            let report = executor.finish().unwrap();
            let seen = values(&report, "visibility");
            assert!(seen == expected[number], "{turn}: {preset}, {number}");
            shadows += seen.iter().filter(|lit| **lit == 0).count();
        }
    }
    assert!(shadows > 100 * FRAMES, "{shadows}");
}

/// A mesh that cannot be prepared is refused on its thread, and a part that cannot be replaced
/// stays.
#[test]
fn mistakes_leave_parts_as_they_were() {
    let mut engine = Engine::new();
    let mut mesh = engine.meshes[STONES[0]].clone();
    mesh.positions[5].y = f32::NAN;
    let error = std::thread::spawn(move || PartMesh::new(&mesh)).join();
    let error = error.unwrap().unwrap_err().to_string();
    let named = "position 5 of the mesh is [";
    assert!(error.starts_with(named), "{error}");
    let mut mesh = engine.meshes[STONES[0]].clone();
    mesh.triangles[2][1] = 70_000;
    let error = PartMesh::new(&mesh).unwrap_err();
    assert!(
        matches!(error, Error::Corner { index: 70_000, .. }),
        "{error}"
    );

    let mut mesh = engine.meshes[STONES[0]].clone();
    mesh.normal_indices[3][2] = 70_000;
    let error = PartMesh::new(&mesh).unwrap_err().to_string();
    assert!(
        error.starts_with("triangle 3 of the mesh has no normals"),
        "{error}"
    );

    let mut mesh = engine.meshes[LEAVES].clone();
    mesh.surfaces.of.truncate(7);
    let error = PartMesh::new(&mesh).unwrap_err().to_string();
    let named = "triangle 7 of the mesh has no material";
    assert!(error.starts_with(named), "{error}");
    let mut mesh = engine.meshes[LEAVES].clone();
    mesh.surfaces.uv_indices[4][0] = 70_000;
    let error = PartMesh::new(&mesh).unwrap_err().to_string();
    let named = "triangle 4 of the mesh has no texture coordinates";
    assert!(error.starts_with(named), "{error}");

    let before = engine.provider.scene().mesh.positions.clone();
    let (part, stone) = (&engine.parts[1], &engine.prepared[STONES[1]]);
    let flat = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
    let refused = engine.provider.replace_part(part.id, stone, &flat);
    let singular = MoveError::Singular { part: 1 };
    assert!(matches!(refused, Err(Error::Move(error)) if error == singular));
    let large = PartMesh::new(&meshes::potato(5, 0.2, 1)).unwrap();
    let limits = wgpu::Limits {
        max_storage_buffer_binding_size: 64_000,
        ..engine.gpu.device.limits()
    };
    engine.provider.reserve(Room::default(), &limits).unwrap();
    let refused = engine.provider.replace_part(part.id, &large, &part.map);
    assert!(
        matches!(refused, Err(Error::TooLarge { .. })),
        "{refused:?}"
    );
    assert!(engine.provider.scene().mesh.positions == before);
    let limits = engine.gpu.device.limits();
    engine.provider.reserve(Room::default(), &limits).unwrap();

    let gone = engine.parts.remove(3);
    engine.provider.remove_part(gone.id).unwrap();
    let stone = &engine.prepared[STONES[1]];
    let refused = engine.provider.replace_part(gone.id, stone, &gone.map);
    assert!(matches!(refused, Err(Error::NoPart(id)) if id == gone.id));
    // One that casts no shadow, nor its hierarchy.
    let mut silent = engine.meshes[STONES[0]].clone();
    silent.set_shadows(Shadows::Receives);
    let silent = PartMesh::new(&silent).unwrap().with_hierarchy();
    let at = (engine.parts[1].id, engine.parts[1].map);
    engine.provider.replace_part(at.0, &silent, &at.1).unwrap();
    let mut encoder = engine
        .gpu
        .device
        .create_command_encoder(&Default::default());
    engine.encode(&mut encoder, &[]);
    engine.gpu.queue.submit([encoder.finish()]);
    let stone = &engine.prepared[STONES[1]];
    // A stone of its own becomes the host's, and the host's one of its own.
    let ids: Vec<PartId> = engine.provider.parts().collect();
    let part = &mut engine.parts[1];
    let host = host_stone(&engine.stones);
    let replaced = engine
        .provider
        .replace_by_host_part(part.id, host, &part.map);
    replaced.unwrap();
    part.kind = SKINNED;
    let part = &mut engine.parts[3];
    (part.kind, part.map) = (STONES[1], DAffine3::from_translation(DVec3::Y));
    engine
        .provider
        .replace_part(part.id, stone, &part.map)
        .unwrap();
    assert!(engine.provider.parts().eq(ids));
    let mut encoder = engine
        .gpu
        .device
        .create_command_encoder(&Default::default());
    let cameras = engine.encode(&mut encoder, &["visibility"]);
    engine.gpu.queue.submit([encoder.finish()]);
    let expected = engine.expected(&cameras);
    for ((.., executor), expected) in engine.views.iter_mut().zip(expected) {
        let report = executor.finish().unwrap();
        assert!(values(&report, "visibility") == expected);
    }
}
