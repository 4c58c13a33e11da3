//! A mesh whose vertices stay in a host's buffer.

use super::{error::HostMeshError, layout::HostVertices, rest::decoded};
use crate::buffers::{On, binding_limit, upload};
use crate::part_mesh::PartMesh;
use crate::parts::Room;
use glam::Vec3;
use skiagraph_gpu::DeviceIdentity;
use skiagraph_scene::{Indexed, Material, Mesh, Movable, Shadows, TwoLevelBvh};
use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

/// Marks a position that no triangle uses, and a normal that no vertex has.
const NONE: u32 = u32::MAX;

/// Indices of a mesh, three for each triangle, counter-clockwise as seen from outside. They count
/// from the first vertex of the mesh's [`HostVertices`]: a base vertex is part of the offset given
/// to [`HostVertices::new`].
#[derive(Clone, Copy, Debug)]
pub enum HostIndices<'a> {
    /// 16-bit indices.
    U16(&'a [u16]),
    /// 32-bit indices.
    U32(&'a [u32]),
}

/// Triangle mesh whose vertices a host keeps in a buffer of its own, for any number of parts of a
/// scene ([`SceneProvider::add_host_part`](crate::SceneProvider::add_host_part)). The GPU reads the
/// buffer whenever a part has moved, or the host has rewritten its vertices, and writes the part's
/// positions and normals into the scene's; no frame brings vertices to the CPU.
///
/// The host hands over the vertices at rest once, while loading, in the format that they have in
/// the buffer. The mesh is welded from them, and its hierarchy is built, which any thread may do.
/// The CPU keeps the welded mesh at rest, its hierarchy, and the numbers of the vertices that it
/// came from.
///
/// Its triangles are opaque and single-sided, unless they have a
/// [material](Self::new_of_material), and cast and receive shadows unless that or
/// [`with_shadows`](Self::with_shadows) says otherwise.
#[derive(Clone, Debug)]
pub struct HostMesh {
    pub(super) own: Arc<Own>,
    bounds: [Vec3; 2],
    shadows: Shadows,
}

#[derive(Debug)]
pub(super) struct Own {
    pub vertices: HostVertices,
    pub rest: Arc<Rest>,
    device: DeviceIdentity,
    pub sources: wgpu::Buffer,
    pub normal_sources: wgpu::Buffer,
    levels: OnceLock<wgpu::Buffer>,
}

/// The part of a mesh that is on the CPU, whichever buffer its vertices are in.
#[derive(Debug)]
pub(super) struct Rest {
    /// It, with its hierarchy.
    pub mesh: PartMesh,
    /// The vertex of each position.
    sources: Vec<u32>,
    /// The vertex of each normal, and a triangle that has it.
    normal_sources: Vec<[u32; 2]>,
}

impl HostMesh {
    /// Makes the mesh of vertices whose bytes at rest are `rest`, from the first vertex on: as many
    /// as the count times the stride; what follows the last attribute of the last vertex may be
    /// missing. Vertices of equal position at rest have one position from then on, that of the
    /// first of them; normals that differ at rest stay apart. Bounds are those of the vertices at
    /// rest. With a [decoder](HostVertices::with_decoder) of the host it waits for the GPU, which
    /// decodes the vertices at rest.
    ///
    /// # Errors
    /// [`HostMeshError`] if the vertices cannot be read as they are described, or form no mesh.
    pub fn new(
        on: (&wgpu::Device, &wgpu::Queue),
        vertices: HostVertices,
        rest: &[u8],
        indices: HostIndices<'_>,
    ) -> Result<Self, HostMeshError> {
        Self::new_of_material(on, vertices, rest, indices, (Material::default(), &[]))
    }

    /// Makes the mesh as [`new`](Self::new) does, all of one material, which may be masked,
    /// double-sided, or cast or receive no shadows. Texture coordinates, v down, are those of the
    /// vertices, in their order; none for a material without a mask and without a texture. They
    /// stay those: a host that rewrites vertices does not change them.
    ///
    /// # Errors
    /// Those of [`new`](Self::new), and [`HostMeshError::Mesh`] for another number of texture
    /// coordinates than of vertices.
    pub fn new_of_material(
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        vertices: HostVertices,
        rest: &[u8],
        indices: HostIndices<'_>,
        (material, uvs): (Material, &[[f32; 2]]),
    ) -> Result<Self, HostMeshError> {
        let shadows = material.shadows;
        let material = Material {
            shadows: Shadows::Both,
            ..material
        };
        let identity = checked(device, &vertices)?;
        if vertices.count == 0 {
            return Err(HostMeshError::Empty);
        }
        let (needed, given) = (vertices.length(), rest.len() as u64);
        // Bytes of other meshes would be read as those of this one.
        if given < needed || given > needed.max(u64::from(vertices.count) * vertices.stride) {
            return Err(HostMeshError::Rest { needed, given });
        }
        binds(device, "the vertices", needed)?;
        let indices: Cow<'_, [u32]> = match indices {
            HostIndices::U32(indices) => indices.into(),
            HostIndices::U16(indices) => indices.iter().copied().map(u32::from).collect(),
        };
        let indices = &*indices;
        let [positions, normals] = match &vertices.decoder {
            Some(decoder) => decoded(decoder, &vertices, rest, On { device, queue })?,
            None => {
                let read = |attribute| vertices.decoded(attribute, rest);
                let normals = vertices.normal.map(read).unwrap_or_default();
                [read(vertices.position), normals]
            }
        };
        let has_normals = vertices.has_normals();
        let indexed = Indexed {
            positions: &positions,
            normals: &normals,
            indices,
        };
        let mut mesh = if material.is_plain() && uvs.is_empty() {
            indexed.mesh()?
        } else {
            indexed.mesh_of(material, uvs)?
        };
        let (low, high) = mesh.bounds().ok_or(HostMeshError::Empty)?;
        if !has_normals {
            part_normals(&mut mesh);
        }
        binds_mesh(device, &mesh)?;
        let welded = Welded::new(&mesh, &positions, indices);
        let mesh = PartMesh::unchecked(&mesh).with_hierarchy();
        let at_rest = &mesh.movable().rest;
        let rest = Rest {
            sources: welded.sources(at_rest),
            normal_sources: welded.normal_sources(at_rest, indices, has_normals),
            mesh,
        };
        Ok(Self {
            own: Arc::new(Own::new(device, (vertices, identity), Arc::new(rest))),
            bounds: [low, high],
            shadows,
        })
    }

    /// Returns the same mesh with its vertices in another buffer, such as one of another device
    /// after the first was lost. They are as many, in the same order, and at rest where they were;
    /// buffer, offset, stride and formats may be others. Nothing is decoded, welded or built again.
    /// [`SceneProvider::set_host_mesh`](crate::SceneProvider::set_host_mesh) gives it to the parts
    /// of this mesh.
    ///
    /// # Errors
    /// [`HostMeshError::OtherVertices`] for another number of vertices, or if only one of both has
    /// normals; [`HostMeshError::OtherDevice`] for a buffer or decoder of another device than
    /// `device`; those of [`new`](Self::new) for a layout that cannot be read, or more than the
    /// device can bind.
    pub fn with_vertices(
        &self,
        device: &wgpu::Device,
        vertices: HostVertices,
    ) -> Result<Self, HostMeshError> {
        let identity = checked(device, &vertices)?;
        let kind = |host: &HostVertices| (host.count, host.has_normals());
        let [mesh, given] = [kind(&self.own.vertices), kind(&vertices)];
        if given != mesh {
            return Err(HostMeshError::OtherVertices { mesh, given });
        }
        binds(device, "the vertices", vertices.length())?;
        binds_mesh(device, &self.movable().rest)?;
        let own = Own::new(device, (vertices, identity), Arc::clone(&self.own.rest));
        Ok(Self {
            own: Arc::new(own),
            ..*self
        })
    }

    /// Returns the mesh with a role in shadows, for parts that are added of it from then on.
    #[must_use]
    pub fn with_shadows(mut self, shadows: Shadows) -> Self {
        self.shadows = shadows;
        self
    }

    /// Returns the role in shadows of parts that are added of the mesh.
    pub fn shadows(&self) -> Shadows {
        self.shadows
    }

    /// Returns the mesh with stated bounds, low and high corner in the space of its vertices, for a
    /// host that will rewrite the vertices within these bounds.
    ///
    /// # Errors
    /// [`HostMeshError::Bounds`] if a vertex at rest lies outside, or a corner is not finite.
    pub fn with_bounds(mut self, [low, high]: [Vec3; 2]) -> Result<Self, HostMeshError> {
        let rest = &self.movable().rest;
        let is_within = |at: Vec3| at.cmpge(low).all() && at.cmple(high).all();
        let is_finite = low.is_finite() && high.is_finite();
        let is_beyond = |at: &Vec3| !is_finite || !is_within(*at);
        if let Some(position) = rest.used_positions().find(is_beyond) {
            return Err(HostMeshError::Bounds {
                position,
                low,
                high,
            });
        }
        self.bounds = [low, high];
        Ok(self)
    }

    /// Returns the bounds, low and high corner in the space of the vertices: those given to
    /// [`with_bounds`](Self::with_bounds), or else those of the vertices at rest.
    pub fn bounds(&self) -> [Vec3; 2] {
        self.bounds
    }

    /// Returns the room that so many parts of this mesh need in a scene
    /// ([`SceneProvider::reserve`](crate::SceneProvider::reserve)).
    pub fn room(&self, parts: usize) -> Room {
        self.own.rest.mesh.room(parts)
    }

    /// The mesh at rest, as a part.
    pub(crate) fn movable(&self) -> &Arc<Movable> {
        self.own.rest.mesh.movable()
    }

    /// True if its buffers are of a device.
    pub(crate) fn is_on(&self, device: &wgpu::Device) -> bool {
        self.own.device.is(device)
    }

    /// Adds its tree to a hierarchy, for triangles from `first` on.
    pub(crate) fn add_to(&self, tree: &mut TwoLevelBvh, piece: usize, first: usize) {
        self.own.rest.mesh.add_to(tree, piece, first);
    }

    /// The levels of its own tree, or of the one that a piece has in its stead.
    pub(crate) fn levels(
        &self,
        tree: &TwoLevelBvh,
        piece: usize,
        device: &wgpu::Device,
    ) -> wgpu::Buffer {
        let packed = || {
            let content = packed(&tree.levels_of(piece));
            storage(device, "host.levels", bytemuck::cast_slice(&content))
        };
        if self.own.rest.mesh.has_order(tree.order_of(piece)) {
            self.own.levels.get_or_init(packed).clone()
        } else {
            packed()
        }
    }
}

