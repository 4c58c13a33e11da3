//! Vectors and turns in scene files.

use glam::{DQuat, DVec3};
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

// How a scene file writes a turn: the quaternion `(x, y, z, w)`.
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(inline, with = "(f64, f64, f64, f64)")
)]
pub(crate) enum Turn {}

impl Turn {
    /// Reads a quaternion and scales it to length 1; one of length 1 keeps its bits. (0, 0, 0, 0)
    /// is returned as it is, and `Motion::check` refuses it.
    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<DQuat, D::Error> {
        let (x, y, z, w) = <(f64, f64, f64, f64)>::deserialize(deserializer)?;
        let rotation = DQuat::from_xyzw(x, y, z, w);
        if rotation.is_normalized() || rotation.length_squared() == 0.0 {
            return Ok(rotation);
        }
        Ok(rotation.normalize())
    }

    /// For the defaults of fields.
    #[cfg(feature = "schema")]
    pub fn serialize<S: serde::Serializer>(turn: &DQuat, serializer: S) -> Result<S::Ok, S::Error> {
        serde::Serialize::serialize(&turn.to_array(), serializer)
    }
}
