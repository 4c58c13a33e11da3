//! Conditions under which `compare` or `judge` fails, for continuous integration:
//! `nsm: wrong > 0.1%`.

use crate::summary_table::summaries;
use itertools::Itertools;
use skiagraph_compare::graphs::method::Method;
use skiagraph_compare::records::figure::Figure;
use skiagraph_compare::records::figures::limited;
use skiagraph_compare::records::judged_pictures::{
    JudgedPicture, JudgedPictures, MOST_WITHOUT_ANSWER,
};
use skiagraph_compare::records::results::Results;
use skiagraph_compare::wording::{percent, size, unknown};
use std::{path::Path, str::FromStr};

/// Upper limit for one figure of a method or picture, beyond which `--fail-if` makes `compare` or
/// `judge` fail.
#[derive(Clone, Debug)]
pub struct Gate {
    /// Name of the method with its setting, for example `crsm@n=1`. For `judge` it is the path of a
    /// picture, or the picture's file name without its extension.
    pub method: String,
    /// The figure that is limited.
    pub figure: &'static Figure,
    /// Greatest value that passes, in the unit of the figure: percent, milliseconds, bytes, or
    /// none.
    pub most: f64,
}

/// The figures that can be limited, those of pictures alone if `of_pictures`.
fn figures(of_pictures: bool) -> impl Iterator<Item = (&'static str, &'static Figure)> {
    let figures = limited().filter(move |figure| !of_pictures || figure.picture.is_some());
    figures.filter_map(|figure| Some((figure.gate.as_deref()?, figure)))
}

/// Returns the figures that `--fail-if` can limit as text for its help, with an example behind
/// those of one unit: `` `wrong`, `missing` > 5%; `frame` > 3ms ``. Those of pictures alone if
/// `of_pictures`.
pub fn help(of_pictures: bool) -> String {
    let units = figures(of_pictures).chunk_by(|(_, figure)| figure.unit.example());
    let unit = units.into_iter().map(|(example, figures)| {
        let mut words = figures.map(|(word, _)| format!("`{word}`"));
        format!("{} > {example}", words.join(", "))
    });
    unit.collect::<Vec<_>>().join("; ")
}

impl FromStr for Gate {
    type Err = String;

