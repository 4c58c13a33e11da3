//! Reads structs from fields that are split already, each from its own text.

use crate::diagnostics::Diagnostic;
use crate::mistakes::{explain, field_twice, place_of, unknown_field};
use crate::reader::{Field, READING, fail, options};
use crate::span::Span;
use serde::de::value::MapAccessDeserializer;
use serde::de::{DeserializeOwned, DeserializeSeed, Error as _, IntoDeserializer, MapAccess};
use std::{cell::Cell, collections::HashSet, iter::Enumerate, slice};

/// Deserialises a struct from fields that [`Node::fields`](crate::reader::Node::fields) returned,
/// each from its own text. `whole` is the place of the struct, where a missing field is reported.
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
