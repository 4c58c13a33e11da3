//! Shaders that cannot be read, or are not valid.

use crate::{
    diagnostics::{code::Code, diagnostic::Diagnostic},
    panics::Panicked,
    source::span::{Located, Span},
};

/// A shader or an import that is not there.
#[derive(Clone, Debug, thiserror::Error)]
pub(crate) enum ImportError {
    #[error("the shader `{}` lies outside the shader folders", **.0)]
    Outside(Located<String>),
    /// Where it was looked for, and what it may have been meant to be.
    #[error("shader `{}.wgsl` not found", **.0)]
    NoShader(Located<String>, Vec<String>, Option<String>),
    #[error("the shader `{}.wgsl` cannot be read", **.0)]
    Unreadable(Located<String>, String),
    #[error("an import names a file in quotes")]
    Unquoted(Span),
    #[error("the import `{}` leaves the shader folder", **.0)]
    Leaves(Located<String>),
    #[error("imported file `{}` not found", **.0)]
    NoFile(Located<String>, Vec<String>, Option<String>),
    #[error("`{}` cannot be read", **.0)]
    UnreadableFile(Located<String>, String),
    #[error("`{}` declares `{function}` otherwise than the module it stands in for", **module)]
    Signature {
        module: Located<String>,
        function: String,
        place: Span,
        declared: Span,
    },
    #[error("{1} conditions of `imports` meet in one document, {2} at most")]
    TooManyConditions(Span, usize, usize),
    #[error("imports are nested too deep")]
    TooDeep(Span),
}

impl From<ImportError> for Diagnostic {
    fn from(mistake: ImportError) -> Self {
        let diagnostic = Self::error(mistake.code(), mistake.to_string());
        mistake.explain(diagnostic)
    }
}

impl ImportError {
    fn code(&self) -> Code {
        match self {
            Self::Unquoted(_)
            | Self::Leaves(_)
            | Self::TooDeep(_)
            | Self::Signature { .. }
            | Self::TooManyConditions(..) => Code::Shader,
            _ => Code::MissingFile,
        }
    }

    fn explain(self, diagnostic: Diagnostic) -> Diagnostic {
        match self {
            Self::Outside(name) => diagnostic.at(name.span, "asked for here").help(
                "shaders stand beside the document or in shaders/, and are named without folder \
                 signs like `..`",
            ),
            Self::NoShader(name, candidates, likeness) => diagnostic
                .at(name.span, "asked for here")
                .help(looked_for(&candidates, likeness)),
            Self::Unreadable(name, why) => diagnostic.at(name.span, "asked for here").help(why),
            Self::Unquoted(span) => diagnostic
                .at(span, "")
                .help("write #import \"shared/camera.wgsl\"; only a `//` comment may follow"),
            Self::Leaves(path) => diagnostic
                .at(path.span, "")
                .help("imports name files in the importing file's folder or in shaders/"),
            Self::NoFile(path, candidates, likeness) => diagnostic
                .at(path.span, "")
                .help(looked_for(&candidates, likeness)),
            Self::UnreadableFile(path, why) => diagnostic.at(path.span, "").help(why),
            Self::Signature {
                module,
                place,
                declared,
                ..
            } => diagnostic
                .at(place, "here")
                .at(declared, "there")
                .at(module.span, "asked for here")
                .help("give both the same parameters and result; a replacement may add functions"),
            Self::TooManyConditions(span, ..) => diagnostic.at(span, "the last of them").help(
                "a shader is compiled for all their values: give several imports one condition",
            ),
            Self::TooDeep(span) => diagnostic.at(span, ""),
        }
    }
}

fn looked_for(candidates: &[String], likeness: Option<String>) -> String {
    let likeness = likeness.map_or(String::new(), |likeness| format!("; {likeness}"));
    format!("looked for {}{likeness}", candidates.join(", "))
}

