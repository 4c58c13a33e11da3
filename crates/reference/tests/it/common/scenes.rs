//! Small scenes whose shadows are known.

use glam::{DVec3, Vec3};
use skiagraph_reference::{GroundTruthPixels, Oracle, OracleMode, Progress, Statistics};
use skiagraph_scene::{Camera, DirectionalLight, LightKind, Mesh, View};

/// Adds a triangle with its geometric normal at every corner; positions are welded.
pub fn add(mesh: &mut Mesh, corners: [[f32; 3]; 3]) {
    let [a, b, c] = corners.map(Vec3::from);
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let index = corners.map(|corner| {
        let corner = Vec3::from(corner);
        mesh.positions
            .iter()
            .position(|&p| p == corner)
            .unwrap_or_else(|| {
                mesh.positions.push(corner);
                mesh.positions.len() - 1
            }) as u32
    });
    mesh.triangles.push(index);
    mesh.normal_indices.push([mesh.normals.len() as u32; 3]);
    mesh.normals.push(normal);
}

/// Adds the rectangle `x` × `z` at height `y`, in two triangles, facing up.
pub fn add_rectangle(mesh: &mut Mesh, x: [f32; 2], y: f32, z: [f32; 2]) {
    let [a, b, c, d] = [
        [x[0], y, z[0]],
        [x[0], y, z[1]],
        [x[1], y, z[1]],
        [x[1], y, z[0]],
    ];
    add(mesh, [a, b, c]);
    add(mesh, [a, c, d]);
}

/// A floor at y = 0, one huge triangle so that no edge of it is near.
pub fn floor() -> Mesh {
    let mut mesh = Mesh::default();
    add(
        &mut mesh,
        [[-100.0, 0.0, -60.0], [0.0, 0.0, 100.0], [100.0, 0.0, -60.0]],
    );
    mesh
}

/// A camera `height` above the floor that looks straight down and sees ±`height` along x (to the
/// right) and z (down).
pub fn from_above(height: f64, viewport: [u32; 2]) -> Camera {
    let eye = DVec3::new(0.0, height, 0.0);
    let (direction, up) = (DVec3::NEG_Y, DVec3::NEG_Z);
    View {
        name: String::new(),
        eye,
        direction,
        up,
        fov_y_degrees: 90.0,
        near: 0.01 * height,
        far: 10.0 * height,
        ..View::default()
    }
    .camera(viewport)
}

pub fn light(x: f64, y: f64, z: f64) -> DirectionalLight {
    DirectionalLight::new(DVec3::new(x, y, z))
}

/// Primary and shadow rays of the oracle alone.
pub fn render(
    mesh: &Mesh,
    camera: &Camera,
    light: impl Into<LightKind>,
    mode: OracleMode,
) -> GroundTruthPixels {
    let oracle = Oracle::new(mesh);
    let primitives = oracle
        .primary(camera, Progress::default())
        .expect("it is not stopped");
    oracle
        .shade(camera, light, &primitives, mode, Progress::default())
        .expect("its own primitives")
}

/// The counts of a reference judged by itself.
pub fn counts(truth: &GroundTruthPixels) -> Statistics {
    Statistics::judged(&truth.visibility(), &truth.status(), truth).expect("its own outputs")
}
