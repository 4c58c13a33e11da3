//! By how much a host's depth may be off, and the place that comes from it: the bounds of
//! docs/embedding.md against a rasteriser in f32, over random cameras and triangles.

use crate::{
    gbuffer::{self, GBuffer},
    host::{VIEWPORT, cameras as host_cameras, on_depth, pixel, surface, texels},
    support::{
        graphs::{open, shares, values},
        random::Random,
        scenes,
    },
};
use glam::{
    DMat4, DVec2, DVec3, DVec4, Mat4, Vec3, Vec4, Vec4Swizzles,
    dcamera::rh::{proj::directx as proj, view::look_to_mat4},
};
use skiagraph_gpu::device::Gpu;
use skiagraph_passes::{Depth, Eye, SceneProvider};
use std::sync::Arc;
use wgpu::util::DeviceExt;

/// Half the distance of 1 to the next f32: the largest error of a rounding.
const HALF_ULP: f64 = 1.0 / (1u32 << 24) as f64;

/// Share of a pixel by which corners are moved at most, in each direction: to a grid of 1/256.
const SNAPPING: f64 = 1.0 / 512.0;

const SIZE: DVec2 = DVec2::new(1280.0, 720.0);

/// A camera with the roundings of a depth that it writes.
struct Camera {
    matrix: DMat4,
    depth: Depth,
    eye: DVec3,
}

/// How hardware may compute a depth between corners.
#[derive(Clone, Copy, Debug)]
enum Interpolation {
    Shares,
    FromPixelZero,
    FromCorner,
}

/// Formats of depth.
#[derive(Clone, Copy, Debug)]
enum Format {
    Float32,
    Unorm24,
    Unorm16,
}

impl Format {
    fn stored(self, depth: f32) -> f64 {
        let unorm = |most: f64| (f64::from(depth) * most).round() / most;
        match self {
            Self::Float32 => f64::from(depth),
            Self::Unorm24 => unorm(f64::from((1 << 24) - 1)),
            Self::Unorm16 => unorm(65535.0),
        }
    }

    /// The most that rounding to it changes a depth.
    fn error(self) -> f64 {
        match self {
            Self::Float32 => 0.0,
            Self::Unorm24 => 0.5 / f64::from((1 << 24) - 1) + HALF_ULP * HALF_ULP,
            Self::Unorm16 => 0.5 / 65535.0 + HALF_ULP * HALF_ULP,
        }
    }
}

fn cameras(random: &mut Random) -> Vec<Camera> {
    let mut unit = || f64::from(random.unit());
    let far_off = 10f64.powf(3.0 * unit());
    let eye = DVec3::new(unit() - 0.5, unit() - 0.5, unit() - 0.5) * far_off;
    let forward = DVec3::new(unit() - 0.5, unit() - 0.5, unit() - 0.5).normalize();
    let view = look_to_mat4(eye, forward, DVec3::new(0.1, 1.0, 0.0).normalize());
    let (fov, aspect) = (0.4 + 1.2 * unit(), SIZE.x / SIZE.y);
    let near = 10f64.powf(-2.0 + 2.0 * unit());
    let infinite = proj::perspective_infinite_reverse(fov, aspect, near);
    let jitter = DVec3::new(unit() - 0.5, unit() - 0.5, 0.0) * 2.0 / SIZE.extend(1.0);
    let half = 20.0 * (0.5 + unit());
    let camera = |projection: DMat4, depth| Camera {
        matrix: projection * view,
        depth,
        eye,
    };
    vec![
        camera(proj::perspective(fov, aspect, near, 500.0), Depth::Standard),
        camera(infinite, Depth::Reversed),
        camera(DMat4::from_translation(jitter) * infinite, Depth::Reversed),
        camera(
            proj::orthographic(-half * aspect, half * aspect, -half, half, 100.0, 0.0),
            Depth::Reversed,
        ),
    ]
}

