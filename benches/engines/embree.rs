//! Embree 3 on all cores: a robust scene, rays one by one, in packets, in streams.

use super::{Engine, Rays};
use embree3::{
    BufferUsage, BuildQuality, Config, Device, Format, GeometryKind, IntersectContext, Ray8, Ray16,
    Scene, SceneFlags, SoAHit, SoARay, ValidMaskN,
};
use rayon::prelude::*;
use std::{
    sync::Arc,
    time::{Duration, Instant},
};

/// Rays of a task: enough that tasks cost nothing beside them.
const TASK: usize = 4096;

/// The modes, over one hierarchy.
pub fn engines(rays: &Rays) -> Vec<Engine<'_>> {
    let begin = Instant::now();
    let scene = scene(rays).unwrap_or_else(|why| panic!("Embree: {why:?}"));
    let scene = Arc::new(scene);
    let built = begin.elapsed();
    // Rays from neighbouring pixels towards one light are what Embree calls coherent.
    let is_coherent = rays.to_light;
    type Mode = fn(&Scene<'static>, bool, &[embree3::Ray]) -> Vec<bool>;
    let modes: [(&str, Mode); 4] = [
        ("single", single),
        ("packets of 8", packets8),
        ("packets of 16", packets16),
        ("streams", stream),
    ];
    let given: Arc<[embree3::Ray]> = (0..rays.rays.len()).map(|index| ray(rays, index)).collect();
    let engine = |(name, mode): (&str, Mode)| {
        let (scene, given) = (Arc::clone(&scene), Arc::clone(&given));
        let trace = move || -> (Duration, Vec<bool>) {
            let begin = Instant::now();
            let tasks = given.par_chunks(TASK);
            let blocked = tasks.flat_map_iter(|rays| mode(&scene, is_coherent, rays));
            let blocked = blocked.collect();
            (begin.elapsed(), blocked)
        };
        Engine {
            name: format!("Embree, {name}"),
            built,
            trace: Box::new(trace),
            blocked: Vec::new(),
        }
    };
    modes.map(engine).into_iter().collect()
}

fn scene(rays: &Rays) -> Result<Scene<'static>, embree3::Error> {
    let mesh = &rays.scene.mesh;
    let device = Device::with_config(Config::default())?;
    let kind = GeometryKind::TRIANGLE;
    let mut geometry = device.create_geometry(kind)?;
    let positions: Vec<[f32; 3]> = mesh.positions.iter().map(|p| p.to_array()).collect();
    geometry
        .set_new_buffer::<[f32; 3]>(BufferUsage::VERTEX, 0, Format::FLOAT3, 12, positions.len())?
        .copy_from_slice(&positions);
    geometry
        .set_new_buffer::<[u32; 3]>(
            BufferUsage::INDEX,
            0,
            Format::UINT3,
            12,
            mesh.triangles.len(),
        )?
        .copy_from_slice(&mesh.triangles);
    if !rays.skip.is_empty() {
        // A ray skips the triangle whose id it carries.
        geometry.set_occluded_filter_function::<_, ()>(|rays, hits, mut valid, _, _| {
            for lane in 0..valid.len() {
                if valid[lane] != 0 && hits.prim_id(lane) == rays.id(lane) {
                    valid[lane] = 0;
                }
            }
        });
    }
    let geometry = geometry.commit();
    let mut scene: Scene<'static> = device.create_scene()?;
    scene.attach_geometry(&geometry);
    // As watertight as the others.
    scene.set_flags(SceneFlags::ROBUST);
    scene.set_build_quality(BuildQuality::HIGH);
    scene.commit();
    Ok(scene)
}

fn context(is_coherent: bool) -> IntersectContext {
    if is_coherent {
        IntersectContext::coherent()
    } else {
        IntersectContext::incoherent()
    }
}

/// Embree marks a blocked ray by its end.
fn is_blocked(end: f32) -> bool {
    end == f32::NEG_INFINITY
}

fn ray(rays: &Rays, index: usize) -> embree3::Ray {
    let ray = &rays.rays[index];
    let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
    let mut given = embree3::Ray::segment(origin, direction, ray.t_min, ray.t_max);
    given.id = rays.skip.get(index).copied().unwrap_or(u32::MAX);
    given
}

fn single(scene: &Scene<'static>, is_coherent: bool, rays: &[embree3::Ray]) -> Vec<bool> {
    let mut context = context(is_coherent);
    let mut occluded = |ray: &embree3::Ray| {
        let mut ray = *ray;
        scene.occluded(&mut context, &mut ray);
        is_blocked(ray.tfar)
    };
    rays.iter().map(&mut occluded).collect()
}

/// Fills one of many rays; one that is not there is empty.
fn set(into: &mut impl SoARay, at: usize, ray: Option<&embree3::Ray>) {
    match ray {
        Some(ray) => {
            into.set_org(at, [ray.org_x, ray.org_y, ray.org_z]);
            into.set_dir(at, [ray.dir_x, ray.dir_y, ray.dir_z]);
            into.set_tnear(at, ray.tnear);
            into.set_tfar(at, ray.tfar);
            into.set_id(at, ray.id);
        }
        None => {
            into.set_tnear(at, 1.0);
            into.set_tfar(at, 0.0);
        }
    }
}

macro_rules! packets {
    ($name:ident, $packet:ty, $width:literal, $occluded:ident) => {
        fn $name(scene: &Scene<'static>, is_coherent: bool, rays: &[embree3::Ray]) -> Vec<bool> {
            let mut context = context(is_coherent);
            let mut blocked = Vec::with_capacity(rays.len());
            for rays in rays.chunks($width) {
                let mut packet = <$packet>::empty();
                for lane in 0..$width {
                    set(&mut packet, lane, rays.get(lane));
                }
                let all = ValidMaskN::<$width>::all_active();
                scene.$occluded(&mut context, &mut packet, &all);
                blocked.extend((0..rays.len()).map(|lane| is_blocked(packet.tfar(lane))));
            }
            blocked
        }
    };
}

packets!(packets8, Ray8, 8, occluded8);
packets!(packets16, Ray16, 16, occluded16);

fn stream(scene: &Scene<'static>, is_coherent: bool, rays: &[embree3::Ray]) -> Vec<bool> {
    let mut context = context(is_coherent);
    let mut stream = rays.to_vec();
    scene.occluded_stream_aos(&mut context, &mut stream);
    stream.iter().map(|ray| is_blocked(ray.tfar)).collect()
}
