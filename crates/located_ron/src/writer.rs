//! Writes values as RON that is laid out for an editor.

use crate::reader::options;
use ron::ser::PrettyConfig;
use serde::Serialize;

/// Returns a value as the text of RON. Each item of a list of structs has a line of its own, and so
/// has each field of a struct with such a list; everything else is in one line.
///
/// # Errors
/// The message of an implementation of `Serialize` that refuses its value.
pub fn to_text<T: Serialize>(value: &T) -> Result<String, ron::Error> {
    let config = PrettyConfig::new().new_line("\n");
    let text = options().to_string_pretty(value, config.separate_tuple_members(true))?;
    let (mut lines, mut open): (Vec<String>, Vec<usize>) = Default::default();
    for line in text.lines() {
        // The line of a text ends with a quote.
        let whole = line.strip_suffix(".0,").map(|whole| format!("{whole},"));
        lines.push(whole.unwrap_or_else(|| line.to_owned()));
        if line.ends_with(OPEN) {
            open.push(lines.len());
        } else if line.trim_start().starts_with([')', ']', '}']) {
            let first = open.pop().unwrap_or(1);
            let is_list = lines[first - 1].ends_with('[');
            let stays = |item: &String| item.ends_with(OPEN) || is_list && item.ends_with("),");
            let inner = &lines[first..lines.len() - 1];
            if !inner.iter().any(stays) {
                let items: Vec<&str> = inner.iter().map(|item| item.trim()).collect();
                let items = items.join(" ");
                let text = format!("{}{}", items.trim_end_matches(','), line.trim());
                lines.truncate(first);
                lines[first - 1] += &text;
            }
        }
    }
    Ok(lines.join("\n"))
}

/// Ends of lines behind which a list, struct or map goes on.
const OPEN: [char; 3] = ['(', '[', '{'];
