//! Expressions and references as they were parsed.

use super::{name::Name, value::Value};
use crate::source::span::{Located, Span};

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

/// Declares words or signs, each with its spelling and with a number that goes with it.
macro_rules! spelt {
    ($(#[$doc:meta])+ $enum:ident $($number:ty)?:
        $($name:ident = $text:literal $($of:literal)?,)+) => {
        $(#[$doc])+
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum $enum { $($name),+ }

        impl $enum {
            /// Every one with its spelling and its number.
            pub const ALL: &[(&str, Self $(, $number)?)] = &[$(($text, Self::$name $(, $of)?)),+];

            pub fn named(text: &str) -> Option<&'static (&'static str, Self $(, $number)?)> {
                Self::ALL.iter().find(|(known, ..)| *known == text)
            }

            pub fn as_str(self) -> &'static str {
                match self { $(Self::$name => $text),+ }
            }
        }
    };
}

spelt! {
    /// Something that a subject can be asked for, with its word.
    Attribute:
    Size = "size",
    Width = "width",
    Height = "height",
    Layers = "layers",
    Mips = "mips",
    Samples = "samples",
    Count = "count",
    Format = "format",
    Kind = "kind",
    Index = "index",
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unary {
    Minus,
    Not,
}

spelt! {
    /// An operator between two values, with its sign and how strongly it binds.
    Binary u8:
    Or = "||" 0,
    And = "&&" 1,
    Equal = "==" 2,
    NotEqual = "!=" 2,
    Less = "<" 2,
    LessEqual = "<=" 2,
    Greater = ">" 2,
    GreaterEqual = ">=" 2,
    Add = "+" 3,
    Subtract = "-" 3,
    Multiply = "*" 4,
    Divide = "/" 4,
    Remainder = "%" 4,
}

spelt! {
    /// A function, with its name and number of arguments.
    Function usize:
    Min = "min" 2,
    Max = "max" 2,
    CeilDiv = "ceil_div" 2,
    Floor = "floor" 1,
    Ceil = "ceil" 1,
    Exp = "exp" 1,
    Log2 = "log2" 1,
    Pow = "pow" 2,
    Sqrt = "sqrt" 1,
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
        self.span.text()
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

    /// Calls `each` with it, and with everything that its selections and conditions are made of.
    pub(crate) fn visit<'a>(&'a self, each: &mut dyn FnMut(Leaf<'a>)) {
        each(Leaf::Material(self));
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
        self.span.text()
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
            ExprKind::Attribute(Subject::Material(of), _) => of.visit(each),
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
                let [a, b] = of.each_ref().map(|expr| expr.canonical(leaf));
                format!("({a} {} {b})", operator.as_str())
            }
            ExprKind::Ternary(of) => {
                let [condition, yes, no] = of.each_ref().map(|expr| expr.canonical(leaf));
                format!("({condition})?({yes}):({no})")
            }
            _ => self.text().to_owned(),
        }
    }
}
