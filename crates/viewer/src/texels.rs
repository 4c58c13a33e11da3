//! Reads the numbers of a material: the value under the pointer, a histogram, a heat map.

use crate::heat;
use skiagraph_compare::pictures::colours::{ClipPlanes, EMPTY, INVALID, cleared};
use skiagraph_gpu::Content;
use skiagraph_reference::Image;

/// Number of bars of a histogram.
pub const BINS: usize = 64;

/// Texels of one mip of one layer, as numbers.
pub struct Texels {
    /// Width and height in texels.
    pub size: [u32; 2],
    /// Number of values of each texel.
    pub channels: usize,
    values: Vec<f64>,
    is_whole: bool,
    is_depth: bool,
    planes: Option<ClipPlanes>,
}

fn wide<N: Into<f64>>(numbers: Vec<N>) -> Vec<f64> {
    numbers.into_iter().map(Into::into).collect()
}

/// Distribution of the values of a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Least and greatest finite value; the first exceeds the second if there are none.
    pub range: [f64; 2],
    /// Number of values in each of `BINS` equal parts of the range.
    pub bins: [u64; BINS],
    /// Number of finite values.
    pub finite: u64,
    /// Number of NaN and infinite values.
    pub others: u64,
}

impl Texels {
    /// Reads one mip of one layer of a texture. `planes` are the camera's clip planes, by which a
    /// camera's depths become distances; `None` for other content. Returns `None` for a buffer and
    /// for formats that are not read as numbers.
    pub fn new(part: &Content, planes: Option<ClipPlanes>) -> Option<Self> {
        let Content::Texture { format, parts, .. } = part else {
            return None;
        };
        let whole = part.as_u32().map(wide).or_else(|| part.as_i32().map(wide));
        let is_whole = whole.is_some();
        let values = whole.or_else(|| part.as_f32().map(wide))?;
        let (size, count) = (*parts.first()?, values.len());
        let texels = size[0] as usize * size[1] as usize;
        let channels = usize::from(format.components());
        (texels * channels == count && count > 0).then_some(Self {
            size,
            channels,
            values,
            is_whole,
            is_depth: format.is_depth_stencil_format(),
            planes,
        })
    }

    /// Returns the stored values of the texel at x and y, from the top left, as text; a camera's
    /// depth is followed by its distance. `None` outside the picture.
    pub fn text(&self, [x, y]: [u32; 2]) -> Option<String> {
        if x >= self.size[0] || y >= self.size[1] {
            return None;
        }
        let first = (y as usize * self.size[0] as usize + x as usize) * self.channels;
        let text = |&value: &f64| {
            if self.is_whole {
                value.to_string()
            } else {
                (value as f32).to_string()
            }
        };
        let values = &self.values[first..first + self.channels];
        let texts: Vec<String> = values.iter().map(text).collect();
        let depth = self.values[first] as f32;
        let distance = self.planes.map(|planes| planes.distance(depth));
        Some(match distance {
            Some(distance) if self.is_depth => {
                format!("{} = {distance} along the view", texts.join(", "))
            }
            _ => texts.join(", "),
        })
    }

    /// The values of a channel. A camera's depths are distances here, or all would lie in the last
    /// bar; those that nothing has written are left out.
    fn numbers(&self, channel: usize) -> impl Iterator<Item = Option<f64>> {
        let texels = self.size[0] as usize * self.size[1] as usize;
        (0..texels).map(move |texel| {
            let number = self.values[texel * self.channels + channel];
            if !self.is_depth {
                return Some(number);
            }
            let distance = |planes: ClipPlanes| f64::from(planes.distance(number as f32));
            let is_written = number != f64::from(cleared(self.planes));
            is_written.then(|| self.planes.map_or(number, distance))
        })
    }

