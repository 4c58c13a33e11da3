//! Graphs on a backend that gives less than WebGPU: refused unless proven there.

use super::plan::Plan;
use crate::{
    diagnostics::{list::Diagnostics, reports::Reports},
    errors::plan::OutputError,
    graph::Graph,
    request::PartialBackend,
};

impl Graph {
    /// The mistake of planning the graph for a backend that it does not list in `proven_on`.
    pub(super) fn not_proven(&self, backend: &PartialBackend) -> Option<OutputError> {
        let mut listed = self.proven_on();
        if listed.any(|word| word.as_str() == backend.name) {
            return None;
        }
        Some(OutputError::NotProven {
            graph: self.document.file.name.to_string(),
            backend: backend.name.clone(),
            lacks: backend.lacks.clone(),
            place: self.place(),
        })
    }
}

impl Plan {
    /// Finds out if the plan may run on a backend that gives less than WebGPU, whichever it was
    /// made for.
    ///
    /// # Errors
    /// If the graph's document does not list the backend in `proven_on`.
    pub fn check_backend(&self, backend: &PartialBackend) -> Result<(), Diagnostics> {
        let Some(error) = self.graph.not_proven(backend) else {
            return Ok(());
        };
        let mut reports = Reports::default();
        reports.report(error);
        Err(self.graph.diagnostics(reports.into_list()))
    }
}