/// A shader that is not valid, or not what a pass needs.
#[derive(Clone, Debug, thiserror::Error)]
pub(crate) enum ShaderError {
    #[error("`{file}` is longer than {most} KiB")]
    TooLong { file: String, most: usize, at: Span },
    #[error("`{file}` holds an expression or a chain of `else if` that is nested too deep")]
    TooDeep { file: String, most: usize, at: Span },
    #[error("`{file}` has more than {most} declarations, those of its imports included")]
    TooManyDeclarations { file: String, most: usize, at: Span },
    /// Message of naga, with its places.
    #[error("{file} {what}")]
    Naga {
        /// In backquotes, with the shader that imports it if it is not that itself.
        file: String,
        what: String,
        places: Vec<(Span, String)>,
        notes: Vec<String>,
    },
    /// A library's mistake, not the author's.
    #[error("naga panics while `{file}` {while_it}: {}", panicked.message)]
    Panicked {
        file: String,
        while_it: &'static str,
        panicked: Panicked,
        at: Span,
    },
    #[error("`{global}` of `{file}` is an immediate, which a graph does not set")]
    Immediate {
        file: String,
        global: String,
        at: Span,
    },
    #[error("a type has no layout: {what}")]
    NoLayout { what: String, at: Span },
    #[error("`{global}` of `{file}` has a binding number that is taken: {number}")]
    Collision {
        file: String,
        global: String,
        number: String,
        at: Span,
        others: Vec<(Span, String)>,
    },
    #[error("`{constant}` is {found} in the shader, and {word} of `{param}` is {number}")]
    Choice {
        constant: String,
        found: String,
        word: String,
        param: String,
        number: u32,
        at: Span,
        declared: Span,
    },
    #[error("two words give the constant `{constant}`")]
    TwoWords {
        constant: String,
        first: Span,
        second: Span,
    },
    #[error("`{file}` has no {stage} entry point `{}`", **name)]
    NoSuchEntry {
        file: String,
        stage: String,
        name: Located<String>,
        known: Vec<String>,
    },
    #[error("`{file}` has no {stage} entry point")]
    NoEntry {
        file: String,
        stage: String,
        at: Span,
    },
    #[error("`{file}` has several {stage} entry points")]
    SeveralEntries {
        file: String,
        stage: String,
        at: Span,
        known: Vec<String>,
    },
    #[error("nothing in `{shader}` uses the {what} `{}`", **name)]
    Unused {
        what: &'static str,
        name: Located<String>,
        shader: String,
    },
}

impl From<ShaderError> for Diagnostic {
    fn from(mistake: ShaderError) -> Self {
        let diagnostic = Self::error(mistake.code(), mistake.to_string());
        mistake.explain(diagnostic)
    }
}

impl ShaderError {
    fn code(&self) -> Code {
        match self {
            Self::Panicked { .. } => Code::LibraryPanic,
            Self::Collision { .. } | Self::Immediate { .. } => Code::Binding,
            Self::Choice { .. } | Self::TwoWords { .. } => Code::ChoiceConstant,
            Self::NoSuchEntry { .. } | Self::NoEntry { .. } | Self::SeveralEntries { .. } => {
                Code::EntryPoint
            }
            Self::Unused { .. } => Code::Unused,
            _ => Code::Shader,
        }
    }

    fn explain(self, diagnostic: Diagnostic) -> Diagnostic {
        match self {
            Self::Unused { name, .. } => diagnostic
                .at(name.span, "")
                .help("remove it, or check the names that should be it"),
            Self::TooLong { at, .. } => diagnostic
                .at(at, "")
                .help("split it into several shaders; large tables belong into buffers"),
            Self::TooDeep { at, most, .. } => diagnostic
                .at(at, format!("more than {most} operators up to here"))
                .help(
                    "split it: give parts of it a name with `let`, turn the chain into a \
                     `switch` or a loop",
                ),
            Self::TooManyDeclarations { at, .. } => diagnostic
                .at(at, "counted up to here")
                .help("split it into several shaders, or import less"),
            Self::Naga { places, notes, .. } => {
                let diagnostic = places
                    .into_iter()
                    .fold(diagnostic, |diagnostic, (span, text)| {
                        diagnostic.at(span, text)
                    });
                if notes.is_empty() {
                    diagnostic
                } else {
                    diagnostic.help(notes.join("\n"))
                }
            }
            Self::Panicked { at, panicked, .. } => diagnostic
                .at(at, "this brings it about")
                .help(panicked.way_out()),
            Self::Immediate { at, .. } => diagnostic.at(at, "").help(
                "make it a member of the uniform `params`, which passes set by `set` and by params",
            ),
            Self::NoLayout { at, .. } => diagnostic.at(at, ""),
            Self::Collision { at, others, .. } => {
                let diagnostic = others
                    .into_iter()
                    .fold(diagnostic.at(at, "this one"), |diagnostic, (span, name)| {
                        diagnostic.at(span, format!("`{name}` has it too"))
                    });
                diagnostic.help("leave the numbers out: the graph gives them")
            }
            Self::Choice { at, declared, .. } => diagnostic
                .at(at, "declared here")
                .at(declared, "the words in their order")
                .help("leave the constant out: the words of a Choice bring it"),
            Self::TwoWords { first, second, .. } => diagnostic
                .at(second, "a word of this")
                .at(first, "and one of this")
                .help("rename one of the words or params: NAME_WORD is the constant of a word"),
            Self::NoSuchEntry { name, known, .. } => {
                diagnostic.at(name.span.clone(), "").suggest(&name, known)
            }
            Self::NoEntry { stage, at, .. } => diagnostic
                .at(at, "this pass needs one")
                .help(format!("write a function with the attribute @{stage}")),
            Self::SeveralEntries { at, known, .. } => {
                let names: Vec<String> = known.iter().map(|name| format!("`{name}`")).collect();
                diagnostic
                    .at(at, "it is not clear which one this pass runs")
                    .help(format!("name one of {}", names.join(", ")))
            }
        }
    }
}
