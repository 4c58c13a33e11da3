//! Draws pictures of a graph's materials.
//!
//! ```
//! use skiagraph_compare::pictures::material::Picture;
//! use skiagraph_gpu::Content;
//!
//! let content = Content::Texture {
//!     format: wgpu::TextureFormat::R8Unorm,
//!     parts: vec![[2, 1]],
//!     bytes: vec![0, 255],
//! };
//! let picture = Picture::new("visibility", &content, None)?;
//! assert_eq!(picture.image.size, [2, 1]);
//! println!("{}", picture.legend);
//! # Ok::<(), String>(())
//! ```

use crate::pictures::colours::{ClipPlanes, EMPTY, depths, floats, fractions, integers};
use skiagraph_gpu::Content;
use skiagraph_reference::Image;

/// Picture of a graph's material (a texture), with its legend.
pub struct Picture {
    /// The picture in RGB; several mips and layers stand one below the other.
    pub image: Image,
    /// Meaning of the colours, as a part of a sentence.
    pub legend: String,
}

impl Picture {
    /// Draws the content of a texture. `name` is the material's name: integers of `status` have
    /// colours of their own. `planes` are the camera's clip planes if the content is a camera's
    /// depths; `None` for a light's depths and for other content.
    ///
    /// # Errors
    /// The reason why there is no picture, such as a buffer, as the rest of a sentence that begins
    /// with the material's name.
    pub fn new(name: &str, content: &Content, planes: Option<ClipPlanes>) -> Result<Self, String> {
        let Content::Texture { format, parts, .. } = content else {
            return Err("is a buffer and has no picture; save it as .csv or .bin".into());
        };
        let texels = parts.iter().map(|size| size[0] as usize * size[1] as usize);
        let texels: usize = texels.sum();
        let channels = usize::from(format.components());
        let ids = content.as_u32();
        let ids = ids.filter(|ids| channels == 1 && ids.len() == texels);
        let (rgb, legend) = if let Some(ids) = ids {
            integers(name, &ids)
        } else {
            let numbers = numbers(content).filter(|samples| samples.len() == texels * channels);
            let numbers = numbers.ok_or_else(|| {
                format!(
                    "has the format {format:?}, of which no picture can be made; save it as .bin"
                )
            })?;
            match () {
                () if format.is_depth_stencil_format() => depths(&numbers, planes),
                () if is_unorm(*format) => fractions(&numbers, channels),
                () => floats(&numbers, channels),
            }
        };
        Ok(Self {
            image: sheet(parts, rgb),
            legend: match parts.len() {
                1 => legend,
                count => format!("{count} mips and layers one below the other, {legend}"),
            },
        })
    }
}

/// The channels of all texels, whatever their type is.
fn numbers(content: &Content) -> Option<Vec<f32>> {
    let unsigned = || Some(content.as_u32()?.into_iter().map(|it| it as f32).collect());
    let signed = || Some(content.as_i32()?.into_iter().map(|it| it as f32).collect());
    content.as_f32().or_else(unsigned).or_else(signed)
}

/// The mips and layers of a texture, one below the other.
fn sheet(parts: &[[u32; 2]], rgb: Vec<u8>) -> Image {
    let width = parts.iter().map(|size| size[0]).max().unwrap_or(0);
    let height = parts.iter().map(|size| size[1]).sum();
    let size = [width, height];
    if parts.iter().all(|size| size[0] == width) {
        return Image { size, rgb };
    }
    let mut sheet = Vec::with_capacity(3 * width as usize * height as usize);
    let mut rest = &rgb[..];
    for [of_part, rows] in parts {
        for _ in 0..*rows {
            let (row, behind) = rest.split_at(3 * *of_part as usize);
            sheet.extend_from_slice(row);
            sheet.extend((*of_part..width).flat_map(|_| EMPTY));
            rest = behind;
        }
    }
    Image { size, rgb: sheet }
}