    /// Parses a condition of `--fail-if`, such as `nsm: wrong > 0.1%`, into its limit.
    fn from_str(text: &str) -> Result<Self, String> {
        let expected = "expected METHOD: FIGURE > VALUE, for example `nsm: wrong > 0.1%`";
        let parts = || {
            let (method, condition) = text.rsplit_once(": ")?;
            let (word, value) = condition.split_once('>')?;
            Some([method, word, value].map(str::trim))
        };
        let [method, word, value] = parts().ok_or(expected)?;
        let named = figures(false).find(|(name, _)| *name == word);
        let (_, figure) = named.ok_or_else(|| {
            let words = figures(false).map(|(name, _)| name).join(", ");
            format!("unknown figure `{word}`; expected one of {words}")
        })?;
        let most = figure.unit.parse(value);
        Ok(Self {
            method: method.into(),
            figure,
            most: most.map_err(|why| format!("{word}: {why}"))?,
        })
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
        let (word, limit) = (self.word(), |value| self.figure.unit.limit(value));
        let mut lines = Vec::new();
        for summary in summaries(results) {
            for row in summary.rows.iter().filter(|row| row.method == self.method) {
                let place = format!("`{}` at {}", row.label, size(summary.viewport));
                lines.extend(match row.worst(self.figure) {
                    None if row.views() == 0 => {
                        Some(format!("{place} has no {word}: it could not run"))
                    }
                    None => Some(format!("{place} has no {word}: it was not timed so")),
                    Some(worst) => (worst.value > self.most).then(|| {
                        let (value, most) = (limit(worst.value), limit(self.most));
                        format!("{place}: {word} {value}{} is more than {most}", worst.on())
                    }),
                });
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
        let (name, word) = (&self.method, self.word());
        if self.figure.picture.is_none() {
            let words = figures(true).map(|(name, _)| name).join(", ");
            return Err(format!(
                "--fail-if: a picture has no {word}; expected {words}"
            ));
        }
        if files.iter().any(|file| self.is_of(file)) {
            return Ok(());
        }
        let stem = |file| Path::new(file).file_stem()?.to_str();
        let stems: Vec<&str> = files.iter().filter_map(stem).collect();
        let what = format!("--fail-if: `{name}` is not judged");
        Err(unknown(&what, name, "pictures", &stems))
    }

    /// Returns a line of text for each judged picture that is beyond this limit, or without an
    /// answer at more than [`MOST_WITHOUT_ANSWER`] of the pixels that are judged; empty if all are
    /// within it. [`check_pictures`](Self::check_pictures) must have accepted the limit. Wrong
    /// pixels and RMSE leave out pixels in the [band](skiagraph_compare#terms),
    /// [unattributable](JudgedPictures::unattributable) ones and those without an answer.
    pub fn picture_failures(&self, judged: &JudgedPictures) -> Vec<String> {
        let apart = judged.band + judged.unattributable;
        let wanted = judged.pixels.facing_light.saturating_sub(apart);
        let line = |picture: &JudgedPicture| {
            if !self.is_of(&picture.file) {
                return None;
            }
            let (word, text) = (self.word(), |value| self.figure.unit.limit(value));
            if picture.without_answer as f64 > MOST_WITHOUT_ANSWER * wanted as f64 {
                let share = percent(picture.without_answer, wanted);
                return Some(format!(
                    "`{}` has no {word}: no finite number at {share} of the pixels that are judged",
                    picture.file
                ));
            }
            let value = self.figure.picture?(picture, &judged.pixels);
            let (file, most) = (&picture.file, text(self.most));
            let line = || format!("`{file}`: {word} {} is more than {most}", text(value));
            (value > self.most).then(line)
        };
        judged.pictures.iter().filter_map(line).collect()
    }

    fn word(&self) -> &str {
        self.figure.gate.as_deref().unwrap_or(&self.figure.name)
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
        let failures = |condition: &str| condition.parse::<Gate>().unwrap().failures(&sample());
        assert_eq!(
            failures("nsm: wrong > 0.1%"),
            ["`nsm 1024` at 512x256: wrong 0.4970 % is more than 0.1000 %"]
        );
        assert_eq!(failures("nsm: wrong > 0.5%"), [""; 0]);
        let counts = limited().map(|figure| {
            let gate = Gate {
                method: "nsm".into(),
                figure,
                most: 0.0,
            };
            gate.failures(&sample()).len()
        });
        assert!(counts.into_iter().all(|count| count == 1));
        assert_eq!(
            failures("nsm: missing > 0.1%"),
            ["`nsm 1024` at 512x256: missing 0.2550 % is more than 0.1000 %"]
        );
        assert_eq!(
            failures("rt_hw: frame > 9ms"),
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
        let gate = |most| format!("nsm: wrong > {most}%").parse::<Gate>().unwrap();
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

    #[test]
    fn a_condition_has_a_method_a_figure_and_a_value_with_its_unit() {
        let most = |text: &str| text.parse().map(|gate: Gate| (gate.method, gate.most));
        assert_eq!(most("nsm: wrong > 0.1%"), Ok(("nsm".into(), 0.1)));
        assert_eq!(most("crsm@n=1: frame>3ms"), Ok(("crsm@n=1".into(), 3.0)));
        for (text, message) in [
            ("nsm wrong > 1%", "METHOD: FIGURE > VALUE"),
            ("nsm: wrong < 1%", "METHOD: FIGURE > VALUE"),
            (
                "nsm: wrnog > 1%",
                "wrong, missing, false, rmse, flip, frame",
            ),
            ("nsm: wrong > 1", "wrong: no sign for percent"),
            ("nsm: frame > 1", "frame: no unit"),
        ] {
            let error = text.parse::<Gate>().unwrap_err();
            assert!(error.contains(message), "{text}: {error}");
        }
    }
}
