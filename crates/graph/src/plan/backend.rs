//! Graphs on a backend that gives less than WebGPU: refused unless proven there.

use crate::{errors::plan::OutputError, graph::Graph, request::PartialBackend};

/// The mistake of planning the graph for a backend that it does not list in `proven_on`.
pub(super) fn not_proven(graph: &Graph, backend: &PartialBackend) -> Option<OutputError> {
    let mut listed = graph.proven_on();
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
