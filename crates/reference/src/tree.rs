//! Traversal of the scene's hierarchy by f64 rays.

use crate::masked::Masked;
use crate::ray::{Corners, Hit, Ray};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use skiagraph_scene::{Bvh, Mesh, Towards};
use std::ops::ControlFlow;

/// A triangle as a shadow ray meets it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Caster<'a> {
    /// Primitive id.
    pub(crate) primitive: u32,
    /// Its corners.
    pub(crate) corners: Corners,
    /// For each edge, in the order of `Ray::edges`, whether no other triangle has it: it may be the
    /// rim of a crack.
    pub(crate) open: [bool; 3],
    /// Where it is there at all, if not everywhere.
    pub(crate) masked: Option<Masked<'a>>,
    /// True if its back face is seen, too.
    pub(crate) double_sided: bool,
    /// True if it casts shadows.
    casts: bool,
}

impl Caster<'_> {
    /// Where the ray meets it, if it is there.
    pub(crate) fn hit(&self, ray: &Ray) -> Option<Hit> {
        let hit = ray.hit(&self.corners)?;
        let is_there = |masked: &Masked<'_>| masked.is_opaque(hit.weights);
        self.masked.as_ref().is_none_or(is_there).then_some(hit)
    }

    /// Returns true if it is in the way of shadow rays that pass the primitive `excluded`.
    pub(crate) fn may_shade(&self, excluded: u32) -> bool {
        self.casts && self.primitive != excluded
    }

    /// Returns true if the ray meets it before its end.
    pub(crate) fn blocks(&self, ray: &Ray) -> bool {
        self.hit(ray).is_some_and(|hit| ray.reaches(hit.t))
    }
}

/// Cone of the directions within an angle of an axis.
pub(crate) struct Cone {
    /// Unit vector.
    pub(crate) axis: DVec3,
    /// Sine of the angle, which is no more than a right one.
    pub(crate) sin: f64,
    pub(crate) cos: f64,
}

impl Cone {
    /// Returns true if it could meet the ball around the box of two opposite corners, both relative
    /// to its apex: by its distance to the cone's side, with room for rounding.
    fn meets_ball(&self, low: DVec3, high: DVec3) -> bool {
        let centre = (low + high) * 0.5;
        let room = 1e-12 * (low.abs().max_element() + high.abs().max_element());
        let radius = (high - low).length() * 0.5 + room;
        let along = centre.dot(self.axis);
        let away = (centre - self.axis * along).length();
        along >= -radius && away * self.cos - along * self.sin <= radius
    }
}

/// A hierarchy with its triangles in leaf order.
pub(crate) struct Tree<'a> {
    bvh: Bvh,
    casters: Vec<Caster<'a>>,
    bounds: Option<(DVec3, DVec3)>,
}

impl<'a> Tree<'a> {
    /// Builds the hierarchy of a mesh.
    pub(crate) fn new(mesh: &'a Mesh) -> Self {
        let bvh = Bvh::build_quickly(mesh);
        let open = open_edges(mesh);
        let corner = |index: u32| mesh.positions[index as usize].to_array();
        let caster = |&primitive: &u32| Caster {
            primitive,
            corners: mesh.triangles[primitive as usize].map(corner),
            open: open[primitive as usize],
            masked: Masked::new(mesh, primitive),
            double_sided: mesh.surfaces.is_double_sided(primitive),
            casts: mesh.casts(primitive),
        };
        let casters = bvh.primitives.par_iter().map(caster).collect();
        let bounds = mesh
            .bounds()
            .map(|(min, max)| (min.as_dvec3(), max.as_dvec3()));
        Self {
            bvh,
            casters,
            bounds,
        }
    }

    /// Distance from `origin` beyond which there is no corner.
    pub(crate) fn max_distance(&self, origin: DVec3) -> f64 {
        self.bounds.map_or(0.0, |(min, max)| {
            (origin - min).abs().max((origin - max).abs()).length()
        })
    }

    /// Diagonal of the mesh's box; `None` without triangles.
    pub(crate) fn extent(&self) -> Option<f64> {
        self.bounds.map(|(min, max)| (max - min).length())
    }

    /// The ray of a way, in boxes larger by so much.
    pub(crate) fn ray(&self, origin: DVec3, way: &Towards, grow: f64) -> Ray {
        let max_distance = self.max_distance(origin);
        Ray::new(origin, way.direction, max_distance, grow).ending(way.distance)
    }

