//! The triangles of a mesh as a shadow map sees them, and which of them continue the surface beyond
//! each other's edges.

use super::{
    bounds::{Bound, CLEAR_OF_EDGE},
    light_space::LightSpace,
    preset::Cull,
    triangle::TexelTriangle,
};
use glam::DVec2;
use rayon::prelude::*;
use skiagraph_scene::{Adjacency, Mesh};

/// All triangles of a mesh in the light space of one map.
pub struct Casters<'a> {
    pub(crate) mesh: &'a Mesh,
    adjacency: &'a Adjacency,
    pub(crate) triangles: Vec<TexelTriangle>,
    /// Three edges per triangle: the triangle beyond it, perhaps and surely.
    adjacent: Vec<[[Option<u32>; 3]; 2]>,
    cull: Cull,
    pub(crate) space: LightSpace,
}

impl<'a> Casters<'a> {
    /// Projects a mesh. `adjacency` is the mesh's own.
    pub fn new(mesh: &'a Mesh, adjacency: &'a Adjacency, space: LightSpace, cull: Cull) -> Self {
        let triangles = (0..mesh.triangles.len() as u32)
            .map(|primitive| TexelTriangle {
                corners: mesh.corners(primitive).map(|corner| space.texel(corner)),
            })
            .collect();
        let mut casters = Self {
            mesh,
            adjacency,
            triangles,
            adjacent: vec![],
            cull,
            space,
        };
        let error = space.across_error();
        casters.adjacent = (0..mesh.triangles.len() as u32)
            .into_par_iter()
            .map(|primitive| {
                [Bound::Low, Bound::High].map(|bound| {
                    [0, 1, 2]
                        .map(|edge| casters.adjacent_triangle(primitive, edge, bound.leeway(error)))
                })
            })
            .collect();
        casters
    }

    /// The triangle of a primitive, in texels.
    ///
    /// # Panics
    /// If the mesh has no such primitive.
    pub fn triangle(&self, primitive: u32) -> &TexelTriangle {
        &self.triangles[primitive as usize]
    }

    /// Returns true if the primitive is in the map, which its winding for the light decides; one
    /// seen edge-on is. `leeway` as for [`TexelTriangle`].
    pub fn casts(&self, primitive: u32, leeway: f64) -> bool {
        let triangle = self.triangle(primitive);
        let culled = match self.cull {
            Cull::None => return true,
            Cull::Front => triangle.area() < 0.0,
            Cull::Back => triangle.area() > 0.0,
        };
        if triangle.winding_is_open(leeway) {
            return leeway > 0.0;
        }
        !culled
    }

    /// The primitive that continues the surface beyond edge `edge` of a primitive: the edge has
    /// exactly two triangles, the other one is in the map, and the light sees it on the other side;
    /// both clear of the edge by [`CLEAR_OF_EDGE`]. The sides decide, not the windings.
    pub fn adjacent_triangle(&self, primitive: u32, edge: usize, leeway: f64) -> Option<u32> {
        let corner = self.adjacency.opposite[3 * primitive as usize + edge];
        // No neighbour is the largest number there is, and no triangle.
        let other = self.triangles.get(corner as usize / 3)?;
        let neighbour = corner / 3;
        let triangle = self.triangle(primitive);
        let clear = |corner: DVec2, winding| {
            triangle.inward(edge, corner, winding, leeway) + leeway >= CLEAR_OF_EDGE
        };
        let own = triangle.corners[(edge + 2) % 3].truncate();
        let opposite = other.corners[corner as usize % 3].truncate();
        let apart = [1.0, -1.0]
            .iter()
            .any(|&winding| clear(own, winding) && clear(opposite, -winding));
        let has_length = leeway > 0.0 || triangle.edge(edge).1 != DVec2::ZERO;
        (has_length && apart && self.casts(neighbour, leeway)).then_some(neighbour)
    }

    /// [`adjacent_triangle`](Self::adjacent_triangle) for f32's leeway, all edges, looked up.
    pub(crate) fn adjacent(&self, primitive: u32, bound: Bound) -> [Option<u32>; 3] {
        self.adjacent[primitive as usize][match bound {
            Bound::Low => 0,
            Bound::High => 1,
        }]
    }
}
