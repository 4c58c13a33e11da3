//! The scene as resources of a graph, each uploaded when a live pass first asks for it.

use crate::{
    atlas::Atlas,
    buffers::{Buffers, On, Patched, binding_limit},
    built::{Built, How, Work},
    error::Error,
    eye::Eye,
    geometry::{Change, Geometry, nodes_to_walk},
    hierarchies::{Tree, all},
    host_buffers::{Bound, HostMesh, HostWrite, Kernels, Written},
    lights,
    names::*,
    parts::{PartId, Room},
    ray_query::{Source, Structures},
    uniforms::{CameraUniform, LightAreaUniform, LightUniform, UnprojectionUniform},
};
use glam::{DAffine3, Vec3, Vec4};
#[cfg(feature = "embree")]
use skiagraph_gpu::CpuWork;
use skiagraph_gpu::{DeviceIdentity, Provider, ProviderError};
use skiagraph_graph::{Describe, Plan, Provided, ProvidedBinding};
use skiagraph_scene::{
    BvhNode, Camera, Light, LightKind, LightSpace, LightSpaceNode, Mesh, Movable, Scene, Sheets,
    View, packed_masks::mask_words,
};
use std::{ops::Range, sync::Arc, time::Instant};

/// Provider of a scene's resources to graphs: the buffers of one mesh, one camera and the lights,
/// on one device. It builds each resource when a graph's pass first binds it. Primitives are
/// triangles, with their index in [`Mesh::triangles`] as id. Positions are welded: corners of equal
/// position share one.
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
/// | `scene.light_space_nodes` | 32-byte [`LightSpaceNode`]s, node 0 the root; last the [centre] |
/// | `scene.light_space_primitives` | `array<u32>`, primitive ids in their leaf order |
/// | `scene.tlas` | `acceleration_structure`; primitive id = custom data + primitive index |
/// | `scene.embree` | work for the CPU, with the feature `embree` |
/// | `scene.masks` | `array<u32>`: [`mask_words`], what `shared/masks.wgsl` reads |
/// | `scene.sheets` | `array<u32>`: a bit per primitive, set for [`Sheets`] |
/// | `scene.uvs` | `array<vec2<f32>>`, v down |
/// | `scene.uv_indices` | `array<u32>`, three per primitive |
/// | `scene.materials` | 32-byte [`MaterialRecord`](crate::MaterialRecord)s |
/// | `scene.material_indices` | `array<u32>`, one per primitive |
/// | `scene.texels` | `array<u32>`, RGBA8 texels of all base-colour textures, sRGB, red lowest |
/// | `camera` | [`CameraUniform`] |
/// | `unprojection` | [`UnprojectionUniform`] |
/// | `light` | [`LightUniform`] |
/// | `light_area` | [`LightAreaUniform`] |
/// | `lights` | array of [`LightUniform`], one per light; `lights[2]` alone is a uniform |
/// | `light_areas` | array of [`LightAreaUniform`]; `light_areas[2]` alone is a uniform |
///
/// Resources that are built stay, and are shared by all graphs that are executed with the same
/// provider. A provider therefore belongs to the device that it was first used with, until it
/// [moves](Self::move_to) to another one. Executors that
/// are created after a camera, light or mesh was set use it at once. Others use it after their next
/// [`refresh`](skiagraph_gpu::Executor::refresh), which rebuilds those resources that depend on the
/// change and that a pass of the plan reads.
///
/// A buffer is never written again after it was handed out. So any number of executors may be
/// refreshed and encoded for one submission, each with a light, a camera and a mesh of its own.
/// Setting the same value again changes nothing for an executor that has seen it. Where a few parts
/// of many have moved, the next buffer gets only those from the CPU; the GPU copies the rest from
/// the buffer before, in one submission of the provider's own
/// ([`submit_built`](Provider::submit_built)).
///
/// wgpu cannot bind a buffer of size zero. An array of an empty scene therefore holds one zero
/// item, and its hierarchy one leaf around a triangle without area, which no ray hits.
/// [`Describe::describe`] still says 0 items, so that nothing is drawn.
///
/// [`Adjacency::opposite`]: skiagraph_scene::Adjacency::opposite
/// [centre]: LightSpaceNode::centre
#[derive(Clone)]
pub struct SceneProvider {
    pub(crate) scene: Arc<Scene>,
    pub(crate) versions: Versions,
    /// Words of [`MASKS`] and [`SHEETS`], made at once: plans ask how many there are.
    pub(crate) masks: Arc<Vec<u32>>,
    sheets: Arc<Sheets>,
    pub(crate) buffers: Buffers,
    structures: Structures,
    /// The device that all of them are on, once there is one.
    device: Option<DeviceIdentity>,
    #[cfg(feature = "embree")]
    embree: Option<(Arc<crate::embree::Embree>, u64)>,
    pub(crate) geometry: Geometry,
    kernels: Kernels,
    /// Materials of the mesh, once they were asked for.
    atlas: Arc<Atlas>,
    pub(crate) built: Vec<Built>,
}

impl SceneProvider {
    /// Creates a provider of `scene` without building any resource; each is built when an executor,
    /// or [`prepare`](Self::prepare), first needs it. Until [`set_view`](Self::set_view),
    /// [`set_camera`](Self::set_camera) or [`set_eye`](Self::set_eye) is called, the resource
    /// `camera` is all zeros. Until [`set_view`](Self::set_view) or [`set_light`](Self::set_light)
    /// is called, the resource `light` is the scene's [default light](Scene::light).
    pub fn new(scene: Arc<Scene>) -> Self {
        let lights = lights::from_scene(&scene);
        Self {
            versions: Versions::new(Eye::default(), scene.light(), lights),
            masks: mask_words(&scene.mesh).into(),
            sheets: Sheets::new(&scene.mesh).into(),
            scene,
            buffers: Buffers::default(),
            structures: Structures::default(),
            device: None,
            #[cfg(feature = "embree")]
            embree: None,
            geometry: Geometry::whole(),
            kernels: Kernels::default(),
            atlas: Arc::default(),
            built: Vec::new(),
        }
    }

