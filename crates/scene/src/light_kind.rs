//! The lights of a scene: directional, spot and point.

use crate::light::DirectionalLight;
use crate::vector::{Vector, is_default};
use glam::DVec3;
use serde::{Deserialize, Deserializer, Serialize, Serializer, ser::Error};

/// A light of a scene, with the name by which commands and results know it.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(from = "NamedLightText", into = "NamedLightText")]
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

/// A light as scene files write it.
#[derive(Deserialize, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "NamedLight")
)]
#[serde(deny_unknown_fields, rename = "light")]
pub(crate) enum NamedLightText {
    /// A light as far away as the sun.
    Directional {
        name: String,
        /// Direction in which the light travels.
        #[serde(with = "Vector")]
        direction: DVec3,
        /// Diameter as seen from the scene: 0 to less than 90.
        #[serde(default, skip_serializing_if = "is_default")]
        angle_degrees: f64,
    },
    /// A lamp with a cone.
    Spot {
        name: String,
        #[serde(with = "Vector")]
        position: DVec3,
        /// Direction of the cone's axis.
        #[serde(with = "Vector")]
        direction: DVec3,
        /// The whole opening angle: more than 0, less than 180.
        cone_degrees: f64,
        /// Radius of its disc, in the mesh's units.
        #[serde(default, skip_serializing_if = "is_default")]
        radius: f64,
    },
    /// A lamp that shines everywhere.
    Point {
        name: String,
        #[serde(with = "Vector")]
        position: DVec3,
        /// Radius of its ball, in the mesh's units.
        #[serde(default, skip_serializing_if = "is_default")]
        radius: f64,
    },
}

/// Writes and reads the lights of a scene file: each kind has the fields that are listed for it.
macro_rules! texts {
    ($($kind:ident($light:ident): $($field:ident),+;)+) => {
        impl From<Light> for NamedLightText {
            fn from(Light { name, kind }: Light) -> Self {
                match kind {
                    $(LightKind::$kind($light { $($field),+ }) => {
                        Self::$kind { name, $($field),+ }
                    })+
                }
            }
        }

        fn named_kind(text: NamedLightText) -> (String, LightKind) {
            match text {
                $(NamedLightText::$kind { name, $($field),+ } => {
                    (name, $light { $($field),+ }.into())
                })+
            }
        }
    };
}

texts! {
    Directional(DirectionalLight): direction, angle_degrees;
    Spot(SpotLight): position, direction, cone_degrees, radius;
    Point(PointLight): position, radius;
}

impl From<NamedLightText> for Light {
    fn from(text: NamedLightText) -> Self {
        let (name, kind) = named_kind(text);
        Self { name, kind }
    }
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

/// The parameters of a light, as [`LightKind::parameters`] returns them; `None` for each that its
/// kind does not have.
#[derive(Debug, Default)]
pub struct LightParameters<'a> {
    /// Position of the light, world space. A light without one is infinitely far away.
    pub position: Option<&'a mut DVec3>,
    /// Direction in which the light travels, along a cone's axis; world space, of any length but
    /// zero.
    pub direction: Option<&'a mut DVec3>,
    /// Angular diameter as seen from the scene, in degrees.
    pub angle_degrees: Option<&'a mut f64>,
    /// Whole angle of the cone that is lit, in degrees.
    pub cone_degrees: Option<&'a mut f64>,
    /// Radius of the emitter, in scene units.
    pub radius: Option<&'a mut f64>,
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

/// The light of a view in scene files, a sun; the view checks it and says whose it is.
pub(crate) enum OwnLight {}

impl OwnLight {
    pub fn deserialize<'de, D: Deserializer<'de>>(input: D) -> Result<Option<Light>, D::Error> {
        DirectionalLight::deserialize(input).map(|sun| Some(sun.into()))
    }

    pub fn serialize<S: Serializer>(
        light: &Option<Light>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        let sun = light.as_ref().and_then(|light| light.kind.directional());
        let lamp = || S::Error::custom("a scene file has lamps for all views only");
        sun.ok_or_else(lamp)?.serialize(serializer)
    }
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
    /// One light of each kind, without extent. The index of a kind is its number in shaders
    /// (`shaders/shared/light.wgsl`); graphs are planned for these where there is no scene.
    pub const EACH: [Self; 3] = [
        Self::Directional(DirectionalLight::new(DVec3::NEG_Z)),
        Self::Spot(SpotLight {
            position: DVec3::Z,
            direction: DVec3::NEG_Z,
            cone_degrees: 90.0,
            radius: 0.0,
        }),
        Self::Point(PointLight {
            position: DVec3::Z,
            radius: 0.0,
        }),
    ];

    /// Words for the kinds of lights ([`word`](Self::word)), in the order of [`EACH`](Self::EACH).
    pub const WORDS: [&str; Self::EACH.len()] = {
        let mut words = [""; Self::EACH.len()];
        let mut number = 0;
        while number < words.len() {
            words[number] = Self::EACH[number].word();
            number += 1;
        }
        words
    };

