//! The geometry of a mesh: the pieces that move by themselves, where they are, and the things kept
//! over them, so that a frame pays for those that moved.

use crate::adjacencies::Adjacencies;
use crate::buffers::binding_limit;
use crate::built::Work;
use crate::changes::{Change, Cleared};
use crate::error::Error;
use crate::hierarchies::all;
use crate::host_buffers::{HostMesh, HostWrite};
use crate::names::next_version;
use crate::outlines::Outlines;
use crate::painted::Painted;
use crate::part::{Added, Moved, Part, placed};
use crate::parts::{PartId, Room};
use crate::piece::{Content, Outside, Piece};
use crate::placed::Placed;
use crate::space::Space;
use crate::trees::{Over, Trees};
use crate::uniforms::LightUniform;
use glam::{DAffine3, Vec3};
use skiagraph_scene::{LightKind, Mesh, Movable, MoveError, PartPlace, Scene};
use std::{collections::BTreeSet, ops::Range, sync::Arc};

/// Pieces of a mesh: its parts, and all that is in none of them. A mesh without parts is one piece.
#[derive(Clone, Default)]
pub(crate) struct Geometry {
    pieces: Vec<Piece>,
    /// Map of each piece from its place at rest, close together as each frame reads all of them;
    /// `None` for a part without a place, or if it was bent since, and for pieces that are no part.
    maps: Vec<Option<DAffine3>>,
    /// The parts that there are, in the order in which they came.
    parts: Vec<PartId>,
    /// Numbers of pieces that were removed, for those that are added.
    gone: Vec<usize>,
    /// Pieces that maps have moved since their corners in the scene's mesh were computed.
    behind: BTreeSet<usize>,
    /// Number of the change that gave parts their positions at rest.
    rested: u64,
    /// Triangles of parts that were removed, each with the number of that change.
    cleared: Cleared,
    /// Number of the change that gave the mesh its items.
    begun: u64,
    /// Parts that the mesh began with; `None` for a mesh without parts.
    first: Option<Arc<Movable>>,
    /// True if the parts are in spaces of their own and were never given places.
    is_unplaced: bool,
    /// True if the mesh moves, so that trees are worth their memory.
    is_deformed: bool,
    pub space: Space,
    painted: Painted,
    trees: Trees,
    outlines: Outlines,
    adjacencies: Adjacencies,
    /// Work besides uploads.
    pub work: Work,
}

impl Geometry {
    /// Creates the geometry of a mesh without parts.
    pub fn whole() -> Self {
        Self {
            begun: next_version(),
            pieces: vec![Piece::new(Content::Whole)],
            maps: vec![None],
            ..Self::default()
        }
    }

    /// Creates the geometry of a mesh in parts, which are at rest.
    pub fn parted(parts: Arc<Movable>) -> Self {
        let is_joined = parts.is_joined();
        let part = |number| Part {
            id: PartId::new(number, next_version()),
            of: Arc::clone(&parts),
            number,
            at: PartPlace::default(),
            is_mirrored: false,
            mesh: None,
            host: None,
        };
        let own: Vec<Part> = (0..parts.parts()).map(part).collect();
        let begun = next_version();
        let ids: Vec<PartId> = own.iter().map(|part| part.id).collect();
        let pieces = own.into_iter().map(|part| Piece::new(Content::Part(part)));
        let mut pieces: Vec<Piece> = pieces.collect();
        let outside = Outside::new(&parts);
        if !outside.triangles.is_empty() {
            pieces.push(Piece::new(Content::Outside(Arc::new(outside))));
        }
        let mut maps = vec![(!is_joined).then_some(DAffine3::IDENTITY); ids.len()];
        maps.resize(pieces.len(), None);
        Self {
            maps,
            pieces,
            parts: ids,
            begun,
            painted: Painted::new(&parts.rest.surfaces),
            is_unplaced: is_joined && parts.parts() > 0,
            first: Some(parts),
            is_deformed: true,
            ..Self::default()
        }
    }

    /// Returns the geometry of another mesh, with the work that was done for this one.
    pub fn replaced_by(&self, other: Self) -> Self {
        let work = self.work;
        let mut other = Self { work, ..other };
        other.space.limit = self.space.limit;
        other
    }

    /// True for a mesh in parts.
    pub fn is_in_parts(&self) -> bool {
        self.first.is_some()
    }

