//! Edge adjacency: finds the triangle on the other side of each edge.

use crate::mesh::Mesh;
use std::collections::HashMap;

/// Entry of [`Adjacency::opposite`] for an edge that has no neighbouring triangle or several, or
/// that a masked triangle touches.
pub const NO_NEIGHBOUR: u32 = u32::MAX;

/// Edge adjacency of a mesh: for each edge of a triangle the triangle on its other side. It is the
/// *corner table* of Rossignac, Safonova and Szymczak ("3D Compression Made Simple", SMI 2001).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Adjacency {
    /// Corner opposite each triangle edge, three entries per triangle. Entry `3 * p + i` belongs to
    /// the edge of triangle `p` from corner `i` to its next corner. Its value is `3 * q + k`: `q`
    /// is the triangle on the other side of the edge, and `k` (0 to 2) is the corner of `q` that is
    /// not on the edge. The value is [`NO_NEIGHBOUR`] for an edge of one triangle or of more than
    /// two. It is the same for an edge beside a masked triangle (one cut out by an alpha mask),
    /// whose surface may end anywhere. A triangle that [casts](Mesh::casts) no shadow is passed
    /// over: it has no neighbours and is none. Neighbours may be wound against each other.
    pub opposite: Vec<u32>,
}

/// The triangles met so far at an edge, by their entries.
#[derive(Clone, Copy)]
enum Edge {
    One(u32),
    Two([u32; 2]),
    More,
}

impl Adjacency {
    /// Finds the neighbours across all edges of a mesh, in time linear in its triangles. A triangle
    /// that names a position twice has no area and gets no neighbours; two of its edges coincide,
    /// and the triangles beyond them become neighbours of each other.
    pub fn new(mesh: &Mesh) -> Self {
        let mut opposite = vec![NO_NEIGHBOUR; 3 * mesh.triangles.len()];
        let mut edges = HashMap::with_capacity(3 * mesh.triangles.len() / 2);
        for (primitive, &[a, b, c]) in mesh.triangles.iter().enumerate() {
            if a == b || b == c || c == a || !mesh.casts(primitive as u32) {
                continue;
            }
            for (side, (from, to)) in [(a, b), (b, c), (c, a)].into_iter().enumerate() {
                let entry = (3 * primitive + side) as u32;
                let edge = edges.entry((from.min(to), from.max(to)));
                edge.and_modify(|edge| match *edge {
                    Edge::One(other) => {
                        opposite[entry as usize] = opposite_corner(other);
                        opposite[other as usize] = opposite_corner(entry);
                        *edge = Edge::Two([other, entry]);
                    }
                    // The first two had been joined before the third came.
                    Edge::Two(joined) => {
                        for entry in joined {
                            opposite[entry as usize] = NO_NEIGHBOUR;
                        }
                        *edge = Edge::More;
                    }
                    Edge::More => {}
                })
                .or_insert(Edge::One(entry));
            }
        }
        leave_out_masked(mesh, &mut opposite);
        Self { opposite }
    }
}

/// Edges of a masked triangle have no other one.
fn leave_out_masked(mesh: &Mesh, opposite: &mut [u32]) {
    let is_masked = |primitive: usize| mesh.surfaces.mask(primitive as u32).is_some();
    for (entry, corner) in opposite.iter_mut().enumerate() {
        let across = *corner != NO_NEIGHBOUR && is_masked(*corner as usize / 3);
        if across || is_masked(entry / 3) {
            *corner = NO_NEIGHBOUR;
        }
    }
}

/// The corner that the edge of this entry does not touch.
fn opposite_corner(entry: u32) -> u32 {
    entry - entry % 3 + (entry + 2) % 3
}

#[cfg(test)]
mod tests {
    use super::*;

    fn adjacency(triangles: &[[u32; 3]]) -> Vec<u32> {
        let mesh = Mesh {
            triangles: triangles.to_vec(),
            ..Mesh::default()
        };
        Adjacency::new(&mesh).opposite
    }

    const NONE: u32 = NO_NEIGHBOUR;

    #[test]
    fn two_triangles_of_a_quad_see_each_other() {
        assert_eq!(
            adjacency(&[[0, 1, 2], [2, 1, 3]]),
            // Edge 1–2 is the second of the first triangle and the first of the second one.
            [NONE, 5, NONE, 0, NONE, NONE]
        );
        // The second one wound the other way.
        assert_eq!(
            adjacency(&[[0, 1, 2], [1, 2, 3]]),
            [NONE, 5, NONE, 0, NONE, NONE]
        );
    }

    #[test]
    fn a_closed_mesh_has_neighbours_everywhere_and_they_are_mutual() {
        let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let opposite = adjacency(&triangles);
        for (entry, &corner) in opposite.iter().enumerate() {
            let corner = corner as usize;
            // The edge of the other triangle is the one after its opposite corner.
            let back = 3 * (corner / 3) + (corner + 1) % 3;
            assert_eq!(opposite[back] as usize / 3, entry / 3);
            let edge = [entry % 3, (entry + 1) % 3].map(|i| triangles[entry / 3][i]);
            assert!(!edge.contains(&triangles[corner / 3][corner % 3]));
        }
    }

    #[test]
    fn three_triangles_at_an_edge_or_a_double_one_have_no_neighbour_there() {
        let fan = adjacency(&[[0, 1, 2], [1, 0, 3], [0, 1, 4], [1, 2, 5]]);
        assert_eq!(
            fan,
            [
                NONE, 11, NONE, NONE, NONE, NONE, NONE, NONE, NONE, 0, NONE, NONE
            ]
        );
        // Four at one edge: not two pairs.
        let four = adjacency(&[[0, 1, 2], [1, 0, 3], [0, 1, 4], [1, 0, 5]]);
        assert_eq!(four, [NONE; 12]);
        // A triangle and its copy close nothing: each edge has two, folded onto itself; the sides
        // tell, not the table.
        let double = adjacency(&[[0, 1, 2], [0, 1, 2]]);
        assert_eq!(double, [5, 3, 4, 2, 0, 1]);
    }

    #[test]
    fn a_triangle_that_names_a_position_twice_is_passed_over() {
        let opposite = adjacency(&[[0, 1, 2], [1, 1, 2], [2, 1, 3]]);
        assert_eq!(opposite, [NONE, 8, NONE, NONE, NONE, NONE, 0, NONE, NONE]);
        assert_eq!(adjacency(&[]), [0; 0]);
    }
}
