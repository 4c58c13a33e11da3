//! Mistakes in RON: ron's errors in plain words, each at its place.

use crate::diagnostics::{Code, Diagnostic};
use crate::span::{Located, SourceFile, Span};
use std::ops::Range;

/// Returns the place of a ron error, in bytes: `text` begins at `base`.
pub(crate) fn place_of(text: &str, error: &ron::error::SpannedError, base: usize) -> Range<usize> {
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
pub(crate) fn explain(error: &ron::Error, span: Span) -> Diagnostic {
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
