//! Conditions under which `compare` or `judge` fails, for continuous integration:
//! `nsm: wrong > 0.1%`.

use crate::summary::{Row, When, Worst, by_wall, share};
use crate::summary_table::summaries;
use skiagraph_compare::graphs::method::Method;
use skiagraph_compare::records::judged_pictures::{
    JudgedPicture, JudgedPictures, MOST_WITHOUT_ANSWER,
};
use skiagraph_compare::records::regimes::Regime;
use skiagraph_compare::records::results::{Part, Results};
use skiagraph_compare::wording::{bytes, ms, percent, size, unknown};
use skiagraph_reference::PixelCounts;
use std::path::Path;

/// Upper limit for one figure of a method or picture, beyond which `--fail-if` makes `compare` or
/// `judge` fail.
#[derive(Clone, Debug, PartialEq)]
pub struct Gate {
    /// Name of the method with its setting, for example `crsm@n=1`. For `judge` it is the path of a
    /// picture, or the picture's file name without its extension.
    pub method: String,
    /// The figure that is limited.
    pub figure: Figure,
    /// Greatest value that passes, in the unit of the figure: percent, milliseconds, bytes, or
    /// none.
    pub most: f64,
}

/// A figure of a method that a [`Gate`] can limit: every view, and every frame of a camera path,
/// must keep to the limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// Wrong pixels, in percent of the pixels that face the light. Pixels whose answer rounding
    /// decides (the band) do not count as wrong.
    Wrong,
    /// Shadow that is missing: lit pixels, in percent of those in the reference's shadow, of a
    /// camera path over all its frames. Pixels in the band count.
    Missing,
    /// Shadow that is false: dark pixels, in percent of those that the reference lights, of a
    /// camera path over all its frames. Pixels in the band count.
    False,
    /// Root mean square error of the [shares of light](skiagraph_compare#terms), which are 0 to 1.
    Rmse,
    /// FLIP error (perceptual difference) of the shaded picture, 0 to 1.
    Flip,
    /// Milliseconds of a frame: the median of a view's frames of that choice, without a regime the
    /// slowest frame of a path. GPU time and upkeep of the CPU, or wall time if any method has no
    /// GPU time in the same viewport under the same light.
    Frame(When),
    /// Milliseconds that this percentage of a view's or path's frames do not exceed, as
    /// [`Frame`](Self::Frame) measures them without a regime.
    Percentile(u8),
    /// Bytes of the textures and buffers of the method and of the scene buffers that it reads; the
    /// largest value of all views.
    Memory,
}

impl Figure {
    /// All figures.
    pub const ALL: [Self; 16] = [
        Self::Wrong,
        Self::Missing,
        Self::False,
        Self::Rmse,
        Self::Flip,
        Self::Frame(None),
        Self::Frame(Some(Regime::Nothing)),
        Self::Frame(Some(Regime::Camera)),
        Self::Frame(Some(Regime::Light)),
        Self::Frame(Some(Regime::SomeMeshes)),
        Self::Frame(Some(Regime::AllMeshes)),
        Self::Percentile(50),
        Self::Percentile(95),
        Self::Percentile(99),
        Self::Percentile(100),
        Self::Memory,
    ];

    /// Returns the word for the figure in a condition, for example `wrong`.
    pub fn word(self) -> String {
        match self {
            Self::Wrong => "wrong".into(),
            Self::Missing => "missing".into(),
            Self::False => "false".into(),
            Self::Rmse => "rmse".into(),
            Self::Flip => "flip".into(),
            Self::Frame(None) => "frame".into(),
            Self::Frame(Some(regime)) => regime.word().replace(' ', "_"),
            Self::Percentile(100) => "worst".into(),
            Self::Percentile(percent) => format!("p{percent}"),
            Self::Memory => "memory".into(),
        }
    }

    /// The greatest value over views and frames; `None` if the method could not run.
    fn worst(self, row: &Row, by_wall: bool) -> Option<Worst> {
        let in_percent = |worst: Worst| Worst {
            value: 100.0 * worst.value,
            ..worst
        };
        match self {
            Self::Wrong => row.most_wrong().map(in_percent),
            Self::Missing => row.most_missing().map(in_percent),
            Self::False => row.most_false().map(in_percent),
            Self::Rmse => row.greatest_rmse(),
            Self::Flip => row.greatest_flip(),
            Self::Frame(when) => row.slowest(when, by_wall),
            Self::Percentile(percent) => row.percentile(percent, by_wall),
            Self::Memory => (row.views() > 0).then(|| Worst {
                value: row.bytes() as f64,
                place: None,
            }),
        }
    }

