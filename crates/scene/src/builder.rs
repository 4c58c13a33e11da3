//! Puts together a mesh of the triangles of a file: welds, drops and repairs.

use crate::error::{FaceRef, beginning, plural};
use crate::indexed::geometric_normal;
use crate::material::Material;
use crate::mesh::{Group, Mesh, names_one_twice};
use crate::report::ImportReport;
use crate::weld::{UvWelder, Welder};
use glam::{DVec3, Vec2};
use std::collections::BTreeMap;

/// A corner of a face: welded position, and what the file gives it.
#[derive(Clone, Copy)]
pub(crate) struct Corner {
    pub position: u32,
    pub normal: Option<DVec3>,
    /// Place in [`MeshBuilder::shared_normals`] of the index of `normal`, if it has one there.
    pub slot: Option<u32>,
    pub uv: Option<Vec2>,
}

/// The mesh so far.
#[derive(Default)]
pub(crate) struct MeshBuilder {
    pub positions: Welder,
    normals: Welder,
    /// Indices of normals that corners share, once a triangle has used them.
    pub shared_normals: Vec<Option<u32>>,
    uvs: UvWelder,
    /// Triangles of which a corner has no texture coordinates, or none that are finite.
    without_uvs: Vec<u32>,
    mesh: Mesh,
    pub report: ImportReport,
}

impl MeshBuilder {
    /// Adds a triangle; `normal` is asked where the triangle has no geometric normal.
    pub fn add(
        &mut self,
        corners: [Corner; 3],
        normal: impl Fn() -> Option<DVec3>,
        group: &str,
        material: Option<u32>,
        face: impl Fn() -> FaceRef,
    ) {
        let indices = corners.map(|corner| corner.position);
        if names_one_twice(&indices) {
            self.report.dropped.add(face);
            return;
        }
        let points = indices.map(|index| self.point(index));
        if has_no_area(points) {
            self.report.zero_area.add(face);
        }
        let mut own = None;
        let normal_indices = corners.map(|corner| {
            let shared = corner
                .slot
                .map(|slot| &mut self.shared_normals[slot as usize]);
            if let Some(Some(index)) = shared {
                return *index;
            }
            let given = corner.normal.map(DVec3::try_normalize);
            self.report.normals_replaced += usize::from(given == Some(None));
            let mut index = |normal: DVec3| self.normals.index(normal.as_vec3());
            match given.flatten() {
                Some(given) => *shared.unwrap_or(&mut None).insert(index(given)),
                None => *own.get_or_insert_with(|| {
                    let own = geometric_normal(points).or_else(&normal);
                    index(own.unwrap_or(DVec3::Y))
                }),
            }
        });
        let primitive = self.mesh.triangles.len() as u32;
        self.mesh.triangles.push(indices);
        self.mesh.normal_indices.push(normal_indices);
        match self.mesh.groups.last_mut() {
            Some(last) if last.name == group => last.triangles.end = primitive + 1,
            _ => self.mesh.groups.push(Group {
                name: group.to_owned(),
                triangles: primitive..primitive + 1,
            }),
        }
        if let Some(material) = material {
            let is_there = |corner: &Corner| corner.uv.is_some_and(Vec2::is_finite);
            if !corners.iter().all(is_there) {
                self.without_uvs.push(primitive);
            }
            let uvs = corners.map(|corner| self.uvs.index(corner.uv.unwrap_or(Vec2::ZERO)));
            self.mesh.surfaces.uv_indices.push(uvs);
            self.mesh.surfaces.of.push(material);
        }
    }

    /// Number of triangles so far.
    pub fn triangles(&self) -> u32 {
        self.mesh.triangles.len() as u32
    }

    /// Returns the welded position with this index.
    pub fn point(&self, index: u32) -> DVec3 {
        self.positions.values[index as usize].as_dvec3()
    }

    /// Gives masked triangles without texture coordinates an opaque material, and says so.
    fn without_masks(&mut self, mut materials: Vec<Material>) -> Vec<Material> {
        // By the number of the masked material: the opaque one, its triangles and the first.
        let mut opaque: BTreeMap<u32, (u32, usize, u32)> = BTreeMap::new();
        for primitive in std::mem::take(&mut self.without_uvs) {
            let masked = self.mesh.surfaces.of[primitive as usize];
            let material = materials.get(masked as usize);
            let mask = material.and_then(|material| material.mask.as_ref());
            if mask.is_none_or(|mask| mask.is_uniform()) {
                continue;
            }
            let (number, count, _) = opaque.entry(masked).or_insert_with(|| {
                let own = materials[masked as usize].clone();
                materials.push(Material { mask: None, ..own });
                (materials.len() as u32 - 1, 0, primitive)
            });
            *count += 1;
            self.mesh.surfaces.of[primitive as usize] = *number;
        }
        for (number, count, first) in opaque.into_values() {
            let mut groups = self.mesh.groups.iter();
            let first = groups.find(|group| group.triangles.contains(&first));
            self.report.remark(format!(
                "material {:?}: {} without finite texture coordinates, by which its mask is \
                 looked up, the first in {:?}: opaque there",
                beginning(&materials[number as usize].name),
                plural(count, "triangle", "triangles"),
                beginning(first.map_or("", |group| &group.name)),
            ));
        }
        materials
    }

    /// Returns the mesh and the report of its import. `materials` are given only if every triangle
    /// has one.
    pub fn finish(mut self, materials: Vec<Material>) -> (Mesh, ImportReport) {
        let materials = self.without_masks(materials);
        self.mesh.positions = self.positions.values;
        self.mesh.normals = self.normals.values;
        self.mesh.surfaces.uvs = self.uvs.values;
        self.mesh.surfaces.materials = materials;
        (self.mesh, self.report)
    }
}

/// Returns true if the corners lie on a line. Differences of `f32` corners are exact in `f64`
/// (unless their exponents lie more than 29 apart); the products are compared with their rounding
/// errors, so that no tiny area is taken for none.
pub(crate) fn has_no_area([a, b, c]: [DVec3; 3]) -> bool {
    let (u, v) = (b - a, c - a);
    let equal = |p: f64, q: f64, r: f64, s: f64| {
        let (left, right) = (p * q, r * s);
        left == right && p.mul_add(q, -left) == r.mul_add(s, -right)
    };
    equal(u.y, v.z, u.z, v.y) && equal(u.z, v.x, u.x, v.z) && equal(u.x, v.y, u.y, v.x)
}
