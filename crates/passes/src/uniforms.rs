//! Uniforms of the camera and the light, laid out like the structs of `shaders/shared/camera.wgsl`
//! and `light.wgsl`. A test checks this with naga.
//!
//! ```
//! use glam::DVec3;
//! use skiagraph_passes::uniforms::LightUniform;
//! use skiagraph_scene::{DirectionalLight, Indexed};
//!
//! let square = [[0.0; 3], [0.0, 0.0, 8.0], [8.0, 0.0, 8.0], [8.0, 0.0, 0.0]];
//! let mesh = Indexed {
//!     positions: &square,
//!     normals: &[],
//!     indices: &[0, 1, 2, 0, 2, 3],
//! }
//! .mesh()?;
//! let light = LightUniform::new(DirectionalLight::new(DVec3::NEG_Y), &mesh);
//! assert_eq!(light.to_light, glam::Vec3::Y);
//! assert_eq!(bytemuck::bytes_of(&light).len(), 144);
//! # Ok::<(), skiagraph_scene::IndexedError>(())
//! ```

use glam::{DMat4, DVec3, Mat3, Mat4, Vec2, Vec3};
use skiagraph_scene::{Camera, DirectionalLight, LightFit, LightKind, Mesh, light::across};

/// The struct `Camera` of `shaders/shared/camera.wgsl`: a perspective camera with reversed depth (1
/// near, 0 far), 96 bytes. Positions and vectors are in world space, distances in scene units.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct CameraUniform {
    /// Eye position, world space, rounded to f32.
    pub eye: Vec3,
    /// Distance of the near plane from the eye, along `forward`, in scene units.
    pub near: f32,
    /// Exact eye position minus `eye`, in scene units, with which shaders compute positions
    /// relative to the eye without losing detail far from the origin.
    pub eye_low: Vec3,
    /// Distance of the far plane from the eye, along `forward`, in scene units.
    pub far: f32,
    /// Unit vector to the right of the image, world space.
    pub right: Vec3,
    /// Half the image's width at distance 1 from the eye, in scene units.
    pub half_width: f32,
    /// Unit vector to the top of the image, world space.
    pub up: Vec3,
    /// Half the image's height at distance 1 from the eye, in scene units.
    pub half_height: f32,
    /// Unit viewing direction, from the eye into the image, world space.
    pub forward: Vec3,
    /// near / (far − near): clip z (before the division by w) per unit of distance from the far
    /// plane towards the eye. Clip z is 0 at the far plane.
    pub depth_scale: f32,
    /// Offset of each pixel's ray from the pixel's centre, in pixels, x right, y down, within ±0.5;
    /// 0 without jitter.
    pub jitter: Vec2,
    /// The offset `jitter` in clip space (−1 to 1 across the image), y up; 0 without jitter.
    pub jitter_clip: Vec2,
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
            depth_scale: (camera.near / (camera.far - camera.near)) as f32,
            jitter: camera.jitter.as_vec2(),
            jitter_clip: camera.jitter_clip().as_vec2(),
        }
    }
}

/// The struct `Unprojection` of `shaders/shared/unprojection.wgsl`, with which shaders reconstruct
/// positions from a depth buffer, 96 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct UnprojectionUniform {
    /// Matrix from clip coordinates (x, y, depth, 1) to world space relative to the eye; the shader
    /// divides the result by w.
    pub relative_from_clip: Mat4,
    /// Eye position, world space, rounded to f32.
    pub origin: Vec3,
    /// 1 if the near plane has depth 1 in the depth buffer, 0 if it has depth 0.
    pub is_reversed: u32,
    /// Exact eye position minus `origin`, in scene units.
    pub origin_low: Vec3,
    /// Unused filler at the end of the struct.
    pub padding: f32,
}

/// The struct `Light` of `shaders/shared/light.wgsl`: a light and its light space (the space of its
/// shadow map), 144 bytes. The light space of a directional light is fitted to the corners of the
/// scene's triangles.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct LightUniform {
    /// Matrix to the light's clip space, in which z grows from 0 to 1 away from the light. For a
    /// directional light it maps positions relative to `centre`, and w stays 1. For a spot light it
    /// maps positions relative to the light: w is the distance along the axis, x and y reach from
    /// −w to w across the map, and z, which is not divided by w, is w / `range`. For a point light
    /// the matrix is 0.
    pub clip_from_relative: Mat4,
    /// Unit vector, world space: towards a directional light; for a spot light, the reverse of its
    /// axis; for a point light, 0.
    pub to_light: Vec3,
    /// Upper bound on the distance between any two points of the scene's mesh, in scene units.
    pub max_distance: f32,
    /// Centre of the scene's bounding box, world space. For a directional light
    /// `clip_from_relative` takes positions relative to it, because absolute ones would lose the
    /// detail of a far-off scene.
    pub centre: Vec3,
    /// Largest sum of |matrix entry · coordinate| in the computation of clip x or clip y, over all
    /// points of the scene's bounding box. The f32 rounding error of clip x and y is proportional
    /// to it. 0 for spot and point lights.
    pub corner_across: f32,
    /// Scene units per unit of the light's clip x, y and z; for a spot light, at the distance
    /// `range`. For a point light each is `range`.
    pub extent: Vec3,
    /// Largest sum of |matrix entry · coordinate| in the computation of clip z, over the same
    /// points as for `corner_across`. 0 for spot and point lights.
    pub corner_along: f32,
    /// Position of a spot or point light, world space, rounded to f32; 0 for a directional light.
    pub position: Vec3,
    /// Cosine of the angle between a spot light's axis and the edge of its cone; 0 for other
    /// lights.
    pub edge_cosine: f32,
    /// Exact light position minus `position`, in scene units; 0 for a directional light.
    pub position_low: Vec3,
    /// Upper bound on the distance from a spot or point light to any point of the scene, in scene
    /// units; 0 for a directional light.
    pub range: f32,
}

