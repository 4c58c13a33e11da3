//! The methods of outside authors (`tests/foreign`), first written in format 1 and format 2: all of
//! it can be said in format 3, and is as wrong on `park` as its author has measured.

mod engine;

use crate::support;
use crate::support::{
    graphs::{frame, open, provider, values},
    meshes,
    scenes::load,
};
use glam::{DVec3, Vec3};
use skiagraph_gpu::{Content, Executor};
use skiagraph_graph::{
    Capture, FolderSources, Graph, Import, LayeredSources, ParamValue, Picture, Plan, PlanRequest,
    Sources,
};
use skiagraph_passes::{EmbeddedSources, SceneProvider, registry};
use skiagraph_reference::{GroundTruthPixels, Oracle, OracleMode, Progress, Statistics};
use skiagraph_scene::{DirectionalLight, LightKind, PointLight, Scene, View};
use std::{path::Path, sync::Arc};
use wgpu::util::DeviceExt;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/foreign");

/// `tests/foreign`, whose only picture is that of `lang/noise.png`.
struct Foreign(FolderSources);

impl Sources for Foreign {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        self.0.read(path)
    }

    fn list(&self, folder: &str) -> Vec<String> {
        self.0.list(folder)
    }

    fn picture(&self, path: &str) -> Result<Option<Picture>, String> {
        let texel = |byte: u16| [byte * 257, 0, 0, u16::MAX];
        Ok((path == "lang/noise.png").then(|| Picture {
            size: [2, 2],
            texels: [0, 51, 102, 255].map(texel).to_vec().into(),
        }))
    }
}

fn sources() -> LayeredSources {
    let foreign = Foreign(FolderSources {
        root: FOLDER.into(),
    });
    LayeredSources(vec![Box::new(foreign), Box::new(EmbeddedSources)])
}

/// Plans a method after `adjust` has had its say; `a.ron@over=b.ron` with another document in its
/// open include.
fn plan(
    path: &str,
    provider: &SceneProvider,
    viewport: [u32; 2],
    adjust: impl FnOnce(&mut PlanRequest<'_>),
) -> Plan {
    let (own, over) = path.split_once("@over=").unwrap_or((path, ""));
    let over = (!over.is_empty()).then(|| ("over".to_owned(), over.to_owned()));
    let graph = Graph::load_over(own, &registry(), &sources(), &over.into_iter().collect())
        .unwrap_or_else(|errors| panic!("{path}: {errors}"));
    let mut request = PlanRequest::new(viewport, provider);
    request.features = wgpu::Features::FLOAT32_FILTERABLE;
    adjust(&mut request);
    graph
        .plan(&request)
        .unwrap_or_else(|errors| panic!("{path}: {errors}"))
}

/// The paths of all documents.
fn documents() -> Vec<String> {
    let folders = std::fs::read_dir(FOLDER).expect("the folder is there");
    let names = folders.map(|entry| entry.expect("it can be listed").file_name());
    let mut paths = vec![];
    for folder in names.map(|name| name.into_string().expect("plain names")) {
        let files = sources().list(&folder);
        let documents = files.iter().filter(|file| file.ends_with(".ron"));
        paths.extend(documents.map(|file| format!("{folder}/{file}")));
    }
    paths.sort();
    paths
}

#[test]
fn every_document_is_checked_without_a_fault_or_a_warning() {
    assert_eq!(documents().len(), 33);
    for path in documents() {
        let mut provider = SceneProvider::new(one());
        let loaded = Graph::load(&path, &registry(), &sources());
        let lights = loaded.map(|graph| graph.lights().map(|word| word.to_string()).collect());
        if lights.is_ok_and(|lights: Vec<String>| lights == ["point"]) {
            let (position, radius) = (DVec3::Z, 0.0);
            provider.set_light(LightKind::Point(PointLight { position, radius }));
        }
        let mut request = PlanRequest::new([1024, 1024], &provider);
        request.features = wgpu::Features::all();
        request.any_adapter = true;
        let (graph, plan) = Graph::check(&path, &registry(), &sources(), &request)
            .unwrap_or_else(|errors| panic!("{errors}"));
        let warnings: Vec<_> = graph.warnings().iter().chain(plan.warnings()).collect();
        assert!(warnings.is_empty(), "{path}: {warnings:?}");
    }
}

/// Counts the lines of a folder's files that are not empty.
fn lines(folder: &str, ending: &str) -> usize {
    let files = std::fs::read_dir(Path::new(FOLDER).join(folder)).expect("the folder is there");
    let paths = files.map(|file| file.expect("it can be listed").path());
    paths
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == ending)
        })
        .map(|path| {
            let text = std::fs::read_to_string(path).expect("it can be read");
            text.lines().filter(|line| !line.trim().is_empty()).count()
        })
        .sum()
}

