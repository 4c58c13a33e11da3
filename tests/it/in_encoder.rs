//! Refreshes whose GPU work comes into the encoder of the frame: a host's skinning before it, moved
//! parts written in place, encoders that are dropped or submitted in another order.

use crate::host_buffers::{
    MegaBuffer, VIEWPORT, camera, destroy, places, places_of, raise_in, raised_stone, scenes,
    shown, start, stones, uploaded,
};
use crate::support::graphs::{self, allow_ray_queries, open, values};
use crate::support::random::Random;
use glam::{DAffine3, DVec3, Vec3};
use skiagraph_gpu::{Executor, Frame, device::Gpu};
use skiagraph_graph::ParamValue;
use skiagraph_passes::SceneProvider;
use skiagraph_scene::Movable;

const PRESETS: [&str; 2] = ["rt", "light_buffer"];
/// One step of `raise_in`, which lowers the right halves of stones.
const STEP: i32 = -3000;
const BOUNDS: [Vec3; 2] = [Vec3::new(-1.0, -1.7, -1.0), Vec3::ONE];

fn begin(gpu: &Gpu) -> wgpu::CommandEncoder {
    gpu.device.create_command_encoder(&Default::default())
}

/// Refreshes in an encoder, and encodes a frame there.
fn encode(
    executor: &mut Executor,
    host: &mut SceneProvider,
    encoder: &mut wgpu::CommandEncoder,
    read: &[&str],
) {
    executor
        .refresh(&mut host.in_encoder(encoder).unwrap())
        .unwrap();
    let frame = Frame::new().with_read(read);
    executor.encode(encoder, &frame).unwrap();
}

/// A frame of each executor in one submission.
fn frames(
    gpu: &Gpu,
    executors: &mut [Executor],
    host: &mut SceneProvider,
    mut encoder: wgpu::CommandEncoder,
) -> Vec<Vec<u32>> {
    for executor in &mut *executors {
        encode(executor, host, &mut encoder, &["visibility"]);
    }
    gpu.queue.submit([encoder.finish()]);
    let reports = executors.iter_mut().map(|it| it.finish().unwrap());
    reports.map(|it| values(&it, "visibility")).collect()
}

/// Pictures of a scene that is made of nothing.
fn expected(
    gpu: &Gpu,
    stones: &MegaBuffer,
    places: &[(usize, DAffine3)],
    lift: i32,
) -> Vec<Vec<u32>> {
    let mut scene = uploaded(stones, places, lift);
    let pictures = PRESETS.iter();
    pictures
        .map(|preset| shown(gpu, &mut start(gpu, preset, &mut scene)))
        .collect()
}

/// Floor and stones, of which the last two move.
fn placed(turn: usize) -> Vec<(usize, DAffine3)> {
    let mut placed = places(0);
    for (at, (_, map)) in placed.iter_mut().enumerate().skip(5) {
        let turned = DAffine3::from_rotation_y(0.3 * (turn * at) as f64);
        let raised = DVec3::Y * 0.1 * turn as f64;
        *map = DAffine3::from_translation(map.translation + raised)
            * turned
            * DAffine3::from_mat3(map.matrix3);
    }
    placed
}

/// A scene of parts in the host's buffers.
fn of_stones() -> (Gpu, MegaBuffer, SceneProvider) {
    let gpu = open();
    let stones = stones(&gpu);
    let [host, _] = scenes(&stones, &placed(0), &gpu.device.limits());
    (gpu, stones, host)
}

/// Lowers the right halves of the stones by a step.
fn lower(gpu: &Gpu, stones: &MegaBuffer, encoder: &mut wgpu::CommandEncoder) {
    raise_in(gpu, encoder, (stones, 1), STEP.cast_unsigned() & 0xffff);
}

fn set(host: &mut SceneProvider, places: &[(usize, DAffine3)]) {
    host.set_transforms(&places_of(places)).unwrap();
}

fn rewritten(host: &mut SceneProvider) {
    let parts: Vec<_> = host.parts().skip(1).collect();
    for part in parts {
        host.rewrite_part(part, BOUNDS).unwrap();
    }
}

/// Stones that the host skins in the encoder of the frame, and moves, are right in that very frame;
/// nothing is copied. Lost frames, and frames of one executor alone, between them.
#[test]
fn what_the_host_writes_in_the_frames_encoder_is_shown_in_that_frame() {
    let (gpu, stones, mut host) = of_stones();
    let mut executors = PRESETS.map(|preset| start(&gpu, preset, &mut host));
    let copied = host.work().copied;
    let (mut lift, mut random) = (0, Random(61));
    for turn in 1..12 {
        let places = placed(turn);
        set(&mut host, &places);
        let mut encoder = begin(&gpu);
        if random.unit() < 0.5 {
            // With the host's own commands, which never run.
            let mut lost = begin(&gpu);
            lower(&gpu, &stones, &mut lost);
            rewritten(&mut host);
            let dropped = 1 + usize::from(random.unit() < 0.5);
            for executor in &mut executors[..dropped] {
                encode(executor, &mut host, &mut lost, &[]);
            }
        }
        if random.unit() < 0.7 {
            lower(&gpu, &stones, &mut encoder);
            lift += STEP;
            rewritten(&mut host);
        }
        let seen = frames(&gpu, &mut executors, &mut host, encoder);
        assert!(seen == expected(&gpu, &stones, &places, lift), "{turn}");
    }
    assert!(lift < 3 * STEP);
    assert_eq!(host.work().copied, copied);
}

