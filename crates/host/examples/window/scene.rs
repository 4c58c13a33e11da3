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
    pub color: [f32; 4],
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

    fn torus(color: [f32; 4], ring: f32, tube: f32) -> Self {
        let model = Self {
            color,
            ..Self::default()
        };
        model.sheet([128, 48], |s, t| {
            // The last column is the first: equal positions to the bit, so that the mesh is closed.
            let ((sin, cos), (up, out)) =
                ((TAU * (s % 1.0)).sin_cos(), (TAU * (t % 1.0)).sin_cos());
            let outwards = Vec3::new(cos, 0.0, -sin);
            let normal = outwards * out + Vec3::Y * up;
            [outwards * ring + normal * tube, normal]
        })
    }

    fn cuboid(color: [f32; 4], half: Vec3) -> Self {
        let [x, y, z] = Vec3::AXES;
        let mut model = Self {
            color,
            ..Self::default()
        };
        for [normal, right, up] in [[x, y, z], [y, z, x], [z, x, y]] {
            for (normal, right) in [(normal, right), (-normal, -right)] {
                let at = |s, t| normal + right * (2.0 * s - 1.0) + up * (2.0 * t - 1.0);
                model = model.sheet([1, 1], |s, t| [half * at(s, t), normal]);
            }
        }
        model
    }
}

pub fn models() -> Vec<Model> {
    let cuboid = |color, x, y, z| Model::cuboid(color, Vec3::new(x, y, z));
    vec![
        cuboid([0.55, 0.55, 0.5, 1.0], 12.0, 0.25, 12.0),
        Model::torus([0.85, 0.45, 0.15, 1.0], 1.2, 0.4),
        cuboid([0.3, 0.45, 0.7, 1.0], 0.5, 1.2, 0.5),
        cuboid([0.65, 0.2, 0.2, 1.0], 0.45, 0.45, 0.45),
        cuboid([0.25, 0.55, 0.3, 1.0], 0.9, 0.1, 0.5),
    ]
}

/// The scene at a time: camera, sun, and a place for each of [`models`].
pub struct Moment {
    pub view: DMat4,
    /// Reversed depth without a far plane.
    pub projection: DMat4,
    pub to_sun: DVec3,
    pub places: Vec<DAffine3>,
}

impl Moment {
    pub fn new(seconds: f64, [width, height]: [u32; 2]) -> Self {
        let eye = DVec3::new(0.0, 5.5, 9.0);
        let aspect = f64::from(width) / f64::from(height);
        let turned = |turn, x, y, z| DAffine3::from_rotation_translation(turn, DVec3::new(x, y, z));
        let (swing, spin) = ((0.8 * seconds).sin(), DQuat::from_rotation_y(seconds));
        Self {
            view: view::look_at_mat4(eye, DVec3::new(0.0, 0.6, 0.0), DVec3::Y),
            projection: perspective_infinite_reverse(0.7, aspect, 0.1),
            to_sun: DVec3::new((0.4 * seconds).cos(), 1.1, (0.4 * seconds).sin()).normalize(),
            places: vec![
                turned(DQuat::IDENTITY, 0.0, -0.25, 0.0),
                turned(spin * DQuat::from_rotation_x(0.9), 0.0, 1.8, 0.0),
                turned(DQuat::IDENTITY, -2.8, 1.2, -0.8),
                turned(DQuat::IDENTITY, 2.5 * swing, 0.45, 2.2),
                turned(spin, 2.7, 1.3 + 0.5 * swing, -0.6),
            ],
        }
    }
}
