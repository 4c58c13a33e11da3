//! Errors of methods at equal cost, read off their curves over the sizes of shadow maps.

use crate::summary::Row;
use crate::verdict::{Verdict, main_choice};
use itertools::Itertools;
use skiagraph_compare::lists::unique;
use skiagraph_compare::records::regimes::Regime;
use skiagraph_compare::wording::ms;

/// Least number of map sizes that make a curve.
const LEAST_SIZES: usize = 3;

/// A point of a curve: edge of the map in texels, milliseconds of a frame, error.
type Point = [f64; 3];

/// Returns a sentence with the error that each method would have at the cost of the fastest exact
/// one, if it chose its map for that; `None` if there is no exact method, or none was measured with
/// three map sizes. Between two sizes map and error are interpolated by the logarithms of the
/// times. The error is the share of wrong pixels outside the band; under a light with an extent,
/// where no method is exact, there is no such sentence.
pub fn sentence(rows: &[Row], verdict: &Verdict) -> Option<String> {
    let when = main_choice(rows);
    let exact = &rows[*verdict.fastest_exact.get(&when)?];
    let cost = exact.frame_ms(when)?;
    let point = |row: &Row| -> Option<Point> {
        let edge = f64::from(row.map_size()?);
        Some([edge, row.frame_ms(when)?, row.wrong().share()])
    };
    let errors = unique(rows.iter().map(|row| &row.method)).into_iter();
    let mut errors = errors.filter_map(|method| {
        let points = rows.iter().filter(|row| row.method == *method);
        let curve: Vec<Point> = points.filter_map(point).collect();
        Some(format!("`{method}` {}", at_cost(curve, cost)?))
    });
    let errors = errors.join(", ");
    let condition = when.map_or("on the path", Regime::condition);
    (!errors.is_empty()).then(|| {
        let (label, time) = (&exact.label, ms(cost));
        format!("At the cost of `{label}` ({time} ms {condition}): {errors}.")
    })
}

/// The error on a curve at a cost in milliseconds, in words; `None` if all its maps are right.
fn at_cost(mut curve: Vec<Point>, cost: f64) -> Option<String> {
    if curve.len() < LEAST_SIZES || curve.iter().all(|[.., error]| *error == 0.0) {
        return None;
    }
    curve.sort_by(|one, other| one[0].total_cmp(&other[0]));
    let percent = |share: f64| format!("{:.2} % wrong", 100.0 * share);
    let Some(below) = curve.iter().rposition(|[_, time, _]| *time <= cost) else {
        return Some(format!("costs more even with a map of {}²", curve[0][0]));
    };
    let [edge, time, error] = curve[below];
    let Some([next_edge, next_time, next_error]) = curve.get(below + 1) else {
        let (error, time) = (percent(error), ms(time));
        return Some(format!("{error} with the largest map ({edge}², {time} ms)"));
    };
    let part = (cost / time).ln() / (next_time / time).ln();
    let between = edge * (next_edge / edge).powf(part);
    let error = percent(error + (next_error - error) * part);
    Some(format!("about {error} with a map of {between:.0}²"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_read_off_between_two_maps() {
        let curve = || vec![[1024.0, 4.0, 0.02], [256.0, 1.0, 0.08], [512.0, 2.0, 0.04]];
        let at = |cost: f64| at_cost(curve(), cost).unwrap();
        assert_eq!(
            at(2.0 * 2f64.sqrt()),
            "about 3.00 % wrong with a map of 724²"
        );
        assert_eq!(at(0.5), "costs more even with a map of 256²");
        assert_eq!(
            at(9.0),
            "2.00 % wrong with the largest map (1024², 4.00 ms)"
        );
        assert_eq!(at_cost(curve()[..2].to_vec(), 9.0), None, "no curve");
    }
}
