//! The small languages of single arguments: `1024x768`, `0.1,-1,0`, `K=V`,
//! `visibility@shade=a.png`.
//!
//! Every parser returns a sentence that says what it expected; clap puts the argument's name before
//! it.

use clap::{builder::RangedI64ValueParser, value_parser};
use glam::DVec3;
use std::{fmt, path::PathBuf, str::FromStr};

/// A viewport, `WIDTHxHEIGHT` in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size(pub [u32; 2]);

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (width, height) = text
            .split_once(['x', 'X', '×'])
            .ok_or("expected WIDTHxHEIGHT, for example 1024x1024")?;
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

/// A number of texels along an edge: at least one.
pub fn texels() -> RangedI64ValueParser<u32> {
    value_parser!(u32).range(1..)
}

/// Parses a number of frames: the samples of all are kept for the percentiles, hence the limit.
pub fn frames(least: i64) -> RangedI64ValueParser<u32> {
    value_parser!(u32).range(least..=100_000)
}

/// A list without repeats, in its own order.
pub fn unique<T: Clone + PartialEq>(list: &[T]) -> Vec<T> {
    let mut kept = Vec::new();
    for item in list {
        if !kept.contains(item) {
            kept.push(item.clone());
        }
    }
    kept
}

/// A position or direction, `x,y,z`, finite.
pub fn vector(text: &str) -> Result<DVec3, String> {
    let expected = "expected three numbers x,y,z, for example 0.3,-1,0.2";
    let numbers = text
        .split(',')
        .map(|number| {
            number
                .trim()
                .parse::<f64>()
                .map_err(|_| format!("`{number}` is not a number; {expected}"))
        })
        .collect::<Result<Vec<_>, _>>()?;
    let [x, y, z] = numbers[..] else {
        return Err(format!("{} numbers; {expected}", numbers.len()));
    };
    let vector = DVec3::new(x, y, z);
    if vector.is_finite() {
        Ok(vector)
    } else {
        Err("all three numbers must be finite".into())
    }
}

/// A direction: like [`vector`], but not zero.
pub fn direction(text: &str) -> Result<DVec3, String> {
    match vector(text)? {
        DVec3::ZERO => Err("a direction must not be 0,0,0".into()),
        direction => Ok(direction),
    }
}

/// Which light, or one of one's own.
#[derive(Clone, Debug, PartialEq)]
pub enum LightArgument {
    /// A light of the scene by its name, or `all`.
    Name(String),
    /// The direction in which a light travels.
    Direction(DVec3),
}

/// A [`LightArgument`]: three numbers are a direction.
pub fn light(text: &str) -> Result<LightArgument, String> {
    if text.contains(',') || text.trim().parse::<f64>().is_ok() {
        direction(text).map(LightArgument::Direction)
    } else {
        Ok(LightArgument::Name(text.to_owned()))
    }
}

/// A number of bytes, `1536`, `512MiB`, `2.5 GiB`; MB and GB are powers of ten.
pub fn bytes(text: &str) -> Result<u64, String> {
    let text = text.trim();
    let split = text.find(|c: char| c.is_ascii_alphabetic());
    let (number, unit) = text.split_at(split.unwrap_or(text.len()));
    let unit = match unit.to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "kib" => 1024.0,
        "mib" => 1_048_576.0,
        "gib" => 1_073_741_824.0,
        "tib" => 1_099_511_627_776.0,
        "kb" => 1e3,
        "mb" => 1e6,
        "gb" => 1e9,
        "tb" => 1e12,
        _ => {
            return Err(format!(
                "unknown unit `{unit}`; expected B, KiB, MiB, GiB or TiB"
            ));
        }
    };
    match number.trim().parse::<f64>() {
        Ok(number) if number.is_finite() && number >= 0.0 => Ok((number * unit) as u64),
        _ => Err("expected a number of bytes, for example 512MiB or 2GiB".into()),
    }
}

/// A finite number above zero.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() && number > 0.0 => Ok(number),
        Ok(_) => Err("must be above 0".into()),
        Err(_) => Err("expected a number".into()),
    }
}

/// A vertical field of view in degrees, between 0 and 180.
pub fn degrees(text: &str) -> Result<f64, String> {
    match positive(text)? {
        angle if angle < 180.0 => Ok(angle),
        _ => Err("a field of view must be below 180 degrees".into()),
    }
}

/// `--set NAME=VALUE`; the value is read by the graph that has the param.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Assignment {
    /// The param.
    pub name: String,
    /// Its value as written.
    pub value: String,
}

impl FromStr for Assignment {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once('=') {
            Some((name, value)) if !name.trim().is_empty() => Ok(Self {
                name: name.trim().into(),
                value: value.trim().into(),
            }),
            _ => Err("expected NAME=VALUE, for example slope_bias=2".into()),
        }
    }
}

/// Encodings of a saved file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// A picture fit for looking at.
    Png,
    /// The texels or items as they are in memory, rows tightly packed.
    Raw,
    /// A line per item of a buffer.
    Csv,
}

