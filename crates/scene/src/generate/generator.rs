//! Which meshes can be generated, and how they are named.

use super::{avenue, city, forest, level, park};
use crate::mesh::Mesh;
use std::{fmt, ops::RangeInclusive, str::FromStr};

/// Range of the number of triangles that a generated city or forest ([`Generator`]) can have, both
/// ends included.
pub const TRIANGLES: RangeInclusive<u32> = 10_000..=10_000_000;

/// Mesh that this crate generates. Its name as text is `park`, `avenue`, `level`, `city:100000` or
/// `forest:100000`; the number is the number of triangles. Up is +y, and the ground lies at y = 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Generator {
    /// A bench, flowers, a lamp and trees on a lawn: about 55,000 triangles, in closed parts
    /// ([`Parts`](crate::Parts)).
    Park,
    /// An avenue of 2,000 scene units between fences, trees and lamps: about 50,000 triangles, in
    /// closed parts ([`Parts`](crate::Parts)).
    Avenue,
    /// Storeys of rooms whose floors and walls are sheets of large triangles: 3,168 triangles, in
    /// open parts ([`Parts`](crate::Parts)).
    Level,
    /// Blocks of houses on a square about 1,000 scene units wide. More triangles mean more details
    /// on walls and roofs.
    City {
        /// Approximate number of triangles, within [`TRIANGLES`].
        triangles: u32,
    },
    /// Trees on both sides of a straight lane, on a square 960 scene units wide. The number of
    /// trees and the number of leaves of a tree both grow with the square root of the number of
    /// triangles.
    Forest {
        /// Approximate number of triangles, within [`TRIANGLES`].
        triangles: u32,
    },
}

impl Generator {
    /// Generates the mesh, the same bits on every machine. 10⁷ triangles take seconds and less than
    /// 1 GB of memory. The number of triangles of a city or forest is off by 3 % at most.
    pub fn build(self) -> Mesh {
        match self {
            Self::Park => park::build(),
            Self::Avenue => avenue::build(),
            Self::Level => level::build(),
            Self::City { triangles } => city::build(triangles),
            Self::Forest { triangles } => forest::build(triangles),
        }
    }

    /// Returns this generator with the number of triangles that `text` gives, such as `1000000` or
    /// `1_000_000`.
    ///
    /// # Errors
    /// Message that says that the text is not a number within [`TRIANGLES`], or that the mesh has
    /// only one size.
    pub fn with_triangles(self, text: &str) -> Result<Self, String> {
        let (least, most) = TRIANGLES.into_inner();
        let number = text.replace('_', "").parse().ok();
        let fits = number.filter(|number| TRIANGLES.contains(number));
        let wrong = || format!("{text:?} is not a number of triangles from {least} to {most}");
        let triangles = fits.ok_or_else(wrong)?;
        match self {
            Self::City { .. } => Ok(Self::City { triangles }),
            Self::Forest { .. } => Ok(Self::Forest { triangles }),
            _ => Err(format!("the mesh \"{self}\" has but one size")),
        }
    }
}

impl FromStr for Generator {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let triangles = *TRIANGLES.start();
        match text.split_once(':') {
            None if text == "park" => Ok(Self::Park),
            None if text == "avenue" => Ok(Self::Avenue),
            None if text == "level" => Ok(Self::Level),
            Some(("city", count)) => Self::City { triangles }.with_triangles(count),
            Some(("forest", count)) => Self::Forest { triangles }.with_triangles(count),
            _ => Err(format!(
                "no generated mesh is called {text:?}; there are: park, avenue, \
                 level, city:TRIANGLES, forest:TRIANGLES"
            )),
        }
    }
}

impl fmt::Display for Generator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Park => f.write_str("park"),
            Self::Avenue => f.write_str("avenue"),
            Self::Level => f.write_str("level"),
            Self::City { triangles } => write!(f, "city:{triangles}"),
            Self::Forest { triangles } => write!(f, "forest:{triangles}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_as_they_are_written() {
        for text in ["park", "avenue", "level", "city:10000", "forest:10000000"] {
            assert_eq!(text.parse::<Generator>().unwrap().to_string(), text);
        }
        assert_eq!(
            "city:1_000_000".parse(),
            Ok(Generator::City {
                triangles: 1_000_000
            })
        );
    }

    #[test]
    fn what_is_no_mesh_or_no_size_is_told_what_there_is() {
        let refusal = |text: &str| text.parse::<Generator>().unwrap_err();
        for text in ["", "parc", "city", "village:10000", "park:10000"] {
            assert!(refusal(text).contains("city:TRIANGLES"), "{text}");
        }
        for text in [
            "city:9999",
            "forest:10000001",
            "city:",
            "city:-1",
            "city:1e6",
        ] {
            assert!(refusal(text).ends_with("from 10000 to 10000000"), "{text}");
        }
        assert!(Generator::Park.with_triangles("10000").is_err());
    }
}
