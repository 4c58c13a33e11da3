//! Tests across Skiagraph's crates, one module for each subject.

#![allow(clippy::too_many_lines, reason = "a table of cases may be long")]

#[path = "support/bounds.rs"]
mod bounds;
#[path = "../../fuzz/entry.rs"]
mod entry;
#[path = "host/gbuffer.rs"]
mod gbuffer;
#[path = "../../crates/scene/examples/foliage/plant.rs"]
mod plant;
#[path = "../../crates/reference/tests/it/common/scenes.rs"]
#[allow(dead_code, reason = "a part of it is used here")]
mod scenes;
#[path = "../../crates/passes/examples/preset/shadows.rs"]
#[allow(missing_docs, reason = "a program's, not a library's")]
mod shadows;
mod support;

mod area;
mod cascades;
mod changes;
mod clusters;
mod compiled_apart;
mod contact;
mod cpu_one_rings;
mod cpu_reference;
mod cpu_status;
mod cpu_triangles;
mod default_limits;
mod depth;
mod dissertation;
mod documents;
mod engine;
mod extents;
mod figures;
mod filtered;
mod fits;
mod foreign;
mod host;
mod host_buffers;
mod host_depth;
mod hostile;
mod in_encoder;
mod lamp_maps;
mod layers;
mod light_buffer;
mod light_cone;
mod light_space;
mod lost_frames;
mod masked;
mod mirrored;
mod moved_device;
mod moving;
mod moving_on_gpu;
mod moving_rays;
mod one_submission;
mod oracle;
mod other_compilers;
mod predicates;
mod presets;
mod provider;
mod ray_query;
mod rays;
mod readme;
mod receivers;
mod roles;
mod rounds;
mod shaders;
mod sheets;
mod shuffled;
mod splits;
mod spot_layers;
mod texels;
mod trace;
mod unit_visibility;
mod views;
mod watertight;
mod work;
