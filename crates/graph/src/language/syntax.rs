//! Expressions and references as they were parsed.

use super::{name::Name, value::Value};
use crate::source::span::{Located, Span};
use std::fmt::Write as _;

/// A number, size, bool or word of a document: written out, or made of params and attributes, as in
/// `"ceil_div(viewport.size, 2)"`. docs/authoring.md has the grammar.
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    pub(crate) kind: ExprKind,
    /// Its place, without quotes.
    pub(crate) span: Span,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ExprKind {
    Literal(Value),
    /// A word of a `Choice`, or a param where one may stand: `front`.
    Word(Name),
    Tuple(Vec<Expr>),
    /// A param, with a dot for one of a named include: `left.radius`.
    Param(String),
    Attribute(Subject, Attribute),
    /// A scalar `const` of the pass's shader.
    Constant(String),
    Has(wgt::Features),
    Unary(Unary, Box<Expr>),
    Binary(Binary, Box<[Expr; 2]>),
    Ternary(Box<[Expr; 3]>),
    Call(Function, Vec<Expr>),
}

/// Subject of an attribute.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Subject {
    Viewport,
    /// The innermost repetition (`index` alone), or that of a group or include.
    Repetition(Option<Name>),
    Material(Box<Reference>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Attribute {
    Size,
    Width,
    Height,
    Layers,
    Mips,
    Samples,
    Count,
    Format,
    Kind,
    Index,
}

impl Attribute {
    pub const ALL: [(&str, Self); 10] = [
        ("size", Self::Size),
        ("width", Self::Width),
        ("height", Self::Height),
        ("layers", Self::Layers),
        ("mips", Self::Mips),
        ("samples", Self::Samples),
        ("count", Self::Count),
        ("format", Self::Format),
        ("kind", Self::Kind),
        ("index", Self::Index),
    ];
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unary {
    Minus,
    Not,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Binary {
    Or,
    And,
    Equal,
    NotEqual,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Add,
    Subtract,
    Multiply,
    Divide,
    Remainder,
}

impl Binary {
    /// Every operator with its sign and how strongly it binds.
    pub const ALL: [(&str, Self, u8); 13] = [
        ("||", Self::Or, 0),
        ("&&", Self::And, 1),
        ("==", Self::Equal, 2),
        ("!=", Self::NotEqual, 2),
        ("<", Self::Less, 2),
        ("<=", Self::LessEqual, 2),
        (">", Self::Greater, 2),
        (">=", Self::GreaterEqual, 2),
        ("+", Self::Add, 3),
        ("-", Self::Subtract, 3),
        ("*", Self::Multiply, 4),
        ("/", Self::Divide, 4),
        ("%", Self::Remainder, 4),
    ];

    pub fn as_str(self) -> &'static str {
        let mut known = Self::ALL.iter();
        known
            .find(|(_, other, _)| *other == self)
            .map_or("", |(sign, ..)| *sign)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Function {
    Min,
    Max,
    CeilDiv,
    Floor,
    Ceil,
    Exp,
    Log2,
    Pow,
    Sqrt,
}

impl Function {
    /// Every function with its name and number of arguments.
    pub const ALL: [(&str, Self, usize); 9] = [
        ("min", Self::Min, 2),
        ("max", Self::Max, 2),
        ("ceil_div", Self::CeilDiv, 2),
        ("floor", Self::Floor, 1),
        ("ceil", Self::Ceil, 1),
        ("exp", Self::Exp, 1),
        ("log2", Self::Log2, 1),
        ("pow", Self::Pow, 2),
        ("sqrt", Self::Sqrt, 1),
    ];

    pub fn as_str(self) -> &'static str {
        let mut known = Self::ALL.iter();
        known
            .find(|(_, other, _)| *other == self)
            .map_or("", |(name, ..)| *name)
    }
}

/// A material or a part of one: `maps[index].mip[0]`, `left.position`, `history.previous`; or one
/// of two, `is_large ? many : few`.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    pub(crate) segments: Vec<Segment>,
    /// True for its content at the end of the frame before.
    pub(crate) previous: bool,
    pub(crate) mips: Option<Selection>,
    /// The condition under which it is meant, and the reference that is meant else.
    pub(crate) otherwise: Option<Box<(Expr, Reference)>>,
    /// Its place, without quotes.
    pub(crate) span: Span,
}

/// A name between two dots.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Segment {
    pub name: Located<Name>,
    pub selection: Option<Selection>,
}

/// One of several (`[2]`), or some of them (`[0..2]`, the end excluded).
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Selection {
    One(Box<Expr>),
    Range(Box<[Expr; 2]>),
}

impl Selection {
    pub(crate) fn exprs(&self) -> &[Expr] {
        match self {
            Self::One(one) => std::slice::from_ref(&**one),
            Self::Range(ends) => &**ends,
        }
    }
}

impl Reference {
    /// A whole material, by its name.
    pub(crate) fn new(name: Located<Name>) -> Self {
        Self {
            span: name.span.clone(),
            segments: vec![Segment {
                name,
                selection: None,
            }],
            previous: false,
            mips: None,
            otherwise: None,
        }
    }

    /// The place of the reference in its document, without quotes.
    pub fn span(&self) -> &Span {
        &self.span
    }

    /// The reference as it is written.
    pub fn text(&self) -> &str {
        text(&self.span)
    }

    /// The reference as it is written, with its place.
    pub(crate) fn located(&self) -> Located<String> {
        Located::new(self.text().to_owned(), self.span.clone())
    }

    /// Its names with dots between them, without selections: the name for a provider.
    pub(crate) fn path(&self) -> String {
        let names: Vec<&str> = self
            .segments
            .iter()
            .map(|segment| segment.name.as_str())
            .collect();
        names.join(".")
    }

    pub(crate) fn visit<'a>(&'a self, each: &mut dyn FnMut(Leaf<'a>)) {
        let segments = self
            .segments
            .iter()
            .filter_map(|segment| segment.selection.as_ref());
        for selection in segments.chain(&self.mips) {
            selection.exprs().iter().for_each(|expr| expr.visit(each));
        }
        if let Some(otherwise) = &self.otherwise {
            let (condition, other) = &**otherwise;
            condition.visit(each);
            each(Leaf::Material(other));
            other.visit(each);
        }
    }
}

/// Leaves of an expression.
pub(crate) enum Leaf<'a> {
    Param(&'a str),
    Word(&'a Name),
    Material(&'a Reference),
    /// A constant of the pass's shader.
    Constant(&'a str),
    Has(wgt::Features),
}

impl<'a> Leaf<'a> {
    /// The name of what may be a param or a value.
    pub fn named(&self) -> Option<&'a str> {
        match self {
            Self::Param(name) => Some(name),
            Self::Word(name) => Some(name.as_str()),
            _ => None,
        }
    }
}

fn text(span: &Span) -> &str {
    span.file.text.get(span.range.clone()).unwrap_or("")
}

impl Expr {
    pub(crate) fn new(kind: ExprKind, span: Span) -> Self {
        Self { kind, span }
    }

    /// The place of the expression in its document, without quotes.
    pub fn span(&self) -> &Span {
        &self.span
    }

    /// The expression as it is written.
    pub fn text(&self) -> &str {
        text(&self.span)
    }

    /// The param that the expression is, with nothing done to it.
    pub(crate) fn as_param(&self) -> Option<&str> {
        match &self.kind {
            ExprKind::Param(name) => Some(name),
            _ => None,
        }
    }

    /// True if it is taken from another count, which may be 0 through no fault of the document.
    pub(crate) fn is_taken(&self) -> bool {
        let mut is_taken = false;
        self.visit(&mut |leaf| is_taken |= matches!(leaf, Leaf::Material(_)));
        is_taken
    }

    /// Calls `each` with everything that the expression is made of.
    pub(crate) fn visit<'a>(&'a self, each: &mut dyn FnMut(Leaf<'a>)) {
        match &self.kind {
            ExprKind::Param(name) => each(Leaf::Param(name)),
            ExprKind::Word(word) => each(Leaf::Word(word)),
            ExprKind::Constant(name) => each(Leaf::Constant(name)),
            ExprKind::Has(feature) => each(Leaf::Has(*feature)),
            ExprKind::Attribute(Subject::Material(of), _) => {
                each(Leaf::Material(of));
                of.visit(each);
            }
            ExprKind::Literal(_) | ExprKind::Attribute(..) => {}
            ExprKind::Tuple(list) | ExprKind::Call(_, list) => {
                list.iter().for_each(|expr| expr.visit(each));
            }
            ExprKind::Unary(_, of) => of.visit(each),
            ExprKind::Binary(_, of) => of.iter().for_each(|expr| expr.visit(each)),
            ExprKind::Ternary(of) => of.iter().for_each(|expr| expr.visit(each)),
        }
    }

    /// A text that is equal for equal expressions; `leaf` says what a param or an attribute is in
    /// the whole graph.
    pub(crate) fn canonical(&self, leaf: &mut dyn FnMut(&Expr) -> String) -> String {
        let mut list = |list: &[Expr]| -> String {
            let list: Vec<String> = list.iter().map(|expr| expr.canonical(leaf)).collect();
            list.join(", ")
        };
        match &self.kind {
            ExprKind::Param(_) | ExprKind::Attribute(..) => leaf(self),
            ExprKind::Tuple(of) => format!("({})", list(of)),
            ExprKind::Call(function, of) => format!("{}({})", function.as_str(), list(of)),
            ExprKind::Unary(Unary::Minus, of) => format!("-{}", of.canonical(leaf)),
            ExprKind::Unary(Unary::Not, of) => format!("!{}", of.canonical(leaf)),
            ExprKind::Binary(operator, of) => {
                let [a, b] = &**of;
                let (a, b) = (a.canonical(leaf), b.canonical(leaf));
                format!("({a} {} {b})", operator.as_str())
            }
            ExprKind::Ternary(of) => {
                let mut text = String::new();
                for (expr, sign) in of.iter().zip(["?", ":", ""]) {
                    // Writing to a String cannot fail.
                    let _ = write!(text, "({}){sign}", expr.canonical(leaf));
                }
                text
            }
            _ => self.text().to_owned(),
        }
    }
}
