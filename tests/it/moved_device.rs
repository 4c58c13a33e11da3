//! A provider moves to another device, such as after the first was lost: of the same instance, and
//! of another one, whose devices and buffers have the numbers of those of the first.

use crate::support::{
    devices::{beside, of_own_instance, others},
    graphs::{self, values},
    meshes,
    random::Random,
};
use glam::{DAffine3, DVec3, Vec3};
use skiagraph_gpu::{ExecuteError, Executor, Frame, Provider, device::Gpu};
use skiagraph_graph::{Describe, Graph, PlanRequest, Provided};
use skiagraph_passes::{
    EmbeddedSources, Error, GpuMesh, GpuMeshError, HostDecoder, HostIndices, HostMesh,
    HostMeshError, HostVertices, PartId, SceneProvider, registry,
};
use skiagraph_scene::{
    Camera, DirectionalLight, Indexed, LightKind, Mesh, Movable, SpotLight, View,
};
use std::error::Error as _;
use wgpu::util::DeviceExt;

const SIZE: [u32; 2] = [48, 32];
const PRESETS: [&str; 3] = ["rt", "light_buffer", "crsm"];

fn camera(aside: f64) -> Camera {
    View {
        name: String::new(),
        eye: DVec3::new(7.0 + aside, 9.0, 24.0),
        direction: DVec3::new(0.0, -0.5, -1.0),
        fov_y_degrees: 50.0,
        far: 60.0,
        ..View::default()
    }
    .camera(SIZE)
}

fn sun(aside: f64) -> DirectionalLight {
    DirectionalLight::new(DVec3::new(0.4 + aside, -1.0, -0.3))
}

/// Vertices of a stone as a host has them: a position for each corner.
struct Stone {
    vertices: Vec<[f32; 3]>,
    indices: Vec<u32>,
}

impl Stone {
    fn new() -> Self {
        let stone = meshes::potato(2, 0.2, 1);
        let corners = stone.triangles.as_flattened().iter();
        let vertices = corners.map(|&corner| stone.positions[corner as usize].to_array());
        let vertices: Vec<[f32; 3]> = vertices.collect();
        let indices = (0..vertices.len() as u32).collect();
        Self { vertices, indices }
    }

    fn bytes(&self) -> &[u8] {
        bytemuck::cast_slice(&self.vertices)
    }

    /// Its vertices, uploaded to a device.
    fn on(&self, gpu: &Gpu) -> HostVertices {
        let buffer = upload(gpu, self.bytes(), wgpu::BufferUsages::STORAGE);
        HostVertices::new(&buffer, 0, 12, self.vertices.len() as u32)
    }

    fn host(&self, gpu: &Gpu) -> HostMesh {
        let on = (&gpu.device, &gpu.queue);
        let indices = HostIndices::U32(&self.indices);
        HostMesh::new(on, self.on(gpu), self.bytes(), indices).unwrap()
    }

    /// The same for our own buffers.
    fn mesh(&self) -> Mesh {
        Indexed {
            positions: &self.vertices,
            normals: &[],
            indices: &self.indices,
        }
        .mesh()
        .unwrap()
    }
}

fn upload(gpu: &Gpu, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let label = Some("a host's");
    let made = wgpu::util::BufferInitDescriptor {
        label,
        contents,
        usage,
    };
    gpu.device.create_buffer_init(&made)
}

/// Kinds of parts: a box over a floor, a stone, leaves with masks, a stone in a host's buffer.
const FLOOR: usize = 0;
const STONE: usize = 1;
const LEAVES: usize = 2;
const HOSTS: usize = 3;

/// A scene that a host has changed, and what is in it now.
struct Stage {
    meshes: [Mesh; 4],
    stone: Stone,
    host: HostMesh,
    scene: SceneProvider,
    /// Kind and place of each part, and its handle.
    parts: Vec<(usize, DAffine3, PartId)>,
    camera: Camera,
    lights: Vec<LightKind>,
}

fn place(x: f64, z: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, 1.5, z))
}

