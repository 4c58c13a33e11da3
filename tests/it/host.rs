//! Presets in a host: its meshes, its buffers on the GPU, its depth and normals.

use crate::support::{
    graphs::{self, open, values},
    meshes, scenes,
};
use crate::{gbuffer, shadows};
use glam::{
    DAffine3, DMat4, DVec3, Vec3,
    dcamera::rh::{proj::directx as proj, view::look_to_mat4},
};
use skiagraph_gpu::{Executor, FrameReport, device::Gpu, import};
use skiagraph_graph::{Graph, PlanRequest};
use skiagraph_passes::{Depth, Eye, GpuMesh, SceneProvider, registry};
use skiagraph_reference::Oracle;
use skiagraph_scene::{DirectionalLight, Indexed, Mesh, Movable, Scene, View};
use std::{fs, path::Path, sync::Arc};
use wgpu::util::DeviceExt;

pub const VIEWPORT: [u32; 2] = [192, 128];
const PRESETS: [&str; 3] = ["light_buffer", "rt", "crsm"];

/// Which pixels see the light.
fn answers(gpu: &Gpu, preset: &str, provider: &mut SceneProvider) -> Vec<u32> {
    let path = format!("pipelines/{preset}.ron");
    let plan = graphs::plan(&path, provider, VIEWPORT, |_| {});
    let report = graphs::run_on(gpu, plan, provider, &["visibility"]);
    values(&report, "visibility")
}

/// As a program has a mesh: corners that are not shared, with their normals.
fn unwelded(mesh: &Mesh) -> Mesh {
    let corners = gbuffer::corners(mesh);
    let part = |at: usize| -> Vec<[f32; 3]> {
        let corners = corners.iter();
        corners
            .map(|it| std::array::from_fn(|k| it[at + k]))
            .collect()
    };
    let indices: Vec<u32> = (0..corners.len() as u32).collect();
    let unwelded = Indexed {
        positions: &part(0),
        normals: &part(3),
        indices: &indices,
    };
    Mesh {
        surfaces: mesh.surfaces.clone(),
        ..unwelded.mesh().unwrap()
    }
}

#[test]
fn an_indexed_mesh_has_the_shadows_of_a_scenes() {
    let (gpu, park) = (open(), scenes::load("park"));
    let welded = unwelded(&park.mesh);
    assert_eq!(welded.positions.len(), park.mesh.positions.len());
    for preset in PRESETS.into_iter().chain(["crsma"]) {
        let expected = answers(
            &gpu,
            preset,
            &mut graphs::provider(&park, &park.views[0], VIEWPORT),
        );
        let mut host = SceneProvider::from_mesh(welded.clone(), park.light_of(&park.views[0]));
        host.set_camera(&park.views[0].camera(VIEWPORT));
        assert!(answers(&gpu, preset, &mut host) == expected, "{preset}");
    }
}

fn places(time: f64) -> [DAffine3; 3] {
    let turned = DAffine3::from_rotation_y(0.7 * time);
    [
        DAffine3::IDENTITY,
        DAffine3::from_translation(DVec3::new(2.0 + time, 0.5, 0.0)) * turned,
        DAffine3::from_translation(DVec3::new(-2.0, 0.3 * time, 1.0)),
    ]
}

fn view(time: f64) -> View {
    View {
        name: String::new(),
        eye: DVec3::new(1.0 + time, 6.0, 9.0),
        direction: DVec3::new(-0.1, -0.6, -1.0),
        fov_y_degrees: 50.0,
        far: 60.0,
        ..View::default()
    }
}

/// Returns the same meshes, but moved by hand.
fn moved(shapes: &[&Mesh], places: &[DAffine3]) -> Mesh {
    let mut whole: Option<Mesh> = None;
    for (mesh, place) in shapes.iter().zip(places) {
        let mut mesh = (*mesh).clone();
        for position in &mut mesh.positions {
            *position = place.transform_point3(position.as_dvec3()).as_vec3();
        }
        for normal in &mut mesh.normals {
            let across = place.matrix3.inverse().transpose();
            *normal = (across * normal.as_dvec3()).normalize().as_vec3();
        }
        whole = Some(match whole {
            Some(first) => meshes::joined(first, &mesh),
            None => mesh,
        });
    }
    whole.unwrap()
}

