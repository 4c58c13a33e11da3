//! A part of a mesh, and the place of its items in the lists of that.

use crate::host_buffers::{HostMesh, HostWrite};
use crate::part_mesh::PartMesh;
use crate::parts::PartId;
use glam::{DAffine3, Vec3};
use skiagraph_scene::{Movable, MoveError, MovedPart, PartPlace};
use std::{ops::Range, sync::Arc};

/// A part of a mesh; the geometry has its map.
#[derive(Clone)]
pub(crate) struct Part {
    pub id: PartId,
    pub of: Arc<Movable>,
    /// Its number in `of`.
    pub number: usize,
    /// Where the lists of `of` begin in those of the mesh.
    pub at: PartPlace,
    /// True if its triangles are wound the other way than at rest.
    pub is_mirrored: bool,
    /// The mesh that it was added of; `None` for those that the scene began with, and for those in
    /// buffers of the host.
    pub mesh: Option<PartMesh>,
    /// Where its vertices are, if they are in a buffer of the host.
    pub host: Option<Box<HostPart>>,
}

/// A mesh of which a part is added.
pub(crate) enum Added<'a> {
    Own(PartMesh),
    OfHost(&'a HostMesh),
}

impl Added<'_> {
    pub fn movable(&self) -> &Arc<Movable> {
        match self {
            Self::Own(mesh) => mesh.movable(),
            Self::OfHost(mesh) => mesh.movable(),
        }
    }

    /// Checks the map that takes the part to its place; the part in a buffer of the host, or where
    /// its corners are.
    ///
    /// # Errors
    /// A map that cannot move it.
    pub fn moved(&self, map: &DAffine3) -> Result<Moved, MoveError> {
        Ok(match self {
            Self::Own(mesh) => Moved::Own(mesh.movable().moved_part(0, map)?),
            Self::OfHost(mesh) => Moved::OfHost(Box::new(HostPart::new(mesh, map)?)),
        })
    }
}

/// Such a part in its place.
pub(crate) enum Moved {
    Own(MovedPart),
    OfHost(Box<HostPart>),
}

/// Part whose vertices are in a buffer of the host.
#[derive(Clone)]
pub(crate) struct HostPart {
    pub mesh: HostMesh,
    /// Bounds of its vertices before they are moved.
    pub bounds: [Vec3; 2],
    /// Bounds of its positions in the scene.
    pub placed: [Vec3; 2],
    /// True if its buffer is on another device than the scene's, so that it is not read.
    pub is_elsewhere: bool,
}

impl HostPart {
    /// True if it casts shadows.
    pub fn casts(&self) -> bool {
        self.mesh.shadows().casts()
    }

    /// Creates a part of a mesh that a map moves.
    ///
    /// # Errors
    /// A map that cannot move it.
    pub fn new(mesh: &HostMesh, map: &DAffine3) -> Result<Self, MoveError> {
        let bounds = mesh.bounds();
        Ok(Self {
            mesh: mesh.clone(),
            bounds,
            placed: placed(bounds, map)?,
            is_elsewhere: false,
        })
    }
}

/// Returns bounds around all that a map moves from within bounds: rounded products and sums grow
/// with each coordinate, so none is beyond those of the corners.
///
/// # Errors
/// A map that is not finite or singular, or moves them beyond f32, of part 0.
pub(crate) fn placed(ends: [Vec3; 2], map: &DAffine3) -> Result<[Vec3; 2], MoveError> {
    let part = 0;
    if !map.is_finite() {
        return Err(MoveError::NotFinite { part, map: *map });
    }
    let determinant = map.matrix3.determinant();
    // Nor is there a normal where an entry of the inverse is beyond f64.
    if determinant == 0.0 || !map.matrix3.inverse().is_finite() {
        return Err(MoveError::Singular { part });
    }
    let mut bounds = [Vec3::INFINITY, Vec3::NEG_INFINITY];
    for from in box_corners(ends) {
        let to = map.transform_point3(from.as_dvec3());
        let place = to.as_vec3();
        if !place.is_finite() {
            return Err(MoveError::OutOfRange { part, from, to });
        }
        bounds = joined(bounds, [place; 2]);
    }
    Ok(bounds)
}

/// Bounds around both.
pub(crate) fn joined(one: [Vec3; 2], other: [Vec3; 2]) -> [Vec3; 2] {
    [one[0].min(other[0]), one[1].max(other[1])]
}

/// The corners of a box.
pub(crate) fn box_corners(ends: [Vec3; 2]) -> impl Iterator<Item = Vec3> {
    (0..8).map(move |corner: usize| {
        Vec3::from_array([0, 1, 2].map(|axis| ends[corner >> axis & 1][axis]))
    })
}

impl Part {
    /// Bounds of its positions where a map takes it.
    ///
    /// # Errors
    /// A map that cannot move it, or not all within its bounds.
    pub fn place(&self, map: &DAffine3) -> Result<[Vec3; 2], MoveError> {
        let bounds = match &self.host {
            Some(host) => host.bounds,
            None => self.of.bounds(self.number),
        };
        placed(bounds, map)
    }

    /// Number of its positions.
    pub fn positions(&self) -> usize {
        match &self.host {
            Some(_) => self.of.rest.positions.len(),
            None => self.of.ranges(self.number)[0].len(),
        }
    }

    /// The write of a part of a host's buffer that a map moves, without nodes.
    pub fn host_write(&self, map: DAffine3) -> Option<HostWrite> {
        let host = self.host.as_ref()?;
        let at = self.at;
        Some(HostWrite {
            id: self.id,
            mesh: host.mesh.clone(),
            map,
            bounds: host.bounds,
            first: [at.position, at.normal, at.triangle],
            nodes: None,
        })
    }

    /// The ranges of the mesh that hold its positions and normals.
    pub fn ranges(&self) -> [Range<usize>; 2] {
        let [positions, normals] = self.of.ranges(self.number);
        let at = self.at;
        [from(positions, at.position), from(normals, at.normal)]
    }

    /// The positions, normals and triangles that are free for others without it. Those of a part
    /// that was cut out of a mesh may have others between them.
    pub fn room(&self) -> Option<[Range<usize>; 3]> {
        let [positions, normals] = self.ranges();
        let ranges = [positions, normals, self.triangles()];
        self.of.is_joined().then_some(ranges)
    }

    /// The range of the mesh that holds its triangles.
    pub fn triangles(&self) -> Range<usize> {
        let range = range_of(self.of.triangles(self.number));
        from(range, self.at.triangle)
    }
}

/// Returns the range that holds these triangles, which are in ascending order.
pub(crate) fn range_of(triangles: &[u32]) -> Range<usize> {
    let ends = triangles.first().zip(triangles.last());
    ends.map_or(0..0, |(first, last)| *first as usize..*last as usize + 1)
}

fn from(range: Range<usize>, first: usize) -> Range<usize> {
    range.start + first..range.end + first
}
