//! Writes JSON files, and shows the place of a mistake in a JSON file that is read back.
//!
//! ```
//! use skiagraph_compare::files::json::{Mistake, to_text};
//! use skiagraph_graph::SourceFile;
//!
//! assert_eq!(to_text(&[1, 2]), "[\n  1,\n  2\n]\n");
//!
//! let text = "{\"schema\": 1,}";
//! let error = serde_json::from_str::<serde_json::Value>(text).unwrap_err();
//! let file = SourceFile::new("out/results.json", text);
//! let (what, help) = ("results.json", "compare anew");
//! let shown = Mistake::from_serde(text, &error).in_file(&file, what, help, "nothing to resume");
//! assert!(shown.to_string().contains("out/results.json:1:14"), "{shown}");
//! ```

use crate::error::CompareError;
use serde::Serialize;
use serde_json::Value;
use skiagraph_graph::{Code, Diagnostic, SourceFile};

/// Returns a value as indented JSON text with a newline at its end.
pub fn to_text(value: &impl Serialize) -> String {
    let mut text = serde_json::to_string_pretty(value)
        .expect("plain structs with string keys always serialise");
    text.push('\n');
    text
}

/// A mistake in a JSON text: a message, and the byte of the text at which it is shown.
#[derive(Debug)]
pub struct Mistake {
    at: usize,
    what: String,
}

impl Mistake {
    /// Creates a mistake from an error that serde found in `text`, with its message and place.
    pub fn from_serde(text: &str, error: &serde_json::Error) -> Self {
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

    /// Moves the mistake from a part of a text, such as a line, to the whole text, in which the
    /// part begins at the byte `at`.
    pub fn behind(mut self, at: usize) -> Self {
        self.at += at;
        self
    }

    /// Creates a mistake with the message `what` at the first occurrence of the string `field` in
    /// `text`, or at the beginning of `text` if it does not occur.
    pub fn at_field(text: &str, field: &str, what: String) -> Self {
        let at = text.find(field).unwrap_or(0);
        Self { at, what }
    }

    /// Returns the error that shows the mistake in its line of `file`. The message begins with
    /// "`FILE` is not a WHAT_FOR: ", with the kind of file `what_for`; `help` is advice to the
    /// user, and `summary` is the last line.
    pub fn in_file(
        self,
        file: &SourceFile,
        what_for: &str,
        help: &str,
        summary: &str,
    ) -> CompareError {
        // Rendering moves a place inside a character or behind the text to where it can be shown.
        let what = format!("`{}` is not a {what_for}: {}", file.name, self.what);
        let error = Diagnostic::error(Code::Syntax, what).help(help);
        let error = error.at(file.span(self.at..self.at + 1), "");
        CompareError::Diagnostics {
            faults: vec![vec![error]],
            summary: summary.into(),
        }
    }
}

/// Checks that `version`, the field `schema` of the JSON file with this `text`, is `expected`.
///
/// # Errors
/// A mistake at the field `schema` if the version is missing or another one.
pub fn check_schema(text: &str, version: Option<Value>, expected: u32) -> Result<(), Mistake> {
    if version == Some(expected.into()) {
        return Ok(());
    }
    let version = version.unwrap_or_default();
    let what = format!(
        "this program reads version {expected} of the schema, not {version}: measure again, or \
         read it with the program that wrote it"
    );
    Err(Mistake::at_field(text, "\"schema\"", what))
}
