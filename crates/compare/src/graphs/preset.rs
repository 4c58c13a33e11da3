//! Loads graphs by arguments such as `nsm` or `my/method.ron`.
//!
//! ```
//! use skiagraph_compare::graphs::preset;
//! use skiagraph_passes::EmbeddedSources;
//!
//! assert!(preset::names(&EmbeddedSources).contains(&"light_buffer".to_owned()));
//! let presets = preset::load_all(&["nsm".into(), "rt".into()], &EmbeddedSources)?;
//! assert!(presets[0].param("map_size").is_some());
//! assert_eq!(presets[1].judged(), [preset::VISIBILITY, preset::STATUS, preset::RAY_COUNT]);
//! # Ok::<(), skiagraph_compare::error::CompareError>(())
//! ```

use crate::error::{CompareError, Result};
use crate::files::fingerprint::{Fingerprint, RecordedSources};
use crate::files::picture_sources::PictureSources;
use crate::graphs::argument::{Assignment, MethodArgument};
use crate::graphs::faults::{GraphFaults, warn};
use crate::graphs::planning::of_every_host;
use crate::sink::Sink;
use crate::wording::unknown;
use itertools::Itertools;
use skiagraph_graph::{
    Diagnostics, FolderSources, Graph, LayeredSources, MemorySources, Param, Plan, PlanRequest,
    Sources,
};
use skiagraph_passes::{EmbeddedSources, registry};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Once};

/// Name of the output with the share of light that reaches each pixel, from 0 in shadow to 1 in
/// full light.
pub const VISIBILITY: &str = "visibility";
/// Name of the optional output with the status of each pixel: 0 background, 1 facing away from the
/// light, 2 certainly lit, 3 certainly in shadow, 4 uncertain (the shadow map does not decide it,
/// so that the method traces a ray or guesses).
pub const STATUS: &str = "status";
/// Name of the optional output with the number of rays traced in the frame.
pub const RAY_COUNT: &str = "ray_count";
/// Name of the optional output with the density of the shadow map at each pixel's receiver (its
/// visible surface): texels per square unit of the scene, measured across the ray to the light; 0
/// outside the map.
pub const TEXEL_DENSITY: &str = "texel_density";
/// Name of the optional output with the index of the layer of the shadow map that each pixel reads.
pub const MAP_LAYER: &str = "map_layer";

/// Returns the sources of graphs and shaders: first the working directory, then the built-in files.
/// Tells the sink, once in a process, which files of the working directory replace built-in files
/// that differ.
pub fn sources(sink: &dyn Sink) -> LayeredSources {
    static SAID: Once = Once::new();
    let folder = FolderSources { root: ".".into() };
    SAID.call_once(|| {
        if let Some(text) = stand_ins(&folder) {
            sink.note(&text);
        }
    });
    LayeredSources(vec![
        Box::new(PictureSources(folder)),
        Box::new(EmbeddedSources),
    ])
}

/// Folders of presets, shaders and the files that they share, as paths in the working directory and
/// among the built-in files.
pub const FOLDERS: [&str; 5] = [
    "pipelines",
    "pipelines/shared",
    "pipelines/shared/splits",
    "shaders",
    "shaders/shared",
];

/// Which files of a folder stand in for built-in ones that differ: a line for the presets, one for
/// each folder of what they are made of.
fn stand_ins(folder: &dyn Sources) -> Option<String> {
    let line = |parent: &&str| {
        let differs = |file: &&String| {
            let path = format!("{parent}/{file}");
            let built_in = EmbeddedSources.read(&path).ok().flatten();
            let own = folder.read(&path).ok().flatten();
            built_in.is_some_and(|built_in| own.is_some_and(|own| own != built_in))
        };
        let (what, ending) = match *parent {
            "pipelines" => ("presets", ".ron"),
            _ => ("files", ""),
        };
        let files = folder.list(parent);
        let names = files.iter().filter(differs);
        let mut names = names.map(|file| file.strip_suffix(ending).unwrap_or(file));
        let names = names.join(", ");
        let text = format!("./{parent} stands in for built-in {what}, which differ: {names}");
        (!names.is_empty()).then_some(text)
    };
    let lines = FOLDERS.iter().filter_map(line);
    lines.reduce(|text, line| text + "\n" + &line)
}

