//! Tests of the results, and samples of them for others.

use super::*;
use crate::files::json;
use crate::records::regimes::{Regime, RegimeTimes};
use crate::records::statistics::{FrameTimes, Spread};
use crate::records::turns::Turns;
use skiagraph_reference::{
    BlockerCounts, CertainCounts, ClassSplit, EdgeDistances, Graded, LayerJump, Quantiles, Split,
    TexelsPerPixel, WrongCounts,
};

/// An adapter that no machine has.
pub(crate) fn adapter() -> Adapter {
    Adapter {
        name: "Some GPU".into(),
        backend: "vulkan".into(),
        driver: "driver 1.2".into(),
        device_type: "Cpu".into(),
        gpu_unavailable: None,
    }
}

/// A machine that is hardly loaded.
fn machine() -> Machine {
    Machine {
        host: Some("bench".into()),
        processor: "Some CPU".into(),
        cores: 8,
        load: Some(0.25),
    }
}

/// A scene of open and closed parts.
pub(crate) fn scene() -> Scene {
    Scene {
        name: "park".into(),
        triangles: 55_000,
        parts: OpenParts {
            all: 40,
            open: 12,
            open_triangles: 5_000,
        },
    }
}

/// Results with every field in use: one full run, one without a map or GPU times, one
/// unavailable.
#[allow(clippy::too_many_lines, reason = "every field has a value")]
pub(crate) fn sample() -> Results {
    let spread = |ms: f64| Spread {
        min: ms,
        q1: ms * 1.25,
        median: ms * 1.5,
        q3: ms * 1.75,
        p95: ms * 2.0,
    };
    let times = |gpu: Option<f64>, wall: f64| FrameTimes {
        gpu_ms: gpu.map(spread),
        wall_ms: spread(wall),
        cpu_ms: None,
        gpu_frames: gpu.map(|ms| vec![ms * 2.0, ms, ms * 1.5]),
        cpu_frames: None,
        wall_frames: vec![wall * 2.0, wall, wall * 1.5],
    };
    let regime = |regime, gpu: Option<f64>| RegimeTimes {
        regime,
        frame: FrameTimes {
            cpu_ms: Some(spread(0.125)),
            cpu_frames: Some(vec![0.25, 0.125, 0.1875]),
            ..times(gpu, 1.0)
        },
        uploaded_bytes: 96,
        skipped: vec!["create_shadow_map".into()],
    };
    let run = |preset: &str, map_size| Run {
        preset: preset.into(),
        view: "main".into(),
        light: None,
        viewport: [512, 256],
        map_size,
        params: BTreeMap::from([
            ("slope_bias".into(), 1.5.into()),
            ("cull".into(), "front".into()),
        ]),
        fingerprint: "85944171f73967e8".into(),
        date: "2026-11-20".into(),
        tuned: None,
        session: "2026-11-20T04:30:12Z".into(),
        cell: format!("c0ffee{:010x}", preset.len()),
        commit: Some("0123456789abcdef0123456789abcdef01234567".into()),
        machine: Some(machine()),
        promise: None,
        pixels: PixelCounts {
            background: 72,
            facing_away: 31_000,
            facing_light: 100_000,
            lit: 60_000,
            shadow: 40_000,
        },
        band: 12,
        wrong_surface: 0,
        area: None,
        measured: None,
        unavailable: None,
        published: Vec::new(),
    };
    let published = |quantity: &str, value, note: Option<&str>| Published {
        by: "D".into(),
        quantity: quantity.into(),
        value,
        source: "table 12".into(),
        note: note.map(Into::into),
    };
    let measured = |name: &str, gpu: bool, rays| Measured {
        certain: CertainCounts {
            lit: 57_100,
            shadow: 37_900,
        },
        uncertain: 5_000,
        split: Split {
            lit: ClassSplit {
                certain_right: 57_000,
                certain_wrong: 400,
                certain_wrong_outside_band: 396,
                uncertain: 2_600,
                uncertain_wrong: 1,
            },
            shadow: ClassSplit {
                certain_right: 37_500,
                certain_wrong: 100,
                certain_wrong_outside_band: 99,
                uncertain: 2_400,
                uncertain_wrong: 2,
            },
        },
        rays,
        wrong: WrongCounts {
            lit: 102,
            shadow: 401,
            total: 503,
            certain: 495,
            in_band: 6,
        },
        hint: None,
        certain_wrong_blockers: gpu.then_some(BlockerCounts {
            open_part: 90,
            closed_part: 9,
            none: 396,
        }),
        facing_mismatch: 3,
        lights: None,
        answer: Answer::Hard,
        graded: Graded {
            rmse: 0.071,
            flip: 0.012,
            ..Graded::default()
        },
        edges: EdgeDistances::default(),
        passes: ["gbuffer", name]
            .map(|name| Pass {
                name: name.into(),
                gpu_ms: gpu.then(|| spread(0.25)),
                cpu_ms: spread(0.01),
            })
            .into(),
        frame: times(gpu.then_some(1.0), 2.0),
        regimes: vec![
            regime(Regime::Camera, gpu.then_some(0.5)),
            regime(Regime::Light, gpu.then_some(1.0)),
        ],
        memory_bytes: 12_582_912,
        saved_bytes: 1_048_576,
        scene_bytes: 2_000_000,
        turns: Some(Turns {
            group: 0,
            anchor: times(Some(1.0), 2.0),
            regimes: vec![regime(Regime::Camera, Some(0.5))],
        }),
        steady: None,
        texels: gpu.then(|| TexelsPerPixel {
            pixels: 99_990,
            under_one: 25_000,
            outside_map: 10,
            texels: Quantiles {
                p5: 0.25,
                median: 2.5,
                p95: 40.0,
            },
            ..TexelsPerPixel::default()
        }),
        layer_jump: gpu.then_some(LayerJump {
            pairs: 500,
            across: 0.0625,
            pairs_elsewhere: 198_000,
            elsewhere: 0.015625,
        }),
        sequence: None,
        images: gpu.then(|| Images {
            frame: None,
            reference: "reference.png".into(),
            shaded: format!("{name}-shaded.png"),
            visibility: format!("{name}-visibility.png"),
            error: format!("{name}-error.png"),
            uncertain: Some(format!("{name}-uncertain.png")),
            texels: Some(format!("{name}-texels.png")),
            perspective: Some(format!("{name}-perspective.png")),
            projection: Some(format!("{name}-projection.png")),
            worst_second: Vec::new(),
        }),
    };
    Results {
        schema: SCHEMA,
        program: "skiagraph 0.1.0".into(),
        adapter: adapter(),
        machine: machine(),
        scene: scene(),
        oracle: "exact".into(),
        frames: 10,
        warmup: 2,
        regime_frames: 10,
        began: "2026-11-20T04:30:12Z".into(),
        budgets: Budgets::default(),
        commands: vec!["skiagraph compare nsm rt rt_hw --size 512x256".into()],
        notes: vec!["1 point and 2 lines left out".into()],
        runs: vec![
            Run {
                measured: Some(measured("create_shadow_map", true, None)),
                published: vec![
                    published("lit", 60_001.0, None),
                    published("wrong_percent", 0.5, Some("misprint: 5.0")),
                    published("ms.trace_rays", 1.25, None),
                ],
                ..run("nsm", Some(1024))
            },
            Run {
                measured: Some(measured("trace_rays", false, Some(100_000))),
                ..run("rt", None)
            },
            Run {
                unavailable: Some("needs ray queries, \"not\" here".into()),
                ..run("rt_hw", None)
            },
        ],
        plan: None,
        others: Vec::new(),
    }
}

