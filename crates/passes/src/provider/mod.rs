//! The scene as resources of a graph, each uploaded when a live pass first asks for it.

mod build;
mod in_encoder;
mod resources;
mod uploads;

use crate::buffers::{On, binding_limit};
use crate::built::{Built, Work};
use crate::error::Error;
use crate::eye::Eye;
use crate::geometry::Geometry;
use crate::host_buffers::{HostMesh, HostWrite};
use crate::lights;
use crate::names::*;
use crate::part::Added;
use crate::part_mesh::PartMesh;
use crate::parts::{PartId, Room};
use crate::ray_query::Structures;
use glam::{DAffine3, Vec3};
use skiagraph_gpu::{DeviceIdentity, ExecuteError, Provider, ProviderError};
use skiagraph_graph::Plan;
use skiagraph_scene::{Camera, Light, LightKind, Mesh, Movable, Scene, Sheets, View};
use std::sync::Arc;
use uploads::{Facts, Uploads};

/// Provider of a scene's resources to graphs: the buffers of one mesh, one camera and the lights,
/// on one device. It builds each resource when a graph's pass first binds it. Primitives are
/// triangles, with their index in [`Mesh::triangles`] as id. Positions are welded: corners of equal
/// position share one.
///
#[doc = resources::table!()]
///
/// Resources that are built stay, and are shared by all graphs that are executed with the same
/// provider. A provider therefore belongs to the device that it was first used with, until it
/// [moves](Self::move_to) to another one. Executors that
/// are created after a camera, light or mesh was set use it at once. Others use it after their next
/// [`refresh`](skiagraph_gpu::Executor::refresh), which rebuilds those resources that depend on the
/// change and that a pass of the plan reads.
///
/// Cameras and single lights are told by their bytes ([`write_uniform`](Provider::write_uniform)),
/// which each executor keeps in a buffer of its own. Other buffers are never written again after
/// they were handed out, unless the host refreshes [in its encoder](Self::in_encoder), where a
/// frame is one submission and parts are written in place. So any number of executors may be
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
/// [`Describe::describe`]: skiagraph_graph::Describe::describe
#[derive(Clone)]
pub struct SceneProvider {
    uploads: Uploads,
    structures: Structures,
    /// The device that all of them are on, once there is one.
    device: Option<DeviceIdentity>,
    #[cfg(feature = "embree")]
    embree: Option<(Arc<crate::embree::Embree>, u64)>,
}

/// A [`SceneProvider`] that submits nothing: what its GPU work writes comes into an encoder of the
/// host, between the commands that are there. [`SceneProvider::in_encoder`] makes it.
pub struct InEncoder<'a> {
    provider: &'a mut SceneProvider,
    encoder: &'a mut wgpu::CommandEncoder,
}

