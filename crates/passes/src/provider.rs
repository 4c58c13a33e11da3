//! The scene as resources of a graph, each uploaded when a live pass first asks for it.

use crate::{
    atlas::Atlas,
    buffers::{Buffers, On, binding_limit},
    built::{Built, How},
    error::Error,
    eye::Eye,
    hierarchies::{Hierarchies, Tree},
    lights,
    names::*,
    ray_query,
    shape::Shape,
    uniforms::{CameraUniform, LightAreaUniform, LightUniform, UnprojectionUniform},
};
use glam::{DAffine3, Vec3};
#[cfg(feature = "embree")]
use skiagraph_gpu::CpuWork;
use skiagraph_gpu::{Provider, ProviderError};
use skiagraph_graph::{Describe, Plan, Provided, ProvidedBinding};
use skiagraph_scene::{
    Adjacency, BvhNode, Camera, Light, LightKind, LightSpace, LightSpaceNode, Mesh, Movable, Scene,
    View, packed_masks::mask_words,
};
use std::{sync::Arc, time::Instant};

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
/// | `scene.light_space_nodes` | 32-byte [`LightSpaceNode`]s, node 0 is the root |
/// | `scene.light_space_primitives` | `array<u32>`, primitive ids in their leaf order |
/// | `scene.tlas` | `acceleration_structure`, one instance; primitives have their ids |
/// | `scene.embree` | work for the CPU, with the feature `embree` |
/// | `scene.masks` | `array<u32>`: [`mask_words`], what `shared/masks.wgsl` reads |
/// | `scene.uvs` | `array<vec2<f32>>`, v down |
/// | `scene.uv_indices` | `array<u32>`, three per primitive |
/// | `scene.materials` | 32-byte [`MaterialRecord`](crate::MaterialRecord)s |
/// | `scene.material_indices` | `array<u32>`, one per primitive |
/// | `scene.texels` | `array<u32>`, RGBA8 texels of all base-colour textures, sRGB, red lowest
/// | `camera` | [`CameraUniform`] |
/// | `unprojection` | [`UnprojectionUniform`] |
/// | `light` | [`LightUniform`] |
/// | `light_area` | [`LightAreaUniform`] |
/// | `lights`, `light_areas` | arrays with an item for each light; `lights[2]` alone is a uniform |
///
/// Resources that are built stay, and are shared by all graphs that are executed with the same
/// provider. A provider therefore belongs to the device that it was first used with. Executors that
/// are created after a camera, light or mesh was set use it at once. Others use it after their next
/// [`refresh`](skiagraph_gpu::Executor::refresh), which rebuilds those resources that depend on the
/// change and that a pass of the plan reads.
///
/// A buffer is never written again after it was handed out. So any number of executors may be
/// refreshed and encoded for one submission, each with a light, a camera and a mesh of its own.
/// Setting the same value again changes nothing for an executor that has seen it.
///
/// wgpu cannot bind a buffer of size zero. An array of an empty scene therefore holds one zero
/// item, and its hierarchy one leaf around a triangle without area, which no ray hits.
/// [`Describe::describe`] still says 0 items, so that nothing is drawn.
#[derive(Clone)]
pub struct SceneProvider {
    pub(crate) scene: Arc<Scene>,
    pub(crate) versions: Versions,
    /// Words of [`MASKS`], made at once: plans ask how many there are.
    pub(crate) masks: Vec<u32>,
    pub(crate) buffers: Buffers,
    pub(crate) tlas: Option<(wgpu::Tlas, u64)>,
    #[cfg(feature = "embree")]
    embree: Option<(Arc<crate::embree::Embree>, u64)>,
    pub(crate) hierarchies: Hierarchies,
    pub(crate) shape: Shape,
    pub(crate) built: Vec<Built>,
}

