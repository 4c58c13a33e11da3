//! Parts of a mesh as a host knows them, and the room for more of them.

use skiagraph_scene::{Mesh, Movable};

/// Handle of a part of a provider's mesh, as [`SceneProvider::add_part`] and
/// [`SceneProvider::parts`] return it. It names the same part after other parts were added or
/// removed, and in [branches](crate::SceneProvider::branch) that were made while the part was
/// there. No two parts of the process have equal handles.
///
/// [`SceneProvider::add_part`]: crate::SceneProvider::add_part
/// [`SceneProvider::parts`]: crate::SceneProvider::parts
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PartId {
    pub(crate) piece: usize,
    /// No other part of the process has it.
    number: u64,
}

impl PartId {
    /// Creates the handle of the part that a piece is, with a number that no other has.
    pub(crate) fn new(piece: usize, number: u64) -> Self {
        Self { piece, number }
    }
}

/// Room in the buffers of a mesh for parts that are added later
/// ([`SceneProvider::reserve`](crate::SceneProvider::reserve)). Until a part takes them, the
/// triangles in this room are drawn, but cover no pixel: they have no area.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Room {
    /// Number of parts that the room is for.
    pub parts: usize,
    /// Number of positions of all these parts together.
    pub positions: usize,
    /// Number of normals of all these parts together. A part has one for each pair of a position
    /// and a normal that meet at a corner of its triangles.
    pub normals: usize,
    /// Number of triangles of all these parts together.
    pub triangles: usize,
}

impl Room {
    /// Returns the room that `copies` parts need, each a copy of `mesh`.
    pub fn of_copies(mesh: &Mesh, copies: usize) -> Self {
        Self::of(&Movable::joined(&[mesh]).rest, copies)
    }

    /// Returns the room that the parts of both rooms need together.
    pub fn and(self, other: Self) -> Self {
        let (own, other) = (self.numbers(), other.numbers());
        Self::from_numbers([0, 1, 2, 3].map(|at| own[at].saturating_add(other[at])))
    }

    /// The numbers of parts, positions, normals and triangles.
    pub(crate) fn numbers(self) -> [usize; 4] {
        [self.parts, self.positions, self.normals, self.triangles]
    }

    /// The room of these [numbers](Self::numbers).
    pub(crate) fn from_numbers([parts, positions, normals, triangles]: [usize; 4]) -> Self {
        Self {
            parts,
            positions,
            normals,
            triangles,
        }
    }

    /// Returns the room of copies of a mesh whose normals are those of a part.
    pub(crate) fn of(rest: &Mesh, copies: usize) -> Self {
        let (positions, normals) = (rest.positions.len(), rest.normals.len());
        let one = [1, positions, normals, rest.triangles.len()];
        Self::from_numbers(one.map(|number| copies.saturating_mul(number)))
    }
}
