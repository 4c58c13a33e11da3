//! The scene as resources of a graph, each uploaded when a live pass first asks for it.

use crate::{
    atlas::Atlas,
    error::Error,
    lights, ray_query,
    uniforms::{CameraUniform, LightAreaUniform, LightUniform},
};
use skiagraph_gpu::{Provider, ProviderError};
use skiagraph_graph::{Describe, Provided, ProvidedBinding};
use skiagraph_scene::{
    Adjacency, Bvh, BvhNode, LightKind, LightSpace, LightSpaceNode, Scene, View,
    packed_masks::mask_words,
};
use std::{collections::BTreeMap, sync::Arc};
use wgpu::util::DeviceExt;

const POSITIONS: &str = "scene.positions";
const INDICES: &str = "scene.indices";
const NORMALS: &str = "scene.normals";
const NORMAL_INDICES: &str = "scene.normal_indices";
const ADJACENCY: &str = "scene.adjacency";
const BVH_NODES: &str = "scene.bvh_nodes";
const BVH_PRIMITIVES: &str = "scene.bvh_primitives";
const LIGHT_SPACE_NODES: &str = "scene.light_space_nodes";
const LIGHT_SPACE_PRIMITIVES: &str = "scene.light_space_primitives";
const TLAS: &str = "scene.tlas";
/// What `shared/masks.wgsl` reads: no items in a scene where no triangle is masked or double-sided.
pub const MASKS: &str = "scene.masks";
const UVS: &str = "scene.uvs";
const UV_INDICES: &str = "scene.uv_indices";
const MATERIALS: &str = "scene.materials";
const MATERIAL_INDICES: &str = "scene.material_indices";
const TEXELS: &str = "scene.texels";
/// The uniform of `shared/camera.wgsl`.
pub const CAMERA: &str = "camera";
/// The uniform of `shared/light.wgsl`.
pub const LIGHT: &str = "light";
/// The uniform of `shared/light_area.wgsl`.
pub const LIGHT_AREA: &str = "light_area";

const NAMES: [&str; 19] = [
    POSITIONS,
    INDICES,
    NORMALS,
    NORMAL_INDICES,
    ADJACENCY,
    BVH_NODES,
    BVH_PRIMITIVES,
    LIGHT_SPACE_NODES,
    LIGHT_SPACE_PRIMITIVES,
    TLAS,
    MASKS,
    UVS,
    UV_INDICES,
    MATERIALS,
    MATERIAL_INDICES,
    TEXELS,
    CAMERA,
    LIGHT,
    LIGHT_AREA,
];

/// What is built anew for another light.
const OF_LIGHT: [&str; 4] = [LIGHT, LIGHT_AREA, LIGHT_SPACE_NODES, LIGHT_SPACE_PRIMITIVES];

