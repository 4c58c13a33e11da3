//! What several test files need: an in-memory store of sources and a small provider.

#![allow(dead_code, reason = "each test file uses a part of it")]

pub mod host;

use skiagraph_graph::{
    Diagnostics, Graph, NoProvider, Plan, PlanRequest, Provided, Provider, ProviderError, Registry,
    Sources,
};
use std::{collections::BTreeMap, sync::Arc};

/// Files in memory.
#[derive(Clone, Debug, Default)]
pub struct Files(pub BTreeMap<String, String>);

impl Files {
    /// The files of these paths and texts.
    pub fn new<const N: usize>(files: [(&str, &str); N]) -> Self {
        Self(
            files
                .into_iter()
                .map(|(path, text)| (path.to_owned(), text.to_owned()))
                .collect(),
        )
    }

    /// One file more.
    pub fn with(mut self, path: &str, text: impl Into<String>) -> Self {
        self.0.insert(path.to_owned(), text.into());
        self
    }
}

impl Files {
    /// The same files, with something replaced in one.
    pub fn edited(mut self, path: &str, from: &str, to: &str) -> Self {
        let text = self.0.get_mut(path).expect("the file is there");
        assert!(text.contains(from), "{path} has no {from}");
        *text = text.replace(from, to);
        self
    }
}

impl Sources for Files {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        Ok(self.0.get(path).map(|text| text.as_str().into()))
    }

    fn list(&self, folder: &str) -> Vec<String> {
        let inside = |path: &String| {
            let (of, name) = path.rsplit_once('/').unwrap_or(("", path));
            (of == folder).then(|| name.to_owned())
        };
        self.0.keys().filter_map(inside).collect()
    }
}

/// A triangle under `scene.positions`, and a camera of 64 bytes.
pub struct Triangle;

impl Provider for Triangle {
    fn names(&self) -> Vec<String> {
        ["scene.positions", "scene.indices", "camera"]
            .map(str::to_owned)
            .to_vec()
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        match name {
            "scene.positions" => Some(Provided {
                items: Some(3),
                stride: 16,
                uniform: false,
            }),
            "scene.indices" => Some(Provided {
                items: Some(3),
                stride: 4,
                uniform: false,
            }),
            "camera" => Some(Provided {
                items: Some(1),
                stride: 64,
                uniform: true,
            }),
            _ => None,
        }
    }

    fn build(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        let positions: [[f32; 4]; 3] = [
            [-1.0, -1.0, 0.25, 1.0],
            [3.0, -1.0, 0.25, 1.0],
            [-1.0, 3.0, 0.25, 1.0],
        ];
        let (bytes, usage): (Vec<u8>, _) = match name {
            "scene.positions" => (
                bytemuck::cast_slice(&positions).to_vec(),
                wgpu::BufferUsages::STORAGE,
            ),
            "scene.indices" => (
                bytemuck::cast_slice(&[0u32, 1, 2]).to_vec(),
                wgpu::BufferUsages::STORAGE,
            ),
            "camera" => (vec![0; 64], wgpu::BufferUsages::UNIFORM),
            _ => return Err(ProviderError(format!("there is no `{name}`"))),
        };
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(name),
            size: bytes.len() as u64,
            usage: usage | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        queue.write_buffer(&buffer, 0, &bytes);
        Ok(buffer)
    }
}

/// Loads `graph.ron` of the files.
pub fn load(files: &Files) -> Result<Graph, Diagnostics> {
    Graph::load("graph.ron", &Registry::standard(), files)
}

/// Loads and plans `graph.ron` at 8×8 without provided resources.
pub fn plan(files: &Files) -> Result<Plan, Diagnostics> {
    load(files)?.plan(&PlanRequest::new([8, 8], &NoProvider))
}
