//! Mistakes between documents: params, inputs, outputs, names.

use crate::param::{Param, ParamFault, ParamValue};
use crate::source::{Located, Span};

mistakes! {
    /// A param that has no value, or a wrong one.
    ParamError:

    Unknown(what: String) =>
        UnknownParam("{what}");

    Asked { name: Located<String>, value: ParamValue, why: ParamFault } =>
        ParamValue("param `{name}` = {value}: {why}").at(name, "declared here");

    QuotedWord(word: String, span: Span) =>
        ParamValue("a word of a Choice stands without quotes")
        .at(span, "in quotes this is an expression").help(format!("write `default: {word}`"));

    Default { param: Located<String>, why: ParamFault } =>
        ParamValue("the default of param `{param}` does not fit").at(param, why.to_string());

    Set { name: Located<String>, declared: Span, why: ParamFault } =>
        ParamValue("the value for param `{name}` does not fit")
        .at(name, why.to_string()).at(declared, "declared here");

    Misfit { name: Located<String>, outer: Box<Param>, param: Box<Param> } =>
        ParamValue(
            "`{}` ({}) is handed to `{name}` ({})", outer.name, range(&outer), range(&param)
        )
        .at(name, "given here").at(&outer.name, range(&outer)).at(&param.name, range(&param))
        .help(
            "give the first one the type and the `min` and `max` of the other, or `set` that to an \
             expression that fits",
        );

    Required { name: String, document: String, span: Span, declared: Span } =>
        ParamValue("`{document}` asks for the param `{name}`")
        .at(span, "no param here has this name").at(declared, "it has no default")
        .help(format!("declare one, or give it a value: `set: {{\"{name}\": …}}`"));
}

/// Type and range of a param.
fn range(param: &Param) -> String {
    let ty = &param.ty;
    match (param.min, param.max) {
        (Some(min), Some(max)) => format!("{ty}, {min} to {max}"),
        (Some(min), None) => format!("{ty}, {min} at least"),
        (None, Some(max)) => format!("{ty}, {max} at most"),
        (None, None) => ty.to_string(),
    }
}

mistakes! {
    /// A mistake at the border between two documents.
    InterfaceError:

    /// Two includes of the same document with the same content, between which a pass writes a
    /// material that they read or write.
    TwoCopies { graph: String, pass: String, material: String, span: Span, by: Span } =>
        TwoCopies("`{graph}` runs twice, because `{pass}` writes `{material}` in between")
        .at(span, "the second copy").at(by, "written by this pass")
        .help(
            "put the include above that pass, or give it a name, which says that two are meant",
        );

    IsValue(name: Located<String>) =>
        ResourceKind("`{name}` is a value, not a material")
        .at(name, "a material is meant here")
        .help("values stand in expressions, and in params and overrides of shaders by name");

    NoInput {
        document: String, name: String, kind: String, span: Span, declared: Span,
        names: Vec<String>,
    } =>
        Input("`{document}` asks for `{name}`, {kind}")
        .at(span, "nothing here has this name").at(declared, "asked for here")
        .suggest(&name, names)
        .help(format!("bind what is meant: `bind: {{\"{name}\": \"…\"}}`"));

    NoImport(name: Located<String>) =>
        Input("the host imports no `{name}`, which the document asks for")
        .at(name, "an input of the root document is the host's import")
        .help("include the document in one that has it, or let the host import it");

    WrongInput {
        document: String, name: String, expected: String, given: String, span: Span,
        declared: Span,
    } =>
        Input("`{document}` asks for `{name}`, {expected}; here it is {given}")
        .at(span, "given here").at(declared, "asked for here");

    WrongImport { name: Located<String>, expected: String, imported: String } =>
        Input("the host imports {imported} for `{name}`, {expected} is asked for")
        .at(name, "asked for here");

    WrittenInput(name: Located<String>, by: Span) =>
        Input("the input `{name}` is written, but is not an output")
        .at(name, "an input").at(by, "written here")
        .help(
            "name it among the `outputs`, so that its includers know; or make it a material, \
             which takes the place of an extended document's input"
        );

    Unused(document: String, name: Located<String>, names: Vec<String>) =>
        Unused("`{document}` has no input, output or param `{name}`")
        .at(&name, "").suggest(&name, names);

    RoundsInRounds(counters: [Located<String>; 2]) =>
        RunCondition("a group that ends early stands in another one")
        .at_all(counters.iter().zip(["ends the inner one", "ends the outer one"]))
        .help("leave one `while` out");

    UnusedInGroup(group: String, name: Located<String>) =>
        Unused("nothing in the group `{group}` asks for `{name}`")
        .at(name, "")
        .help("one of its passes or includes must have this name free; check its spelling");

    UnwrittenOutput(name: Located<String>) =>
        Output("no pass writes the output `{name}`")
        .at(name, "").help("let a pass write it, or name another `material`");

    BoundOutput(name: Located<String>, why: String, declared: Span) =>
        Output("the output `{name}` cannot be written into a material here")
        .at(name, why).at(declared, "declared here");

    /// Name without a material; `document` is the path of the document in which the name stands.
    Unknown { name: Located<String>, document: String, materials: Vec<String> } =>
        UnknownResource("unknown material `{name}`")
        .at(&name, format!("`{document}` declares no material or input of this name"))
        .suggest(&name, materials);

    Private(entry: String, name: Located<String>, outputs: Vec<String>) =>
        UnknownResource("`{entry}` gives no `{name}`")
        .at(&name, "only its outputs are seen from here").suggest(&name, outputs);

    Namespace(name: Located<String>) =>
        ResourceKind("`{name}` has no content of its own")
        .at(name, "name what it gives: `x.y`, or `x[0].y` where it is repeated");

    Range(part: Located<String>, what: String, declared: Option<Span>) =>
        Range("`{part}` does not exist").at(part, what).at_any(declared, "declared here");

    NoPart(part: Located<String>, what: &'static str) =>
        ResourceKind("`{part}` has no such part").at(part, what);

    NotOfMaterial(material: String, name: Located<String>) =>
        ResourceKind("`{material}` is a material, and gives no `{name}`")
        .at(name, "not a part of it")
        .help(format!("its parts are `{material}[0]`, `{material}.mip[0]`, `{material}.previous`"));

    NoPrevious {
        name: Located<String>,
        what: String,
        /// Name of the material, if it has `keep: true`; `None` otherwise.
        kept: Option<String>,
    } =>
        ResourceKind("`{name}` has no version of the frame before")
        .at(name, format!("it is {what}"))
        .help(match kept {
            Some(name) => format!(
                "read `{name}` above the passes that write it: there it holds what the frame \
                 before left; or leave `keep` out"
            ),
            None => "textures and buffers that the graph writes have one; copy it into one".into(),
        });

    TooMany(most: usize, what: &'static str, at: Span) =>
        Size("the graph has more than {most} {what}")
        .at(at, "counted up to here").help("repeat or include less");

    Need { document: String, need: Located<String>, evaluated: String } =>
        Need("`{document}` needs `{need}`")
        .at(need, format!("here it is {evaluated}"))
        .help("plan it for another viewport, scene or number of lights, which `needs` asks for");

    Feature(document: String, feature: Located<String>) =>
        Feature("`{document}` cannot run without the feature `{feature}`")
        .at(feature, "the device does not have this feature")
        .help("run it on an adapter that has the feature, or ask `has(…)` in an `if`");
}
