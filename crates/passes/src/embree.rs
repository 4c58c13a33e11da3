//! The scene in Embree 3: rays traced by the CPU, on all cores. Each piece of the mesh that moves
//! by itself has a hierarchy of its own, of its positions in world space; above them is one of
//! instances that leave everything where it is.

use crate::{
    error::Error,
    geometry::{Geometry, Solid},
    ray_query::check_corners,
};
use embree3::{
    BufferUsage, BuildQuality, Config, Device, Format, GeometryKind, HitN, IntersectContext, Ray16,
    RayHit, RayN, Scene as Tree, SceneFlags, SoAHit, SoARay, ValidMaskN, ValidityN,
};
use glam::{DVec2, Vec3};
use rayon::prelude::*;
use skiagraph_gpu::{CpuWork, ProviderError};
use skiagraph_scene::{Mesh, Surfaces};
use std::{cell::RefCell, collections::BTreeMap, sync::Arc};

/// Rays of a task: enough that tasks cost nothing beside them.
const TASK: usize = 4096;

/// Rays of a packet, the fastest of those that Embree takes for the rays of a picture's pixels.
const PACKET: usize = 16;

/// Primitive of a ray that hits nothing.
const MISS: u32 = u32::MAX;

/// A ray as shaders have it.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Ray {
    origin: Vec3,
    t_min: f32,
    direction: Vec3,
    t_max: f32,
}

/// A hit as shaders have it.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Hit {
    t: f32,
    primitive: u32,
    u: f32,
    v: f32,
}

/// Rays of the task that a thread traces: Embree's filter knows a ray by its number in here.
#[derive(Default)]
struct Task {
    /// Primitive that each ray does not see.
    skip: Vec<u32>,
    hits: Vec<Hit>,
}

thread_local! {
    static TASK_OF_THREAD: RefCell<Task> = RefCell::default();
}

/// A mesh as Embree's hierarchies. Their scenes are *robust*: boxes are padded, and edges are
/// watertight. How a triangle is tested, and rounded, is Embree's own.
pub(crate) struct Embree {
    device: Device,
    /// The hierarchy that rays go through: that of the only solid, or one of instances of all.
    top: Arc<Tree<'static>>,
    /// The first primitive of each solid, by the number of its instance.
    firsts: Vec<u32>,
    solids: BTreeMap<Option<usize>, Bottom>,
}

/// Hierarchy of a solid, with the number of its last change then.
#[derive(Clone)]
struct Bottom {
    tree: Arc<Tree<'static>>,
    changed: u64,
}

/// Column-major matrix that leaves everything where it is.
const IDENTITY: [f32; 16] = [
    1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.,
];

impl Embree {
    /// Builds the hierarchies of a mesh, but those that `before` has already, and returns the
    /// number of triangles that were built over. Primitives count as in the mesh.
    ///
    /// # Errors
    /// An index beyond the mesh's positions, or Embree's own.
    pub fn build(
        mesh: &Mesh,
        geometry: &Geometry,
        before: Option<&Self>,
    ) -> Result<(Self, usize), Error> {
        let solids = geometry.solids(mesh, u32::MAX);
        let known = |solid: &Solid| {
            let known = before?.solids.get(&solid.piece)?;
            (known.changed == solid.changed).then(|| known.clone())
        };
        for solid in solids.iter().filter(|solid| known(solid).is_none()) {
            check_corners(mesh, solid.triangles.clone())?;
        }
        let build = || -> Result<(Self, usize), embree3::Error> {
            let device = match before {
                Some(before) => before.device.clone(),
                None => Device::with_config(Config::default())?,
            };
            let (mut built, mut triangles) = (BTreeMap::new(), 0);
            for solid in &solids {
                let bottom = match known(solid) {
                    Some(known) => known,
                    None => {
                        triangles += solid.triangles.len();
                        Bottom {
                            tree: Arc::new(tree(&device, mesh, geometry, solid)?),
                            changed: solid.changed,
                        }
                    }
                };
                built.insert(solid.piece, bottom);
            }
            let firsts = solids.iter().map(|solid| solid.triangles.start as u32);
            let top = match &solids[..] {
                [only] => Arc::clone(&built[&only.piece].tree),
                _ => Arc::new(instances(&device, &solids, &built)?),
            };
            let built = Self {
                device,
                top,
                firsts: firsts.collect(),
                solids: built,
            };
            Ok((built, triangles))
        };
        build().map_err(|why| Error::Embree(format!("{why:?}")))
    }