#[test]
fn instances_have_the_shadows_of_one_mesh() {
    let gpu = open();
    let (floor, stone) = (
        meshes::box_over_floor(8.0, Vec3::splat(0.5)),
        meshes::potato(3, 0.2, 1),
    );
    let shapes = [&floor, &stone, &stone];
    let parts = Movable::joined(&shapes);
    let light = DirectionalLight::new(DVec3::new(0.4, -1.0, -0.3));
    let mut host = SceneProvider::from_parts(parts, light);
    for time in [0.0, 1.0, 2.0] {
        host.set_camera(&view(time).camera(VIEWPORT));
        host.set_transforms(&places(time)).unwrap();
        let mut scene = SceneProvider::from_mesh(moved(&shapes, &places(time)), light);
        scene.set_camera(&view(time).camera(VIEWPORT));
        for preset in PRESETS {
            let expected = answers(&gpu, preset, &mut scene);
            assert!(expected.contains(&0) && expected.contains(&1));
            assert!(
                answers(&gpu, preset, &mut host) == expected,
                "{preset}, {time}"
            );
        }
    }
}

/// The program of docs/embedding.md, whose text `readme.rs` compares with this file, in motion.
#[test]
fn the_program_of_the_document_has_exact_shadows() {
    let gpu = open();
    let (floor, stone) = (
        meshes::box_over_floor(8.0, Vec3::splat(0.5)),
        meshes::potato(3, 0.2, 1),
    );
    let shapes = [&floor, &stone, &stone];
    let mut program = shadows::Shadows::new((&gpu.device, &gpu.queue), VIEWPORT, &shapes).unwrap();
    for time in [0.0, 1.0, 2.0] {
        let camera = view(time).camera(VIEWPORT);
        let light = DVec3::new(0.4 + 0.3 * time, -1.0, -0.3);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let seen = program
            .frame(&mut encoder, &camera, light, &places(time))
            .unwrap();
        let seen = texels(&gpu, encoder, seen.texture());
        let light = DirectionalLight::new(light);
        let mut scene = SceneProvider::from_mesh(moved(&shapes, &places(time)), light);
        scene.set_camera(&camera);
        let expected = answers(&gpu, "rt", &mut scene);
        assert!(expected.contains(&0) && expected.contains(&1));
        assert!(seen == expected, "{time}");
    }
    let program =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/passes/examples/preset/shadows.rs");
    let lines = fs::read_to_string(program).unwrap().lines().count();
    assert!(lines <= 50, "{lines} lines");
}

#[test]
fn a_light_and_a_camera_that_are_none_are_errors() {
    let gpu = open();
    let stone = meshes::potato(2, 0.2, 1);
    let down = DirectionalLight::new(DVec3::NEG_Y);
    let nowhere = DirectionalLight::new(DVec3::ZERO);
    let blind = View {
        fov_y_degrees: f64::NAN,
        ..view(0.0)
    };
    for (light, view, expected) in [
        (nowhere, view(0.0), "the light's direction"),
        (down, blind, "the camera has numbers"),
    ] {
        let mut host = SceneProvider::from_mesh(stone.clone(), light);
        host.set_camera(&view.camera(VIEWPORT));
        let plan = graphs::plan("pipelines/light_buffer.ron", &host, VIEWPORT, |_| {});
        let error = Executor::on(&gpu, plan, &mut host).err().unwrap();
        assert!(error.to_string().contains(expected), "{error}");
    }
}

/// Returns the texels of a texture of u32.
pub fn texels(gpu: &Gpu, mut encoder: wgpu::CommandEncoder, texture: &wgpu::Texture) -> Vec<u32> {
    let (width, height) = (texture.width(), texture.height());
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(4 * width * height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let to = wgpu::TexelCopyBufferInfo {
        buffer: &buffer,
        layout: wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * width),
            rows_per_image: None,
        },
    };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), to, texture.size());
    gpu.queue.submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |done| done.unwrap());
    gpu.device
        .poll(wgpu::PollType::wait_indefinitely())
        .unwrap();
    let mapped = buffer.get_mapped_range(..).unwrap();
    bytemuck::pod_collect_to_vec(&mapped)
}

