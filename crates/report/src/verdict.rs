//! Which method to take, in a sentence or two.

use crate::summary::{Row, Wrong, by_wall};
use skiagraph_compare::wording::{ms, percent};

/// Times that differ by less than this share are level: no adapter's are surer.
const LEVEL: f64 = 0.03;

/// Verdict of a table of hard answers: which rows are the best, and that in words.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Verdict {
    /// Index of the fastest row with 0 wrong pixels outside the band, while light or meshes move.
    pub fastest_exact: Option<usize>,
    /// One sentence each.
    pub sentences: Vec<String>,
}

/// Judges rows that were measured on the same views, the fastest first; those on fewer views and
/// those that could not run take no part.
pub fn verdict(rows: &[Row]) -> Verdict {
    let most = rows.iter().map(Row::views).max().unwrap_or_default();
    let by_wall = by_wall(rows);
    let full: Vec<Contender> = rows
        .iter()
        .enumerate()
        .filter(|(_, row)| row.views() == most && most > 0)
        .filter_map(|(index, row)| Contender::new(index, row, by_wall))
        .collect();
    if full.is_empty() {
        Verdict::default()
    } else if full.iter().all(|of| of.rmse.is_some()) {
        graded(&full, rows)
    } else {
        hard(&full)
    }
}

/// A row, with what decides.
#[derive(Clone, Debug)]
struct Contender<'a> {
    index: usize,
    label: &'a str,
    method: &'a str,
    wrong: Wrong,
    rmse: Option<f64>,
    frame: f64,
    kept: f64,
}

impl<'a> Contender<'a> {
    fn new(index: usize, row: &'a Row, by_wall: bool) -> Option<Self> {
        let frame = row.frame_ms(by_wall)?;
        if row.rmse().is_none() && row.wrong().facing_light == 0 {
            return None; // Nothing was judged.
        }
        Some(Self {
            index,
            label: &row.label,
            method: &row.method,
            wrong: row.wrong(),
            rmse: row.rmse(),
            frame,
            kept: row.kept_ms(by_wall).unwrap_or(frame),
        })
    }

    fn is_exact(&self) -> bool {
        self.wrong.outside_band == 0
    }

    fn error(&self) -> String {
        match self.rmse {
            Some(rmse) => format!("RMSE {rmse:.4}"),
            None if self.is_exact() => "exact".into(),
            None => format!(
                "{} wrong",
                percent(self.wrong.outside_band, self.wrong.facing_light)
            ),
        }
    }

    fn figures(&self) -> String {
        let ms = ms(self.frame);
        format!("`{}` ({}, {ms} ms)", self.label, self.error())
    }
}

type Time = fn(&Contender) -> f64;
const TIMES: [(&str, Time); 2] = [
    ("while light or meshes move", |of| of.frame),
    ("while only the camera moves", |of| of.kept),
];

fn least<'c, 'a>(
    of: impl IntoIterator<Item = &'c Contender<'a>>,
    figure: impl Fn(&Contender) -> f64,
) -> Option<&'c Contender<'a>> {
    let of = of.into_iter();
    of.min_by(|one, other| figure(one).total_cmp(&figure(other)))
}

fn hard(all: &[Contender]) -> Verdict {
    let exact: Vec<Contender> = all.iter().filter(|of| of.is_exact()).cloned().collect();
    let Some(best) = least(&exact, TIMES[0].1) else {
        return Verdict {
            fastest_exact: None,
            sentences: none_exact(all),
        };
    };
    let mut sentences = Vec::new();
    let kept = least(&exact, TIMES[1].1).unwrap_or(best);
    if kept.index == best.index {
        sentences.push(sentence(best, None, &exact, all));
    } else {
        for (of, (when, time)) in [best, kept].into_iter().zip(TIMES) {
            sentences.push(sentence(of, Some((when, time)), &exact, all));
        }
    }
    Verdict {
        fastest_exact: Some(best.index),
        sentences,
    }
}

