//! Check for backends that lack part of WebGPU: a graph is refused unless it is proven there.

use crate::{compose::Loaded, errors::plan::OutputError, request::PartialBackend};

/// Returns the error for a backend that the graph does not list in `proven_on`; `None` if it lists
/// the backend.
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