impl Stage {
    /// A floor and a stone, both moved since.
    fn new(gpu: &Gpu) -> Self {
        let stone = Stone::new();
        let meshes = [
            meshes::box_over_floor(12.0, Vec3::splat(0.4)),
            meshes::potato(2, 0.2, 1),
            meshes::foliage(40, 2.0, 4.0, 3),
            stone.mesh(),
        ];
        let joined = Movable::joined(&[&meshes[FLOOR], &meshes[STONE]]);
        let mut scene = SceneProvider::from_parts(joined, sun(0.0));
        scene.set_camera(&camera(0.0));
        let places = [place(7.0, 6.0), place(3.0, 5.0)];
        scene.set_transforms(&places).unwrap();
        let parts = [FLOOR, STONE].into_iter().zip(places).zip(scene.parts());
        Self {
            parts: parts.map(|((kind, map), id)| (kind, map, id)).collect(),
            host: stone.host(gpu),
            stone,
            meshes,
            scene,
            camera: camera(0.0),
            lights: vec![sun(0.0).into()],
        }
    }

    /// Parts of all kinds; some moved, mirrored and removed; several lights.
    fn changed(gpu: &Gpu) -> Self {
        let mut stage = Self::new(gpu);
        for (index, kind) in [HOSTS, LEAVES, STONE, HOSTS, LEAVES]
            .into_iter()
            .enumerate()
        {
            stage.add(kind, place(1.0 + 2.5 * index as f64, 8.0 - index as f64));
        }
        stage.remove(1);
        stage.remove(5);
        stage.put(
            2,
            place(4.0, 9.0) * DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0)),
        );
        stage.put(3, place(9.0, 4.0));
        let lamp = SpotLight {
            position: DVec3::new(6.0, 12.0, 6.0),
            direction: DVec3::NEG_Y,
            cone_degrees: 80.0,
            radius: 0.0,
        };
        stage.lights = vec![sun(0.2).into(), lamp.into(), sun(-0.3).into()];
        stage.scene.set_lights(&stage.lights).unwrap();
        stage.scene.set_light(stage.lights[0]);
        stage
    }

    fn add(&mut self, kind: usize, map: DAffine3) {
        let part = match kind {
            HOSTS => self.scene.add_host_part(&self.host, &map),
            _ => self.scene.add_part(&self.meshes[kind], &map),
        };
        self.parts.push((kind, map, part.unwrap()));
    }

    fn remove(&mut self, at: usize) {
        let (_, _, part) = self.parts.remove(at);
        self.scene.remove_part(part).unwrap();
    }

    fn put(&mut self, at: usize, map: DAffine3) {
        let (_, old_map, part) = &mut self.parts[at];
        *old_map = map;
        self.scene.set_transform(*part, &map).unwrap();
    }

    /// The handles of parts in the host's buffer.
    fn hosts(&self) -> Vec<PartId> {
        let parts = self.parts.iter().filter(|part| part.0 == HOSTS);
        parts.map(|part| part.2).collect()
    }

    /// Moves the scene, and the host's buffer.
    fn move_to(&mut self, gpu: &Gpu) {
        self.scene.move_to(&gpu.device);
        self.hand_over(gpu).unwrap();
    }

    /// Its lines are those of docs/embedding.md.
    fn hand_over(&mut self, gpu: &Gpu) -> Result<(), Box<dyn std::error::Error>> {
        let (device, provider, mesh) = (&gpu.device, &mut self.scene, &self.host);
        let vertices = self.stone.on(gpu);
        let mesh = mesh.with_vertices(device, vertices)?;
        provider.set_host_mesh(&mesh)?;
        self.host = mesh;
        Ok(())
    }

    /// The same scene, all of it in our own buffers, that was never moved or changed.
    fn fresh(&self) -> SceneProvider {
        let meshes = self.parts.iter().map(|part| &self.meshes[part.0]);
        let meshes: Vec<&Mesh> = meshes.collect();
        let maps: Vec<DAffine3> = self.parts.iter().map(|part| part.1).collect();
        let mut scene = SceneProvider::from_parts(Movable::joined(&meshes), sun(0.0));
        scene.set_transforms(&maps).unwrap();
        scene.set_camera(&self.camera);
        scene.set_lights(&self.lights).unwrap();
        scene.set_light(self.lights[0]);
        scene
    }

    /// Fails unless new executors show what they show of the fresh scene.
    fn is_as_fresh(&mut self, gpu: &Gpu) {
        let mut fresh = self.fresh();
        for preset in PRESETS {
            let expected = shown(gpu, &mut start(gpu, preset, &mut fresh));
            assert!(expected.contains(&0) && expected.contains(&1), "{preset}");
            let seen = shown(gpu, &mut start(gpu, preset, &mut self.scene));
            let wrong = seen.iter().zip(&expected).filter(|(a, b)| a != b).count();
            assert_eq!(wrong, 0, "{preset}");
        }
    }
}