    /// Returns the word for this kind in graph documents, messages and results: `directional`,
    /// `spot` or `point`.
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Directional(_) => "directional",
            Self::Spot(_) => "spot",
            Self::Point(_) => "point",
        }
    }

    /// Returns the parameters of the light, to be read or changed without regard to its kind.
    pub fn parameters(&mut self) -> LightParameters<'_> {
        let none = LightParameters::default();
        match self {
            Self::Directional(light) => LightParameters {
                direction: Some(&mut light.direction),
                angle_degrees: Some(&mut light.angle_degrees),
                ..none
            },
            Self::Spot(light) => LightParameters {
                position: Some(&mut light.position),
                direction: Some(&mut light.direction),
                cone_degrees: Some(&mut light.cone_degrees),
                radius: Some(&mut light.radius),
                ..none
            },
            Self::Point(light) => LightParameters {
                position: Some(&mut light.position),
                radius: Some(&mut light.radius),
                ..none
            },
        }
    }

    /// Returns the directional light, or `None` for a light at a position.
    pub fn directional(&self) -> Option<&DirectionalLight> {
        match self {
            Self::Directional(light) => Some(light),
            _ => None,
        }
    }

    /// Returns the radius of a light at a position in scene units, 0 if it has no extent; `None`
    /// for a directional light.
    pub fn radius(mut self) -> Option<f64> {
        self.parameters().radius.copied()
    }

    /// Returns true if the light has an extent, so that its shadows have a penumbra.
    pub fn has_extent(&self) -> bool {
        self.disk().1 > 0.0
    }

    /// Returns the position of a light, world space, or `None` for a directional light.
    pub fn position(mut self) -> Option<DVec3> {
        self.parameters().position.copied()
    }

    /// Returns the direction in which the light travels, along a cone's axis, world space; `None`
    /// for a light that has none.
    pub fn direction(mut self) -> Option<DVec3> {
        self.parameters().direction.copied()
    }

    /// Returns the whole angle of the cone that is lit, in degrees; `None` for a light without a
    /// cone.
    pub fn cone_degrees(mut self) -> Option<f64> {
        self.parameters().cone_degrees.copied()
    }

    /// Returns the disk around the light's centre that stands for its extent: the unit vector that
    /// it lies across, world space (`None` if it faces each receiver), and its radius, 0 without
    /// extent. The radius is in scene units, and for a directional light at distance 1 from the
    /// receiver.
    pub fn disk(&self) -> (Option<DVec3>, f64) {
        match self {
            Self::Directional(light) => {
                let radius = (light.angle_degrees.to_radians() * 0.5).tan();
                (Some(light.to_light()), radius)
            }
            Self::Spot(light) => (Some(light.direction.normalize()), light.radius),
            Self::Point(light) => (None, light.radius),
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

    /// Returns the cosine of the angle between the axis and the edge of the cone; `None` for a
    /// light without a cone.
    pub fn edge_cosine(&self) -> Option<f64> {
        let degrees = self.cone_degrees()?;
        Some((degrees * 0.5).to_radians().cos())
    }

    /// Returns how far a receiver (a shaded surface point) is beyond the cone's edge: the edge's
    /// cosine minus that of the angle between the axis and the direction from the light to the
    /// receiver, more than 0 outside of the cone. `to_light` is the unit vector from the receiver
    /// to the light. Returns `None` for a light without a cone.
    pub fn beyond_cone(&self, to_light: DVec3) -> Option<f64> {
        let axis = self.direction()?.normalize();
        Some(self.edge_cosine()? + axis.dot(to_light))
    }

    /// Checks that the light's parameters are within their ranges: a position of at most 1e18 in
    /// each coordinate, a direction other than 0, a sun's angle of less than 90 degrees and that of
    /// a cone of less than 180, a radius of at least 0.
    ///
    /// # Errors
    /// Sentence with the first mistake.
    pub fn check(mut self) -> Result<(), String> {
        let parameters = self.parameters();
        if let Some(position) = parameters.position
            && (position.is_nan() || position.abs().max_element() > FARTHEST)
        {
            return Err(format!(
                "the light's position {position} must be finite, and no number beyond \
                 {FARTHEST:e}; a light so far away is directional"
            ));
        }
        if let Some(direction) = parameters.direction {
            let sun = DirectionalLight {
                direction: *direction,
                angle_degrees: parameters.angle_degrees.map_or(0.0, |degrees| *degrees),
            };
            sun.check()?;
        }
        if let Some(degrees) = parameters.cone_degrees
            && !(*degrees > 0.0 && *degrees < 180.0)
        {
            return Err(format!(
                "cone_degrees is {degrees}, expected more than 0 and less than 180, the whole \
                 angle at the light"
            ));
        }
        match parameters.radius {
            Some(radius) if !(radius.is_finite() && *radius >= 0.0) => Err(format!(
                "radius is {radius}, expected a length of at least 0"
            )),
            _ => Ok(()),
        }
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
