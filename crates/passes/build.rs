//! Rebuilds the crate when a preset or shader is added or changed: `include_dir!` cannot ask for
//! that itself.

fn main() {
    for folder in ["pipelines", "shaders"] {
        println!("cargo::rerun-if-changed={folder}");
    }
}