    /// The figure of a judged picture of a view with these pixels; `None` if pictures have no such
    /// figure.
    fn of_picture(self, picture: &JudgedPicture, pixels: &PixelCounts) -> Option<f64> {
        let percent = |count: u64, whole: u64| Some(100.0 * share(Part { count, of: whole }));
        match self {
            Self::Wrong => percent(picture.wrong_attributable(), pixels.facing_light),
            Self::Missing => percent(picture.wrong.lit, pixels.shadow),
            Self::False => percent(picture.wrong.shadow, pixels.lit),
            Self::Rmse => Some(picture.graded.rmse_outside_band),
            Self::Flip => Some(picture.graded.flip),
            Self::Frame(_) | Self::Percentile(_) | Self::Memory => None,
        }
    }

    fn text(self, value: f64) -> String {
        match self {
            Self::Wrong | Self::Missing | Self::False => format!("{value:.4} %"),
            Self::Rmse | Self::Flip => format!("{value:.5}"),
            Self::Frame(_) | Self::Percentile(_) => format!("{} ms", ms(value)),
            Self::Memory => bytes(value as u64),
        }
    }
}

impl Gate {
    /// Checks that the method of every limit is one of `methods`, those of the comparison.
    ///
    /// # Errors
    /// A text for the user that names the first method that is not compared, and those that are.
    pub fn check(gates: &[Self], methods: &[Method]) -> Result<(), String> {
        let mut names: Vec<&str> = methods.iter().map(|method| method.name.as_str()).collect();
        names.dedup();
        let is_unknown = |gate: &&Self| !names.contains(&&*gate.method);
        gates.iter().find(is_unknown).map_or(Ok(()), |gate| {
            let what = format!("--fail-if: `{}` is not compared", gate.method);
            Err(unknown(&what, &gate.method, "methods", &names))
        })
    }

    /// Returns a line of text for each row that is beyond this limit on any view, or in any frame
    /// of a camera path: the worst of them is named. A row is the method with one map size, in one
    /// viewport and under one light, over all views. A row that could not run fails as well. The
    /// list is empty if all rows pass, or if the results have no row of the method.
    pub fn failures(&self, results: &Results) -> Vec<String> {
        let mut lines = Vec::new();
        for summary in summaries(results) {
            let by_wall = by_wall(&summary.rows);
            let viewport = size(summary.viewport);
            for row in summary.rows.iter().filter(|row| row.method == self.method) {
                let (label, word) = (&row.label, self.figure.word());
                let text = |value| self.figure.text(value);
                match self.figure.worst(row, by_wall) {
                    None => {
                        let why = if row.views() == 0 {
                            "it could not run"
                        } else {
                            "it was not timed so"
                        };
                        lines.push(format!("`{label}` at {viewport} has no {word}: {why}"));
                    }
                    Some(worst) if worst.value > self.most => lines.push(format!(
                        "`{label}` at {viewport}: {word} {}{} is more than {}",
                        text(worst.value),
                        worst.on(),
                        text(self.most)
                    )),
                    Some(_) => {}
                }
            }
        }
        lines
    }

    /// Checks that [`method`](Self::method) names one of the pictures `files` (by its path, or its
    /// file name without extension), and that [`figure`](Self::figure) is one that judged pictures
    /// have.
    ///
    /// # Errors
    /// A text for the user that names the unknown picture, or the figure that pictures lack.
    pub fn check_pictures(&self, files: &[String]) -> Result<(), String> {
        let (name, word) = (&self.method, self.figure.word());
        if matches!(
            self.figure,
            Figure::Frame(_) | Figure::Percentile(_) | Figure::Memory
        ) {
            return Err(format!(
                "--fail-if: a picture has no {word}; expected wrong, missing, false, rmse or flip"
            ));
        }
        if files.iter().any(|file| self.is_of(file)) {
            return Ok(());
        }
        let stems = files
            .iter()
            .filter_map(|file| Path::new(file).file_stem()?.to_str());
        let what = format!("--fail-if: `{name}` is not judged");
        Err(unknown(&what, name, "pictures", &stems.collect::<Vec<_>>()))
    }

