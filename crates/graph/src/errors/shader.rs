//! Shaders that cannot be read, or are not valid.

use super::compose::looked_for;
use crate::source::{Located, Span};
use skiagraph_located_ron::panics::Panicked;

mistakes! {
    /// A shader or an import that is not there.
    ImportError:

    Outside(name: Located<String>) =>
        MissingFile("the shader `{name}` lies outside the shader folders")
        .at(name, "asked for here")
        .help(
            "shaders stand beside the document or in shaders/, and are named without folder signs \
             like `..`",
        );

    /// No shader at any of `candidates`, the paths that were tried; `likeness` suggests a name.
    NoShader(name: Located<String>, candidates: Vec<String>, likeness: Option<String>) =>
        MissingFile("shader `{name}.wgsl` not found")
        .at(name, "asked for here").help(looked_for(&candidates, likeness));

    Unreadable(name: Located<String>, why: String) =>
        MissingFile("the shader `{name}.wgsl` cannot be read").at(name, "asked for here").help(why);

    Unquoted(place: Span) =>
        Shader("an import names a file in quotes")
        .at(place, "").help("write #import \"shared/camera.wgsl\"; only a `//` comment may follow");

    Leaves(path: Located<String>) =>
        Shader("the import `{path}` leaves the shader folder")
        .at(path, "").help("imports name files in the importing file's folder or in shaders/");

    NoFile(path: Located<String>, candidates: Vec<String>, likeness: Option<String>) =>
        MissingFile("imported file `{path}` not found")
        .at(path, "").help(looked_for(&candidates, likeness));

    UnreadableFile(path: Located<String>, why: String) =>
        MissingFile("`{path}` cannot be read").at(path, "").help(why);

    Signature { module: Located<String>, function: String, place: Span, declared: Span } =>
        Shader("`{module}` declares `{function}` otherwise than the module it stands in for")
        .at(place, "here").at(declared, "there").at(module, "asked for here")
        .help("give both the same parameters and result; a replacement may add functions");

    TooManyConditions(place: Span, count: usize, most: usize) =>
        Shader("{count} conditions of `imports` meet in one document, {most} at most")
        .at(place, "the last of them")
        .help("a shader is compiled for all their values: give several imports one condition");

    TooDeep(place: Span) =>
        Shader("imports are nested too deep").at(place, "");
}

mistakes! {
    /// A shader that is not valid, or not what a pass needs.
    ShaderError:

    TooLong(file: String, most: usize, at: Span) =>
        Shader("`{file}` is longer than {most} KiB")
        .at(at, "").help("split it into several shaders; large tables belong into buffers");

    TooDeep(file: String, most: usize, at: Span) =>
        Shader("`{file}` holds an expression or a chain of `else if` that is nested too deep")
        .at(at, format!("more than {most} operators up to here"))
        .help(
            "split it: give parts of it a name with `let`, turn the chain into a `switch` or a \
             loop",
        );

    TooManyDeclarations(file: String, most: usize, at: Span) =>
        Shader("`{file}` has more than {most} declarations, those of its imports included")
        .at(at, "counted up to here").help("split it into several shaders, or import less");

    /// An error of naga's with its places. `file` is in backquotes, followed by the importing
    /// shader if the mistake is in a module.
    Naga(file: String, what: String, places: Vec<(Span, String)>, notes: Vec<String>) =>
        Shader("{file} {what}")
        .at_all(places).help_any((!notes.is_empty()).then(|| notes.join("\n")));

    /// A panic of naga's: a mistake of the library, not of the author.
    Panicked { file: String, while_it: &'static str, panicked: Panicked, at: Span } =>
        LibraryPanic("naga panics while `{file}` {while_it}: {}", panicked.message)
        .at(at, "this brings it about").help(panicked.way_out());

    Immediate(file: String, global: String, at: Span) =>
        Binding("`{global}` of `{file}` is an immediate, which a graph does not set")
        .at(at, "")
        .help(
            "make it a member of the uniform `params`, which passes set by `set` and by params",
        );

    NoLayout(what: String, at: Span) =>
        Shader("a type has no layout: {what}").at(at, "");

    Collision {
        file: String, global: String, number: String, at: Span, clashing: Vec<(Span, String)>,
    } =>
        Binding("`{global}` of `{file}` has a binding number that is taken: {number}")
        .at(at, "this one")
        .at_all(clashing.into_iter().map(|(at, name)| (at, format!("`{name}` has it too"))))
        .help("leave the numbers out: the graph gives them");

    Choice {
        constant: String, value: String, word: String, param: Located<String>, number: u32,
        at: Span,
    } =>
        ChoiceConstant(
            "`{constant}` is {value} in the shader, and {word} of `{param}` is {number}"
        )
        .at(at, "declared here").at(param, "the words in their order")
        .help("leave the constant out: the words of a Choice bring it");

    TwoWords(constant: String, first: Span, second: Span) =>
        ChoiceConstant("two words give the constant `{constant}`")
        .at(second, "a word of this").at(first, "and one of this")
        .help("rename one of the words or params: NAME_WORD is the constant of a word");

    NoSuchEntry { file: String, stage: String, name: Located<String>, entries: Vec<String> } =>
        EntryPoint("`{file}` has no {stage} entry point `{name}`")
        .at(&name, "").suggest(&name, entries);

    NoEntry(file: String, stage: String, at: Span) =>
        EntryPoint("`{file}` has no {stage} entry point")
        .at(at, "this pass needs one")
        .help(format!("write a function with the attribute @{stage}"));

    SeveralEntries { file: String, stage: String, at: Span, entries: Vec<String> } =>
        EntryPoint("`{file}` has several {stage} entry points")
        .at(at, "it is not clear which one this pass runs")
        .help(format!("name one of `{}`", entries.join("`, `")));

    Mixed(first: String, second: String, at: Span) =>
        Shader("`{second}` stands beside `{first}` without parentheses")
        .at(at, "")
        .help("WGSL asks for parentheses here: browsers refuse what naga takes");

    Unused(what: &'static str, name: Located<String>, shader: String) =>
        Unused("nothing in `{shader}` uses the {what} `{name}`")
        .at(name, "").help("remove it, or check the names that should be it");
}
