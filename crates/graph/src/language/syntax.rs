//! Syntax trees of expressions and references.

use super::{name::Name, value::Value};
use crate::source::{Located, Span};

/// A parsed expression of a document, whose value is a number, size, vector, bool, word or format:
/// `"ceil_div(viewport.size, 2)"`. docs/authoring.md has the grammar. [`Lowering`](crate::Lowering)
/// evaluates the expressions in the fields of a pass.
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    pub(crate) kind: ExprKind,
    /// Place of the expression in its document, without quotes.
    pub(crate) span: Span,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ExprKind {
    Literal(Value),
    /// A word of a `Choice`, or the name of a param where a word may stand: `front`.
    Word(Name),
    Tuple(Vec<Expr>),
    /// Name of a param; `left.radius` is the param `radius` of the include `left`.
    Param(String),
    Attribute(Subject, Attribute),
    /// Name of a scalar `const` of the pass's shader.
    Constant(String),
    Has(wgt::Features),
    Adapter(AdapterFact),
    Unary(Unary, Box<Expr>),
    Binary(Binary, Box<[Expr; 2]>),
    Ternary(Box<[Expr; 3]>),
    Call(Function, Vec<Expr>),
    /// One of several numbers: `status.size.x`.
    Component(Box<Expr>, Component),
}

/// Thing whose attribute an expression asks for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Subject {
    Viewport,
    /// The repetition of the group or include called so, or the innermost one for `None` (`index`
    /// alone).
    Repetition(Option<Name>),
    Material(Box<Reference>),
}

/// Declares an enum of words or signs: each variant with its spelling and, if a type is given, a
/// number.
macro_rules! spelt {
    ($(#[$doc:meta])+ $enum:ident $($number:ty)?:
        $($name:ident = $text:literal $($of:literal)?,)+) => {
        $(#[$doc])+
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum $enum { $($name),+ }

        impl $enum {
            /// All variants, each with its spelling and its number.
            pub const ALL: &[(&str, Self $(, $number)?)] = &[$(($text, Self::$name $(, $of)?)),+];

            pub fn named(text: &str) -> Option<&'static (&'static str, Self $(, $number)?)> {
                Self::ALL.iter().find(|(name, ..)| *name == text)
            }

            pub fn as_str(self) -> &'static str {
                match self { $(Self::$name => $text),+ }
            }
        }
    };
}

spelt! {
    /// Attribute of the viewport, a material or a repetition, by its word.
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

/// Fact about the adapter: `adapter.software`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AdapterFact {
    Software,
    SubgroupSize,
    StorageBinding,
}