    /// Calls `visit` with every triangle that could meet a cone from `origin`, until it breaks.
    /// `stack` is scratch memory.
    pub(crate) fn within(
        &self,
        origin: DVec3,
        cone: &Cone,
        stack: &mut Vec<u32>,
        mut visit: impl FnMut(Caster<'a>) -> ControlFlow<()>,
    ) {
        let nodes = &self.bvh.nodes;
        let relative = |corner: [f32; 3]| Vec3::from(corner).as_dvec3() - origin;
        stack.clear();
        stack.extend(nodes.first().map(|_| 0));
        while let Some(index) = stack.pop() {
            let node = &nodes[index as usize];
            if !cone.meets_ball(relative(node.min), relative(node.max)) {
                continue;
            }
            if node.count == 0 {
                stack.extend([node.first, node.first + 1]);
                continue;
            }
            let first = node.first as usize;
            for caster in &self.casters[first..first + node.count as usize] {
                let [a, b, c] = caster.corners.map(relative);
                if cone.meets_ball(a.min(b).min(c), a.max(b).max(c)) && visit(*caster).is_break() {
                    return;
                }
            }
        }
    }

    /// Calls `visit` with the current end of the ray and every triangle whose box the ray enters,
    /// nearer boxes first. `visit` may shorten the ray, or end the walk by `Break`; returns true if
    /// it did. `stack` is scratch memory.
    pub(crate) fn walk(
        &self,
        ray: &Ray,
        stack: &mut Vec<u32>,
        mut visit: impl FnMut(&Caster<'a>, &mut f64) -> ControlFlow<()>,
    ) -> bool {
        let nodes = &self.bvh.nodes;
        let mut t_max = ray.far_side();
        stack.clear();
        let root = nodes.first();
        if root.is_some_and(|root| ray.slab_test(root, t_max).is_some()) {
            stack.push(0);
        }
        while let Some(index) = stack.pop() {
            let node = &nodes[index as usize];
            let first = node.first as usize;
            if node.count > 0 {
                for caster in &self.casters[first..first + node.count as usize] {
                    if visit(caster, &mut t_max).is_break() {
                        return true;
                    }
                }
                continue;
            }
            match (
                ray.slab_test(&nodes[first], t_max),
                ray.slab_test(&nodes[first + 1], t_max),
            ) {
                (Some(left), Some(right)) if left <= right => {
                    stack.extend([node.first + 1, node.first])
                }
                (Some(_), Some(_)) => stack.extend([node.first, node.first + 1]),
                (Some(_), None) => stack.push(node.first),
                (None, Some(_)) => stack.push(node.first + 1),
                (None, None) => {}
            }
        }
        false
    }
}

/// For each triangle and each of its edges, in the order of `Ray::edges`, whether it is the only
/// caster to have it.
fn open_edges(mesh: &Mesh) -> Vec<[bool; 3]> {
    let keys = |&[a, b, c]: &[u32; 3]| [(b, c), (c, a), (a, b)].map(|(p, q)| (p.min(q), p.max(q)));
    let casters = mesh.casters().into_iter();
    let casters = casters.map(|primitive| &mesh.triangles[primitive as usize]);
    let mut edges: Vec<(u32, u32)> = casters.flat_map(keys).collect();
    edges.par_sort_unstable();
    let alone = |key| {
        let first = edges.partition_point(|other| *other < key);
        edges.get(first + 1) != Some(&key)
    };
    let are_alone = |triangle| keys(triangle).map(alone);
    mesh.triangles.par_iter().map(are_alone).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use proptest::prelude::*;
    use std::collections::HashMap;

    /// A sphere of 1,280 triangles: an icosahedron divided three times, its vertices shared by
    /// index.
    fn sphere() -> Mesh {
        let golden = (1.0 + 5f32.sqrt()) / 2.0;
        let mut positions: Vec<Vec3> = [
            (1.0, golden),
            (-1.0, golden),
            (1.0, -golden),
            (-1.0, -golden),
        ]
        .iter()
        .flat_map(|&(p, q)| {
            [
                Vec3::new(0.0, p, q),
                Vec3::new(q, 0.0, p),
                Vec3::new(p, q, 0.0),
            ]
        })
        .map(Vec3::normalize)
        .collect();
        let near = |p: Vec3, q: Vec3| p != q && p.distance(q) < 1.1;
        let mut triangles = Vec::new();
        for (a, b, c) in
            (0..12).flat_map(|a| (0..a).flat_map(move |b| (0..b).map(move |c| (a, b, c))))
        {
            let (pa, pb, pc) = (positions[a], positions[b], positions[c]);
            if near(pa, pb) && near(pb, pc) && near(pc, pa) {
                let outwards = (pb - pa).cross(pc - pa).dot(pa) > 0.0;
                triangles.push(if outwards {
                    [a as u32, b as u32, c as u32]
                } else {
                    [a as u32, c as u32, b as u32]
                });
            }
        }
        for _ in 0..3 {
            let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
            let mut middle = |a: u32, b: u32| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    positions.push(
                        positions[a as usize]
                            .midpoint(positions[b as usize])
                            .normalize(),
                    );
                    positions.len() as u32 - 1
                })
            };
            triangles = triangles
                .iter()
                .flat_map(|&[a, b, c]| {
                    let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
                })
                .collect();
        }
        Mesh {
            positions,
            triangles,
            ..Mesh::default()
        }
    }

    fn soup(corners: &[Corners]) -> Mesh {
        let positions = corners
            .iter()
            .flatten()
            .map(|&corner| Vec3::from(corner))
            .collect();
        let triangles = (0..corners.len() as u32)
            .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
            .collect();
        Mesh {
            positions,
            triangles,
            ..Mesh::default()
        }
    }

    fn tree(mesh: &Mesh) -> Tree<'_> {
        Tree::new(mesh)
    }

    /// Ids of all triangles that the ray hits in front of its origin, sorted.
    fn hits(tree: &Tree, origin: DVec3, direction: DVec3) -> Vec<u32> {
        let ray = Ray::new(origin, direction, tree.max_distance(origin), 0.0);
        let mut hits = Vec::new();
        tree.walk(&ray, &mut Vec::new(), |caster, _| {
            if ray.hit(&caster.corners).is_some_and(|hit| hit.t > 0.0) {
                hits.push(caster.primitive);
            }
            ControlFlow::Continue(())
        });
        hits.sort_unstable();
        hits
    }

    #[test]
    fn nothing_leaves_a_sphere_through_its_vertices_or_edges() {
        let mesh = sphere();
        assert_eq!((mesh.triangles.len(), mesh.positions.len()), (1280, 642));
        let tree = tree(&mesh);
        let origins = [
            DVec3::ZERO,
            DVec3::new(0.3, -0.2, 0.1),
            DVec3::new(0.0, 0.9, 0.0),
            DVec3::splat(1e-17),
        ];
        for origin in origins {
            for position in &mesh.positions {
                assert!(
                    !hits(&tree, origin, position.as_dvec3() - origin).is_empty(),
                    "{origin} to {position}"
                );
            }
            for (triangle, along) in mesh
                .triangles
                .iter()
                .flat_map(|t| [0.5, 0.3, 1e-9].map(|along| (t, along)))
            {
                let [a, b, _] = triangle.map(|index| mesh.positions[index as usize].as_dvec3());
                let target = a.lerp(b, along);
                assert!(
                    !hits(&tree, origin, target - origin).is_empty(),
                    "{origin} to {target}"
                );
            }
        }
    }

    #[test]
    fn only_rims_are_open() {
        assert!(open_edges(&sphere()).iter().flatten().all(|open| !open));
        let mut mesh = soup(&[[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]]);
        mesh.positions.push(Vec3::ONE);
        mesh.triangles.push([3, 2, 1]);
        // The common edge (1, 2) lies opposite the first corner of both.
        assert_eq!(open_edges(&mesh), [[false, true, true]; 2]);
    }

    /// Coordinates that often coincide, so that rays run along box faces, edges and corners.
    fn coordinate() -> impl Strategy<Value = f32> {
        prop_oneof![(-4i8..=4).prop_map(|i| f32::from(i) * 0.25), -1.0f32..1.0]
    }

    proptest! {
        #[test]
        fn the_hierarchy_finds_what_brute_force_finds(
            corners in prop::collection::vec(
                prop::array::uniform3(prop::array::uniform3(coordinate())),
                1..60,
            ),
            origin in prop::array::uniform3(coordinate()),
            direction in prop::array::uniform3(coordinate()),
        ) {
            let (origin, direction) = (
                Vec3::from(origin).as_dvec3(),
                Vec3::from(direction).as_dvec3(),
            );
            prop_assume!(direction != DVec3::ZERO);
            let ray = Ray::new(origin, direction, 8.0, 0.0);
            let hit = |corners: &Corners| ray.hit(corners).is_some_and(|hit| hit.t > 0.0);
            let expected: Vec<u32> = (0..corners.len())
                .filter(|&i| hit(&corners[i]))
                .map(|i| i as u32)
                .collect();
            prop_assert_eq!(hits(&tree(&soup(&corners)), origin, direction), expected);
        }
    }
}
