//! Small meshes.

use super::random::Random;
use glam::Vec3;
use skiagraph_scene::Mesh;

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
