//! Documents that cannot be found, or do not go together.

use crate::language::Name;
use crate::source::{Located, Span};

mistakes! {
    /// A document that cannot be found, or does not go together with another.
    ComposeError:

    NoDocument(path: String, likeness: Option<String>) =>
        MissingFile("document `{path}` not found").help_any(likeness);

    Unreadable(path: String, why: String) =>
        MissingFile("the document `{path}` cannot be read: {why}");

    Outside(path: Located<String>) =>
        MissingFile("the document `{path}` lies outside the folders of documents")
        .at(path, "asked for here")
        .help(
            "documents stand beside the one that asks for them, in a folder below it, or in \
             pipelines/, and are named without folder signs like `..`",
        );

    /// No document at any of `candidates`, the paths that were tried; `likeness` suggests a name.
    NoInclude(path: Located<String>, candidates: Vec<String>, likeness: Option<String>) =>
        MissingFile("document `{path}` not found")
        .at(path, "asked for here").help(looked_for(&candidates, likeness));

    UnreadableInclude(path: Located<String>, why: String) =>
        MissingFile("the document `{path}` cannot be read").at(path, "asked for here").help(why);

    Cycle(graph: Located<String>, open: Vec<(String, Option<Span>)>) =>
        IncludeCycle(
            "the document `{}` includes itself", open.first().map_or("", |(path, _)| path)
        )
        .at(graph, "includes it again")
        .at_all(open.iter().skip(1).filter_map(|(path, place)| {
            Some((place.as_ref()?, format!("includes `{path}`")))
        }))
        .help(ring(&open));

    TooDeep(graph: Located<String>, most: usize) =>
        Size("documents include or extend each other more than {most} deep")
        .at(graph, "").help("use fewer levels");

    SameName(what: &'static str, name: Located<String>, first: Span) =>
        DuplicateName("two of the name `{name}`: every {what} needs its own")
        .at(name, "the second one").at(first, "the first one")
        .help_any((what == "material").then_some(
            "an include can be given a name: `name: \"left\"` makes `left.x` of its output `x`",
        ));

    /// Two names that are spelt alike in a shader, such as `a.b` and `a_b`.
    Clash(name: Located<String>, first: Located<String>) =>
        Name("`{name}` and `{first}` are one name in a shader")
        .at(&name, format!("gives `{name}`")).at(first, "declared here").help("rename one of them");

    NoParam(name: Located<String>, document: String, params: Vec<String>) =>
        UnknownParam("`{document}` has no param `{name}`").at(&name, "").suggest(&name, params);

    NoOpening(name: String, document: String, openings: Vec<String>) =>
        UnknownParam("`{document}` has no open include `{name}`, and no picture of this name")
        .help_any(openings.is_empty().then_some(
            "an include is left open by `open: \"…\"`, a texture has a picture by `file: \"…\"`; \
             it has none",
        ))
        .suggest(&name, openings);

    NoCommonLight(graph: Located<String>, takes: Vec<String>) =>
        Light("no light is taken both here and by `{graph}`")
        .at(graph, "included here")
        .help(format!(
            "it takes {}: take one of these in `lights`, or another document", takes.join(", ")
        ));

    ExposedTwice(name: Located<String>, first: Span) =>
        ParamValue("`{name}` is a param here already")
        .at(&name, "exposed here").at(first, "and declared here")
        .help(format!(
            "give the include a name, or `set` it to the one that is here: \
             `set: {{\"{name}\": \"{name}\"}}`"
        ));

    NarrowOfOther(name: Located<String>, declared: Span) =>
        ParamValue("`{name}` is not a `Choice`: it has no words to narrow")
        .at(name, "").at(declared, "declared here")
        .help("give a number another `min` or `max` where it is declared");

    NarrowWord(word: Located<Name>, declared: Span, words: Vec<String>) =>
        ParamValue("`{word}` is not a word that is left to narrow")
        .at(&word, "").at(declared, "declared here").suggest(&word, words);

    ValueIsWord(name: Located<Name>, param: Located<String>) =>
        Name("the value `{name}` has the name of a word of the param `{param}`")
        .at(name, "").at(param, "its words are declared here")
        .help("rename the value: beside the param its name would be the word");

    ExposedDefault(name: Located<String>) =>
        ParamValue("`{name}` cannot be exposed: its default is made of other params")
        .at(name, "").help("declare a param here, and `set` it to that");

    NoOutputs(place: Span) =>
        Output("the document has no outputs, so none of its passes is needed")
        .at(place, "").help("add `outputs: [\"…\"]`");

    Unused(what: &'static str, name: Located<String>) =>
        Unused("nothing uses the {what} `{name}`")
        .at(name, "")
        .help(match what {
            "value" => {
                "remove it, or check the names in expressions, outputs, params and overrides"
            }
            "material" => {
                "remove it, or check the names of the shader globals that should be it"
            }
            "param" => {
                "remove it, or check the names in `params` of the shaders and in expressions"
            }
            _ => "remove the entry, or name the module as the shaders import it",
        });
}

/// Says where a file was looked for, and which one may have been meant.
pub(super) fn looked_for(candidates: &[String], likeness: Option<String>) -> String {
    let likeness = likeness.map_or(String::new(), |likeness| format!("; {likeness}"));
    format!("looked for {}{likeness}", candidates.join(", "))
}

fn ring(open: &[(String, Option<Span>)]) -> String {
    let path: Vec<&str> = open.iter().map(|(path, _)| path.as_str()).collect();
    format!(
        "the cycle is {} → {}: take one of these includes out",
        path.join(" → "),
        path.first().unwrap_or(&"")
    )
}
