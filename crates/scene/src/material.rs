//! Materials of the surfaces of a mesh.

use crate::{mask::Mask, shadows::Shadows, texture::Texture};
use glam::{DVec2, Vec2};
use std::{collections::HashMap, sync::Arc};

/// Material of triangles of a mesh.
#[derive(Clone, Debug)]
pub struct Material {
    /// Name of the material in the mesh file. A glTF material without a name is called `unnamed`.
    pub name: String,
    /// Base colour: linear red, green and blue, multiplied by the texture if there is one.
    pub base_color: [f32; 3],
    /// Texture of the base colour; `None` for a surface of one colour.
    pub texture: Option<Texture>,
    /// Mask that cuts out the surface; `None` for a surface without holes.
    pub mask: Option<Arc<Mask>>,
    /// True if the surface's back faces are visible, too.
    pub double_sided: bool,
    /// Role of the surface in shadows.
    pub shadows: Shadows,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: [1.0; 3],
            texture: None,
            mask: None,
            double_sided: false,
            shadows: Shadows::default(),
        }
    }
}

impl Material {
    /// True if a triangle without a material looks as one with it.
    pub fn is_plain(&self) -> bool {
        let is_plain = self.mask.is_none() && self.texture.is_none() && !self.double_sided;
        is_plain && self.base_color == [1.0; 3] && self.shadows == Shadows::Both
    }

    /// Makes the material opaque, for triangles without texture coordinates.
    fn lose_coordinates(&mut self) {
        self.mask.take_if(|mask| !mask.is_uniform());
    }
}

/// Materials of a mesh, and the material and texture coordinates of each triangle. All lists are
/// empty for a mesh without materials. The argument `primitive` of methods is the index of a
/// triangle in [`Mesh::triangles`](crate::Mesh::triangles).
#[derive(Clone, Debug, Default)]
pub struct Surfaces {
    /// Texture coordinates, v down: (0, 0) is the outer corner of the texture's first texel.
    pub uvs: Vec<Vec2>,
    /// Three indices into `uvs` per triangle, in the order of the mesh's triangles; empty for a
    /// mesh without texture coordinates, whose masks then hide nothing.
    pub uv_indices: Vec<[u32; 3]>,
    /// Materials of the mesh; `of` holds indices into this list.
    pub materials: Vec<Material>,
    /// Index into `materials` for each triangle, in the order of the mesh's triangles; empty for a
    /// mesh without materials.
    pub of: Vec<u32>,
}

/// Place of the lists of another mesh among those of a mesh ([`Surfaces::put`]).
#[derive(Clone, Copy, Debug)]
pub struct SurfacePlace([u32; 2]);

impl Surfaces {
    /// Those of another mesh behind these; a plain one for its triangles if it has none.
    pub(crate) fn append(&mut self, other: &Self, triangles: usize) {
        let total = self.of.len() + triangles;
        let place = self.append_lists(other);
        self.of.resize(total, 0);
        self.uv_indices.resize(total, [0; 3]);
        self.put_again(other, place, (total - triangles, triangles));
    }

    /// Appends the materials and texture coordinates of another mesh, and returns where they are.
    fn append_lists(&mut self, other: &Self) -> SurfacePlace {
        if self.uv_indices.len() < self.of.len() {
            self.uv_indices = vec![[self.uvs.len() as u32; 3]; self.of.len()];
            self.uvs.push(Vec2::ZERO);
            self.materials
                .iter_mut()
                .for_each(Material::lose_coordinates);
        }
        let place = [self.uvs.len(), self.materials.len()].map(|count| count as u32);
        self.uvs.extend(&other.uvs);
        if other.of.is_empty() {
            self.materials.push(Material::default());
        }
        self.materials.extend(other.materials.iter().cloned());
        if other.uv_indices.is_empty() {
            self.uvs.push(Vec2::ZERO);
            let appended = &mut self.materials[place[1] as usize..];
            appended.iter_mut().for_each(Material::lose_coordinates);
        }
        SurfacePlace(place)
    }

