//! A host that loses frames at random, submits them in another order and goes on on another device:
//! every frame that is encoded after that was known shows what a scene that never moved does, and
//! the host is told of each other frame.

use crate::{
    one_submission::{parts, places, same, sun, view},
    support::{
        devices::{of_own_instance, others},
        graphs::{self, values},
        random::Random,
    },
};
use skiagraph_gpu::{Executor, FaultKind, Frame, device::Gpu};
use skiagraph_passes::SceneProvider;
use std::collections::{BTreeMap, HashMap};

const VIEWPORT: [u32; 2] = [32, 20];
/// A buffer that grows, maps that are kept while nothing moves, hierarchies that are fitted.
const PRESETS: [&str; 5] = ["light_buffer", "crsm", "nsm", "rt", "hybrid_pcf"];
const FRAMES: usize = 500;
/// Moments in which the scene is shown.
const TIMES: usize = 4;

/// Ways in which commands end.
#[derive(Clone, Copy, Debug, PartialEq)]
enum End {
    Submitted,
    Dropped,
    FinishRefused,
    SubmitRefused,
}

/// A frame that was encoded.
struct Encoded {
    time: usize,
    is_read: bool,
    /// True if everything that happened to the frames before it was known.
    is_right: bool,
    end: Option<End>,
}

/// A host with a moving scene, and one executor.
struct Host<'g> {
    gpu: &'g Gpu,
    provider: SceneProvider,
    executor: Executor,
    frames: BTreeMap<u32, Encoded>,
    /// Commands that are submitted or lost later.
    held: Vec<(u32, wgpu::CommandEncoder)>,
    newest_submitted: Option<u32>,
    /// True if frames ran in another order, and the GPU may not be done with them.
    is_unknown: bool,
    faults: BTreeMap<u32, FaultKind>,
}

fn set(provider: &mut SceneProvider, time: usize) {
    let time = time as f64;
    provider.set_camera(&view(time).camera(VIEWPORT));
    provider.set_transforms(&places(time)).unwrap();
}

fn start(gpu: &Gpu, preset: &str, provider: &mut SceneProvider) -> Executor {
    let path = format!("pipelines/{preset}.ron");
    let plan = graphs::plan(&path, provider, VIEWPORT, |_| {});
    Executor::on(gpu, plan, provider).unwrap()
}

/// The picture of a scene that was made for this time.
fn fresh(gpu: &Gpu, preset: &str, time: usize) -> Vec<u32> {
    let mut provider = SceneProvider::from_parts(parts(), sun());
    set(&mut provider, time);
    let mut executor = start(gpu, preset, &mut provider);
    // A buffer that grows may have no room in the first frame.
    graphs::frame(gpu, &mut executor, &["visibility"]);
    values(
        &graphs::frame(gpu, &mut executor, &["visibility"]),
        "visibility",
    )
}

impl<'g> Host<'g> {
    fn new(gpu: &'g Gpu, preset: &str, mut provider: SceneProvider) -> Self {
        Self {
            executor: start(gpu, preset, &mut provider),
            gpu,
            provider,
            frames: BTreeMap::new(),
            held: Vec::new(),
            newest_submitted: None,
            is_unknown: false,
            faults: BTreeMap::new(),
        }
    }

    fn encode(&mut self, time: usize, is_read: bool) -> (u32, wgpu::CommandEncoder) {
        self.executor.refresh(&mut self.provider).unwrap();
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let read: &[&str] = if is_read { &["visibility"] } else { &[] };
        let frame = Frame::new().with_read(read);
        let index = self.executor.encode(&mut encoder, &frame).unwrap();
        let encoded = Encoded {
            time,
            is_read,
            is_right: self.held.is_empty() && !self.is_unknown,
            end: None,
        };
        self.frames.insert(index, encoded);
        (index, encoder)
    }

