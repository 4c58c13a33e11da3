//! Pieces of a mesh that move by themselves, and the triangles that each has.

use crate::{
    names::next_version,
    part::{HostPart, Part, box_corners, range_of},
};
use glam::Vec3;
use skiagraph_scene::{Mesh, Movable, TwoLevelBvh, outline::outer};
use std::{ops::Range, sync::Arc};

/// A piece, with the numbers of the changes that made it as it is.
#[derive(Clone)]
pub(crate) struct Piece {
    pub content: Content,
    /// Number of the change that brought it to where it is.
    pub moved: u64,
    /// Number of the change that gave it its normals.
    pub leaned: u64,
    /// Number of the change that gave its triangles their corners.
    pub turned: u64,
    /// Number of the change that gave it another tree.
    pub built: u64,
}

/// Triangles of a piece.
#[derive(Clone)]
pub(crate) enum Content {
    /// The mesh.
    Whole,
    Part(Part),
    /// Triangles that are in no part.
    Outside(Arc<Outside>),
    /// A part that was removed.
    Gone,
}

/// Triangles that are in no part, with the positions that they use.
#[derive(Default)]
pub(crate) struct Outside {
    pub triangles: Vec<u32>,
    pub corners: Vec<u32>,
}

impl Piece {
    pub fn new(content: Content) -> Self {
        let version = next_version();
        Self {
            content,
            moved: version,
            leaned: version,
            turned: version,
            built: version,
        }
    }

    /// Adds a part to a hierarchy that was built before it came, in the place of a piece; the
    /// number of its nodes.
    pub fn add_to(&self, tree: &mut TwoLevelBvh, piece: usize) -> usize {
        let Content::Part(part) = &self.content else {
            return 0;
        };
        match &part.host {
            Some(host) if host.casts() => {
                host.mesh.add_to(tree, piece, part.at.triangle);
                tree.state_bounds(piece, host.placed);
            }
            Some(_) => tree.add(piece, &Mesh::default(), 0),
            None => tree.add(piece, &part.of.rest, part.at.triangle as u32),
        }
        tree.nodes_of(piece).len()
    }

    /// The part of a host's buffer that it is, if it is one.
    pub fn host(&self) -> Option<&HostPart> {
        match &self.content {
            Content::Part(part) => part.host.as_deref(),
            _ => None,
        }
    }

    /// That part, to be changed.
    pub fn host_mut(&mut self) -> Option<&mut HostPart> {
        match &mut self.content {
            Content::Part(part) => part.host.as_deref_mut(),
            _ => None,
        }
    }

    /// Number of the last change of its positions or its tree.
    pub fn changed(&self) -> u64 {
        self.moved.max(self.built)
    }

    /// The ranges that hold its positions and normals.
    pub fn ranges(&self, mesh: &Mesh) -> [Range<usize>; 2] {
        match &self.content {
            Content::Part(part) => part.ranges(),
            Content::Gone => [0..0, 0..0],
            Content::Whole | Content::Outside(_) => {
                [0..mesh.positions.len(), 0..mesh.normals.len()]
            }
        }
    }

    /// The range that holds its triangles.
    pub fn triangles(&self, mesh: &Mesh) -> Range<usize> {
        match &self.content {
            Content::Part(part) => part.triangles(),
            Content::Outside(outside) => range_of(&outside.triangles),
            Content::Gone => 0..0,
            Content::Whole => 0..mesh.triangles.len(),
        }
    }

    /// Its primitives.
    pub fn primitives(&self, mesh: &Mesh) -> Vec<u32> {
        match &self.content {
            Content::Part(part) => {
                let own = part.of.triangles(part.number).iter();
                own.map(|own| part.at.triangle as u32 + own).collect()
            }
            Content::Outside(outside) => outside.triangles.clone(),
            Content::Gone => Vec::new(),
            Content::Whole => (0..mesh.triangles.len() as u32).collect(),
        }
    }

    /// The number of positions that its triangles use, and those of them that may be on its box or
    /// outline.
    pub fn corners(&self, mesh: &Mesh) -> (usize, Vec<Vec3>) {
        let places = |corners: &[u32], first: usize| {
            let place = |at: usize| mesh.positions[first + corners[at] as usize];
            (corners.len(), outer(corners.len(), place))
        };
        if let Some(host) = self.host() {
            return (8, box_corners(host.placed).collect());
        }
        match &self.content {
            Content::Part(part) => places(part.of.corners(part.number), part.at.position),
            Content::Outside(outside) => places(&outside.corners, 0),
            Content::Gone => (0, Vec::new()),
            Content::Whole => {
                let used: Vec<Vec3> = mesh.used_positions().collect();
                (used.len(), outer(used.len(), |at| used[at]))
            }
        }
    }
}

impl Outside {
    /// True if a corner of its triangles would have another place than in `mesh`, and if one would
    /// have another normal.
    pub fn is_bent(&self, mesh: &Mesh, positions: &[Vec3], normals: &[Vec3]) -> [bool; 2] {
        let mut corners = self.corners.iter().map(|&corner| corner as usize);
        let triangles = self.triangles.iter();
        let directions = triangles.flat_map(|&id| mesh.normal_indices[id as usize]);
        let mut directions = directions.map(|normal| normal as usize);
        [
            corners.any(|at| mesh.positions[at] != positions[at]),
            directions.any(|at| mesh.normals[at] != normals[at]),
        ]
    }

    pub fn new(parts: &Movable) -> Self {
        let mesh = &parts.rest;
        let mut is_inside = vec![false; mesh.triangles.len()];
        for part in 0..parts.parts() {
            for &triangle in parts.triangles(part) {
                is_inside[triangle as usize] = true;
            }
        }
        let triangles = (0..).zip(is_inside).filter(|(_, is_inside)| !is_inside);
        let triangles: Vec<u32> = triangles.map(|(triangle, _)| triangle).collect();
        let corners = triangles.iter().flat_map(|&id| mesh.triangles[id as usize]);
        let mut corners: Vec<u32> = corners.collect();
        corners.sort_unstable();
        corners.dedup();
        Self { triangles, corners }
    }
}