#[test]
fn the_lines_of_the_readme_are_those_of_the_files() {
    let readme = std::fs::read_to_string(format!("{FOLDER}/README.md")).expect("it is there");
    let mut rows = 0;
    for row in readme.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let folder = cells[1].trim_matches('`');
        let now = |cell: &str| -> usize {
            let (_, now) = cell.rsplit_once(' ').expect("before → now");
            now.parse().expect("a number")
        };
        assert_eq!(
            (now(cells[2]), now(cells[3])),
            (lines(folder, "ron"), lines(folder, "wgsl")),
            "{folder}"
        );
        rows += 1;
    }
    assert_eq!(rows, 9);
}

const PARK: [u32; 2] = [256, 256];

/// Returns the oracle's answer for the park's first view.
fn truth(scene: &Arc<Scene>, light: &DirectionalLight) -> GroundTruthPixels {
    let mut provider = provider(scene, &scene.views[0], PARK);
    let plan = plan("pipelines/shared/gbuffer.ron", &provider, PARK, |request| {
        request.outputs = Some(vec!["primitive".into()]);
    });
    let report = support::graphs::run(plan, &mut provider, &["primitive"]);
    let primitives = values(&report, "primitive");
    let camera = scene.views[0].camera(PARK);
    let progress = Progress::default();
    Oracle::new(&scene.mesh)
        .shade(&camera, light, &primitives, OracleMode::Exact, progress)
        .unwrap_or_else(|error| panic!("{error}"))
}

/// Wrong pixels after each of some frames, percent.
fn wrong(
    path: &str,
    params: &[(&str, ParamValue)],
    frames: usize,
    scene: &Arc<Scene>,
    truth: &GroundTruthPixels,
) -> Vec<f64> {
    let mut provider = provider(scene, &scene.views[0], PARK);
    let plan = plan(path, &provider, PARK, |request| {
        let params = params.iter().cloned();
        request
            .params
            .extend(params.map(|(name, value)| (name.to_owned(), value)));
    });
    let gpu = open();
    let mut executor =
        Executor::on(&gpu, plan, &mut provider).unwrap_or_else(|error| panic!("{path}: {error}"));
    let mut share = || {
        let report = frame(&gpu, &mut executor, &["visibility", "status"]);
        let (visibility, status) = (values(&report, "visibility"), values(&report, "status"));
        let counts = Statistics::judged(&visibility, &status, truth)
            .unwrap_or_else(|error| panic!("{path}: {error}"));
        100.0 * counts.wrong_share()
    };
    (0..frames).map(|_| share()).collect()
}

