//! Parts whose vertices stay in a host's own buffers: quantised, in a mega-buffer, moved, rewritten
//! by the host, removed. They are held against the same positions decoded and uploaded by us.

use crate::support::{
    graphs::{self, open, values},
    meshes,
    random::Random,
};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use skiagraph_gpu::{Executor, Frame, Provider, device::Gpu};
use skiagraph_graph::Describe;
use skiagraph_passes::{
    Error, HostDecoder, HostIndices, HostMesh, HostMeshError, HostVertices, PartId, Room,
    SceneProvider, Work,
};
use skiagraph_reference::{Oracle, OracleMode, Progress, Statistics, statistics::status};
use skiagraph_scene::{Camera, DirectionalLight, Indexed, Material, Mesh, Movable, Shadows, View};
use wgpu::{BufferUsages, VertexFormat, util::DeviceExt};

pub const VIEWPORT: [u32; 2] = [96, 64];

fn sun() -> DirectionalLight {
    DirectionalLight::new(DVec3::new(0.4, -1.0, -0.3))
}

pub fn camera(size: [u32; 2]) -> Camera {
    View {
        name: String::new(),
        eye: DVec3::new(2.0, 9.0, 14.0),
        direction: DVec3::new(-0.1, -0.55, -1.0),
        fov_y_degrees: 50.0,
        far: 60.0,
        ..View::default()
    }
    .camera(size)
}

/// How a mesh that fits -1 to 1 lies in the host's vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Packing {
    /// `Snorm16x4`, from -1 to 1.
    Snorm16,
    /// `Unorm16x4`, from 0 to 1: the rest is in the map of the part.
    Unorm16,
    /// Ten bits a coordinate, which no format of ours is: [`PACKED`] decodes them.
    Bits10,
}

/// A mesh as engines keep them: small positions, 8-bit normals, 16-bit indices.
struct Quantised {
    packing: Packing,
    /// Bytes of the vertices, 12 each, or 8 of those of ten bits.
    vertices: Vec<u8>,
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    indices: Vec<u16>,
}

const STRIDE: u64 = 12;

/// The module of docs/embedding.md.
const PACKED: &str = "
    fn decode_position(first: u32) -> vec3<f32> {
        let bits = (vec3(vertices[first]) >> vec3(0u, 10u, 20u)) & vec3(1023u);
        return vec3<f32>(bits) / 512.0 - 1.0;
    }

    fn decode_normal(first: u32) -> vec3<f32> {
        return unpack4x8snorm(vertices[first + 1u]).xyz;
    }
";

/// Its text is that of docs/embedding.md.
fn packed_vertices(
    device: &wgpu::Device,
    buffer: &wgpu::Buffer,
    offset: u64,
    count: u32,
) -> Result<HostVertices, HostMeshError> {
    let decoder = HostDecoder::of_positions_and_normals(device, PACKED)?;
    let vertices = HostVertices::new(buffer, offset, 8, count).with_decoder(&decoder);
    Ok(vertices)
}

impl Quantised {
    /// Quantises a mesh that fits -1 to 1; a vertex for each corner.
    fn new(mesh: &Mesh, packing: Packing) -> Self {
        let mut own = Self {
            packing,
            vertices: Vec::new(),
            positions: Vec::new(),
            normals: Vec::new(),
            indices: Vec::new(),
        };
        for (corners, normals) in mesh.triangles.iter().zip(&mesh.normal_indices) {
            for (&corner, &normal) in corners.iter().zip(normals) {
                own.indices.push(own.positions.len() as u16);
                own.append(mesh.positions[corner as usize].to_array());
                let across = mesh.normals[normal as usize].to_array();
                let across = across.map(|x| (x * 127.0).round() as i8);
                own.vertices
                    .extend(across.iter().chain(&[0]).map(|c| *c as u8));
                own.normals.push(across.map(|c| f32::from(c) / 127.0));
            }
        }
        own
    }

    fn append(&mut self, at: [f32; 3]) {
        let words = |at: [u16; 3]| {
            let words = at.into_iter().chain([0]);
            words.flat_map(u16::to_le_bytes).collect::<Vec<u8>>()
        };
        let (bytes, position) = match self.packing {
            Packing::Snorm16 => {
                let at = at.map(|x| (x * 32767.0).round() as i16);
                let position = at.map(|c| f32::from(c) / 32767.0);
                (words(at.map(i16::cast_unsigned)), position)
            }
            Packing::Unorm16 => {
                let at = at.map(|x| ((0.5 * x + 0.5) * 65535.0).round() as u16);
                (words(at), at.map(|c| f32::from(c) / 65535.0))
            }
            Packing::Bits10 => {
                let at = at.map(|x| ((x + 1.0) * 512.0).round().min(1023.0) as u32);
                let packed = at[0] | at[1] << 10 | at[2] << 20;
                let position = at.map(|c| c as f32 / 512.0 - 1.0);
                (packed.to_le_bytes().to_vec(), position)
            }
        };
        self.vertices.extend(bytes);
        self.positions.push(position);
    }

    /// The map of its part that takes a mesh of -1 to 1 to a place.
    fn map(&self, place: &DAffine3) -> DAffine3 {
        match self.packing {
            Packing::Unorm16 => {
                let minus = DAffine3::from_translation(DVec3::NEG_ONE);
                *place * minus * DAffine3::from_scale(DVec3::splat(2.0))
            }
            _ => *place,
        }
    }

    /// The mesh in a buffer, from a byte on.
    fn at(&self, gpu: &Gpu, buffer: &wgpu::Buffer, offset: u64) -> Result<HostMesh, HostMeshError> {
        let on = (&gpu.device, &gpu.queue);
        let count = self.positions.len() as u32;
        let wide: Vec<u32> = self.indices.iter().map(|&index| index.into()).collect();
        let indices = HostIndices::U32(&wide);
        let vertices = match self.packing {
            Packing::Snorm16 => return self.of_the_document(on, buffer, offset),
            Packing::Unorm16 => HostVertices::new(buffer, offset, STRIDE, count)
                .with_position(VertexFormat::Unorm16x4, 0)
                .with_normal(VertexFormat::Snorm8x4, 8),
            Packing::Bits10 => packed_vertices(&gpu.device, buffer, offset, count)?,
        };
        HostMesh::new(on, vertices, &self.vertices, indices)
    }

    /// Its text is that of docs/embedding.md.
    fn of_the_document(
        &self,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        buffer: &wgpu::Buffer,
        offset: u64,
    ) -> Result<HostMesh, HostMeshError> {
        let (mesh, count) = (self, self.positions.len() as u32);
        let vertices = HostVertices::new(buffer, offset, STRIDE, count)
            .with_position(VertexFormat::Snorm16x4, 0)
            .with_normal(VertexFormat::Snorm8x4, 8);
        let indices = HostIndices::U16(&mesh.indices);
        HostMesh::new((device, queue), vertices, &mesh.vertices, indices)
    }

