//! Every shader parses and validates, and the uniforms are laid out as Rust lays them out. No GPU.

use crate::support;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use skiagraph_graph::Sources;
use skiagraph_passes::{
    EmbeddedSources,
    uniforms::{CameraUniform, LightAreaUniform, LightUniform, UnprojectionUniform},
};
use skiagraph_scene::LightSpaceNode;
use std::mem::offset_of;

fn module(path: &str) -> naga::Module {
    let text = support::expanded(path);
    naga::front::wgsl::parse_str(&text)
        .unwrap_or_else(|error| panic!("{path}: {}", error.emit_to_string(&text)))
}

#[test]
fn shaders_are_valid() {
    let files = EmbeddedSources.list("shaders");
    assert!(files.len() >= 8, "{files:?}");
    for file in files {
        // The graph assigns the bindings.
        let flags = ValidationFlags::all() - ValidationFlags::BINDINGS;
        let beyond = match file.as_str() {
            "trace_ray_query.wgsl" => Capabilities::RAY_QUERY,
            _ => Capabilities::empty(),
        };
        let mut validator = Validator::new(flags, beyond);
        if let Err(error) = validator.validate(&module(&file)) {
            panic!(
                "{file}: {}",
                error.emit_to_string(&support::expanded(&file))
            );
        }
    }
}

#[test]
fn shaders_open_with_what_they_do() {
    for file in EmbeddedSources.list("shaders") {
        let text = EmbeddedSources
            .read(&format!("shaders/{file}"))
            .unwrap()
            .unwrap();
        assert!(text.starts_with("// Stage to "), "{file}");
    }
}

/// Name, offset and size of a WGSL struct's members, and its size.
fn layout(path: &str, name: &str) -> (Vec<(String, u32)>, u32) {
    let module = module(path);
    let (_, ty) = module
        .types
        .iter()
        .find(|(_, ty)| ty.name.as_deref() == Some(name))
        .unwrap();
    let naga::TypeInner::Struct { members, span } = &ty.inner else {
        panic!("{name} is not a struct")
    };
    let members = members
        .iter()
        .map(|member| (member.name.clone().unwrap(), member.offset));
    (members.collect(), *span)
}

macro_rules! rust_layout {
    ($ty:ty { $($field:ident),* }) => {
        (
            vec![$((stringify!($field).to_owned(), offset_of!($ty, $field) as u32)),*],
            size_of::<$ty>() as u32,
        )
    };
}

#[test]
fn camera_is_laid_out_as_in_rust() {
    let rust = rust_layout!(CameraUniform {
        eye,
        near,
        eye_low,
        far,
        right,
        half_width,
        up,
        half_height,
        forward,
        depth_scale,
        jitter,
        jitter_clip
    });
    assert_eq!(layout("shared/camera.wgsl", "Camera"), rust);
}

#[test]
fn unprojection_is_laid_out_as_in_rust() {
    let rust = rust_layout!(UnprojectionUniform {
        relative_from_clip,
        origin,
        is_reversed,
        origin_low,
        padding
    });
    assert_eq!(layout("shared/unprojection.wgsl", "Unprojection"), rust);
}

#[test]
fn light_is_laid_out_as_in_rust() {
    // `centre` and `extent` are vec4 in WGSL: their w is a field of its own in Rust.
    let rust = rust_layout!(LightUniform {
        clip_from_relative,
        to_light,
        max_distance,
        centre,
        extent,
        position,
        edge_cosine,
        position_low,
        range
    });
    assert_eq!(layout("shared/light.wgsl", "Light"), rust);
}

#[test]
fn light_area_is_laid_out_as_in_rust() {
    let rust = rust_layout!(LightAreaUniform {
        right,
        radius,
        up,
        padding
    });
    assert_eq!(layout("shared/light_area.wgsl", "LightArea"), rust);
}

#[test]
fn rays_hits_and_nodes_have_their_contracted_sizes() {
    assert_eq!(layout("trace_rays.wgsl", "Ray").1, 32);
    assert_eq!(layout("trace_rays.wgsl", "Hit").1, 16);
    let (members, size) = layout("trace_rays.wgsl", "Node");
    let offsets: Vec<u32> = members.iter().map(|member| member.1).collect();
    assert_eq!((offsets, size), (vec![0, 12, 16, 28], 32));
    let (members, size) = layout("trace_light_space.wgsl", "Node");
    let rust = rust_layout!(LightSpaceNode {
        low,
        high,
        farthest,
        link
    });
    assert_eq!((members, size), rust);
}

#[test]
fn constants_that_shaders_and_rust_share_agree() {
    let constant = |path: &str, name: &str| {
        let text = support::expanded(path);
        let line = text
            .lines()
            .find(|line| line.starts_with(&format!("const {name}:")))
            .unwrap();
        line.split(['=', ';'])
            .nth(1)
            .unwrap()
            .trim()
            .trim_end_matches('u')
            .to_owned()
    };
    let inset: f64 = constant("shared/pixel_weights.wgsl", "INSET")
        .parse()
        .unwrap();
    assert_eq!(inset, skiagraph_reference::receiver::INSET);
    let constant = |path, name| constant(path, name).parse::<u32>().unwrap();
    // One entry per level at most: an inner node pushes one child and goes on with the other.
    let stack = constant("shared/trace_entries.wgsl", "STACK_SIZE");
    assert!(stack >= skiagraph_scene::bvh::MAX_DEPTH);
    let bits = constant("trace_light_space.wgsl", "LEAF_BITS");
    assert_eq!(bits, LightSpaceNode::LEAF_BITS);
    let mask = constant("trace_light_space.wgsl", "LEAF_MASK");
    assert_eq!(mask, (1 << bits) - 1);
}
