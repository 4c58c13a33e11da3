//! The scene, and the buffers that it is uploaded to.

use crate::atlas::Atlas;
use crate::buffers::{Buffers, Held, On, Patched, binding_limit};
use crate::built::{Built, How};
use crate::changes::Change;
use crate::error::Error;
use crate::eye::Eye;
use crate::geometry::Geometry;
use crate::hierarchies::all;
use crate::host_buffers::{Bound, HostWrite, Kernel, Kernels};
use crate::lights;
use crate::names::*;
use crate::trees::nodes_to_walk;
use crate::uniforms::LightAreaUniform;
use bytemuck::bytes_of;
use glam::{Vec3, Vec4};
use skiagraph_graph::Provided;
use skiagraph_scene::packed_masks::{mask_words, shadow_words};
use skiagraph_scene::{BvhNode, LightKind, LightSpace, LightSpaceNode, Mesh, Scene, Sheets};
use std::ops::Range;
use std::sync::{Arc, OnceLock};
use web_time::Instant;

/// A resource of scenes.
pub(super) struct Resource {
    pub name: &'static str,
    pub made_from: MadeFrom,
    pub held: Held,
    /// Describes it to plans; `None` for a light that the scene does not have.
    pub describe: fn(&Uploads, &str) -> Option<Provided>,
    /// Uploads it, of the scene's mesh.
    pub upload: fn(&mut Uploads, &Mesh, &str, On) -> Result<How, Error>,
}

/// Facts about a mesh's triangles, packed for shaders.
pub(super) struct Facts {
    pub masks: Vec<u32>,
    pub shadows: Vec<u32>,
    /// Casters, of a mesh with such words.
    listed: Option<Vec<u32>>,
}

impl Facts {
    pub fn new(mesh: &Mesh) -> Self {
        let shadows = shadow_words(mesh);
        Self {
            masks: mask_words(mesh),
            listed: (!shadows.is_empty()).then(|| mesh.casters()),
            shadows,
        }
    }

    /// Number of triangles that cast shadows.
    pub fn casters(&self, mesh: &Mesh) -> usize {
        let listed = self.listed.as_ref();
        listed.map_or(mesh.triangles.len(), Vec::len)
    }
}

/// A scene under a camera and lights, and what is uploaded of it.
#[derive(Clone)]
pub(super) struct Uploads {
    resources: &'static [Resource],
    /// The scene; in its mesh some parts are [behind](Geometry::bring).
    pub scene: Arc<Scene>,
    /// The scene with all parts in their places, once it was asked for since the last change.
    current: OnceLock<Arc<Scene>>,
    pub versions: Versions,
    /// Words of [`MASKS`], [`SHADOWS`] and [`SHEETS`], made at once: plans ask how many there are.
    pub facts: Arc<Facts>,
    pub sheets: Arc<Sheets>,
    pub buffers: Buffers,
    pub geometry: Geometry,
    pub kernels: Kernels,
    /// Materials of the mesh, once they were asked for.
    pub atlas: Arc<Atlas>,
    pub built: Vec<Built>,
    /// Bytes of uniforms that executors were told, by name and version: those of views and lights
    /// that take turns.
    pub told: Vec<(String, u64, Vec<u8>)>,
}

impl Uploads {
    pub fn new(scene: Arc<Scene>, resources: &'static [Resource]) -> Self {
        let lights = lights::from_scene(&scene);
        let held = resources.iter();
        let held = held.map(|resource| (resource.name, resource.held));
        Self {
            versions: Versions::new(Eye::default(), scene.light(), lights),
            facts: Facts::new(&scene.mesh).into(),
            sheets: Sheets::new(&scene.mesh).into(),
            scene,
            current: OnceLock::new(),
            buffers: Buffers::new(held),
            resources,
            geometry: Geometry::whole(),
            kernels: Kernels::default(),
            atlas: Arc::default(),
            built: Vec::new(),
            told: Vec::new(),
        }
    }

    pub fn light(&self) -> LightKind {
        self.versions.light.light.now
    }

    pub fn lights(&self) -> &[LightKind] {
        &self.versions.lights.now
    }

