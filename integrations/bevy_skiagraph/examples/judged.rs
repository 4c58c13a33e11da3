//! Draws a view of a scene of Skiagraph in Bevy, for `skiagraph judge`: `cargo run --example judged
//! -- SCENE VIEW WIDTHxHEIGHT FOLDER [PRESET]` writes `shadowed.npy`, `unshadowed.npy` and
//! `depth.npy`, under the shadows of a preset or, without one, under Bevy's own shadow maps.
//! Materials are not followed: all surfaces are white, opaque and seen from their front.

mod headless;

use bevy::{
    asset::RenderAssetUsages,
    camera::{Hdr, RenderTarget},
    core_pipeline::tonemapping::{DebandDither, Tonemapping},
    mesh::PrimitiveTopology,
    prelude::*,
    render::{
        RenderApp,
        render_asset::RenderAssets,
        render_resource::{PollType, TextureFormat, TextureUsages},
        renderer::{RenderDevice, RenderQueue},
        texture::GpuImage,
        view::ViewDepthStencilTexture,
    },
};
use bevy_skiagraph::{SkiagraphPlugin, SkiagraphShadows};
use skiagraph_scene::{Scene, SceneLibrary, View};
use std::{error::Error, fs, path::Path, process::ExitCode};

/// Frames until the picture stands: meshes and pipelines come with the first ones.
const FRAMES: usize = 4;

/// Greatest width and height of a texture under wgpu's default limits.
const LARGEST: u32 = 8192;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, view, size, folder, preset @ ..] = arguments.as_slice() else {
        return Err("give SCENE VIEW WIDTHxHEIGHT FOLDER: park bench_side 1280x720 out".into());
    };
    let size = parse_size(size)
        .ok_or_else(|| format!("size {size:?}: expected WIDTHxHEIGHT, each 1 to {LARGEST}"))?;
    let (scene, _) = SceneLibrary::from_environment().load(scene)?;
    let names = scene.views.iter().map(|view| view.name.as_str());
    let names = names.collect::<Vec<_>>().join(", ");
    let missing = || format!("{} has no view {view:?}; its views: {names}", scene.name);
    let view = scene.view(view).ok_or_else(missing)?;
    let folder = Path::new(folder);
    fs::create_dir_all(folder)?;

    let mut app = App::new();
    app.add_plugins(headless::without_window())
        // Light from everywhere would stand in the quotient.
        .insert_resource(GlobalAmbientLight::NONE);
    if let Some(preset) = preset.first() {
        let shadows = SkiagraphShadows::new(preset);
        app.add_plugins(SkiagraphPlugin::default())
            .register_required_components_with::<DirectionalLight, _>(move || shadows.clone());
    }
    app.finish();
    app.cleanup();
    let target = spawn(app.world_mut(), &scene, view, size)?;

    for (name, has_shadows) in [("unshadowed", false), ("shadowed", true)] {
        let mut lights = app.world_mut().query::<&mut DirectionalLight>();
        for mut light in lights.iter_mut(app.world_mut()) {
            light.shadow_maps_enabled = has_shadows;
        }
        for _ in 0..FRAMES {
            app.update();
            let device = app.world().resource::<RenderDevice>();
            device.poll(PollType::wait_indefinitely())?;
        }
        let world = app.sub_app_mut(RenderApp).world_mut();
        let image = world.resource::<RenderAssets<GpuImage>>().get(&target);
        let picture = &image.ok_or("the target is not on the GPU")?.texture;
        write_npy(world, picture, &folder.join(format!("{name}.npy")))?;
    }
    let world = app.sub_app_mut(RenderApp).world_mut();
    let depth = world.query::<&ViewDepthStencilTexture>().single(world)?;
    write_npy(world, depth.texture(), &folder.join("depth.npy"))
}

fn parse_size(text: &str) -> Option<[u32; 2]> {
    let (width, height) = text.split_once('x')?;
    let size = [width.parse().ok()?, height.parse().ok()?];
    let fits = size.iter().all(|edge| (1..=LARGEST).contains(edge));
    fits.then_some(size)
}

