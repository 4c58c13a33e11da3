//! Exact shadows in Bevy: the light of a [`SkiagraphShadows`] is multiplied by what a preset of
//! Skiagraph finds for each pixel, in the place of Bevy's shadow maps.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_skiagraph::{SkiagraphPlugin, SkiagraphShadows};
//!
//! fn main() {
//!     App::new()
//!         .add_plugins((DefaultPlugins, SkiagraphPlugin::default()))
//!         .add_systems(Startup, set_up)
//!         .run();
//! }
//!
//! fn set_up(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>) {
//!     let material = MeshMaterial3d::<StandardMaterial>::default();
//!     let floor = Mesh3d(meshes.add(Plane3d::default().mesh().size(9.0, 9.0)));
//!     let ring = Mesh3d(meshes.add(Torus::new(0.4, 1.0)));
//!     commands.spawn((floor, material.clone()));
//!     commands.spawn((ring, material, Transform::from_xyz(0.0, 1.0, 0.0)));
//!     let sun = Transform::from_xyz(2.0, 3.0, 1.0).looking_at(Vec3::ZERO, Vec3::Y);
//!     commands.spawn((DirectionalLight::default(), SkiagraphShadows::default(), sun));
//!     let eye = Transform::from_xyz(1.0, 4.0, 5.0).looking_at(Vec3::ZERO, Vec3::Y);
//!     commands.spawn((Camera3d::default(), Msaa::Off, eye));
//! }
//! ```
//!
//! All [`Mesh3d`] without [`NotShadowCaster`](bevy::light::NotShadowCaster) cast shadows,
//! alpha-tested [`StandardMaterial`]s through their holes. Materials stay as they are. Any number
//! of cameras, of any size and with viewports, see the shadows of any number of directional lights
//! and spot lights.
//!
//! # How it works
//!
//! The preset runs between Bevy's prepass and its main pass, in Bevy's encoder, on the depth and
//! the normals of the prepass. The factor of each pixel is then written into the texels of the
//! light's own shadow map, in which Bevy has drawn no caster, and the function of Bevy's shader
//! that looks that map up reads the texel of its pixel. So every material and every lighting pass
//! of Bevy's has the factor, and no bind group has another layout.

#![warn(missing_docs)]

mod casters;
mod lights;
mod maps;
mod skins;
mod views;

use bevy::{
    core_pipeline::{Core3dSystems, schedule::Core3d},
    light::SimulationLightSystems,
    pbr::{LATE_SHADOW_PASS, per_view_shadow_pass, prepare_lights, shared_shadow_pass},
    prelude::*,
    render::{
        ExtractSchedule, Render, RenderApp, RenderStartup, RenderSystems,
        extract_component::{ExtractComponent, ExtractComponentPlugin},
    },
};
use std::path::PathBuf;

/// Gives a [`DirectionalLight`] or a [`SpotLight`] the shadows that a preset of Skiagraph finds.
///
/// Adding it sets the light's `shadow_maps_enabled`; without that the light has no shadows, as in
/// Bevy. The light's biases and its cascades are not used. A light with `VolumetricLight` keeps
/// Bevy's shadow maps, and so does every light for a camera that is not [`Msaa::Off`].
#[derive(Component, ExtractComponent, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[extract_app(RenderApp)]
pub struct SkiagraphShadows {
    /// Name of a preset (`light_buffer`, which is exact, `rt`, `pcf`, …), or path of a document in
    /// [`SkiagraphPlugin::folder`]. Its pass `gbuffer` is replaced by Bevy's prepass.
    pub preset: String,
    /// Extent of the light for presets that have penumbrae, such as `light_buffer_area`: angular
    /// diameter of a directional light in radians, radius of a spot light in metres.
    pub extent: f32,
}

impl Default for SkiagraphShadows {
    fn default() -> Self {
        Self::new("light_buffer")
    }
}

impl SkiagraphShadows {
    /// Shadows of a preset, under a light without an extent.
    pub fn new(preset: impl Into<String>) -> Self {
        Self {
            preset: preset.into(),
            extent: 0.0,
        }
    }

    /// Sets the [extent](Self::extent) of the light.
    #[must_use]
    pub fn with_extent(self, extent: f32) -> Self {
        Self { extent, ..self }
    }
}

fn enable_shadow_maps(
    added: On<Add<SkiagraphShadows>>,
    mut lights: Query<(Option<&mut DirectionalLight>, Option<&mut SpotLight>)>,
) {
    let Ok((directional, spot)) = lights.get_mut(added.entity) else {
        return;
    };
    if directional.is_none() && spot.is_none() {
        let light = added.entity;
        warn!("SkiagraphShadows is for a DirectionalLight or a SpotLight; {light} is neither");
    }
    if let Some(mut light) = directional {
        light.shadow_maps_enabled = true;
    }
    if let Some(mut light) = spot {
        light.shadow_maps_enabled = true;
    }
}

/// Draws the shadows of all lights that have [`SkiagraphShadows`].
#[derive(Clone, Debug, Default)]
pub struct SkiagraphPlugin {
    /// Folder with documents and shaders of your own, next to the presets; `None` for none.
    pub folder: Option<PathBuf>,
}

impl Plugin for SkiagraphPlugin {
    fn build(&self, app: &mut App) {
        if app.get_sub_app(RenderApp).is_none() {
            warn!("SkiagraphPlugin draws nothing without a renderer: add it after DefaultPlugins");
            return;
        }
        let is_patched = maps::IsPatched::default();
        app.register_type::<SkiagraphShadows>()
            .init_resource::<casters::Casters>()
            .insert_resource(is_patched.clone())
            .add_observer(enable_shadow_maps)
            .add_plugins(ExtractComponentPlugin::<SkiagraphShadows>::default())
            .add_systems(
                PostUpdate,
                (
                    maps::patch_shader,
                    lights::ask_for_prepasses,
                    lights::draw_no_maps.after(SimulationLightSystems::CheckLightVisibility),
                ),
            )
            .add_systems(Last, casters::gather);
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
            return;
        };
        let encode = views::encode
            .after(Core3dSystems::Prepass)
            .after(per_view_shadow_pass::<LATE_SHADOW_PASS>)
            .after(shared_shadow_pass::<LATE_SHADOW_PASS>)
            .before(Core3dSystems::MainPass);
        let mark = lights::mark.in_set(RenderSystems::CreateViews);
        render_app
            .insert_resource(is_patched)
            .insert_resource(views::Views::new(self.folder.clone()))
            .add_systems(RenderStartup, views::move_to)
            .add_systems(ExtractSchedule, casters::extract)
            .add_systems(Render, mark.before(prepare_lights))
            .add_systems(Render, views::drop_unused.in_set(RenderSystems::Cleanup))
            .add_systems(Core3d, encode);
    }
}
