//! Mistakes of graphs, as they are shown.

use crate::error::CliError;
use crate::terminal::console::{colour, note};
use crate::wording::plural;
use skiagraph_graph::{Diagnostic, Diagnostics, Graph, Severity, diagnostics};
use std::collections::BTreeSet;

/// Faults of several graphs, gathered so that all are shown, each once.
#[derive(Default)]
pub struct GraphFaults {
    rendered: Vec<String>,
    errors: usize,
    graphs: BTreeSet<String>,
}

impl GraphFaults {
    /// Adds the faults of one graph, which may be the same as under another viewport before.
    pub fn add(&mut self, graph: &str, diagnostics: &Diagnostics) {
        let rendered = diagnostics.render(colour());
        self.graphs.insert(graph.into());
        if !self.rendered.contains(&rendered) {
            self.errors += errors(diagnostics).count();
            self.rendered.push(rendered);
        }
    }

    /// The faults of one graph alone, as an error.
    pub fn one(graph: &str, diagnostics: &Diagnostics) -> CliError {
        let mut faults = Self::default();
        faults.add(graph, diagnostics);
        faults.into_error()
    }

    /// An error if there are any.
    ///
    /// # Errors
    /// [`CliError::Diagnostics`].
    pub fn none_or_error(self) -> Result<(), CliError> {
        if self.graphs.is_empty() {
            Ok(())
        } else {
            Err(self.into_error())
        }
    }

    fn into_error(self) -> CliError {
        let summary = format!(
            "{} in {}",
            plural(self.errors, "error"),
            plural(self.graphs.len(), "graph")
        );
        CliError::Diagnostics {
            rendered: self.rendered.concat(),
            summary,
        }
    }
}

fn errors(diagnostics: &Diagnostics) -> impl Iterator<Item = &Diagnostic> {
    let is_error = |diagnostic: &&Diagnostic| diagnostic.severity == Severity::Error;
    diagnostics.iter().filter(is_error)
}

/// The errors in one line each, for a table's footnote; of a help only its first line.
pub fn reasons(diagnostics: &Diagnostics) -> String {
    let line = |Diagnostic { message, help, .. }: &Diagnostic| match help {
        Some(help) => format!("{message} ({})", help.lines().next().unwrap_or_default()),
        None => message.clone(),
    };
    errors(diagnostics).map(line).collect::<Vec<_>>().join("; ")
}

/// Prints the warnings of a graph and of its plan on standard error.
pub fn warn(graph: &Graph, plan: &[Diagnostic]) {
    let warnings: Vec<Diagnostic> = graph.warnings().iter().chain(plan).cloned().collect();
    if !warnings.is_empty() {
        note(diagnostics::render(&warnings, colour()).trim_end());
    }
}
