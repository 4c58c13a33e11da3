//! Encodes values of pixels as files for other programs: NumPy arrays and OpenEXR pictures.
//!
//! Rows run from the top to the bottom, and pixels in them from left to right.
//!
//! ```
//! use skiagraph_compare::pictures::data::{Array, DataFormat, Values};
//!
//! let array = Array::of_pixels([2, 1], Values::F32(vec![0.25, 1.0]));
//! let npy = array.encode(DataFormat::Npy)?;
//! assert!(npy.starts_with(b"\x93NUMPY\x01\x00"));
//! assert!(npy.ends_with(&[0, 0, 128, 63])); // 1.0
//! let exr = array.encode(DataFormat::Exr)?;
//! assert!(exr.starts_with(&[0x76, 0x2f, 0x31, 0x01]));
//! # Ok::<(), String>(())
//! ```

use crate::graphs::shadow_method::Outputs;
use exr::prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Vec2, WritableImage};
use itertools::Itertools;
use skiagraph_gpu::Content;
use skiagraph_reference::GroundTruth;
use std::{borrow::Cow, io::Cursor, str::FromStr};

/// Formats of data files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DataFormat {
    /// Array of NumPy, `.npy`.
    Npy,
    /// OpenEXR picture, `.exr`, with a channel for each channel of the texels.
    Exr,
}

impl DataFormat {
    /// Returns the extension of files of the format.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Npy => "npy",
            Self::Exr => "exr",
        }
    }
}

impl FromStr for DataFormat {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut formats = [Self::Npy, Self::Exr].into_iter();
        let format = formats.find(|format| format.extension() == text);
        format.ok_or_else(|| "expected npy or exr".into())
    }
}

/// Numbers of an array, all of one type.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// 32-bit floating-point numbers.
    F32(Vec<f32>),
    /// Unsigned 32-bit integers.
    U32(Vec<u32>),
    /// Signed 32-bit integers.
    I32(Vec<i32>),
    /// Unsigned 8-bit integers.
    U8(Vec<u8>),
    /// Booleans.
    Bool(Vec<bool>),
}

/// Texels of one or several layers of the same size, with one or several numbers each.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Width and height of each layer in texels.
    size: [u32; 2],
    /// Number of layers.
    layers: usize,
    /// Numbers per texel.
    channels: usize,
    /// Numbers of all texels: those of a texel together, rows from the top, layers in order.
    values: Values,
}

impl Array {
    /// Creates an array of one number for each pixel of a viewport, row by row from the top left.
    pub fn of_pixels(size: [u32; 2], values: Values) -> Self {
        Self {
            size,
            layers: 1,
            channels: 1,
            values,
        }
    }

    /// Creates an array of the texels of a texture; its mips and layers become layers of the array.
    ///
    /// # Errors
    /// The reason why the content cannot become an array, such as a buffer or mips of several
    /// sizes, as the rest of a sentence that begins with the material's name.
    pub fn from_content(content: &Content) -> Result<Self, String> {
        let Content::Texture { format, parts, .. } = content else {
            return Err("is a buffer and has no texels; save it as .csv or .bin".into());
        };
        let Ok(&size) = parts.iter().all_equal_value() else {
            return Err("has mips of several sizes; name one, or save it as .bin".into());
        };
        let signed = || content.as_i32().map(Values::I32);
        let unsigned = || content.as_u32().map(Values::U32);
        let values = content.as_f32().map(Values::F32).or_else(unsigned);
        let (layers, channels) = (parts.len(), usize::from(format.components()));
        let count = size[0] as usize * size[1] as usize * layers * channels;
        let is_whole = |values: &Values| values.described().0.len() == 4 * count;
        let values = values.or_else(signed).filter(is_whole).ok_or_else(|| {
            format!("has the format {format:?}, whose texels are not numbers; save it as .bin")
        })?;
        Ok(Self {
            size,
            layers,
            channels,
            values,
        })
    }

    /// Returns the array as a file.
    ///
    /// # Errors
    /// The reason why the format cannot hold the array, such as several layers or signed integers
    /// in OpenEXR, as the rest of a sentence that begins with the material's name.
    pub fn encode(&self, format: DataFormat) -> Result<Vec<u8>, String> {
        match format {
            DataFormat::Npy => Ok(self.npy()),
            DataFormat::Exr => self.exr(),
        }
    }

    /// Returns shape and type in NumPy's notation, rows first: `an array (256, 512) of f4`.
    pub fn text(&self) -> String {
        let (shape, kind) = (self.shape(), self.values.described().1);
        let kind = kind.trim_start_matches(['<', '|']);
        format!("an array {shape} of {kind}")
    }

