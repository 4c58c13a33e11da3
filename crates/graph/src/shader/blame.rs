//! Finds the part of a WGSL text on which a library panics: the first declaration that brings the
//! panic about and, in a function, the first statement. Both are found by bisection, so a long text
//! is parsed only a few dozen times.

use super::text::{next, tokens};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// A declaration of a module.
struct Declaration<'t> {
    range: Range<usize>,
    /// None of a directive.
    name: Option<&'t str>,
    /// The words in it.
    words: BTreeSet<&'t str>,
    /// Body of a function between its braces, and its type in words, empty if it has none.
    body: Option<(Range<usize>, String)>,
}

/// Returns the byte range of the first declaration, or of the first statement in it, for which
/// `panics` is true of the text so far. `None` if `panics` is true of no part.
pub(super) fn blamed_range(text: &str, panics: &dyn Fn(&str) -> bool) -> Option<Range<usize>> {
    let declarations = declarations(text);
    let order = in_order_of_need(&declarations);
    let joined = |parts: &[usize]| {
        let parts = parts.iter();
        let texts = parts.map(|&part| &text[declarations[part].range.clone()]);
        texts.collect::<Vec<_>>().join("\n")
    };
    let counts: Vec<usize> = (1..=order.len()).collect();
    let first = counts.partition_point(|&count| !panics(&joined(&order[..count])));
    let declaration = &declarations[*order.get(first)?];
    let Some((body, ty)) = &declaration.body else {
        return Some(declaration.range.clone());
    };
    let before = joined(&order[..first]);
    let head = &text[declaration.range.start..body.start];
    let ends = statement_ends(&text[body.clone()]);
    let result = match ty.as_str() {
        "" => String::new(),
        ty => format!(" return {ty}();"),
    };
    let cut = |&(end, depth): &(usize, usize)| {
        let begin = &text[body.start..body.start + end];
        let close = "}".repeat(depth);
        // A `return` is the last statement of a valid function, and not every one needs it.
        let mut results = [result.as_str(), ""].into_iter();
        results.any(|result| panics(&format!("{before}\n{head}{begin}{close}{result} }}")))
    };
    let first = ends.partition_point(|end| !cut(end));
    // A part of it may not be valid where the whole is.
    let Some(&(end, _)) = ends.get(first) else {
        return Some(declaration.range.start..body.start);
    };
    let before = first.checked_sub(1).map_or(0, |before| ends[before].0);
    // Behind spaces and comments.
    let space = next(&text[body.start + before..body.start + end])
        .map_or(0, |(length, token)| length - token.len());
    Some(body.start + before + space..body.start + end)
}

/// Returns the text with spaces in the place of its functions, so that all places stay.
pub(super) fn without_functions(text: &str) -> String {
    let mut rest = text.to_owned();
    for declaration in declarations(text).iter().filter(|it| it.body.is_some()) {
        let blank = |c: char| {
            if c == '\n' {
                "\n".to_owned()
            } else {
                " ".repeat(c.len_utf8())
            }
        };
        let blank: String = text[declaration.range.clone()].chars().map(blank).collect();
        rest.replace_range(declaration.range.clone(), &blank);
    }
    rest
}

/// The declarations, each behind those that it names; directives first.
fn in_order_of_need(declarations: &[Declaration<'_>]) -> Vec<usize> {
    let indexed = || declarations.iter().enumerate();
    let by_name = indexed().filter_map(|(index, declaration)| Some((declaration.name?, index)));
    let by_name: BTreeMap<&str, usize> = by_name.collect();
    let directives = indexed().filter(|(_, declaration)| declaration.name.is_none());
    let mut order: Vec<usize> = directives.map(|(index, _)| index).collect();
    let mut seen: BTreeSet<usize> = order.iter().copied().collect();
    for (index, _) in indexed() {
        if !seen.insert(index) {
            continue;
        }
        let mut open = vec![(index, declarations[index].words.iter())];
        while let Some((index, words)) = open.last_mut() {
            let needed = words.find_map(|word| by_name.get(word).filter(|at| seen.insert(**at)));
            match needed {
                Some(&needed) => open.push((needed, declarations[needed].words.iter())),
                None => {
                    order.push(*index);
                    open.pop();
                }
            }
        }
    }
    order
}

/// Declarations of a module, in order.
fn declarations(text: &str) -> Vec<Declaration<'_>> {
    let mut declarations = Vec::new();
    let (mut start, mut depth) = (None, 0usize);
    let (mut read, mut body): (Vec<&str>, _) = (Vec::new(), None);
    for (place, token) in tokens(text) {
        let (first, at) = (*start.get_or_insert(place.start), place.end);
        match token {
            "{" | "(" | "[" => {
                if token == "{" && depth == 0 && read.contains(&"fn") {
                    body = Some((at, result_of(&read)));
                }
                depth += 1;
            }
            "}" | ")" | "]" => depth = depth.saturating_sub(1),
            _ => {}
        }
        read.push(token);
        let ends = depth == 0 && matches!(token, ";" | "}");
        if !ends {
            continue;
        }
        declarations.push(Declaration {
            range: first..at,
            name: name_of(&read),
            words: read.drain(..).collect(),
            body: body.take().map(|(from, ty)| (from..at - 1, ty)),
        });
        start = None;
    }
    declarations
}

