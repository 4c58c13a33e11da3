//! Names of entry points, or one of two by a condition.

use super::kind::Lowering;
use crate::{fields::by_text, language::Expr, source::Located};
use skiagraph_located_ron::reader::read;

/// The name of a shader's entry point, or one of two: `"masked ? fragment_masked : none"`.
#[derive(Clone, Debug)]
pub(crate) enum EntryName {
    Name(Located<String>),
    Choice(Expr),
}

/// Word for no entry point in an [`EntryName`].
const NO_ENTRY: &str = "none";

by_text!(EntryName, |text, _| if text.contains('?') {
    read(text).map(Self::Choice)
} else {
    read(text).map(Self::Name)
});

impl EntryName {
    /// Returns the chosen name; `None` for the word `none`.
    pub fn chosen(&self, pass: &mut Lowering<'_>) -> Option<Located<String>> {
        let name = match self {
            Self::Name(name) => name.clone(),
            Self::Choice(expr) => {
                let chosen = pass.branch(expr);
                Located::new(chosen.text().to_owned(), chosen.span.clone())
            }
        };
        (*name != NO_ENTRY).then_some(name)
    }
}

#[cfg(feature = "schema")]
crate::written::written!(EntryName, "EntryName", _generator => {
    schemars::json_schema!({
        "description": "The name of an entry point, or by a condition one of two, of which `none` \
            is no entry point.",
        "type": "string",
    })
});
