//! Embree 3 on all cores, as the engine `Embree` of `Trace` has it, without the way to the GPU and
//! back.

use super::{Engine, Rays};
use skiagraph_gpu::Provider;
use skiagraph_passes::SceneProvider;
use std::{sync::Arc, time::Instant};

pub fn engine(rays: &Rays) -> Engine<'_> {
    let mut provider = SceneProvider::new(Arc::clone(&rays.scene));
    let begin = Instant::now();
    let embree = provider.build_cpu_work("scene.embree");
    let embree = embree.unwrap_or_else(|why| panic!("{why}"));
    let built = begin.elapsed();
    let trace = move || {
        let (given, skip) = (&rays.set.rays[..], &rays.set.skip[..]);
        let (entry, reads): (_, &[&[u8]]) = match skip {
            [] => ("any_hit", &[bytemuck::cast_slice(given)]),
            _ => (
                "any_hit_skip",
                &[bytemuck::cast_slice(given), bytemuck::cast_slice(skip)],
            ),
        };
        let mut hits = vec![[0u32; 4]; given.len()];
        let begin = Instant::now();
        let done = embree.run(entry, reads, bytemuck::cast_slice_mut(&mut hits));
        done.unwrap_or_else(|why| panic!("{why}"));
        let time = begin.elapsed();
        (time, hits.iter().map(|hit| hit[1] != u32::MAX).collect())
    };
    Engine {
        name: "Embree".to_owned(),
        built,
        trace: Box::new(trace),
        blocked: Vec::new(),
    }
}
