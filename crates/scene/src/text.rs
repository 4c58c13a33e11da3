//! Text and names of files that other programs wrote: byte order marks and encodings.

use crate::handed::is_file;
use memchr::{memchr, memchr2};
use std::borrow::Cow;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// The mark at the beginning of a file in UTF-8 that some editors write.
const UTF8_MARK: &[u8] = b"\xef\xbb\xbf";

/// Characters of the bytes 0x80 to 0x9f in Windows-1252. The five that it leaves open stand for
/// themselves, so that different names stay different.
const WINDOWS_1252: [char; 32] = [
    '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž', '\u{8f}',
    '\u{90}', '‘', '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}', 'ž', 'Ÿ',
];

/// A file's bytes without a byte order mark; those of UTF-16 become UTF-8. UTF-16 without a mark is
/// known by the zero byte of its first character.
pub(crate) fn without_mark(bytes: &[u8]) -> Cow<'_, [u8]> {
    let (rest, word): (_, fn([u8; 2]) -> u16) = match bytes {
        [0xff, 0xfe, rest @ ..] => (rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => (rest, u16::from_be_bytes),
        [1..=255, 0, 1..=255, 0, ..] => (bytes, u16::from_le_bytes),
        [0, 1..=255, 0, 1..=255, ..] => (bytes, u16::from_be_bytes),
        _ => return bytes.strip_prefix(UTF8_MARK).unwrap_or(bytes).into(),
    };
    let words = rest.as_chunks::<2>().0.iter().map(|pair| word(*pair));
    let text: String = char::decode_utf16(words)
        .map(|read| read.unwrap_or(char::REPLACEMENT_CHARACTER))
        .collect();
    text.into_bytes().into()
}

/// Takes the next line off a text, without its end; the flag says whether it had one. Lines end as
/// on Unix, on Windows or on old Macs.
pub(crate) fn next_line<'a>(rest: &mut &'a str) -> Option<(&'a str, bool)> {
    if rest.is_empty() {
        return None;
    }
    let Some(end) = memchr2(b'\n', b'\r', rest.as_bytes()) else {
        return Some((std::mem::take(rest), false));
    };
    let (line, behind) = rest.split_at(end);
    let length = if behind.starts_with("\r\n") { 2 } else { 1 };
    *rest = &behind[length..];
    Some((line, true))
}

/// A file's lines as text, each as [`line_text`] reads it.
pub(crate) fn lines_text(bytes: &[u8]) -> Cow<'_, str> {
    if let Ok(text) = std::str::from_utf8(bytes) {
        return text.into();
    }
    let lines = bytes.split_inclusive(|byte| matches!(byte, b'\n' | b'\r'));
    lines.map(line_text).collect::<String>().into()
}

/// A line as text. One that is not UTF-8 is read as Windows-1252, which gives every byte a
/// character of its own: keywords and numbers are the same in all encodings that contain ASCII, and
/// names that differ stay different.
pub(crate) fn line_text(line: &[u8]) -> Cow<'_, str> {
    if let Ok(text) = std::str::from_utf8(line) {
        return text.into();
    }
    let character = |&byte: &u8| match byte {
        0x80..=0x9f => WINDOWS_1252[usize::from(byte - 0x80)],
        _ => char::from(byte),
    };
    line.iter().map(character).collect::<String>().into()
}

/// The bytes of a text in Windows-1252, if it has no other characters: the reverse of
/// [`line_text`].
fn windows_1252(text: &str) -> Option<Vec<u8>> {
    let byte = |character: char| {
        let place = WINDOWS_1252.iter().position(|other| *other == character);
        place.map_or(u8::try_from(character).ok(), |place| {
            Some(0x80 + place as u8)
        })
    };
    text.chars().map(byte).collect()
}

/// A name of a file from its bytes, which are in any encoding where file names are.
fn file_name(bytes: Vec<u8>) -> PathBuf {
    #[cfg(unix)]
    let name = <OsString as std::os::unix::ffi::OsStringExt>::from_vec(bytes);
    #[cfg(not(unix))]
    let name = OsString::from(line_text(&bytes).into_owned());
    name.into()
}

/// The file of that name in a folder. Its name may be in the encoding that the text was read from.
pub(crate) fn file_in(folder: &Path, name: &str) -> PathBuf {
    let path = folder.join(name);
    let bytes = windows_1252(name).filter(|_| !name.is_ascii() && !is_file(&path));
    let other = bytes.map(|bytes| folder.join(file_name(bytes)));
    other.filter(|other| is_file(other)).unwrap_or(path)
}

/// True if the name of a file ends in `.extension`, in small letters or capitals.
pub(crate) fn has_extension(path: &Path, extension: &str) -> bool {
    let own = path.extension();
    own.is_some_and(|own| own.eq_ignore_ascii_case(extension))
}

/// The part of a statement before a comment.
pub(crate) fn without_comment(rest: &str) -> &str {
    &rest[..memchr(b'#', rest.as_bytes()).unwrap_or(rest.len())]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(bytes: &[u8]) -> String {
        String::from_utf8(without_mark(bytes).into_owned()).unwrap()
    }

    #[test]
    fn byte_order_marks_are_followed() {
        assert_eq!(text(b"v 1"), "v 1");
        assert_eq!(text(b"\xef\xbb\xbfv 1"), "v 1");
        assert_eq!(text(b"\xff\xfev\0\xe9\0"), "vé");
        assert_eq!(text(b"\xfe\xff\0v\0\xe9"), "vé");
        assert_eq!(text(b"v\0 \0"), "v ");
        assert_eq!(text(b"\0v\0 "), "v ");
        // Half a character at the end, and half of a pair.
        assert_eq!(text(b"\xff\xfev\0 "), "v");
        assert_eq!(text(b"\xff\xfe\0\xd8v\0"), "\u{fffd}v");
        assert_eq!(text(b"\0\0\0\0"), "\0\0\0\0");
    }

    #[test]
    fn lines_end_in_three_ways() {
        let mut rest = "a\nb\r\nc\rd\n\re";
        let lines = std::iter::from_fn(|| next_line(&mut rest));
        let lines: Vec<(&str, bool)> = lines.collect();
        let ended = ["a", "b", "c", "d", ""].map(|line| (line, true));
        assert_eq!(lines, [&ended[..], &[("e", false)]].concat());
    }

    #[test]
    fn each_line_has_its_own_encoding() {
        assert_eq!(lines_text("ä\nö\r".as_bytes()), "ä\nö\r");
        assert_eq!(lines_text(b"\xc3\xa4\r\n\xe4\r\xc3\xa4"), "ä\r\nä\rä");
    }

    #[test]
    fn every_byte_has_a_character_of_its_own() {
        assert_eq!(line_text("größe".as_bytes()), "größe");
        assert_eq!(line_text(b"gr\xf6\xdfe \x80"), "größe €");
        let bytes: Vec<u8> = (0..=255).collect();
        let characters: std::collections::HashSet<char> = line_text(&bytes).chars().collect();
        assert_eq!(characters.len(), 256);
        assert_eq!(windows_1252(&line_text(&bytes)), Some(bytes));
        assert_eq!(windows_1252("größe €").unwrap(), b"gr\xf6\xdfe \x80");
        assert_eq!(windows_1252("Ω"), None);
    }
}
