//! Stands between a shader's text and naga, whose reader calls itself once per operator of a long expression, per `else if` of a
//! chain and per declaration that names a later one, with no limit of its own: what is refused here would overflow the stack.

use super::Expanded;
use crate::diagnostics::{Code, Diagnostic};

/// Longest text, imports in place, in bytes: ten times the longest shader one would write.
const LONGEST: usize = 1 << 20;

/// Most declarations of a module, each of which may name the next: naga's time grows with their square.
const MOST_DECLARATIONS: usize = 2048;

/// Most operators on the longest path through a statement. Optimised, naga 30 takes 0.5 KiB of stack for each (measured: 2 MiB,
/// which is what a thread has, hold more than 3,200), so that an unoptimised build has room too.
const DEEPEST: usize = 500;

/// What an `else` weighs beside the operators of its condition; naga takes 1.5 KiB for both.
const ELSE: usize = 2;

/// What is inside one pair of brackets so far.
#[derive(Default)]
struct Level {
    /// Operators of the current statement, or of the current argument.
    current: usize,
    /// Those of the longest one before.
    longest: usize,
}

impl Level {
    /// A statement or an argument ends.
    fn end(&mut self) -> usize {
        self.longest = self.longest.max(std::mem::take(&mut self.current));
        self.longest
    }
}

/// Refuses what naga cannot read in bounded stack and time.
///
/// # Errors
/// What is too much, with its place and the way out.
pub(super) fn check(source: &Expanded) -> Result<(), Diagnostic> {
    let name = &source.file.name;
    let text = source.text.as_str();
    if text.len() > LONGEST {
        return Err(Diagnostic::error(
            Code::Shader,
            format!("`{name}` is longer than {} KiB", LONGEST >> 10),
        )
        .at(source.locate(0..0), "")
        .help("split it into several shaders; large tables belong into buffers"));
    }
    let mut levels = vec![Level::default()];
    let mut declarations = 0;
    let mut at = 0;
    while let Some((length, token)) = next(&text[at..]) {
        at += length;
        let here = at - token.len()..at;
        let outside = levels.len() == 1;
        // There is always the outermost level: it is never closed.
        let Some(level) = levels.last_mut() else {
            break;
        };
        match token {
            "(" | "[" | "{" => levels.push(Level::default()),
            ")" | "]" | "}" if !outside => {
                let inside = level.end() + 1;
                levels.pop();
                let Some(around) = levels.last_mut() else {
                    break;
                };
                let before = around.current;
                around.current += inside;
                if token == "}" {
                    // A block ends a statement, unless an `else` continues it.
                    around.end();
                    if next(&text[at..]).is_some_and(|(_, token)| token == "else") {
                        around.current = before + ELSE;
                    }
                }
            }
            ";" | "," => drop(level.end()),
            "fn" | "struct" | "alias" | "const" | "override" | "var" | "const_assert"
                if outside =>
            {
                declarations += 1;
            }
            "+" | "-" | "*" | "/" | "%" | "&" | "|" | "^" | "<" | ">" | "=" | "!" | "." => {
                level.current += 1;
            }
            _ => {}
        }
        if levels
            .last()
            .is_some_and(|level| level.current.max(level.longest) > DEEPEST)
        {
            return Err(Diagnostic::error(
                Code::Shader,
                format!("`{name}` holds an expression or a chain of `else if` that is nested too deep"),
            )
            .at(source.locate(here), format!("more than {DEEPEST} operators up to here"))
            .help("split it: give parts of it a name with `let`, turn the chain into a `switch` or a loop"));
        }
        if declarations > MOST_DECLARATIONS {
            return Err(Diagnostic::error(
                Code::Shader,
                format!("`{name}` has more than {MOST_DECLARATIONS} declarations, those of its imports included"),
            )
            .at(source.locate(here), "counted up to here")
            .help("split it into several shaders, or import less"));
        }
    }
    Ok(())
}

/// The next token that is no comment and no space, and how far it reaches from the start of `text`: a word, or one sign.
fn next(text: &str) -> Option<(usize, &str)> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut at = 0;
    loop {
        let rest = text.get(at..)?;
        let first = rest.chars().next()?;
        if rest.starts_with("//") {
            // The line ends of WGSL: what naga reads must not be a comment here.
            at += rest.find(|c| matches!(c, '\n'..='\r' | '\u{85}' | '\u{2028}' | '\u{2029}'))?;
        } else if rest.starts_with("/*") {
            at += comment(rest.as_bytes());
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

/// Bytes of the block comment, possibly with others inside, that `text` begins with.
fn comment(text: &[u8]) -> usize {
    let (mut depth, mut at) = (0, 0);
    loop {
        (depth, at) = match text.get(at..) {
            None | Some([]) => return text.len(),
            Some([b'/', b'*', ..]) => (depth + 1, at + 2),
            Some([b'*', b'/', ..]) if depth == 1 => return at + 2,
            Some([b'*', b'/', ..]) => (depth - 1, at + 2),
            Some(_) => (depth, at + 1),
        };
    }
}