impl SceneProvider {
    /// Creates a provider of `scene` without building any resource. Until
    /// [`set_view`](Self::set_view), [`set_camera`](Self::set_camera) or [`set_eye`](Self::set_eye)
    /// is called, the resource `camera` is all zeros. Until [`set_view`](Self::set_view) or
    /// [`set_light`](Self::set_light) is called, the resource `light` is the scene's default light.
    pub fn new(scene: Arc<Scene>) -> Self {
        let lights = lights::from_scene(&scene);
        Self {
            versions: Versions::new(Eye::default(), scene.light(), lights),
            masks: mask_words(&scene.mesh),
            scene,
            buffers: Buffers::default(),
            tlas: None,
            #[cfg(feature = "embree")]
            embree: None,
            hierarchies: Hierarchies::default(),
            shape: Shape::default(),
            built: Vec::new(),
        }
    }

    /// Creates a second provider of the same scene that shares all built resources. It can be
    /// changed and [prepared](Self::prepare) on another thread while frames are encoded with this
    /// provider, and then be passed to [`refresh`](skiagraph_gpu::Executor::refresh) in its place.
    /// Both can also be used side by side. The new provider starts with the scene, camera and
    /// lights of this one; later changes of either do not show in the other.
    pub fn branch(&self) -> Self {
        self.clone()
    }