impl Own {
    fn new(
        device: &wgpu::Device,
        (vertices, identity): (HostVertices, DeviceIdentity),
        rest: Arc<Rest>,
    ) -> Self {
        let sources = |content: &[u8]| storage(device, "host.sources", content);
        Self {
            sources: sources(bytemuck::cast_slice(&rest.sources)),
            normal_sources: sources(bytemuck::cast_slice(&rest.normal_sources)),
            device: identity,
            vertices,
            rest,
            levels: OnceLock::new(),
        }
    }
}

/// Checks that vertices can be read as they are described, on that device.
fn checked(
    device: &wgpu::Device,
    vertices: &HostVertices,
) -> Result<DeviceIdentity, HostMeshError> {
    vertices.check()?;
    let identity = DeviceIdentity::new(device);
    if !identity.has_buffer(&vertices.buffer) {
        return Err(HostMeshError::OtherDevice("buffer"));
    }
    let mut decoder = vertices.decoder.iter();
    if decoder.any(|decoder| !decoder.device.is(device)) {
        return Err(HostMeshError::OtherDevice("decoder"));
    }
    Ok(identity)
}

/// Gives each triangle a normal of its own, since those in one plane at rest may part.
fn part_normals(mesh: &mut Mesh) {
    let normals = mesh.normal_indices.iter();
    mesh.normals = normals.map(|own| mesh.normals[own[0] as usize]).collect();
    for (triangle, own) in (0u32..).zip(&mut mesh.normal_indices) {
        *own = [triangle; 3];
    }
}

