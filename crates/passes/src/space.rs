//! Room in the lists of a mesh for parts that are added.

use crate::buffers::check_size;
use crate::error::Error;
use crate::names::{BVH_NODES, INDICES, NORMALS, POSITIONS};
use crate::parts::Room;
use glam::Vec3;
use skiagraph_scene::{BvhNode, Mesh, PartPlace, free::Free};
use std::ops::Range;

/// Buffers that grow with a [`Room`], each with the bytes of one of its
/// [numbers](Room::numbers): two nodes of the top level for a part.
const GROWING: [(&str, u64); 4] = [
    (BVH_NODES, 2 * size_of::<BvhNode>() as u64),
    (POSITIONS, 16),
    (NORMALS, 16),
    (INDICES, 12),
];

/// Room of a mesh that no part has.
#[derive(Clone, Default)]
pub(crate) struct Space {
    /// Room for positions, for normals and for triangles.
    free: [Free; 3],
    /// All room that was asked for.
    pub room: Room,
    /// The most bytes of a buffer that the device binds, once that is known.
    pub limit: Option<u64>,
}

impl Space {
    /// The numbers of the items that a mesh of so many pieces has, in the order of [`GROWING`].
    fn numbers(&self, pieces: usize, mesh: &Mesh) -> [usize; 4] {
        [
            pieces + self.room.parts,
            mesh.positions.len(),
            mesh.normals.len(),
            mesh.triangles.len(),
        ]
    }

    /// Checks that a mesh of so many pieces can have more room.
    ///
    /// # Errors
    /// [`Error::TooLarge`].
    pub fn check(&self, room: Room, pieces: usize, mesh: &Mesh) -> Result<(), Error> {
        let numbers = self.numbers(pieces, mesh).into_iter().zip(room.numbers());
        for ((there, more), (name, bytes)) in numbers.zip(GROWING) {
            let bytes = bytes.saturating_mul(there.saturating_add(more) as u64);
            check_size(name, bytes, self.limit.unwrap_or(u64::MAX))?;
        }
        Ok(())
    }

    /// Makes room in a mesh.
    pub fn reserve(&mut self, room: Room, mesh: &mut Mesh) {
        // Triangles that no part has yet have a corner, and a normal.
        let least = usize::from(room.triangles > 0);
        let [positions, normals] = [room.positions, room.normals].map(|it| it.max(least));
        lengthened(&mut mesh.normal_indices, room.triangles, [0; 3]);
        self.give_back([
            lengthened(&mut mesh.positions, positions, Vec3::ZERO),
            lengthened(&mut mesh.normals, normals, Vec3::Y),
            lengthened(&mut mesh.triangles, room.triangles, [0; 3]),
        ]);
        mesh.surfaces.pad(mesh.triangles.len());
        self.room.parts += room.parts;
        self.room.triangles += room.triangles;
    }

    /// True if there is that room.
    fn has(&self, needed: Room) -> bool {
        let [_, needed @ ..] = needed.numbers();
        let mut each = self.free.iter().zip(needed);
        each.all(|(free, needed)| needed <= free.longest())
    }

    /// Returns the room by which a mesh of so many pieces must grow, if there is too little.
    pub fn lacking(&self, needed: Room, pieces: usize, mesh: &Mesh) -> Option<Room> {
        (!self.has(needed)).then(|| self.more(needed, pieces, mesh))
    }

    /// Returns the room by which a mesh of so many pieces is to grow: a half, or what is needed.
    fn more(&self, needed: Room, pieces: usize, mesh: &Mesh) -> Room {
        let there = self.numbers(pieces, mesh);
        let most = GROWING.map(|(_, bytes)| self.limit.map(|limit| (limit / bytes) as usize));
        let needed = needed.numbers();
        Room::from_numbers(std::array::from_fn(|at| {
            let left = most[at].map_or(usize::MAX, |most| most.saturating_sub(there[at]));
            needed[at].max((there[at] / 2).min(left))
        }))
    }

    /// Takes room that there is.
    pub fn take(&mut self, needed: Room) -> PartPlace {
        let [_, needed @ ..] = needed.numbers();
        let taken = |at: usize| self.free[at].take(needed[at]).unwrap_or_default();
        let [position, normal, triangle] = [0, 1, 2].map(taken);
        PartPlace {
            position,
            normal,
            triangle,
        }
    }

    /// Gives back the positions, normals and triangles of a part.
    pub fn give_back(&mut self, ranges: [Range<usize>; 3]) {
        for (free, range) in self.free.iter_mut().zip(ranges) {
            free.give_back(range);
        }
    }
}

/// Lengthens a list by so many items; the range of the new ones.
fn lengthened<T: Clone>(list: &mut Vec<T>, by: usize, item: T) -> Range<usize> {
    let before = list.len();
    list.resize(before + by, item);
    before..list.len()
}
