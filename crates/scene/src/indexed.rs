//! Triangle meshes in a program's memory, to be made into a [`Mesh`], in which equal positions are
//! one (welded).

use crate::material::Material;
use crate::mesh::{Group, Mesh, names_one_twice};
use crate::weld::Welder;
use glam::{DVec3, Vec2, Vec3};

/// Triangle mesh as a program holds it in memory: not welded, with one normal for each position.
#[derive(Clone, Copy, Debug, Default)]
pub struct Indexed<'a> {
    /// Positions in world space, or, of a mesh that is moved as a part
    /// ([`Movable::joined`](crate::Movable::joined)), in a space of its own. All must be finite.
    pub positions: &'a [[f32; 3]],
    /// Normals, one for each position, finite and of any length; a normal of length 0 counts as
    /// missing. An empty list gives each triangle its geometric normal.
    pub normals: &'a [[f32; 3]],
    /// Indices into `positions`, three for each triangle, counter-clockwise seen from outside.
    pub indices: &'a [u32],
}

/// Reason why [`Indexed::mesh`] cannot make a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IndexedError {
    /// The number of indices is not divisible by 3. Holds the number of indices.
    #[error("{0} indices do not form triangles: they are not divisible by 3")]
    Corners(usize),
    /// The number of normals is neither 0 nor the number of positions.
    #[error("there are {normals} normals for {positions} positions: give one each, or none")]
    Normals {
        /// Number of normals that were given.
        normals: usize,
        /// Number of positions that were given.
        positions: usize,
    },
    /// An index is not below the number of positions.
    #[error("index {at} is {index}, but there are only {positions} positions")]
    Index {
        /// Place of the index in [`Indexed::indices`], from 0.
        at: usize,
        /// Index that was found there.
        index: u32,
        /// Number of positions that were given.
        positions: usize,
    },
    /// The number of texture coordinates is not the number of positions.
    #[error("there are {uvs} texture coordinates for {positions} positions: give one each")]
    Uvs {
        /// Number of texture coordinates that were given.
        uvs: usize,
        /// Number of positions that were given.
        positions: usize,
    },
    /// A coordinate is infinite or NaN.
    #[error("{what} {at} is not finite: {value:?}")]
    NotFinite {
        /// List that holds the coordinate: `position` or `normal`.
        what: &'static str,
        /// Place of the position or normal in its list, from 0.
        at: usize,
        /// Position or normal that was found there.
        value: [f32; 3],
    },
}

impl Indexed<'_> {
    /// Returns the mesh, in which equal positions are one (welded). They stand in the order in
    /// which [`positions`](Self::positions) first has them, unused ones too; −0 becomes 0.
    /// Triangles keep their order. One with equal positions at two corners is left out, so that the
    /// primitive ids of those after it are lower by one. A missing normal is replaced by the
    /// geometric normal of its triangle (+y if the triangle has no area). Equal normals are one, in
    /// the order in which triangles first use them. The mesh has one group, whose name is empty,
    /// and no materials; its [`surfaces`](Mesh::surfaces) may be set for the triangles that are
    /// left.
    ///
    /// # Errors
    /// [`IndexedError`] for lists of the wrong length, an index without a position, or a number
    /// that is not finite.
    pub fn mesh(&self) -> Result<Mesh, IndexedError> {
        check(self)?;
        let (mut positions, mut normals) = <(Welder, Welder)>::default();
        let welded = self.positions.iter().map(|&p| positions.index(p.into()));
        let at: Vec<u32> = welded.collect();
        let mut mesh = Mesh::default();
        for corners in self.indices.as_chunks::<3>().0 {
            let triangle = corners.map(|corner| at[corner as usize]);
            if names_one_twice(&triangle) {
                continue;
            }
            let points = triangle.map(|index| positions.values[index as usize].as_dvec3());
            let flat = geometric_normal(points).unwrap_or(DVec3::Y);
            mesh.normal_indices.push(corners.map(|corner| {
                let own = self.normals.get(corner as usize);
                let own = own.and_then(|&own| Vec3::from(own).as_dvec3().try_normalize());
                normals.index(own.unwrap_or(flat).as_vec3())
            }));
            mesh.triangles.push(triangle);
        }
        mesh.groups.push(Group {
            name: String::new(),
            triangles: 0..mesh.triangles.len() as u32,
        });
        (mesh.positions, mesh.normals) = (positions.values, normals.values);
        Ok(mesh)
    }

    /// Returns the mesh, all of one material. `uvs` are texture coordinates, v down, one for each
    /// position; none for a material without a mask and without a texture.
    ///
    /// # Errors
    /// Those of [`mesh`](Self::mesh), and [`IndexedError::Uvs`] for another number of texture
    /// coordinates.
    pub fn mesh_of(&self, material: Material, uvs: &[[f32; 2]]) -> Result<Mesh, IndexedError> {
        let mut mesh = self.mesh()?;
        let (uvs, positions) = (uvs.iter().copied().map(Vec2::from), self.positions.len());
        let surfaces = &mut mesh.surfaces;
        surfaces.of = vec![0; mesh.triangles.len()];
        surfaces.materials = vec![material];
        surfaces.uvs = uvs.collect();
        if surfaces.uvs.is_empty() {
            return Ok(mesh);
        }
        if surfaces.uvs.len() != positions {
            let uvs = surfaces.uvs.len();
            return Err(IndexedError::Uvs { uvs, positions });
        }
        // Those that `mesh` leaves: places are equal as numbers, 0 and -0 too.
        let at = |corner: u32| self.positions[corner as usize];
        let is_left = |&[a, b, c]: &[u32; 3]| at(a) != at(b) && at(b) != at(c) && at(c) != at(a);
        let triangles = self.indices.as_chunks::<3>().0.iter().copied();
        surfaces.uv_indices = triangles.filter(is_left).collect();
        Ok(mesh)
    }
}

