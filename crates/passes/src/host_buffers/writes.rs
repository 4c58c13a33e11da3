//! Kernels that write the parts of hosts' buffers into those of the scene.

use super::kernel_module::{ENTRIES, KernelModule};
use super::mesh::HostMesh;
use super::mesh_record::{MOST_GROUPS, MeshRecord, across_items};
use crate::buffers::{On, check_binding, refused, upload};
use crate::error::Error;
use crate::host;
use crate::parts::PartId;
use glam::{DAffine3, DVec3, Vec3};
use std::sync::Arc;

/// A part that is to be written.
pub(crate) struct HostWrite {
    pub id: PartId,
    pub mesh: HostMesh,
    pub map: DAffine3,
    /// Bounds of its vertices before they are moved.
    pub bounds: [Vec3; 2],
    /// Where its positions, normals and triangles begin in those of the scene.
    pub first: [usize; 3],
    /// Where its nodes begin, and their levels; none for writes of other things.
    pub nodes: Option<(usize, wgpu::Buffer)>,
}

/// As `Part` in place.wgsl.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct PartRecord {
    map: [u64; 12],
    across: [[f32; 4]; 3],
    low: [f32; 3],
    first_position: u32,
    high: [f32; 3],
    first_normal: u32,
    first_triangle: u32,
    first_node: u32,
    /// Number among all parts that are written.
    number: u32,
    padding: u32,
}

/// Kernels, by the numbers of their entry points.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kernel {
    Positions,
    /// Writes normals, and reads positions and indices.
    Normals,
    /// Writes nodes, and reads positions, indices and primitives.
    Nodes,
    /// Finds the first vertex of each part that is beyond its bounds.
    Beyond,
    /// Writes positions of parts of the scene's own mesh.
    Own,
}

impl Kernel {
    /// The bindings that its entry point uses, of which a pipeline's layout has no others: those of
    /// vertices and parts, and those of the buffer that it writes and the scene's that it reads.
    fn bindings(self) -> (&'static [u32], &'static [u32]) {
        match self {
            Self::Positions => (&[0, 1, 2, 3], &[5]),
            Self::Normals => (&[0, 1, 2, 4], &[6, 7, 8]),
            Self::Nodes => (&[1], &[11, 7, 8, 9]),
            Self::Beyond => (&[0, 1, 2, 3], &[12]),
            Self::Own => (&[1], &[14, 5]),
        }
    }
}

/// A kernel with the buffer that it writes and the scene's buffers that it reads, in the order of
/// its bindings.
pub(crate) type Written<'a> = (Kernel, &'a [&'a wgpu::Buffer]);

impl HostWrite {
    /// Sorts parts so that those of one mesh are one dispatch.
    pub fn sorted(mut parts: Vec<Self>) -> Vec<Self> {
        parts.sort_by_key(|part| Arc::as_ptr(&part.mesh.own));
        parts
    }
}

/// The kernels on a device for vertices of our formats, made when they are first asked for.
#[derive(Clone, Default)]
pub(crate) struct Kernels {
    made: Option<Arc<KernelModule>>,
}

/// Kernels with all that they read and write.
pub(crate) struct Bound(Vec<Batch>);

/// Parts of one mesh that one dispatch writes.
struct Batch {
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    workgroups: [u32; 2],
    /// Number of bytes that were uploaded for it.
    uploaded: u64,
}

impl Bound {
    /// Returns the number of bytes that were uploaded for the kernels.
    pub fn uploaded(&self) -> u64 {
        self.0.iter().map(|batch| batch.uploaded).sum()
    }

    /// Records the kernels.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        for batch in &self.0 {
            let [across, parts] = batch.workgroups;
            pass.set_pipeline(&batch.pipeline);
            pass.set_bind_group(0, &batch.group, &[]);
            pass.dispatch_workgroups(across, parts, 1);
        }
    }
}

impl Kernels {
    /// Binds parts, in the order of their meshes, for a kernel that writes them.
    ///
    /// # Errors
    /// [`Error::TooLarge`] if the device cannot bind the vertices of a mesh,
    /// [`Error::HostVertices`] if it refuses them.
    pub fn bind(
        &mut self,
        written: Written,
        parts: &[HostWrite],
        device: &wgpu::Device,
    ) -> Result<Bound, Error> {
        let batch = |(first, parts): (usize, &[HostWrite])| {
            let make = || {
                let mesh = &parts[0].mesh;
                let pipeline = self.pipeline(written.0, mesh, device);
                let (group, uploaded) = bind(&pipeline, written, (first, parts), device)?;
                Ok(Batch {
                    pipeline,
                    group,
                    workgroups: [groups(written.0, mesh), parts.len() as u32],
                    uploaded,
                })
            };
            refused(device, make).map_err(|why| unread(parts, why))?
        };
        let batches: Result<Vec<_>, Error> = batches(parts).map(batch).collect();
        Ok(Bound(batches?))
    }