    /// The mesh decoded to f32.
    fn mesh(&self) -> Mesh {
        let indices: Vec<u32> = self.indices.iter().map(|&index| index.into()).collect();
        Indexed {
            positions: &self.positions,
            normals: &self.normals,
            indices: &indices,
        }
        .mesh()
        .unwrap()
    }
}

/// Some meshes after each other in one buffer, with other bytes before the first one.
pub struct MegaBuffer {
    buffer: wgpu::Buffer,
    meshes: Vec<Quantised>,
    hosts: Vec<HostMesh>,
}

const BEFORE: usize = 4 * 77;

impl MegaBuffer {
    fn new(gpu: &Gpu, meshes: Vec<Quantised>) -> Self {
        let mut content = vec![0xa5; BEFORE];
        let offsets = meshes.iter().map(|mesh| {
            let offset = content.len() as u64;
            content.extend(&mesh.vertices);
            offset
        });
        let offsets: Vec<u64> = offsets.collect();
        let buffer = upload(gpu, &content);
        let hosts = meshes.iter().zip(offsets);
        let hosts = hosts.map(|(mesh, offset)| mesh.at(gpu, &buffer, offset).unwrap());
        let hosts = hosts.collect();
        Self {
            buffer,
            meshes,
            hosts,
        }
    }
}

fn upload(gpu: &Gpu, contents: &[u8]) -> wgpu::Buffer {
    gpu.device
        .create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("the host's vertices"),
            contents,
            usage: BufferUsages::VERTEX | BufferUsages::STORAGE | BufferUsages::COPY_DST,
        })
}

pub fn stones(gpu: &Gpu) -> MegaBuffer {
    stones_of(gpu, 3, Packing::Snorm16)
}

/// A floor, and a stone that is cut so many times.
fn stones_of(gpu: &Gpu, cuts: u32, packing: Packing) -> MegaBuffer {
    let floor = meshes::box_over_floor(1.0, Vec3::splat(0.3));
    let shrunk = |mesh: &Mesh| {
        let mut mesh = mesh.clone();
        let most = mesh.positions.iter().map(|at| at.abs().max_element());
        let most = most.fold(0.0, f32::max);
        mesh.positions.iter_mut().for_each(|at| *at /= most);
        Quantised::new(&mesh, packing)
    };
    let meshes = vec![shrunk(&floor), shrunk(&meshes::potato(cuts, 0.2, 1))];
    MegaBuffer::new(gpu, meshes)
}

/// The floor, and stones over it: number of the mesh, and its map.
pub fn places(turn: usize) -> Vec<(usize, DAffine3)> {
    let mut places = vec![(0, DAffine3::from_scale(DVec3::splat(9.0)))];
    for index in 0..6 {
        let angle = 0.37 * (index + turn) as f64;
        let turned = DMat3::from_rotation_y(angle) * DMat3::from_rotation_z(0.7 * angle);
        let size = DVec3::new(0.9, 0.7, if index == 2 { -0.8 } else { 0.8 });
        let at = DVec3::new(
            3.0 * (index % 3) as f64 - 3.0,
            1.3 + angle.sin(),
            3.5 * (index / 3) as f64 - 2.0,
        );
        let matrix = turned * DMat3::from_diagonal(size);
        places.push((1, DAffine3::from_mat3_translation(matrix, at)));
    }
    places
}

/// A scene of parts of a host's buffers, in room for them, and one of the same parts uploaded.
pub fn scenes(
    stones: &MegaBuffer,
    places: &[(usize, DAffine3)],
    limits: &wgpu::Limits,
) -> [SceneProvider; 2] {
    let mut host = SceneProvider::from_parts(Movable::joined(&[]), sun());
    let room = places.iter().map(|(mesh, _)| stones.hosts[*mesh].room(1));
    let room = room.fold(Room::default(), Room::and);
    host.reserve(room, limits).unwrap();
    let maps = places
        .iter()
        .map(|(mesh, map)| stones.meshes[*mesh].map(map));
    let maps: Vec<DAffine3> = maps.collect();
    for ((mesh, _), map) in places.iter().zip(&maps) {
        host.add_host_part(&stones.hosts[*mesh], map).unwrap();
    }
    let meshes: Vec<Mesh> = stones.meshes.iter().map(Quantised::mesh).collect();
    let parts: Vec<&Mesh> = places.iter().map(|(mesh, _)| &meshes[*mesh]).collect();
    let mut uploaded = SceneProvider::from_parts(Movable::joined(&parts), sun());
    uploaded.set_transforms(&maps).unwrap();
    [host, uploaded].map(|mut scene| {
        scene.set_camera(&camera(VIEWPORT));
        scene
    })
}

pub fn start(gpu: &Gpu, preset: &str, provider: &mut SceneProvider) -> Executor {
    let path = format!("pipelines/{preset}.ron");
    let plan = graphs::plan(&path, provider, VIEWPORT, |_| {});
    Executor::on(gpu, plan, provider).unwrap()
}

pub fn shown(gpu: &Gpu, executor: &mut Executor) -> Vec<u32> {
    values(&graphs::frame(gpu, executor, &["visibility"]), "visibility")
}

/// The lines of docs/embedding.md, whose text `readme.rs` compares with this file.
fn part_of_the_document(gpu: &Gpu) -> Result<Work, Box<dyn std::error::Error>> {
    let stone = &stones(gpu).hosts[1];
    let place = DAffine3::from_translation(DVec3::Y);
    let mut provider = SceneProvider::from_parts(Movable::joined(&[]), sun());
    provider.reserve(stone.room(20), &gpu.device.limits())?;
    let part = provider.add_host_part(stone, &place)?;
    provider.set_camera(&camera(VIEWPORT));
    let mut executor = start(gpu, "light_buffer", &mut provider);
    let bounds = [Vec3::splat(-2.0), Vec3::splat(2.0)];
    let before = provider.work();
    provider.rewrite_part(part, bounds)?;
    executor.refresh(&mut provider)?;
    Ok(provider.work().since(before))
}

#[test]
fn the_part_of_the_document_is_written_by_the_gpu() {
    let gpu = open();
    let work = part_of_the_document(&gpu).unwrap();
    assert!(
        work.moved > 0 && work.uploaded <= 3 * (192 + 32) + 32 + 144,
        "{work:?}"
    );
}

#[test]
fn parts_of_a_mega_buffer_are_traced_as_uploaded_ones() {
    let gpu = open();
    let [mut host, mut uploaded] = scenes(&stones(&gpu), &places(0), &gpu.device.limits());
    let seen = shown(&gpu, &mut start(&gpu, "rt", &mut host));
    let expected = shown(&gpu, &mut start(&gpu, "rt", &mut uploaded));
    assert!(expected.contains(&0) && expected.contains(&1));
    let wrong = seen.iter().zip(&expected).filter(|(a, b)| a != b);
    assert_eq!(wrong.count(), 0);
}

