//! Wavefront OBJ files, read by `tobj` behind a guard and welded into a [`Mesh`](crate::Mesh).
//!
//! Conventions: `o` and `g` both begin a group; a polygon is fanned from the corner that
//! [`QuadDiagonal`] names, one that does not fit its fan is cut by ears; a face without a normal at
//! every corner is *flat*: each of its triangles takes its own geometric normal. (A smooth guess
//! would tilt the corners of boxes, and which pixels face the light is decided by these normals.)
//! Vertex numbers count from the beginning of the file, wherever the face stands; negative ones
//! count back from it. Lines that are not UTF-8 are read as Windows-1252. Ignored parts stand in
//! the report.

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