/// Provides one scene under one view, on one device.
///
/// | resource | content |
/// |---|---|
/// | `scene.positions` | `array<vec4<f32>>`, welded, w = 1 |
/// | `scene.indices` | `array<u32>`, three per primitive |
/// | `scene.normals` | `array<vec4<f32>>`, unit length, w = 0 |
/// | `scene.normal_indices` | `array<u32>`, three per primitive |
/// | `scene.adjacency` | `array<u32>`, three per primitive: [`Adjacency::opposite`] |
/// | `scene.bvh_nodes` | 32-byte [`BvhNode`]s, node 0 is the root |
/// | `scene.bvh_primitives` | `array<u32>`, primitive ids in leaf order |
/// | `scene.light_space_nodes` | 32-byte [`LightSpaceNode`]s, node 0 is the root |
/// | `scene.light_space_primitives` | `array<u32>`, primitive ids in their leaf order |
/// | `scene.tlas` | `acceleration_structure`, one instance; primitives have their ids |
/// | `scene.masks` | `array<u32>`: [`mask_words`], what `shared/masks.wgsl` reads |
/// | `scene.uvs` | `array<vec2<f32>>`, v down |
/// | `scene.uv_indices` | `array<u32>`, three per primitive |
/// | `scene.materials` | 32-byte [`MaterialRecord`](crate::atlas::MaterialRecord)s |
/// | `scene.material_indices` | `array<u32>`, one per primitive |
/// | `scene.texels` | `array<u32>`, the base colours' textures, sRGB and alpha, red lowest |
/// | `camera` | [`CameraUniform`] |
/// | `light` | [`LightUniform`] |
/// | `light_area` | [`LightAreaUniform`] |
/// | `lights`, `light_areas` | the same of all lights, arrays; `lights[2]` alone is a uniform |
///
/// What was built stays and is shared by all graphs that are executed with the same provider, which
/// therefore belongs to the device that it was first used with;
/// [`set_view`](SceneProvider::set_view) changes the one camera that they all see, and the light to
/// the first of the view's own or the scene's. wgpu binds no buffer of size zero: an array of an
/// empty scene holds one zero item, its hierarchy one leaf around a triangle without area, which no
/// ray hits; [`Describe::describe`] still says 0 items, so that nothing is drawn.
pub struct SceneProvider {
    scene: Arc<Scene>,
    camera: CameraUniform,
    /// How often the camera was set, and which of these is in its buffer.
    camera_version: u64,
    camera_uploaded: u64,
    light: LightKind,
    /// All lights of the scene, or the view's own.
    lights: Vec<LightKind>,
    /// By their names, of `lights` and what is in it.
    light_buffers: BTreeMap<String, wgpu::Buffer>,
    /// How often a light was changed.
    light_version: u64,
    /// Words of [`MASKS`], made at once: plans ask how many there are.
    masks: Vec<u32>,
    buffers: BTreeMap<&'static str, wgpu::Buffer>,
    tlas: Option<wgpu::Tlas>,
    built: Vec<&'static str>,
}

impl SceneProvider {
    /// Provides `scene`. Builds nothing; until [`set_view`](Self::set_view) the `camera` is all
    /// zeros, and the light is the scene's.
    pub fn new(scene: Arc<Scene>) -> Self {
        Self {
            light: scene.light(),
            lights: lights::of(&scene),
            light_buffers: BTreeMap::new(),
            light_version: 0,
            masks: mask_words(&scene.mesh),
            scene,
            camera: CameraUniform::default(),
            camera_version: 0,
            camera_uploaded: 0,
            buffers: BTreeMap::new(),
            tlas: None,
            built: Vec::new(),
        }
    }

    /// The scene.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The camera and the light of executors made from now on, and of others from their next
    /// [`refresh`](skiagraph_gpu::Executor::refresh) on.
    pub fn set_view(&mut self, view: &View, viewport: [u32; 2]) {
        self.camera = CameraUniform::from(&view.camera(viewport));
        self.camera_version += 1;
        let light = self.scene.light_of(view);
        let mut lights = lights::of(&self.scene);
        // A view may be under one of the scene's lights, or have one that is nobody else's.
        if !lights.contains(&light) {
            lights = vec![light];
        }
        if lights != self.lights {
            self.lights = lights;
            self.light_version += 1;
            self.light_buffers.clear();
        }
        self.set_light(light);
    }

    /// The light.
    pub fn light(&self) -> LightKind {
        self.light
    }

    /// Which of `lights` the light is; the first, if it is none of them.
    pub fn light_number(&self) -> usize {
        let number = self.lights.iter().position(|light| *light == self.light);
        number.unwrap_or_default()
    }

    /// All lights of the scene, or the view's own.
    pub fn lights(&self) -> &[LightKind] {
        &self.lights
    }

    /// Another light. A plan depends on the light's kind: what was planned under a light of another
    /// kind is planned anew.
    pub fn set_light(&mut self, light: LightKind) {
        if light != self.light {
            self.light = light;
            self.light_version += 1;
            self.buffers.retain(|name, _| !OF_LIGHT.contains(name));
        }
    }