    /// Creates a second provider of the same scene, a clone, that shares all built resources. It
    /// can be changed and [prepared](Self::prepare) on another thread while frames are encoded with
    /// this provider, and then be passed to [`refresh`](skiagraph_gpu::Executor::refresh) in its
    /// place. Both can also be used side by side. The new provider starts with the scene, parts
    /// (the same [handles](PartId) name them), camera and lights of this one; later changes of
    /// either do not show in the other.
    pub fn branch(&self) -> Self {
        self.clone()
    }

    /// Builds the resources that the passes of a [`Plan`] read and that are missing or out of date,
    /// so that [`refresh`](skiagraph_gpu::Executor::refresh) has nothing left to build. Passes
    /// whose results are not needed are left out, and so are resources of a mesh whose parts have
    /// no transforms yet.
    ///
    /// # Errors
    /// Those of [`Provider::build`] and [`Provider::build_acceleration_structure`].
    pub fn prepare(
        &mut self,
        plan: &Plan,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<(), ProviderError> {
        for name in plan.provided() {
            match name {
                // It is asked for again when it can be made.
                _ if self.missing(name).is_some() => {}
                TLAS => drop(self.build_acceleration_structure(name, device, queue)?),
                EMBREE => drop(self.build_cpu_work(name)?),
                _ => drop(self.build(name, device, queue)?),
            }
        }
        self.submit_built(device, queue)
    }

    /// Moves the provider to another device, such as one that is opened after the first was lost.
    /// The scene, parts with their handles and places, lights, camera and versions stay; all
    /// resources are built again, on the new device, when executors there first need them.
    /// Executors on the device before get [`ExecuteError::OtherDevice`] from their next
    /// [`refresh`](skiagraph_gpu::Executor::refresh). Moving to the device that the provider is on
    /// changes nothing.
    ///
    /// Vertices of [host parts](Self::add_host_part) are in buffers of the device before: until
    /// [`set_host_mesh`](Self::set_host_mesh) gives them others, or they are removed, what is made
    /// of them fails with [`Error::HostVertices`], which lists these parts.
    ///
    /// [`ExecuteError::OtherDevice`]: skiagraph_gpu::ExecuteError::OtherDevice
    pub fn move_to(&mut self, device: &wgpu::Device) {
        if self.device.as_ref().is_some_and(|own| own.is(device)) {
            return;
        }
        let work = self.buffers.work;
        (self.buffers, self.structures, self.kernels) = Default::default();
        self.buffers.work = work;
        self.geometry.move_to(device);
        self.device = Some(DeviceIdentity::new(device));
    }

    /// Checks that all is on `device`, which the first call decides.
    fn check_device(&mut self, device: &wgpu::Device) -> Result<(), Error> {
        match &self.device {
            Some(identity) if identity.is(device) => {}
            Some(_) => return Err(Error::OtherDevice("the provider")),
            None => self.move_to(device),
        }
        Ok(())
    }

    /// Lists the resources that this provider has built: an entry for each, in the order of their
    /// first build. An entry describes the last build of its resource.
    pub fn built(&self) -> &[Built] {
        &self.built
    }

    /// Returns counters of the work that this provider has done so far: bytes uploaded, positions
    /// moved, nodes fitted.
    pub fn work(&self) -> Work {
        let (uploads, rest) = (self.buffers.work, self.geometry.work);
        Work {
            uploaded: uploads.uploaded,
            copied: uploads.copied,
            ..rest
        }
    }

    /// The buffer of that name with what is in it now.
    fn buffer(&mut self, name: &str, on: On) -> Result<wgpu::Buffer, Error> {
        let is_parted = self.geometry.is_in_parts();
        self.buffers.lay_over(self.versions.shape, is_parted);
        self.buffers.keeps_gaps = self.geometry.a_host_part().is_some();
        let version = self.version(name);
        if let Some(buffer) = self.buffers.get(name, version) {
            return Ok(buffer.clone());
        }
        let began = self.begin();
        let how = self.upload_named(name, on)?;
        self.note(name, how, began);
        let buffer = self.buffers.get(name, version);
        buffer.cloned().ok_or_else(|| unknown(name))
    }

    /// The time, and the bytes uploaded so far, at which a resource begins to be made.
    fn begin(&self) -> (Instant, u64) {
        (Instant::now(), self.buffers.work.uploaded)
    }

    /// Notes what was made; of lights, which list they are of.
    fn note(&mut self, name: &str, how: How, began: (Instant, u64)) {
        let (time, uploaded) = (began.0.elapsed(), self.buffers.work.uploaded - began.1);
        let listed = || NAMES.iter().copied().find(|own| *own == name);
        let Some(name) = lights::list_of(name).or_else(listed) else {
            return;
        };
        match self.built.iter_mut().find(|built| built.name == name) {
            Some(built) => {
                (built.how, built.time, built.uploaded) = (how, time, uploaded);
                built.times += 1;
            }
            None => self.built.push(Built {
                name,
                how,
                time,
                uploaded,
                times: 1,
            }),
        }
    }

    fn upload_items<T: bytemuck::NoUninit + bytemuck::Zeroable>(
        &mut self,
        name: &str,
        items: &[T],
        on: On,
    ) -> Result<How, Error> {
        let version = self.version(name);
        self.buffers.make(name, items, version, on)?;
        Ok(How::Made)
    }

    fn upload_hierarchy(&mut self, on: On) -> Result<How, Error> {
        // Beyond some four million triangles the boxes of all leaves exceed what Vulkan promises
        // to bind, and so the smallest leaves are joined.
        let most = binding_limit(&on.device.limits()) / size_of::<BvhNode>() as u64;
        let (version, held) = (self.version(BVH_NODES), self.buffers.version(BVH_NODES));
        let mesh = &self.scene.mesh;
        let fitted = self.geometry.bvh(mesh, most as usize, version, held);
        let (tree, nodes) = (&fitted.tree, nodes_to_walk(&fitted.tree));
        let (buffers, changed) = (&mut self.buffers, &fitted.nodes);
        let patched = buffers.patch_list(BVH_NODES, nodes, changed, version, on)?;
        let (primitives, changed) = (&tree.primitives, &fitted.primitives);
        buffers.patch_list(BVH_PRIMITIVES, primitives, changed, version, on)?;
        let writes = match patched {
            Patched::All => self.geometry.host_writes(None),
            _ => self.geometry.host_writes(held),
        };
        let with_nodes = |(piece, write): (usize, HostWrite)| {
            let levels = write.mesh.levels(tree, piece, on.device);
            let first = tree.nodes_of(piece).start;
            HostWrite {
                nodes: Some((first, levels)),
                ..write
            }
        };
        let writes: Vec<HostWrite> = writes.into_iter().map(with_nodes).collect();
        self.write_host_parts(BVH_NODES, patched, writes, on)?;
        Ok(fitted.how)
    }

    /// Uploads the positions or normals that have changed, with a fourth coordinate.
    fn upload_corners(
        &mut self,
        name: &str,
        (items, w): (&[Vec3], f32),
        on: On,
    ) -> Result<How, Error> {
        let (version, held) = (self.version(name), self.buffers.version(name));
        let (held, mesh) = (held.unwrap_or_default(), &self.scene.mesh);
        let list = (name, items.len());
        let changed = self.geometry.moved_since(held, list, mesh);
        let append = |range: Range<usize>, to: &mut Vec<Vec4>| {
            to.extend(items[range].iter().map(|item| item.extend(w)));
        };
        let changed = (items.len(), &changed[..]);
        let patched = self.buffers.patch(name, changed, append, version, on)?;
        let since = (patched != Patched::All).then_some(held);
        let writes = self.geometry.host_writes(since).into_iter();
        let writes = writes.map(|(_, write)| write).collect();
        self.write_host_parts(name, patched, writes, on)?;
        Ok(How::Made)
    }

    /// Has the GPU write parts of hosts' buffers into the buffer of that name, which was patched.
    fn write_host_parts(
        &mut self,
        name: &str,
        patched: Patched,
        writes: Vec<HostWrite>,
        on: On,
    ) -> Result<(), Error> {
        if writes.is_empty() {
            return Ok(());
        }
        let Some(buffer) = self.buffers.renew(name, patched, on) else {
            return Ok(());
        };
        match self.bind_host_parts((name, &buffer), HostWrite::sorted(writes), on) {
            Ok(bound) => {
                let uploaded = bound.record(self.buffers.record(name, on));
                self.buffers.work.uploaded += uploaded;
                Ok(())
            }
            Err(error) => {
                // It has not what its version says.
                self.buffers.forget(name);
                Err(error)
            }
        }
    }

    fn bind_host_parts(
        &mut self,
        (name, buffer): (&str, &wgpu::Buffer),
        writes: Vec<HostWrite>,
        on: On,
    ) -> Result<Bound, Error> {
        self.geometry.check_host_parts()?;
        if name == POSITIONS {
            let written = Written::positions(buffer);
            return self.kernels.bind(&written, &writes, on.device);
        }
        let [positions, indices] = [self.buffer(POSITIONS, on)?, self.buffer(INDICES, on)?];
        if name == NORMALS {
            let written = Written::normals(buffer, [&positions, &indices]);
            return self.kernels.bind(&written, &writes, on.device);
        }
        let primitives = self.buffer(BVH_PRIMITIVES, on)?;
        let written = Written::nodes(buffer, [&positions, &indices, &primitives]);
        self.kernels.bind(&written, &writes, on.device)
    }

    /// Uploads the numbers of those triangles that have other corners than before.
    fn upload_triangles<const N: usize>(
        &mut self,
        name: &str,
        items: &[[u32; N]],
        on: On,
    ) -> Result<How, Error> {
        let (version, held) = (self.version(name), self.buffers.version(name));
        let mesh = &self.scene.mesh;
        let held = held.unwrap_or_default();
        let turned = self.geometry.triangles_since(held, mesh);
        let turned = turned.iter().map(|range| N * range.start..N * range.end);
        let (items, changed) = (items.as_flattened(), turned.collect::<Vec<_>>());
        self.buffers
            .patch_list(name, items, &changed, version, on)?;
        Ok(How::Made)
    }

    /// Uploads the items behind those that were there, of a list that only grows.
    fn upload_appended<T: bytemuck::NoUninit + bytemuck::Zeroable>(
        &mut self,
        name: &str,
        items: &[T],
        on: On,
    ) -> Result<How, Error> {
        let (version, held) = (self.version(name), self.buffers.version(name));
        if held.is_none_or(|held| self.geometry.is_begun_after(held)) {
            return self.upload_items(name, items, on);
        }
        self.buffers.extend(name, items, version, on)?;
        Ok(How::Made)
    }

    fn upload_tree<N: bytemuck::Pod>(
        &mut self,
        [nodes, primitives]: [&str; 2],
        tree: Tree<N>,
        on: On,
    ) -> Result<How, Error> {
        self.upload_items(nodes, &tree.nodes, on)?;
        let version = self.versions.get(primitives);
        match tree.primitives {
            Some(items) => drop(self.upload_items(primitives, &items, on)?),
            None => self.buffers.still_hold(primitives, version),
        }
        Ok(tree.how)
    }

    fn light_uniform(&mut self, light: LightKind) -> LightUniform {
        self.geometry.lay(light, &self.scene.mesh)
    }

    /// The light, if it can be used; of the scene's lights the error names which one it is.
    fn checked(&self, light: LightKind) -> Result<LightKind, Error> {
        let Err(reason) = light.check() else {
            return Ok(light);
        };
        let mut lights = self.scene.lights.iter();
        // Numbers that are none equal nothing, but their mistakes do.
        let named = lights.find(|light| light.kind.check().as_ref() == Err(&reason));
        let named = named.and_then(|light| light.check().err());
        Err(Error::Light(named.unwrap_or(reason)))
    }

    fn upload_light_space(&mut self, on: On) -> Result<How, Error> {
        if self.light().directional().is_none() {
            return Err(Error::LightSpaceKind(self.light().word()));
        }
        if let Some(part) = self.geometry.a_host_part() {
            return Err(Error::OnDevice(LIGHT_SPACE_NODES, part));
        }
        let light = self.light_uniform(self.light());
        let space = LightSpace {
            direction: light.to_light,
            centre: light.centre,
        };
        // As in the other hierarchy, leaves are joined where there are too many nodes to bind; the
        // last item is the centre.
        let most = binding_limit(&on.device.limits()) / size_of::<LightSpaceNode>() as u64 - 1;
        if self.geometry.is_in_parts() {
            // An eighth of the scene's size nearer or farther, boxes are as tight.
            let space = (space, light.max_distance / 16.0);
            return self.upload_light_space_of_parts(space, most as usize, on);
        }
        let mesh = &self.scene.mesh;
        let tree = self.geometry.light_space(space, mesh, most as usize)?;
        self.upload_tree([LIGHT_SPACE_NODES, LIGHT_SPACE_PRIMITIVES], tree, on)
    }

    fn upload_light_space_of_parts(
        &mut self,
        space: (LightSpace, f32),
        most: usize,
        on: On,
    ) -> Result<How, Error> {
        let version = self.version(LIGHT_SPACE_NODES);
        let (mesh, versions) = (&self.scene.mesh, [self.versions.shape, version]);
        let geometry = &mut self.geometry;
        let parted = geometry.light_space_of_parts(space, mesh, most, versions)?;
        let buffers = &mut self.buffers;
        let names = [LIGHT_SPACE_NODES, LIGHT_SPACE_PRIMITIVES];
        let is_held = names.map(|name| buffers.take_up(name, parted.since));
        let [nodes, primitives] = parted.changed;
        let nodes = if is_held[0] {
            nodes
        } else {
            all(parted.nodes.len())
        };
        buffers.patch_list(names[0], &parted.nodes, &nodes, version, on)?;
        let items = &parted.tree.primitives;
        let primitives = if is_held[1] {
            primitives
        } else {
            all(items.len())
        };
        buffers.patch_list(names[1], items, &primitives, version, on)?;
        for name in names {
            buffers.leave(name, parted.since, version);
        }
        Ok(if parted.since == 0 {
            How::Made
        } else {
            How::Refitted
        })
    }

    fn upload_named(&mut self, name: &str, on: On) -> Result<How, Error> {
        let scene = Arc::clone(&self.scene);
        let mesh = &scene.mesh;
        match name {
            POSITIONS => self.upload_corners(name, (&mesh.positions, 1.0), on),
            NORMALS => self.upload_corners(name, (&mesh.normals, 0.0), on),
            INDICES => self.upload_triangles(name, &mesh.triangles, on),
            NORMAL_INDICES => self.upload_triangles(name, &mesh.normal_indices, on),
            ADJACENCY => {
                let opposite = self.geometry.adjacency(mesh, self.version(name));
                self.upload_triangles(name, opposite.as_chunks::<3>().0, on)
            }
            MASKS => self.upload_items(name, &Arc::clone(&self.masks), on),
            SHEETS => self.upload_items(name, Arc::clone(&self.sheets).words(), on),
            UVS => self.upload_appended(name, &mesh.surfaces.uvs, on),
            UV_INDICES => self.upload_triangles(name, &mesh.surfaces.uv_indices, on),
            MATERIAL_INDICES => {
                self.upload_triangles(name, mesh.surfaces.of.as_chunks::<1>().0, on)
            }
            MATERIALS | TEXELS => {
                Arc::make_mut(&mut self.atlas).append(&mesh.surfaces)?;
                let atlas = Arc::clone(&self.atlas);
                if !self.geometry.is_in_parts() {
                    // No other materials come, so that it is not worth its memory.
                    self.atlas = Arc::default();
                }
                match name {
                    MATERIALS => self.upload_appended(name, &atlas.records, on),
                    _ => self.upload_appended(name, &atlas.texels, on),
                }
            }
            CAMERA => self.upload_items(name, &[self.versions.eye.now.finite()?.camera], on),
            UNPROJECTION => {
                self.upload_items(name, &[self.versions.eye.now.finite()?.unprojection], on)
            }
            LIGHT => {
                let light = self.checked(self.light())?;
                let light = self.light_uniform(light);
                self.upload_items(name, &[light], on)
            }
            LIGHT_AREA => {
                let light = self.checked(self.light())?;
                self.upload_items(name, &[LightAreaUniform::from(&light)], on)
            }
            BVH_NODES | BVH_PRIMITIVES => self.upload_hierarchy(on),
            LIGHT_SPACE_NODES | LIGHT_SPACE_PRIMITIVES => self.upload_light_space(on),
            _ => {
                for &light in self.lights() {
                    self.checked(light)?;
                }
                let lights = &self.versions.lights.now;
                let lay = |light| self.geometry.lay(light, mesh);
                let content = lights::content(name, lights, lay);
                let missing = || lights::gone(name, self.lights()).unwrap_or_else(|| unknown(name));
                self.upload_items(name, &content.ok_or_else(missing)?, on)
            }
        }
    }

    /// Creates a provider of a mesh under a light. Both can be changed later. A camera must be set
    /// before frames are encoded ([`set_camera`](Self::set_camera) or [`set_eye`](Self::set_eye));
    /// until then the resource `camera` is all zeros.
    pub fn from_mesh(mesh: Mesh, light: impl Into<LightKind>) -> Self {
        Self::new(Arc::new(Scene {
            name: String::new(),
            mesh,
            views: Vec::new(),
            lights: vec![Light::only(light.into())],
        }))
    }

    /// Creates a provider of a mesh under a light; the mesh is cut into parts that
    /// [`set_transforms`](Self::set_transforms) moves. Mesh and light can be changed later. A
    /// camera must be set before frames are encoded ([`set_camera`](Self::set_camera) or
    /// [`set_eye`](Self::set_eye)). Parts that were [joined](Movable::joined), each from a mesh in
    /// a space of its own, need transforms before that, too.
    pub fn from_parts(parts: impl Into<Arc<Movable>>, light: impl Into<LightKind>) -> Self {
        let mut provider = Self::from_mesh(Mesh::default(), light);
        provider.set_parts(parts);
        provider
    }

    /// Returns the provider's scene. Its mesh is the one that was set last, in its current shape:
    /// with parts moved and positions deformed.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Sets the camera of a view on a viewport of `[width, height]` pixels, and the view's light:
    /// its own, or else the scene's default light. [`lights`](Self::lights) becomes the list of the
    /// scene's lights, or the view's light alone if it is none of these.
    pub fn set_view(&mut self, view: &View, viewport: [u32; 2]) {
        self.set_camera(&view.camera(viewport));
        let light = self.scene.light_of(view);
        let mut lights = lights::from_scene(&self.scene);
        // A view may be under one of the scene's lights, or have one of its own.
        if !lights.contains(&light) {
            lights = vec![light];
        }
        self.versions.set_lights(lights);
        self.set_light(light);
    }

    /// Sets the camera, for a graph whose depth buffer has 1 at the near and 0 at the far plane, as
    /// `shared/gbuffer.ron` draws it. For a host's own depth buffer use [`set_eye`](Self::set_eye):
    /// an [`Eye`] tells which depth is near. A camera with numbers that are not finite is an error
    /// of the next [`refresh`](skiagraph_gpu::Executor::refresh) ([`Error::Camera`]).
    pub fn set_camera(&mut self, camera: &Camera) {
        self.set_eye(&Eye::from(camera));
    }

    /// Sets the camera to a host program's own, which [`Eye::new`] makes from its matrices.
    pub fn set_eye(&mut self, eye: &Eye) {
        self.versions.eye.set(*eye);
    }

    /// Returns the light that was set last: the resources `light` and `light_area` describe it.
    pub fn light(&self) -> LightKind {
        self.versions.light.light.now
    }

    /// Returns the index of [`light`](Self::light) in [`lights`](Self::lights); 0 if it is not in
    /// that list.
    pub fn light_number(&self) -> usize {
        let mut lights = self.lights().iter();
        let number = lights.position(|light| *light == self.light());
        number.unwrap_or_default()
    }

    /// Returns the lights that the resources `lights` and `light_areas` describe: those of
    /// [`set_lights`](Self::set_lights), if it was called. Otherwise the list has all lights of the
    /// scene, in the scene's order (its default light if it has none); or only a view's own light,
    /// if [`set_view`](Self::set_view) was given a view with a light that the scene does not list.
    pub fn lights(&self) -> &[LightKind] {
        &self.versions.lights.now
    }

    /// Sets the light that the resources `light` and `light_area` describe;
    /// [`lights`](Self::lights) stay as they are. A plan depends on the kind of its light
    /// (directional, spot or point): after a change of kind, graphs must be planned anew. Until
    /// then [`refresh`](skiagraph_gpu::Executor::refresh) fails with
    /// [`ExecuteError::OtherThanPlanned`](skiagraph_gpu::ExecuteError::OtherThanPlanned). A light
    /// that cannot be used, such as one without a direction, is an error of the next refresh, too
    /// ([`Error::Light`]).
    pub fn set_light(&mut self, light: LightKind) {
        self.versions.set_light(light);
    }

    /// Sets the lights that the resources `lights` and `light_areas` describe, all at once;
    /// [`light`](Self::light) stays as it is. The lights may differ from frame to frame. A pass
    /// with `run: OnChange` that reads `lights[2]` but no other light runs again only if that light
    /// or the mesh has changed.
    ///
    /// A plan depends on the kind of each light that it reads, and on the number of the lights if
    /// its documents count them (`lights.count`) or its shaders bind the list: after a change of
    /// these, graphs must be planned anew. Until then [`refresh`](skiagraph_gpu::Executor::refresh)
    /// fails with an error that names the light, or the list.
    ///
    /// # Errors
    /// [`Error::LightNumber`] for a light that cannot be used, [`Error::NoLights`] for an empty
    /// list. The lights then stay as they were.
    pub fn set_lights(&mut self, lights: &[LightKind]) -> Result<(), Error> {
        lights::check(lights)?;
        self.versions.set_lights(lights.to_vec());
        Ok(())
    }

    /// Replaces the mesh by one without parts to move. A plan depends on the numbers of positions,
    /// triangles and other items: if they change, graphs must be planned anew
    /// ([`replace_graph`](skiagraph_gpu::Executor::replace_graph)).
    pub fn set_mesh(&mut self, mesh: Mesh) {
        self.masks = mask_words(&mesh).into();
        self.sheets = Sheets::new(&mesh).into();
        Arc::make_mut(&mut self.scene).mesh = mesh;
        self.atlas = Arc::default();
        self.geometry = self.geometry.replaced_by(Geometry::whole());
        self.structures = Structures::default();
        self.versions.change_mesh();
    }

    /// Replaces the mesh by one that is cut into parts, which
    /// [`set_transforms`](Self::set_transforms) moves. Plans depend on the mesh as described at
    /// [`set_mesh`](Self::set_mesh). Parts that were [joined](Movable::joined) need transforms;
    /// executors may be created before these are set, but
    /// [`encode`](skiagraph_gpu::Executor::encode) then returns an error.
    pub fn set_parts(&mut self, parts: impl Into<Arc<Movable>>) {
        let parts = parts.into();
        self.set_mesh(parts.rest.clone());
        self.geometry = self.geometry.replaced_by(Geometry::parted(parts));
    }

    /// Deforms the mesh: replaces the positions (world space, scene units) and unit normals of
    /// [`scene`](Self::scene)'s mesh by as many others in the same order. Of a mesh in parts they
    /// are where the parts are now. The next [`set_transforms`](Self::set_transforms), even with
    /// maps equal to those before, moves all parts from their original places and so undoes the
    /// deformation; [`set_transform`](Self::set_transform) does this for its part. The next
    /// [`refresh`](skiagraph_gpu::Executor::refresh) of an executor refits the bounding-volume
    /// hierarchies, or rebuilds them if refitting has made them bad; adjacency and all else is
    /// kept. Triangles keep their winding: for a mirrored mesh use [`set_mesh`](Self::set_mesh) or
    /// [`set_transforms`](Self::set_transforms). Nothing is rebuilt for equal positions and
    /// normals.
    ///
    /// # Errors
    /// [`Error::Deformed`] for another number of positions or normals, [`Error::NotFinite`] for a
    /// number that is not finite, [`Error::OnDevice`] for a mesh with parts of hosts' buffers. The
    /// mesh then stays as it was.
    pub fn deform(&mut self, positions: Vec<Vec3>, normals: Vec<Vec3>) -> Result<(), Error> {
        if let Some(part) = self.geometry.a_host_part() {
            return Err(Error::OnDevice("deform", part));
        }
        let mesh = &self.scene.mesh;
        let expected = [mesh.positions.len(), mesh.normals.len()];
        let given = [positions.len(), normals.len()];
        if given != expected {
            return Err(Error::Deformed { expected, given });
        }
        for (what, list) in [("position", &positions), ("normal", &normals)] {
            if let Some(index) = list.iter().position(|v| !v.is_finite()) {
                let value = list[index];
                return Err(Error::NotFinite { what, index, value });
            }
        }
        if self.geometry.deform(mesh, &positions, &normals) {
            let mesh = &mut Arc::make_mut(&mut self.scene).mesh;
            (mesh.positions, mesh.normals) = (positions, normals);
            self.versions.change_shape();
        }
        Ok(())
    }

    /// Moves each part of the mesh: `maps[n]` takes part number n of [`parts`](Self::parts) from
    /// its original place, in which its triangles were given, to its new place in world space. Only
    /// parts whose map has changed are moved, and equal maps cost nothing, except after
    /// [`deform`](Self::deform), when all parts are moved. If a map mirrors its part, the winding
    /// of the part's triangles is reversed (the rule of glTF), so that the outside stays the front
    /// face. Executors show it from their next [`refresh`](skiagraph_gpu::Executor::refresh) on.
    ///
    /// # Errors
    /// [`Error::NoParts`] if the mesh was not given in parts; [`Error::Move`] if the number of maps
    /// is not the number of parts, or a map is singular, not finite, or moves a position beyond
    /// f32; the error names the part of such a map. The mesh then stays as it was.
    pub fn set_transforms(&mut self, maps: &[DAffine3]) -> Result<(), Error> {
        let change = self.geometry.set_transforms(maps, &mut self.scene)?;
        self.note_change(change);
        Ok(())
    }

    /// Moves one part, as [`set_transforms`](Self::set_transforms) moves all.
    ///
    /// # Errors
    /// [`Error::NoPart`] for a part that the mesh does not have; [`Error::Move`] for a map that is
    /// singular, not finite, or moves a position beyond f32. The mesh then stays as it was.
    pub fn set_transform(&mut self, part: PartId, map: &DAffine3) -> Result<(), Error> {
        let change = self.geometry.set_transform(part, map, &mut self.scene)?;
        self.note_change(change);
        Ok(())
    }

    /// Returns the handles of the mesh's parts, in the order in which
    /// [`set_transforms`](Self::set_transforms) takes their maps: first the parts that
    /// [`set_parts`](Self::set_parts) or [`from_parts`](Self::from_parts) was given, then the parts
    /// that were [added](Self::add_part) later.
    pub fn parts(&self) -> impl Iterator<Item = PartId> {
        self.geometry.parts().iter().copied()
    }

    /// Makes room for parts that [`add_part`](Self::add_part) and
    /// [`add_host_part`](Self::add_host_part) add, besides the room that is left from earlier
    /// calls. The room that a [removed](Self::remove_part) part leaves between others serves only
    /// parts that fit into it, as the positions of a part follow each other, and so do its normals
    /// and its triangles. Plans depend on the numbers of positions, triangles and other items (see
    /// [`set_mesh`](Self::set_mesh)), which become larger by all of `room`: reserve before graphs
    /// are planned. `limits` are those of the device that the provider is used with.
    ///
    /// # Errors
    /// [`Error::NoParts`] if the mesh was not given in parts, [`Error::TooLarge`] if the device
    /// cannot bind the mesh with that room. The mesh then stays as it was.
    pub fn reserve(&mut self, room: Room, limits: &wgpu::Limits) -> Result<(), Error> {
        self.geometry.limit = Some(binding_limit(limits));
        self.geometry.reserve(room, &mut self.scene)?;
        self.masks = mask_words(&self.scene.mesh).into();
        self.put_sheets(&Mesh::default(), 0);
        self.versions.change_mesh();
        Ok(())
    }

    /// Adds a part to a mesh in parts, and returns its handle. `mesh` is in the part's own space;
    /// `map` takes it to its place in world space, as a map of
    /// [`set_transforms`](Self::set_transforms) does. If it fits into the [room](Self::reserve)
    /// that is left, only this part is uploaded and gets a hierarchy, and its triangles get
    /// primitive ids that are unused or that a removed part had. If it does not fit, the mesh grows
    /// by a half, and all of it is uploaded.
    ///
    /// A part that fits leaves every plan valid that neither binds nor
    /// [counts](skiagraph_graph::Plan::relies_on) masks, materials and texture coordinates
    /// (`scene.masks`, `scene.materials`, `scene.uvs` and their like). It makes other plans invalid
    /// if it changes numbers of items that they use. Each masked part changes that of masks, and so
    /// does the first double-sided one in a mesh without masks; the first part with [`Sheets`]
    /// changes that of `scene.sheets`. If the mesh or the part has
    /// materials, the numbers of items of materials and texture coordinates change. All plans are
    /// invalid if the mesh grows. Invalid plans must be made anew
    /// ([`replace_graph`](skiagraph_gpu::Executor::replace_graph)). Until then
    /// [`refresh`](skiagraph_gpu::Executor::refresh) returns
    /// [`ExecuteError::OtherThanPlanned`](skiagraph_gpu::ExecuteError::OtherThanPlanned).
    ///
    /// # Errors
    /// [`Error::NoParts`] if the mesh was not given in parts, [`Error::Move`] for a map that cannot
    /// move the part, [`Error::TooLarge`] if the mesh must grow beyond the limits that
    /// [`reserve`](Self::reserve) was given. The mesh then stays as it was. If `reserve` was not
    /// called, a mesh that the device cannot bind is an error of the next refresh instead.
    pub fn add_part(&mut self, mesh: &Mesh, map: &DAffine3) -> Result<PartId, Error> {
        let (part, change) = self.geometry.add(mesh, map, &mut self.scene)?;
        self.put_sheets(mesh, self.geometry.part(part)?.at.triangle);
        self.note_change(change);
        Ok(part)
    }

    /// Adds a part whose vertices are in a buffer of the host, as [`add_part`](Self::add_part)
    /// does. Refreshes read the buffer if the part was added, has moved or was
    /// [rewritten](Self::rewrite_part), and write its positions and normals for all passes: the
    /// vertices must be in the buffer, or their upload submitted, before the first such refresh. No
    /// frame brings them to the CPU: shadow maps and light spaces are fitted to the bounds of the
    /// [`HostMesh`], which must hold all its vertices ([`HostMesh::with_bounds`]), and
    /// [`scene`](Self::scene) has the part's positions at rest.
    ///
    /// The host keeps the buffer, or hands over [another](Self::set_host_mesh), and calls
    /// [`rewrite_part`](Self::rewrite_part) after each write to the part's vertices. While the mesh
    /// has such a part, all that needs every position on the CPU fails with [`Error::OnDevice`]:
    /// the hierarchies of the engines `LightSpace` and `Embree` at the next refresh, and
    /// [`deform`](Self::deform).
    ///
    /// # Errors
    /// As [`add_part`](Self::add_part), and [`Error::OtherDevice`] if the mesh is on another device
    /// than the provider's resources.
    pub fn add_host_part(&mut self, mesh: &HostMesh, map: &DAffine3) -> Result<PartId, Error> {
        self.check_mesh(mesh)?;
        let (part, change) = self.geometry.add_host(mesh, map, &mut self.scene)?;
        self.put_sheets(&mesh.movable().rest, self.geometry.part(part)?.at.triangle);
        self.note_change(change);
        Ok(part)
    }

    /// Gives all parts of a host's mesh another buffer, after the provider has
    /// [moved](Self::move_to) to another device or the first buffer was destroyed. `mesh` is made
    /// of theirs by [`HostMesh::with_vertices`]. Their handles, places and stated bounds stay. The
    /// next [`refresh`](skiagraph_gpu::Executor::refresh) reads the vertices, which must be in the
    /// buffer, or their upload submitted, before. Returns the number of these parts.
    ///
    /// # Errors
    /// [`Error::OtherDevice`] if the mesh is on another device than the provider's resources.
    pub fn set_host_mesh(&mut self, mesh: &HostMesh) -> Result<usize, Error> {
        self.check_mesh(mesh)?;
        let (parts, change) = self.geometry.set_host_mesh(mesh);
        self.note_change(change);
        Ok(parts)
    }

    /// Checks that a host's mesh is on the provider's device, if there is one yet.
    fn check_mesh(&self, mesh: &HostMesh) -> Result<(), Error> {
        match &self.device {
            Some(identity) if !mesh.is_on(identity.device()) => {
                Err(Error::OtherDevice("the host's mesh"))
            }
            _ => Ok(()),
        }
    }

    /// Notes that the host has rewritten the vertices of a part in its buffer (skinning, morphing).
    /// The next [`refresh`](skiagraph_gpu::Executor::refresh) reads them; their writing must be
    /// submitted before. All parts of the same [`HostMesh`] show them from their next move on, so
    /// each part that is rewritten must have a mesh, and vertices, of its own. `bounds`, low and
    /// high corner in the space of the vertices, must hold all vertices that triangles use: shadow
    /// maps are fitted to them, and rays miss what is beyond them.
    /// [`check_bounds`](Self::check_bounds) finds bounds that are too small.
    ///
    /// # Errors
    /// [`Error::NoHostPart`] for a part of another kind, [`Error::NoPart`] for one that there is
    /// not, [`Error::Bounds`] for bounds that hold nothing, [`Error::Move`] for bounds that the
    /// part's map moves beyond f32.
    pub fn rewrite_part(&mut self, part: PartId, bounds: [Vec3; 2]) -> Result<(), Error> {
        let change = self.geometry.rewrite(part, bounds)?;
        self.note_change(change);
        Ok(())
    }

    /// Checks that all vertices of parts of hosts' buffers, as they are after all that was
    /// submitted, lie within the bounds that were stated. It waits for the GPU: for debugging, not
    /// for each frame.
    ///
    /// # Errors
    /// [`Error::Beyond`] with a part and the first vertex of it that lies outside or is not finite;
    /// [`Error::HostVertices`] or [`Error::TooLarge`] if the device cannot read a part's vertices,
    /// [`Error::Read`] if the result cannot be read back.
    pub fn check_bounds(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<(), Error> {
        self.check_device(device)?;
        self.geometry.check_host_parts()?;
        let writes = self.geometry.host_writes(None).into_iter();
        let writes = HostWrite::sorted(writes.map(|(_, write)| write).collect());
        if writes.is_empty() {
            return Ok(());
        }
        self.kernels.check_bounds(&writes, On { device, queue })
    }

    /// Removes a part. From the next [`refresh`](skiagraph_gpu::Executor::refresh) of an executor
    /// on, the part's triangles have no area, so that they cover no pixel; frames that are already
    /// encoded still show it. It is no longer among the [`parts`](Self::parts), nor has it a map in
    /// the list for [`set_transforms`](Self::set_transforms). The memory of a part that was added,
    /// or [joined](Movable::joined) with others, is reused for parts that are added later.
    ///
    /// # Errors
    /// [`Error::NoPart`] for a part that the mesh does not have.
    pub fn remove_part(&mut self, part: PartId) -> Result<(), Error> {
        let change = self.geometry.remove(part, &mut self.scene)?;
        self.note_change(change);
        Ok(())
    }

    /// Notes which triangles of a part that was put into the mesh are sheets.
    fn put_sheets(&mut self, part: &Mesh, first: usize) {
        let total = self.scene.mesh.triangles.len();
        Arc::make_mut(&mut self.sheets).put(part, first, total);
    }

    fn note_change(&mut self, change: Change) {
        if change.is_grown {
            self.versions.change_mesh();
        }
        if change.is_turned || change.is_painted {
            // Texture coordinates come in the order of corners.
            self.masks = mask_words(&self.scene.mesh).into();
            self.versions.change_winding();
        }
        if change.is_painted {
            self.versions.change_surfaces();
        }
        if change.is_elsewhere || change.is_turned {
            self.versions.change_shape();
        }
    }
}

/// Names of the resources that every provider has.
fn known() -> impl Iterator<Item = String> {
    let names = NAMES.iter().copied();
    let names = names.filter(|name| *name != EMBREE || cfg!(feature = "embree"));
    names.map(str::to_owned)
}

fn unknown(name: &str) -> Error {
    Error::Unknown {
        name: name.to_owned(),
        known: known().collect(),
    }
}

impl Describe for SceneProvider {
    fn names(&self) -> Vec<String> {
        known().chain(lights::names(self.lights().len())).collect()
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        let mesh = &self.scene.mesh;
        let corners = 3 * mesh.triangles.len();
        let bound = |binding, items: Option<usize>, stride: usize| {
            Some(Provided::new(
                binding,
                items.map(|items| items as u64),
                stride as u64,
            ))
        };
        let array = |items, stride| bound(ProvidedBinding::Storage, items, stride);
        let uniform = |bytes| bound(ProvidedBinding::Uniform, Some(1), bytes);
        match name {
            POSITIONS => array(Some(mesh.positions.len()), 16),
            INDICES | NORMAL_INDICES | ADJACENCY => array(Some(corners), 4),
            NORMALS => array(Some(mesh.normals.len()), 16),
            // Known only once the hierarchy is built.
            BVH_NODES | LIGHT_SPACE_NODES => array(None, 32),
            BVH_PRIMITIVES | LIGHT_SPACE_PRIMITIVES => array(Some(mesh.triangles.len()), 4),
            TLAS => Some(Provided::ACCELERATION_STRUCTURE),
            EMBREE => cfg!(feature = "embree").then_some(Provided::CPU_WORK),
            MASKS => array(Some(self.masks.len()), 4),
            SHEETS => array(Some(self.sheets.words().len()), 4),
            UVS => array(Some(mesh.surfaces.uvs.len()), 8),
            UV_INDICES => array(Some(3 * mesh.surfaces.uv_indices.len()), 4),
            MATERIALS => array(Some(mesh.surfaces.materials.len()), 32),
            MATERIAL_INDICES => array(Some(mesh.surfaces.of.len()), 4),
            // Known only once the textures are read.
            TEXELS => array(None, 4),
            CAMERA => uniform(size_of::<CameraUniform>()),
            UNPROJECTION => uniform(size_of::<UnprojectionUniform>()),
            LIGHT => uniform(size_of::<LightUniform>())
                .map(|light| light.with_kind(lights::provided_kind(&self.light()))),
            LIGHT_AREA => uniform(size_of::<LightAreaUniform>()),
            name => lights::describe(name, self.lights()),
        }
    }
}

impl Provider for SceneProvider {
    fn version(&self, name: &str) -> u64 {
        if name == TLAS {
            return self.structures.version(self.versions.shape);
        }
        let of_lights = lights::version(name, &self.versions);
        of_lights.unwrap_or_else(|| self.versions.get(name))
    }

    fn has_versions(&self) -> bool {
        true
    }

    fn device(&self) -> Option<&DeviceIdentity> {
        self.device.as_ref()
    }

    fn missing(&self, name: &str) -> Option<String> {
        let is_of_shape = is_of_shape(name) || lights::describe(name, self.lights()).is_some();
        (self.geometry.is_unplaced() && is_of_shape).then(|| {
            "the parts of the mesh have no places yet: call `SceneProvider::set_transforms`, then \
             `Executor::refresh`"
                .to_owned()
        })
    }

    fn build(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        let checked = self.check_device(device);
        let buffer = checked.and_then(|()| self.buffer(name, On { device, queue }));
        buffer.map_err(ProviderError::from_error)
    }

    fn submit_built(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<(), ProviderError> {
        let submitted = self.buffers.submit(On { device, queue });
        submitted.map_err(ProviderError::from_error)
    }

    fn build_acceleration_structure(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Tlas, ProviderError> {
        let why = |error: Error| ProviderError::from_error(error);
        if name != TLAS {
            return Err(why(unknown(name)));
        }
        self.check_device(device).map_err(why)?;
        let on = On { device, queue };
        let vertices = self.buffer(POSITIONS, on).map_err(why)?;
        let indices = self.buffer(INDICES, on).map_err(why)?;
        // It is built of what they hold.
        self.submit_built(device, queue)?;
        let began = self.begin();
        let tlas = self.structures.get(Source {
            mesh: &self.scene.mesh,
            geometry: &self.geometry,
            buffers: [&vertices, &indices],
            shape: self.versions.shape,
            device,
            queue,
        });
        let (tlas, triangles) = tlas.map_err(why)?;
        if let Some(triangles) = triangles {
            self.geometry.work.triangles += triangles as u64;
            self.note(TLAS, How::Made, began);
        }
        Ok(tlas)
    }

    #[cfg(feature = "embree")]
    fn build_cpu_work(&mut self, name: &str) -> Result<Arc<dyn CpuWork>, ProviderError> {
        let why = |error: Error| ProviderError::from_error(error);
        if name != EMBREE {
            return Err(why(unknown(name)));
        }
        let version = self.versions.get(EMBREE);
        if let Some((embree, held)) = &self.embree
            && *held == version
        {
            return Ok(embree.clone());
        }
        if let Some(part) = self.geometry.a_host_part() {
            return Err(why(Error::OnDevice(EMBREE, part)));
        }
        let began = self.begin();
        let embree = Arc::new(crate::embree::Embree::build(&self.scene).map_err(why)?);
        self.embree = Some((embree.clone(), version));
        self.note(EMBREE, How::Made, began);
        Ok(embree)
    }
}