/// Stones that cast nothing are in no hierarchy, list or map, uploaded or not.
#[test]
fn host_parts_have_the_roles_of_their_meshes() {
    let gpu = open();
    let stones = stones(&gpu);
    let roles = [Shadows::Both, Shadows::Receives, Shadows::Casts];
    let providers = || {
        let mut host = SceneProvider::from_parts(Movable::joined(&[]), sun());
        let room = stones.hosts[0].room(1).and(stones.hosts[1].room(6));
        host.reserve(room, &gpu.device.limits()).unwrap();
        let meshes: Vec<Mesh> = stones.meshes.iter().map(Quantised::mesh).collect();
        let (mut uploaded, mut maps) = (Vec::new(), Vec::new());
        for (number, (mesh, map)) in places(0).into_iter().enumerate() {
            let shadows = roles[number % 3];
            let part = stones.hosts[mesh].clone().with_shadows(shadows);
            host.add_host_part(&part, &map).unwrap();
            let mut mesh = meshes[mesh].clone();
            mesh.set_shadows(shadows);
            uploaded.push(mesh);
            maps.push(map);
        }
        let parts: Vec<&Mesh> = uploaded.iter().collect();
        let mut uploaded = SceneProvider::from_parts(Movable::joined(&parts), sun());
        uploaded.set_transforms(&maps).unwrap();
        [host, uploaded].map(|mut scene| {
            scene.set_camera(&camera(VIEWPORT));
            scene
        })
    };
    let casters = |scene: &SceneProvider| scene.describe("scene.casters").unwrap().items;
    for preset in ["rt", "light_buffer", "crsm"] {
        let [mut host, mut uploaded] = providers();
        let triangles = uploaded.scene().mesh.triangles.len() as u64;
        assert!(casters(&host) == casters(&uploaded) && casters(&host) < Some(triangles));
        let mut executor = start(&gpu, preset, &mut host);
        let seen = shown(&gpu, &mut executor);
        let expected = shown(&gpu, &mut start(&gpu, preset, &mut uploaded));
        assert!(expected.contains(&0) && expected.contains(&1));
        assert!(seen == expected, "{preset}");
        // They move, too.
        let places = places(3);
        let maps: Vec<DAffine3> = places.iter().map(|(_, map)| *map).collect();
        host.set_transforms(&maps).unwrap();
        uploaded.set_transforms(&maps).unwrap();
        executor.refresh(&mut host).unwrap();
        let expected = shown(&gpu, &mut start(&gpu, preset, &mut uploaded));
        assert!(shown(&gpu, &mut executor) == expected, "{preset}, moved");
    }
}

/// Leaves with holes, seen from both sides, in a host's buffer and uploaded.
#[test]
fn host_parts_have_the_materials_of_their_meshes() {
    let gpu = open();
    let mut leaves = meshes::foliage(40, 0.7, 0.8, 3);
    leaves
        .positions
        .iter_mut()
        .for_each(|at| *at = (*at / 2.0).clamp(Vec3::NEG_ONE, Vec3::ONE));
    let triangles = 0..leaves.triangles.len() as u32;
    let uvs = triangles.flat_map(|id| leaves.surfaces.corner_uvs(id).map(|uv| uv.to_array()));
    let uvs: Vec<[f32; 2]> = uvs.collect();
    let materials = leaves.surfaces.materials.iter();
    let mut masked = materials.filter(|material| material.mask.is_some());
    let masked = Material {
        double_sided: true,
        ..masked.next().unwrap().clone()
    };
    let own = Quantised::new(&leaves, Packing::Snorm16);
    let buffer = upload(&gpu, &own.vertices);
    let host_mesh = |material: &Material, uvs: &[[f32; 2]]| {
        let vertices = HostVertices::new(&buffer, 0, STRIDE, own.positions.len() as u32)
            .with_position(VertexFormat::Snorm16x4, 0)
            .with_normal(VertexFormat::Snorm8x4, 8);
        let on = (&gpu.device, &gpu.queue);
        let indices = HostIndices::U16(&own.indices);
        HostMesh::new_of_material(
            on,
            vertices,
            &own.vertices,
            indices,
            (material.clone(), uvs),
        )
    };
    let error = host_mesh(&masked, &uvs[1..]).unwrap_err().to_string();
    let expected = format!(
        "there are {} texture coordinates for {} positions: give one each",
        uvs.len() - 1,
        uvs.len()
    );
    assert!(error.contains(&expected), "{error}");

    let floor = meshes::box_over_floor(9.0, Vec3::splat(0.3));
    let indices: Vec<u32> = own.indices.iter().map(|&index| index.into()).collect();
    let indexed = Indexed {
        positions: &own.positions,
        normals: &own.normals,
        indices: &indices,
    };
    let place = |x: f64| {
        let at = DAffine3::from_translation(DVec3::new(x, 3.0, 1.0));
        at * DAffine3::from_scale(DVec3::splat(4.0))
    };
    let frame = frame_around();
    let identity = DAffine3::IDENTITY;
    let maps = |x: f64| [identity, identity, place(x), place(x + 3.0)];
    for (material, uvs) in [(masked, &uvs[..]), (Material::default(), &[])] {
        let mut host = SceneProvider::from_parts(Movable::joined(&[&floor, &frame]), sun());
        host.set_transforms(&maps(0.0)[..2]).unwrap();
        let part = host_mesh(&material, uvs).unwrap();
        let mesh = indexed.mesh_of(material, uvs).unwrap();
        for map in &maps(0.0)[2..] {
            host.add_host_part(&part, map).unwrap();
        }
        let uploaded = Movable::joined(&[&floor, &frame, &mesh, &mesh]);
        let mut uploaded = SceneProvider::from_parts(uploaded, sun());
        uploaded.set_transforms(&maps(0.0)).unwrap();
        let mut scenes = [host, uploaded];
        scenes
            .iter_mut()
            .for_each(|scene| scene.set_camera(&camera(VIEWPORT)));
        for preset in ["rt", "light_buffer", "crsm"] {
            let mut executors = scenes.each_mut().map(|scene| start(&gpu, preset, scene));
            for x in [0.0, -1.5] {
                let mut seen = Vec::new();
                for (scene, executor) in scenes.iter_mut().zip(&mut executors) {
                    scene.set_transforms(&maps(x)).unwrap();
                    executor.refresh(scene).unwrap();
                    seen.push(shown(&gpu, executor));
                }
                assert!(seen[0].contains(&0) && seen[0].contains(&1));
                assert!(seen[0] == seen[1], "{preset}, {x}");
            }
        }
    }
}

/// Formats with the size of a component in bytes, and its decoder.
type Decoder = fn(&[u8]) -> f32;
const FORMATS: [(VertexFormat, usize, Decoder); 11] = [
    (VertexFormat::Float32x3, 4, |c| {
        f32::from_le_bytes([c[0], c[1], c[2], c[3]])
    }),
    (VertexFormat::Float32x4, 4, |c| {
        f32::from_le_bytes([c[0], c[1], c[2], c[3]])
    }),
    (VertexFormat::Float16x4, 2, |c| {
        half(u16::from_le_bytes([c[0], c[1]]))
    }),
    (VertexFormat::Snorm16x4, 2, |c| signed(c) / 32767.0),
    (VertexFormat::Unorm16x4, 2, |c| unsigned(c) / 65535.0),
    (VertexFormat::Sint16x4, 2, signed),
    (VertexFormat::Uint16x4, 2, unsigned),
    (VertexFormat::Snorm8x4, 1, |c| f32::from(c[0] as i8) / 127.0),
    (VertexFormat::Unorm8x4, 1, |c| f32::from(c[0]) / 255.0),
    (VertexFormat::Sint8x4, 1, |c| f32::from(c[0] as i8)),
    (VertexFormat::Uint8x4, 1, |c| f32::from(c[0])),
];

