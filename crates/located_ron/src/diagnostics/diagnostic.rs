//! One diagnostic: a mistake with its message, its places, and a hint how to mend it.

use super::{code::Code, suggest::suggestion};
use crate::span::Span;

/// Severity of a [`Diagnostic`]. Errors sort before warnings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The file that was read cannot be used.
    Error,
    /// The file that was read can be used, but something in it has no effect or is likely a
    /// mistake.
    Warning,
}

/// A place in a file, with the text that is printed beside it: one of the places that a
/// [`Diagnostic`] is about.
#[derive(Clone, Debug)]
pub struct Label {
    /// Place in the file: a range of its text.
    pub span: Span,
    /// Text that is printed beside the place; may be empty.
    pub text: String,
}

/// A mistake in a file, or something in it that is likely one: its kind, its message, and the
/// places that it is about.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    /// Kind of the mistake, which has a stable name for scripts.
    pub code: Code,
    /// Severity: an error, or a warning with which the file can still be used.
    pub severity: Severity,
    /// Message, which names the thing that is wrong: "unknown field `hieght`".
    pub message: String,
    /// Places that the mistake is about. The first is the mistake's own place; the others explain
    /// it. Empty if the mistake has no place.
    pub labels: Vec<Label>,
    /// Hint how to mend the mistake, which may have several lines; `None` without a hint.
    pub help: Option<String>,
}

impl Diagnostic {
    /// Creates an error of the kind `code`, without places and help. [`at`](Self::at) adds a place,
    /// the method `help` a hint.
    pub fn error(code: Code, message: impl Into<String>) -> Self {
        Self {
            code,
            severity: Severity::Error,
            message: message.into(),
            labels: Vec::new(),
            help: None,
        }
    }

    /// Creates a warning of the kind `code`, without places and help. [`at`](Self::at) adds a
    /// place, the method `help` a hint.
    pub fn warning(code: Code, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Warning,
            ..Self::error(code, message)
        }
    }

    /// Appends a place to [`labels`](Self::labels), with a text to print beside it. The first place
    /// that is added is the mistake's own.
    #[must_use]
    pub fn at(mut self, place: impl Into<Span>, text: impl Into<String>) -> Self {
        self.labels.push(Label {
            span: place.into(),
            text: text.into(),
        });
        self
    }

    /// Appends a place to [`labels`](Self::labels), with a text to print beside it, as
    /// [`at`](Self::at) does; `None` adds nothing.
    #[must_use]
    pub fn at_any(self, place: Option<impl Into<Span>>, text: impl Into<String>) -> Self {
        self.at_all(place.map(|place| (place, text)))
    }

    /// Appends places to [`labels`](Self::labels), each with a text to print beside it.
    #[must_use]
    pub fn at_all<P: Into<Span>, T: Into<String>>(
        self,
        places: impl IntoIterator<Item = (P, T)>,
    ) -> Self {
        let places = places.into_iter();
        places.fold(self, |diagnostic, (place, text)| diagnostic.at(place, text))
    }

    /// Adds another diagnostic as the reason for this mistake. Appends the message of `reason` as a
    /// label at `place`, appends its help to this diagnostic's, and takes over its kind
    /// ([`code`](Self::code)); the places of `reason` are dropped.
    #[must_use]
    pub fn because(self, place: impl Into<Span>, reason: impl Into<Self>) -> Self {
        let reason = reason.into();
        Self {
            code: reason.code,
            ..self.at(place, reason.message).help_any(reason.help)
        }
    }

    /// Appends a hint how to mend the mistake to the field `help`, on a new line after earlier
    /// hints.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Self {
        let text = text.into();
        self.help = Some(match self.help {
            Some(before) => format!("{before}\n{text}"),
            None => text,
        });
        self
    }

    /// Appends a hint how to mend the mistake, as the method `help` does; `None` adds nothing.
    #[must_use]
    pub fn help_any(self, text: Option<impl Into<String>>) -> Self {
        text.into_iter().fold(self, Self::help)
    }

    /// Appends a hint for the misspelt `word`, as [`suggestion`] makes it: "did you mean …?" if a
    /// name in `names` is close, or else a list of the first names in `names`. An empty `names`
    /// adds nothing.
    #[must_use]
    pub fn suggest<S: AsRef<str>>(self, word: &str, names: impl IntoIterator<Item = S>) -> Self {
        self.help_any(suggestion(word, names))
    }

    /// Returns the first place and the message as `FILE:LINE:COLUMN: MESSAGE`, line and column
    /// counted from 1, without the help. Without a place it is only the message.
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
