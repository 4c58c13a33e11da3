//! Welds what `tobj` read into a [`Mesh`].

use super::guard::{FaceRecord, Faults, Guard};
use super::mtl::{self, Found};
use super::options::ObjOptions;
use super::polygon;
use crate::builder::{Corner, MeshBuilder};
use crate::error::{FaceProblem, SceneError, plural};
use crate::mesh::Mesh;
use crate::report::ImportReport;
use glam::{DVec3, Vec3};
use smallvec::SmallVec;
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
        let mut remark = |count: usize, one: &str, many: &str, text: &str| {
            if count > 0 {
                report.remark(format!("{} {text}", plural(count, one, many)));
            }
        };
        let unread = "(vn) passed over: not three numbers";
        remark(guard.normals_unread, "normal", "normals", unread);
        let flat = "normals that are not there: flat";
        remark(guard.normals_absent, "face names", "faces name", flat);
        let curved = "(curv, surf) passed over: only faces are drawn";
        remark(
            guard.curved,
            "curve or surface",
            "curves and surfaces",
            curved,
        );
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
        let white = "texture coordinates that are not there";
        remark(harmless, "face names", "faces name", white);
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
            let (points, positions) = (
                mesh.positions.as_chunks::<3>().0,
                &mut self.builder.positions,
            );
            let welded = points
                .iter()
                .map(|point| positions.index(Vec3::from(*point)));
            let welded: Vec<u32> = welded.collect();
            self.builder.shared_normals.clear();
            self.builder
                .shared_normals
                .resize(mesh.normals.len() / 3, None);
            for (range, record) in faces(mesh).zip(&mut records) {
                polygon.clear();
                let first = range.start;
                polygon.extend(range.map(|slot| {
                    let normal = record.has_normals.then(|| mesh.normal_indices[slot]);
                    Corner {
                        position: welded[mesh.indices[slot] as usize],
                        normal: normal.map(|index| vec3(&mesh.normals, index).as_dvec3()),
                        slot: normal,
                        uv: record.uvs.map(|uvs| {
                            let uv = self.guard.corner_uvs[uvs as usize + slot - first];
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
        let mut values = models.iter().flat_map(|model| &model.mesh.positions);
        if values.all(|value| value.is_finite()) {
            return Ok(());
        }
        let mut faults = Faults::default();
        let mut records = self.guard.faces.iter();
        for model in models {
            let mesh = &model.mesh;
            for (mut range, record) in faces(mesh).zip(&mut records) {
                let first = range.start;
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
        let points = polygon.iter().map(|corner| builder.point(corner.position));
        let points: SmallVec<[DVec3; 4]> = points.collect();
        let (apex, concave) = (self.options.quads.apex(), self.options.concave);
        let Some(triangles) = polygon::cut(&points, apex, concave) else {
            self.uncut
                .add(|| guard.face_ref(record), FaceProblem::CannotBeCut);
            return;
        };
        let of_all = || polygon::normal(&points).try_normalize();
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
    let (mut range, mut arities) = (0..0, mesh.face_arities.iter());
    std::iter::from_fn(move || {
        let arity = arities.next().map_or(3, |arity| *arity as usize);
        range = range.end..range.end + arity;
        (range.end <= mesh.indices.len()).then(|| range.clone())
    })
}

fn vec3(values: &[f32], index: u32) -> Vec3 {
    Vec3::from_slice(&values[index as usize * 3..])
}
