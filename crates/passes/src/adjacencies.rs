//! The adjacency of a mesh in pieces, which share no edge: of a piece whose triangles get other
//! corners it is found anew, of the others it is kept.

use skiagraph_scene::{Adjacency, Mesh, NO_NEIGHBOUR, Surfaces};
use std::sync::Arc;

/// The adjacency that was asked for last.
#[derive(Clone, Default)]
pub(crate) struct Adjacencies {
    known: Option<(Arc<Vec<u32>>, u64)>,
}

impl Adjacencies {
    /// Returns the adjacency of a mesh whose winding has a version. `turned`, for a mesh in pieces,
    /// returns the primitives of each piece whose triangles have other corners since a version.
    pub fn get(
        &mut self,
        mesh: &Mesh,
        version: u64,
        turned: Option<impl Fn(u64) -> Vec<Vec<u32>>>,
    ) -> Arc<Vec<u32>> {
        let Some(turned) = turned else {
            return Arc::new(Adjacency::new(mesh).opposite);
        };
        let (mut opposite, pieces) = match self.known.take() {
            Some((before, since)) => (before, turned(since)),
            None => (Arc::new(Adjacency::new(mesh).opposite), Vec::new()),
        };
        for piece in pieces {
            let list: &mut Vec<u32> = Arc::make_mut(&mut opposite);
            renew(list, &piece, mesh);
        }
        self.known = Some((Arc::clone(&opposite), version));
        opposite
    }

    /// Forgets it, for a mesh of another number of triangles.
    pub fn forget(&mut self) {
        self.known = None;
    }
}

/// Finds the neighbours of a piece's triangles, all of which are of the piece.
fn renew(opposite: &mut [u32], piece: &[u32], mesh: &Mesh) {
    let picked = |list: &Vec<u32>| piece.iter().map(|&id| list[id as usize]).collect();
    let (whole, mut surfaces) = (&mesh.surfaces, Surfaces::default());
    if whole.need_care() || whole.have_roles() {
        surfaces.materials.clone_from(&whole.materials);
        surfaces.of = picked(&whole.of);
    }
    let triangles = piece.iter().map(|&id| mesh.triangles[id as usize]);
    let alone = Mesh {
        triangles: triangles.collect(),
        surfaces,
        ..Mesh::default()
    };
    let neighbours = Adjacency::new(&alone).opposite;
    for (corners, &id) in neighbours.chunks_exact(3).zip(piece) {
        for (side, &corner) in corners.iter().enumerate() {
            let place = |corner: u32| 3 * piece[corner as usize / 3] + corner % 3;
            let neighbour = Some(corner).filter(|corner| *corner != NO_NEIGHBOUR);
            opposite[3 * id as usize + side] = neighbour.map_or(NO_NEIGHBOUR, place);
        }
    }
}
