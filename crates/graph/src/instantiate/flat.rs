//! The tree of entries made flat: one list of passes.

use super::{
    scopes::{InstanceId, Position, ScopeId},
    symbols::{At, SymbolTable},
};
use crate::{
    diagnostics::reports::Reported,
    document::typed::{Entry, Pass},
    expressions::eval,
    language::{
        name::Name,
        syntax::{Expr, Leaf, Reference},
    },
    resource::{ResourceId, Target},
    source::span::{Located, Span},
};
use std::{collections::BTreeSet, ops::Range};

/// In which frames a pass runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Run {
    /// In every frame.
    Always,
    /// In the first frame after planning.
    Once,
    /// In frames where something that it reads has changed.
    OnChange,
    /// In frames where an expression is true; equal texts are equal conditions.
    When(String),
}

impl std::fmt::Display for Run {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::When(condition) => write!(f, "When({condition:?})"),
            other => write!(f, "{other:?}"),
        }
    }
}

/// A graph with nothing nested any more.
pub(crate) struct Flat<'a> {
    pub symbols: SymbolTable<'a>,
    pub passes: Vec<FlatPass<'a>>,
    /// How many passes stand above the first entry with a mistake that was reported.
    pub first_invalid: Option<usize>,
    pub interfaces: Vec<Interface>,
    /// Includes that others stand for.
    pub merged: Vec<Merge>,
    pub plan_inputs: PlanInputs,
}

/// An include that another one stands for.
pub(crate) struct Merge {
    /// The numbers of the passes between the end of the one that stands there and this one.
    pub between: Range<usize>,
    /// Resources from outside that it reads.
    pub inputs: Vec<ResourceId>,
    /// The resources of the one that stands there.
    pub owned: Range<usize>,
    /// The document that is included.
    pub graph: String,
    pub span: Span,
}

/// A pass with its place in the graph.
pub(crate) struct FlatPass<'a> {
    pub name: Located<String>,
    pub entry: &'a Entry,
    pub pass: &'a Pass,
    pub position: Position,
    pub run: Run,
    /// The value of the expression in [`Run::When`]; true without one.
    pub enabled: bool,
    /// Bindings of its shader's globals by groups around it.
    pub bind: Vec<Inherited<'a, Reference>>,
    /// Values of its shader's params from groups around it.
    pub set: Vec<Inherited<'a, Expr>>,
}

/// Surroundings of an entry.
#[derive(Clone)]
pub(super) struct EntryContext<'a> {
    pub scope: ScopeId,
    /// Prefix of the names of passes.
    pub prefix: String,
    pub run: Option<(Run, bool)>,
    pub bind: Vec<Inherited<'a, Reference>>,
    pub set: Vec<Inherited<'a, Expr>>,
}

impl<'a> EntryContext<'a> {
    pub fn new(scope: ScopeId) -> Self {
        Self {
            scope,
            prefix: String::new(),
            run: None,
            bind: Vec::new(),
            set: Vec::new(),
        }
    }

    /// Returns the surroundings of the entries of an included document. Groups outside say nothing
    /// of its names, for these are not their own.
    pub fn inside(&self, scope: ScopeId) -> Self {
        Self {
            prefix: self.prefix.clone(),
            run: self.run.clone(),
            ..Self::new(scope)
        }
    }
}

/// Setting of a group, with its place.
pub(crate) struct Inherited<'a, T> {
    pub name: &'a Located<String>,
    pub value: &'a T,
    pub position: Position,
    /// Its number in `Builder::said`.
    pub(super) number: usize,
}

impl<T> Clone for Inherited<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Inherited<'_, T> {}

/// Inputs and outputs of a document, to be compared with the accesses of its passes.
pub(crate) struct Interface {
    pub instance: InstanceId,
    pub outputs: Vec<(Located<Name>, Target)>,
    /// Inputs that are no outputs.
    pub read_only: Vec<(Located<Name>, Target)>,
}

/// Values that decide which entries exist.
#[derive(Debug, Default)]
pub(crate) struct PlanInputs {
    pub params: BTreeSet<String>,
    pub features: wgt::Features,
}

impl PlanInputs {
    /// True if an entry or output exists, on whose condition the plan depends then.
    pub(super) fn is_there(
        &mut self,
        condition: Option<&Expr>,
        at: &mut At<'_, '_>,
    ) -> Reported<bool> {
        let Some(condition) = condition else {
            return Ok(true);
        };
        let (symbols, scope) = (at.symbols(), at.position.scope);
        self.params.extend(symbols.roots(scope, condition));
        symbols.visit(scope, condition, &mut |_, leaf| {
            if let Leaf::Has(feature) = leaf {
                self.features |= feature;
            }
        });
        eval::boolean(condition, at)
    }
}
