//! Draws bars of GPU time: one for each row, divided into its steps.

use crate::html::charts::sign;
use crate::html::shown::{Shown, part};
use skiagraph_chart::xml;
use skiagraph_compare::lists::entry;
use skiagraph_compare::wording::ms;

/// Steps that have a colour of their own: those that take the longest, over all rows.
const COLOURS: usize = 7;

/// Returns HTML with the bars of GPU time, in milliseconds, of each table that has such times.
pub fn bars(tables: &[Shown]) -> String {
    let of_table = |(index, table): (usize, &Shown)| {
        let rows = table.summary.rows.iter().map(|row| (row, row.steps()));
        let rows: Vec<_> = rows.filter(|(_, steps)| !steps.is_empty()).collect();
        let sum = |steps: &[(&str, f64)]| steps.iter().map(|(_, ms)| ms).sum::<f64>();
        let sums = rows.iter().map(|(_, steps)| sum(steps));
        let most = sums.fold(1e-9, f64::max);
        let mut totals: Vec<(&str, f64)> = Vec::new();
        for (name, ms) in rows.iter().flat_map(|(_, steps)| steps) {
            *entry(&mut totals, *name) += ms;
        }
        totals.sort_by(|(_, one), (_, other)| other.total_cmp(one));
        let colour = |name: &str| match totals.iter().position(|(step, _)| *step == name) {
            Some(place) if place < COLOURS => format!("var(--s{place})"),
            _ => "var(--quiet)".into(),
        };
        let step = |label: &str, (name, time): &(&str, f64)| {
            let (colour, share, time, name) = (colour(name), time / most, ms(*time), xml(name));
            format!(
                "<i class=\"step\" style=\"--share:{share:.5};--c:{colour}\" \
                 aria-label=\"{label}&#10;{name}: {time} ms\"><b>{name}</b></i>"
            )
        };
        let mut html = String::new();
        for (row, steps) in &rows {
            let label = xml(&row.label);
            let parts: String = steps.iter().map(|timing| step(&label, timing)).collect();
            let (method, whole) = (xml(&row.method), ms(sum(steps)));
            let sign = sign(tables, &row.method);
            html += &format!(
                "<div class=\"bar\" data-series=\"{method}\"><span>{sign}{label}</span>\
                 <div>{parts}<span class=\"tick\">{whole} ms</span></div></div>\n"
            );
        }
        let swatch = |colour: &str, name: &str| {
            format!("<span><i style=\"--c:{colour}\"></i>{}</span>", xml(name))
        };
        let named = totals.iter().take(COLOURS);
        let mut swatches: String = named.map(|(name, _)| swatch(&colour(name), name)).collect();
        if totals.len() > COLOURS {
            swatches += &swatch("var(--quiet)", "others");
        }
        let html = format!("{html}<div class=\"swatches\">{swatches}</div>");
        (!rows.is_empty()).then(|| part("bars", &[index], None, &html))
    };
    tables.iter().enumerate().filter_map(of_table).collect()
}
