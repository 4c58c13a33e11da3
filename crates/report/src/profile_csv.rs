//! `profile --csv`: a line for each pass and one for the whole frame of each profile.

use itertools::Itertools;
use skiagraph_compare::records::profile::{Line, Profile};
use skiagraph_compare::records::results::Adapter;
use skiagraph_compare::records::table::Table;

type Column = (&'static str, fn(&Profile, Line) -> String);

/// In an order on which scripts rely: new ones stand at the end. Empty cells are nulls.
#[rustfmt::skip] // A line each.
const COLUMNS: [Column; 28] = [
    ("program", |profile, _| profile.conditions.program.clone()),
    ("build", |profile, _| profile.conditions.build.clone()),
    ("date", |profile, _| profile.conditions.date.clone()),
    ("adapter", |profile, _| adapter(profile).name.clone()),
    ("backend", |profile, _| adapter(profile).backend.clone()),
    ("driver", |profile, _| adapter(profile).driver.clone()),
    ("gpu_unavailable", |profile, _| adapter(profile).gpu_unavailable.clone().unwrap_or_default()),
    ("scene", |profile, _| profile.conditions.scene.name.clone()),
    ("triangles", |profile, _| profile.conditions.scene.triangles.to_string()),
    ("preset", |profile, _| profile.conditions.preset.clone()),
    ("view", |profile, _| profile.conditions.view.clone()),
    ("width", |profile, _| profile.conditions.viewport[0].to_string()),
    ("height", |profile, _| profile.conditions.viewport[1].to_string()),
    ("params", |profile, _| {
        profile.conditions.params().map(|(name, value)| format!("{name}={value}")).join(" ")
    }),
    ("frames", |profile, _| profile.timed().to_string()),
    ("warmup", |profile, _| profile.conditions.warmup.to_string()),
    ("pass", |_, (pass, ..)| pass.map_or(String::new(), |pass| pass.name.clone())),
    ("kind", |_, (pass, ..)| pass.map_or("frame".into(), |pass| pass.kind.clone())),
    ("gpu_min_ms", |_, (_, gpu, _)| six_digits(gpu.map(|gpu| gpu.min))),
    ("gpu_median_ms", |_, (_, gpu, _)| six_digits(gpu.map(|gpu| gpu.median))),
    ("gpu_p95_ms", |_, (_, gpu, _)| six_digits(gpu.map(|gpu| gpu.p95))),
    ("gpu_max_ms", |_, (_, gpu, _)| six_digits(gpu.map(|gpu| gpu.max))),
    ("gpu_share", |_, (pass, ..)| six_digits(pass.and_then(|pass| pass.share))),
    ("cpu_min_ms", |_, (.., cpu)| six_digits(Some(cpu.min))),
    ("cpu_median_ms", |_, (.., cpu)| six_digits(Some(cpu.median))),
    ("cpu_p95_ms", |_, (.., cpu)| six_digits(Some(cpu.p95))),
    ("cpu_max_ms", |_, (.., cpu)| six_digits(Some(cpu.max))),
    ("wall_median_ms", |profile, (pass, ..)| {
        six_digits(pass.is_none().then_some(profile.frame.wall_ms.median))
    }),
];

fn adapter(profile: &Profile) -> &Adapter {
    &profile.conditions.adapter
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
    let lines = profiles.iter();
    let lines = lines.flat_map(|profile| profile.lines().map(move |line| (profile, line)));
    let rows = lines.map(|(profile, line)| {
        let cells = COLUMNS.iter().map(|(_, cell)| cell(profile, line));
        cells.collect()
    });
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
