//! All mistakes of a document, in the order in which they are read.

use super::diagnostic::{Diagnostic, Label, Severity};
use std::fmt;

/// Most diagnostics that are printed, each with a piece of its file.
const MOST_SHOWN: usize = 200;

/// A non-empty list of diagnostics, errors first, in source order.
#[derive(Clone, Debug)]
pub struct Diagnostics(Vec<Diagnostic>);

impl Diagnostics {
    /// Sorts mistakes, and drops those that are told twice or too many.
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

    /// The diagnostics, in the order in which they are printed.
    pub fn iter(&self) -> std::slice::Iter<'_, Diagnostic> {
        self.0.iter()
    }

    /// All of them with the lines that they are about, coloured for a terminal or not.
    #[cfg(feature = "render")]
    pub fn render(&self, colour: bool) -> String {
        super::render::render(&self.0, colour)
    }
}

/// In plain words, a line per place; the feature `render` shows the places themselves.
impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, found) in self.0.iter().enumerate() {
            let severity = match found.severity {
                Severity::Error => "error",
                Severity::Warning => "warning",
            };
            let gap = if index > 0 { "\n" } else { "" };
            write!(
                f,
                "{gap}{severity}[{}]: {}",
                found.code.as_str(),
                found.message
            )?;
            for label in &found.labels {
                write!(f, "\n  --> {} {}", label.span, label.text)?;
            }
            if let Some(help) = &found.help {
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
