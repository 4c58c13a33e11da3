//! One mistake: its message, its places, and the way out.

use super::{code::Code, suggest::suggestion};
use crate::span::Span;

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The document cannot be used.
    Error,
    /// The document can be used, but something in it has no effect or is likely a mistake.
    Warning,
}

/// A place and what is to be said about it.
#[derive(Clone, Debug)]
pub struct Label {
    /// The place.
    pub span: Span,
    /// Text of the label; may be empty.
    pub text: String,
}

/// One mistake.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    /// Its kind.
    pub code: Code,
    /// Error or warning.
    pub severity: Severity,
    /// The mistake, with the name of the thing.
    pub message: String,
    /// Where; the first label is the place itself, others explain.
    pub labels: Vec<Label>,
    /// The way out, if there is one.
    pub help: Option<String>,
}

impl Diagnostic {
    /// An error without a place yet.
    pub fn error(code: Code, message: impl Into<String>) -> Self {
        Self {
            code,
            severity: Severity::Error,
            message: message.into(),
            labels: Vec::new(),
            help: None,
        }
    }

    /// A warning without a place yet.
    pub fn warning(code: Code, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Warning,
            ..Self::error(code, message)
        }
    }

    /// Adds a place; the first one added is the mistake's own.
    #[must_use]
    pub fn at(mut self, place: impl Into<Span>, text: impl Into<String>) -> Self {
        self.labels.push(Label {
            span: place.into(),
            text: text.into(),
        });
        self
    }

    /// Adds a place that may not be known.
    #[must_use]
    pub fn at_any(self, place: Option<impl Into<Span>>, text: impl Into<String>) -> Self {
        self.at_all(place.map(|place| (place, text)))
    }

    /// Adds several places.
    #[must_use]
    pub fn at_all<P: Into<Span>, T: Into<String>>(
        self,
        places: impl IntoIterator<Item = (P, T)>,
    ) -> Self {
        let places = places.into_iter();
        places.fold(self, |diagnostic, (place, text)| diagnostic.at(place, text))
    }

    /// Adds the reason, which is a mistake of its own: its kind is this one's.
    #[must_use]
    pub fn because(self, place: impl Into<Span>, reason: impl Into<Self>) -> Self {
        let reason = reason.into();
        Self {
            code: reason.code,
            ..self.at(place, reason.message).help_any(reason.help)
        }
    }

    /// Says what to do, after what was said before.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Self {
        let text = text.into();
        self.help = Some(match self.help {
            Some(before) => format!("{before}\n{text}"),
            None => text,
        });
        self
    }

    /// Says what to do in some cases.
    #[must_use]
    pub fn help_any(self, text: Option<impl Into<String>>) -> Self {
        text.into_iter().fold(self, Self::help)
    }

    /// Adds "did you mean …" if one of `known` is close to `word`, else a list of what there is.
    #[must_use]
    pub fn suggest<S: AsRef<str>>(self, word: &str, known: impl IntoIterator<Item = S>) -> Self {
        self.help_any(suggestion(word, known))
    }

    /// Place and message in a line.
    pub fn brief(&self) -> String {
        match self.labels.first() {
            Some(label) => format!("{}: {}", label.span, self.message),
            None => self.message.clone(),
        }
    }

    /// Key for sorting diagnostics: errors first, then by place.
    pub(super) fn key(&self) -> (Severity, &str, usize) {
        let first = self.labels.first();
        (
            self.severity,
            first.map_or("", |label| &label.span.file.name),
            first.map_or(0, |label| label.span.range.start),
        )
    }
}
