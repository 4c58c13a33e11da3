//! From the arguments `nsm` or `my/method.ron` to loaded graphs.

use crate::{
    args::MethodArgs,
    commands::check::all_at_once,
    error::{CliError, colour, count_errors, note},
    fingerprint::{Fingerprint, Recorded},
    parse::Assignment,
};
use skiagraph_graph::{
    Diagnostic, Diagnostics, FolderSources, Graph, LayeredSources, ParamValue, Sources, diagnostics,
};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
    slice,
};

/// Where graphs and shaders are read from: the working directory, then what is built in.
pub fn sources() -> LayeredSources {
    LayeredSources(vec![
        Box::new(FolderSources { root: ".".into() }),
        Box::new(skiagraph_passes::EmbeddedSources),
    ])
}

/// Names of the presets: `pipelines/*.ron` on disk and built in, sorted.
pub fn names(sources: &dyn Sources) -> Vec<String> {
    let files = sources.list("pipelines");
    let mut names: Vec<String> = files
        .iter()
        .filter_map(|file| file.strip_suffix(".ron"))
        .map(Into::into)
        .collect();
    names.sort();
    names.dedup();
    names
}

/// A graph under the name that tables and file names give it.
pub struct Preset {
    /// The preset's name, or the graph's path as given.
    pub name: String,
    /// The graph.
    pub graph: Graph,
    /// Of the texts that it was read from.
    pub fingerprint: Fingerprint,
}

/// Loads all arguments, each once.
///
/// # Errors
/// Every fault of every graph together.
pub fn load_all(arguments: &[String], sources: &dyn Sources) -> Result<Vec<Preset>, CliError> {
    let registry = skiagraph_passes::registry();
    let mut presets: Vec<Preset> = Vec::new();
    let mut faults = Faults::default();
    for argument in arguments {
        if presets.iter().any(|preset| preset.name == *argument) {
            continue;
        }
        let path = locate(argument, sources)?;
        let recorded = Recorded::new(sources);
        match Graph::load(&path, &registry, &recorded) {
            Ok(graph) => presets.push(Preset {
                name: argument.clone(),
                graph,
                fingerprint: recorded.fingerprint(),
            }),
            // What planning would find besides is shown in the same go.
            Err(diagnostics) => {
                let all = all_at_once(&path, &registry, sources).err();
                faults.add(argument, &all.unwrap_or(diagnostics));
            }
        }
    }
    faults.none_or_error().map(|()| presets)
}

/// Loads the one graph that the arguments name, with the params that they set.
///
/// # Errors
/// Its faults, a param that it does not have, a value that a param cannot take.
pub fn load_one(
    args: &MethodArgs,
    sources: &dyn Sources,
) -> Result<(Preset, BTreeMap<String, ParamValue>), CliError> {
    let mut presets = load_all(slice::from_ref(&args.preset), sources)?;
    check_names(&presets, &args.params)?;
    let preset = presets
        .pop()
        .ok_or_else(|| CliError::Input("no graph".into()))?;
    let params = params(&preset, &args.params, args.map_size)?;
    Ok((preset, params))
}

/// The path of the graph that an argument names.
///
/// # Errors
/// Names what is there instead.
pub fn locate(argument: &str, sources: &dyn Sources) -> Result<String, CliError> {
    let is_path = Path::new(argument)
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("ron"));
    let path = match is_path {
        true if cfg!(windows) => argument.replace('\\', "/"),
        true => argument.into(),
        false => format!("pipelines/{argument}.ron"),
    };
    match sources.read(&path) {
        Ok(Some(_)) => Ok(path),
        Ok(None) if is_path => Err(CliError::Input(format!("there is no file `{argument}`"))),
        Ok(None) if Path::new(argument).is_dir() => Err(CliError::Input(format!(
            "`{argument}` is a folder; a graph is given as a path that ends in .ron"
        ))),
        Ok(None) if Path::new(argument).is_file() => Err(CliError::Input(format!(
            "`{argument}` is no .ron file; a graph is given as a path that ends in .ron"
        ))),
        Ok(None) => {
            let known = names(sources);
            let hint = closest(argument, known.iter().map(String::as_str))
                .map_or(String::new(), |name| format!("; did you mean `{name}`?"));
            Err(CliError::Input(format!(
                "there is no preset `{argument}`{hint}\n  presets: {}\n  a graph of your own is given as a path that ends in .ron",
                known.join(", ")
            )))
        }
        Err(reason) => Err(CliError::Input(format!("cannot read `{path}`: {reason}"))),
    }
}

/// The name most like `wanted`, if one is like it at all.
pub fn closest<'a>(wanted: &str, names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    names
        .map(|name| (strsim::damerau_levenshtein(wanted, name), name))
        // A third of the letters wrong is a misspelling, more is another word.
        .filter(|(distance, name)| *distance <= wanted.len().max(name.len()).div_ceil(3))
        .min()
        .map(|(_, name)| name)
}

