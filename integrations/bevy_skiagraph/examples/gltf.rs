//! A glTF scene under a sun and a lamp, drawn without a window: `cargo run --example gltf --
//! PICTURE.png [SCENE.gltf]`, the scene from the folder `assets`. The picture is compared with that
//! of the preset `rt`, which traces a ray for each pixel.

mod headless;

use bevy::{prelude::*, world_serialization::WorldAssetRoot};
use bevy_skiagraph::{SkiagraphPlugin, SkiagraphShadows};
use std::error::Error;

const SIZE: UVec2 = UVec2::new(960, 540);

/// Frames until the scene is loaded, in any case.
const LONGEST: usize = 1000;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let file = arguments.next().unwrap_or_else(|| "gltf.png".to_owned());
    let scene = arguments.next().unwrap_or_else(|| "yard.gltf".to_owned());

    let mut app = App::new();
    app.add_plugins((headless::without_window(), SkiagraphPlugin::default()));
    app.finish();
    app.cleanup();
    let assets = app.world().resource::<AssetServer>().clone();
    let scene = assets.load(GltfAssetLabel::Scene(0).from_asset(scene));
    app.world_mut().spawn(WorldAssetRoot(scene.clone()));
    let mut images = app.world_mut().resource_mut::<Assets<Image>>();
    let camera = headless::camera(&mut images, SIZE);
    let place = Transform::from_xyz(2.6, 2.7, 5.2).looking_at(Vec3::new(0.0, 0.7, 0.0), Vec3::Y);
    let camera = app.world_mut().spawn((camera, place)).id();
    let sun = Transform::default().looking_to(Vec3::new(-0.6, -1.0, -0.75), Vec3::Y);
    let lamp = Transform::from_xyz(-1.4, 3.0, 3.4).looking_at(Vec3::new(-0.5, 0.0, 0.0), Vec3::Y);
    let sun = (
        DirectionalLight {
            illuminance: 3500.0,
            ..default()
        },
        SkiagraphShadows::default(),
        sun,
    );
    let lamp = (
        SpotLight {
            color: Color::srgb(1.0, 0.75, 0.4),
            intensity: 450_000.0,
            outer_angle: 0.6,
            inner_angle: 0.5,
            ..default()
        },
        SkiagraphShadows::default(),
        lamp,
    );
    app.world_mut().spawn(sun);
    app.world_mut().spawn(lamp);

    for _ in 0..LONGEST {
        if assets.is_loaded_with_dependencies(&scene) {
            break;
        }
        headless::update(&mut app)?;
    }
    if !assets.is_loaded_with_dependencies(&scene) {
        return Err("the scene does not load; the log tells why".into());
    }
    for _ in 0..3 {
        headless::update(&mut app)?; // the scene is spawned
    }
    let drawn = headless::picture(&mut app, camera)?;
    for mut shadows in app
        .world_mut()
        .query::<&mut SkiagraphShadows>()
        .iter_mut(app.world_mut())
    {
        *shadows = SkiagraphShadows::new("rt");
    }
    let traced = headless::picture(&mut app, camera)?;
    let pixels = |image: &Image| image.data.clone().unwrap_or_default();
    let (one, other) = (pixels(&drawn), pixels(&traced));
    let texels = one.chunks_exact(4).zip(other.chunks_exact(4));
    let differ = texels.filter(|(one, other)| one != other).count();
    drawn.try_into_dynamic()?.to_rgb8().save(&file)?;
    println!(
        "{file}: {differ} of {} pixels differ from `rt`",
        SIZE.element_product()
    );
    if differ > 20 {
        return Err("the two presets do not agree".into());
    }
    Ok(())
}
