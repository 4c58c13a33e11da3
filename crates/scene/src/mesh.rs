//! Indexed triangle meshes with welded positions.

use crate::{material::Surfaces, shadows::Shadows};
use glam::{DVec3, Vec3};
use std::ops::Range;

/// A triangle mesh. Positions are *welded* (bit-equal positions are stored once, -0 counts as 0),
/// so that an index names a point in space and adjacency can be read off `triangles`; normals are
/// indexed apart, so that a crease costs no duplicate position.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Welded positions, world space, finite.
    pub positions: Vec<Vec3>,
    /// Three indices into `positions` per triangle, counter-clockwise seen from outside. A
    /// triangle's index in this list is its *primitive id*.
    pub triangles: Vec<[u32; 3]>,
    /// Vertex normals, world space, unit length, indexed by `normal_indices`.
    pub normals: Vec<Vec3>,
    /// Three indices into `normals` per triangle, parallel to `triangles`.
    pub normal_indices: Vec<[u32; 3]>,
    /// Named runs of consecutive triangles, in the order of `triangles`, such as the groups of an
    /// OBJ file or the nodes of a glTF file. Several may have the same name.
    pub groups: Vec<Group>,
    /// Materials of the triangles, and texture coordinates of their corners.
    pub surfaces: Surfaces,
}

/// Named run of consecutive triangles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// Name of the group in the file or generator.
    pub name: String,
    /// Primitive ids of the group: indices into [`Mesh::triangles`].
    pub triangles: Range<u32>,
}

impl Mesh {
    /// Returns the corner positions of triangle `primitive`, world space, in f64 (exact).
    ///
    /// # Panics
    /// If `primitive` is not below `triangles.len()`.
    pub fn corners(&self, primitive: u32) -> [DVec3; 3] {
        self.triangles[primitive as usize].map(|index| self.positions[index as usize].as_dvec3())
    }

    /// Returns the vertex normals of triangle `primitive`, world space, in f64, corner by corner.
    ///
    /// # Panics
    /// If `primitive` is not below `triangles.len()`.
    pub fn corner_normals(&self, primitive: u32) -> [DVec3; 3] {
        self.normal_indices[primitive as usize].map(|index| self.normals[index as usize].as_dvec3())
    }

    /// Reverses the winding of triangle `primitive`: its second and third corner change places,
    /// with their normals and texture coordinates.
    ///
    /// # Panics
    /// If `primitive` is not below `triangles.len()`.
    pub fn turn(&mut self, primitive: usize) {
        self.triangles[primitive].swap(1, 2);
        self.normal_indices[primitive].swap(1, 2);
        if let Some(uvs) = self.surfaces.uv_indices.get_mut(primitive) {
            uvs.swap(1, 2);
        }
    }

    /// Finds the triangles of a part: the primitive ids of all groups of this name, ascending.
    ///
    /// # Errors
    /// Text that lists the names of all groups, if there is none of this name.
    pub fn part(&self, name: &str) -> Result<Vec<u32>, String> {
        let groups = self.groups.iter().filter(|group| group.name == name);
        let triangles: Vec<u32> = groups.flat_map(|group| group.triangles.clone()).collect();
        if !triangles.is_empty() {
            return Ok(triangles);
        }
        let mut names: Vec<&str> = self.groups.iter().map(|it| it.name.as_str()).collect();
        names.dedup();
        let names = names.join(", ");
        Err(format!(
            "no part of the mesh is called {name:?}; known here: {names}"
        ))
    }

    /// Gives all triangles a role in shadows.
    pub fn set_shadows(&mut self, shadows: Shadows) {
        let total = self.triangles.len();
        self.surfaces.set_shadows(0..total as u32, total, shadows);
    }

    /// Gives the triangles of a [part](Self::part) a role in shadows.
    ///
    /// # Errors
    /// Text that lists the names of all groups, if there is none of this name.
    pub fn set_shadows_of(&mut self, part: &str, shadows: Shadows) -> Result<(), String> {
        let (triangles, total) = (self.part(part)?, self.triangles.len());
        self.surfaces.set_shadows(triangles, total, shadows);
        Ok(())
    }

    /// Returns true if triangle `primitive` casts a shadow, or is one of a removed part: all of its
    /// corners are position 0, and another part may take its place.
    ///
    /// # Panics
    /// If `primitive` is not below `triangles.len()`.
    pub fn casts(&self, primitive: u32) -> bool {
        let is_free = || self.triangles[primitive as usize] == [0; 3];
        self.surfaces.shadows(primitive).casts() || is_free()
    }

    /// Returns the primitive ids of all triangles that cast a shadow, ascending.
    pub fn casters(&self) -> Vec<u32> {
        let primitives = 0..self.triangles.len() as u32;
        primitives.filter(|id| self.casts(*id)).collect()
    }

    /// Iterates over the corner positions of all triangles, in the order of `triangles`, three for
    /// each.
    pub fn corner_positions(&self) -> impl Iterator<Item = Vec3> {
        let corners = self.triangles.iter().flatten();
        corners.map(|&index| self.positions[index as usize])
    }

    /// Iterates over the positions that at least one triangle uses, each once, in the order of
    /// `positions`.
    pub fn used_positions(&self) -> impl Iterator<Item = Vec3> {
        let mut is_used = vec![false; self.positions.len()];
        for &index in self.triangles.iter().flatten() {
            is_used[index as usize] = true;
        }
        let positions = self.positions.iter().zip(is_used);
        positions.filter_map(|(place, is_used)| is_used.then_some(*place))
    }

    /// Returns the smallest axis-aligned box, in world space, around all positions that triangles
    /// use, as its low and high corner. Returns `None` for a mesh without triangles.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        bounds(self.corner_positions())
    }
}

/// The smallest box around some points; `None` around none.
pub(crate) fn bounds(mut points: impl Iterator<Item = Vec3>) -> Option<(Vec3, Vec3)> {
    let first = points.next()?;
    Some(points.fold((first, first), |(min, max), p| (min.min(p), max.max(p))))
}

pub(crate) fn names_one_twice([a, b, c]: &[u32; 3]) -> bool {
    a == b || b == c || c == a
}
