//! The hierarchies over a mesh, of which those are kept that are fitted when its pieces move.

use crate::built::{How, Work};
use crate::error::Error;
use crate::hierarchies::{FAR_AWAY, Fitted, Hierarchies, Parted, Tree, all};
use crate::parts::Room;
use crate::piece::{Content, Piece};
use skiagraph_scene::bvh::{self, Moved};
use skiagraph_scene::{BvhNode, LightSpace, Mesh, Movable, TwoLevelBvh};
use std::{borrow::Cow, collections::BTreeMap, sync::Arc};

/// Hierarchies that are kept over a mesh.
#[derive(Clone, Default)]
pub(crate) struct Trees {
    bvh: Option<Kept>,
    hierarchies: Hierarchies,
    /// True if the mesh was deformed since its hierarchy was fitted, otherwise than by maps.
    is_bent: bool,
}

/// A hierarchy that is fitted when pieces move.
#[derive(Clone)]
struct Kept {
    tree: Arc<TwoLevelBvh>,
    /// Version of the shape that it is fitted to.
    version: u64,
}

/// Pieces that hierarchies are made over.
pub(crate) struct Over<'a> {
    pub mesh: &'a Mesh,
    pub pieces: &'a mut [Piece],
    /// Parts that the mesh began with; `None` for a mesh without parts.
    pub first: Option<&'a Movable>,
    /// All room that was asked for.
    pub room: Room,
    /// True if the mesh moves, so that trees are worth their memory.
    pub is_deformed: bool,
    pub work: &'a mut Work,
}

impl Over<'_> {
    /// Those of some triangles that cast shadows.
    fn casters<'t>(&self, triangles: &'t [u32]) -> Cow<'t, [u32]> {
        if !self.mesh.surfaces.have_roles() {
            return triangles.into();
        }
        let casters = triangles.iter().copied();
        casters.filter(|id| self.mesh.casts(*id)).collect()
    }

    fn build_parts(&self, first: &Movable, most: usize) -> TwoLevelBvh {
        let mut numbers = BTreeMap::new();
        let mut added = Vec::new();
        let mut begun = Vec::new();
        for (number, piece) in self.pieces.iter().enumerate() {
            let (triangles, copy_of) = match &piece.content {
                Content::Part(part) if std::ptr::eq(&*part.of, first) => {
                    let copy_of = first.copy_of(part.number);
                    let copy_of = *numbers.entry(copy_of).or_insert(number);
                    (first.triangles(part.number), copy_of)
                }
                Content::Outside(outside) => (&outside.triangles[..], number),
                Content::Part(_) => {
                    added.push(number);
                    (&[][..], number)
                }
                Content::Gone | Content::Whole => (&[][..], number),
            };
            begun.push((self.casters(triangles), copy_of));
        }
        let begun = begun.iter().map(|(triangles, copy_of)| bvh::Piece {
            triangles,
            copy_of: *copy_of,
        });
        let begun: Vec<bvh::Piece<'_>> = begun.collect();
        let mut tree = TwoLevelBvh::build(self.mesh, &first.rest, &begun, most);
        if self.room != Room::default() {
            let left = most.saturating_sub(tree.nodes.len()) / 4;
            let [parts, triangles] = [self.room.parts, self.room.triangles];
            tree.reserve(parts.min(left), triangles.min(left));
        }
        for &piece in &added {
            self.pieces[piece].add_to(&mut tree, piece);
        }
        tree.refit(self.mesh, &added, Moved::Affinely);
        tree
    }
}

impl Trees {
    /// Notes that the mesh was deformed otherwise than by maps.
    pub fn bend(&mut self) {
        self.is_bent = true;
    }

    /// Adds a part in the place of a piece; the number of its nodes.
    pub fn add(&mut self, part: &Piece, piece: usize) -> usize {
        let kept = self.bvh.as_mut();
        kept.map_or(0, |kept| part.add_to(Arc::make_mut(&mut kept.tree), piece))
    }

    /// Removes a piece.
    pub fn remove(&mut self, piece: usize) {
        if let Some(kept) = &mut self.bvh {
            Arc::make_mut(&mut kept.tree).remove(piece);
        }
    }

    /// Makes room for parts.
    pub fn reserve(&mut self, room: Room) {
        if let Some(kept) = &mut self.bvh {
            Arc::make_mut(&mut kept.tree).reserve(room.parts, room.triangles);
        }
    }

    /// Drops what a device does not bind, whose buffers have `most` bytes at most.
    pub fn move_to(&mut self, most: u64) {
        self.hierarchies = Hierarchies::default();
        let fits = |kept: &mut Kept| size_of_val(&*kept.tree.nodes) as u64 <= most;
        self.bvh = self.bvh.take_if(fits);
    }

