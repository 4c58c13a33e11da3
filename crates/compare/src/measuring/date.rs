//! Dates of measurements, in UTC.
//!
//! ```
//! use skiagraph_compare::measuring::date;
//!
//! let (now, today) = (date::now(), date::today());
//! assert_eq!((now.len(), today.len()), ("2026-11-21T04:30:12Z".len(), "2026-11-21".len()));
//! ```

use jiff::Timestamp;

/// Returns the current time in UTC as RFC 3339 text: `2026-11-21T04:30:12Z`.
pub fn now() -> String {
    format!("{:.0}", Timestamp::now())
}

/// True if two times in the form of [`now`], in either order, are an hour or more apart; false if
/// one of them cannot be parsed.
pub fn is_another_hour(one: &str, other: &str) -> bool {
    let seconds = |text: &str| Some(text.parse::<Timestamp>().ok()?.as_second());
    match (seconds(one), seconds(other)) {
        (Some(one), Some(other)) => one.abs_diff(other) >= 3600,
        _ => false,
    }
}

/// Returns the current date in UTC: `2026-11-21`.
pub fn today() -> String {
    Timestamp::now().strftime("%F").to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_hour_apart_is_another_hour() {
        let apart = |other| is_another_hour("2026-11-21T04:30:12Z", other);
        assert!(apart("2026-11-21T05:30:12Z") && apart("2026-11-20T04:30:12Z"));
        assert!(!apart("2026-11-21T05:30:11Z") && !apart("long ago"));
    }

    #[test]
    fn a_day_and_a_second_are_written_as_records_pin_them() {
        let (now, today) = (now(), today());
        assert_eq!((now.len(), today.len()), (20, 10), "{now}, {today}");
        assert!(
            now.ends_with('Z') && now.parse::<Timestamp>().is_ok(),
            "{now}"
        );
        assert!(today.parse::<jiff::civil::Date>().is_ok(), "{today}");
    }
}
