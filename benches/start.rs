//! Measures starts of executors: alone, with the pipelines of another one, and with the data of
//! wgpu's pipeline cache. Each way has a device of its own in each turn, so that no driver finds
//! compiled shaders of the turn before in the device; what it keeps on disk stays (Mesa's:
//! `MESA_SHADER_CACHE_DISABLE=true` turns it off).
//!
//! A start ends when the first frame is done, since some drivers compile when they first draw.

use skiagraph_benches::{median, open_quietly, planned};
use skiagraph_gpu::device::{Gpu, Wanted};
use skiagraph_gpu::{Executor, Frame, Pipelines};
use skiagraph_graph::{Plan, PlanRequest};
use skiagraph_passes::{EmbeddedSources, SceneProvider, registry};
use skiagraph_scene::{DirectionalLight, Indexed};
use std::time::Instant;

const PRESETS: [&str; 3] = ["light_buffer", "crsm", "rt"];
const VIEWPORT: [u32; 2] = [64, 64];
const TURNS: usize = 5;

/// Milliseconds for an executor, and from there to the end of its first frame.
type Times = [f64; 2];

fn main() {
    println!("ms for an executor + for its first frame; medians of {TURNS} turns");
    println!("preset | alone | beside another one | empty cache | its data | bytes of data");
    for preset in PRESETS {
        let mut turns: Vec<[Times; 4]> = Vec::new();
        let mut bytes = 0;
        for _ in 0..TURNS {
            let Some((turn, data)) = turn(preset) else {
                return;
            };
            bytes = data.len();
            turns.push(turn);
        }
        let cell = |way: usize| {
            let time = |part: usize| median(turns.iter().map(|turn| turn[way][part]));
            format!("{:.0} + {:.0}", time(0), time(1))
        };
        let cells: Vec<String> = (0..4).map(cell).collect();
        println!("{preset} | {} | {bytes}", cells.join(" | "));
    }
}

/// One turn of each way; `None` without an adapter.
fn turn(preset: &str) -> Option<([Times; 4], Vec<u8>)> {
    let gpu = open()?;
    let (mut provider, plan) = scene(&gpu, preset);
    let shared = Pipelines::new(&gpu.device);
    let alone = start(&gpu, &shared, plan, &mut provider);
    // Its scene is uploaded already, as that of the first view is in a host.
    let (_, plan) = scene(&gpu, preset);
    let beside = start(&gpu, &shared, plan, &mut provider);
    let mut data = None;
    let caches = [(); 2].map(|()| {
        let gpu = open().expect("it was there a moment ago");
        let (mut provider, plan) = scene(&gpu, preset);
        let cache = cache_of(&gpu, data.as_deref());
        let pipelines = Pipelines::with_cache(&gpu.device, cache);
        let times = start(&gpu, &pipelines, plan, &mut provider);
        data = pipelines.cache().and_then(wgpu::PipelineCache::get_data);
        times
    });
    let [cold, warm] = caches;
    Some(([alone, beside, cold, warm], data.unwrap_or_default()))
}

fn open() -> Option<Gpu> {
    open_quietly(&Wanted::default().with_features(wgpu::Features::PIPELINE_CACHE))
}

fn cache_of(gpu: &Gpu, data: Option<&[u8]>) -> wgpu::PipelineCache {
    #[expect(unsafe_code, reason = "wgpu has the host vouch for the data")]
    // SAFETY: the data are those that `get_data` has just given.
    unsafe {
        let device = &gpu.device;
        device.create_pipeline_cache(&wgpu::PipelineCacheDescriptor {
            label: None,
            data,
            fallback: true,
        })
    }
}

/// A roof above a floor, and a preset's plan for it.
fn scene(gpu: &Gpu, preset: &str) -> (SceneProvider, Plan) {
    let square = |half: f32, y: f32| {
        [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]].map(|[x, z]| [x * half, y, z * half])
    };
    let mesh = Indexed {
        positions: &[square(4.0, 0.0), square(1.0, 1.5)].concat(),
        normals: &[],
        indices: &[0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7],
    };
    let mesh = mesh.mesh().expect("the squares are a mesh");
    let sun = DirectionalLight::new(glam::DVec3::new(0.6, -1.0, 0.3));
    let mut provider = SceneProvider::from_mesh(mesh, sun);
    let view = skiagraph_scene::View {
        name: String::new(),
        eye: glam::DVec3::new(0.0, 6.0, 7.0),
        direction: glam::DVec3::new(0.0, -6.0, -7.0),
        far: 50.0,
        ..skiagraph_scene::View::default()
    };
    provider.set_camera(&view.camera(VIEWPORT));
    let request = PlanRequest::new(VIEWPORT, &provider);
    let request = request.with_device(gpu.device.limits(), gpu.device.features());
    let path = format!("pipelines/{preset}.ron");
    let plan = planned(&path, (&registry(), &EmbeddedSources), &request);
    (provider, plan)
}

fn start(gpu: &Gpu, pipelines: &Pipelines, plan: Plan, provider: &mut SceneProvider) -> Times {
    let begin = Instant::now();
    let executor = Executor::with_pipelines(pipelines, &gpu.queue, plan, provider);
    let mut executor = executor.unwrap_or_else(|error| panic!("{error}"));
    let made = begin.elapsed();
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let done = executor.encode(&mut encoder, &Frame::default());
    done.unwrap_or_else(|error| panic!("{error}"));
    gpu.queue.submit([encoder.finish()]);
    executor.finish().unwrap_or_else(|error| panic!("{error}"));
    [made, begin.elapsed() - made].map(|time| time.as_secs_f64() * 1e3)
}
