//! Builds the meshes and views of the cases.

use glam::{DVec3, Vec3};
use skiagraph_scene::{DirectionalLight, Light, LightKind, Mesh, Scene, View, weld::Welder};

/// Direction of the light of most cases: along no axis, and steep enough for short shadows.
pub(crate) const LIGHT: DVec3 = DVec3::new(0.8, -1.0, 0.43);

/// The lower and the upper corner of a box.
pub(crate) type Block = [[f32; 3]; 2];

/// Triangles by their corners in scene units, y up; flat-shaded unless [`smooth`](Self::smooth) is
/// called.
#[derive(Clone, Default)]
pub(crate) struct Shape {
    corners: Vec<[Vec3; 3]>,
    smooth: bool,
}

impl Shape {
    /// Adds a triangle, counter-clockwise seen from outside.
    pub fn triangle(mut self, corners: [[f32; 3]; 3]) -> Self {
        self.corners.push(corners.map(Vec3::from));
        self
    }

    /// Adds triangles, each as [`triangle`](Self::triangle) does.
    pub fn triangles(self, corners: impl IntoIterator<Item = [[f32; 3]; 3]>) -> Self {
        corners.into_iter().fold(self, Self::triangle)
    }

    /// Adds a plane quadrilateral, counter-clockwise seen from outside.
    pub fn quad(self, [a, b, c, d]: [[f32; 3]; 4]) -> Self {
        self.triangle([a, b, c]).triangle([a, c, d])
    }

    /// Adds a horizontal rectangle at height `y` that faces up, between two corners of x and z.
    pub fn sheet(self, [[x0, z0], [x1, z1]]: [[f32; 2]; 2], y: f32) -> Self {
        self.quad([[x0, y, z1], [x1, y, z1], [x1, y, z0], [x0, y, z0]])
    }

    /// Adds a horizontal square at height `y` that faces up, with edges of `2 * half`, around x = z
    /// = 0.
    pub fn floor(self, half: f32, y: f32) -> Self {
        self.sheet([[-half; 2], [half; 2]], y)
    }

    /// Adds a closed box between two corners.
    pub fn cuboid(self, block: Block) -> Self {
        self.moved_cuboid(block, |corner| corner)
    }

    /// Adds closed boxes, each between two corners.
    pub fn cuboids(self, blocks: &[Block]) -> Self {
        blocks
            .iter()
            .fold(self, |shape, &block| shape.cuboid(block))
    }

