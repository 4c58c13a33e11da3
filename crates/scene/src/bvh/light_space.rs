//! A hierarchy for rays that are all parallel, towards a light. Seen along them a ray is a point,
//! so that a node is left out by comparisons alone: no division, no slabs. The space is that of the
//! watertight triangle test (Woop, Benthin and Wald 2013): axes permuted so that the direction's
//! longest component is the last, then sheared so that the direction is the z axis.

use super::build::Effort;
use super::node::{BvhNode, MAX_DEPTH};
use super::tree::{Bvh, triangle_box};
use super::two_level::TwoLevelBvh;
use crate::mesh::Mesh;
use glam::{DVec2, DVec3, Vec2, Vec3};

/// Weight of depth beside width when triangles are put together: half the surface of a flat box is
/// its area, the chance of a ray to be in it, but rays that begin behind a box miss it. On the
/// shadow rays of Sponza's `main` a hundredth takes 55 boxes and 3.3 triangles (nothing 57 and 4.2,
/// all of it 72 and 4.4, the tree of other rays 64 and 3.8), on those of `park` 52 and 5.5 (83 and
/// 5.5, 56 and 5.1, 76 and 6.1).
const DEPTH: f64 = 0.01;

/// Node of a bounding volume hierarchy in [`LightSpace`]: 32 bytes, laid out as
/// `shaders/trace_light_space.wgsl` reads it. All coordinates are relative to
/// [`LightSpace::centre`], in scene units, and rounded outwards.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct LightSpaceNode {
    /// Low corner of the node's box, in the two coordinates across the rays
    /// ([`LightSpace::place`]).
    pub low: [f32; 2],
    /// High corner of the node's box, in the two coordinates across the rays
    /// ([`LightSpace::place`]).
    pub high: [f32; 2],
    /// Far sides of the node's box, by which rays leave it, along the three world axes in the order
    /// of [`LightSpace::place`]. Axes are mirrored so that each coordinate grows along the rays. A
    /// ray that begins beyond any of these sides misses the node. Three sides are stored instead of
    /// one depth along the ray because a floor is flat along an axis, but deep along a ray.
    pub farthest: [f32; 3],
    /// Packed count and index. The [`LEAF_BITS`](Self::LEAF_BITS) low bits hold the number of
    /// primitives of a leaf, or 0 for an inner node. The bits above hold an index. For a leaf it is
    /// the first of its entries in [`Bvh::primitives`]; for an inner node it is the first child in
    /// the list of nodes, which the second child follows.
    pub link: u32,
}

impl LightSpaceNode {
    /// Number of low bits of `link` that hold a leaf's number of primitives.
    pub const LEAF_BITS: u32 = 6;

    /// Returns the item that shaders find behind all nodes: [`LightSpace::centre`], in
    /// [`farthest`](Self::farthest).
    pub fn centre(centre: Vec3) -> Self {
        Self {
            farthest: centre.into(),
            ..Self::default()
        }
    }
}

/// Coordinates for rays that are all parallel to `direction`, such as those towards a light: seen
/// along the rays, each ray is a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSpace {
    /// Direction of the rays in world space, of any length but zero.
    pub direction: Vec3,
    /// Origin of the coordinates, in world space. f32 rounds them least if it is the middle of the
    /// mesh.
    pub centre: Vec3,
}

impl LightSpace {
    /// The axes in cyclic order, the direction's longest last; found as by
    /// `shared/ray_triangle.wgsl`.
    fn permute(&self, v: DVec3) -> DVec3 {
        let size = self.direction.abs();
        let largest = size.max_element();
        match (size.x == largest, size.y == largest) {
            (true, _) => DVec3::new(v.y, v.z, v.x),
            (_, true) => DVec3::new(v.z, v.x, v.y),
            _ => v,
        }
    }