/// Clip coordinates as a vertex shader has them.
fn clip(matrix: &Mat4, at: Vec3, is_fused: bool) -> Vec4 {
    let rows = matrix.transpose();
    let rows = [rows.x_axis, rows.y_axis, rows.z_axis, rows.w_axis];
    let [x, y, z, w] = rows.map(|row| {
        if is_fused {
            let z = row.z.mul_add(at.z, row.w);
            row.x.mul_add(at.x, row.y.mul_add(at.y, z))
        } else {
            ((row.x * at.x + row.y * at.y) + row.z * at.z) + row.w
        }
    });
    Vec4::new(x, y, z, w)
}

/// The depth that a rasteriser writes at a place of its picture in pixels, if the triangle is
/// there, and how slender that is: the square of its longest edge over twice its area.
fn drawn(clips: [Vec4; 3], (at, size): (DVec2, DVec2), how: Interpolation) -> Option<(f32, f64)> {
    let ndc = clips.map(|clip| clip.xyz() / clip.w);
    let on_grid = |corner: Vec3| {
        let pixels = DVec2::new(
            f64::from((corner.x * 0.5 + 0.5) * size.x as f32),
            f64::from((0.5 - corner.y * 0.5) * size.y as f32),
        );
        (pixels * 256.0).round() / 256.0
    };
    let corners = ndc.map(on_grid);
    let [first, second] = [corners[1] - corners[0], corners[2] - corners[0]];
    let (area, from) = (first.perp_dot(second), at - corners[0]);
    let shares = [from.perp_dot(second) / area, first.perp_dot(from) / area];
    let is_inside = shares[0] >= 0.0 && shares[1] >= 0.0 && shares[0] + shares[1] <= 1.0;
    let edges = [first, second, second - first].map(DVec2::length);
    let longest = edges.into_iter().fold(0.0, f64::max);
    // A sliver is thinner than what corners are moved by.
    if area.abs() < longest / 32.0 || !is_inside {
        return None;
    }
    let [zero, one, two] = ndc.map(|corner| corner.z);
    let [one, two] = [one - zero, two - zero];
    let [a, b] = shares.map(|share| share as f32);
    let inverse = 1.0 / area as f32;
    let along_x = (one * second.y as f32 - two * first.y as f32) * inverse;
    let along_y = (two * first.x as f32 - one * second.x as f32) * inverse;
    let depth = match how {
        Interpolation::Shares => zero + (a * one + b * two),
        Interpolation::FromPixelZero => {
            let corner = corners[0].as_vec2();
            let begin = zero - along_x * corner.x - along_y * corner.y;
            begin + along_x * at.x as f32 + along_y * at.y as f32
        }
        Interpolation::FromCorner => zero + (along_x * from.x as f32 + along_y * from.y as f32),
    };
    Some((depth, longest * longest / area.abs()))
}

/// The arithmetic of shaders/from_depth.wgsl, in f32.
struct Unprojection {
    relative_from_clip: Mat4,
    origin: Vec3,
    origin_low: Vec3,
    is_reversed: bool,
}

impl Unprojection {
    fn new(camera: &Camera) -> Self {
        let origin = camera.eye.as_vec3();
        let relative = camera.matrix * DMat4::from_translation(camera.eye);
        Self {
            relative_from_clip: relative.inverse().as_mat4(),
            origin,
            origin_low: (camera.eye - origin.as_dvec3()).as_vec3(),
            is_reversed: camera.depth == Depth::Reversed,
        }
    }

    fn relative(&self, pixel: DVec2, depth: f32) -> Vec3 {
        let across = (pixel / SIZE * 2.0 - 1.0).as_vec2();
        let place = self.relative_from_clip * Vec4::new(across.x, -across.y, depth, 1.0);
        place.xyz() / place.w
    }

