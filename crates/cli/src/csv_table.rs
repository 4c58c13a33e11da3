//! `results.csv`: one line per run, for spreadsheets.

use crate::results::{Measured, Results, Run, Spread};

impl Results {
    /// The contents of `results.csv`: one line per run, times are medians, empty cells are nulls.
    pub fn to_csv(&self) -> Result<String, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(COLUMNS)?;
        for run in &self.runs {
            writer.write_record(self.record(run))?;
        }
        let bytes = writer.into_inner().map_err(|error| error.into_error())?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    fn record(&self, run: &Run) -> Vec<String> {
        let measured = run.measured.as_ref();
        let count =
            |pick: fn(&Measured) -> u64| measured.map(|m| pick(m).to_string()).unwrap_or_default();
        let ms = |spread: Option<Spread>| {
            spread
                .map(|s| format!("{:.6}", s.median))
                .unwrap_or_default()
        };
        vec![
            self.adapter.name.clone(),
            self.scene.name.clone(),
            self.scene.triangles.to_string(),
            self.oracle.clone(),
            run.preset.clone(),
            run.view.clone(),
            run.viewport[0].to_string(),
            run.viewport[1].to_string(),
            run.map_size
                .map(|size| size.to_string())
                .unwrap_or_default(),
            run.pixels.background.to_string(),
            run.pixels.facing_away.to_string(),
            run.pixels.facing_light.to_string(),
            run.pixels.lit.to_string(),
            run.pixels.shadow.to_string(),
            run.band.to_string(),
            count(|m| m.certain.lit),
            count(|m| m.certain.shadow),
            count(|m| m.uncertain),
            measured
                .and_then(|m| m.rays)
                .map(|rays| rays.to_string())
                .unwrap_or_default(),
            count(|m| m.wrong.lit),
            count(|m| m.wrong.shadow),
            count(|m| m.wrong.total),
            count(|m| m.wrong.certain),
            count(|m| m.wrong.in_band),
            count(|m| m.facing_mismatch),
            ms(measured.and_then(|m| m.frame.gpu_ms)),
            ms(measured.map(|m| m.frame.wall_ms)),
            count(|m| m.memory_bytes),
            count(|m| m.saved_bytes),
            run.unavailable.clone().unwrap_or_default(),
            ms(measured
                .and_then(|m| m.cached.as_ref())
                .and_then(|cached| cached.frame.gpu_ms)),
            count(|m| m.split.lit.certain_right),
            count(|m| m.split.lit.certain_wrong),
            count(|m| m.split.lit.certain_wrong_outside_band),
            count(|m| m.split.lit.uncertain),
            count(|m| m.split.lit.uncertain_wrong),
            count(|m| m.split.shadow.certain_right),
            count(|m| m.split.shadow.certain_wrong),
            count(|m| m.split.shadow.certain_wrong_outside_band),
            count(|m| m.split.shadow.uncertain),
            count(|m| m.split.shadow.uncertain_wrong),
        ]
    }
}

const COLUMNS: [&str; 41] = [
    "adapter",
    "scene",
    "triangles",
    "oracle",
    "preset",
    "view",
    "width",
    "height",
    "map_size",
    "background",
    "facing_away",
    "facing_light",
    "lit",
    "shadow",
    "band",
    "certain_lit",
    "certain_shadow",
    "uncertain",
    "rays",
    "wrong_lit",
    "wrong_shadow",
    "wrong_total",
    "wrong_certain",
    "wrong_in_band",
    "facing_mismatch",
    "gpu_ms",
    "wall_ms",
    "memory_bytes",
    "saved_bytes",
    "unavailable",
    "cached_gpu_ms",
    "lit_certain_right",
    "lit_certain_wrong",
    "lit_certain_wrong_outside_band",
    "lit_uncertain",
    "lit_uncertain_wrong",
    "shadow_certain_right",
    "shadow_certain_wrong",
    "shadow_certain_wrong_outside_band",
    "shadow_uncertain",
    "shadow_uncertain_wrong",
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::tests::sample;

    #[test]
    fn csv_has_a_line_per_run_and_as_many_cells_as_columns() {
        let csv = sample().to_csv().unwrap();
        insta::assert_snapshot!(csv);
        let mut reader = csv::Reader::from_reader(csv.as_bytes());
        assert_eq!(
            reader
                .records()
                .map(|record| record.unwrap().len())
                .collect::<Vec<_>>(),
            [COLUMNS.len(); 3]
        );
    }
}