/// The name that a declaration gives; none of a directive.
fn name_of<'t>(tokens: &[&'t str]) -> Option<&'t str> {
    let at = tokens.iter().position(|token| {
        matches!(
            *token,
            "fn" | "struct" | "alias" | "const" | "override" | "var"
        )
    })?;
    let rest = &tokens[at + 1..];
    // `var<storage, read_write> name`
    let skipped = match rest.first() {
        Some(&"<") => 1 + rest.iter().position(|token| *token == ">")?,
        _ => 0,
    };
    rest.get(skipped).copied()
}

/// The type that a function returns, without its attributes, from the tokens of its head.
fn result_of(head: &[&str]) -> String {
    let arrow = head.windows(2).rposition(|pair| pair == ["-", ">"]);
    let mut rest = arrow.map_or(&[][..], |at| &head[at + 2..]);
    while let ["@", _, after @ ..] = rest {
        let inside = after.first() == Some(&"(");
        let end = after.iter().position(|token| *token == ")");
        rest = match end {
            Some(end) if inside => &after[end + 1..],
            _ => after,
        };
    }
    rest.concat()
}

/// Where statements of a body and their heads end, in bytes from its begin, and how many braces are
/// open there.
fn statement_ends(body: &str) -> Vec<(usize, usize)> {
    let (mut braces, mut brackets) = (0usize, 0usize);
    let mut ends = Vec::new();
    for (place, token) in tokens(body) {
        match token {
            "(" | "[" => brackets += 1,
            ")" | "]" => brackets = brackets.saturating_sub(1),
            "{" => braces += 1,
            "}" => braces = braces.saturating_sub(1),
            _ => {}
        }
        if brackets == 0 && matches!(token, ";" | "{" | "}") {
            ends.push((place.end, braces));
        }
    }
    ends
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The part of a text that is blamed where every text with the word `bad` panics.
    fn blamed(text: &str) -> Option<&str> {
        let panics = |text: &str| text.contains("bad");
        blamed_range(text, &panics).map(|range| &text[range])
    }

    #[test]
    fn the_declaration_that_others_name() {
        let text = "enable f16;\nconst a = bad;\nconst b = a;\nfn f() -> u32 { return b; }";
        assert_eq!(blamed(text), Some("const a = bad;"));
        assert_eq!(
            blamed("const c = b; const b = bad;"),
            Some("const b = bad;")
        );
        assert_eq!(blamed("const c = 1;"), None);
    }

    #[test]
    fn the_statement_of_a_function() {
        let text = "@fragment fn f(@builtin(position) at: vec4f) -> @location(0) vec4<f32> {
            let x = 1; // ;
            for (var i = 0; i < 3; i += 1) { if i == 2 { let y = bad; } }
            return vec4f();
        }";
        assert_eq!(blamed(text), Some("let y = bad;"));
        let head = text.replace("i < 3", "bad");
        assert_eq!(blamed(&head), Some("for (var i = 0; bad; i += 1) {"));
    }

    #[test]
    fn a_cut_function_returns_what_it_says() {
        let head = [
            "fn", "f", "(", ")", "-", ">", "@", "location", "(", "0", ")", "vec4", "<", "f32", ">",
        ];
        assert_eq!(result_of(&head), "vec4<f32>");
        assert_eq!(result_of(&["fn", "f", "(", ")"]), "");
    }
}
