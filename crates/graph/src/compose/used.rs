//! Finds the names that a document uses, and drops what it inherits by `extends` without using it.

use crate::diagnostics::Reports;
use crate::document::Document;
use crate::document::typed::each_include;
use crate::errors::compose::ComposeError;
use crate::language::{Leaf, Name};
use crate::shader::{Shader, Shaders};
use crate::source::{Located, Span};
use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

/// Names of materials and params that a document uses.
#[derive(Default)]
pub(crate) struct Used {
    pub materials: BTreeSet<String>,
    pub params: BTreeSet<String>,
}

impl Used {
    pub fn new(document: &Document, shaders: &Shaders) -> Self {
        let mut used = Self::default();
        document.visit(&mut |leaf| match leaf {
            Leaf::Param(name) => drop(used.params.insert(name.to_owned())),
            Leaf::Word(name) => drop(used.params.insert(name.to_string())),
            Leaf::Material(reference) => drop(
                used.materials
                    .insert(reference.segments[0].name.to_string()),
            ),
            Leaf::Constant(_) | Leaf::Has(_) => {}
        });
        for pass in document.passes() {
            let variants = pass.shaders.iter();
            for shader in variants.flat_map(|shader| shaders.variants(document, shader)) {
                used.params.extend(shader.params().map(str::to_owned));
                used.materials
                    .extend(shader.global_names().map(str::to_owned));
                used.choices(document, shader);
            }
        }
        for (_, _, inner) in document.includes() {
            let inputs = inner.inputs.iter().map(|input| input.name.to_string());
            used.materials.extend(inputs);
            let asked = inner.params.iter().filter(|param| param.default.is_none());
            used.params
                .extend(asked.map(|param| param.name.value.clone()));
        }
        used
    }

    /// Params of whose words the shader has constants.
    fn choices(&mut self, document: &Document, shader: &Shader) {
        let constants: BTreeSet<&str> = shader.constants().collect();
        for param in &document.params {
            let prefix = format!("{}_", param.name.value.replace('.', "_").to_uppercase());
            if constants.iter().any(|name| name.starts_with(&prefix)) {
                self.params.insert(param.name.value.clone());
            }
        }
    }
}

/// Drops params, values, inputs and materials that a document inherits by `extends` and does not
/// use, in the document and in all that it includes. Warns of a default for a dropped param.
/// `documents` holds the included documents that are done, by path.
pub(crate) fn drop_unused(
    document: &mut Document,
    shaders: &Shaders,
    documents: &mut HashMap<Arc<str>, Arc<Document>>,
    reports: &mut Reports,
) {
    let mut given: Vec<Span> = Vec::new();
    each_include(&mut document.entries, &mut |include| {
        let Some(Ok(inner)) = &mut include.document else {
            return;
        };
        let path = Arc::clone(&inner.file.name);
        if !documents.contains_key(&path) {
            let mut document = Document::clone(inner);
            drop_unused(&mut document, shaders, documents, reports);
            documents.insert(Arc::clone(&path), Arc::new(document));
        }
        *inner = Arc::clone(&documents[&path]);
        let is_there = |name: &Located<String>| inner.params.iter().any(|it| *it.name == **name);
        include.expose.names.retain(is_there);
        given.extend(inner.params.iter().map(|param| param.name.span.clone()));
    });
    let exposed = document.params.split_off(document.declared);
    let file = Arc::clone(&document.file.name);
    let is_own = |span: &Span| span.file.name == file;
    loop {
        let used = Used::new(document, shaders);
        let is_used = |name: &str| used.params.contains(name) || used.materials.contains(name);
        let is_kept = |name: &Located<Name>| is_own(&name.span) || is_used(name.as_str());
        let count = |it: &Document| {
            it.params.len() + it.values.len() + it.inputs.len() + it.materials.len()
        };
        let before = count(document);
        document.materials.retain(|it| is_kept(it.name()));
        document.inputs.retain(|it| is_kept(&it.name));
        document.values.retain(|(name, _)| is_kept(name));
        document.params.retain(|param| {
            let is_kept = is_own(&param.name.span) || used.params.contains(&param.name.value);
            let default = param.default.as_ref();
            let default = default.filter(|it| !is_kept && is_own(&it.span));
            if let Some(default) = default {
                let name = Located::new(param.name.value.clone(), default.span.clone());
                reports.warn(ComposeError::Unused("param", name));
            }
            is_kept
        });
        document.declared = document.params.len();
        if count(document) == before {
            break;
        }
    }
    let exposed = exposed.into_iter();
    let exposed = exposed.filter(|param| given.contains(&param.name.span));
    document.params.extend(exposed);
}
