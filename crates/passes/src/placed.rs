//! Parts that maps have moved: by the GPU, and in the scene's mesh once something asks for their
//! corners there.

use crate::hierarchies::all;
use crate::names::NORMALS;
use crate::piece::{Content, Piece};
use glam::DAffine3;
use skiagraph_scene::Mesh;
use std::{collections::BTreeSet, ops::Range};

/// Pieces of a mesh, and where they are.
#[derive(Clone, Copy)]
pub(crate) struct Placed<'a> {
    pub pieces: &'a [Piece],
    /// Map of each piece, if it has one.
    pub maps: &'a [Option<DAffine3>],
    /// Pieces that maps have moved since their corners in the scene's mesh were computed.
    pub behind: &'a BTreeSet<usize>,
    /// Number of the change that gave the mesh its items.
    pub begun: u64,
    /// Number of the change that gave parts their positions at rest.
    pub rested: u64,
}

impl Placed<'_> {
    /// Computes the corners of those that are behind in the scene's mesh, or in a copy of it.
    pub fn bring(self, mesh: &mut Mesh) {
        for &piece in self.behind {
            let content = &self.pieces[piece].content;
            // It was checked that the map can move it.
            if let (Content::Part(part), Some(map)) = (content, self.maps[piece])
                && let Ok(moved) = part.of.moved_part(part.number, &map)
            {
                part.of.put_at(part.number, &moved, mesh, part.at);
            }
        }
    }

    /// The ranges of positions, or of normals, that are others than in a version of the shape:
    /// those of pieces that were moved on the CPU; parts that have maps were not if `is_gpu`.
    /// `name` says which; the list has `count` items.
    pub fn changed_since(
        self,
        version: u64,
        (name, count, is_gpu): (&str, usize, bool),
        mesh: &Mesh,
    ) -> Vec<Range<usize>> {
        if version < self.begun {
            return all(count);
        }
        let list = usize::from(name == NORMALS);
        let pieces = self.pieces.iter().zip(self.maps);
        let moved = pieces.filter(|(piece, map)| {
            let is_cpu = piece.host().is_none() && !(is_gpu && map.is_some());
            is_cpu && [piece.moved, piece.leaned][list] > version
        });
        moved
            .map(|(piece, _)| piece.ranges(mesh)[list].clone())
            .collect()
    }

    /// The maps of parts that the GPU can move, by the numbers of their pieces.
    pub fn own_maps(self) -> impl Iterator<Item = Option<DAffine3>> {
        let pieces = self.pieces.iter().zip(self.maps);
        pieces.map(|(piece, map)| map.filter(|_| piece.host().is_none()))
    }

    /// The number of positions that the GPU can move which have moved since a version of the shape.
    pub fn moved_since(self, version: u64) -> usize {
        let pieces = self.pieces.iter().zip(self.own_maps());
        let moved = pieces.filter(|(piece, map)| piece.moved > version && map.is_some());
        let positions = moved.map(|(piece, _)| match &piece.content {
            Content::Part(part) => part.positions(),
            _ => 0,
        });
        positions.sum()
    }

    /// The positions of parts at rest in the places of the mesh's, as bits, each with the number of
    /// its piece; all bits are 1 where there is no part.
    pub fn at_rest(self, mesh: &Mesh) -> Vec<[u32; 4]> {
        let mut rest = vec![[u32::MAX; 4]; mesh.positions.len()];
        for (number, piece) in (0..).zip(self.pieces) {
            if let Content::Part(part) = &piece.content {
                for &corner in part.of.corners(part.number) {
                    let place = part.of.rest.positions[corner as usize].extend(0.0);
                    let item = &mut rest[part.at.position + corner as usize];
                    *item = place.to_array().map(f32::to_bits);
                    item[3] = number;
                }
            }
        }
        rest
    }
}
