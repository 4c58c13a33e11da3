//! Tests of `crates/scene`, one module for each subject.

#[path = "../../../../tests/it/support/bounds.rs"]
mod bounds;
mod common;
#[path = "common/solids.rs"]
mod solids;

mod alike;
mod bench;
mod bvh;
mod foreign_files;
mod generated;
mod gltf;
mod gltf_animations;
mod gltf_scene;
mod hostile;
mod materials;
mod obj;
mod outlines;
mod park;
mod polygons;
mod quiet_faults;
mod scene_files;
mod scene_writer;
mod sponza;
