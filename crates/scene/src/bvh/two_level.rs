//! A hierarchy over a mesh in pieces that move by themselves: a tree for each piece, and a top
//! level over the pieces, in one list of nodes. It is walked like any other.

use super::build::Effort;
use super::levels::levels;
use super::node::{BvhNode, MAX_DEPTH, area};
use super::top::{Split, deepest, over_boxes};
use super::tree::{Bvh, cost_of, fitted_box};
use crate::{free::Free, mesh::Mesh};
use glam::Vec3;
use std::{collections::BTreeMap, ops::Range, sync::Arc};

/// A piece is built anew when a deformation has made its rays this many times as dear as they were.
const WORSE: f64 = 1.5;

/// Piece of a mesh for [`TwoLevelBvh::build`]: triangles that move together.
#[derive(Clone, Copy, Debug)]
pub struct Piece<'a> {
    /// Primitive ids (indices into [`Mesh::triangles`]) of the piece's triangles. No triangle is in
    /// two pieces.
    pub triangles: &'a [u32],
    /// Number of the piece that this one is a copy of, or its own number if it is no copy. Pieces
    /// are numbered from 0 in the order of the list given to [`TwoLevelBvh::build`]. A copy has as
    /// many triangles as its original, in the same order: in both meshes of `build` one affine map
    /// takes all triangles of the original to those of the copy. A copy of a copy, or of a piece
    /// that there is not, is left out of the hierarchy.
    pub copy_of: usize,
}

/// Way in which pieces have moved, for [`TwoLevelBvh::refit`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moved {
    /// By affine maps. Triangles that were near each other still are, so that each piece's tree
    /// keeps its shape.
    Affinely,
    /// In any way. The tree of a piece that costs rays half as much again as when it was built is
    /// built anew.
    Freely,
}

/// Hierarchy of two levels over a mesh in pieces. Each piece has a tree of its own, in world space.
/// The leaves of the top level are the roots of those trees. When a piece moves, its boxes are
/// fitted and the top level is built anew; the other pieces stay as they are. The hierarchy of a
/// single piece is that of [`Bvh::build`].
#[derive(Clone, Debug, Default)]
pub struct TwoLevelBvh {
    /// Nodes of the tree, the root first. [`top`](Self::top) and [`nodes_of`](Self::nodes_of) tell
    /// which nodes are of the top level and of a piece; others are unused. The two children of an
    /// inner node follow each other. No path from the root to a leaf has more than
    /// [`MAX_DEPTH`](super::MAX_DEPTH) nodes, through both levels. Empty after a
    /// [`build`](Self::build) without triangles.
    pub nodes: Vec<BvhNode>,
    /// Primitive ids (indices into [`Mesh::triangles`]) in the order of the leaves. Each leaf names
    /// a range of this list; ids outside these ranges are unused.
    pub primitives: Vec<u32>,
    pieces: Vec<Subtree>,
    /// Room of the top level's nodes but the root.
    top: Range<usize>,
    /// Ranges of nodes that no tree has, in ascending order.
    free: Free,
    /// True if there are other pieces than those that the top level was built over.
    is_stale: bool,
}

/// Tree of a piece. Its nodes but the root follow each other; the root is in the top level.
#[derive(Clone, Debug, Default)]
struct Subtree {
    root: BvhNode,
    nodes: Range<usize>,
    slots: Range<usize>,
    /// Nodes by their numbers within the tree, each before its children.
    order: Arc<[u32]>,
    depth: u32,
    /// Expected cost of a ray when the tree was built.
    cost: f64,
    /// Box of the root, of a piece whose positions are not in the mesh.
    stated: Option<[Vec3; 2]>,
}

/// Work that [`TwoLevelBvh::refit`] has done.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Refit {
    /// Number of nodes whose boxes were fitted or built.
    pub nodes: usize,
    /// Numbers of the pieces whose trees were built anew, so that their entries in
    /// [`TwoLevelBvh::primitives`] stand in another order.
    pub rebuilt: Vec<usize>,
}