    /// Returns a line of text for each judged picture that is beyond this limit, or without an
    /// answer at more than [`MOST_WITHOUT_ANSWER`] of the pixels that are judged; empty if all are
    /// within it. [`check_pictures`](Self::check_pictures) must have accepted the limit. Wrong
    /// pixels and RMSE leave out pixels in the [band](skiagraph_compare#terms),
    /// [unattributable](JudgedPictures::unattributable) ones and those without an answer.
    pub fn picture_failures(&self, judged: &JudgedPictures) -> Vec<String> {
        let apart = judged.band + judged.unattributable;
        let wanted = judged.pixels.facing_light.saturating_sub(apart);
        let pictures = judged
            .pictures
            .iter()
            .filter(|picture| self.is_of(&picture.file));
        let line = |picture: &JudgedPicture| {
            let (word, text) = (self.figure.word(), |value| self.figure.text(value));
            if picture.without_answer as f64 > MOST_WITHOUT_ANSWER * wanted as f64 {
                let share = percent(picture.without_answer, wanted);
                return Some(format!(
                    "`{}` has no {word}: no finite number at {share} of the pixels that are judged",
                    picture.file
                ));
            }
            let value = self.figure.of_picture(picture, &judged.pixels)?;
            let (value, most) = (value > self.most).then(|| (text(value), text(self.most)))?;
            Some(format!(
                "`{}`: {word} {value} is more than {most}",
                picture.file
            ))
        };
        pictures.filter_map(line).collect()
    }

    fn is_of(&self, file: &str) -> bool {
        let stem = Path::new(file).file_stem();
        file == self.method || stem.is_some_and(|stem| *stem == *self.method)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::results as sample;
    use skiagraph_compare::records::sequence::{Sequence, SequenceFrame};
    use skiagraph_reference::Shimmer;

    #[test]
    fn a_condition_fails_for_what_is_above_it_or_could_not_run() {
        let failures = |method: &str, figure, most| {
            let method = method.into();
            Gate {
                method,
                figure,
                most,
            }
            .failures(&sample())
        };
        assert_eq!(
            failures("nsm", Figure::Wrong, 0.1),
            ["`nsm 1024` at 512x256: wrong 0.4970 % is more than 0.1000 %"]
        );
        assert_eq!(failures("nsm", Figure::Wrong, 0.5), [""; 0]);
        let counts = Figure::ALL.map(|figure| failures("nsm", figure, 0.0).len());
        assert_eq!(counts, [1; 16]);
        assert_eq!(
            failures("nsm", Figure::Missing, 0.1),
            ["`nsm 1024` at 512x256: missing 0.2550 % is more than 0.1000 %"]
        );
        assert_eq!(
            failures("rt_hw", Figure::Frame(None), 1e9),
            ["`rt_hw` at 512x256 has no frame: it could not run"]
        );
    }

    /// A mean hides a view beyond the limit, and the sum over a path its worst frame.
    #[test]
    fn the_worst_view_and_the_worst_frame_keep_to_a_condition() {
        let mut results = sample();
        let mut roofs = results.runs[0].clone();
        roofs.view = "roofs".into();
        let measured = roofs.measured.as_mut().unwrap();
        measured.wrong.total *= 4;
        let frame = |wrong_outside_band| {
            serde_json::from_value::<SequenceFrame>(serde_json::json!({
                "facing_light": 100, "wrong": 9, "wrong_outside_band": wrong_outside_band,
                "graded": {}, "rays": null, "gpu_ms": 1.0, "wall_ms": 1.0
            }))
        };
        let mut path = roofs.clone();
        path.view = "walk".into();
        path.measured.as_mut().unwrap().sequence = Some(Sequence {
            frames: vec![frame(0).unwrap(), frame(9).unwrap()],
            shimmer: Shimmer::default(),
        });
        let gate = |most| Gate {
            method: "nsm".into(),
            figure: Figure::Wrong,
            most,
        };
        results.runs.insert(1, roofs);
        let failures = gate(1.5).failures(&results);
        let on_roofs = "`nsm 1024` at 512x256: wrong 2.0060 % on `roofs` is more than 1.5000 %";
        assert_eq!(failures, [on_roofs]);
        results.runs.insert(2, path);
        let failures = gate(3.0).failures(&results);
        let on_path =
            "`nsm 1024` at 512x256: wrong 9.0000 % on frame 1 of `walk` is more than 3.0000 %";
        assert_eq!(failures, [on_path]);
    }
}