/// `--save MATERIAL[@PASS]=FILE.png|.bin|.csv`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Save {
    /// An output or a material of the graph.
    pub material: String,
    /// The pass after which it is read; `None`: at the end of the frame.
    pub after: Option<String>,
    /// Where to.
    pub file: PathBuf,
    /// From the file's extension.
    pub encoding: Encoding,
}

impl FromStr for Save {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = "expected MATERIAL=FILE.png or MATERIAL@PASS=FILE.bin, for example \
            visibility=shadow.png";
        let (what, file) = text.split_once('=').ok_or(expected)?;
        let (material, after) = match what.split_once('@') {
            Some((material, pass)) => (material, Some(pass.to_string())),
            None => (what, None),
        };
        if material.is_empty() || after.as_deref() == Some("") || file.is_empty() {
            return Err(expected.into());
        }
        let file = PathBuf::from(file);
        let extension = file.extension().unwrap_or_default().to_ascii_lowercase();
        let encoding = match extension.to_str() {
            Some("png") => Encoding::Png,
            Some("bin") => Encoding::Raw,
            Some("csv") => Encoding::Csv,
            _ => {
                return Err(format!(
                    "`{}` must end in .png (a picture), .bin (raw bytes) or .csv (the items of a \
                     buffer)",
                    file.display()
                ));
            }
        };
        Ok(Self {
            material: material.into(),
            after,
            file,
            encoding,
        })
    }
}

/// `--beside [LABEL:]FILE.csv`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PublishedFile {
    /// How the figures are marked in tables. Without one: the file's name.
    pub label: String,
    /// The file.
    pub file: PathBuf,
}

impl FromStr for PublishedFile {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (label, file) = match text.split_once(':') {
            Some((label, file)) if !label.contains(['/', '\\']) => (Some(label), file),
            _ => (None, text),
        };
        let path = PathBuf::from(file);
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let label = label.unwrap_or(&stem).trim().to_owned();
        if label.is_empty() || file.is_empty() {
            return Err("expected LABEL:FILE.csv, for example D:published.csv".into());
        }
        Ok(Self { label, file: path })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_have_units() {
        for (text, number) in [
            ("7", 7),
            ("1.5 KiB", 1536),
            ("2GiB", 2 << 30),
            ("3mb", 3_000_000),
        ] {
            assert_eq!(bytes(text), Ok(number), "{text}");
        }
        for text in ["", "GiB", "-1", "nan", "1e", "2 gigs", "inf"] {
            assert!(bytes(text).is_err(), "{text}");
        }
    }

    #[test]
    fn sizes_are_two_numbers_of_pixels() {
        assert_eq!("1920x1080".parse(), Ok(Size([1920, 1080])));
        for wrong in ["1024", "0x4", "x", "-4x4", "4x4x4", "4,4", "99999999999x1"] {
            assert!(wrong.parse::<Size>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn vectors_may_be_negative_but_not_infinite() {
        assert_eq!(vector("-1,2.5,-3e2"), Ok(DVec3::new(-1.0, 2.5, -300.0)));
        for wrong in ["1,2", "1,2,3,4", "a,b,c", "inf,0,0", "NaN,0,0", ""] {
            assert!(vector(wrong).is_err(), "{wrong}");
        }
        assert!(direction("0,-0,0").is_err());
    }

    #[test]
    fn assignments_keep_everything_after_the_first_equals_sign() {
        assert_eq!(
            "a=b=c".parse(),
            Ok(Assignment {
                name: "a".into(),
                value: "b=c".into()
            })
        );
        assert!("=1".parse::<Assignment>().is_err());
        assert!("cull".parse::<Assignment>().is_err());
    }

    #[test]
    fn saves_name_a_material_and_a_file_of_a_known_kind() {
        let save: Save = "shadow_map@create_shadow_map=out/a=b.PNG".parse().unwrap();
        assert_eq!(save.material, "shadow_map");
        assert_eq!(save.after.as_deref(), Some("create_shadow_map"));
        assert_eq!(
            (save.file, save.encoding),
            (PathBuf::from("out/a=b.PNG"), Encoding::Png)
        );
        for wrong in [
            "visibility",
            "visibility=a.jpg",
            "visibility=a",
            "=a.png",
            "v@=a.png",
            "v=",
        ] {
            assert!(wrong.parse::<Save>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn published_figures_have_a_label_and_a_file() {
        let published = |label: &str, file: &str| {
            Ok(PublishedFile {
                label: label.into(),
                file: file.into(),
            })
        };
        assert_eq!("D:docs/d.csv".parse(), published("D", "docs/d.csv"));
        assert_eq!("docs/d.csv".parse(), published("d", "docs/d.csv"));
        assert_eq!("./a:b.csv".parse(), published("a:b", "./a:b.csv"));
        for wrong in ["", ":d.csv", "D:"] {
            assert!(wrong.parse::<PublishedFile>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn fields_of_view_are_open_intervals() {
        assert_eq!(degrees("60"), Ok(60.0));
        for wrong in ["0", "180", "-5", "NaN", "wide"] {
            assert!(degrees(wrong).is_err(), "{wrong}");
        }
    }
}
