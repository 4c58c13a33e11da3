//! Collects the faults of graphs, and turns them into errors, notes and warnings.
//!
//! ```
//! use skiagraph_compare::graphs::faults::GraphFaults;
//! use skiagraph_graph::Graph;
//! use skiagraph_passes::{EmbeddedSources, registry};
//!
//! let mut faults = GraphFaults::default();
//! for path in ["pipelines/rt.ron", "pipelines/none.ron"] {
//!     if let Err(wrong) = Graph::load(path, &registry(), &EmbeddedSources) {
//!         faults.add(path, &wrong);
//!     }
//! }
//! let error = faults.none_or_error().unwrap_err();
//! println!("{error}");
//! ```

use crate::error::{CompareError, Result, explain, with_causes};
use crate::sink::Sink;
use crate::wording::plural;
use itertools::Itertools;
use skiagraph_graph::{Code, Diagnostic, Diagnostics, Graph, Severity};

/// Faults of several graphs, collected to be shown together, equal ones once.
#[derive(Default)]
pub struct GraphFaults(Vec<(String, Diagnostics)>);

impl GraphFaults {
    /// Adds the faults of the graph named `graph`. Faults equal to ones that were added before, for
    /// example by planning for another viewport, are not shown again.
    pub fn add(&mut self, graph: &str, diagnostics: &Diagnostics) {
        self.0.push((graph.into(), diagnostics.clone()));
    }

    /// True if no faults were added.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Adds all faults in `other`.
    pub fn append(&mut self, other: Self) {
        self.0.extend(other.0);
    }

    /// Returns the error that shows the faults of one graph named `graph`.
    pub fn one(graph: &str, diagnostics: &Diagnostics) -> CompareError {
        let mut faults = Self::default();
        faults.add(graph, diagnostics);
        faults.into_error()
    }

    /// Returns `Ok` if no faults were added.
    ///
    /// # Errors
    /// [`CompareError::Diagnostics`] with all faults that were added.
    pub fn none_or_error(self) -> Result<()> {
        if self.is_empty() {
            Ok(())
        } else {
            Err(self.into_error())
        }
    }

    fn into_error(self) -> CompareError {
        let graphs = self.0.iter().map(|(graph, _)| graph).unique().count();
        let faults = self.0.iter().map(|(_, faults)| faults);
        let faults = faults.unique_by(|faults| faults.render(false));
        let faults = faults.map(|refusal| refusal.iter().cloned().collect());
        let faults: Vec<Vec<_>> = faults.collect();
        let count = plural(errors(faults.iter().flatten()).count(), "error");
        let summary = format!("{count} in {}", plural(graphs, "graph"));
        CompareError::Diagnostics { faults, summary }
    }
}

fn errors<'d>(
    diagnostics: impl IntoIterator<Item = &'d Diagnostic>,
) -> impl Iterator<Item = &'d Diagnostic> {
    let is_error = |diagnostic: &&Diagnostic| diagnostic.severity == Severity::Error;
    diagnostics.into_iter().filter(is_error)
}

/// True if a graph cannot be planned for a mistake of its own, not only for what it meets: a light
/// that it does not take, a viewport or scene that its section `needs` excludes, or an adapter or
/// program without what it needs.
pub fn is_mistake<'d>(diagnostics: impl IntoIterator<Item = &'d Diagnostic>) -> bool {
    let is_met = |code| {
        use Code::{Feature, Light, Limit, Memory, Need, Size};
        matches!(code, Feature | Light | Limit | Memory | Need | Size)
    };
    errors(diagnostics).any(|error| !is_met(error.code))
}

/// Returns the errors among `diagnostics`, without warnings, as one line for a table's footnote.
/// Only the first line of each help text is included.
pub fn reasons<'d>(diagnostics: impl IntoIterator<Item = &'d Diagnostic>) -> String {
    let line = |Diagnostic { message, help, .. }: &Diagnostic| match help {
        Some(help) => format!("{message} ({})", help.lines().next().unwrap_or_default()),
        None => message.clone(),
    };
    errors(diagnostics).map(line).collect::<Vec<_>>().join("; ")
}

/// Returns why a method cannot run as one line, and true if its document is at fault.
pub fn refusal(error: &CompareError) -> (String, bool) {
    match error {
        CompareError::Diagnostics { faults, .. } => {
            let faults = || faults.iter().flatten();
            (reasons(faults()), is_mistake(faults()))
        }
        CompareError::Gpu { source, .. } => (explain(source), false),
        error => (
            with_causes(error),
            matches!(error, CompareError::InvalidOutputs(_)),
        ),
    }
}

/// Passes the warnings of a graph and of its plan to a sink, if there are any.
pub fn warn(sink: &dyn Sink, graph: &Graph, plan: &[Diagnostic]) {
    let warnings: Vec<Diagnostic> = graph.warnings().iter().chain(plan).cloned().collect();
    if !warnings.is_empty() {
        sink.warnings(&warnings);
    }
}
