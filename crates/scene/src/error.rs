//! Everything that can go wrong between a scene's name and its triangles.

use std::{borrow::Cow, io, path::PathBuf};
use thiserror::Error;

/// How many faces an error or a warning spells out before it only counts.
pub const FACES_SHOWN: usize = 5;

/// Extents and coordinates of a mesh, in scene units, of which all products that shaders take stay
/// within f32 (docs/precision.md).
pub(crate) const EXTENTS: std::ops::RangeInclusive<f64> = 1e-12..=1e12;

/// Why a scene could not be loaded. Every message names the file and what to do about it.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A file that exists could not be read.
    #[error("cannot read {}: {reason}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Error of the operating system, or the bound that is exceeded.
        reason: io::Error,
    },
    /// A line of an OBJ file could not be understood.
    #[error("{}:{line}: {reason}", path.display())]
    ObjLine {
        /// The OBJ file.
        path: PathBuf,
        /// Line, from 1.
        line: u32,
        /// Found and expected text.
        reason: String,
    },
    /// Faces of an OBJ file that name vertices which do not exist or are not finite.
    #[error("{}: {}", path.display(), list_faults(faults, *total))]
    ObjFaces {
        /// The OBJ file.
        path: PathBuf,
        /// The first faults, in file order.
        faults: Vec<FaceFault>,
        /// Number of faulty faces.
        total: usize,
    },
    /// A part of a mesh file, or a file that it names, that cannot be used.
    #[error("{}: {place}: {reason}", path.display())]
    Part {
        /// The mesh file.
        path: PathBuf,
        /// Where in it, or the file that it names.
        place: String,
        /// Reason, and the way out.
        reason: String,
    },
    /// A group to be left out is not in the OBJ file.
    #[error("{}: there is no group {name:?} to leave out; {}", path.display(), list_groups(groups))]
    NoSuchGroup {
        /// The OBJ file.
        path: PathBuf,
        /// The name asked for.
        name: String,
        /// The names there are.
        groups: Vec<String>,
    },
    /// An OBJ file without a single face.
    #[error(
        "{}: no triangles: the file holds {}, {} and {}",
        path.display(),
        plural(*faces, "face", "faces"),
        plural(*lines, "line", "lines"),
        plural(*points, "point", "points")
    )]
    NoTriangles {
        /// The OBJ file.
        path: PathBuf,
        /// Faces read, those left out not counted.
        faces: usize,
        /// `l` records.
        lines: usize,
        /// `p` records.
        points: usize,
    },
    /// A mesh too large for 32-bit indices.
    #[error("{}: more than {} triangles or vertices", path.display(), u32::MAX)]
    TooLarge {
        /// The OBJ file.
        path: PathBuf,
    },
    /// A mesh whose lengths, multiplied as geometry must, leave the range of f32.
    #[error(
        "{}: the model is {across:.1e} units across and reaches {farthest:.1e} from the origin, \
         but f32 can only tell right from wrong between {:.0e} and {:.0e}: scale it",
        path.display(), EXTENTS.start(), EXTENTS.end()
    )]
    Extent {
        /// The OBJ file.
        path: PathBuf,
        /// Diagonal of its box.
        across: f64,
        /// Largest coordinate.
        farthest: f64,
    },
    /// A scene file is not valid RON, or its content makes no scene: all that is wrong with it,
    /// with places; one mistake at least.
    #[cfg(feature = "files")]
    #[error(transparent)]
    SceneFile(skiagraph_located_ron::diagnostics::Diagnostics),
    /// The mesh of a scene file is in none of the places searched.
    #[error(
        "the mesh {file:?} of scene {scene:?} was not found; searched\n{}{}put it at {file:?} \
         below a folder that the environment variable SKIAGRAPH_ASSETS names",
        list_places(searched),
        download(source_text.as_deref())
    )]
    MeshNotFound {
        /// The scene's name.
        scene: String,
        /// The file as the scene names it.
        file: String,
        /// Every path tried, in order.
        searched: Vec<PathBuf>,
        /// Where the scene file says it can be had.
        source_text: Option<String>,
    },
    /// A mesh's name leads to a folder.
    #[error("the mesh of scene {scene:?}: {} is a folder, expected an .obj file", path.display())]
    MeshIsFolder {
        /// The scene's name.
        scene: String,
        /// The folder.
        path: PathBuf,
    },
    /// No scene of that name, and no file of that path.
    #[error(
        "no scene {argument:?}: it is neither the path of a .ron, .obj, .gltf or .glb file, nor \
         the name of a .ron file in {}, nor one of the built-in scenes {}",
        folder.display(), builtin.join(", ")
    )]
    UnknownScene {
        /// Requested argument.
        argument: String,
        /// The folder of scene files that was searched.
        folder: PathBuf,
        /// Names of the built-in scenes.
        builtin: Vec<&'static str>,
    },
    /// A number of triangles was given for a scene that cannot have it.
    #[error("{argument:?}: {reason}")]
    Size {
        /// Requested argument.
        argument: String,
        /// Why it cannot be had.
        reason: String,
    },
    /// A mesh file without cameras or without lights came without the view and the light that a
    /// scene file would hold.
    #[error("{}: it holds no camera or no light: give --eye x,y,z --look x,y,z \
        (direction) and --light x,y,z (the direction in which the light travels); --fov DEGREES, \
        --near and --far if the defaults do not suit it", path.display())]
    ObjNeedsView {
        /// The file.
        path: PathBuf,
    },
    /// A view was given for a scene that brings its own views.
    #[error(
        "scene {argument:?} has its own views and light: a view and a light (--eye, --look, \
         --light …) can only be given with a mesh file"
    )]
    ViewNotWanted {
        /// Requested argument.
        argument: String,
    },
    /// A view or a light given by the caller makes no camera or no light.
    #[error("{}: {reason}", path.display())]
    BadView {
        /// The OBJ file it was given for.
        path: PathBuf,
        /// Reason.
        reason: String,
    },
}

