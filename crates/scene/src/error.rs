//! Errors of loading a scene, from its name to its triangles.

use std::{borrow::Cow, io, path::PathBuf};
use thiserror::Error;

/// Most faces that an error or a warning about a mesh file lists; further faces are only counted.
pub const FACES_SHOWN: usize = 5;

/// Extents and coordinates of a mesh, in scene units, of which all products that shaders take stay
/// within f32 (docs/precision.md).
pub(crate) const EXTENTS: std::ops::RangeInclusive<f64> = 1e-12..=1e12;

/// Reason why a scene could not be loaded. Its message names the file or scene, and a way to mend
/// the mistake.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A file could not be read.
    #[error("cannot read {}: {reason}", path.display())]
    Read {
        /// Path of the file that could not be read.
        path: PathBuf,
        /// Error of the operating system, or the size limit that the file exceeds.
        #[source]
        reason: io::Error,
    },
    /// A line of an OBJ file could not be understood.
    #[error("{}:{line}: {reason}", path.display())]
    ObjLine {
        /// Path of the OBJ file.
        path: PathBuf,
        /// Number of the line, from 1.
        line: u32,
        /// Text that was found, and text that was expected.
        reason: String,
    },
    /// Faces of an OBJ file cannot be used, for one of the reasons of [`FaceProblem`].
    #[error("{}: {}", path.display(), list_faults(faults, *total))]
    ObjFaces {
        /// Path of the OBJ file.
        path: PathBuf,
        /// First faulty faces, in file order: at most [`FACES_SHOWN`].
        faults: Vec<FaceFault>,
        /// Number of faulty faces in the file.
        total: usize,
    },
    /// A part of a mesh file (for example a material, buffer or node), or a file that the mesh file
    /// names, cannot be used.
    #[error("{}: {place}: {reason}", path.display())]
    Part {
        /// Path of the mesh file.
        path: PathBuf,
        /// Place in the mesh file, such as `node 3`, or path of the file that the mesh file names.
        place: String,
        /// Reason why the part cannot be used, and a way to mend it.
        reason: String,
    },
    /// A group that the caller asked to leave out is not in the OBJ file.
    #[error("{}: there is no group {name:?} to leave out; {}", path.display(), list_groups(groups))]
    NoSuchGroup {
        /// Path of the OBJ file.
        path: PathBuf,
        /// Name of the group that was to be left out.
        name: String,
        /// Names of the groups in the file, in file order.
        groups: Vec<String>,
    },
    /// A mesh file has no triangles.
    #[error(
        "{}: no triangles: the file holds {}, {} and {}",
        path.display(),
        plural(*faces, "face", "faces"),
        plural(*lines, "line", "lines"),
        plural(*points, "point", "points")
    )]
    NoTriangles {
        /// Path of the mesh file.
        path: PathBuf,
        /// Number of faces (triangles and polygons) read, without faces of groups that were left
        /// out.
        faces: usize,
        /// Number of lines in the file: of an OBJ file, `l` records and faces of two corners.
        lines: usize,
        /// Number of points in the file: of an OBJ file, `p` records and faces of one corner.
        points: usize,
    },
    /// A mesh is too large for 32-bit indices.
    #[error("{}: more than {} triangles or vertices", path.display(), u32::MAX)]
    TooLarge {
        /// Path of the OBJ file.
        path: PathBuf,
    },
    /// A mesh is so small, so large or so far from the origin that products of its lengths do not
    /// fit into f32: less than 1e-12 or more than 1e12 scene units.
    #[error(
        "{}: the model is {across:.1e} units across and reaches {farthest:.1e} from the origin, \
         but f32 can only tell right from wrong between {:.0e} and {:.0e}: scale it",
        path.display(), EXTENTS.start(), EXTENTS.end()
    )]
    Extent {
        /// Path of the mesh file.
        path: PathBuf,
        /// Diagonal of the mesh's bounding box, in scene units.
        across: f64,
        /// Largest absolute coordinate of the mesh, in scene units.
        farthest: f64,
    },
    /// A scene file is not valid RON, or its content does not form a scene. Holds all mistakes with
    /// their places, at least one.
    #[cfg(feature = "files")]
    #[error(transparent)]
    SceneFile(skiagraph_located_ron::diagnostics::Diagnostics),
    /// The mesh of a scene file was not found in any of the searched places.
    #[error(
        "the mesh {file:?} of scene {scene:?} was not found; searched\n{}{}put it at {file:?} \
         below a folder that the environment variable SKIAGRAPH_ASSETS names",
        list_places(searched),
        download(source_text.as_deref())
    )]
    MeshNotFound {
        /// Name of the scene, as its scene file gives it.
        scene: String,
        /// Path of the mesh file as the scene file gives it.
        file: String,
        /// Every path that was tried, in order.
        searched: Vec<PathBuf>,
        /// Sentence of the scene file that tells where the mesh can be downloaded; `None` if the
        /// scene file does not have one.
        source_text: Option<String>,
    },
    /// The path of a scene's mesh leads to a folder.
    #[error("the mesh of scene {scene:?}: {} is a folder, expected an .obj file", path.display())]
    MeshIsFolder {
        /// Name of the scene, as its scene file gives it.
        scene: String,
        /// Path of the folder that was found instead of a mesh file.
        path: PathBuf,
    },
    /// The text that should name a scene is neither the name of a scene nor the path of a file.
    #[error(
        "no scene {argument:?}: it is neither the path of a .ron, .obj, .gltf or .glb file, nor \
         the name of a .ron file in {}, nor one of the built-in scenes {}",
        folder.display(), builtin.join(", ")
    )]
    UnknownScene {
        /// Name or path that was given.
        argument: String,
        /// Path of the folder of scene files that was searched.
        folder: PathBuf,
        /// Names of the built-in scenes.
        builtin: Vec<&'static str>,
    },
    /// The scene file of a mesh file was asked for.
    #[error(
        "{argument:?} is a mesh, which has no scene file: name a scene, or the path of a .ron file"
    )]
    NoSceneFile {
        /// Path of the mesh file.
        argument: String,
    },
    /// A number of triangles was given for a scene whose mesh cannot have that number.
    #[error("{argument:?}: {reason}")]
    Size {
        /// Scene and number that were given, such as `city:5`.
        argument: String,
        /// Reason why the scene cannot have that number.
        reason: String,
    },
    /// A mesh file that is loaded as a scene lacks a camera or a light.
    #[error("{}: it holds no camera or no light: give --eye x,y,z --look x,y,z \
        (direction) and --light x,y,z (the direction in which the light travels); --fov DEGREES, \
        --near and --far if the defaults do not suit it", path.display())]
    ObjNeedsView {
        /// Path of the mesh file.
        path: PathBuf,
    },
    /// A view that the caller gave does not form a camera, or a light that the caller gave is not
    /// valid.
    #[error("{}: {reason}", path.display())]
    BadView {
        /// Path of the mesh file that the view or light was given for.
        path: PathBuf,
        /// Reason why the view or light cannot be used.
        reason: String,
    },
}