fn start(gpu: &Gpu, preset: &str, provider: &mut SceneProvider) -> Executor {
    try_start(gpu, preset, provider).unwrap_or_else(|error| panic!("{error}"))
}

fn try_start(
    gpu: &Gpu,
    preset: &str,
    provider: &mut SceneProvider,
) -> Result<Executor, ExecuteError> {
    let path = format!("pipelines/{preset}.ron");
    let plan = graphs::plan(&path, provider, SIZE, |_| {});
    Executor::on(gpu, plan, provider)
}

fn shown(gpu: &Gpu, executor: &mut Executor) -> Vec<u32> {
    values(&graphs::frame(gpu, executor, &["visibility"]), "visibility")
}

/// Makes an executor after the device was lost; its lines are those of docs/embedding.md.
fn again(
    (device, queue): (&wgpu::Device, &wgpu::Queue),
    graph: &Graph,
    size: [u32; 2],
    provider: &mut SceneProvider,
) -> Result<Executor, Box<dyn std::error::Error>> {
    provider.move_to(device);
    let request = PlanRequest::new(size, provider).with_device(device.limits(), device.features());
    let executor = Executor::new(device, queue, graph.plan(&request)?, provider)?;
    Ok(executor)
}

#[test]
fn after_the_device_is_lost_the_recipe_shows_the_same() {
    for is_beside in [true, false] {
        let gpu = of_own_instance();
        let mut stage = Stage::changed(&gpu);
        let mut executors = PRESETS.map(|preset| start(&gpu, preset, &mut stage.scene));
        let before: Vec<Vec<u32>> = executors
            .iter_mut()
            .map(|executor| shown(&gpu, executor))
            .collect();
        gpu.device.destroy();
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        for executor in &mut executors {
            let error = executor.encode(&mut encoder, &Frame::default());
            assert!(matches!(error, Err(ExecuteError::DeviceLost(_))));
        }
        let next = if is_beside {
            beside(&gpu)
        } else {
            of_own_instance()
        };
        // Without the move it is the way out that is told.
        let error = try_start(&next, "rt", &mut stage.scene).unwrap_err();
        let text = error.to_string();
        assert!(matches!(error, ExecuteError::OtherDevice { .. }), "{text}");
        assert!(
            text.contains("the provider") && text.contains("SceneProvider::move_to"),
            "{text}"
        );
        let original = (
            stage.scene.parts().collect::<Vec<PartId>>(),
            stage.scene.lights().to_vec(),
            stage.scene.light(),
            stage.scene.scene().clone(),
        );
        stage.scene.move_to(&next.device);
        stage.hand_over(&next).unwrap();
        for (preset, expected) in PRESETS.iter().zip(&before) {
            let path = format!("pipelines/{preset}.ron");
            let graph = Graph::load(&path, &registry(), &EmbeddedSources).unwrap();
            let on = (&next.device, &next.queue);
            let mut executor = again(on, &graph, SIZE, &mut stage.scene).unwrap();
            assert!(shown(&next, &mut executor) == *expected, "{preset}");
        }
        stage.is_as_fresh(&next);
        let scene = &stage.scene;
        assert!(scene.parts().eq(original.0) && scene.lights() == original.1);
        assert!(scene.light() == original.2);
        assert!(scene.scene().mesh.positions == original.3.mesh.positions);
        // The old handles move parts on.
        let count = stage.parts.len();
        (0..count).for_each(|at| stage.put(at, place(2.0 + 2.0 * at as f64, 7.0)));
        stage.add(HOSTS, place(8.0, 8.0));
        stage.remove(1);
        stage.is_as_fresh(&next);
    }
}