    fn receiver(&self, pixel: DVec2, seen: f32, steps: f32, snapping: f32, away: Vec3) -> Vec3 {
        let ulp = HALF_ULP as f32;
        let by = 2.0 * ulp * steps * seen.abs();
        let nearer = if self.is_reversed {
            seen + by
        } else {
            seen - by
        };
        let relative = self.relative(pixel, nearer);
        let place = (relative + self.origin_low) + self.origin;
        let [beside, below] = [DVec2::X, DVec2::Y].map(|step| self.relative(pixel + step, nearer));
        let size = relative.distance(beside) + relative.distance(below);
        let rounding = 4.0 * ulp * (place.length() + 2.0 * relative.length());
        place + (snapping * size + rounding) * away
    }
}

/// Sums of |entry · coordinate| of each row of a matrix, the most over some corners.
fn sums(matrix: &DMat4, corners: [Vec3; 3]) -> DVec4 {
    let rows = matrix.transpose();
    let rows = [rows.x_axis, rows.y_axis, rows.z_axis, rows.w_axis];
    let corners = corners.map(|at| at.as_dvec3().abs().extend(1.0));
    let most = |row: DVec4| {
        corners
            .iter()
            .map(|at| row.abs().dot(*at))
            .fold(0.0, f64::max)
    };
    DVec4::from_array(rows.map(most))
}

/// Bounds of docs/embedding.md: what a depth may be off by, and corners, in pixels.
fn bounds(
    camera: &Camera,
    corners: [Vec3; 3],
    (ndc, w, depth): (DVec2, f64, f64),
    (depths, slender): ([f64; 3], f64),
    format: Format,
) -> (f64, f64) {
    let sums = sums(&camera.matrix, corners);
    let roundings = 5.0 * HALF_ULP / w;
    let of_corners = roundings * (sums.z + depth * sums.w);
    let most = depths.into_iter().fold(0.0, f64::max);
    let least = depths.into_iter().fold(f64::INFINITY, f64::min);
    let between = HALF_ULP * (4.0 * most + 16.0 * (most - least) * slender);
    let off = of_corners + between + format.error();
    let across = roundings * (sums.xy() + ndc.abs() * sums.w) * 0.5 * SIZE;
    (
        off,
        SNAPPING + across.max_element() + 8.0 * HALF_ULP * SIZE.x,
    )
}

