//! Splits expressions and references into tokens.

use crate::{errors::language::SyntaxFault, source::SourceFile};
use std::ops::Range;

/// Most tokens of one expression: parser and evaluation call themselves for each of them.
const MOST: usize = 256;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Token<'a> {
    Word(&'a str),
    Whole(i64),
    Number(f64),
    Sign(&'static str),
    End,
}

/// Two signs before one: `<=` is not `<` and `=`.
const SIGNS: [&str; 25] = [
    "||", "&&", "==", "!=", "<=", ">=", "<<", ">>", "..", "<", ">", "+", "-", "*", "/", "%", "!",
    "(", ")", "[", "]", ",", "?", ":", ".",
];

/// Splits the bytes `range` of a file into tokens, each with its place. The last one is
/// [`Token::End`].
pub(crate) fn tokens(
    file: &SourceFile,
    range: Range<usize>,
) -> Result<Vec<(Token<'_>, Range<usize>)>, SyntaxFault> {
    let text = file.text.get(range.clone()).unwrap_or("");
    let mut tokens = Vec::new();
    let mut at = 0;
    loop {
        at += text[at..].len() - text[at..].trim_start_matches([' ', '\n', '\t', '\r']).len();
        let rest = &text[at..];
        let (token, length) = match rest.chars().next() {
            None => (Token::End, 0),
            Some(first) if first.is_ascii_alphabetic() || first == '_' => {
                let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
                let word = &rest[..rest.find(|c| !is_part(c)).unwrap_or(rest.len())];
                (Token::Word(word), word.len())
            }
            Some(first) if first.is_ascii_digit() => number(rest)
                .ok_or_else(|| SyntaxFault::Number(file.span(range.start + at..range.end)))?,
            Some(first) => {
                let sign = SIGNS.into_iter().find(|sign| rest.starts_with(sign));
                let place = range.start + at..range.start + at + first.len_utf8();
                let sign = sign.ok_or_else(|| SyntaxFault::Sign(file.span(place), first))?;
                (Token::Sign(sign), sign.len())
            }
        };
        let start = range.start + at;
        tokens.push((token, start..start + length));
        if token == Token::End {
            return Ok(tokens);
        }
        if tokens.len() > MOST {
            return Err(SyntaxFault::TooLong(file.span(range), MOST));
        }
        at += length;
    }
}

/// The number that a text begins with, and its length. `0..2` begins with a whole number.
fn number(text: &str) -> Option<(Token<'static>, usize)> {
    let digits = |from: usize| {
        let rest = &text[from..];
        let end = rest.find(|c: char| !c.is_ascii_digit() && c != '_');
        end.unwrap_or(rest.len())
    };
    let mut end = digits(0);
    let mut whole = true;
    if text[end..].starts_with('.') && !text[end..].starts_with("..") {
        end += 1;
        end += digits(end);
        whole = false;
    }
    if text[end..].starts_with(['e', 'E']) {
        let sign = usize::from(text[end + 1..].starts_with(['-', '+']));
        let length = digits(end + 1 + sign);
        if length == 0 {
            return None;
        }
        end += 1 + sign + length;
        whole = false;
    }
    if text[end..].starts_with(|c: char| c.is_ascii_alphanumeric()) {
        return None;
    }
    let plain = text[..end].replace('_', "");
    if whole {
        return Some((Token::Whole(plain.parse().ok()?), end));
    }
    let number: f64 = plain.parse().ok()?;
    let token = Token::Number(number);
    number.is_finite().then_some((token, end))
}