    /// Shape as Python writes it.
    fn shape(&self) -> String {
        let layers = (self.layers > 1).then_some(self.layers);
        let channels = (self.channels > 1).then_some(self.channels);
        let [width, height] = self.size.map(|it| it as usize);
        let mut shape = layers.into_iter().chain([height, width]).chain(channels);
        format!("({})", shape.join(", "))
    }

    /// The file of NumPy's format 1.0: magic, length of the header, a Python dictionary that ends
    /// with a newline at a multiple of 64 bytes, the numbers.
    fn npy(&self) -> Vec<u8> {
        const BEFORE_HEADER: usize = 10;
        let (shape, (bytes, kind)) = (self.shape(), self.values.described());
        let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
        let whole = (BEFORE_HEADER + header.len() + 1).next_multiple_of(64);
        let width = whole - BEFORE_HEADER - 1;
        let mut file = b"\x93NUMPY\x01\x00".to_vec();
        file.extend(((width + 1) as u16).to_le_bytes());
        file.extend(format!("{header:width$}\n").bytes());
        file.extend(bytes);
        file
    }

    fn exr(&self) -> Result<Vec<u8>, String> {
        if self.layers > 1 {
            return Err("has several layers; name one, or save it as .npy".into());
        }
        let names: &[&str] = match self.channels {
            1 => &["Y"],
            count => &["R", "G", "B", "A"][..count.min(4)],
        };
        let step = self.channels;
        let samples = |first: usize| match &self.values {
            Values::F32(floats) => Ok(FlatSamples::F32(every(floats, first, step))),
            Values::U32(words) => Ok(FlatSamples::U32(every(words, first, step))),
            Values::U8(bytes) => Ok(FlatSamples::U32(every(bytes, first, step))),
            Values::Bool(flags) => Ok(FlatSamples::U32(every(flags, first, step))),
            Values::I32(_) => {
                Err("has signed integers, which OpenEXR lacks; save it as .npy".to_owned())
            }
        };
        let channels = names.iter().enumerate();
        let channels = channels.map(|(index, name)| Ok(AnyChannel::new(*name, samples(index)?)));
        let channels = AnyChannels::sort(channels.collect::<Result<_, String>>()?);
        let [width, height] = self.size.map(|it| it as usize);
        let size = Vec2(width, height);
        let picture = Image::from_encoded_channels(size, Encoding::SMALL_LOSSLESS, channels);
        let mut file = Cursor::new(Vec::new());
        let written = picture.write().to_buffered(&mut file);
        written.map_err(|error| format!("cannot be written as OpenEXR: {error}"))?;
        Ok(file.into_inner())
    }
}

impl Values {
    /// Bytes of the numbers, little-endian as on every machine that wgpu runs on, and the type as
    /// NumPy names it.
    fn described(&self) -> (&[u8], &'static str) {
        match self {
            Self::F32(floats) => (bytemuck::cast_slice(floats), "<f4"),
            Self::U32(words) => (bytemuck::cast_slice(words), "<u4"),
            Self::I32(signed) => (bytemuck::cast_slice(signed), "<i4"),
            Self::U8(bytes) => (bytes, "|u1"),
            Self::Bool(flags) => (bytemuck::cast_slice(flags), "|b1"),
        }
    }
}

/// Every number of one channel.
fn every<T: Copy, S: From<T>>(values: &[T], first: usize, step: usize) -> Vec<S> {
    let values = values.iter().skip(first).step_by(step);
    values.map(|value| S::from(*value)).collect()
}

