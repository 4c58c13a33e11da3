//! Vectors in scene files.

use glam::DVec3;
use serde::{Deserialize, Deserializer};

// How a scene file writes a vector: `(x, y, z)`.
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(inline, with = "(f64, f64, f64)")
)]
pub(crate) enum Vector {}

impl Vector {
    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<DVec3, D::Error> {
        <(f64, f64, f64)>::deserialize(deserializer).map(DVec3::from)
    }

    /// For the defaults of fields.
    #[cfg(feature = "schema")]
    pub fn serialize<S: serde::Serializer>(
        vector: &DVec3,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        serde::Serialize::serialize(&vector.to_array(), serializer)
    }

    /// One that is written, of a field that may be left out.
    pub fn some<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<DVec3>, D::Error> {
        Self::deserialize(deserializer).map(Some)
    }
}