#[test]
fn each_method_is_as_wrong_on_park_as_its_author_has_measured() {
    let scene = load("park");
    let truth = truth(&scene, &scene.sun().unwrap());
    let far = [
        ("map_size", ParamValue::U32(1024)),
        ("reach", ParamValue::F32(80.0)),
    ];
    let half = [("map_size", ParamValue::U32(512))];
    // Differences between rasterisers are far below a hundredth of these figures.
    for (path, params, percent) in [
        ("pipelines/nsm.ron", &[][..], 8.27),
        ("vsm/vsm.ron", &[], 11.44),
        ("csm/csm.ron", &far, 2.55),
        ("hsm/hsm.ron", &half, 13.05),
        ("pingpong/pingpong.ron", &[], 8.44),
        ("swraster/swraster.ron", &[], 13.67),
        ("volumes/volumes.ron", &[], 0.10),
        ("volumes/stencil.ron", &[], 0.10),
    ] {
        let share = wrong(path, params, 1, &scene, &truth)[0];
        println!("{path}: {share:.4} %, {percent} % expected");
        assert!((share - percent).abs() < 0.05, "{path}: {share} %");
    }
}

/// A quarter of the pixels in each frame; what no ray has reached yet is dark.
#[test]
fn temporal_is_right_once_every_pixel_has_had_its_ray() {
    let scene = load("park");
    let truth = truth(&scene, &scene.sun().unwrap());
    let shares = wrong("temporal/temporal.ron", &[], 5, &scene, &truth);
    println!("{shares:?}");
    for (share, percent) in shares.iter().zip([53.8, 35.9, 18.0, 0.003, 0.003]) {
        assert!((share - percent).abs() < 0.05, "{share} % for {percent} %");
    }
}

#[test]
fn the_two_lights_are_each_asked_by_itself() {
    let scene = load("park");
    let mut provider = provider(&scene, &scene.views[0], PARK);
    let lights = ["sun", "sky"];
    let plan = plan("twolights/two.ron", &provider, PARK, |request| {
        let captures = lights.map(|light| format!("{light}.visibility"));
        let captures = captures.into_iter().chain(["sky.status".to_owned()]);
        request.captures = captures.map(Capture::new).collect();
    });
    let names = [
        "visibility",
        "sun.visibility",
        "sky.visibility",
        "sky.status",
    ];
    let report = support::graphs::run(plan, &mut provider, &names);
    let [both, sun, sky, status] = names.map(|name| values(&report, name));
    let expected: Vec<u32> = sun.iter().zip(&sky).map(|(sun, sky)| sun & sky).collect();
    assert_eq!(both, expected);
    assert!(both != sun && both != sky);
    // The light that a pass has aimed is one as good as the scene's.
    let light = DirectionalLight::new(DVec3::NEG_Y);
    let counts = Statistics::judged(&sky, &status, &truth(&scene, &light))
        .unwrap_or_else(|error| panic!("{error}"));
    println!("straight from above: {:.2} %", 100.0 * counts.wrong_share());
    assert!(counts.wrong_share() < 0.05, "{counts:?}");
}

/// And says no where half of it is missing, as `vsm` does.
#[test]
fn softvis_hands_out_the_share_that_arrives() {
    let scene = load("park");
    let mut provider = provider(&scene, &scene.views[0], PARK);
    let plan = plan("vsm/softvis.ron", &provider, PARK, |_| {});
    let names = ["visibility", "soft", "status"];
    let report = support::graphs::run(plan, &mut provider, &names);
    let share = |at: usize| report.readbacks[at].content.as_f32().expect("floats");
    let (visibility, soft, status) = (share(0), share(1), values(&report, "status"));
    assert_eq!(visibility, soft);
    let between = soft.iter().filter(|&&share| share > 0.0 && share < 1.0);
    assert!(between.count() > 1000);
    for (share, status) in soft.iter().zip(status) {
        assert!(
            (2..4).contains(&status) || *share == 1.0,
            "{share}, {status}"
        );
        assert!(status != 2 || *share >= 0.5, "{share} is light");
        assert!(status != 3 || *share < 0.5, "{share} is shadow");
    }
}

/// One triangle, and a view of it.
fn one() -> Arc<Scene> {
    let view = View {
        eye: DVec3::Z,
        near: 0.5,
        far: 10.0,
        ..View::default()
    };
    Arc::new(Scene {
        name: "one".into(),
        mesh: meshes::mesh(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]),
        views: vec![view],
        lights: vec![DirectionalLight::new(DVec3::NEG_Z).into()],
    })
}

