//! Result of flattening the tree of entries: one list of passes.

use super::scopes::{InstanceId, Position, ScopeId};
use super::settings::Settings;
use super::symbols::{At, SymbolTable};
use crate::diagnostics::Reported;
use crate::document::{Entry, Pass};
use crate::expressions::eval;
use crate::language::{Expr, Leaf, Name, Reference};
use crate::resource::{ResourceId, Target};
use crate::source::{Located, Span};
use std::{collections::BTreeSet, ops::Range};

/// Frames in which a pass runs, as its document gives them in the pass's field `run`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Run {
    /// In every frame that may compute something new, which is the default.
    Always,
    /// In the first frame, and again when the content that the pass wrote is lost, for example by a
    /// change of the viewport.
    Once,
    /// In the first frame, in frames where content that the pass reads, params included, has
    /// changed since the pass last ran, and when the content that the pass wrote is lost. Contents
    /// are not compared: content has changed if a pass that writes it has run, or the host reports
    /// a change.
    OnChange,
    /// In the frames in which an expression over params and the frame's number is true. Holds the
    /// expression as text, which names params as the loaded document does; passes with equal texts
    /// run in the same frames. [`LinkedPass::turns`](crate::LinkedPass::turns) holds its values.
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

/// Frames in which an entry runs, and the values of the expression in [`Run::When`], frame by frame
/// until they repeat; one true for every other [`Run`].
pub(super) type Runs = (Run, Vec<bool>);

/// A graph whose includes, groups and repetitions are resolved to one list of passes, without these
/// passes.
pub(crate) struct Flat<'a> {
    /// Meanings of the names in the graph's documents, and the resources found so far.
    pub symbols: SymbolTable<'a>,
    /// Number of passes above the first entry with a reported mistake; `None` if no entry has a
    /// mistake.
    pub first_invalid: Option<usize>,
    /// Inputs and outputs of each use of a document: of the loaded document and of every include.
    pub interfaces: Vec<Interface>,
    /// Includes that are replaced by an earlier include of the same content.
    pub merged: Vec<Merge>,
    /// Params and features that decide which entries of the documents exist.
    pub plan_inputs: PlanInputs,
}

/// An include that is replaced by an earlier include of the same content.
pub(crate) struct Merge {
    /// Indices of the passes between the end of the earlier include and this
    /// one.
    pub between: Range<usize>,
    /// Resources of the including document that are bound to the inputs of the included one, in the
    /// order of the inputs.
    pub inputs: Vec<ResourceId>,
    /// Indices, in the list of the plan's resources, of those that the earlier include declares.
    pub owned: Range<usize>,
    /// Path of the included document, as the include writes it.
    pub graph: String,
    pub span: Span,
}

/// A pass of a flattened graph, with the settings that it inherits.
pub(crate) struct FlatPass<'a> {
    pub name: Located<String>,
    pub entry: &'a Entry,
    pub pass: &'a Pass,
    pub position: Position,
    pub run: Run,
    /// Values of the expression in [`Run::When`], frame by frame until they repeat; one true for
    /// every other [`Run`].
    pub turns: Vec<bool>,
    /// The round that the pass belongs to, of a group that ends early.
    pub round: Option<Round<'a>>,
    /// Bindings and values that groups around the pass give to globals, params and overrides of
    /// its shader.
    pub inherited: Settings<'a>,
}

/// A round of a group that ends early (`while`).
#[derive(Clone, Copy)]
pub(crate) struct Round<'a> {
    /// Buffer whose first u32 is 0 once no round runs any more.
    pub counter: &'a Reference,
    /// Position at which the counter's reference is resolved.
    pub position: Position,
    /// Buffer of one u32: 1 if the round runs, else 0.
    pub goes: ResourceId,
}

/// Settings that an entry inherits from the document and the groups around it.
#[derive(Clone)]
pub(super) struct EntryContext<'a> {
    pub scope: ScopeId,
    /// Prefix of the full names of the passes inside, such as `cascade[2].`; empty at the top of
    /// the loaded document.
    pub prefix: String,
    pub run: Option<Runs>,
    pub round: Option<Round<'a>>,
    pub settings: Settings<'a>,
}

impl<'a> EntryContext<'a> {
    pub fn new(scope: ScopeId) -> Self {
        Self {
            scope,
            prefix: String::new(),
            run: None,
            round: None,
            settings: Settings::default(),
        }
    }

    /// Returns the settings that the entries of an included document inherit. Bindings and values
    /// of groups outside are dropped, because they mean names of another document.
    pub fn inside(&self, scope: ScopeId) -> Self {
        Self {
            prefix: self.prefix.clone(),
            run: self.run.clone(),
            round: self.round,
            ..Self::new(scope)
        }
    }
}

/// Inputs and outputs of an instance of a document, to be compared with the accesses of its passes.
pub(crate) struct Interface {
    pub instance: InstanceId,
    /// Outputs of the document that are textures, buffers or samplers, each with the target that it
    /// means; empty for the loaded document.
    pub outputs: Vec<(Located<Name>, Target)>,
    /// Inputs that the document must not write, because they are not outputs, too, each with the
    /// target that is bound to it.
    pub read_only: Vec<(Located<Name>, Target)>,
}

/// Params and features that decide which entries exist.
#[derive(Debug, Default)]
pub(crate) struct PlanInputs {
    /// Names of params of the loaded document.
    pub params: BTreeSet<String>,
    pub features: wgt::Features,
}

impl PlanInputs {
    /// Evaluates the condition of an entry or output, and notes the params and features in it; true
    /// without a condition.
    pub fn is_there(&mut self, condition: Option<&Expr>, at: &mut At<'_, '_>) -> Reported<bool> {
        let Some(condition) = condition else {
            return Ok(true);
        };
        self.note(condition, at.symbols, at.position.scope);
        eval::boolean(condition, at)
    }

    /// Notes the params and features in a condition.
    pub fn note(&mut self, condition: &Expr, symbols: &SymbolTable<'_>, scope: ScopeId) {
        self.params.extend(symbols.roots(scope, condition));
        symbols.visit(scope, condition, &mut |_, leaf| {
            if let Leaf::Has(feature) = leaf {
                self.features |= feature;
            }
        });
    }
}