/// The next refresh writes what was in an encoder that was dropped, or came in the other order.
#[test]
fn what_lost_encoders_held_is_written_by_the_next_refresh() {
    let (gpu, stones, mut host) = of_stones();
    let mut executors = PRESETS.map(|preset| start(&gpu, preset, &mut host));
    for turn in 1..5 {
        let mut encoders = [begin(&gpu), begin(&gpu)];
        for (at, encoder) in encoders.iter_mut().enumerate() {
            set(&mut host, &placed(2 * turn + at));
            encode(&mut executors[at], &mut host, encoder, &[]);
        }
        let [first, second] = encoders.map(wgpu::CommandEncoder::finish);
        match turn % 3 {
            0 => {
                gpu.queue.submit([second, first]);
                // The order is known once they have run.
                gpu.device
                    .poll(wgpu::PollType::wait_indefinitely())
                    .unwrap();
            }
            1 => {
                drop(first);
                gpu.queue.submit([second]);
            }
            _ => {
                drop(second);
                gpu.queue.submit([first]);
            }
        }
        // Nothing has changed since.
        let seen = frames(&gpu, &mut executors, &mut host, begin(&gpu));
        let expected = expected(&gpu, &stones, &placed(2 * turn + 1), 0);
        assert!(seen == expected, "{turn}");
    }
}

/// A branch keeps its scene, and what encoders held that had not run when it was made.
#[test]
fn branches_are_not_written_in_place() {
    let (gpu, stones, mut host) = of_stones();
    let mut executors = PRESETS.map(|preset| start(&gpu, preset, &mut host));
    set(&mut host, &placed(1));
    let mut encoder = begin(&gpu);
    encode(&mut executors[0], &mut host, &mut encoder, &[]);
    let mut branch = host.branch();
    drop(encoder);
    let mut own = PRESETS.map(|preset| start(&gpu, preset, &mut branch));
    set(&mut host, &placed(2));
    let seen = frames(&gpu, &mut executors, &mut host, begin(&gpu));
    assert!(seen == expected(&gpu, &stones, &placed(2), 0));
    let seen = frames(&gpu, &mut own, &mut branch, begin(&gpu));
    assert!(seen == expected(&gpu, &stones, &placed(1), 0));
    let copied = host.work().copied;
    drop((branch, own));
    set(&mut host, &placed(3));
    let seen = frames(&gpu, &mut executors, &mut host, begin(&gpu));
    assert!(seen == expected(&gpu, &stones, &placed(3), 0));
    assert_eq!(host.work().copied, copied);
}

/// A lost copy from a buffer that a branch has meanwhile to itself finds it as it was; a branch
/// notices a loss before it was made.
#[test]
fn a_branch_writes_no_buffer_that_is_to_be_copied() {
    let (gpu, stones, mut host) = of_stones();
    let mut executors = PRESETS.map(|preset| start(&gpu, preset, &mut host));
    let mut branch = host.branch();
    let mut own = PRESETS.map(|preset| start(&gpu, preset, &mut branch));
    set(&mut host, &placed(1));
    let mut lost = begin(&gpu);
    encode(&mut executors[0], &mut host, &mut lost, &[]);
    drop(lost);
    // Another part.
    let mut other = placed(0);
    other[1].1 = DAffine3::from_translation(DVec3::Y) * other[1].1;
    set(&mut branch, &other);
    let seen = frames(&gpu, &mut own, &mut branch, begin(&gpu));
    assert!(seen == expected(&gpu, &stones, &other, 0));
    let seen = frames(&gpu, &mut executors, &mut host, begin(&gpu));
    assert!(seen == expected(&gpu, &stones, &placed(1), 0));

    set(&mut host, &placed(2));
    let mut lost = begin(&gpu);
    for executor in &mut executors {
        encode(executor, &mut host, &mut lost, &[]);
    }
    let mut branch = host.branch();
    drop((host, lost));
    let seen = frames(&gpu, &mut executors, &mut branch, begin(&gpu));
    assert!(seen == expected(&gpu, &stones, &placed(2), 0));
}

