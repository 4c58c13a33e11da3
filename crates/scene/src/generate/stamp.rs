//! Parts that are made once and copied many times, turned by quarters: these change no bit of a
//! normal, so that all copies share the few that there are.

use super::solid::Builder;
use crate::mesh::Mesh;
use glam::{DVec3, Vec3};

/// A part and its normals' places in the mesh, by quarter turn.
pub(super) struct Stamp {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    normal_indices: [Vec<[u32; 3]>; 4],
}

/// A vector turned about the y axis: a quarter takes z to x.
pub(super) fn turned(v: DVec3, quarters: usize) -> DVec3 {
    match quarters % 4 {
        0 => v,
        1 => DVec3::new(v.z, v.y, -v.x),
        2 => DVec3::new(-v.x, v.y, -v.z),
        _ => DVec3::new(-v.z, v.y, v.x),
    }
}

impl Stamp {
    /// The geometry that `draw` builds around the origin, to be copied into a mesh.
    pub fn new(mesh: &mut Builder, draw: impl FnOnce(&mut Builder)) -> Self {
        let mut part = Builder::default();
        draw(&mut part);
        let part: Mesh = part.finish();
        let normal_indices = std::array::from_fn(|quarters| {
            let mut place = |normal: Vec3| {
                let normal = turned(normal.as_dvec3(), quarters).as_vec3();
                mesh.normals.index(normal)
            };
            let places: Vec<u32> = part.normals.iter().map(|&normal| place(normal)).collect();
            let placed = |corners: &[u32; 3]| corners.map(|index| places[index as usize]);
            part.normal_indices.iter().map(placed).collect()
        });
        Self {
            positions: part.positions.iter().map(|p| p.as_dvec3()).collect(),
            triangles: part.triangles,
            normal_indices,
        }
    }

    /// Copies the part into `builder`'s mesh, turned by quarters about the y axis as [`turned`]
    /// turns, with its origin at `origin`. `builder` must be the one that [`Self::new`] got.
    pub fn place(&self, quarters: usize, origin: DVec3, builder: &mut Builder) {
        let mesh = &mut builder.mesh;
        let base = mesh.positions.len() as u32;
        let positions = self.positions.iter();
        mesh.positions
            .extend(positions.map(|&p| (origin + turned(p, quarters)).as_vec3()));
        let triangles = self.triangles.iter();
        mesh.triangles
            .extend(triangles.map(|corners| corners.map(|corner| base + corner)));
        mesh.normal_indices
            .extend(&self.normal_indices[quarters % 4]);
        builder.end_group();
    }
}