/// True if the channels reach from 0 to 1 whatever they hold.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pictures::colours::*;
    use skiagraph_reference::BACKGROUND;
    use wgpu::TextureFormat as F;

    fn texture(format: F, size: [u32; 2], bytes: Vec<u8>) -> Content {
        Content::Texture {
            format,
            parts: vec![size],
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
        let picture = Picture::new(
            "status",
            &texture(F::R8Uint, [3, 2], vec![0, 1, 2, 3, 4, 9]),
            None,
        )
        .unwrap();
        let colours = STATUS.map(|(colour, _)| colour);
        assert_eq!(
            picture.image.rgb,
            [colours.as_flattened(), &INVALID].concat()
        );
        assert!(
            picture
                .legend
                .ends_with("purple uncertain (1), magenta no status (1)")
        );
    }

    #[test]
    fn visibility_is_black_and_white() {
        let picture =
            Picture::new("visibility", &texture(F::R8Uint, [2, 1], vec![0, 1]), None).unwrap();
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
        let picture = Picture::new("height", &texture(F::R32Float, [6, 1], bytes), None).unwrap();
        let texels: Vec<_> = picture.image.rgb.chunks(3).collect();
        assert_eq!(
            texels,
            [
                [0; 3],
                [128; 3],
                [255; 3],
                INVALID,
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
        let planes = ClipPlanes {
            near: 1.0,
            far: 11.0,
        };
        // Depth of a distance z: near (far - z) / (z (far - near)).
        let depth = |z: f32| (11.0 - z) / (z * 10.0);
        let written = [2.0, 3.0, 7.0].map(depth);
        let grey = |planes, empty| {
            let bytes = float_bytes(&[&written[..], &[empty]].concat());
            let content = texture(F::Depth32Float, [4, 1], bytes);
            let Picture { image, legend } = Picture::new("depth", &content, planes).unwrap();
            assert_eq!(image.rgb[9..], EMPTY);
            ([image.rgb[0], image.rgb[3], image.rgb[6]], legend)
        };
        let (linear, legend) = grey(Some(planes), 0.0);
        assert_eq!(
            linear,
            [0, 51, 255],
            "3 lies at a fifth of the way from 2 to 7"
        );
        assert!(
            legend.starts_with("distance along the view, black to white 2"),
            "{legend}"
        );
        assert!(legend.ends_with("grey 0, nothing there (1)"), "{legend}");
        let (stored, legend) = grey(None, 1.0);
        assert_eq!(
            stored,
            [255, 136, 0],
            "and nearly half way between their depths"
        );
        assert!(
            legend.starts_with("stored depth, black to white 0.05"),
            "{legend}"
        );
        assert!(legend.ends_with("grey 1, nothing there (1)"), "{legend}");
    }

    #[test]
    fn mips_and_layers_stand_below_each_other_in_one_range() {
        let content = Content::Texture {
            format: F::R8Unorm,
            parts: vec![[2, 1], [2, 1], [1, 1], [1, 1]],
            bytes: vec![0, 51, 102, 153, 204, 255],
        };
        let Picture { image, legend } = Picture::new("x", &content, None).unwrap();
        assert_eq!(image.size, [2, 4]);
        let grey = |value| [value; 3];
        let rows = [
            [grey(0), grey(51)],
            [grey(102), grey(153)],
            [grey(204), EMPTY],
            [grey(255), EMPTY],
        ];
        assert_eq!(image.rgb, rows.as_flattened().as_flattened());
        assert!(
            legend.starts_with("4 mips and layers one below the other, "),
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
            let picture = Picture::new("x", &texture(format, [2, 1], bytes), None).unwrap();
            assert_eq!(picture.image.rgb, rgb, "{format:?}: {}", picture.legend);
        }
    }

    #[test]
    fn constant_and_huge_ranges_do_not_overflow() {
        for values in [[3.0, 3.0], [f32::MIN, f32::MAX], [f32::NAN, f32::NAN]] {
            Picture::new(
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
            Picture::new("position", &texture(F::Rgba32Float, [2, 1], bytes), None).unwrap();
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
                Picture::new("x", &content, None)
                    .err()
                    .unwrap()
                    .contains(".bin")
            );
        }
    }
}
