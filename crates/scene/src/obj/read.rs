//! Reading the file, and what is refused of it.

use super::{guard::Guard, import::import, options::ObjOptions};
use crate::border::caught;
use crate::error::{EXTENTS, SceneError};
use crate::limit::Limit;
use crate::mesh::Mesh;
use crate::report::ImportReport;
use crate::text::{lines_text, without_mark};
use std::{collections::HashSet, path::Path};

/// Some twenty million faces. The mesh takes several times as much.
const OBJ_FILE: Limit = Limit {
    of: "an .obj file",
    mib: 2048,
    way_out: "split it, or leave groups out of it",
};

/// Reads an OBJ file into a mesh in which equal positions are one (welded). The report lists
/// changes that the import made and parts that it ignored.
///
/// # Errors
/// [`SceneError`] with file, line, group and face number: an unreadable or damaged file, a face
/// that names missing or non-finite vertices, a polygon that cannot be cut, a mask that cannot be
/// read, a group to be left out that does not exist, a file without triangles.
pub fn load_obj(path: &Path, options: &ObjOptions) -> Result<(Mesh, ImportReport), SceneError> {
    let bytes = OBJ_FILE.read(path).map_err(|reason| SceneError::Read {
        path: path.to_owned(),
        reason,
    })?;
    parse_obj(&bytes, path, options)
}

/// Reads the bytes of an OBJ file into a mesh as [`load_obj`] does. `path` names the file in
/// messages; files of materials are searched beside it.
///
/// # Errors
/// The errors of [`load_obj`], except for errors of reading the file itself.
pub fn parse_obj(
    bytes: &[u8],
    path: &Path,
    options: &ObjOptions,
) -> Result<(Mesh, ImportReport), SceneError> {
    let bytes = without_mark(bytes);
    let text = lines_text(&bytes);
    let mut guard = Guard::new(&text, &options.leave_out, &options.materials);
    let no_materials = |_: &Path| Ok(Default::default());
    let loaded = caught("tobj", || {
        tobj::load_obj_buf(&mut guard, &tobj::LoadOptions::default(), no_materials)
    });
    let loaded = loaded.and_then(|loaded| {
        loaded.map_err(|error| {
            let fatal = guard.fatal.take();
            fatal.unwrap_or_else(|| format!("{error} in {:?}", guard.current_line()))
        })
    });
    let (models, _) = loaded.map_err(|reason| SceneError::ObjLine {
        path: path.to_owned(),
        line: guard.line,
        reason,
    })?;
    if guard.is_empty() && bytes.contains(&0) {
        return Err(SceneError::ObjLine {
            path: path.to_owned(),
            line: 1,
            reason: "not an OBJ file, or damaged: it holds no vertex, but bytes that are not text"
                .to_owned(),
        });
    }
    std::mem::take(&mut guard.faults).refuse(path)?;
    let groups: HashSet<&String> = guard.groups.iter().collect();
    let missing = options.leave_out.iter().find(|name| !groups.contains(name));
    if let Some(name) = missing {
        let groups = guard.groups.into_iter().skip(1).collect();
        return Err(SceneError::NoSuchGroup {
            path: path.to_owned(),
            name: name.clone(),
            groups,
        });
    }
    let (mesh, report) = import(&models, &guard, options, path)?;
    check_read(&mesh, &report, path)?;
    Ok((mesh, report))
}

/// Refuses a file without triangles, and lengths whose products leave f32. A mesh that is one point
/// has none.
pub(crate) fn check_read(
    mesh: &Mesh,
    report: &ImportReport,
    path: &Path,
) -> Result<(), SceneError> {
    let Some((low, high)) = mesh.bounds().filter(|_| !mesh.triangles.is_empty()) else {
        return Err(SceneError::NoTriangles {
            path: path.to_owned(),
            faces: report.faces,
            lines: report.lines,
            points: report.points,
        });
    };
    let across = low.as_dvec3().distance(high.as_dvec3());
    let farthest = f64::from(low.abs().max(high.abs()).max_element());
    let too_far = across.max(farthest) > *EXTENTS.end();
    if too_far || (across > 0.0 && across < *EXTENTS.start()) {
        return Err(SceneError::Extent {
            path: path.to_owned(),
            across,
            farthest,
        });
    }
    Ok(())
}