    fn end(&mut self, (index, mut encoder): (u32, wgpu::CommandEncoder), end: End) {
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let buffer = || {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: 4,
                usage: wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let refusal = device.push_error_scope(wgpu::ErrorFilter::Validation);
        match end {
            End::Submitted => drop(queue.submit([encoder.finish()])),
            End::Dropped => drop(encoder),
            End::FinishRefused => {
                encoder.copy_buffer_to_buffer(&buffer(), 0, &buffer(), 0, 4);
                queue.submit([encoder.finish()]);
            }
            End::SubmitRefused => {
                let cleared = buffer();
                encoder.clear_buffer(&cleared, 0, None);
                let commands = encoder.finish();
                cleared.destroy();
                queue.submit([commands]);
            }
        }
        let is_refused = pollster::block_on(refusal.pop()).is_some();
        assert_eq!(
            is_refused,
            matches!(end, End::FinishRefused | End::SubmitRefused)
        );
        let frame = self.frames.get_mut(&index).unwrap();
        frame.end = Some(end);
        if end == End::Submitted {
            if self.newest_submitted > Some(index) {
                frame.is_right = false;
                self.is_unknown = true;
            }
            self.newest_submitted = self.newest_submitted.max(Some(index));
        }
    }

    fn wait(&mut self) {
        let wait = wgpu::PollType::wait_indefinitely();
        self.gpu.device.poll(wait).unwrap();
        self.is_unknown &= !self.held.is_empty();
    }

    fn ask(&mut self) {
        let faults = self.executor.take_faults().unwrap();
        let faults = faults.iter().map(|fault| (fault.index, fault.kind));
        self.faults.extend(faults);
    }

    /// Submits what is held, and looks at all frames. Returns how many must be right, and how many
    /// were stale, with the scene.
    fn check(mut self, expected: &[Vec<u32>], preset: &str) -> ([usize; 2], SceneProvider) {
        for held in std::mem::take(&mut self.held) {
            self.end(held, End::Submitted);
        }
        self.wait();
        self.ask();
        let mut reports = HashMap::new();
        while let Some(report) = self.executor.poll().unwrap() {
            reports.insert(report.index, report);
        }
        let (mut right, mut stale) = (0, 0);
        for (index, frame) in &self.frames {
            let fault = self.faults.get(index).copied();
            let what = format!("{preset}, frame {index}, {:?}", frame.end);
            if frame.end != Some(End::Submitted) {
                let is_told = fault == Some(FaultKind::NeverRan);
                assert!(
                    is_told || fault.is_none() && !frame.is_read,
                    "{what}: {fault:?}"
                );
                assert!(!reports.contains_key(index), "{what}");
                continue;
            }
            assert!(!(frame.is_right && fault.is_some()), "{what}: {fault:?}");
            right += usize::from(frame.is_right);
            if frame.is_read {
                let report = &reports[index];
                assert_eq!(report.fault, fault, "{what}");
                let seen = values(report, "visibility");
                if fault.is_none() {
                    same(&seen, &expected[frame.time], &what);
                }
                stale += usize::from(seen != expected[frame.time]);
            }
        }
        ([right, stale], self.provider)
    }
}

#[test]
fn frames_that_never_ran_leave_nothing_stale() {
    // A thread of another test that polls the same device may be about to tell of a loss.
    let gpu = of_own_instance();
    let [beside, elsewhere] = others(&gpu);
    let devices = [&gpu, &beside, &elsewhere];
    let [mut stales, mut moves] = [0; 2];
    for (number, preset) in PRESETS.into_iter().enumerate() {
        let expected: Vec<_> = (0..TIMES).map(|time| fresh(&gpu, preset, time)).collect();
        assert_ne!(expected[0], expected[1], "{preset}: what moves is seen");
        let mut random = Random(number as u64);
        let mut pick = |count: usize| (random.unit() * count as f32) as usize;
        let mut provider = SceneProvider::from_parts(parts(), sun());
        set(&mut provider, 0);
        let mut host = Host::new(&gpu, preset, provider);
        let (mut time, mut rights) = (0, 0);
        for _ in 0..FRAMES / PRESETS.len() {
            if pick(2) == 0 {
                time = pick(TIMES);
                set(&mut host.provider, time);
            }
            if pick(25) == 0 {
                let ([right, stale], mut provider) = host.check(&expected, preset);
                (rights, stales, moves) = (rights + right, stales + stale, moves + 1);
                let device = devices[pick(devices.len())];
                provider.move_to(&device.device);
                host = Host::new(device, preset, provider);
            }
            let encoded = host.encode(time, pick(3) > 0);
            match pick(20) {
                0..10 => host.end(encoded, End::Submitted),
                10..12 => host.end(encoded, End::Dropped),
                12..14 => host.end(encoded, End::FinishRefused),
                14..16 => host.end(encoded, End::SubmitRefused),
                _ => host.held.push(encoded),
            }
            while !host.held.is_empty() && pick(3) == 0 {
                let held = host.held.swap_remove(pick(host.held.len()));
                let end = [End::Submitted, End::Submitted, End::Dropped][pick(3)];
                host.end(held, end);
            }
            match pick(4) {
                0 => host.wait(),
                1 => host.ask(),
                _ => {}
            }
        }
        let ([right, stale], _) = host.check(&expected, preset);
        (rights, stales) = (rights + right, stales + stale);
        assert!(
            rights > FRAMES / PRESETS.len() / 8,
            "{preset}: only {rights}"
        );
    }
    assert!(
        moves > PRESETS.len(),
        "the device changed only {moves} times"
    );
    assert!(
        stales > 0,
        "no frame was stale, so none need have been told"
    );
}
