//! Renders diagnostics for a terminal, with the source lines that they are about (feature
//! `render`).

use super::diagnostic::{Diagnostic, Label, Severity};
use crate::panics::caught;
use crate::span::{SourceFile, Span};
use miette::{GraphicalReportHandler, GraphicalTheme, LabeledSpan, NamedSource};
use std::{fmt, ops::Range};

/// Longest line of which a piece is printed, in bytes: there is no pointing at a word in one that
/// fills a screen, and miette cannot count beyond 65,535 columns.
const LONGEST_LINE: usize = 2000;
/// Returns the diagnostics in `list` as text for a terminal, in their order, each with the source
/// lines that it is about. `colour` adds ANSI colours.
pub fn render(list: &[Diagnostic], colour: bool) -> String {
    let theme = if colour {
        GraphicalTheme::unicode()
    } else {
        GraphicalTheme::unicode_nocolor()
    };
    let handler = GraphicalReportHandler::new_themed(theme)
        .with_width(110)
        .with_links(false);
    let mut text = String::new();
    for diagnostic in list {
        let mut rendered = String::new();
        let report = Report::new(diagnostic);
        // Rendering into a String fails only if a Display implementation does, and miette may
        // panic: then the words must do, with the places in words.
        match caught(|| handler.render_report(&mut rendered, &report)) {
            Ok(Ok(())) => text.push_str(&rendered),
            Ok(Err(_)) | Err(_) => {
                text.push_str(&diagnostic.message);
                for label in &diagnostic.labels {
                    text.push_str(&format!("\n{}: {}", label.span, label.text));
                }
            }
        }
        text.push('\n');
    }
    text
}

/// One diagnostic as miette sees it: labels of the first file on the report itself, those of other
/// files as related notes.
#[derive(Debug)]
struct Report<'a> {
    diagnostic: &'a Diagnostic,
    message: String,
    source: Option<NamedSource<String>>,
    labels: Vec<LabeledSpan>,
    related: Vec<Report<'a>>,
    /// Says only where else to look: code and help stand in the main report.
    is_note: bool,
}

impl<'a> Report<'a> {
    fn new(diagnostic: &'a Diagnostic) -> Self {
        let mut files = diagnostic.labels.iter().map(|label| &label.span.file);
        let first = files.next();
        let mut report = Self::from_file(diagnostic, diagnostic.message.clone(), first);
        let mut files: Vec<_> = files.filter(|file| Some(*file) != first).collect();
        files.sort_by(|a, b| a.name.cmp(&b.name));
        files.dedup();
        for file in files {
            let note = Self::from_file(diagnostic, format!("and in {}", file.name), Some(file));
            report.related.push(Self {
                is_note: true,
                ..note
            });
        }
        report
    }

    fn from_file(
        diagnostic: &'a Diagnostic,
        mut message: String,
        file: Option<&SourceFile>,
    ) -> Self {
        let labels = diagnostic.labels.iter();
        let labels = labels.filter(|label| Some(&label.span.file) == file);
        let mut labels: Vec<&Label> = labels.collect();
        let mut file = file;
        if labels.iter().any(|label| is_too_wide(&label.span)) {
            // The places in words.
            for label in std::mem::take(&mut labels) {
                message.push_str(&format!("\n{}: {}", label.span, label.text));
            }
            file = None;
        }
        let labels = labels
            .into_iter()
            .map(|label| {
                let text = (!label.text.is_empty()).then(|| label.text.clone());
                let range = clamp(&label.span);
                LabeledSpan::new(text, range.start, range.len())
            })
            .collect();
        let source = file.map(|file| NamedSource::new(&*file.name, file.text.to_string()));
        Self {
            diagnostic,
            message,
            source,
            labels,
            related: Vec::new(),
            is_note: false,
        }
    }
}

/// A span that miette can show: inside the text, on character borders.
fn clamp(span: &Span) -> Range<usize> {
    let text = &span.file.text;
    let border = |mut at: usize| {
        at = at.min(text.len());
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        at
    };
    let start = border(span.range.start);
    start..border(span.range.end).max(start)
}

/// True if miette would have to print a line that is too long, or too many lines. It shows a line
/// before and after a label.
fn is_too_wide(span: &Span) -> bool {
    let text = &span.file.text;
    let Range { start, end } = clamp(span);
    let before = text[..start].rsplit('\n').take(2).map(str::len).max();
    let after = text[end..].split('\n').take(2).map(str::len).max();
    let within = end - start;
    let mut lengths = [before, Some(within), after].into_iter().flatten();
    lengths.any(|length| length > LONGEST_LINE)
}

impl fmt::Display for Report<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Report<'_> {}

impl miette::Diagnostic for Report<'_> {
    fn code<'b>(&'b self) -> Option<Box<dyn fmt::Display + 'b>> {
        (!self.is_note).then(|| Box::new(self.diagnostic.code.as_str()) as Box<dyn fmt::Display>)
    }

    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.diagnostic.severity {
            _ if self.is_note => miette::Severity::Advice,
            Severity::Error => miette::Severity::Error,
            Severity::Warning => miette::Severity::Warning,
        })
    }

    fn help<'b>(&'b self) -> Option<Box<dyn fmt::Display + 'b>> {
        let help = self.diagnostic.help.as_ref()?;
        (!self.is_note).then(|| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        let source = self.source.as_ref()?;
        Some(source)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(self.labels.iter().cloned()))
    }

    fn related<'b>(&'b self) -> Option<Box<dyn Iterator<Item = &'b dyn miette::Diagnostic> + 'b>> {
        Some(Box::new(
            self.related
                .iter()
                .map(|report| report as &dyn miette::Diagnostic),
        ))
    }
}
