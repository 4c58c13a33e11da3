//! `skiagraph presets`: the methods that `compare` and `run` know by name.

use crate::{
    args::PresetsArgs,
    error::{CliError, print},
    preset::{self, closest},
};
use skiagraph_graph::{Graph, Param, Sources};

/// Lists the presets with their params, or prints one of the built-in files.
///
/// # Errors
/// A preset on disk that cannot be loaded, a file that there is not, standard output.
pub fn presets(args: &PresetsArgs) -> Result<(), CliError> {
    let sources = preset::sources();
    if let Some(name) = &args.show {
        return show(name, &sources);
    }
    let loaded = preset::load_all(&preset::names(&sources), &sources)?;
    let texts: Vec<String> = loaded
        .iter()
        .map(|preset| describe(&preset.name, &preset.graph))
        .collect();
    print(&texts.join("\n"))
}

/// Where documents and shaders stand.
const FOLDERS: [&str; 4] = ["pipelines", "pipelines/shared", "shaders", "shaders/shared"];

fn show(name: &str, sources: &dyn Sources) -> Result<(), CliError> {
    let candidates = [
        name.to_owned(),
        format!("pipelines/{name}.ron"),
        format!("pipelines/{name}"),
        format!("shaders/{name}"),
        format!("shaders/{name}.wgsl"),
    ];
    for path in candidates {
        match sources.read(&path) {
            Ok(Some(text)) => return print(&text),
            Ok(None) => {}
            Err(reason) => return Err(CliError::Input(format!("cannot read `{path}`: {reason}"))),
        }
    }
    let files: Vec<String> = FOLDERS
        .iter()
        .flat_map(|folder| {
            let names = sources.list(folder).into_iter();
            names.map(move |name| format!("{folder}/{name}"))
        })
        .collect();
    let short = files
        .iter()
        .filter_map(|file| Some(file.split_once('/')?.1));
    let hint =
        closest(name, short).map_or(String::new(), |file| format!("; did you mean `{file}`?"));
    Err(CliError::Input(format!(
        "there is no built-in file `{name}`{hint}\n  there are {}",
        files.join(", ")
    )))
}

fn describe(name: &str, graph: &Graph) -> String {
    let mut text = format!("{name}: {}\n", graph.description());
    for param in graph.params() {
        let setting = format!("--set {}={}", param.name.as_str(), param.default);
        text.push_str(&format!("  {setting:<24} {}{}\n", param.ty, range(param)));
        if !param.description.is_empty() {
            text.push_str(&format!("      {}\n", param.description));
        }
    }
    text
}

fn range(param: &Param) -> String {
    match (param.min, param.max) {
        (Some(min), Some(max)) => format!(", {min} to {max}"),
        (Some(min), None) => format!(", from {min}"),
        (None, Some(max)) => format!(", to {max}"),
        (None, None) => String::new(),
    }
}
