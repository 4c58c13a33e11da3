//! The casters of a mesh as solids: one for each run of them in a piece whose triangles lie
//! together.

use crate::piece::{Content, Piece};
use skiagraph_scene::Mesh;
use std::ops::Range;

/// Triangles that a tracer other than ours has in a structure of their own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Solid {
    /// The piece that they are of, and the first of them; `None` for pieces whose triangles lie
    /// among those of others, which are one solid together.
    pub piece: Option<[usize; 2]>,
    /// The range of the mesh that holds them, and no others if they are of a piece.
    pub triangles: Range<usize>,
    /// Number of the last change of their corners.
    pub changed: u64,
}

/// Most runs of casters in a piece: one of more runs is joined with others.
const MOST_RUNS: usize = 64;

/// Returns the solids of the mesh: all of its casters but those that no part has. They are `most`
/// at most, and the numbers of their first triangles have 24 bits.
pub(crate) fn solids(pieces: &[Piece], mesh: &Mesh, most: u32) -> Vec<Solid> {
    let mut solids = Vec::new();
    let (mut together, mut changed) = (0..0, 0);
    for (number, piece) in pieces.iter().enumerate() {
        let of_piece = piece.moved.max(piece.turned);
        if let Some(runs) = runs(pieces, piece, mesh, most) {
            solids.extend(runs.into_iter().map(|triangles| Solid {
                piece: Some([number, triangles.start]),
                triangles,
                changed: of_piece,
            }));
        } else {
            // Those of a piece that is gone may have been among these.
            changed = changed.max(of_piece);
            together.end = together.end.max(piece.triangles(mesh).end);
        }
    }
    let together = Solid {
        piece: None,
        triangles: together,
        changed,
    };
    solids.extend((!together.triangles.is_empty()).then_some(together));
    solids
}

/// The runs of casters of a piece, if they are solids by themselves.
fn runs(pieces: &[Piece], piece: &Piece, mesh: &Mesh, most: u32) -> Option<Vec<Range<usize>>> {
    let triangles = piece.triangles(mesh);
    let count = match &piece.content {
        Content::Part(part) => part.of.triangles(part.number).len(),
        Content::Outside(outside) => outside.triangles.len(),
        Content::Whole => triangles.len(),
        Content::Gone => return None,
    };
    if count != triangles.len() {
        return None;
    }
    let mut runs = Vec::new();
    if mesh.surfaces.have_roles() {
        for caster in triangles.filter(|id| mesh.casts(*id as u32)) {
            match runs.last_mut() {
                Some(Range { end, .. }) if *end == caster => *end += 1,
                _ => runs.push(caster..caster + 1),
            }
        }
    } else if !triangles.is_empty() {
        runs.push(triangles);
    }
    let last = runs.last().map_or(0, |run| run.start);
    let is_named = last < 1 << 24 && pieces.len() * runs.len().max(1) < most as usize;
    (is_named && runs.len() <= MOST_RUNS).then_some(runs)
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
    let joined = pieces.iter();
    let joined = joined.filter(|piece| runs(pieces, piece, mesh, most).is_none());
    let joined = joined.flat_map(|piece| piece.primitives(mesh));
    for primitive in joined.filter(|id| mesh.casts(*id)) {
        corners[primitive as usize] = mesh.triangles[primitive as usize];
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;
    use skiagraph_scene::Shadows;

    /// Triangles of their own corners, of which some cast nothing.
    fn mesh(count: u32, quiet: &[u32]) -> Mesh {
        let mut mesh = Mesh {
            triangles: (0..count)
                .map(|at| [3 * at, 3 * at + 1, 3 * at + 2])
                .collect(),
            ..Mesh::default()
        };
        let quiet = quiet.iter().copied();
        mesh.surfaces
            .set_shadows(quiet, count as usize, Shadows::Receives);
        mesh
    }

    fn ranges(mesh: &Mesh) -> Vec<(Option<[usize; 2]>, Range<usize>)> {
        let solids = solids(&[Piece::new(Content::Whole)], mesh, 1 << 24).into_iter();
        solids.map(|solid| (solid.piece, solid.triangles)).collect()
    }

    #[test]
    fn each_run_of_casters_is_a_solid() {
        assert_eq!(ranges(&mesh(9, &[])), [(Some([0, 0]), 0..9)]);
        let runs = [(Some([0, 1]), 1..4), (Some([0, 6]), 6..9)];
        assert_eq!(ranges(&mesh(9, &[0, 4, 5])), runs);
        assert_eq!(ranges(&mesh(2, &[0, 1])), []);
    }

    #[test]
    fn many_runs_are_one_solid_in_which_others_have_no_area() {
        let quiet: Vec<u32> = (0..300).filter(|at| at % 2 == 1).collect();
        let mesh = mesh(300, &quiet);
        let pieces = [Piece::new(Content::Whole)];
        let solids = solids(&pieces, &mesh, 1 << 24);
        assert_eq!((solids.len(), solids[0].piece), (1, None));
        let corners = joined_corners(&pieces, &mesh, &solids[0], 1 << 24);
        let areas = corners.iter().filter(|corners| **corners != [0; 3]);
        assert_eq!(areas.count(), 150);
    }
}
