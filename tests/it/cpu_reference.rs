//! The statuses of the hybrids' presets against their CPU references in f64: they agree on every
//! pixel that the CPU reference does not call indeterminate.

use crate::support::{
    graphs::{open, plan, provider, run_on, values},
    meshes,
    scenes::load,
};
use glam::{DVec3, Vec3};
use skiagraph_gpu::device::Gpu;
use skiagraph_graph::{Capture, ParamValue};
use skiagraph_passes::SceneProvider;
use skiagraph_reference::{Progress, statistics::status};
use skiagraph_scene::{Adjacency, DirectionalLight, Scene, View};
use skiagraph_tests::cpu_reference::{CpuReference, Cull, Depth, LightSpace, Method, SLACK};
use std::sync::Arc;

/// A scene under one view on one device.
struct Bench<'a> {
    scene: &'a Scene,
    viewport: [u32; 2],
    gpu: Gpu,
    provider: SceneProvider,
    adjacency: Adjacency,
}

/// Counts of the answers of a CPU reference and its preset, over the pixels that face the light.
#[derive(Debug, Default)]
struct Agreement {
    facing_light: usize,
    light: usize,
    shadow: usize,
    uncertain: usize,
    indeterminate: usize,
    /// Pixels that are not indeterminate and on which both disagree.
    disagree: usize,
}

impl Agreement {
    /// Share of the indeterminate ones among the pixels that face the light.
    fn indeterminate_share(&self) -> f64 {
        self.indeterminate as f64 / self.facing_light as f64
    }

    /// No determinate pixel disagrees, and few are indeterminate: more where a rasteriser snaps
    /// corners and draws triangles that are lower than its steps, as park's leaves are.
    fn check(&self, cpu: &CpuReference) {
        assert_eq!(self.disagree, 0, "{cpu:?}: {self:?}");
        let most = match cpu.method {
            Method::HybridPcf => 0.025,
            Method::Crsm | Method::Crsma | Method::CrsmaFull => 0.004,
        };
        assert!(self.indeterminate_share() < most, "{cpu:?}: {self:?}");
    }
}

impl<'a> Bench<'a> {
    fn new(scene: &'a Arc<Scene>, viewport: [u32; 2]) -> Self {
        Self {
            scene,
            viewport,
            gpu: open(),
            provider: provider(scene, &scene.views[0], viewport),
            adjacency: Adjacency::new(&scene.mesh),
        }
    }

    fn judge(&mut self, cpu: CpuReference) -> Agreement {
        let (preset, has_layers) = match cpu.method {
            Method::HybridPcf => ("hybrid_pcf", false),
            Method::Crsm => ("crsm", true),
            Method::Crsma => ("crsma", true),
            Method::CrsmaFull => ("crsma_full", true),
        };
        let choice = |word: &str| ParamValue::Choice(word.into());
        let cull = match cpu.cull {
            Cull::None => "none",
            Cull::Front => "front",
            Cull::Back => "back",
        };
        let depth = match cpu.depth {
            Depth::Plane => "plane",
            Depth::Conservative => "conservative",
        };
        let path = format!("pipelines/{preset}.ron");
        let plan = plan(&path, &self.provider, self.viewport, |request| {
            let mut set = |name: &str, value| request.params.insert(name.into(), value);
            set("map_size", ParamValue::U32(cpu.map_size));
            set("cull", choice(cull));
            if has_layers {
                set("depth", choice(depth));
                set("n", ParamValue::F32(cpu.n as f32));
            }
            request.captures.push(Capture::new("primitive"));
        });
        let report = run_on(
            &self.gpu,
            plan,
            &mut self.provider,
            &["status", "primitive"],
        );
        let primitives = values(&report, "primitive");
        let camera = self.scene.views[0].camera(self.viewport);
        let maps = cpu
            .maps(
                &self.scene.mesh,
                &self.adjacency,
                &self.scene.sun().unwrap(),
            )
            .unwrap();
        let expected = maps
            .classify(&camera, &primitives, Progress::default())
            .unwrap();

        let mut counts = Agreement::default();
        for (index, &answer) in values(&report, "status").iter().enumerate() {
            let (status, indeterminate) = (expected.status[index], expected.indeterminate[index]);
            if answer >= status::CERTAIN_LIGHT {
                counts.facing_light += 1;
                counts.indeterminate += usize::from(indeterminate);
            }
            match answer {
                status::CERTAIN_LIGHT => counts.light += 1,
                status::CERTAIN_SHADOW => counts.shadow += 1,
                status::UNCERTAIN => counts.uncertain += 1,
                _ => {}
            }
            if answer != status && !indeterminate {
                if counts.disagree < 3 {
                    println!("pixel {index}: {answer} instead of {status}");
                }
                counts.disagree += 1;
            }
        }
        println!(
            "{} {:?} {cpu:?}: {counts:?}, indeterminate {:.4}",
            self.scene.name,
            self.viewport,
            counts.indeterminate_share()
        );
        counts
    }
}