impl TwoLevelBvh {
    /// Builds the hierarchy of those triangles of `mesh` that are in pieces, on all cores (with the
    /// feature `rayon`). `at_rest` is the same mesh before its pieces were moved: each tree is
    /// built there, and its boxes are then fitted to `mesh`. A copy takes the tree of the piece
    /// that it is a copy of. A piece may have no triangles; its tree has no nodes then.
    ///
    /// Where there would be more than `most` nodes, leaves of every tree are merged until there are
    /// not; `usize::MAX` sets no limit. The top level alone has nearly two nodes for each piece,
    /// none of which can be left out, so that more pieces than half of `most` make more nodes than
    /// `most`.
    ///
    /// # Panics
    /// If a piece that is no copy names a triangle that `at_rest` lacks.
    pub fn build(mesh: &Mesh, at_rest: &Mesh, pieces: &[Piece<'_>], most: usize) -> Self {
        let filled = pieces.iter().filter(|piece| !piece.triangles.is_empty());
        let count = filled.count();
        let is_first =
            |&piece: &usize| pieces[piece].copy_of == piece && !pieces[piece].triangles.is_empty();
        let depth = depth_left(count);
        // One after the other: a thread of a pool that waits for one tree takes up the next on the
        // same stack, which thousands of pieces overflow.
        let trees = (0..pieces.len()).filter(is_first).map(|piece| {
            let ids = pieces[piece].triangles;
            (piece, Bvh::over(at_rest, ids, depth, Effort::Thorough))
        });
        let trees: BTreeMap<usize, Bvh> = trees.collect();
        let mut trees = merged(trees, pieces, most);
        let mut built = if let [only] = pieces
            && let Some(tree) = trees.remove(&0)
        {
            Self::single(tree, only.triangles)
        } else {
            Self::several(trees, pieces, count)
        };
        // Those of triangles that are in no piece yet.
        let total = built.primitives.len().max(mesh.triangles.len());
        built.primitives.resize(total, 0);
        let is_moved = !std::ptr::eq(mesh, at_rest);
        for (piece, given) in pieces.iter().enumerate() {
            let cost = if is_moved || given.copy_of != piece {
                built.fit(mesh, piece)
            } else {
                built.cost(piece)
            };
            built.pieces[piece].cost = cost;
        }
        built.build_top();
        built
    }

    /// The tree of a single piece, in its own memory: it is the hierarchy.
    fn single(tree: Bvh, triangles: &[u32]) -> Self {
        let order: Arc<[u32]> = tree.order().into();
        let mut primitives = tree.primitives;
        for primitive in &mut primitives {
            *primitive = triangles[*primitive as usize];
        }
        Self {
            pieces: vec![Subtree {
                root: tree.nodes[0],
                nodes: 1..tree.nodes.len(),
                slots: 0..primitives.len(),
                order,
                depth: tree.depth,
                ..Subtree::default()
            }],
            nodes: tree.nodes,
            primitives,
            top: 1..1,
            ..Self::default()
        }
    }

    /// The trees of pieces one behind the other, `count` of which are not empty, behind room for
    /// the top level.
    fn several(trees: BTreeMap<usize, Bvh>, pieces: &[Piece<'_>], count: usize) -> Self {
        let trees = trees.into_iter().map(|(piece, tree)| {
            let order = tree.order().into();
            (piece, (tree, order))
        });
        let trees: BTreeMap<usize, (Bvh, Arc<[u32]>)> = trees.collect();
        let mut built = Self {
            top: 1..(2 * count).max(2) - 1,
            ..Self::default()
        };
        if count > 0 {
            built.nodes.resize(built.top.end, BvhNode::default());
        }
        let empty = (Bvh::default(), Arc::default());
        for piece in pieces {
            let tree = trees.get(&piece.copy_of);
            let tree = tree.filter(|_| !piece.triangles.is_empty());
            let (tree, order) = tree.unwrap_or(&empty);
            built.append(tree, Arc::clone(order), piece.triangles);
        }
        built
    }

    /// Makes room in [`nodes`](Self::nodes) for `pieces` pieces that are [added](Self::add) later
    /// and have `triangles` triangles together. Without room the list of nodes grows when a piece
    /// is added.
    pub fn reserve(&mut self, pieces: usize, triangles: usize) {
        let filled = self.filled();
        self.reserve_top(filled + pieces);
        let end = self.nodes.len() + 2 * triangles;
        self.free.give_back(self.nodes.len()..end);
        self.nodes.resize(end, BvhNode::default());
    }

    /// Makes room for the top level over so many pieces.
    fn reserve_top(&mut self, pieces: usize) {
        let needed = (2 * pieces).saturating_sub(2);
        if self.nodes.is_empty() {
            self.nodes.push(BvhNode::default());
            self.top = 1..1;
        }
        if self.top.len() < needed {
            let before = std::mem::take(&mut self.top);
            self.free.give_back(before);
            self.top = self.take(needed);
            self.is_stale = true;
        }
    }

    /// Takes a range of nodes that is free, or new ones.
    fn take(&mut self, count: usize) -> Range<usize> {
        let first = self.free.take(count).unwrap_or_else(|| {
            let end = self.nodes.len();
            self.nodes.resize(end + count, BvhNode::default());
            end
        });
        first..first + count
    }

    /// Number of pieces that have triangles.
    fn filled(&self) -> usize {
        let filled = self.pieces.iter().filter(|piece| !piece.order.is_empty());
        filled.count()
    }

    /// Adds a piece with the number `piece`: the next unused number ([`pieces`](Self::pieces)), or
    /// the number of a piece that was [removed](Self::remove). `at_rest` has the piece's triangles
    /// before they were moved; its tree is built over those that [cast](Mesh::casts). In the whole
    /// mesh they are the triangles from the primitive id `first` on. The boxes are fitted by the
    /// next [`refit`](Self::refit), which must name the piece.
    ///
    /// # Panics
    /// If `piece` is the number of a piece that has triangles, or greater than the number of
    /// pieces.
    pub fn add(&mut self, piece: usize, at_rest: &Mesh, first: u32) {
        let mut ids = at_rest.casters();
        let depth = depth_left(self.filled() + 1);
        let tree = Bvh::over(at_rest, &ids, depth, Effort::Quick);
        ids.iter_mut().for_each(|id| *id += first);
        self.add_built(piece, &tree, tree.order().into(), &ids);
    }

    /// Adds a piece as [`add`](Self::add) does, with a tree that was built before: `tree` over the
    /// triangles of `at_rest`, whose [order](Bvh::order) is `order`. If that tree is too deep for
    /// so many pieces to stay within [`MAX_DEPTH`](super::MAX_DEPTH), another one is built.
    ///
    /// # Panics
    /// As [`add`](Self::add).
    pub fn add_tree(
        &mut self,
        piece: usize,
        (tree, order): (&Bvh, &Arc<[u32]>),
        at_rest: &Mesh,
        first: u32,
    ) {
        if tree.depth > depth_left(self.filled() + 1) {
            self.add(piece, at_rest, first);
        } else {
            let ids: Vec<u32> = (first..).take(tree.primitives.len()).collect();
            self.add_built(piece, tree, Arc::clone(order), &ids);
        }
    }

    fn add_built(&mut self, piece: usize, tree: &Bvh, order: Arc<[u32]>, ids: &[u32]) {
        let (first, count) = (ids.first().map_or(0, |id| *id as usize), ids.len());
        if count > 0 {
            self.reserve_top(self.filled() + 1);
        }
        let nodes = self.take(tree.nodes.len().max(1) - 1);
        let slots = first..first + count;
        if self.primitives.len() < slots.end {
            self.primitives.resize(slots.end, 0);
        }
        let added = Subtree {
            nodes,
            slots,
            ..Subtree::default()
        };
        match self.pieces.get_mut(piece) {
            Some(before) => {
                assert!(before.order.is_empty(), "piece {piece} has triangles");
                *before = added;
            }
            None => {
                assert_eq!(piece, self.pieces.len(), "pieces follow each other");
                self.pieces.push(added);
            }
        }
        self.put(piece, tree, order, ids);
        self.pieces[piece].cost = self.cost(piece);
        self.is_stale = true;
    }

    /// States the box (low and high corner, world space) of a piece whose positions are not in the
    /// mesh, such as one that a GPU writes and fits the nodes of. [`refit`](Self::refit) leaves its
    /// nodes as they are from then on, and takes this box into the top level.
    ///
    /// # Panics
    /// If there is no piece of that number.
    pub fn state_bounds(&mut self, piece: usize, bounds: [Vec3; 2]) {
        let at = &mut self.pieces[piece];
        at.stated = Some(bounds);
        at.take_stated();
        self.is_stale = true;
    }

    /// Returns the numbers of a piece's nodes but its root, in a list for each height, that of the
    /// leaves first. Node number n of a piece is the n-th of [`nodes_of`](Self::nodes_of), from 1;
    /// the root is number 0.
    ///
    /// # Panics
    /// If there is no piece of that number.
    pub fn levels_of(&self, piece: usize) -> Vec<Vec<u32>> {
        let at = &self.pieces[piece];
        levels(&at.order, |index| {
            let node = match index {
                0 => at.root,
                _ => self.nodes[at.nodes.start + index as usize - 1],
            };
            match node.count {
                0 => BvhNode {
                    first: node.first + 1 - at.nodes.start as u32,
                    ..node
                },
                _ => node,
            }
        })
    }

    /// Returns the numbers of a piece's nodes, counted as by [`levels_of`](Self::levels_of), each
    /// before its children: the very list that [`add_tree`](Self::add_tree) was given, unless
    /// another tree was built.
    ///
    /// # Panics
    /// If there is no piece of that number.
    pub fn order_of(&self, piece: usize) -> &Arc<[u32]> {
        &self.pieces[piece].order
    }

    /// Removes a piece; the tree changes at the next [`refit`](Self::refit). Other pieces keep
    /// their numbers. The piece's number and nodes may be reused by pieces that are
    /// [added](Self::add) later.
    ///
    /// # Panics
    /// If there is no piece of that number.
    pub fn remove(&mut self, piece: usize) {
        let gone = &mut self.pieces[piece];
        (gone.order, gone.depth) = (Arc::default(), 0);
        let nodes = std::mem::take(&mut gone.nodes);
        self.free.give_back(nodes);
        self.is_stale = true;
    }

    /// Appends the tree of a piece.
    fn append(&mut self, tree: &Bvh, order: Arc<[u32]>, triangles: &[u32]) {
        let nodes = self.nodes.len()..self.nodes.len() + tree.nodes.len().max(1) - 1;
        let slots = self.primitives.len()..self.primitives.len() + tree.primitives.len();
        self.nodes.resize(nodes.end, BvhNode::default());
        self.primitives.resize(slots.end, 0);
        self.pieces.push(Subtree {
            nodes,
            slots,
            ..Subtree::default()
        });
        self.put(self.pieces.len() - 1, tree, order, triangles);
    }

    /// Writes a tree to the place of a piece, which is large enough.
    fn put(&mut self, piece: usize, tree: &Bvh, order: Arc<[u32]>, triangles: &[u32]) {
        let at = &mut self.pieces[piece];
        (at.order, at.depth) = (order, tree.depth);
        let (first_node, first_slot) = (at.nodes.start, at.slots.start);
        let placed = tree.nodes.iter().map(|node| BvhNode {
            first: match node.count {
                // The children of the root are the first of its nodes.
                0 => first_node as u32 + node.first - 1,
                _ => first_slot as u32 + node.first,
            },
            ..*node
        });
        for (index, node) in placed.enumerate() {
            *at.node(&mut self.nodes, index) = node;
        }
        self.pieces[piece].take_stated();
        for (slot, &local) in (first_slot..).zip(&tree.primitives) {
            self.primitives[slot] = triangles[local as usize];
        }
    }

    /// Fits the boxes of the pieces with the numbers in `pieces` to `mesh`, in which they have
    /// moved, and builds the top level anew. Of pieces whose bounds were
    /// [stated](Self::state_bounds) only the root's box changes.
    ///
    /// # Panics
    /// If a number in `pieces` is not that of a piece, or the mesh has fewer triangles than the
    /// hierarchy.
    pub fn refit(&mut self, mesh: &Mesh, pieces: &[usize], moved: Moved) -> Refit {
        let mut work = Refit::default();
        for &piece in pieces {
            if self.pieces[piece].stated.is_some() {
                continue;
            }
            let cost = self.fit(mesh, piece);
            work.nodes += self.pieces[piece].order.len();
            if moved == Moved::Freely && cost > WORSE * self.pieces[piece].cost {
                self.rebuild(mesh, piece);
                work.nodes += self.pieces[piece].order.len();
                work.rebuilt.push(piece);
            }
        }
        if !pieces.is_empty() || std::mem::take(&mut self.is_stale) {
            let depth = depth_left(self.filled());
            // More pieces than when they were built leave them less.
            let deep = (0..self.pieces.len()).filter(|&piece| self.pieces[piece].depth > depth);
            for piece in deep.collect::<Vec<_>>() {
                self.rebuild(mesh, piece);
                work.rebuilt.push(piece);
            }
            self.build_top();
            work.nodes += (2 * self.filled()).max(1) - 1;
        }
        work
    }

    /// Builds the tree of a piece anew, in its place.
    fn rebuild(&mut self, mesh: &Mesh, piece: usize) {
        let Subtree { nodes, slots, .. } = &self.pieces[piece];
        let most = nodes.len() + 1;
        let mut ids = self.primitives[slots.clone()].to_vec();
        ids.sort_unstable();
        let depth = depth_left(self.filled());
        let tree = Bvh::over(mesh, &ids, depth, Effort::Quick).merged(most);
        let order = tree.order().into();
        self.put(piece, &tree, order, &ids);
        self.pieces[piece].cost = self.cost(piece);
    }

    /// Returns the number of pieces, removed ones included.
    pub fn pieces(&self) -> usize {
        self.pieces.len()
    }

    /// Returns two ranges of [`nodes`](Self::nodes): the root, and the other nodes of the top
    /// level. Each [`refit`](Self::refit) writes these.
    pub fn top(&self) -> [Range<usize>; 2] {
        let below = (2 * self.filled()).max(2) - 2;
        [
            0..1.min(self.nodes.len()),
            self.top.start..self.top.start + below,
        ]
    }

    /// Returns the range of a piece's nodes in [`nodes`](Self::nodes), without the root of its
    /// tree, which is in the top level.
    ///
    /// # Panics
    /// If there is no piece of that number.
    pub fn nodes_of(&self, piece: usize) -> Range<usize> {
        self.pieces[piece].nodes.clone()
    }

    /// Returns the range of a piece's entries in [`primitives`](Self::primitives).
    ///
    /// # Panics
    /// If there is no piece of that number.
    pub fn primitives_of(&self, piece: usize) -> Range<usize> {
        self.pieces[piece].slots.clone()
    }

    /// The nodes of a piece but its root, which is of the top level: children before their parents.
    pub(super) fn children_first(&self, piece: usize) -> impl Iterator<Item = usize> {
        let Subtree { nodes, order, .. } = &self.pieces[piece];
        let below = order.iter().rev().filter(|index| **index > 0);
        below.map(move |index| nodes.start + *index as usize - 1)
    }

    /// The nodes of the top level, children before their parents.
    pub(super) fn top_children_first(&self) -> impl Iterator<Item = usize> {
        let [root, below] = self.top();
        // Built so that parents come first.
        below.rev().chain(root)
    }

    /// Fits the boxes of a piece; its cost.
    fn fit(&mut self, mesh: &Mesh, piece: usize) -> f64 {
        let at = &mut self.pieces[piece];
        let mut cost = 0.0;
        let order = Arc::clone(&at.order);
        for &index in order.iter().rev() {
            let index = index as usize;
            let node = *at.node(&mut self.nodes, index);
            let (min, max) = fitted_box(&node, &self.nodes, &self.primitives, mesh);
            let node = at.node(&mut self.nodes, index);
            (node.min, node.max) = (min.into(), max.into());
            cost += cost_of(node);
        }
        cost / area(&at.root).max(f64::MIN_POSITIVE)
    }

    /// Returns the cost of a piece's tree as it is, of a ray that enters its box.
    fn cost(&self, piece: usize) -> f64 {
        let at = &self.pieces[piece];
        if at.order.is_empty() {
            return 0.0;
        }
        let nodes = self.nodes[at.nodes.clone()][..at.order.len() - 1].iter();
        let cost: f64 = nodes.chain([&at.root]).map(cost_of).sum();
        cost / area(&at.root).max(f64::MIN_POSITIVE)
    }

    /// Builds the top level over the pieces where they are.
    fn build_top(&mut self) {
        let filled = |piece: &&Subtree| !piece.order.is_empty();
        let leaves: Vec<&Subtree> = self.pieces.iter().filter(filled).collect();
        let tree = match &leaves[..] {
            // A box that no ray hits, as far as there is a node.
            [] => vec![BvhNode {
                count: 1,
                ..BvhNode::default()
            }],
            [only] => vec![only.root],
            _ => {
                let roots = leaves.iter().map(|leaf| leaf.root);
                let roots: Vec<BvhNode> = roots.collect();
                let depths: Vec<u32> = leaves.iter().map(|leaf| leaf.depth).collect();
                let mut top = over_boxes(&roots, Split::ByArea, 1);
                if deepest(&top, &depths) > MAX_DEPTH {
                    top = over_boxes(&roots, Split::ByCount, 1);
                }
                let (tree, order) = top;
                let place = |node: &BvhNode| match node.count {
                    0 => BvhNode {
                        first: self.top.start as u32 + node.first - 1,
                        ..*node
                    },
                    _ => roots[order[node.first as usize] as usize],
                };
                tree.iter().map(place).collect()
            }
        };
        if self.nodes.is_empty() {
            return;
        }
        self.nodes[0] = tree[0];
        self.nodes[self.top.start..][..tree.len() - 1].copy_from_slice(&tree[1..]);
    }
}

impl Subtree {
    /// The node of an index in its tree: the root, or one of the hierarchy's nodes.
    fn node<'n>(&'n mut self, nodes: &'n mut [BvhNode], index: usize) -> &'n mut BvhNode {
        match index {
            0 => &mut self.root,
            _ => &mut nodes[self.nodes.start + index - 1],
        }
    }

    /// Gives the root the box that was stated for it.
    fn take_stated(&mut self) {
        if let Some([min, max]) = self.stated {
            (self.root.min, self.root.max) = (min.into(), max.into());
        }
    }
}

/// Trees that leave room for the top level: together they have at most `most` nodes.
fn merged(trees: BTreeMap<usize, Bvh>, pieces: &[Piece<'_>], most: usize) -> BTreeMap<usize, Bvh> {
    let own = |piece: &Piece<'_>| trees.get(&piece.copy_of).map_or(0, |tree| tree.nodes.len());
    let filled = pieces.iter().filter(|piece| !piece.triangles.is_empty());
    let (count, sum) = filled.fold((0, 0), |(count, sum), piece| (count + 1, sum + own(piece)));
    // A piece's root is a leaf of the top level, which has one node less beside its leaves.
    if sum + count <= most.saturating_add(1) {
        return trees;
    }
    let share = (most + 1).saturating_sub(2 * count) as f64 / (sum - count).max(1) as f64;
    let merged = trees.into_iter().map(|(piece, tree)| {
        let most = match count {
            1 => most,
            _ => 1 + ((tree.nodes.len() - 1) as f64 * share) as usize,
        };
        (piece, tree.merged(most))
    });
    merged.collect()
}

/// The depth that is left to the tree of each of so many pieces, below a balanced top level.
fn depth_left(pieces: usize) -> u32 {
    let above = usize::BITS - pieces.saturating_sub(1).leading_zeros();
    MAX_DEPTH.saturating_sub(above).max(1)
}