/// A scene without parts, which keeps no trees.
#[test]
fn a_scene_at_rest_moves_too() {
    let gpu = of_own_instance();
    let mut scene = SceneProvider::from_mesh(meshes::foliage(60, 2.0, 8.0, 3), sun(0.0));
    scene.set_camera(&camera(0.0));
    let before = PRESETS.map(|preset| shown(&gpu, &mut start(&gpu, preset, &mut scene)));
    let mut from = gpu;
    for next in others(&from.clone()) {
        scene.move_to(&next.device);
        let after = PRESETS.map(|preset| shown(&next, &mut start(&next, preset, &mut scene)));
        assert!(before == after);
        // The one before is still there, and refuses it now.
        let error = try_start(&from, "rt", &mut scene).unwrap_err();
        assert!(matches!(error, ExecuteError::OtherDevice { .. }), "{error}");
        from = next;
    }
}

/// Each resource is built again with the bytes that it had, also after several changes.
#[test]
fn what_is_built_again_is_what_there_was() {
    let gpu = of_own_instance();
    for is_deformed in [false, true] {
        let mut stage = Stage::changed(&gpu);
        if is_deformed {
            // Without hosts' parts there is a hierarchy in light space, too.
            let hosts = stage.hosts();
            hosts
                .iter()
                .for_each(|part| stage.scene.remove_part(*part).unwrap());
            let (mut positions, normals) = {
                let mesh = &stage.scene.scene().mesh;
                (mesh.positions.clone(), mesh.normals.clone())
            };
            positions.iter_mut().for_each(|at| at.y *= 1.1);
            stage.scene.deform(positions, normals).unwrap();
        }
        let described = |scene: &SceneProvider, name: &String| {
            let provided = scene.describe(name);
            provided.is_some() && provided != Some(Provided::ACCELERATION_STRUCTURE)
        };
        let mut names = stage.scene.names();
        names.retain(|name| described(&stage.scene, name) && name != "scene.embree");
        names.retain(|name| is_deformed || !name.starts_with("scene.light_space"));
        let read = |gpu: &Gpu, scene: &mut SceneProvider| -> Vec<Vec<u8>> {
            let names = names.iter();
            names
                .map(|name| graphs::resource_bytes(gpu, scene, name))
                .collect()
        };
        let before = read(&gpu, &mut stage.scene);
        for next in others(&gpu) {
            stage.scene.move_to(&next.device);
            if !is_deformed {
                stage.hand_over(&next).unwrap();
            }
            let after = read(&next, &mut stage.scene);
            for (name, (before, after)) in names.iter().zip(before.iter().zip(&after)) {
                assert!(before == after, "{name}");
            }
        }
    }
}

/// One provider cannot serve two devices at once; a branch for each can.
#[test]
fn two_devices_take_a_branch_each() {
    let gpu = of_own_instance();
    for other in others(&gpu) {
        let mut stage = Stage::changed(&gpu);
        let mut executor = start(&gpu, "rt", &mut stage.scene);
        let expected = shown(&gpu, &mut executor);
        let mut branch = stage.scene.branch();
        let error = try_start(&other, "rt", &mut branch)
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("executors on two devices need a provider each"),
            "{error}"
        );
        branch.move_to(&other.device);
        stage
            .hosts()
            .iter()
            .for_each(|part| branch.remove_part(*part).unwrap());
        let mut second = start(&other, "rt", &mut branch);
        assert!(shown(&other, &mut second) != expected);
        executor.refresh(&mut stage.scene).unwrap();
        assert!(shown(&gpu, &mut executor) == expected);
        // Each executor is told of the other's provider, though nothing has changed.
        for (executor, provider) in [
            (&mut executor, &mut branch),
            (&mut second, &mut stage.scene),
        ] {
            let error = executor.refresh(provider);
            assert!(matches!(error, Err(ExecuteError::OtherDevice { .. })));
        }
        assert!(shown(&gpu, &mut executor) == expected);
        // Back again, where executors have not forgotten.
        stage.scene.move_to(&other.device);
        assert!(executor.refresh(&mut stage.scene).is_err());
        stage.scene.move_to(&gpu.device);
        executor.refresh(&mut stage.scene).unwrap();
        assert!(shown(&gpu, &mut executor) == expected);
    }
}