impl SceneProvider {
    /// Creates a provider of `scene` without building any resource; each is built when an executor,
    /// or [`prepare`](Self::prepare), first needs it. Until [`set_view`](Self::set_view),
    /// [`set_camera`](Self::set_camera) or [`set_eye`](Self::set_eye) is called, the resource
    /// `camera` is all zeros. Until [`set_view`](Self::set_view) or [`set_light`](Self::set_light)
    /// is called, the resource `light` is the scene's [default light](Scene::light).
    pub fn new(scene: Arc<Scene>) -> Self {
        Self {
            uploads: Uploads::new(scene, resources::RESOURCES),
            structures: Structures::default(),
            device: None,
            #[cfg(feature = "embree")]
            embree: None,
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

    /// Returns this provider as one for [`refresh`](skiagraph_gpu::Executor::refresh) whose GPU
    /// work comes into an encoder of the host, and not into a submission of its own:
    ///
    /// ```no_run
    /// # fn frame(provider: &mut skiagraph_passes::SceneProvider,
    /// #     executor: &mut skiagraph_gpu::Executor, gpu: &skiagraph_gpu::device::Gpu)
    /// #     -> Result<(), Box<dyn std::error::Error>> {
    /// let mut encoder = gpu.device.create_command_encoder(&Default::default());
    /// // Record the host's skinning here, into the same encoder.
    /// executor.refresh(&mut provider.in_encoder(&mut encoder)?)?;
    /// executor.encode(&mut encoder, &skiagraph_gpu::Frame::new())?;
    /// gpu.queue.submit([encoder.finish()]);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// Parts of [hosts' buffers](Self::add_host_part) are read as the commands before have left
    /// them, so vertices may be written in the same encoder. Where few parts have changed, only
    /// these are written, into the buffers that executors have bound. So encoders must be submitted
    /// in the order in which they were recorded, and each executor of the provider be refreshed
    /// before its next frame: the scene is that of the last refresh, also for executors that have
    /// not seen it. Buffers that a [branch](Self::branch) shares are copied first.
    ///
    /// Commands of an encoder that was dropped are recorded again by the next call of this method
    /// and the refresh that follows it, and executors run all passes that read their results. The
    /// same holds for an encoder that wgpu refused, or that was submitted after a later one, as
    /// soon as the GPU has finished. Frames that were submitted meanwhile lack them. A refresh that
    /// submits by itself also submits what encoders hold that are not submitted yet, so that frames
    /// encoded before them show it; it notices a loss only for the refresh after it.
    ///
    /// Bottom levels of acceleration structures that are built in encoders are not made compact.
    ///
    /// # Errors
    /// [`ExecuteError::DeviceLost`] if the device is lost while an encoder is looked after.
    pub fn in_encoder<'a>(
        &'a mut self,
        encoder: &'a mut wgpu::CommandEncoder,
    ) -> Result<InEncoder<'a>, ExecuteError> {
        InEncoder::new(self, encoder)
    }

    /// Records once more what was in encoders that were lost, with versions of its own, so that
    /// executors run the passes that read it.
    fn record_lost(&mut self, device: &wgpu::Device) -> Result<(), ExecuteError> {
        if self.uploads.buffers.record_lost(device)? {
            self.structures = Structures::default();
            self.uploads.versions.change_mesh();
        }
        Ok(())
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
                // Laid around the shape here; the executor brings it to the device.
                _ if self.uploads.is_uniform(name) => drop(self.uploads.uniform(name)?),
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
        self.uploads.buffers.clear();
        self.uploads.told.clear();
        (self.structures, self.uploads.kernels) = Default::default();
        self.uploads.geometry.move_to(device);
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
        &self.uploads.built
    }

