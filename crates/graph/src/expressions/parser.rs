//! Parses tokens into expressions and references, by recursive descent: one level per binding
//! strength.

use super::lexer::{Token, tokens};
use crate::errors::language::SyntaxFault;
use crate::language::{
    AdapterFact, Attribute, Binary, Component, Expr, ExprKind, Function, Name, Reference, Scalar,
    Segment, Selection, Subject, Unary, Value, format_named,
};
use crate::source::{Located, SourceFile, Span};
use std::ops::Range;

type Parsed<T> = Result<T, SyntaxFault>;

/// Parses the expression at the bytes `range` of a file.
pub(crate) fn expression(file: &SourceFile, range: Range<usize>) -> Parsed<Expr> {
    whole(file, range, |parser| parser.expr())
}

/// Parses the reference at the bytes `range` of a file.
pub(crate) fn reference(file: &SourceFile, range: Range<usize>) -> Parsed<Reference> {
    whole(file, range, |parser| parser.conditional())
}

fn whole<T>(
    file: &SourceFile,
    range: Range<usize>,
    read: impl FnOnce(&mut Parser<'_>) -> Parsed<T>,
) -> Parsed<T> {
    let mut parser = Parser {
        file,
        tokens: tokens(file, range)?,
        at: 0,
    };
    let value = read(&mut parser)?;
    match parser.peek() {
        Token::End => Ok(value),
        _ => Err(parser.unexpected("nothing more")),
    }
}

struct Parser<'a> {
    file: &'a SourceFile,
    tokens: Vec<(Token<'a>, Range<usize>)>,
    at: usize,
}

/// A part of a dotted path as it stands there: materials, params and attributes look alike.
struct Part<'a> {
    word: &'a str,
    range: Range<usize>,
    selection: Option<Selection>,
}

