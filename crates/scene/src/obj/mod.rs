//! Wavefront OBJ files, read by `tobj` behind a guard and welded into a [`Mesh`](crate::Mesh).
//!
//! Conventions: `o` and `g` both begin a group; faces before the first are in the group `unnamed`.
//! A polygon is split into a fan of triangles from the corner that [`QuadDiagonal`] names; a
//! polygon that this fan would not cover exactly is cut by ear clipping. A face without a normal at
//! every corner is *flat*: each of its triangles takes its own geometric normal. (A smooth guess
//! would tilt the corners of boxes, and these normals decide which pixels face the light.) Positive
//! vertex numbers count from the beginning of the file, even if the face precedes the vertex;
//! negative numbers count back from the face. Lines that are not UTF-8 are read as Windows-1252.
//! The import report lists ignored parts.

mod guard;
mod import;
mod mtl;
mod mtl_file;
pub(crate) mod options;
mod polygon;
pub(crate) mod read;
mod texture_statement;

pub use options::{Concave, ObjMaterials, ObjOptions, QuadDiagonal};
pub use read::{load_obj, parse_obj};
