//! Collects the mistakes that the phases report.

use skiagraph_located_ron::diagnostics::{Diagnostic, Severity};
use std::collections::BTreeSet;

/// Number of mistakes at which the search for more ends.
const ENOUGH: usize = 1000;

/// Mistakes for which a document's names are searched: it may hold as many misspelt names as names,
/// and to compare all with all takes minutes.
const HINTED: usize = 50;

/// Proof that a mistake was reported, so that what follows from it need not be reported again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ErrorGuaranteed(());

/// A value, or the proof that a mistake in it was reported.
pub(crate) type Reported<T> = Result<T, ErrorGuaranteed>;

/// Collected mistakes of all phases.
#[derive(Clone, Debug, Default)]
pub(crate) struct Reports {
    list: Vec<Diagnostic>,
    errors: usize,
    /// True if the device that will run the graph is not known. Exceeding its limits and features
    /// is then a warning.
    pub any_adapter: bool,
    /// Params of the loaded document on which the plan depends; other values of these may lead to
    /// another plan or other mistakes.
    pub depends_on: BTreeSet<String>,
}

impl Reports {
    /// Returns the value of `result`, or reports its mistake and returns the proof of that.
    pub fn check<T>(&mut self, result: Result<T, impl Into<Diagnostic>>) -> Reported<T> {
        result.map_err(|mistake| self.report(mistake))
    }

    /// Reports a mistake: a typed one of a phase, or a diagnostic. Returns the proof that it was
    /// reported.
    pub fn report(&mut self, mistake: impl Into<Diagnostic>) -> ErrorGuaranteed {
        let diagnostic = mistake.into();
        self.errors += usize::from(diagnostic.severity == Severity::Error);
        self.list.push(diagnostic);
        ErrorGuaranteed(())
    }

    /// Reports a mistake as a warning, whatever its severity is.
    pub fn warn(&mut self, mistake: impl Into<Diagnostic>) {
        self.report(Diagnostic {
            severity: Severity::Warning,
            ..mistake.into()
        });
    }

    /// Reports that the device cannot do something that the graph needs. If the device is not known
    /// ([`any_adapter`](Self::any_adapter)), this is a warning, and the result is `Ok`.
    pub fn unsupported(&mut self, mistake: impl Into<Diagnostic>) -> Reported<()> {
        if self.any_adapter {
            self.warn(mistake);
            return Ok(());
        }
        Err(self.report(mistake))
    }

    /// Returns `names`, as candidates for a suggestion; empty once there are too many mistakes to
    /// search for suggestions.
    pub fn known<S: Into<String>>(&self, names: impl IntoIterator<Item = S>) -> Vec<String> {
        if self.list.len() < HINTED {
            names.into_iter().map(Into::into).collect()
        } else {
            Vec::new()
        }
    }

    /// Returns the number of errors, without warnings.
    pub fn errors(&self) -> usize {
        self.errors
    }

    /// True if more than 1,000 mistakes were reported, so that the search for more may end.
    pub fn has_enough(&self) -> bool {
        self.list.len() > ENOUGH
    }

    /// Iterates over the diagnostics reported so far, in the order in which they were reported.
    pub fn iter(&self) -> std::slice::Iter<'_, Diagnostic> {
        self.list.iter()
    }

    /// Notes that the plan depends on these params of the root document.
    pub fn depend_on<'n>(&mut self, params: impl Iterator<Item = &'n String>) {
        for param in params {
            if !self.depends_on.contains(param) {
                self.depends_on.insert(param.clone());
            }
        }
    }

    /// Returns all errors and warnings, in the order in which they were reported.
    pub fn into_list(self) -> Vec<Diagnostic> {
        self.list
    }
}
