//! Finds operators that stand beside each other without the parentheses that WGSL asks for. Naga
//! takes them, the compilers of browsers do not.

use super::text::tokens;
use std::ops::Range;

/// Two operators of which one needs parentheses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Mixed {
    /// The operator that comes first.
    pub first: String,
    /// The other one.
    pub second: String,
    /// Where the second stands in the text.
    pub at: Range<usize>,
}

/// Operators that WGSL's grammar treats alike.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Class {
    /// `&`, `|` or `^`, each with itself alone.
    Bits,
    /// `||` or `&&`, each with itself alone, and between comparisons.
    Choice,
    /// One between two operators of choice.
    Comparison,
    /// One between two operators of comparison, with operands in parentheses.
    Shift,
    Arithmetic,
}

struct Operator<'t> {
    text: &'t str,
    class: Class,
    at: Range<usize>,
}

fn class(operator: &str) -> Option<Class> {
    Some(match operator {
        "&" | "|" | "^" => Class::Bits,
        "||" | "&&" => Class::Choice,
        "==" | "!=" | "<" | "<=" | ">" | ">=" => Class::Comparison,
        "<<" | ">>" => Class::Shift,
        "+" | "-" | "*" | "/" | "%" => Class::Arithmetic,
        _ => return None,
    })
}

/// Returns the first two operators, of those that no bracket parts, that are not to be mixed.
fn mixed(operators: &[Operator]) -> Option<Mixed> {
    let begin = operators.first()?;
    // The first choice, the comparison since the last one, and the operator within its operand.
    let (mut choice, mut comparison, mut inner) = (None, None, None::<&Operator>);
    operators.iter().find_map(|second| {
        let differs = |first: &&Operator| first.text != second.text;
        let first = match second.class {
            _ if begin.class == Class::Bits => Some(begin).filter(differs),
            Class::Bits => Some(begin),
            Class::Choice => {
                (comparison, inner) = (None, None);
                Some(*choice.get_or_insert(second)).filter(differs)
            }
            Class::Comparison => {
                inner = None;
                comparison.replace(second)
            }
            Class::Shift => inner.replace(second),
            Class::Arithmetic => {
                let first = inner.replace(second);
                first.filter(|first| first.class == Class::Shift)
            }
        }?;
        Some(Mixed {
            first: first.text.to_owned(),
            second: second.text.to_owned(),
            at: second.at.clone(),
        })
    })
}

/// Words behind which an expression begins.
const BEGINS: [&str; 6] = ["return", "if", "while", "switch", "case", "else"];

/// Signs of two characters.
const PAIRS: [&str; 11] = [
    "&&", "||", "==", "!=", "<=", ">=", "<<", ">>", "->", "++", "--",
];

/// True if a word, or a sign before or within an operand, parts no expressions.
fn is_inner(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphanumeric() || "_.!~&*-".contains(c))
}

/// True if `<` behind the word begins a list of types.
fn takes_types(word: &str) -> bool {
    const NAMES: [&str; 6] = ["array", "binding_array", "ptr", "atomic", "bitcast", "var"];
    let is_matrix = matches!(
        word.as_bytes(),
        [b'm', b'a', b't', b'2'..=b'4', b'x', b'2'..=b'4']
    );
    let is_vector = matches!(word, "vec2" | "vec3" | "vec4");
    is_matrix || is_vector || NAMES.contains(&word) || word.starts_with("texture_")
}

/// True if the token before an operator ends its first operand.
fn is_operand(before: &str) -> bool {
    let is_number = before.starts_with(|c: char| c.is_ascii_digit()) && !before.starts_with("0x");
    let is_exponent = is_number && before.ends_with(['e', 'E']);
    let ends = before.ends_with(|c: char| c.is_alphanumeric() || "_)]".contains(c));
    ends && !is_exponent && !BEGINS.contains(&before)
}

