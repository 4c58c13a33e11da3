//! Tests of comparisons with a baseline.

use super::*;
use crate::records::regimes::RegimeTimes;
use crate::records::results::{Answer, tests::sample};
use crate::records::statistics::FrameTimes;

/// `sample()` with ten frames of around so many milliseconds.
fn timed(ms: f64) -> Results {
    let mut results = sample();
    for measured in results
        .runs
        .iter_mut()
        .filter_map(|run| run.measured.as_mut())
    {
        let frame = |turn: u32| ms + f64::from(turn % 3) * 0.01;
        let frames: Vec<f64> = (0..10).map(frame).collect();
        measured.frame = FrameTimes::new(Some(frames.clone()), None, frames).unwrap();
    }
    results
}

fn baseline(results: Results) -> Baseline {
    Baseline {
        name: "old.json".into(),
        all: results.each(),
    }
}

fn changes(then: Results, now: &Results) -> Changes {
    baseline(then).against(now).unwrap()
}

/// Errors and times of the first cell.
fn first(then: Results, change: impl Fn(&mut Results)) -> (Change, Change) {
    let mut now = timed(10.0);
    change(&mut now);
    let changes = changes(then, &now);
    let times = changes.cells[0].times.first();
    (
        changes.cells[0].errors,
        times.map_or(Change::Same, TimeChange::change),
    )
}

fn measured(results: &mut Results) -> &mut Measured {
    results.runs[0].measured.as_mut().unwrap()
}

#[test]
fn any_growth_of_errors_is_worse_on_one_adapter() {
    use Change::{Better, Same, Worse};
    let errors = |change: fn(&mut Measured)| first(timed(10.0), |now| change(measured(now))).0;
    assert_eq!(errors(|_| ()), Same);
    assert_eq!(errors(|measured| measured.wrong.total += 1), Worse);
    assert_eq!(errors(|measured| measured.wrong.total -= 1), Better);
    assert_eq!(
        errors(|measured| (measured.wrong.total, measured.wrong.in_band) = (504, 7)),
        Same,
        "in the band"
    );
    assert_eq!(
        errors(|measured| measured.graded.rmse_outside_band += 1e-6),
        Worse
    );
    // Fewer wrong pixels, but worse shades: no trade.
    let both = |measured: &mut Measured| {
        (measured.answer, measured.wrong.total) = (Answer::Graded, 400);
        measured.graded.rmse_outside_band += 0.1;
    };
    assert_eq!(errors(both), Worse);
}

#[test]
fn another_adapter_has_a_tolerance_and_no_times() {
    let far = |results: &mut Results| results.adapter.driver = "driver 2".into();
    let wrong = |by: u64| {
        let change = |now: &mut Results| {
            far(now);
            measured(now).wrong.total += by;
        };
        first(timed(5.0), change)
    };
    // 0.05 % of 100,000 pixels.
    assert_eq!(wrong(50), (Change::Same, Change::Same));
    assert_eq!(wrong(51), (Change::Worse, Change::Same));
    let mut now = timed(10.0);
    far(&mut now);
    let notes = changes(timed(5.0), &now).notes;
    assert_eq!(
        notes,
        [
            "measured on another adapter then (Some GPU · vulkan · driver 1.2): errors within \
             0.05 % of the pixels that face the light, or the band, and RMSE within 0.001 are \
             the same (2 cells)",
            "times are not compared: another adapter or driver (2 cells)"
        ]
    );
}

#[test]
fn times_are_told_apart_or_it_is_said_why_not() {
    let times = |then: f64| first(timed(then), |_| ()).1;
    assert_eq!(times(8.0), Change::Worse);
    assert_eq!(times(12.0), Change::Better);
    assert_eq!([9.8, 10.0, 10.2].map(times), [Change::Same; 3], "level");
    type Spoil = fn(&mut Results);
    let spoils: [(Spoil, &str); 3] = [
        (
            |now| now.runs[0].machine.as_mut().unwrap().host = Some("far".into()),
            "another machine (bench, Some CPU, 8 cores then, far, Some CPU, 8 cores now)",
        ),
        (
            |now| now.runs[0].machine.as_mut().unwrap().load = Some(6.0),
            "the machine was busy now (load 6.0 on 8 cores)",
        ),
        (
            |now| measured(now).frame.gpu_frames = Some(vec![1.0; 3]),
            "10 frames then and 3 now, and both must be 8 or more",
        ),
    ];
    for (spoil, why) in spoils {
        let mut now = timed(20.0);
        spoil(&mut now);
        let changes = changes(timed(10.0), &now);
        assert_eq!(changes.cells[0].times, []);
        assert_eq!(
            changes.notes,
            [format!("times are not compared: {why} (1 cell)")]
        );
        assert_eq!(changes.with(Change::Worse).len(), 1, "the other cell");
    }
}