impl AdapterFact {
    pub fn named(word: &str) -> Option<Self> {
        match word {
            "software" => Some(Self::Software),
            "subgroup_size" => Some(Self::SubgroupSize),
            "storage_binding" => Some(Self::StorageBinding),
            _ => None,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unary {
    Minus,
    Not,
}

spelt! {
    /// Binary operator, by its sign; its number says how strongly it binds (the greater, the
    /// stronger).
    Binary u8:
    Or = "||" 0,
    And = "&&" 1,
    Equal = "==" 2,
    NotEqual = "!=" 2,
    Less = "<" 2,
    LessEqual = "<=" 2,
    Greater = ">" 2,
    GreaterEqual = ">=" 2,
    ShiftLeft = "<<" 3,
    ShiftRight = ">>" 3,
    Add = "+" 4,
    Subtract = "-" 4,
    Multiply = "*" 5,
    Divide = "/" 5,
    Remainder = "%" 5,
}

spelt! {
    /// Component of a vector or size.
    Component:
    X = "x",
    Y = "y",
    Z = "z",
    W = "w",
}

spelt! {
    /// Function, by its name; its number is the number of its arguments.
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

/// A parsed reference to a material or a part of one: `maps[2].mip[0]` (a mip of a layer),
/// `left.position` (an output of the [include](crate#terms) `left`), `history.previous` (the
/// content at the end of the frame before), or one of two by a condition, `is_large ? many : few`.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    pub(crate) segments: Vec<Segment>,
    /// True if the material's content at the end of the previous frame is meant.
    pub(crate) previous: bool,
    pub(crate) mips: Option<Selection>,
    /// Condition under which this reference holds, and the reference that holds otherwise; `None`
    /// if this one always holds.
    pub(crate) otherwise: Option<Box<(Expr, Reference)>>,
    /// Place of the reference in its document, without quotes.
    pub(crate) span: Span,
}

/// One name of a dotted path, with the selection behind it in brackets.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Segment {
    pub name: Located<Name>,
    pub selection: Option<Selection>,
}

/// Selection of one element (`[2]`), or of a range (`[0..2]`, the end excluded).
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
    /// Creates a reference to the whole material called `name`.
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

    /// Returns the place of the reference in its document, without quotes.
    pub fn span(&self) -> &Span {
        &self.span
    }

    /// Returns the text of the reference, as it is written in its document.
    pub fn text(&self) -> &str {
        self.span.text()
    }

    /// Returns the text of the reference, with its place in the document.
    pub(crate) fn located(&self) -> Located<String> {
        Located::new(self.text().to_owned(), self.span.clone())
    }

    /// Returns the [path](Self::path) of the reference, with its place in the document.
    pub(crate) fn located_path(&self) -> Located<String> {
        Located::new(self.path(), self.span.clone())
    }

    /// Returns the reference's names with dots between them, without selections: the name that a
    /// provider is asked for.
    pub(crate) fn path(&self) -> String {
        let segments = self.segments.iter();
        let names: Vec<&str> = segments.map(|segment| segment.name.as_str()).collect();
        names.join(".")
    }

    /// Calls `each` with this reference, and with every leaf of its selections and conditions.
    pub(crate) fn visit<'a>(&'a self, each: &mut dyn FnMut(Leaf<'a>)) {
        each(Leaf::Material(self));
        let segments = self.segments.iter();
        let segments = segments.filter_map(|segment| segment.selection.as_ref());
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

/// Name, material or feature that an expression depends on.
pub(crate) enum Leaf<'a> {
    Param(&'a str),
    Word(&'a Name),
    Material(&'a Reference),
    /// Name of a constant of the pass's shader.
    Constant(&'a str),
    Has(wgt::Features),
}

impl<'a> Leaf<'a> {
    /// Returns the leaf's name if it may name a param or a named value; `None` for other leaves.
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

    /// Returns the place of the expression in its document, without quotes.
    pub fn span(&self) -> &Span {
        &self.span
    }

    /// Returns the text of the expression, as it is written in its document.
    pub fn text(&self) -> &str {
        self.span.text()
    }

    /// Returns the param's name if the expression is a param alone; `None` otherwise.
    pub(crate) fn as_param(&self) -> Option<&str> {
        match &self.kind {
            ExprKind::Param(name) => Some(name),
            _ => None,
        }
    }

    /// Returns the param's name and the component if the expression may be one component of a
    /// param: `direction.x`. It is none if a param has the whole text as its name, `left.x`.
    pub(crate) fn as_component(&self) -> Option<(&str, Component)> {
        let (owner, component) = self.as_param()?.rsplit_once('.')?;
        Some((owner, Component::named(component)?.1))
    }

    /// True if the expression is `frame.index`: the number of the frame, unless an entry called
    /// `frame` is repeated around it.
    pub(crate) fn is_frame_number(&self) -> bool {
        let frame = |name: &Name| name.as_str() == "frame";
        matches!(&self.kind, ExprKind::Attribute(Subject::Repetition(Some(name)), _) if frame(name))
    }

    /// True if the expression asks for an attribute of a material. A count of this kind may be 0
    /// without a mistake of the document.
    pub(crate) fn is_taken(&self) -> bool {
        let mut is_taken = false;
        self.visit(&mut |leaf| is_taken |= matches!(leaf, Leaf::Material(_)));
        is_taken
    }

    /// Calls `each` with every leaf of the expression: the params, words, constants, features and
    /// materials in it.
    pub(crate) fn visit<'a>(&'a self, each: &mut dyn FnMut(Leaf<'a>)) {
        match &self.kind {
            ExprKind::Param(name) => {
                each(Leaf::Param(name));
                if let Some((owner, _)) = self.as_component() {
                    each(Leaf::Param(owner));
                }
            }
            ExprKind::Word(word) => each(Leaf::Word(word)),
            ExprKind::Constant(name) => each(Leaf::Constant(name)),
            ExprKind::Has(feature) => each(Leaf::Has(*feature)),
            ExprKind::Attribute(Subject::Material(material), _) => material.visit(each),
            ExprKind::Literal(_) | ExprKind::Attribute(..) | ExprKind::Adapter(_) => {}
            ExprKind::Tuple(list) | ExprKind::Call(_, list) => {
                list.iter().for_each(|expr| expr.visit(each));
            }
            ExprKind::Unary(_, operand) | ExprKind::Component(operand, _) => operand.visit(each),
            ExprKind::Binary(_, operands) => operands.iter().for_each(|expr| expr.visit(each)),
            ExprKind::Ternary(operands) => operands.iter().for_each(|expr| expr.visit(each)),
        }
    }

    /// Returns a text that is equal for equal expressions. `leaf` returns the text of a param or an
    /// attribute, by its meaning in the whole graph.
    pub(crate) fn canonical(&self, leaf: &mut dyn FnMut(&Expr) -> String) -> String {
        let mut list = |list: &[Expr]| -> String {
            let list: Vec<String> = list.iter().map(|expr| expr.canonical(leaf)).collect();
            list.join(", ")
        };
        match &self.kind {
            ExprKind::Param(_) | ExprKind::Attribute(..) => leaf(self),
            ExprKind::Tuple(exprs) => format!("({})", list(exprs)),
            ExprKind::Call(function, exprs) => format!("{}({})", function.as_str(), list(exprs)),
            ExprKind::Unary(Unary::Minus, operand) => format!("-{}", operand.canonical(leaf)),
            ExprKind::Unary(Unary::Not, operand) => format!("!{}", operand.canonical(leaf)),
            ExprKind::Component(operand, component) => {
                format!("({}).{}", operand.canonical(leaf), component.as_str())
            }
            ExprKind::Binary(operator, operands) => {
                let [a, b] = operands.each_ref().map(|expr| expr.canonical(leaf));
                format!("({a} {} {b})", operator.as_str())
            }
            ExprKind::Ternary(operands) => {
                let [condition, yes, no] = operands.each_ref().map(|expr| expr.canonical(leaf));
                format!("({condition})?({yes}):({no})")
            }
            _ => self.text().to_owned(),
        }
    }
}
