//! A ground, columns and a ball that rolls, under a sun that sets, drawn by Bevy without a window;
//! the last frame becomes a picture: `cargo run -- FILE.png`.

use bevy::{
    asset::RenderAssetUsages,
    camera::RenderTarget,
    core_pipeline::{
        prepass::{DepthPrepass, NormalPrepass},
        tonemapping::{DebandDither, Tonemapping},
    },
    light::CascadeShadowConfig,
    prelude::*,
    render::{
        render_resource::{PollType, TextureFormat},
        renderer::RenderDevice,
        view::screenshot::{Screenshot, ScreenshotCaptured},
    },
};
use skiagraph_bevy::{
    Caster, ShadowPlugin, Shadowed, ShadowedMaterial, Visibility, without_window,
};
use std::sync::{Arc, Mutex};

const SIZE: [u32; 2] = [640, 360];
const FRAMES: usize = 12;

/// On the ground: behind a column as seen from the sun of the last frame, and in the open.
const SHADED: Vec3 = Vec3::new(-0.4, 0.0, -0.7);
const LIT: Vec3 = Vec3::new(-1.2, 0.0, -0.7);

#[derive(Component)]
struct Ball;

#[derive(Resource, Default)]
struct Progress(f32);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args()
        .nth(1)
        .unwrap_or_else(|| "bevy.png".to_owned());
    let mut app = App::new();
    app.add_plugins((without_window(), ShadowPlugin { size: SIZE }))
        .init_resource::<Progress>()
        .add_systems(Startup, set_up)
        .add_systems(Update, advance);
    app.finish();
    app.cleanup();

    let seen: Arc<Mutex<Option<Image>>> = Arc::default();
    for frame in 0..FRAMES {
        app.world_mut().resource_mut::<Progress>().0 = frame as f32 / (FRAMES - 1) as f32;
        if frame + 1 == FRAMES {
            let target = app
                .world_mut()
                .query::<&RenderTarget>()
                .single(app.world())?
                .clone();
            let seen = Arc::clone(&seen);
            let mut screenshot = app.world_mut().spawn(Screenshot(target));
            screenshot.observe(move |captured: On<ScreenshotCaptured>| {
                if let Ok(mut seen) = seen.lock() {
                    *seen = Some(captured.image.clone());
                }
            });
        }
        update(&mut app)?;
    }
    // The picture comes a few frames later.
    let image = loop {
        update(&mut app)?;
        if let Some(image) = seen.lock().map_err(|_| "an observer panicked")?.take() {
            break image;
        }
    };
    let [shaded, lit] = [SHADED, LIT].map(|place| brightness(&mut app, &image, place));
    let (shaded, lit) = (shaded?, lit?);
    image.try_into_dynamic()?.to_rgb8().save(&file)?;
    println!("{file}: {shaded:.3} in shadow, {lit:.3} in the light");
    if shaded > 0.5 * lit {
        return Err("what should be in shadow is not".into());
    }
    Ok(())
}

fn update(app: &mut App) -> Result<(), Box<dyn std::error::Error>> {
    app.update();
    let device = app.world().resource::<RenderDevice>().wgpu_device().clone();
    device.poll(PollType::wait_indefinitely())?;
    Ok(())
}

/// Returns the brightness of the picture where it shows a place.
fn brightness(
    app: &mut App,
    image: &Image,
    place: Vec3,
) -> Result<f32, Box<dyn std::error::Error>> {
    let mut cameras = app.world_mut().query::<(&Camera, &GlobalTransform)>();
    let (camera, eye) = cameras.single(app.world())?;
    let at = camera.world_to_viewport(eye, place)?.as_uvec2();
    let colour = image.get_color_at(at.x, at.y)?.to_linear();
    Ok(colour.luminance())
}

fn set_up(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<ShadowedMaterial>>,
    mut images: ResMut<Assets<Image>>,
    visibility: Res<Visibility>,
) {
    let mut material = |red, green, blue| {
        materials.add(ShadowedMaterial {
            base: StandardMaterial {
                base_color: Color::srgb(red, green, blue),
                perceptual_roughness: 0.9,
                ..default()
            },
            extension: Shadowed {
                visibility: visibility.0.clone(),
            },
        })
    };
    let (grey, sand, red) = (
        material(0.55, 0.57, 0.6),
        material(0.85, 0.75, 0.6),
        material(0.8, 0.25, 0.2),
    );
    let ground = meshes.add(Plane3d::default().mesh().size(30.0, 30.0));
    commands.spawn((Caster, Mesh3d(ground), MeshMaterial3d(grey)));
    let column = meshes.add(Cylinder::new(0.35, 2.4).mesh().resolution(48));
    for number in 0..5 {
        commands.spawn((
            Caster,
            Mesh3d(column.clone()),
            MeshMaterial3d(sand.clone()),
            Transform::from_xyz(1.8 * number as f32 - 3.6, 1.2, -1.5),
        ));
    }
    let ball = meshes.add(
        Sphere::new(0.5)
            .mesh()
            .ico(6)
            .unwrap_or_else(|_| Sphere::new(0.5).into()),
    );
    commands.spawn((
        Ball,
        Caster,
        Mesh3d(ball),
        MeshMaterial3d(red),
        Transform::default(),
    ));

    commands.spawn((
        DirectionalLight {
            illuminance: 5_500.0,
            // Bevy asks for the shadow of such lights only; its own maps end before the first pixel.
            shadow_maps_enabled: true,
            ..default()
        },
        CascadeShadowConfig {
            bounds: vec![0.02],
            overlap_proportion: 0.0,
            minimum_distance: 0.01,
        },
        Transform::default(),
    ));
    let [width, height] = SIZE;
    let mut target = Image::new_target_texture(width, height, TextureFormat::Rgba8UnormSrgb, None);
    target.asset_usage = RenderAssetUsages::RENDER_WORLD;
    commands.spawn((
        Camera3d::default(),
        RenderTarget::from(images.add(target)),
        Transform::from_xyz(3.5, 4.0, 7.0).looking_at(Vec3::new(0.0, 0.6, -0.8), Vec3::Y),
        Msaa::Off,
        Tonemapping::None,
        DebandDither::Disabled,
        DepthPrepass,
        NormalPrepass,
    ));
}

/// The ball rolls between the columns, the sun sinks.
fn advance(
    progress: Res<Progress>,
    mut balls: Query<&mut Transform, (With<Ball>, Without<DirectionalLight>)>,
    mut suns: Query<&mut Transform, With<DirectionalLight>>,
) {
    for mut place in &mut balls {
        place.translation = Vec3::new(3.6 - 2.0 * progress.0, 0.5, 0.9);
    }
    for mut place in &mut suns {
        let from = Vec3::new(0.6 - 0.2 * progress.0, 2.5 - 1.5 * progress.0, -0.8);
        *place = Transform::from_translation(from).looking_at(Vec3::ZERO, Vec3::Y);
    }
}