/// All methods and both depths.
fn all_methods(map_size: u32, cull: Cull, n: f64) -> Vec<CpuReference> {
    let cpu = |method, depth| CpuReference {
        method,
        map_size,
        cull,
        n,
        depth,
    };
    let layered = [Method::Crsm, Method::Crsma, Method::CrsmaFull]
        .map(|method| [Depth::Plane, Depth::Conservative].map(|depth| cpu(method, depth)));
    [cpu(Method::HybridPcf, Depth::Plane)]
        .into_iter()
        .chain(layered.into_iter().flatten())
        .collect()
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn the_statuses_on_park_are_the_cpu_references() {
    let scene = load("park");
    let mut bench = Bench::new(&scene, [128, 96]);
    for (map_size, n) in [(200, 1.0), (512, 0.51)] {
        for cpu in all_methods(map_size, Cull::Front, n) {
            bench.judge(cpu).check(&cpu);
        }
    }
}

/// A rough potato with some triangles turned over above a soup of needles above a floor, and a fan
/// that goes round twice: open, non-manifold, sub-texel and edge-on for the light.
fn hard() -> Arc<Scene> {
    let mut potato = meshes::potato(3, 0.3, 7);
    for triangle in potato.triangles.iter_mut().step_by(5) {
        triangle.swap(0, 1);
    }
    let soup = meshes::soup(60, 0.4, 3);
    let hub = Vec3::new(-2.2, 0.5, 1.5);
    let spoke = |i: u16| {
        let angle = 2.0 * std::f32::consts::TAU * f32::from(i) / 9.0;
        hub + Vec3::new(angle.cos(), 0.0, angle.sin()) * 0.7
    };
    let around = (0..9).map(|i| [0, 1 + (i + 1) % 9, 1 + i]);
    let fan = meshes::mesh(
        [hub].into_iter().chain((0..9).map(spoke)).collect(),
        around.collect(),
    );
    let mut positions = vec![];
    let mut triangles: Vec<[u32; 3]> = vec![];
    let mut add = |mesh: &skiagraph_scene::Mesh, scale: Vec3, up: f32| {
        let first = positions.len() as u32;
        positions.extend(mesh.positions.iter().map(|&p| p * scale + Vec3::Y * up));
        triangles.extend(mesh.triangles.iter().map(|t| t.map(|i| first + i)));
    };
    add(&potato, Vec3::splat(0.8), 2.6);
    add(&soup, Vec3::new(1.5, 0.4, 1.5), 1.0);
    add(&fan, Vec3::ONE, 0.0);
    let first = positions.len() as u32;
    let corners = [(-3.0, 3.0), (3.0, 3.0), (3.0, -3.0), (-3.0, -3.0)];
    positions.extend(corners.map(|(x, z)| Vec3::new(x, 0.0, z)));
    triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    let view = View {
        eye: DVec3::new(0.5, 4.0, 6.0),
        direction: DVec3::new(0.0, -0.5, -1.0),
        fov_y_degrees: 50.0,
        near: 0.5,
        far: 50.0,
        ..View::default()
    };
    Arc::new(Scene {
        name: "hard".into(),
        mesh: meshes::mesh(positions, triangles),
        views: vec![view],
        lights: vec![DirectionalLight::new(DVec3::new(-0.3, -1.0, 0.2)).into()],
    })
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn the_statuses_on_a_hard_mesh_are_the_cpu_references() {
    let scene = hard();
    let mut bench = Bench::new(&scene, [160, 120]);
    for (map_size, cull, n) in [
        (64, Cull::None, 1.0),
        (200, Cull::Front, 0.5),
        (200, Cull::Back, 1.7),
        (1500, Cull::Front, 1.0),
    ] {
        for cpu in all_methods(map_size, cull, n) {
            bench.judge(cpu).check(&cpu);
        }
    }
}

/// Beyond that `light_space_error_bound` leaves every pixel uncertain.
#[test]
fn the_presets_maps_end_where_f32_places_no_receiver() {
    let scene = load("park");
    let graph = skiagraph_graph::Graph::load(
        "pipelines/crsm.ron",
        &skiagraph_passes::registry(),
        &skiagraph_passes::EmbeddedSources,
    )
    .unwrap();
    let places = |size: u32| {
        let space = LightSpace::new(&scene.mesh, &scene.sun().unwrap(), size);
        let corners = scene.mesh.corner_positions();
        corners
            .filter(|corner| space.light_space_error_bound(corner.as_dvec3()).0 <= SLACK)
            .count()
    };
    let corners = scene.mesh.corner_positions().count();
    assert!(graph.parse_param("map_size", "8192").is_ok() && places(8192) == corners);
    assert!(graph.parse_param("map_size", "8193").is_err() && places(16384) == 0);
}