fn signed(c: &[u8]) -> f32 {
    f32::from(i16::from_le_bytes([c[0], c[1]]))
}

fn unsigned(c: &[u8]) -> f32 {
    f32::from(u16::from_le_bytes([c[0], c[1]]))
}

fn half(bits: u16) -> f32 {
    let size = match bits >> 10 & 31 {
        0 => f64::from(bits & 0x3ff) / f64::from(1 << 24),
        exponent => f64::from((bits & 0x3ff) | 0x400) * 2f64.powi(i32::from(exponent) - 25),
    };
    (if bits >> 15 == 1 { -size } else { size }) as f32
}

/// Reads a buffer of the scene back, as tests may.
pub fn contents(gpu: &Gpu, provider: &mut SceneProvider, name: &str) -> Vec<u32> {
    bytemuck::pod_collect_to_vec(&graphs::resource_bytes(gpu, provider, name))
}

/// Maps by which f64 rounds in all its ways: near and far, small and large, with ties, cancelling.
fn maps(random: &mut Random) -> Vec<DAffine3> {
    let mut maps = vec![
        DAffine3::IDENTITY,
        DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0)),
        DAffine3::from_scale_rotation_translation(
            DVec3::splat(0.5),
            glam::DQuat::IDENTITY,
            DVec3::splat(f64::from(1 << 24) + 0.5),
        ),
        DAffine3::from_scale(DVec3::splat(1e-42)),
        DAffine3::from_scale(DVec3::splat(3e32)),
    ];
    for power in [-20, -3, 0, 0, 0, 4, 11] {
        let mut wide = || {
            let fine = f64::from(random.signed()) + f64::from(random.signed()) * 2f64.powi(-26);
            fine * 2f64.powi((random.signed() * 8.0) as i32)
        };
        let columns = [0; 9].map(|_| wide() * 2f64.powi(power));
        let at = DVec3::new(wide(), wide(), wide()) * 2f64.powi(power + 6);
        let mut matrix = DMat3::from_cols_array(&columns);
        if power == 4 {
            // The sum of three products is nearly 0, but no matrix of these is singular.
            let aside = matrix.x_axis.cross(matrix.y_axis).normalize();
            matrix.z_axis =
                (matrix.x_axis + aside) * 2f64.powi(-30) - matrix.x_axis - matrix.y_axis;
        }
        maps.push(DAffine3::from_mat3_translation(matrix, at));
    }
    maps
}

#[test]
fn positions_are_to_the_bit_those_that_the_cpu_moves() {
    let (gpu, mut random) = (open(), Random(40));
    let count = 96;
    for (format, size, decode) in FORMATS {
        let stride = format.size() + 8;
        let component = |random: &mut Random, index: usize| {
            let mut bytes = [0; 4].map(|_| (random.unit() * 256.0) as u8);
            match format {
                VertexFormat::Float16x4 if bytes[1] & 0x7c == 0x7c => bytes[1] &= 0xbf,
                VertexFormat::Float32x3 | VertexFormat::Float32x4 => {
                    let power = if index.is_multiple_of(9) { -130 } else { 3 };
                    bytes = (random.signed() * 2f32.powi(power)).to_le_bytes();
                }
                _ => {}
            }
            bytes
        };
        let (mut rest, mut positions) = (Vec::new(), Vec::new());
        for vertex in 0..count {
            let mut own = vec![0x5a; stride as usize];
            let position = [0, 1, 2].map(|axis| {
                let bytes = component(&mut random, vertex + axis);
                let at = 4 + axis * size;
                own[at..at + size].copy_from_slice(&bytes[..size]);
                decode(&bytes[..size]).max(if size < 4 { -65536.0 } else { f32::MIN })
            });
            let norm = [VertexFormat::Snorm16x4, VertexFormat::Snorm8x4].contains(&format);
            positions.push(position.map(|c| if norm { c.max(-1.0) } else { c }));
            rest.extend(own);
        }
        let buffer = upload(&gpu, &rest);
        let indices: Vec<u16> = (0..count as u16).collect();
        let vertices = HostVertices::new(&buffer, 0, stride, count as u32).with_position(format, 4);
        let host = HostMesh::new(
            (&gpu.device, &gpu.queue),
            vertices,
            &rest,
            HostIndices::U16(&indices),
        );
        let host = host.unwrap();
        let wide: Vec<u32> = (0..count as u32).collect();
        let mesh = Indexed {
            positions: &positions,
            normals: &[],
            indices: &wide,
        };
        let mesh = mesh.mesh().unwrap();
        let mut scene = SceneProvider::from_parts(Movable::joined(&[]), sun());
        let part = scene.add_host_part(&host, &DAffine3::IDENTITY).unwrap();
        for map in maps(&mut random) {
            let moved = Movable::joined(&[&mesh]).moved(&[map]);
            let expected = moved.unwrap_or_else(|error| panic!("{format:?} {map}: {error}"));
            scene.set_transform(part, &map).unwrap();
            let placed = contents(&gpu, &mut scene, "scene.positions");
            for (index, at) in expected.positions.iter().enumerate() {
                let own = &placed[4 * index..4 * index + 4];
                let expected = at.extend(1.0).to_array().map(|c| (c + 0.0).to_bits());
                let own = [0, 1, 2, 3].map(|axis| (f32::from_bits(own[axis]) + 0.0).to_bits());
                assert_eq!(own, expected, "{format:?} {index} {map}: {at}");
            }
        }
    }
}

/// A part that is uploaded, around all others: the light is laid around it alone.
fn frame_around() -> Mesh {
    let mut positions = vec![];
    let mut triangles = vec![];
    let mut triangle = |corners: [Vec3; 3]| {
        let first = positions.len() as u32;
        positions.extend(corners);
        triangles.push([first, first + 1, first + 2]);
    };
    for [x, z] in [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]] {
        for y in [-12.0, 12.0] {
            let at = Vec3::new(30.0 * x, y, 30.0 * z);
            triangle([at, at - Vec3::X * x, at - Vec3::Z * z]);
        }
    }
    meshes::mesh(positions, triangles)
}

/// The scenes of [`scenes`], with the frame around both.
fn framed(
    stones: &MegaBuffer,
    places: &[(usize, DAffine3)],
    limits: &wgpu::Limits,
) -> [SceneProvider; 2] {
    let frame = frame_around();
    scenes(stones, places, limits).map(|mut scene| {
        scene.reserve(Room::of_copies(&frame, 1), limits).unwrap();
        scene.add_part(&frame, &DAffine3::IDENTITY).unwrap();
        scene
    })
}