/// Where a face stands in an OBJ file.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("face {number} of group {:?}{}", beginning(group), in_line(*line))]
pub struct FaceRef {
    /// Name of its group.
    pub group: String,
    /// Number of the face within that run of the group, in file order, from 1.
    pub number: u32,
    /// Line in the file, from 1; 0 in a file that has no lines of faces.
    pub line: u32,
}

/// Its line, if it has one.
fn in_line(line: u32) -> String {
    match line {
        0 => String::new(),
        line => format!(" (line {line})"),
    }
}

/// A face that cannot be used, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaceFault {
    /// The face.
    pub face: FaceRef,
    /// Problem of the face.
    pub problem: FaceProblem,
}

/// Problems of a face.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum FaceProblem {
    /// A vertex number that names nothing.
    #[error(
        "names vertex {}, but {}",
        beginning(written), counted(written, *available, ["vertex", "vertices"])
    )]
    NoSuchVertex {
        /// The number as written.
        written: String,
        /// Vertices of the file; those above the face where the number counts back.
        available: usize,
    },
    /// A number of texture coordinates that names nothing, at a face whose material has a mask.
    #[error(
        "names texture coordinates {}, but {}",
        beginning(written), counted(written, *available, ["pair", "pairs"])
    )]
    NoSuchUv {
        /// The number as written.
        written: String,
        /// Texture coordinates, as of `NoSuchVertex`.
        available: usize,
    },
    /// A polygon that intersects itself, or a concave one of too many corners.
    #[error(
        "cannot be cut into triangles, for its outline crosses itself or has more than 10,000 \
         corners: triangulate it where it was made, give --concave fan, or have a scene file say \
         `concave: Fan`"
    )]
    CannotBeCut,
    /// A corner that is not `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    #[error("has the corner {:?}; expected v, v/vt, v//vn or v/vt/vn", beginning(.0))]
    NotACorner(
        /// The corner as written.
        String,
    ),
    /// A corner at NaN or infinity.
    #[error("has its corner {corner} at {position}, which is not finite")]
    NotFinite {
        /// Corner within the face, from 1.
        corner: usize,
        /// The coordinates read, as text (NaN equals nothing, not even itself).
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
    let shown: Vec<_> = names
        .iter()
        .take(SHOWN)
        .map(|name| beginning(name))
        .collect();
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
    places
        .iter()
        .map(|place| format!("  {}\n", place.display()))
        .collect()
}
