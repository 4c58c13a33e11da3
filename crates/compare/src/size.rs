//! Sizes of viewports in the notation `WIDTHxHEIGHT`.
//!
//! ```
//! use skiagraph_compare::size::Size;
//!
//! let size: Size = "1920x1080".parse()?;
//! assert_eq!(size.0, [1920, 1080]);
//! assert_eq!(size.to_string(), "1920x1080");
//! assert!("1920".parse::<Size>().is_err());
//! # Ok::<(), String>(())
//! ```

use std::{fmt, str::FromStr};

/// Width and height of a viewport in pixels, each at least 1 when parsed; written `WIDTHxHEIGHT`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size(pub [u32; 2]);

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let edges = text.split_once(['x', 'X', '×']);
        let (width, height) = edges.ok_or("expected WIDTHxHEIGHT, for example 1024x1024")?;
        let edge = |text: &str| match text.trim().parse::<u32>() {
            Ok(0) => Err("a viewport must be at least 1x1".to_string()),
            Ok(edge) => Ok(edge),
            Err(_) => Err(format!(
                "`{text}` is not a number of pixels; expected WIDTHxHEIGHT, for example 1024x1024"
            )),
        };
        Ok(Self([edge(width)?, edge(height)?]))
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}x{}", self.0[0], self.0[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_two_numbers_of_pixels() {
        assert_eq!("1920x1080".parse(), Ok(Size([1920, 1080])));
        for wrong in ["1024", "0x4", "x", "-4x4", "4x4x4", "4,4", "99999999999x1"] {
            assert!(wrong.parse::<Size>().is_err(), "{wrong}");
        }
    }
}
