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

use crate::error::CompareError;
use crate::sink::Sink;
use crate::wording::plural;
use skiagraph_graph::{Diagnostic, Diagnostics, Graph, Severity};
use std::collections::BTreeSet;

/// Faults of several graphs, collected to be shown together, equal ones once.
#[derive(Default)]
pub struct GraphFaults {
    rendered: Vec<String>,
    faults: Vec<Vec<Diagnostic>>,
    errors: usize,
    graphs: BTreeSet<String>,
}

impl GraphFaults {
    /// Adds the faults of the graph named `graph`. Faults equal to ones that were added before, for
    /// example by planning for another viewport, are not repeated.
    pub fn add(&mut self, graph: &str, diagnostics: &Diagnostics) {
        let rendered = diagnostics.render(false);
        self.graphs.insert(graph.into());
        if !self.rendered.contains(&rendered) {
            self.errors += errors(diagnostics).count();
            self.faults.push(diagnostics.iter().cloned().collect());
            self.rendered.push(rendered);
        }
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
    pub fn none_or_error(self) -> Result<(), CompareError> {
        if self.graphs.is_empty() {
            Ok(())
        } else {
            Err(self.into_error())
        }
    }

    fn into_error(self) -> CompareError {
        let summary = format!(
            "{} in {}",
            plural(self.errors, "error"),
            plural(self.graphs.len(), "graph")
        );
        CompareError::Diagnostics {
            faults: self.faults,
            summary,
        }
    }
}

fn errors(diagnostics: &Diagnostics) -> impl Iterator<Item = &Diagnostic> {
    let is_error = |diagnostic: &&Diagnostic| diagnostic.severity == Severity::Error;
    diagnostics.iter().filter(is_error)
}

/// Returns the errors among `diagnostics`, without warnings, as one line for a table's footnote.
/// Only the first line of each help text is included.
pub fn reasons(diagnostics: &Diagnostics) -> String {
    let line = |Diagnostic { message, help, .. }: &Diagnostic| match help {
        Some(help) => format!("{message} ({})", help.lines().next().unwrap_or_default()),
        None => message.clone(),
    };
    errors(diagnostics).map(line).collect::<Vec<_>>().join("; ")
}

/// Passes the warnings of a graph and of its plan to a sink, if there are any.
pub fn warn(sink: &dyn Sink, graph: &Graph, plan: &[Diagnostic]) {
    let warnings: Vec<Diagnostic> = graph.warnings().iter().chain(plan).cloned().collect();
    if !warnings.is_empty() {
        sink.warnings(&warnings);
    }
}
