//! What the provider describes and builds, and what it refuses.

mod support;

use glam::DVec3;
use skiagraph_graph::{Provider, gpu::Gpu};
use skiagraph_passes::SceneProvider;
use skiagraph_scene::{DirectionalLight, Mesh, Scene};
use std::sync::Arc;
use support::{graphs::open, meshes};

fn provider(mesh: Mesh) -> SceneProvider {
    let light = DirectionalLight {
        direction: DVec3::NEG_Y,
    };
    SceneProvider::new(Arc::new(Scene {
        name: "test".into(),
        mesh,
        views: vec![],
        light,
    }))
}

fn build(provider: &mut SceneProvider, gpu: &Gpu, name: &str) -> Result<wgpu::Buffer, String> {
    provider
        .build(name, &gpu.device, &gpu.queue)
        .map_err(|error| error.to_string())
}

#[test]
fn buffers_are_as_large_as_described() {
    let gpu = open();
    let mut provider = provider(meshes::soup(50, 0.2, 1));
    for name in provider.names() {
        let described = provider.describe(&name).unwrap();
        let size = build(&mut provider, &gpu, &name).unwrap().size();
        match described.items {
            Some(items) => assert_eq!(size, items * described.stride, "{name}"),
            None => assert_eq!(size % described.stride, 0, "{name}"),
        }
        assert_eq!(described.uniform, !name.starts_with("scene."), "{name}");
    }
}

#[test]
fn an_empty_scene_has_nothing_to_draw_and_something_to_bind() {
    let gpu = open();
    let mut provider = provider(Mesh::default());
    assert_eq!(provider.describe("scene.indices").unwrap().items, Some(0));
    for name in provider.names() {
        let stride = provider.describe(&name).unwrap().stride;
        assert_eq!(
            build(&mut provider, &gpu, &name).unwrap().size(),
            stride,
            "{name}"
        );
    }
}

#[test]
fn an_unknown_resource_is_named_with_those_that_there_are() {
    let gpu = open();
    let mut provider = provider(Mesh::default());
    assert!(provider.describe("scene.position").is_none());
    let error = build(&mut provider, &gpu, "scene.position").unwrap_err();
    assert!(
        error.contains("`scene.position`") && error.contains("scene.positions"),
        "{error}"
    );
    assert!(provider.built().is_empty());
}
