//! CPU time and allocations of an engine's frame: 300 meshes of 173,400 triangles, of which none,
//! or five, move in each frame, or only the camera; and where nothing moves, but all passes are
//! encoded. Setting the transforms, `refresh`, `encode` and finishing the encoder is measured;
//! submission and the GPU's work are not: each frame is submitted and waited for outside the clock,
//! so that the CPU is the frame's own. Beside it a frame by hand, in plain wgpu, of as many
//! dispatches. At the end the same of the fifty lines of docs/embedding.md, which know no more than
//! where everything is, and of four lights in two views. Words on the command line choose the lines
//! to measure: `cargo bench --bench host_frame -- light_buffer camera`.

use glam::{DAffine3, DVec3};
use skiagraph_benches::chain::{self, ByHand};
use skiagraph_benches::{open, planned};
use skiagraph_gpu::device::{self, Gpu};
use skiagraph_gpu::{Executor, Frame};
use skiagraph_graph::step::Step;
use skiagraph_graph::{ParamValue, PlanRequest};
use skiagraph_passes::{EmbeddedSources, PartMesh, Room, SceneProvider, SceneView, Work, registry};
use skiagraph_scene::{DirectionalLight, Indexed, Mesh, Movable, View};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::time::{Duration, Instant};

#[path = "../crates/passes/examples/preset/shadows.rs"]
#[allow(missing_docs, reason = "a program's, not a library's")]
mod shadows;

/// Counts the allocations of each thread.
struct Counting;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

#[expect(unsafe_code, reason = "a global allocator is unsafe by its signature")]
// SAFETY: everything is handed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // None is counted where the thread is at its end.
        let _ = ALLOCATIONS.try_with(|count| count.set(count.get() + 1));
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        unsafe { System.dealloc(place, layout) }
    }
}

const MESHES: usize = 300;
/// Meshes that there is room for besides.
const ROOM: usize = 20;
/// Parts that move in each frame.
const MOVING: usize = 5;

/// A kind of frames.
#[derive(Clone, Copy)]
struct Kind {
    name: &'static str,
    /// Number of the parts that move.
    moving: usize,
    /// True if the camera moves.
    camera: bool,
    /// True if all passes are encoded, whether or not something has changed.
    all: bool,
}

const NOTHING: Kind = Kind {
    name: "nothing moves",
    moving: 0,
    camera: false,
    all: false,
};
const FIVE: Kind = Kind {
    name: "five move",
    moving: MOVING,
    ..NOTHING
};
const ALL_PASSES: Kind = Kind {
    name: "nothing moves, all passes",
    all: true,
    ..NOTHING
};
const KINDS: [Kind; 4] = [
    NOTHING,
    ALL_PASSES,
    Kind {
        name: "the camera moves",
        camera: true,
        ..NOTHING
    },
    FIVE,
];

/// Presets, with the engine of their rays if it is not `hierarchy`.
const METHODS: [(&str, Option<&str>); 4] = [
    ("light_buffer", None),
    ("rt", None),
    ("rt", Some("light_space")),
    ("rt", Some("ray_query")),
];
const RAY_QUERY: wgpu::Features = wgpu::Features::EXPERIMENTAL_RAY_QUERY;
/// Small: the CPU's work does not depend on it.
const VIEWPORT: [u32; 2] = [32, 32];
/// Triangles of a stone: 578, in rings of 17 between two poles.
const RINGS: u32 = 17;
const SIDES: u32 = 17;