/// One method as the fastest exact one, with what is level with it, and beside the fastest of all
/// and the slowest exact one.
fn sentence(
    best: &Contender,
    when: Option<(&str, Time)>,
    exact: &[Contender],
    all: &[Contender],
) -> String {
    let time = when.map_or(TIMES[0].1, |(_, time)| time);
    let level = |of: &&Contender| of.index != best.index && time(of) <= time(best) * (1.0 + LEVEL);
    let names: Vec<String> = [best]
        .into_iter()
        .chain(exact.iter().filter(level))
        .map(|of| format!("`{}`", of.label))
        .collect();
    let mut text = match when {
        Some((when, _)) => format!("{}{}: ", when[..1].to_uppercase(), &when[1..]),
        None if all.iter().any(|of| of.kept < of.frame) => "Whatever moves: ".into(),
        None => String::new(),
    };
    text += &format!(
        "{}: exact here, {} ms",
        names.join(", level with "),
        ms(time(best))
    );
    if when.is_none() && best.kept < best.frame * (1.0 - LEVEL) {
        text += &format!(" ({} while only the camera moves)", ms(best.kept));
    }
    let all_exact = exact.len() == all.len();
    let quickest = least(all, time).filter(|_| !all_exact);
    if let Some(of) = quickest.filter(|of| time(of) > 0.0 && of.index != best.index) {
        let times = ratio(time(best) / time(of));
        text += &format!(", {times} x `{}` ({})", of.label, of.error());
    }
    let other_method = |of: &&Contender| of.method != best.method && !level(of);
    let next = exact.iter().filter(other_method);
    if let Some(of) = least(next, time) {
        let times = ratio(time(best) / time(of));
        text += &format!(", {times} x `{}`, the next exact method", of.label);
    }
    if all_exact && all.len() > 1 {
        text += "; all are exact here";
    }
    text + "."
}

fn none_exact(all: &[Contender]) -> Vec<String> {
    let right = all.iter().min_by(|one, other| {
        let shares = one.wrong.share().total_cmp(&other.wrong.share());
        shares.then(one.frame.total_cmp(&other.frame))
    });
    let (Some(right), Some(fastest)) = (right, least(all, TIMES[0].1)) else {
        return Vec::new();
    };
    let (wrong, quick) = (right.figures(), fastest.figures());
    vec![if right.index == fastest.index {
        format!("None is exact here; the least wrong and the fastest is {wrong}.")
    } else {
        format!("None is exact here; the least wrong is {wrong}, the fastest {quick}.")
    }]
}

/// Judges errors of shares: the least one, and the fastest.
fn graded(all: &[Contender], rows: &[Row]) -> Verdict {
    let rmse = |of: &Contender| of.rmse.unwrap_or(f64::INFINITY);
    let (Some(right), Some(fastest)) = (least(all, rmse), least(all, TIMES[0].1)) else {
        return Verdict::default();
    };
    let (error, quick) = (right.figures(), fastest.figures());
    let mut text = if right.index == fastest.index {
        format!("The least error and the fastest: {error}")
    } else {
        format!("The least error: {error}; the fastest: {quick}")
    };
    let own = rows
        .iter()
        .filter_map(Row::reference_error)
        .reduce(f64::max);
    if let Some(own) = own.filter(|own| rmse(right) < 10.0 * own) {
        text += &format!(
            "; the reference's own error is {own:.4}, more samples would tell more \
             (--reference-samples)"
        );
    }
    Verdict {
        fastest_exact: None,
        sentences: vec![text + "."],
    }
}

