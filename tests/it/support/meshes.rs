//! Small meshes.

use super::random::Random;
use glam::{Vec2, Vec3};
use skiagraph_scene::{Mask, Material, Mesh, Surfaces, Wrap};
use std::sync::Arc;

/// A mesh with one normal per triangle.
pub fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    let normals = triangles.iter().map(|t| {
        let [a, b, c] = t.map(|i| positions[i as usize]);
        (b - a).cross(c - a).normalize_or_zero()
    });
    let normals: Vec<Vec3> = normals.collect();
    let normal_indices = (0..triangles.len() as u32).map(|i| [i; 3]).collect();
    Mesh {
        positions,
        triangles,
        normals,
        normal_indices,
        ..Mesh::default()
    }
}

/// A square floor at height 0, and a box above it whose centre is at height 1.5; half edges.
pub fn box_over_floor(floor: f32, half: Vec3) -> Mesh {
    let (mut positions, mut triangles) = (vec![], vec![]);
    let mut quad = |corners: [Vec3; 4]| {
        let first = positions.len() as u32;
        positions.extend(corners);
        triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    };
    let corners = [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)];
    quad(corners.map(|(x, z)| Vec3::new(x, 0.0, z) * floor));
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let face = Vec3::AXES[axis] * side;
            let (u, v) = (
                Vec3::AXES[(axis + 1) % 3] * side,
                Vec3::AXES[(axis + 2) % 3],
            );
            let corners = [face - u - v, face + u - v, face + u + v, face - u + v];
            quad(corners.map(|p| p * half + Vec3::Y * 1.5));
        }
    }
    mesh(positions, triangles)
}

/// Two meshes as one.
pub fn joined(mut first: Mesh, second: &Mesh) -> Mesh {
    let (corners, normals) = (first.positions.len() as u32, first.normals.len() as u32);
    first.positions.extend(&second.positions);
    first.normals.extend(&second.normals);
    let moved = |by: u32| move |triangle: &[u32; 3]| triangle.map(|index| index + by);
    first
        .triangles
        .extend(second.triangles.iter().map(moved(corners)));
    first
        .normal_indices
        .extend(second.normal_indices.iter().map(moved(normals)));
    first
}

/// Triangles of about `size` at random places in a cube of half edge 1.
pub fn soup(count: usize, size: f32, seed: u64) -> Mesh {
    let mut random = Random(seed);
    let mut positions = Vec::new();
    for _ in 0..count {
        let centre = random.vector();
        for _ in 0..3 {
            positions.push(centre + random.vector() * size);
        }
    }
    let triangles = (0..count as u32)
        .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
        .collect();
    mesh(positions, triangles)
}

/// A closed surface around the origin: a subdivided octahedron pushed out to a radius that differs
/// from corner to corner.
pub fn potato(levels: u32, roughness: f32, seed: u64) -> Mesh {
    let mut positions = vec![
        Vec3::X,
        Vec3::NEG_X,
        Vec3::Y,
        Vec3::NEG_Y,
        Vec3::Z,
        Vec3::NEG_Z,
    ];
    let mut triangles: Vec<[u32; 3]> = vec![
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ];
    for _ in 0..levels {
        let mut middles = std::collections::BTreeMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in triangles {
            let mut middle = |p: u32, q: u32| {
                *middles.entry((p.min(q), p.max(q))).or_insert_with(|| {
                    positions
                        .push(((positions[p as usize] + positions[q as usize]) * 0.5).normalize());
                    positions.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    let mut random = Random(seed);
    let positions = positions
        .into_iter()
        .map(|p| p * (1.0 + roughness * random.unit()))
        .collect();
    mesh(positions, triangles)
}

/// `count` masked, double-sided squares of about `size` at random places in a cube of half edge 1,
/// their texture coordinates turned, stretched and beyond 0…1, over a floor that is not masked.
pub fn foliage(count: u32, size: f32, floor: f32, seed: u64) -> Mesh {
    let mut random = Random(seed);
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    let mut surfaces = Surfaces::default();
    for leaf in 0..count {
        let (centre, along) = (random.vector(), random.vector().normalize() * size);
        let across = along.cross(random.vector()).normalize() * size;
        let first = 4 * leaf;
        positions.extend([
            centre - along - across,
            centre + along - across,
            centre + along + across,
            centre - along + across,
        ]);
        triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        let turn = Vec2::from_angle(3.0 * random.unit()) * (1.0 + random.unit().abs());
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let shift = 3.0 * random.vector().truncate();
        let uvs = corners.map(|corner| turn.rotate(Vec2::from(corner)) + shift);
        surfaces.uvs.extend(uvs);
        surfaces
            .uv_indices
            .extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        surfaces.of.extend([leaf % 3; 2]);
    }
    let corners = [
        (-floor, floor),
        (floor, floor),
        (floor, -floor),
        (-floor, -floor),
    ];
    let first = 4 * count;
    positions.extend(corners.map(|(x, z)| Vec3::new(x, -1.5, z)));
    triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    surfaces.uv_indices.extend([[0; 3]; 2]);
    surfaces.of.extend([3; 2]);
    let disk = |x: u32, y: u32| (x as f32 - 15.5).hypot(y as f32 - 15.5) < 13.0;
    let masks = [
        Mask::new([32, 32], [Wrap::Repeat; 2], disk),
        Mask::new([5, 3], [Wrap::Mirror, Wrap::Clamp], |x, y| {
            (x + y).is_multiple_of(2)
        }),
        Mask::new([1, 64], [Wrap::Clamp, Wrap::Repeat], |_, y| y % 7 < 4),
    ];
    surfaces.materials.extend(masks.map(|mask| Material {
        mask: Some(Arc::new(mask)),
        double_sided: true,
        ..Material::default()
    }));
    surfaces.materials.push(Material::default());
    Mesh {
        surfaces,
        ..mesh(positions, triangles)
    }
}
