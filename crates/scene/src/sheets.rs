//! Sheets: triangles that cast a shadow by both of their faces.

use crate::{mesh::Mesh, parts::Parts};
use std::cell::LazyCell;

/// Sheets of a mesh: its masked triangles, and its double-sided ones that belong to an open
/// [part](Parts). Behind the front of a sheet is no back that could cast its shadow, so a shadow
/// map has to draw both. A double-sided triangle of a closed part is no sheet: its part casts the
/// same shadow by its back faces alone. A triangle that [casts](Mesh::casts) no shadow is none.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sheets(Vec<u32>);

impl Sheets {
    /// Finds the sheets of a mesh, in linear time; in time *n* log *n* of its triangles if any is
    /// double-sided and not masked.
    pub fn new(mesh: &Mesh) -> Self {
        let mut sheets = Self::default();
        sheets.put(mesh, 0, mesh.triangles.len());
        sheets
    }

    /// Replaces the sheets among the triangles of a larger mesh from primitive id `first` on by
    /// those of `part`, whose triangles these are; no other triangle shares an edge with them.
    /// `total` is the number of triangles that the larger mesh has now.
    ///
    /// # Panics
    /// If `first` and the triangles of `part` together are more than `total`.
    pub fn put(&mut self, part: &Mesh, first: usize, total: usize) {
        let parts = LazyCell::new(|| Parts::new(part));
        let is_sheet = |id| {
            let is_double_sided = part.surfaces.is_double_sided(id);
            let has_faces =
                part.surfaces.mask(id).is_some() || is_double_sided && parts.is_open(id);
            has_faces && part.casts(id)
        };
        let flags: Vec<bool> = (0..part.triangles.len() as u32).map(is_sheet).collect();
        if self.0.is_empty() && !flags.contains(&true) {
            return;
        }
        self.0.resize(total.div_ceil(32), 0);
        for (at, flag) in (first..).zip(flags) {
            let (word, bit) = (&mut self.0[at / 32], at % 32);
            *word = (*word & !(1 << bit)) | u32::from(flag) << bit;
        }
        if self.0.iter().all(|&word| word == 0) {
            self.0.clear();
        }
    }

    /// Returns one bit per triangle, set for sheets: 32 to a word, lowest bit first. No words if no
    /// triangle is a sheet.
    pub fn words(&self) -> &[u32] {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{mask::Mask, material::Material, texture::Wrap};
    use glam::Vec2;
    use std::sync::Arc;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    fn is_sheet(sheets: &Sheets, primitive: u32) -> bool {
        let word = sheets.words().get(primitive as usize / 32);
        word.is_some_and(|word| word >> (primitive % 32) & 1 == 1)
    }

    /// Triangles whose materials are: 0 plain, 1 double-sided, 2 masked.
    fn sheets_of(triangles: &[[u32; 3]], materials: &[u32]) -> Vec<u32> {
        let mesh = painted(triangles, materials);
        let sheets = Sheets::new(&mesh);
        (0..triangles.len() as u32)
            .filter(|&id| is_sheet(&sheets, id))
            .collect()
    }

    fn painted(triangles: &[[u32; 3]], materials: &[u32]) -> Mesh {
        let mask = Some(Arc::new(Mask::new([2, 1], [Wrap::Repeat; 2], |x, _| x > 0)));
        let mut mesh = Mesh {
            triangles: triangles.to_vec(),
            ..Mesh::default()
        };
        mesh.surfaces.uvs = vec![Vec2::ZERO];
        mesh.surfaces.uv_indices = vec![[0; 3]; triangles.len()];
        mesh.surfaces.of = materials.to_vec();
        mesh.surfaces.materials = [(false, None), (true, None), (false, mask)]
            .map(|(double_sided, mask)| Material {
                double_sided,
                mask,
                ..Material::default()
            })
            .to_vec();
        mesh
    }

    #[test]
    fn double_sided_triangles_are_sheets_where_their_part_is_open() {
        assert_eq!(sheets_of(&TETRAHEDRON, &[1; 4]), [0; 0]);
        assert_eq!(sheets_of(&TETRAHEDRON[..3], &[1; 3]), [0, 1, 2]);
        // A flag on some of a part.
        assert_eq!(sheets_of(&TETRAHEDRON[..3], &[0, 1, 0]), [1]);
        assert_eq!(sheets_of(&TETRAHEDRON[..3], &[0; 3]), [0; 0]);
        // A leaf beside a solid, and one on its edge, which opens it.
        let with_leaf = |leaf| [&TETRAHEDRON[..], &[leaf]].concat();
        assert_eq!(sheets_of(&with_leaf([4, 5, 6]), &[1; 5]), [4]);
        assert_eq!(sheets_of(&with_leaf([0, 1, 6]), &[1; 5]), [0, 1, 2, 3, 4]);
    }

    #[test]
    fn masked_triangles_are_sheets_whatever_their_part() {
        assert_eq!(sheets_of(&TETRAHEDRON, &[2, 1, 1, 2]), [0, 3]);
        assert_eq!(sheets_of(&TETRAHEDRON[..2], &[2, 0]), [0]);
        assert!(Sheets::new(&Mesh::default()).words().is_empty());
    }

    #[test]
    fn parts_that_come_and_go_change_their_own_bits_alone() {
        let triangles: Vec<[u32; 3]> = (0..40)
            .map(|leaf| [0, 1, 2].map(|c| 3 * leaf + c))
            .collect();
        let leaves = |count: usize, material| painted(&triangles[..count], &vec![material; count]);
        let mut sheets = Sheets::default();
        sheets.put(&leaves(20, 0), 10, 70);
        assert!(sheets.words().is_empty());
        sheets.put(&leaves(40, 1), 30, 70);
        sheets.put(&leaves(5, 0), 31, 70);
        sheets.put(&leaves(3, 2), 0, 100);
        sheets.put(&Mesh::default(), 0, 130);
        let expected = |id: u32| id < 3 || id == 30 || (36..70).contains(&id);
        assert!((0..200).all(|id| is_sheet(&sheets, id) == expected(id)));
        assert_eq!(sheets.words().len(), 5);
        sheets.put(&leaves(40, 0), 0, 130);
        sheets.put(&leaves(40, 0), 40, 130);
        assert!(sheets.words().is_empty(), "no sheet is left");
    }
}