fn main() {
    // `cargo bench` says `--bench`; without it the frames are only tried.
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let measured = arguments.iter().any(|argument| argument == "--bench");
    let (frames, added) = if measured { (1000, ROOM) } else { (3, 1) };
    let words: Vec<&String> = arguments.iter().filter(|it| !it.starts_with('-')).collect();
    let is_asked = |line: &str| words.iter().all(|word| line.contains(word.as_str()));
    let wanted = device::Wanted::default().with_features(RAY_QUERY);
    let unit = format!("; ms of CPU, median and 99th percentile of {frames} frames");
    let Some(gpu) = open(&wanted, &unit) else {
        return;
    };
    let stone = stone();
    println!(
        "{MESHES} meshes, {} triangles, {MOVING} of them move",
        MESHES * stone.triangles.len()
    );
    for (preset, engine) in METHODS {
        let method = (preset, engine);
        let words = engine.map(|engine| format!("@engine={engine}"));
        let preset = &*format!("{preset}{}", words.unwrap_or_default());
        if engine == Some("ray_query") && !gpu.device.features().contains(RAY_QUERY) {
            println!("{preset} IS NOT MEASURED: this adapter has no EXPERIMENTAL_RAY_QUERY");
            continue;
        }
        let of_method = |kind: &Kind| is_asked(&format!("{preset}, {}", kind.name));
        let kinds: Vec<Kind> = KINDS.into_iter().filter(of_method).collect();
        if kinds.is_empty() {
            continue;
        }
        let mut host = Host::new(&gpu, method, &stone);
        // The first frames make what later ones have.
        for turn in 0..3 {
            host.frame(turn, FIVE);
        }
        for kind in kinds {
            let mut works = Vec::new();
            let frame = |turn| {
                let before = host.provider.work();
                let times = host.frame(turn, kind);
                works.push(host.provider.work().since(before));
                times
            };
            let times: Vec<Times> = (0..frames).map(frame).collect();
            print(preset, kind.name, &times);
            print_work(&works);
            host.print_built(kind);
        }
        host.print_by_hand(frames);
        let mut times: Vec<f64> = (0..added).map(|_| host.add(&stone)).collect();
        times.sort_by(f64::total_cmp);
        let [median, most] = [times.len() / 2, times.len() - 1].map(|at| times[at]);
        println!("{preset}, one mesh more: {median:.2}, {most:.2} at most");
        let level = PartMesh::new(&stone).map(PartMesh::with_hierarchy);
        let level = level.expect("its numbers are finite");
        let swaps: Vec<[f64; 2]> = (0..frames).map(|turn| host.swap(&level, turn)).collect();
        let [set, refresh] = [0, 1].map(|at| quantiles(swaps.iter().map(|times| times[at])));
        println!("{preset}, another level of detail: replace_part {set}, refresh {refresh}");
    }
    if is_asked("the fifty lines") {
        fifty_lines(&gpu, &stone, frames);
    }
    if is_asked("four lights in two views") {
        views(&gpu, &stone, frames);
    }
}

/// Prints the times of four suns in two views of one scene, whose cameras move: `light_buffer` for
/// each of the eight, in one encoder.
fn views(gpu: &Gpu, stone: &Mesh, frames: usize) {
    let mut host = Host::new(gpu, ("light_buffer", None), stone);
    let suns = [0.4, -0.2, 0.1, 0.7].map(|x| DirectionalLight::new(DVec3::new(x, -1.0, -0.3)));
    let camera = |turn: usize, number: usize| view(turn + 7 * number).camera(VIEWPORT);
    let numbers = (0..2).flat_map(|number| suns.map(|sun| (number, sun)));
    let mut views: Vec<(usize, SceneView, Executor)> = Vec::new();
    for (number, sun) in numbers {
        let seen = SceneView::from_camera(&camera(0, number), sun);
        let request = PlanRequest::new(seen.size(), seen.apply(&mut host.provider));
        let request = request.with_device(gpu.device.limits(), gpu.device.features());
        let on = (&registry(), &EmbeddedSources as _);
        let plan = planned("pipelines/light_buffer.ron", on, &request);
        let executor = Executor::on(gpu, plan, &mut host.provider);
        views.push((
            number,
            seen,
            executor.expect("the preset suits every device"),
        ));
    }
    let mut frame = |turn: usize| {
        let clock = Clock::start();
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        for (number, seen, executor) in &mut views {
            seen.set_camera(&camera(turn, *number));
            let refreshed = seen.refresh(executor, &mut host.provider);
            refreshed.expect("the same resources are built again");
            let encoded = executor.encode(&mut encoder, &Frame::default());
            encoded.expect("the frame was encoded before");
        }
        let commands = encoder.finish();
        let spent = clock.spent();
        submit(gpu, commands);
        spent
    };
    for turn in 0..3 {
        frame(turn);
    }
    let spent: Vec<Spent> = (3..frames + 3).map(frame).collect();
    println!("four lights in two views, the cameras move: {}", of(&spent));
}

/// Time and allocations of a stretch of work on this thread.
#[derive(Clone, Copy)]
struct Spent {
    ms: f64,
    allocations: u64,
}