/// Returns the names of all presets of `sources`, their files `pipelines/NAME.ron`, sorted and each
/// once.
pub fn names(sources: &dyn Sources) -> Vec<String> {
    let files = sources.list("pipelines");
    let names = files.iter().filter_map(|file| file.strip_suffix(".ron"));
    names.sorted().dedup().map(Into::into).collect()
}

/// Returns the names of all built-in presets, sorted.
pub fn built_in() -> Vec<String> {
    names(&EmbeddedSources)
}

/// Names of the built-in presets that are fit for use in an engine; a comparison takes these by
/// default.
pub const SHIPPED: [&str; 8] = [
    "rt",
    "light_buffer",
    "nsm",
    "pcf",
    "pssm",
    "vsm",
    "hybrid_pcf",
    "crsm",
];

/// Returns the names of the presets that a comparison takes by default: [`SHIPPED`], then the
/// presets of `sources` that are not built in: the user's own, in the folder `pipelines`.
pub fn shipped_and_own(sources: &dyn Sources) -> Vec<String> {
    let built_in = built_in();
    let own = names(sources).into_iter();
    let own = own.filter(|name| !built_in.contains(name));
    SHIPPED.map(str::to_owned).into_iter().chain(own).collect()
}

/// Returns `arguments`, the names of presets; if it is empty, the names of all presets of
/// `sources`.
pub fn named_or_all(arguments: &[String], sources: &dyn Sources) -> Vec<String> {
    match arguments {
        [] => names(sources),
        named => named.to_vec(),
    }
}

/// A loaded graph with its name, for example a built-in shadow method.
pub struct Preset {
    /// Name that tables and file names show, the argument that the graph was loaded by: `nsm`,
    /// `my/method.ron`, or `contact.ron@over=msm` with another document in an open include
    /// ([`load`]).
    pub name: String,
    /// Graph of the preset's document, loaded and not yet planned; an empty one if the document has
    /// [`faults`](Self::faults).
    pub graph: Graph,
    /// Faults for which the graph could not be loaded ([`load_each`]): every plan of it fails with
    /// them. `None` for a sound document.
    pub faults: Option<Diagnostics>,
    /// Hash of the files from which the graph was read.
    pub fingerprint: Fingerprint,
}

