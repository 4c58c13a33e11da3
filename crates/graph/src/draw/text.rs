//! Words in drawings: escaped, measured without a font, and numbers as people read them.

/// Text for XML, attributes included. Characters that XML cannot hold become U+FFFD.
pub(super) fn xml(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\t' | '\n' | '\r' => escaped.push(' '),
            '\0'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            _ => escaped.push(character),
        }
    }
    escaped
}

/// Width of a character of size 1 in a wide sans-serif (DejaVu Sans), rounded up: which font a reader has is not known.
fn advance(character: char) -> f64 {
    match character {
        'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' | ' ' => 0.36,
        'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '-' | '/' | '·' => 0.44,
        'm' | 'w' | 'M' | 'W' | '@' | '%' | '…' => 1.0,
        'A'..='Z' => 0.76,
        '\0'..='\u{2fff}' => 0.64,
        _ => 1.1,
    }
}

/// Width of a text, never less than what a browser makes of it.
pub(super) fn width(text: &str, size: f64) -> f64 {
    size * text.chars().map(advance).sum::<f64>()
}

/// Width of a text in bold.
pub(super) fn bold(text: &str, size: f64) -> f64 {
    1.1 * width(text, size)
}

/// The text, cut to at most `characters`, with an ellipsis where something is missing. The end of a name often tells more than
/// its middle, so the middle goes.
pub(crate) fn cut(text: &str, characters: usize) -> String {
    let all: Vec<char> = text.chars().collect();
    if all.len() <= characters {
        return text.to_owned();
    }
    let tail = characters / 3;
    let head = characters.saturating_sub(tail + 1);
    all[..head]
        .iter()
        .chain(['…'].iter())
        .chain(&all[all.len() - tail..])
        .collect()
}

/// The text in lines no wider than `room`, broken between words; a longer word stands by itself, cut.
pub(super) fn wrap(text: &str, size: f64, room: f64) -> Vec<String> {
    let most = (room / (0.64 * size)).max(8.0) as usize;
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let word = cut(word, most);
        match lines.last_mut() {
            Some(line) if width(line, size) + width(&word, size) + 0.36 * size <= room => {
                line.push(' ');
                line.push_str(&word);
            }
            _ => lines.push(word),
        }
    }
    lines
}

/// Bytes in the unit that fits.
pub(crate) fn bytes(bytes: u64) -> String {
    match bytes {
        0..1024 => format!("{bytes} B"),
        1024..1_048_576 => format!("{:.1} KiB", bytes as f64 / 1024.0),
        1_048_576..1_073_741_824 => format!("{:.1} MiB", bytes as f64 / 1_048_576.0),
        _ => format!("{:.2} GiB", bytes as f64 / 1_073_741_824.0),
    }
}

/// `1 pass`, `2 passes`.
pub(super) fn plural(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_xml_cannot_hold_is_replaced() {
        assert_eq!(
            xml("a<b>&\"c'\u{7}\n"),
            "a&lt;b&gt;&amp;&quot;c&#39;\u{fffd} "
        );
    }

    #[test]
    fn long_words_are_cut_in_the_middle_and_long_texts_between_words() {
        assert_eq!(cut("eye.primitive", 20), "eye.primitive");
        assert_eq!(cut("a_very_long_name_indeed", 12), "a_very_…deed");
        let lines = wrap(
            "nothing that an output needs reads what it writes",
            10.0,
            120.0,
        );
        assert!(
            lines.len() > 1 && lines.iter().all(|line| width(line, 10.0) <= 120.0),
            "{lines:?}"
        );
        assert_eq!(
            lines.join(" "),
            "nothing that an output needs reads what it writes"
        );
    }
}