    /// Binds parts of the scene's own mesh, which the GPU moves by `maps`; those without one stay.
    /// `buffers` are their positions at rest, each with the number of its map, and the scene's.
    ///
    /// # Errors
    /// [`Error::TooLarge`] for more parts than the device can bind.
    pub fn bind_own(
        &mut self,
        buffers: [&wgpu::Buffer; 2],
        maps: impl Iterator<Item = Option<DAffine3>>,
        device: &wgpu::Device,
    ) -> Result<Bound, Error> {
        let record = |map: Option<DAffine3>| PartRecord {
            number: if map.is_some() { 0 } else { u32::MAX },
            ..PartRecord::of_map(&map.unwrap_or_default())
        };
        let records: Vec<PartRecord> = maps.map(record).collect();
        let content: &[u8] = bytemuck::cast_slice(&records);
        check_binding("moved parts", content.len() as u64, device)?;
        let records = upload(device, "moved parts", content, wgpu::BufferUsages::STORAGE);
        let pipeline = self.own(device).pipeline(Kernel::Own as usize, device);
        let (own, of_scene) = Kernel::Own.bindings();
        let bindings = own.iter().chain(of_scene).copied();
        let bound = bindings.zip([&records, buffers[0], buffers[1]]);
        let bound = bound.map(|(at, buffer)| (at, buffer.as_entire_binding()));
        let group = group(&pipeline, Kernel::Own, bound, device);
        let positions = (buffers[0].size() / 16) as u32;
        Ok(Bound(vec![Batch {
            pipeline,
            group,
            workgroups: [across_items(positions), 1],
            uploaded: content.len() as u64,
        }]))
    }

    /// Looks for a vertex beyond the bounds of its part, and waits for the answer.
    ///
    /// # Errors
    /// [`Error::Beyond`] with the first one that is found, and those of [`bind`](Self::bind).
    pub fn check_bounds(&mut self, parts: &[HostWrite], on: On) -> Result<(), Error> {
        let none = vec![u32::MAX; parts.len()];
        let (label, none) = ("vertices beyond their bounds", bytemuck::cast_slice(&none));
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        let beyond = upload(on.device, label, none, usage);
        let bound = self.bind((Kernel::Beyond, &[&beyond]), parts, on.device)?;
        let mut encoder = on.device.create_command_encoder(&Default::default());
        bound.record(&mut encoder);
        let submitted = refused(on.device, || on.queue.submit([encoder.finish()]));
        submitted.map_err(|why| unread(parts, why))?;
        let bytes = host::read("bounds check", beyond.slice(..), on.device, on.queue)?;
        let vertices: Vec<u32> = bytemuck::pod_collect_to_vec(&bytes);
        let mut beyond = parts.iter().zip(vertices);
        match beyond.find(|(_, vertex)| *vertex != u32::MAX) {
            Some((part, vertex)) => Err(Error::Beyond {
                part: part.id,
                vertex,
                bounds: part.bounds,
            }),
            None => Ok(()),
        }
    }

    /// The kernel that writes parts of a mesh, by its decoder.
    fn pipeline(
        &mut self,
        kernel: Kernel,
        mesh: &HostMesh,
        device: &wgpu::Device,
    ) -> wgpu::ComputePipeline {
        let decoder = mesh.own.vertices.decoder.as_ref();
        // Nodes are fitted to positions.
        match decoder.filter(|_| kernel != Kernel::Nodes) {
            Some(decoder) => decoder.made.pipeline(kernel as usize, device),
            None => self.own(device).pipeline(kernel as usize, device),
        }
    }

    fn own(&mut self, device: &wgpu::Device) -> &KernelModule {
        let make = || Arc::new(KernelModule::new(device, include_str!("decode.wgsl")));
        self.made.get_or_insert_with(make)
    }
}

/// The error of parts whose vertices cannot be read.
fn unread(parts: &[HostWrite], why: String) -> Error {
    let parts = parts.iter().map(|part| part.id).collect();
    Error::HostVertices { parts, why }
}

/// Runs of parts that one dispatch writes, each with the number of its first part.
fn batches(parts: &[HostWrite]) -> impl Iterator<Item = (usize, &[HostWrite])> {
    let is_alike = |a: &HostWrite, b: &HostWrite| {
        let levels = |write: &HostWrite| write.nodes.as_ref().map(|nodes| nodes.1.clone());
        Arc::ptr_eq(&a.mesh.own, &b.mesh.own) && levels(a) == levels(b)
    };
    let runs = parts.chunk_by(is_alike);
    let runs = runs.flat_map(|run| run.chunks(MOST_GROUPS as usize));
    runs.scan(0, |first, run| {
        let begins = *first;
        *first += run.len();
        Some((begins, run))
    })
}

