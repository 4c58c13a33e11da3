//! How an OBJ file becomes a mesh.

use crate::{material_use::MaterialUse, pattern::Pattern};
use serde::Deserialize;
use std::collections::BTreeMap;

/// Which diagonal splits a quad, corners counted from the first; larger polygons are fanned from
/// the same corner.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum QuadDiagonal {
    /// (0, 1, 2), (0, 2, 3): what most importers do.
    #[default]
    FirstThird,
    /// (1, 2, 3), (1, 3, 0): reproduces the dissertation's Sponza.
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

/// Treatment of a polygon that the fan from its corner does not fit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Concave {
    /// It is cut as its outline is, and refused where that crosses itself.
    #[default]
    Cut,
    /// It is fanned all the same and gains area, as many importers have it: the dissertation's
    /// Sponza has 231 such quads.
    Fan,
}

/// Parts of an OBJ file's materials that are read.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum ObjMaterials {
    /// Nothing: files of materials and textures need not be there.
    Ignore,
    /// Colours, for pictures. Every surface is opaque, and what cannot be read is a warning.
    Color,
    /// Colours and masks (`map_d`, `d`); masks must be there.
    #[default]
    All,
    /// Nothing but names: these materials get masks that are made here.
    Made(BTreeMap<String, Pattern>),
}

impl From<MaterialUse> for ObjMaterials {
    fn from(of: MaterialUse) -> Self {
        match of {
            MaterialUse::Ignore => Self::Ignore,
            MaterialUse::Color => Self::Color,
            MaterialUse::All => Self::All,
        }
    }
}

/// Options for reading an OBJ file.
#[derive(Clone, Debug, Default)]
pub struct ObjOptions {
    /// Names of groups or objects that are left out (the whole text after `g` or `o`).
    pub leave_out: Vec<String>,
    /// Diagonal that splits a quad.
    pub quads: QuadDiagonal,
    /// Treatment of concave polygons.
    pub concave: Concave,
    /// Parts of the file's materials that are read.
    pub materials: ObjMaterials,
}
