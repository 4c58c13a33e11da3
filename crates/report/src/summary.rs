//! Combines runs into rows: one row for each method and setting, over all views of a viewport. The
//! band of a picture is the set of pixels at which rounding decides the right answer.

use skiagraph_compare::lists::entry;
use skiagraph_compare::records::regimes::Regime;
use skiagraph_compare::records::results::{Measured, Part, Run, step};
use skiagraph_compare::records::sequence::SequenceFrame;
use skiagraph_compare::records::statistics::FrameTimes;
use skiagraph_compare::records::steady::Cycle;
use skiagraph_compare::records::tuned::Tuned;
use skiagraph_compare::records::turns::{Ratio, Turns};
use skiagraph_reference::Shimmer;

/// Figures of one method in one setting of its params and with one map size, combined over the
/// views of one viewport and light.
#[derive(Debug)]
pub struct Row<'a> {
    /// Name of the method with its setting and map size in texels: `crsm@n=1 1024`. Without a
    /// shadow map it is [`method`](Self::method).
    pub label: String,
    /// Name of the method with its setting, such as `crsm@n=1`.
    pub method: String,
    /// The method's runs with measurements, one for each view.
    runs: Vec<Measurement<'a>>,
    /// Reason why the method ran on none of the views; `None` if it ran on any.
    pub unavailable: Option<&'a str>,
    /// True if every run has GPU times.
    pub has_gpu_times: bool,
}

/// A run and its measurements.
type Measurement<'a> = (&'a Run, &'a Measured);

/// Choice of frames: those before each of which that has moved. `None` chooses the frames of a
/// still view in which every pass runs, and all frames of a path.
pub type When = Option<Regime>;

/// Greatest value of a figure among the views, and the frames of camera paths, that a [`Row`]
/// combines.
#[derive(Clone, Debug, PartialEq)]
pub struct Worst {
    /// The value, in the unit of the figure.
    pub value: f64,
    /// Place of the value in words, such as `` `roofs` `` or `` frame 12 of `wind` ``. `None` if
    /// the row has one view alone and no path.
    pub place: Option<String>,
}

impl Worst {
    /// Returns the place behind ` on `; nothing if there is only one.
    pub fn on(&self) -> String {
        let place = self.place.as_ref();
        place.map_or(String::new(), |place| format!(" on {place}"))
    }

    /// The greater one, the first of equal ones.
    fn greater(self, other: Self) -> Self {
        let is_more = other.value > self.value;
        if is_more { other } else { self }
    }
}

/// Number of wrong pixels of a method over all views.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wrong {
    /// Wrong pixels outside the band (the pixels whose answer rounding decides). These count
    /// against the method.
    pub outside_band: u64,
    /// Wrong pixels in the band, the pixels whose answer rounding decides. These do not count
    /// against the method.
    pub in_band: u64,
    /// All pixels that face the light, wrong or not.
    pub facing_light: u64,
    /// All pixels in the band (those whose answer rounding decides), wrong or not.
    pub band: u64,
}

impl Wrong {
    /// Returns the wrong pixels outside the band (the pixels whose answer rounding decides) as a
    /// share of the pixels that face the light, from 0 to 1; 0 if no pixel faces the light.
    pub fn share(self) -> f64 {
        self.outside_band as f64 / self.facing_light.max(1) as f64
    }
}

