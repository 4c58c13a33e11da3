//! The scene as acceleration structures of the device: a bottom level for each piece of the mesh
//! that moves by itself, of its positions in world space, and a top level of instances that leave
//! everything where it is. Where a piece has moved, it gets another bottom level; the others keep
//! theirs.

use crate::buffers::{On, refused, upload};
use crate::error::Error;
use crate::geometry::Geometry;
use crate::names::next_version;
use crate::part_mesh::check_corners;
use crate::solids::{Solid, joined_corners, solids};
use skiagraph_scene::Mesh;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use wgpu::{
    AccelerationStructureFlags as Flags, BlasTriangleGeometrySizeDescriptor as Size, TlasInstance,
};

/// Rows of the matrix that leaves everything where it is.
const IDENTITY: [f32; 12] = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0.];

/// Acceleration structures that are kept for the next change.
#[derive(Clone, Default)]
pub(crate) struct Structures {
    bottoms: BTreeMap<Option<[usize; 2]>, Bottom>,
    top: Option<Top>,
}

/// Bottom level of a solid.
#[derive(Clone)]
struct Bottom {
    blas: wgpu::Blas,
    changed: u64,
}

#[derive(Clone)]
struct Top {
    tlas: wgpu::Tlas,
    /// Version of the shape that it is of.
    shape: u64,
    /// Its version as a resource, and the next one: over bottom levels that are compact.
    versions: [u64; 2],
    open: Option<Open>,
}

/// Number of bottom levels whose compact sizes the device has not told yet.
#[derive(Clone, Default)]
struct Open(Arc<AtomicUsize>);

impl Open {
    fn is_none(&self) -> bool {
        self.0.load(Ordering::Acquire) == 0
    }

    /// Asks for the compact size of a bottom level whose build was submitted.
    fn ask(&self, blas: &wgpu::Blas) {
        self.0.fetch_add(1, Ordering::AcqRel);
        let open = Self::clone(self);
        blas.prepare_compaction_async(move |_| {
            open.0.fetch_sub(1, Ordering::AcqRel);
        });
    }
}

impl Top {
    /// True if its bottom levels can be made compact now.
    fn is_ready(&self) -> bool {
        self.open.as_ref().is_some_and(Open::is_none)
    }
}

/// The mesh where structures are made of it.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub mesh: &'a Mesh,
    pub geometry: &'a Geometry,
    /// Positions of 16 bytes, and indices of 4 bytes.
    pub buffers: [&'a wgpu::Buffer; 2],
    /// Version of the mesh's shape.
    pub shape: u64,
    pub on: On<'a>,
}

impl Structures {
    /// Returns the version of the top level over a shape. With the shape as it is, it changes once:
    /// when the device has told how small the bottom levels can be.
    pub fn version(&self, shape: u64) -> u64 {
        match &self.top {
            Some(top) if top.shape == shape => top.versions[usize::from(top.is_ready())],
            _ => shape,
        }
    }

    /// Returns the top level over the mesh, and the number of triangles of the bottom levels that
    /// were built for it, if it was made anew; the builds are recorded into `encoder`, a host's, or
    /// else submitted. Only bottom levels whose build was submitted become compact. Primitives of
    /// an instance are counted from its custom data, and none is opaque: a query sees each as a
    /// candidate. A mesh without triangles is a structure without instances.
    ///
    /// No structure is built a second time, since frames that are encoded may read it.
    ///
    /// # Errors
    /// More triangles than the device can take, an index beyond the mesh's positions, or builds
    /// that the device refuses; those structures are built again when they are next asked for.
    pub fn get(
        &mut self,
        source: Source<'_>,
        encoder: Option<&mut wgpu::CommandEncoder>,
    ) -> Result<(wgpu::Tlas, Option<usize>), Error> {
        let former = self.top.take();
        let is_same = former.as_ref().is_some_and(|top| top.shape == source.shape);
        if let Some(top) = former.as_ref().filter(|top| is_same && !top.is_ready()) {
            let tlas = top.tlas.clone();
            self.top = former;
            return Ok((tlas, None));
        }
        let limits = source.on.device.limits();
        let most = limits.max_tlas_instance_count;
        let solids = solids(source.geometry.pieces(), source.mesh, most);
        let mut versions = [source.shape, next_version()];
        let mut open = None;
        if let Some(top) = former {
            if top.is_ready() {
                self.compact(source.on.queue);
            } else {
                open = top.open;
            }
            if is_same {
                versions = [top.versions[1]; 2];
            }
        }
        let new = self.create(&solids, source)?;
        let is_submitted = encoder.is_none();
        let tlas = self.build(&solids, &new, source, encoder);
        let tlas = tlas.inspect_err(|_| self.bottoms.clear())?;
        let asks = |(_, is_first): &&(_, bool)| *is_first && is_submitted;
        for (solid, _) in new.iter().filter(asks) {
            if let Some(bottom) = self.bottoms.get(&solid.piece) {
                open.get_or_insert_with(Open::default).ask(&bottom.blas);
            }
        }
        let triangles = new.iter().map(|(solid, _)| solid.triangles.len()).sum();
        self.top = Some(Top {
            tlas: tlas.clone(),
            shape: source.shape,
            versions,
            open,
        });
        Ok((tlas, Some(triangles)))
    }

    /// Copies each bottom level whose compact size is known into one of that size.
    fn compact(&mut self, queue: &wgpu::Queue) {
        let bottoms = self.bottoms.values_mut();
        for bottom in bottoms.filter(|bottom| bottom.blas.ready_for_compaction()) {
            bottom.blas = queue.compact_blas(&bottom.blas);
        }
    }