impl LightUniform {
    /// Creates the uniform of a light whose light space and bounds enclose `mesh`. An empty mesh
    /// counts as a point at the origin.
    pub fn new(light: impl Into<LightKind>, mesh: &Mesh) -> Self {
        let fit = |light: &DirectionalLight| light.fit(mesh.used_positions());
        Self::around(light.into(), mesh.bounds(), fit)
    }

    /// Creates the uniform of a light whose bounds are a box, if there is one, and whose light
    /// space is that which `fit` makes for a directional light.
    pub(crate) fn around(
        light: LightKind,
        bounds: Option<(Vec3, Vec3)>,
        fit: impl FnOnce(&DirectionalLight) -> LightFit,
    ) -> Self {
        let (min, max) = bounds.unwrap_or((Vec3::ZERO, Vec3::ZERO));
        let bounds = (min.as_dvec3(), max.as_dvec3());
        if let Some(sun) = light.directional() {
            return Self::directional(sun, bounds, fit(sun));
        }
        let axis = light.direction().map(DVec3::normalize);
        let placed = Self {
            to_light: axis.map_or(Vec3::ZERO, |axis| -axis.as_vec3()),
            edge_cosine: light.edge_cosine().unwrap_or(0.0) as f32,
            ..Self::at(light.position().unwrap_or_default(), bounds)
        };
        match (axis, light.cone_degrees()) {
            (Some(axis), Some(degrees)) => placed.with_cone(axis, degrees),
            _ => placed,
        }
    }

    /// A light at a place.
    fn at(position: DVec3, (min, max): (DVec3, DVec3)) -> Self {
        let rounded = position.as_vec3();
        let farthest = (position - min).abs().max((position - max).abs()).length();
        // A hair more, as of a directional light's box; and no scene is a point to divide by.
        let range = (farthest * 1.002).max(1e-12) as f32;
        Self {
            max_distance: (2.0 * min.distance(max)) as f32,
            centre: ((min + max) * 0.5).as_vec3(),
            extent: Vec3::splat(range),
            position: rounded,
            position_low: (position - rounded.as_dvec3()).as_vec3(),
            range,
            ..Self::default()
        }
    }

    /// With the light space of a light that lights a cone around `forward`.
    fn with_cone(self, forward: DVec3, degrees: f64) -> Self {
        let (right, up) = across(forward);
        let half_width = (degrees * 0.5).to_radians().tan();
        let rows = [
            (right / half_width).extend(0.0),
            (up / half_width).extend(0.0),
            (forward / f64::from(self.range)).extend(0.0),
            forward.extend(0.0),
        ];
        let across = self.range * half_width as f32;
        Self {
            clip_from_relative: DMat4::from_cols_array_2d(&rows.map(|row| row.to_array()))
                .transpose()
                .as_mat4(),
            extent: Vec3::new(across, across, self.range),
            ..self
        }
    }

    fn directional(light: &DirectionalLight, (min, max): (DVec3, DVec3), fit: LightFit) -> Self {
        let centre = ((min + max) * 0.5).as_vec3();
        let to_relative = DMat4::from_translation(centre.as_dvec3());
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
            ..Self::default()
        }
    }
}

/// The struct `LightArea` of `shaders/shared/light_area.wgsl`: the disk of an area light, around
/// its centre, 32 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct LightAreaUniform {
    /// Vector from the light's centre to its rim, in scene units; for a directional light, on a
    /// disk at distance 1 from the receiver. 0 for a point light, whose disk faces each receiver.
    pub right: Vec3,
    /// Radius of the light's disk in scene units (for a directional light, at distance 1); 0 for a
    /// light without extent.
    pub radius: f32,
    /// Second vector from the light's centre to its rim, at a right angle to `right` and of the
    /// same length.
    pub up: Vec3,
    /// Unused filler at the end of the struct.
    pub padding: f32,
}

impl From<&LightKind> for LightAreaUniform {
    fn from(light: &LightKind) -> Self {
        let (axis, radius) = light.disk();
        let (right, up) = axis.map_or_else(Default::default, |axis| axis.any_orthonormal_pair());
        Self {
            right: (right * radius).as_vec3(),
            radius: radius as f32,
            up: (up * radius).as_vec3(),
            padding: 0.0,
        }
    }
}
