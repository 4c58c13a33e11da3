//! Pictures: PNG encoding, and what any material of a graph looks like.

mod shades;

use crate::{error::CliError, files::write_whole};
use image::{ImageEncoder, codecs::png::PngEncoder};
use shades::{depths, floats, fractions, integers};
use skiagraph_graph::Content;
use skiagraph_reference::Image;
use std::path::Path;

/// A material as a picture.
pub struct Picture {
    /// The picture.
    pub image: Image,
    /// How values became colours, one sentence part.
    pub legend: String,
}

/// Near and far plane of the perspective camera whose depths a texture holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planes {
    /// Distance of the near plane, depth 0.
    pub near: f64,
    /// Distance of the far plane, depth 1.
    pub far: f64,
}

impl Planes {
    /// The distance along the viewing direction that a depth stands for.
    fn distance(self, depth: f32) -> f32 {
        let Self { near, far } = self;
        (near * far / (far - f64::from(depth) * (far - near))) as f32
    }
}

impl Picture {
    /// Shows what was read of the material `name`; the name tells `status` from other integers, `planes` a camera's depths
    /// from others.
    ///
    /// # Errors
    /// Why it has no picture.
    pub fn of(name: &str, content: &Content, planes: Option<Planes>) -> Result<Self, String> {
        let Content::Texture { format, size, .. } = content else {
            return Err("is a buffer and has no picture; save it as .csv or .bin".into());
        };
        let texels = size[0] as usize * size[1] as usize;
        let (channels, aspects) = (
            usize::from(format.components()),
            format.is_depth_stencil_format(),
        );
        let is_whole = |length: usize| length == texels * channels;
        let (rgb, legend) = match (content.as_u32(), content.as_i32(), content.as_f32()) {
            (Some(values), ..) if channels == 1 && is_whole(values.len()) => {
                integers(name, &values)
            }
            (Some(values), ..) if is_whole(values.len()) => floats(
                &values.iter().map(|&value| value as f32).collect::<Vec<_>>(),
                channels,
            ),
            (_, Some(values), _) if is_whole(values.len()) => floats(
                &values.iter().map(|&value| value as f32).collect::<Vec<_>>(),
                channels,
            ),
            (.., Some(values)) if aspects && is_whole(values.len()) => depths(&values, planes),
            (.., Some(values)) if is_whole(values.len()) => match is_unorm(*format) {
                true => fractions(&values, channels),
                false => floats(&values, channels),
            },
            _ => {
                return Err(format!(
                    "has the format {format:?}, of which no picture can be made; save it as .bin"
                ));
            }
        };
        Ok(Self {
            image: Image { size: *size, rgb },
            legend,
        })
    }
}