    /// Creates the bottom levels of those solids that are new or have changed, and returns these;
    /// true for those that were never built. Bottom levels of others than `solids` are dropped.
    fn create<'s>(
        &mut self,
        solids: &'s [Solid],
        source: Source<'_>,
    ) -> Result<Vec<(&'s Solid, bool)>, Error> {
        let most = source.on.device.limits().max_blas_primitive_count;
        let mut before = std::mem::take(&mut self.bottoms);
        let mut new = Vec::new();
        for solid in solids {
            let former = before.remove(&solid.piece);
            let is_first = former.is_none();
            let bottom = match former.filter(|bottom| bottom.changed == solid.changed) {
                Some(former) => former,
                None => {
                    let triangles = solid.triangles.len();
                    if triangles as u64 > u64::from(most) {
                        return Err(Error::TooManyTriangles { triangles, most });
                    }
                    check_corners(source.mesh, solid.triangles.clone())?;
                    new.push((solid, is_first));
                    let flags = if is_first {
                        Flags::PREFER_FAST_TRACE | Flags::ALLOW_COMPACTION
                    } else {
                        Flags::PREFER_FAST_BUILD
                    };
                    let descriptor = wgpu::CreateBlasDescriptor {
                        label: Some("scene.blas"),
                        flags,
                        update_mode: wgpu::AccelerationStructureUpdateMode::Build,
                    };
                    let descriptors = vec![size_of(solid, source.mesh)];
                    let sizes = wgpu::BlasGeometrySizeDescriptors::Triangles { descriptors };
                    Bottom {
                        blas: source.on.device.create_blas(&descriptor, sizes),
                        changed: solid.changed,
                    }
                }
            };
            self.bottoms.insert(solid.piece, bottom);
        }
        Ok(new)
    }

    /// Builds the new bottom levels, and a top level over all.
    fn build(
        &self,
        solids: &[Solid],
        new: &[(&Solid, bool)],
        source: Source<'_>,
        encoder: Option<&mut wgpu::CommandEncoder>,
    ) -> Result<wgpu::Tlas, Error> {
        let mut tlas = source.on.device.create_tlas(&wgpu::CreateTlasDescriptor {
            label: Some("scene.tlas"),
            max_instances: solids.len().max(1) as u32,
            flags: Flags::PREFER_FAST_TRACE,
            update_mode: wgpu::AccelerationStructureUpdateMode::Build,
        });
        for (index, solid) in solids.iter().enumerate() {
            let first = solid.triangles.start as u32;
            let bottom = self.bottoms.get(&solid.piece);
            let instance = |it: &Bottom| TlasInstance::new(&it.blas, IDENTITY, first, u8::MAX);
            tlas[index] = bottom.map(instance);
        }
        let most = source.on.device.limits().max_tlas_instance_count;
        let together = new.iter().find(|(solid, _)| solid.piece.is_none());
        let together = together.map(|(solid, _)| {
            let corners = joined_corners(source.geometry.pieces(), source.mesh, solid, most);
            let corners = bytemuck::cast_slice(corners.as_flattened());
            let usage = wgpu::BufferUsages::BLAS_INPUT;
            upload(source.on.device, "scene.blas", corners, usage)
        });
        let sizes = new.iter().map(|(solid, _)| size_of(solid, source.mesh));
        let sizes: Vec<Size> = sizes.collect();
        let [positions, indices] = source.buffers;
        let entries = new.iter().zip(&sizes).filter_map(|((solid, _), size)| {
            let (index_buffer, first) = match (solid.piece, &together) {
                (None, Some(own)) => (own, 0),
                _ => (indices, solid.triangles.start),
            };
            let geometry = wgpu::BlasTriangleGeometry {
                size,
                vertex_buffer: positions,
                first_vertex: 0,
                vertex_stride: 16,
                index_buffer: Some(index_buffer),
                first_index: Some(3 * first as u32),
                transform_buffer: None,
                transform_buffer_offset: None,
            };
            let blas = &self.bottoms.get(&solid.piece)?.blas;
            let geometry = wgpu::BlasGeometries::TriangleGeometries(vec![geometry]);
            Some(wgpu::BlasBuildEntry { blas, geometry })
        });
        let entries: Vec<wgpu::BlasBuildEntry<'_>> = entries.collect();
        if let Some(encoder) = encoder {
            encoder.build_acceleration_structures(entries.iter(), [&tlas]);
            return Ok(tlas);
        }
        let label = Some("scene.tlas");
        let descriptor = wgpu::CommandEncoderDescriptor { label };
        let mut encoder = source.on.device.create_command_encoder(&descriptor);
        encoder.build_acceleration_structures(entries.iter(), [&tlas]);
        let submit = || source.on.queue.submit([encoder.finish()]);
        let submitted = refused(source.on.device, submit);
        submitted.map(|_| tlas).map_err(Error::Structures)
    }
}

fn size_of(solid: &Solid, mesh: &Mesh) -> Size {
    Size {
        vertex_format: wgpu::VertexFormat::Float32x3,
        vertex_count: mesh.positions.len() as u32,
        index_format: Some(wgpu::IndexFormat::Uint32),
        index_count: Some(3 * solid.triangles.len() as u32),
        flags: wgpu::AccelerationStructureGeometryFlags::empty(),
    }
}