    /// Returns the histogram of the channel with this index. Depths of a camera count as distances
    /// in scene units; depths that still have the cleared value are left out.
    pub fn histogram(&self, channel: usize) -> Histogram {
        let finite = |number: &f64| number.is_finite();
        let numbers = || self.numbers(channel).flatten();
        let empty = [f64::INFINITY, f64::NEG_INFINITY];
        let range = numbers().filter(finite).fold(empty, |[low, high], number| {
            [low.min(number), high.max(number)]
        });
        let mut histogram = Histogram {
            range,
            bins: [0; BINS],
            finite: 0,
            others: 0,
        };
        for number in numbers() {
            if number.is_finite() {
                histogram.finite += 1;
                let bin = (share(number, range) * BINS as f64) as usize;
                histogram.bins[bin.min(BINS - 1)] += 1;
            } else {
                histogram.others += 1;
            }
        }
        histogram
    }

    /// Draws the channel with this index as a heat map from the first to the second value of
    /// `range`. Magenta marks values that are not finite, grey marks depths that still have the
    /// cleared value.
    pub fn heat(&self, channel: usize, range: [f64; 2]) -> Image {
        let colour = |number: Option<f64>| match number {
            None => EMPTY,
            Some(number) if !number.is_finite() => INVALID,
            Some(number) => heat::colour(share(number, range)),
        };
        Image {
            size: self.size,
            rgb: self.numbers(channel).flat_map(colour).collect(),
        }
    }
}

/// Where a value lies in a range, 0 to 1.
fn share(value: f64, [low, high]: [f64; 2]) -> f64 {
    ((value - low) / (high - low).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::TextureFormat as F;

    fn floats(format: F, size: [u32; 2], values: &[f32]) -> Content {
        Content::Texture {
            format,
            parts: vec![size],
            bytes: values
                .iter()
                .flat_map(|value| value.to_le_bytes())
                .collect(),
        }
    }

    #[test]
    fn a_histogram_counts_every_value_once() {
        let values = [0.0, 0.5, 1.0, 1.0, f32::NAN, f32::INFINITY];
        let texels = Texels::new(&floats(F::R32Float, [3, 2], &values), None).unwrap();
        let histogram = texels.histogram(0);
        assert_eq!((histogram.finite, histogram.others), (4, 2));
        assert_eq!(histogram.range, [0.0, 1.0]);
        let [first, middle, last] = [0, BINS / 2, BINS - 1].map(|bin| histogram.bins[bin]);
        assert_eq!([first, middle, last], [1, 1, 2]);
        let image = texels.heat(0, histogram.range);
        assert_eq!(image.rgb[..3], heat::colour(0.0));
        assert_eq!(image.rgb[12..], [INVALID, INVALID].concat());
    }

    #[test]
    fn channels_are_read_and_counted_by_themselves() {
        let values = [1.0, -2.0, 3.0, 5.0];
        let texels = Texels::new(&floats(F::Rg32Float, [2, 1], &values), None).unwrap();
        assert_eq!(texels.text([1, 0]).as_deref(), Some("3, 5"));
        assert_eq!(texels.text([2, 0]), None);
        assert_eq!(texels.histogram(1).range, [-2.0, 5.0]);
    }

    #[test]
    fn a_cameras_depths_are_distances_and_cleared_ones_nothing() {
        let planes = ClipPlanes {
            near: 1.0,
            far: 11.0,
        };
        let depth = |z: f32| (11.0 - z) / (z * 10.0);
        let content = floats(F::Depth32Float, [3, 1], &[depth(2.0), depth(4.0), 0.0]);
        let texels = Texels::new(&content, Some(planes)).unwrap();
        let histogram = texels.histogram(0);
        assert_eq!(histogram.finite, 2);
        assert!((histogram.range[1] - 4.0).abs() < 1e-4, "{histogram:?}");
        assert!(texels.text([1, 0]).unwrap().ends_with("along the view"));
        assert_eq!(texels.heat(0, histogram.range).rgb[6..], EMPTY);
    }

    #[test]
    fn equal_and_missing_values_divide_by_nothing() {
        let same = floats(F::R32Float, [2, 1], &[3.0, 3.0]);
        let histogram = Texels::new(&same, None).unwrap().histogram(0);
        assert_eq!(histogram.bins[0], 2);
        let none = floats(F::R32Float, [1, 1], &[f32::NAN]);
        assert_eq!(Texels::new(&none, None).unwrap().histogram(0).finite, 0);
        assert!(Texels::new(&Content::Buffer(vec![0; 4]), None).is_none());
    }
}