    /// Names of the resources that were built, in the order in which they first were.
    pub fn built(&self) -> &[&'static str] {
        &self.built
    }

    /// The buffer of that name, uploaded if it was not before.
    fn buffer(&mut self, name: &'static str, device: &wgpu::Device) -> Result<wgpu::Buffer, Error> {
        if !self.buffers.contains_key(name) {
            self.upload_named(name, device)?;
        }
        let buffer = self.buffers.get(name);
        buffer.cloned().ok_or_else(|| unknown(name))
    }

    fn note(&mut self, name: &'static str) {
        if !self.built.contains(&name) {
            self.built.push(name);
        }
    }

    fn upload(
        &mut self,
        name: &'static str,
        content: &[u8],
        device: &wgpu::Device,
    ) -> Result<(), Error> {
        let bytes = content.len() as u64;
        let limit = binding_limit(device);
        if bytes > limit {
            return Err(Error::TooLarge {
                name: name.to_owned(),
                bytes,
                limit,
            });
        }
        let uniform = matches!(name, CAMERA | LIGHT | LIGHT_AREA);
        let usage = if uniform {
            wgpu::BufferUsages::UNIFORM
        } else {
            wgpu::BufferUsages::STORAGE
        };
        let is_mesh = matches!(name, POSITIONS | INDICES);
        let queries = device
            .features()
            .contains(wgpu::Features::EXPERIMENTAL_RAY_QUERY);
        let usage = match is_mesh && queries {
            true => usage | wgpu::BufferUsages::BLAS_INPUT,
            false => usage,
        };
        let buffer = buffer_of(name, content, usage, device);
        self.buffers.insert(name, buffer);
        Ok(())
    }

    fn upload_items<T: bytemuck::NoUninit + bytemuck::Zeroable>(
        &mut self,
        name: &'static str,
        items: &[T],
        device: &wgpu::Device,
    ) -> Result<(), Error> {
        let dummy = [T::zeroed()];
        let items = if items.is_empty() { &dummy } else { items };
        self.upload(name, bytemuck::cast_slice(items), device)
    }

    fn upload_hierarchy(&mut self, device: &wgpu::Device) -> Result<(), Error> {
        // Beyond some four million triangles the boxes of all leaves exceed what Vulkan promises
        // to bind, and so the smallest leaves are joined.
        let most = binding_limit(device) / size_of::<BvhNode>() as u64;
        let mut bvh = Bvh::build(&self.scene.mesh).merged(most as usize);
        if bvh.nodes.is_empty() {
            bvh.nodes.push(BvhNode {
                min: [0.0; 3],
                first: 0,
                max: [0.0; 3],
                count: 1,
            });
        }
        let nodes: Vec<[u32; 8]> = bvh.nodes.iter().map(node_words).collect();
        self.upload_items(BVH_NODES, &nodes, device)?;
        self.upload_items(BVH_PRIMITIVES, &bvh.primitives, device)
    }

    fn light_uniform(&self) -> LightUniform {
        LightUniform::new(self.light, &self.scene.mesh)
    }

    fn upload_light_space(&mut self, device: &wgpu::Device) -> Result<(), Error> {
        if self.light.directional().is_none() {
            return Err(Error::LightSpaceKind(self.light.word()));
        }
        let light = self.light_uniform();
        let space = LightSpace {
            direction: light.to_light,
            centre: light.centre,
        };
        // As in the other hierarchy, leaves are joined where there are too many nodes to bind.
        let most = binding_limit(device) / size_of::<LightSpaceNode>() as u64;
        let mesh = &self.scene.mesh;
        let built = space.build(mesh, most as usize);
        let (mut nodes, primitives) = built.ok_or(Error::LightSpace {
            triangles: mesh.triangles.len(),
        })?;
        if nodes.is_empty() {
            nodes.push(LightSpaceNode {
                low: [0.0; 2],
                high: [0.0; 2],
                farthest: [0.0; 3],
                link: 1,
            });
        }
        let nodes: Vec<[u32; 8]> = nodes.iter().map(light_space_words).collect();
        self.upload_items(LIGHT_SPACE_NODES, &nodes, device)?;
        self.upload_items(LIGHT_SPACE_PRIMITIVES, &primitives, device)
    }