/// Levels as place.wgsl reads them.
fn packed(levels: &[Vec<u32>]) -> Vec<u32> {
    let mut end = levels.len() as u32 + 2;
    let mut packed = vec![levels.len() as u32, end];
    for level in levels {
        end += level.len() as u32;
        packed.push(end);
    }
    packed.extend(levels.iter().flatten());
    packed
}

/// Checks that a device can bind so many bytes.
fn binds(device: &wgpu::Device, what: &'static str, bytes: u64) -> Result<(), HostMeshError> {
    let limit = binding_limit(&device.limits());
    let is_bound = (bytes <= limit).then_some(());
    is_bound.ok_or(HostMeshError::TooLarge { what, bytes, limit })
}

/// Checks that a device can bind what is made of a mesh.
fn binds_mesh(device: &wgpu::Device, mesh: &Mesh) -> Result<(), HostMeshError> {
    binds(device, "the positions", 16 * mesh.positions.len() as u64)?;
    binds(device, "the normals", 16 * mesh.normals.len() as u64)
}

fn storage(device: &wgpu::Device, label: &str, contents: &[u8]) -> wgpu::Buffer {
    upload(device, label, contents, wgpu::BufferUsages::STORAGE)
}

/// Positions of a mesh by the vertices of the host.
struct Welded {
    /// The position of each vertex.
    of: Vec<u32>,
    /// The first vertex of each position that an index names. Others may hold anything later.
    first: Vec<u32>,
}

