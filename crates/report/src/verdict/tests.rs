//! Tests of verdicts, on runs of which only errors and times count.

use super::*;
use crate::summary;
use crate::test_support::results as sample;
use skiagraph_compare::records::figure::Clocks;
use skiagraph_compare::records::results::{Results, Run};
use skiagraph_compare::records::{statistics::FrameTimes, tuned::Tuned};

/// A run of 100,000 pixels that face the light: method, wrong pixels outside the band, ms of a
/// frame while the light moves, and while the camera moves; without these if they are equal.
fn run(method: &str, wrong: u64, frame: f64, kept: f64) -> Run {
    let mut run = sample().runs.remove(0);
    (run.preset, run.map_size) = (method.into(), None);
    let measured = run.measured.as_mut().unwrap();
    (measured.wrong.total, measured.wrong.in_band) = (wrong + 6, 6);
    let set = |times: &mut FrameTimes, ms: f64| {
        *times = FrameTimes::new(Some(vec![ms; 10]), None, vec![ms; 10]).unwrap();
    };
    set(&mut measured.frame, frame);
    if kept == frame {
        measured.regimes.clear();
    }
    for (times, ms) in measured.regimes.iter_mut().zip([kept, frame]) {
        set(&mut times.frame, ms);
    }
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

fn of_runs(runs: &[Run]) -> Results {
    Results {
        runs: runs.to_vec(),
        ..sample()
    }
}

fn rows(results: &Results) -> Vec<Row<'_>> {
    let clocks = Clocks::new(results);
    let cases = results.runs.iter().map(|run| clocks.case(run));
    summary::rows(cases, [512, 256])
}

/// The label of the marked row, and what is said.
fn outcome(runs: &[Run]) -> (Option<String>, Vec<String>) {
    within(runs, &Budgets::default())
}

fn within(runs: &[Run], budgets: &Budgets) -> (Option<String>, Vec<String>) {
    let results = of_runs(runs);
    let rows = rows(&results);
    let verdict = verdict(&rows, budgets);
    let marked = verdict.fastest_exact.values().next_back();
    let marked = marked.map(|index| rows[*index].label.clone());
    (marked, verdict.sentences)
}

#[test]
fn the_fastest_exact_one_stands_beside_the_fastest_and_the_next_exact() {
    let runs = [
        run("rt", 0, 100.0, 99.0),
        run("nsm", 4_700, 10.0, 8.0),
        run("light_buffer", 0, 21.0, 20.0),
        unavailable("rt_hw"),
    ];
    let (marked, sentences) = outcome(&runs);
    assert_eq!(marked.as_deref(), Some("light_buffer"));
    assert_eq!(
        sentences,
        [
            "Whatever moves: take `light_buffer` (21.0 ms a frame). It is exact here and 4.8 \
             times as fast as `rt`, the next such method. `nsm` is 2.1 times as fast and wrong \
             on 4.700 % of the surfaces that face the light."
        ]
    );
}

#[test]
fn who_keeps_a_map_may_win_while_only_the_camera_moves() {
    let runs = [
        run("rt", 0, 70.0, 69.0),
        run("crsma_full", 0, 380.0, 34.0),
        run("nsm", 9, 20.0, 10.0),
    ];
    let (marked, sentences) = outcome(&runs);
    assert_eq!(marked.as_deref(), Some("rt"));
    assert_eq!(
        sentences,
        [
            "While the light moves: take `rt` (70.0 ms a frame). It is exact here and 5.4 \
             times as fast as `crsma_full`, the next such method. `nsm` is 3.5 times as fast \
             and wrong on 0.009 % of the surfaces that face the light.",
            "While the camera moves: take `crsma_full` (34.0 ms a frame). It is exact here \
             and 2.0 times as fast as `rt`, the next such method. `nsm` is 3.4 times as fast \
             and wrong on 0.009 % of the surfaces that face the light.",
        ]
    );
}

