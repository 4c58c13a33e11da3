//! Reads the sections of a document; a mistake in one part does not hide the others.

use super::extend::no_edits;
use super::materials::{
    BufferInput, FormatEntry, Input, InputKind, Material, SamplerInput, TextureInput,
};
use super::raw::{RawDocument, RawItem, RawMap};
use super::typed::Document;
use super::{entries, params};
use crate::diagnostics::{Diagnostic, ErrorGuaranteed, Reports};
use crate::errors::document::DocumentError;
use crate::errors::language::SyntaxFault;
use crate::fields::one_line;
use crate::kinds::Registry;
use crate::language::{Expr, Name, RESERVED};
use crate::source::Located;
use serde::de::DeserializeOwned;
use skiagraph_located_ron::{fields::from_fields, reader::Node};

/// Reads a document and reports its mistakes. The readable part is returned in any case, so that
/// later phases find more mistakes in one go.
pub(crate) fn document(raw: RawDocument, registry: &Registry, reports: &mut Reports) -> Document {
    let description = raw.description.map(|node| reports.check(node.parse()));
    let description: String = description.and_then(Result::ok).unwrap_or_default();
    let mut document = Document {
        description: one_line(&description),
        requires: read_list(&raw.requires, feature, reports),
        needs: read_list(&raw.needs, Node::parse, reports),
        invalid_params: raw.invalid_params,
        incomplete: raw.incomplete,
        extended: raw.extended,
        file: raw.file,
        ..Document::default()
    };
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
    document.defaults = read_map(raw.set, reports);
    for (name, node) in raw.values {
        match value(name.clone(), &node) {
            Ok(value) => document.values.push(value),
            Err(error) => lacks(&mut document, Some(name), reports.report(error)),
        }
    }
    document.narrow = read_map(raw.narrow, reports);
    document.imports = read_list(&raw.imports, Node::parse, reports);
    document.lights = read_list(&raw.lights, Node::parse, reports);
    document.proven_on = read_list(&raw.proven_on, Node::parse, reports);
    document.claims = read_map(raw.claims, reports);
    document
}

/// The entries of a list that can be read.
fn read_list<T>(
    list: &[Node],
    read: impl Fn(&Node) -> Result<T, Diagnostic>,
    reports: &mut Reports,
) -> Vec<T> {
    let read = |node| reports.check(read(node)).ok();
    list.iter().filter_map(read).collect()
}

/// The entries of a map that can be read.
fn read_map<T: DeserializeOwned>(map: RawMap, reports: &mut Reports) -> Vec<(Located<String>, T)> {
    let read = |(name, node): (_, Node)| Some((name, reports.check(node.parse()).ok()?));
    map.into_iter().filter_map(read).collect()
}

/// Notes what cannot be read, by its name if that can.
fn lacks(document: &mut Document, name: Option<Located<String>>, reported: ErrorGuaranteed) {
    match name {
        Some(name) => document.broken_materials.push((name.value, reported)),
        None => document.incomplete = Some(reported),
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
fn free<T>(name: Located<Name>, declaration: T) -> Result<T, Diagnostic> {
    if RESERVED.contains(&name.as_str()) {
        Err(DocumentError::Reserved(name).into())
    } else {
        Ok(declaration)
    }
}

fn feature(node: &Node) -> Result<(Located<String>, wgt::Features), Diagnostic> {
    let name = Located::new(node.parse::<String>()?, node.clone());
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
    let (name, kind) = match tag.as_str() {
        "Texture" => {
            let TextureInput { name, format } = from_fields(fields, &tag.span)?;
            let format = match format {
                None => None,
                Some(FormatEntry::Named(format)) => Some(format),
                Some(FormatEntry::Expr(expr)) => {
                    return Err(DocumentError::InputFormat(expr.span).into());
                }
            };
            (name, InputKind::Texture(format))
        }
        "Buffer" => {
            let BufferInput { name } = from_fields(fields, &tag.span)?;
            (name, InputKind::Buffer)
        }
        "Sampler" => {
            let SamplerInput { name, compare } = from_fields(fields, &tag.span)?;
            (name, InputKind::Sampler { compare })
        }
        _ => return Err(DocumentError::UnknownMaterial(tag.clone()).into()),
    };
    Ok(Input { name, kind })
}