impl<'a> Parser<'a> {
    fn peek(&self) -> Token<'a> {
        self.tokens[self.at].0
    }

    fn range(&self) -> Range<usize> {
        self.tokens[self.at].1.clone()
    }

    fn next(&mut self) -> Range<usize> {
        let range = self.range();
        self.at = (self.at + 1).min(self.tokens.len() - 1);
        range
    }

    fn take(&mut self, sign: &'static str) -> bool {
        let is_there = self.peek() == Token::Sign(sign);
        if is_there {
            self.next();
        }
        is_there
    }

    fn expect(&mut self, sign: &'static str) -> Parsed<()> {
        if self.take(sign) {
            Ok(())
        } else {
            Err(self.unexpected(&format!("`{sign}`")))
        }
    }

    fn unexpected(&self, expected: &str) -> SyntaxFault {
        let token = match self.peek() {
            Token::Word(word) => format!("`{word}`"),
            Token::Sign(sign) => format!("`{sign}`"),
            Token::Whole(number) => format!("`{number}`"),
            Token::Number(number) => format!("`{number}`"),
            Token::End => "the end".to_owned(),
        };
        SyntaxFault::Unexpected(self.file.span(self.range()), token, expected.to_owned())
    }

    fn span(&self, from: usize) -> Span {
        let end = self.tokens[self.at.saturating_sub(1)].1.end;
        self.file.span(from..end.max(from))
    }

    /// A reference, or one of two: `condition ? maps : shadow_map`.
    fn conditional(&mut self) -> Parsed<Reference> {
        if !self.asks_here() {
            let path = self.path()?;
            return self.reference(path);
        }
        let condition = self.binary(0)?;
        self.expect("?")?;
        let path = self.path()?;
        let mut reference = self.reference(path)?;
        self.expect(":")?;
        let other = self.conditional()?;
        reference.otherwise = Some(Box::new((condition, other)));
        Ok(reference)
    }

    /// True if a `?` follows outside of brackets.
    fn asks_here(&self) -> bool {
        let mut depth = 0u32;
        self.tokens[self.at..].iter().any(|(token, _)| {
            match token {
                Token::Sign("(" | "[") => depth += 1,
                Token::Sign(")" | "]") => depth = depth.saturating_sub(1),
                _ => {}
            }
            depth == 0 && *token == Token::Sign("?")
        })
    }

    fn expr(&mut self) -> Parsed<Expr> {
        let start = self.range().start;
        let condition = self.binary(0)?;
        if !self.take("?") {
            return Ok(condition);
        }
        let yes = self.expr()?;
        self.expect(":")?;
        let no = self.expr()?;
        let kind = ExprKind::Ternary(Box::new([condition, yes, no]));
        Ok(Expr::new(kind, self.span(start)))
    }

    /// Parses operators that bind at least as strongly as `least` into one expression.
    fn binary(&mut self, least: u8) -> Parsed<Expr> {
        let start = self.range().start;
        let mut left = self.unary()?;
        loop {
            let operator = self.operator().filter(|(.., own)| *own >= least);
            let Some((_, operator, strength)) = operator else {
                return Ok(left);
            };
            self.next();
            let right = self.binary(strength + 1)?;
            // A comparison of a comparison is a mistake in every language that allows it.
            if *strength == 2 && self.operator().is_some_and(|(.., own)| *own == 2) {
                return Err(self.unexpected("`&&`, or brackets around one comparison"));
            }
            let kind = ExprKind::Binary(*operator, Box::new([left, right]));
            left = Expr::new(kind, self.span(start));
        }
    }

    fn operator(&self) -> Option<&'static (&'static str, Binary, u8)> {
        match self.peek() {
            Token::Sign(sign) => Binary::named(sign),
            _ => None,
        }
    }

    fn unary(&mut self) -> Parsed<Expr> {
        let start = self.range().start;
        let operator = match self.peek() {
            Token::Sign("-") => Unary::Minus,
            Token::Sign("!") => Unary::Not,
            _ => return self.primary(),
        };
        self.next();
        let operand = self.unary()?;
        let kind = ExprKind::Unary(operator, Box::new(operand));
        Ok(Expr::new(kind, self.span(start)))
    }

    fn primary(&mut self) -> Parsed<Expr> {
        let start = self.range().start;
        let kind = match self.peek() {
            Token::Whole(number) => self.literal(Value::Scalar(Scalar::Whole(number))),
            Token::Number(number) => self.literal(Value::Scalar(Scalar::Number(number))),
            Token::Word(word @ ("true" | "false")) => self.literal(Value::Bool(word == "true")),
            Token::Sign("(") => {
                self.next();
                let inner = self.expr()?;
                self.expect(")")?;
                return self.component(Expr::new(inner.kind, self.span(start)));
            }
            Token::Word(word) if self.tokens[self.at + 1].0 == Token::Sign("(") => {
                let call = self.call(word)?;
                return self.component(Expr::new(call, self.span(start)));
            }
            Token::Word(word) if word.starts_with(|c: char| c.is_ascii_uppercase()) => {
                self.next();
                Ok(match format_named(word) {
                    Some(format) => ExprKind::Literal(Value::Format(format)),
                    None => ExprKind::Constant(word.to_owned()),
                })
            }
            Token::Word(_) => {
                let path = self.path()?;
                self.value_of(path)
            }
            _ => return Err(self.unexpected("a number, a name or a bracket")),
        }?;
        Ok(Expr::new(kind, self.span(start)))
    }

    /// The expression, or the component of it that is asked for behind a bracket: `max(a, b).x`.
    fn component(&mut self, expr: Expr) -> Parsed<Expr> {
        if !self.take(".") {
            return Ok(expr);
        }
        let component = match self.peek() {
            Token::Word(word) => Component::named(word),
            _ => None,
        };
        let (_, component) = component.ok_or_else(|| self.unexpected("`x`, `y`, `z` or `w`"))?;
        self.next();
        let start = expr.span.range.start;
        let kind = ExprKind::Component(Box::new(expr), *component);
        Ok(Expr::new(kind, self.span(start)))
    }

    fn literal(&mut self, value: Value) -> Parsed<ExprKind> {
        self.next();
        Ok(ExprKind::Literal(value))
    }

    fn call(&mut self, name: &str) -> Parsed<ExprKind> {
        let place = self.next();
        self.expect("(")?;
        if name == "has" {
            let Token::Word(feature) = self.peek() else {
                return Err(self.unexpected("a feature of wgpu"));
            };
            let span = self.file.span(self.next());
            self.expect(")")?;
            let flag = wgt::Features::from_name(feature);
            let unknown = || SyntaxFault::Feature(Located::new(feature.to_owned(), span));
            return flag.map(ExprKind::Has).ok_or_else(unknown);
        }
        let Some((_, function, count)) = Function::named(name) else {
            let name = Located::new(name.to_owned(), self.file.span(place));
            return Err(SyntaxFault::Function(name));
        };
        let mut arguments = vec![self.expr()?];
        while self.take(",") {
            arguments.push(self.expr()?);
        }
        self.expect(")")?;
        if arguments.len() != *count {
            return Err(SyntaxFault::Arguments {
                span: self.span(place.start),
                function: function.as_str(),
                expected: *count,
                given: arguments.len(),
            });
        }
        Ok(ExprKind::Call(*function, arguments))
    }

    fn path(&mut self) -> Parsed<Vec<Part<'a>>> {
        let mut parts = Vec::new();
        loop {
            let Token::Word(word) = self.peek() else {
                return Err(self.unexpected("a name"));
            };
            let range = self.next();
            let is_selected = self.take("[");
            let selection = is_selected.then(|| self.selection()).transpose()?;
            parts.push(Part {
                word,
                range,
                selection,
            });
            if !self.take(".") {
                return Ok(parts);
            }
        }
    }

    fn selection(&mut self) -> Parsed<Selection> {
        let first = self.expr()?;
        let selection = if self.take("..") {
            Selection::Range(Box::new([first, self.expr()?]))
        } else {
            Selection::One(Box::new(first))
        };
        self.expect("]")?;
        Ok(selection)
    }

    fn name(&self, part: &Part<'_>) -> Parsed<Located<Name>> {
        let span = self.file.span(part.range.clone());
        match Name::new(part.word) {
            Ok(name) => Ok(Located::new(name, span)),
            Err(fault) => Err(SyntaxFault::Name(span, fault)),
        }
    }

    /// A path that is a material or a part of one.
    fn reference(&self, mut path: Vec<Part<'_>>) -> Parsed<Reference> {
        let (first, last) = match path.as_slice() {
            [first, .., last] | [first @ last] => (first.range.start, last),
            [] => return Err(self.unexpected("a name")),
        };
        let selection = last.selection.as_ref();
        let selected = selection.and_then(|selection| selection.exprs().last());
        let end = selected.map_or(last.range.end, |expr| expr.span.range.end + 1);
        let mut reference = Reference {
            segments: Vec::new(),
            previous: false,
            mips: None,
            otherwise: None,
            span: self.file.span(first..end),
        };
        let is = |part: Option<&Part<'_>>, word: &str, selected: bool| {
            part.is_some_and(|part| part.word == word && part.selection.is_some() == selected)
        };
        if is(path.last(), "mip", true) {
            reference.mips = path.pop().and_then(|part| part.selection);
        }
        if path.len() > 1 && is(path.last(), "previous", false) {
            reference.previous = true;
            path.pop();
        }
        if path.is_empty() {
            return Err(SyntaxFault::Part(reference.span, "mip"));
        }
        for (index, part) in path.into_iter().enumerate() {
            let is_attribute = Attribute::named(part.word).is_some();
            if index > 0 && (is_attribute || matches!(part.word, "previous" | "mip")) {
                let word = if is_attribute { "attribute" } else { "order" };
                return Err(SyntaxFault::Part(self.file.span(part.range), word));
            }
            let name = self.name(&part)?;
            let selection = part.selection;
            reference.segments.push(Segment { name, selection });
        }
        Ok(reference)
    }

    /// A path that has a value: a param, or an attribute of something.
    fn value_of(&self, mut path: Vec<Part<'_>>) -> Parsed<ExprKind> {
        let last = path.last().filter(|last| last.selection.is_none());
        let attribute = last.and_then(|last| Some(Attribute::named(last.word)?.1));
        let alone = path.len() == 1;
        if let [.., owner, _] = path.as_slice()
            && let Some((_, component)) = last.and_then(|last| Component::named(last.word))
            && path.len() > 2
            && owner.selection.is_none()
            && Attribute::named(owner.word).is_some()
        {
            path.pop();
            let (first, owner) = (path[0].range.start, path[path.len() - 1].range.end);
            let kind = self.value_of(path)?;
            let whole = Expr::new(kind, self.file.span(first..owner));
            return Ok(ExprKind::Component(Box::new(whole), *component));
        }
        if alone && attribute == Some(Attribute::Index) {
            let innermost = Subject::Repetition(None);
            return Ok(ExprKind::Attribute(innermost, Attribute::Index));
        }
        if let Some(attribute) = attribute.filter(|_| !alone) {
            path.pop();
            let subject = match path.as_slice() {
                [one] if one.word == "viewport" && one.selection.is_none() => Subject::Viewport,
                [one] if attribute == Attribute::Index => {
                    Subject::Repetition(Some(self.name(one)?.value))
                }
                _ => Subject::Material(Box::new(self.reference(path)?)),
            };
            return Ok(ExprKind::Attribute(subject, attribute));
        }
        if let Some(part) = path.iter().find(|part| part.selection.is_some()) {
            let place = self.file.span(part.range.clone());
            return Err(SyntaxFault::Part(place, "number"));
        }
        if let [owner, fact] = path.as_slice()
            && owner.word == "adapter"
            && let Some(fact) = AdapterFact::named(fact.word)
        {
            return Ok(ExprKind::Adapter(fact));
        }
        let names = path.iter().map(|part| Ok(self.name(part)?.to_string()));
        let names = names.collect::<Parsed<Vec<_>>>()?;
        Ok(ExprKind::Param(names.join(".")))
    }
}
