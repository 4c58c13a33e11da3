//! Source files, and places in them.

use std::fmt;
use std::ops::{Deref, Range};
use std::sync::Arc;

/// Path and text of a source file, which places ([`Span`]) refer to. Clones share one text and are
/// cheap.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SourceFile(Arc<SourceText>);

/// Path and text of a [`SourceFile`].
#[derive(Debug, Default, PartialEq, Eq)]
pub struct SourceText {
    /// Path of the file, as it was given to [`SourceFile::new`]; it need not exist on disk.
    pub name: Arc<str>,
    /// Text of the source file, without a byte order mark at its start.
    pub text: Arc<str>,
}

impl SourceFile {
    /// Creates a source file from its path, `name`, and its text, of which a byte order mark at the
    /// start is left out; nothing is read from disk.
    pub fn new(name: impl Into<Arc<str>>, text: impl Into<Arc<str>>) -> Self {
        let (name, text) = (name.into(), text.into());
        // Some editors begin UTF-8 with a byte order mark.
        let text = match text.trim_start_matches('\u{feff}') {
            rest if rest.len() < text.len() => rest.into(),
            _ => text,
        };
        Self(Arc::new(SourceText { name, text }))
    }

    /// Returns the place of the byte range `range` of this file's text. The range is not checked.
    pub fn span(&self, range: Range<usize>) -> Span {
        Span {
            file: self.clone(),
            range,
        }
    }
}

impl Deref for SourceFile {
    type Target = SourceText;
    fn deref(&self) -> &SourceText {
        &self.0
    }
}

/// A place in a file: a range of bytes of its text. Printed it is `FILE:LINE:COLUMN`, line and
/// column counted from 1.
#[derive(Clone, PartialEq, Eq)]
pub struct Span {
    /// File that the place lies in.
    pub file: SourceFile,
    /// Range of bytes in the file's text, the end excluded.
    pub range: Range<usize>,
}

impl Span {
    /// Returns the text at this place; empty if the range lies outside of the file's text or cuts a
    /// character.
    pub fn text(&self) -> &str {
        self.file.text.get(self.range.clone()).unwrap_or("")
    }

    /// Returns the line and column of the start of the place, both counted from 1; columns count
    /// characters, not bytes. A start outside of the text counts as its end.
    pub fn line_column(&self) -> (usize, usize) {
        let before = self
            .file
            .text
            .get(..self.range.start)
            .unwrap_or(&self.file.text);
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
        (line, column)
    }
}

impl fmt::Display for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (line, column) = self.line_column();
        write!(f, "{}:{line}:{column}", self.file.name)
    }
}

impl fmt::Debug for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

impl From<&Span> for Span {
    fn from(span: &Span) -> Self {
        span.clone()
    }
}

/// A value together with its place in a source file.
#[derive(Clone, PartialEq)]
pub struct Located<T> {
    /// The value that was read from the file.
    pub value: T,
    /// Place of the value in its file.
    pub span: Span,
}

impl<T> Located<T> {
    /// Creates a located value from a value and its place.
    pub fn new(value: T, span: Span) -> Self {
        Self { value, span }
    }
}

impl<T: fmt::Display> Located<T> {
    /// Returns the value formatted as text by `Display`, with the same place.
    pub fn text(&self) -> Located<String> {
        Located::new(self.value.to_string(), self.span.clone())
    }
}

impl<T> Deref for Located<T> {
    type Target = T;
    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T> From<Located<T>> for Span {
    fn from(located: Located<T>) -> Self {
        located.span
    }
}

impl<T> From<&Located<T>> for Span {
    fn from(located: &Located<T>) -> Self {
        located.span.clone()
    }
}

impl<T: fmt::Display> fmt::Display for Located<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.value.fmt(f)
    }
}

impl<T: fmt::Debug> fmt::Debug for Located<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.value.fmt(f)
    }
}