/// Calls of a provider without an executor.
#[test]
fn calls_with_another_device_are_named() {
    let gpu = of_own_instance();
    for other in others(&gpu) {
        let mut stage = Stage::changed(&gpu);
        start(&gpu, "rt", &mut stage.scene);
        let scene = &mut stage.scene;
        let (device, queue) = (&other.device, &other.queue);
        let plan = graphs::plan("pipelines/rt.ron", scene, SIZE, |_| {});
        let bounds = scene.check_bounds(device, queue).unwrap_err();
        assert!(matches!(bounds, Error::OtherDevice("the provider")));
        let errors = [
            bounds.to_string(),
            scene
                .build("scene.positions", device, queue)
                .unwrap_err()
                .to_string(),
            scene.prepare(&plan, device, queue).unwrap_err().to_string(),
        ];
        for error in errors {
            assert!(error.contains("`SceneProvider::move_to`"), "{error}");
        }
        // A mesh of the other device, for a provider of this one.
        let theirs = stage.stone.host(&other);
        let map = place(0.0, 0.0);
        for error in [
            scene.add_host_part(&theirs, &map).unwrap_err(),
            scene.set_host_mesh(&theirs).unwrap_err(),
        ] {
            let text = error.to_string();
            let is_mesh = matches!(error, Error::OtherDevice("the host's mesh"));
            assert!(is_mesh && text.contains("move_to"), "{text}");
        }
        // For one that is on no device yet it counts later, when it is used.
        let mut early = SceneProvider::from_parts(Movable::joined(&[]), sun(0.0));
        early.set_camera(&camera(0.0));
        let part = early.add_host_part(&theirs, &map).unwrap();
        let error = try_start(&gpu, "rt", &mut early).unwrap_err();
        assert!(error.to_string().contains(&format!("{part:?}")), "{error}");

        let (rest, indices) = (stage.stone.bytes(), HostIndices::U32(&stage.stone.indices));
        let on = (&gpu.device, &gpu.queue);
        let foreign = HostMesh::new(on, stage.stone.on(&other), rest, indices);
        assert!(matches!(foreign, Err(HostMeshError::OtherDevice("buffer"))));
        let decode = "fn decode_position(first: u32) -> vec3<f32> { return vec3(1.0); }";
        let decoder = HostDecoder::of_positions(device, decode).unwrap();
        let vertices = stage.stone.on(&gpu).with_decoder(&decoder);
        let foreign = HostMesh::new(on, vertices, rest, indices);
        assert!(matches!(
            foreign,
            Err(HostMeshError::OtherDevice("decoder"))
        ));
        let foreign = stage
            .host
            .with_vertices(&gpu.device, stage.stone.on(&other));
        assert!(matches!(foreign, Err(HostMeshError::OtherDevice("buffer"))));

        let usage = wgpu::BufferUsages::COPY_SRC;
        let index_bytes: &[u8] = bytemuck::cast_slice(&stage.stone.indices);
        let [own, foreign] = [&gpu, &other]
            .map(|gpu| [rest, index_bytes].map(|content| upload(gpu, content, usage)));
        for (vertices, indices, what) in [
            (&foreign[0], &own[1], "vertices"),
            (&own[0], &foreign[1], "indices"),
        ] {
            let mesh = GpuMesh {
                vertices: vertices.slice(..),
                stride: 12,
                position: 0,
                normal: None,
                indices: indices.slice(..),
                format: wgpu::IndexFormat::Uint32,
            };
            let error = mesh.read(&gpu.device, &gpu.queue).unwrap_err();
            assert!(
                matches!(error, GpuMeshError::OtherDevice(content) if content == what),
                "{error}"
            );
        }
    }
}

