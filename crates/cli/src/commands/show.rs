//! `skiagraph show`: prints a document, shader or scene file as written. A document is followed by
//! what its passes read and write, or printed with all that it extends.

use crate::args::commands::ShowArgs;
use crate::error::CliError;
use crate::terminal::{Terminal, console::print};
use itertools::Itertools;
use skiagraph_compare::graphs::faults::GraphFaults;
use skiagraph_compare::graphs::planning::{Capabilities, placeholder};
use skiagraph_compare::graphs::preset;
use skiagraph_compare::wording::did_you_mean;
use skiagraph_graph::{Access, Graph, Sources};
use skiagraph_passes::registry;
use skiagraph_scene::SceneLibrary;

/// Prints a file of the working directory, or a built-in one. Behind a document it prints, as
/// comments, the materials that each pass reads and writes.
///
/// # Errors
/// If the file does not exist, a document cannot be read, or standard output cannot be written.
pub fn show(args: &ShowArgs) -> Result<(), CliError> {
    let sources = preset::sources(&Terminal);
    let not_flat = |name: &str, kind| {
        let text = format!("--flat writes out what a document extends; `{name}` is a {kind}");
        Err(CliError::Usage(text))
    };
    let (path, text) = match find(&args.file, &sources)? {
        Found::Text(path, text) if path.ends_with(".ron") => (path, text),
        Found::Text(_, text) if !args.flat => return print(&text),
        Found::Scene(text) if !args.flat => return print(&text),
        Found::Text(path, _) => return not_flat(&path, "shader"),
        Found::Scene(_) => return not_flat(&args.file, "scene file"),
    };
    let passes = passes(&path, &sources).unwrap_or_default();
    if !args.flat {
        return print(&format!("{text}{passes}"));
    }
    match Graph::flat(&path, &registry(), &sources) {
        Ok(text) => print(&format!("{text}{passes}")),
        Err(faults) => Err(GraphFaults::one(&args.file, &faults).into()),
    }
}

/// Lists what the passes of a document read and write and the values that its expressions have, as
/// comments of RON; `None` where it cannot be planned by itself.
fn passes(path: &str, sources: &dyn Sources) -> Option<String> {
    let graph = Graph::load(path, &registry(), sources).ok()?;
    let viewport = [1024, 1024];
    let provider = placeholder(viewport, &graph);
    let request = Capabilities::greatest().request(viewport, &provider);
    let plan = graph.plan(&request).ok()?;
    let mut text = format!(
        "// What runs at 1024x1024, with the params as they are, where adapter.software = {}, \
         adapter.subgroup_size = {}, adapter.storage_binding = {}:\n",
        request.adapter.is_software,
        request.adapter.subgroup_size,
        request.limits.max_storage_buffer_binding_size,
    );
    for pass in plan.live() {
        let names = |is_meant: fn(&Access) -> bool| {
            let used = pass.accesses.iter().filter(|access| is_meant(access));
            let names = used.map(|access| plan.resource(access.resource).name.as_str());
            names.sorted().dedup().join(", ")
        };
        let (reads, writes) = (names(|access| access.reads), names(|access| access.writes));
        text += &format!("//   {}\n", *pass.name);
        for (what, names) in [("reads", reads), ("writes", writes)] {
            if !names.is_empty() {
                text += &format!("//     {what} {names}\n");
            }
        }
    }
    for (name, document) in graph.openings() {
        text += &format!("// {name} = {document}, or another one: --set {name}=METHOD\n");
    }
    for (name, value) in plan.named_values() {
        text += &format!("// {name} = {value}\n");
    }
    Some(text)
}

/// A file or scene that a name stands for.
enum Found {
    /// A document or shader: its path and text.
    Text(String, std::sync::Arc<str>),
    Scene(String),
}

/// The path and text of a file by its name.
fn find(name: &str, sources: &dyn Sources) -> Result<Found, CliError> {
    let candidates = [
        name.to_owned(),
        format!("pipelines/{name}.ron"),
        format!("pipelines/{name}"),
        format!("shaders/{name}"),
        format!("shaders/{name}.wgsl"),
    ];
    for path in candidates {
        match sources.read(&path) {
            Ok(Some(text)) => return Ok(Found::Text(path, text)),
            Ok(None) => {}
            Err(reason) => return Err(CliError::Input(format!("cannot read `{path}`: {reason}"))),
        }
    }
    let scenes = SceneLibrary::from_environment();
    if let Ok(text) = scenes.text(name) {
        return Ok(Found::Scene(text));
    }
    let in_folder = |folder: &'static str| {
        let files = sources.list(folder).into_iter();
        files.map(move |file| format!("{folder}/{file}"))
    };
    let files: Vec<String> = preset::FOLDERS.into_iter().flat_map(in_folder).collect();
    let listed = scenes.list().into_iter().map(|scene| scene.name);
    let listed: Vec<String> = listed.collect();
    // With their ending and without.
    let short = files.iter().flat_map(|file| {
        let name = file.split_once('/').map_or(&**file, |(_, name)| name);
        [name, name.rsplit_once('.').map_or(name, |(stem, _)| stem)]
    });
    let hint = did_you_mean(name, short.chain(listed.iter().map(String::as_str)));
    let [files, scenes] = [&files, &listed].map(|names| names.join(", "));
    Err(CliError::Input(format!(
        "there is no file `{name}`{hint}\n  there are {files}; and the scenes {scenes}"
    )))
}