/// Holds both bounds against so many cameras of each kind; the number of depths that were tried.
fn hold(rounds: usize, seed: u64) -> usize {
    let mut random = Random(seed);
    let mut tried = 0;
    // The largest shares of the bounds that occur: of a depth, and of the way before the surface.
    let mut most = [0.0f64; 2];
    for round in 0..rounds {
        for camera in cameras(&mut random) {
            let unprojection = Unprojection::new(&camera);
            let inverse = camera.matrix.inverse();
            let place = |pixel: DVec2, depth: f64| {
                let ndc =
                    DVec2::new(pixel.x / SIZE.x, -pixel.y / SIZE.y) * 2.0 + DVec2::new(-1.0, 1.0);
                inverse.project_point3(ndc.extend(depth))
            };
            let mut unit = || f64::from(random.unit());
            // A triangle somewhere before the eye, from slivers to large ones.
            let middle = DVec2::new(unit(), unit()) * SIZE;
            let depth = match camera.depth {
                Depth::Standard => 1.0 - unit().powi(4),
                Depth::Reversed => unit().powi(3),
            };
            let extent = 10f64.powf(-2.0 + 3.0 * unit());
            let around = place(middle, depth.clamp(1e-3, 1.0));
            let mut corner = || around + extent * random.vector().as_dvec3();
            let mut corners = [corner(), corner(), corner()];
            if round % 4 == 0 {
                corners[2] = corners[0].midpoint(corners[1]).lerp(corners[2], 0.01);
            }
            let corners = corners.map(|at| at.as_vec3());
            let [a, b, c] = corners.map(|at| at.as_dvec3());
            let cross = (b - a).cross(c - a);
            let exact = [a, b, c].map(|at| camera.matrix * at.extend(1.0));
            if cross.length() < 1e-9
                || exact
                    .iter()
                    .any(|clip| clip.w < 1e-2 || clip.z < 0.0 || clip.z > clip.w)
            {
                continue;
            }
            let f32s = camera.matrix.as_mat4();
            let centre = exact.map(|clip| clip.xyz() / clip.w);
            let centre = (centre[0] + centre[1] + centre[2]) / 3.0;
            let pixel = (DVec2::new(centre.x, -centre.y) * 0.5 + 0.5) * SIZE;
            let pixel = pixel.floor() + 0.5;
            let is_fused = round % 2 == 0;
            let clips = corners.map(|at| clip(&f32s, at, is_fused));
            let how = [
                Interpolation::Shares,
                Interpolation::FromPixelZero,
                Interpolation::FromCorner,
            ][round % 3];
            let format = [Format::Float32, Format::Unorm24, Format::Unorm16][round / 3 % 3];
            let Some((written, slender)) = drawn(clips, (pixel, SIZE), how) else {
                continue;
            };
            let seen = format.stored(written);
            if !(1e-6..=1.0).contains(&seen) {
                continue;
            }
            let at = place(pixel, seen);
            let projected = camera.matrix * at.extend(1.0);
            let depths = (exact.map(|corner| corner.z / corner.w), slender);
            let ndc = projected.xy() / projected.w;
            let (off, snapping) =
                bounds(&camera, corners, (ndc, projected.w, seen), depths, format);
            // The side that is seen.
            let ray = (place(pixel, seen + 1e-9) - at).normalize();
            let normal = cross.normalize();
            let towards = if camera.depth == Depth::Reversed {
                ray
            } else {
                -ray
            };
            let normal = if normal.dot(towards) < 0.0 {
                -normal
            } else {
                normal
            };
            let [beside, below] = [DVec2::X, DVec2::Y].map(|step| place(pixel + step, seen));
            let size = (beside - at).length().hypot((below - at).length());
            let along = |depth: f64| (place(pixel, depth) - at).dot(normal).abs();
            let bound = along(seen + off).max(along(seen - off)) + snapping * size;
            let distance = (at - a).dot(normal);
            tried += 1;
            most[0] = most[0].max(distance.abs() / bound);
            assert!(
                distance.abs() <= bound,
                "{round}, {how:?}, {format:?}: {distance} {bound}, size {size}"
            );
            // With a normal that is 45 degrees off.
            let tilted = normal.cross(random.vector().as_dvec3()).normalize();
            let away = ((normal + tilted) * 0.5f64.sqrt()).as_vec3();
            let steps = off / (HALF_ULP * seen);
            let receiver =
                unprojection.receiver(pixel, seen as f32, steps as f32, snapping as f32, away);
            let before = (receiver.as_dvec3() - a).dot(normal);
            let allowed = along(seen + 3.0 * off).max(along(seen - 3.0 * off))
                + 3.0 * snapping * size
                + 16.0
                    * HALF_ULP
                    * (receiver.as_dvec3().length() + receiver.as_dvec3().distance(camera.eye));
            most[1] = most[1].max(before / allowed);
            assert!(
                before >= 0.0 && before <= allowed,
                "{round}, {how:?}, {format:?}, {:?}: {before} of {allowed}; depth {seen}",
                camera.depth
            );
        }
    }
    println!(
        "of {tried} depths the most is {:.3} of the bound, of places {:.3}",
        most[0], most[1]
    );
    tried
}

#[test]
fn places_are_before_their_surface_and_no_farther_than_the_document_says() {
    let tried = hold(4000, 14);
    assert!(tried > 8000, "{tried}");
}

#[test]
#[ignore = "a minute: cargo test -p skiagraph-tests --test across more_places -- --ignored"]
fn more_places_are_before_their_surface() {
    assert!(hold(400_000, 15) > 800_000);
}

const WRITE: &str = "
@group(0) @binding(0) var<storage, read> depths: array<f32>;

@vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment fn fragment(@builtin(position) at: vec4<f32>) -> @builtin(frag_depth) f32 {
    return depths[u32(at.x) + WIDTHu * u32(at.y)];
}";

