//! Texture statements of files of materials: options, then a file.

use crate::texture::Wrap;
use glam::Vec2;

/// Map of texture coordinates, v up, before a texture is looked up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct UvTransform {
    pub scale: Vec2,
    pub offset: Vec2,
}

impl UvTransform {
    pub const IDENTITY: Self = Self {
        scale: Vec2::ONE,
        offset: Vec2::ZERO,
    };

    /// Maps coordinates with v down, as meshes have them, to coordinates with v down: v is turned
    /// up, both are multiplied by the scale and moved by the offset, and v is turned down again.
    pub fn apply(&self, uv: Vec2) -> Vec2 {
        if *self == Self::IDENTITY {
            return uv;
        }
        let up = Vec2::new(uv.x, 1.0 - uv.y) * self.scale + self.offset;
        Vec2::new(up.x, 1.0 - up.y)
    }
}

/// Which number of a texel counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Channel {
    /// Alpha where the texture has any, red of a grey one.
    Own,
    /// Red, green, blue or alpha.
    Of(usize),
    /// The mean of red, green and blue.
    Luminance,
}

/// A texture statement.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TextureStatement {
    pub file: String,
    pub wrap: Wrap,
    pub uv: UvTransform,
    pub channel: Channel,
    /// Addend and factor of a texel's number (`-mm`).
    pub range: [f32; 2],
    /// Options that change what is cut out and are not followed.
    pub passed_over: Vec<&'static str>,
}

/// Options with the most words that each takes, and whether those are numbers: those of the MTL
/// specification (Alias/Wavefront, version 4.2), `-turb`, by which some files call `-t`, and
/// `-colorspace`.
const OPTIONS: [(&str, usize, bool); 15] = [
    ("-clamp", 1, false),
    ("-blendu", 1, false),
    ("-blendv", 1, false),
    ("-cc", 1, false),
    ("-colorspace", 1, false),
    ("-imfchan", 1, false),
    ("-type", 1, false),
    ("-mm", 2, true),
    ("-o", 3, true),
    ("-s", 3, true),
    ("-t", 3, true),
    ("-turb", 3, true),
    ("-bm", 1, true),
    ("-boost", 1, true),
    ("-texres", 1, true),
];

impl TextureStatement {
    /// Reads the text behind a keyword of an .mtl file such as `map_Kd`. A word that is no option
    /// begins the file's name, as does a word where an option lacks a number, which keeps its
    /// default then. Without a name `file` is empty.
    pub fn parse(text: &str) -> Self {
        let mut statement = Self {
            file: String::new(),
            wrap: Wrap::Repeat,
            uv: UvTransform::IDENTITY,
            channel: Channel::Own,
            range: [0.0, 1.0],
            passed_over: Vec::new(),
        };
        let mut rest = text.trim();
        while let Some(&(option, most, numeric)) = first_word(rest).and_then(|word| {
            OPTIONS
                .iter()
                .find(|(option, ..)| option.eq_ignore_ascii_case(word))
        }) {
            rest = rest[option.len()..].trim_start();
            let (mut words, mut numbers) = (Vec::new(), Vec::new());
            while let Some(word) = first_word(rest).filter(|_| words.len() < most) {
                let behind = rest[word.len()..].trim_start();
                let number = word.parse::<f32>().ok().filter(|number| number.is_finite());
                let is_number = numeric && number.is_some();
                let is_taken = is_number || (!numeric && is_word_of(option, word));
                // The last word is the file's.
                if !is_taken || behind.is_empty() {
                    break;
                }
                numbers.extend(number);
                words.push(word);
                rest = behind;
            }
            statement.follow(option, words.first().copied().unwrap_or(""), &numbers);
        }
        rest.clone_into(&mut statement.file);
        statement
    }

