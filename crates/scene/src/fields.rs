//! RON read field by field, so that one mistake does not hide the next.

use crate::error::{SceneError, SceneMistake};
use ron::{Error as RonError, error::SpannedError, value::RawValue};
use serde::{
    Deserialize, Deserializer,
    de::{
        DeserializeOwned, DeserializeSeed, Error, IntoDeserializer, MapAccess, Visitor,
        value::MapAccessDeserializer,
    },
};
use std::{cell::RefCell, collections::HashSet, fmt, iter::Enumerate, slice};

/// A field as it stands in the text: its name and its value, both parts of that text.
pub(crate) type Field<'a> = (&'a str, &'a str);

/// A text, and what is wrong with it so far. Parts of it are handed about as slices: their address
/// tells where they stand.
pub(crate) struct Reader<'a> {
    text: &'a str,
    mistakes: Vec<(usize, String)>,
}

impl<'a> Reader<'a> {
    pub fn new(text: &'a str) -> Self {
        Self {
            text,
            mistakes: Vec::new(),
        }
    }

    /// Says that something is wrong where `part` begins.
    pub fn wrong(&mut self, part: &str, reason: impl Into<String>) {
        self.wrong_at(part, 0, reason.into());
    }

    fn wrong_at(&mut self, part: &str, offset: usize, reason: String) {
        let at = (part.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize);
        self.mistakes.push((at + offset, reason));
    }

    fn explain(&mut self, part: &str, error: &SpannedError) {
        self.wrong_at(part, place(part, error), words(&error.code));
    }

    /// The value, if nothing was wrong.
    pub fn finish<T>(mut self, file: &str, value: Option<T>) -> Result<T, SceneError> {
        if let Some(value) = value.filter(|_| self.mistakes.is_empty()) {
            return Ok(value);
        }
        self.mistakes.sort_by_key(|(at, _)| *at);
        let mistakes = self.mistakes.into_iter().map(|(at, reason)| {
            let before = self.text.get(..at).unwrap_or(self.text);
            let line = before.rsplit('\n').next().unwrap_or("");
            SceneMistake {
                line: before.matches('\n').count() + 1,
                column: line.chars().count() + 1,
                reason,
            }
        });
        Err(SceneError::SceneFile {
            file: file.to_owned(),
            mistakes: mistakes.collect(),
        })
    }

