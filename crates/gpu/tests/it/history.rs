//! Knowledge between frames: the uniform `frame`, `.previous` of provided resources, and content
//! that survives another plan.

use crate::buffers::{OUT, compute, document, shader, writes};
use crate::given::Number;
use crate::host::{GPU, encoder, executor, frame, numbers, planned, request, submit, words};
use crate::support::{Files, right};
use skiagraph_gpu::{Executor, Frame};
use skiagraph_graph::{NoProvider, ParamValue, Plan};

/// `frame.index` and the bits of `frame.seconds`.
fn clock(run: &str) -> Files {
    let files = document(
        "",
        &[],
        &[compute("tell", run, r#""out": "told""#)],
        &["told"],
    );
    files
        .edited(
            "graph.ron",
            "materials: [",
            r#"materials: [Buffer(name: "told", count: 2)"#,
        )
        .with(
            "tell.wgsl",
            shader(
                &format!(
                    "struct Frame {{ index: u32, seconds: f32 }} var<uniform> frame: Frame; {OUT}"
                ),
                "out[0] = frame.index; out[1] = bitcast<u32>(frame.seconds);",
            ),
        )
}

#[test]
fn shaders_know_the_number_and_the_time_of_the_frame() {
    // That the frame is another one is a change.
    for run in ["", "run: OnChange,"] {
        let mut executor = executor(&clock(run), &request(&NoProvider));
        for (index, seconds) in [0.0, 0.5, 0.25, -3.0].into_iter().enumerate() {
            let now = Frame::new().with_seconds(seconds).with_read(&["told"]);
            let report = submit(&mut executor, &now);
            assert_eq!(words(&report, 0), [index as u32, f32::to_bits(seconds)]);
        }
        // Another plan goes on counting.
        executor
            .resize([4, 4], &mut NoProvider)
            .unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(numbers(&mut executor, "told")[0], 4);
    }
}

/// A host may encode several frames before it submits the first.
#[test]
fn each_of_two_frames_in_one_encoder_has_its_own_number() {
    let files = document(
        "",
        &["sum"],
        &[compute("add", "", r#""old": "sum.previous", "out": "sum""#)],
        &["sum"],
    )
    .with(
        "add.wgsl",
        writes(
            "struct Frame { index: u32, seconds: f32 } var<uniform> frame: Frame;
             var<storage, read> old: array<u32>;",
            "10u * old[0] + frame.index + 1u",
        ),
    );
    let mut executor = executor(&files, &request(&NoProvider));
    let mut commands = encoder();
    for _ in 0..2 {
        executor
            .encode(&mut commands, &Frame::default())
            .unwrap_or_else(|error| panic!("{error}"));
    }
    GPU.queue.submit([commands.finish()]);
    assert_eq!(numbers(&mut executor, "sum"), [123]);
}

/// ```text
/// host.number, host.number.previous ─▶ pair (OnChange) ─▶ seen
/// ```
fn pair() -> Files {
    let files = document(
        "U32(name: \"other\", default: 0)",
        &[],
        &[compute(
            "pair",
            "run: OnChange,",
            r#""now": "host.number", "old": "host.number.previous", "out": "seen""#,
        )],
        &["seen"],
    );
    files
        .edited(
            "graph.ron",
            "materials: [",
            r#"materials: [Buffer(name: "seen", count: 2)"#,
        )
        .with(
            "pair.wgsl",
            shader(
                &format!(
                    "var<storage, read> now: array<u32>; var<storage, read> old: array<u32>; {OUT}"
                ),
                "out[0] = now[0]; out[1] = old[0];",
            ),
        )
}

/// In the frame after a change, what was there before it; in the next one, what is there now; then
/// nothing has changed any more.
#[test]
fn the_frame_before_has_what_the_host_provided_then() {
    for in_place in [true, false] {
        let mut provider = Number::new(in_place);
        let plan = planned(&pair(), &request(&provider));
        let mut executor = Executor::new(&GPU.device, &GPU.queue, plan, &mut provider)
            .unwrap_or_else(|error| panic!("{error}"));
        let step = |executor: &mut Executor, now: u32, old: u32, ran: bool| {
            let report = frame(executor, &["seen"]);
            assert_eq!(words(&report, 0), [now, old]);
            assert_eq!(report.skipped.is_empty(), ran, "{now}, {old}");
        };
        step(&mut executor, 1, 1, true);
        step(&mut executor, 1, 1, false);
        provider.value = 2;
        executor
            .refresh(&mut provider)
            .unwrap_or_else(|error| panic!("{error}"));
        step(&mut executor, 2, 1, true);
        step(&mut executor, 2, 2, true);
        step(&mut executor, 2, 2, false);
        // Through another plan, too.
        provider.value = 3;
        executor
            .set_param("other", ParamValue::U32(1), &mut provider)
            .unwrap_or_else(|error| panic!("{error}"));
        step(&mut executor, 3, 2, true);
        step(&mut executor, 3, 3, true);
        step(&mut executor, 3, 3, false);
        // And when the host writes into its buffer and says so.
        provider.value = 4;
        provider.fill();
        executor
            .touch("host.number")
            .unwrap_or_else(|error| panic!("{error}"));
        step(&mut executor, 4, 3, true);
        step(&mut executor, 4, 4, true);
        step(&mut executor, 4, 4, false);
    }
}

/// ```text
/// map (OnChange) ─▶ shade (OnChange) ─▶ image ;  total.previous ─▶ count ─▶ total
///   └─▶ more (OnChange, only if asked for) ─▶ second
/// ```
const STEPS: &str = r#"
    params: [
        U32(name: "size", default: 4),
        U32(name: "gain", default: 1),
        Bool(name: "extra", default: false),
    ],
    materials: [
        Texture(name: "map", format: R32Uint, size: "size"),
        Texture(name: "image", format: R32Uint),
        Texture(name: "second", format: R32Uint, size: 4),
        Buffer(name: "total", count: 1),
    ],
    passes: [
        Fullscreen(name: "map", color: ["map"], run: OnChange),
        Fullscreen(name: "shade", color: ["image"], run: OnChange),
        Fullscreen(
            name: "more",
            if: "extra",
            shader: "shade",
            color: ["second"],
            run: OnChange,
        ),
        Compute(
            name: "count",
            dispatch: Groups(1, 1, 1),
            bind: {"old": "total.previous", "out": "total"},
        ),
    ],
    outputs: ["image", "total", (name: "second", if: "extra")],
"#;

/// The plan made once more.
fn same(plan: &Plan) -> Plan {
    right(plan.with(|_| {}))
}

/// After another plan only what it changed is made again, and histories go on.
#[test]
fn a_frame_after_another_plan_makes_only_what_changed() {
    let files = Files::graph(STEPS)
        .with(
            "map.wgsl",
            "@fragment fn fragment() -> @location(0) u32 { return 7u; }",
        )
        .with(
            "shade.wgsl",
            "struct Params { gain: u32 } var<uniform> params: Params;
             var map: texture_2d<u32>;
             @fragment fn fragment() -> @location(0) u32 {
                 return params.gain * textureLoad(map, vec2(0u), 0).x;
             }",
        )
        .with(
            "count.wgsl",
            writes("var<storage, read> old: array<u32>;", "old[0] + 1u"),
        );
    let mut executor = executor(&files, &request(&NoProvider));
    let (number, flag) = (ParamValue::U32, ParamValue::Bool);
    let edited = files.edited("map.wgsl", "7u", "9u");
    type Change<'c> = Box<dyn Fn(&Plan) -> Plan + 'c>;
    let param = |name: &'static str, value: ParamValue| -> Change<'_> {
        Box::new(move |plan| right(plan.with_param(name, value.clone())))
    };
    let outputs = |wanted: Option<&'static str>| -> Change<'_> {
        Box::new(move |plan| {
            let wanted = wanted.map(|name| vec![name.to_owned()]);
            right(plan.with(|request| request.outputs = wanted))
        })
    };
    let viewport = Box::new(|plan: &Plan| right(plan.with_viewport([16, 4])));
    let other = Box::new(|_: &Plan| planned(&edited, &request(&NoProvider)));
    let steps: [(&str, Change<'_>, &[&str], u32); 11] = [
        ("the same plan", Box::new(same), &["map", "shade"], 7),
        ("a param of shade", param("gain", number(2)), &["map"], 14),
        ("the map's size", param("size", number(8)), &[], 14),
        (
            "one more pass",
            param("extra", flag(true)),
            &["map", "shade"],
            14,
        ),
        (
            "that has run",
            Box::new(same),
            &["map", "shade", "more"],
            14,
        ),
        (
            "one pass less",
            param("extra", flag(false)),
            &["map", "shade"],
            14,
        ),
        ("the viewport", viewport, &["map"], 14),
        ("no image wanted", outputs(Some("total")), &[], 0),
        ("it is wanted again", outputs(None), &[], 14),
        ("another shader, all else as at first", other, &[], 9),
        ("nothing any more", Box::new(same), &["map", "shade"], 9),
    ];
    let report = frame(&mut executor, &["image", "total"]);
    assert!(report.skipped.is_empty());
    for (count, (what, change, skipped, image)) in (2..).zip(steps) {
        let plan = change(executor.plan());
        executor
            .replace_graph(plan, &mut NoProvider)
            .unwrap_or_else(|error| panic!("{error}"));
        let outputs = executor.plan().outputs();
        let read: Vec<&str> = outputs.iter().map(|output| output.name.as_str()).collect();
        let report = frame(&mut executor, &read);
        assert_eq!(report.skipped, skipped, "{what}");
        for (at, name) in read.iter().enumerate() {
            let expected = if *name == "total" { count } else { image };
            assert_eq!(words(&report, at)[0], expected, "{what}: {name}");
        }
    }
}