    fn any(&self, rays: &[Ray], context: &mut IntersectContext) {
        for (packet, rays) in rays.chunks(PACKET).enumerate() {
            let mut lanes = Ray16::empty();
            for lane in 0..PACKET {
                match rays.get(lane).filter(|ray| ray.has_way()) {
                    Some(ray) => {
                        lanes.set_org(lane, ray.origin.to_array());
                        lanes.set_dir(lane, ray.direction.to_array());
                        lanes.set_tnear(lane, ray.t_min);
                        lanes.set_tfar(lane, ray.t_max);
                        lanes.set_id(lane, (packet * PACKET + lane) as u32);
                    }
                    None => {
                        lanes.set_tnear(lane, 1.0);
                        lanes.set_tfar(lane, 0.0);
                    }
                }
            }
            let all = ValidMaskN::<PACKET>::all_active();
            self.top.occluded16(context, &mut lanes, &all);
        }
    }

    fn closest(&self, rays: &[Ray], context: &mut IntersectContext) {
        for (index, ray) in rays.iter().enumerate().filter(|(_, ray)| ray.has_way()) {
            let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
            let mut traced = RayHit::from_ray(embree3::Ray::segment_with_id(
                origin,
                direction,
                ray.t_min,
                ray.t_max,
                index as u32,
            ));
            self.top.intersect(context, &mut traced);
            if traced.hit.is_valid() {
                let hit = Hit {
                    t: traced.ray.tfar,
                    primitive: self.first(traced.hit.instID[0]) + traced.hit.primID,
                    u: traced.hit.u,
                    v: traced.hit.v,
                };
                TASK_OF_THREAD.with_borrow_mut(|task| task.hits[index] = hit);
            }
        }
    }

    /// The first primitive of an instance, or of the only solid.
    fn first(&self, instance: u32) -> u32 {
        let instance = if instance == embree3::INVALID_ID {
            0
        } else {
            instance
        };
        self.firsts[instance as usize]
    }

    /// Traces the rays of a task, with the primitives that they do not see if there are any.
    fn trace(&self, rays: &[Ray], skip: Option<&[u32]>, any: bool) -> Vec<Hit> {
        let miss = |ray: &Ray| Hit {
            t: ray.t_max,
            primitive: MISS,
            u: 0.0,
            v: 0.0,
        };
        TASK_OF_THREAD.with_borrow_mut(|task| {
            task.skip.clear();
            match skip {
                Some(skip) => task.skip.extend_from_slice(skip),
                None => task.skip.resize(rays.len(), MISS),
            }
            task.hits = rays.iter().map(miss).collect();
        });
        // Rays from neighbouring pixels towards one light are what Embree calls coherent.
        let is_parallel = rays
            .windows(2)
            .all(|pair| pair[0].direction == pair[1].direction);
        let mut context = if is_parallel {
            IntersectContext::coherent()
        } else {
            IntersectContext::incoherent()
        };
        if any {
            self.any(rays, &mut context);
        } else {
            self.closest(rays, &mut context);
        }
        TASK_OF_THREAD.with_borrow_mut(|task| std::mem::take(&mut task.hits))
    }
}

impl CpuWork for Embree {
    fn run(&self, entry: &str, reads: &[&[u8]], writes: &mut [u8]) -> Result<(), ProviderError> {
        let [rays, skip @ ..] = reads else {
            return Err(ProviderError::new("Embree got no rays".to_owned()));
        };
        let any = entry.starts_with("any_hit");
        let tasks = rays
            .par_chunks(TASK * size_of::<Ray>())
            .zip(writes.par_chunks_mut(TASK * size_of::<Hit>()));
        tasks.enumerate().for_each(|(task, (rays, hits))| {
            let rays: Vec<Ray> = bytemuck::pod_collect_to_vec(rays);
            let skip: Option<Vec<u32>> = skip.first().map(|skip| {
                let first = task * TASK * size_of::<u32>();
                bytemuck::pod_collect_to_vec(&skip[first..first + rays.len() * size_of::<u32>()])
            });
            let traced = self.trace(&rays, skip.as_deref(), any);
            hits.copy_from_slice(bytemuck::cast_slice(&traced));
        });
        Ok(())
    }
}

impl std::fmt::Debug for Embree {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Embree")
    }
}

impl Ray {
    /// True if there is a way to trace, of numbers that Embree takes.
    fn has_way(&self) -> bool {
        let is_finite = self.origin.is_finite() && self.direction.is_finite();
        is_finite && self.direction != Vec3::ZERO && 0.0 <= self.t_min && self.t_min < self.t_max
    }
}

