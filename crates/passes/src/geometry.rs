//! The geometry of a mesh: the pieces that move by themselves, where they are, and the things kept
//! over them, so that a frame pays for those that moved.

use crate::{
    built::{How, Work},
    error::Error,
    hierarchies::{Hierarchies, Tree},
    names::next_version,
    outlines::Outlines,
    shape::Shape,
    uniforms::LightUniform,
};
use glam::{DAffine3, Vec3};
use skiagraph_scene::{
    BvhNode, LightKind, LightSpace, LightSpaceNode, Mesh, Movable, PartChange, Scene, TwoLevelBvh,
    bvh::{Moved, Piece},
};
use std::{ops::Range, sync::Arc};

/// Pieces of a mesh: its parts, and all that is in none of them. A mesh without parts is one piece.
#[derive(Clone, Default)]
pub(crate) struct Geometry {
    shape: Shape,
    /// Number of the version of the shape with which each piece came to where it is.
    moved: Vec<u64>,
    /// Triangles that are in no part, the last piece, and the positions that they use.
    outside: Option<Arc<Outside>>,
    bvh: Option<Kept>,
    hierarchies: Hierarchies,
    outlines: Outlines,
    /// Work besides uploads.
    pub work: Work,
}

#[derive(Default)]
struct Outside {
    triangles: Vec<u32>,
    corners: Vec<u32>,
}

/// A hierarchy that is fitted when pieces move.
#[derive(Clone)]
struct Kept {
    tree: Arc<TwoLevelBvh>,
    /// Version of the shape that it is fitted to.
    version: u64,
}

/// The hierarchy as shaders read it.
pub(crate) struct Fitted {
    pub tree: Arc<TwoLevelBvh>,
    /// Ranges of the nodes that are others than those of a version.
    pub nodes: Vec<Range<usize>>,
    /// Ranges of the primitives that are others than those of the last time.
    pub primitives: Vec<Range<usize>>,
    pub how: How,
}

/// How a change of the places of parts has changed a mesh.
#[derive(Clone, Copy, Default)]
pub(crate) struct Change {
    pub is_elsewhere: bool,
    pub is_turned: bool,
}

impl Geometry {
    /// Creates the geometry of a mesh without parts.
    pub fn whole() -> Self {
        Self {
            moved: vec![next_version()],
            ..Self::default()
        }
    }

    /// Creates the geometry of a mesh in parts, which are at rest.
    pub fn parted(parts: Arc<Movable>) -> Self {
        let (count, is_joined) = (parts.parts(), parts.is_joined());
        let outside = Outside::new(&parts);
        let pieces = count + usize::from(!outside.triangles.is_empty());
        Self {
            moved: vec![next_version(); pieces],
            outside: Some(Arc::new(outside)),
            shape: Shape {
                maps: if is_joined {
                    Vec::new()
                } else {
                    vec![DAffine3::IDENTITY; count]
                },
                mirrored: vec![false; count],
                parts: Some(parts),
                is_unplaced: is_joined,
                is_deformed: true,
                is_bent: false,
            },
            ..Self::default()
        }
    }

    /// Returns the geometry of another mesh, with the work that was done for this one.
    pub fn replaced_by(&self, other: Self) -> Self {
        Self {
            work: self.work,
            ..other
        }
    }

    /// True if parts are in spaces of their own and have no places yet.
    pub fn is_unplaced(&self) -> bool {
        self.shape.is_unplaced
    }