/// Commands that wgpu refuses are not recorded for ever: they read vertices that are gone.
#[test]
fn buffers_whose_commands_are_refused_are_made_anew() {
    let (gpu, stones, mut host) = of_stones();
    let (stone, at) = (
        raised_stone(&stones, 0),
        DAffine3::from_scale(DVec3::splat(2.0)),
    );
    let parts: Vec<_> = host.parts().collect();
    host.add_part(&stone, &at).unwrap();
    let mut executors = PRESETS.map(|preset| start(&gpu, preset, &mut host));
    for (part, (_, map)) in parts.iter().zip(placed(1)) {
        host.set_transform(*part, &map).unwrap();
    }
    let mut lost = begin(&gpu);
    for executor in &mut executors {
        encode(executor, &mut host, &mut lost, &[]);
    }
    drop(lost);
    parts
        .iter()
        .for_each(|part| host.remove_part(*part).unwrap());
    destroy(&stones);
    let refused = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
    let mut encoder = begin(&gpu);
    for executor in &mut executors {
        encode(executor, &mut host, &mut encoder, &[]);
    }
    gpu.queue.submit([encoder.finish()]);
    assert!(skiagraph_gpu::block_on(refused.pop()).is_some());
    gpu.device
        .poll(wgpu::PollType::wait_indefinitely())
        .unwrap();
    let seen = frames(&gpu, &mut executors, &mut host, begin(&gpu));
    let mut alone = SceneProvider::from_parts(Movable::joined(&[&stone]), host.light());
    alone.set_camera(&camera(VIEWPORT));
    alone.set_transforms(&[at]).unwrap();
    let expected = PRESETS.map(|preset| shown(&gpu, &mut start(&gpu, preset, &mut alone)));
    assert!(seen == expected);
}

/// A refresh with a submission of its own finds what encoders hold that are not submitted yet.
#[test]
fn both_ways_of_refreshing_go_together() {
    let (gpu, stones, mut host) = of_stones();
    let mut executors = PRESETS.map(|preset| start(&gpu, preset, &mut host));
    for turn in 1..4 {
        let places = placed(turn);
        set(&mut host, &places);
        let mut encoder = begin(&gpu);
        encode(&mut executors[0], &mut host, &mut encoder, &["visibility"]);
        if turn % 2 == 0 {
            let part = host.parts().nth(1).unwrap();
            host.rewrite_part(part, BOUNDS).unwrap();
        }
        executors[1].refresh(&mut host).unwrap();
        let expected = expected(&gpu, &stones, &places, 0);
        assert!(shown(&gpu, &mut executors[1]) == expected[1], "{turn}");
        gpu.queue.submit([encoder.finish()]);
        let report = executors[0].finish().unwrap();
        assert!(values(&report, "visibility") == expected[0], "{turn}");
        assert!(shown(&gpu, &mut executors[1]) == expected[1], "{turn}");
    }
    // A loss is repaired by refreshes that submit by themselves, too, once something has changed.
    set(&mut host, &placed(4));
    let mut lost = begin(&gpu);
    for executor in &mut executors {
        encode(executor, &mut host, &mut lost, &[]);
    }
    drop(lost);
    let mut other = placed(4);
    other[1].1 = DAffine3::from_translation(DVec3::Y) * other[1].1;
    set(&mut host, &other);
    let expected = expected(&gpu, &stones, &other, 0);
    for _ in 0..2 {
        for (executor, expected) in executors.iter_mut().zip(&expected) {
            executor.refresh(&mut host).unwrap();
            assert!(shown(&gpu, executor) == *expected);
        }
    }
}

/// Acceleration structures are built in the encoder, of what was written there.
#[test]
#[ignore = "needs EXPERIMENTAL_RAY_QUERY"]
fn ray_query_structures_are_built_in_the_encoder() {
    let (gpu, stones, mut host) = of_stones();
    let plan = graphs::plan("pipelines/rt.ron", &host, VIEWPORT, |request| {
        allow_ray_queries(request);
        let engine = ParamValue::Choice("ray_query".to_owned());
        request.params.insert("engine".to_owned(), engine);
    });
    let mut executors = [Executor::on(&gpu, plan, &mut host).unwrap()];
    let mut other = start(&gpu, "light_buffer", &mut host);
    for turn in 1..6 {
        set(&mut host, &placed(turn));
        let mut encoder = begin(&gpu);
        if turn % 2 == 0 {
            lower(&gpu, &stones, &mut encoder);
            rewritten(&mut host);
        } else {
            // The positions are there already, and a structure alone is lost.
            other.refresh(&mut host).unwrap();
            encode(&mut executors[0], &mut host, &mut begin(&gpu), &[]);
        }
        let lift = STEP * (turn / 2) as i32;
        let seen = frames(&gpu, &mut executors, &mut host, encoder);
        let expected = expected(&gpu, &stones, &placed(turn), lift);
        assert!(seen[0] == expected[0], "{turn}");
    }
}
