//! Reads a document, whatever is wrong with some of it.

use super::{
    entries,
    extend::no_edits,
    materials::{BufferInput, Input, Material, SamplerInput, TextureInput},
    params,
    raw::{RawDocument, RawItem, RawMap},
    typed::Document,
};
use crate::{
    diagnostics::{
        diagnostic::Diagnostic,
        reports::{ErrorGuaranteed, Reports},
    },
    errors::{document::DocumentError, language::SyntaxFault},
    fields::one_line,
    kinds::registry::Registry,
    language::{
        name::{Name, RESERVED},
        syntax::Expr,
    },
    source::span::Located,
};
use skiagraph_located_ron::reader::{Node, from_fields};
use std::collections::BTreeSet;

/// Reads a document and reports its mistakes. Its readable part is returned all the same, so that
/// later phases find more mistakes in one go.
pub(crate) fn document(raw: RawDocument, registry: &Registry, reports: &mut Reports) -> Document {
    let mut document = Document {
        description: String::new(),
        requires: Vec::new(),
        params: Vec::new(),
        declared: 0,
        defaults: Vec::new(),
        values: Vec::new(),
        narrow: Vec::new(),
        imports: Vec::new(),
        inputs: Vec::new(),
        materials: Vec::new(),
        entries: Vec::new(),
        outputs: Vec::new(),
        lights: Vec::new(),
        proven_on: Vec::new(),
        claims: Vec::new(),
        broken_materials: Vec::new(),
        invalid_params: raw.invalid_params,
        broken_outputs: None,
        incomplete: raw.incomplete,
        gives_values: BTreeSet::new(),
        include_depth: 0,
        extended: raw.extended,
        file: raw.file,
    };
    if let Some(node) = &raw.description {
        keep(node.parse(), reports, |text: String| {
            document.description = one_line(&text);
        });
    }
    for node in &raw.requires {
        keep(feature(node), reports, |feature| {
            document.requires.push(feature)
        });
    }
    for item in &raw.params {
        match params::read(&item.tag, &item.fields) {
            Ok(param) => document.params.push(param),
            Err(error) => document.invalid_params = Some(reports.report(error)),
        }
    }
    document.declared = document.params.len();
    for item in &raw.inputs {
        let input = input(item).and_then(|input| free(input.name.clone(), input));
        match input {
            Ok(input) => document.inputs.push(input),
            Err(error) => lacks(&mut document, item.name(), reports.report(error)),
        }
    }
    for item in &raw.materials {
        let material = material(item).and_then(|read| free(read.name().clone(), read));
        match material {
            Ok(material) => document.materials.push(material),
            Err(error) => lacks(&mut document, item.name(), reports.report(error)),
        }
    }
    let mut passes = raw.passes;
    no_edits(&mut passes, reports);
    document.entries = entries::read(passes, registry, reports);
    for node in &raw.outputs {
        match node.parse() {
            Ok(output) => document.outputs.push(output),
            Err(error) => document.broken_outputs = Some(reports.report(error)),
        }
    }
    for (name, node) in raw.set {
        keep(node.parse(), reports, |value| {
            document.defaults.push((name, value))
        });
    }
    values(&mut document, raw.values, raw.narrow, &raw.imports, reports);
    promises(
        &mut document,
        (&raw.lights, &raw.proven_on),
        raw.claims,
        reports,
    );
    document
}

/// Reads what expressions and shaders are given by name.
fn values(
    document: &mut Document,
    values: RawMap,
    narrow: RawMap,
    imports: &[Node],
    reports: &mut Reports,
) {
    for (name, node) in values {
        match value(name.clone(), &node) {
            Ok(value) => document.values.push(value),
            Err(error) => lacks(document, Some(name), reports.report(error)),
        }
    }
    for (name, node) in narrow {
        keep(node.parse(), reports, |narrow| {
            document.narrow.push((name, narrow))
        });
    }
    for node in imports {
        keep(node.parse(), reports, |entry| document.imports.push(entry));
    }
}

/// Reads what the document says of itself as a method.
fn promises(
    document: &mut Document,
    (lights, proven_on): (&[Node], &[Node]),
    claims: RawMap,
    reports: &mut Reports,
) {
    for node in lights {
        keep(node.parse(), reports, |kind| document.lights.push(kind));
    }
    for node in proven_on {
        keep(node.parse(), reports, |backend| {
            document.proven_on.push(backend)
        });
    }
    for (name, node) in claims {
        keep(node.parse(), reports, |value| {
            document.claims.push((name, value))
        });
    }
}

/// Notes what cannot be read, by its name if that can.
fn lacks(document: &mut Document, name: Option<Located<String>>, reported: ErrorGuaranteed) {
    match name {
        Some(name) => document.broken_materials.push((name.value, reported)),
        None => document.incomplete = Some(reported),
    }
}

fn keep<T>(result: Result<T, Diagnostic>, reports: &mut Reports, keep: impl FnOnce(T)) {
    match result {
        Ok(value) => keep(value),
        Err(error) => drop(reports.report(error)),
    }
}

/// A value whose name is free to be one.
fn value(name: Located<String>, node: &Node) -> Result<(Located<Name>, Expr), Diagnostic> {
    let span = name.span.clone();
    let wrong = |fault| DocumentError::Name(span, name.value.clone(), fault);
    let named = Located::new(Name::new(&name).map_err(wrong)?, name.span.clone());
    let value = node.parse()?;
    free(named.clone(), (named, value))
}

/// A material whose name is free to be one.
fn free<T>(name: Located<Name>, of: T) -> Result<T, Diagnostic> {
    if RESERVED.contains(&name.as_str()) {
        Err(DocumentError::Reserved(name).into())
    } else {
        Ok(of)
    }
}

fn feature(node: &Node) -> Result<(Located<String>, wgt::Features), Diagnostic> {
    let name = Located::new(node.parse::<String>()?, node.span.clone());
    match wgt::Features::from_name(&name) {
        Some(flag) => Ok((name, flag)),
        None => Err(SyntaxFault::Feature(name).into()),
    }
}

fn material(item: &RawItem) -> Result<Material, Diagnostic> {
    let (fields, tag) = (&item.fields, &item.tag);
    match tag.as_str() {
        "Texture" => from_fields(fields, &tag.span).map(Material::Texture),
        "Buffer" => from_fields(fields, &tag.span).map(Material::Buffer),
        "Sampler" => from_fields(fields, &tag.span).map(Material::Sampler),
        _ => Err(DocumentError::UnknownMaterial(tag.clone()).into()),
    }
}

fn input(item: &RawItem) -> Result<Input, Diagnostic> {
    let (fields, tag) = (&item.fields, &item.tag);
    match tag.as_str() {
        "Texture" => {
            let texture: TextureInput = from_fields(fields, &tag.span)?;
            Ok(Input::try_from(texture)?)
        }
        "Buffer" => from_fields::<BufferInput>(fields, &tag.span).map(Input::from),
        "Sampler" => from_fields::<SamplerInput>(fields, &tag.span).map(Input::from),
        _ => Err(DocumentError::UnknownMaterial(tag.clone()).into()),
    }
}
