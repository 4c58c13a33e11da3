//! Writes a camera's matrices in the conventions that engines use.
//!
//! ```
//! use skiagraph_compare::foreign::conventions::CameraRecord;
//!
//! let scene = skiagraph_cases::case("box_on_floor").ok_or("it is in the catalogue")?.scene();
//! let record = CameraRecord::new(&scene, &scene.views[0], [64, 48]);
//! assert!(record.projections.iter().any(|of| of.used_by.contains("Bevy")));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::records::results::PROGRAM;
use glam::{DMat4, DVec4};
use serde::Serialize;
use skiagraph_scene::{Camera, LightKind, Scene, View};

/// Content of `camera.json`: the camera of a view in a viewport, its light, and its matrices.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CameraRecord {
    /// Version of this schema: 1.
    pub schema: u32,
    /// The program that wrote the file, `skiagraph 0.1.0`.
    pub program: String,
    /// Name of the scene.
    pub scene: String,
    /// Name of the view.
    pub view: String,
    /// Width and height in pixels. Pixel centres lie at half pixels, counted from the top left.
    pub viewport: [u32; 2],
    /// Handedness and units of world space: `right-handed, in scene units`.
    pub world: String,
    /// Position of the eye, world space.
    pub eye: [f64; 3],
    /// Unit viewing direction, world space.
    pub forward: [f64; 3],
    /// Unit vector to the right of the picture, world space.
    pub right: [f64; 3],
    /// Unit vector to the top of the picture, world space.
    pub up: [f64; 3],
    /// Vertical field of view in degrees.
    pub fov_y_degrees: f64,
    /// Horizontal field of view in degrees.
    pub fov_x_degrees: f64,
    /// Width divided by height.
    pub aspect: f64,
    /// Distance of the near plane along `forward`, scene units.
    pub near: f64,
    /// Distance of the far plane along `forward`, scene units.
    pub far: f64,
    /// The light of the view, under which its shadows were computed.
    pub light: LightRecord,
    /// Matrices from world space to the camera's space, one for each direction (−z or +z) in which
    /// the camera may look.
    pub views: Vec<NamedMatrix>,
    /// Matrices from the camera's space to clip space, and from world space to clip space, one pair
    /// for each convention of axes and depths.
    pub projections: Vec<Projection>,
}

/// A light, as `camera.json` holds it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LightRecord {
    /// `directional`, `spot` or `point`.
    pub kind: String,
    /// Unit vector, world space: the direction in which a directional light travels, or the axis of
    /// a spot light's cone, away from the light; absent for a point light.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction: Option<[f64; 3]>,
    /// Position of a spot or point light, world space; absent for a directional light.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position: Option<[f64; 3]>,
    /// Whole angle of a spot light's cone in degrees; absent for other lights.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cone_degrees: Option<f64>,
    /// Angular diameter of a directional light in degrees, 0 for hard shadows; absent for other
    /// lights.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle_degrees: Option<f64>,
    /// Radius of a spot or point light in scene units, 0 for hard shadows; absent for a directional
    /// light.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
}

/// A matrix M for column vectors (M · p), in both orders in which files and engines store it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Matrix {
    /// The matrix's four rows. For row vectors (p · M, the convention of DirectXMath) read
    /// `column_major` as the rows.
    pub rows: [[f64; 4]; 4],
    /// The matrix's sixteen numbers column by column, the order of OpenGL, glam and WGSL.
    pub column_major: [f64; 16],
    /// The matrix's sixteen numbers row by row, the order of HLSL's `row_major`.
    pub row_major: [f64; 16],
}

/// A view matrix with its convention.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NamedMatrix {
    /// `looks_along_minus_z` (right-handed) or `looks_along_plus_z` (left-handed).
    pub name: String,
    /// Directions of the x, y and z axis of the camera's space as seen by the camera, such as
    /// `right`, `up` and `back`.
    pub axes: [String; 3],
    /// Matrix from world space to the camera's space.
    pub world_to_camera: Matrix,
}