#[test]
fn nothing_exact_all_exact_and_level_times() {
    let (marked, sentences) = outcome(&[run("nsm", 500, 10.0, 10.0), run("crsm", 20, 40.0, 40.0)]);
    assert_eq!(marked, None);
    assert_eq!(
        sentences,
        [
            "None is exact here. `crsm` is the least wrong (wrong on 0.020 % of the surfaces \
             that face the light, 40.0 ms a frame). `nsm` is 4.0 times as fast: wrong on 0.500 \
             % of the surfaces that face the light."
        ]
    );
    let (_, sentences) = outcome(&[run("a", 0, 10.0, 10.0), run("b", 0, 10.2, 10.2)]);
    assert_eq!(
        sentences,
        [
            "Take `a` or `b`: their times cannot be told apart (10.0 ms a \
             frame). All are exact here."
        ]
    );
    let mut later = run("b", 0, 30.0, 30.0);
    later.session = "2026-11-20T04:50:00Z".into();
    let (_, sentences) = outcome(&[run("a", 0, 10.0, 10.0), later]);
    let why = "Take `a` or `b`: they did not all take turns, so their times cannot be told apart";
    assert!(sentences[0].starts_with(why), "{sentences:?}");
    let (_, sentences) = outcome(&[run("rt", 0, 10.0, 4.0)]);
    assert_eq!(
        sentences,
        ["Whatever moves: take `rt` (10.0 ms a frame). It is exact here."]
    );
    assert_eq!(outcome(&[unavailable("rt_hw")]), (None, Vec::new()));
    assert_eq!(outcome(&[]), (None, Vec::new()));
    let mut dark = run("rt", 0, 10.0, 10.0);
    dark.pixels.facing_light = 0;
    assert_eq!(outcome(&[dark]), (None, Vec::new()), "nothing to judge");
}

#[test]
fn a_method_that_is_there_twice_has_no_winner() {
    let twice = |wrong| {
        [
            run("nsm", wrong, 10.0, 10.0),
            run("nsm@bias=0", wrong, 10.1, 10.1),
        ]
    };
    let (_, sentences) = outcome(&twice(500));
    assert_eq!(
        sentences,
        [
            "None is exact here. `nsm` and `nsm@bias=0` are the least wrong and cannot be told \
             apart in time (wrong on 0.500 % of the surfaces that face the light, 10.0 ms a \
             frame)."
        ]
    );
    assert!(outcome(&twice(0)).1[0].starts_with("Take `nsm` or `nsm@bias=0`: their times"));
    let soft = [graded("pcf", 0.1, 10.0), graded("pcf@bias=0", 0.1, 10.1)];
    assert!(outcome(&soft).1[0].starts_with("`pcf` and `pcf@bias=0` have the least error"));
}

/// The labels of the taken row and of the runner-up.
fn pair(runs: &[Run], budgets: &Budgets) -> [Option<String>; 2] {
    let results = of_runs(runs);
    let rows = rows(&results);
    let verdict = verdict(&rows, budgets);
    [verdict.first.first().copied(), verdict.runner_up]
        .map(|index| Some(rows[index?].label.clone()))
}

#[test]
fn the_runner_up_is_the_alternative_that_the_sentences_name() {
    let labels = |runs: &[Run]| {
        let [taken, runner_up] = pair(runs, &Budgets::default());
        [taken, runner_up].map(|label| label.unwrap_or_else(|| "none".into()))
    };
    let (rt, exact) = (run("rt", 0, 100.0, 100.0), run("buffer", 0, 21.0, 21.0));
    let (nsm, slow) = (run("nsm", 4_700, 10.0, 8.0), run("slow", 9, 300.0, 300.0));
    assert_eq!(
        labels(&[rt.clone(), exact.clone(), nsm.clone()]),
        ["buffer", "nsm"]
    );
    assert_eq!(
        labels(&[rt.clone(), exact.clone(), slow.clone()]),
        ["buffer", "rt"]
    );
    assert_eq!(
        labels(&[nsm.clone(), slow.clone()]),
        ["slow", "nsm"],
        "none is exact"
    );
    assert_eq!(
        labels(&[run("a", 9, 1.0, 1.0), run("b", 99, 9.0, 9.0)]),
        ["a", "b"]
    );
    assert_eq!(labels(&[exact]), ["buffer", "none"]);
    assert_eq!(labels(&[]), ["none", "none"]);
    assert_eq!(
        labels(&[graded("a", 0.1, 9.0), graded("b", 0.2, 1.0)]),
        ["a", "b"]
    );
    let budgets = Budgets {
        frame_ms: Some(1.0),
        ..Budgets::default()
    };
    assert_eq!(
        pair(&[rt, nsm], &budgets),
        [None, None],
        "no method keeps to it"
    );
}

