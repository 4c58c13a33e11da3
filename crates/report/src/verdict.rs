//! Which method to take, in a sentence or two.

use crate::summary::{Row, Wrong, by_wall};
use skiagraph_compare::wording::{ms, percent};

/// Times that differ by less than this share are level: no adapter's are surer.
const LEVEL: f64 = 0.03;

/// The share of pixels in the band beyond which a verdict holds of the others alone: the right
/// answer of more than one pixel in a hundred hangs on rounding.
const MAX_BAND: f64 = 0.01;

/// Verdict of a table: which rows are the best, and that in words.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Verdict {
    /// Index of the fastest row that is right wherever that can be judged, while light or meshes
    /// move.
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
    let mut verdict = if full.is_empty() {
        Verdict::default()
    } else if full.iter().any(|of| of.is_soft) {
        graded(&full, rows)
    } else {
        hard(&full)
    };
    if let Some(condition) = full.iter().find_map(|of| of.condition) {
        verdict.sentences = conditioned(condition, verdict.sentences, &full);
    }
    verdict
}

/// The pixels that a verdict is of, where it is not of nearly all that face the light.
#[derive(Clone, Copy, Debug)]
struct Condition {
    /// Pixels in the band, and all that face the light.
    band: u64,
    facing_light: u64,
}

impl Condition {
    fn new(wrong: Wrong) -> Option<Self> {
        let Wrong {
            band, facing_light, ..
        } = wrong;
        let share = band as f64 / facing_light.max(1) as f64;
        (share > MAX_BAND).then_some(Self { band, facing_light })
    }
}

/// The sentences with the pixels that they hold of, and how much methods differ on the others.
fn conditioned(of: Condition, sentences: Vec<String>, all: &[Contender]) -> Vec<String> {
    let Condition { band, facing_light } = of;
    let whole = |count: u64| format!("{:.0} %", 100.0 * count as f64 / facing_light as f64);
    let judged = whole(facing_light.saturating_sub(band));
    let mut said: Vec<String> = sentences
        .into_iter()
        .map(|sentence| format!("Of the {judged} that can be judged: {sentence}"))
        .collect();
    let mut others: Vec<&Contender> = all.iter().collect();
    others.sort_by_key(|of| of.wrong.in_band);
    let share = |of: &&Contender| format!("`{}` {}", of.label, percent(of.wrong.in_band, band));
    let (least, most) = (others.first(), others.last().filter(|_| others.len() > 1));
    let shares: Vec<String> = least.into_iter().chain(most).map(share).collect();
    said.push(format!(
        "On the other {} the right answer hangs on rounding: no method is right or wrong there. \
         From the reference's choice differ {}.",
        whole(band),
        shares.join(" (the least) and ") + if shares.len() > 1 { " (the most)" } else { "" }
    ));
    said
}

/// A row, with what decides.
#[derive(Clone, Debug)]
struct Contender<'a> {
    index: usize,
    label: &'a str,
    method: &'a str,
    wrong: Wrong,
    is_exact: bool,
    rmse: f64,
    /// True if the light has an extent.
    is_soft: bool,
    /// Where much of what it shows cannot be judged.
    condition: Option<Condition>,
    frame: f64,
    kept: f64,
}

impl<'a> Contender<'a> {
    fn new(index: usize, row: &'a Row, by_wall: bool) -> Option<Self> {
        let frame = row.frame_ms(by_wall)?;
        let wrong = row.wrong();
        if wrong.facing_light == 0 {
            return None; // Nothing was judged.
        }
        Some(Self {
            index,
            label: &row.label,
            method: &row.method,
            wrong,
            is_exact: row.is_exact(),
            rmse: row.rmse()?,
            is_soft: row.is_soft(),
            condition: Condition::new(wrong),
            frame,
            kept: row.kept_ms(by_wall).unwrap_or(frame),
        })
    }

