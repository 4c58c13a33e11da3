//! The container of a binary file: a header, then chunks.

use super::fault::{Fault, of_another_version};
use crate::text::without_mark;
use std::borrow::Cow;

const HEADER: usize = 12;

/// JSON, and the buffer behind it.
type Parts<'a> = (Cow<'a, [u8]>, Option<&'a [u8]>);

/// A file's JSON, and the buffer behind it in a binary file. Chunks of other kinds are passed over.
///
/// # Errors
/// The file is cut off, or of another version.
pub(super) fn split(bytes: &[u8]) -> Result<Parts<'_>, Fault> {
    if !bytes.starts_with(b"glTF") {
        return Ok((without_mark(bytes), None));
    }
    let fail = |why: String| ("its binary container".to_owned(), why);
    let there = bytes.len();
    let cut = |length: usize| {
        fail(format!(
            "the file is cut off: it should have {length} bytes, but {there} are there; copy or \
             download it anew"
        ))
    };
    let word = |at: usize| {
        let word = bytes.get(at..at + 4)?.try_into().ok()?;
        Some(u32::from_le_bytes(word))
    };
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(cut(HEADER));
    };
    if version != 2 {
        return Err(fail(of_another_version(&format!("{version}.0"))));
    }
    let length = length as usize;
    if length > there {
        return Err(cut(length));
    }
    let (mut json, mut blob) = (None, None);
    let mut at = HEADER;
    while let (Some(size), Some(kind)) = (word(at), bytes.get(at + 4..at + 8)) {
        let begin = at + 8;
        let end = begin.saturating_add(size as usize);
        let Some(chunk) = bytes.get(begin..end) else {
            // Bytes behind the length in the header are no part of the file.
            if at >= length && json.is_some() {
                break;
            }
            return Err(cut(end));
        };
        match kind {
            b"JSON" if json.is_none() => json = Some(chunk),
            b"BIN\0" if json.is_some() && blob.is_none() => blob = Some(chunk),
            _ => {}
        }
        at = end.next_multiple_of(4);
    }
    let json = json.ok_or_else(|| fail("it holds no JSON: it is damaged".to_owned()))?;
    Ok((without_mark(json), blob))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(length: u32, chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let mut bytes = b"glTF\x02\0\0\0".to_vec();
        bytes.extend(length.to_le_bytes());
        for (kind, chunk) in chunks {
            bytes.extend((chunk.len() as u32).to_le_bytes());
            bytes.extend(*kind);
            bytes.extend(*chunk);
        }
        bytes
    }

    #[test]
    fn chunks_are_told_apart() {
        let bytes = file(
            0,
            &[(b"JSON", b"{}  "), (b"odd ", b"1234"), (b"BIN\0", b"5678")],
        );
        assert_eq!(split(&bytes), Ok((b"{}  ".into(), Some(&b"5678"[..]))));
        assert_eq!(split(b"{}"), Ok((b"{}".into(), None)));
        let mut longer = file(24, &[(b"JSON", b"{}  ")]);
        longer.extend([255; 9]);
        assert_eq!(split(&longer), Ok((b"{}  ".into(), None)));
    }

    #[test]
    fn a_cut_file_says_so_wherever_it_is_cut() {
        let whole = file(32, &[(b"JSON", b"{}  "), (b"BIN\0", b"")]);
        assert_eq!(whole.len(), 32);
        for end in 4..whole.len() {
            let (_, why) = split(&whole[..end]).unwrap_err();
            assert!(why.starts_with("the file is cut off"), "{why}");
        }
        // The header knows of no more, its chunks do.
        let (_, why) = split(&file(20, &[(b"JSON", b"{}  ")])[..22]).unwrap_err();
        assert!(why.starts_with("the file is cut off"), "{why}");
        let (_, why) = split(b"glTF\x01\0\0\0\x14\0\0\0").unwrap_err();
        assert!(why.contains("glTF 1.0"), "{why}");
    }
}
