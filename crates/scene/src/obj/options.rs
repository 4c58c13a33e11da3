//! Options for reading an OBJ file.

use crate::{material_use::MaterialUse, pattern::Pattern};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Diagonal that splits a quad of an OBJ file into two triangles. Larger polygons are split into a
/// fan from the diagonal's first corner.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum QuadDiagonal {
    /// From corner 0 to corner 2: triangles (0, 1, 2) and (0, 2, 3). Most importers do this.
    #[default]
    FirstThird,
    /// From corner 1 to corner 3: triangles (1, 2, 3) and (1, 3, 0). This reproduces the Sponza
    /// mesh of the dissertation (docs/methods.md).
    SecondFourth,
}

impl QuadDiagonal {
    /// Corner from which a polygon is fanned.
    pub(super) fn apex(self) -> usize {
        match self {
            Self::FirstThird => 0,
            Self::SecondFourth => 1,
        }
    }
}

/// Treatment of a concave polygon of an OBJ file whose fan of triangles would cover area outside
/// it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Concave {
    /// The polygon is cut into triangles within its outline. A polygon whose outline crosses itself
    /// is an error.
    #[default]
    Cut,
    /// The polygon is split into the fan nevertheless and gains area, as many importers do it. The
    /// Sponza mesh of the dissertation (docs/methods.md) has 231 such quads.
    Fan,
}

/// Parts of an OBJ file's materials that are read.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum ObjMaterials {
    /// Nothing is read: files of materials and textures may be missing.
    Ignore,
    /// Only colours and their textures are read, no masks: every surface is opaque. A colour that
    /// cannot be read is a warning in the import report.
    Color,
    /// Colours, their textures and masks (`map_d`, `d`) are read. A mask that cannot be read is an
    /// error.
    #[default]
    All,
    /// Only the names of materials are read: each material in this table gets a generated mask with
    /// its pattern, and all others are opaque. A name that the file does not use is an error.
    Made(BTreeMap<String, Pattern>),
}

impl From<MaterialUse> for ObjMaterials {
    fn from(material_use: MaterialUse) -> Self {
        match material_use {
            MaterialUse::Ignore => Self::Ignore,
            MaterialUse::Color => Self::Color,
            MaterialUse::All | MaterialUse::BlendMask => Self::All,
        }
    }
}

/// Options for reading an OBJ file.
#[derive(Clone, Debug, Default)]
pub struct ObjOptions {
    /// Names of groups or objects that are left out: the whole text after `g` or `o`. A name that
    /// the file does not have is an error.
    pub leave_out: Vec<String>,
    /// Diagonal that splits a quad into triangles.
    pub quads: QuadDiagonal,
    /// Treatment of concave polygons.
    pub concave: Concave,
    /// Parts of the file's materials that are read.
    pub materials: ObjMaterials,
}