    /// The scene with all parts in their places.
    pub fn current(&self) -> &Arc<Scene> {
        let placed = self.geometry.placed();
        if placed.behind.is_empty() {
            return &self.scene;
        }
        self.current.get_or_init(|| {
            let mut scene = Arc::clone(&self.scene);
            placed.bring(&mut Arc::make_mut(&mut scene).mesh);
            scene
        })
    }

    /// Computes the corners of all parts that maps have moved.
    pub fn bring(&mut self) {
        self.current.take();
        self.geometry.bring(&mut self.scene);
    }

    /// True if the GPU moves parts by their maps, in the buffer of positions that is of a version:
    /// where many have moved, or once they have.
    fn moves_on_gpu(&self, held: Option<u64>) -> bool {
        /// The others are fewer than so many times those that have moved.
        const FEW: usize = 8;
        let placed = self.geometry.placed();
        let Some(held) = held.filter(|held| !self.geometry.is_begun_after(*held)) else {
            return false;
        };
        let moved = placed.moved_since(held);
        let has_rest = self.buffers.version(AT_REST) == Some(placed.rested);
        moved > 0 && (has_rest || FEW * moved > self.scene.mesh.positions.len())
    }

    /// The resource of a name; of a single light, the list.
    pub fn find(&self, name: &str) -> Option<&'static Resource> {
        let name = lights::list_of(name).unwrap_or(name);
        self.resources.iter().find(|resource| resource.name == name)
    }

    /// Names of the resources that every provider has.
    pub fn names(&self) -> impl Iterator<Item = String> {
        let names = self.resources.iter().map(|resource| resource.name);
        let names = names.filter(|name| lights::list_of(name).is_none());
        names.map(str::to_owned)
    }

    pub fn unknown(&self, name: &str) -> Error {
        Error::Unknown {
            name: name.to_owned(),
            known: self.names().collect(),
        }
    }

    /// Returns the version of a resource, but for what the device adds to one.
    pub fn version(&self, name: &str) -> u64 {
        let made_from = self.find(name).map(|resource| resource.made_from);
        let made_from = made_from.unwrap_or(MadeFrom::Mesh);
        self.versions.get(made_from, lights::number(name))
    }

    /// The buffer of that name with what is in it now.
    pub fn buffer(&mut self, name: &str, on: On) -> Result<wgpu::Buffer, Error> {
        let is_parted = self.geometry.is_in_parts();
        self.buffers.lay_over(self.versions.shape, is_parted);
        self.buffers.keeps_gaps = self.geometry.a_host_part().is_some();
        let version = self.version(name);
        if let Some(buffer) = self.buffers.get(name, version) {
            return Ok(buffer.clone());
        }
        let began = self.begin();
        let resource = self.find(name).ok_or_else(|| self.unknown(name))?;
        let held = self.buffers.version(name);
        let needs_places = match name {
            POSITIONS => !self.moves_on_gpu(held),
            NORMALS => {
                let (mesh, held) = (&self.scene.mesh, held.unwrap_or_default());
                let list = (name, mesh.normals.len(), false);
                let changed = self.geometry.placed().changed_since(held, list, mesh);
                !changed.is_empty()
            }
            BVH_NODES | BVH_PRIMITIVES | LIGHT_SPACE_NODES | LIGHT_SPACE_PRIMITIVES => true,
            _ => false,
        };
        if needs_places {
            self.bring();
        }
        let scene = Arc::clone(&self.scene);
        let how = (resource.upload)(self, &scene.mesh, name, on)?;
        self.note(name, how, began);
        let buffer = self.buffers.get(name, version);
        buffer.cloned().ok_or_else(|| self.unknown(name))
    }

    /// The time, and the bytes uploaded so far, at which a resource begins to be made.
    pub fn begin(&self) -> (Instant, u64) {
        (Instant::now(), self.buffers.work.uploaded)
    }

    /// Notes what was made; of lights, which list they are of.
    pub fn note(&mut self, name: &str, how: How, began: (Instant, u64)) {
        let (time, uploaded) = (began.0.elapsed(), self.buffers.work.uploaded - began.1);
        let Some(&Resource { name, .. }) = self.find(name) else {
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

    pub fn upload_items<T: bytemuck::NoUninit>(
        &mut self,
        name: &str,
        items: &[T],
        on: On,
    ) -> Result<How, Error> {
        let version = self.version(name);
        self.buffers.make(name, items, version, on)?;
        Ok(How::Made)
    }

    /// Number of entries that hierarchies have for primitives; in parts, room for those to come.
    pub fn tree_slots(&self) -> usize {
        let mesh = &self.scene.mesh;
        if self.geometry.is_in_parts() {
            mesh.triangles.len()
        } else {
            self.facts.casters(mesh)
        }
    }

    pub fn upload_casters(&mut self, mesh: &Mesh, name: &str, on: On) -> Result<How, Error> {
        let item = |id: u32| {
            let [a, b, c] = mesh.triangles[id as usize];
            [a, b, c, id]
        };
        let mut casters: Vec<[u32; 4]> = match &self.facts.listed {
            Some(listed) => listed.iter().copied().map(item).collect(),
            None => (0..mesh.triangles.len() as u32).map(item).collect(),
        };
        if casters.is_empty() {
            casters.push([u32::MAX; 4]);
        }
        self.upload_items(name, &casters, on)
    }

    pub fn upload_hierarchy(&mut self, on: On) -> Result<How, Error> {
        // Beyond some four million triangles the boxes of all leaves exceed what Vulkan promises
        // to bind, and so the smallest leaves are joined.
        let most = binding_limit(&on.device.limits()) / size_of::<BvhNode>() as u64;
        let (version, held) = (self.version(BVH_NODES), self.buffers.version(BVH_NODES));
        let mesh = &self.scene.mesh;
        let (trees, mut over) = self.geometry.trees(mesh);
        let fitted = trees.bvh(&mut over, most as usize, version, held);
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
        let writes = writes.into_iter();
        let cast = writes.filter(|(_, write)| write.mesh.shadows().casts());
        let writes: Vec<HostWrite> = cast.map(with_nodes).collect();
        self.write_host_parts(BVH_NODES, patched, writes, on)?;
        Ok(fitted.how)
    }

    /// Uploads the positions or normals that have changed, with a fourth coordinate.
    pub fn upload_corners(
        &mut self,
        name: &str,
        (items, w): (&[Vec3], f32),
        on: On,
    ) -> Result<How, Error> {
        let (version, held) = (self.version(name), self.buffers.version(name));
        let is_gpu = name == POSITIONS && self.moves_on_gpu(held);
        let (held, mesh) = (held.unwrap_or_default(), &self.scene.mesh);
        let list = (name, items.len(), is_gpu);
        let changed = self.geometry.placed().changed_since(held, list, mesh);
        let append = |range: Range<usize>, to: &mut Vec<Vec4>| {
            to.extend(items[range].iter().map(|item| item.extend(w)));
        };
        let changed = (items.len(), &changed[..]);
        let mut patched = self.buffers.patch(name, changed, append, version, on)?;
        let since = (patched != Patched::All).then_some(held);
        let writes = self.geometry.host_writes(since).into_iter();
        let writes = writes.map(|(_, write)| write).collect();
        if is_gpu {
            // Behind an error it has not what its version says.
            let moved = self.move_parts(patched, on);
            moved.inspect_err(|_| self.buffers.forget(name))?;
            patched = Patched::Some;
        }
        self.write_host_parts(name, patched, writes, on)?;
        Ok(How::Made)
    }

    /// Has the GPU move all parts that have maps, in the buffer of positions, which was patched.
    fn move_parts(&mut self, patched: Patched, on: On) -> Result<(), Error> {
        let placed = self.geometry.placed();
        if self.buffers.version(AT_REST) != Some(placed.rested) {
            let rest = placed.at_rest(&self.scene.mesh);
            self.buffers.make(AT_REST, &rest, placed.rested, on)?;
        }
        let rest = self.buffers.get(AT_REST, placed.rested).cloned();
        if let Some((rest, buffer)) = rest.zip(self.buffers.renew(POSITIONS, patched, on)) {
            let (buffers, maps) = ([&rest, &buffer], placed.own_maps());
            let bound = self.kernels.bind_own(buffers, maps, on.device)?;
            self.run(POSITIONS, bound);
        }
        Ok(())
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
                self.run(name, bound);
                Ok(())
            }
            Err(error) => {
                // It has not what its version says.
                self.buffers.forget(name);
                Err(error)
            }
        }
    }

    fn run(&mut self, name: &str, bound: Bound) {
        self.buffers.work.uploaded += bound.uploaded();
        let record = Arc::new(move |encoder: &mut _| bound.record(encoder));
        self.buffers.run(name, record);
    }

    fn bind_host_parts(
        &mut self,
        (name, buffer): (&str, &wgpu::Buffer),
        writes: Vec<HostWrite>,
        on: On,
    ) -> Result<Bound, Error> {
        self.geometry.check_host_parts()?;
        let (kernel, read): (_, &[&str]) = match name {
            POSITIONS => (Kernel::Positions, &[]),
            NORMALS => (Kernel::Normals, &[POSITIONS, INDICES]),
            _ => (Kernel::Nodes, &[POSITIONS, INDICES, BVH_PRIMITIVES]),
        };
        let read = read.iter().map(|name| self.buffer(name, on));
        let read = read.collect::<Result<Vec<_>, _>>()?;
        let buffers: Vec<_> = std::iter::once(buffer).chain(&read).collect();
        self.kernels.bind((kernel, &buffers), &writes, on.device)
    }

    /// Uploads the numbers of those triangles that have other corners than before.
    pub fn upload_triangles<const N: usize>(
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
    pub fn upload_appended<T: bytemuck::NoUninit>(
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

    /// The light, if it can be used; of the scene's lights the error names which one it is.
    pub fn checked(&self, light: LightKind) -> Result<LightKind, Error> {
        let Err(reason) = light.check() else {
            return Ok(light);
        };
        let mut lights = self.scene.lights.iter();
        // Numbers that are none equal nothing, but their mistakes do.
        let named = lights.find(|light| light.kind.check().as_ref() == Err(&reason));
        let named = named.and_then(|light| light.check().err());
        Err(Error::Light(named.unwrap_or(reason)))
    }

    pub fn upload_light_space(&mut self, on: On) -> Result<How, Error> {
        if self.light().directional().is_none() {
            return Err(Error::LightSpaceKind(self.light().word()));
        }
        if let Some(part) = self.geometry.a_host_part() {
            return Err(Error::OnDevice(LIGHT_SPACE_NODES, part));
        }
        let light = self.geometry.lay(self.light(), &self.scene.mesh);
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
        let (trees, mut over) = self.geometry.trees(&self.scene.mesh);
        let tree = trees.light_space(&mut over, space, most as usize)?;
        self.upload_items(LIGHT_SPACE_NODES, &tree.nodes, on)?;
        match tree.primitives {
            Some(items) => drop(self.upload_items(LIGHT_SPACE_PRIMITIVES, &items, on)?),
            None => {
                let version = self.version(LIGHT_SPACE_PRIMITIVES);
                self.buffers.still_hold(LIGHT_SPACE_PRIMITIVES, version);
            }
        }
        Ok(tree.how)
    }

    fn upload_light_space_of_parts(
        &mut self,
        space: (LightSpace, f32),
        most: usize,
        on: On,
    ) -> Result<How, Error> {
        let version = self.version(LIGHT_SPACE_NODES);
        let versions = [self.versions.shape, version];
        let (trees, mut over) = self.geometry.trees(&self.scene.mesh);
        let parted = trees.light_space_of_parts(&mut over, space, most, versions)?;
        let buffers = &mut self.buffers;
        let names = [LIGHT_SPACE_NODES, LIGHT_SPACE_PRIMITIVES];
        let is_held = names.map(|name| buffers.take_up(name, parted.since));
        let items = &parted.tree.primitives;
        let [mut nodes, mut primitives] = parted.changed;
        if !is_held[0] {
            nodes = all(parted.nodes.len());
        }
        if !is_held[1] {
            primitives = all(items.len());
        }
        buffers.patch_list(names[0], &parted.nodes, &nodes, version, on)?;
        buffers.patch_list(names[1], items, &primitives, version, on)?;
        for name in names {
            buffers.leave(name, parted.since, version);
        }
        let is_new = parted.since == 0;
        Ok(if is_new { How::Made } else { How::Refitted })
    }

    /// Returns the bytes of a resource that describes the camera or lights; `None` for others.
    fn content(&mut self, name: &str) -> Result<Option<Vec<u8>>, Error> {
        let mesh = &self.scene.mesh;
        let bytes = match name {
            CAMERA => bytes_of(&self.versions.eye.now.finite()?.camera).to_vec(),
            UNPROJECTION => bytes_of(&self.versions.eye.now.finite()?.unprojection).to_vec(),
            LIGHT => {
                let light = self.checked(self.light())?;
                bytes_of(&self.geometry.lay(light, mesh)).to_vec()
            }
            LIGHT_AREA => {
                let light = self.checked(self.light())?;
                bytes_of(&LightAreaUniform::from(&light)).to_vec()
            }
            _ if lights::list_of(name).is_some() => {
                for &light in self.lights() {
                    self.checked(light)?;
                }
                let lights = &self.versions.lights.now;
                let lay = |light| self.geometry.lay(light, mesh);
                let content = lights::content(name, lights, lay);
                let gone = || lights::gone(name, self.lights());
                content.ok_or_else(|| gone().unwrap_or_else(|| self.unknown(name)))?
            }
            _ => return Ok(None),
        };
        Ok(Some(bytes))
    }

    /// True if a resource is told to executors by its bytes.
    pub fn is_uniform(&self, name: &str) -> bool {
        let held = self.find(name).map(|resource| resource.held);
        matches!(held, Some(Held::Uniform)) || lights::number(name).is_some()
    }

    /// Returns the bytes of a uniform, for the executor to bring to the device; `None` for other
    /// resources.
    pub fn uniform(&mut self, name: &str) -> Result<Option<Vec<u8>>, Error> {
        /// Number of contents that are kept.
        const TOLD: usize = 64;
        let version = self.version(name);
        let mut earlier = self.told.iter();
        if let Some((_, _, bytes)) = earlier.find(|(own, at, _)| own == name && *at == version) {
            return Ok(Some(bytes.clone()));
        }
        let began = self.begin();
        let content = self.content(name)?;
        if let Some(bytes) = &content {
            self.buffers.work.uploaded += bytes.len() as u64;
            self.note(name, How::Made, began);
            remember(
                &mut self.told,
                (name.to_owned(), version, bytes.clone()),
                TOLD,
            );
        }
        Ok(content)
    }

    /// Uploads a resource that describes the camera or lights.
    pub fn upload_content(&mut self, _: &Mesh, name: &str, on: On) -> Result<How, Error> {
        let content = self.content(name)?.ok_or_else(|| self.unknown(name))?;
        self.upload_items(name, &content, on)
    }

    /// Returns the mesh's materials.
    pub fn atlas(&mut self) -> Result<Arc<Atlas>, Error> {
        Arc::make_mut(&mut self.atlas).append(&self.scene.mesh.surfaces)?;
        let atlas = Arc::clone(&self.atlas);
        if !self.geometry.is_in_parts() {
            // No other materials come, so that it is not worth its memory.
            self.atlas = Arc::default();
        }
        Ok(atlas)
    }

    /// Notes which triangles of a part that was put into the mesh are sheets.
    pub fn put_sheets(&mut self, part: &Mesh, first: usize) {
        let total = self.scene.mesh.triangles.len();
        Arc::make_mut(&mut self.sheets).put(part, first, total);
    }

    /// Changes the geometry, and notes what changed.
    pub fn change(
        &mut self,
        change: impl FnOnce(&mut Geometry, &mut Arc<Scene>) -> Result<Change, Error>,
    ) -> Result<(), Error> {
        let change = change(&mut self.geometry, &mut self.scene)?;
        self.note_change(change);
        Ok(())
    }

    pub fn note_change(&mut self, change: Change) {
        self.current.take();
        if change.is_grown {
            self.atlas = Arc::default();
            self.versions.change_mesh();
        }
        if change.is_turned || change.is_painted {
            // Texture coordinates come in the order of corners.
            self.facts = Facts::new(&self.scene.mesh).into();
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
