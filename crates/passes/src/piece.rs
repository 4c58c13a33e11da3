//! Pieces of a mesh that move by themselves, and the triangles that each has.

use crate::names::next_version;
use crate::part::{HostPart, Part, box_corners, range_of};
use glam::{DAffine3, Vec3};
use skiagraph_scene::{Mesh, Movable, Scene, TwoLevelBvh, outline::outer};
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
            None => match &part.mesh {
                Some(mesh) => mesh.add_to(tree, piece, part.at.triangle),
                None => tree.add(piece, &part.of.rest, part.at.triangle as u32),
            },
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

    /// Moves the part that it is, by a map in the place of the one before, to these bounds; true if
    /// that winds its triangles the other way in the scene's mesh.
    pub fn move_by(
        &mut self,
        (before, map): (Option<DAffine3>, &DAffine3),
        bounds: [Vec3; 2],
        scene: &mut Arc<Scene>,
    ) -> bool {
        let Content::Part(part) = &mut self.content else {
            return false;
        };
        self.moved = next_version();
        if let Some(host) = &mut part.host {
            host.placed = bounds;
        }
        // At rest normals are as they were given, of any length.
        let before = before.filter(|before| *before != DAffine3::IDENTITY);
        if before.is_none_or(|before| before.matrix3 != map.matrix3) {
            self.leaned = self.moved;
        }
        let is_turned = part.is_mirrored != (map.matrix3.determinant() < 0.0);
        if is_turned {
            part.is_mirrored = !part.is_mirrored;
            let mesh = &mut Arc::make_mut(scene).mesh;
            part.of.turn_at(part.number, mesh, part.at);
            self.turned = self.moved;
        }
        is_turned
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

    /// True if a corner of its triangles would have another place than in `mesh`, and if one would
    /// have another normal.
    pub fn is_bent(&self, mesh: &Mesh, positions: &[Vec3], normals: &[Vec3]) -> [bool; 2] {
        if let Content::Whole = self.content {
            return [mesh.positions != positions, mesh.normals != normals];
        }
        // Ranges may hold those of other pieces, too.
        let primitives = self.primitives(mesh);
        let differ = |indices: &[[u32; 3]], now: &[Vec3], then: &[Vec3]| {
            let corners = primitives.iter().flat_map(|&id| indices[id as usize]);
            corners.map(|at| at as usize).any(|at| now[at] != then[at])
        };
        [
            differ(&mesh.triangles, &mesh.positions, positions),
            differ(&mesh.normal_indices, &mesh.normals, normals),
        ]
    }

    /// The number of positions that were looked at, and those of the piece that may be on its box
    /// or outline. A part that has a `map` is where that takes it; others are as in `mesh`.
    pub fn corners(&self, mesh: &Mesh, map: Option<&DAffine3>) -> (usize, Vec<Vec3>) {
        let places = |corners: &[u32], first: usize| {
            let place = |at: usize| mesh.positions[first + corners[at] as usize];
            (corners.len(), outer(corners.len(), place))
        };
        if let Some(host) = self.host() {
            return (8, box_corners(host.placed).collect());
        }
        match &self.content {
            Content::Part(part) => match map {
                Some(map) => {
                    let moved = part.of.moved_border(part.number, map);
                    (moved.len(), moved)
                }
                None => places(part.of.corners(part.number), part.at.position),
            },
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
    pub fn new(parts: &Movable) -> Self {
        let triangles = parts.outside();
        let corners = triangles.iter();
        let corners = corners.flat_map(|&id| parts.rest.triangles[id as usize]);
        let mut corners: Vec<u32> = corners.collect();
        corners.sort_unstable();
        corners.dedup();
        Self { triangles, corners }
    }
}