    /// Returns the coordinates of a world position relative to `centre`, in scene units: first two
    /// coordinates across the rays, then the three world coordinates in cyclic order with the
    /// longest component of `direction` last, mirrored so that each grows along the rays.
    ///
    /// With p the position relative to `centre` and d the `direction`, both in that cyclic order
    /// and not mirrored, the two coordinates across the rays are p.x − p.z · d.x / d.z and
    /// p.y − p.z · d.y / d.z: the point is moved along the rays to the plane z = 0. (Woop, Benthin,
    /// Wald, "Watertight Ray/Triangle Intersection", JCGT 2013.)
    pub fn place(&self, position: Vec3) -> (DVec2, DVec3) {
        let d = self.permute(self.direction.as_dvec3());
        let p = self.permute(position.as_dvec3() - self.centre.as_dvec3());
        let up = DVec3::select(d.cmpge(DVec3::ZERO), p, -p);
        (p.truncate() - d.truncate() / d.z * p.z, up)
    }

    /// Builds a hierarchy over the [casters](Mesh::casters) of a mesh with at most `most` nodes (0
    /// counts as 1). Returns its nodes, root first, and a [`Bvh`] of the same tree, to be used only
    /// for its `primitives` and for [`refit`](Self::refit). Both are empty where nothing casts.
    /// Returns `None` if
    /// [`LightSpaceNode::link`] has too few bits: with more than 67 million triangles or nodes, or
    /// with more than 63 triangles in a leaf.
    pub fn build(&self, mesh: &Mesh, most: usize) -> Option<(Vec<LightSpaceNode>, Bvh)> {
        let bvh = self.tree(mesh);
        // Nothing is merged in an empty one.
        let bvh = if bvh.nodes.is_empty() {
            bvh
        } else {
            bvh.merged(most)
        };
        Some((self.refit(&bvh, mesh)?, bvh))
    }

    fn tree(&self, mesh: &Mesh) -> Bvh {
        // Depth is measured along the rays.
        let d = self.direction.as_dvec3();
        let steepness = d.length() / d.abs().max_element();
        let corner = |index: u32| {
            let (seen, up) = self.place(mesh.positions[index as usize]);
            seen.extend(DEPTH * steepness * up.z).as_vec3()
        };
        let casters = mesh.casters();
        let box_of = |place: u32| {
            let primitive = casters[place as usize];
            triangle_box(mesh.triangles[primitive as usize].map(corner))
        };
        let tree = Bvh::by_ploc(casters.len() as u32, box_of, Effort::Thorough);
        let own = || Bvh::over(mesh, &casters, MAX_DEPTH, Effort::Thorough);
        let mut tree = tree.unwrap_or_else(own);
        for primitive in &mut tree.primitives {
            *primitive = casters[*primitive as usize];
        }
        tree
    }

    /// Returns the nodes of a hierarchy, fitted to the mesh in this light space, root first. `bvh`
    /// is a tree over the triangles of the mesh, such as [`build`](Self::build) returns; their
    /// corners may have moved since. Returns `None` if [`LightSpaceNode::link`] has too few bits,
    /// as for `build`.
    ///
    /// # Panics
    /// If `bvh` names a triangle that the mesh does not have.
    pub fn refit(&self, bvh: &Bvh, mesh: &Mesh) -> Option<Vec<LightSpaceNode>> {
        let places = mesh.positions.iter().map(|&p| Bounds::at(self.place(p)));
        let places: Vec<Bounds> = places.collect();
        let mut bounds = vec![Bounds::NOTHING; bvh.nodes.len()];
        // Children before their parents.
        for index in bvh.order().into_iter().rev() {
            let node = &bvh.nodes[index as usize];
            let first = node.first as usize;
            bounds[index as usize] = match node.count {
                0 => bounds[first].or(bounds[first + 1]),
                _ => {
                    let corners = corners(&bvh.primitives, mesh, node);
                    Bounds::around(corners.map(|corner| places[corner as usize]))
                }
            };
        }
        let nodes = bvh.nodes.iter().zip(bounds);
        nodes.map(|(node, bounds)| bounds.rounded(node)).collect()
    }