/// Builds the hierarchy of a solid.
fn tree(
    device: &Device,
    mesh: &Mesh,
    of: &Geometry,
    solid: &Solid,
) -> Result<Tree<'static>, embree3::Error> {
    let mut tree: Tree<'static> = device.create_scene()?;
    let mut geometry = device.create_geometry(GeometryKind::TRIANGLE)?;
    let together = solid.piece.is_none();
    let together = together.then(|| of.together(mesh, solid, u32::MAX));
    let corners = match &together {
        Some(corners) => &corners[..],
        None => &mesh.triangles[solid.triangles.clone()],
    };
    let used = corners.as_flattened().iter();
    let ends = used.fold([u32::MAX, 0], |[low, high], &corner| {
        [low.min(corner), high.max(corner)]
    });
    let [low, high] = ends.map(|end| end as usize);
    let positions = &mesh.positions[low..high + 1];
    let positions: Vec<[f32; 3]> = positions.iter().map(|p| p.to_array()).collect();
    let corners: Vec<[u32; 3]> = corners
        .iter()
        .map(|of| of.map(|corner| corner - low as u32))
        .collect();
    let [places, triangles] = [positions.len(), corners.len()];
    geometry
        .set_new_buffer::<[f32; 3]>(BufferUsage::VERTEX, 0, Format::FLOAT3, 12, places)?
        .copy_from_slice(&positions);
    geometry
        .set_new_buffer::<[u32; 3]>(BufferUsage::INDEX, 0, Format::UINT3, 12, triangles)?
        .copy_from_slice(&corners);
    let first = solid.triangles.start as u32;
    let masks = masks_of(mesh, solid).map(Arc::new);
    let masked = masks.clone();
    geometry.set_occluded_filter_function::<_, ()>(move |rays, hits, valid, _, _| {
        filter((first, masked.as_deref()), rays, hits, valid, true);
    });
    geometry.set_intersect_filter_function::<_, ()>(move |rays, hits, valid, _, _| {
        filter((first, masks.as_deref()), rays, hits, valid, false);
    });
    tree.attach_geometry(&geometry.commit());
    committed(&mut tree);
    Ok(tree)
}

/// Builds the hierarchy of instances of solids, in their order.
fn instances(
    device: &Device,
    solids: &[Solid],
    built: &BTreeMap<Option<usize>, Bottom>,
) -> Result<Tree<'static>, embree3::Error> {
    let mut top: Tree<'static> = device.create_scene()?;
    for (number, solid) in (0..).zip(solids) {
        let mut instance = device.create_geometry(GeometryKind::INSTANCE)?;
        instance.set_instanced_scene(&built[&solid.piece].tree);
        instance.set_transform(0, &IDENTITY);
        top.attach_geometry_by_id(&instance.commit(), number);
    }
    committed(&mut top);
    Ok(top)
}

fn committed(tree: &mut Tree<'static>) {
    tree.set_flags(SceneFlags::ROBUST);
    tree.set_build_quality(BuildQuality::HIGH);
    tree.commit();
}

/// The surfaces of a solid, if some of its triangles are masked: of its triangles alone, in their
/// order.
fn masks_of(mesh: &Mesh, solid: &Solid) -> Option<Surfaces> {
    let all = &mesh.surfaces;
    let mut triangles = solid.triangles.clone();
    triangles.any(|id| all.mask(id as u32).is_some()).then(|| {
        let ids = solid.triangles.clone().map(|id| id as u32);
        let uvs: Vec<_> = ids.flat_map(|id| all.corner_uvs(id)).collect();
        let corners = (0..uvs.len() as u32).collect::<Vec<_>>();
        Surfaces {
            uvs,
            uv_indices: corners.as_chunks().0.to_vec(),
            materials: all.materials.clone(),
            of: all.of[solid.triangles.clone()].to_vec(),
        }
    })
}

/// Rejects the hits of each ray on its own primitive, at its very begin, and where a mask has
/// holes. Keeps one that ends its ray, which Embree does not tell. Of a solid it gets the first
/// primitive, and the surfaces.
fn filter(
    (first, masks): (u32, Option<&Surfaces>),
    rays: RayN<'_>,
    hits: HitN<'_>,
    mut valid: ValidityN<'_>,
    any: bool,
) {
    TASK_OF_THREAD.with_borrow_mut(|task| {
        for lane in 0..valid.len() {
            if valid[lane] == 0 {
                continue;
            }
            let (index, own) = (rays.id(lane) as usize, hits.prim_id(lane));
            let [u, v] = hits.uv(lane);
            let (t, primitive) = (rays.tfar(lane), first + own);
            if primitive == task.skip[index]
                || t <= rays.tnear(lane)
                || masks.is_some_and(|masks| !is_opaque(masks, own, [u, v]))
            {
                valid[lane] = 0;
            } else if any {
                task.hits[index] = Hit { t, primitive, u, v };
            }
        }
    });
}

/// True if a primitive is there at the weights of its second and third corner.
fn is_opaque(surfaces: &Surfaces, primitive: u32, [b, c]: [f32; 2]) -> bool {
    let Some(mask) = surfaces.mask(primitive) else {
        return true;
    };
    let [uv_a, uv_b, uv_c] = surfaces.corner_uvs(primitive);
    let uv = uv_a + (b * (uv_b - uv_a) + c * (uv_c - uv_a));
    mask.ask(uv.as_dvec2(), DVec2::ZERO).opaque
}