/// Writes depths into a depth buffer.
fn write(gpu: &Gpu, depths: &[f32], to: &wgpu::Texture) {
    let device = &gpu.device;
    let source = WRITE.replace("WIDTH", &to.width().to_string());
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: None,
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: to.format(),
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: None,
            compilation_options: Default::default(),
            targets: &[],
        }),
        multiview_mask: None,
        cache: None,
    });
    let buffer = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: None,
        contents: bytemuck::cast_slice(depths),
        usage: wgpu::BufferUsages::STORAGE,
    });
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: buffer.as_entire_binding(),
        }],
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    let view = to.create_view(&Default::default());
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &view,
            depth_ops: Some(wgpu::Operations::default()),
            stencil_ops: None,
        }),
        ..Default::default()
    });
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.draw(0..3, 0..1);
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
}

/// The shader on depths of rasterisers that move corners to a grid of 1/256 of a pixel, as GPUs do:
/// with the slope of the depth from pixel to pixel, which may be another surface's, places on edges
/// lay behind their own.
#[test]
fn no_place_is_behind_its_surface_where_corners_are_moved() {
    let (gpu, park) = (open(), scenes::load("park"));
    let size = DVec2::from(VIEWPORT.map(f64::from));
    let mut judged = 0;
    for (name, eye, projection, depth) in host_cameras(&park) {
        let matrix = projection * eye;
        let GBuffer {
            depth: buffer,
            normal,
            primitive,
        } = gbuffer::draw(&gpu, &park.mesh, matrix, depth, VIEWPORT);
        let encoder = gpu.device.create_command_encoder(&Default::default());
        let primitives = texels(&gpu, encoder, &primitive);
        let rounded = matrix.as_mat4();
        for (is_fused, how) in [
            (false, Interpolation::FromCorner),
            (true, Interpolation::FromPixelZero),
            (true, Interpolation::Shares),
        ] {
            let mut is_drawn = Vec::new();
            let far = if depth == Depth::Reversed { 0.0 } else { 1.0 };
            let depths = primitives.iter().enumerate().map(|(index, &primitive)| {
                let corners = park.mesh.triangles[primitive as usize];
                let corners = corners.map(|corner| park.mesh.positions[corner as usize]);
                let clips = corners.map(|at| clip(&rounded, at, is_fused));
                let at = DVec2::from(pixel(index).map(|at| at as f64)) + 0.5;
                let is_before = clips
                    .iter()
                    .all(|clip| clip.w > 0.0 && clip.z >= 0.0 && clip.z <= clip.w);
                let written = is_before.then(|| drawn(clips, (at, size), how)).flatten();
                is_drawn.push(written.is_some());
                written.map_or(far, |(depth, _)| depth)
            });
            write(&gpu, &depths.collect::<Vec<f32>>(), &buffer);
            let drawn = GBuffer {
                depth: buffer.clone(),
                normal: normal.clone(),
                primitive: primitive.clone(),
            };
            let mut provider = SceneProvider::new(Arc::clone(&park));
            provider.set_eye(&Eye::new(eye, projection, depth).unwrap());
            let report = on_depth(&gpu, "light_buffer", &mut provider, &drawn);
            let (status, position) = (values(&report, "status"), shares(&report, "position"));
            let mut behind = 0;
            for (index, place) in position.as_chunks::<4>().0.iter().enumerate() {
                if is_drawn[index] && matches!(status[index], 2..=4) {
                    let place = Vec3::from_slice(&place[..3]);
                    let [exact, normal] = surface(&park.mesh, primitives[index], matrix, index);
                    judged += 1;
                    behind += usize::from((place.as_dvec3() - exact).dot(normal) < 0.0);
                }
            }
            println!("{name}, {is_fused}, {how:?}: {behind} behind");
            assert_eq!(behind, 0, "{name}, {is_fused}, {how:?}");
        }
    }
    assert!(judged > 50_000, "{judged}");
}
