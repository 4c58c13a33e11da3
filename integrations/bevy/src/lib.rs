//! Shadows of a Skiagraph preset in Bevy's lighting.
//!
//! [`ShadowPlugin`] runs `light_buffer` between Bevy's prepass and its main pass, on the prepass's
//! depth and normals, over all meshes with [`Caster`]. Materials with the extension [`Shadowed`]
//! multiply the directional light by what it finds, where Bevy multiplies it by its shadow maps.

mod casters;
mod shadows;

use bevy::{
    app::PluginGroupBuilder,
    asset::embedded_asset,
    core_pipeline::{Core3dSystems, schedule::Core3d},
    pbr::{ExtendedMaterial, MaterialExtension},
    prelude::*,
    render::{
        RenderApp, RenderPlugin,
        extract_resource::{ExtractResource, ExtractResourcePlugin},
        render_resource::{AsBindGroup, TextureFormat},
    },
    shader::ShaderRef,
    window::ExitCondition,
};

/// Throws shadows.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct Caster;

/// Factor of the directional light, as an image of the camera's size: 0 or 1.
#[derive(Resource, Clone, ExtractResource)]
#[extract_app(RenderApp)]
pub struct Visibility(pub Handle<Image>);

/// A material under exact shadows.
pub type ShadowedMaterial = ExtendedMaterial<StandardMaterial, Shadowed>;

/// The extension that multiplies the light.
#[derive(Asset, AsBindGroup, Reflect, Debug, Clone)]
pub struct Shadowed {
    /// That of the resource [`Visibility`].
    #[texture(100, sample_type = "u_int")]
    pub visibility: Handle<Image>,
}

impl MaterialExtension for Shadowed {
    fn fragment_shader() -> ShaderRef {
        "embedded://skiagraph_bevy/shadowed.wesl".into()
    }
}

/// Exact shadows of one directional light, for one camera with a depth and a normal prepass and
/// without multisampling.
pub struct ShadowPlugin {
    /// Pixels of the camera.
    pub size: [u32; 2],
}

impl Plugin for ShadowPlugin {
    fn build(&self, app: &mut App) {
        embedded_asset!(app, "shadowed.wesl");
        let [width, height] = self.size;
        let image = Image::new_target_texture(width, height, TextureFormat::R32Uint, None);
        let image = app.world_mut().resource_mut::<Assets<Image>>().add(image);
        app.insert_resource(Visibility(image))
            .init_resource::<casters::Casters>()
            .add_plugins((
                MaterialPlugin::<ShadowedMaterial>::default(),
                ExtractResourcePlugin::<Visibility>::default(),
                ExtractResourcePlugin::<casters::Casters>::default(),
            ))
            .add_systems(Last, casters::gather);
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
            return;
        };
        let between = shadows::encode
            .after(Core3dSystems::Prepass)
            .before(Core3dSystems::MainPass);
        render_app
            .init_resource::<shadows::Shadows>()
            .add_systems(Core3d, between);
    }
}

/// Returns Bevy's own plug-ins for a program without a window, whose pipelines are compiled before
/// the frame that uses them.
pub fn without_window() -> PluginGroupBuilder {
    DefaultPlugins
        .set(WindowPlugin {
            primary_window: None,
            exit_condition: ExitCondition::DontExit,
            ..default()
        })
        .set(RenderPlugin {
            synchronous_pipeline_compilation: true,
            ..default()
        })
}