/// Returns pairs of operators in a WGSL text that need parentheses, at most one for each
/// expression.
pub(crate) fn find(text: &str) -> Vec<Mixed> {
    let (mut pairs, mut before, mut tokens) = (Vec::new(), "", tokens(text).peekable());
    // Operators of each open bracket, and whether it is one of types.
    let mut levels: Vec<(Vec<Operator>, bool)> = Vec::new();
    let mut level = (Vec::new(), false);
    while let Some((mut at, mut token)) = tokens.next() {
        if let Some((next, _)) = tokens.peek()
            && !(level.1 && token == ">")
            && PAIRS.contains(&&text[at.start..next.end])
        {
            at.end = next.end;
            token = &text[at.clone()];
            tokens.next();
        }
        let opens_types = token == "<" && takes_types(before);
        if opens_types || matches!(token, "(" | "[" | "{") {
            if token == "{" {
                pairs.extend(mixed(&std::mem::take(&mut level.0)));
            }
            levels.push(std::mem::replace(&mut level, (Vec::new(), opens_types)));
        } else if (level.1 && token == ">") || matches!(token, ")" | "]" | "}") {
            let outer = levels.pop().unwrap_or_default();
            pairs.extend(mixed(&std::mem::replace(&mut level, outer).0));
        } else if let Some(class) = class(token).filter(|_| is_operand(before)) {
            let text = token;
            level.0.push(Operator { text, class, at });
        } else if !is_inner(token) {
            pairs.extend(mixed(&std::mem::take(&mut level.0)));
        }
        before = token;
    }
    pairs.extend(mixed(&level.0));
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> Vec<String> {
        let pairs = find(text).into_iter();
        pairs
            .map(|pair| format!("{} {}", pair.first, pair.second))
            .collect()
    }

    #[test]
    fn what_wgsl_refuses_is_found() {
        for (text, pair) in [
            ("let a = b << 8u | c;", "<< |"),
            ("if a || b && c { x(); }", "|| &&"),
            ("return lane / 2u & 3u;", "/ &"),
            ("x = a + b << 2u;", "+ <<"),
            ("x = a << 1u << 2u;", "<< <<"),
            ("x = a < b < c;", "< <"),
            ("x = a == b & c;", "== &"),
            ("let v = vec2<u32>(a | b ^ c, 1u);", "| ^"),
            ("x = w[i >> 1u & 3u];", ">> &"),
        ] {
            assert_eq!(found(text), [pair], "{text}");
        }
        assert_eq!(found("a = b | c & d; e = f && g || h;"), ["| &", "&& ||"]);
    }

    #[test]
    fn a_long_expression_takes_no_longer_than_it_is_long() {
        let sum = "a + ".repeat(1_000_000);
        assert_eq!(found(&format!("x = {sum} a;")), [""; 0]);
        assert_eq!(found(&format!("x = {sum} a << 1u;")), ["+ <<"]);
    }

    #[test]
    fn what_wgsl_takes_is_left_alone() {
        for text in [
            "let a = (b << 8u) | c; if (a || b) && c { x(); } if a < b { y(); }",
            "if a < b { x(); } else if c < d { y(); }",
            "var<workgroup> all: array<atomic<u32>, 4>; x = a - -b * -1.0e-3 + 2e-5;",
            "x = a << 1u == b && c + d < e; /* a | b & c */ // a | b & c",
            "for (var i = 0u; i < 4u && a < b; i++) { p = &q; *p |= 1u << i; }",
            "fn f(a: ptr<function, vec4<f32>>, b: u32) -> u32 { return g(a >> 1u, b & 1u); }",
            "#import \"shared/light.wgsl\"\n@compute @workgroup_size(8, 8) fn main() { }",
            "x = select(a < b, c < d, e < f) | g; switch a & 3u { case 1u: { } default: { } }",
        ] {
            assert_eq!(found(text), [""; 0], "{text}");
        }
    }
}