    /// The fields of `(name: …, …)`, each once.
    pub fn fields(&mut self, part: &'a str) -> Option<Vec<Field<'a>>> {
        let read: Result<Fields<'a>, _> = options().from_str(part);
        let fields = match read {
            Ok(Fields(fields)) => fields,
            Err(error) => {
                self.explain(part, &error);
                return None;
            }
        };
        let mut from = 0;
        let mut seen = HashSet::new();
        let mut once = Vec::new();
        for (name, value) in fields {
            // ron hands out names as copies; this one stands right before its value.
            let end = value.as_ptr() as usize - part.as_ptr() as usize;
            let at = part[from..end].rfind(&name).map_or(end, |at| from + at);
            let name = &part[at..(at + name.len()).min(end.max(at))];
            from = end + value.len();
            if seen.insert(name) {
                once.push((name, value))
            } else {
                self.wrong(name, format!("the field `{name}` is given twice"))
            }
        }
        Some(once)
    }

    /// The items of `[…, …]`.
    pub fn list(&mut self, part: &'a str) -> Option<Vec<&'a str>> {
        let items: Result<Vec<&'a RawValue>, _> = options().from_str(part);
        let items = items.map_err(|error| self.explain(part, &error)).ok()?;
        Some(items.into_iter().map(bare).collect())
    }

    /// A value of which only one mistake can be told.
    pub fn value<T: DeserializeOwned>(&mut self, part: &'a str) -> Option<T> {
        let value = options().from_str(part);
        value.map_err(|error| self.explain(part, &error)).ok()
    }

    /// A struct.
    pub fn record<T: DeserializeOwned>(&mut self, part: &'a str) -> Option<T> {
        let fields = self.fields(part)?;
        self.record_of(part, fields, &[])
    }

    /// A struct of these fields of `whole`, which may have `more`: each field that cannot be read
    /// is told and left out, until the rest can be.
    pub fn record_of<T: DeserializeOwned>(
        &mut self,
        whole: &str,
        mut fields: Vec<Field<'a>>,
        more: &[&str],
    ) -> Option<T> {
        let (mut left_out, mut misspelt) = (Vec::new(), false);
        loop {
            let failed = RefCell::default();
            let access = Access {
                fields: fields.iter().enumerate(),
                value: None,
                failed: &failed,
            };
            let read = T::deserialize(MapAccessDeserializer::new(access));
            let error = match read {
                Ok(value) => return left_out.is_empty().then_some(value),
                Err(error) => error,
            };
            match (failed.into_inner(), &error) {
                (Some((index, of_value)), _) => {
                    let (name, value) = fields.remove(index);
                    match of_value {
                        Some(error) => self.explain(value, &error),
                        None => {
                            misspelt = true;
                            self.wrong(name, unknown_field(&error, more));
                        }
                    }
                    left_out.push(name);
                }
                // The missing field is then the misspelt one, or one that could not be read.
                (None, RonError::MissingStructField { field, .. })
                    if misspelt || left_out.contains(field) =>
                {
                    return None;
                }
                (None, _) => {
                    self.wrong(whole, words(&error));
                    return None;
                }
            }
        }
    }
}

fn options() -> ron::Options {
    ron::Options::default()
}

/// Without the blanks and comments around it.
fn bare(raw: &RawValue) -> &str {
    raw.trim().get_ron()
}

/// Offset in `part` of what ron is about.
fn place(part: &str, error: &SpannedError) -> usize {
    let start = &error.span.start;
    // An error about a value itself belongs to its beginning; ron stands at its end then.
    if matches!(
        error.code,
        RonError::Message(_) | RonError::MissingStructField { .. }
    ) {
        return 0;
    }
    let lines = part
        .split_inclusive('\n')
        .take(start.line.saturating_sub(1));
    let line: usize = lines.map(str::len).sum();
    let rest = part.get(line..).unwrap_or("").chars();
    let column = rest.take(start.col.saturating_sub(1)).map(char::len_utf8);
    line + column.sum::<usize>()
}

fn unknown_field(error: &RonError, more: &[&str]) -> String {
    match error {
        RonError::NoSuchStructField {
            expected, found, ..
        } => {
            let known: Vec<&str> = expected.iter().chain(more).copied().collect();
            format!("unknown field `{found}`; known here: {}", known.join(", "))
        }
        other => words(other),
    }
}

/// A ron error in our words.
fn words(error: &RonError) -> String {
    use RonError as R;
    match error {
        R::NoSuchStructField { .. } => unknown_field(error, &[]),
        R::NoSuchEnumVariant {
            expected, found, ..
        } => format!(
            "unknown word `{found}`; known here: {}",
            expected.join(", ")
        ),
        R::MissingStructField { field, .. } => format!("the field `{field}` is missing"),
        R::DuplicateStructField { field, .. } => format!("the field `{field}` is given twice"),
        R::ExpectedDifferentLength { expected, found } => {
            let count = expected.trim_start_matches(|c: char| !c.is_ascii_digit());
            format!("{count} values are needed here, not {found}")
        }
        R::Eof => "the text ends before its last bracket is closed".to_owned(),
        R::ExpectedString => "a text in quotes is needed".to_owned(),
        R::ExpectedArray => "a list `[…]` is needed".to_owned(),
        R::ExpectedStructLike | R::ExpectedNamedStructLike(_) => {
            "what has fields, `(name: …)`, is needed".to_owned()
        }
        R::ExpectedInteger | R::ExpectedFloat => "a number is needed".to_owned(),
        R::InvalidValueForType { expected, found } => {
            format!("{expected} is needed, not {found}")
        }
        R::ExceededRecursionLimit => "brackets are nested too deep".to_owned(),
        R::Message(text) => text.clone(),
        other => {
            let text = other.to_string();
            let mut letters = text.chars();
            let first = letters.next().into_iter().flat_map(char::to_lowercase);
            first.chain(letters).collect()
        }
    }
}

/// Fields as ron finds them: copies of their names, and their values in the text.
struct Fields<'a>(Vec<(String, &'a str)>);

impl<'de> Deserialize<'de> for Fields<'de> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visit;
        impl<'de> Visitor<'de> for Visit {
            type Value = Fields<'de>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("what has fields, `(name: …)`,")
            }
            fn visit_unit<E: Error>(self) -> Result<Self::Value, E> {
                Ok(Fields(Vec::new()))
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut fields = Vec::new();
                while let Some(Word(name)) = map.next_key()? {
                    fields.push((name, bare(map.next_value::<&RawValue>()?)));
                }
                Ok(Fields(fields))
            }
        }
        deserializer.deserialize_any(Visit)
    }
}

/// The name of a field.
struct Word(String);

impl<'de> Deserialize<'de> for Word {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Identifier;
        impl Visitor<'_> for Identifier {
            type Value = Word;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the name of a field")
            }
            fn visit_str<E>(self, name: &str) -> Result<Word, E> {
                Ok(Word(name.to_owned()))
            }
        }
        deserializer.deserialize_identifier(Identifier)
    }
}

/// Fields for serde, and which of them failed: with its value's error, or by its name.
struct Access<'f, 'a> {
    fields: Enumerate<slice::Iter<'f, Field<'a>>>,
    value: Option<(usize, &'a str)>,
    failed: &'f RefCell<Option<(usize, Option<SpannedError>)>>,
}

impl<'a> MapAccess<'a> for Access<'_, 'a> {
    type Error = RonError;

    fn next_key_seed<K: DeserializeSeed<'a>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, RonError> {
        let Some((index, (name, value))) = self.fields.next() else {
            return Ok(None);
        };
        self.value = Some((index, value));
        let key = seed.deserialize(IntoDeserializer::<RonError>::into_deserializer(*name));
        key.map(Some)
            .inspect_err(|_| *self.failed.borrow_mut() = Some((index, None)))
    }

    fn next_value_seed<V: DeserializeSeed<'a>>(&mut self, seed: V) -> Result<V::Value, RonError> {
        let Some((index, text)) = self.value.take() else {
            return Err(RonError::custom("a value without its name"));
        };
        options().from_str_seed(text, seed).map_err(|error| {
            let code = error.code.clone();
            *self.failed.borrow_mut() = Some((index, Some(error)));
            code
        })
    }
}
