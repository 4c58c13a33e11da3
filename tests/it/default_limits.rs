//! The presets on a device with the limits that WebGPU promises, and without any feature.

use crate::{
    one_submission::{sun, view},
    support::{
        graphs::{open, run_on, shares},
        meshes,
    },
};
use skiagraph_gpu::{Pipelines, device::Gpu};
use skiagraph_graph::{Diagnostics, Graph, Plan, PlanRequest, step::Step};
use skiagraph_passes::{EmbeddedSources, SceneProvider, presets, registry};

const VIEWPORT: [u32; 2] = [48, 32];

/// Presets that do not run there, each with the feature that it asks for.
const OTHERS: [(&str, &str); 1] = [("crsm_hw", "CONSERVATIVE_RASTERIZATION")];

/// Masks are the buffers that passes bind besides all others.
fn provider() -> SceneProvider {
    let mut provider = SceneProvider::from_mesh(meshes::foliage(40, 0.4, 4.0, 3), sun());
    provider.set_camera(&view(0.0).camera(VIEWPORT));
    provider
}

fn planned(path: &str, provider: &SceneProvider) -> Result<Plan, Diagnostics> {
    let graph = Graph::load(path, &registry(), &EmbeddedSources)?;
    graph.plan(&PlanRequest::new(VIEWPORT, provider))
}

/// A device of the same adapter with WebGPU's default limits and no features.
fn modest() -> Gpu {
    let mut gpu = open();
    let request = gpu.adapter.request_device(&wgpu::DeviceDescriptor {
        required_limits: wgpu::Limits::default(),
        ..Default::default()
    });
    let (device, queue) = pollster::block_on(request).expect("WebGPU's limits are the least");
    gpu.pipelines = Pipelines::new(&device);
    (gpu.device, gpu.queue) = (device, queue);
    gpu
}

/// The most storage buffers that a pass of a plan binds.
fn storage_buffers(plan: &Plan) -> usize {
    let programs = plan.live().flat_map(|pass| &pass.steps);
    let programs = programs.filter_map(|step| match step {
        Step::Draw(draw) => Some(&draw.program),
        Step::Dispatch(dispatch) => Some(&dispatch.program),
        _ => None,
    });
    let is_storage = |ty: &wgpu::BindingType| {
        let is = |ty: &wgpu::BufferBindingType| !matches!(ty, wgpu::BufferBindingType::Uniform);
        matches!(ty, wgpu::BindingType::Buffer { ty, .. } if is(ty))
    };
    let counts = programs.map(|program| {
        let bindings = program.bindings.iter();
        bindings.filter(|binding| is_storage(&binding.ty)).count()
    });
    counts.max().unwrap_or_default()
}

/// Every preset is planned for a scene with masks under a sun, and gives the picture that it gives
/// on a device with all limits of the adapter. Some pass binds as many storage buffers as a stage
/// may have there.
#[test]
fn every_preset_runs_at_the_default_limits() {
    let (wide, modest) = (open(), modest());
    assert_eq!(modest.device.features(), wgpu::Features::empty());
    let promised = wgpu::Limits::default().max_storage_buffers_per_shader_stage;
    assert_eq!(
        modest.device.limits().max_storage_buffers_per_shader_stage,
        promised
    );
    let mut most = 0;
    for preset in presets() {
        let other = OTHERS.iter().find(|(name, _)| *name == preset.name);
        let plan = match (planned(&preset.path, &provider()), other) {
            (Ok(plan), None) => plan,
            (Err(refused), Some((_, feature))) => {
                assert!(refused.to_string().contains(feature), "{refused}");
                continue;
            }
            (Err(refused), None) => panic!("{refused}"),
            (Ok(_), Some((name, _))) => panic!("{name} runs: it is no exception any more"),
        };
        most = most.max(storage_buffers(&plan));
        let [narrow, expected] = [&modest, &wide].map(|gpu| {
            let report = run_on(gpu, plan.clone(), &mut provider(), &["visibility"]);
            shares(&report, "visibility")
        });
        assert!(narrow == expected, "{}", preset.name);
        assert!(narrow.iter().any(|share| *share < 1.0), "{}", preset.name);
    }
    assert_eq!(most, promised as usize);
}
