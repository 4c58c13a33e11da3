//! Reads RON piece by piece, so that every mistake in a file is found and every name keeps its
//! place.
//!
//! ron stops at its first error, so each list entry and each field of a struct is deserialised by
//! itself from its raw text. A raw value borrows the source, so the difference of their pointers is
//! the value's byte offset.

use crate::{
    diagnostics::{Code, Diagnostic},
    panics::{Panicked, caught},
    span::{Located, SourceFile, Span},
};
use ron::value::RawValue;
use serde::{
    Deserialize, Deserializer,
    de::{
        DeserializeOwned, DeserializeSeed, Error as _, IntoDeserializer, MapAccess, SeqAccess,
        Unexpected, Visitor, value::MapAccessDeserializer,
    },
};
use std::{
    borrow::Cow,
    cell::{Cell, RefCell},
    collections::HashSet,
    fmt,
    iter::Enumerate,
    ops::Range,
    slice,
};

/// The text that is being deserialised on this thread, and the innermost place where it went wrong
/// with what is to be told (outer levels only see a text).
struct Reading {
    file: SourceFile,
    failed: Option<Diagnostic>,
}

/// Remembers a failure, unless one further inside is remembered already.
fn fail(diagnostic: impl FnOnce(&SourceFile) -> Option<Diagnostic>) {
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
    static READING: RefCell<Option<Reading>> = const { RefCell::new(None) };
}

fn options() -> ron::Options {
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

/// Returns the place of a ron error, in bytes: `text` begins at `base`.
fn place_of(text: &str, error: &ron::error::SpannedError, base: usize) -> Range<usize> {
    // Such a mistake is the whole value's; ron stands at its end.
    if let ron::Error::Message(_) = error.code {
        return base..base + text.lines().next().map_or(0, str::len);
    }
    let start = offset(text, error.span.start.line, error.span.start.col);
    let end = offset(text, error.span.end.line, error.span.end.col).max(start);
    // ron reports the end of a bad word as its place; a word is what the reader wants to see.
    word_around(text, start, end, base)
}

fn offset(text: &str, line: usize, column: usize) -> usize {
    let lines = text.split_inclusive('\n').take(line.saturating_sub(1));
    let start: usize = lines.map(str::len).sum();
    let rest = text.get(start..).unwrap_or("");
    let mut characters = rest.char_indices();
    let before = characters.nth(column.saturating_sub(1));
    start + before.map_or(rest.len(), |(at, _)| at)
}

fn word_around(text: &str, start: usize, end: usize, base: usize) -> Range<usize> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == '"';
    let mut low = start.min(text.len());
    if low == end {
        low = text[..low].trim_end_matches(is_word).len();
    }
    let high = end.min(text.len()).max(low);
    let rest = text[high..].trim_start_matches(is_word);
    base + low..base + text.len() - rest.len()
}

