//! The lights of a scene: directional, spot and point.

use crate::light::DirectionalLight;
use glam::DVec3;
use serde::{Deserialize, Deserializer};

/// A light of a scene, with the name by which commands and results know it.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Deserialize))]
#[cfg_attr(feature = "files", serde(from = "crate::scene_file::NamedLightText"))]
pub struct Light {
    /// Name of small letters, digits and `_`, unique within its scene. It begins with a letter and
    /// is not `all`.
    pub name: String,
    /// Kind of the light, with its direction or position.
    pub kind: LightKind,
}

/// Kind of a light, with its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// Light that is infinitely far away.
    Directional(DirectionalLight),
    /// Lamp at a position that lights a cone.
    Spot(SpotLight),
    /// Bulb at a position that lights every direction.
    Point(PointLight),
}

/// Light at a position that lights a cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotLight {
    /// Apex of the cone, world space.
    pub position: DVec3,
    /// Axis of the cone, world space, pointing away from the light, of any length but zero.
    pub direction: DVec3,
    /// Whole angle of the cone at its apex, in degrees: more than 0 and less than 180.
    pub cone_degrees: f64,
    /// Radius of the emitting disk, which faces along the axis, in scene units; 0 for a light
    /// without extent, whose shadows are hard.
    pub radius: f64,
}

/// Light at a position that lights every direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// Position of the light, world space.
    pub position: DVec3,
    /// Radius of the emitting sphere, in scene units; 0 for a light without extent, whose shadows
    /// are hard.
    pub radius: f64,
}

/// Direction and distance from a point to a light, as [`LightKind::towards`] returns them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Towards {
    /// Unit vector to the light, world space; zero for a point at the light's position.
    pub direction: DVec3,
    /// Distance to the light, in scene units; infinite for a directional light.
    pub distance: f64,
}

/// Name that a scene's light gets if the scene file has the field `light`, for a single light,
/// instead of the list `lights`.
pub const ONLY_LIGHT: &str = "light";

/// A positional light farther from the origin is as good as directional, and f32 cannot square the
/// distance.
const FARTHEST: f64 = 1e18;

/// Fraction of the distance from a receiver (a shaded point) to a spot or point light by which a
/// shadow ray ends before the light. A surface that contains the light's position thus casts no
/// shadow, instead of being decided by rounding.
pub const LIGHT_GAP: f64 = 1.0 / 65536.0;

/// The light of a view, which checks it and says whose it is.
pub(crate) fn own_light<'de, D: Deserializer<'de>>(input: D) -> Result<Option<Light>, D::Error> {
    DirectionalLight::deserialize(input).map(|sun| Some(sun.into()))
}

impl Light {
    /// Creates the only light of a scene, with the name [`ONLY_LIGHT`].
    pub fn only(kind: impl Into<LightKind>) -> Self {
        Self {
            name: ONLY_LIGHT.to_owned(),
            kind: kind.into(),
        }
    }

    /// Checks that the light's name and parameters can be used: the name has the form that
    /// [`name`](Self::name) describes, and [`LightKind::check`] passes.
    ///
    /// # Errors
    /// Sentence with the first mistake.
    pub fn check(&self) -> Result<(), String> {
        let starts = |c: char| c.is_ascii_lowercase();
        let goes_on = |c: char| starts(c) || c.is_ascii_digit() || c == '_';
        if !(self.name.starts_with(starts) && self.name.chars().all(goes_on)) {
            return Err(format!(
                "a light is called {:?}; expected small letters, digits and `_`, a letter first",
                self.name
            ));
        }
        if self.name == "all" {
            return Err("a light is called \"all\", which means all lights".to_owned());
        }
        let named = |reason| match self.name.as_str() {
            ONLY_LIGHT => reason,
            name => format!("light {name:?}: {reason}"),
        };
        self.kind.check().map_err(named)
    }
}

