//! Connected parts of a mesh, and whether they are closed.

use crate::mesh::{Mesh, names_one_twice};
use petgraph::unionfind::UnionFind;
use std::collections::HashMap;

/// Connected parts of a mesh: triangles that share edges, where equal positions are one (welded).
///
/// A part is *closed* if its triangles pass each edge as often in one direction as in the other:
/// between two points outside the part a ray then meets as many of its back faces as of its front
/// faces. It is *open* if it has an edge of a single triangle, an edge whose two triangles are
/// wound against each other, or an edge of more triangles that do not form pairs of opposite
/// winding. Two boxes that touch along an edge have four triangles there, which form pairs: the
/// part stays closed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Parts {
    /// Part number of each triangle, by primitive id (the index in [`Mesh::triangles`]). Parts are
    /// numbered from 0 in the order of their first triangles.
    pub of: Vec<u32>,
    /// One entry per part, by part number: true if the part is open.
    pub open: Vec<bool>,
}

/// A triangle's side: its edge, the lower position first, whether it is passed in that direction,
/// and the triangle.
type Side = ([u32; 2], bool, u32);

impl Parts {
    /// Finds the parts of a mesh. A triangle that names a position twice has no area, and one may
    /// [cast](Mesh::casts) no shadow: such a triangle closes no edge, and is an open part of its
    /// own.
    pub fn new(mesh: &Mesh) -> Self {
        let mut sides = sides(mesh);
        sides.sort_unstable();
        let mut joined = UnionFind::<u32>::new(mesh.triangles.len());
        let ids = 0..mesh.triangles.len() as u32;
        let mut open: Vec<bool> = ids.map(|id| is_passed_over(mesh, id)).collect();
        for edge in sides.chunk_by(|one, other| one.0 == other.0) {
            let first = edge[0].2;
            for &(.., triangle) in edge {
                joined.union(first, triangle);
            }
            let forward = edge.iter().filter(|side| side.1).count();
            open[first as usize] |= 2 * forward != edge.len();
        }
        let mut parts = Self::default();
        let mut numbers = HashMap::new();
        for (root, is_open) in joined.into_labeling().into_iter().zip(open) {
            let part = *numbers.entry(root).or_insert(parts.open.len());
            if part == parts.open.len() {
                parts.open.push(false);
            }
            parts.of.push(part as u32);
            parts.open[part] |= is_open;
        }
        parts
    }

    /// Returns true if triangle `primitive` (an index into [`Mesh::triangles`]) belongs to an open
    /// part.
    ///
    /// # Panics
    /// If the mesh has no triangle `primitive`.
    pub fn is_open(&self, primitive: u32) -> bool {
        self.open[self.of[primitive as usize] as usize]
    }
}

fn is_passed_over(mesh: &Mesh, primitive: u32) -> bool {
    names_one_twice(&mesh.triangles[primitive as usize]) || !mesh.casts(primitive)
}

fn sides(mesh: &Mesh) -> Vec<Side> {
    let mut sides = Vec::with_capacity(3 * mesh.triangles.len());
    for (primitive, &[a, b, c]) in (0..).zip(&mesh.triangles) {
        if is_passed_over(mesh, primitive) {
            continue;
        }
        sides.extend(
            [(a, b), (b, c), (c, a)]
                .map(|(from, to)| ([from.min(to), from.max(to)], from < to, primitive)),
        );
    }
    sides
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    fn parts(triangles: &[[u32; 3]]) -> Parts {
        Parts::new(&Mesh {
            triangles: triangles.to_vec(),
            ..Mesh::default()
        })
    }

    fn open(triangles: &[[u32; 3]]) -> Vec<bool> {
        parts(triangles).open
    }

    #[test]
    fn a_solid_is_closed_and_open_without_one_of_its_faces() {
        assert_eq!(open(&TETRAHEDRON), [false]);
        for face in 0..4 {
            let mut rest = TETRAHEDRON.to_vec();
            rest.remove(face);
            assert_eq!(open(&rest), [true]);
        }
    }

    #[test]
    fn a_face_wound_against_the_others_opens() {
        for face in 0..4 {
            let mut turned = TETRAHEDRON;
            turned[face].swap(0, 1);
            assert_eq!(open(&turned), [true]);
        }
        // Inside out is closed, too.
        let inside_out = TETRAHEDRON.map(|[a, b, c]| [a, c, b]);
        assert_eq!(open(&inside_out), [false]);
    }

    #[test]
    fn more_than_two_triangles_at_an_edge_close_if_they_pair_off() {
        let beside = TETRAHEDRON.map(|face| face.map(|corner| [0, 1, 4, 5][corner as usize]));
        let two = [&TETRAHEDRON[..], &beside].concat();
        assert_eq!(parts(&two).of, [0; 8]);
        assert_eq!(open(&two), [false]);
        // A sheet on the edge of a solid.
        let with_sheet = [&TETRAHEDRON[..], &[[0, 1, 4]]].concat();
        assert_eq!(open(&with_sheet), [true]);
        // A sheet with a back of its own is closed, one with the same face twice is not.
        assert_eq!(open(&[[0, 1, 2], [0, 2, 1]]), [false]);
        assert_eq!(open(&[[0, 1, 2], [0, 1, 2]]), [true]);
    }

    #[test]
    fn parts_are_numbered_by_their_first_triangles_and_joined_by_edges_only() {
        // The second sheet touches the first one in a corner, the last triangle joins both.
        let apart = [[0, 1, 2], [2, 3, 4], [5, 5, 6], [4, 3, 7]];
        assert_eq!(
            parts(&apart),
            Parts {
                of: vec![0, 1, 2, 1],
                open: vec![true; 3],
            }
        );
        let joined = [&apart[..], &[[1, 2, 3]], &[[2, 1, 3]]].concat();
        assert_eq!(parts(&joined).of, [0, 0, 1, 0, 0, 0]);
        assert_eq!(parts(&[]), Parts::default());
    }

    #[test]
    fn a_solid_beside_a_sheet_stays_closed() {
        let sheet = [[4, 5, 6], [4, 6, 7]];
        let parts = parts(&[&sheet[..1], &TETRAHEDRON, &sheet[1..]].concat());
        assert_eq!(parts.of, [0, 1, 1, 1, 1, 0]);
        let open: Vec<bool> = (0..6).map(|primitive| parts.is_open(primitive)).collect();
        assert_eq!(open, [true, false, false, false, false, true]);
    }
}
