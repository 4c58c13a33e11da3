//! Orders of passes that cannot be.

use crate::{
    diagnostics::{code::Code, diagnostic::Diagnostic},
    source::span::{Located, Span},
};

#[derive(Clone, Debug, thiserror::Error)]
pub(crate) enum OrderError {
    #[error("`{name}` cannot be read back: {}", written(*partly))]
    Capture {
        name: String,
        first: Option<String>,
        /// Something above has written some of it.
        partly: bool,
    },
    #[error("pass `{}` {} `{name}` that no pass has written", **pass, verb(*changes, *partly))]
    Unwritten {
        name: String,
        pass: Located<String>,
        read: Span,
        /// The pass writes it, too.
        changes: bool,
        /// Something above has written some of it.
        partly: bool,
    },
    #[error("passes need each other's results: {} → {}", path.join(" → "), **pass)]
    Cycle {
        name: String,
        pass: Located<String>,
        writer: Located<String>,
        path: Vec<String>,
    },
    #[error("pass `{}` reads `{name}` before it is written", **pass)]
    WrittenBelow {
        name: String,
        pass: Located<String>,
        read: Span,
        writer: Located<String>,
    },
    #[error("pass `{}` reads `{name}` of the frame before, but no pass writes it", **pass)]
    NeverWritten {
        name: String,
        pass: Located<String>,
        read: Span,
    },
    #[error("`{}` grows by `{counter}`, which no pass writes", **name)]
    NeverCounted {
        name: Located<String>,
        counter: String,
    },
    #[error(
        "passes `{}` and `{}` must run or be skipped together, for the sake of `{name}`",
        *passes[0], *passes[1]
    )]
    RunConditions {
        name: String,
        passes: [Located<String>; 2],
        runs: [String; 2],
    },
}

fn verb(changes: bool, partly: bool) -> &'static str {
    match (changes, partly) {
        (true, true) => "reads and changes a part of",
        (true, false) => "reads and changes",
        (false, true) => "reads a part of",
        (false, false) => "reads",
    }
}

/// How far something is written.
fn written(partly: bool) -> &'static str {
    if partly {
        "something has written some of it, but not all"
    } else {
        "nothing has written it yet"
    }
}

impl From<OrderError> for Diagnostic {
    fn from(mistake: OrderError) -> Self {
        let diagnostic = Self::error(mistake.code(), mistake.to_string());
        mistake.explain(diagnostic)
    }
}

impl OrderError {
    fn code(&self) -> Code {
        match self {
            Self::Capture { .. } => Code::Output,
            Self::Cycle { .. } => Code::Cycle,
            Self::RunConditions { .. } => Code::RunCondition,
            _ => Code::ReadBeforeWrite,
        }
    }

    fn explain(self, diagnostic: Diagnostic) -> Diagnostic {
        match self {
            Self::Capture { first, partly, .. } => diagnostic.help(match (first, partly) {
                (Some(first), true) => {
                    format!("name a mip or layer that is written by then; `{first}` writes others")
                }
                (None, true) => "name a mip or layer that is written by then".to_owned(),
                (Some(first), false) => format!("it is first written by `{first}`"),
                (None, false) => "no pass writes it".to_owned(),
            }),
            Self::Unwritten {
                name,
                pass,
                read,
                changes,
                ..
            } => {
                let diagnostic = diagnostic
                    .at(read, "read here")
                    .at(pass.span, "by this pass");
                if changes {
                    diagnostic.help(format!(
                        "put `Clear(name: \"clear\", target: \"{name}\")` above it, if it \
                         starts anew in each frame; if it goes on from the frame before, give it \
                         `keep: true`, or bind `\"{name}.previous\"` and read that; say \
                         `overwrites: [\"{name}\"]`, if the pass itself writes all that it reads"
                    ))
                } else {
                    diagnostic.help("let a pass above write it, or name another material")
                }
            }
            Self::Cycle {
                name, pass, writer, ..
            } => diagnostic
                .at(pass.span, format!("reads `{name}`"))
                .at(
                    writer.span,
                    format!("writes `{name}`, and needs what `{}` made", pass.value),
                )
                .help(
                    "break the cycle: write a second material, or move the read into a pass below",
                ),
            Self::WrittenBelow {
                name,
                pass,
                read,
                writer,
            } => diagnostic
                .at(read, "read here")
                .at(pass.span, "by this pass")
                .at(writer.span.clone(), "written only here, below")
                .help(format!(
                    "move `{}` above `{}`: the file reads as a sequential program; give `{name}` \
                     `keep: true` to read here what the frame before left",
                    *writer, pass.value
                )),
            Self::NeverWritten { name, pass, read } => diagnostic
                .at(read, "read here")
                .at(pass.span, "by this pass")
                .help(format!("let a pass write `{name}`")),
            Self::NeverCounted { name, counter } => diagnostic.at(name.span, "").help(format!(
                "let a pass count in `{counter}` the items that are needed"
            )),
            Self::RunConditions {
                name,
                passes: [a, b],
                runs: [run_a, run_b],
            } => diagnostic
                .at(b.span, format!("`run: {run_b}`"))
                .at(a.span, format!("`run: {run_a}`"))
                .help(format!(
                    "both write it, or one reads what the other overwrites: give both the same \
                     `run`, or one of them another material than `{name}`"
                )),
        }
    }
}
