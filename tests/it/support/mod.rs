//! Items that the tests share.
#![allow(dead_code)]

pub mod bench;
pub mod brute;
pub mod devices;
pub mod graphs;
pub mod map_fit;
pub mod meshes;
pub mod random;
pub mod scenes;
pub mod solids;

use skiagraph_graph::Sources;
use skiagraph_passes::EmbeddedSources;
use std::collections::BTreeSet;

/// The embedded shader at `shaders/<path>` with its imports put in.
pub fn expanded(path: &str) -> String {
    expand(path, &mut BTreeSet::new())
}

fn expand(path: &str, seen: &mut BTreeSet<String>) -> String {
    let text = EmbeddedSources
        .read(&format!("shaders/{path}"))
        .unwrap()
        .unwrap_or_else(|| panic!("no shader {path}"));
    let mut whole = String::new();
    for line in text.lines() {
        match line.strip_prefix("#import \"") {
            Some(import) => {
                let whole_import = import.trim_end_matches('"');
                let (import, replaced) = whole_import.split_once("\" instead \"").unzip();
                seen.extend(replaced.map(str::to_owned));
                let import = import.unwrap_or(whole_import);
                if seen.insert(import.to_owned()) {
                    whole += &expand(import, seen);
                }
            }
            None => {
                whole += line;
                whole.push('\n');
            }
        }
    }
    whole
}
