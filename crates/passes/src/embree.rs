//! The scene in Embree 3: rays traced by the CPU, on all cores.

use crate::{error::Error, part_mesh::check_corners};
use embree3::{
    BufferUsage, BuildQuality, Config, Device, Format, GeometryKind, HitN, IntersectContext, Ray16,
    RayHit, RayN, Scene as Tree, SceneFlags, SoAHit, SoARay, ValidMaskN, ValidityN,
};
use glam::{DVec2, Vec3};
use rayon::prelude::*;
use skiagraph_gpu::{CpuWork, ProviderError};
use skiagraph_scene::{Mesh, Scene};
use std::{cell::RefCell, sync::Arc};

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

/// A mesh as Embree's hierarchy. Its scene is *robust*: boxes are padded, and edges are watertight.
/// How a triangle is tested, and rounded, is Embree's own.
pub(crate) struct Embree(Tree<'static>);

impl Embree {
    /// Builds the hierarchy of a scene's mesh; primitives count as in the mesh.
    ///
    /// # Errors
    /// An index beyond the mesh's positions, or Embree's own.
    pub fn build(scene: &Arc<Scene>) -> Result<Self, Error> {
        check_corners(&scene.mesh, 0..scene.mesh.triangles.len())?;
        let tree = tree(scene).map_err(|why| Error::Embree(format!("{why:?}")))?;
        Ok(Self(tree))
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
            let active = ValidMaskN::<PACKET>::all_active();
            self.0.occluded16(context, &mut lanes, &active);
        }
    }

    fn closest(&self, rays: &[Ray], context: &mut IntersectContext) {
        for (index, ray) in rays.iter().enumerate().filter(|(_, ray)| ray.has_way()) {
            let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
            let (near, far, id) = (ray.t_min, ray.t_max, index as u32);
            let segment = embree3::Ray::segment_with_id(origin, direction, near, far, id);
            let mut traced = RayHit::from_ray(segment);
            self.0.intersect(context, &mut traced);
            if traced.hit.is_valid() {
                let hit = Hit {
                    t: traced.ray.tfar,
                    primitive: traced.hit.primID,
                    u: traced.hit.u,
                    v: traced.hit.v,
                };
                TASK_OF_THREAD.with_borrow_mut(|task| task.hits[index] = hit);
            }
        }
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
        let mut pairs = rays.windows(2);
        let is_parallel = pairs.all(|pair| pair[0].direction == pair[1].direction);
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

fn tree(scene: &Arc<Scene>) -> Result<Tree<'static>, embree3::Error> {
    let mesh = &scene.mesh;
    let device = Device::with_config(Config::default())?;
    let mut tree: Tree<'static> = device.create_scene()?;
    if !mesh.triangles.is_empty() {
        let mut geometry = device.create_geometry(GeometryKind::TRIANGLE)?;
        let positions: Vec<[f32; 3]> = mesh.positions.iter().map(|p| p.to_array()).collect();
        let (corners, triangles) = (positions.len(), mesh.triangles.len());
        geometry
            .set_new_buffer::<[f32; 3]>(BufferUsage::VERTEX, 0, Format::FLOAT3, 12, corners)?
            .copy_from_slice(&positions);
        geometry
            .set_new_buffer::<[u32; 3]>(BufferUsage::INDEX, 0, Format::UINT3, 12, triangles)?
            .copy_from_slice(&triangles_of(mesh));
        let masked = Arc::clone(scene);
        geometry.set_occluded_filter_function::<_, ()>(move |rays, hits, valid, _, _| {
            filter(&masked.mesh, rays, hits, valid, true);
        });
        let masked = Arc::clone(scene);
        geometry.set_intersect_filter_function::<_, ()>(move |rays, hits, valid, _, _| {
            filter(&masked.mesh, rays, hits, valid, false);
        });
        tree.attach_geometry(&geometry.commit());
    }
    tree.set_flags(SceneFlags::ROBUST);
    tree.set_build_quality(BuildQuality::HIGH);
    tree.commit();
    Ok(tree)
}

/// The triangles of a mesh; one that casts no shadow names corners that there are not, for which
/// Embree leaves it out of its hierarchy.
fn triangles_of(mesh: &Mesh) -> Vec<[u32; 3]> {
    let mut triangles = mesh.triangles.clone();
    for (primitive, corners) in (0..).zip(&mut triangles) {
        if !mesh.casts(primitive) {
            *corners = [MISS; 3];
        }
    }
    triangles
}

/// Rejects the hits of each ray on its own primitive, at its very begin, and where a mask has
/// holes. Keeps one that ends its ray, which Embree does not tell.
fn filter(mesh: &Mesh, rays: RayN<'_>, hits: HitN<'_>, mut valid: ValidityN<'_>, any: bool) {
    TASK_OF_THREAD.with_borrow_mut(|task| {
        for lane in 0..valid.len() {
            if valid[lane] == 0 {
                continue;
            }
            let (index, primitive) = (rays.id(lane) as usize, hits.prim_id(lane));
            let [u, v] = hits.uv(lane);
            let t = rays.tfar(lane);
            if primitive == task.skip[index]
                || t <= rays.tnear(lane)
                || !is_opaque(mesh, primitive, [u, v])
            {
                valid[lane] = 0;
            } else if any {
                task.hits[index] = Hit { t, primitive, u, v };
            }
        }
    });
}

/// True if a primitive is there at the weights of its second and third corner.
fn is_opaque(mesh: &Mesh, primitive: u32, [b, c]: [f32; 2]) -> bool {
    let Some(mask) = mesh.surfaces.mask(primitive) else {
        return true;
    };
    let [uv_a, uv_b, uv_c] = mesh.surfaces.corner_uvs(primitive);
    let uv = uv_a + (b * (uv_b - uv_a) + c * (uv_c - uv_a));
    mask.ask(uv.as_dvec2(), DVec2::ZERO).opaque
}
