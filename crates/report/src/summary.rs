//! Runs folded to a row per method and setting, over all views of a viewport: the figures by which
//! to pick a method.

use skiagraph_compare::lists::entry;
use skiagraph_compare::records::results::{Measured, Part, Run, step};
use skiagraph_compare::records::sequence::SequenceFrame;
use skiagraph_compare::records::statistics::FrameTimes;
use skiagraph_reference::Shimmer;

/// One method in one setting, over the views that it was measured on.
#[derive(Debug)]
pub struct Row<'a> {
    /// Method, variant and map size.
    pub label: String,
    /// Method and variant.
    pub method: String,
    /// Its runs, one per view, those that measured something.
    runs: Vec<(&'a Run, &'a Measured)>,
    /// Why it could not run, where it could not at all.
    pub unavailable: Option<&'a str>,
    /// True if its times are the GPU's own, not the wall clock's.
    pub has_gpu_times: bool,
}

/// Wrong pixels over all views.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wrong {
    /// Outside the band: what counts.
    pub outside_band: u64,
    /// In the band, where the answer hangs on rounding.
    pub in_band: u64,
    /// Number of pixels that face the light, of which these are.
    pub facing_light: u64,
}

impl Wrong {
    /// Those outside the band as a share of what faces the light.
    pub fn share(self) -> f64 {
        self.outside_band as f64 / self.facing_light.max(1) as f64
    }
}

impl<'a> Row<'a> {
    fn new(label: String, all: &[&'a Run]) -> Self {
        let measured = |run: &&'a Run| Some((*run, run.measured.as_ref()?));
        let runs: Vec<_> = all.iter().filter_map(measured).collect();
        let unavailable = all.iter().find_map(|run| run.unavailable.as_deref());
        let has_time =
            |(_, of): &(&Run, &Measured)| full(of).gpu_ms.is_some() && kept(of).gpu_ms.is_some();
        Self {
            method: all
                .first()
                .map(|run| run.preset.clone())
                .unwrap_or_default(),
            label,
            unavailable: unavailable.filter(|_| runs.is_empty()),
            has_gpu_times: runs.iter().all(has_time),
            runs,
        }
    }

    /// On how many views it was measured.
    pub fn views(&self) -> usize {
        self.runs.len()
    }

    /// Wrong pixels, of hard answers.
    pub fn wrong(&self) -> Wrong {
        self.runs
            .iter()
            .fold(Wrong::default(), |sum, (run, of)| Wrong {
                outside_band: sum.outside_band + of.wrong_outside_band(),
                in_band: sum.in_band + of.wrong.in_band,
                facing_light: sum.facing_light + run.pixels.facing_light,
            })
    }

    /// The size of its map, where it has one.
    pub fn map_size(&self) -> Option<u32> {
        self.runs.first().and_then(|(run, _)| run.map_size)
    }

    /// Its steps in their order, each with the sum of its passes' medians in GPU ms, means of the
    /// views; those without GPU times are left out.
    pub fn steps(&self) -> Vec<(&'a str, f64)> {
        let mut steps: Vec<(&str, f64)> = Vec::new();
        let passes = self.runs.iter().flat_map(|(_, of)| &of.passes);
        for (name, gpu) in passes.filter_map(|pass| Some((step(&pass.name), pass.gpu_ms?))) {
            let ms = gpu.median / self.views() as f64;
            *entry(&mut steps, name) += ms;
        }
        steps
    }

    /// Root mean square error of graded answers, over all views.
    pub fn rmse(&self) -> Option<f64> {
        let squares = self.mean(|_, of| Some(of.graded?.rmse.powi(2)));
        squares.map(f64::sqrt)
    }

    /// Milliseconds of a frame in which light or meshes have moved: every pass runs. The mean of
    /// the views' medians; of the wall clock if `by_wall`.
    pub fn frame_ms(&self, by_wall: bool) -> Option<f64> {
        self.mean(|_, of| median(full(of), by_wall))
    }

    /// The same of a frame in which only the camera has moved; `None` where nothing is kept.
    pub fn kept_ms(&self, by_wall: bool) -> Option<f64> {
        let keeps = |(_, of): &(&Run, &Measured)| kept(of) != full(of);
        let any = self.runs.iter().any(keeps);
        self.mean(|_, of| median(kept(of), by_wall)).filter(|_| any)
    }

    /// Rays of a frame, if the method counts them.
    pub fn rays(&self) -> Option<f64> {
        self.mean(|_, of| of.rays.map(|rays| rays as f64 / frames(of)))
    }

    /// Counts, of camera paths, answers that changed though the right ones did not, of those
    /// compared.
    pub fn shimmer(&self) -> Option<Part> {
        let mut all = Shimmer::default();
        for (_, of) in &self.runs {
            all += of.sequence.as_ref()?.shimmer;
        }
        Some(Part {
            count: all.changed,
            of: all.compared,
        })
    }

    /// Worst frame of all camera paths, by its error.
    pub fn worst_frame(&self) -> Option<&'a SequenceFrame> {
        let paths = self.runs.iter();
        let worst = paths.filter_map(|(_, of)| Some(of.sequence.as_ref()?.worst()?.1));
        worst.max_by(|one, other| one.error().total_cmp(&other.error()))
    }

