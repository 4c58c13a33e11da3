//! Parts of a mesh that move by themselves: rigidly, or bent.

use crate::mesh::{Group, Mesh};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use std::collections::{BTreeMap, HashSet};

/// A mesh some parts of which move.
#[derive(Clone, Debug)]
pub struct Movable {
    /// At rest. Its moving parts have normals of their own, one per corner's position.
    pub rest: Mesh,
    parts: Vec<Part>,
}

/// What one part is made of.
#[derive(Clone, Debug)]
struct Part {
    positions: Vec<u32>,
    /// Normals, each with the position at which it stands.
    normals: Vec<(u32, u32)>,
}

impl Movable {
    /// The parts are groups of the mesh by name; groups of the same name are one.
    ///
    /// # Errors
    /// A name that no group has, or a part that is welded to another, so that moving it would tear
    /// the surface.
    pub fn new(mesh: &Mesh, parts: &[&str]) -> Result<Self, String> {
        let mut rest = mesh.clone();
        let parts = parts.iter().map(|name| Part::cut(&mut rest, name));
        let parts = parts.collect::<Result<_, _>>()?;
        Ok(Self { rest, parts })
    }

    /// Several meshes as one, each a part in a space of its own, such as the instances of one mesh:
    /// the n-th is moved by the n-th map. What has no material gets a plain one if another has one.
    pub fn joined(meshes: &[&Mesh]) -> Self {
        let mut rest = Mesh::default();
        let has_materials = meshes.iter().any(|mesh| !mesh.surfaces.of.is_empty());
        let parts = meshes.iter().map(|mesh| {
            if has_materials {
                rest.surfaces.append(&mesh.surfaces, mesh.triangles.len());
            }
            Part::append(&mut rest, mesh)
        });
        let parts = parts.collect();
        Self { rest, parts }
    }

    /// Positions and normals after each part was moved by the map of its index; parts without one
    /// stay.
    pub fn moved(&self, maps: &[DAffine3]) -> (Vec<Vec3>, Vec<Vec3>) {
        self.bent(|part, place| {
            let map = maps.get(part).copied().unwrap_or_default();
            (map.transform_point3(place), map.matrix3)
        })
    }

    /// The same by any map, which is given the part and a place on it at rest, and returns the
    /// place where that is now and the map's derivative there.
    pub fn bent(&self, map: impl Fn(usize, DVec3) -> (DVec3, DMat3)) -> (Vec<Vec3>, Vec<Vec3>) {
        let at_rest = &self.rest.positions;
        let (mut positions, mut normals) = (at_rest.clone(), self.rest.normals.clone());
        for (index, part) in self.parts.iter().enumerate() {
            let map = |position: u32| map(index, at_rest[position as usize].as_dvec3());
            for &position in &part.positions {
                positions[position as usize] = map(position).0.as_vec3();
            }
            for &(normal, position) in &part.normals {
                let across = map(position).1.inverse().transpose();
                let normal = &mut normals[normal as usize];
                *normal = (across * normal.as_dvec3()).normalize_or_zero().as_vec3();
            }
        }
        (positions, normals)
    }

    /// The lowest and highest place of a part at rest along an axis; 0 of a part without corners.
    pub fn span(&self, part: usize, axis: DVec3) -> [f64; 2] {
        let places = self.parts[part].positions.iter();
        let along = places.map(|&p| self.rest.positions[p as usize].as_dvec3().dot(axis));
        let span = along.fold(None, |span, at| {
            let [low, high] = span.unwrap_or([at; 2]);
            Some([f64::min(low, at), f64::max(high, at)])
        });
        span.unwrap_or_default()
    }
}

impl Part {
    fn append(rest: &mut Mesh, mesh: &Mesh) -> Self {
        let [first, first_position] =
            [rest.triangles.len(), rest.positions.len()].map(|n| n as u32);
        rest.positions.extend(&mesh.positions);
        let moved = |triangle: &[u32; 3]| triangle.map(|index| first_position + index);
        rest.triangles.extend(mesh.triangles.iter().map(moved));
        for group in &mesh.groups {
            rest.groups.push(Group {
                name: group.name.clone(),
                triangles: first + group.triangles.start..first + group.triangles.end,
            });
        }
        let mut own = BTreeMap::new();
        for (corners, triangle) in mesh.normal_indices.iter().zip(&mesh.triangles) {
            let own = [0, 1, 2].map(|corner| {
                let (normal, position) = (corners[corner], first_position + triangle[corner]);
                *own.entry((normal, position)).or_insert_with(|| {
                    rest.normals.push(mesh.normals[normal as usize]);
                    rest.normals.len() as u32 - 1
                })
            });
            rest.normal_indices.push(own);
        }
        Self {
            positions: (first_position..rest.positions.len() as u32).collect(),
            normals: at_positions(&own),
        }
    }

    fn cut(mesh: &mut Mesh, name: &str) -> Result<Self, String> {
        let groups = mesh.groups.iter().filter(|group| group.name == name);
        let inside: HashSet<u32> = groups.flat_map(|group| group.triangles.clone()).collect();
        if inside.is_empty() {
            let mut names: Vec<&str> = mesh.groups.iter().map(|it| it.name.as_str()).collect();
            names.dedup();
            return Err(format!(
                "no part of the mesh is called {name:?}; known here: {}",
                names.join(", ")
            ));
        }
        let mut positions: Vec<u32> = Vec::new();
        let mut outside = HashSet::new();
        for (primitive, corners) in (0..).zip(&mesh.triangles) {
            match inside.contains(&primitive) {
                true => positions.extend(corners),
                false => outside.extend(corners.iter().copied()),
            }
        }
        positions.sort_unstable();
        positions.dedup();
        let welded = positions.iter().filter(|it| outside.contains(it)).count();
        if welded > 0 {
            return Err(format!(
                "part {name:?} shares {welded} positions with others, so that it cannot move by \
                 itself"
            ));
        }
        let mut own = BTreeMap::new();
        for (primitive, corners) in (0..).zip(&mut mesh.normal_indices) {
            if !inside.contains(&primitive) {
                continue;
            }
            for (normal, &position) in corners.iter_mut().zip(&mesh.triangles[primitive as usize]) {
                let old = mesh.normals[*normal as usize];
                *normal = *own.entry((*normal, position)).or_insert_with(|| {
                    mesh.normals.push(old);
                    mesh.normals.len() as u32 - 1
                });
            }
        }
        Ok(Self {
            positions,
            normals: at_positions(&own),
        })
    }
}

/// New normals, each with the position at which it stands.
fn at_positions(own: &BTreeMap<(u32, u32), u32>) -> Vec<(u32, u32)> {
    let normals = own.iter();
    normals
        .map(|(&(_, position), &normal)| (normal, position))
        .collect()
}