impl LightKind {
    /// Returns the word for this kind in graph documents, messages and results: `directional`,
    /// `spot` or `point`.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Directional(_) => "directional",
            Self::Spot(_) => "spot",
            Self::Point(_) => "point",
        }
    }

    /// Returns the directional light, or `None` for a spot or point light.
    pub fn directional(&self) -> Option<&DirectionalLight> {
        match self {
            Self::Directional(light) => Some(light),
            Self::Spot(_) | Self::Point(_) => None,
        }
    }

    /// Returns the radius of a spot or point light in scene units, 0 if it has no extent; `None`
    /// for a directional light.
    pub fn radius(&self) -> Option<f64> {
        match self {
            Self::Directional(_) => None,
            Self::Spot(SpotLight { radius, .. }) | Self::Point(PointLight { radius, .. }) => {
                Some(*radius)
            }
        }
    }

    /// Returns true if the light has an extent, so that its shadows have a penumbra.
    pub fn has_extent(&self) -> bool {
        match self {
            Self::Directional(light) => light.has_extent(),
            _ => self.radius().is_some_and(|radius| radius > 0.0),
        }
    }

    /// Returns the position of a spot or point light, world space, or `None` for a directional
    /// light.
    pub fn position(&self) -> Option<DVec3> {
        match self {
            Self::Directional(_) => None,
            Self::Spot(SpotLight { position, .. }) | Self::Point(PointLight { position, .. }) => {
                Some(*position)
            }
        }
    }

    /// Returns the direction and distance from `point`, world space, to the light.
    pub fn towards(&self, point: DVec3) -> Towards {
        match (self, self.position()) {
            (Self::Directional(light), _) => Towards {
                direction: light.to_light(),
                distance: f64::INFINITY,
            },
            (_, position) => {
                let way = position.unwrap_or(point) - point;
                Towards {
                    direction: way.normalize_or_zero(),
                    distance: way.length(),
                }
            }
        }
    }

    /// Checks that the light's parameters are within their ranges: a position of at most 1e18 in
    /// each coordinate, a direction other than 0, a sun's angle of less than 90 degrees and that of
    /// a cone of less than 180, a radius of at least 0.
    ///
    /// # Errors
    /// Sentence with the first mistake.
    pub fn check(&self) -> Result<(), String> {
        if let Some(position) = self.position()
            && (position.is_nan() || position.abs().max_element() > FARTHEST)
        {
            return Err(format!(
                "the light's position {position} must be finite, and no number beyond \
                 {FARTHEST:e}; a light so far away is directional"
            ));
        }
        match self {
            Self::Directional(light) => light.check(),
            Self::Spot(spot) => {
                let direction = spot.direction;
                DirectionalLight::new(direction).check()?;
                if !(spot.cone_degrees > 0.0 && spot.cone_degrees < 180.0) {
                    return Err(format!(
                        "cone_degrees is {}, expected more than 0 and less than 180, the whole \
                         angle at the light",
                        spot.cone_degrees
                    ));
                }
                check_radius(spot.radius)
            }
            Self::Point(point) => check_radius(point.radius),
        }
    }
}

fn check_radius(radius: f64) -> Result<(), String> {
    if radius.is_finite() && radius >= 0.0 {
        Ok(())
    } else {
        Err(format!(
            "radius is {radius}, expected a length of at least 0"
        ))
    }
}

impl SpotLight {
    /// Returns the cosine of the angle between the axis and the edge of the cone.
    pub fn edge_cosine(&self) -> f64 {
        (self.cone_degrees * 0.5).to_radians().cos()
    }

    /// Returns the cosine of the angle between the cone's axis and the direction from the light to
    /// a receiver (a shaded surface point). `to_light` is the unit vector from the receiver to the
    /// light. Within the cone, the result is at least [`edge_cosine`](Self::edge_cosine).
    pub fn axis_cosine(&self, to_light: DVec3) -> f64 {
        -self.direction.normalize().dot(to_light)
    }
}

impl From<DirectionalLight> for LightKind {
    fn from(light: DirectionalLight) -> Self {
        Self::Directional(light)
    }
}

impl From<SpotLight> for LightKind {
    fn from(light: SpotLight) -> Self {
        Self::Spot(light)
    }
}

impl From<PointLight> for LightKind {
    fn from(light: PointLight) -> Self {
        Self::Point(light)
    }
}

impl<L: Copy + Into<LightKind>> From<&L> for LightKind {
    fn from(light: &L) -> Self {
        (*light).into()
    }
}

impl From<&Light> for LightKind {
    fn from(light: &Light) -> Self {
        light.kind
    }
}

impl<L: Into<LightKind>> From<L> for Light {
    fn from(kind: L) -> Self {
        Self::only(kind)
    }
}
