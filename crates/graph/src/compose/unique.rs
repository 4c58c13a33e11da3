//! Checks that names are unique: those of materials, groups, includes and their outputs, of passes,
//! and of a document's outputs.

use crate::diagnostics::Reports;
use crate::document::{Document, Entry, Invalid, What};
use crate::errors::compose::ComposeError;
use crate::language::{Name, wgsl_identifier};
use crate::source::Located;
use std::collections::HashMap;

/// Reports each name that is declared twice. Conditions do not count: two declarations may not
/// share a name even if only one of them can exist.
pub(super) fn check(document: &Document, reports: &mut Reports) {
    let mut materials = Names::new("material");
    for input in &document.inputs {
        materials.add(input.name.text(), reports);
    }
    for material in &document.materials {
        materials.add(material.name().text(), reports);
    }
    for (name, _) in &document.values {
        materials.add(name.text(), reports);
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
        outputs.add(output.name.text(), reports);
    }
}

/// A value is told apart from params, and from words that stand where it may.
fn check_value(document: &Document, name: &Located<Name>, reports: &mut Reports) {
    for param in &document.params {
        if *param.name.value == *name.value.as_str() {
            let first = param.name.span.clone();
            reports.report(ComposeError::SameName("value", name.text(), first));
        }
        if param.words().any(|word| *word == name.value) {
            reports.report(ComposeError::ValueIsWord(name.clone(), param.name.clone()));
        }
    }
}

/// The name of an open include is set as a param is, and told apart from them.
fn check_openings(document: &Document, reports: &mut Reports) {
    for (name, _) in document.openings() {
        if let Some(param) = document.param(name.as_str()) {
            let (what, first) = ("param and open include", param.name.span.clone());
            reports.report(ComposeError::SameName(what, name.text(), first));
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
        let name = &entry.name;
        match &entry.what {
            What::Pass(_) => {
                let name = Located::new(format!("{prefix}{name}"), name.span.clone());
                passes.add(name, reports);
            }
            What::Group(inner) => {
                let prefix = format!("{prefix}{name}.");
                materials.add(name.text(), reports);
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
                let is_first = materials.add(name.text(), reports);
                // Which repetitions there are, and so their names, is not known yet.
                if entry.repeat.is_some() || !is_first {
                    continue;
                }
                let Some(document) = include.document() else {
                    continue;
                };
                for (number, output) in document.outputs.iter().enumerate() {
                    let output = &output.name;
                    // Two of a name are told in that document.
                    let earlier = &document.outputs[..number];
                    let is_second = earlier.iter().any(|other| other.name.value == output.value);
                    let full = entry.outer_name(include, output);
                    let mut bound = entry.bind.iter();
                    let mut inputs = document.inputs.iter();
                    // Without a name of its own the include is known by what it gives.
                    if !is_second
                        && full != *name.value
                        && bound.all(|(name, _)| name.value != output.as_str())
                        && inputs.all(|input| input.name.value != output.value)
                    {
                        let full = Located::new(full, include.graph.span.clone());
                        materials.add(full, reports);
                    }
                }
            }
        }
    }
}

/// The names of one namespace, by their spelling, each as the first one has it.
struct Names {
    what: &'static str,
    seen: HashMap<String, Located<String>>,
}

impl Names {
    fn new(what: &'static str) -> Self {
        Self {
            what,
            seen: HashMap::new(),
        }
    }

    /// Adds a name. True if it was free.
    fn add(&mut self, name: Located<String>, reports: &mut Reports) -> bool {
        let spelling = match self.what {
            "material" => wgsl_identifier(&name),
            _ => name.value.clone(),
        };
        let Some(first) = self.seen.get(&spelling) else {
            self.seen.insert(spelling, name);
            return true;
        };
        reports.report(if name.value == first.value {
            ComposeError::SameName(self.what, name, first.span.clone())
        } else {
            ComposeError::Clash(name, first.clone())
        });
        false
    }
}
