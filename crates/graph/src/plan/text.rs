//! Formatting of numbers and names for readers.
//!
//! ```
//! use skiagraph_graph::text::{bytes, cut};
//!
//! assert_eq!(bytes(3 << 20), "3.0 MiB");
//! assert_eq!(cut("create_shadow_map.outer", 13), "create_s…uter");
//! ```

/// Shortens a text to at most `characters` characters (at least 1): an ellipsis replaces the
/// middle, because the end of a name often tells more than its middle. A text that is not longer is
/// returned unchanged.
pub fn cut(text: &str, characters: usize) -> String {
    let chars: Vec<char> = text.chars().collect();
    if chars.len() <= characters {
        return text.to_owned();
    }
    let tail = characters / 3;
    let head = characters.saturating_sub(tail + 1);
    let beginning = chars[..head].iter().chain(['…'].iter());
    beginning.chain(&chars[chars.len() - tail..]).collect()
}

/// Formats a number of bytes in the largest unit in which it is at least 1: `B`, `KiB`, `MiB` or
/// `GiB`, each 1,024 times the one before. It has one decimal, two for `GiB`, none for `B`.
pub fn bytes(bytes: u64) -> String {
    match bytes {
        0..1024 => format!("{bytes} B"),
        1024..1_048_576 => format!("{:.1} KiB", bytes as f64 / 1024.0),
        1_048_576..1_073_741_824 => format!("{:.1} MiB", bytes as f64 / 1_048_576.0),
        _ => format!("{:.2} GiB", bytes as f64 / 1_073_741_824.0),
    }
}