/// The begin of such a stretch.
struct Clock(Instant, u64);

impl Clock {
    fn start() -> Self {
        Self(Instant::now(), ALLOCATIONS.get())
    }

    fn spent(&self) -> Spent {
        Spent {
            ms: since(self.0),
            allocations: ALLOCATIONS.get() - self.1,
        }
    }
}

/// Milliseconds, median and 99th percentile, and the median number of allocations.
fn of(spent: &[Spent]) -> String {
    let mut allocations: Vec<u64> = spent.iter().map(|spent| spent.allocations).collect();
    allocations.sort_unstable();
    let times = quantiles(spent.iter().map(|spent| spent.ms));
    format!(
        "{times}, {} allocations",
        allocations[allocations.len() / 2]
    )
}

/// Prints the times of the program of docs/embedding.md.
fn fifty_lines(gpu: &Gpu, stone: &Mesh, frames: usize) {
    let (meshes, on) = (vec![stone; MESHES], (&gpu.device, &gpu.queue));
    let mut program =
        shadows::Shadows::new(on, VIEWPORT, &meshes).expect("the preset runs anywhere");
    let mut places: Vec<DAffine3> = (0..MESHES).map(|index| place(index, 0)).collect();
    let mut frame = |turn: usize, kind: Kind| {
        for (index, map) in places[..kind.moving].iter_mut().enumerate() {
            *map = place(index, turn + 1);
        }
        let clock = Clock::start();
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let light = DVec3::new(0.4, -1.0, -0.3);
        let turn = if kind.camera { turn } else { 0 };
        let seen = program.frame(&mut encoder, &view(turn).camera(VIEWPORT), light, &places);
        seen.expect("the frame was encoded before");
        let commands = encoder.finish();
        let spent = clock.spent();
        submit(gpu, commands);
        spent
    };
    for turn in 0..3 {
        frame(turn, FIVE);
    }
    // Those lines have no say in which passes are encoded.
    for kind in KINDS.into_iter().filter(|kind| !kind.all) {
        let spent: Vec<Spent> = (0..frames).map(|turn| frame(turn, kind)).collect();
        println!("the fifty lines, {}: {}", kind.name, of(&spent));
    }
}

/// A view that moves a little in each turn.
fn view(turn: usize) -> View {
    let aside = (0.1 * turn as f64).sin();
    View {
        name: String::new(),
        eye: DVec3::new(30.0 + aside, 20.0, 90.0),
        direction: DVec3::new(0.0, -0.4, -1.0),
        fov_y_degrees: 50.0,
        far: 300.0,
        ..View::default()
    }
}

/// Times of a frame's steps, in milliseconds.
#[derive(Clone, Copy)]
struct Times {
    whole: Spent,
    set: f64,
    refresh: f64,
    encode: f64,
    /// The encoder's `finish`, which is wgpu's alone.
    finish: f64,
    /// The GPU's work and the submission, for which the frame waits.
    rest: f64,
}

/// Median and 99th percentile of times.
fn quantiles(times: impl Iterator<Item = f64>) -> String {
    let mut times: Vec<f64> = times.collect();
    times.sort_by(f64::total_cmp);
    let [median, most] =
        [0.5, 0.99].map(|share| times[((times.len() - 1) as f64 * share) as usize]);
    format!("{median:.3} ({most:.3})")
}

fn print(preset: &str, what: &str, times: &[Times]) {
    let both = |time: fn(&Times) -> f64| quantiles(times.iter().map(time));
    let whole: Vec<Spent> = times.iter().map(|times| times.whole).collect();
    println!(
        "{preset}, {what}: {}; set_transforms {}, refresh {}, encode {}, wgpu's finish {}; beside \
         it submitted and waited {}",
        of(&whole),
        both(|times| times.set),
        both(|times| times.refresh),
        both(|times| times.encode),
        both(|times| times.finish),
        both(|times| times.rest),
    );
}

