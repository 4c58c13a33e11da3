//! Parses quantities as a user writes them: `0.1,-1,0`, `512MiB`, `3ms`, `0.1%`. The error of a
//! parser is a sentence with what was expected.
//!
//! ```
//! use skiagraph_compare::quantities::{bytes, milliseconds};
//!
//! assert_eq!(bytes("1.5 KiB"), Ok(1536));
//! assert!(milliseconds("3").unwrap_err().contains("for example 3ms"));
//! ```

use glam::DVec3;

/// Parses a position or direction, `x,y,z`, of finite numbers.
///
/// # Errors
/// Text with the value that was expected.
pub fn vector(text: &str) -> Result<DVec3, String> {
    let expected = "expected three numbers x,y,z, for example 0.3,-1,0.2";
    let numbers = text.split(',').map(|number| {
        let value = number.trim().parse::<f64>();
        value.map_err(|_| format!("`{number}` is not a number; {expected}"))
    });
    let numbers: Vec<f64> = numbers.collect::<Result<_, _>>()?;
    let [x, y, z] = numbers[..] else {
        return Err(format!("{} numbers; {expected}", numbers.len()));
    };
    let vector = DVec3::new(x, y, z);
    let finite = Some(vector).filter(|vector| vector.is_finite());
    finite.ok_or_else(|| "all three numbers must be finite".into())
}

/// Parses a direction as [`vector`] does; it must not be zero.
///
/// # Errors
/// Text with the value that was expected.
pub fn direction(text: &str) -> Result<DVec3, String> {
    match vector(text)? {
        DVec3::ZERO => Err("a direction must not be 0,0,0".into()),
        direction => Ok(direction),
    }
}

/// Parses a number of bytes, at least one: `1536`, `512MiB`, `2.5 GiB`; MB and GB are powers of
/// ten.
///
/// # Errors
/// Text with the value that was expected.
pub fn bytes(text: &str) -> Result<u64, String> {
    let text = text.trim();
    let split = text.find(|c: char| c.is_ascii_alphabetic());
    let (number, unit) = text.split_at(split.unwrap_or(text.len()));
    let unit = match unit.to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "kib" => 1024.0,
        "mib" => 1_048_576.0,
        "gib" => 1_073_741_824.0,
        "tib" => 1_099_511_627_776.0,
        "kb" => 1e3,
        "mb" => 1e6,
        "gb" => 1e9,
        "tb" => 1e12,
        _ => {
            return Err(format!(
                "unknown unit `{unit}`; expected B, KiB, MiB, GiB or TiB"
            ));
        }
    };
    match number.trim().parse::<f64>() {
        Ok(number) if number.is_finite() && number * unit >= 1.0 => Ok((number * unit) as u64),
        _ => Err("expected a number of bytes above 0, for example 512MiB or 2GiB".into()),
    }
}

/// Parses a time above zero, `3ms`, `0.8 ms` or `800us`, into milliseconds.
///
/// # Errors
/// Text with the value that was expected.
pub fn milliseconds(text: &str) -> Result<f64, String> {
    let expected = "expected a time, for example 3ms or 800us";
    let text = text.trim();
    let (number, scale) = match (text.strip_suffix("ms"), text.strip_suffix("us")) {
        (Some(number), _) => (number, 1.0),
        (_, Some(number)) => (number, 1e-3),
        _ => return Err(format!("no unit; {expected}")),
    };
    positive(number.trim())
        .map(|number| number * scale)
        .map_err(|why| format!("{why}; {expected}"))
}

/// Parses a share above 0 and at most 100 percent, `1%` or `0.05 %`, into percent.
///
/// # Errors
/// Text with the value that was expected.
pub fn percent(text: &str) -> Result<f64, String> {
    let expected = "expected a share above 0 % and at most 100 %, for example 1%";
    let number = text.trim().strip_suffix('%');
    let number = number.ok_or_else(|| format!("no sign for percent; {expected}"))?;
    match positive(number.trim()) {
        Ok(share) if share <= 100.0 => Ok(share),
        _ => Err(expected.into()),
    }
}

/// Parses a finite number above zero.
///
/// # Errors
/// Text with the value that was expected.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() && number > 0.0 => Ok(number),
        Ok(_) => Err("must be above 0".into()),
        Err(_) => Err("expected a number".into()),
    }
}

/// Parses a vertical field of view in degrees, above 0 and below 180.
///
/// # Errors
/// Text with the value that was expected.
pub fn degrees(text: &str) -> Result<f64, String> {
    match positive(text)? {
        angle if angle < 180.0 => Ok(angle),
        _ => Err("a field of view must be below 180 degrees".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_shares_have_units() {
        assert_eq!(milliseconds("3ms"), Ok(3.0));
        assert_eq!(milliseconds("800 us"), Ok(0.8));
        assert_eq!(percent("0.05 %"), Ok(0.05));
        for text in ["3", "ms", "-1ms", "0ms", "infms"] {
            assert!(
                milliseconds(text).unwrap_err().contains("3ms or 800us"),
                "{text}"
            );
        }
        for text in ["1", "%", "0%", "101%", "nan%"] {
            assert!(
                percent(text).unwrap_err().contains("for example 1%"),
                "{text}"
            );
        }
    }

    #[test]
    fn bytes_have_units() {
        for (text, number) in [
            ("7", 7),
            ("1.5 KiB", 1536),
            ("2GiB", 2 << 30),
            ("3mb", 3_000_000),
        ] {
            assert_eq!(bytes(text), Ok(number), "{text}");
        }
        for text in [
            "", "GiB", "-1", "0", "0GiB", "0.2", "nan", "1e", "2 gigs", "inf",
        ] {
            assert!(bytes(text).is_err(), "{text}");
        }
    }

    #[test]
    fn vectors_may_be_negative_but_not_infinite() {
        assert_eq!(vector("-1,2.5,-3e2"), Ok(DVec3::new(-1.0, 2.5, -300.0)));
        for wrong in ["1,2", "1,2,3,4", "a,b,c", "inf,0,0", "NaN,0,0", ""] {
            assert!(vector(wrong).is_err(), "{wrong}");
        }
        assert!(direction("0,-0,0").is_err());
    }

    #[test]
    fn fields_of_view_are_open_intervals() {
        assert_eq!(degrees("60"), Ok(60.0));
        for wrong in ["0", "180", "-5", "NaN", "wide"] {
            assert!(degrees(wrong).is_err(), "{wrong}");
        }
    }
}