/// Whether the channels reach from 0 to 1 whatever they hold.
fn is_unorm(format: wgpu::TextureFormat) -> bool {
    use wgpu::TextureFormat as F;
    matches!(
        format.remove_srgb_suffix(),
        F::R8Unorm
            | F::Rg8Unorm
            | F::Rgba8Unorm
            | F::Bgra8Unorm
            | F::R16Unorm
            | F::Rg16Unorm
            | F::Rgba16Unorm
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
    use super::{shades::*, *};
    use skiagraph_reference::BACKGROUND;
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
            None,
        )
        .unwrap();
        let colours = STATUS.map(|(colour, _)| colour);
        assert_eq!(picture.image.rgb, [colours.as_flattened(), &WRONG].concat());
        assert!(
            picture
                .legend
                .ends_with("purple uncertain (1), magenta no status (1)")
        );
    }

    #[test]
    fn visibility_is_black_and_white() {
        let picture =
            Picture::of("visibility", &texture(F::R8Uint, [2, 1], vec![0, 1]), None).unwrap();
        assert_eq!(picture.image.rgb, [0, 0, 0, 255, 255, 255]);
        assert_eq!(picture.legend, "black 0 (1), white 1 (1)");
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
    fn values_fill_their_range_and_odd_ones_are_marked_and_counted() {
        let values = [0.5, 0.75, 1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
        let bytes = float_bytes(&values);
        let picture = Picture::of("height", &texture(F::R32Float, [6, 1], bytes), None).unwrap();
        let texels: Vec<_> = picture.image.rgb.chunks(3).collect();
        assert_eq!(
            texels,
            [
                [0; 3],
                [128; 3],
                [255; 3],
                WRONG,
                POSITIVE_INFINITY,
                NEGATIVE_INFINITY
            ]
        );
        assert_eq!(
            picture.legend,
            "0.5 … 1, magenta NaN (1), orange +∞ (1), light blue -∞ (1)"
        );
    }

    #[test]
    fn a_cameras_depths_are_shown_as_distances_and_what_is_cleared_as_nothing() {
        let planes = Planes {
            near: 1.0,
            far: 11.0,
        };
        // Depth of a distance z: far (z - near) / (z (far - near)).
        let depth = |z: f32| 11.0 * (z - 1.0) / (z * 10.0);
        let bytes = float_bytes(&[depth(2.0), depth(3.0), depth(7.0), 1.0]);
        let content = texture(F::Depth32Float, [4, 1], bytes);
        let grey = |planes| {
            let Picture { image, legend } = Picture::of("depth", &content, planes).unwrap();
            assert_eq!(image.rgb[9..], NOTHING);
            ([image.rgb[0], image.rgb[3], image.rgb[6]], legend)
        };
        let (linear, legend) = grey(Some(planes));
        assert_eq!(
            linear,
            [0, 51, 255],
            "3 lies at a fifth of the way from 2 to 7"
        );
        assert!(
            legend.starts_with("distance along the view, black to white 2"),
            "{legend}"
        );
        assert!(legend.ends_with("grey 1, nothing there (1)"), "{legend}");
        let (stored, legend) = grey(None);
        assert_eq!(
            stored,
            [0, 119, 255],
            "and nearly half way between their depths"
        );
        assert!(
            legend.starts_with("stored depth, black to white 0.55 …"),
            "{legend}"
        );
    }

    #[test]
    fn every_kind_of_channel_has_a_picture() {
        for (format, bytes, rgb) in [
            (F::R8Unorm, vec![51, 102], [51, 51, 51, 102, 102, 102]),
            (F::Rg8Unorm, vec![0, 255, 255, 0], [0, 255, 0, 255, 0, 0]),
            (
                F::Bgra8Unorm,
                vec![1, 2, 3, 4, 5, 6, 7, 8],
                [3, 2, 1, 7, 6, 5],
            ),
            (F::R8Sint, vec![0xff, 1], [0, 0, 0, 255, 255, 255]),
            (F::Rg8Uint, vec![4, 9, 6, 9], [0, 0, 0, 255, 0, 0]),
            (
                F::R16Float,
                vec![0, 0x3c, 0, 0x40],
                [0, 0, 0, 255, 255, 255],
            ),
        ] {
            let picture = Picture::of("x", &texture(format, [2, 1], bytes), None).unwrap();
            assert_eq!(picture.image.rgb, rgb, "{format:?}: {}", picture.legend);
        }
    }

    #[test]
    fn constant_and_huge_ranges_do_not_overflow() {
        for values in [[3.0, 3.0], [f32::MIN, f32::MAX], [f32::NAN, f32::NAN]] {
            Picture::of(
                "x",
                &texture(F::R32Float, [2, 1], float_bytes(&values)),
                None,
            )
            .unwrap();
        }
    }

    #[test]
    fn positions_become_colours() {
        let bytes = float_bytes(&[0.0, 10.0, -1.0, 1.0, 4.0, 20.0, 1.0, 1.0]);
        let picture =
            Picture::of("position", &texture(F::Rgba32Float, [2, 1], bytes), None).unwrap();
        assert_eq!(picture.image.rgb, [0, 0, 0, 255, 255, 255]);
        assert_eq!(
            picture.legend,
            "red 0 … 4, green 10 … 20, blue -1 … 1, alpha (not shown) 1 … 1"
        );
    }

    #[test]
    fn buffers_and_odd_formats_say_what_to_do() {
        for content in [
            Content::Buffer(vec![0; 4]),
            texture(F::Rgb10a2Unorm, [1, 1], vec![0; 4]),
        ] {
            assert!(
                Picture::of("x", &content, None)
                    .err()
                    .unwrap()
                    .contains(".bin")
            );
        }
    }
}
