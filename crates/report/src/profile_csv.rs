//! `profile --csv`: a line for each pass and one for the whole frame of each profile.

use itertools::Itertools;
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
#[rustfmt::skip] // A line each.
const COLUMNS: [Column; 28] = [
    ("program", |line| line.conditions().program.clone()),
    ("build", |line| line.conditions().build.clone()),
    ("date", |line| line.conditions().date.clone()),
    ("adapter", |line| line.conditions().adapter.name.clone()),
    ("backend", |line| line.conditions().adapter.backend.clone()),
    ("driver", |line| line.conditions().adapter.driver.clone()),
    ("gpu_unavailable", |line| {
        line.conditions().adapter.gpu_unavailable.clone().unwrap_or_default()
    }),
    ("scene", |line| line.conditions().scene.name.clone()),
    ("triangles", |line| line.conditions().scene.triangles.to_string()),
    ("preset", |line| line.conditions().preset.clone()),
    ("view", |line| line.conditions().view.clone()),
    ("width", |line| line.conditions().viewport[0].to_string()),
    ("height", |line| line.conditions().viewport[1].to_string()),
    ("params", |line| {
        line.conditions().params().map(|(name, value)| format!("{name}={value}")).join(" ")
    }),
    ("frames", |line| line.profile.timed().to_string()),
    ("warmup", |line| line.conditions().warmup.to_string()),
    ("pass", |line| line.pass.map_or(String::new(), |pass| pass.name.clone())),
    ("kind", |line| line.pass.map_or("frame".into(), |pass| pass.kind.clone())),
    ("gpu_min_ms", |line| six_digits(line.gpu().map(|gpu| gpu.min))),
    ("gpu_median_ms", |line| six_digits(line.gpu().map(|gpu| gpu.median))),
    ("gpu_p95_ms", |line| six_digits(line.gpu().map(|gpu| gpu.p95))),
    ("gpu_max_ms", |line| six_digits(line.gpu().map(|gpu| gpu.max))),
    ("gpu_share", |line| six_digits(line.pass.and_then(|pass| pass.share))),
    ("cpu_min_ms", |line| six_digits(Some(line.cpu().min))),
    ("cpu_median_ms", |line| six_digits(Some(line.cpu().median))),
    ("cpu_p95_ms", |line| six_digits(Some(line.cpu().p95))),
    ("cpu_max_ms", |line| six_digits(Some(line.cpu().max))),
    ("wall_median_ms", |line| {
        six_digits(line.pass.is_none().then_some(line.profile.frame.wall_ms.median))
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

    fn cpu(&self) -> &Series {
        self.pass
            .map_or(&self.profile.frame.cpu_ms, |pass| &pass.cpu_ms)
    }
}

fn six_digits(number: Option<f64>) -> String {
    number.map_or(String::new(), |number| format!("{number:.6}"))
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
