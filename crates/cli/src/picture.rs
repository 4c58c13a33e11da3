//! Pictures: PNG encoding, and what any material of a graph looks like.

use crate::{error::CliError, files::write_whole};
use image::{ImageEncoder, codecs::png::PngEncoder};
use skiagraph_graph::Content;
use skiagraph_reference::{BACKGROUND, Image};
use std::path::Path;

/// Colours of the `status` values 0 to 4: background, facing away, certain light, certain shadow, uncertain.
const STATUS: [[u8; 3]; 5] = [
    [96, 112, 128],
    [0, 128, 0],
    [255, 255, 255],
    [0, 0, 0],
    [160, 32, 240],
];
const NO_PRIMITIVE: [u8; 3] = STATUS[0];
/// NaN, and integers that have no business being there.
const WRONG: [u8; 3] = [255, 0, 255];

/// A material as a picture.
pub struct Picture {
    /// The picture.
    pub image: Image,
    /// How values became colours, one sentence part.
    pub legend: String,
}

impl Picture {
    /// Shows what was read of the material `name`; the name tells `status` from other integers.
    ///
    /// # Errors
    /// Why it has no picture.
    pub fn of(name: &str, content: &Content) -> Result<Self, String> {
        let Content::Texture {
            format,
            size,
            bytes,
        } = content
        else {
            return Err("is a buffer and has no picture; save it as .bin".into());
        };
        let texels = size[0] as usize * size[1] as usize;
        let (rgb, legend) = if let Some(values) = content.as_u32() {
            integers(name, &values)
        } else if let Some(values) = content
            .as_f32()
            .filter(|values| texels > 0 && values.len() % texels == 0)
        {
            floats(&values, values.len() / texels)
        } else if let Some(rgb) = bytes_rgb(*format, bytes) {
            (rgb, "as it is".into())
        } else {
            return Err(format!(
                "has the format {format:?}, of which no picture can be made; save it as .bin"
            ));
        };
        if rgb.len() != texels * 3 {
            return Err(format!(
                "holds {} bytes, which are not {}x{} texels",
                bytes.len(),
                size[0],
                size[1]
            ));
        }
        Ok(Self {
            image: Image { size: *size, rgb },
            legend,
        })
    }
}

fn integers(name: &str, values: &[u32]) -> (Vec<u8>, String) {
    if name == "status" {
        let colour = |&value: &u32| STATUS.get(value as usize).copied().unwrap_or(WRONG);
        let legend = "grey background, green facing away, white certain light, black certain shadow, purple uncertain";
        (values.iter().flat_map(colour).collect(), legend.into())
    } else if values.iter().all(|&value| value <= 1) {
        (
            values
                .iter()
                .flat_map(|&value| [value as u8 * 255; 3])
                .collect(),
            "black 0, white 1".into(),
        )
    } else {
        (
            values.iter().flat_map(|&value| id_colour(value)).collect(),
            "a colour per number, grey 0xffffffff".into(),
        )
    }
}

/// Neighbouring ids must look different: a multiplicative hash (Knuth's 2³²/φ), its high bits as a bright colour.
fn id_colour(id: u32) -> [u8; 3] {
    if id == BACKGROUND {
        return NO_PRIMITIVE;
    }
    let hash = (id.wrapping_add(1))
        .wrapping_mul(0x9e37_79b9)
        .rotate_left(15)
        .wrapping_mul(0x85eb_ca6b);
    [hash >> 24, hash >> 16 & 0xff, hash >> 8 & 0xff]
        .map(|channel| 48 + (channel * 207 / 255) as u8)
}

/// Each channel between its own least and greatest finite value; one channel is grey, two leave blue black, a fourth is not shown.
fn floats(values: &[f32], channels: usize) -> (Vec<u8>, String) {
    let shown = channels.min(3);
    let ranges: Vec<(f32, f32)> = (0..shown)
        .map(|channel| {
            let finite = values
                .iter()
                .skip(channel)
                .step_by(channels)
                .filter(|value| value.is_finite());
            finite.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &value| {
                (low.min(value), high.max(value))
            })
        })
        .collect();
    let level = |value: f32, (low, high): (f32, f32)| {
        // In f64, where the difference of two f32 cannot overflow. ±∞ land on black and white.
        let share = (f64::from(value) - f64::from(low))
            / (f64::from(high) - f64::from(low)).max(f64::MIN_POSITIVE);
        (share.clamp(0.0, 1.0) * 255.0).round() as u8
    };
    let mut rgb = Vec::with_capacity(values.len() / channels * 3);
    for texel in values.chunks_exact(channels) {
        if texel[..shown].iter().any(|value| value.is_nan()) {
            rgb.extend(WRONG);
            continue;
        }
        let mut colour = [0; 3];
        for (channel, &range) in ranges.iter().enumerate() {
            colour[channel] = level(texel[channel], range);
        }
        rgb.extend(if shown == 1 { [colour[0]; 3] } else { colour });
    }
    let names = if shown == 1 {
        [""; 3]
    } else {
        ["red ", "green ", "blue "]
    };
    let spans = names
        .iter()
        .zip(&ranges)
        .map(|(name, (low, high))| match low <= high {
            true => format!("{name}{low} … {high}"),
            false => format!("{name}without a finite value"),
        });
    let mut legend = spans.collect::<Vec<_>>().join(", ");
    if values.iter().any(|value| value.is_nan()) {
        legend.push_str(", magenta NaN");
    }
    (rgb, legend)
}