/// A projection with its convention.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Projection {
    /// Name made of the parts of the convention: `minus_z_y_up_reversed`.
    pub name: String,
    /// Engines and interfaces with this convention; empty for a rarer one.
    pub used_by: String,
    /// [Name](NamedMatrix::name) of the camera's space that the projection takes positions in, an
    /// entry of [`CameraRecord::views`].
    pub camera_space: String,
    /// Side of the picture to which y grows in clip space: `up` or `down`.
    pub clip_y: String,
    /// Depth (z divided by w) at the near plane.
    pub depth_near: f64,
    /// Depth (z divided by w) at the far plane, or infinitely far away if `is_infinite`.
    pub depth_far: f64,
    /// True if the projection has no far plane.
    pub is_infinite: bool,
    /// Matrix from the camera's space to clip space.
    pub camera_to_clip: Matrix,
    /// Matrix from world space to clip space.
    pub world_to_clip: Matrix,
}

impl From<DMat4> for Matrix {
    fn from(matrix: DMat4) -> Self {
        Self {
            rows: matrix.transpose().to_cols_array_2d(),
            column_major: matrix.to_cols_array(),
            row_major: matrix.transpose().to_cols_array(),
        }
    }
}

impl LightRecord {
    fn new(mut light: LightKind) -> Self {
        let kind = light.word().into();
        let parameters = light.parameters();
        Self {
            kind,
            direction: parameters.direction.map(|it| it.normalize().to_array()),
            position: parameters.position.map(|at| at.to_array()),
            cone_degrees: parameters.cone_degrees.copied(),
            angle_degrees: parameters.angle_degrees.copied(),
            radius: parameters.radius.copied(),
        }
    }
}

/// Depths at the near and the far plane.
const DEPTHS: [(&str, [f64; 2], bool); 4] = [
    ("reversed", [1.0, 0.0], false),
    ("reversed_infinite", [1.0, 0.0], true),
    ("zero_to_one", [0.0, 1.0], false),
    ("minus_one_to_one", [-1.0, 1.0], false),
];

impl CameraRecord {
    /// Describes the camera and the light of a view in a viewport.
    pub fn new(scene: &Scene, view: &View, viewport: [u32; 2]) -> Self {
        let camera = view.camera(viewport);
        let degrees = |half: f64| half.atan().to_degrees() * 2.0;
        let spaces = [("minus_z", -1.0), ("plus_z", 1.0)];
        let named = |(name, z): (&str, f64)| NamedMatrix {
            name: format!("looks_along_{name}"),
            axes: ["right", "up", if z < 0.0 { "back" } else { "forward" }].map(Into::into),
            world_to_camera: world_to_camera(&camera, z).into(),
        };
        let projections = spaces.iter().flat_map(|space| {
            let sides = [("y_up", 1.0), ("y_down", -1.0)].into_iter();
            let each = sides.flat_map(|side| DEPTHS.map(|depth| (side, depth)));
            each.map(|(side, depth)| projection(&camera, *space, side, depth))
        });
        Self {
            schema: 1,
            program: PROGRAM.into(),
            scene: scene.name.clone(),
            view: view.name.clone(),
            viewport,
            world: "right-handed, in scene units".into(),
            eye: camera.eye.to_array(),
            forward: camera.forward.to_array(),
            right: camera.right.to_array(),
            up: camera.up.to_array(),
            fov_y_degrees: degrees(camera.half_height),
            fov_x_degrees: degrees(camera.half_width),
            aspect: camera.half_width / camera.half_height,
            near: camera.near,
            far: camera.far,
            light: LightRecord::new(scene.light_of(view)),
            views: spaces.map(named).into(),
            projections: projections.collect(),
        }
    }
}

/// To a space whose z grows along the view, or against it.
fn world_to_camera(camera: &Camera, z: f64) -> DMat4 {
    let axes = [camera.right, camera.up, camera.forward * z];
    let [x, y, z] = axes.map(|axis| axis.extend(0.0));
    let rotation = DMat4::from_cols(x, y, z, DVec4::W).transpose();
    rotation * DMat4::from_translation(-camera.eye)
}