impl SceneError {
    /// The error of a file that cannot be read.
    #[cfg(feature = "files")]
    pub(crate) fn unread(path: &std::path::Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        |reason| Self::Read { path, reason }
    }
}

/// Place of a face in a mesh file.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("face {number} of group {:?}{}", beginning(group), in_line(*line))]
pub struct FaceRef {
    /// Name of the group that the face is in; `unnamed` for an OBJ group without a name, such as
    /// that of faces before the first `g` or `o`.
    pub group: String,
    /// Number of the face within its group, from 1. A group that begins anew further down in the
    /// file counts from 1 again. In a glTF file it is the number of the triangle within its mesh
    /// primitive.
    pub number: u32,
    /// Line of the face in the file, from 1; 0 for a glTF file.
    pub line: u32,
}

/// Its line, if it has one.
fn in_line(line: u32) -> String {
    match line {
        0 => String::new(),
        line => format!(" (line {line})"),
    }
}

/// Face of a mesh file that cannot be used, with the reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaceFault {
    /// Place of the face in the mesh file.
    pub face: FaceRef,
    /// Reason why the face cannot be used.
    pub problem: FaceProblem,
}

/// Reason why a face cannot be used. The message continues that of [`FaceRef`].
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum FaceProblem {
    /// The face names a vertex that does not exist.
    #[error(
        "names vertex {}, but {}",
        beginning(written), counted(written, *available, ["vertex", "vertices"])
    )]
    NoSuchVertex {
        /// Number of the vertex as written in the face; negative numbers count back from the face.
        written: String,
        /// Number of vertices in the file; for a number that counts back, of vertices above the
        /// face.
        available: usize,
    },
    /// The face names texture coordinates that do not exist, and its material has a mask.
    #[error(
        "names texture coordinates {}, but {}",
        beginning(written), counted(written, *available, ["pair", "pairs"])
    )]
    NoSuchUv {
        /// Number of the texture coordinates as written in the face; negative numbers count back
        /// from the face.
        written: String,
        /// Number of texture coordinate pairs in the file; for a number that counts back, of pairs
        /// above the face.
        available: usize,
    },
    /// The polygon intersects itself, or is concave and has more than 10,000 corners.
    #[error(
        "cannot be cut into triangles, for its outline crosses itself or has more than 10,000 \
         corners: triangulate it where it was made, give --concave fan, or have a scene file say \
         `concave: Fan`"
    )]
    CannotBeCut,
    /// A corner is not written as `v`, `v/vt`, `v//vn` or `v/vt/vn`. Holds the corner as written.
    #[error("has the corner {:?}; expected v, v/vt, v//vn or v/vt/vn", beginning(.0))]
    NotACorner(String),
    /// A corner lies at NaN or infinity.
    #[error("has its corner {corner} at {position}, which is not finite")]
    NotFinite {
        /// Number of the corner within the face, from 1.
        corner: usize,
        /// Coordinates of the corner, as text (NaN equals nothing, not even itself).
        position: String,
    },
}