/// Workgroups for each part.
fn groups(kernel: Kernel, mesh: &HostMesh) -> u32 {
    let rest = &mesh.movable().rest;
    let items = match kernel {
        Kernel::Positions | Kernel::Beyond => rest.positions.len(),
        Kernel::Normals => rest.normals.len(),
        Kernel::Nodes | Kernel::Own => 1,
    };
    across_items(items as u32)
}

/// The bind group of some parts of one mesh, and the number of bytes that were uploaded for it.
fn bind(
    pipeline: &wgpu::ComputePipeline,
    (kernel, buffers): Written,
    (begins, parts): (usize, &[HostWrite]),
    device: &wgpu::Device,
) -> Result<(wgpu::BindGroup, u64), Error> {
    let (rest, mesh) = (&parts[0].mesh.movable().rest, &parts[0].mesh.own);
    let vertices = &mesh.vertices;
    let alignment = u64::from(device.limits().min_storage_buffer_offset_alignment);
    let offset = vertices.offset - vertices.offset % alignment;
    let first = vertices.offset - offset;
    let bytes = first + vertices.length();
    check_binding("the vertices of a host's mesh", bytes, device)?;
    let numbers = [rest.positions.len(), rest.normals.len()];
    let record = MeshRecord::new(vertices, first, numbers.map(|number| number as u32));
    let records = (begins..).zip(parts);
    let records = records.map(|(at, part)| PartRecord::new(at, part));
    let records: Vec<PartRecord> = records.collect();
    let upload = |contents: &[u8], usage| upload(device, "host parts", contents, usage);
    let records: &[u8] = bytemuck::cast_slice(&records);
    let uploaded = (records.len() + size_of::<MeshRecord>()) as u64;
    let records = upload(records, wgpu::BufferUsages::STORAGE);
    let record = upload(bytemuck::bytes_of(&record), wgpu::BufferUsages::UNIFORM);
    let vertices = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
        buffer: &vertices.buffer,
        offset,
        size: std::num::NonZero::new(bytes),
    });
    let own = [
        (0, record.as_entire_binding()),
        (1, records.as_entire_binding()),
        (2, vertices),
        (3, mesh.sources.as_entire_binding()),
        (4, mesh.normal_sources.as_entire_binding()),
    ];
    let (used, of_scene) = kernel.bindings();
    let own = own.into_iter().filter(|(at, _)| used.contains(at));
    let of_scene = of_scene.iter().copied().zip(buffers.iter().copied());
    let levels = parts[0].nodes.iter().map(|(_, levels)| (10, levels));
    let of_scene = of_scene.chain(levels);
    let of_scene = of_scene.map(|(at, buffer)| (at, buffer.as_entire_binding()));
    let group = group(pipeline, kernel, own.chain(of_scene), device);
    Ok((group, uploaded))
}

/// The bind group of a kernel.
fn group<'a>(
    pipeline: &wgpu::ComputePipeline,
    kernel: Kernel,
    bound: impl Iterator<Item = (u32, wgpu::BindingResource<'a>)>,
    device: &wgpu::Device,
) -> wgpu::BindGroup {
    let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
    let entries: Vec<wgpu::BindGroupEntry> = bound.map(entry).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some(ENTRIES[kernel as usize]),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries,
    })
}

impl PartRecord {
    fn of_map(map: &DAffine3) -> Self {
        Self {
            map: map.to_cols_array().map(f64::to_bits),
            across: across(map).map(|axis| axis.as_vec3().extend(0.0).to_array()),
            ..bytemuck::Zeroable::zeroed()
        }
    }

    fn new(number: usize, part: &HostWrite) -> Self {
        let [position, normal, triangle] = part.first.map(|first| first as u32);
        let [low, high] = part.bounds.map(|corner| corner.to_array());
        Self {
            low,
            first_position: position,
            high,
            first_normal: normal,
            first_triangle: triangle,
            first_node: part.nodes.as_ref().map_or(0, |(first, _)| *first as u32),
            number: number as u32,
            ..Self::of_map(&part.map)
        }
    }
}

/// Columns of the matrix that takes normals along, scaled to entries of at most 1.
fn across(map: &DAffine3) -> [DVec3; 3] {
    let across = map.matrix3.inverse().transpose();
    let columns = [across.x_axis, across.y_axis, across.z_axis];
    let largest = columns.map(|axis| axis.abs().max_element());
    let largest = largest.into_iter().fold(f64::MIN_POSITIVE, f64::max);
    columns.map(|axis| axis / largest)
}