    /// Adds surfaces for triangles that were appended to the mesh, which now has `triangles`
    /// triangles: the appended ones get the first material and the first texture coordinates, if
    /// the mesh has any.
    pub fn pad(&mut self, triangles: usize) {
        if !self.of.is_empty() {
            self.of.resize(triangles, 0);
        }
        if !self.uv_indices.is_empty() {
            self.uv_indices.resize(triangles, [0; 3]);
        }
    }

    /// Gives `triangles` triangles of the mesh, from the primitive id `first` on, the surfaces of
    /// `other`, which is of another mesh with that many triangles. `total` is the number of
    /// triangles of this mesh. The materials and texture coordinates of `other` are appended to the
    /// lists; where they are then is returned. If only one of the two meshes has materials, the
    /// other counts as plain white; if neither has, nothing changes.
    ///
    /// # Panics
    /// If `first` and `triangles` together are more than `total`.
    pub fn put(
        &mut self,
        other: &Self,
        (first, triangles): (usize, usize),
        total: usize,
    ) -> Option<SurfacePlace> {
        if self.of.is_empty() && other.of.is_empty() {
            return None;
        }
        if self.of.is_empty() {
            self.append(&Self::default(), total);
        }
        let place = self.append_lists(other);
        self.put_again(other, place, (first, triangles));
        Some(place)
    }

    /// Gives triangles the surfaces of `other`, as [`put`](Self::put) does, where its lists were
    /// put before, at `place`.
    ///
    /// # Panics
    /// If the mesh has no such triangles.
    pub fn put_again(
        &mut self,
        other: &Self,
        SurfacePlace([uv, material]): SurfacePlace,
        (first, triangles): (usize, usize),
    ) {
        for triangle in 0..triangles {
            let corners = other.uv_indices.get(triangle);
            let own = other.of.get(triangle).copied().unwrap_or_default();
            self.uv_indices[first + triangle] = corners.unwrap_or(&[0; 3]).map(|index| uv + index);
            self.of[first + triangle] = material + own;
        }
    }

    /// Drops the materials and texture coordinates that no triangle uses, but for the first ones,
    /// which triangles get of which `is_used` is false.
    pub fn compact(&mut self, is_used: impl Fn(usize) -> bool) {
        for triangle in (0..self.of.len()).filter(|triangle| !is_used(*triangle)) {
            self.of[triangle] = 0;
            if let Some(corners) = self.uv_indices.get_mut(triangle) {
                *corners = [0; 3];
            }
        }
        keep_used(&mut self.materials, &mut self.of);
        keep_used(&mut self.uvs, self.uv_indices.as_flattened_mut());
    }

    /// Returns the material of triangle `primitive`, or `None` if it has none.
    pub fn material(&self, primitive: u32) -> Option<&Material> {
        let material = *self.of.get(primitive as usize)?;
        self.materials.get(material as usize)
    }

    /// Returns the texture coordinates of the corners of triangle `primitive`; all zero if it has
    /// none.
    pub fn corner_uvs(&self, primitive: u32) -> [Vec2; 3] {
        let indices = self.uv_indices.get(primitive as usize);
        indices.map_or([Vec2::ZERO; 3], |indices| {
            indices.map(|index| self.uvs[index as usize])
        })
    }

    /// Returns the mask of triangle `primitive`. `None` if it is not masked, or if it has no finite
    /// texture coordinates by which its mask could be looked up.
    pub fn mask(&self, primitive: u32) -> Option<&Mask> {
        let mask = self.material(primitive)?.mask.as_deref()?;
        let indices = self.uv_indices.get(primitive as usize);
        let uv = |index: &u32| self.uvs.get(*index as usize);
        let is_finite = |index: &u32| uv(index).is_some_and(|uv| uv.is_finite());
        let is_placed = indices.is_some_and(|indices| indices.iter().all(is_finite));
        (is_placed || mask.is_uniform()).then_some(mask)
    }

    /// Returns true if the back face of triangle `primitive` is visible, too.
    pub fn is_double_sided(&self, primitive: u32) -> bool {
        self.material(primitive)
            .is_some_and(|material| material.double_sided)
    }