impl<'a> Row<'a> {
    fn new(label: String, attempts: &[&'a Run]) -> Self {
        let measured = |run: &&'a Run| Some((*run, run.measured.as_ref()?));
        let runs: Vec<_> = attempts.iter().filter_map(measured).collect();
        let unavailable = attempts.iter().find_map(|run| run.unavailable.as_deref());
        let has_time = |(_, measured): &(&Run, &Measured)| {
            let mut regimes = measured.regimes.iter().map(|times| &times.frame);
            measured.frame.gpu_ms.is_some() && regimes.all(|times| times.gpu_ms.is_some())
        };
        Self {
            method: attempts
                .first()
                .map(|run| run.preset.clone())
                .unwrap_or_default(),
            label,
            unavailable: unavailable.filter(|_| runs.is_empty()),
            has_gpu_times: runs.iter().all(has_time),
            runs,
        }
    }

    /// Returns the runs with measurements, one for each view.
    pub fn runs(&self) -> impl Iterator<Item = (&'a Run, &'a Measured)> {
        self.runs.iter().copied()
    }

    /// Returns the record of the search that chose this row's params; `None` if the method was not
    /// tuned, or could not run.
    pub fn tuned(&self) -> Option<&'a Tuned> {
        self.runs.first().and_then(|(run, _)| run.tuned.as_ref())
    }

    /// Returns the number of views on which the method was measured; 0 if it could not run.
    pub fn views(&self) -> usize {
        self.runs.len()
    }

    /// Returns the numbers of wrong pixels, summed over the views; a [share of
    /// light](skiagraph_compare#terms) of one half or more counts as lit. For a method that reuses
    /// results of earlier frames they are means over its steady state (the pictures that it
    /// repeats), rounded up.
    pub fn wrong(&self) -> Wrong {
        let runs = self.runs.iter();
        runs.fold(Wrong::default(), |sum, (run, measured)| {
            let (outside, in_band) = match cycle(measured) {
                Some(cycle) => {
                    let outside = cycle.wrong_outside_band_mean;
                    (
                        outside.ceil() as u64,
                        (cycle.wrong_mean - outside).ceil() as u64,
                    )
                }
                None => (measured.wrong_outside_band(), measured.wrong.in_band),
            };
            Wrong {
                outside_band: sum.outside_band + outside,
                in_band: sum.in_band + in_band,
                facing_light: sum.facing_light + run.pixels.facing_light,
                band: sum.band + run.band,
            }
        })
    }

    /// Returns the view or frame with the greatest share of wrong pixels outside the band (the
    /// pixels whose answer rounding decides) among the pixels that face the light, 0 to 1; `None`
    /// without runs.
    pub fn most_wrong(&self) -> Option<Worst> {
        let wrong = |count: u64, whole: u64| Some(share(Part { count, of: whole }));
        self.worst(
            |run, measured| wrong(measured.wrong_outside_band(), run.pixels.facing_light),
            |_, _, frame| wrong(frame.wrong_outside_band, frame.facing_light),
        )
    }

    /// Returns the view or frame with the greatest root mean square error of the [shares of
    /// light](skiagraph_compare#terms), 0 to 1; `None` without runs.
    pub fn greatest_rmse(&self) -> Option<Worst> {
        let rmse = |_: &Run, measured: &Measured| Some(measured.graded.rmse);
        self.worst(rmse, |_, _, frame| Some(frame.graded.rmse))
    }

    /// Returns the view or frame with the greatest FLIP error (perceptual difference, 0 to 1) of
    /// the shaded picture; `None` without runs.
    pub fn greatest_flip(&self) -> Option<Worst> {
        let flip = |_: &Run, measured: &Measured| Some(measured.graded.flip);
        self.worst(flip, |_, _, frame| Some(frame.graded.flip))
    }

    /// Returns the view whose frames take longest, by their median, or of frames without a regime
    /// the slowest frame of a path, in milliseconds. `None` if a view has no such time. `by_wall`
    /// selects wall time instead of GPU time and the upkeep of the CPU.
    pub fn slowest(&self, when: When, by_wall: bool) -> Option<Worst> {
        let of_view = |measured: &Measured| median(measured, when, by_wall);
        if when.is_some() {
            return self.worst_view(of_view);
        }
        self.worst(
            |_, measured| of_view(measured),
            |measured, index, _| measured.frame.costs(by_wall)?.get(index).copied(),
        )
    }

