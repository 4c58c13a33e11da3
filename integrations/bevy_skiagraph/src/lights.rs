//! Cameras and lights: what Bevy has to draw for them, and what it need not.

use crate::{SkiagraphShadows, maps::IsPatched};
use bevy::{
    camera::visibility::{CascadesVisibleEntities, VisibleMeshEntities},
    core_pipeline::prepass::{DepthPrepass, NormalPrepass},
    light::{DirectionalLightShadowMap, VolumetricLight},
    pbr::{ExtractedDirectionalLight, ExtractedPointLight},
    prelude::*,
    render::camera::ExtractedCamera,
};

/// Cameras of the main world, and what they lack.
type Cameras<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static Camera,
        &'static Msaa,
        Has<DepthPrepass>,
        Has<NormalPrepass>,
    ),
    With<Camera3d>,
>;

/// Gives cameras the prepasses that presets read, once there is a light of theirs.
pub fn ask_for_prepasses(
    lights: Query<(), With<SkiagraphShadows>>,
    cameras: Cameras,
    mut commands: Commands,
) {
    if lights.is_empty() {
        return;
    }
    for (camera, _, msaa, has_depth, has_normal) in &cameras {
        if *msaa != Msaa::Off {
            warn_once!(
                "camera {camera} has Bevy's shadow maps instead of SkiagraphShadows, which have no \
                 multisampling: give the camera `Msaa::Off`"
            );
        } else if !has_depth || !has_normal {
            commands
                .entity(camera)
                .insert((DepthPrepass, NormalPrepass));
        }
    }
}

/// Casters that Bevy draws into the maps of our lights.
type Drawn<'w, 's> = Query<
    'w,
    's,
    (
        Option<&'static mut CascadesVisibleEntities>,
        Option<&'static mut VisibleMeshEntities>,
    ),
    (With<SkiagraphShadows>, Without<VolumetricLight>),
>;

/// Keeps Bevy from drawing casters into maps that no camera looks up.
pub fn draw_no_maps(cameras: Cameras, mut lights: Drawn, is_patched: Res<IsPatched>) {
    let is_own =
        |(_, camera, msaa, ..): (_, &Camera, &Msaa, _, _)| !camera.is_active || *msaa == Msaa::Off;
    if !is_patched.get() || !cameras.iter().all(is_own) {
        return;
    }
    for (cascades, casters) in &mut lights {
        if let Some(mut cascades) = cascades {
            let maps = cascades.entities.values_mut().flatten();
            maps.for_each(|map| map.entities.clear());
        }
        if let Some(mut casters) = casters {
            casters.entities.clear();
        }
    }
}

/// Marks lights for the shader by the lowest bit of their depth bias, which changes no shadow of
/// Bevy's, and gives their maps the texels that the largest camera has pixels. All cameras share
/// the maps of spot lights, which are Bevy's while one of the cameras needs these. `sizes` are the
/// size of maps that the program has set, and the one that they were given.
pub fn mark(
    mut directional: Query<(&mut ExtractedDirectionalLight, Has<SkiagraphShadows>)>,
    mut spots: Query<(&mut ExtractedPointLight, Has<SkiagraphShadows>)>,
    cameras: Query<(&ExtractedCamera, &Msaa), With<Camera3d>>,
    mut maps: ResMut<DirectionalLightShadowMap>,
    mut sizes: Local<[usize; 2]>,
    is_patched: Res<IsPatched>,
) {
    if maps.size != sizes[1] {
        sizes[0] = maps.size;
    }
    maps.size = sizes[0];
    let targets = cameras
        .iter()
        .filter_map(|(camera, _)| camera.physical_target_size);
    let pixels = targets.map(|size| (size.x * size.y) as usize).max();
    let pixels = pixels.unwrap_or_default();
    let are_own = cameras.iter().all(|(_, msaa)| *msaa == Msaa::Off);
    for (light, is_own) in &mut directional {
        let light = light.into_inner();
        let is_own = is_own && !light.volumetric && is_patched.get();
        set_mark(&mut light.shadow_depth_bias, is_own);
        let bounds = &mut light.cascade_shadow_config.bounds;
        if is_own && !bounds.is_empty() {
            maps.size = maps.size.max(side(pixels.div_ceil(bounds.len())));
            if are_own {
                bounds.truncate(pixels.div_ceil(maps.size * maps.size).max(1));
            }
        }
    }
    for (light, is_own) in &mut spots {
        let light = light.into_inner();
        let is_spot = light.spot_light_angles.is_some() && !light.volumetric;
        let is_own = is_own && is_spot && are_own && is_patched.get();
        set_mark(&mut light.shadow_depth_bias, is_own);
        if is_own && light.shadow_maps_enabled {
            maps.size = maps.size.max(side(pixels));
        }
    }
    sizes[1] = maps.size;
}

/// A side, such as Bevy's maps have, of a square of so many texels.
fn side(texels: usize) -> usize {
    let below = texels.isqrt();
    (below + usize::from(below * below < texels)).next_power_of_two()
}

/// True for a light whose shadows are those of a preset in this frame.
pub fn is_marked(depth_bias: f32) -> bool {
    depth_bias.to_bits() & 1 == 1
}

fn set_mark(bias: &mut f32, is_marked: bool) {
    *bias = f32::from_bits(bias.to_bits() & !1 | u32::from(is_marked));
}