    /// Builds the resources that a plan's passes read and that are missing or out of date, so that
    /// [`refresh`](skiagraph_gpu::Executor::refresh) has nothing left to build. Passes whose
    /// results are not needed are left out, and so are resources of a mesh whose parts have no
    /// transforms yet.
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
                // Resources that the executor keeps of the frame before are not ours.
                _ if self.describe(name).is_some() => drop(self.build(name, device, queue)?),
                _ => {}
            }
        }
        Ok(())
    }

    /// Lists the resources that this provider has built: an entry for each, in the order of their
    /// first build. An entry describes the last build of its resource.
    pub fn built(&self) -> &[Built] {
        &self.built
    }

    /// The buffer of that name with what is in it now.
    fn buffer(&mut self, name: &str, on: On) -> Result<wgpu::Buffer, Error> {
        self.buffers.lay_over(self.versions.shape);
        let version = self.version(name);
        if let Some(buffer) = self.buffers.get(name, version) {
            return Ok(buffer.clone());
        }
        let began = Instant::now();
        let how = self.upload_named(name, on)?;
        self.note(name, how, began);
        let buffer = self.buffers.get(name, version);
        buffer.cloned().ok_or_else(|| unknown(name))
    }

    /// Notes what was made; of lights, which list they are of.
    fn note(&mut self, name: &str, how: How, began: Instant) {
        let time = began.elapsed();
        let known = || NAMES.iter().copied().find(|known| *known == name);
        let Some(name) = lights::list_of(name).or_else(known) else {
            return;
        };
        match self.built.iter_mut().find(|built| built.name == name) {
            Some(built) => {
                (built.how, built.time) = (how, time);
                built.times += 1;
            }
            None => self.built.push(Built {
                name,
                how,
                time,
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
        let most = binding_limit(on.device) / size_of::<BvhNode>() as u64;
        let (mesh, keep) = (&self.scene.mesh, self.shape.is_deformed);
        let tree = self.hierarchies.bvh(mesh, most as usize, keep);
        self.upload_tree([BVH_NODES, BVH_PRIMITIVES], tree, on)
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

    /// The light, if it can be used; of the scene's lights the error names which one it is.
    fn checked(&self, light: LightKind) -> Result<LightKind, Error> {
        let Err(reason) = light.check() else {
            return Ok(light);
        };
        let mut lights = self.scene.lights.iter();
        // Numbers that are none equal nothing, but their mistakes do.
        let named = lights.find(|of| of.kind.check().as_ref() == Err(&reason));
        let named = named.and_then(|light| light.check().err());
        Err(Error::Light(named.unwrap_or(reason)))
    }

    fn light_uniform(&self) -> LightUniform {
        LightUniform::new(self.light(), &self.scene.mesh)
    }

    fn upload_light_space(&mut self, on: On) -> Result<How, Error> {
        if self.light().directional().is_none() {
            return Err(Error::LightSpaceKind(self.light().word()));
        }
        let light = self.light_uniform();
        let space = LightSpace {
            direction: light.to_light,
            centre: light.centre,
        };
        // As in the other hierarchy, leaves are joined where there are too many nodes to bind.
        let most = binding_limit(on.device) / size_of::<LightSpaceNode>() as u64;
        let (mesh, keep) = (&self.scene.mesh, self.shape.is_deformed);
        let trees = &mut self.hierarchies;
        let tree = trees.light_space(space, mesh, most as usize, keep)?;
        self.upload_tree([LIGHT_SPACE_NODES, LIGHT_SPACE_PRIMITIVES], tree, on)
    }

    fn upload_named(&mut self, name: &str, on: On) -> Result<How, Error> {
        let scene = Arc::clone(&self.scene);
        let mesh = &scene.mesh;
        match name {
            POSITIONS => {
                let items: Vec<_> = mesh.positions.iter().map(|p| p.extend(1.0)).collect();
                self.upload_items(name, &items, on)
            }
            NORMALS => {
                let items: Vec<_> = mesh.normals.iter().map(|n| n.extend(0.0)).collect();
                self.upload_items(name, &items, on)
            }
            INDICES => self.upload_items(name, mesh.triangles.as_flattened(), on),
            NORMAL_INDICES => self.upload_items(name, mesh.normal_indices.as_flattened(), on),
            ADJACENCY => self.upload_items(name, &Adjacency::new(mesh).opposite, on),
            MASKS => {
                let words = std::mem::take(&mut self.masks);
                let done = self.upload_items(name, &words, on);
                self.masks = words;
                done
            }
            UVS => self.upload_items(name, &mesh.surfaces.uvs, on),
            UV_INDICES => self.upload_items(name, mesh.surfaces.uv_indices.as_flattened(), on),
            MATERIAL_INDICES => self.upload_items(name, &mesh.surfaces.of, on),
            MATERIALS => self.upload_items(name, &Atlas::new(&mesh.surfaces)?.records, on),
            TEXELS => self.upload_items(name, &Atlas::new(&mesh.surfaces)?.texels, on),
            CAMERA => self.upload_items(name, &[self.versions.eye.now.finite()?.camera], on),
            UNPROJECTION => {
                self.upload_items(name, &[self.versions.eye.now.finite()?.unprojection], on)
            }
            LIGHT => {
                self.checked(self.light())?;
                self.upload_items(name, &[self.light_uniform()], on)
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
                let content = lights::content(name, self.lights(), mesh);
                let missing = || lights::gone(name, self.lights()).unwrap_or_else(|| unknown(name));
                self.upload_items(name, &content.ok_or_else(missing)?, on)
            }
        }
    }

    /// Creates a provider of a mesh under a light. Both can be changed later. A camera must be set
    /// before frames are encoded ([`set_camera`](Self::set_camera)); until then the resource
    /// `camera` is all zeros.
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
    /// camera must be set before frames are encoded ([`set_camera`](Self::set_camera)). Parts that
    /// were [joined](Movable::joined) from several meshes need transforms before that, too.
    pub fn from_parts(parts: impl Into<Arc<Movable>>, light: impl Into<LightKind>) -> Self {
        let mut provider = Self::from_mesh(Mesh::default(), light);
        provider.set_parts(parts);
        provider
    }

    /// Returns the scene that the provider serves, with the mesh that was set last in its current
    /// shape.
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
    /// an [`Eye`] tells which depth is near.
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
    /// [`set_lights`](Self::set_lights), if it was called. Otherwise these are all lights of the
    /// scene in its order (its default light if it has none), or the light of a view alone, if
    /// [`set_view`](Self::set_view) was given a view whose own light is none of these.
    pub fn lights(&self) -> &[LightKind] {
        &self.versions.lights.now
    }

    /// Sets the light that the resources `light` and `light_area` describe;
    /// [`lights`](Self::lights) stay as they are. A plan depends on the kind of its light: after a
    /// change of kind, graphs must be planned anew. Until then
    /// [`refresh`](skiagraph_gpu::Executor::refresh) fails with
    /// [`ExecuteError::OtherThanPlanned`](skiagraph_gpu::ExecuteError::OtherThanPlanned).
    pub fn set_light(&mut self, light: LightKind) {
        self.versions.set_light(light);
    }

    /// Sets the lights that the resources `lights` and `light_areas` describe, all at once;
    /// [`light`](Self::light) stays as it is. They may be others in each frame. What a pass makes
    /// from `lights[2]` alone is made anew only if that light has changed, or the mesh.
    ///
    /// A plan depends on the number of the lights and the kind of each: after a change of these,
    /// graphs that read them must be planned anew. Until then
    /// [`refresh`](skiagraph_gpu::Executor::refresh) fails with an error that names the light, or
    /// the list.
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
        self.masks = mask_words(&mesh);
        Arc::make_mut(&mut self.scene).mesh = mesh;
        self.hierarchies.forget();
        self.shape = Shape::default();
        self.versions.change_mesh();
    }

    /// Replaces the mesh by one that is cut into parts, which
    /// [`set_transforms`](Self::set_transforms) moves. Plans depend on the mesh as described at
    /// [`set_mesh`](Self::set_mesh). Parts that were [joined](Movable::joined) from several meshes
    /// need transforms; executors may be created before these are set, but
    /// [`encode`](skiagraph_gpu::Executor::encode) then returns an error.
    pub fn set_parts(&mut self, parts: impl Into<Arc<Movable>>) {
        let parts = parts.into();
        self.set_mesh(parts.rest.clone());
        let (count, is_joined) = (parts.parts(), parts.is_joined());
        self.shape = Shape {
            maps: if is_joined {
                Vec::new()
            } else {
                vec![DAffine3::IDENTITY; count]
            },
            mirrored: vec![false; count],
            parts: Some(parts),
            is_unplaced: is_joined,
            is_deformed: true,
        };
    }

    /// Deforms the mesh: replaces its positions (scene units) and unit normals by as many others in
    /// the same order. The next [`refresh`](skiagraph_gpu::Executor::refresh) of an executor refits
    /// the bounding-volume hierarchies, or rebuilds them if refitting has made them bad; adjacency
    /// and all else is kept. Triangles keep their winding: for a mirrored mesh use
    /// [`set_mesh`](Self::set_mesh) or [`set_transforms`](Self::set_transforms). Nothing is rebuilt
    /// for equal positions and normals.
    ///
    /// # Errors
    /// [`Error::Deformed`] for another number of positions or normals, [`Error::NotFinite`] for a
    /// number that is not finite. The mesh then stays as it was.
    pub fn deform(&mut self, positions: Vec<Vec3>, normals: Vec<Vec3>) -> Result<(), Error> {
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
        // The maps of parts, if there are any, no longer say where those are.
        self.shape.maps.clear();
        self.shape.is_unplaced = false;
        if mesh.positions == positions && mesh.normals == normals {
            return Ok(());
        }
        let mesh = &mut Arc::make_mut(&mut self.scene).mesh;
        (mesh.positions, mesh.normals) = (positions, normals);
        self.shape.is_deformed = true;
        self.versions.change_shape();
        Ok(())
    }

    /// Moves each part of the mesh: `maps[n]` takes part number n from its original place, as given
    /// to [`set_parts`](Self::set_parts) or [`from_parts`](Self::from_parts), to its new place in
    /// world space. Only parts whose map has changed are moved, and equal maps cost nothing. The
    /// triangles of a part that its map mirrors are wound the other way, as in glTF, so that its
    /// outside stays outside.
    ///
    /// # Errors
    /// [`Error::NoParts`] if the mesh has no parts; [`Error::Move`] if the number of maps is not
    /// the number of parts, or a map is singular, not finite, or moves a position beyond f32; the
    /// error names the part. The mesh then stays as it was.
    pub fn set_transforms(&mut self, maps: &[DAffine3]) -> Result<(), Error> {
        let parts = self.shape.parts.clone().ok_or(Error::NoParts)?;
        parts.check_count(maps.len())?;
        let before = &self.shape.maps;
        let others = (0..maps.len()).filter(|&part| before.get(part) != Some(&maps[part]));
        let moved = others.map(|part| Ok((part, parts.moved_part(part, &maps[part])?)));
        let moved: Vec<_> = moved.collect::<Result<_, Error>>()?;
        self.shape.maps = maps.to_vec();
        if moved.is_empty() && !self.shape.is_unplaced {
            return Ok(());
        }
        let mesh = &mut Arc::make_mut(&mut self.scene).mesh;
        let mut is_elsewhere = std::mem::take(&mut self.shape.is_unplaced);
        let mut is_turned = false;
        for (part, moved) in &moved {
            let was = &mut self.shape.mirrored[*part];
            let change = parts.put(*part, moved, *was, mesh);
            *was = moved.is_mirrored;
            is_elsewhere |= change.is_elsewhere;
            is_turned |= change.is_turned;
        }
        if is_turned {
            // Its texture coordinates come in the order of corners.
            self.masks = mask_words(mesh);
            self.versions.change_winding();
        }
        if is_elsewhere || is_turned {
            self.versions.change_shape();
        }
        Ok(())
    }
}

fn unknown(name: &str) -> Error {
    Error::Unknown {
        name: name.to_owned(),
        known: NAMES.iter().copied().map(str::to_owned).collect(),
    }
}

impl Describe for SceneProvider {
    fn names(&self) -> Vec<String> {
        let names = NAMES.iter().copied().map(str::to_owned);
        let names = names.filter(|name| *name != EMBREE || cfg!(feature = "embree"));
        names.chain(lights::names(self.lights().len())).collect()
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
        let of_lights = lights::version(name, &self.versions);
        of_lights.unwrap_or_else(|| self.versions.get(name))
    }

    fn missing(&self, name: &str) -> Option<String> {
        let is_of_shape = is_of_shape(name) || lights::describe(name, self.lights()).is_some();
        (self.shape.is_unplaced && is_of_shape).then(|| {
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
        let buffer = self.buffer(name, On { device, queue });
        buffer.map_err(ProviderError::from_error)
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
        let version = self.versions.get(TLAS);
        if let Some((tlas, of)) = &self.tlas
            && *of == version
        {
            return Ok(tlas.clone());
        }
        let on = On { device, queue };
        let vertices = self.buffer(POSITIONS, on).map_err(why)?;
        let indices = self.buffer(INDICES, on).map_err(why)?;
        let began = Instant::now();
        let of = [&vertices, &indices];
        let tlas = ray_query::build(&self.scene.mesh, of, device, queue).map_err(why)?;
        self.tlas = Some((tlas.clone(), version));
        self.note(TLAS, How::Made, began);
        Ok(tlas)
    }

    #[cfg(feature = "embree")]
    fn build_cpu_work(&mut self, name: &str) -> Result<Arc<dyn CpuWork>, ProviderError> {
        let why = |error: Error| ProviderError::from_error(error);
        if name != EMBREE {
            return Err(why(unknown(name)));
        }
        let version = self.versions.get(EMBREE);
        if let Some((embree, of)) = &self.embree
            && *of == version
        {
            return Ok(embree.clone());
        }
        let began = Instant::now();
        let embree = Arc::new(crate::embree::Embree::build(&self.scene).map_err(why)?);
        self.embree = Some((embree.clone(), version));
        self.note(EMBREE, How::Made, began);
        Ok(embree)
    }
}
