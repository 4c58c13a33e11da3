//! Requests that a plan cannot meet.

use crate::source::{Located, Span};

mistakes! {
    /// A request that a plan cannot meet.
    OutputError:

    NoOutput { graph: String, name: String, outputs: Vec<String> } =>
        Output("`{graph}` has no output `{name}`").suggest(&name, outputs);

    NoMaterial { graph: String, name: String, materials: Vec<String> } =>
        Output("`{graph}` has no material `{name}` to read back").suggest(&name, materials);

    NoPass(name: String, passes: Vec<String>) =>
        Output("unknown pass `{name}` to read a material after").suggest(&name, passes);

    Unsized(name: String) =>
        Output("`{name}` cannot be read back")
        .help("its size is known only once it is built, and the copy is planned before");

    Sampler(name: String) =>
        Output("`{name}` is a sampler and has no content");

    Provided(name: String) =>
        Output("`{name}` is provided, not written by a pass")
        .help(format!("name a pass that binds it: `{name}@PASS`"));

    Unwritten(name: String) =>
        Output("`{name}` cannot be read back: no pass writes it");

    Unreadable { name: String, what: String } =>
        Output("`{name}` cannot be read back: it is {what}");

    UnwrittenOutput { name: Located<String>, material: Located<String> } =>
        ReadBeforeWrite("no pass writes the output `{name}`")
        .at(&material, format!("`{material}` is never written"))
        .help("let a pass write it, or name another `material`");

    UnreadableOutput {
        name: Located<String>,
        material: Span,
        what: String,
        way_out: &'static str,
    } =>
        FormatMismatch("the output `{name}` cannot be read back")
        .at(material, &what)
        .help(way_out);

    Light { graph: String, kind: &'static str, takes: Vec<String>, place: Span } =>
        Light("`{graph}` takes no {kind} light")
        .at(place, "").help(format!("it takes: {}", takes.join(", ")));

    NotProven { graph: String, backend: String, lacks: String, place: Span } =>
        Feature("`{graph}` is not proven on the backend {backend}, which has {lacks}")
        .at(place, "")
        .help(format!(
            "run it on another backend; a graph whose answers on this one are known to be right \
             says `proven_on: [{backend}]`"
        ));

    NoViewport(place: Span) =>
        Size("the viewport has no pixels")
        .at(place, "").help("leave out frames of a view without pixels, as of a minimised window");

    UnsizedBuffer(name: Located<String>) =>
        Size("the size of `{name}` is not known: no shader sees it")
        .at(name, "")
        .help("let a pass bind it: the size of its items comes from the shader's type");

    Undrawn(name: Located<String>) =>
        ReadBeforeWrite("no pass draws to the multisampled texture `{name}`")
        .at(name, "bound, but never drawn to")
        .help("let a pass draw to it above, or leave `samples` out");

    ImportUsage { name: Located<String>, pass: Located<String>, lacking: String } =>
        Import("the import `{name}` was not made for what pass `{pass}` does")
        .at(name, "used here").at(pass, "by this pass")
        .help(format!("the host must make it with {lacking} besides"));

    Memory {
        graph: String, takes: String, limit: String, table: String, largest: Option<Span>,
        place: Span,
    } =>
        Memory(
            "the materials of `{graph}` take {takes}, but there are only {limit} of memory for them"
        )
        .at(largest.as_ref().unwrap_or(&place), match largest {
            Some(_) => "the largest of them",
            None => "",
        })
        .help(format!(
            "make the largest ones smaller (a smaller viewport, the param that sizes them, fewer \
             layers, a format with fewer bytes), or allow more memory\n{table}"
        ));
}