/// Returns arrays of the pixels of a method and of the [reference](crate#terms), each behind the
/// name that ends its file's name. The first list is the method's (`visibility`, `status`), the
/// second the reference's (`visibility`, `status`, and `indeterminate`: true where rounding may
/// flip the answer). Both arrays `visibility` hold [shares of light](crate#terms) as f32, 0 to 1;
/// hard answers are 0 and 1.
pub fn judged(outputs: &Outputs, ground_truth: &GroundTruth) -> [Vec<(&'static str, Array)>; 2] {
    let truth = &ground_truth.pixels;
    let array = |values| Array::of_pixels(truth.viewport, values);
    let floats = |shares: Cow<[f32]>| array(Values::F32(shares.into_owned()));
    let status = outputs.status.iter().map(|&status| status as u8).collect();
    let indeterminate = array(Values::Bool(truth.indeterminate.clone()));
    let own = vec![
        ("visibility", floats(outputs.shown())),
        ("status", array(Values::U8(status))),
    ];
    let reference = vec![
        ("visibility", floats(ground_truth.shares())),
        ("status", array(Values::U8(truth.status()))),
        ("indeterminate", indeterminate),
    ];
    [own, reference]
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::TextureFormat as F;

    /// Shape and type that the header of an array names, and its bytes.
    fn npy(array: &Array) -> (String, Vec<u8>) {
        let file = array.encode(DataFormat::Npy).unwrap();
        let length = usize::from(u16::from_le_bytes([file[8], file[9]]));
        assert_eq!(
            (&file[..8], (10 + length) % 64),
            (&b"\x93NUMPY\x01\x00"[..], 0)
        );
        let header = std::str::from_utf8(&file[10..10 + length]).unwrap();
        assert!(header.ends_with('\n'));
        (header.trim_end().to_owned(), file[10 + length..].to_vec())
    }

    /// Name and values of each channel of a picture.
    fn exr(array: &Array) -> Vec<(String, FlatSamples)> {
        use exr::prelude::{ReadChannels, ReadLayers};
        let file = array.encode(DataFormat::Exr).unwrap();
        let layers = exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level();
        let picture = layers.all_channels().first_valid_layer().all_attributes();
        let picture = picture.from_buffered(Cursor::new(file)).unwrap();
        let size = picture.layer_data.size;
        assert_eq!([size.x() as u32, size.y() as u32], array.size);
        let channels = picture.layer_data.channel_data.list.into_iter();
        channels
            .map(|channel| (channel.name.to_string(), channel.sample_data))
            .collect()
    }

    #[test]
    fn shares_and_statuses_are_read_back_as_they_were() {
        let shares = vec![0.0, 0.25, 1.0, f32::NAN, 0.5, 0.75];
        let array = Array::of_pixels([3, 2], Values::F32(shares.clone()));
        let (header, bytes) = npy(&array);
        assert_eq!(
            header,
            "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }"
        );
        let bits: Vec<u8> = shares
            .iter()
            .flat_map(|share| share.to_le_bytes())
            .collect();
        assert_eq!(bytes, bits);
        let [(name, FlatSamples::F32(read))] = &exr(&array)[..] else {
            panic!("one channel of floats")
        };
        assert_eq!(name, "Y");
        let bits = |shares: &[f32]| shares.iter().map(|it| it.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(read), bits(&shares));
        let status = Array::of_pixels([2, 1], Values::U8(vec![2, 4]));
        assert!(npy(&status).0.contains("'|u1'") && npy(&status).1 == [2, 4]);
        assert!(matches!(&exr(&status)[0].1, FlatSamples::U32(read) if read == &[2, 4]));
        let band = Array::of_pixels([2, 1], Values::Bool(vec![true, false]));
        assert!(npy(&band).0.contains("'|b1'") && npy(&band).1 == [1, 0]);
    }

    fn texture(format: F, parts: Vec<[u32; 2]>, bytes: Vec<u8>) -> Content {
        Content::Texture {
            format,
            parts,
            bytes,
        }
    }

    #[test]
    fn textures_have_layers_and_channels_or_a_reason() {
        let layers = texture(F::Rg8Unorm, vec![[1, 2]; 3], vec![255; 12]);
        let array = Array::from_content(&layers).unwrap();
        assert!(
            npy(&array)
                .0
                .contains("'<f4', 'fortran_order': False, 'shape': (3, 2, 1, 2)")
        );
        let why = array.encode(DataFormat::Exr).unwrap_err();
        assert!(why.contains("several layers"), "{why}");
        let colours = texture(F::Rg8Uint, vec![[2, 1]], vec![1, 2, 3, 4]);
        let read = exr(&Array::from_content(&colours).unwrap());
        let expected = [("G", vec![2, 4]), ("R", vec![1, 3])];
        let expected = expected.map(|(name, samples)| (name.to_owned(), FlatSamples::U32(samples)));
        assert_eq!(read, expected);
        let signed = texture(F::R8Sint, vec![[1, 1]], vec![255]);
        let signed = Array::from_content(&signed).unwrap();
        assert_eq!(npy(&signed).1, (-1i32).to_le_bytes());
        assert!(signed.encode(DataFormat::Exr).unwrap_err().contains(".npy"));
        for (refused, why) in [
            (Content::Buffer(vec![0; 4]), "is a buffer"),
            (
                texture(F::R8Uint, vec![[2, 2], [1, 1]], vec![0; 5]),
                "several sizes",
            ),
            (
                texture(F::Rgb10a2Unorm, vec![[1, 1]], vec![0; 4]),
                "Rgb10a2Unorm",
            ),
        ] {
            let message = Array::from_content(&refused).unwrap_err();
            assert!(message.contains(why), "{message}");
        }
    }
}
