//! Reads RON piece by piece, so that every mistake in a file is found and every name keeps its
//! place.
//!
//! ron stops at its first error, so each list entry and each field of a struct is deserialised by
//! itself from its raw text. A raw value borrows the source, so the difference of their pointers is
//! the value's byte offset.

use crate::diagnostics::{Code, Diagnostic};
use crate::mistakes::{explain, place_of};
use crate::panics::{Panicked, caught};
use crate::span::{Located, SourceFile, Span};
use ron::value::RawValue;
use serde::de::{
    DeserializeOwned, DeserializeSeed, Error as _, MapAccess, SeqAccess, Unexpected, Visitor,
};
use serde::{Deserialize, Deserializer};
use std::{borrow::Cow, cell::RefCell, fmt, ops::Range};

/// The text that is being deserialised on this thread, and the innermost place where it went wrong
/// with what is to be told (outer levels only see a text).
pub(crate) struct Reading {
    pub(crate) file: SourceFile,
    failed: Option<Diagnostic>,
}

/// Remembers a failure, unless one further inside is remembered already.
pub(crate) fn fail(diagnostic: impl FnOnce(&SourceFile) -> Option<Diagnostic>) {
    READING.with_borrow_mut(|reading| {
        if let Some(reading) = reading
            && reading.failed.is_none()
        {
            reading.failed = diagnostic(&reading.file);
        }
    });
}

/// Returns a serde error that stands for `mistake`. For use in implementations of `Deserialize`,
/// which return it. The function that reads the [`Node`], such as [`Node::parse`], then returns
/// `mistake` with its places, not just the text of the serde error.
pub fn refuse<E: serde::de::Error>(mistake: impl Into<Diagnostic>) -> E {
    let diagnostic = mistake.into();
    let message = diagnostic.message.clone();
    fail(|_| Some(diagnostic));
    E::custom(message)
}

thread_local! {
    // serde hands a `Deserialize` implementation no context; this is the context.
    pub(crate) static READING: RefCell<Option<Reading>> = const { RefCell::new(None) };
}

pub(crate) fn options() -> ron::Options {
    ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
}

/// The text of a value without the white space and comments around it. A line comment that lost its
/// newline would not end.
fn bare(raw: &RawValue) -> &str {
    raw.trim().get_ron()
}

/// Byte range of `part` in the text being read, if it is part of it.
fn range_in(text: &str, part: &str) -> Option<Range<usize>> {
    let start = (part.as_ptr() as usize).checked_sub(text.as_ptr() as usize)?;
    (start + part.len() <= text.len()).then(|| start..start + part.len())
}

/// Deserialises `text`, a part of the file being read, and remembers the innermost place of a
/// failure.
fn read_part<T: DeserializeOwned>(text: &str) -> Result<T, ron::Error> {
    options().from_str(text).map_err(|error| {
        fail(|file| {
            let whole = range_in(&file.text, text)?;
            let place = place_of(text, &error, whole.start);
            Some(explain(&error.code, file.span(place)))
        });
        error.code
    })
}

/// Returns the text of a value as it is written, without space and comments around it, and its
/// place in the file that is being read. For use in implementations of `Deserialize`.
///
/// # Errors
/// If the value is not well-formed RON, or is not read through a [`Node`], for example by
/// [`Node::parse`] or [`from_fields`](crate::fields::from_fields).
pub fn raw<'de, D: Deserializer<'de>>(deserializer: D) -> Result<(&'de str, Span), D::Error> {
    let text = bare(<&RawValue>::deserialize(deserializer)?);
    let span = READING.with_borrow(|reading| {
        let reading = reading.as_ref()?;
        Some(reading.file.span(range_in(&reading.file.text, text)?))
    });
    let outside = || D::Error::custom("a value with a place outside a document");
    Ok((text, span.ok_or_else(outside)?))
}

/// Deserialises a value from a text that [`raw`] returned. For use in implementations of
/// `Deserialize`.
///
/// # Errors
/// If the text cannot be read as a `T`. The diagnostic of the [`Node`] that is being read points at
/// the innermost place that failed.
pub fn read<T: DeserializeOwned, E: serde::de::Error>(text: &str) -> Result<T, E> {
    read_part(text).map_err(E::custom)
}

