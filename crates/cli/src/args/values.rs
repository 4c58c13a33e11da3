//! Parses the values of single arguments: `1024x768`, `0.1,-1,0`, `K=V`, `visibility@shade=a.png`.
//!
//! The error of a parser is a sentence with the value that was expected; clap puts the argument's
//! name before it.

use clap::{builder::RangedI64ValueParser, value_parser};
use glam::DVec3;
use skiagraph_compare::quantities::{bytes, direction, milliseconds, percent, positive};
use skiagraph_report::gate::{Figure, Gate};

/// Returns the parser of a number of texels along an edge: at least one.
pub fn texels() -> RangedI64ValueParser<u32> {
    value_parser!(u32).range(1..)
}

/// Returns the parser of a number of frames from `least` to 100,000: all samples are kept.
pub fn frames(least: i64) -> RangedI64ValueParser<u32> {
    value_parser!(u32).range(least..=100_000)
}

/// Value of `--light`: a light of the scene, or a sun of the user's own.
#[derive(Clone, Debug, PartialEq)]
pub enum LightArgument {
    /// A light of the scene by its name, or `all`.
    Name(String),
    /// The direction in which the light of a sun travels.
    Direction(DVec3),
}

/// Parses a [`LightArgument`]: text with a comma and numbers are directions.
pub fn light(text: &str) -> Result<LightArgument, String> {
    if text.contains(',') || text.trim().parse::<f64>().is_ok() {
        direction(text).map(LightArgument::Direction)
    } else {
        Ok(LightArgument::Name(text.to_owned()))
    }
}

/// Parses a condition of `--fail-if`, such as `nsm: wrong > 0.1%`, into its limit.
pub fn gate(text: &str) -> Result<Gate, String> {
    let expected = "expected METHOD: FIGURE > VALUE, for example `nsm: wrong > 0.1%`";
    let parts = || {
        let (method, condition) = text.rsplit_once(": ")?;
        let (figure, value) = condition.split_once('>')?;
        Some([method, figure, value].map(str::trim))
    };
    let [method, figure, value] = parts().ok_or(expected)?;
    let mut figures = Figure::ALL.into_iter();
    let Some(quantity) = figures.find(|quantity| quantity.word() == figure) else {
        let words = Figure::ALL.map(Figure::word).join(", ");
        return Err(format!(
            "unknown figure `{figure}`; expected one of {words}"
        ));
    };
    let most = match quantity {
        Figure::Wrong | Figure::Missing | Figure::False => percent(value),
        Figure::Frame(_) | Figure::Percentile(_) => milliseconds(value),
        Figure::Memory => bytes(value).map(|bytes| bytes as f64),
        Figure::Rmse | Figure::Flip => positive(value),
    };
    Ok(Gate {
        method: method.into(),
        figure: quantity,
        most: most.map_err(|why| format!("{figure}: {why}"))?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_condition_has_a_method_a_figure_and_a_value_with_its_unit() {
        let most = |text| gate(text).map(|gate| (gate.method, gate.most));
        assert_eq!(most("nsm: wrong > 0.1%"), Ok(("nsm".into(), 0.1)));
        assert_eq!(most("crsm@n=1: frame>3ms"), Ok(("crsm@n=1".into(), 3.0)));
        for (text, message) in [
            ("nsm wrong > 1%", "METHOD: FIGURE > VALUE"),
            ("nsm: wrong < 1%", "METHOD: FIGURE > VALUE"),
            (
                "nsm: wrnog > 1%",
                "wrong, missing, false, rmse, flip, frame",
            ),
            ("nsm: wrong > 1", "wrong: no sign for percent"),
            ("nsm: frame > 1", "frame: no unit"),
        ] {
            let error = gate(text).unwrap_err();
            assert!(error.contains(message), "{text}: {error}");
        }
    }
}