/// Brings mesh, light and camera into Bevy's world. Returns the camera's target.
fn spawn(
    world: &mut World,
    scene: &Scene,
    view: &View,
    [width, height]: [u32; 2],
) -> Result<Handle<Image>, Box<dyn Error>> {
    let mesh = &scene.mesh;
    let positions: Vec<[f32; 3]> = mesh.corner_positions().map(Into::into).collect();
    let normals = mesh.normal_indices.iter().flatten();
    let normals: Vec<[f32; 3]> = normals
        .map(|&normal| mesh.normals[normal as usize].into())
        .collect();
    let mesh = Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals);
    let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
    // No colour is 0, or there is no quotient.
    let material = StandardMaterial {
        base_color: Color::WHITE,
        perceptual_roughness: 1.0,
        reflectance: 0.0,
        ..default()
    };
    let material = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(material);
    world.spawn((Mesh3d(mesh), MeshMaterial3d(material)));

    let vector = |vector: glam::DVec3| Vec3::from_array(vector.as_vec3().to_array());
    let light = scene.light_of(view);
    let sun = light.directional().ok_or_else(|| {
        let kind = light.word();
        format!(
            "{}'s light is a {kind} light; take a scene with a directional one",
            view.name
        )
    })?;
    // Four cascades of 2048² texels, filter, biases: Bevy's own.
    world.spawn((
        DirectionalLight::default(),
        Transform::default().looking_to(vector(sun.direction), Vec3::Y),
    ));

    let mut target = Image::new_target_texture(width, height, TextureFormat::Rgba16Float, None);
    target.texture_descriptor.usage |= TextureUsages::COPY_SRC;
    let target = world.resource_mut::<Assets<Image>>().add(target);
    world.spawn((
        Camera3d {
            depth_texture_usages: (TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC)
                .into(),
            ..default()
        },
        Projection::from(PerspectiveProjection {
            fov: view.fov_y_degrees.to_radians() as f32,
            near: view.near as f32,
            far: view.far as f32,
            ..default()
        }),
        Transform::from_translation(vector(view.eye))
            .looking_to(vector(view.direction), vector(view.camera([1, 1]).up)),
        RenderTarget::from(target.clone()),
        Hdr,
        Msaa::Off,
        Tonemapping::None,
        DebandDither::Disabled,
    ));
    Ok(target)
}

/// Writes the numbers of a texture, half floats of four channels or depths, as they are.
fn write_npy(world: &World, texture: &wgpu::Texture, file: &Path) -> Result<(), Box<dyn Error>> {
    let device = world.resource::<RenderDevice>().wgpu_device();
    let size = texture.size();
    let (numbers, channels, texel) = match texture.format() {
        TextureFormat::Rgba16Float => ("<f2", ", 4", 8),
        TextureFormat::Depth32Float => ("<f4", "", 4),
        other => return Err(format!("a texture of {other:?} is not written").into()),
    };
    let row = size.width * texel;
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(padded) * u64::from(size.height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let layout = wgpu::TexelCopyBufferLayout {
        bytes_per_row: Some(padded),
        ..default()
    };
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout,
        },
        size,
    );
    world.resource::<RenderQueue>().submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |_| ());
    device.poll(PollType::wait_indefinitely())?;

    let shape = format!("({}, {}{channels})", size.height, size.width);
    let header = format!("{{'descr': '{numbers}', 'fortran_order': False, 'shape': {shape}, }}");
    // Ten bytes stand before the header, which ends with a line at a multiple of 64.
    let length = (10 + header.len() + 1).next_multiple_of(64) - 10;
    let mut npy = b"\x93NUMPY\x01\x00".to_vec();
    npy.extend((length as u16).to_le_bytes());
    npy.extend(format!("{header:<0$}\n", length - 1).bytes());
    let bytes = buffer.get_mapped_range(..)?;
    for padded in bytes.chunks_exact(padded as usize) {
        npy.extend(&padded[..row as usize]);
    }
    Ok(fs::write(file, npy)?)
}
