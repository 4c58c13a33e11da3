//! Escapes text for drawings, and measures it without a font.

use skiagraph_graph::text::cut;

/// Size of names, pixels.
pub(crate) const NAME: f64 = 12.5;
/// Size of everything beside names, pixels.
pub(crate) const SMALL: f64 = 10.5;
/// Size of notes at marks, pixels.
pub(crate) const NOTE: f64 = 8.0;

/// Escapes text for XML, attributes included. Characters that XML cannot hold become U+FFFD.
pub(crate) fn xml(text: &str) -> String {
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

/// Width of a character of size 1 in a wide sans-serif (DejaVu Sans), rounded up: which font a
/// reader has is not known.
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

/// Returns the width of a text of this font size in pixels, never less than in a browser.
pub(crate) fn width(text: &str, size: f64) -> f64 {
    size * text.chars().map(advance).sum::<f64>()
}

/// Returns the width of a bold text of this font size in pixels.
pub(crate) fn bold(text: &str, size: f64) -> f64 {
    1.1 * width(text, size)
}

/// Returns the greatest of the widths; 0 if there are none.
pub(crate) fn widest(widths: impl Iterator<Item = f64>) -> f64 {
    widths.fold(0.0, f64::max)
}

/// Breaks a text between words into lines no wider than `room`. A word that is longer gets a line
/// of its own and is cut.
pub(crate) fn wrap(text: &str, size: f64, room: f64) -> Vec<String> {
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

/// Returns the count with its noun, `one` or `many`: `1 pass`, `2 passes`.
pub(crate) fn plural(count: usize, one: &str, many: &str) -> String {
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