/// The params of each preset from `--set` and `--map-size`.
///
/// # Errors
/// A value that a param cannot take, and a name that no preset has.
pub fn params(
    preset: &Preset,
    assignments: &[Assignment],
    map_size: Option<u32>,
) -> Result<BTreeMap<String, ParamValue>, CliError> {
    let mut params = BTreeMap::new();
    let mut set = |name: &str, value: &str| match preset.graph.parse_param(name, value) {
        Ok(value) => Ok(params.insert(name.into(), value)),
        Err(error) => Err(CliError::Input(error.to_string())),
    };
    for Assignment { name, value } in assignments
        .iter()
        .filter(|assignment| has_param(preset, &assignment.name))
    {
        set(name, value)?;
    }
    if let Some(size) = map_size {
        set(MAP_SIZE, &size.to_string())?;
    }
    Ok(params)
}

/// The param that `--map-size` sets.
pub const MAP_SIZE: &str = "map_size";

/// Whether the graph declares the param.
pub fn has_param(preset: &Preset, name: &str) -> bool {
    preset
        .graph
        .params()
        .iter()
        .any(|param| param.name.as_str() == name)
}

/// Refuses an assignment that no preset has a param for.
///
/// # Errors
/// Names the params there are.
pub fn check_names(presets: &[Preset], assignments: &[Assignment]) -> Result<(), CliError> {
    for Assignment { name, .. } in assignments {
        if presets.iter().any(|preset| has_param(preset, name)) {
            continue;
        }
        let mut known: Vec<&str> = presets
            .iter()
            .flat_map(|preset| preset.graph.params())
            .map(|param| param.name.as_str())
            .collect();
        known.sort_unstable();
        known.dedup();
        let hint = closest(name, known.iter().copied())
            .map_or(String::new(), |name| format!("; did you mean `{name}`?"));
        let list = if known.is_empty() {
            "none".into()
        } else {
            known.join(", ")
        };
        return Err(CliError::Input(format!(
            "--set {name}: no such param{hint}\n  params: {list}"
        )));
    }
    Ok(())
}

/// Faults of several graphs, gathered so that all are shown, each once.
#[derive(Default)]
pub struct Faults {
    rendered: Vec<String>,
    errors: usize,
    graphs: BTreeSet<String>,
}

impl Faults {
    /// Adds the faults of one graph, which may be the same as under another viewport before.
    pub fn add(&mut self, graph: &str, diagnostics: &Diagnostics) {
        let rendered = diagnostics.render(colour());
        self.graphs.insert(graph.into());
        if !self.rendered.contains(&rendered) {
            self.errors += count_errors(diagnostics.iter());
            self.rendered.push(rendered);
        }
    }

    /// The faults of one graph alone, as an error.
    pub fn of(graph: &str, diagnostics: &Diagnostics) -> CliError {
        let mut faults = Self::default();
        faults.add(graph, diagnostics);
        faults.into_error()
    }

    /// An error if there are any.
    ///
    /// # Errors
    /// [`CliError::Diagnostics`].
    pub fn none_or_error(self) -> Result<(), CliError> {
        if self.graphs.is_empty() {
            Ok(())
        } else {
            Err(self.into_error())
        }
    }

    fn into_error(self) -> CliError {
        let plural = |count: usize, noun: &str| {
            format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
        };
        let summary = format!(
            "{} in {}",
            plural(self.errors, "error"),
            plural(self.graphs.len(), "graph")
        );
        CliError::Diagnostics {
            rendered: self.rendered.concat(),
            summary,
        }
    }
}

/// Prints the warnings of a graph and of its plan on standard error.
pub fn warn(graph: &Graph, plan: &[Diagnostic]) {
    let warnings: Vec<Diagnostic> = graph.warnings().iter().chain(plan).cloned().collect();
    if !warnings.is_empty() {
        note(diagnostics::render(&warnings, colour()).trim_end());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_misspellings_get_a_suggestion() {
        let names = ["rt", "nsm", "crsm", "certified"];
        assert_eq!(closest("nms", names.into_iter()), Some("nsm"));
        assert_eq!(closest("certifed", names.into_iter()), Some("certified"));
        assert_eq!(closest("rtt", names.into_iter()), Some("rt"));
        assert_eq!(closest("photon_map", names.into_iter()), None);
    }

    #[test]
    fn missing_presets_and_files_are_told_apart() {
        let sources = sources();
        let message = |argument| locate(argument, &sources).unwrap_err().to_string();
        assert!(message("nowhere/a.ron").contains("no file `nowhere/a.ron`"));
        assert!(message("zzzzzzzz").contains("no preset `zzzzzzzz`"));
    }
}
