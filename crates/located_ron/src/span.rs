//! Files that were read, and places in them.

use std::{
    fmt,
    ops::{Deref, Range},
    sync::Arc,
};

/// A file that was read. Cheap to clone, and small: every name of a document knows its place.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SourceFile(Arc<SourceText>);

/// Name and text of a [`SourceFile`].
#[derive(Debug, Default, PartialEq, Eq)]
pub struct SourceText {
    /// Path as the reader was given it.
    pub name: Arc<str>,
    /// Whole text.
    pub text: Arc<str>,
}

impl SourceFile {
    /// A file of that name and text.
    pub fn new(name: impl Into<Arc<str>>, text: impl Into<Arc<str>>) -> Self {
        Self(Arc::new(SourceText {
            name: name.into(),
            text: text.into(),
        }))
    }

    /// The place of `range` (bytes) in this file.
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

/// A place in a file.
#[derive(Clone, PartialEq, Eq)]
pub struct Span {
    /// The file.
    pub file: SourceFile,
    /// Bytes of its text.
    pub range: Range<usize>,
}

impl Span {
    /// The text that stands there.
    pub fn text(&self) -> &str {
        self.file.text.get(self.range.clone()).unwrap_or("")
    }

    /// Line and column of the start, counted from 1, columns in characters.
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

/// A value that knows where it stands.
#[derive(Clone, PartialEq)]
pub struct Located<T> {
    /// The value.
    pub value: T,
    /// Its place.
    pub span: Span,
}

impl<T> Located<T> {
    /// A value at a place.
    pub fn new(value: T, span: Span) -> Self {
        Self { value, span }
    }
}

impl<T: fmt::Display> Located<T> {
    /// The value as text, at its place.
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
