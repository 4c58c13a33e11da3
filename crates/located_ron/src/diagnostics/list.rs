//! The list of all diagnostics of a document, sorted for printing.

use super::diagnostic::{Diagnostic, Label, Severity};
use std::fmt;

/// Most diagnostics that are printed, each with a piece of its file.
const MOST_SHOWN: usize = 200;

/// A sorted list of diagnostics, such as all those of a document: errors before warnings, and both
/// by file name and place.
#[derive(Clone, Debug)]
pub struct Diagnostics(Vec<Diagnostic>);

impl Diagnostics {
    /// Creates a list from `list`: sorts the diagnostics and drops duplicates, which have the same
    /// message at the same place. If there are more than 200, those after the first 200 are
    /// replaced by one that counts them.
    pub fn new(mut list: Vec<Diagnostic>) -> Self {
        list.sort_by(|a, b| a.key().cmp(&b.key()));
        list.dedup_by(|a, b| a.message == b.message && a.key() == b.key());
        if let Some(first) = list.get(MOST_SHOWN) {
            let rest = list.len() - MOST_SHOWN;
            let mut more = Diagnostic::error(first.code, format!("and {rest} mistakes more"));
            let place = first.labels.first();
            more.labels.extend(place.map(|label| Label {
                span: label.span.clone(),
                text: "the next one".to_owned(),
            }));
            list.truncate(MOST_SHOWN);
            list.push(more.help("mend those above first: what is left may follow from them"));
        }
        Self(list)
    }

    /// Iterates over the diagnostics: errors before warnings, and both by file name and place.
    pub fn iter(&self) -> std::slice::Iter<'_, Diagnostic> {
        self.0.iter()
    }

    /// Returns all diagnostics as text for a terminal, in the order of the list, each with the
    /// source lines that it is about. `colour` adds ANSI colours.
    #[cfg(feature = "render")]
    pub fn render(&self, colour: bool) -> String {
        super::render::render(&self.0, colour)
    }
}

/// Prints each diagnostic as plain text: severity, kind and message, then a line per place, then
/// the help. The feature `render` prints the source lines, too.
impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, diagnostic) in self.0.iter().enumerate() {
            let severity = match diagnostic.severity {
                Severity::Error => "error",
                Severity::Warning => "warning",
            };
            let gap = if index > 0 { "\n" } else { "" };
            write!(
                f,
                "{gap}{severity}[{}]: {}",
                diagnostic.code.as_str(),
                diagnostic.message
            )?;
            for label in &diagnostic.labels {
                write!(f, "\n  --> {} {}", label.span, label.text)?;
            }
            if let Some(help) = &diagnostic.help {
                write!(f, "\n  help: {}", help.replace('\n', "\n        "))?;
            }
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostics {}

impl From<Diagnostic> for Diagnostics {
    fn from(diagnostic: Diagnostic) -> Self {
        Self(vec![diagnostic])
    }
}
