//! Common parts of the test files of this crate and of `skiagraph-gpu`: files in memory, and the
//! resources of a small scene.

#![allow(dead_code, reason = "each test file uses a part of it")]

use skiagraph_graph::{
    Code, Describe, Diagnostic, Diagnostics, Graph, NoProvider, Picture, Plan, PlanRequest,
    Provided, ProvidedBinding, ProvidedKind, Registry, Sources,
};
use std::{collections::BTreeMap, sync::Arc};

/// Files in memory.
#[derive(Clone, Debug, Default)]
pub struct Files {
    pub texts: BTreeMap<String, String>,
    pub pictures: BTreeMap<String, Picture>,
}

impl Files {
    /// The files of these paths and texts.
    pub fn new<const N: usize>(files: [(&str, &str); N]) -> Self {
        files
            .into_iter()
            .fold(Self::default(), |files, (path, text)| {
                files.with(path, text)
            })
    }

    /// `graph.ron`: these sections, after the format.
    pub fn graph(sections: &str) -> Self {
        Self::default().document("graph.ron", sections)
    }

    /// One file more.
    pub fn with(mut self, path: &str, text: impl Into<String>) -> Self {
        self.texts.insert(path.to_owned(), text.into());
        self
    }

    /// One document more: these sections, after the format.
    pub fn document(self, path: &str, sections: &str) -> Self {
        self.with(path, format!("(format: 3, {sections})"))
    }

    /// A picture of this width; each texel by its first channel, 255 is one.
    pub fn picture(mut self, path: &str, width: u32, texels: &[u8]) -> Self {
        let texel = |value: &u8| [u16::from(*value) * 257, 0, 0, u16::MAX];
        let picture = Picture {
            size: [width, texels.len() as u32 / width],
            texels: texels.iter().map(texel).collect(),
        };
        self.pictures.insert(path.to_owned(), picture);
        self
    }

    /// The same files, with something replaced in one.
    pub fn edited(mut self, path: &str, from: &str, to: &str) -> Self {
        let text = self.texts.get_mut(path).expect("the file is there");
        assert!(text.contains(from), "{path} has no {from}");
        *text = text.replace(from, to);
        self
    }
}

impl Sources for Files {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        Ok(self.texts.get(path).map(|text| text.as_str().into()))
    }

    fn list(&self, folder: &str) -> Vec<String> {
        let inside = |path: &String| {
            let (parent, name) = path.rsplit_once('/').unwrap_or(("", path));
            (parent == folder).then(|| name.to_owned())
        };
        self.texts.keys().filter_map(inside).collect()
    }

    fn picture(&self, path: &str) -> Result<Option<Picture>, String> {
        Ok(self.pictures.get(path).cloned())
    }
}

/// Resources of a scene of one triangle: its buffers, a camera of 64 bytes, three lights of 256, a
/// stream of items without a count, and an acceleration structure.
pub struct Triangle;

impl Describe for Triangle {
    fn names(&self) -> Vec<String> {
        let names = [
            "scene.positions",
            "scene.indices",
            "scene.stream",
            "scene.tlas",
            "camera",
            "light",
            "lights",
            "lights.lamp",
        ];
        names.map(str::to_owned).to_vec()
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        let (items, stride, binding) = match name {
            "scene.positions" => (Some(3), 16, ProvidedBinding::Storage),
            "scene.indices" => (Some(3), 4, ProvidedBinding::Storage),
            "scene.stream" => (None, 4, ProvidedBinding::Storage),
            "scene.tlas" => return Some(Provided::ACCELERATION_STRUCTURE),
            "camera" => (Some(1), 64, ProvidedBinding::Uniform),
            "light" => (Some(1), 256, ProvidedBinding::Uniform),
            "lights" => (Some(3), 256, ProvidedBinding::Both),
            "lights.lamp" => {
                let kind = ProvidedKind {
                    words: &["directional", "spot"],
                    number: 1,
                };
                return Some(Provided::new(ProvidedBinding::Uniform, Some(1), 256).with_kind(kind));
            }
            _ => return None,
        };
        Some(Provided::new(binding, items, stride))
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

/// Returns the value of a result without mistakes.
#[track_caller]
pub fn right<T>(result: Result<T, Diagnostics>) -> T {
    result.unwrap_or_else(|errors| panic!("{errors}"))
}

/// The mistakes of what comes with some.
#[track_caller]
pub fn wrong<T>(result: Result<T, Diagnostics>) -> Diagnostics {
    result
        .err()
        .unwrap_or_else(|| panic!("a mistake was not found"))
}

/// [`Graph::check`] of `graph.ron` with the scene of [`Triangle`]: its mistakes, or where there are
/// none its warnings.
pub fn checked(files: &Files) -> Vec<Diagnostic> {
    let request = PlanRequest::new([8, 8], &Triangle);
    match Graph::check("graph.ron", &Registry::standard(), files, &request) {
        Err(errors) => errors.iter().cloned().collect(),
        Ok((graph, plan)) => {
            let warnings = graph.warnings().iter().chain(plan.warnings());
            warnings.cloned().collect()
        }
    }
}

/// The codes of mistakes.
pub fn codes<'d>(mistakes: impl IntoIterator<Item = &'d Diagnostic>) -> Vec<Code> {
    mistakes.into_iter().map(|mistake| mistake.code).collect()
}

/// Names of the live passes in order.
pub fn names(plan: &Plan) -> Vec<String> {
    plan.passes().into_iter().map(|pass| pass.name).collect()
}