    /// Returns the view or path on which the time that `percent` percent of the frames keep to
    /// is the longest, in milliseconds. `None` if a view has no such times. `by_wall` selects wall
    /// time instead of GPU time and the upkeep of the CPU.
    pub fn percentile(&self, percent: u8, by_wall: bool) -> Option<Worst> {
        self.worst_view(|measured| {
            let mut costs = measured.frame.costs(by_wall)?;
            costs.sort_by(f64::total_cmp);
            let rank = (costs.len() * usize::from(percent)).div_ceil(100).max(1);
            costs.get(rank - 1).copied()
        })
    }

    /// The view or path with the greatest value; `None` if one has none.
    fn worst_view(&self, value: impl Fn(&Measured) -> Option<f64>) -> Option<Worst> {
        let views = self.runs.iter().map(|(run, measured)| {
            let place = (self.views() > 1).then(|| format!("`{}`", run.view));
            Some(Worst {
                value: value(measured)?,
                place,
            })
        });
        let views: Vec<Worst> = views.collect::<Option<_>>()?;
        views.into_iter().reduce(Worst::greater)
    }

    /// Returns the pixels that the method lights although they are in the reference's shadow, of
    /// all in that shadow: the shadow that is missing, over all views. Pixels in the band count.
    pub fn missing_shadow(&self) -> Part {
        self.sum(missing)
    }

    /// Returns the pixels that the method darkens although the reference lights them, of all that
    /// it lights: the shadow that is false, over all views. Pixels in the band count.
    pub fn false_shadow(&self) -> Part {
        self.sum(falsely_dark)
    }

    /// Returns the view or path with the greatest share of [missing shadow](Self::missing_shadow),
    /// 0 to 1; `None` without runs.
    pub fn most_missing(&self) -> Option<Worst> {
        self.greatest_share(missing)
    }

    /// Returns the view or path with the greatest share of [false shadow](Self::false_shadow), 0 to
    /// 1; `None` without runs.
    pub fn most_false(&self) -> Option<Worst> {
        self.greatest_share(falsely_dark)
    }

    fn sum(&self, part: fn(&Run, &Measured) -> Part) -> Part {
        let parts = self.runs.iter().map(|(run, measured)| part(run, measured));
        parts.fold(Part { count: 0, of: 0 }, |sum, part| Part {
            count: sum.count + part.count,
            of: sum.of + part.of,
        })
    }

    fn greatest_share(&self, part: fn(&Run, &Measured) -> Part) -> Option<Worst> {
        let shares = self.runs.iter().map(|(run, measured)| Worst {
            value: share(part(run, measured)),
            place: (self.views() > 1).then(|| format!("`{}`", run.view)),
        });
        shares.reduce(Worst::greater)
    }

    /// The greatest value of a figure over views and frames of paths, the first of equal ones.
    fn worst(
        &self,
        of_view: impl Fn(&Run, &Measured) -> Option<f64>,
        of_frame: impl Fn(&Measured, usize, &SequenceFrame) -> Option<f64>,
    ) -> Option<Worst> {
        let mut worst: Option<Worst> = None;
        let mut add = |value: f64, place: Option<String>| {
            if worst.as_ref().is_none_or(|worst| value > worst.value) {
                worst = Some(Worst { value, place });
            }
        };
        for (run, measured) in &self.runs {
            let Some(path) = &measured.sequence else {
                let name = (self.views() > 1).then(|| format!("`{}`", run.view));
                add(of_view(run, measured)?, name);
                continue;
            };
            for (index, frame) in path.frames.iter().enumerate() {
                let place = format!("frame {index} of `{}`", run.view);
                add(of_frame(measured, index, frame)?, Some(place));
            }
        }
        worst
    }

