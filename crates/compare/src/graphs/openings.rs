//! Resolves open includes: includes whose document a run may exchange. A graph with another
//! document in an open include is a method of its own: `contact.ron@over=msm`. So is one with
//! another picture in a texture: `effect.ron@noise=other.png`.
//!
//! ```
//! use skiagraph_compare::graphs::openings::arguments;
//! use skiagraph_graph::{FolderSources, LayeredSources};
//! use skiagraph_passes::EmbeddedSources;
//!
//! # let root = tempfile::tempdir()?;
//! let step = r#"(format: 3, outputs: ["visibility"], passes: [
//!     Include(graph: "nsm.ron", open: "over", expose: All)])"#;
//! std::fs::create_dir(root.path().join("pipelines"))?;
//! std::fs::write(root.path().join("pipelines/step.ron"), step)?;
//! let folder = FolderSources { root: root.path().into() };
//! let sources = LayeredSources(vec![Box::new(folder), Box::new(EmbeddedSources)]);
//! let (methods, _) = arguments(["step"], &["over=pcf,nsm".parse()?], &sources)?;
//! let names: Vec<&str> = methods.iter().map(|it| it.preset.as_str()).collect();
//! assert_eq!(names, ["step@over=pcf", "step@over=nsm"]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::Result;
use crate::graphs::argument::{Assignment, MethodArgument};
use crate::graphs::preset;
use crate::lists::unique;
use itertools::Itertools;
use skiagraph_graph::Sources;
use std::collections::BTreeSet;

/// Parses methods of a command line, and chooses documents for their *open includes*: includes
/// whose document a run may exchange (`Include(open: "over")`). An assignment whose name is that of
/// an open include chooses the include's document, and becomes part of the graph's name:
/// `step@over=pcf`. A method's own assignment wins over one of `params`. A list of documents,
/// `over=pcf,nsm`, gives one method for each. Returns the methods, and those of `params` that name
/// no open include of any method: they set params, and are left to the caller.
///
/// # Errors
/// A graph file that does not exist or cannot be read, if its method has assignments or `params` is
/// not empty.
pub fn arguments(
    words: impl IntoIterator<Item = impl AsRef<str>>,
    params: &[Assignment],
    sources: &dyn Sources,
) -> Result<(Vec<MethodArgument>, Vec<Assignment>)> {
    let (mut chosen, mut taken) = (Vec::new(), BTreeSet::new());
    for word in words {
        let argument = MethodArgument::new(word.as_ref());
        if argument.own.is_empty() && params.is_empty() {
            chosen.push(argument);
            continue;
        }
        // A graph with faults is told where it is loaded.
        let graph = preset::load(&argument.preset, sources)?.0.ok();
        let graph = graph.iter();
        let openings = graph.flat_map(|graph| graph.openings().chain(graph.pictures()));
        let openings: BTreeSet<String> = openings.map(|(name, _)| name.to_owned()).collect();
        let names = params.iter().map(|set| &set.name);
        taken.extend(names.filter(|name| openings.contains(*name)));
        chosen.extend(over(argument, params, &openings));
    }
    let left = params.iter().filter(|set| !taken.contains(&set.name));
    Ok((chosen, left.cloned().collect()))
}

/// One argument for each choice of documents.
fn over(
    argument: MethodArgument,
    params: &[Assignment],
    openings: &BTreeSet<String>,
) -> Vec<MethodArgument> {
    let own = argument.own.into_iter();
    let (documents, own): (Vec<_>, Vec<_>) = own.partition(|set| openings.contains(&set.name));
    let is_own = |name: &str| documents.iter().any(|set| set.name == name);
    let is_for_all = |set: &&Assignment| openings.contains(&set.name) && !is_own(&set.name);
    let for_all = params.iter().filter(is_for_all);
    let mut names = vec![argument.preset];
    for (number, set) in documents.iter().chain(for_all).enumerate() {
        let sign = if number == 0 { '@' } else { ',' };
        let documents = unique(set.value.split(',').map(str::trim));
        let with =
            |(document, name): (&str, &String)| format!("{name}{sign}{}={document}", set.name);
        let pairs = documents.into_iter().cartesian_product(&names);
        names = pairs.map(with).collect();
    }
    let with = |preset| MethodArgument {
        preset,
        own: own.clone(),
    };
    names.into_iter().map(with).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graphs::preset;
    use skiagraph_graph::{FolderSources, LayeredSources};
    use skiagraph_passes::EmbeddedSources;

    const STEP: &str = r#"(format: 3, outputs: ["visibility"], passes: [
        Include(graph: "nsm.ron", open: "over", expose: All)])"#;

    #[test]
    fn documents_in_open_includes_are_in_the_names_of_graphs() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("pipelines")).unwrap();
        std::fs::write(folder.path().join("pipelines/step.ron"), STEP).unwrap();
        let root = folder.path().to_owned();
        let sources = LayeredSources(vec![
            Box::new(FolderSources { root }),
            Box::new(EmbeddedSources),
        ]);
        let read = |words: &[&str], set: &[&str]| {
            let words: Vec<String> = words.iter().map(|word| (*word).to_owned()).collect();
            let set: Vec<Assignment> = set.iter().map(|set| set.parse().unwrap()).collect();
            let (arguments, left) = arguments(&words, &set, &sources).unwrap();
            let pairs = arguments.iter().map(|it| (it.preset.clone(), it.own.len()));
            (pairs.collect::<Vec<_>>(), left.len())
        };
        let named = |names: &[(&str, usize)]| -> Vec<(String, usize)> {
            let names = names.iter().map(|(name, own)| ((*name).to_owned(), *own));
            names.collect()
        };
        let parsed = read(&["step", "nsm@bias=1", "step@over=pcf,bias=1"], &[]);
        let expected = [("step", 0), ("nsm", 1), ("step@over=pcf", 1)];
        assert_eq!(parsed, (named(&expected), 0));
        // A value set for all methods holds where nothing else is said; a list makes several
        // methods.
        let parsed = read(
            &["step", "step@over=pcf", "nsm"],
            &["over=nsm,pcf", "bias=1"],
        );
        let expected = [
            ("step@over=nsm", 0),
            ("step@over=pcf", 0),
            ("step@over=pcf", 0),
            ("nsm", 0),
        ];
        assert_eq!(parsed, (named(&expected), 1));

        let load = |name: &str| preset::load(name, &sources).unwrap().0;
        let params = |name| load(name).unwrap().params().len();
        assert_ne!(params("step"), params("step@over=pcf"));
        let faults = load("step@ovr=pcf").unwrap_err().to_string();
        assert!(faults.contains("has no open include `ovr`"), "{faults}");
        assert!(preset::load("step@over=none", &sources).is_err());
    }
}