    /// Fits nodes to a hierarchy of two levels over a mesh: those of some pieces, which have moved
    /// or have other trees than before, and those of the top level. `nodes` are those of
    /// [`TwoLevelBvh::nodes`] in this light space, in the same order and with the same primitives;
    /// those of other pieces are fitted already. The list is made as long as that one: the first
    /// time it may be empty, with all pieces named. Returns the number of nodes that were fitted,
    /// or `None` if [`LightSpaceNode::link`] has too few bits, as for [`build`](Self::build).
    ///
    /// # Panics
    /// If there is no piece of such a number, or the mesh has fewer triangles than the hierarchy.
    pub fn refit_pieces(
        &self,
        nodes: &mut Vec<LightSpaceNode>,
        tree: &TwoLevelBvh,
        mesh: &Mesh,
        pieces: impl IntoIterator<Item = usize>,
    ) -> Option<usize> {
        nodes.resize(tree.nodes.len(), LightSpaceNode::default());
        let of_pieces = pieces
            .into_iter()
            .flat_map(|piece| tree.children_first(piece));
        let mut fitted = 0;
        for index in of_pieces.chain(tree.top_children_first()) {
            let node = &tree.nodes[index];
            let first = node.first as usize;
            nodes[index] = match node.count {
                // Rounded outwards, their bounds are those of the node rounded so.
                0 => nodes[first].or(&nodes[first + 1]).linked(node)?,
                _ => {
                    let corners = corners(&tree.primitives, mesh, node);
                    let places = corners.map(|corner| mesh.positions[corner as usize]);
                    let bounds = places.map(|place| Bounds::at(self.place(place)));
                    Bounds::around(bounds).rounded(node)?
                }
            };
            fitted += 1;
        }
        Some(fitted)
    }
}

impl LightSpaceNode {
    /// The bounds of both.
    fn or(&self, other: &Self) -> Self {
        Self {
            low: Vec2::from(self.low).min(other.low.into()).into(),
            high: Vec2::from(self.high).max(other.high.into()).into(),
            farthest: Vec3::from(self.farthest).max(other.farthest.into()).into(),
            link: 0,
        }
    }

    /// With the link of a node; `None` where it has too few bits.
    fn linked(self, node: &BvhNode) -> Option<Self> {
        let fits =
            node.count < 1 << Self::LEAF_BITS && node.first < 1 << (u32::BITS - Self::LEAF_BITS);
        fits.then_some(Self {
            link: node.first << Self::LEAF_BITS | node.count,
            ..self
        })
    }
}

/// Extent of a node.
#[derive(Clone, Copy)]
struct Bounds {
    low: DVec2,
    high: DVec2,
    farthest: DVec3,
}

impl Bounds {
    const NOTHING: Self = Self {
        low: DVec2::ZERO,
        high: DVec2::ZERO,
        farthest: DVec3::ZERO,
    };

    fn around(extents: impl Iterator<Item = Self>) -> Self {
        extents.reduce(Self::or).unwrap_or(Self::NOTHING)
    }

    fn at((seen, up): (DVec2, DVec3)) -> Self {
        Self {
            low: seen,
            high: seen,
            farthest: up,
        }
    }

    fn or(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            farthest: self.farthest.max(other.farthest),
        }
    }

    /// `None` where the node's link is too small.
    fn rounded(self, node: &BvhNode) -> Option<LightSpaceNode> {
        let rounded = LightSpaceNode {
            low: self.low.to_array().map(down),
            high: self.high.to_array().map(up),
            farthest: self.farthest.to_array().map(up),
            link: 0,
        };
        rounded.linked(node)
    }
}

/// Indices of the corners of a leaf's triangles; none of the leaf of an empty tree.
fn corners<'a>(
    primitives: &'a [u32],
    mesh: &'a Mesh,
    leaf: &BvhNode,
) -> impl Iterator<Item = u32> + 'a {
    let slots = leaf.first as usize..(leaf.first + leaf.count) as usize;
    let primitives = primitives.get(slots).unwrap_or_default().iter();
    primitives.flat_map(|&primitive| mesh.triangles[primitive as usize])
}

/// The greatest f32 that is not greater.
fn down(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) > value {
        near.next_down()
    } else {
        near
    }
}

/// The least f32 that is not less.
fn up(value: f64) -> f32 {
    -down(-value)
}
