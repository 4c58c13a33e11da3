//! The schema of `check --format json`, version 1. Editors and scripts rely on it: extend it, rename nothing.

use serde::Serialize;
use skiagraph_graph::{Code, Diagnostic, Label, Severity};

/// What `check` found.
#[derive(Debug, Serialize)]
pub struct CheckReport {
    /// Version of this schema: 1.
    schema: u32,
    /// One entry per argument, in their order.
    files: Vec<FileReport>,
}

/// One graph.
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

/// A place: lines and columns count from 1, columns in characters, the end is the first character behind.
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
    /// Of a graph that can be planned, with its warnings.
    pub fn fine<'a>(
        file: &str,
        passes: usize,
        warnings: impl Iterator<Item = &'a Diagnostic>,
    ) -> Self {
        Self {
            file: file.into(),
            passes: Some(passes),
            diagnostics: warnings.map(DiagnosticReport::new).collect(),
        }
    }

    /// Of a graph with errors.
    pub fn faulty<'a>(file: &str, diagnostics: impl Iterator<Item = &'a Diagnostic>) -> Self {
        Self {
            file: file.into(),
            passes: None,
            diagnostics: diagnostics.map(DiagnosticReport::new).collect(),
        }
    }

    /// Of an argument that names no graph.
    pub fn missing(file: &str, message: String) -> Self {
        let error = Diagnostic::error(Code::MissingFile, message);
        Self::faulty(file, [error].iter())
    }
}

impl CheckReport {
    /// Of all arguments.
    pub fn new(files: Vec<FileReport>) -> Self {
        Self { schema: 1, files }
    }

    /// What is printed.
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self)
            .expect("plain structs with string keys always serialise");
        text.push('\n');
        text
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
    use skiagraph_graph::SourceFile;

    #[test]
    fn the_schema_is_pinned() {
        let file = SourceFile::new("größe.ron", "a: \"ü\",\n b: 2");
        let twice = Diagnostic::error(Code::DuplicateName, "two things are called `b`")
            .at(file.span(10..14), "here")
            .at(file.span(0..11), "");
        let warning = Diagnostic::warning(Code::Unused, "no pass uses `ü`").help("remove it");
        let report = CheckReport::new(vec![
            FileReport::faulty("größe.ron", [twice].iter()),
            FileReport::fine("nsm", 4, [warning].iter()),
            FileReport::fine("rt", 6, [].iter()),
            FileReport::missing("no.ron", "there is no file `no.ron`".into()),
        ]);
        insta::assert_snapshot!(report.to_json());
    }
}