    fn upload_named(&mut self, name: &'static str, device: &wgpu::Device) -> Result<(), Error> {
        let scene = Arc::clone(&self.scene);
        let mesh = &scene.mesh;
        match name {
            POSITIONS => {
                let items: Vec<_> = mesh.positions.iter().map(|p| p.extend(1.0)).collect();
                self.upload_items(name, &items, device)
            }
            NORMALS => {
                let items: Vec<_> = mesh.normals.iter().map(|n| n.extend(0.0)).collect();
                self.upload_items(name, &items, device)
            }
            INDICES => self.upload_items(name, mesh.triangles.as_flattened(), device),
            NORMAL_INDICES => self.upload_items(name, mesh.normal_indices.as_flattened(), device),
            ADJACENCY => self.upload_items(name, &Adjacency::new(mesh).opposite, device),
            MASKS => {
                let words = std::mem::take(&mut self.masks);
                let done = self.upload_items(name, &words, device);
                self.masks = words;
                done
            }
            UVS => self.upload_items(name, &mesh.surfaces.uvs, device),
            UV_INDICES => self.upload_items(name, mesh.surfaces.uv_indices.as_flattened(), device),
            MATERIAL_INDICES => self.upload_items(name, &mesh.surfaces.of, device),
            MATERIALS => self.upload_items(name, &Atlas::new(&mesh.surfaces)?.records, device),
            TEXELS => self.upload_items(name, &Atlas::new(&mesh.surfaces)?.texels, device),
            CAMERA => self.upload_items(name, &[self.camera], device),
            LIGHT => self.upload_items(name, &[self.light_uniform()], device),
            LIGHT_AREA => self.upload_items(name, &[LightAreaUniform::from(&self.light)], device),
            BVH_NODES | BVH_PRIMITIVES => self.upload_hierarchy(device),
            LIGHT_SPACE_NODES | LIGHT_SPACE_PRIMITIVES => self.upload_light_space(device),
            _ => Ok(()),
        }
    }
}

fn buffer_of(
    name: &str,
    content: &[u8],
    usage: wgpu::BufferUsages,
    device: &wgpu::Device,
) -> wgpu::Buffer {
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some(name),
        contents: content,
        usage: usage | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
    })
}

/// The most bytes that a storage buffer can have and be bound whole.
fn binding_limit(device: &wgpu::Device) -> u64 {
    let limits = device.limits();
    limits
        .max_buffer_size
        .min(limits.max_storage_buffer_binding_size)
}

fn unknown(name: &str) -> Error {
    Error::Unknown {
        name: name.to_owned(),
        known: NAMES.map(str::to_owned).to_vec(),
    }
}

/// A node as the shader reads it: the floats' bits and the two counts, in the order of [`BvhNode`].
fn node_words(node: &BvhNode) -> [u32; 8] {
    let [low_x, low_y, low_z] = node.min.map(f32::to_bits);
    let [high_x, high_y, high_z] = node.max.map(f32::to_bits);
    [
        low_x, low_y, low_z, node.first, high_x, high_y, high_z, node.count,
    ]
}

/// The same of a node in light space.
fn light_space_words(node: &LightSpaceNode) -> [u32; 8] {
    let [low_x, low_y] = node.low.map(f32::to_bits);
    let [high_x, high_y] = node.high.map(f32::to_bits);
    let [x, y, z] = node.farthest.map(f32::to_bits);
    [low_x, low_y, high_x, high_y, x, y, z, node.link]
}