#[test]
fn times_are_compared_by_what_moves() {
    let with = |light: f64, nothing: f64| {
        let mut results = timed(10.0);
        let regime = |regime, ms| RegimeTimes {
            regime,
            frame: measured(&mut timed(ms)).frame.clone(),
            uploaded_bytes: 0,
            skipped: Vec::new(),
        };
        measured(&mut results).regimes = vec![
            regime(Regime::Nothing, nothing),
            regime(Regime::Light, light),
        ];
        results
    };
    let changes = |now: &Results| changes(with(4.0, 0.01), now).cells[0].clone();
    let slower = changes(&with(8.0, 0.03));
    assert_eq!(slower.verdict(), Change::Worse);
    let times = |cell: &CellChange| -> Vec<(Option<Regime>, Change)> {
        let times = cell.times.iter();
        times.map(|times| (times.regime, times.change())).collect()
    };
    let light = Some(Regime::Light);
    let expected = [(None, Change::Same), (light, Change::Worse)];
    assert_eq!(times(&slower), expected, "next to nothing at rest");
    let moved = changes(&with(4.0, 2.0));
    assert_eq!(times(&moved)[1], (Some(Regime::Nothing), Change::Worse));
    assert_eq!(times(&changes(&timed(10.0))).len(), 1, "no regimes now");
}

#[test]
fn a_method_that_cannot_run_any_more_is_worse_and_new_ones_are_named() {
    let mut now = timed(10.0);
    (now.runs[0].measured, now.runs[0].unavailable) = (None, Some("no ray queries".into()));
    now.runs[1].cell = "1".into();
    let changes = changes(timed(10.0), &now);
    assert_eq!(
        (changes.cells.len(), changes.cells[0].verdict()),
        (1, Change::Worse)
    );
    assert_eq!(changes.only_now, ["rt on main 512x256"]);
    assert_eq!(changes.only_then, 1);
}

#[test]
fn of_a_joined_baseline_the_run_of_this_machine_counts() {
    let mut joined = timed(5.0);
    joined.adapter.name = "Far GPU".into();
    joined.others = vec![timed(10.0)];
    assert_eq!(first(joined, |_| ()), (Change::Same, Change::Same));
}

#[test]
fn a_baseline_of_something_else_says_what_differs() {
    let refused = |change: fn(&mut Results)| {
        let mut now = sample();
        for (index, run) in now.runs.iter_mut().enumerate() {
            run.cell = format!("{index}");
        }
        change(&mut now);
        baseline(sample())
            .check(&now, &now.runs)
            .unwrap_err()
            .to_string()
    };
    type Change = fn(&mut Results);
    let changes: [(Change, &str); 6] = [
        (
            |now| now.scene.name = "sponza".into(),
            "scene: there park, 55,000 triangles, here sponza, 55,000 triangles",
        ),
        (|now| now.frames = 3, "frames: there 10, here 3"),
        (
            |now| now.oracle = "offset:1".into(),
            "oracle: there exact, here offset:1",
        ),
        (
            |now| now.runs.iter_mut().for_each(|run| run.view = "down".into()),
            "views: there main, here down",
        ),
        (
            |now| {
                now.runs
                    .iter_mut()
                    .for_each(|run| drop(run.params.remove("cull")))
            },
            "params of nsm 1024: there cull=front;slope_bias=1.5, here slope_bias=1.5",
        ),
        (
            |_| (),
            "camera, light, jitter or number of reference samples: not the same",
        ),
    ];
    for (change, part) in changes {
        let message = refused(change);
        assert!(
            message.contains(part) && message.contains("measure it anew"),
            "{message}"
        );
    }
    assert!(baseline(sample()).check(&sample(), &sample().runs).is_ok());
    let mut moved = sample();
    moved.runs[0].pixels.lit += 1;
    let message = baseline(sample()).against(&moved).unwrap_err().to_string();
    assert!(
        message.contains("is of another scene: on main at 512x256"),
        "{message}"
    );
}
