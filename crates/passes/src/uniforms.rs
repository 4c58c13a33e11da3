//! What shaders know of the camera and the light. The structs of `shaders/shared/camera.wgsl` and
//! `light.wgsl` are laid out alike; a test compares both with what naga makes of them.

use glam::{Mat3, Mat4, Vec3};
use skiagraph_scene::{Camera, DirectionalLight, Mesh};

/// WGSL's `Camera`: a perspective camera, 80 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct CameraUniform {
    /// Eye, world space, rounded to f32.
    pub eye: Vec3,
    /// Near plane distance.
    pub near: f32,
    /// What rounding the eye left over, so that corners far from the origin keep their distance to
    /// the eye.
    pub eye_low: Vec3,
    /// Far plane distance.
    pub far: f32,
    /// Unit vector to the right of the image.
    pub right: Vec3,
    /// Half the image's width at distance 1.
    pub half_width: f32,
    /// Unit vector to the top of the image.
    pub up: Vec3,
    /// Half the image's height at distance 1.
    pub half_height: f32,
    /// Unit viewing direction.
    pub forward: Vec3,
    /// far / (far − near): clip z per unit of distance beyond the near plane.
    pub depth_scale: f32,
}

impl From<&Camera> for CameraUniform {
    fn from(camera: &Camera) -> Self {
        let eye = camera.eye.as_vec3();
        Self {
            eye,
            near: camera.near as f32,
            eye_low: (camera.eye - eye.as_dvec3()).as_vec3(),
            far: camera.far as f32,
            right: camera.right.as_vec3(),
            half_width: camera.half_width as f32,
            up: camera.up.as_vec3(),
            half_height: camera.half_height as f32,
            forward: camera.forward.as_vec3(),
            depth_scale: (camera.far / (camera.far - camera.near)) as f32,
        }
    }
}

/// WGSL's `Light`: a directional light and the light space fitted to the scene's corners,
/// 112 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct LightUniform {
    /// From a position relative to `centre` to the light's clip space (w stays 1; z in 0..1 grows
    /// away from the light).
    pub clip_from_relative: Mat4,
    /// Unit vector towards the light.
    pub to_light: Vec3,
    /// No two points of the scene are farther apart.
    pub max_distance: f32,
    /// Centre of the scene's box, world space: a matrix on absolute positions would lose the detail
    /// of a far-off scene.
    pub centre: Vec3,
    /// The most that is summed up, sizes alone, for clip x or y of a point in the scene's box: what
    /// their rounding is a share of.
    pub corner_across: f32,
    /// World units per unit of light-space clip x, y and z.
    pub extent: Vec3,
    /// The same for clip z.
    pub corner_along: f32,
}

impl LightUniform {
    /// The light over all corners of a mesh; an empty one counts as a point at the origin.
    pub fn new(light: &DirectionalLight, mesh: &Mesh) -> Self {
        let (min, max) = mesh.bounds().unwrap_or((Vec3::ZERO, Vec3::ZERO));
        let fit = light.fit(mesh.corner_positions());
        let (min, max) = (min.as_dvec3(), max.as_dvec3());
        let centre = ((min + max) * 0.5).as_vec3();
        let to_relative = glam::DMat4::from_translation(centre.as_dvec3());
        let clip_from_relative = (fit.view_projection * to_relative).as_mat4();
        let matrix = Mat3::from_mat4(clip_from_relative);
        let half = ((max - min) * 0.5).as_vec3();
        let summed = Mat3::from_cols(
            matrix.x_axis.abs(),
            matrix.y_axis.abs(),
            matrix.z_axis.abs(),
        ) * half;
        Self {
            clip_from_relative,
            to_light: light.to_light().as_vec3(),
            // Doubled: receivers may lie a rounding outside of the box, and it costs nothing.
            max_distance: (2.0 * min.distance(max)) as f32,
            centre,
            corner_across: summed.x.max(summed.y),
            extent: fit.extent.as_vec3(),
            corner_along: summed.z,
        }
    }
}

/// WGSL's `LightArea`: how far the light reaches around its centre, 32 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct LightAreaUniform {
    /// From the light's centre, at distance 1, to its rim.
    pub right: Vec3,
    /// Length of `right` and of `up`; 0 for a light without extent.
    pub radius: f32,
    /// The same at a right angle.
    pub up: Vec3,
    /// Unused.
    pub padding: f32,
}

impl From<&DirectionalLight> for LightAreaUniform {
    fn from(light: &DirectionalLight) -> Self {
        let [right, up] = light.across().map(|axis| axis.as_vec3());
        Self {
            right,
            radius: right.length(),
            up,
            padding: 0.0,
        }
    }
}
