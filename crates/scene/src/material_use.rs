//! Extent to which the materials of a mesh file are read.

use serde::{Deserialize, Serialize};

/// Extent to which the materials of a mesh file are read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum MaterialUse {
    /// Nothing is read: files of materials and textures may be missing.
    Ignore,
    /// Only colours and their textures are read, no masks: every surface is opaque. A colour that
    /// cannot be read is a warning in the import report.
    Color,
    /// Colours, their textures and masks are read. A mask that cannot be read is an error.
    #[default]
    All,
    /// Everything that `All` reads. Surfaces of a glTF file whose `alphaMode` is `BLEND` get masks,
    /// too: they are cut out where alpha is below 0.5.
    BlendMask,
}
