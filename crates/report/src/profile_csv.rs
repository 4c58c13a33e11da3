//! `profile --csv`: a line for each pass and one for the whole frame of each profile.

use skiagraph_compare::records::profile::{Conditions, PassProfile, Profile};
use skiagraph_compare::records::statistics::Series;
use skiagraph_compare::records::table::Table;

/// A line: a pass, or the frame.
struct Line<'a> {
    profile: &'a Profile,
    pass: Option<&'a PassProfile>,
}

type Column = (&'static str, fn(&Line) -> String);

/// In an order on which scripts rely: new ones stand at the end. Empty cells are nulls.
const COLUMNS: [Column; 28] = [
    ("program", |of| of.conditions().program.clone()),
    ("build", |of| of.conditions().build.clone()),
    ("date", |of| of.conditions().date.clone()),
    ("adapter", |of| of.conditions().adapter.name.clone()),
    ("backend", |of| of.conditions().adapter.backend.clone()),
    ("driver", |of| of.conditions().adapter.driver.clone()),
    ("gpu_unavailable", |of| {
        let reason = of.conditions().adapter.gpu_unavailable.clone();
        reason.unwrap_or_default()
    }),
    ("scene", |of| of.conditions().scene.name.clone()),
    ("triangles", |of| {
        of.conditions().scene.triangles.to_string()
    }),
    ("preset", |of| of.conditions().preset.clone()),
    ("view", |of| of.conditions().view.clone()),
    ("width", |of| of.conditions().viewport[0].to_string()),
    ("height", |of| of.conditions().viewport[1].to_string()),
    ("params", |of| {
        let params = of.conditions().params();
        let texts = params.map(|(name, value)| format!("{name}={value}"));
        texts.collect::<Vec<_>>().join(" ")
    }),
    ("frames", |of| of.profile.timed().to_string()),
    ("warmup", |of| of.conditions().warmup.to_string()),
    ("pass", |of| {
        of.pass.map_or(String::new(), |pass| pass.name.clone())
    }),
    ("kind", |of| {
        of.pass.map_or("frame".into(), |pass| pass.kind.clone())
    }),
    ("gpu_min_ms", |of| ms(of.gpu(), |gpu| gpu.min)),
    ("gpu_median_ms", |of| ms(of.gpu(), |gpu| gpu.median)),
    ("gpu_p95_ms", |of| ms(of.gpu(), |gpu| gpu.p95)),
    ("gpu_max_ms", |of| ms(of.gpu(), |gpu| gpu.max)),
    ("gpu_share", |of| {
        of.pass
            .and_then(|pass| pass.share)
            .map_or(String::new(), six_digits)
    }),
    ("cpu_min_ms", |of| ms(of.cpu(), |cpu| cpu.min)),
    ("cpu_median_ms", |of| ms(of.cpu(), |cpu| cpu.median)),
    ("cpu_p95_ms", |of| ms(of.cpu(), |cpu| cpu.p95)),
    ("cpu_max_ms", |of| ms(of.cpu(), |cpu| cpu.max)),
    ("wall_median_ms", |of| match of.pass {
        Some(_) => String::new(),
        None => six_digits(of.profile.frame.wall_ms.median),
    }),
];

impl Line<'_> {
    fn conditions(&self) -> &Conditions {
        &self.profile.conditions
    }

    fn gpu(&self) -> Option<&Series> {
        let frame = self.profile.frame.gpu_ms.as_ref();
        self.pass.map_or(frame, |pass| pass.gpu_ms.as_ref())
    }

    fn cpu(&self) -> Option<&Series> {
        let frame = &self.profile.frame.cpu_ms;
        Some(self.pass.map_or(frame, |pass| &pass.cpu_ms))
    }
}

fn ms(series: Option<&Series>, pick: fn(&Series) -> f64) -> String {
    series.map_or(String::new(), |series| six_digits(pick(series)))
}

fn six_digits(number: f64) -> String {
    format!("{number:.6}")
}

/// Returns the profiles as CSV: for each profile a line for each pass and one for the whole frame.
/// The cell `pass` is empty in the lines of whole frames. Times are in milliseconds; the cells of
/// GPU times are empty where they are missing.
///
/// # Errors
/// The errors of [`Table::csv`].
pub fn to_csv(profiles: &[Profile]) -> Result<String, ::csv::Error> {
    let lines = profiles.iter().flat_map(|profile| {
        let passes = profile.passes.iter().map(Some).chain([None]);
        passes.map(move |pass| Line { profile, pass })
    });
    let rows = lines.map(|line| COLUMNS.iter().map(|(_, cell)| cell(&line)).collect());
    Table::new(COLUMNS.map(|(name, _)| name), 0, rows).csv()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::profile as sample;

    #[test]
    fn csv_has_a_line_per_pass_and_one_for_the_frame() {
        let csv = to_csv(&[sample()]).unwrap();
        insta::assert_snapshot!(csv);
        let mut reader = ::csv::Reader::from_reader(csv.as_bytes());
        let lengths = reader.records().map(|record| record.unwrap().len());
        assert_eq!(lengths.collect::<Vec<_>>(), [COLUMNS.len(); 3]);
    }
}
