//! How much is taken of a mesh file's materials.

use serde::Deserialize;

/// How much is taken of a mesh file's materials.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum MaterialUse {
    /// Nothing: files of materials and textures need not be there.
    Ignore,
    /// Colours, for pictures. Every surface is opaque, and what cannot be read is a warning.
    Color,
    /// Colours and masks; masks must be there.
    #[default]
    All,
}