#[test]
fn of_fewer_than_eight_frames_no_times_are_told_apart_or_called_level() {
    let few = |run: &mut Run, frames: usize| {
        let times = &mut run.measured.as_mut().unwrap().frame;
        times.wall_frames.truncate(frames);
        times.gpu_frames.as_mut().unwrap().truncate(frames);
    };
    let judged = |runs: &[Run], frames: usize| {
        let mut runs = runs.to_vec();
        few(&mut runs[0], frames);
        let (marked, sentences) = outcome(&runs);
        assert!(
            !sentences.iter().any(|line| line.contains("told apart,")),
            "{sentences:?}"
        );
        (marked, sentences)
    };
    let exact = [run("rt", 0, 100.0, 100.0), run("nsm", 9, 10.0, 10.0)];
    let (marked, sentences) = judged(&exact, 3);
    assert_eq!(marked.as_deref(), Some("rt"));
    let few = "frames are too few to tell times apart: give --frames 8 or more.";
    assert_eq!(
        sentences,
        [format!("3 {few}"), "`rt` is exact here.".into()]
    );
    assert!(judged(&exact, 8).1[0].starts_with("Take `rt`"));
    let wrong = [
        run("crsm", 20, 40.0, 40.0),
        run("crsma", 20, 40.0, 40.0),
        run("nsm", 500, 1.0, 1.0),
    ];
    assert_eq!(
        judged(&wrong, 7).1,
        [
            format!("7 {few}"),
            "`crsm` and `crsma` are the least wrong (wrong on 0.020 % of the surfaces that \
             face the light)."
                .into()
        ]
    );
    let soft = [graded("pcf", 0.1, 10.0), graded("vsm", 0.2, 10.0)];
    assert_eq!(
        judged(&soft, 1).1,
        [
            few.replace("frames are", "1 frame is"),
            "`pcf` is the least wrong (RMSE 0.1000).".into()
        ]
    );
    assert_eq!(
        judged(&exact[..1], 1).1[0],
        "Take `rt` (100 ms a frame). It is exact here."
    );
}

#[test]
fn a_row_of_another_hour_takes_no_part() {
    let mut old = run("quick", 0, 1.0, 1.0);
    old.session = "2026-11-20T03:00:00Z".into();
    let (marked, sentences) = outcome(&[run("rt", 0, 50.0, 50.0), old]);
    assert_eq!(marked.as_deref(), Some("rt"));
    assert_eq!(
        sentences,
        ["Take `rt` (50.0 ms a frame). It is exact here."]
    );
}

#[test]
fn budgets_leave_methods_out_and_say_what_comes_closest() {
    let runs = [
        run("rt", 0, 30.0, 30.0),
        run("pssm", 400, 8.0, 8.0),
        run("nsm", 4_700, 5.0, 5.0),
    ];
    let budget = |frame_ms, wrong_percent| Budgets {
        frame_ms,
        wrong_percent,
        memory_bytes: None,
    };
    let (_, sentences) = within(&runs, &budget(None, Some(1.0)));
    assert_eq!(
        sentences,
        [
            "Within less than 1 % wrong: 2 of 3 methods.",
            "Take `pssm` (wrong on 0.400 % of the surfaces that face the light, 8.00 ms a \
             frame).",
        ]
    );
    let (_, sentences) = within(&runs, &budget(Some(10.0), None));
    assert!(
        sentences[1].contains("`pssm` is the least wrong"),
        "{sentences:?}"
    );
    let (marked, sentences) = within(&runs, &budget(Some(40.0), None));
    assert_eq!(marked.as_deref(), Some("rt"), "{sentences:?}");
    let (marked, sentences) = within(&runs, &budget(Some(6.0), Some(1.0)));
    assert_eq!(marked, None);
    assert_eq!(
        sentences,
        [
            "No method keeps to at most 6 ms a frame and less than 1 % wrong; the fastest is \
             `nsm` (5.00 ms a frame); the least wrong is `rt` (exact here)."
        ]
    );
    let memory = Budgets {
        memory_bytes: Some(1 << 20),
        ..Budgets::default()
    };
    let (_, sentences) = within(&runs, &memory);
    assert!(sentences[0].starts_with("No method keeps to at most 1.0 MiB; the smallest is"));
}