    /// Returns the start of the newest comparison among those that measured the runs, in UTC:
    /// `2026-11-21T04:30:12Z`. It is empty without runs.
    pub fn session(&self) -> &'a str {
        let sessions = self.runs.iter().map(|(run, _)| run.session.as_str());
        sessions.max().unwrap_or_default()
    }

    /// True unless a run was cut short after a single frame.
    pub fn is_whole(&self) -> bool {
        self.runs.iter().all(|(run, _)| run.is_whole())
    }

    /// True if the visibility of every pixel outside the band (the pixels whose answer rounding
    /// decides) equals the [reference](skiagraph_compare#terms)'s, also as a [share of
    /// light](skiagraph_compare#terms). True without runs.
    pub fn is_exact(&self) -> bool {
        let is_exact = |(_, measured): &(&Run, &Measured)| {
            measured.wrong_outside_band() == 0 && measured.graded.rmse_outside_band == 0.0
        };
        self.runs.iter().all(is_exact)
    }

    /// Returns the width and height of the shadow map in texels; `None` if the method has none, or
    /// could not run.
    pub fn map_size(&self) -> Option<u32> {
        self.runs.first().and_then(|(run, _)| run.map_size)
    }

    /// Returns the method's steps (passes with the same name up to the first dot) in order, each
    /// with its GPU milliseconds: the sum of the medians of its passes, as the mean of the views.
    /// Passes without GPU times are left out.
    pub fn steps(&self) -> Vec<(&'a str, f64)> {
        let mut steps: Vec<(&str, f64)> = Vec::new();
        let passes = self.runs.iter().flat_map(|(_, measured)| &measured.passes);
        for (name, gpu) in passes.filter_map(|pass| Some((step(&pass.name), pass.gpu_ms?))) {
            let ms = gpu.median / self.views() as f64;
            *entry(&mut steps, name) += ms;
        }
        steps
    }

    /// Returns the root mean square error of the [shares of light](skiagraph_compare#terms), 0 to
    /// 1, over all views; `None` without runs. For a method that reuses results of earlier frames
    /// the error of a view is the mean over its steady state, the pictures that it repeats.
    pub fn rmse(&self) -> Option<f64> {
        let rmse = |measured: &Measured| {
            cycle(measured).map_or(measured.graded.rmse, |cycle| cycle.rmse_mean)
        };
        self.mean(|_, measured| Some(rmse(measured).powi(2)))
            .map(f64::sqrt)
    }

    /// Returns the FLIP error (perceptual difference, 0 to 1) of the shaded pictures, as the mean
    /// of the views; `None` without runs.
    pub fn flip(&self) -> Option<f64> {
        self.mean(|_, measured| {
            Some(cycle(measured).map_or(measured.graded.flip, |cycle| cycle.flip_mean))
        })
    }

    /// True if the light has an extent. Then methods are judged by their [shares of
    /// light](skiagraph_compare#terms).
    pub fn is_soft(&self) -> bool {
        self.runs.iter().any(|(run, _)| run.area.is_some())
    }

    /// Returns the milliseconds of a frame: GPU time and the upkeep of the CPU added, the mean of
    /// the views' medians. `None` if a view has no such time. `by_wall` selects wall time instead.
    pub fn frame_ms(&self, when: When, by_wall: bool) -> Option<f64> {
        self.mean(|_, measured| median(measured, when, by_wall))
    }

    /// Returns the first and third quartile of the times of [`frame_ms`](Self::frame_ms), in
    /// milliseconds: the means of the views. `None` if a view has no such times.
    pub fn quartiles(&self, when: When, by_wall: bool) -> Option<[f64; 2]> {
        let spread = |measured: &Measured| measured.times(when)?.spread(by_wall);
        let q1 = self.mean(|_, measured| Some(spread(measured)?.q1))?;
        Some([q1, self.mean(|_, measured| Some(spread(measured)?.q3))?])
    }

    /// Returns the regimes in which every run of the row was timed; none without runs.
    pub fn regimes(&self) -> Vec<Regime> {
        let is_timed = |regime: &Regime| {
            let mut runs = self.runs();
            runs.all(|(_, measured)| measured.times(Some(*regime)).is_some())
        };
        let regimes = Regime::ALL.into_iter().filter(|_| self.views() > 0);
        regimes.filter(is_timed).collect()
    }

    /// Returns the GPU milliseconds of a frame without its G-buffer, which all methods draw alike:
    /// the mean of the views' medians. `None` if a view has no GPU times.
    pub fn own_ms(&self) -> Option<f64> {
        self.mean(|_, measured| measured.ms_without_gbuffer())
    }

    /// True if a run is of a camera path.
    pub fn is_path(&self) -> bool {
        self.runs
            .iter()
            .any(|(_, measured)| measured.sequence.is_some())
    }

    /// Returns the number of timed frames of the view that has the fewest; 0 without runs.
    pub fn frames(&self, when: When) -> usize {
        let frames = self.runs.iter().map(|(_, measured)| {
            measured
                .times(when)
                .map_or(0, |times| times.wall_frames.len())
        });
        frames.min().unwrap_or_default()
    }

    /// Returns the ratio of the times of this row's frames to those of another row that was timed
    /// in the same turns, summed over the views, with its interval ([`Ratio::paired`]). `by_wall`
    /// selects wall time instead of GPU time and the upkeep of the CPU. `None` if the rows have
    /// other views, or frames that were not timed in the same turns of one session; if times are
    /// missing, or of fewer than eight turns.
    pub fn ratio(&self, other: &Self, when: When, by_wall: bool) -> Option<Ratio> {
        let mut sums: [Vec<f64>; 2] = Default::default();
        for ((run, one), (other_run, other)) in self.runs.iter().zip(&other.runs) {
            let is_pair = (&run.session, &run.view) == (&other_run.session, &other_run.view);
            let turns = [one, other].map(|measured| measured.turns.as_ref());
            let [Some(turns), Some(other_turns)] = turns.map(|turns| turns.filter(|_| is_pair))
            else {
                return None;
            };
            let [ms, other_ms] = [one, other].map(|measured| measured.times(when)?.costs(by_wall));
            let (ms, mut other_ms) = (ms?, other_ms?);
            if turns.group != other_turns.group {
                // The anchor drew in both groups.
                let anchors = [turns, other_turns].map(|turns| anchor(turns, when)?.costs(by_wall));
                let [anchor, other_anchor] = anchors;
                let scales = anchor?.into_iter().zip(other_anchor?);
                let scaled = other_ms.iter().zip(scales);
                other_ms = scaled
                    .map(|(ms, (anchor, other))| ms * anchor / other.max(1e-6))
                    .collect();
            }
            for (sum, frames) in sums.iter_mut().zip([ms, other_ms]) {
                sum.resize(sum.len().max(frames.len()), 0.0);
                sum.iter_mut().zip(frames).for_each(|(sum, ms)| *sum += ms);
            }
        }
        Ratio::paired(&sums[0], &sums[1]).filter(|_| self.views() == other.views())
    }

    /// True if the frame times of two rows differ by more than chance: their [`ratio`](Self::ratio)
    /// is [told apart](Ratio::is_told_apart). False if there is no ratio.
    pub fn is_told_apart(&self, other: &Self, when: When, by_wall: bool) -> bool {
        let ratio = self.ratio(other, when, by_wall);
        ratio.is_some_and(|ratio| ratio.is_told_apart())
    }

    /// Returns the number of rays per frame, the mean of the views; `None` if the method does not
    /// count them.
    pub fn rays(&self) -> Option<f64> {
        self.mean(|_, measured| measured.rays.map(|rays| rays as f64 / frames(measured)))
    }

    /// Returns the number of pixels on camera paths whose visibility changed from one frame to the
    /// next although the right one did not, of those that were compared. `None` if a run is not of
    /// a path.
    pub fn shimmer(&self) -> Option<Part> {
        let mut shimmer = Shimmer::default();
        for (_, measured) in &self.runs {
            shimmer += measured.sequence.as_ref()?.shimmer;
        }
        Some(Part {
            count: shimmer.changed,
            of: shimmer.compared,
        })
    }

    /// Returns the frame with the greatest [`error`](SequenceFrame::error) on all camera paths;
    /// `None` without paths.
    pub fn worst_frame(&self) -> Option<&'a SequenceFrame> {
        let paths = self.runs.iter();
        let worst = paths.filter_map(|(_, measured)| Some(measured.sequence.as_ref()?.worst()?.1));
        worst.max_by(|one, other| one.error().total_cmp(&other.error()))
    }

    /// Returns the bytes of the textures and buffers that the graph makes, and of the scene buffers
    /// that it reads: the most on any view.
    pub fn bytes(&self) -> u64 {
        let bytes = self.runs.iter();
        let bytes = bytes.map(|(_, measured)| measured.memory_bytes + measured.scene_bytes);
        bytes.max().unwrap_or_default()
    }

    /// Returns the estimated standard error of the [reference](skiagraph_compare#terms)'s [shares
    /// of light](skiagraph_compare#terms) under a light [with an extent](skiagraph_compare#terms),
    /// as the root mean square over the pixels: the greatest of the views. `None` under other
    /// lights.
    pub fn reference_error(&self) -> Option<f64> {
        let errors = self.runs.iter().filter_map(|(run, _)| run.area);
        errors.map(|area| area.standard_error_rms).reduce(f64::max)
    }

    fn mean(&self, value: impl Fn(&Run, &Measured) -> Option<f64>) -> Option<f64> {
        let values = self.runs.iter().map(|(run, measured)| value(run, measured));
        let sum: f64 = values.sum::<Option<f64>>()?;
        (self.views() > 0).then(|| sum / self.views() as f64)
    }
}

