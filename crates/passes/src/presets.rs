//! The presets and their shaders, embedded, and the registry of pass kinds that they need.

use crate::names::{MASKS, SHADOWS};
use crate::trace::Trace;
use include_dir::{Dir, include_dir};
use skiagraph_graph::{Diagnostics, Graph, Registry, Sources};
use std::{collections::BTreeMap, sync::Arc};

static PIPELINES: Dir = include_dir!("$CARGO_MANIFEST_DIR/pipelines");
static SHADERS: Dir = include_dir!("$CARGO_MANIFEST_DIR/shaders");

/// The presets' documents (`pipelines/…`) and shaders (`shaders/…`), embedded in the crate when it
/// was compiled. Behind a [`FolderSources`](skiagraph_graph::FolderSources) in a
/// [`LayeredSources`](skiagraph_graph::LayeredSources), it supplies the files that the folder
/// lacks.
#[derive(Clone, Copy, Debug, Default)]
pub struct EmbeddedSources;

impl EmbeddedSources {
    /// The embedded folder that `path` begins with, and what follows.
    fn root(path: &str) -> Option<(&'static Dir<'static>, &str)> {
        let (root, rest) = path.split_once('/').unwrap_or((path, ""));
        match root {
            "pipelines" => Some((&PIPELINES, rest)),
            "shaders" => Some((&SHADERS, rest)),
            _ => None,
        }
    }
}

impl Sources for EmbeddedSources {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        let Some(file) = Self::root(path).and_then(|(root, rest)| root.get_file(rest)) else {
            return Ok(None);
        };
        let text = file.contents_utf8();
        Ok(Some(
            text.ok_or_else(|| format!("{path} is not UTF-8"))?.into(),
        ))
    }

    fn list(&self, folder: &str) -> Vec<String> {
        let Some((root, rest)) = Self::root(folder.trim_end_matches('/')) else {
            return Vec::new();
        };
        let folder = match rest {
            "" => Some(root),
            rest => root.get_dir(rest),
        };
        let files = folder.into_iter().flat_map(Dir::files);
        let names = files.filter_map(|file| file.path().file_name()?.to_str());
        names.map(str::to_owned).collect()
    }
}

/// Preset: a shadow method that ships with Skiagraph, as a graph document (a RON file that
/// describes the method's passes) with a short name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Preset {
    /// Name of the preset on the command line: the document's file name without `.ron`, such as
    /// `rt`.
    pub name: String,
    /// Path of the document, such as `pipelines/rt.ron`. Pass it to
    /// [`Graph::load`](skiagraph_graph::Graph::load) with [`EmbeddedSources`] or a folder that
    /// holds the same files.
    pub path: String,
}

/// Lists the embedded presets, sorted by name: one for every document directly in `pipelines/`.
pub fn presets() -> Vec<Preset> {
    let files = EmbeddedSources.list("pipelines");
    let names = files.iter().filter_map(|file| file.strip_suffix(".ron"));
    let presets = names.map(|name| Preset {
        name: name.to_owned(),
        path: format!("pipelines/{name}.ron"),
    });
    let mut presets: Vec<Preset> = presets.collect();
    presets.sort_by(|a, b| a.name.cmp(&b.name));
    presets
}

/// Loads the document at `path`, a shadow method, and adds the output `unit_visibility`: the
/// method's `visibility` (R8Uint, R32Uint or R32Float) as a texture of the format R8Unorm. It is
/// the share of the light that arrives at each pixel, 0 in shadow to 1 in full light, and has as
/// many layers as `visibility`. Pixels that show no geometry or face away from the light have any
/// share: the host's shading decides there. The graph's other output is `visibility`; the
/// document's other materials are [captures](skiagraph_graph::Request::captures) under the
/// [full names](skiagraph_graph#terms) that [`Plan::resources`](skiagraph_graph::Plan::resources)
/// lists, where an output of the document such as `status` keeps its name. The document's params
/// and inputs stay; its [claims](skiagraph_graph::Claim) do not, nor its `proven_on`, so that
/// executors on GL refuse the graph. The conversion costs one pass over the picture, or none in a
/// plan that does not compute `unit_visibility`
/// ([`PlanRequest::outputs`](skiagraph_graph::PlanRequest)). `sources` must hold
/// `pipelines/shared/unit_visibility.ron`; [`EmbeddedSources`] does.
///
/// ```
/// use skiagraph_passes::{EmbeddedSources, load_unit_visibility, registry};
///
/// let graph = load_unit_visibility("pipelines/pcf.ron", &registry(), &EmbeddedSources)?;
/// assert_eq!(graph.outputs()[0], "unit_visibility");
/// # Ok::<(), skiagraph_graph::Diagnostics>(())
/// ```
///
/// # Errors
/// Those of [`Graph::load`], and an error if the document has no output `visibility`. A
/// `visibility` of another format is an error of [`Graph::plan`].
pub fn load_unit_visibility(
    path: &str,
    registry: &Registry,
    sources: &dyn Sources,
) -> Result<Graph, Diagnostics> {
    let over = BTreeMap::from([("over".to_owned(), path.to_owned())]);
    let document = "pipelines/shared/unit_visibility.ron";
    Graph::load_over(document, registry, sources, &over)
}

/// Creates a registry of the [standard](Registry::standard) pass kinds and [`Trace`], which
/// [`Graph::load`](skiagraph_graph::Graph::load) needs to read the presets. In scenes with masked
/// or double-sided triangles `shared/masks.wgsl` [stands in](Registry::stand_in) for
/// `shared/solid.wgsl` in the shaders of all documents, and modules that know which triangles cast
/// and receive shadows for those that do not, in scenes where some do not.
pub fn registry() -> Registry {
    let mut registry = Registry::standard();
    registry.register::<Trace>("Trace");
    for (module, is, items_of) in [
        ("shared/solid.wgsl", "shared/masks.wgsl", MASKS),
        // A stage that reads masks has no storage buffer left for the number of rays.
        (
            "shared/ray_total.wgsl",
            "shared/ray_total_uniform.wgsl",
            MASKS,
        ),
        (
            "shared/all_cast.wgsl",
            "shared/listed_casters.wgsl",
            SHADOWS,
        ),
        ("shared/all_roles.wgsl", "shared/roles.wgsl", SHADOWS),
        (
            "shared/numbered_casters.wgsl",
            "shared/listed_corners.wgsl",
            SHADOWS,
        ),
    ] {
        registry.stand_in(module, is, items_of);
    }
    #[cfg(feature = "schema")]
    registry.describe::<Trace>("Trace");
    registry
}
