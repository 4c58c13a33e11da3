//! Reads files of materials, line by line, for the five statements that colour a triangle or cut it
//! out: `Kd`, `d`, `Tr`, `map_Kd` and `map_d`.
//!
//! Every other statement may say what it likes. `tobj`'s own reader refuses the whole file over a
//! number that is missing from a highlight, and dies where `Kd` has one number instead of three.

use super::guard::split;
use crate::error::beginning;
use crate::text::{lines_text, next_line, without_comment, without_mark};

/// A material, as far as it matters here.
#[derive(Clone, Debug, Default)]
pub(super) struct MtlMaterial {
    pub name: String,
    /// `Kd`.
    pub diffuse: Option<[f32; 3]>,
    /// Opacity from `d`.
    pub dissolve: Option<f32>,
    /// Opacity from `Tr`, which counts where `d` says nothing.
    pub transparency: Option<f32>,
    /// Words behind `map_Kd`.
    pub diffuse_map: Option<String>,
    /// Words behind `map_d`.
    pub dissolve_map: Option<String>,
    /// A line on which it depends what is cut out, and which cannot be read.
    pub fault: Option<String>,
    /// Lines that were passed over.
    pub remarks: Vec<String>,
}

impl MtlMaterial {
    /// Opacity, 1 where nothing is said.
    pub fn opacity(&self) -> f32 {
        let transparent = self.transparency.map(|transparency| 1.0 - transparency);
        self.dissolve.or(transparent).unwrap_or(1.0)
    }

    fn take(&mut self, keyword: &str, rest: &str, line: usize) {
        let is = |other: &str| keyword.eq_ignore_ascii_case(other);
        let shown = || format!("line {line}: `{}`", beginning(&format!("{keyword} {rest}")));
        if is("Kd") {
            match colour(rest) {
                Some(colour) => self.diffuse = Some(colour),
                None => self.remarks.push(format!("{} passed over", shown())),
            }
        } else if is("d") || is("Tr") {
            let first = without_comment(rest).split_whitespace().next();
            let number = first.map(|word| word.parse::<f32>().ok().filter(|it| it.is_finite()));
            match (first, number.flatten()) {
                (_, Some(number)) if is("d") => self.dissolve = Some(number),
                (_, Some(number)) => self.transparency = Some(number),
                (Some("-halo"), _) => self.remarks.push(format!(
                    "{} depends on the direction from which one looks: passed over, it counts as \
                     opaque",
                    shown()
                )),
                (None, _) => self.remarks.push(format!("{} says nothing", shown())),
                (Some(_), None) => {
                    self.fault = Some(format!("{}: expected a number from 0 to 1", shown()));
                }
            }
        } else if is("map_Kd") {
            self.diffuse_map = (!rest.is_empty()).then(|| rest.to_owned());
        } else if is("map_d") {
            self.dissolve_map = (!rest.is_empty()).then(|| rest.to_owned());
        } else if is("map_Tr") || is("map_opacity") {
            let text = format!("{} is not followed: write it as map_d", shown());
            self.remarks.push(text);
        }
    }
}

/// The materials of a file's bytes. A material without a name cannot be used, and is left out.
pub(super) fn parse(bytes: &[u8]) -> Vec<MtlMaterial> {
    let bytes = without_mark(bytes);
    let mut materials: Vec<MtlMaterial> = Vec::new();
    let mut is_named = false;
    let text = lines_text(&bytes);
    let mut rest = &*text;
    let lines = std::iter::from_fn(|| next_line(&mut rest));
    for (number, (line, _)) in (1..).zip(lines) {
        let (keyword, rest) = split(line.trim());
        let rest = rest.trim();
        if keyword.eq_ignore_ascii_case("newmtl") {
            is_named = !rest.is_empty();
            if is_named {
                let name = rest.to_owned();
                materials.push(MtlMaterial {
                    name,
                    ..MtlMaterial::default()
                });
            }
        } else if let Some(material) = materials.last_mut().filter(|_| is_named) {
            material.take(keyword, rest, number);
        }
    }
    materials
}

/// Red, green, blue. Green and blue that are left out equal red; colours of spectra and in XYZ are
/// not read.
fn colour(rest: &str) -> Option<[f32; 3]> {
    let mut numbers = without_comment(rest)
        .split_whitespace()
        .map(|word| word.parse::<f32>().ok().filter(|it| it.is_finite()));
    let red = numbers.next()??;
    let mut next = || numbers.next().unwrap_or(Some(red));
    Some([red, next()?, next()?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_are_left_out_equal_the_first() {
        assert_eq!(colour("0.7"), Some([0.7; 3]));
        assert_eq!(colour("1 0"), Some([1.0, 0.0, 1.0]));
        assert_eq!(colour("1 0 0.5 7 # red"), Some([1.0, 0.0, 0.5]));
        for other in ["", "#", "xyz 1 1 1", "spectral a.rfl 1", "1 nan 0", "1 x"] {
            assert_eq!(colour(other), None, "{other}");
        }
    }

    #[test]
    fn statements_without_a_material_are_passed_over() {
        let text =
            "Kd 1 1 1\nnewmtl\nd 0\n newmtl \t grün \r\n\tKD 1\r\nmap_kd a b.png\nmap_d\nNi\n";
        let materials = parse(text.as_bytes());
        assert_eq!(materials.len(), 1);
        let green = &materials[0];
        assert_eq!(
            (green.name.as_str(), green.diffuse),
            ("grün", Some([1.0; 3]))
        );
        assert_eq!(green.diffuse_map.as_deref(), Some("a b.png"));
        assert!(green.dissolve_map.is_none() && green.remarks.is_empty());
        // In another encoding it is the same material.
        assert_eq!(parse(b"newmtl gr\xfcn")[0].name, "grün");
    }

    #[test]
    fn d_counts_before_tr() {
        let opacity = |text: &str| parse(format!("newmtl a\n{text}").as_bytes())[0].opacity();
        assert_eq!(opacity(""), 1.0);
        assert_eq!(opacity("Tr 0.75"), 0.25);
        assert_eq!(opacity("d 1\nTr 1"), 1.0);
        assert_eq!(opacity("Tr 1\nd 0.5"), 0.5);
        assert_eq!(opacity("d -halo 0.1"), 1.0);
    }
}
