//! Parses the values of single arguments: `1024x768`, `0.1,-1,0`, `K=V`, `visibility@shade=a.png`.
//!
//! The error of a parser is a sentence with the value that was expected; clap puts the argument's
//! name before it.

use clap::{builder::RangedI64ValueParser, value_parser};
use glam::DVec3;
use skiagraph_compare::quantities::direction;

/// Returns the parser of a number of texels along an edge: at least one.
pub fn texels() -> RangedI64ValueParser<u32> {
    value_parser!(u32).range(1..)
}

/// Returns the parser of a number of frames from `least` to 100,000: all samples are kept.
pub fn frames(least: i64) -> RangedI64ValueParser<u32> {
    value_parser!(u32).range(least..=100_000)
}

/// Value of `--light`: a light of the scene, or a sun of the user's own.
#[derive(Clone, Debug, PartialEq)]
pub enum LightArgument {
    /// A light of the scene by its name, or `all`.
    Name(String),
    /// The direction in which the light of a sun travels.
    Direction(DVec3),
}

/// Parses a [`LightArgument`]: text with a comma and numbers are directions.
pub fn light(text: &str) -> Result<LightArgument, String> {
    if text.contains(',') || text.trim().parse::<f64>().is_ok() {
        direction(text).map(LightArgument::Direction)
    } else {
        Ok(LightArgument::Name(text.to_owned()))
    }
}
