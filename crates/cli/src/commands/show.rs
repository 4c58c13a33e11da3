//! `skiagraph show`: a document or shader as it is written, or with all that it extends.

use crate::args::commands::ShowArgs;
use crate::error::CliError;
use crate::graphs::faults::GraphFaults;
use crate::graphs::preset;
use crate::terminal::console::print;
use crate::wording::did_you_mean;
use skiagraph_graph::{Graph, Sources};

/// Where documents and shaders stand.
const FOLDERS: [&str; 4] = ["pipelines", "pipelines/shared", "shaders", "shaders/shared"];

/// Prints a file of the working directory, else one that is built in.
///
/// # Errors
/// A file that there is not, a document that cannot be read, standard output.
pub fn show(args: &ShowArgs) -> Result<(), CliError> {
    let sources = preset::sources();
    let (path, text) = find(&args.file, &sources)?;
    if !args.flat {
        return print(&text);
    }
    if !path.ends_with(".ron") {
        return Err(CliError::Usage(format!(
            "--flat writes out what a document extends; `{path}` is a shader"
        )));
    }
    match Graph::flat(&path, &sources) {
        Ok(text) => print(&text),
        Err(faults) => Err(GraphFaults::one(&args.file, &faults)),
    }
}

/// The path and text of a file by its name.
fn find(name: &str, sources: &dyn Sources) -> Result<(String, std::sync::Arc<str>), CliError> {
    let candidates = [
        name.to_owned(),
        format!("pipelines/{name}.ron"),
        format!("pipelines/{name}"),
        format!("shaders/{name}"),
        format!("shaders/{name}.wgsl"),
    ];
    for path in candidates {
        match sources.read(&path) {
            Ok(Some(text)) => return Ok((path, text)),
            Ok(None) => {}
            Err(reason) => return Err(CliError::Input(format!("cannot read `{path}`: {reason}"))),
        }
    }
    let in_folder = |folder: &&str| {
        let files = sources.list(folder).into_iter();
        files
            .map(|file| format!("{folder}/{file}"))
            .collect::<Vec<_>>()
    };
    let files: Vec<String> = FOLDERS.iter().flat_map(in_folder).collect();
    let short = files
        .iter()
        .filter_map(|file| Some(file.split_once('/')?.1));
    Err(CliError::Input(format!(
        "there is no file `{name}`{}\n  there are {}",
        did_you_mean(name, short),
        files.join(", ")
    )))
}