    fn error(&self) -> String {
        if self.is_soft {
            format!("RMSE {:.4}", self.rmse)
        } else if self.is_exact {
            self.right().into()
        } else {
            let Wrong {
                outside_band,
                band,
                facing_light,
                ..
            } = self.wrong;
            // Where much lies in the band, the others are judged.
            let judged = match self.condition {
                Some(_) => facing_light.saturating_sub(band),
                None => facing_light,
            };
            format!("{} wrong", percent(outside_band, judged))
        }
    }

    /// That no pixel is wrong, as far as that can be judged.
    fn right(&self) -> &'static str {
        match self.condition {
            Some(_) => "none wrong",
            None => "exact",
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
    let exact: Vec<Contender> = all.iter().filter(|of| of.is_exact).cloned().collect();
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
        "{}: {}, {} ms",
        names.join(", level with "),
        if best.condition.is_some() {
            best.right()
        } else {
            "exact here"
        },
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
        let next = match best.condition {
            Some(_) => "the next one with none wrong",
            None => "the next exact method",
        };
        text += &format!(", {times} x `{}`, {next}", of.label);
    }
    if all_exact && all.len() > 1 {
        text += match best.condition {
            Some(_) => "; none of the methods is wrong there",
            None => "; all are exact here",
        };
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
    let none = match right.condition {
        Some(_) => "Each method is wrong on some",
        None => "None is exact here",
    };
    vec![if right.index == fastest.index {
        format!("{none}; the least wrong and the fastest is {wrong}.")
    } else {
        format!("{none}; the least wrong is {wrong}, the fastest {quick}.")
    }]
}

/// Judges errors of shares: the least one, and the fastest.
fn graded(all: &[Contender], rows: &[Row]) -> Verdict {
    let rmse = |of: &Contender| of.rmse;
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
        run.area = Some(skiagraph_compare::records::results::AreaReference {
            samples: 512,
            standard_error_rms: 0.0005,
            standard_error_worst: 0.05,
            penumbra: 900,
        });
        run.measured.as_mut().unwrap().graded.rmse = rmse;
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
    fn pixels_that_cannot_be_judged_never_vanish() {
        let doubtful = |method, wrong, in_band, ms| {
            let mut run = run(method, wrong, ms, ms);
            run.band = 57_900;
            let measured = run.measured.as_mut().unwrap();
            (measured.wrong.total, measured.wrong.in_band) = (wrong + in_band, in_band);
            run
        };
        let runs = [
            doubtful("hybrid_pcf", 0, 1_200, 30.0),
            doubtful("nsm", 51, 16_675, 9.0),
        ];
        let (marked, said) = outcome(&runs);
        assert_eq!(marked.as_deref(), Some("hybrid_pcf"));
        assert_eq!(
            said,
            [
                "Of the 42 % that can be judged: `hybrid_pcf`: none wrong, 30.0 ms, 3.3 x `nsm` \
                 (0.121 % wrong).",
                "On the other 58 % the right answer hangs on rounding: no method is right or wrong \
                 there. From the reference's choice differ `hybrid_pcf` 2.073 % (the least) and \
                 `nsm` 28.800 % (the most).",
            ]
        );
        for runs in [
            &runs[..1],
            &[doubtful("a", 4, 9, 1.0), doubtful("b", 3, 9, 1.0)],
        ] {
            let (_, said) = outcome(runs);
            assert!(said.iter().all(|line| !line.contains("exact")), "{said:?}");
            assert!(
                said[0].starts_with("Of the 42 %") && said.len() == 2,
                "{said:?}"
            );
        }
    }

    #[test]
    fn a_share_that_is_off_is_not_exact_though_it_is_right_at_one_half() {
        let mut soft = run("pcf", 0, 5.0, 5.0);
        soft.measured.as_mut().unwrap().graded.rmse_outside_band = 0.02;
        let (marked, said) = outcome(&[soft, run("rt", 0, 50.0, 50.0)]);
        assert_eq!(marked.as_deref(), Some("rt"));
        assert!(said[0].contains("10 x `pcf` (0 % wrong)"), "{said:?}");
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