/// A picture of each preset. `crsm_hw` needs a feature that software adapters lack.
#[test]
fn every_preset_draws_parts_of_a_hosts_buffer_as_uploaded_ones() {
    let (gpu, size) = (open(), [48, 32]);
    let stones = stones(&gpu);
    let [mut host, mut uploaded] = framed(&stones, &places(0), &gpu.device.limits());
    for scene in [&mut host, &mut uploaded] {
        scene.set_camera(&camera(size));
    }
    for preset in skiagraph_passes::presets() {
        if preset.name == "crsm_hw" {
            continue;
        }
        let draw = |scene: &mut SceneProvider| {
            let plan = graphs::plan(&preset.path, scene, size, |_| {});
            let report = graphs::run_on(&gpu, plan, scene, &["visibility"]);
            report.readbacks.into_iter().next().unwrap().content
        };
        assert!(draw(&mut host) == draw(&mut uploaded), "{}", preset.name);
    }
}

#[test]
fn exact_presets_are_right_on_16_bit_buffers_of_a_host() {
    for packing in [Packing::Snorm16, Packing::Unorm16] {
        exact_presets_are_right(packing);
    }
}

#[test]
fn exact_presets_are_right_on_vertices_that_a_module_of_the_host_decodes() {
    let lines = PACKED
        .lines()
        .map(|line| line.strip_prefix("    ").unwrap_or(line));
    let module = lines.collect::<Vec<_>>().join("\n");
    assert!(include_str!("../../docs/embedding.md").contains(module.trim()));
    exact_presets_are_right(Packing::Bits10);
}

/// The pixels of a preset, judged by the oracle over the uploaded scene.
fn exact_presets_are_right(packing: Packing) {
    let gpu = open();
    let stones = stones_of(&gpu, 3, packing);
    let [mut host, mut uploaded] = scenes(&stones, &places(3), &gpu.device.limits());
    let expected = shown(&gpu, &mut start(&gpu, "rt", &mut uploaded));
    let oracle = Oracle::new(&uploaded.scene().mesh);
    host.check_bounds(&gpu.device, &gpu.queue).unwrap();
    for preset in ["rt", "light_buffer", "crsm"] {
        let path = format!("pipelines/{preset}.ron");
        let plan = graphs::plan(&path, &host, VIEWPORT, |request| {
            let primitives = skiagraph_graph::Capture::new("primitive");
            request.captures.push(primitives);
        });
        let mut executor = Executor::on(&gpu, plan, &mut host).unwrap();
        let names = ["visibility", "status", "primitive"];
        let report = graphs::frame(&gpu, &mut executor, &names);
        let [seen, statuses, primitives] = names.map(|name| values(&report, name));
        let truth = oracle.shade(
            &camera(VIEWPORT),
            sun(),
            &primitives,
            OracleMode::Exact,
            Progress::default(),
        );
        let counts = Statistics::judged(&seen, &statuses, &truth.unwrap()).unwrap();
        let what = format!("{packing:?} {preset}: {counts:?}");
        println!("{what}");
        assert!(
            counts.pixels.lit > 500 && counts.pixels.shadow > 150,
            "{what}"
        );
        assert!(counts.indeterminate_share() < 3e-3, "{what}");
        let split = [&counts.split.lit, &counts.split.shadow];
        let wrong = split.map(|class| class.certain_wrong_outside_band);
        assert_eq!(wrong, [0, 0], "{what}");
        let is_certain =
            |word: &u32| [status::CERTAIN_LIGHT, status::CERTAIN_SHADOW].contains(word);
        assert_eq!(counts.wrong.total, counts.wrong.in_band, "{what}");
        if preset == "crsm" {
            assert!(statuses.iter().filter(|word| is_certain(word)).count() > 500);
        }
        let pixels = seen.iter().zip(&statuses).zip(&expected);
        let asked = pixels.filter(|((_, word), _)| preset != "crsm" || is_certain(word));
        let differing = asked.filter(|((seen, _), ray)| seen != ray).count();
        assert_eq!(differing, 0, "{what}");
    }
}

/// Files of a folder and those below.
fn sources(folder: &std::path::Path) -> Vec<std::path::PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let below = |path: std::path::PathBuf| {
        if path.is_dir() {
            sources(&path)
        } else {
            vec![path]
        }
    };
    paths.flat_map(below).collect()
}

/// The scene's positions on the CPU are those at rest, however the GPU has rewritten and moved
/// them; one function of the provider's crate maps a buffer, and frames do not call it.
#[test]
fn frames_read_nothing_back() {
    let gpu = open();
    let stones = stones(&gpu);
    let [mut host, _] = scenes(&stones, &places(0)[..2], &gpu.device.limits());
    let part = host.parts().nth(1).unwrap();
    let at_rest = host.scene().mesh.positions.clone();
    let mut executors = ["rt", "light_buffer", "crsm"].map(|name| start(&gpu, name, &mut host));
    for turn in 1..4 {
        raise(&gpu, &stones, 1, 100);
        let bounds = [Vec3::splat(-1.0), Vec3::new(1.0, 1.1, 1.0)];
        host.rewrite_part(part, bounds).unwrap();
        host.set_transforms(&places_of(&places(turn)[..2])).unwrap();
        let before = host.work();
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        for executor in &mut executors {
            executor.refresh(&mut host).unwrap();
            executor.encode(&mut encoder, &Frame::new()).unwrap();
        }
        gpu.queue.submit([encoder.finish()]);
        // Records of two parts for each of three buffers, roots, the light.
        let work = host.work().since(before);
        assert!(
            work.uploaded <= 3 * 2 * (192 + 32) + 32 * 5 + 4 * 144,
            "{work:?}"
        );
        assert_eq!(host.scene().mesh.positions, at_rest);
    }
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/passes/src");
    let mentions = |word: &str| {
        let files = sources(&root).into_iter();
        let files = files
            .filter(|path| std::fs::read_to_string(path).is_ok_and(|text| text.contains(word)));
        let names = files.map(|path| path.file_name().unwrap().to_string_lossy().into_owned());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    };
    assert_eq!(mentions("map_async"), [""; 0]);
    assert_eq!(mentions("DownloadBuffer::read_buffer("), ["host.rs"]);
    // `HostMesh::new` with a module of the host, and `check_bounds`.
    assert_eq!(mentions("host::read("), ["rest.rs", "writes.rs"]);
}