#[test]
fn buffers_on_the_gpu_are_read_once_and_welded() {
    let gpu = open();
    let mesh = meshes::potato(2, 0.2, 1);
    let corners = gbuffer::corners(&mesh);
    let indices: Vec<u16> = (0..corners.len() as u16).collect();
    let buffer = |content: &[u8], usage| {
        gpu.device
            .create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: None,
                contents: content,
                usage,
            })
    };
    let readable = wgpu::BufferUsages::COPY_SRC;
    let vertices = buffer(bytemuck::cast_slice(&corners), readable);
    let indices = buffer(bytemuck::cast_slice(&indices), readable);
    let given = GpuMesh {
        vertices: vertices.slice(..),
        stride: 24,
        position: 0,
        normal: Some(12),
        indices: indices.slice(..),
        format: wgpu::IndexFormat::Uint16,
    };
    let read = given.read(&gpu.device, &gpu.queue).unwrap();
    let expected = unwelded(&mesh);
    assert_eq!(read.positions, expected.positions);
    assert_eq!(read.triangles, expected.triangles);
    assert_eq!(read.normals, expected.normals);
    assert_eq!(read.normal_indices, expected.normal_indices);

    let hidden = buffer(bytemuck::cast_slice(&corners), wgpu::BufferUsages::VERTEX);
    for (given, expected) in [
        (
            GpuMesh {
                vertices: hidden.slice(..),
                ..given
            },
            "buffer of vertices cannot be read",
        ),
        (
            GpuMesh {
                normal: Some(13),
                ..given
            },
            "normal at byte 13",
        ),
        (
            GpuMesh {
                indices: indices.slice(2..),
                ..given
            },
            "indices lie at an offset",
        ),
        (
            GpuMesh {
                format: wgpu::IndexFormat::Uint32,
                ..given
            },
            "index 0 is 65536",
        ),
    ] {
        let error = given.read(&gpu.device, &gpu.queue).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

/// A host's camera: name, world to eye, eye to clip, depth.
pub type Camera = (&'static str, DMat4, DMat4, Depth);

pub fn cameras(scene: &Scene) -> [Camera; 4] {
    let seen = &scene.views[0];
    let eye = look_to_mat4(seen.eye, seen.direction.normalize(), seen.up);
    let aspect = f64::from(VIEWPORT[0]) / f64::from(VIEWPORT[1]);
    let fov = seen.fov_y_degrees.to_radians();
    let infinite = proj::perspective_infinite_reverse(fov, aspect, seen.near);
    let [x, y] = [
        0.31 * 2.0 / f64::from(VIEWPORT[0]),
        -0.22 * 2.0 / f64::from(VIEWPORT[1]),
    ];
    let jitter = DMat4::from_translation(DVec3::new(x, y, 0.0));
    let (low, high) = scene.mesh.bounds().unwrap();
    let (centre, radius) = (
        low.midpoint(high).as_dvec3(),
        f64::from(low.distance(high)) * 0.5,
    );
    let down = DVec3::new(0.4, -0.8, -0.5).normalize();
    let above = look_to_mat4(centre - 2.0 * radius * down, down, DVec3::Y);
    let half = 0.6 * radius;
    let parallel = proj::orthographic(
        -half * aspect,
        half * aspect,
        -half,
        half,
        3.0 * radius,
        radius,
    );
    [
        (
            "standard",
            eye,
            proj::perspective(fov, aspect, seen.near, seen.far),
            Depth::Standard,
        ),
        ("reversed", eye, infinite, Depth::Reversed),
        ("jittered", eye, jitter * infinite, Depth::Reversed),
        ("orthographic", above, parallel, Depth::Reversed),
    ]
}

/// A preset on a host's depth and normals.
pub fn on_depth(
    gpu: &Gpu,
    preset: &str,
    provider: &mut SceneProvider,
    drawn: &gbuffer::GBuffer,
) -> FrameReport {
    let mut executor = executor_on_depth(gpu, preset, provider, drawn);
    graphs::frame(gpu, &mut executor, &["visibility", "status", "position"])
}

fn executor_on_depth(
    gpu: &Gpu,
    preset: &str,
    provider: &mut SceneProvider,
    drawn: &gbuffer::GBuffer,
) -> Executor {
    let document = format!(
        r#"(
            format: 3,
            extends: "{preset}.ron",
            inputs: [Texture(name: "depth"), Texture(name: "normal")],
            passes: [Change(pass: "gbuffer", graph: "shared/from_depth.ron")],
            outputs: ["visibility", "status", "position"],
        )"#
    );
    let files = [("pipelines/on_depth.ron", document.as_str())];
    let graph = Graph::load(
        "pipelines/on_depth.ron",
        &registry(),
        &graphs::layered(&files),
    );
    let graph = graph.unwrap_or_else(|error| panic!("{error}"));
    let size = [drawn.depth.width(), drawn.depth.height()];
    let mut request = PlanRequest::new(size, provider);
    let imports = [("depth", &drawn.depth), ("normal", &drawn.normal)];
    let described = imports.map(|(name, texture)| (name.to_owned(), import::texture(texture)));
    request.imports.extend(described);
    let plan = graph
        .plan(&request)
        .unwrap_or_else(|error| panic!("{error}"));
    let mut executor = Executor::on(gpu, plan, provider).unwrap();
    for (name, texture) in imports {
        executor.import_texture(name, texture).unwrap();
    }
    executor
}

/// A picture whose resolution changes within textures that stay: one executor, never planned anew.
#[test]
fn a_part_of_a_larger_target_is_shown_as_a_picture_of_its_size() {
    let (gpu, park) = (open(), scenes::load("park"));
    for (name, eye, projection, depth) in cameras(&park) {
        let mut provider = SceneProvider::new(Arc::clone(&park));
        provider.set_eye(&Eye::new(eye, projection, depth).unwrap());
        let whole = gbuffer::draw(&gpu, &park.mesh, projection * eye, depth, VIEWPORT);
        let mut executor = executor_on_depth(&gpu, "light_buffer", &mut provider, &whole);
        for [x, y, width, height] in [[0, 0, 96, 64], [11, 6, 150, 100], [3, 0, 189, 126]] {
            let own = gbuffer::draw(&gpu, &park.mesh, projection * eye, depth, [width, height]);
            let mut alone = SceneProvider::new(Arc::clone(&park));
            alone.set_eye(&Eye::new(eye, projection, depth).unwrap());
            let expected = on_depth(&gpu, "light_buffer", &mut alone, &own);
            let expected = values(&expected, "visibility");

            let part = [x, y, width, height];
            let camera = (projection * eye, depth);
            let part_drawn = gbuffer::draw_part(&gpu, &park.mesh, camera, (VIEWPORT, part));
            let viewport = part.map(f64::from);
            let within = Eye::in_viewport(eye, projection, depth, viewport, VIEWPORT).unwrap();
            provider.set_eye(&within);
            executor.refresh(&mut provider).unwrap();
            let gbuffer::GBuffer { depth, normal, .. } = &part_drawn;
            for (name, texture) in [("depth", depth), ("normal", normal)] {
                executor.import_texture(name, texture).unwrap();
            }
            let seen = graphs::frame(&gpu, &mut executor, &["visibility"]);
            let seen = values(&seen, "visibility");
            let mut wrong = 0;
            for (index, expected) in (0u32..).zip(&expected) {
                let at = [index % width + x, index / width + y];
                wrong += u32::from(seen[(at[1] * VIEWPORT[0] + at[0]) as usize] != *expected);
            }
            assert!(expected.contains(&0) && expected.contains(&1), "{name}");
            assert!(wrong <= 2, "{name}, {width}x{height}: {wrong}");
        }
    }
}

/// A host that tells the versions of its depth and normals pays nothing at rest, though it hands
/// them over in each frame.
#[test]
fn a_hosts_depth_at_rest_runs_no_pass() {
    let (gpu, park) = (open(), scenes::load("park"));
    let (_, eye, projection, depth) = cameras(&park)[0];
    let drawn = gbuffer::draw(&gpu, &park.mesh, projection * eye, depth, VIEWPORT);
    let mut provider = SceneProvider::new(Arc::clone(&park));
    provider.set_eye(&Eye::new(eye, projection, depth).unwrap());
    for preset in PRESETS {
        let mut executor = executor_on_depth(&gpu, preset, &mut provider, &drawn);
        let mut skipped = |version: u64| {
            for (name, texture) in [("depth", &drawn.depth), ("normal", &drawn.normal)] {
                executor.import_texture(name, texture).unwrap();
                executor.set_import_version(name, version).unwrap();
            }
            executor.refresh(&mut provider).unwrap();
            let report = graphs::frame(&gpu, &mut executor, &["visibility"]);
            (report.skipped.len(), executor.plan().live().count())
        };
        // Lists and hierarchies may grow in the first frames.
        let first = [1; 4].map(&mut skipped);
        assert!(first[0].0 < first[0].1, "{preset}: {first:?}");
        assert_eq!(first[3].0, first[3].1, "{preset}: {first:?}");
        let (changed, passes) = skipped(2);
        assert!(
            changed < passes,
            "{preset}: {changed} of {passes} are skipped"
        );
        let (rests, passes) = skipped(2);
        assert_eq!(rests, passes, "{preset}");
    }
}

#[test]
fn the_document_for_a_hosts_depth_is_right() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/embedding.md");
    let page = fs::read_to_string(page).unwrap();
    let mut blocks = page.split("```ron\n").skip(1);
    let document = blocks.find(|block| block.contains("extends:")).unwrap();
    let document = document.split("```").next().unwrap();
    let files = [("pipelines/on_depth.ron", document)];
    let sources = graphs::layered(&files);
    let provider = SceneProvider::new(scenes::load("park"));
    let mut request = PlanRequest::new(VIEWPORT, &provider);
    for (name, format) in [
        ("depth", wgpu::TextureFormat::Depth32Float),
        ("normal", wgpu::TextureFormat::Rgb10a2Unorm),
    ] {
        let texture = open().device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d {
                width: VIEWPORT[0],
                height: VIEWPORT[1],
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let import = import::texture(&texture);
        request.imports.insert(name.to_owned(), import);
    }
    let (graph, plan) = Graph::check("pipelines/on_depth.ron", &registry(), &sources, &request)
        .unwrap_or_else(|error| panic!("{error}"));
    assert!(graph.warnings().is_empty(), "{:?}", graph.warnings());
    let provided = plan.provided();
    assert!(provided.contains(&"unprojection"), "{provided:?}");
    assert!(!provided.contains(&"scene.normals"), "{provided:?}");
}

/// Column and row of a pixel.
pub fn pixel(index: usize) -> [usize; 2] {
    [index % VIEWPORT[0] as usize, index / VIEWPORT[0] as usize]
}

/// The place of a primitive that a pixel shows, and the normal there.
pub fn surface(mesh: &Mesh, primitive: u32, matrix: DMat4, index: usize) -> [DVec3; 2] {
    let ndc = |at: usize, extent: u32| (at as f64 + 0.5) / f64::from(extent) * 2.0 - 1.0;
    let [x, y] = pixel(index);
    let ndc = [ndc(x, VIEWPORT[0]), -ndc(y, VIEWPORT[1])];
    gbuffer::receiver(mesh, primitive, matrix, ndc)
}

/// Every answer is right where the receiver was put, which is before its own surface, and so near
/// to it that few pixels differ from the exact answer.
#[test]
fn a_hosts_depth_is_as_good_as_its_rounding() {
    let (gpu, park) = (open(), scenes::load("park"));
    let oracle = Oracle::new(&park.mesh);
    let sun = park.sun().unwrap();
    let to_light = sun.to_light().as_vec3();
    for (name, eye, projection, depth) in cameras(&park) {
        let matrix = projection * eye;
        let drawn = gbuffer::draw(&gpu, &park.mesh, matrix, depth, VIEWPORT);
        let encoder = gpu.device.create_command_encoder(&Default::default());
        let primitives = texels(&gpu, encoder, &drawn.primitive);
        let mut provider = SceneProvider::new(Arc::clone(&park));
        provider.set_eye(&Eye::new(eye, projection, depth).unwrap());
        for preset in PRESETS {
            let report = on_depth(&gpu, preset, &mut provider, &drawn);
            let (visibility, status) = (values(&report, "visibility"), values(&report, "status"));
            let position = graphs::shares(&report, "position");
            let mut rays = (Vec::new(), Vec::new());
            let (mut pixels, mut behind, mut farthest) = (Vec::new(), 0, 0.0f64);
            for (pixel, place) in position.as_chunks::<4>().0.iter().enumerate() {
                if !matches!(status[pixel], 2..=4) {
                    continue;
                }
                let [exact, normal] = surface(&park.mesh, primitives[pixel], matrix, pixel);
                let place = Vec3::from_slice(&place[..3]);
                behind += usize::from((place.as_dvec3() - exact).dot(normal) < 0.0);
                farthest = farthest.max(place.as_dvec3().distance(exact));
                pixels.push(pixel);
                rays.0.push((place, to_light));
                rays.1.push(((exact + 1e-4 * normal).as_vec3(), to_light));
            }
            let [there, exactly] = [oracle.occlusion(&rays.0), oracle.occlusion(&rays.1)];
            let differs = |blocked: bool, pixel: usize| (visibility[pixel] == 0) != blocked;
            let judged = pixels.iter().zip(&there);
            let unfaithful =
                judged.filter(|(pixel, it)| !it.indeterminate && differs(it.blocked, **pixel));
            let unfaithful = unfaithful.count();
            let wrong = pixels.iter().zip(&exactly);
            let wrong = wrong
                .filter(|(pixel, it)| differs(it.blocked, **pixel))
                .count();
            println!(
                "{preset}, {name}: of {} pixels {wrong} wrong, {unfaithful} not as their places; \
                 {behind} behind their surface; at most {farthest:.5} off",
                pixels.len()
            );
            assert!(pixels.len() > 5000, "{preset}, {name}");
            assert_eq!(unfaithful, 0, "{preset}, {name}");
            assert_eq!(behind, 0, "{preset}, {name}");
            assert!(wrong * 300 <= pixels.len(), "{preset}, {name}: {wrong}");
        }
    }
}