#[test]
fn every_view_and_every_frame_keeps_to_a_budget() {
    let on = |view: &str, mut run: Run| {
        run.view = view.into();
        run
    };
    let runs = [
        on("main", run("rt", 0, 5.1, 5.1)),
        on("roofs", run("rt", 0, 53.7, 53.7)),
        on("main", run("pssm", 400, 8.0, 8.0)),
        on("roofs", run("pssm", 2_120, 9.0, 9.0)),
        on("main", run("nsm", 900, 20.0, 20.0)),
        on("roofs", run("nsm", 990, 20.0, 20.0)),
    ];
    let budget = |frame_ms, wrong_percent| Budgets {
        frame_ms,
        wrong_percent,
        memory_bytes: None,
    };
    let (marked, sentences) = within(&runs, &budget(Some(30.0), None));
    assert_eq!(marked, None);
    let on_roofs = "`rt` takes 53.7 ms on `roofs` (mean 29.4).";
    assert_eq!(
        sentences[0],
        "Within at most 30 ms a frame: 2 of 3 methods."
    );
    assert!(
        sentences[1].contains("`nsm` is the least wrong"),
        "{sentences:?}"
    );
    assert_eq!(sentences.last().unwrap(), on_roofs);
    let (_, sentences) = within(&runs, &budget(None, Some(1.5)));
    assert!(sentences[1].starts_with("Take `nsm`"), "{sentences:?}");
    let wrong = "`pssm` is wrong on 2.120 % on `roofs` (1.260 % in all).";
    assert_eq!(sentences.last().unwrap(), wrong);
    let (_, sentences) = within(&runs, &budget(Some(8.5), None));
    assert_eq!(
        sentences,
        [
            "No method keeps to at most 8.5 ms a frame; the fastest is `pssm` (9.00 ms a \
             frame on `roofs`).",
            "`pssm` takes 9.00 ms on `roofs` (mean 8.50).",
        ]
    );
}

#[test]
fn shadow_that_is_missing_is_told_before_a_small_share_of_all_surfaces() {
    let error = |lit: u64, shadow: u64| {
        let mut plant = run("nsm", 4_800, 9.0, 9.0);
        (plant.pixels.lit, plant.pixels.shadow) = (95_000, 5_000);
        let wrong = &mut plant.measured.as_mut().unwrap().wrong;
        (wrong.lit, wrong.shadow) = (lit, shadow);
        outcome(&[plant, run("rt", 0, 50.0, 50.0)]).1.remove(0)
    };
    let wrong = "wrong on 4.800 % of the surfaces that face the light";
    for (sentence, first) in [
        (error(4_780, 26), "without 95.600 % of the shadow, "),
        (
            error(100, 28_500),
            "falsely dark on 30.000 % of the light, ",
        ),
        (error(1_200, 3_606), ""),
    ] {
        let expected = format!("`nsm` is 5.6 times as fast and {first}{wrong}.");
        assert!(sentence.ends_with(&expected), "{sentence}");
    }
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
    let (marked, sentences) = outcome(&runs);
    assert_eq!(marked.as_deref(), Some("hybrid_pcf"));
    assert_eq!(
        sentences,
        [
            "Of the 42 % that can be judged: take `hybrid_pcf` (30.0 ms a frame). It is right \
             on all of these. `nsm` is 3.3 times as fast and wrong on 0.121 % of these.",
            "On the other 58 % the right answer hangs on rounding: no method is right or wrong \
             there. From the reference's choice differ `hybrid_pcf` 2.073 % (the least) and \
             `nsm` 28.800 % (the most).",
        ]
    );
    for runs in [
        &runs[..1],
        &[doubtful("a", 4, 9, 1.0), doubtful("b", 3, 9, 1.0)],
    ] {
        let (_, sentences) = outcome(runs);
        assert!(
            sentences.iter().all(|line| !line.contains("exact")),
            "{sentences:?}"
        );
        assert!(
            sentences[0].starts_with("Of the 42 %") && sentences.len() == 2,
            "{sentences:?}"
        );
    }
}