impl Preset {
    /// Returns those of the names `visibility`, `status` and `ray_count` that the graph has as
    /// outputs: the outputs by which a shadow method is judged.
    pub fn judged(&self) -> Vec<&'static str> {
        self.outputs_of(&[VISIBILITY, STATUS, RAY_COUNT])
    }

    /// Returns those of the names `texel_density` and `map_layer` that the graph has as outputs:
    /// the outputs that describe the shadow map. They are left out of timed frames.
    pub fn diagnostics(&self) -> Vec<&'static str> {
        self.outputs_of(&[TEXEL_DENSITY, MAP_LAYER])
    }

    fn outputs_of(&self, names: &[&'static str]) -> Vec<&'static str> {
        let outputs = self.graph.outputs();
        let names = names.iter().copied();
        names.filter(|name| outputs.contains(name)).collect()
    }

    /// Returns the graph's param of this name; `None` if it has no such param.
    pub fn param(&self, name: &str) -> Option<&Param> {
        let mut params = self.graph.params().iter();
        params.find(|param| param.name.as_str() == name)
    }

    /// Returns the names that assignments can set: the graph's params, its open includes, whose
    /// document can be exchanged, and its textures with a picture, likewise.
    pub fn settable(&self) -> impl Iterator<Item = &str> {
        let params = self.graph.params().iter().map(|param| param.name.as_str());
        let chosen = self.graph.openings().chain(self.graph.pictures());
        params.chain(chosen.map(|(name, _)| name))
    }

    /// Plans the graph.
    ///
    /// # Errors
    /// The [`faults`](Self::faults) of the document, or those of the graph under this request.
    pub fn plan_quietly(&self, request: &PlanRequest) -> Result<Plan, Diagnostics> {
        match &self.faults {
            Some(faults) => Err(faults.clone()),
            None => self.graph.plan(request),
        }
    }

    /// Plans the graph, and passes the warnings of graph and plan to the sink.
    ///
    /// # Errors
    /// Those of [`plan_quietly`](Self::plan_quietly).
    pub fn plan(&self, request: &PlanRequest, sink: &dyn Sink) -> Result<Plan> {
        let plan = self.plan_quietly(request);
        let plan = plan.map_err(|diagnostics| GraphFaults::one(&self.name, &diagnostics))?;
        warn(sink, &self.graph, plan.warnings());
        Ok(plan)
    }
}

/// Returns the graph of each preset.
pub fn graphs(presets: &[Arc<Preset>]) -> impl Iterator<Item = &Graph> {
    presets.iter().map(|preset| &preset.graph)
}

/// Loads the graphs that `arguments` name (a preset's name or a path), in their order, each once.
///
/// # Errors
/// The faults of all graphs together; those of [`load_each`].
pub fn load_all(arguments: &[String], sources: &dyn Sources) -> Result<Vec<Arc<Preset>>> {
    sound(load_each(arguments, sources)?)
}

/// Returns the presets if none of their documents has [`faults`](Preset::faults).
///
/// # Errors
/// The faults of all graphs together.
pub(crate) fn sound(presets: Vec<Arc<Preset>>) -> Result<Vec<Arc<Preset>>> {
    let mut faults = GraphFaults::default();
    for preset in &presets {
        if let Some(diagnostics) = &preset.faults {
            faults.add(&preset.name, diagnostics);
        }
    }
    faults.none_or_error().map(|()| presets)
}

/// Loads the graphs that `arguments` name, as [`load_all`] does; a document with faults becomes a
/// preset that cannot be planned ([`Preset::faults`]).
///
/// # Errors
/// A name without a preset; a file that does not exist or cannot be read.
pub fn load_each(arguments: &[String], sources: &dyn Sources) -> Result<Vec<Arc<Preset>>> {
    let mut presets: Vec<Arc<Preset>> = Vec::new();
    for argument in arguments {
        if presets.iter().any(|preset| preset.name == *argument) {
            continue;
        }
        let recorded = RecordedSources::new(sources);
        let (graph, faults) = match load(argument, &recorded)? {
            (Ok(graph), _) => (graph, None),
            // Faults that only planning finds are shown in the same go.
            (Err(faults), path) => (empty()?, Some(of_every_host(&path, sources, faults))),
        };
        presets.push(Arc::new(Preset {
            name: argument.clone(),
            graph,
            faults,
            fingerprint: recorded.fingerprint(),
        }));
    }
    Ok(presets)
}

/// Returns the graph in the place of one that cannot be loaded: nothing is known of it.
fn empty() -> Result<Graph> {
    const TEXT: &str = "(format: 3, materials: [Texture(name: \"none\", format: R8Uint)], \
                        passes: [Clear(name: \"clear\", target: \"none\")], outputs: [\"none\"])";
    let sources = MemorySources::default().with("empty.ron", TEXT);
    Graph::load("empty.ron", &registry(), &sources)
        .map_err(|faults| GraphFaults::one("empty.ron", &faults))
}

/// Loads the graph that an argument names: a preset's name or a path. Returns the graph or its
/// faults, and the path of the graph. The argument `contact.ron@over=msm` puts the document `msm`
/// in the place of the open include `over`, and `effect.ron@noise=other.png` the picture
/// `other.png` in that of the texture `noise`.
///
/// # Errors
/// A file that does not exist or cannot be read.
pub fn load(argument: &str, sources: &dyn Sources) -> Result<(Result<Graph, Diagnostics>, String)> {
    let named = MethodArgument::new(argument);
    let path = locate(&named.preset, sources)?;
    let mut documents = BTreeMap::new();
    for Assignment { name, value } in named.own {
        let is_picture = value.to_ascii_lowercase().ends_with(".png");
        let path = if is_picture {
            value
        } else {
            locate(&value, sources)?
        };
        documents.insert(name, path);
    }
    let graph = Graph::load_over(&path, &registry(), sources, &documents);
    Ok((graph, path))
}

/// Returns the path of the graph that an argument names: the argument itself if it ends in `.ron`,
/// otherwise `pipelines/ARGUMENT.ron`.
///
/// # Errors
/// A file that does not exist or cannot be read. For an unknown preset, the message lists the known
/// ones.
pub fn locate(argument: &str, sources: &dyn Sources) -> Result<String> {
    let extension = Path::new(argument).extension();
    let is_path = extension.is_some_and(|extension| extension.eq_ignore_ascii_case("ron"));
    let path = if !is_path {
        format!("pipelines/{argument}.ron")
    } else if cfg!(windows) {
        argument.replace('\\', "/")
    } else {
        argument.into()
    };
    let missing = match sources.read(&path) {
        Ok(Some(_)) => return Ok(path),
        Err(reason) => format!("cannot read `{path}`: {reason}"),
        Ok(None) if is_path => format!("there is no file `{argument}`"),
        Ok(None) if Path::new(argument).is_dir() => {
            format!("`{argument}` is a folder; a graph is given as a path that ends in .ron")
        }
        Ok(None) if Path::new(argument).is_file() => {
            format!("`{argument}` is not a .ron file; a graph is given as a path that ends in .ron")
        }
        Ok(None) => {
            let what = format!("unknown preset `{argument}`");
            unknown(&what, argument, "presets", names(sources))
                + "\n  a graph of your own is given as a path that ends in .ron"
        }
    };
    Err(CompareError::Input(missing))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sink::Silent;

    /// A folder of what presets are made of that is not in the list would stand in silently.
    #[test]
    fn every_built_in_folder_is_looked_at() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let mut open = vec!["pipelines".to_owned(), "shaders".to_owned()];
        while let Some(folder) = open.pop() {
            assert!(FOLDERS.contains(&folder.as_str()), "{folder}");
            for entry in std::fs::read_dir(root.join(&folder)).unwrap().flatten() {
                if entry.path().is_dir() {
                    open.push(format!("{folder}/{}", entry.file_name().display()));
                }
            }
        }
    }

    #[test]
    fn files_that_stand_in_for_built_in_ones_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        std::fs::create_dir_all(root.join("pipelines")).unwrap();
        let sources = FolderSources { root: root.into() };
        let built_in = EmbeddedSources.read("pipelines/rt.ron").unwrap().unwrap();
        std::fs::write(root.join("pipelines/rt.ron"), &*built_in).unwrap();
        std::fs::write(root.join("pipelines/mine.ron"), "()").unwrap();
        assert_eq!(stand_ins(&sources), None);
        std::fs::write(root.join("pipelines/nsm.ron"), format!("{built_in} ")).unwrap();
        let warning = stand_ins(&sources).unwrap();
        let expected = "./pipelines stands in for built-in presets, which differ: nsm";
        assert_eq!(warning, expected);
    }

    #[test]
    fn missing_presets_and_files_are_told_apart() {
        let sources = sources(&Silent);
        let message = |argument| locate(argument, &sources).unwrap_err().to_string();
        assert!(message("nowhere/a.ron").contains("no file `nowhere/a.ron`"));
        assert!(message("zzzzzzzz").contains("unknown preset `zzzzzzzz`"));
    }
}