impl<'de, T: DeserializeOwned> Deserialize<'de> for Located<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let (text, span) = raw(deserializer)?;
        let value = read(text)?;
        Ok(Self { value, span })
    }
}

/// A RON value that is not read yet: its place in a file. Its methods split the text at this place,
/// or deserialise it.
pub type Node = Span;

/// A field of a RON struct, `name: value`, whose value is not read yet.
#[derive(Clone, Debug)]
pub struct Field {
    /// Name of the struct's field, with its place in the file.
    pub name: Located<String>,
    /// Value of the struct's field, which is not read yet: its place in the file.
    pub node: Node,
}

impl Node {
    /// Returns the node of the whole text of `file`.
    pub fn root(file: &SourceFile) -> Self {
        file.span(0..file.text.len())
    }

    /// Returns the place of the first line of the node's text, for diagnostics about a node of many
    /// lines.
    pub fn head(&self) -> Span {
        let start = self.range.start;
        let length = self.text().lines().next().map_or(0, str::len);
        self.file.span(start..start + length)
    }

    fn sub(&self, part: &str) -> Node {
        let range = range_in(&self.file.text, part).unwrap_or(self.range.clone());
        self.file.span(range)
    }

    /// Deserialises the node's text, RON, as a `T`.
    ///
    /// # Errors
    /// The first mistake as a diagnostic, at the innermost place that failed.
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T, Diagnostic> {
        self.reading(|| read_part(self.text()))
    }

    pub(crate) fn reading<T>(
        &self,
        read: impl FnOnce() -> Result<T, ron::Error>,
    ) -> Result<T, Diagnostic> {
        READING.set(Some(Reading {
            file: self.file.clone(),
            failed: None,
        }));
        let result = caught(read);
        let failed = READING.take().and_then(|reading| reading.failed);
        self.without_panic(result)?
            .map_err(|error| failed.unwrap_or_else(|| explain(&error, self.clone())))
    }

    /// A panic of ron's as a diagnostic at the piece that it read.
    fn without_panic<T>(&self, result: Result<T, Panicked>) -> Result<T, Diagnostic> {
        result.map_err(|panicked| {
            let what = format!("ron panics while this is read: {}", panicked.message);
            Diagnostic::error(Code::LibraryPanic, what)
                .at(self, "this brings it about")
                .help(panicked.way_out())
        })
    }

    /// Returns a node for each entry of a list, `[…]`, or of a tuple, `(…)`, in the order of the
    /// text.
    ///
    /// # Errors
    /// If the node is neither a list nor a tuple, or is not well-formed.
    pub fn list(&self) -> Result<Vec<Node>, Diagnostic> {
        // A tuple of one name looks like a struct to ron.
        let parts = self.parts(Shape::List)?.into_iter();
        Ok(parts.map(|(_, part)| self.sub(part)).collect())
    }

    /// Returns the entries of a map, `{"name": value}`, in the order of the text: each name, and
    /// the node of its value. A name that is given twice is returned twice.
    ///
    /// # Errors
    /// If the node is not a map of names, or is not well-formed.
    pub fn map(&self) -> Result<Vec<(Located<String>, Node)>, Diagnostic> {
        let entry = |(key, value): (Cow<'_, str>, _)| {
            let key = self.sub(&key);
            let name: String = key.parse()?;
            Ok((Located::new(name, key), self.sub(value)))
        };
        self.parts(Shape::Map)?.into_iter().map(entry).collect()
    }

    /// Returns the fields of a struct, `(name: value, …)`, in the order of the text. A field that
    /// is given twice is returned twice.
    ///
    /// # Errors
    /// If the node is not a struct with named fields, or is not well-formed.
    pub fn fields(&self) -> Result<Vec<Field>, Diagnostic> {
        let field = |(name, value): (Cow<'_, str>, _)| {
            let node = self.sub(value);
            let span = self.key_span(&name, &node);
            let name = Located::new(name.into_owned(), span);
            Field { name, node }
        };
        let parts = self.parts(Shape::Fields)?.into_iter();
        Ok(parts.map(field).collect())
    }