/// Times of a group's anchor.
fn anchor(turns: &Turns, when: When) -> Option<&FrameTimes> {
    let Some(regime) = when else {
        return Some(&turns.anchor);
    };
    let mut regimes = turns.regimes.iter();
    Some(&regimes.find(|times| times.regime == regime)?.frame)
}

/// Shadow of a run that is missing, of all that the reference has.
fn missing(run: &Run, measured: &Measured) -> Part {
    Part {
        count: measured.wrong.lit,
        of: run.pixels.shadow,
    }
}

/// Light of a run that is dark, of all that the reference has.
fn falsely_dark(run: &Run, measured: &Measured) -> Part {
    Part {
        count: measured.wrong.shadow,
        of: run.pixels.lit,
    }
}

/// The share of a part in its whole, 0 to 1.
pub(crate) fn share(part: Part) -> f64 {
    part.count as f64 / part.of.max(1) as f64
}

/// The steady state of a method that remembers, as it was judged.
fn cycle(measured: &Measured) -> Option<Cycle> {
    measured.steady.as_ref()?.judged
}

/// Counts of a path are those of all its frames.
fn frames(measured: &Measured) -> f64 {
    let frames = measured
        .sequence
        .as_ref()
        .map_or(1, |path| path.frames.len());
    frames.max(1) as f64
}