#[test]
fn mistakes_in_a_module_of_the_host_are_named() {
    let gpu = open();
    let made = |wgsl: &str| HostDecoder::of_positions(&gpu.device, wgsl);
    let right = "fn decode_position(first: u32) -> vec3<f32> { return vec3(f32(first)); }";
    assert!(made(right).is_ok());
    let error = |wgsl: &str| made(wgsl).unwrap_err().to_string();
    let none = error("");
    assert!(
        none.starts_with(
            "the module that decodes a host's vertices cannot be compiled; it needs \
             `decode_position(first: u32) -> vec3<f32>`:\n"
        ) && none.contains("no definition in scope for identifier"),
        "{none}"
    );
    let line = error("\nfn decode_position(first: u32) -> vec3<f32> { return vertex; }");
    assert!(line.contains("`vertex`") && line.contains(":2:"), "{line}");
    let normals = HostDecoder::of_positions_and_normals(&gpu.device, right);
    let normals = normals.unwrap_err().to_string();
    assert!(
        normals.contains("`decode_position` and `decode_normal`"),
        "{normals}"
    );
    let own = Quantised::new(&meshes::potato(2, 0.2, 1), Packing::Bits10);
    let buffer = upload(&gpu, &own.vertices);
    let decoder = HostDecoder::of_positions_and_normals(&gpu.device, PACKED).unwrap();
    let make = |stride: u64, count: u32, rest: &[u8]| {
        let vertices = HostVertices::new(&buffer, 0, stride, count).with_decoder(&decoder);
        let on = (&gpu.device, &gpu.queue);
        HostMesh::new(on, vertices, rest, HostIndices::U16(&own.indices)).map(|_| ())
    };
    let count = own.positions.len() as u32;
    assert_eq!(make(8, count, &own.vertices), Ok(()));
    let short = make(8, count, &own.vertices[1..]);
    assert!(
        matches!(short, Err(HostMeshError::Rest { .. })),
        "{short:?}"
    );
    let beyond = make(8, count + 1, &own.vertices);
    assert!(
        matches!(beyond, Err(HostMeshError::Beyond { .. })),
        "{beyond:?}"
    );
    // All vertices are the first one.
    let one = make(0, count, &own.vertices[..4]);
    assert_eq!(one, Err(HostMeshError::Empty));
    assert_eq!(make(8, 0, &own.vertices), Err(HostMeshError::Empty));
}

/// Moves parts in each frame. The CPU writes records of them, whatever their triangles.
#[test]
fn parts_of_a_hosts_buffer_move_without_their_vertices() {
    let gpu = open();
    let stones = stones(&gpu);
    let [mut host, mut uploaded] = scenes(&stones, &places(0), &gpu.device.limits());
    let presets = ["rt", "light_buffer", "crsm"];
    let mut executors = presets.map(|preset| start(&gpu, preset, &mut host));
    let mut references = presets.map(|preset| start(&gpu, preset, &mut uploaded));
    for turn in 1..6 {
        let maps: Vec<DAffine3> = places(turn).into_iter().map(|(_, map)| map).collect();
        let before = host.work();
        host.set_transforms(&maps).unwrap();
        uploaded.set_transforms(&maps).unwrap();
        for executor in &mut executors {
            executor.refresh(&mut host).unwrap();
        }
        let work = host.work().since(before);
        // Records of six parts for each of three buffers, roots, the light, and turned triangles.
        assert!(
            work.uploaded < 3 * (6 * 192 + 32) + 32 * 13 + 4 * 144,
            "{work:?}"
        );
        assert!(work.laid <= 2 * 8 * 7, "{work:?}");
        let pairs = executors.iter_mut().zip(&mut references);
        for ((executor, other), preset) in pairs.zip(presets) {
            other.refresh(&mut uploaded).unwrap();
            let (seen, expected) = (shown(&gpu, executor), shown(&gpu, other));
            // Its map is laid around bounds, so other pixels are certain.
            assert!(preset == "crsm" || seen == expected, "{preset} {turn}");
        }
        let before = host.work();
        host.set_transforms(&maps).unwrap();
        executors[0].refresh(&mut host).unwrap();
        assert_eq!(host.work(), before, "nothing moved");
    }
}

/// Uploaded parts move on both sides of one in a host's buffer that stays, and the other way round.
#[test]
fn parts_of_both_kinds_keep_off_each_other() {
    let gpu = open();
    // Few positions: a patch would otherwise write those between two parts along with them.
    let stones = stones_of(&gpu, 1, Packing::Snorm16);
    let meshes: Vec<Mesh> = stones.meshes.iter().map(Quantised::mesh).collect();
    let begun = places(0);
    let room = begun.iter().map(|(mesh, _)| stones.hosts[*mesh].room(1));
    let room = room.fold(Room::default(), Room::and);
    let [mut mixed, mut uploaded] = [true, false].map(|is_mixed| {
        let mut scene = SceneProvider::from_parts(Movable::joined(&[]), sun());
        scene.reserve(room, &gpu.device.limits()).unwrap();
        for (index, (mesh, map)) in begun.iter().enumerate() {
            if is_mixed && index.is_multiple_of(2) {
                scene.add_host_part(&stones.hosts[*mesh], map).unwrap();
            } else {
                scene.add_part(&meshes[*mesh], map).unwrap();
            }
        }
        scene.set_camera(&camera(VIEWPORT));
        scene
    });
    let presets = ["rt", "light_buffer"];
    let mut executors = presets.map(|preset| start(&gpu, preset, &mut mixed));
    let mut references = presets.map(|preset| start(&gpu, preset, &mut uploaded));
    let mut maps = places_of(&begun);
    for turn in 1..6 {
        for (index, (_, map)) in places(turn).into_iter().enumerate() {
            if turn == 5 || index % 2 == turn % 2 {
                maps[index] = map;
            }
        }
        let before = mixed.work();
        mixed.set_transforms(&maps).unwrap();
        uploaded.set_transforms(&maps).unwrap();
        for ((executor, other), preset) in executors.iter_mut().zip(&mut references).zip(presets) {
            executor.refresh(&mut mixed).unwrap();
            other.refresh(&mut uploaded).unwrap();
            let (seen, expected) = (shown(&gpu, executor), shown(&gpu, other));
            let wrong = seen.iter().zip(&expected).filter(|(a, b)| a != b);
            assert_eq!(wrong.count(), 0, "{preset} {turn}");
        }
        assert!(mixed.work().since(before).copied > 0, "patched");
        let [own, expected] = [&mut mixed, &mut uploaded].map(|scene| {
            let bits = contents(&gpu, scene, "scene.positions").into_iter();
            bits.map(f32::from_bits).collect::<Vec<f32>>()
        });
        assert!(own == expected, "{turn}");
    }
}

/// A host's pass that raises the vertices of a mesh: `amount` in steps of 1 / 32767, by the sign of
/// their x. It adds integers, so the CPU knows what comes out.
const RAISE: &str = "
    @group(0) @binding(0) var<storage, read_write> vertices: array<u32>;
    @group(0) @binding(1) var<uniform> range: vec4<u32>; // first word, vertices, amount

    @compute @workgroup_size(64)
    fn raise(@builtin(global_invocation_id) id: vec3<u32>) {
        if id.x >= range.y { return; }
        let word = range.x + 3u * id.x;
        let x = bitcast<i32>(vertices[word] << 16u) >> 16u;
        let y = (vertices[word] >> 16u) + select(0u, range.z, x > 0);
        vertices[word] = (vertices[word] & 0xffffu) | (y << 16u);
    }
";

fn raise(gpu: &Gpu, stones: &MegaBuffer, mesh: usize, amount: u32) {
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    raise_in(gpu, &mut encoder, (stones, mesh), amount);
    gpu.queue.submit([encoder.finish()]);
}

