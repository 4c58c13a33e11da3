//! The program's own scene: its meshes, and where everything is at a time.

use skiagraph_host::glam::dcamera::rh::{proj::directx::perspective_infinite_reverse, view};
use skiagraph_host::glam::{DAffine3, DMat4, DQuat, DVec3, Vec3};
use std::f32::consts::TAU;

/// Triangles in model space, counter-clockwise seen from outside.
#[derive(Default)]
pub struct Model {
    pub positions: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
    pub indices: Vec<u32>,
}

impl Model {
    /// Adds a sheet of so many cells: `at` maps (0, 0) to (1, 1) to positions and normals.
    fn sheet(mut self, [columns, rows]: [u32; 2], at: impl Fn(f32, f32) -> [Vec3; 2]) -> Self {
        let (first, row) = (self.positions.len() as u32, columns + 1);
        for (y, x) in (0..=rows).flat_map(|y| (0..row).map(move |x| (y, x))) {
            let [position, normal] = at(x as f32 / columns as f32, y as f32 / rows as f32);
            self.positions.push(position.into());
            self.normals.push(normal.into());
            if x < columns && y < rows {
                let a = first + y * row + x;
                let (b, c, d) = (a + 1, a + row + 1, a + row);
                self.indices.extend([a, b, c, a, c, d]);
            }
        }
        self
    }
}

/// A cube of half edge 1, and a torus.
pub fn models() -> [Model; 2] {
    let mut cube = Model::default();
    let [x, y, z] = Vec3::AXES;
    for [normal, right, up] in [[x, y, z], [y, z, x], [z, x, y]] {
        for (normal, right) in [(normal, right), (-normal, -right)] {
            let at = |s, t| normal + right * (2.0 * s - 1.0) + up * (2.0 * t - 1.0);
            cube = cube.sheet([1, 1], |s, t| [at(s, t), normal]);
        }
    }
    let torus = Model::default().sheet([128, 48], |s, t| {
        // The last column is the first: equal positions to the bit, so that the mesh is closed.
        let ((sin, cos), (up, out)) = ((TAU * (s % 1.0)).sin_cos(), (TAU * (t % 1.0)).sin_cos());
        let outwards = Vec3::new(cos, 0.0, -sin);
        let normal = outwards * out + Vec3::Y * up;
        [outwards * 1.2 + normal * 0.4, normal]
    });
    [cube, torus]
}

/// Model and colour of each part: the ground, the torus, three boxes.
pub const PARTS: [(usize, [f32; 4]); 5] = [
    (0, [0.55, 0.55, 0.5, 1.0]),
    (1, [0.85, 0.45, 0.15, 1.0]),
    (0, [0.3, 0.45, 0.7, 1.0]),
    (0, [0.65, 0.2, 0.2, 1.0]),
    (0, [0.25, 0.55, 0.3, 1.0]),
];

/// The scene at a time: camera, sun, and a place for each of [`PARTS`].
pub struct Moment {
    /// Width and height of the picture in pixels.
    pub size: [u32; 2],
    pub view: DMat4,
    /// Reversed depth without a far plane.
    pub projection: DMat4,
    pub to_sun: DVec3,
    pub places: [DAffine3; 5],
}

impl Moment {
    pub fn new(seconds: f64, size: [u32; 2]) -> Self {
        let [width, height] = size.map(f64::from);
        let put = |size: [f64; 3], turn, at: [f64; 3]| {
            DAffine3::from_scale_rotation_translation(size.into(), turn, at.into())
        };
        let (swing, spin) = ((0.8 * seconds).sin(), DQuat::from_rotation_y(seconds));
        let (still, tilt) = (DQuat::IDENTITY, spin * DQuat::from_rotation_x(0.9));
        Self {
            size,
            view: view::look_at_mat4([0.0, 5.5, 9.0].into(), [0.0, 0.6, 0.0].into(), DVec3::Y),
            projection: perspective_infinite_reverse(0.7, width / height, 0.1),
            to_sun: DVec3::new((0.4 * seconds).cos(), 1.1, (0.4 * seconds).sin()).normalize(),
            places: [
                put([12.0, 0.25, 12.0], still, [0.0, -0.25, 0.0]),
                put([1.0; 3], tilt, [0.0, 1.8, 0.0]),
                put([0.5, 1.2, 0.5], still, [-2.8, 1.2, -0.8]),
                put([0.45; 3], still, [2.5 * swing, 0.45, 2.2]),
                put([0.9, 0.1, 0.5], spin, [2.7, 1.3 + 0.5 * swing, -0.6]),
            ],
        }
    }
}