    /// Returns counters of the work that this provider has done so far: bytes uploaded, positions
    /// moved, nodes fitted.
    pub fn work(&self) -> Work {
        let (uploads, rest) = (self.uploads.buffers.work, self.uploads.geometry.work);
        Work {
            uploaded: uploads.uploaded,
            copied: uploads.copied,
            ..rest
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
    /// with parts moved and positions deformed. The first call after parts have moved computes all
    /// of their positions and normals; frames of methods without a hierarchy do not.
    pub fn scene(&self) -> &Arc<Scene> {
        self.uploads.current()
    }

    /// Sets the camera of a view on a viewport of `[width, height]` pixels, and the view's light:
    /// its own, or else the scene's default light. [`lights`](Self::lights) becomes the list of the
    /// scene's lights, or the view's light alone if it is none of these.
    pub fn set_view(&mut self, view: &View, viewport: [u32; 2]) {
        self.set_camera(&view.camera(viewport));
        let light = self.uploads.scene.light_of(view);
        let mut lights = lights::from_scene(&self.uploads.scene);
        // A view may be under one of the scene's lights, or have one of its own.
        if !lights.contains(&light) {
            lights = vec![light];
        }
        self.uploads.versions.set_lights(lights);
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
        self.uploads.versions.eye.set(*eye);
    }

    /// Returns the light that was set last: the resources `light` and `light_area` describe it.
    pub fn light(&self) -> LightKind {
        self.uploads.versions.light.light.now
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
        &self.uploads.versions.lights.now
    }

    /// Sets the light that the resources `light` and `light_area` describe;
    /// [`lights`](Self::lights) stay as they are. A plan depends on the kind of its light
    /// (directional, spot or point): after a change of kind, graphs must be planned anew. Until
    /// then [`refresh`](skiagraph_gpu::Executor::refresh) fails with
    /// [`ExecuteError::OtherThanPlanned`](skiagraph_gpu::ExecuteError::OtherThanPlanned). A light
    /// that cannot be used, such as one without a direction, is an error of the next refresh, too
    /// ([`Error::Light`]).
    pub fn set_light(&mut self, light: LightKind) {
        self.uploads.versions.set_light(light);
    }

    /// Sets the lights that the resources `lights` and `light_areas` describe, all at once;
    /// [`light`](Self::light) stays as it is. The lights may differ from frame to frame. A pass
    /// with `run: OnChange` that reads `lights[2]` but no other light runs again only if that light
    /// or the mesh has changed.
    ///
    /// A plan depends on the kind of each light that it reads: after a change of kind, or without
    /// that light, graphs must be planned anew, and until then
    /// [`refresh`](skiagraph_gpu::Executor::refresh) fails with an error that names the light. For
    /// another number of lights, if its documents count them (`lights.count`) or its shaders bind
    /// the list, `refresh` plans a graph by itself.
    ///
    /// # Errors
    /// [`Error::LightNumber`] for a light that cannot be used, [`Error::NoLights`] for an empty
    /// list. The lights then stay as they were.
    pub fn set_lights(&mut self, lights: &[LightKind]) -> Result<(), Error> {
        lights::check(lights)?;
        self.uploads.versions.set_lights(lights.to_vec());
        Ok(())
    }

    /// Replaces the mesh by one without parts to move. A plan depends on the numbers of positions,
    /// triangles and other items; the next [`refresh`](skiagraph_gpu::Executor::refresh) plans for
    /// other numbers, as for [`add_part`](Self::add_part).
    pub fn set_mesh(&mut self, mesh: Mesh) {
        self.uploads.facts = Facts::new(&mesh).into();
        self.uploads.sheets = Sheets::new(&mesh).into();
        Arc::make_mut(&mut self.uploads.scene).mesh = mesh;
        self.uploads.atlas = Arc::default();
        self.uploads.geometry = self.uploads.geometry.replaced_by(Geometry::whole());
        self.structures = Structures::default();
        self.uploads.versions.change_mesh();
    }

    /// Replaces the mesh by one that is cut into parts, which
    /// [`set_transforms`](Self::set_transforms) moves. Plans depend on the mesh as described at
    /// [`set_mesh`](Self::set_mesh). Parts that were [joined](Movable::joined) need transforms;
    /// executors may be created before these are set, but
    /// [`encode`](skiagraph_gpu::Executor::encode) then returns an error.
    pub fn set_parts(&mut self, parts: impl Into<Arc<Movable>>) {
        let parts = parts.into();
        self.set_mesh(parts.rest.clone());
        self.uploads.geometry = self.uploads.geometry.replaced_by(Geometry::parted(parts));
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
        if let Some(part) = self.uploads.geometry.a_host_part() {
            return Err(Error::OnDevice("deform", part));
        }
        self.uploads.bring();
        let mesh = &self.uploads.scene.mesh;
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
        if self.uploads.geometry.deform(mesh, &positions, &normals) {
            let mesh = &mut Arc::make_mut(&mut self.uploads.scene).mesh;
            (mesh.positions, mesh.normals) = (positions, normals);
            self.uploads.versions.change_shape();
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
    /// is not the number of parts, or a map is singular, not finite, or moves a corner of the box
    /// around its part beyond f32; the error names this part. The mesh then stays as it was.
    pub fn set_transforms(&mut self, maps: &[DAffine3]) -> Result<(), Error> {
        self.uploads
            .change(|geometry, scene| geometry.set_transforms(maps, scene))
    }

    /// Moves one part, as [`set_transforms`](Self::set_transforms) moves all.
    ///
    /// # Errors
    /// [`Error::NoPart`] for a part that the mesh does not have; [`Error::Move`] for a map that is
    /// singular, not finite, or moves a corner of the part's box beyond f32. The mesh then stays as
    /// it was.
    pub fn set_transform(&mut self, part: PartId, map: &DAffine3) -> Result<(), Error> {
        self.uploads
            .change(|geometry, scene| geometry.set_transform(part, map, scene))
    }

    /// Returns the handles of the mesh's parts, in the order in which
    /// [`set_transforms`](Self::set_transforms) takes their maps: first the parts that
    /// [`set_parts`](Self::set_parts) or [`from_parts`](Self::from_parts) was given, then the parts
    /// that were [added](Self::add_part) later.
    pub fn parts(&self) -> impl Iterator<Item = PartId> {
        self.uploads.geometry.parts().iter().copied()
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
        let uploads = &mut self.uploads;
        uploads.bring();
        uploads.geometry.space.limit = Some(binding_limit(limits));
        uploads.geometry.reserve(room, &mut uploads.scene)?;
        uploads.facts = Facts::new(&uploads.scene.mesh).into();
        uploads.put_sheets(&Mesh::default(), 0);
        uploads.versions.change_mesh();
        Ok(())
    }

    /// Adds a part to a mesh in parts, and returns its handle. `mesh` is in the part's own space;
    /// `map` takes it to its place in world space, as a map of
    /// [`set_transforms`](Self::set_transforms) does. If it fits into the [room](Self::reserve)
    /// that is left, only this part is uploaded and gets a hierarchy, and its triangles get
    /// primitive ids that are unused or that a removed part had. If it does not fit, the mesh grows
    /// by a half, and all of it is uploaded.
    ///
    /// Where numbers of items change that a plan uses,
    /// [`refresh`](skiagraph_gpu::Executor::refresh) plans the graph for these: for a mesh that
    /// grows, for each masked part those of masks, for each part that casts or receives no shadow
    /// those of `scene.casters` and `scene.shadows`, and for a mesh that was not there yet those of
    /// materials and texture coordinates, if the scene has any. The first masked or double-sided
    /// part, the first one with [`Sheets`] and the first that casts or receives no shadow need
    /// other shaders: until the graph is planned anew
    /// ([`replace_graph`](skiagraph_gpu::Executor::replace_graph)) `refresh` returns
    /// [`ExecuteError::OtherThanPlanned`](skiagraph_gpu::ExecuteError::OtherThanPlanned).
    ///
    /// # Errors
    /// [`Error::NoParts`] if the mesh was not given in parts, [`Error::Move`] for a map that cannot
    /// move the part, [`Error::TooLarge`] if the mesh must grow beyond the limits that
    /// [`reserve`](Self::reserve) was given. The mesh then stays as it was. If `reserve` was not
    /// called, a mesh that the device cannot bind is an error of the next refresh instead.
    pub fn add_part(&mut self, mesh: &Mesh, map: &DAffine3) -> Result<PartId, Error> {
        self.put(Added::Own(PartMesh::unchecked(mesh)), map, None)
    }

    /// Adds a part of a mesh that was prepared, as [`add_part`](Self::add_part) does. Nothing is
    /// prepared again: the hierarchy, too, is that of
    /// [`with_hierarchy`](PartMesh::with_hierarchy), if it was built.
    ///
    /// # Errors
    /// As [`add_part`](Self::add_part).
    pub fn add_mesh(&mut self, mesh: &PartMesh, map: &DAffine3) -> Result<PartId, Error> {
        self.put(Added::Own(mesh.clone()), map, None)
    }

    /// Replaces the mesh of a part by another one, such as another level of detail, at `map`. The
    /// part keeps its handle and its place among the [`parts`](Self::parts); frames that are
    /// already encoded show the mesh before. Its room is free for the new mesh, if it was
    /// added or [joined](Movable::joined), and plans follow as with
    /// [`add_part`](Self::add_part).
    ///
    /// # Errors
    /// [`Error::NoPart`] for a part that the mesh does not have, and those of
    /// [`add_part`](Self::add_part). The part then stays as it was.
    pub fn replace_part(
        &mut self,
        part: PartId,
        mesh: &PartMesh,
        map: &DAffine3,
    ) -> Result<(), Error> {
        let replaced = self.put(Added::Own(mesh.clone()), map, Some(part));
        replaced.map(drop)
    }

    /// Replaces the mesh of a part by one in a buffer of the host, as
    /// [`replace_part`](Self::replace_part) does.
    ///
    /// # Errors
    /// [`Error::NoPart`] for a part that the mesh does not have, and those of
    /// [`add_host_part`](Self::add_host_part). The part then stays as it was.
    pub fn replace_by_host_part(
        &mut self,
        part: PartId,
        mesh: &HostMesh,
        map: &DAffine3,
    ) -> Result<(), Error> {
        self.check_mesh(mesh)?;
        self.put(Added::OfHost(mesh), map, Some(part)).map(drop)
    }

    /// Adds a part whose vertices are in a buffer of the host, as [`add_part`](Self::add_part)
    /// does. Refreshes read the buffer if the part was added, has moved or was
    /// [rewritten](Self::rewrite_part), and write its positions and normals for all passes: the
    /// vertices must be in the buffer, or their upload submitted (for a refresh
    /// [in an encoder](Self::in_encoder): recorded there), before the first such refresh. No
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
        self.put(Added::OfHost(mesh), map, None)
    }

    /// Adds a part, in the place of another one if one is `replaced`.
    fn put(
        &mut self,
        added: Added,
        map: &DAffine3,
        replaced: Option<PartId>,
    ) -> Result<PartId, Error> {
        let movable = Arc::clone(added.movable());
        let rest = &movable.rest;
        let uploads = &mut self.uploads;
        let (part, change) = uploads
            .geometry
            .add(added, map, replaced, &mut uploads.scene)?;
        let first = self.uploads.geometry.part(part)?.at.triangle;
        self.uploads.put_sheets(rest, first);
        self.uploads.note_change(change);
        Ok(part)
    }

    /// Gives all parts of a host's mesh another buffer, after the provider has
    /// [moved](Self::move_to) to another device or the first buffer was destroyed. `mesh` is made
    /// of theirs by [`HostMesh::with_vertices`]. Their handles, places and stated bounds stay. The
    /// next [`refresh`](skiagraph_gpu::Executor::refresh) reads the vertices, which must be in the
    /// buffer, or their upload submitted or recorded, before, as for
    /// [`add_host_part`](Self::add_host_part). Returns the number of these parts.
    ///
    /// # Errors
    /// [`Error::OtherDevice`] if the mesh is on another device than the provider's resources.
    pub fn set_host_mesh(&mut self, mesh: &HostMesh) -> Result<usize, Error> {
        self.check_mesh(mesh)?;
        let (parts, change) = self.uploads.geometry.set_host_mesh(mesh);
        self.uploads.note_change(change);
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
    /// submitted before, or be recorded in the encoder of that refresh
    /// ([`in_encoder`](Self::in_encoder)). All parts of the same [`HostMesh`] show them from their
    /// next move on, so each part that is rewritten must have a mesh, and vertices, of its own.
    /// `bounds`, low and high corner in the space of the vertices, must hold all vertices that
    /// triangles use: shadow maps are fitted to them, and rays miss what is beyond them.
    /// [`check_bounds`](Self::check_bounds) finds bounds that are too small.
    ///
    /// # Errors
    /// [`Error::NoHostPart`] for a part of another kind, [`Error::NoPart`] for one that there is
    /// not, [`Error::Bounds`] for bounds that hold nothing, [`Error::Move`] for bounds that the
    /// part's map moves beyond f32.
    pub fn rewrite_part(&mut self, part: PartId, bounds: [Vec3; 2]) -> Result<(), Error> {
        self.uploads
            .change(|geometry, _| geometry.rewrite(part, bounds))
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
        self.uploads.geometry.check_host_parts()?;
        let writes = self.uploads.geometry.host_writes(None).into_iter();
        let writes = HostWrite::sorted(writes.map(|(_, write)| write).collect());
        if writes.is_empty() {
            return Ok(());
        }
        let kernels = &mut self.uploads.kernels;
        kernels.check_bounds(&writes, On { device, queue })
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
        self.uploads
            .change(|geometry, scene| geometry.remove(part, scene))
    }
}

impl<'a> InEncoder<'a> {
    fn new(
        provider: &'a mut SceneProvider,
        encoder: &'a mut wgpu::CommandEncoder,
    ) -> Result<Self, ExecuteError> {
        if let Some(device) = provider.device.as_ref().map(|own| own.device().clone()) {
            provider.record_lost(&device)?;
        }
        provider.uploads.buffers.in_place = true;
        Ok(Self { provider, encoder })
    }
}

impl Drop for InEncoder<'_> {
    fn drop(&mut self) {
        self.provider.uploads.buffers.in_place = false;
    }
}
