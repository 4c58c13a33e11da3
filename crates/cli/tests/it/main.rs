//! Tests of `crates/cli`, one module for each subject.

#![allow(clippy::too_many_lines, reason = "a table of cases may be long")]

mod support;

#[cfg(unix)]
mod adapter;
mod backends;
mod cannot_run;
mod cells;
mod check;
mod command_line;
mod endless_files;
mod faults;
mod foreign_files;
mod judge;
mod new;
mod on_a_gpu;
mod own_scene;
mod paths;
mod profile;
mod recording;
mod report;
mod several_scenes;
mod shader_cache;
mod stress;
mod teams;
mod together;
mod tutorial;
mod verdict;
mod watch;
