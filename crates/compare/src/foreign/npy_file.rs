//! Decodes arrays of NumPy, `.npy`, of the versions 1 to 3 of the format.

use crate::foreign::decoded::{FLOAT, HALF, Raster, checked};
use exr::prelude::f16;
use itertools::Itertools;

/// Longest header of an array of numbers.
const LONGEST_HEADER: usize = 4096;

/// A type of numbers as NumPy names it, with the bytes of a number, and how it is read from them,
/// the first byte being the lowest.
type Kind = (&'static str, usize, fn(u64) -> f64);

const KINDS: [Kind; 10] = [
    ("|b1", 1, |bits| f64::from(u8::from(bits != 0))),
    ("|u1", 1, |bits| bits as f64),
    ("<u1", 1, |bits| bits as f64),
    ("<u2", 2, |bits| bits as f64),
    ("<u4", 4, |bits| bits as f64),
    ("<i4", 4, |bits| f64::from(bits as i32)),
    ("<i8", 8, |bits| bits as i64 as f64),
    ("<f2", 2, |bits| f16::from_bits(bits as u16).into()),
    ("<f4", 4, |bits| f32::from_bits(bits as u32).into()),
    ("<f8", 8, f64::from_bits),
];

/// Decodes an array of the shape (height, width) or (height, width, channels).
///
/// # Errors
/// The reason, as the rest of a message that begins with the file.
pub(crate) fn decode(bytes: &[u8]) -> Result<Raster, String> {
    let damaged = || "its header is cut off or damaged; write it anew with numpy.save".to_owned();
    let (length, begin) = match bytes.get(6..12) {
        Some(&[1, _, a, b, ..]) => (usize::from(u16::from_le_bytes([a, b])), 10),
        Some(&[2 | 3, _, a, b, c, d]) => (u32::from_le_bytes([a, b, c, d]) as usize, 12),
        _ => return Err(damaged()),
    };
    if length > LONGEST_HEADER {
        return Err(format!(
            "its header has {length} bytes, at most {LONGEST_HEADER} are read: save a plain array \
             of numbers"
        ));
    }
    let header = bytes.get(begin..begin + length).ok_or_else(damaged)?;
    let header = std::str::from_utf8(header).map_err(|_| damaged())?;
    let name = text_of(header, "descr").ok_or_else(|| {
        "its items are not plain numbers; save an array of one type, such as \
         array.astype('<f4')"
            .to_owned()
    })?;
    let kind = KINDS.iter().find(|(descr, ..)| *descr == name);
    let Some(&(_, width, read)) = kind else {
        return Err(format!(
            "its numbers are of the type `{name}`; expected <f4, <f2, <f8, |u1, <u2, <u4, <i4, \
             <i8 or |b1: save array.astype('<f4')"
        ));
    };
    if value_of(header, "fortran_order").is_none_or(|it| !it.starts_with("False")) {
        return Err("its columns stand before its rows (fortran_order); save \
             numpy.ascontiguousarray(array)"
            .into());
    }
    let shape = shape_of(header).ok_or_else(damaged)?;
    let (size, channels) = match shape[..] {
        [height, columns] => ([columns, height], 1),
        [height, columns, channels @ 1..=4] => ([columns, height], channels),
        _ => {
            return Err(format!(
                "its shape is ({}); expected (height, width) or (height, width, channels) of 1 to \
                 4 channels",
                shape.iter().join(", ")
            ));
        }
    };
    let size = checked(size, channels)?;
    let count = u64::from(size[0]) * u64::from(size[1]) * channels;
    let numbers = &bytes[begin + length..];
    let (promised, held) = (count * width as u64, numbers.len() as u64);
    if held != promised {
        return Err(format!(
            "its header promises {promised} bytes of numbers, and it has {held}: write it anew \
             with numpy.save"
        ));
    }
    let number = |bytes: &[u8]| {
        let mut eight = [0; 8];
        eight[..width].copy_from_slice(bytes);
        read(u64::from_le_bytes(eight))
    };
    let values: Vec<f64> = numbers.chunks_exact(width).map(number).collect();
    // The number that stands for 1: integers are 0 and 1 unless one is greater.
    let greatest = match name {
        "|u1" | "<u1" => Some(255.0),
        "<u2" => Some(65_535.0),
        _ => None,
    };
    let is_of_greatest = values.iter().any(|value| *value > 1.0);
    Ok(Raster {
        size,
        channels: channels as usize,
        has_alpha: matches!(channels, 2 | 4),
        whole: greatest.filter(|_| is_of_greatest),
        precision: match greatest {
            Some(greatest) => 1.0 / greatest,
            None if name == "<f2" => HALF,
            None => FLOAT,
        },
        values,
        format: format!("NPY, {}", name.trim_start_matches(['<', '|'])),
        ..Raster::default()
    })
}

/// The text behind a key of the header's dictionary.
fn value_of<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let (_, behind) = header.split_once(&format!("'{key}'"))?;
    Some(behind.trim_start().strip_prefix(':')?.trim_start())
}