/// Fails unless an error lists these parts, and says what to do.
fn names_parts(error: &ExecuteError, expected: &[PartId]) {
    let text = error.to_string();
    let reason = error.source().and_then(|why| why.source());
    let reason = reason.and_then(|why| why.downcast_ref::<Error>());
    let Some(Error::HostVertices { parts, .. }) = reason else {
        panic!("{text}");
    };
    let [mut named, mut expected] = [&parts[..], expected].map(<[PartId]>::to_vec);
    named.sort();
    expected.sort();
    assert_eq!(named, expected);
    assert!(
        expected
            .iter()
            .all(|part| text.contains(&format!("{part:?}"))),
        "{text}"
    );
    assert!(text.contains("SceneProvider::set_host_mesh"), "{text}");
}

#[test]
fn parts_of_a_hosts_buffer_are_named_until_it_hands_over_another() {
    let gpu = of_own_instance();
    for other in others(&gpu) {
        let mut stage = Stage::changed(&gpu);
        start(&gpu, "rt", &mut stage.scene);
        stage.scene.move_to(&other.device);
        let hosts = stage.hosts();
        assert_eq!(hosts.len(), 2);
        for preset in PRESETS {
            names_parts(
                &try_start(&other, preset, &mut stage.scene).unwrap_err(),
                &hosts,
            );
        }
        let error = stage.scene.check_bounds(&other.device, &other.queue);
        assert!(matches!(error, Err(Error::HostVertices { parts, .. }) if parts == hosts));
        // One that is removed is no matter any more, nor is one that is handed over.
        let mut branch = stage.scene.branch();
        branch.remove_part(hosts[0]).unwrap();
        names_parts(
            &try_start(&other, "rt", &mut branch).unwrap_err(),
            &hosts[1..],
        );
        branch.remove_part(hosts[1]).unwrap();
        start(&other, "rt", &mut branch);
        let count = stage.stone.vertices.len() as u32;
        let buffer = upload(&other, stage.stone.bytes(), wgpu::BufferUsages::STORAGE);
        let fewer = HostVertices::new(&buffer, 0, 12, count - 1);
        let fewer = stage.host.with_vertices(&other.device, fewer).unwrap_err();
        let expected = HostMeshError::OtherVertices {
            mesh: (count, false),
            given: (count - 1, false),
        };
        assert_eq!(fewer, expected);
        stage.hand_over(&other).unwrap();
        stage.is_as_fresh(&other);
        stage
            .scene
            .check_bounds(&other.device, &other.queue)
            .unwrap();
        // A mesh of its own is none of theirs.
        assert_eq!(
            stage
                .scene
                .set_host_mesh(&stage.stone.host(&other))
                .unwrap(),
            0
        );
    }
}

/// On the device that there is, too; and only those of that buffer.
#[test]
fn a_destroyed_buffer_is_named_by_its_parts() {
    let gpu = graphs::open();
    let mut stage = Stage::changed(&gpu);
    let buffer = upload(&gpu, stage.stone.bytes(), wgpu::BufferUsages::STORAGE);
    let count = stage.stone.vertices.len() as u32;
    let indices = HostIndices::U32(&stage.stone.indices);
    let vertices = HostVertices::new(&buffer, 0, 12, count);
    let on = (&gpu.device, &gpu.queue);
    let lost = HostMesh::new(on, vertices, stage.stone.bytes(), indices).unwrap();
    let parts = [6.0, 9.0].map(|x| stage.scene.add_host_part(&lost, &place(x, 3.0)).unwrap());
    let mut executors = PRESETS.map(|preset| start(&gpu, preset, &mut stage.scene));
    buffer.destroy();
    for executor in &mut executors {
        executor.refresh(&mut stage.scene).unwrap();
    }
    stage
        .scene
        .set_transform(parts[1], &place(9.0, 2.0))
        .unwrap();
    for (executor, first) in executors.iter_mut().zip([1, 0, 0]) {
        // Then all are read again, as the buffer that they were written to is given up.
        names_parts(
            &executor.refresh(&mut stage.scene).unwrap_err(),
            &parts[first..],
        );
    }
    let error = stage
        .scene
        .check_bounds(&gpu.device, &gpu.queue)
        .unwrap_err();
    let Error::HostVertices {
        parts: mut named,
        why,
    } = error
    else {
        panic!("{error}");
    };
    let mut expected = parts.to_vec();
    named.sort();
    expected.sort();
    assert!(named == expected && why.contains("destroyed"), "{why}");
    // Another buffer, and all is well.
    let vertices = stage.stone.on(&gpu);
    let lost = lost.with_vertices(&gpu.device, vertices).unwrap();
    assert_eq!(stage.scene.set_host_mesh(&lost).unwrap(), 2);
    for executor in &mut executors {
        executor.refresh(&mut stage.scene).unwrap();
    }
    for (part, at) in parts.into_iter().zip([place(6.0, 3.0), place(9.0, 2.0)]) {
        stage.parts.push((HOSTS, at, part));
    }
    stage.is_as_fresh(&gpu);
}

