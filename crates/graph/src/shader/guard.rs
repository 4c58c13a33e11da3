//! Stands between a shader's text and naga, whose reader calls itself once per operator of a long
//! expression, per `else if` of a chain and per declaration that names a later one, with no limit
//! of its own. A text that is refused here would overflow the stack.

use super::expand::Expanded;
use super::text::{next, tokens};
use crate::errors::shader::ShaderError;

/// Longest text, imports in place, in bytes: ten times the longest shader one would write.
const LONGEST: usize = 1 << 20;

/// Most declarations of a module, each of which may name the next: naga's time grows with their
/// square.
const MOST_DECLARATIONS: usize = 2048;

/// Most operators on the longest path through a statement. Optimised, naga 30 takes 0.5 KiB of
/// stack for each (measured: 2 MiB, which is what a thread has, hold more than 3,200), so that an
/// unoptimised build has room too.
const DEEPEST: usize = 500;

/// Weight of an `else` beside the operators of its condition; naga takes 1.5 KiB for both.
const ELSE: usize = 2;

/// Content of one pair of brackets so far.
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

/// Refuses a text that naga cannot read in bounded stack and time.
///
/// # Errors
/// The construct that is too large, with its place and a hint how to mend it.
pub(super) fn check(source: &Expanded) -> Result<(), ShaderError> {
    let file = source.file.name.to_string();
    let text = source.text.as_str();
    if text.len() > LONGEST {
        let at = source.locate(0..0);
        return Err(ShaderError::TooLong(file, LONGEST >> 10, at));
    }
    let mut levels = vec![Level::default()];
    let mut declarations = 0;
    for (range, token) in tokens(text) {
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
                    if next(&text[range.end..]).is_some_and(|(_, token)| token == "else") {
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
        let last = levels.last();
        let deepest = last.map_or(0, |level| level.current.max(level.longest));
        if deepest > DEEPEST {
            return Err(ShaderError::TooDeep(file, DEEPEST, source.locate(range)));
        }
        if declarations > MOST_DECLARATIONS {
            let (most, at) = (MOST_DECLARATIONS, source.locate(range));
            return Err(ShaderError::TooManyDeclarations(file, most, at));
        }
    }
    Ok(())
}
