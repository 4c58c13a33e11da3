//! `profile --csv`: a line per pass and one for the frame, for spreadsheets.

use crate::profile::record::{Conditions, Profile, Series};

impl Profile {
    /// A line per pass and one for the frame, whose cell `pass` is empty; each with the conditions. Empty cells are nulls.
    pub fn to_csv(&self) -> Result<String, ::csv::Error> {
        let mut writer = ::csv::Writer::from_writer(Vec::new());
        writer.write_record(COLUMNS)?;
        for pass in &self.passes {
            let times = times(pass.gpu_ms.as_ref(), pass.share, &pass.cpu_ms);
            writer.write_record(self.record([&pass.name, &pass.kind], times))?;
        }
        let frame = times(self.frame.gpu_ms.as_ref(), None, &self.frame.cpu_ms);
        let mut record = self.record(["", "frame"], frame);
        let wall = &self.frame.wall_ms;
        if let Some(cell) = record.last_mut() {
            *cell = cell_ms(wall.median);
        }
        writer.write_record(record)?;
        let bytes = writer.into_inner().map_err(|error| error.into_error())?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    fn record(&self, name: [&str; 2], times: [String; 9]) -> Vec<String> {
        let Conditions {
            program,
            build,
            date,
            adapter,
            scene,
            preset,
            view,
            viewport: [width, height],
            warmup,
            ..
        } = &self.conditions;
        let params = self.conditions.params();
        let params: Vec<String> = params
            .map(|(name, value)| format!("{name}={value}"))
            .collect();
        let conditions = [
            program.clone(),
            build.clone(),
            date.clone(),
            adapter.name.clone(),
            adapter.backend.clone(),
            adapter.driver.clone(),
            adapter.gpu_unavailable.clone().unwrap_or_default(),
            scene.name.clone(),
            scene.triangles.to_string(),
            preset.clone(),
            view.clone(),
            width.to_string(),
            height.to_string(),
            params.join(" "),
            self.timed().to_string(),
            warmup.to_string(),
        ];
        let name = name.map(str::to_owned);
        let wall = String::new();
        conditions
            .into_iter()
            .chain(name)
            .chain(times)
            .chain([wall])
            .collect()
    }
}

fn cell_ms(ms: f64) -> String {
    format!("{ms:.6}")
}

fn times(gpu: Option<&Series>, share: Option<f64>, cpu: &Series) -> [String; 9] {
    let gpu =
        |pick: fn(&Series) -> f64| gpu.map(|series| cell_ms(pick(series))).unwrap_or_default();
    [
        gpu(|series| series.min),
        gpu(|series| series.median),
        gpu(|series| series.p95),
        gpu(|series| series.max),
        share.map(|share| format!("{share:.6}")).unwrap_or_default(),
        cell_ms(cpu.min),
        cell_ms(cpu.median),
        cell_ms(cpu.p95),
        cell_ms(cpu.max),
    ]
}

const COLUMNS: [&str; 28] = [
    "program",
    "build",
    "date",
    "adapter",
    "backend",
    "driver",
    "gpu_unavailable",
    "scene",
    "triangles",
    "preset",
    "view",
    "width",
    "height",
    "params",
    "frames",
    "warmup",
    "pass",
    "kind",
    "gpu_min_ms",
    "gpu_median_ms",
    "gpu_p95_ms",
    "gpu_max_ms",
    "gpu_share",
    "cpu_min_ms",
    "cpu_median_ms",
    "cpu_p95_ms",
    "cpu_max_ms",
    "wall_median_ms",
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::record::tests::sample;

    #[test]
    fn csv_has_a_line_per_pass_and_one_for_the_frame() {
        let csv = sample().to_csv().unwrap();
        insta::assert_snapshot!(csv);
        let mut reader = ::csv::Reader::from_reader(csv.as_bytes());
        let lengths = reader.records().map(|record| record.unwrap().len());
        assert_eq!(lengths.collect::<Vec<_>>(), [COLUMNS.len(); 3]);
    }
}