/// Records the pass into an encoder.
pub fn raise_in(
    gpu: &Gpu,
    encoder: &mut wgpu::CommandEncoder,
    (stones, mesh): (&MegaBuffer, usize),
    amount: u32,
) {
    let module = gpu
        .device
        .create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("raise"),
            source: wgpu::ShaderSource::Wgsl(RAISE.into()),
        });
    let pipeline = gpu
        .device
        .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("raise"),
            layout: None,
            module: &module,
            entry_point: Some("raise"),
            compilation_options: Default::default(),
            cache: None,
        });
    let before = stones.meshes[..mesh].iter().map(|mesh| mesh.vertices.len());
    let first = (BEFORE + before.sum::<usize>()) as u32 / 4;
    let count = stones.meshes[mesh].positions.len() as u32;
    let range = [first, count, amount, 0];
    let range = gpu
        .device
        .create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents: bytemuck::cast_slice(&range),
            usage: BufferUsages::UNIFORM,
        });
    let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[
            wgpu::BindGroupEntry {
                binding: 0,
                resource: stones.buffer.as_entire_binding(),
            },
            wgpu::BindGroupEntry {
                binding: 1,
                resource: range.as_entire_binding(),
            },
        ],
    });
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups(count.div_ceil(64), 1, 1);
}

/// The same on the CPU.
fn raised(stone: &Quantised, amount: i32) -> Quantised {
    let raised = stone.positions.iter().map(|&[x, y, z]| {
        let y = (y * 32767.0).round() as i32 + if x > 0.0 { amount } else { 0 };
        // Sums wrap, as in the pass.
        [x, (f32::from(y as i16) / 32767.0).max(-1.0), z]
    });
    Quantised {
        packing: stone.packing,
        vertices: Vec::new(),
        positions: raised.collect(),
        normals: stone.normals.clone(),
        indices: stone.indices.clone(),
    }
}

pub fn places_of(maps: &[(usize, DAffine3)]) -> Vec<DAffine3> {
    maps.iter().map(|(_, map)| *map).collect()
}

/// The stone, raised by so much.
pub fn raised_stone(stones: &MegaBuffer, lift: i32) -> Mesh {
    raised(&stones.meshes[1], lift).mesh()
}

/// Destroys the vertices.
pub fn destroy(stones: &MegaBuffer) {
    stones.buffer.destroy();
}

/// The stone as the host has it.
pub fn host_stone(stones: &MegaBuffer) -> &HostMesh {
    &stones.hosts[1]
}

/// Floor and stones uploaded, the stones raised by so much.
pub fn uploaded(stones: &MegaBuffer, places: &[(usize, DAffine3)], lift: i32) -> SceneProvider {
    let meshes = [stones.meshes[0].mesh(), raised_stone(stones, lift)];
    let parts: Vec<&Mesh> = places.iter().map(|(mesh, _)| &meshes[*mesh]).collect();
    let mut uploaded = SceneProvider::from_parts(Movable::joined(&parts), sun());
    uploaded.set_transforms(&places_of(places)).unwrap();
    uploaded.set_camera(&camera(VIEWPORT));
    uploaded
}

/// A stone that is torn apart by a pass of the host: the trees stay, their boxes follow.
#[test]
fn a_part_that_the_host_has_rewritten_is_traced_as_it_is() {
    let gpu = open();
    let stones = stones(&gpu);
    // The only part of its mesh.
    let places = &places(2)[..2];
    let [mut host, _] = scenes(&stones, places, &gpu.device.limits());
    let part = host.parts().nth(1).unwrap();
    let presets = ["rt", "light_buffer"];
    let mut executors = presets.map(|preset| start(&gpu, preset, &mut host));
    let at_rest = shown(&gpu, &mut executors[0]);
    let (mut lift, step) = (0, -9000i32);
    for _ in 0..2 {
        lift += step;
        raise(&gpu, &stones, 1, step.cast_unsigned() & 0xffff);
        let bounds = [Vec3::new(-1.0, -1.6, -1.0), Vec3::ONE];
        host.rewrite_part(part, bounds).unwrap();
        host.check_bounds(&gpu.device, &gpu.queue).unwrap();
        let mut uploaded = uploaded(&stones, places, lift);
        for (executor, preset) in executors.iter_mut().zip(presets) {
            executor.refresh(&mut host).unwrap();
            let seen = shown(&gpu, executor);
            let expected = shown(&gpu, &mut start(&gpu, preset, &mut uploaded));
            assert!(seen == expected, "{preset}");
            assert!(seen != at_rest, "{preset}");
        }
    }
    // Bounds that lie.
    let bounds = [-Vec3::ONE, Vec3::ONE * 0.2];
    host.rewrite_part(part, bounds).unwrap();
    let error = host.check_bounds(&gpu.device, &gpu.queue).unwrap_err();
    let text = error.to_string();
    assert!(
        text.starts_with("vertex ") && text.contains("state larger ones by `rewrite_part`"),
        "{text}"
    );
    let Error::Beyond {
        part: named,
        vertex,
        ..
    } = error
    else {
        panic!("{error}");
    };
    assert_eq!(named, part);
    let own = Vec3::from(raised(&stones.meshes[1], lift).positions[vertex as usize]);
    assert!(
        own.cmpgt(bounds[1]).any() || own.cmplt(bounds[0]).any(),
        "{own}"
    );
    for bounds in [[Vec3::ONE, Vec3::NAN], [Vec3::NEG_INFINITY, Vec3::ONE]] {
        let lie = host.rewrite_part(part, bounds).unwrap_err();
        assert!(
            matches!(lie, Error::Bounds { part: named, .. } if named == part),
            "{lie}"
        );
    }
}

/// A vertex that no index names, equal to one at rest, is the host's to write.
#[test]
fn a_vertex_that_no_triangle_uses_moves_nothing() {
    let gpu = open();
    let own = Quantised::new(&meshes::potato(1, 0.2, 1), Packing::Snorm16);
    let stride = STRIDE as usize;
    let rest = [&own.vertices[3 * stride..4 * stride], &own.vertices[..]].concat();
    let buffer = upload(&gpu, &rest);
    let count = own.positions.len() as u32 + 1;
    let vertices = HostVertices::new(&buffer, 0, STRIDE, count);
    let vertices = vertices.with_position(VertexFormat::Snorm16x4, 0);
    let indices: Vec<u16> = own.indices.iter().map(|index| index + 1).collect();
    let on = (&gpu.device, &gpu.queue);
    let mesh = HostMesh::new(on, vertices, &rest, HostIndices::U16(&indices)).unwrap();
    let mut scene = SceneProvider::from_parts(Movable::joined(&[]), sun());
    let part = scene.add_host_part(&mesh, &DAffine3::IDENTITY).unwrap();
    let before = contents(&gpu, &mut scene, "scene.positions");
    gpu.queue.write_buffer(&buffer, 0, &[0x11; 8]);
    scene.rewrite_part(part, mesh.bounds()).unwrap();
    assert!(before == contents(&gpu, &mut scene, "scene.positions"));
    scene.check_bounds(&gpu.device, &gpu.queue).unwrap();
}

