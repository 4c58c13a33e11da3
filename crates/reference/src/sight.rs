//! Finds the first surface on each of several rays, seen from its front or back, for example to
//! place cameras in a mesh.

use crate::{oracle::Oracle, ray::Ray};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// First surface of a mesh on a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// Distance from the ray's origin, in multiples of the length of the ray's direction vector.
    pub distance: f64,
    /// Primitive id of the surface: the index of its triangle in the mesh.
    pub primitive: u32,
    /// True if a picture from the ray's origin would show the surface: a front face, or a
    /// double-sided one.
    pub is_front: bool,
}

/// Finds the first surface of the oracle's mesh on each ray. A ray is its origin and its direction,
/// which has any length but zero, both in world space. Rays pass through the holes of masked
/// triangles. The result has an entry for each ray, in their order: `None` for a ray that meets
/// nothing.
pub fn sights(oracle: &Oracle<'_>, rays: &[(DVec3, DVec3)]) -> Vec<Option<Sight>> {
    let tree = &oracle.tree;
    let sight = |stack: &mut Vec<u32>, &(origin, direction): &(DVec3, DVec3)| {
        let ray = Ray::new(origin, direction, tree.max_distance(origin), 0.0);
        let mut first: Option<Sight> = None;
        tree.walk(&ray, stack, |caster, t_max| {
            if let Some(hit) = caster.hit(&ray)
                && hit.t > 0.0
                && first.is_none_or(|first| hit.t < first.distance)
            {
                first = Some(Sight {
                    distance: hit.t,
                    primitive: caster.primitive,
                    is_front: hit.front || caster.double_sided,
                });
                *t_max = hit.t;
            }
            ControlFlow::Continue(())
        });
        first
    };
    rays.par_iter().map_init(Vec::new, sight).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use skiagraph_scene::Mesh;

    #[test]
    fn the_nearest_surface_is_met_from_both_sides() {
        let at = |y| [[-1., y, -1.], [-1., y, 3.], [3., y, -1f32]].map(Vec3::from);
        let mesh = Mesh {
            positions: [at(0.0), at(1.0)].concat(),
            triangles: vec![[0, 1, 2], [3, 4, 5]],
            normals: vec![Vec3::Y],
            normal_indices: vec![[0; 3]; 2],
            ..Mesh::default()
        };
        let oracle = Oracle::new(&mesh);
        let above = (DVec3::Y * 3.0, DVec3::NEG_Y * 2.0);
        let below = (DVec3::NEG_Y, DVec3::Y);
        let sight = |distance, primitive, is_front| {
            Some(Sight {
                distance,
                primitive,
                is_front,
            })
        };
        assert_eq!(
            sights(&oracle, &[above, below, (DVec3::Y * 3.0, DVec3::Y)]),
            [sight(1.0, 1, true), sight(1.0, 0, false), None]
        );
    }
}