    /// Moves the parts of the scene's mesh whose maps are others than before.
    ///
    /// # Errors
    /// See [`SceneProvider::set_transforms`](crate::SceneProvider::set_transforms).
    pub fn set_transforms(
        &mut self,
        maps: &[DAffine3],
        scene: &mut Arc<Scene>,
    ) -> Result<Change, Error> {
        let parts = self.shape.parts.clone().ok_or(Error::NoParts)?;
        parts.check_count(maps.len())?;
        let before = &self.shape.maps;
        let others = (0..maps.len()).filter(|&part| before.get(part) != Some(&maps[part]));
        let moved = others.map(|part| Ok((part, parts.moved_part(part, &maps[part])?)));
        let moved: Vec<_> = moved.collect::<Result<_, Error>>()?;
        if moved.is_empty() && !self.shape.is_unplaced {
            self.shape.maps = maps.to_vec();
            return Ok(Change::default());
        }
        self.shape.maps = maps.to_vec();
        let (mesh, version) = (&mut Arc::make_mut(scene).mesh, next_version());
        let mut change = Change {
            is_elsewhere: std::mem::take(&mut self.shape.is_unplaced),
            is_turned: false,
        };
        for (part, moved) in &moved {
            let was = &mut self.shape.mirrored[*part];
            let PartChange {
                is_elsewhere,
                is_turned,
            } = parts.put(*part, moved, *was, mesh);
            *was = moved.is_mirrored;
            change.is_elsewhere |= is_elsewhere;
            change.is_turned |= is_turned;
            if is_elsewhere {
                self.moved[*part] = version;
                self.work.moved += parts.ranges(*part)[0].len() as u64;
            }
        }
        Ok(change)
    }

    /// Notes that the positions and normals of `mesh` are about to be replaced by these, and
    /// returns true if they are others.
    pub fn deform(&mut self, mesh: &Mesh, positions: &[Vec3], normals: &[Vec3]) -> bool {
        // The maps of parts, if there are any, no longer say where those are.
        self.shape.maps.clear();
        self.shape.is_unplaced = false;
        if mesh.positions == positions && mesh.normals == normals {
            return false;
        }
        self.shape.is_deformed = true;
        self.shape.is_bent = true;
        let version = next_version();
        for piece in 0..self.moved.len() {
            let [places, directions] = self.ranges(piece, mesh);
            if mesh.positions[places.clone()] != positions[places.clone()]
                || mesh.normals[directions.clone()] != normals[directions]
            {
                self.moved[piece] = version;
                self.work.moved += places.len() as u64;
            }
        }
        true
    }

    /// The ranges that hold the positions and normals of a piece.
    fn ranges(&self, piece: usize, mesh: &Mesh) -> [Range<usize>; 2] {
        match &self.shape.parts {
            Some(parts) if piece < parts.parts() => parts.ranges(piece),
            _ => [0..mesh.positions.len(), 0..mesh.normals.len()],
        }
    }

    /// The pieces that have moved since a version of the shape.
    fn moved_since(&self, version: u64) -> impl Iterator<Item = usize> {
        let pieces = self.moved.iter().enumerate();
        pieces.filter_map(move |(piece, moved)| (*moved > version).then_some(piece))
    }

    /// The ranges of positions that are others than in a version of the shape.
    pub fn positions_since(&self, version: u64, mesh: &Mesh) -> Vec<Range<usize>> {
        let moved = self.moved_since(version);
        moved
            .map(|piece| self.ranges(piece, mesh)[0].clone())
            .collect()
    }

    /// The ranges of normals that are others than in a version of the shape.
    pub fn normals_since(&self, version: u64, mesh: &Mesh) -> Vec<Range<usize>> {
        let moved = self.moved_since(version);
        moved
            .map(|piece| self.ranges(piece, mesh)[1].clone())
            .collect()
    }

    /// Returns the hierarchy of the mesh, fitted to it. `version` is that of the shape now, `known`
    /// that of the nodes on the device.
    pub fn bvh(&mut self, mesh: &Mesh, most: usize, version: u64, known: Option<u64>) -> Fitted {
        let Some(kept) = self.bvh.take() else {
            return self.build_bvh(mesh, most, version);
        };
        let moved: Vec<usize> = self.moved_since(kept.version).collect();
        let how = if std::mem::take(&mut self.shape.is_bent) {
            Moved::Freely
        } else {
            Moved::Affinely
        };
        let mut tree = kept.tree;
        let fitted = Arc::make_mut(&mut tree);
        let refit = fitted.refit(mesh, &moved, how);
        self.work.nodes += refit.nodes as u64;
        let others = self.moved_since(known.unwrap_or_default());
        let nodes = others.map(|piece| tree.nodes_of(piece)).chain(tree.top());
        let nodes = nodes.collect();
        let rebuilt = refit.rebuilt.iter();
        let primitives: Vec<_> = rebuilt.map(|&piece| tree.primitives_of(piece)).collect();
        let how = if primitives.is_empty() {
            How::Refitted
        } else {
            How::Made
        };
        self.bvh = Some(Kept {
            tree: Arc::clone(&tree),
            version,
        });
        Fitted {
            tree,
            nodes,
            primitives,
            how,
        }
    }