fn median(measured: &Measured, when: When, by_wall: bool) -> Option<f64> {
    Some(measured.times(when)?.spread(by_wall)?.median)
}

/// Combines the runs of `runs` that are in the viewport `viewport` (pixels) into rows by method,
/// setting and map size, the fastest first. Give it the runs under one light: it does not keep
/// lights apart. Rows that could not run come last. A tuned method stands behind the one that it is
/// a setting of.
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
    let time = |row: &Row| row.frame_ms(None, by_wall).unwrap_or(f64::INFINITY);
    rows.sort_by(|one, other| time(one).total_cmp(&time(other)));
    let is_changed = |row: &Row| row.tuned().is_some_and(|tuned| !tuned.set.is_empty());
    let (tuned, mut rows): (Vec<Row>, Vec<Row>) = rows.into_iter().partition(is_changed);
    for row in tuned {
        let base = row.tuned().map(|tuned| &tuned.of);
        let before = rows.iter().rposition(|other| Some(&other.method) == base);
        rows.insert(before.map_or(rows.len(), |before| before + 1), row);
    }
    rows
}

/// True if some rows have no GPU times, so that rows can be compared by wall time only.
pub fn by_wall(rows: &[Row]) -> bool {
    rows.iter().any(|row| !row.has_gpu_times)
}