fn check(from: &Indexed) -> Result<(), IndexedError> {
    let positions = from.positions.len();
    if !from.indices.len().is_multiple_of(3) {
        return Err(IndexedError::Corners(from.indices.len()));
    }
    let normals = from.normals.len();
    if normals != 0 && normals != positions {
        return Err(IndexedError::Normals { normals, positions });
    }
    let mut indices = from.indices.iter().enumerate();
    if let Some((at, &index)) = indices.find(|(_, index)| **index as usize >= positions) {
        return Err(IndexedError::Index {
            at,
            index,
            positions,
        });
    }
    for (what, list) in [("position", from.positions), ("normal", from.normals)] {
        let mut values = list.iter().enumerate();
        if let Some((at, &value)) = values.find(|(_, it)| !it.iter().all(|x| x.is_finite())) {
            return Err(IndexedError::NotFinite { what, at, value });
        }
    }
    Ok(())
}

pub(crate) fn geometric_normal([a, b, c]: [DVec3; 3]) -> Option<DVec3> {
    (b - a).cross(c - a).try_normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.0; 3]];

    fn indexed(indices: &[u32]) -> Result<Mesh, IndexedError> {
        Indexed {
            positions: &CORNERS,
            normals: &[],
            indices,
        }
        .mesh()
    }

    #[test]
    fn equal_positions_are_one_and_triangles_keep_their_order() {
        let mesh = indexed(&[1, 2, 3, 0, 3, 1, 0, 2, 1]).unwrap();
        assert_eq!(mesh.positions.len(), 3);
        assert_eq!(mesh.triangles, [[1, 2, 0], [0, 2, 1]]);
        assert_eq!(mesh.normals, [Vec3::Z, Vec3::NEG_Z]);
        assert_eq!(mesh.normal_indices, [[0; 3], [1; 3]]);
    }

    #[test]
    fn normals_are_made_unit_length_or_the_faces() {
        let mesh = Indexed {
            positions: &CORNERS,
            normals: &[[3.0, 0.0, 0.0], [0.0; 3], [0.0, 2.0, 0.0], [1.0; 3]],
            indices: &[0, 1, 2],
        }
        .mesh();
        let mesh = mesh.unwrap();
        assert_eq!(mesh.normals, [Vec3::X, Vec3::Z, Vec3::Y]);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let error_text = |mesh: Result<Mesh, IndexedError>| mesh.unwrap_err().to_string();
        assert!(error_text(indexed(&[0, 1])).contains("2 indices"));
        let beyond = error_text(indexed(&[0, 1, 2, 0, 4, 1]));
        assert_eq!(beyond, "index 4 is 4, but there are only 4 positions");
        for (normals, positions, expected) in [
            (vec![[1.0; 3]; 2], CORNERS, "2 normals for 4 positions"),
            (vec![[f32::NAN; 3]; 4], CORNERS, "normal 0 is not finite"),
            (vec![], [[f32::INFINITY; 3]; 4], "position 0 is not finite"),
        ] {
            let text = error_text(
                Indexed {
                    positions: &positions,
                    normals: &normals,
                    indices: &[0, 1, 2],
                }
                .mesh(),
            );
            assert!(text.contains(expected), "{text}");
        }
    }
}
