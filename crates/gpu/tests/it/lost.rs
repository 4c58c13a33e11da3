//! Frames that never ran, because a host dropped their encoder or wgpu refused their commands, and
//! frames that ran in another order than they were encoded in.

use crate::buffers::{INPUT, OLD, OUT, SEED, SEED_PARAM, compute, document, shader, writes};
use crate::given::{KIND, Number, STORAGE, buffer, sums, sums_request, texture};
use crate::host::{
    GPU, LOSSES, encoder, executor, frame, lose, lost, numbers, planned, request, set, submit,
    words,
};
use crate::support::Files;
use crate::tiny::image;
use skiagraph_gpu::{ExecuteError, Executor, FaultKind, Frame};
use skiagraph_graph::{NoProvider, ParamValue};

/// The frames that are told, with their kinds.
fn told(executor: &mut Executor) -> Vec<(u32, FaultKind)> {
    let wait = wgpu::PollType::wait_indefinitely();
    GPU.device.poll(wait).unwrap();
    let faults = executor.take_faults().unwrap();
    faults.iter().map(|it| (it.index, it.kind)).collect()
}

/// Waits until frames are told: another test that polls the device may be about to call back.
fn told_some(executor: &mut Executor) -> Vec<(u32, FaultKind)> {
    let began = std::time::Instant::now();
    let mut faults = Vec::new();
    loop {
        let more = told(executor);
        let is_over = more.is_empty() && !faults.is_empty();
        faults.extend(more);
        if is_over || began.elapsed().as_secs() > 10 {
            return faults;
        }
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
}

/// Encodes a frame.
fn encoded(executor: &mut Executor) -> (u32, wgpu::CommandEncoder) {
    let mut encoder = encoder();
    let index = executor.encode(&mut encoder, &Frame::default()).unwrap();
    (index, encoder)
}

fn run(encoder: wgpu::CommandEncoder) {
    GPU.queue.submit([encoder.finish()]);
}

/// ```text
/// seed ─▶ make ─▶ a ─▶ pass_on ─▶ b       both OnChange
/// ```
fn caches() -> Files {
    let make = compute("make", "run: OnChange,", r#""out": "a""#);
    let pass_on = compute("pass_on", "run: OnChange,", r#""input": "a", "out": "b""#);
    document(SEED_PARAM, &["a", "b"], &[make, pass_on], &["b"])
        .with("make.wgsl", writes(SEED, "params.seed"))
        .with("pass_on.wgsl", writes(INPUT, "input[0] + 1u"))
}

fn seed(executor: &mut Executor, seed: u32) {
    set(executor, "seed", ParamValue::U32(seed));
}

#[test]
fn passes_of_a_lost_frame_run_again() {
    for loss in LOSSES {
        let mut executor = executor(&caches(), &request(&NoProvider));
        let first = lost(&mut executor, &Frame::default(), loss);
        assert_eq!(numbers(&mut executor, "b"), [6], "{loss:?}");
        seed(&mut executor, 8);
        let moved = lost(&mut executor, &Frame::default(), loss);
        let never = FaultKind::NeverRan;
        assert_eq!(numbers(&mut executor, "b"), [9], "{loss:?}");
        assert_eq!(told_some(&mut executor), [(first, never), (moved, never)]);
        // And then the frame rests, until something is lost again.
        let report = frame(&mut executor, &["b"]);
        assert_eq!(report.skipped, ["make", "pass_on"]);
        assert_eq!(report.fault, None);
    }
}

/// A frame that had nothing to run is no loss, and its contents are not those of an earlier one.
#[test]
fn a_lost_frame_at_rest_changes_nothing() {
    let mut executor = executor(&caches(), &request(&NoProvider));
    assert_eq!(numbers(&mut executor, "b"), [6]);
    for loss in LOSSES {
        lost(&mut executor, &Frame::default(), loss);
        assert_eq!(told(&mut executor), []);
        let asked = lost(&mut executor, &Frame::new().with_read(&["b"]), loss);
        let missing = executor.finish();
        assert!(
            matches!(missing, Err(ExecuteError::NotRun { frame }) if frame == asked),
            "{loss:?}: {missing:?}"
        );
        assert_eq!(told_some(&mut executor), [(asked, FaultKind::NeverRan)]);
        let report = frame(&mut executor, &["b"]);
        assert_eq!((words(&report, 0), report.skipped.len()), (vec![6], 2));
    }
}

/// Frames that were encoded before the loss was known are told; those after it are right.
#[test]
fn frames_behind_a_lost_one_are_told() {
    for loss in LOSSES {
        let mut executor = executor(&caches(), &request(&NoProvider));
        let (_, first) = encoded(&mut executor);
        seed(&mut executor, 8);
        let (missing, second) = encoded(&mut executor);
        let mut third = encoder();
        let read = Frame::new().with_read(&["b"]);
        let stale = executor.encode(&mut third, &read).unwrap();
        run(first);
        lose(second, loss);
        run(third);
        let report = executor.finish().unwrap();
        assert_eq!((report.index, words(&report, 0)), (stale, vec![6]));
        assert_eq!(report.fault, Some(FaultKind::WithoutPredecessor));
        let expected = [
            (missing, FaultKind::NeverRan),
            (stale, FaultKind::WithoutPredecessor),
        ];
        assert_eq!(told_some(&mut executor), expected, "{loss:?}");
        assert_eq!(numbers(&mut executor, "b"), [9], "{loss:?}");
        assert_eq!(told(&mut executor), []);
    }
}

#[test]
fn frames_in_another_order_are_told() {
    let mut executor = executor(&caches(), &request(&NoProvider));
    let (_, first) = encoded(&mut executor);
    run(first);
    seed(&mut executor, 8);
    let (one, former) = encoded(&mut executor);
    seed(&mut executor, 9);
    let (two, latter) = encoded(&mut executor);
    let (three, last) = encoded(&mut executor);
    for commands in [latter, former, last] {
        run(commands);
    }
    let out = FaultKind::OutOfOrder;
    assert_eq!(
        told_some(&mut executor),
        [(one, out), (two, out), (three, out)]
    );
    assert_eq!(numbers(&mut executor, "b"), [10]);
    assert_eq!(told(&mut executor), []);
    // One that is held back longer is told when it runs, and what was encoded meanwhile as well.
    seed(&mut executor, 11);
    let (late, held) = encoded(&mut executor);
    seed(&mut executor, 12);
    let (early, commands) = encoded(&mut executor);
    run(commands);
    assert_eq!(told_some(&mut executor), [(early, out)]);
    let (after, commands) = encoded(&mut executor);
    run(commands);
    assert_eq!(told(&mut executor), [], "nothing is wrong with {after}");
    run(held);
    assert_eq!(told_some(&mut executor), [(late, out)]);
    assert_eq!(numbers(&mut executor, "b"), [13]);
}

/// Losses that become known one after the other.
#[test]
fn frames_that_are_lost_one_by_one_leave_nothing() {
    let add = compute("add", "", r#""old": "total.previous", "out": "total""#);
    let make = compute("make", "run: OnChange,", r#""out": "a""#);
    let params = format!(r#"{SEED_PARAM} U32(name: "other", default: 1, min: 1)"#);
    let names = ["a", "total"];
    let files = document(&params, &names, &[make, add], &names)
        .with("make.wgsl", writes(SEED, "params.seed"))
        .with("add.wgsl", writes(OLD, "old[0] + 1u"))
        .edited(
            "graph.ron",
            r#"name: "total", count: 1"#,
            r#"name: "total", count: "other""#,
        );
    let values = |executor: &mut Executor| {
        let report = frame(executor, &names);
        [0, 1].map(|at| words(&report, at)[0])
    };
    for losses in LOSSES.map(|loss| [loss, LOSSES[0]]) {
        for order in [[0, 1], [1, 0]] {
            let mut executor = executor(&files, &request(&NoProvider));
            assert_eq!(values(&mut executor), [5, 1]);
            seed(&mut executor, 6);
            let (one, first) = encoded(&mut executor);
            let (two, second) = encoded(&mut executor);
            let mut commands = [Some(first), Some(second)];
            for (at, loss) in order.into_iter().zip(losses) {
                lose(commands[at].take().unwrap(), loss);
                let fault = ([one, two][at], FaultKind::NeverRan);
                assert_eq!(told_some(&mut executor), [fault]);
            }
            for total in [2, 3] {
                let report = frame(&mut executor, &names);
                let values = [0, 1].map(|at| words(&report, at)[0]);
                assert_eq!(values, [6, total], "{losses:?}, {order:?}");
                assert_eq!(report.fault, None, "{losses:?}, {order:?}");
            }
            assert_eq!(told(&mut executor), [], "{losses:?}, {order:?}");
            // A frame at rest for another plan, and one that is lost before the plan changes.
            lost(&mut executor, &Frame::default(), losses[0]);
            set(&mut executor, "other", ParamValue::U32(2));
            assert_eq!(values(&mut executor)[0], 6);
        }
    }
}

/// ```text
/// total.previous ─▶ count ─▶ total
/// ```
fn counts() -> Files {
    let count = compute("count", "", r#""old": "total.previous", "out": "total""#);
    document("", &["total"], &[count], &["total"]).with("count.wgsl", writes(OLD, "old[0] + 1u"))
}

/// A frame that goes on from what those before it leave is told if they have not run by then,
/// whether they run later or never.
#[test]
fn a_frame_before_those_that_it_goes_on_from_is_told() {
    let (never, without) = (FaultKind::NeverRan, FaultKind::WithoutPredecessor);
    for loss in LOSSES {
        for is_late in [false, true] {
            let mut executor = executor(&counts(), &request(&NoProvider));
            assert_eq!(numbers(&mut executor, "total"), [1]);
            let (missing, lost) = encoded(&mut executor);
            let waiting = [0, 1].map(|_| encoded(&mut executor));
            lose(lost, loss);
            assert_eq!(told_some(&mut executor), [(missing, never)]);
            let (early, commands) = encoded(&mut executor);
            run(commands);
            assert_eq!(told_some(&mut executor), [(early, FaultKind::OutOfOrder)]);
            let expected = waiting.each_ref().map(|(index, _)| match is_late {
                true => (*index, without),
                false => (*index, never),
            });
            for (_, commands) in waiting {
                match is_late {
                    true => run(commands),
                    false => lose(commands, loss),
                }
            }
            assert_eq!(told_some(&mut executor), expected, "{loss:?}");
            assert_eq!(numbers(&mut executor, "total"), [2], "{loss:?}");
            assert_eq!(numbers(&mut executor, "total"), [3], "{loss:?}");
            assert_eq!(told(&mut executor), [], "{loss:?}");
        }
        // In the order of encoding nothing is wrong with it.
        let mut executor = executor(&counts(), &request(&NoProvider));
        let (_, lost) = encoded(&mut executor);
        let (index, waiting) = encoded(&mut executor);
        lose(lost, loss);
        told_some(&mut executor);
        let (_, commands) = encoded(&mut executor);
        run(waiting);
        run(commands);
        assert_eq!(told_some(&mut executor), [(index, without)], "{loss:?}");
        assert_eq!(numbers(&mut executor, "total"), [3], "{loss:?}");
        assert_eq!(told(&mut executor), [], "{loss:?}");
    }
}

/// Two frames are lost one by one; the one behind them has run, and left its content.
#[test]
fn what_a_frame_behind_lost_ones_has_left_stays() {
    for loss in LOSSES {
        for order in [[0, 1], [1, 0]] {
            let mut executor = executor(&counts(), &request(&NoProvider));
            assert_eq!(numbers(&mut executor, "total"), [1]);
            let mut lost = [0, 1].map(|_| Some(encoded(&mut executor)));
            let (behind, commands) = encoded(&mut executor);
            for at in order {
                let (index, commands) = lost[at].take().unwrap();
                lose(commands, loss);
                assert_eq!(told_some(&mut executor), [(index, FaultKind::NeverRan)]);
            }
            run(commands);
            let fault = (behind, FaultKind::WithoutPredecessor);
            assert_eq!(told_some(&mut executor), [fault]);
            let total = executor.output_buffer("total").unwrap();
            let left = crate::given::content(&total, encoder());
            assert_eq!(left, [2], "{loss:?}, {order:?}");
            assert_eq!(numbers(&mut executor, "total"), [3], "{loss:?}, {order:?}");
            assert_eq!(told(&mut executor), []);
        }
    }
}

/// A frame that asks for nothing and is never submitted keeps no report back.
#[test]
fn a_report_waits_for_no_frame_that_asks_for_nothing() {
    let mut executor = executor(&caches(), &request(&NoProvider));
    let (held, first) = encoded(&mut executor);
    let mut second = encoder();
    let read = Frame::new().with_read(&["b"]).with_all(true);
    let asked = executor.encode(&mut second, &read).unwrap();
    run(second);
    let report = executor.finish().unwrap();
    assert_eq!((report.index, words(&report, 0)), (asked, vec![6]));
    assert_eq!(report.fault, Some(FaultKind::OutOfOrder));
    assert_eq!(told_some(&mut executor), [(asked, FaultKind::OutOfOrder)]);
    lose(first, LOSSES[0]);
    assert_eq!(told_some(&mut executor), [(held, FaultKind::NeverRan)]);
    assert_eq!(numbers(&mut executor, "b"), [6]);
}

/// A plan may change while frames are under way that asked for contents at rest.
#[test]
fn frames_at_rest_outlive_a_change_of_the_plan() {
    let mut executor = executor(&caches(), &request(&NoProvider));
    assert_eq!(numbers(&mut executor, "b"), [6]);
    let mut commands = encoder();
    let read = Frame::new().with_read(&["b"]);
    executor.encode(&mut commands, &read).unwrap();
    let plan = planned(&image(), &request(&NoProvider));
    executor.replace_graph(plan, &mut NoProvider).unwrap();
    let mut next = encoder();
    executor.encode(&mut next, &Frame::default()).unwrap();
    let plan = planned(&caches(), &request(&NoProvider));
    executor.replace_graph(plan, &mut NoProvider).unwrap();
    run(commands);
    lose(next, LOSSES[0]);
    assert_eq!(words(&executor.finish().unwrap(), 0), [6]);
    assert_eq!(numbers(&mut executor, "b"), [6]);
}

/// Several frames of one encoder are lost together.
#[test]
fn all_frames_of_an_encoder_are_lost_with_it() {
    for loss in LOSSES {
        let mut executor = executor(&counts(), &request(&NoProvider));
        assert_eq!(numbers(&mut executor, "total"), [1]);
        let mut commands = encoder();
        for _ in 0..3 {
            executor.encode(&mut commands, &Frame::default()).unwrap();
        }
        lose(commands, loss);
        let lost = [1, 2, 3].map(|index| (index, FaultKind::NeverRan));
        assert_eq!(told_some(&mut executor), lost);
        // The output is that of the last frame that ran.
        let total = executor.output_buffer("total").unwrap();
        let content = crate::given::content(&total, encoder());
        assert_eq!(content, [1], "{loss:?}");
        assert_eq!(numbers(&mut executor, "total"), [2], "{loss:?}");
    }
}

/// ```text
/// host.number, host.number.previous ─▶ pair ─▶ seen
/// ```
#[test]
fn what_the_host_provided_before_is_that_of_the_last_frame_that_ran() {
    let bind = r#""now": "host.number", "old": "host.number.previous", "out": "seen""#;
    let files = document("", &["seen"], &[compute("pair", "", bind)], &["seen"]).with(
        "pair.wgsl",
        writes(
            &format!("var<storage, read> now: array<u32>; {OLD}"),
            "100u * now[0] + old[0]",
        ),
    );
    for loss in LOSSES {
        let mut provider = Number::new(false);
        let plan = planned(&files, &request(&provider));
        let made = Executor::new(&GPU.device, &GPU.queue, plan, &mut provider);
        let mut executor = made.unwrap();
        // A frame that runs before the one that fills the copy is told.
        let (_, missing) = encoded(&mut executor);
        let (_, waiting) = encoded(&mut executor);
        lose(missing, loss);
        told_some(&mut executor);
        let (early, commands) = encoded(&mut executor);
        run(commands);
        let fault = (early, FaultKind::OutOfOrder);
        let faults = told_some(&mut executor);
        assert!(faults.contains(&fault), "{loss:?}: {faults:?}");
        lose(waiting, loss);
        told(&mut executor);
        let made = Executor::new(
            &GPU.device,
            &GPU.queue,
            executor.plan().clone(),
            &mut provider,
        );
        let mut executor = made.unwrap();
        // The first frame has no frame before it, and does not count if it is lost.
        lost(&mut executor, &Frame::default(), loss);
        let mut turn = |number: u32| {
            provider.value = number;
            executor.refresh(&mut provider).unwrap();
        };
        turn(2);
        assert_eq!(numbers(&mut executor, "seen"), [202], "{loss:?}");
        let mut turn = |executor: &mut Executor, number: u32| {
            provider.value = number;
            executor.refresh(&mut provider).unwrap();
        };
        turn(&mut executor, 3);
        lost(&mut executor, &Frame::default(), loss);
        turn(&mut executor, 4);
        assert_eq!(numbers(&mut executor, "seen"), [402], "{loss:?}");
        // The frame behind a lost one in which the number has changed leaves it all the same.
        turn(&mut executor, 5);
        let (_, missing) = encoded(&mut executor);
        let (_, behind) = encoded(&mut executor);
        lose(missing, loss);
        run(behind);
        turn(&mut executor, 6);
        assert_eq!(numbers(&mut executor, "seen"), [605], "{loss:?}");
    }
}

/// A buffer with `keep` grows; the frame that copies its content to the larger one is lost.
#[test]
fn what_stays_survives_a_lost_copy() {
    let files = Files::graph(
        r#"
    params: [U32(name: "wanted", default: 3)],
    materials: [
        Buffer(name: "needed", keep: true),
        Buffer(name: "list", count: 4, keep: true, grow: (counter: "needed", max: 64)),
    ],
    passes: [Compute(name: "append", dispatch: Groups(1, 1, 1))],
    outputs: ["list", "needed"],
"#,
    )
    .with(
        "append.wgsl",
        "struct Params { wanted: u32 }
         var<uniform> params: Params;
         var<storage, read_write> needed: u32;
         var<storage, read_write> list: array<u32>;
         @compute @workgroup_size(1) fn main() {
             for (var item = 0u; item < params.wanted; item++) {
                 if needed < arrayLength(&list) { list[needed] = 10u + needed; }
                 needed++;
             }
         }",
    );
    for loss in LOSSES {
        let mut executor = executor(&files, &request(&NoProvider));
        assert_eq!(numbers(&mut executor, "list"), [10, 11, 12, 0]);
        let plan = executor.plan().with(|request| {
            request.grown.insert("list".to_owned(), 9);
        });
        executor
            .replace_graph(plan.unwrap(), &mut NoProvider)
            .unwrap();
        lost(&mut executor, &Frame::default(), loss);
        let expected = [10, 11, 12, 13, 14, 15, 0, 0, 0];
        assert_eq!(numbers(&mut executor, "list"), expected, "{loss:?}");
        // A frame that runs before the copy is told.
        let (_, missing) = encoded(&mut executor);
        let plan = executor.plan().with(|request| {
            request.grown.insert("list".to_owned(), 20);
        });
        executor
            .replace_graph(plan.unwrap(), &mut NoProvider)
            .unwrap();
        let (_, waiting) = encoded(&mut executor);
        lose(missing, loss);
        told_some(&mut executor);
        let (early, commands) = encoded(&mut executor);
        run(commands);
        let fault = (early, FaultKind::OutOfOrder);
        let faults = told_some(&mut executor);
        assert!(faults.contains(&fault), "{loss:?}: {faults:?}");
        drop(waiting);
    }
}

/// Changes before a lost frame are told to the next one.
#[test]
fn flags_are_told_again() {
    let tell = compute("tell", "", r#""out": "told""#);
    let count = compute("count", "", r#""old": "told.previous", "out": "total""#);
    let flags = "out[0] = 4u * frame.fresh + 2u * frame.changed_scene + frame.changed_light;";
    let files = document("", &["told", "total"], &[tell, count], &["told", "total"])
        .with(
            "frame.wgsl",
            include_str!("../../../../shaders/shared/frame.wgsl"),
        )
        .with(
            "tell.wgsl",
            shader(&format!("#import \"frame.wgsl\"\n{OUT}"), flags),
        )
        .with("count.wgsl", writes(OLD, "old[0]"));
    for loss in LOSSES {
        let mut executor = executor(&files, &request(&NoProvider));
        lost(&mut executor, &Frame::default(), loss);
        assert_eq!(numbers(&mut executor, "told"), [7], "{loss:?}");
        assert_eq!(numbers(&mut executor, "told"), [0], "{loss:?}");
        lost(&mut executor, &Frame::default(), loss);
        assert_eq!(numbers(&mut executor, "told"), [0], "{loss:?}");
        // A frame ran on other contents than it was encoded for, so what it left is not to be
        // relied on.
        let (_, missing) = encoded(&mut executor);
        let (_, behind) = encoded(&mut executor);
        lose(missing, loss);
        run(behind);
        assert_eq!(numbers(&mut executor, "told"), [7], "{loss:?}");
    }
}

/// A resource with two allocations that few frames write.
#[test]
fn a_history_goes_on_from_what_was_written_last() {
    let step = compute(
        "step",
        r#"run: When("on"),"#,
        r#""old": "total.previous", "out": "total""#,
    );
    let other = compute("other", "", r#""out": "beside""#);
    let params = format!(r#"{SEED_PARAM} Bool(name: "on", default: true)"#);
    let names = ["total", "beside"];
    let files = document(&params, &names, &[step, other], &names)
        .with(
            "step.wgsl",
            writes(&format!("{SEED} {OLD}"), "10u * old[0] + params.seed"),
        )
        .with("other.wgsl", writes("", "1u"));
    for loss in LOSSES {
        let mut executor = executor(&files, &request(&NoProvider));
        let on = |executor: &mut Executor, on| set(executor, "on", ParamValue::Bool(on));
        seed(&mut executor, 1);
        assert_eq!(numbers(&mut executor, "total"), [1]);
        seed(&mut executor, 2);
        assert_eq!(numbers(&mut executor, "total"), [12]);
        // The frame behind the lost one does not write it.
        seed(&mut executor, 3);
        let (_, missing) = encoded(&mut executor);
        on(&mut executor, false);
        let (_, behind) = encoded(&mut executor);
        lose(missing, loss);
        run(behind);
        assert_eq!(numbers(&mut executor, "total"), [12], "{loss:?}");
        on(&mut executor, true);
        assert_eq!(numbers(&mut executor, "total"), [123], "{loss:?}");
        told(&mut executor);
        // Nor does a lost one take back what another has written that ran in its place.
        on(&mut executor, false);
        let (late, held) = encoded(&mut executor);
        on(&mut executor, true);
        seed(&mut executor, 4);
        let (early, commands) = encoded(&mut executor);
        run(commands);
        let out = FaultKind::OutOfOrder;
        assert_eq!(told_some(&mut executor), [(early, out)], "{loss:?}");
        let total = executor.output_buffer("total").unwrap();
        let [left] = crate::given::content(&total, encoder())[..] else {
            panic!("one number");
        };
        lose(held, loss);
        assert_eq!(told_some(&mut executor), [(late, FaultKind::NeverRan)]);
        seed(&mut executor, 5);
        assert_eq!(numbers(&mut executor, "total"), [10 * left + 5], "{loss:?}");
    }
}

/// `submit` returns what wgpu refuses; nothing reaches the host's handler of uncaptured errors.
#[test]
fn commands_of_submit_that_are_refused_are_an_error() {
    let mut executor = executor(&sums(), &sums_request());
    let image = texture(&KIND, 1);
    let import = |executor: &mut Executor, number: u32| {
        let more = buffer(&[number], STORAGE);
        executor.import_texture("image", &image).unwrap();
        executor.import_buffer("more", &more).unwrap();
        more
    };
    let read = Frame::new().with_read(&["sum"]);
    let more = import(&mut executor, 1);
    executor.submit(&read, &|| false).unwrap();
    assert_eq!(words(&executor.finish().unwrap(), 0)[0], 2);
    more.destroy();
    let refused = executor.submit(&read, &|| false);
    match refused {
        Err(ExecuteError::Refused { frame, .. }) => assert_eq!(frame, 1),
        other => panic!("{other:?}"),
    }
    assert_eq!(told_some(&mut executor), [(1, FaultKind::NeverRan)]);
    import(&mut executor, 2);
    executor.submit(&read, &|| false).unwrap();
    assert_eq!(words(&executor.finish().unwrap(), 0)[0], 3);
    assert_eq!(told(&mut executor), []);
}

/// Only so many faults wait for a host that never asks.
#[test]
fn faults_that_nobody_asks_for_take_no_memory_without_bound() {
    let mut executor = executor(&caches(), &request(&NoProvider));
    let frame = Frame::new().with_all(true);
    let last = (0..1100)
        .map(|_| lost(&mut executor, &frame, LOSSES[0]))
        .last();
    let faults = executor.take_faults().unwrap();
    assert_eq!(faults.len(), 1024);
    assert_eq!(faults.last().map(|fault| fault.index), last);
    let text = faults[0].to_string();
    assert!(text.starts_with("frame 76 never ran"), "{text}");
    assert_eq!(numbers(&mut executor, "b"), [6]);
}

/// Numbers of frames on the GPU are made anew after some thousand frames.
#[test]
fn thousands_of_frames_are_told_apart() {
    let mut executor = executor(&caches(), &request(&NoProvider));
    let frame = Frame::new().with_all(true);
    for _ in 0..2100 {
        let mut encoder = encoder();
        executor.encode(&mut encoder, &frame).unwrap();
        run(encoder);
    }
    assert_eq!(told(&mut executor), []);
    assert_eq!(submit(&mut executor, &frame).skipped, [""; 0]);
}
