use skiagraph_gpu::{Executor, Frame, device};
use skiagraph_graph::*;
use skiagraph_passes::{EmbeddedSources, SceneProvider, registry};
use skiagraph_scene::*;
use std::sync::Arc;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let (scene, view, size, frames) = (&a[1], &a[2], &a[3], a[4].parse::<usize>().unwrap());
    let (scene, _) = SceneLibrary::from_environment()
        .load(&SceneRequest {
            argument: scene.clone(),
            obj: None,
        })
        .unwrap();
    let scene = Arc::new(scene);
    let view = scene
        .views
        .iter()
        .find(|v| v.name == *view)
        .unwrap()
        .clone();
    let (w, h) = size.split_once('x').unwrap();
    let viewport = [w.parse().unwrap(), h.parse().unwrap()];
    let gpu = device::open(None).unwrap();
    let mut runs = vec![];
    for spec in &a[5..] {
        let mut parts = spec.split(':');
        let dir = parts.next().unwrap();
        let preset = parts.next().unwrap();
        let mut provider = SceneProvider::new(Arc::clone(&scene));
        provider.set_view(&view, viewport);
        let sources = LayeredSources(vec![
            Box::new(FolderSources {
                root: std::path::PathBuf::from(dir),
            }),
            Box::new(EmbeddedSources),
        ]);
        let graph = Graph::load(&format!("pipelines/{preset}.ron"), &registry(), &sources)
            .unwrap_or_else(|e| panic!("{e}"));
        let mut request = PlanRequest::new(viewport, &provider);
        request.limits = gpu.device.limits();
        request.features = gpu.device.features();
        for set in parts {
            let (k, v) = set.split_once('=').unwrap();
            let v = match v.parse::<u32>() {
                Ok(n) => ParamValue::U32(n),
                Err(_) => ParamValue::Choice(v.into()),
            };
            request.params.insert(k.into(), v);
        }
        let plan = graph.plan(&request).unwrap_or_else(|e| panic!("{e}"));
        let executor = Executor::new(&gpu.device, &gpu.queue, plan, &mut provider)
            .unwrap_or_else(|e| panic!("{e}"));
        runs.push((
            spec.clone(),
            executor,
            Vec::<Vec<(String, f64)>>::new(),
            provider,
        ));
    }
    for f in 0..frames + 3 {
        for (_, executor, times, _provider) in &mut runs {
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            executor
                .encode(
                    &mut encoder,
                    &Frame {
                        timing: true,
                        all: true,
                        ..Frame::default()
                    },
                )
                .unwrap();
            gpu.queue.submit([encoder.finish()]);
            executor.submitted().unwrap();
            let r = executor.finish().unwrap();
            if f < 3 {
                executor.grow(_provider).unwrap();
            }
            if f >= 3 {
                times.push(
                    r.timing
                        .unwrap()
                        .passes
                        .iter()
                        .map(|p| (p.name.clone(), p.gpu.unwrap().as_secs_f64() * 1e3))
                        .collect(),
                );
            }
        }
    }
    let med = |mut v: Vec<f64>| {
        v.sort_by(f64::total_cmp);
        v[v.len() / 2]
    };
    let total = |t: &Vec<(String, f64)>| {
        t.iter()
            .filter(|p| !p.0.starts_with("gbuffer"))
            .map(|p| p.1)
            .sum::<f64>()
    };
    let first: Vec<f64> = runs[0].2.iter().map(total).collect();
    for (spec, _, times, _) in &runs {
        let t: Vec<f64> = times.iter().map(total).collect();
        let ratio = med(t.iter().zip(&first).map(|(a, b)| a / b).collect());
        let min = t.iter().copied().fold(1e9, f64::min);
        print!(
            "{spec:45} ratio {ratio:.3} median {:7.1} min {min:7.1} :",
            med(t)
        );
        for i in 0..times[0].len() {
            let m = med(times.iter().map(|t| t[i].1).collect());
            let rel = med(times.iter().zip(&first).map(|(t, f)| t[i].1 / f).collect());
            if m > 0.4 && !times[0][i].0.starts_with("gbuffer") {
                print!(
                    " {}={m:.1}({:.3})",
                    times[0][i].0.rsplit('.').next().unwrap(),
                    rel
                );
            }
        }
        println!();
    }
}