/// A host that moves, adds and removes parts, turns its camera and its light, and loses its device
/// now and then, shows in each of so many frames what a scene shows that was made for it. Returns
/// how often it was on another device.
fn changing_host(frames: usize, seed: u64) -> usize {
    let mut gpu = of_own_instance();
    let mut stage = Stage::new(&gpu);
    let mut executors: Vec<Executor> = Vec::new();
    let mut random = Random(seed);
    let mut moves = 0;
    for frame in 0..frames {
        let [which, x, z] = [0; 3].map(|_| f64::from(random.unit()));
        let at = place(2.0 + 10.0 * x, 2.0 + 8.0 * z);
        let one = 1 + (x * (stage.parts.len() - 1) as f64) as usize;
        match (10.0 * which) as u32 {
            0..=2 => stage.put(one.min(stage.parts.len() - 1), at),
            3 | 4 => stage.add(1 + (3.0 * z) as usize, at),
            5 if stage.parts.len() > 2 => stage.remove(one.min(stage.parts.len() - 1)),
            6 => {
                stage.camera = camera(x);
                stage.scene.set_camera(&stage.camera);
            }
            7 => {
                stage.lights = vec![sun(x - 0.5).into()];
                stage.scene.set_lights(&stage.lights).unwrap();
                stage.scene.set_light(stage.lights[0]);
            }
            8 | 9 => {
                let next = if x < 0.5 {
                    beside(&gpu)
                } else {
                    of_own_instance()
                };
                if z < 0.5 {
                    gpu.device.destroy();
                }
                for executor in &mut executors {
                    stage.scene.move_to(&next.device);
                    let error = executor.refresh(&mut stage.scene).unwrap_err();
                    let is_told = matches!(
                        error,
                        ExecuteError::OtherDevice { .. } | ExecuteError::DeviceLost(_)
                    );
                    assert!(is_told, "frame {frame}: {error}");
                }
                stage.move_to(&next);
                executors.clear();
                gpu = next;
                moves += 1;
            }
            _ => {}
        }
        let refreshed = executors
            .iter_mut()
            .try_for_each(|executor| executor.refresh(&mut stage.scene));
        match refreshed {
            Ok(()) => {}
            Err(ExecuteError::OtherThanPlanned { .. }) => executors.clear(),
            Err(error) => panic!("frame {frame}: {error}"),
        }
        if executors.is_empty() {
            let presets = PRESETS[..2].iter();
            executors = presets
                .map(|preset| start(&gpu, preset, &mut stage.scene))
                .collect();
        }
        let mut fresh = stage.fresh();
        for (preset, executor) in PRESETS.iter().zip(&mut executors) {
            let expected = shown(&gpu, &mut start(&gpu, preset, &mut fresh));
            assert!(shown(&gpu, executor) == expected, "frame {frame}: {preset}");
        }
    }
    moves
}

#[test]
fn a_host_that_changes_devices_shows_what_is_there() {
    let moves = changing_host(20, 56);
    assert!(moves > 2, "{moves}");
}

#[test]
#[ignore = "takes minutes: `.ci/long` runs it"]
fn ci_long_a_host_that_changes_devices_shows_what_is_there() {
    let moves = changing_host(500, 57);
    assert!(moves > 50, "{moves}");
}
