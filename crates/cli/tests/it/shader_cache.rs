//! Compiled shaders that the program keeps for its next start.

use std::{fs, path::Path, process::Command};

/// A graph that lights everything.
const LIT: &str = include_str!("support/lit.ron");

fn run(folder: &Path, cache: &str) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_skiagraph"));
    command.args("--backend vulkan run lit.ron --size 16x16".split(' '));
    command.env("SKIAGRAPH_SHADER_CACHE", cache);
    let output = command.current_dir(folder).output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{stderr}");
}

fn only_file(folder: &Path) -> (String, Vec<u8>) {
    let files: Vec<_> = fs::read_dir(folder).unwrap().map(Result::unwrap).collect();
    let [file] = &files[..] else {
        panic!("one file is expected, no temporary one: {files:?}");
    };
    let name = file.file_name().into_string().unwrap();
    (name, fs::read(file.path()).unwrap())
}

#[test]
fn shaders_are_kept_in_a_file_and_a_torn_one_is_written_anew() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("lit.ron"), LIT).unwrap();
    let cache = folder.path().join("deep/cache");
    run(folder.path(), "deep/cache");
    let (name, whole) = only_file(&cache);
    assert!(name.starts_with("wgpu_pipeline_cache_vulkan_"), "{name}");
    for broken in [&whole[..whole.len() / 2], b"", b"something else"] {
        fs::write(cache.join(&name), broken).unwrap();
        run(folder.path(), "deep/cache");
        assert_eq!(only_file(&cache).1.len(), whole.len());
    }
}

#[test]
fn without_a_folder_shaders_are_kept_nowhere_and_a_bad_one_does_no_harm() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("lit.ron"), LIT).unwrap();
    run(folder.path(), "");
    run(folder.path(), "lit.ron/cache");
    assert_eq!(only_file(folder.path()).0, "lit.ron");
}
