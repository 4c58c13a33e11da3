//! Sponza as `sponza.md`'s conventions ask for it.

use glam::{DVec3, Vec3};
use skiagraph_scene::{DirectionalLight, Mesh, View};
use std::{collections::HashMap, path::Path};

pub fn load(path: &Path) -> Mesh {
    let (models, _) = tobj::load_obj(path, &tobj::LoadOptions::default())
        .expect("sponza.obj below SKIAGRAPH_ASSETS");
    let mut mesh = Mesh::default();
    let mut welded: HashMap<[u32; 3], u32> = HashMap::new();
    for model in models {
        if model.name == "sponza_04" {
            continue;
        }
        let m = model.mesh;
        let position = |i: u32| Vec3::from_slice(&m.positions[i as usize * 3..][..3]) + 0.0;
        let base = mesh.normals.len() as u32;
        mesh.normals.extend(
            m.normals
                .chunks_exact(3)
                .map(|n| Vec3::from_slice(n).normalize_or_zero()),
        );
        let positions: Vec<u32> = (0..m.positions.len() as u32 / 3)
            .map(|i| {
                let p = position(i);
                *welded
                    .entry(p.to_array().map(f32::to_bits))
                    .or_insert_with(|| {
                        mesh.positions.push(p);
                        mesh.positions.len() as u32 - 1
                    })
            })
            .collect();
        let mut start = 0;
        let arities = if m.face_arities.is_empty() {
            vec![3; m.indices.len() / 3]
        } else {
            m.face_arities.clone()
        };
        for arity in arities {
            let corner = |i: usize| positions[m.indices[start + i] as usize];
            let normal = |i: usize| base + m.normal_indices[start + i];
            let splits: Vec<[usize; 3]> = match arity {
                4 => vec![[1, 2, 3], [1, 3, 0]],
                n => (1..n as usize - 1).map(|i| [0, i, i + 1]).collect(),
            };
            for split in splits {
                mesh.triangles.push(split.map(corner));
                mesh.normal_indices.push(split.map(normal));
            }
            start += arity as usize;
        }
    }
    mesh
}

pub fn view() -> View {
    View {
        name: "main".into(),
        eye: DVec3::new(-83.72924, 222.06694, -2.89993),
        direction: DVec3::new(0.810612, -0.273794, 0.517634),
        up: DVec3::Y,
        fov_y_degrees: 60.0,
        near: 1.0,
        far: 2800.0,
    }
}

pub fn light() -> DirectionalLight {
    DirectionalLight {
        direction: DVec3::new(-0.001881, -0.968051, 0.250748),
    }
}
