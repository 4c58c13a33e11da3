//! Roles of surfaces in shadows: which cast them, and which receive them.

use serde::{Deserialize, Serialize};

/// Role of a surface in shadows. A surface that does not cast keeps light from nothing; one that
/// does not receive is lit wherever it faces. Cameras see it whatever its role.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Shadows {
    /// It casts shadows and receives them.
    #[default]
    Both,
    /// It casts shadows and receives none.
    Casts,
    /// It receives shadows and casts none.
    Receives,
    /// It casts no shadow and receives none.
    Neither,
}

impl Shadows {
    /// Returns true if the surface keeps light from others.
    pub fn casts(self) -> bool {
        matches!(self, Self::Both | Self::Casts)
    }

    /// Returns true if others keep light from the surface.
    pub fn receives(self) -> bool {
        matches!(self, Self::Both | Self::Receives)
    }

    /// Returns the role of this casting and receiving.
    pub fn new(casts: bool, receives: bool) -> Self {
        match (casts, receives) {
            (true, true) => Self::Both,
            (true, false) => Self::Casts,
            (false, true) => Self::Receives,
            (false, false) => Self::Neither,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mesh, packed_masks::shadow_words};

    /// Triangles of their own corners, of two groups.
    fn mesh(count: u32) -> Mesh {
        let group = |name: &str, triangles| crate::Group {
            name: name.to_owned(),
            triangles,
        };
        Mesh {
            triangles: (0..count)
                .map(|at| [3 * at, 3 * at + 1, 3 * at + 2])
                .collect(),
            groups: vec![group("grass", 1..3), group("tree", 3..count)],
            ..Mesh::default()
        }
    }

    #[test]
    fn roles_are_packed_two_bits_each() {
        let mut mesh = mesh(20);
        assert!(shadow_words(&mesh).is_empty());
        mesh.set_shadows_of("grass", Shadows::Receives)
            .expect("a part");
        assert_eq!(shadow_words(&mesh), [0b1_01_00, 0]);
        mesh.surfaces.set_shadows([17, 18], 20, Shadows::Casts);
        mesh.surfaces.set_shadows([2], 20, Shadows::Neither);
        assert_eq!(shadow_words(&mesh), [0b11_01_00, 0b10_10_00]);
        let casters: Vec<u32> = [0].into_iter().chain(3..20).collect();
        assert_eq!(mesh.casters(), casters);
        // A triangle of a removed part is there for another one.
        mesh.triangles[1] = [0; 3];
        assert!(mesh.casts(1) && !mesh.casts(2));
    }

    #[test]
    fn materials_are_copied_once_for_each_role_and_part() {
        let mut mesh = mesh(6);
        mesh.set_shadows_of("grass", Shadows::Neither)
            .expect("a part");
        mesh.set_shadows_of("grass", Shadows::Neither)
            .expect("a part");
        assert_eq!(mesh.surfaces.of, [0, 1, 1, 0, 0, 0]);
        assert_eq!(mesh.surfaces.materials.len(), 2);
        assert!(mesh.surfaces.have_roles());
        mesh.set_shadows_of("grass", Shadows::Both).expect("a part");
        assert!(!mesh.surfaces.have_roles() && shadow_words(&mesh).is_empty());
        assert_eq!(
            mesh.set_shadows_of("gras", Shadows::Both),
            Err("no part of the mesh is called \"gras\"; known here: grass, tree".to_owned())
        );
    }

    #[test]
    fn a_mesh_without_roles_gets_no_materials() {
        let mut mesh = mesh(4);
        mesh.set_shadows(Shadows::Both);
        assert!(mesh.surfaces.of.is_empty());
        mesh.set_shadows(Shadows::Receives);
        assert!(mesh.casters().is_empty());
        for (casts, receives) in [(true, true), (true, false), (false, true), (false, false)] {
            let role = Shadows::new(casts, receives);
            assert_eq!((role.casts(), role.receives()), (casts, receives));
        }
    }
}