    fn parts(&self, shape: Shape) -> Result<Parts<'_>, Diagnostic> {
        self.without_panic(caught(|| options().from_str_seed(self.text(), shape)))?
            .map_err(|error| {
                let range = place_of(self.text(), &error, self.range.start);
                explain(&error.code, self.file.span(range))
            })
    }

    /// The place of the field name that stands before `value`.
    fn key_span(&self, name: &str, value: &Node) -> Span {
        let before = &self.file.text[self.range.start..value.range.start];
        match before.rfind(name) {
            Some(at) => {
                let start = self.range.start + at;
                self.file.span(start..start + name.len())
            }
            None => value.clone(),
        }
    }

    /// Splits the text of an enum variant `Tag(…)` into the tag and the node of its body, `(…)`; of
    /// a bare `Tag` the body is empty. The body is not checked. Returns `None` if the text does not
    /// begin with a letter.
    pub fn variant(&self) -> Option<(Located<String>, Node)> {
        let text = self.text();
        let end = text.find(|c: char| !c.is_alphanumeric() && c != '_');
        let length = end.unwrap_or(text.len());
        if !text.starts_with(|c: char| c.is_alphabetic()) {
            return None;
        }
        let (start, end) = (self.range.start, self.range.end);
        let tag = self.file.span(start..start + length);
        let body = self.file.span(start + length..end);
        Some((Located::new(text[..length].to_owned(), tag), body))
    }
}

/// Raw texts of values, each with what stands before it: a name, the raw text of a key, nothing.
type Parts<'de> = Vec<(Cow<'de, str>, &'de str)>;

/// A value that is split into its parts.
#[derive(Clone, Copy)]
enum Shape {
    List,
    Map,
    Fields,
}

impl<'de> DeserializeSeed<'de> for Shape {
    type Value = Parts<'de>;
    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Parts<'de>, D::Error> {
        match self {
            Self::Map => deserializer.deserialize_map(self),
            Self::List | Self::Fields => deserializer.deserialize_any(self),
        }
    }
}

impl<'de> Visitor<'de> for Shape {
    type Value = Parts<'de>;
    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::List => "a list `[a, b]`",
            Self::Map => "a map of names, `{\"a\": …}`",
            Self::Fields => "a struct with named fields, `(name: value, …)`",
        })
    }
    fn visit_unit<E: serde::de::Error>(self) -> Result<Parts<'de>, E> {
        match self {
            Self::Fields => Ok(Vec::new()),
            _ => Err(E::invalid_type(Unexpected::Unit, &self)),
        }
    }
    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Parts<'de>, A::Error> {
        let Self::List = self else {
            return Err(A::Error::invalid_type(Unexpected::Seq, &self));
        };
        let mut parts = Vec::new();
        while let Some(entry) = seq.next_element()? {
            parts.push((Cow::Borrowed(""), bare(entry)));
        }
        Ok(parts)
    }
    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Parts<'de>, A::Error> {
        let mut parts = Vec::new();
        while let Some(key) = match self {
            Self::Map => map.next_key()?.map(|key| Cow::Borrowed(bare(key))),
            Self::Fields => map.next_key()?.map(|Word(name)| Cow::Owned(name)),
            Self::List => return Err(A::Error::invalid_type(Unexpected::Map, &self)),
        } {
            parts.push((key, bare(map.next_value()?)));
        }
        Ok(parts)
    }
}

/// A key of a struct or a map, identifier or string.
struct Word(String);
impl<'de> Deserialize<'de> for Word {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Identifier;
        impl Visitor<'_> for Identifier {
            type Value = Word;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a field name")
            }
            fn visit_str<E>(self, name: &str) -> Result<Word, E> {
                Ok(Word(name.to_owned()))
            }
        }
        deserializer.deserialize_identifier(Identifier)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Panics as it is read, in the place of a library that does.
    #[derive(Debug)]
    struct Panics;

    impl<'de> Deserialize<'de> for Panics {
        fn deserialize<D: Deserializer<'de>>(_: D) -> Result<Self, D::Error> {
            panic!("no value today")
        }
    }

    #[test]
    fn a_panic_is_a_diagnostic_at_its_piece() {
        let node = || SourceFile::new("graph.ron", "(a: 1)").span(4..5);
        let diagnostic = node().parse::<Panics>().expect_err("it panics");
        assert_eq!(diagnostic.code, Code::LibraryPanic);
        assert!(
            diagnostic.message.contains("no value today"),
            "{diagnostic:?}"
        );
        assert_eq!(diagnostic.labels[0].span.range, 4..5);
        // Later reads work as before.
        assert_eq!(node().parse::<u32>().ok(), Some(1));
    }
}