    /// Refuses a mesh without parts.
    fn check_parts(&self) -> Result<(), Error> {
        self.first.as_ref().map(drop).ok_or(Error::NoParts)
    }

    /// True if parts are in spaces of their own and have no places yet.
    pub fn is_unplaced(&self) -> bool {
        self.is_unplaced
    }

    /// The parts that there are, in the order in which they came.
    pub fn parts(&self) -> &[PartId] {
        &self.parts
    }

    /// The number of a part among those that there are.
    ///
    /// # Errors
    /// [`Error::NoPart`] for one that was removed, or is of another mesh.
    fn number(&self, id: PartId) -> Result<usize, Error> {
        let number = self.parts.iter().position(|part| *part == id);
        number.ok_or(Error::NoPart(id))
    }

    /// The part of a handle.
    ///
    /// # Errors
    /// [`Error::NoPart`].
    pub fn part(&self, id: PartId) -> Result<&Part, Error> {
        match self.pieces.get(id.piece).map(|piece| &piece.content) {
            Some(Content::Part(part)) if part.id == id => Ok(part),
            _ => Err(Error::NoPart(id)),
        }
    }

    fn part_mut(&mut self, piece: usize) -> Result<&mut Part, Error> {
        match self.pieces.get_mut(piece).map(|piece| &mut piece.content) {
            Some(Content::Part(part)) => Ok(part),
            _ => Err(Error::NoParts),
        }
    }

    /// Moves the parts whose maps are others than before. Their corners in the scene's mesh follow
    /// when they are [brought](Self::bring) there.
    ///
    /// # Errors
    /// See [`SceneProvider::set_transforms`](crate::SceneProvider::set_transforms).
    pub fn set_transforms(
        &mut self,
        maps: &[DAffine3],
        scene: &mut Arc<Scene>,
    ) -> Result<Change, Error> {
        self.check_parts()?;
        let [parts, given] = [self.parts.len(), maps.len()];
        if parts != given {
            return Err(MoveError::Count { parts, maps: given }.into());
        }
        let moved: Vec<_> = self.parts.iter().copied().zip(maps).enumerate().collect();
        self.move_parts(&moved, scene)
    }

    /// Moves one part.
    ///
    /// # Errors
    /// [`Error::NoPart`], [`Error::Move`].
    pub fn set_transform(
        &mut self,
        id: PartId,
        map: &DAffine3,
        scene: &mut Arc<Scene>,
    ) -> Result<Change, Error> {
        let number = self.number(id)?;
        self.move_parts(&[(number, (id, map))], scene)
    }

    fn move_parts(
        &mut self,
        maps: &[(usize, (PartId, &DAffine3))],
        scene: &mut Arc<Scene>,
    ) -> Result<Change, Error> {
        let mut moved = Vec::new();
        for &(number, (id, map)) in maps {
            if self.maps[id.piece] != Some(*map) {
                let placed = self.part(id)?.place(map);
                let placed = placed.map_err(|error| error.renumbered(number))?;
                moved.push((id.piece, map, placed));
            }
        }
        let mut change = Change::default();
        for (piece, map, placed) in moved {
            let before = self.maps[piece].replace(*map);
            let own = &mut self.pieces[piece];
            change.is_turned |= own.move_by((before, map), placed, scene);
            change.is_elsewhere = true;
            self.work.moved += own.ranges(&scene.mesh)[0].len() as u64;
            if own.host().is_none() {
                self.behind.insert(piece);
            }
        }
        if self.is_unplaced && self.has_places() {
            self.is_unplaced = false;
            change.is_elsewhere = true;
        }
        Ok(change)
    }

    /// True if each part has a map.
    fn has_places(&self) -> bool {
        let mut parts = self.parts.iter();
        parts.all(|id| self.maps[id.piece].is_some())
    }

    /// Computes the corners in the scene's mesh of those parts that maps have moved.
    pub fn bring(&mut self, scene: &mut Arc<Scene>) {
        if !self.behind.is_empty() {
            self.placed().bring(&mut Arc::make_mut(scene).mesh);
            self.behind.clear();
        }
    }