    /// Adds a closed box whose corners `place` moves; an affine map keeps its faces plane, up to
    /// rounding.
    pub fn moved_cuboid(self, block: Block, place: impl Fn([f32; 3]) -> [f32; 3]) -> Self {
        let at = |x: usize, y: usize, z: usize| place([block[x][0], block[y][1], block[z][2]]);
        self.quad([at(0, 1, 1), at(1, 1, 1), at(1, 1, 0), at(0, 1, 0)])
            .quad([at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1)])
            .quad([at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1)])
            .quad([at(1, 0, 0), at(0, 0, 0), at(0, 1, 0), at(1, 1, 0)])
            .quad([at(1, 0, 1), at(1, 0, 0), at(1, 1, 0), at(1, 1, 1)])
            .quad([at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0)])
    }

    /// Adds a closed slab of this thickness below y = 0. Its upper side is a square with edges of
    /// `2 * half` and, around it, `frames` rings, each four times as large as the one before, so
    /// that no triangle is huge near the centre.
    pub fn graded_slab(mut self, half: f32, frames: i32, thickness: f32) -> Self {
        let square = |frame: i32, y: f32| {
            let half = half * 4f32.powi(frame);
            [[-half, half], [half, half], [half, -half], [-half, -half]].map(|[x, z]| [x, y, z])
        };
        let mut from = square(0, -thickness);
        from.reverse();
        self = self.quad(square(0, 0.0)).quad(from);
        for frame in 0..frames {
            for side in 0..4 {
                let next = (side + 1) % 4;
                let [inner, outer] = [frame, frame + 1].map(|frame| square(frame, 0.0));
                self = self.quad([outer[side], outer[next], inner[next], inner[side]]);
                let [inner, outer] = [frame, frame + 1].map(|frame| square(frame, -thickness));
                self = self.quad([inner[side], inner[next], outer[next], outer[side]]);
            }
        }
        let (above, below) = (square(frames, 0.0), square(frames, -thickness));
        (0..4).fold(self, |shape, side| {
            let next = (side + 1) % 4;
            shape.quad([below[side], below[next], above[next], above[side]])
        })
    }

    /// Adds the quadrilaterals of a lattice of `rows` × `columns` cells with the corners `at(row,
    /// column)`, counter-clockwise along (row, column); cells that collapse to a line are left out.
    pub fn lattice(self, rows: u32, columns: u32, at: impl Fn(u32, u32) -> DVec3) -> Self {
        let at = |row, column| at(row, column).as_vec3().to_array();
        let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        let corners = cells.map(|(row, column)| {
            [
                at(row, column),
                at(row + 1, column),
                at(row + 1, column + 1),
                at(row, column + 1),
            ]
        });
        let halves = corners.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
        self.triangles(halves.filter(|[a, b, c]| a != b && b != c && c != a))
    }

    /// Adds a closed convex prism: an outline in x and y, counter-clockwise seen from +z, between
    /// two values of z.
    pub fn prism(self, outline: &[[f32; 2]], [back, front]: [f32; 2]) -> Self {
        let at = |i: usize, z: f32| {
            let [x, y] = outline[i % outline.len()];
            [x, y, z]
        };
        let caps = (2..outline.len()).flat_map(|i| {
            [
                [at(0, front), at(i - 1, front), at(i, front)],
                [at(0, back), at(i, back), at(i - 1, back)],
            ]
        });
        (0..outline.len()).fold(self.triangles(caps), |shape, i| {
            shape.quad([at(i, back), at(i + 1, back), at(i + 1, front), at(i, front)])
        })
    }

    /// Adds all triangles once more, wound the other way.
    pub fn and_reversed(mut self) -> Self {
        let reversed: Vec<_> = self.corners.iter().map(|&[a, b, c]| [a, c, b]).collect();
        self.corners.extend(reversed);
        self
    }

    /// Winds all triangles the other way.
    pub fn reversed(mut self) -> Self {
        self.corners
            .iter_mut()
            .for_each(|corners| corners.swap(1, 2));
        self
    }

    /// Adds the triangles of another shape.
    pub fn and(mut self, other: Self) -> Self {
        self.corners.extend(other.corners);
        self
    }

    /// Makes the shading smooth: normals are averaged where triangles meet.
    pub fn smooth(mut self) -> Self {
        self.smooth = true;
        self
    }

    /// The mesh: positions welded, one normal per triangle (upward where it has no area), or one
    /// per position.
    fn mesh(self) -> Mesh {
        let mut welder: Welder = Welder::default();
        let mut mesh = Mesh::default();
        let mut areas = Vec::new();
        for corners in &self.corners {
            let [a, b, c] = corners.map(|p| p.as_dvec3());
            let place = areas.len() as u32;
            areas.push((b - a).cross(c - a));
            mesh.normal_indices.push([place; 3]);
            mesh.triangles.push(corners.map(|p| welder.index(p)));
        }
        if self.smooth {
            let mut sums = vec![DVec3::ZERO; welder.values.len()];
            for (triangle, &area) in mesh.triangles.iter().zip(&areas) {
                triangle.iter().for_each(|&i| sums[i as usize] += area);
            }
            (areas, mesh.normal_indices) = (sums, mesh.triangles.clone());
        }
        let unit = |area: &DVec3| area.try_normalize().unwrap_or(DVec3::Y).as_vec3();
        mesh.normals = areas.iter().map(unit).collect();
        mesh.positions = welder.values;
        mesh
    }

    /// Returns a scene of the shape, without a name, with the view `main` from `eye` to `target`
    /// and one light. Up is y, or −z if the view is nearly vertical.
    pub fn scene(self, Seen { eye, target, light }: Seen) -> Scene {
        let eye = DVec3::from(eye);
        let direction = DVec3::from(target) - eye;
        let upright = direction.normalize().y.abs() < 0.99;
        Scene {
            name: String::new(),
            mesh: self.mesh(),
            views: vec![View {
                name: "main".into(),
                eye,
                direction,
                up: if upright { DVec3::Y } else { DVec3::NEG_Z },
                fov_y_degrees: 45.0,
                near: 0.01 * direction.length(),
                far: 100.0 * direction.length(),
                ..View::default()
            }],
            lights: vec![Light::only(light)],
        }
    }
}

/// Position of the eye, point at which it looks, and light of a case.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    pub eye: [f64; 3],
    pub target: [f64; 3],
    pub light: LightKind,
}

/// Returns the eye and target given, with a directional light that travels along `light`.
pub(crate) const fn seen(eye: [f64; 3], target: [f64; 3], light: DVec3) -> Seen {
    seen_under(
        eye,
        target,
        LightKind::Directional(DirectionalLight::new(light)),
    )
}

/// Returns the eye, target and light given.
pub(crate) const fn seen_under(eye: [f64; 3], target: [f64; 3], light: LightKind) -> Seen {
    Seen { eye, target, light }
}