fn bytes_rgb(format: wgpu::TextureFormat, bytes: &[u8]) -> Option<Vec<u8>> {
    use wgpu::TextureFormat as F;
    let order = match format {
        F::Rgba8Unorm | F::Rgba8UnormSrgb | F::Rgba8Uint => [0, 1, 2],
        F::Bgra8Unorm | F::Bgra8UnormSrgb => [2, 1, 0],
        _ => return None,
    };
    Some(
        bytes
            .chunks_exact(4)
            .flat_map(|texel| order.map(|channel| texel[channel]))
            .collect(),
    )
}

/// Writes a PNG, whole or not at all.
///
/// # Errors
/// The path cannot be written.
pub fn save(path: &Path, image: &Image) -> Result<(), CliError> {
    let mut png = Vec::new();
    PngEncoder::new(&mut png)
        .write_image(
            &image.rgb,
            image.size[0],
            image.size[1],
            image::ExtendedColorType::Rgb8,
        )
        .map_err(|error| CliError::write(path, error))?;
    write_whole(path, &png)
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::TextureFormat as F;

    fn texture(format: F, size: [u32; 2], bytes: Vec<u8>) -> Content {
        Content::Texture {
            format,
            size,
            bytes,
        }
    }

    fn float_bytes(values: &[f32]) -> Vec<u8> {
        values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect()
    }

    #[test]
    fn status_has_a_colour_per_value_and_strangers_show() {
        let picture = Picture::of(
            "status",
            &texture(F::R8Uint, [3, 2], vec![0, 1, 2, 3, 4, 9]),
        )
        .unwrap();
        assert_eq!(picture.image.rgb, [STATUS.as_flattened(), &WRONG].concat());
    }

    #[test]
    fn visibility_is_black_and_white() {
        let picture = Picture::of("visibility", &texture(F::R8Uint, [2, 1], vec![0, 1])).unwrap();
        assert_eq!(picture.image.rgb, [0, 0, 0, 255, 255, 255]);
    }

    #[test]
    fn ids_differ_from_their_neighbours_and_from_the_background() {
        let colours: Vec<_> = (0..1000).chain([BACKGROUND]).map(id_colour).collect();
        let distance =
            |a: [u8; 3], b: [u8; 3]| (0..3).map(|i| a[i].abs_diff(b[i]) as u32).sum::<u32>();
        let alike = colours
            .windows(2)
            .filter(|pair| distance(pair[0], pair[1]) < 24)
            .count();
        assert!(alike < 10, "{alike} neighbours of 1000 look alike");
    }

    #[test]
    fn depths_fill_their_range_and_odd_values_show() {
        let values = [0.5, 0.75, 1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
        let picture = Picture::of(
            "depth",
            &texture(F::Depth32Float, [6, 1], float_bytes(&values)),
        )
        .unwrap();
        let texels: Vec<_> = picture.image.rgb.chunks(3).collect();
        assert_eq!(
            texels,
            [[0; 3], [128; 3], [255; 3], WRONG, [255; 3], [0; 3]]
        );
        assert_eq!(picture.legend, "0.5 … 1, magenta NaN");
    }

    #[test]
    fn constant_and_huge_ranges_do_not_overflow() {
        for values in [[3.0, 3.0], [f32::MIN, f32::MAX], [f32::NAN, f32::NAN]] {
            Picture::of("x", &texture(F::R32Float, [2, 1], float_bytes(&values))).unwrap();
        }
    }

    #[test]
    fn positions_become_colours() {
        let bytes = float_bytes(&[0.0, 10.0, -1.0, 1.0, 4.0, 20.0, 1.0, 1.0]);
        let picture = Picture::of("position", &texture(F::Rgba32Float, [2, 1], bytes)).unwrap();
        assert_eq!(picture.image.rgb, [0, 0, 0, 255, 255, 255]);
        assert_eq!(picture.legend, "red 0 … 4, green 10 … 20, blue -1 … 1");
    }

    #[test]
    fn buffers_and_odd_formats_say_what_to_do() {
        for content in [
            Content::Buffer(vec![0; 4]),
            texture(F::Rg8Snorm, [1, 1], vec![0, 0]),
        ] {
            assert!(Picture::of("x", &content).err().unwrap().contains(".bin"));
        }
    }
}