#[test]
fn a_share_that_is_off_is_not_exact_though_it_is_right_at_one_half() {
    let mut soft = run("pcf", 0, 5.0, 5.0);
    soft.measured.as_mut().unwrap().graded.rmse_outside_band = 0.02;
    let (marked, sentences) = outcome(&[soft, run("rt", 0, 50.0, 50.0)]);
    assert_eq!(marked.as_deref(), Some("rt"));
    assert!(
        sentences[0].contains("`pcf` is 10 times as fast and off in its shades"),
        "{sentences:?}"
    );
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
    let (marked, sentences) = outcome(&runs);
    assert_eq!(marked.as_deref(), Some("rt"));
    assert_eq!(
        sentences,
        ["Take `rt` (55.0 ms a frame). It is exact here."]
    );
    // Wrong in one view is wrong.
    let runs = [run("rt", 0, 1.0, 1.0), elsewhere(run("rt", 7, 1.0, 1.0))];
    assert!(outcome(&runs).1[0].starts_with("None is exact here"));
}

/// A run of what `base` was tuned to; of the defaults, if nothing is set.
fn tuned(base: &str, set: &[(&str, serde_json::Value)], wrong: u64, frame: f64) -> Run {
    let set = set
        .iter()
        .map(|(name, value)| ((*name).to_owned(), value.clone()));
    let tuned = Tuned {
        of: base.into(),
        set: set.collect(),
        chosen_on: vec!["side".into(), "back".into()],
        tried: 40,
        is_whole: true,
        ..Tuned::default()
    };
    let mut run = run(&tuned.argument(), wrong, frame, frame);
    run.tuned = Some(tuned);
    run
}

#[test]
fn tuning_is_told_and_a_setting_that_is_beaten_is_never_advised() {
    let set = [("cull", "none".into()), ("slope_bias", 2.0.into())];
    let mut rt = run("rt", 0, 100.0, 100.0);
    rt.promise = Some(skiagraph_compare::records::results::Promise {
        of: "exact".into(),
        closed_only: false,
    });
    let runs = [
        rt,
        run("nsm", 17_600, 10.0, 10.0),
        tuned("nsm", &set, 2, 12.0),
        tuned("pcf", &[], 900, 30.0),
    ];
    let labels: Vec<String> = rows(&of_runs(&runs))
        .into_iter()
        .map(|row| row.label)
        .collect();
    assert_eq!(labels, ["nsm", "nsm@cull=none,slope_bias=2", "pcf", "rt"]);
    insta::assert_snapshot!(outcome(&runs).1.join("\n"));
    // Where the defaults are better after all, they are what is advised.
    let worse = [run("nsm", 5, 10.0, 10.0), tuned("nsm", &set, 40, 12.0)];
    let sentences = outcome(&worse).1;
    assert!(
        sentences[0].contains("`nsm` is the least wrong"),
        "{sentences:?}"
    );
    assert!(!sentences[0].contains("slope_bias"), "{sentences:?}");
    // A budget that only the defaults keep to.
    let quick = Budgets {
        frame_ms: Some(11.0),
        ..Budgets::default()
    };
    let sentences = within(&runs, &quick).1;
    assert!(
        sentences[1].contains("`nsm` is the least wrong"),
        "{sentences:?}"
    );
}

#[test]
fn grades_have_a_least_error_and_a_fastest() {
    let runs = [graded("rt_area", 0.01, 90.0), graded("pcf", 0.2, 9.0)];
    let expected = "`rt_area` has the least error (RMSE 0.0100, 90.0 ms a frame). `pcf` is 10 \
        times as fast: RMSE 0.2000.";
    assert_eq!(outcome(&runs), (None, vec![expected.into()]));
}
