//! Vectors, turns and defaults in scene files.

use glam::{DQuat, DVec3};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// True of a field's value that is not written.
pub(crate) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

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

    pub fn serialize<S: Serializer>(vector: &DVec3, serializer: S) -> Result<S::Ok, S::Error> {
        // No −0.
        (*vector + 0.0).to_array().serialize(serializer)
    }
}

// A vector of a field that may be left out.
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(inline, with = "Option<Vector>")
)]
pub(crate) enum SomeVector {}

impl SomeVector {
    pub fn deserialize<'de, D: Deserializer<'de>>(input: D) -> Result<Option<DVec3>, D::Error> {
        Vector::deserialize(input).map(Some)
    }

    pub fn serialize<S: Serializer>(
        vector: &Option<DVec3>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        Vector::serialize(&vector.unwrap_or_default(), serializer)
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

    pub fn serialize<S: Serializer>(turn: &DQuat, serializer: S) -> Result<S::Ok, S::Error> {
        turn.to_array().map(|part| part + 0.0).serialize(serializer)
    }
}
