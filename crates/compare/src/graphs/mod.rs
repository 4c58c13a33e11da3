//! From an argument to a graph that can run: presets and params, planning, what a shadow method
//! must hand out. Nothing here runs on a GPU.

pub mod argument;
pub mod faults;
pub mod ground_truth;
pub mod idle_params;
pub mod light_kinds;
pub mod method;
pub mod openings;
pub mod planning;
pub mod preset;
pub mod shadow_method;
pub mod variants;
