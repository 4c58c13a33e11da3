//! What the cases are built from.

use crate::{DirectionalLight, Mesh, Scene, View, weld::Welder};
use glam::{DVec3, Vec3};

/// Triangles by their corners, flat-shaded unless told otherwise.
#[derive(Default)]
pub(super) struct Shape {
    corners: Vec<[Vec3; 3]>,
}

impl Shape {
    /// One triangle, counter-clockwise seen from outside.
    pub fn triangle(mut self, corners: [[f32; 3]; 3]) -> Self {
        self.corners.push(corners.map(Vec3::from));
        self
    }

    /// A plane quadrilateral, counter-clockwise seen from outside.
    pub fn quad(self, [a, b, c, d]: [[f32; 3]; 4]) -> Self {
        self.triangle([a, b, c]).triangle([a, c, d])
    }

    /// A horizontal square that faces up, around the origin.
    pub fn floor(self, half: f32, y: f32) -> Self {
        self.quad([
            [-half, y, half],
            [half, y, half],
            [half, y, -half],
            [-half, y, -half],
        ])
    }

    /// A closed box between two corners.
    pub fn cuboid(self, low: [f32; 3], high: [f32; 3]) -> Self {
        let at = |x: usize, y: usize, z: usize| {
            let pick = |axis: usize, upper: usize| if upper == 1 { high[axis] } else { low[axis] };
            [pick(0, x), pick(1, y), pick(2, z)]
        };
        self.quad([at(0, 1, 1), at(1, 1, 1), at(1, 1, 0), at(0, 1, 0)])
            .quad([at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1)])
            .quad([at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1)])
            .quad([at(1, 0, 0), at(0, 0, 0), at(0, 1, 0), at(1, 1, 0)])
            .quad([at(1, 0, 1), at(1, 0, 0), at(1, 1, 0), at(1, 1, 1)])
            .quad([at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0)])
    }

    /// The mesh: positions welded, one normal per triangle (upward where it has no area).
    pub fn mesh(self) -> Mesh {
        let mut welder = Welder::default();
        let mut mesh = Mesh::default();
        for corners in self.corners {
            let [a, b, c] = corners.map(|p| p.as_dvec3());
            let normal = (b - a).cross(c - a).try_normalize().unwrap_or(DVec3::Y);
            let place = mesh.normals.len() as u32;
            mesh.normals.push(normal.as_vec3());
            mesh.normal_indices.push([place; 3]);
            mesh.triangles.push(corners.map(|p| welder.index(p)));
        }
        mesh.positions = welder.values;
        mesh
    }

    /// The scene, seen by a camera at `eye` that looks at `target`, up being y unless that is where it looks.
    pub fn scene(self, name: &str, eye: DVec3, target: DVec3, light: DVec3) -> Scene {
        let direction = target - eye;
        let upright = direction.normalize().y.abs() < 0.99;
        Scene {
            name: name.into(),
            mesh: self.mesh(),
            views: vec![View {
                name: "main".into(),
                eye,
                direction,
                up: if upright { DVec3::Y } else { DVec3::NEG_Z },
                fov_y_degrees: 45.0,
                near: 0.01 * direction.length(),
                far: 100.0 * direction.length(),
            }],
            light: DirectionalLight { direction: light },
        }
    }
}
