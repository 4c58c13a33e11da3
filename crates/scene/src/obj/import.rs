//! Welds the faces of a file into a [`Mesh`].

use super::{
    mtl::{self, Found},
    options::ObjOptions,
    polygon,
    statements::{Face, Faults, Statements},
};
use crate::{
    builder::{Corner, MeshBuilder},
    error::{FaceProblem, SceneError, plural},
    mesh::Mesh,
    report::ImportReport,
};
use glam::DVec3;
use std::path::Path;

/// The mesh of the faces of a file.
///
/// # Errors
/// More corners than indices, a corner that is not finite, a face that cannot be cut, or materials
/// that cannot be had.
pub(super) fn import(
    statements: &Statements<'_>,
    options: &ObjOptions,
    path: &Path,
) -> Result<(Mesh, ImportReport), SceneError> {
    let materials = mtl::materials(statements, options, path)?;
    let mut import = Import {
        statements,
        options,
        path,
        found: materials,
        builder: MeshBuilder::default(),
        uncut: Faults::default(),
    };
    import.builder.report = ImportReport {
        file: Some(path.to_owned()),
        faces: statements.faces.len(),
        points: statements.points,
        lines: statements.lines,
        colours_missing: std::mem::take(&mut import.found.colours_missing),
        ..ImportReport::default()
    };
    import.remark_and_check()?;
    import.run()?;
    import.uncut.refuse(path)?;
    Ok(import.builder.finish(import.found.materials))
}

struct Import<'a> {
    statements: &'a Statements<'a>,
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
        let (statements, report) = (self.statements, &mut self.builder.report);
        for text in std::mem::take(&mut self.found.remarks) {
            report.remark(text);
        }
        if statements.normals_unread > 0 {
            let normals = plural(statements.normals_unread, "normal", "normals");
            report.remark(format!("{normals} (vn) passed over: not three numbers"));
        }
        if statements.normals_absent > 0 {
            let faces = plural(statements.normals_absent, "face names", "faces name");
            report.remark(format!("{faces} normals that are not there: flat"));
        }
        if statements.curved > 0 {
            let curved = plural(statements.curved, "curve or surface", "curves and surfaces");
            report.remark(format!(
                "{curved} (curv, surf) passed over: only faces are drawn"
            ));
        }
        let (mut faults, mut harmless) = (Faults::default(), 0);
        for (face, problem) in &statements.uvs_absent {
            let face = &statements.faces[*face];
            let material = self.found.materials.get(face.material as usize);
            if material.is_none_or(|material| material.mask.is_none()) {
                harmless += 1;
                continue;
            }
            faults.add(|| statements.face_ref(face), problem.clone());
        }
        if harmless > 0 {
            let faces = plural(harmless, "face names", "faces name");
            report.remark(format!("{faces} texture coordinates that are not there"));
        }
        faults.refuse(self.path)
    }

    fn run(&mut self) -> Result<(), SceneError> {
        let statements = self.statements;
        // Welded positions, normals and triangles are at most as many as corners.
        if u32::try_from(statements.corners.len()).is_err() {
            return Err(SceneError::TooLarge {
                path: self.path.to_owned(),
            });
        }
        self.check_finite()?;
        for face in &statements.faces {
            let transform = self.found.uvs.get(face.material as usize);
            let corners = statements.corners[face.corners.clone()].iter();
            let polygon = corners.map(|corner| Corner {
                position: self.builder.positions.index(corner.position),
                normal: corner.normal.map(|normal| normal.as_dvec3()),
                uv: corner
                    .uv
                    .map(|uv| transform.map_or(uv, |transform| transform.apply(uv))),
            });
            let polygon: Vec<Corner> = polygon.collect();
            self.add_face(face, &polygon);
        }
        Ok(())
    }

    fn check_finite(&self) -> Result<(), SceneError> {
        let mut faults = Faults::default();
        for face in &self.statements.faces {
            let corners = &self.statements.corners[face.corners.clone()];
            let mut places = (1..).zip(corners.iter().map(|corner| corner.position));
            if let Some((corner, place)) = places.find(|(_, place)| !place.is_finite()) {
                let position = place.to_string();
                let problem = FaceProblem::NotFinite { corner, position };
                faults.add(|| self.statements.face_ref(face), problem);
            }
        }
        faults.refuse(self.path)
    }

    fn add_face(&mut self, face: &Face, polygon: &[Corner]) {
        let (statements, builder) = (self.statements, &mut self.builder);
        let points = polygon.iter().map(|corner| builder.point(corner.position));
        let points: Vec<DVec3> = points.collect();
        let Some(triangles) =
            polygon::cut(&points, self.options.quads.apex(), self.options.concave)
        else {
            let place = || statements.face_ref(face);
            self.uncut.add(place, FaceProblem::CannotBeCut);
            return;
        };
        let of_all = |_: &MeshBuilder| polygon::normal(&points).try_normalize();
        let group = &statements.groups[face.group as usize];
        let material = (!self.found.materials.is_empty()).then_some(face.material);
        for triangle in triangles {
            let corners = triangle.map(|corner| polygon[corner]);
            builder.add(corners, of_all, group, material, || {
                statements.face_ref(face)
            });
        }
    }
}
