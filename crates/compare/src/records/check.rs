//! The schema of `check --format json`, version 1. Editors and scripts rely on it: extend it,
//! rename nothing.
//!
//! ```
//! use skiagraph_compare::records::check::{CheckReport, FileReport};
//! use skiagraph_compare::{files::json, graphs::planning::{Trial, check}};
//! use skiagraph_passes::{EmbeddedSources, registry};
//!
//! let path = "pipelines/none.ron";
//! let file = match check(path, &registry(), &EmbeddedSources, &Trial::default()) {
//!     Ok(it) => FileReport::new(path, Some(it.plan.passes().len()), it.graph.warnings()),
//!     Err(wrong) => FileReport::new(path, None, wrong.iter()),
//! };
//! let text = json::to_text(&CheckReport::new(vec![file]));
//! assert!(text.contains("missing-file"), "{text}");
//! ```

use serde::Serialize;
use skiagraph_graph::{Code, Diagnostic, Label, Severity};

/// The report of `check --format json`.
#[derive(Debug, Serialize)]
pub struct CheckReport {
    /// Version of this schema: 1.
    schema: u32,
    /// One entry per argument, in their order.
    files: Vec<FileReport>,
}

/// Report on one graph that the command `check` was given.
#[derive(Debug, Serialize)]
pub struct FileReport {
    /// The argument: a path, or a preset's name.
    file: String,
    /// How many passes run; null where there are errors.
    passes: Option<usize>,
    /// Errors first, in source order.
    diagnostics: Vec<DiagnosticReport>,
}

#[derive(Debug, Serialize)]
struct DiagnosticReport {
    code: &'static str,
    severity: &'static str,
    message: String,
    /// The first is the mistake's own place, others explain; none if it has no place.
    labels: Vec<LabelReport>,
    help: Option<String>,
}

/// A place: lines and columns count from 1, columns in characters, the end is the first character
/// behind.
#[derive(Debug, Serialize)]
struct LabelReport {
    file: String,
    line: usize,
    column: usize,
    end_line: usize,
    end_column: usize,
    text: String,
}

impl FileReport {
    /// Creates the report on the command-line argument `file`. `passes` is the number of passes
    /// that run, `None` if the graph has errors. The report keeps the order of `diagnostics`, which
    /// have errors first.
    pub fn new<'a>(
        file: &str,
        passes: Option<usize>,
        diagnostics: impl IntoIterator<Item = &'a Diagnostic>,
    ) -> Self {
        Self {
            file: file.into(),
            passes,
            diagnostics: diagnostics.into_iter().map(DiagnosticReport::new).collect(),
        }
    }

    /// Creates the report on an argument that names no graph. `message` is its only error.
    pub fn missing(file: &str, message: String) -> Self {
        Self::new(file, None, &[Diagnostic::error(Code::MissingFile, message)])
    }
}

impl CheckReport {
    /// Creates the report of all arguments, in their order.
    pub fn new(files: Vec<FileReport>) -> Self {
        Self { schema: 1, files }
    }
}

impl DiagnosticReport {
    fn new(diagnostic: &Diagnostic) -> Self {
        Self {
            code: diagnostic.code.as_str(),
            severity: match diagnostic.severity {
                Severity::Error => "error",
                Severity::Warning => "warning",
            },
            message: diagnostic.message.clone(),
            labels: diagnostic.labels.iter().map(LabelReport::new).collect(),
            help: diagnostic.help.clone(),
        }
    }
}

impl LabelReport {
    fn new(Label { span, text }: &Label) -> Self {
        let (line, column) = span.line_column();
        let end = span.range.end.max(span.range.start);
        let (end_line, end_column) = span.file.span(end..end).line_column();
        Self {
            file: span.file.name.to_string(),
            line,
            column,
            end_line,
            end_column,
            text: text.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::json;
    use skiagraph_graph::SourceFile;

    #[test]
    fn the_schema_is_pinned() {
        let file = SourceFile::new("größe.ron", "a: \"ü\",\n b: 2");
        let twice = Diagnostic::error(Code::DuplicateName, "two things are called `b`")
            .at(file.span(10..14), "here")
            .at(file.span(0..11), "");
        let warning = Diagnostic::warning(Code::Unused, "no pass uses `ü`").help("remove it");
        let report = CheckReport::new(vec![
            FileReport::new("größe.ron", None, &[twice]),
            FileReport::new("nsm", Some(4), &[warning]),
            FileReport::new("rt", Some(6), &[]),
            FileReport::missing("no.ron", "there is no file `no.ron`".into()),
        ]);
        insta::assert_snapshot!(json::to_text(&report));
    }
}