#[test]
fn a_step_is_what_stands_before_the_first_dot_but_no_repeat() {
    for (pass, name) in [
        ("trace_rays", "trace_rays"),
        ("fill_rays.compact", "fill_rays"),
        ("turn[0].fill_rays.compact", "fill_rays"),
        ("fill[3]", "fill[3]"),
    ] {
        assert_eq!(step(pass), name);
    }
}

#[test]
fn joined_results_are_split_and_older_files_lack_cell_commit_and_machine() {
    let mut joined = sample();
    joined.others = vec![sample(), sample()];
    joined.others[0].others = vec![sample()];
    let text = json::to_text(&joined);
    let read: Results = serde_json::from_str(&text).unwrap();
    assert_eq!(read.each(), [sample(), sample(), sample(), sample()]);
    let mut older = serde_json::to_value(sample()).unwrap();
    for run in older["runs"].as_array_mut().unwrap() {
        let run = run.as_object_mut().unwrap();
        for field in ["cell", "commit", "machine"] {
            assert!(run.remove(field).is_some(), "{field}");
        }
    }
    let older: Results = serde_json::from_value(older).unwrap();
    assert_eq!(older.machine_of(&older.runs[0]), &machine());
    assert!(
        older.runs[0].is_same_cell(&sample().runs[0]),
        "by its params"
    );
    assert_eq!(older.runs[0].assignments(), "cull=front;slope_bias=1.5");
}

#[test]
fn the_schema_is_pinned_and_reads_back() {
    let json = json::to_text(&sample());
    insta::assert_snapshot!(json);
    assert_eq!(serde_json::from_str::<Results>(&json).unwrap(), sample());
}