/// Frames that were encoded before show a part that is removed, or moved, since.
#[test]
fn a_part_may_be_removed_while_frames_are_under_way() {
    let gpu = open();
    let stones = stones(&gpu);
    let places = places(1);
    let [mut host, _] = scenes(&stones, &places, &gpu.device.limits());
    let removed = host.parts().last().unwrap();
    let mut executor = start(&gpu, "rt", &mut host);
    let complete = shown(&gpu, &mut executor);
    let read = Frame::new().with_read(&["visibility"]);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    executor.encode(&mut encoder, &read).unwrap();
    host.remove_part(removed).unwrap();
    let refused = host.rewrite_part(removed, [-Vec3::ONE, Vec3::ONE]);
    assert!(matches!(refused, Err(Error::NoPart(part)) if part == removed));
    executor.refresh(&mut host).unwrap();
    executor.encode(&mut encoder, &read).unwrap();
    gpu.queue.submit([encoder.finish()]);
    let under_way = values(&executor.finish().unwrap(), "visibility");
    let after = values(&executor.finish().unwrap(), "visibility");
    assert!(under_way == complete && after != complete);
    let [mut without, _] = scenes(&stones, &places[..places.len() - 1], &gpu.device.limits());
    assert!(after == shown(&gpu, &mut start(&gpu, "rt", &mut without)));
    // Its room is for another one.
    let (mesh, map) = &places[places.len() - 1];
    host.add_host_part(&stones.hosts[*mesh], map).unwrap();
    executor.refresh(&mut host).unwrap();
    assert!(shown(&gpu, &mut executor) == complete);
}

#[test]
fn a_destroyed_buffer_is_an_error_of_refresh() {
    let gpu = open();
    let stones = stones(&gpu);
    let [mut host, _] = scenes(&stones, &places(0), &gpu.device.limits());
    let mut executor = start(&gpu, "rt", &mut host);
    stones.buffer.destroy();
    host.set_transforms(&places_of(&places(1))).unwrap();
    let error = executor.refresh(&mut host).unwrap_err().to_string();
    assert!(
        error.contains("scene.positions") && error.contains("destroyed"),
        "{error}"
    );
}

#[test]
fn engines_that_need_positions_on_the_cpu_name_the_part() {
    let gpu = open();
    let [mut host, _] = scenes(&stones(&gpu), &places(0), &gpu.device.limits());
    let error = host.deform(Vec::new(), Vec::new()).unwrap_err().to_string();
    assert!(
        error.contains("deform") && error.contains("PartId"),
        "{error}"
    );
    let built = host.build("scene.light_space_nodes", &gpu.device, &gpu.queue);
    let error = built.unwrap_err().to_string();
    assert!(
        error.contains("scene.light_space_nodes") && error.contains("Hierarchy"),
        "{error}"
    );
    let map = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
    let maps = vec![map; host.parts().count()];
    assert!(matches!(host.set_transforms(&maps), Err(Error::Move(_))));
    let far = DAffine3::from_scale(DVec3::splat(1e39));
    let part: PartId = host.parts().next().unwrap();
    assert!(matches!(
        host.set_transform(part, &far),
        Err(Error::Move(_))
    ));
}

/// A range of vertices with something wrong, and words of the error.
#[test]
fn mistakes_in_a_layout_are_named() {
    let gpu = open();
    let own = Quantised::new(&meshes::potato(2, 0.2, 1), Packing::Snorm16);
    let count = own.positions.len() as u32;
    let size = own.vertices.len() as u64;
    let buffer = upload(&gpu, &own.vertices);
    let hidden = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size,
        usage: BufferUsages::VERTEX,
        mapped_at_creation: false,
    });
    let vertices = |buffer: &wgpu::Buffer, offset: u64, stride: u64, count: u32| {
        HostVertices::new(buffer, offset, stride, count).with_position(VertexFormat::Snorm16x4, 0)
    };
    let right = vertices(&buffer, 0, STRIDE, count);
    let cases = [
        (vertices(&hidden, 0, STRIDE, count), "usage STORAGE"),
        (
            vertices(&buffer, 2, STRIDE, count),
            "offset of the vertices, 2 bytes",
        ),
        (
            vertices(&buffer, 0, 14, count),
            "stride of the vertices, 14 bytes",
        ),
        (
            vertices(&buffer, 12, STRIDE, count),
            "reach beyond the end of their buffer",
        ),
        (
            vertices(&buffer, u64::MAX - 3, STRIDE, count),
            "reach beyond",
        ),
        (vertices(&buffer, 0, STRIDE, count + 1), "reach beyond"),
        (vertices(&buffer, 0, 16, count), "reach beyond"),
        (
            right.clone().with_position(VertexFormat::Snorm16x4, 8),
            "does not fit a vertex of 12",
        ),
        (
            right
                .clone()
                .with_position(VertexFormat::Unorm10_10_10_2, 0),
            "Unorm10_10_10_2",
        ),
        (
            right.clone().with_position(VertexFormat::Snorm16x2, 0),
            "Snorm16x2; read are",
        ),
        (
            vertices(&buffer, 0, STRIDE, count - 1),
            "give those of the mesh alone, from its first vertex to its last",
        ),
    ];
    let make = |vertices, rest: &[u8], indices| {
        let on = (&gpu.device, &gpu.queue);
        HostMesh::new(on, vertices, rest, HostIndices::U16(indices))
    };
    for (vertices, expected) in cases {
        let error = make(vertices, &own.vertices, &own.indices).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
    let short = make(right.clone(), &own.vertices[8..], &own.indices).unwrap_err();
    assert!(matches!(short, HostMeshError::Rest { .. }), "{short}");
    let few = own.vertices.len() - STRIDE as usize;
    let few = make(
        vertices(&buffer, 0, STRIDE, count - 1),
        &own.vertices[..few],
        &own.indices,
    );
    let few = few.unwrap_err();
    assert!(few.to_string().contains("index"), "{few}");
    let odd = make(right.clone(), &own.vertices, &own.indices[1..]).unwrap_err();
    assert!(matches!(odd, HostMeshError::Mesh(_)), "{odd}");
    let empty = make(right.clone(), &own.vertices, &[]).unwrap_err();
    assert_eq!(empty, HostMeshError::Empty);
    let mesh = make(right, &own.vertices, &own.indices).unwrap();
    let [low, high] = mesh.bounds();
    let small = mesh
        .clone()
        .with_bounds([low, high - 0.1 * Vec3::X])
        .unwrap_err();
    assert!(matches!(small, HostMeshError::Bounds { .. }), "{small}");
    let wide = mesh.clone().with_bounds([Vec3::NEG_INFINITY, high]);
    let wide = wide.unwrap_err();
    assert!(wide.to_string().contains("not finite"), "{wide}");
    assert_eq!(
        mesh.with_bounds([low - 1.0, high]).unwrap().bounds(),
        [low - 1.0, high]
    );
}
