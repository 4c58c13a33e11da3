//! Welds what `tobj` read into a [`Mesh`].

use super::{
    guard::{FaceRecord, Guard},
    options::ObjOptions,
};
use crate::{
    error::{FACES_SHOWN, FaceFault, FaceProblem, SceneError},
    mesh::{Group, Mesh},
    report::ImportReport,
    weld::Welder,
};
use glam::{DVec3, Vec3};
use std::path::Path;

/// The mesh of the models that `tobj` read through `guard`.
///
/// # Errors
/// More corners than indices, or a corner that is not finite.
pub(super) fn import(
    models: &[tobj::Model],
    guard: &Guard<'_>,
    options: &ObjOptions,
    path: &Path,
) -> Result<(Mesh, ImportReport), SceneError> {
    let report = ImportReport {
        file: Some(path.to_owned()),
        faces: guard.faces.len(),
        faces_left_out: guard.faces_left_out,
        points: guard.points,
        lines: guard.lines,
        ..ImportReport::default()
    };
    let mut import = Import {
        guard,
        options,
        path,
        mesh: Mesh::default(),
        report,
    };
    import.run(models)?;
    Ok((import.mesh, import.report))
}

struct Import<'a> {
    guard: &'a Guard<'a>,
    options: &'a ObjOptions,
    path: &'a Path,
    mesh: Mesh,
    report: ImportReport,
}

/// A corner of a polygon: welded position, and the normal that the file gives it.
#[derive(Clone, Copy)]
struct Corner {
    position: u32,
    normal: Option<DVec3>,
}

impl Import<'_> {
    fn run(&mut self, models: &[tobj::Model]) -> Result<(), SceneError> {
        let corner_count: usize = models.iter().map(|model| model.mesh.indices.len()).sum();
        // Welded positions, normals and triangles are at most as many as corners.
        if u32::try_from(corner_count).is_err() {
            return Err(SceneError::TooLarge {
                path: self.path.to_owned(),
            });
        }
        self.check_finite(models)?;
        let mut positions = Welder::default();
        let mut normals = Welder::default();
        let mut read = 0;
        let mut records = self.guard.faces.iter();
        let mut polygon = Vec::new();
        for model in models {
            let mesh = &model.mesh;
            let points = mesh
                .positions
                .chunks_exact(3)
                .map(|p| Vec3::new(p[0], p[1], p[2]));
            let welded: Vec<u32> = points.map(|point| positions.index(point)).collect();
            read += welded.len();
            for (range, record) in faces(mesh).zip(&mut records) {
                polygon.clear();
                polygon.extend(range.map(|slot| {
                    let normal = record
                        .has_normals
                        .then(|| vec3(&mesh.normals, mesh.normal_indices[slot]).as_dvec3());
                    Corner {
                        position: welded[mesh.indices[slot] as usize],
                        normal,
                    }
                }));
                self.add_face(record, &polygon, &positions.values, &mut normals);
            }
        }
        self.report.vertices_welded = read - positions.values.len();
        self.mesh.positions = positions.values;
        self.mesh.normals = normals.values;
        Ok(())
    }

    fn check_finite(&self, models: &[tobj::Model]) -> Result<(), SceneError> {
        let mut faults = Vec::new();
        let mut total = 0;
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
                total += 1;
                if faults.len() < FACES_SHOWN {
                    let position = vec3(&mesh.positions, mesh.indices[slot]).to_string();
                    let problem = FaceProblem::NotFinite {
                        corner: slot - first + 1,
                        position,
                    };
                    faults.push(FaceFault {
                        face: self.guard.face_ref(record),
                        problem,
                    });
                }
            }
        }
        if total == 0 {
            Ok(())
        } else {
            Err(SceneError::ObjFaces {
                path: self.path.to_owned(),
                faults,
                total,
            })
        }
    }

    fn add_face(
        &mut self,
        record: &FaceRecord,
        polygon: &[Corner],
        positions: &[Vec3],
        normals: &mut Welder,
    ) {
        if !record.has_normals {
            self.report.faces_without_normals += 1;
        }
        let count = polygon.len();
        let apex = self.options.quads.apex();
        for step in 1..count - 1 {
            let corners = [
                polygon[apex],
                polygon[(apex + step) % count],
                polygon[(apex + step + 1) % count],
            ];
            let indices = corners.map(|corner| corner.position);
            if indices[0] == indices[1] || indices[1] == indices[2] || indices[2] == indices[0] {
                self.report.dropped.add(|| self.guard.face_ref(record));
                continue;
            }
            let points = indices.map(|index| positions[index as usize].as_dvec3());
            if has_no_area(points) {
                self.report.zero_area.add(|| self.guard.face_ref(record));
            }
            let own = || {
                geometric_normal(points)
                    .or_else(|| newell(polygon, positions))
                    .unwrap_or(DVec3::Y)
            };
            let normal_indices = corners.map(|corner| {
                let given = corner.normal.map(DVec3::try_normalize);
                if given == Some(None) {
                    self.report.normals_replaced += 1;
                }
                normals.index(given.flatten().unwrap_or_else(own).as_vec3())
            });
            self.push(record.group, indices, normal_indices);
        }
    }

    fn push(&mut self, group: u32, indices: [u32; 3], normal_indices: [u32; 3]) {
        let primitive = self.mesh.triangles.len() as u32;
        self.mesh.triangles.push(indices);
        self.mesh.normal_indices.push(normal_indices);
        let name = &self.guard.groups[group as usize];
        match self.mesh.groups.last_mut() {
            Some(last) if last.name == *name => last.triangles.end = primitive + 1,
            _ => self.mesh.groups.push(Group {
                name: name.clone(),
                triangles: primitive..primitive + 1,
            }),
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

/// Whether the corners lie on a line. Differences of `f32` corners are exact in `f64` (unless their
/// exponents lie more than 29 apart); the products are compared with their rounding errors, so that
/// no tiny area is taken for none.
fn has_no_area([a, b, c]: [DVec3; 3]) -> bool {
    let (u, v) = (b - a, c - a);
    let equal = |p: f64, q: f64, r: f64, s: f64| {
        let (left, right) = (p * q, r * s);
        left == right && p.mul_add(q, -left) == r.mul_add(s, -right)
    };
    equal(u.y, v.z, u.z, v.y) && equal(u.z, v.x, u.x, v.z) && equal(u.x, v.y, u.y, v.x)
}

fn geometric_normal([a, b, c]: [DVec3; 3]) -> Option<DVec3> {
    (b - a).cross(c - a).try_normalize()
}

/// Normal of a whole polygon: the sum over its edges (Newell's method).
fn newell(polygon: &[Corner], positions: &[Vec3]) -> Option<DVec3> {
    let point =
        |index: usize| positions[polygon[index % polygon.len()].position as usize].as_dvec3();
    let origin = point(0);
    (0..polygon.len())
        .map(|i| (point(i) - origin).cross(point(i + 1) - origin))
        .sum::<DVec3>()
        .try_normalize()
}