/// Prints the work by counters: the median frame's, and the most of one frame.
fn print_work(works: &[Work]) {
    let both = |counter: fn(&Work) -> u64| {
        let mut values: Vec<u64> = works.iter().map(counter).collect();
        values.sort_unstable();
        let [median, most] = [values.len() / 2, values.len() - 1].map(|at| values[at]);
        format!("{median} ({most})")
    };
    println!(
        "  bytes uploaded {}, copied on the GPU {}; nodes {}, triangles {}; positions moved {}, \
         laid around {}",
        both(|work| work.uploaded),
        both(|work| work.copied),
        both(|work| work.nodes),
        both(|work| work.triangles),
        both(|work| work.moved),
        both(|work| work.laid),
    );
}

fn since(start: Instant) -> f64 {
    Duration::as_secs_f64(&start.elapsed()) * 1e3
}

/// Submits commands and waits for them; how long that took, in milliseconds.
fn submit(gpu: &Gpu, commands: wgpu::CommandBuffer) -> f64 {
    let start = Instant::now();
    gpu.queue.submit([commands]);
    let waited = gpu.device.poll(wgpu::PollType::wait_indefinitely());
    waited.expect("the GPU is there");
    since(start)
}

/// An engine with a scene of stones.
struct Host<'a> {
    gpu: &'a Gpu,
    provider: SceneProvider,
    executor: Executor,
    places: Vec<DAffine3>,
}

impl<'a> Host<'a> {
    fn new(gpu: &'a Gpu, (preset, engine): (&str, Option<&str>), stone: &Mesh) -> Self {
        let stones = Movable::joined(&vec![stone; MESHES]);
        let light = DirectionalLight::new(DVec3::new(0.4, -1.0, -0.3));
        let mut provider = SceneProvider::from_parts(stones, light);
        provider
            .reserve(Room::of_copies(stone, ROOM), &gpu.device.limits())
            .expect("the mesh has parts, and the device room for them");
        provider.set_camera(&view(0).camera(VIEWPORT));
        let places: Vec<DAffine3> = (0..MESHES).map(|index| place(index, 0)).collect();
        let placed = provider.set_transforms(&places);
        placed.expect("the maps are plain shifts");
        let path = format!("pipelines/{preset}.ron");
        let request = PlanRequest::new(VIEWPORT, &provider);
        let mut request = request.with_device(gpu.device.limits(), gpu.device.features());
        if let Some(engine) = engine {
            let engine = ParamValue::Choice(engine.to_owned());
            request.params.insert("engine".to_owned(), engine);
        }
        let plan = planned(&path, (&registry(), &EmbeddedSources), &request);
        let executor = Executor::on(gpu, plan, &mut provider);
        Self {
            gpu,
            provider,
            executor: executor.expect("the preset suits every device"),
            places,
        }
    }

    /// Runs a frame.
    fn frame(&mut self, turn: usize, kind: Kind) -> Times {
        for (index, map) in self.places[..kind.moving].iter_mut().enumerate() {
            *map = place(index, turn + 1);
        }
        let clock = Clock::start();
        let descriptor = wgpu::CommandEncoderDescriptor::default();
        let mut encoder = self.gpu.device.create_command_encoder(&descriptor);
        let start = Instant::now();
        if kind.camera {
            self.provider.set_camera(&view(turn).camera(VIEWPORT));
        }
        let placed = self.provider.set_transforms(&self.places);
        placed.expect("the maps are turns and shifts");
        let set = since(start);
        let start = Instant::now();
        self.refresh(&mut encoder);
        let refresh = since(start);
        let start = Instant::now();
        let frame = Frame::new().with_all(kind.all);
        let encoded = self.executor.encode(&mut encoder, &frame);
        encoded.expect("the frame was encoded before");
        let encode = since(start);
        let start = Instant::now();
        let commands = encoder.finish();
        let finish = since(start);
        Times {
            whole: clock.spent(),
            set,
            refresh,
            encode,
            finish,
            rest: submit(self.gpu, commands),
        }
    }

    /// Prints the times of a frame by hand, of as many compute passes as the plan has dispatches,
    /// between frames in which nothing moves and all is encoded.
    fn print_by_hand(&mut self, frames: usize) {
        let steps = self.executor.plan().live().flat_map(|pass| &pass.steps);
        let dispatches = steps
            .filter(|step| matches!(step, Step::Dispatch(_)))
            .count();
        let by_hand = ByHand::new(self.gpu, chain::Kind::Dispatch, dispatches);
        let mut times = Vec::new();
        for turn in 0..frames {
            self.frame(turn, ALL_PASSES);
            let clock = Clock::start();
            let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
            by_hand.encode(&mut encoder, false);
            let commands = encoder.finish();
            times.push(clock.spent());
            submit(self.gpu, commands);
        }
        println!("{dispatches} dispatches by hand: {}", of(&times));
    }