    /// Where the parts are.
    pub fn placed(&self) -> Placed<'_> {
        Placed {
            pieces: &self.pieces,
            maps: &self.maps,
            behind: &self.behind,
            begun: self.begun,
            rested: self.rested.max(self.begun),
        }
    }

    /// Notes that the positions and normals of `mesh` are about to be replaced by these, and
    /// returns true if they are others.
    pub fn deform(&mut self, mesh: &Mesh, positions: &[Vec3], normals: &[Vec3]) -> bool {
        self.is_unplaced = false;
        if mesh.positions == positions && mesh.normals == normals {
            return false;
        }
        // The maps of parts, if there are any, no longer say where those are.
        self.maps.fill(None);
        self.is_deformed = true;
        self.trees.bend();
        let version = next_version();
        for piece in &mut self.pieces {
            let [is_elsewhere, is_leaning] = piece.is_bent(mesh, positions, normals);
            if is_elsewhere {
                piece.moved = version;
                self.work.moved += piece.ranges(mesh)[0].len() as u64;
            }
            if is_leaning {
                piece.leaned = version;
            }
        }
        true
    }

    /// Makes room for parts in the scene's mesh, and in the hierarchy over it.
    ///
    /// # Errors
    /// [`Error::NoParts`], [`Error::TooLarge`].
    pub fn reserve(&mut self, room: Room, scene: &mut Arc<Scene>) -> Result<(), Error> {
        self.check_parts()?;
        self.space.check(room, self.pieces.len(), &scene.mesh)?;
        self.space.reserve(room, &mut Arc::make_mut(scene).mesh);
        self.begun = next_version();
        self.adjacencies.forget();
        self.trees.reserve(room);
        Ok(())
    }

    /// Adds a part to the scene's mesh, which grows if it has no room for it; `replaced` gives it
    /// its room and its handle.
    ///
    /// # Errors
    /// [`Error::NoParts`], [`Error::NoPart`], [`Error::Move`], [`Error::TooLarge`].
    pub fn add(
        &mut self,
        added: Added,
        map: &DAffine3,
        replaced: Option<PartId>,
        scene: &mut Arc<Scene>,
    ) -> Result<(PartId, Change), Error> {
        self.check_parts()?;
        let number = replaced.map(|id| self.number(id)).transpose()?;
        let number = number.unwrap_or(self.parts.len());
        let is_mirrored = map.matrix3.determinant() < 0.0;
        let moved = added.moved(map);
        let moved = moved.map_err(|error| error.renumbered(number))?;
        let movable = Arc::clone(added.movable());
        let needed = Room::of(&movable.rest, 1);
        if let Some(id) = replaced {
            self.check_replaced(id, needed, &scene.mesh)?;
            // Nothing fails behind this.
            self.remove(id, scene)?;
        }
        let lacking = self.space.lacking(needed, self.pieces.len(), &scene.mesh);
        let begun = self.begun;
        if let Some(more) = lacking {
            self.reserve(more, scene)?;
        }
        let at = self.space.take(needed);
        let whole = &mut Arc::make_mut(scene).mesh;
        for (index, corners) in movable.rest.triangles.iter().enumerate() {
            let corner = |corner| at.position as u32 + corner;
            whole.triangles[at.triangle + index] = corners.map(corner);
            let normals = movable.rest.normal_indices[index];
            let normal = |normal| at.normal as u32 + normal;
            whole.normal_indices[at.triangle + index] = normals.map(normal);
        }
        let total = whole.triangles.len();
        let own = (at.triangle, movable.rest.triangles.len());
        if self.painted.put(&movable, own, whole) {
            self.begun = next_version();
        }
        let positions = movable.rest.positions.len();
        let host = match moved {
            Moved::OfHost(host) => {
                let own = own.0 as u32..(own.0 + own.1) as u32;
                whole.surfaces.set_shadows(own, total, host.mesh.shadows());
                // Its tree may have to be built once more.
                let own = &mut whole.positions[at.position..][..positions];
                own.copy_from_slice(&movable.rest.positions);
                Some(host)
            }
            Moved::Own(moved) => {
                movable.put_at(0, &moved, whole, at);
                None
            }
        };
        if is_mirrored {
            movable.turn_at(0, whole, at);
        }
        let piece = self.gone.pop().unwrap_or(self.pieces.len());
        let id = replaced.unwrap_or_else(|| PartId::new(piece, next_version()));
        let part = Piece::new(Content::Part(Part {
            id,
            number: 0,
            at,
            is_mirrored,
            of: movable,
            mesh: match added {
                Added::Own(mesh) => Some(mesh),
                Added::OfHost(_) => None,
            },
            host,
        }));
        self.rested = next_version();
        self.work.nodes += self.trees.add(&part, piece) as u64;
        if piece < self.pieces.len() {
            self.pieces[piece] = part;
        } else {
            self.pieces.push(part);
            self.maps.push(None);
        }
        self.maps[piece] = Some(*map);
        self.parts.insert(number, id);
        self.work.moved += positions as u64;
        let change = Change {
            is_elsewhere: true,
            is_turned: true,
            is_painted: !whole.surfaces.of.is_empty(),
            is_grown: self.begun != begun,
        };
        Ok((id, change))
    }

    /// Checks that there is room for a part in the place of another one, or can be.
    fn check_replaced(&self, id: PartId, needed: Room, mesh: &Mesh) -> Result<(), Error> {
        let (mut space, pieces) = (self.space.clone(), self.pieces.len());
        if let Some(ranges) = self.part(id)?.room() {
            space.give_back(ranges);
        }
        let more = space.lacking(needed, pieces, mesh);
        more.map_or(Ok(()), |more| space.check(more, pieces, mesh))
    }

    /// Removes a part from the scene's mesh: its triangles have no area any more, and its room is
    /// for other parts.
    ///
    /// # Errors
    /// [`Error::NoPart`].
    pub fn remove(&mut self, id: PartId, scene: &mut Arc<Scene>) -> Result<Change, Error> {
        let number = self.number(id)?;
        let part = self.part(id)?.clone();
        let mesh = &mut Arc::make_mut(scene).mesh;
        for &triangle in part.of.triangles(part.number) {
            let triangle = part.at.triangle + triangle as usize;
            mesh.triangles[triangle] = [0; 3];
            mesh.normal_indices[triangle] = [0; 3];
        }
        if let Some(ranges) = part.room() {
            self.space.give_back(ranges);
        }
        self.pieces[id.piece] = Piece::new(Content::Gone);
        self.maps[id.piece] = None;
        self.behind.remove(&id.piece);
        self.rested = next_version();
        self.parts.remove(number);
        self.gone.push(id.piece);
        self.cleared.clear(part.triangles());
        self.trees.remove(id.piece);
        self.is_unplaced &= !self.has_places();
        let mut change = Change::MOVED;
        change.is_turned = true;
        Ok(change)
    }

    /// Notes that the host has rewritten the vertices of a part within these bounds.
    ///
    /// # Errors
    /// [`Error::NoPart`], [`Error::NoHostPart`], [`Error::Bounds`], [`Error::Move`].
    pub fn rewrite(&mut self, id: PartId, bounds: [Vec3; 2]) -> Result<Change, Error> {
        let number = self.number(id)?;
        let part = self.part(id)?;
        let (Some(_), Some(map)) = (&part.host, &self.maps[id.piece]) else {
            return Err(Error::NoHostPart(id));
        };
        let [low, high] = bounds;
        if !low.cmple(high).all() || !low.is_finite() || !high.is_finite() {
            let part = id;
            return Err(Error::Bounds { part, low, high });
        }
        let moved = placed(bounds, map).map_err(|error| error.renumbered(number))?;
        if let Some(host) = &mut self.part_mut(id.piece)?.host {
            (host.bounds, host.placed) = (bounds, moved);
        }
        let positions = self.part(id)?.positions();
        self.work.moved += positions as u64;
        self.pieces[id.piece].moved = next_version();
        Ok(Change::MOVED)
    }

    /// Notes the device that the scene's buffers are on from now on, with its limits. Vertices in
    /// hosts' buffers of others are not read.
    pub fn move_to(&mut self, device: &wgpu::Device) {
        let most = binding_limit(&device.limits());
        self.space.limit = self.space.limit.map(|_| most);
        self.trees.move_to(most);
        for host in self.pieces.iter_mut().filter_map(Piece::host_mut) {
            host.is_elsewhere = !host.mesh.is_on(device);
        }
    }

    /// Checks that the vertices of all parts of hosts' buffers are on the device of the scene's.
    ///
    /// # Errors
    /// [`Error::HostVertices`] with those that are not.
    pub fn check_host_parts(&self) -> Result<(), Error> {
        let host = |id: &PartId| self.pieces[id.piece].host();
        let is_elsewhere = |id: &PartId| host(id).is_some_and(|host| host.is_elsewhere);
        let parts: Vec<PartId> = self.parts.iter().copied().filter(is_elsewhere).collect();
        if parts.is_empty() {
            return Ok(());
        }
        let why = "they are in buffers of another device".to_owned();
        Err(Error::HostVertices { parts, why })
    }

    /// Gives the parts of a host's mesh another buffer of the same mesh; their number, and what has
    /// changed.
    pub fn set_host_mesh(&mut self, mesh: &HostMesh) -> (usize, Change) {
        let mut parts = 0;
        for piece in &mut self.pieces {
            if let Some(host) = piece.host_mut()
                && Arc::ptr_eq(host.mesh.movable(), mesh.movable())
            {
                let shadows = host.mesh.shadows();
                host.mesh = mesh.clone().with_shadows(shadows);
                host.is_elsewhere = false;
                piece.moved = next_version();
                parts += 1;
            }
        }
        match parts {
            0 => (parts, Change::default()),
            _ => (parts, Change::MOVED),
        }
    }

    /// Returns a part whose vertices are in a buffer of the host, if there is one.
    pub fn a_host_part(&self) -> Option<PartId> {
        let mut parts = self.parts.iter().copied();
        parts.find(|id| self.pieces[id.piece].host().is_some())
    }

    /// The writes of those parts of hosts' buffers that have changed since a version of the shape,
    /// with the pieces that they are; all of them if the scene's buffer was made anew.
    pub fn host_writes(&self, since: Option<u64>) -> Vec<(usize, HostWrite)> {
        let is_meant = |piece: &Piece| since.is_none_or(|version| piece.changed() > version);
        let pieces = self.pieces.iter().enumerate();
        let writes = pieces.filter_map(|(number, piece)| match &piece.content {
            Content::Part(part) if is_meant(piece) => {
                Some((number, part.host_write(self.maps[number]?)?))
            }
            _ => None,
        });
        writes.collect()
    }

    /// True if the mesh was given its items after that version.
    pub fn is_begun_after(&self, version: u64) -> bool {
        version < self.begun
    }

    /// The ranges of triangles that have other corners than in a version of the winding.
    pub fn triangles_since(&self, version: u64, mesh: &Mesh) -> Vec<Range<usize>> {
        if self.is_begun_after(version) {
            return all(mesh.triangles.len());
        }
        let turned = self.pieces.iter().filter(|piece| piece.turned > version);
        let turned = turned.map(|piece| piece.triangles(mesh));
        turned.chain(self.cleared.since(version)).collect()
    }

    /// Returns the adjacency of the mesh. `version` is that of the winding.
    pub fn adjacency(&mut self, mesh: &Mesh, version: u64) -> Arc<Vec<u32>> {
        let mut adjacencies = std::mem::take(&mut self.adjacencies);
        let turned = |since: u64| {
            let turned = self.pieces.iter().filter(|piece| piece.turned > since);
            let turned = turned.map(|piece| piece.primitives(mesh));
            let cleared = self.cleared.since(since);
            // Without an area they have no neighbours; those of pieces come after. A range may hold
            // triangles of other parts.
            let is_clear = |id: &u32| mesh.triangles[*id as usize] == [0; 3];
            let cleared = cleared.map(|range| {
                let range = range.start as u32..range.end as u32;
                range.filter(is_clear).collect()
            });
            cleared.chain(turned).collect()
        };
        let turned = self.first.is_some().then_some(turned);
        let opposite = adjacencies.get(mesh, version, turned);
        self.adjacencies = adjacencies;
        opposite
    }

    /// The hierarchies, and the pieces that they are over.
    pub fn trees<'a>(&'a mut self, mesh: &'a Mesh) -> (&'a mut Trees, Over<'a>) {
        let over = Over {
            mesh,
            pieces: &mut self.pieces,
            first: self.first.as_deref(),
            room: self.space.room,
            is_deformed: self.is_deformed,
            work: &mut self.work,
        };
        (&mut self.trees, over)
    }

    /// The pieces of the mesh.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// Returns the uniform of a light that is laid around the mesh. Of pieces that stand still, few
    /// corners are looked at, or none.
    pub fn lay(&mut self, light: LightKind, mesh: &Mesh) -> LightUniform {
        let moved: Vec<u64> = self.pieces.iter().map(|piece| piece.moved).collect();
        let corners = |piece: usize| self.pieces[piece].corners(mesh, self.maps[piece].as_ref());
        let (uniform, laid) = self.outlines.lay(light, &moved, corners);
        self.work.laid += laid;
        uniform
    }
}
