//! The documents of `tests/broken`, each with a mistake, and what is said about it.

#![allow(dead_code, reason = "each test file uses a part of it")]

use crate::support::Triangle;
use skiagraph_graph::{
    Diagnostic, FolderSources, Graph, Import, Picture, PlanRequest, Registry, Sources,
};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::Arc,
};

/// The folder of the documents, and two pictures: `tile.png`, and one that cannot be decoded.
pub struct Broken(FolderSources);

impl Sources for Broken {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        self.0.read(path)
    }

    fn list(&self, folder: &str) -> Vec<String> {
        self.0.list(folder)
    }

    fn picture(&self, path: &str) -> Result<Option<Picture>, String> {
        let texel = [u16::MAX, 0, 0, u16::MAX];
        match path {
            "tile.png" => Ok(Some(Picture {
                size: [2, 2],
                texels: [texel; 4].into(),
            })),
            "torn.png" => Err("the file ends too early".to_owned()),
            _ => Ok(None),
        }
    }
}

pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/broken")
}

pub fn folder() -> Broken {
    Broken(FolderSources { root: root() })
}

/// Imports of a host, made for too little, and a viewport and memory to plan for.
pub fn request() -> PlanRequest<'static> {
    let mut request = PlanRequest::new([64, 48], &Triangle);
    request.memory_limit = Some(4 << 30);
    let usage = wgt::TextureUsages::TEXTURE_BINDING;
    let texture = Import::plain_texture(wgt::TextureFormat::R32Float, [64, 48], usage);
    let buffer = Import::buffer(12, Some(3), wgt::BufferUsages::COPY_SRC);
    request.imports = BTreeMap::from([
        ("host_image".to_owned(), texture),
        ("host_items".to_owned(), buffer),
    ]);
    request
}

/// Errors of reading or planning, and the warnings where there are no errors.
pub fn diagnose(name: &str) -> Vec<Diagnostic> {
    let path = format!("{name}.ron");
    match Graph::check(&path, &Registry::standard(), &folder(), &request()) {
        Err(errors) => errors.iter().cloned().collect(),
        Ok((graph, plan)) => {
            let warnings = graph.warnings().iter().chain(plan.warnings());
            warnings.cloned().collect()
        }
    }
}

/// The names of all documents, in order.
pub fn documents() -> Vec<String> {
    let folder = std::fs::read_dir(root()).expect("it is part of the repository");
    let file = |entry: std::io::Result<std::fs::DirEntry>| {
        entry
            .expect("it is readable")
            .file_name()
            .to_string_lossy()
            .into_owned()
    };
    let ron = |name: String| name.strip_suffix(".ron").map(str::to_owned);
    let mut names: Vec<String> = folder.map(file).filter_map(ron).collect();
    names.sort();
    names
}

/// All documents with what is said about each.
pub fn all() -> Vec<(String, Vec<Diagnostic>)> {
    let documents = documents().into_iter();
    documents
        .map(|name| (name.clone(), diagnose(&name)))
        .collect()
}