impl Welded {
    fn new(mesh: &Mesh, vertices: &[[f32; 3]], indices: &[u32]) -> Self {
        let key = |at: Vec3| (at + Vec3::ZERO).to_array().map(f32::to_bits);
        let places = (0u32..).zip(&mesh.positions);
        let by_key: HashMap<[u32; 3], u32> = places.map(|(index, &at)| (key(at), index)).collect();
        // A vertex that no index names may have no position in the mesh.
        let position = |&at: &[f32; 3]| by_key.get(&key(at.into())).copied().unwrap_or(NONE);
        let welded: Vec<u32> = vertices.iter().map(position).collect();
        let mut first = vec![NONE; mesh.positions.len()];
        for &vertex in indices {
            let first = &mut first[welded[vertex as usize] as usize];
            *first = vertex.min(*first);
        }
        Self { of: welded, first }
    }

    /// The vertex of each position that a triangle uses.
    fn sources(&self, rest: &Mesh) -> Vec<u32> {
        let mut sources = vec![NONE; rest.positions.len()];
        for &corner in rest.triangles.as_flattened() {
            sources[corner as usize] = self.first[corner as usize];
        }
        sources
    }

    /// The vertex of each normal, and a triangle that has it.
    fn normal_sources(&self, rest: &Mesh, indices: &[u32], has_normals: bool) -> Vec<[u32; 2]> {
        let mut sources = vec![[NONE; 2]; rest.normals.len()];
        let place = |corner: &u32| self.of[*corner as usize];
        let triangles = indices.as_chunks::<3>().0.iter();
        let is_flat = |corners: &[u32; 3]| {
            let [a, b, c] = [0, 1, 2].map(|corner| place(&corners[corner]));
            a == b || b == c || c == a
        };
        // Those that were left out have no number.
        let triangles = triangles.filter(|corners| !is_flat(corners));
        for ((triangle, corners), normals) in (0u32..).zip(triangles).zip(&rest.normal_indices) {
            for (&vertex, &normal) in corners.iter().zip(normals) {
                let vertex = if has_normals { vertex } else { NONE };
                sources[normal as usize] = [vertex, 3 * triangle];
            }
        }
        sources
    }
}