    /// Bytes of its own materials and of what it reads of the scene, the most on any view.
    pub fn bytes(&self) -> u64 {
        let bytes = self.runs.iter();
        let bytes = bytes.map(|(_, of)| of.memory_bytes + of.scene_bytes);
        bytes.max().unwrap_or_default()
    }

    /// The reference's own error, under a light that has an extent: the worst of the views.
    pub fn reference_error(&self) -> Option<f64> {
        let errors = self.runs.iter().filter_map(|(run, _)| run.area);
        errors.map(|area| area.standard_error_rms).reduce(f64::max)
    }

    fn mean(&self, value: impl Fn(&Run, &Measured) -> Option<f64>) -> Option<f64> {
        let values = self.runs.iter().map(|(run, of)| value(run, of));
        let sum: f64 = values.sum::<Option<f64>>()?;
        (self.views() > 0).then(|| sum / self.views() as f64)
    }
}

/// Counts of a path are those of all its frames.
fn frames(of: &Measured) -> f64 {
    let frames = of.sequence.as_ref().map_or(1, |path| path.frames.len());
    frames.max(1) as f64
}

/// Times with every pass run.
fn full(of: &Measured) -> &FrameTimes {
    let path = of.sequence.as_ref();
    path.and_then(|path| path.every_pass.as_ref())
        .unwrap_or(&of.frame)
}

/// Times with what is kept.
fn kept(of: &Measured) -> &FrameTimes {
    of.cached.as_ref().map_or(&of.frame, |cached| &cached.frame)
}

fn median(times: &FrameTimes, by_wall: bool) -> Option<f64> {
    if by_wall {
        Some(times.wall_ms.median)
    } else {
        times.gpu_ms.map(|gpu| gpu.median)
    }
}

/// The rows of one viewport, the fastest first, those that could not run last.
pub fn rows<'a>(runs: impl IntoIterator<Item = &'a Run>, viewport: [u32; 2]) -> Vec<Row<'a>> {
    let mut cells: Vec<(String, Vec<&Run>)> = Vec::new();
    for run in runs.into_iter().filter(|run| run.viewport == viewport) {
        entry(&mut cells, run.method_label()).push(run);
    }
    let rows = cells
        .into_iter()
        .map(|(label, runs)| Row::new(label, &runs));
    let mut rows: Vec<Row> = rows.collect();
    let by_wall = by_wall(&rows);
    let time = |row: &Row| row.frame_ms(by_wall).unwrap_or(f64::INFINITY);
    rows.sort_by(|one, other| time(one).total_cmp(&time(other)));
    rows
}

/// True if rows can only be compared by the wall clock: some have no GPU times.
pub fn by_wall(rows: &[Row]) -> bool {
    rows.iter().any(|row| !row.has_gpu_times)
}