/// A ratio of times as it is read: two digits that count.
fn ratio(ratio: f64) -> String {
    match ratio {
        _ if ratio >= 9.95 => format!("{ratio:.0}"),
        _ if ratio >= 0.995 => format!("{ratio:.1}"),
        _ => format!("{ratio:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::results as sample;
    use crate::summary::rows;
    use skiagraph_compare::records::results::Run;

    /// A run of 100,000 pixels that face the light: method, wrong pixels outside the band, ms of a
    /// frame, and of one with the map kept.
    fn run(method: &str, wrong: u64, frame: f64, kept: f64) -> Run {
        let mut run = sample().runs.remove(0);
        (run.preset, run.map_size) = (method.into(), None);
        let measured = run.measured.as_mut().unwrap();
        (measured.wrong.total, measured.wrong.in_band) = (wrong + 6, 6);
        let set = |times: &mut skiagraph_compare::records::statistics::FrameTimes, ms| {
            times.gpu_ms.as_mut().unwrap().median = ms;
        };
        set(&mut measured.frame, frame);
        set(&mut measured.cached.as_mut().unwrap().frame, kept);
        run
    }

    fn graded(method: &str, rmse: f64, frame: f64) -> Run {
        let mut run = run(method, 0, frame, frame);
        let measured = run.measured.as_mut().unwrap();
        measured.graded = Some(skiagraph_reference::Graded {
            rmse,
            ..Default::default()
        });
        run
    }

    fn unavailable(method: &str) -> Run {
        let mut run = run(method, 0, 1.0, 1.0);
        (run.measured, run.unavailable) = (None, Some("no ray queries here".into()));
        run
    }

    /// The label of the marked row, and what is said.
    fn outcome(runs: &[Run]) -> (Option<String>, Vec<String>) {
        let rows = rows(runs, [512, 256]);
        let verdict = verdict(&rows);
        let marked = verdict.fastest_exact.map(|index| rows[index].label.clone());
        (marked, verdict.sentences)
    }

    #[test]
    fn the_fastest_exact_one_stands_beside_the_fastest_and_the_next_exact() {
        let runs = [
            run("rt", 0, 100.0, 100.0),
            run("nsm", 4_700, 10.0, 8.0),
            run("light_buffer", 0, 21.0, 21.0),
            unavailable("rt_hw"),
        ];
        let (marked, said) = outcome(&runs);
        assert_eq!(marked.as_deref(), Some("light_buffer"));
        assert_eq!(
            said,
            [
                "Whatever moves: `light_buffer`: exact here, 21.0 ms, 2.1 x `nsm` (4.700 % wrong), \
                 0.21 x `rt`, the next exact method."
            ]
        );
    }

    #[test]
    fn who_keeps_a_map_may_win_while_only_the_camera_moves() {
        let runs = [
            run("rt", 0, 70.0, 70.0),
            run("crsma_full", 0, 380.0, 34.0),
            run("nsm", 9, 20.0, 10.0),
        ];
        let (marked, said) = outcome(&runs);
        assert_eq!(marked.as_deref(), Some("rt"));
        assert_eq!(
            said,
            [
                "While light or meshes move: `rt`: exact here, 70.0 ms, 3.5 x `nsm` (0.009 % \
                 wrong), 0.18 x `crsma_full`, the next exact method.",
                "While only the camera moves: `crsma_full`: exact here, 34.0 ms, 3.4 x `nsm` \
                 (0.009 % wrong), 0.49 x `rt`, the next exact method.",
            ]
        );
    }

    #[test]
    fn nothing_exact_all_exact_and_level_times() {
        let (marked, said) = outcome(&[run("nsm", 500, 10.0, 10.0), run("crsm", 20, 40.0, 40.0)]);
        assert_eq!(marked, None);
        assert_eq!(
            said,
            [
                "None is exact here; the least wrong is `crsm` (0.020 % wrong, 40.0 ms), the \
                 fastest `nsm` (0.500 % wrong, 10.0 ms)."
            ]
        );
        let (_, said) = outcome(&[run("a", 0, 10.0, 10.0), run("b", 0, 10.2, 10.2)]);
        assert_eq!(
            said,
            ["`a`, level with `b`: exact here, 10.0 ms; all are exact here."]
        );
        let (_, said) = outcome(&[run("rt", 0, 10.0, 4.0)]);
        assert_eq!(
            said,
            ["Whatever moves: `rt`: exact here, 10.0 ms (4.00 while only the camera moves)."]
        );
        assert_eq!(outcome(&[unavailable("rt_hw")]), (None, Vec::new()));
        assert_eq!(outcome(&[]), (None, Vec::new()));
        let mut dark = run("rt", 0, 10.0, 10.0);
        dark.pixels.facing_light = 0;
        assert_eq!(outcome(&[dark]), (None, Vec::new()), "nothing to judge");
    }

    #[test]
    fn a_row_on_fewer_views_takes_no_part() {
        let elsewhere = |mut run: Run| {
            run.view = "other".into();
            run
        };
        let runs = [
            run("rt", 0, 50.0, 50.0),
            elsewhere(run("rt", 0, 60.0, 60.0)),
            run("quick", 0, 1.0, 1.0),
        ];
        let (marked, said) = outcome(&runs);
        assert_eq!(marked.as_deref(), Some("rt"));
        assert_eq!(said, ["`rt`: exact here, 55.0 ms."]);
        // Wrong in one view is wrong.
        let runs = [run("rt", 0, 1.0, 1.0), elsewhere(run("rt", 7, 1.0, 1.0))];
        assert!(outcome(&runs).1[0].starts_with("None is exact here"));
    }

    #[test]
    fn grades_have_a_least_error_and_a_fastest() {
        let runs = [graded("rt_area", 0.01, 90.0), graded("pcf", 0.2, 9.0)];
        let expected = "The least error: `rt_area` (RMSE 0.0100, 90.0 ms); the fastest: `pcf` \
            (RMSE 0.2000, 9.00 ms).";
        assert_eq!(outcome(&runs), (None, vec![expected.into()]));
    }
}
