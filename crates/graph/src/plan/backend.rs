//! Graphs on a backend that gives less than WebGPU: refused unless proven there.

use crate::{compose::loaded::Loaded, errors::plan::OutputError, request::PartialBackend};

/// The mistake of planning the graph for a backend that it does not list in `proven_on`.
pub(super) fn not_proven(graph: &Loaded, backend: &PartialBackend) -> Option<OutputError> {
    let mut listed = graph.document.proven_on.iter();
    if listed.any(|word| word.as_str() == backend.name) {
        return None;
    }
    Some(OutputError::NotProven {
        graph: graph.document.file.name.to_string(),
        backend: backend.name.clone(),
        lacks: backend.lacks.clone(),
        place: graph.place(),
    })
}
