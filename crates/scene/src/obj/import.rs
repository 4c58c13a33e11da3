//! Welds what `tobj` read into a [`Mesh`].

use super::{
    guard::{FaceRecord, Faults, Guard},
    mtl::{self, Found},
    options::ObjOptions,
    polygon,
};
use crate::{
    builder::{Corner, MeshBuilder},
    error::{FaceProblem, SceneError, plural},
    mesh::Mesh,
    report::ImportReport,
};
use glam::{DVec3, Vec3};
use std::path::Path;

/// The mesh of the models that `tobj` read through `guard`.
///
/// # Errors
/// More corners than indices, a corner that is not finite, a face that cannot be cut, or materials
/// that cannot be had.
pub(super) fn import(
    models: &[tobj::Model],
    guard: &Guard<'_>,
    options: &ObjOptions,
    path: &Path,
) -> Result<(Mesh, ImportReport), SceneError> {
    let materials = mtl::materials(guard, options, path)?;
    let mut import = Import {
        guard,
        options,
        path,
        found: materials,
        builder: MeshBuilder::default(),
        uncut: Faults::default(),
    };
    import.builder.report = ImportReport {
        file: Some(path.to_owned()),
        faces: guard.faces.len(),
        points: guard.points,
        lines: guard.lines,
        colours_missing: std::mem::take(&mut import.found.colours_missing),
        ..ImportReport::default()
    };
    import.remark_and_check()?;
    import.run(models)?;
    import.uncut.refuse(path)?;
    Ok(import.builder.finish(import.found.materials))
}

struct Import<'a> {
    guard: &'a Guard<'a>,
    options: &'a ObjOptions,
    path: &'a Path,
    found: Found,
    builder: MeshBuilder,
    /// Faces that cannot be cut.
    uncut: Faults,
}

impl Import<'_> {
    /// Says what was passed over. Texture coordinates that are not there are a fault where a mask
    /// is looked up by them.
    fn remark_and_check(&mut self) -> Result<(), SceneError> {
        let (guard, report) = (self.guard, &mut self.builder.report);
        for text in std::mem::take(&mut self.found.remarks) {
            report.remark(text);
        }
        if guard.normals_unread > 0 {
            let normals = plural(guard.normals_unread, "normal", "normals");
            report.remark(format!("{normals} (vn) passed over: not three numbers"));
        }
        if guard.normals_absent > 0 {
            let faces = plural(guard.normals_absent, "face names", "faces name");
            report.remark(format!("{faces} normals that are not there: flat"));
        }
        if guard.curved > 0 {
            let curved = plural(guard.curved, "curve or surface", "curves and surfaces");
            report.remark(format!(
                "{curved} (curv, surf) passed over: only faces are drawn"
            ));
        }
        let (mut faults, mut harmless) = (Faults::default(), 0);
        for (face, problem) in &guard.uvs_absent {
            let record = &guard.faces[*face];
            let material = self.found.materials.get(record.material as usize);
            if material.is_none_or(|material| material.mask.is_none()) {
                harmless += 1;
                continue;
            }
            faults.add(|| guard.face_ref(record), problem.clone());
        }
        if harmless > 0 {
            let faces = plural(harmless, "face names", "faces name");
            report.remark(format!("{faces} texture coordinates that are not there"));
        }
        faults.refuse(self.path)
    }

    fn run(&mut self, models: &[tobj::Model]) -> Result<(), SceneError> {
        let corner_count: usize = models.iter().map(|model| model.mesh.indices.len()).sum();
        // Welded positions, normals and triangles are at most as many as corners.
        if u32::try_from(corner_count).is_err() {
            return Err(SceneError::TooLarge {
                path: self.path.to_owned(),
            });
        }
        self.check_finite(models)?;
        let mut records = self.guard.faces.iter();
        let mut polygon = Vec::new();
        for model in models {
            let mesh = &model.mesh;
            let points = mesh
                .positions
                .chunks_exact(3)
                .map(|p| Vec3::new(p[0], p[1], p[2]));
            let welded: Vec<u32> = points
                .map(|point| self.builder.positions.index(point))
                .collect();
            for (range, record) in faces(mesh).zip(&mut records) {
                polygon.clear();
                let first = range.start;
                polygon.extend(range.map(|slot| {
                    let normal = record
                        .has_normals
                        .then(|| vec3(&mesh.normals, mesh.normal_indices[slot]).as_dvec3());
                    Corner {
                        position: welded[mesh.indices[slot] as usize],
                        normal,
                        uv: record.uvs.map(|uvs| {
                            let uv = self.guard.corner_uvs[uvs + slot - first];
                            let transform = self.found.uvs.get(record.material as usize);
                            transform.map_or(uv, |transform| transform.apply(uv))
                        }),
                    }
                }));
                self.add_face(record, &polygon);
            }
        }
        Ok(())
    }

    fn check_finite(&self, models: &[tobj::Model]) -> Result<(), SceneError> {
        let mut faults = Faults::default();
        let mut records = self.guard.faces.iter();
        for model in models {
            let mesh = &model.mesh;
            let all_finite = mesh.positions.iter().all(|value| value.is_finite());
            for (mut range, record) in faces(mesh).zip(&mut records) {
                let first = range.start;
                if all_finite {
                    continue;
                }
                let broken =
                    range.find(|&slot| !vec3(&mesh.positions, mesh.indices[slot]).is_finite());
                let Some(slot) = broken else { continue };
                let problem = FaceProblem::NotFinite {
                    corner: slot - first + 1,
                    position: vec3(&mesh.positions, mesh.indices[slot]).to_string(),
                };
                faults.add(|| self.guard.face_ref(record), problem);
            }
        }
        faults.refuse(self.path)
    }

    fn add_face(&mut self, record: &FaceRecord, polygon: &[Corner]) {
        let (guard, builder) = (self.guard, &mut self.builder);
        let points: Vec<DVec3> = polygon
            .iter()
            .map(|corner| builder.point(corner.position))
            .collect();
        let Some(triangles) =
            polygon::cut(&points, self.options.quads.apex(), self.options.concave)
        else {
            let face = || guard.face_ref(record);
            self.uncut.add(face, FaceProblem::CannotBeCut);
            return;
        };
        let of_all = |_: &MeshBuilder| polygon::normal(&points).try_normalize();
        let group = &guard.groups[record.group as usize];
        let material = (!self.found.materials.is_empty()).then_some(record.material);
        for triangle in triangles {
            let corners = triangle.map(|corner| polygon[corner]);
            builder.add(corners, of_all, group, material, || guard.face_ref(record));
        }
    }
}

/// Index ranges of a model's faces. `tobj` lists no arities where all faces are triangles.
fn faces(mesh: &tobj::Mesh) -> impl Iterator<Item = std::ops::Range<usize>> + '_ {
    let triangles = if mesh.face_arities.is_empty() {
        mesh.indices.len() / 3
    } else {
        0
    };
    let arities = mesh
        .face_arities
        .iter()
        .map(|&arity| arity as usize)
        .chain(std::iter::repeat_n(3, triangles));
    arities.scan(0, |start, arity| {
        let range = *start..*start + arity;
        *start = range.end;
        Some(range)
    })
}

fn vec3(values: &[f32], index: u32) -> Vec3 {
    let start = index as usize * 3;
    Vec3::new(values[start], values[start + 1], values[start + 2])
}
