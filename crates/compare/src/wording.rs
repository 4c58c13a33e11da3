//! Formats numbers, suggestions and command lines as text for messages and tables.
//!
//! ```
//! use skiagraph_compare::wording::{did_you_mean, ms, percent, thousands};
//!
//! assert_eq!(ms(12.3456), "12.3");
//! assert_eq!(percent(1, 1_000_000), "<0.001 %");
//! assert_eq!(thousands(207_377), "207,377");
//! assert_eq!(did_you_mean("nsn", ["nsm", "rt"].into_iter()), "; did you mean `nsm`?");
//! ```

use itertools::Itertools;
use skiagraph_graph::diagnostics::closest;
pub use skiagraph_graph::text::bytes;
use std::ffi::OsString;

/// Returns a time in milliseconds as text with three significant digits, at most three of them
/// decimals; whole milliseconds from 100 on.
pub fn ms(ms: f64) -> String {
    match ms {
        _ if ms >= 99.95 => format!("{ms:.0}"),
        _ if ms >= 9.995 => format!("{ms:.1}"),
        _ if ms >= 0.9995 => format!("{ms:.2}"),
        _ => format!("{ms:.3}"),
    }
}

/// Returns `count` as a percentage of `whole` with three decimals: `33.333 %`. A count that is not
/// zero never shows as zero but as `<0.001 %`; a `whole` of 0 gives `–`.
pub fn percent(count: u64, whole: u64) -> String {
    let share = count as f64 / whole as f64 * 100.0;
    match (count, whole) {
        (_, 0) => "–".into(),
        (0, _) => "0 %".into(),
        _ if share < 0.001 => "<0.001 %".into(),
        _ => format!("{share:.3} %"),
    }
}

/// Returns `count` as a percentage of `whole` without the percent sign, for documents: three
/// decimals below 1, two from 1 on. A count of 0 is `0`, another one below 0.001 percent `<0.001`;
/// a `whole` of 0 gives `–`.
pub fn share(count: u64, whole: u64) -> String {
    let share = count as f64 / whole as f64 * 100.0;
    match (count, whole) {
        (_, 0) => "–".into(),
        (0, _) => "0".into(),
        _ if share < 0.001 => "<0.001".into(),
        _ if share < 1.0 => format!("{share:.3}"),
        _ => format!("{share:.2}"),
    }
}

/// Returns a value as the text that `text` makes of it; nothing for `None`.
pub fn or_nothing<T>(value: Option<T>, text: impl FnOnce(T) -> String) -> String {
    value.map(text).unwrap_or_default()
}

/// Returns a number with commas between thousands: `1,234,567`.
pub fn thousands(number: u64) -> String {
    let digits = number.to_string();
    let groups = digits.as_bytes().rchunks(3).rev();
    groups.map(String::from_utf8_lossy).join(",")
}

/// Returns a length, which is not negative, with three significant digits, and as a whole number
/// from 100 on: `3,200`, `12.3`, `0.0123`.
pub fn length(length: f64) -> String {
    if length >= 100.0 {
        return thousands(length.round() as u64);
    }
    let power = length.log10().floor() as i32;
    let digits = 2i32.saturating_sub(power).clamp(1, 15);
    let text = format!("{length:.*}", digits as usize);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Returns a count with its noun, to which `s` is added unless the count is 1: `1 frame`, `2
/// frames`.
pub fn plural(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// Returns a number of frames as text: `1 frame`, `2 frames`.
pub fn frames(count: u32) -> String {
    plural(count as usize, "frame")
}

/// Returns a size in pixels as `WIDTHxHEIGHT`: `512x256`.
pub fn size([width, height]: [u32; 2]) -> String {
    format!("{width}x{height}")
}

/// Returns the end of a message about an unknown name, which suggests the [`closest`] of `names`;
/// empty if none of them is close.
pub fn did_you_mean<'a>(wanted: &str, names: impl Iterator<Item = &'a str>) -> String {
    let hint = |name| format!("; did you mean `{name}`?");
    closest(wanted, names).map_or(String::new(), hint)
}

/// Returns a message about the unknown name `wanted`: the text `what`, the name in `names` that is
/// closest to it, and a line with `nouns` (such as `views`) and all of `names`.
pub fn unknown<S: AsRef<str>>(
    what: &str,
    wanted: &str,
    nouns: &str,
    names: impl IntoIterator<Item = S>,
) -> String {
    let names: Vec<S> = names.into_iter().collect();
    let names = || names.iter().map(AsRef::as_ref);
    let hint = did_you_mean(wanted, names());
    format!("{what}{hint}\n  {nouns}: {}", names().join(", "))
}

/// Returns the command line of this process as it can be typed again, with `skiagraph` instead of
/// the program's path. `arguments` begin with that path.
pub fn command_line(arguments: impl Iterator<Item = OsString>) -> String {
    let quoted = |argument: OsString| {
        let text = argument.to_string_lossy().into_owned();
        let is_plain = |c: char| c.is_alphanumeric() || "-_=.,:/\\@+".contains(c);
        if text.chars().all(is_plain) && !text.is_empty() {
            text
        } else {
            format!("'{}'", text.replace('\'', r"'\''"))
        }
    };
    let words = arguments.skip(1).map(quoted);
    ["skiagraph".into()].into_iter().chain(words).join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stay_readable_over_ten_orders_of_magnitude() {
        assert_eq!(
            [0.0, 0.00049, 1.234, 12.34, 123.4, 99999.0].map(ms),
            ["0.000", "0.000", "1.23", "12.3", "123", "99999"]
        );
        assert_eq!(
            [0, 999, 1000, 1_234_567].map(thousands),
            ["0", "999", "1,000", "1,234,567"]
        );
        assert_eq!(
            [512, 1536, 3 << 20].map(bytes),
            ["512 B", "1.5 KiB", "3.0 MiB"]
        );
        assert_eq!(
            [(0, 9), (1, 1_000_000), (1, 3), (0, 0)].map(|(n, d)| percent(n, d)),
            ["0 %", "<0.001 %", "33.333 %", "–"]
        );
    }

    #[test]
    fn lengths_are_said_with_three_digits() {
        for (number, text) in [
            (3199.7, "3,200"),
            (8.0, "8"),
            (0.012345, "0.0123"),
            (12.34, "12.3"),
            (99.96, "100"),
            (0.0, "0"),
            (1e12, "1,000,000,000,000"),
        ] {
            assert_eq!(length(number), text);
        }
    }

    #[test]
    fn shares_keep_what_is_small() {
        let shares = [(0, 9), (1, 1_000_000), (1, 1000), (1, 3), (0, 0)];
        let texts = shares.map(|(count, whole)| share(count, whole));
        assert_eq!(texts, ["0", "<0.001", "0.100", "33.33", "–"]);
    }

    #[test]
    fn only_misspellings_get_a_suggestion() {
        let names = ["rt", "nsm", "crsm", "certified"];
        assert_eq!(closest("nms", names.into_iter()), Some("nsm"));
        assert_eq!(closest("certifed", names.into_iter()), Some("certified"));
        assert_eq!(closest("rtt", names.into_iter()), Some("rt"));
        assert_eq!(closest("photon_map", names.into_iter()), None);
    }

    #[test]
    fn a_command_line_can_be_typed_again() {
        let words = [
            "/some/where/skiagraph.exe",
            "compare",
            "my method.ron",
            "--set",
            "a=1",
        ];
        let text = command_line(words.into_iter().map(OsString::from));
        assert_eq!(text, "skiagraph compare 'my method.ron' --set a=1");
    }
}