fn projection(
    camera: &Camera,
    (space, z): (&str, f64),
    (side, y): (&str, f64),
    (word, [at_near, at_far], is_infinite): (&str, [f64; 2], bool),
) -> Projection {
    // Depth is a + b / distance.
    let Camera { near, far, .. } = *camera;
    let (a, b) = if is_infinite {
        (at_far, (at_near - at_far) * near)
    } else {
        let b = (at_near - at_far) / (1.0 / near - 1.0 / far);
        (at_far - b / far, b)
    };
    let camera_to_clip = DMat4::from_cols(
        DVec4::X / camera.half_width,
        DVec4::Y * (y / camera.half_height),
        DVec4::new(0.0, 0.0, a * z, z),
        DVec4::new(0.0, 0.0, b, 0.0),
    );
    let name = format!("{space}_{side}_{word}");
    let used_by = match name.as_str() {
        "minus_z_y_up_reversed" => "Skiagraph; wgpu with reversed depths",
        "minus_z_y_up_reversed_infinite" => "Bevy",
        "minus_z_y_up_zero_to_one" => {
            "WebGPU, Metal and Direct3D with right-handed cameras; three.js on WebGPU"
        }
        "minus_z_y_up_minus_one_to_one" => "OpenGL, WebGL, three.js on WebGL",
        "minus_z_y_down_zero_to_one" => "Vulkan without a flipped viewport",
        "plus_z_y_up_zero_to_one" => "Direct3D and Metal with left-handed cameras",
        "plus_z_y_up_reversed_infinite" => "Unreal Engine, whose world is left-handed with z up",
        _ => "",
    };
    Projection {
        used_by: used_by.into(),
        camera_space: format!("looks_along_{space}"),
        clip_y: if y > 0.0 { "up" } else { "down" }.into(),
        depth_near: at_near,
        depth_far: at_far,
        is_infinite,
        camera_to_clip: camera_to_clip.into(),
        world_to_clip: (camera_to_clip * world_to_camera(camera, z)).into(),
        name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record() -> (Camera, CameraRecord) {
        let scene = skiagraph_cases::case("box_on_floor").unwrap().scene();
        let view = &scene.views[0];
        (
            view.camera([40, 20]),
            CameraRecord::new(&scene, view, [40, 20]),
        )
    }

    #[test]
    fn every_matrix_takes_pixels_to_where_it_says() {
        let (camera, record) = record();
        assert_eq!(record.projections.len(), 16);
        for projection in &record.projections {
            let matrix = DMat4::from_cols_array(&projection.world_to_clip.column_major);
            for (x, y) in [(0, 0), (39, 19), (7, 12)] {
                for distance in [camera.near, camera.far, (camera.near * camera.far).sqrt()] {
                    let point = camera.eye + camera.pixel_direction(x, y) * distance;
                    let clip = matrix.project_point3(point);
                    let across = (f64::from(x) + 0.5) / 20.0 - 1.0;
                    let up = 1.0 - (f64::from(y) + 0.5) / 10.0;
                    let up = if projection.clip_y == "up" { up } else { -up };
                    assert!((clip.x - across).abs() < 1e-9, "{}", projection.name);
                    assert!((clip.y - up).abs() < 1e-9, "{}", projection.name);
                    let share = (1.0 / distance - 1.0 / camera.far)
                        / (1.0 / camera.near - 1.0 / camera.far);
                    let share = if projection.is_infinite {
                        camera.near / distance
                    } else {
                        share
                    };
                    let depth = projection.depth_far
                        + (projection.depth_near - projection.depth_far) * share;
                    assert!(
                        (clip.z - depth).abs() < 1e-9,
                        "{}: {} {depth}",
                        projection.name,
                        clip.z
                    );
                }
            }
            let rows = projection.world_to_clip.rows.concat();
            assert_eq!(
                rows, projection.world_to_clip.row_major,
                "{}",
                projection.name
            );
        }
        let own = &record.projections[0].world_to_clip.column_major;
        let expected = camera.view_projection().to_cols_array();
        let near = own
            .iter()
            .zip(expected)
            .all(|(one, other)| (one - other).abs() < 1e-12);
        assert!(near, "{own:?}");
    }

    #[test]
    fn every_known_convention_is_written() {
        let (_, record) = record();
        let used = record
            .projections
            .iter()
            .filter(|projection| !projection.used_by.is_empty());
        assert_eq!(used.count(), 7);
    }
}
