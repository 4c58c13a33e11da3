//! Names that must be free: of materials, groups, includes and what these give, of passes, of
//! outputs.

use crate::{
    diagnostics::reports::Reports,
    document::{
        raw::Invalid,
        typed::{Document, Entry, What},
    },
    errors::compose::ComposeError,
    language::name::{Name, wgsl_identifier},
    source::span::{Located, Span},
};
use std::collections::HashMap;

/// Reports every second one of a name. Conditions do not count: names are unique whatever they are.
pub(super) fn check(document: &Document, reports: &mut Reports) {
    let mut materials = Names::new("material");
    for input in &document.inputs {
        materials.add(&input.name.value, &input.name.span, reports);
    }
    for material in &document.materials {
        let name = material.name();
        materials.add(&name.value, &name.span, reports);
    }
    for (name, _) in &document.values {
        materials.add(&name.value, &name.span, reports);
        check_value(document, name, reports);
    }
    check_entries(
        &document.entries,
        &mut materials,
        &mut Names::new("pass"),
        "",
        reports,
    );
    check_openings(document, reports);
    let mut outputs = Names::new("output");
    for output in &document.outputs {
        outputs.add(&output.name.value, &output.name.span, reports);
    }
}

/// A value is told apart from params, and from words that stand where it may.
fn check_value(document: &Document, name: &Located<Name>, reports: &mut Reports) {
    for param in &document.params {
        if *param.name.value == *name.value.as_str() {
            reports.report(ComposeError::SameName {
                what: "value",
                name: name.value.to_string(),
                span: name.span.clone(),
                first: param.name.span.clone(),
            });
        }
        if param.words().any(|word| *word == name.value) {
            reports.report(ComposeError::ValueIsWord {
                name: Located::new(name.value.to_string(), name.span.clone()),
                param: param.name.value.clone(),
                declared: param.name.span.clone(),
            });
        }
    }
}

/// The name of an open include is set as a param is, and told apart from them.
fn check_openings(document: &Document, reports: &mut Reports) {
    for (name, _) in document.openings() {
        let mut params = document.params.iter();
        if let Some(param) = params.find(|param| *param.name.value == *name.value.as_str()) {
            reports.report(ComposeError::SameName {
                what: "param and open include",
                name: name.value.to_string(),
                span: name.span.clone(),
                first: param.name.span.clone(),
            });
        }
    }
}

fn check_entries(
    entries: &[Result<Entry, Invalid>],
    materials: &mut Names,
    passes: &mut Names,
    prefix: &str,
    reports: &mut Reports,
) {
    for entry in entries.iter().flatten() {
        let (name, span) = (&entry.name.value, &entry.name.span);
        match &entry.what {
            What::Pass(_) => drop(passes.add(&format!("{prefix}{name}"), span, reports)),
            What::Group(inner) => {
                let prefix = format!("{prefix}{name}.");
                materials.add(name, span, reports);
                match entry.repeat {
                    // Materials of a repetition have names of their own outside.
                    Some(_) => {
                        let mut inside = Names::new("material");
                        check_entries(inner, &mut inside, passes, &prefix, reports);
                    }
                    None => check_entries(inner, materials, passes, &prefix, reports),
                }
            }
            What::Include(include) => {
                let is_first = materials.add(name, span, reports);
                // Which repetitions there are, and so their names, is not known yet.
                if entry.repeat.is_some() || !is_first {
                    continue;
                }
                let namespace = if include.is_named {
                    format!("{name}.")
                } else {
                    String::new()
                };
                let Some(document) = include.document() else {
                    continue;
                };
                for (number, output) in document.outputs.iter().enumerate() {
                    // Two of a name are told in that document.
                    let others = &document.outputs[..number];
                    if others
                        .iter()
                        .any(|other| other.name.value == output.name.value)
                    {
                        continue;
                    }
                    let is_own = |input: &crate::document::materials::Input| {
                        input.name.value == output.name.value
                    };
                    let bound = entry
                        .bind
                        .iter()
                        .any(|(name, _)| name.value == output.name.as_str());
                    let full = format!("{namespace}{}", output.name.value);
                    // Without a name of its own the include is known by what it gives.
                    let is_own_name = full == **name;
                    if !bound && !is_own_name && !document.inputs.iter().any(is_own) {
                        materials.add(&full, &include.graph.span, reports);
                    }
                }
            }
        }
    }
}

/// The names of one namespace, each with the place of the first one.
struct Names {
    what: &'static str,
    seen: HashMap<String, (String, Span)>,
}

impl Names {
    fn new(what: &'static str) -> Self {
        Self {
            what,
            seen: HashMap::new(),
        }
    }

    /// Adds a name. True if it was free.
    fn add(&mut self, name: &str, span: &Span, reports: &mut Reports) -> bool {
        let spelling = match self.what {
            "material" => wgsl_identifier(name),
            _ => name.to_owned(),
        };
        if let Some((known, first)) = self.seen.get(&spelling) {
            let (span, first) = (span.clone(), first.clone());
            let (name, known) = (name.to_owned(), known.clone());
            reports.report(if name == known {
                let what = self.what;
                ComposeError::SameName {
                    what,
                    name,
                    span,
                    first,
                }
            } else {
                ComposeError::Clash {
                    name,
                    known,
                    span,
                    first,
                }
            });
            return false;
        }
        self.seen.insert(spelling, (name.to_owned(), span.clone()));
        true
    }
}
