//! Text in charts: measured without a font, broken into lines; and numbers as axes show them.

/// Size of the title, pixels.
pub(crate) const TITLE: f64 = 18.0;
/// Size of panel titles and axis titles, pixels.
pub(crate) const HEAD: f64 = 14.0;
/// Size of everything else, pixels.
pub(crate) const BODY: f64 = 13.0;

/// Returns the width of a text of this font size in pixels, never less than in a browser; the
/// reader's font is unknown.
pub(crate) fn width(text: &str, size: f64) -> i32 {
    (text.chars().count() as f64 * size * 0.62).ceil() as i32
}

/// Breaks a text of this font size between words into lines no wider than `room` pixels.
pub(crate) fn wrap(text: &str, size: f64, room: i32) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width(line, size) + width(word, size) + size as i32 <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Replaces control characters, and those that XML cannot hold, by U+FFFD.
pub(crate) fn clean(text: &str) -> String {
    let fits = |c: char| !c.is_control() && !matches!(c, '\u{fffe}' | '\u{ffff}');
    let shown = |c: char| if fits(c) { c } else { '\u{fffd}' };
    text.chars().map(shown).collect()
}

/// Escapes text for XML and HTML: for content, and for attributes in double quotes (single quotes
/// stay). A line break becomes `&#10;`; one at the end is left out. All other control characters,
/// tabs too, and those that XML cannot hold become U+FFFD.
pub fn xml(text: &str) -> String {
    let lines = text.lines().map(|line| {
        let line = clean(line).replace('&', "&amp;").replace('<', "&lt;");
        line.replace('>', "&gt;").replace('"', "&quot;")
    });
    lines.collect::<Vec<_>>().join("&#10;")
}

/// Returns the label of a tick of a logarithmic axis: `0.05`, `200`, `10⁵`, `2·10⁵`.
pub(crate) fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    // A tick has one digit that is not 0; what f64 adds to it is rounding.
    let exponent = (value.log10() + 1e-9).floor() as i32;
    if (-3..4).contains(&exponent) {
        let digits = (-exponent).max(0) as usize;
        return format!("{value:.digits$}");
    }
    let lead = (value / 10f64.powi(exponent)).round();
    let power = superscript(exponent.into());
    match lead as i64 {
        1 => format!("10{power}"),
        lead => format!("{lead}·10{power}"),
    }
}

/// Returns a whole number in raised digits: `⁻¹²`.
pub fn superscript(number: i64) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised = |c: char| c.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize]);
    number.to_string().chars().map(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_short() {
        let cases = [
            (0.0, "0"),
            (0.001, "0.001"),
            (0.05, "0.05"),
            (0.5, "0.5"),
            (1.0, "1"),
            (200.0, "200"),
            (5000.0, "5000"),
            (1e4, "10⁴"),
            (2e5, "2·10⁵"),
            (5e-5, "5·10⁻⁵"),
            (1e16, "10¹⁶"),
        ];
        for (value, text) in cases {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn lines_are_broken_between_words_and_hold_no_control_characters() {
        let lines = wrap("one two three four", 10.0, 70);
        assert!(lines.len() > 1 && lines.iter().all(|line| width(line, 10.0) <= 70));
        assert_eq!(lines.join(" "), "one two three four");
        assert_eq!(clean("a\u{7}b"), "a\u{fffd}b");
    }
}