/// Returns the text of a value as it is written, without space and comments around it, and its
/// place in the file that is being read. For use in implementations of `Deserialize`.
///
/// # Errors
/// If the value is not well-formed RON, or is not read through a [`Node`], for example by
/// [`Node::parse`] or [`from_fields`].
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

    fn reading<T>(&self, read: impl FnOnce() -> Result<T, ron::Error>) -> Result<T, Diagnostic> {
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

/// Deserialises a struct from fields that [`Node::fields`] returned, each from its own text.
/// `whole` is the place of the struct, where a missing field is reported.
///
/// # Errors
/// The first mistake as a diagnostic at its place: an unknown field (if `T` denies unknown fields),
/// a missing or duplicate field, or a value of the wrong type.
pub fn from_fields<T: DeserializeOwned>(fields: &[Field], whole: &Span) -> Result<T, Diagnostic> {
    from_some_fields(fields, whole, &[])
}

/// Deserialises a struct as [`from_fields`] does, from fields of which the caller has removed some
/// that the struct does not have. `more` holds the names of the removed fields, so that the
/// suggestion for a misspelt field knows them, too.
///
/// # Errors
/// The errors of [`from_fields`].
pub fn from_some_fields<T: DeserializeOwned>(
    fields: &[Field],
    whole: &Span,
    more: &[&str],
) -> Result<T, Diagnostic> {
    // ron would report it before it has the place of the second one.
    let mut seen = HashSet::new();
    let mut names = fields.iter().map(|field| &field.name);
    match names.find(|name| !seen.insert(name.as_str())) {
        Some(twice) => Err(field_twice(twice)),
        None => read_fields(fields, whole, more, &Fault::default()),
    }
}

/// Deserialises a struct as [`from_some_fields`] does, but appends an entry to `diagnostics` for
/// every unknown or duplicate field and every field that cannot be read, not only for the first. If
/// no other mistake is the cause, a missing field is reported, too. Returns `None` if a field is
/// unknown, missing or cannot be read. Of a duplicate field the first is read.
pub fn from_all_fields<T: DeserializeOwned>(
    mut fields: Vec<Field>,
    whole: &Span,
    more: &[&str],
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<T> {
    let mut seen = HashSet::new();
    fields.retain(|field| {
        let is_first = seen.insert(field.name.value.clone());
        diagnostics.extend((!is_first).then(|| field_twice(&field.name)));
        is_first
    });
    let (mut left_out, mut is_misspelt) = (HashSet::new(), false);
    loop {
        let fault = Fault::default();
        let error = match read_fields(&fields, whole, more, &fault) {
            Ok(value) => return left_out.is_empty().then_some(value),
            Err(error) => error,
        };
        match (fault.field.get(), fault.missing.get()) {
            (Some((index, is_name)), _) => {
                is_misspelt |= is_name;
                left_out.insert(fields.remove(index).name.value);
                diagnostics.push(error);
            }
            // It is then the misspelt one, or one that could not be read.
            (None, Some(missing)) if is_misspelt || left_out.contains(missing) => return None,
            (None, _) => {
                diagnostics.push(error);
                return None;
            }
        }
    }
}

/// The part of a struct that could not be read.
#[derive(Default)]
struct Fault {
    /// Number of the field, and whether it is its name.
    field: Cell<Option<(usize, bool)>>,
    /// Field that is not there.
    missing: Cell<Option<&'static str>>,
}

fn read_fields<T: DeserializeOwned>(
    fields: &[Field],
    whole: &Span,
    more: &[&str],
    fault: &Fault,
) -> Result<T, Diagnostic> {
    whole.reading(|| {
        let fields = fields.iter().enumerate();
        let access = Access {
            fields,
            value: None,
            more,
            fault,
        };
        T::deserialize(MapAccessDeserializer::new(access)).inspect_err(|error| {
            if let ron::Error::MissingStructField { field, .. } = error {
                fault.missing.set(Some(field));
            }
        })
    })
}

/// Fields for serde.
struct Access<'a> {
    fields: Enumerate<slice::Iter<'a, Field>>,
    value: Option<(usize, &'a Field)>,
    more: &'a [&'a str],
    fault: &'a Fault,
}

impl<'de> MapAccess<'de> for Access<'de> {
    type Error = ron::Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, ron::Error> {
        self.value = self.fields.next();
        let Some((index, field)) = self.value else {
            return Ok(None);
        };
        let name: &str = &field.name.value;
        let key = seed.deserialize(IntoDeserializer::<ron::Error>::into_deserializer(name));
        key.map(Some).inspect_err(|error| {
            self.fault.field.set(Some((index, true)));
            fail(|_| {
                Some(match error {
                    ron::Error::NoSuchStructField { expected, .. } => {
                        unknown_field(&field.name, expected.iter().chain(self.more))
                    }
                    error => explain(error, field.name.span.clone()),
                })
            });
        })
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(
        &mut self,
        seed: V,
    ) -> Result<V::Value, ron::Error> {
        let without_key = || ron::Error::custom("a value without its key");
        let (index, field) = self.value.take().ok_or_else(without_key)?;
        // An extended document's field stands in that one's file.
        let text = field.node.text();
        let file = field.node.file.clone();
        READING.with_borrow_mut(|reading| {
            if let Some(reading) = reading {
                reading.file = file;
            }
        });
        options().from_str_seed(text, seed).map_err(|error| {
            self.fault.field.set(Some((index, false)));
            fail(|file| {
                let place = place_of(text, &error, field.node.range.start);
                Some(explain(&error.code, file.span(place)))
            });
            error.code
        })
    }
}

/// Returns the error [`Code::UnknownField`] for a field whose name is not in `fields`, at the place
/// of the name. Its help is the [suggestion](crate::diagnostics::suggestion) of a name in `fields`.
pub fn unknown_field<S: AsRef<str>>(
    name: &Located<String>,
    fields: impl IntoIterator<Item = S>,
) -> Diagnostic {
    Diagnostic::error(Code::UnknownField, format!("unknown field `{name}`"))
        .at(name, "not a field of this")
        .suggest(name, fields)
}

/// Returns the error [`Code::UnknownVariant`] for a word, such as the name of an enum variant, that
/// is not in `words`, at the place of the word. Its help is the
/// [suggestion](crate::diagnostics::suggestion) of a word in `words`.
pub fn unknown_word<S: AsRef<str>>(
    word: &Located<String>,
    words: impl IntoIterator<Item = S>,
) -> Diagnostic {
    Diagnostic::error(Code::UnknownVariant, format!("unknown word `{word}`"))
        .at(word, "not one of the words that may stand here")
        .suggest(word, words)
}

/// Returns the error [`Code::MissingField`] for the required field `field` that is missing in the
/// struct at `place`; the error points at `place`.
pub fn missing_field(place: impl Into<Span>, field: &str) -> Diagnostic {
    let what = format!("the field `{field}` is missing");
    Diagnostic::error(Code::MissingField, what).at(place, "it must be given here")
}

/// Returns the error [`Code::DuplicateName`] for a field that is given twice in a struct. `field`
/// is the name where it is given the second time, at which the error points.
pub fn field_twice(field: &Located<String>) -> Diagnostic {
    let what = format!("the field `{field}` is given twice");
    Diagnostic::error(Code::DuplicateName, what).at(field, "the second one")
}

/// The bracket that a text does not close: its place, the sign that closes it, and the place of a
/// closing bracket of another kind that stands instead; `None` of that at the end of the text.
fn unclosed(text: &str) -> Option<(usize, char, Option<usize>)> {
    let mut open: Vec<(usize, char)> = Vec::new();
    let mut at = 0;
    while let Some(sign) = text[at..].chars().next() {
        let rest = &text[at..];
        let closes = match sign {
            '(' => ')',
            '[' => ']',
            _ => '}',
        };
        at += match sign {
            '"' => {
                let mut is_escaped = false;
                let is_end = |c: char| {
                    let is_end = c == '"' && !is_escaped;
                    is_escaped = c == '\\' && !is_escaped;
                    is_end
                };
                rest[1..].find(is_end)? + 2
            }
            '/' if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
            '/' if rest.starts_with("/*") => rest.find("*/")? + 2,
            '(' | '[' | '{' => {
                open.push((at, closes));
                1
            }
            ')' | ']' | '}' => match open.pop()? {
                (_, expected) if expected == sign => 1,
                (opened, closing) => return Some((opened, closing, Some(at))),
            },
            _ => sign.len_utf8(),
        };
    }
    open.pop().map(|(opened, closing)| (opened, closing, None))
}

/// A syntax error of a file in which a bracket is not closed; `None` if all are.
fn open_bracket(file: &SourceFile) -> Option<Diagnostic> {
    let (opened, closing, instead) = unclosed(&file.text)?;
    let place = |at: usize| file.span(at..at + 1);
    let what = format!("`{}` is not closed", &file.text[opened..=opened]);
    let missing = format!("here `{closing}` is missing, or above");
    let error = Diagnostic::error(Code::Syntax, what).at(place(opened), "opened here");
    let error = error.at_any(instead.map(place), missing);
    Some(error.help(format!("close it with `{closing}`")))
}

/// A ron error in our words.
fn explain(error: &ron::Error, span: Span) -> Diagnostic {
    use ron::Error as R;
    let syntax = |what: String| Diagnostic::error(Code::Syntax, what);
    let what = match error {
        R::NoSuchStructField {
            expected,
            found: field,
            ..
        } => return unknown_field(&Located::new(field.clone(), span), *expected),
        R::NoSuchEnumVariant {
            expected,
            found: word,
            ..
        } => return unknown_word(&Located::new(word.clone(), span), *expected),
        R::MissingStructField { field, .. } => return missing_field(span, field),
        R::DuplicateStructField { field, .. } => {
            return field_twice(&Located::new(field.to_string(), span));
        }
        R::Eof => {
            return open_bracket(&span.file).unwrap_or_else(|| {
                syntax("the text ends too early".to_owned())
                    .at(span, "something is not closed")
                    .help("check that every bracket and quote is closed")
            });
        }
        R::ExceededRecursionLimit => {
            return syntax("values are nested too deep".to_owned())
                .at(span, "")
                .help(
                    "no document needs so many brackets in brackets: is one of them never closed?",
                );
        }
        R::ExpectedString => "a text in quotes",
        R::ExpectedArray => "a list `[…]`",
        R::ExpectedMap => "a map `{…}`",
        // A tuple's first value stands where the name of a field is read.
        R::ExpectedStructLike
        | R::ExpectedNamedStructLike(_)
        | R::ExpectedIdentifier
        | R::SuggestRawIdentifier(_) => "what has fields, `(name: …)`,",
        R::ExpectedDifferentLength {
            expected,
            found: length,
        } => {
            let count = expected.trim_start_matches(|c: char| !c.is_ascii_digit());
            let what = format!("{count} values are needed here, not {length}");
            return syntax(what).at(span, "here");
        }
        R::ExpectedBoolean => "`true` or `false`",
        R::ExpectedInteger | R::ExpectedFloat => "a number",
        R::InvalidValueForType { expected, .. } => expected,
        other => {
            let is_unclosed = matches!(
                other,
                R::ExpectedArrayEnd
                    | R::ExpectedComma
                    | R::ExpectedMapEnd
                    | R::ExpectedOptionEnd
                    | R::ExpectedStructLikeEnd
                    | R::UnexpectedChar(_)
            );
            let unclosed = is_unclosed.then(|| open_bracket(&span.file)).flatten();
            return unclosed
                .unwrap_or_else(|| syntax(lower_first(&other.to_string())).at(span, "here"));
        }
    };
    syntax(format!("{what} is needed")).at(span, "here")
}

fn lower_first(text: &str) -> String {
    let mut characters = text.chars();
    match characters.next() {
        Some(first) => first.to_lowercase().chain(characters).collect(),
        None => String::new(),
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