    /// Returns true if any triangle is masked or double-sided, so that tracing and drawing have to
    /// look at its material.
    pub fn need_care(&self) -> bool {
        self.use_any(|material| material.mask.is_some() || material.double_sided)
    }

    /// True if a triangle has such a material.
    fn use_any(&self, is_such: impl Fn(&Material) -> bool + Copy) -> bool {
        let mut used = self.of.iter();
        self.materials.iter().any(is_such)
            && used.any(|index| self.materials.get(*index as usize).is_some_and(is_such))
    }

    /// Returns the role of triangle `primitive` in shadows.
    pub fn shadows(&self, primitive: u32) -> Shadows {
        let material = self.material(primitive);
        material.map(|it| it.shadows).unwrap_or_default()
    }

    /// Returns true if some triangle does not cast shadows or does not receive them.
    pub fn have_roles(&self) -> bool {
        self.use_any(|material| material.shadows != Shadows::Both)
    }

    /// Gives triangles, by their primitive ids, a role in shadows, by copies of their materials.
    /// `total` is the number of triangles of the mesh.
    ///
    /// # Panics
    /// If a primitive id is not below `total`.
    pub fn set_shadows(
        &mut self,
        primitives: impl IntoIterator<Item = u32>,
        total: usize,
        shadows: Shadows,
    ) {
        if self.of.is_empty() {
            if shadows == Shadows::Both {
                return;
            }
            self.of = vec![self.materials.len() as u32; total];
            self.materials.push(Material::default());
        }
        let mut copies = HashMap::new();
        for primitive in primitives {
            let index = &mut self.of[primitive as usize];
            let own = self.materials.get(*index as usize);
            let Some(own) = own.filter(|own| own.shadows != shadows) else {
                continue;
            };
            let copy = Material {
                shadows,
                ..own.clone()
            };
            *index = *copies.entry(*index).or_insert_with(|| {
                self.materials.push(copy);
                self.materials.len() as u32 - 1
            });
        }
    }

    /// Returns the linear base colour of triangle `primitive`, times its texture's nearest texel,
    /// at the point with these barycentric weights (in the order of the triangle's corners). A
    /// triangle without a material counts as white, and so does a texture that cannot be read.
    pub fn base_color(&self, primitive: u32, weights: [f64; 3]) -> [f32; 3] {
        let Some(material) = self.material(primitive) else {
            return [1.0; 3];
        };
        let texture = material.texture.as_ref();
        let texels = texture.and_then(|texture| Some((texture.texels().ok()?, texture.wrap)));
        let Some((texels, wrap)) = texels else {
            return material.base_color;
        };
        let uvs = self.corner_uvs(primitive).into_iter().zip(weights);
        let at: DVec2 = uvs.map(|(uv, weight)| uv.as_dvec2() * weight).sum();
        let [width, height] = texels.size;
        let [x, y] = [wrap[0].texel(at.x, width), wrap[1].texel(at.y, height)];
        let [red, green, blue, _] = texels.rgba[y as usize * width as usize + x as usize];
        let [r, g, b] = material.base_color;
        [r * linear(red), g * linear(green), b * linear(blue)]
    }
}

/// Drops the items that have no index, but for the first one.
fn keep_used<T>(items: &mut Vec<T>, indices: &mut [u32]) {
    let mut moved = vec![u32::MAX; items.len()];
    let mut count = 0;
    for &index in indices.iter() {
        if let Some(place) = moved.get_mut(index as usize) {
            *place = 0;
        }
    }
    moved.iter_mut().take(1).for_each(|place| *place = 0);
    for place in moved.iter_mut().filter(|place| **place == 0) {
        *place = count;
        count += 1;
    }
    let mut places = moved.iter();
    items.retain(|_| places.next() != Some(&u32::MAX));
    for index in indices {
        *index = moved.get(*index as usize).copied().unwrap_or(*index);
    }
}

/// A channel of sRGB as light.
fn linear(channel: u8) -> f32 {
    let value = f32::from(channel) / 255.0;
    if value <= 0.04045 {
        value / 12.92
    } else {
        ((value + 0.055) / 1.055).powf(2.4)
    }
}