    /// Prints what one more frame builds, and how long each takes.
    fn print_built(&mut self, kind: Kind) {
        let before: Vec<_> = self.provider.built().to_vec();
        self.frame(1000, kind);
        let times = |name: &str| before.iter().find(|it| it.name == name).map(|it| it.times);
        let built = self.provider.built().iter();
        let made = built.filter(|built| times(built.name) != Some(built.times));
        let made = made.map(|it| format!("{} {:.3}", it.name, it.time.as_secs_f64() * 1e3));
        let made: Vec<String> = made.collect();
        if !made.is_empty() {
            println!("  of refresh, one frame: {}", made.join(", "));
        }
    }

    /// Adds a mesh to the scene; how long that took, in milliseconds.
    fn add(&mut self, stone: &Mesh) -> f64 {
        let map = place(self.places.len(), 0);
        let start = Instant::now();
        self.places.push(map);
        let added = self.provider.add_part(stone, &map);
        added.expect("the map is a shift");
        let refreshed = self.executor.refresh(&mut self.provider);
        refreshed.expect("there is room for it");
        let time = since(start);
        self.frame(0, NOTHING);
        time
    }

    fn refresh(&mut self, encoder: &mut wgpu::CommandEncoder) {
        let provider = self.provider.in_encoder(encoder);
        let mut provider = provider.expect("the device is there");
        let refreshed = self.executor.refresh(&mut provider);
        refreshed.expect("the plan stays valid");
    }

    /// Replaces the mesh of a part by another level of detail, of as many triangles; the times of
    /// the call and of the refresh.
    fn swap(&mut self, level: &PartMesh, turn: usize) -> [f64; 2] {
        let number = turn % self.places.len();
        let part = self.provider.parts().nth(number);
        let part = part.expect("there are as many parts as places");
        let start = Instant::now();
        let replaced = self
            .provider
            .replace_part(part, level, &self.places[number]);
        replaced.expect("the map is a shift");
        let set = since(start);
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let start = Instant::now();
        self.refresh(&mut encoder);
        let refresh = since(start);
        submit(self.gpu, encoder.finish());
        [set, refresh]
    }
}

/// The place of a part in rows, where it turns and goes up and down.
fn place(index: usize, turn: usize) -> DAffine3 {
    let at = DVec3::new((index % 20) as f64, 0.0, (index / 20) as f64) * 3.0;
    let angle = 0.1 * turn as f64;
    DAffine3::from_translation(at + DVec3::Y * angle.sin()) * DAffine3::from_rotation_y(angle)
}

/// A sphere of radius 1 with dents.
fn stone() -> Mesh {
    let mut positions = vec![[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]];
    for ring in 0..RINGS {
        for side in 0..SIDES {
            let down = (ring + 1) as f32 / (RINGS + 1) as f32 * std::f32::consts::PI;
            let round = side as f32 / SIDES as f32 * std::f32::consts::TAU;
            let radius = 1.0 - 0.1 * (5.0 * round).sin() * (4.0 * down).sin();
            let [x, z] = [round.cos(), round.sin()].map(|along| along * down.sin());
            positions.push([x, down.cos(), z].map(|along| along * radius));
        }
    }
    let at = |ring: u32, side: u32| 2 + ring * SIDES + side % SIDES;
    let mut indices = Vec::new();
    for side in 0..SIDES {
        indices.extend([0, at(0, side + 1), at(0, side)]);
        indices.extend([1, at(RINGS - 1, side), at(RINGS - 1, side + 1)]);
        for ring in 1..RINGS {
            let [a, b] = [at(ring - 1, side), at(ring - 1, side + 1)];
            let [c, d] = [at(ring, side), at(ring, side + 1)];
            indices.extend([a, b, c, b, d, c]);
        }
    }
    // As engines have them: smooth, one for each position.
    let stone = Indexed {
        positions: &positions,
        normals: &positions,
        indices: &indices,
    };
    stone.mesh().expect("its numbers are finite")
}
