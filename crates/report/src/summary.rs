//! Runs folded to a row per method and setting, over all views of a viewport: the figures by which
//! to pick a method.

use skiagraph_compare::lists::entry;
use skiagraph_compare::records::results::{Measured, Part, Run, step};
use skiagraph_compare::records::sequence::SequenceFrame;
use skiagraph_compare::records::statistics::FrameTimes;
use skiagraph_compare::records::steady::Cycle;
use skiagraph_compare::records::turns::{PairedRatio, Turns};
use skiagraph_reference::Shimmer;

/// One method in one setting, over the views that it was measured on.
#[derive(Debug)]
pub struct Row<'a> {
    /// Method, variant and map size.
    pub label: String,
    /// Method and variant.
    pub method: String,
    /// Its runs, one per view, those that measured something.
    runs: Vec<Measurement<'a>>,
    /// Why it could not run, where it could not at all.
    pub unavailable: Option<&'a str>,
    /// True if its times are the GPU's own, not the wall clock's.
    pub has_gpu_times: bool,
}

/// A run, and its measurements.
type Measurement<'a> = (&'a Run, &'a Measured);

/// Wrong pixels over all views.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wrong {
    /// Outside the band: what counts.
    pub outside_band: u64,
    /// In the band, where the answer hangs on rounding.
    pub in_band: u64,
    /// Number of pixels that face the light, of which these are.
    pub facing_light: u64,
    /// Number of these in the band: which answer is right there hangs on rounding.
    pub band: u64,
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

    /// Its runs that measured something, one per view.
    pub fn runs(&self) -> impl Iterator<Item = (&'a Run, &'a Measured)> {
        self.runs.iter().copied()
    }

    /// On how many views it was measured.
    pub fn views(&self) -> usize {
        self.runs.len()
    }

    /// Pixels that are wrong if shares are cut at one half; of a method that remembers the mean of
    /// its steady state, rounded up.
    pub fn wrong(&self) -> Wrong {
        self.runs.iter().fold(Wrong::default(), |sum, (run, of)| {
            let (outside, in_band) = match cycle(of) {
                Some(cycle) => {
                    let outside = cycle.wrong_outside_band_mean;
                    (
                        outside.ceil() as u64,
                        (cycle.wrong_mean - outside).ceil() as u64,
                    )
                }
                None => (of.wrong_outside_band(), of.wrong.in_band),
            };
            Wrong {
                outside_band: sum.outside_band + outside,
                in_band: sum.in_band + in_band,
                facing_light: sum.facing_light + run.pixels.facing_light,
                band: sum.band + run.band,
            }
        })
    }

    /// When the newest comparison began that measured it.
    pub fn session(&self) -> &'a str {
        let sessions = self.runs.iter().map(|(run, _)| run.session.as_str());
        sessions.max().unwrap_or_default()
    }

    /// True unless an early end left one of its runs with a single frame.
    pub fn is_whole(&self) -> bool {
        self.runs.iter().all(|(run, _)| run.is_whole())
    }

    /// True if no answer outside the band differs from the reference's, in any share.
    pub fn is_exact(&self) -> bool {
        let is_exact = |(_, of): &(&Run, &Measured)| {
            of.wrong_outside_band() == 0 && of.graded.rmse_outside_band == 0.0
        };
        self.runs.iter().all(is_exact)
    }

    /// Wrong pixels of the worst picture as a share of those facing the light, of a method that
    /// remembers and whose pictures differ in its steady state.
    pub fn worst_of_cycle(&self) -> Option<Part> {
        let pictures = |of: &Measured| cycle(of).map_or(1, |cycle| cycle.pictures);
        let worst = self.runs.iter().filter(|(_, of)| pictures(of) > 1);
        let part = |(run, of): &(&Run, &Measured)| Part {
            count: of.wrong_outside_band(),
            of: run.pixels.facing_light,
        };
        worst
            .map(part)
            .max_by(|one, other| (one.count * other.of.max(1)).cmp(&(other.count * one.of.max(1))))
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

    /// Root mean square error of the shares of light, over all views; of a method that remembers in
    /// the mean of its steady state.
    pub fn rmse(&self) -> Option<f64> {
        let rmse = |of: &Measured| cycle(of).map_or(of.graded.rmse, |cycle| cycle.rmse_mean);
        self.mean(|_, of| Some(rmse(of).powi(2))).map(f64::sqrt)
    }

    /// FLIP of the shaded pictures, the mean of the views.
    pub fn flip(&self) -> Option<f64> {
        self.mean(|_, of| Some(cycle(of).map_or(of.graded.flip, |cycle| cycle.flip_mean)))
    }

    /// True if the light has an extent: then shares are what is judged.
    pub fn is_soft(&self) -> bool {
        self.runs.iter().any(|(run, _)| run.area.is_some())
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

    /// First and third quartile of the same times as [`frame_ms`](Self::frame_ms), or with `kept`
    /// as [`kept_ms`](Self::kept_ms): means of the views'.
    pub fn quartiles(&self, by_wall: bool, is_kept: bool) -> Option<[f64; 2]> {
        let times = if is_kept { kept } else { full };
        let q1 = self.mean(|_, of| Some(times(of).spread(by_wall)?.q1))?;
        Some([q1, self.mean(|_, of| Some(times(of).spread(by_wall)?.q3))?])
    }

    /// Milliseconds of a frame less its G-buffer, which all methods have alike, by the GPU's clock.
    pub fn own_ms(&self) -> Option<f64> {
        self.mean(|_, of| of.ms_without_gbuffer())
    }

    /// True if its frames were faster or slower than those of another row on the same views, with
    /// every pass run or with what is kept. Frames that took turns are compared turn by turn;
    /// those that did not are told apart if their quartiles do not overlap.
    pub fn is_told_apart(&self, other: &Self, by_wall: bool, is_kept: bool) -> bool {
        let pair = || self.runs.iter().zip(&other.runs);
        let is_pair = |((one, of), (other, of_other)): (&Measurement, &Measurement)| {
            one.session == other.session && are_paired(of, of_other)
        };
        if !is_kept && pair().all(is_pair) {
            let mut sums: [Vec<f64>; 2] = Default::default();
            for ((_, one), (_, other)) in pair() {
                let times = [one, other].map(|of| full(of).frames(by_wall));
                let [Some(one_ms), Some(other_ms)] = times else {
                    return false;
                };
                let scale = anchors(one, other, by_wall);
                for turn in 0..one_ms.len().min(other_ms.len()) {
                    let scale = scale.as_ref().map_or(1.0, |scale| scale[turn]);
                    let add = [one_ms[turn], other_ms[turn] * scale];
                    for (sums, ms) in sums.iter_mut().zip(add) {
                        match sums.get_mut(turn) {
                            Some(sum) => *sum += ms,
                            None => sums.push(ms),
                        }
                    }
                }
            }
            let ratio = PairedRatio::new(&sums[0], &sums[1]);
            return ratio.is_some_and(|ratio| ratio.is_told_apart());
        }
        let quartiles = [self, other].map(|row| {
            let kept = row.quartiles(by_wall, is_kept);
            kept.or_else(|| row.quartiles(by_wall, false))
        });
        match quartiles {
            [Some([q1, q3]), Some([other_q1, other_q3])] => q3 < other_q1 || other_q3 < q1,
            _ => false,
        }
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

/// True if the frames of two runs of a view can be compared one by one: they took turns, or are
/// those of one camera path.
fn are_paired(one: &Measured, other: &Measured) -> bool {
    one.turns.is_some() == other.turns.is_some()
}

/// How the common anchor's times in the group of `one` stand to those in the group of `other`, turn
/// by turn; `None` of one group.
fn anchors(one: &Measured, other: &Measured, by_wall: bool) -> Option<Vec<f64>> {
    let (one, other) = (one.turns.as_ref()?, other.turns.as_ref()?);
    if one.group == other.group {
        return None;
    }
    let frames = |of: &Turns| Some(of.anchor.frames(by_wall)?.to_vec());
    let pairs = frames(one)?.into_iter().zip(frames(other)?);
    Some(pairs.map(|(one, other)| one / other.max(1e-6)).collect())
}

/// The steady state of a method that remembers, as it was judged.
fn cycle(of: &Measured) -> Option<Cycle> {
    of.steady.as_ref()?.judged
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
    Some(times.spread(by_wall)?.median)
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