/// How many there are of what a number names, which may count back from its face.
fn counted(written: &str, available: usize, [one, many]: [&str; 2]) -> String {
    let count = plural(available, one, many);
    match (written.starts_with('-'), available) {
        (true, 1) => format!("{count} stands above it"),
        (true, _) => format!("{count} stand above it"),
        (false, _) => format!("the file has {count}"),
    }
}

/// As much of a word from a file as fits a message; a damaged file may hold one of any length.
pub(crate) fn beginning(text: &str) -> Cow<'_, str> {
    const SHOWN: usize = 60;
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &text[..end]).into(),
        None => text.into(),
    }
}

/// A count with its noun.
pub(crate) fn plural(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

fn download(source: Option<&str>) -> String {
    source.map_or_else(String::new, |source| {
        format!("it can be downloaded: {source}\n")
    })
}

fn list_groups(names: &[String]) -> String {
    const SHOWN: usize = 12;
    if names.is_empty() {
        return "the file has no groups".to_owned();
    }
    let shown = names.iter().take(SHOWN).map(|name| beginning(name));
    let shown: Vec<_> = shown.collect();
    let mut text = format!("the file's groups are {}", shown.join(", "));
    if names.len() > SHOWN {
        text += &format!(", … ({} in all)", names.len());
    }
    text
}

fn list_faults(faults: &[FaceFault], total: usize) -> String {
    let mut text = format!("{} cannot be used", plural(total, "face", "faces"));
    for fault in faults {
        text += &format!("\n  {} {}", fault.face, fault.problem);
    }
    if total > faults.len() {
        text += &format!("\n  and {} more", total - faults.len());
    }
    text
}

fn list_places(places: &[PathBuf]) -> String {
    if places.is_empty() {
        return "  no folder at all (the environment variable SKIAGRAPH_ASSETS is not set)\n"
            .to_owned();
    }
    let line = |place: &PathBuf| format!("  {}\n", place.display());
    places.iter().map(line).collect()
}