impl Describe for SceneProvider {
    fn names(&self) -> Vec<String> {
        let names = NAMES.into_iter().map(str::to_owned);
        names.chain(lights::names(self.lights.len())).collect()
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        let mesh = &self.scene.mesh;
        let corners = 3 * mesh.triangles.len();
        let array = |items: Option<usize>, stride| {
            Some(Provided {
                items: items.map(|items| items as u64),
                stride,
                binding: ProvidedBinding::Storage,
                kind: None,
            })
        };
        let uniform = |bytes: usize| {
            Some(Provided {
                items: Some(1),
                stride: bytes as u64,
                binding: ProvidedBinding::Uniform,
                kind: None,
            })
        };
        match name {
            POSITIONS => array(Some(mesh.positions.len()), 16),
            INDICES | NORMAL_INDICES | ADJACENCY => array(Some(corners), 4),
            NORMALS => array(Some(mesh.normals.len()), 16),
            // Known only once the hierarchy is built.
            BVH_NODES | LIGHT_SPACE_NODES => array(None, 32),
            BVH_PRIMITIVES | LIGHT_SPACE_PRIMITIVES => array(Some(mesh.triangles.len()), 4),
            TLAS => Some(Provided::ACCELERATION_STRUCTURE),
            MASKS => array(Some(self.masks.len()), 4),
            UVS => array(Some(mesh.surfaces.uvs.len()), 8),
            UV_INDICES => array(Some(3 * mesh.surfaces.uv_indices.len()), 4),
            MATERIALS => array(Some(mesh.surfaces.materials.len()), 32),
            MATERIAL_INDICES => array(Some(mesh.surfaces.of.len()), 4),
            // Known only once the textures are read.
            TEXELS => array(None, 4),
            CAMERA => uniform(size_of::<CameraUniform>()),
            LIGHT => uniform(size_of::<LightUniform>()).map(|light| Provided {
                kind: Some(lights::provided_kind(&self.light)),
                ..light
            }),
            LIGHT_AREA => uniform(size_of::<LightAreaUniform>()),
            name => lights::describe(name, &self.lights),
        }
    }
}

impl Provider for SceneProvider {
    fn version(&self, name: &str) -> u64 {
        match name {
            CAMERA => self.camera_version,
            _ if OF_LIGHT.contains(&name) => self.light_version,
            _ if lights::describe(name, &self.lights).is_some() => self.light_version,
            _ => 0,
        }
    }

    fn build(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        let why = |error: Error| ProviderError(error.to_string());
        if let Some(content) = lights::content(name, &self.lights, &self.scene.mesh) {
            let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::STORAGE;
            let make = || buffer_of(name, &content, usage, device);
            let buffer = self.light_buffers.entry(name.to_owned());
            let buffer = buffer.or_insert_with(make).clone();
            self.note(lights::list_of(name));
            return Ok(buffer);
        }
        let known = NAMES.into_iter().find(|&known| known == name);
        let name = known.ok_or_else(|| why(unknown(name)))?;
        let buffer = self.buffer(name, device).map_err(why)?;
        if name == CAMERA && self.camera_uploaded != self.camera_version {
            queue.write_buffer(&buffer, 0, bytemuck::bytes_of(&self.camera));
            self.camera_uploaded = self.camera_version;
        }
        self.note(name);
        Ok(buffer)
    }

    fn build_acceleration_structure(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Tlas, ProviderError> {
        let why = |error: Error| ProviderError(error.to_string());
        if name != TLAS {
            return Err(why(unknown(name)));
        }
        let tlas = match &self.tlas {
            Some(tlas) => tlas.clone(),
            None => {
                let vertices = self.buffer(POSITIONS, device).map_err(why)?;
                let indices = self.buffer(INDICES, device).map_err(why)?;
                let of = [&vertices, &indices];
                ray_query::build(&self.scene.mesh, of, device, queue).map_err(why)?
            }
        };
        self.tlas = Some(tlas.clone());
        self.note(TLAS);
        Ok(tlas)
    }
}