    fn follow(&mut self, option: &'static str, word: &str, numbers: &[f32]) {
        let two = |otherwise: [f32; 2]| {
            let at = |index: usize| numbers.get(index).copied().unwrap_or(otherwise[index]);
            [at(0), at(1)]
        };
        match option {
            "-clamp" if word.eq_ignore_ascii_case("on") => self.wrap = Wrap::Clamp,
            "-o" => self.uv.offset = two([0.0, 0.0]).into(),
            "-s" => self.uv.scale = two([1.0, 1.0]).into(),
            "-mm" => self.range = two([0.0, 1.0]),
            "-t" | "-turb" if numbers.iter().any(|number| *number != 0.0) => {
                self.passed_over.push(option)
            }
            "-imfchan" => match &*word.to_ascii_lowercase() {
                "r" => self.channel = Channel::Of(0),
                "g" => self.channel = Channel::Of(1),
                "b" => self.channel = Channel::Of(2),
                "m" => self.channel = Channel::Of(3),
                "l" => self.channel = Channel::Luminance,
                _ => self.passed_over.push(option),
            },
            _ => {}
        }
    }
}

fn first_word(text: &str) -> Option<&str> {
    text.split_whitespace().next()
}

fn is_word_of(option: &str, word: &str) -> bool {
    let one_of = |words: &[&str]| words.iter().any(|choice| choice.eq_ignore_ascii_case(word));
    match option {
        "-imfchan" => one_of(&["r", "g", "b", "m", "l", "z"]),
        // Kinds of maps of reflections and names of spaces have no bounds.
        "-type" | "-colorspace" => true,
        _ => one_of(&["on", "off"]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_stand_in_front_of_a_textures_name() {
        let name = |text: &str| TextureStatement::parse(text).file;
        assert_eq!(name("leaf.png"), "leaf.png");
        assert_eq!(name("-s 1 1 1 -o 0.5 my leaf.png"), "my leaf.png");
        assert_eq!(name("-bm 0.2 -imfchan l 2 leaves.tga"), "2 leaves.tga");
        assert_eq!(name("-s 1 1 1 2 leaves.tga"), "2 leaves.tga");
        assert_eq!(name("-clamp on on.png"), "on.png");
        assert_eq!(name("-clamp OFF -imfchan R a.png"), "a.png");
        // Every option with all of its words, and with as few as it may have.
        for options in [
            "-blendu on",
            "-blendv off",
            "-bm 0.5",
            "-boost 2",
            "-Boost 2.5 -cc on",
            "-clamp on",
            "-colorspace sRGB",
            "-colorspace rec.709",
            "-imfchan l",
            "-mm 0 1",
            "-mm 0.5",
            "-o 1",
            "-o 1 2",
            "-o 1 2 3",
            "-s 1e-1 -2 +.5",
            "-t 0.1 0.1 0.1",
            "-turb 0.1 0.1 0.1",
            "-texres 512",
            "-type cube_top",
        ] {
            for file in ["a.png", "my big leaf.png", "-leaf.png"] {
                assert_eq!(name(&format!("{options} {file}")), file, "{options}");
            }
        }
        // A number that stands last is the file's name.
        assert_eq!(name("-boost 2 2"), "2");
        assert_eq!(name("-s 1 1 7"), "7");
        assert_eq!(name("-type on.png"), "on.png");
        assert_eq!(name("-leaf.png"), "-leaf.png");
        assert_eq!(name(""), "");
    }

    #[test]
    fn options_are_followed_or_told() {
        let parsed =
            TextureStatement::parse("-s 2 -o 0.25 0.5 0 -mm 0.1 0.5 -imfchan g -clamp on a.png");
        assert_eq!(parsed.uv.scale, Vec2::new(2.0, 1.0));
        assert_eq!(parsed.uv.offset, Vec2::new(0.25, 0.5));
        assert_eq!((parsed.range, parsed.channel), ([0.1, 0.5], Channel::Of(1)));
        assert_eq!((parsed.wrap, parsed.passed_over.len()), (Wrap::Clamp, 0));
        let parsed = TextureStatement::parse("-t 0.5 0 0 -imfchan z -cc on -turb 0 1 a.png");
        assert_eq!(parsed.passed_over, ["-t", "-imfchan", "-turb"]);
        let parsed = TextureStatement::parse("-clamp ON -imfchan R a.png");
        assert_eq!((parsed.wrap, parsed.channel), (Wrap::Clamp, Channel::Of(0)));
        // v counts from the bottom of a texture in the file, from its top here.
        let uv = UvTransform {
            scale: Vec2::splat(2.0),
            offset: Vec2::new(0.0, 0.5),
        };
        assert_eq!(uv.apply(Vec2::new(0.25, 1.0)), Vec2::new(0.5, 0.5));
    }
}
