//! Joins the vertices of a large mesh within the cells of a grid, so that a few thousand rays
//! through it cost less than the hierarchy of all its triangles.

use glam::{DVec3, UVec3, Vec3};
use itertools::Itertools;
use skiagraph_scene::{Material, Mesh};
use std::borrow::Cow;

/// Most triangles that are traced.
const MOST_TRIANGLES: usize = 40_000;

/// Most cells along an axis.
const MOST_CELLS: f64 = 150.0;

/// Returns a mesh of at most some 40,000 triangles like `mesh`, the number of its first triangles
/// that come from the first `subject` ones of `mesh`, and by how much its surfaces may be moved.
/// Vertices of one cell become one, which keeps closed parts closed. A small mesh stays as it is,
/// as do the triangles that are not the subject's.
pub(super) fn coarse(mesh: &Mesh, subject: usize) -> (Cow<'_, Mesh>, usize, f64) {
    let corners = || mesh.triangles[..subject].iter().flatten();
    let place = |corner: &u32| mesh.positions[*corner as usize];
    let boxes = corners().map(|corner| (place(corner), place(corner)));
    let bounds = boxes.reduce(|(min, max), (low, high)| (min.min(low), max.max(high)));
    let bounds = bounds.filter(|_| subject > MOST_TRIANGLES);
    let Some((min, max)) = bounds else {
        return (Cow::Borrowed(mesh), subject, 0.0);
    };
    let area = |primitive| {
        let [a, b, c] = mesh.corners(primitive);
        (b - a).cross(c - a).length()
    };
    // A surface has two triangles for each cell that it goes through. One triangle in 16 will do.
    let area = (0..subject as u32).step_by(16).map(area).sum::<f64>() * 8.0;
    let least = f64::from((max - min).max_element()) / MOST_CELLS;
    let mut cell = (2.0 * area / MOST_TRIANGLES as f64).sqrt().max(least);
    loop {
        let (joined, first) = joined(mesh, subject, min, (max - min, cell as f32));
        let excess = first as f64 / MOST_TRIANGLES as f64;
        if excess <= 1.2 || cell > 16.0 * least {
            return (Cow::Owned(joined), first, cell);
        }
        cell *= excess.sqrt().max(1.2);
    }
}

/// The mesh with vertices joined in cells from `min` on, with the number of the subject's triangles
/// that are left. Each triangle has its geometric normal, and no texture.
fn joined(mesh: &Mesh, subject: usize, min: Vec3, (size, cell): (Vec3, f32)) -> (Mesh, usize) {
    let counts = (size / cell).as_uvec3() + UVec3::ONE;
    let mut numbers = vec![0u32; counts.element_product() as usize];
    let mut coarse = Mesh::default();
    let least_corner = mesh.triangles[subject..].iter().flatten().min();
    let first_other = least_corner.map_or(u32::MAX, |corner| *corner);
    let position = |(index, position): (u32, &Vec3)| {
        if index >= first_other {
            coarse.positions.push(*position);
            return coarse.positions.len() as u32 - 1;
        }
        // A position that no triangle uses may lie outside of the box.
        let at = ((*position - min) / cell).max(Vec3::ZERO).as_uvec3();
        let at = at.min(counts - 1);
        let number = &mut numbers[(at.x + counts.x * (at.y + counts.y * at.z)) as usize];
        if *number == 0 {
            coarse.positions.push(*position);
            *number = coarse.positions.len() as u32;
        }
        *number - 1
    };
    let number = (0..).zip(&mesh.positions).map(position).collect_vec();
    let mut kept_of_subject = 0;
    for (primitive, corners) in mesh.triangles.iter().enumerate() {
        let corners @ [a, b, c] = corners.map(|corner| number[corner as usize]);
        if a == b || b == c || c == a {
            continue;
        }
        let [a, b, c] = corners.map(|corner| coarse.positions[corner as usize].as_dvec3());
        let normal = (b - a).cross(c - a).normalize_or(DVec3::Y);
        kept_of_subject += usize::from(primitive < subject);
        let index = coarse.triangles.len() as u32;
        coarse.triangles.push(corners);
        coarse.normals.push(normal.as_vec3());
        coarse.normal_indices.push([index; 3]);
        coarse.surfaces.of.extend(mesh.surfaces.of.get(primitive));
    }
    let plain = |material: &Material| Material {
        double_sided: material.double_sided,
        ..Material::default()
    };
    coarse.surfaces.materials = mesh.surfaces.materials.iter().map(plain).collect();
    (coarse, kept_of_subject)
}
