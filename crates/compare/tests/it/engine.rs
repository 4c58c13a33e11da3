//! Compares methods on a scene that a program has in memory, as an engine's own tests would.

use glam::DVec3;
use skiagraph_compare::{
    comparison::Comparison,
    graphs::shadow_method::load_methods,
    measuring::device::{self, GpuRequest},
    measuring::series::run,
    sink::{Session, Silent},
};
use skiagraph_gpu::block_on;
use skiagraph_passes::EmbeddedSources;
use skiagraph_scene::{DirectionalLight, Indexed, Light, Scene, View};
use std::{error::Error, sync::Arc};

/// A roof above a floor, each of two triangles.
fn engine_scene() -> Result<Scene, Box<dyn Error>> {
    let square = |half: f32, y: f32| {
        [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]].map(|[x, z]| [x * half, y, z * half])
    };
    let mesh = Indexed {
        positions: &[square(4.0, 0.0), square(1.0, 1.5)].concat(),
        normals: &[],
        indices: &[0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7],
    }
    .mesh()?;
    let view = View {
        name: "above".into(),
        eye: DVec3::new(0.0, 6.0, 7.0),
        direction: DVec3::new(0.0, -6.0, -7.0),
        far: 50.0,
        ..View::default()
    };
    let sun = DirectionalLight::new(DVec3::new(0.6, -1.0, 0.3));
    Ok(Scene {
        name: "roof".into(),
        mesh,
        views: vec![view],
        lights: vec![Light::only(sun)],
    })
}

#[test]
fn shadows_of_our_scene_are_right() -> Result<(), Box<dyn Error>> {
    let methods = load_methods(&["light_buffer", "nsm"], &[], &[256], &EmbeddedSources)?;
    let graphs = methods.iter().map(|method| &method.preset.graph);
    let gpu = device::open(&GpuRequest::default(), graphs)?;
    let mut comparison = Comparison::new(Arc::new(engine_scene()?), methods)?;
    comparison.viewports = vec![[64, 64]];
    comparison.protocol.frames = 1; // times are not asked for
    comparison.protocol.regime_frames = 0;
    let results = block_on(run(&comparison, Session::new(&gpu, &Silent)))?;
    let [exact, mapped] = &results.runs[..] else {
        return Err("two methods on one view are two runs".into());
    };
    assert!(exact.pixels.shadow > 0, "the roof casts a shadow");
    let measured = exact.measured.as_ref().ok_or("light_buffer cannot run")?;
    assert_eq!(measured.wrong_outside_band(), 0);
    let measured = mapped.measured.as_ref().ok_or("nsm cannot run")?;
    let wrong = measured.wrong.total as f64 / mapped.pixels.facing_light as f64;
    // 5.6 % on Mesa's software adapter.
    assert!(wrong <= 0.08, "nsm: {:.1} % wrong", 100.0 * wrong);
    Ok(())
}