    fn build_bvh(&mut self, mesh: &Mesh, most: usize, version: u64) -> Fitted {
        self.shape.is_bent = false;
        let tree = match (&self.shape.parts, &self.outside) {
            (Some(parts), Some(outside)) => {
                let own = (0..parts.parts()).map(|part| Piece {
                    triangles: parts.triangles(part),
                    copy_of: parts.copy_of(part),
                });
                let rest = self.moved.len().checked_sub(1).map(|piece| Piece {
                    triangles: &outside.triangles,
                    copy_of: piece,
                });
                let rest = rest.filter(|rest| rest.copy_of >= parts.parts());
                let pieces: Vec<Piece> = own.chain(rest).collect();
                TwoLevelBvh::build(mesh, &parts.rest, &pieces, most)
            }
            _ => {
                let triangles: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
                let whole = Piece {
                    triangles: &triangles,
                    copy_of: 0,
                };
                TwoLevelBvh::build(mesh, mesh, &[whole], most)
            }
        };
        let tree = Arc::new(tree);
        self.work.nodes += tree.nodes.len() as u64;
        // Only of a mesh that moves it is worth its memory.
        self.bvh = self.shape.is_deformed.then(|| Kept {
            tree: Arc::clone(&tree),
            version,
        });
        Fitted {
            nodes: vec![0..tree.nodes.len()],
            primitives: vec![0..tree.primitives.len()],
            tree,
            how: How::Made,
        }
    }

    /// Returns the hierarchy of the mesh in the light space of `space`.
    ///
    /// # Errors
    /// More triangles than its links can name.
    pub fn light_space(
        &mut self,
        space: LightSpace,
        mesh: &Mesh,
        most: usize,
    ) -> Result<Tree<LightSpaceNode>, Error> {
        let keep = self.shape.is_deformed;
        let tree = self.hierarchies.light_space(space, mesh, most, keep)?;
        self.work.nodes += tree.nodes.len() as u64;
        Ok(tree)
    }

    /// Returns the uniform of a light that is laid around the mesh; around parts where they are,
    /// of which only those are looked at that have moved.
    pub fn lay(&mut self, light: LightKind, mesh: &Mesh) -> LightUniform {
        let (Some(parts), Some(outside)) = (&self.shape.parts, &self.outside) else {
            self.work.laid += mesh.positions.len() as u64;
            return LightUniform::new(light, mesh);
        };
        let corners = |piece: usize| {
            let is_part = piece < parts.parts();
            let corners: &[u32] = if is_part {
                parts.corners(piece)
            } else {
                &outside.corners
            };
            corners
                .iter()
                .map(|&corner| mesh.positions[corner as usize])
        };
        let (uniform, laid) = self.outlines.lay(light, &self.moved, corners);
        self.work.laid += laid;
        uniform
    }
}

impl Outside {
    fn new(parts: &Movable) -> Self {
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

/// Nodes that shaders walk: those of the tree, or of an empty one a leaf around a triangle without
/// area, which no ray hits.
pub(crate) fn nodes_to_walk(tree: &TwoLevelBvh) -> &[BvhNode] {
    const EMPTY: &[BvhNode] = &[BvhNode {
        min: [0.0; 3],
        first: 0,
        max: [0.0; 3],
        count: 1,
    }];
    if tree.nodes.is_empty() {
        EMPTY
    } else {
        &tree.nodes
    }
}
