//! WGSL as text: answers questions that naga does not answer, or that come before it is called.

use std::ops::Range;

/// WGSL's line breaks besides `\n`: a comment ends at any of them.
pub(super) const BREAKS: [char; 6] = ['\r', '\u{b}', '\u{c}', '\u{85}', '\u{2028}', '\u{2029}'];

/// Counts the block comments that are open at the end of the text read so far.
#[derive(Default)]
pub(super) struct Comments {
    depth: usize,
}

impl Comments {
    pub fn are_open(&self) -> bool {
        self.depth > 0
    }

    /// Reads the next piece of the text, which follows the pieces read before.
    pub fn read(&mut self, text: &str) {
        let mut at = 0;
        while at < text.len() {
            at += self.step(&text[at..]);
        }
    }

    /// Reads a sign, a bracket of a comment or a line comment. Returns its length.
    fn step(&mut self, text: &str) -> usize {
        match text.as_bytes() {
            [b'/', b'*', ..] => {
                self.depth += 1;
                2
            }
            [b'*', b'/', ..] if self.depth > 0 => {
                self.depth -= 1;
                2
            }
            [b'/', b'/', ..] if self.depth == 0 => {
                let end = text.find(|c| c == '\n' || BREAKS.contains(&c));
                end.unwrap_or(text.len())
            }
            _ => text.chars().next().map_or(1, char::len_utf8),
        }
    }
}

/// Returns the next token that is not a comment or space, with the byte offset of its end in
/// `text`. A token is a word or one sign. `None` at the end of the text.
pub(super) fn next(text: &str) -> Option<(usize, &str)> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut at = 0;
    loop {
        let rest = text.get(at..)?;
        let first = rest.chars().next()?;
        if rest.starts_with("//") || rest.starts_with("/*") {
            at += comment(rest);
        } else if is_word(first) {
            let length = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
            return Some((at + length, &rest[..length]));
        } else if first.is_ascii_punctuation() {
            return Some((at + 1, &rest[..1]));
        } else {
            // Some of what WGSL skips is no white space elsewhere.
            at += first.len_utf8();
        }
    }
}

/// Iterates over all tokens of a text, each with its byte range.
pub(super) fn tokens(text: &str) -> impl Iterator<Item = (Range<usize>, &str)> {
    let mut at = 0;
    std::iter::from_fn(move || {
        let (length, token) = next(&text[at..])?;
        at += length;
        Some((at - token.len()..at, token))
    })
}

/// Length of the comment that a text begins with; comments nest, and one may stay open.
fn comment(text: &str) -> usize {
    let mut comments = Comments::default();
    let mut at = comments.step(text);
    while comments.are_open() && at < text.len() {
        at += comments.step(&text[at..]);
    }
    at
}

/// Names that a text declares.
#[derive(Default)]
pub(super) struct Declared<'t> {
    /// Names of struct members.
    pub fields: Vec<&'t str>,
    /// Names of functions, variables, constants, types and arguments.
    pub names: Vec<&'t str>,
}

impl<'t> Declared<'t> {
    pub fn new(text: &'t str) -> Self {
        const BEFORE_A_NAME: [&str; 8] = [
            "fn", "let", "var", "const", "override", "struct", "alias", ">",
        ];
        let (mut declared, mut is_struct) = (Self::default(), false);
        let (mut before, mut last) = ("", "");
        for (_, token) in tokens(text) {
            match token {
                "struct" => is_struct = true,
                "}" => is_struct = false,
                ":" if is_struct => declared.fields.push(last),
                // `for (var<private> name: …`, `fn f(name: …`, `let name = …`, `fn name(…`
                ":" | "=" | "(" | "{" if BEFORE_A_NAME.contains(&before) => {
                    declared.names.push(last);
                }
                ":" => declared.names.push(last),
                _ => {}
            }
            (before, last) = (last, token);
        }
        declared
    }
}

/// Iterates over the byte offsets at which `word` stands in `text` as a whole word.
pub(super) fn words<'a>(text: &'a str, word: &'a str) -> impl Iterator<Item = usize> + 'a {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    text.match_indices(word)
        .map(|(at, _)| at)
        .filter(move |&at| {
            !text[..at].ends_with(is_part) && !text[at + word.len()..].starts_with(is_part)
        })
}

/// Keywords before a name that is declared at module scope.
pub(super) const DECLARES: [&str; 6] = ["fn", "const", "override", "struct", "alias", "var"];

/// True if a text declares `name` at module scope, and no entry points: it is a module to import.
pub(super) fn declares(text: &str, name: &str) -> bool {
    let is_entry = |(word, before, _): (&str, &str, _)| {
        before == "@" && matches!(word, "compute" | "vertex" | "fragment")
    };
    let mut words = identifiers(text);
    words.any(|(word, before, outside)| outside && word == name && DECLARES.contains(&before))
        && !identifiers(text).any(is_entry)
}

/// Iterates over the words of a text outside of comments: the word; the token before it (`var` also
/// where a `<…>` stands between); and true if the word stands at module scope.
pub(super) fn identifiers(text: &str) -> impl Iterator<Item = (&str, &str, bool)> {
    let (mut depth, mut before) = (0usize, "");
    // Inside `<…>` behind `var`.
    let mut is_template = false;
    tokens(text).filter_map(move |(_, token)| {
        match token {
            "{" | "(" => depth += 1,
            "}" | ")" => depth = depth.saturating_sub(1),
            "<" if before == "var" => is_template = true,
            ">" if is_template => {
                (is_template, before) = (false, "var");
                return None;
            }
            _ => {}
        }
        let before = std::mem::replace(&mut before, token);
        let is_word = token.starts_with(|c: char| c.is_alphabetic() || c == '_');
        is_word.then_some((token, before, depth == 0 && !is_template))
    })
}