/// Value that a probe writes into the texel in this column and row.
type Texel = fn(usize, usize) -> f32;

/// Column of the pixel's centre: what `pass.wgsl` writes.
fn x(x: usize, _: usize) -> f32 {
    x as f32 + 0.5
}

/// The probes of the language, with what they write in the first and in the second frame.
const PROBES: [(&str, Texel, Texel); 13] = [
    ("arith", x, x),
    ("cube", |_, _| 1.0, |_, _| 1.0),
    ("dim3", x, x),
    ("file", noise, noise),
    ("frame", |_, _| 0.0, |_, _| 1.0),
    ("fullmips", x, x),
    ("index1", x, x),
    ("msaa", x, x),
    ("prevcam", |_, _| 0.5, |_, _| 0.5),
    ("reproject", |_, _| 0.0, |_, _| 0.5),
    ("scenetex", |_, _| 0.75, |_, _| 0.75),
    ("stencil", x, x),
    ("viewport", corner, corner),
];

fn noise(x: usize, y: usize) -> f32 {
    [[0.0, 0.2], [0.4, 1.0]][y % 2][x % 2]
}

fn corner(column: usize, row: usize) -> f32 {
    if column < 64 && row < 64 {
        x(column, row)
    } else {
        0.0
    }
}

#[test]
fn every_probe_of_the_language_writes_what_it_says() {
    let (scene, gpu) = (one(), open());
    const VIEWPORT: [u32; 2] = [96, 72];
    for (probe, first, second) in PROBES {
        let mut provider = provider(&scene, &scene.views[0], VIEWPORT);
        let path = format!("lang/{probe}.ron");
        let plan = plan(&path, &provider, VIEWPORT, |request| {
            if probe == "scenetex" {
                request.imports = imports().into();
            }
        });
        let output = plan.outputs()[0].name.clone();
        let mut executor = Executor::on(&gpu, plan, &mut provider)
            .unwrap_or_else(|error| panic!("{probe}: {error}"));
        if probe == "scenetex" {
            import(&gpu, &mut executor);
        }
        for expected in [first, second] {
            let report = frame(&gpu, &mut executor, &[&output]);
            for part in report.readbacks[0].content.split() {
                holds(probe, &part, expected);
            }
        }
    }
}

fn holds(probe: &str, part: &Content, expected: Texel) {
    let width = part.size().expect("a texture")[0] as usize;
    let texels = part.as_f32().expect("one float per texel");
    for (at, texel) in texels.into_iter().enumerate() {
        let expected = expected(at % width, at / width);
        assert_eq!(texel, expected, "{probe}: texel {at}, {width} a row");
    }
}

fn imports() -> [(String, Import); 2] {
    let uvs = Import::buffer(8, None, wgpu::BufferUsages::STORAGE);
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let albedo = Import::plain_texture(wgpu::TextureFormat::R32Float, [1, 1], usage);
    [("uvs".to_owned(), uvs), ("albedo".to_owned(), albedo)]
}

/// Imports the values of a scene with a material: 0.25 and 0.5.
fn import(gpu: &skiagraph_gpu::device::Gpu, executor: &mut Executor) {
    let uvs = gpu
        .device
        .create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents: bytemuck::bytes_of(&[0.25f32, 0.0]),
            usage: wgpu::BufferUsages::STORAGE,
        });
    let albedo = gpu.device.create_texture_with_data(
        &gpu.queue,
        &wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d::default(),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R32Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        },
        wgpu::util::TextureDataOrder::LayerMajor,
        bytemuck::bytes_of(&0.5f32),
    );
    executor
        .import_buffer("uvs", &uvs)
        .and_then(|()| executor.import_texture("albedo", &albedo))
        .unwrap_or_else(|error| panic!("{error}"));
}
