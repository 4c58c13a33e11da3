//! Changes that an import made to a mesh, and content that it left out.

use crate::error::{FACES_SHOWN, FaceRef, plural};
use crate::mesh::Mesh;
use std::{fmt, path::PathBuf};

/// Counts and warnings of the import of a mesh file. The report of a generated mesh is empty.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ImportReport {
    /// Path of the mesh file; `None` for a mesh that is not from a file.
    pub file: Option<PathBuf>,
    /// Number of faces (triangles and larger polygons) read, without those of groups that were left
    /// out.
    pub faces: usize,
    /// Number of points, which are not part of the mesh: of an OBJ file, `p` records and faces of
    /// one corner.
    pub points: usize,
    /// Number of lines, which are not part of the mesh: of an OBJ file, `l` records and faces of
    /// two corners.
    pub lines: usize,
    /// Number of corners whose normal had no direction (zero or not finite) and was replaced by the
    /// geometric normal.
    pub normals_replaced: usize,
    /// Triangles that are not in the mesh because two of their corners are the same point.
    pub dropped: Degenerate,
    /// Triangles that are in the mesh although their area is zero: three different points on a
    /// line.
    pub zero_area: Degenerate,
    /// One message for each colour or texture that could not be read; surfaces are then shown
    /// without it.
    pub colours_missing: Vec<String>,
    /// One sentence for each part of the file that was left out or read in an unexpected way; no
    /// two are equal. Further ones are dropped after 1,000.
    pub remarks: Vec<String>,
}

/// Degenerate triangles of an import: their number, and the faces that they come from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Degenerate {
    /// Number of degenerate triangles, those of the faces in `first` included.
    pub triangles: usize,
    /// First faces with such a triangle, in file order: at most
    /// [`FACES_SHOWN`].
    pub first: Vec<FaceRef>,
}

impl Degenerate {
    pub(crate) fn add(&mut self, face: impl FnOnce() -> FaceRef) {
        self.triangles += 1;
        if self.first.len() < FACES_SHOWN {
            let face = face();
            if self.first.last() != Some(&face) {
                self.first.push(face);
            }
        }
    }

    fn describe(&self, what: &str, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.triangles == 0 {
            return Ok(());
        }
        let mut faces: Vec<String> = self.first.iter().map(FaceRef::to_string).collect();
        if self.triangles > faces.len() {
            faces.push("…".to_owned());
        }
        let triangles = plural(self.triangles, "triangle", "triangles");
        writeln!(f, "{triangles} {what}: {}", faces.join(", "))
    }
}

/// Returns a warning for a mesh of which nothing casts a shadow, with the way out.
pub(crate) fn nothing_casts(mesh: &Mesh) -> Option<&'static str> {
    (mesh.surfaces.have_roles() && mesh.casters().is_empty()).then_some(
        "no part of the mesh casts a shadow, so that everything is lit: let one cast (`shadows` of \
         a scene file, `casts` in the extras of a glTF file)",
    )
}

/// How many remarks are spelt out before they are only counted.
const REMARKS_SHOWN: usize = 12;

impl ImportReport {
    /// Adds a remark, unless it is there. A damaged file may cause any number of them.
    pub(crate) fn remark(&mut self, text: impl Into<String>) {
        const MOST: usize = 1000;
        let text = text.into();
        if self.remarks.len() < MOST && !self.remarks.contains(&text) {
            self.remarks.push(text);
        }
    }

    /// Returns true if the file held anything that a user may want to mend: a degenerate triangle,
    /// a replaced normal, a point or line, a missing colour, or a remark.
    pub fn has_warnings(&self) -> bool {
        !self.to_string().is_empty()
    }
}

/// Writes the warnings, one per line; writes nothing for an import without warnings.
impl fmt::Display for ImportReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.dropped
            .describe("dropped, two corners being the same point", f)?;
        self.zero_area.describe("without area kept", f)?;
        if self.normals_replaced > 0 {
            let normals = plural(self.normals_replaced, "corner normal", "corner normals");
            writeln!(
                f,
                "{normals} without a direction replaced by the triangle's own"
            )?;
        }
        if self.points + self.lines > 0 {
            let points = plural(self.points, "point", "points");
            writeln!(
                f,
                "{points} and {} left out",
                plural(self.lines, "line", "lines")
            )?;
        }
        if let Some(first) = self.colours_missing.first() {
            let materials = plural(self.colours_missing.len(), "material", "materials");
            writeln!(f, "{materials} without colours: {first}")?;
        }
        for remark in self.remarks.iter().take(REMARKS_SHOWN) {
            writeln!(f, "{remark}")?;
        }
        match self.remarks.len().saturating_sub(REMARKS_SHOWN) {
            0 => Ok(()),
            more => writeln!(f, "and {} more", plural(more, "remark", "remarks")),
        }
    }
}