    /// Returns the hierarchy of the mesh, fitted to it. `version` is that of the shape now, `held`
    /// that of the nodes and primitives on the device.
    pub fn bvh(&mut self, over: &mut Over, most: usize, version: u64, held: Option<u64>) -> Fitted {
        let Some(kept) = self.bvh.take() else {
            return self.build_bvh(over, most, version);
        };
        let pieces = 0..over.pieces.len();
        let moved = pieces.filter(|piece| over.pieces[*piece].moved > kept.version);
        let moved: Vec<usize> = moved.collect();
        let how = if self.is_bent {
            Moved::Freely
        } else {
            Moved::Affinely
        };
        let mut tree = kept.tree;
        let fitted = Arc::make_mut(&mut tree);
        for &piece in &moved {
            if let Some(host) = over.pieces[piece].host().filter(|host| host.casts()) {
                fitted.state_bounds(piece, host.placed);
            }
        }
        let refit = fitted.refit(over.mesh, &moved, how);
        for &piece in &refit.rebuilt {
            over.pieces[piece].built = version;
        }
        let held = held.unwrap_or_default();
        let pieces = &*over.pieces;
        let since = |stamp: fn(&Piece) -> u64| {
            (0..pieces.len()).filter(move |piece| stamp(&pieces[*piece]) > held)
        };
        let changed: Vec<usize> = since(Piece::changed).collect();
        // The GPU fits the nodes of hosts' parts, once they are there.
        let written = changed.iter().filter(|&&piece| {
            let piece = &pieces[piece];
            piece.host().is_none() || piece.built > held
        });
        let nodes = written.map(|&piece| tree.nodes_of(piece));
        let nodes = nodes.chain(tree.top()).collect();
        let primitives = since(|piece| piece.turned.max(piece.built));
        let primitives = primitives.map(|piece| tree.primitives_of(piece)).collect();
        let how = if refit.rebuilt.is_empty() {
            How::Refitted
        } else {
            How::Made
        };
        self.is_bent = false;
        over.work.nodes += refit.nodes as u64;
        self.bvh = Some(Kept {
            tree: Arc::clone(&tree),
            version,
        });
        Fitted {
            tree,
            pieces: changed,
            nodes,
            primitives,
            how,
        }
    }

    fn build_bvh(&mut self, over: &mut Over, most: usize, version: u64) -> Fitted {
        self.is_bent = false;
        let mesh = over.mesh;
        let tree = match over.first {
            Some(first) => over.build_parts(first, most),
            None => {
                let triangles = mesh.casters();
                let whole = bvh::Piece {
                    triangles: &triangles,
                    copy_of: 0,
                };
                let mut tree = TwoLevelBvh::build(mesh, mesh, &[whole], most);
                tree.primitives.truncate(triangles.len());
                tree
            }
        };
        let tree = Arc::new(tree);
        over.work.nodes += tree.nodes.len() as u64;
        // Only of a mesh that moves it is worth its memory.
        self.bvh = over.is_deformed.then(|| Kept {
            tree: Arc::clone(&tree),
            version,
        });
        Fitted {
            pieces: (0..over.pieces.len()).collect(),
            nodes: all(tree.nodes.len()),
            primitives: all(tree.primitives.len()),
            tree,
            how: How::Made,
        }
    }

    /// Returns the hierarchy of a mesh without parts in the light space of `space`.
    ///
    /// # Errors
    /// More triangles than its links can name.
    pub fn light_space(
        &mut self,
        over: &mut Over,
        space: LightSpace,
        most: usize,
    ) -> Result<Tree, Error> {
        let hierarchies = &mut self.hierarchies;
        let tree = hierarchies.light_space(space, over.mesh, most, over.is_deformed)?;
        over.work.nodes += tree.nodes.len() as u64;
        Ok(tree)
    }

    /// Returns the hierarchy of a mesh in parts in the light space of `space`, of which only the
    /// parts are fitted that have moved. A centre nearer than `near` to the last one changes
    /// nothing. The versions are those of the shape and of the resource.
    ///
    /// # Errors
    /// More triangles than its links can name.
    pub fn light_space_of_parts(
        &mut self,
        over: &mut Over,
        (space, near): (LightSpace, f32),
        most: usize,
        versions: [u64; 2],
    ) -> Result<Parted, Error> {
        let nodes = self.hierarchies.take(space.direction);
        let since = nodes.as_ref().map(|nodes| nodes.shape);
        let fitted = self.bvh(over, most, versions[0], since);
        let target = (space, near);
        let hierarchies = &mut self.hierarchies;
        let parted = hierarchies.of_parts(nodes, target, &fitted, over.mesh, versions)?;
        over.work.nodes += parted.fitted as u64;
        Ok(parted)
    }
}

/// Nodes that shaders walk: those of the tree, or of an empty one a leaf where no ray is.
pub(crate) fn nodes_to_walk(tree: &TwoLevelBvh) -> &[BvhNode] {
    const EMPTY: &[BvhNode] = &[BvhNode {
        min: [FAR_AWAY; 3],
        first: 0,
        max: [FAR_AWAY; 3],
        count: 1,
    }];
    if tree.nodes.is_empty() {
        EMPTY
    } else {
        &tree.nodes
    }
}