fn text_of<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let behind = value_of(header, key)?.strip_prefix('\'')?;
    behind.split_once('\'').map(|(text, _)| text)
}

fn shape_of(header: &str) -> Option<Vec<u64>> {
    let shape = value_of(header, "shape")?.strip_prefix('(')?;
    let parts = shape.split_once(')')?.0.split(',').map(str::trim);
    let parts = parts.filter(|part| !part.is_empty());
    parts.map(|part| part.parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(descr: &str, order: &str, shape: &str, numbers: &[u8]) -> Vec<u8> {
        let header =
            format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}\n");
        let mut file = b"\x93NUMPY\x01\x00".to_vec();
        file.extend((header.len() as u16).to_le_bytes());
        file.extend(header.bytes());
        file.extend(numbers);
        file
    }

    fn values(descr: &str, numbers: &[u8]) -> (Vec<f64>, Option<f64>) {
        let decoded = decode(&file(descr, "False", "(1, 2)", numbers)).unwrap();
        assert_eq!((decoded.size, decoded.channels), ([2, 1], 1));
        (decoded.values, decoded.whole)
    }

    #[test]
    fn every_type_is_read_as_numbers() {
        let pair = |one: [u8; 8], other: [u8; 8], width: usize| {
            [&one[8 - width..], &other[8 - width..]].concat()
        };
        let high = |bytes: &[u8]| {
            let mut eight = [0; 8];
            eight[8 - bytes.len()..].copy_from_slice(bytes);
            eight
        };
        let [half, one] = [0.5f32.to_le_bytes(), 1f32.to_le_bytes()];
        let floats = pair(high(&half), high(&one), 4);
        assert_eq!(values("'<f4'", &floats), (vec![0.5, 1.0], None));
        let doubles = [0.5f64.to_le_bytes(), 1f64.to_le_bytes()].concat();
        assert_eq!(values("'<f8'", &doubles), (vec![0.5, 1.0], None));
        assert_eq!(values("'<f2'", &[0, 0x38, 0, 0x3c]), (vec![0.5, 1.0], None));
        assert_eq!(values("'|b1'", &[0, 1]), (vec![0.0, 1.0], None));
        assert_eq!(values("'|u1'", &[0, 1]), (vec![0.0, 1.0], None));
        assert_eq!(values("'|u1'", &[1, 255]), (vec![1.0, 255.0], Some(255.0)));
        assert_eq!(
            values("'<u2'", &[0, 1, 0, 0]),
            (vec![256.0, 0.0], Some(65_535.0))
        );
        assert_eq!(values("'<i8'", &[[1; 8], [0; 8]].concat()).0[1], 0.0);
    }

    #[test]
    fn arrays_that_are_no_pictures_are_told_with_the_way_out() {
        let refusal = |file: Vec<u8>| decode(&file).err().unwrap();
        for (file, expected) in [
            (
                file("'>f4'", "False", "(1, 2)", &[0; 8]),
                "array.astype('<f4')",
            ),
            (
                file("[('r', '<f4')]", "False", "(1, 2)", &[0; 8]),
                "not plain numbers",
            ),
            (
                file("'<f4'", "True", "(1, 2)", &[0; 8]),
                "numpy.ascontiguousarray",
            ),
            (file("'<f4'", "False", "(2,)", &[0; 8]), "its shape is (2)"),
            (
                file("'<f4'", "False", "(1, 2, 9)", &[0; 72]),
                "expected (height, width)",
            ),
            (
                file("'<f4'", "False", "(1, 2)", &[0; 7]),
                "promises 8 bytes of numbers, and it has 7",
            ),
            (
                file("'<f4'", "False", "(99999999, 99999999)", &[0; 8]),
                "at most 16384 pixels",
            ),
            (
                file("'<f4'", "False", "(0, 2)", &[]),
                "it has no pixels (2x0)",
            ),
            (b"\x93NUMPY\x01\x00\xff".to_vec(), "cut off or damaged"),
            (
                b"\x93NUMPY\x02\x00\xff\xff\xff\x7f".to_vec(),
                "its header has 2147483647 bytes",
            ),
        ] {
            let message = refusal(file);
            assert!(message.contains(expected), "{message}");
        }
    }
}
