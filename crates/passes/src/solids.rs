//! The triangles of a mesh as solids: one for each piece whose triangles lie together.

use crate::piece::{Content, Piece};
use skiagraph_scene::Mesh;
use std::ops::Range;

/// Triangles that a tracer other than ours has in a structure of their own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Solid {
    /// The piece that they are; `None` for pieces whose triangles lie among those of others, which
    /// are one solid together.
    pub piece: Option<usize>,
    /// The range of the mesh that holds them, and no others if they are a piece.
    pub triangles: Range<usize>,
    /// Number of the last change of their corners.
    pub changed: u64,
}

/// Returns the solids of the mesh: all of its triangles but those that no part has. They are
/// `most` at most, and the numbers of their first triangles have 24 bits.
pub(crate) fn solids(pieces: &[Piece], mesh: &Mesh, most: u32) -> Vec<Solid> {
    let mut solids = Vec::new();
    let (mut together, mut changed) = (0..0, 0);
    for (number, piece) in pieces.iter().enumerate() {
        let (triangles, of_piece) = (piece.triangles(mesh), piece.moved.max(piece.turned));
        if is_solid(pieces, piece, mesh, most) {
            let (piece, changed) = (Some(number), of_piece);
            solids.push(Solid {
                piece,
                triangles,
                changed,
            });
        } else {
            // Those of a piece that is gone may have been among these.
            changed = changed.max(of_piece);
            together.end = together.end.max(triangles.end);
        }
    }
    solids.retain(|solid| !solid.triangles.is_empty());
    let together = Solid {
        piece: None,
        triangles: together,
        changed,
    };
    solids.extend((!together.triangles.is_empty()).then_some(together));
    solids
}

/// True if a piece is a solid by itself.
fn is_solid(pieces: &[Piece], piece: &Piece, mesh: &Mesh, most: u32) -> bool {
    let triangles = piece.triangles(mesh);
    let count = match &piece.content {
        Content::Part(part) => part.of.triangles(part.number).len(),
        Content::Outside(outside) => outside.triangles.len(),
        Content::Whole => triangles.len(),
        Content::Gone => return false,
    };
    let is_named = triangles.start < 1 << 24 && pieces.len() < most as usize;
    count == triangles.len() && is_named
}

/// Returns the corners of the solid of those pieces that are none by themselves: those of other
/// triangles are all the same one, so that they have no area.
pub(crate) fn joined_corners(
    pieces: &[Piece],
    mesh: &Mesh,
    solid: &Solid,
    most: u32,
) -> Vec<[u32; 3]> {
    let mut corners = vec![[0; 3]; solid.triangles.len()];
    let joined = pieces
        .iter()
        .filter(|piece| !is_solid(pieces, piece, mesh, most));
    for primitive in joined.flat_map(|piece| piece.primitives(mesh)) {
        corners[primitive as usize] = mesh.triangles[primitive as usize];
    }
    corners
}
