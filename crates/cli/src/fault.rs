//! A mistake at a place of a file of data that is to be read back.

use crate::error::{CliError, colour};
use skiagraph_graph::{Code, Diagnostic, SourceFile, diagnostics};

/// What is wrong, at a byte of the text.
#[derive(Debug)]
pub struct Fault {
    at: usize,
    what: String,
}

impl Fault {
    /// What serde found, where it found it.
    pub fn json(text: &str, error: &serde_json::Error) -> Self {
        // serde_json counts lines and, in bytes, columns from 1; an empty text has column 0.
        let lines = text.split_inclusive('\n').map(str::len);
        let before: usize = lines.take(error.line().saturating_sub(1)).sum();
        let message = error.to_string();
        let place = format!(" at line {} column {}", error.line(), error.column());
        Self {
            at: before + error.column().saturating_sub(1),
            what: message.strip_suffix(&place).unwrap_or(&message).to_owned(),
        }
    }

    /// At the first place where `field` is written, or at the begin of the file.
    pub fn at_field(text: &str, field: &str, what: String) -> Self {
        let at = text.find(field).unwrap_or(0);
        Self { at, what }
    }

    /// Shown in its file: `what_for` goes on "`FILE` is no …", `help` is the way out, `summary` the last line.
    pub fn in_file(self, file: &SourceFile, what_for: &str, help: &str, summary: &str) -> CliError {
        // Rendering moves a place inside a character or behind the text to where it can be shown.
        let error = Diagnostic::error(
            Code::Syntax,
            format!("`{}` is no {what_for}: {}", file.name, self.what),
        )
        .at(file.span(self.at..self.at + 1), "")
        .help(help);
        CliError::Diagnostics {
            rendered: diagnostics::render(&[error], colour()),
            summary: summary.into(),
        }
    }
}
