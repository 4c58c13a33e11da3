//! A document with everything in it read, and nothing looked up.

use super::{
    entries::{self, Entry, Run, What},
    extend::no_edits,
    fields::short_or_long,
    materials::{BufferInput, Input, Material, SamplerInput, TextureInput},
    params::Param,
    raw::{Broken, RawDocument, RawItem},
    ron::{Node, from_fields, raw, read as read_part},
};
use crate::{
    diagnostics::{
        diagnostic::Diagnostic,
        reports::{Mistake, Reported, Reports},
    },
    errors::document::DocumentError,
    kinds::registry::Registry,
    language::{
        name::{Name, RESERVED},
        syntax::{Expr, Leaf, Reference},
    },
    source::span::{Located, SourceFile},
};
use serde::{Deserialize, Deserializer};

/// A document as its author wrote it.
#[derive(Debug)]
pub(crate) struct Document {
    pub file: SourceFile,
    pub description: String,
    pub requires: Vec<(Located<String>, wgt::Features)>,
    /// The params that it declares, then those that it exposes.
    pub params: Vec<Param>,
    /// How many of them it declares.
    pub declared: usize,
    /// Other defaults for exposed params.
    pub defaults: Vec<(Located<String>, Expr)>,
    pub inputs: Vec<Input>,
    pub materials: Vec<Material>,
    pub entries: Vec<Result<Entry, Broken>>,
    pub outputs: Vec<Output>,
    pub claims: Vec<(Located<String>, ClaimEntry)>,
    /// Names of materials and inputs that could not be read.
    pub broken_materials: Vec<(String, Reported)>,
    /// A param could not be read: nothing of the document has a size then.
    pub broken_params: Option<Reported>,
    /// Something could not be read, and nobody knows which names it would have given.
    pub incomplete: Option<Reported>,
    /// An output could not be read: nobody knows what it would have been called.
    pub broken_outputs: Option<Reported>,
    /// How many includes there are one within the other below this document.
    pub include_depth: usize,
}

/// What a method promises: `(if: "n >= 0.5", because: "…")`, or the condition alone.
#[derive(Clone, Debug)]
pub(crate) struct ClaimEntry {
    /// `None`: always.
    pub condition: Option<Expr>,
    pub because: String,
}

impl<'de> Deserialize<'de> for ClaimEntry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(rename = "claim", deny_unknown_fields)]
        struct Long {
            #[serde(default, rename = "if")]
            condition: Option<Expr>,
            #[serde(default)]
            because: String,
        }
        let (text, _) = raw(deserializer)?;
        if !text.starts_with('(') {
            return Ok(Self {
                condition: Some(read_part(text)?),
                because: String::new(),
            });
        }
        let long: Long = read_part(text)?;
        Ok(Self {
            condition: long.condition,
            because: long.because,
        })
    }
}

/// What includer and host see.
#[derive(Clone, Debug)]
pub(crate) struct Output {
    pub name: Located<Name>,
    pub material: Reference,
    /// Whether it is there.
    pub condition: Option<Expr>,
}

impl<'de> Deserialize<'de> for Output {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Long {
            name: Located<Name>,
            #[serde(default)]
            material: Option<Reference>,
            #[serde(default, rename = "if")]
            condition: Option<Expr>,
        }
        let named = |name: Located<Name>, material: Option<Reference>, condition| Self {
            material: material.unwrap_or_else(|| Reference::of(name.clone())),
            name,
            condition,
        };
        short_or_long(
            deserializer,
            |long: Long| named(long.name, long.material, long.condition),
            |short: Reference| {
                let name = short.segments[0].name.clone();
                named(name, Some(short), None)
            },
        )
    }
}

/// Reads what a document holds. What is wrong is reported; what could be read is returned all the
/// same, so that later phases find more mistakes in one go.
pub(crate) fn read(raw: RawDocument, registry: &Registry, reports: &mut Reports) -> Document {
    let mut document = Document {
        description: String::new(),
        requires: Vec::new(),
        params: Vec::new(),
        declared: 0,
        defaults: Vec::new(),
        inputs: Vec::new(),
        materials: Vec::new(),
        entries: Vec::new(),
        outputs: Vec::new(),
        claims: Vec::new(),
        broken_materials: Vec::new(),
        broken_params: raw.broken_params,
        broken_outputs: None,
        incomplete: raw.incomplete,
        include_depth: 0,
        file: raw.file,
    };
    if let Some(node) = &raw.description {
        keep(node.parse(), reports, |text| document.description = text);
    }
    for node in &raw.requires {
        keep(feature(node), reports, |feature| {
            document.requires.push(feature)
        });
    }
    for item in &raw.params {
        match Param::read(&item.tag, &item.fields) {
            Ok(param) => document.params.push(param),
            Err(error) => document.broken_params = Some(reports.tell(error)),
        }
    }
    document.declared = document.params.len();
    for item in &raw.inputs {
        let input = input(item).and_then(|input| free(input.name.clone(), input));
        match input {
            Ok(input) => document.inputs.push(input),
            Err(error) => {
                let reported = reports.tell(error);
                match item.name() {
                    Some(name) => document.broken_materials.push((name.value, reported)),
                    None => document.incomplete = Some(reported),
                }
            }
        }
    }
    for item in &raw.materials {
        let material = material(item).and_then(|read| free(read.name().clone(), read));
        match material {
            Ok(material) => document.materials.push(material),
            Err(error) => {
                let reported = reports.tell(error);
                match item.name() {
                    Some(name) => document.broken_materials.push((name.value, reported)),
                    None => document.incomplete = Some(reported),
                }
            }
        }
    }
    let mut passes = raw.passes;
    no_edits(&mut passes, reports);
    document.entries = entries::read(passes, registry, reports);
    for node in &raw.outputs {
        match node.parse() {
            Ok(output) => document.outputs.push(output),
            Err(error) => document.broken_outputs = Some(reports.tell(error)),
        }
    }
    for (name, node) in raw.set {
        keep(node.parse(), reports, |value| {
            document.defaults.push((name, value))
        });
    }
    for (name, node) in raw.claims {
        keep(node.parse(), reports, |value| {
            document.claims.push((name, value))
        });
    }
    document
}

fn keep<T>(result: Result<T, Diagnostic>, reports: &mut Reports, keep: impl FnOnce(T)) {
    match result {
        Ok(value) => keep(value),
        Err(error) => drop(reports.tell(error)),
    }
}

/// A material whose name is free to be one.
fn free<T>(name: Located<Name>, of: T) -> Result<T, Diagnostic> {
    match RESERVED.contains(&name.as_str()) {
        true => Err(DocumentError::Reserved(name).diagnostic()),
        false => Ok(of),
    }
}

fn feature(node: &Node) -> Result<(Located<String>, wgt::Features), Diagnostic> {
    let name = Located::new(node.parse::<String>()?, node.span.clone());
    match wgt::Features::from_name(&name) {
        Some(flag) => Ok((name, flag)),
        None => Err(crate::errors::language::SyntaxFault::Feature(name).diagnostic()),
    }
}

fn material(item: &RawItem) -> Result<Material, Diagnostic> {
    let (fields, tag) = (&item.fields, &item.tag);
    match tag.as_str() {
        "Texture" => from_fields(fields, &tag.span).map(Material::Texture),
        "Buffer" => from_fields(fields, &tag.span).map(Material::Buffer),
        "Sampler" => from_fields(fields, &tag.span).map(Material::Sampler),
        _ => Err(DocumentError::UnknownMaterial(tag.clone()).diagnostic()),
    }
}

fn input(item: &RawItem) -> Result<Input, Diagnostic> {
    let (fields, tag) = (&item.fields, &item.tag);
    match tag.as_str() {
        "Texture" => {
            let texture: TextureInput = from_fields(fields, &tag.span)?;
            Input::try_from(texture).map_err(Mistake::diagnostic)
        }
        "Buffer" => from_fields::<BufferInput>(fields, &tag.span).map(Input::from),
        "Sampler" => from_fields::<SamplerInput>(fields, &tag.span).map(Input::from),
        _ => Err(DocumentError::UnknownMaterial(tag.clone()).diagnostic()),
    }
}

impl Document {
    /// Calls `each` with everything that expressions and references of the document are made of.
    pub fn visit<'a>(&'a self, each: &mut dyn FnMut(Leaf<'a>)) {
        for param in &self.params[..self.declared] {
            param.default.iter().for_each(|default| default.visit(each));
        }
        let claims = self
            .claims
            .iter()
            .filter_map(|(_, claim)| claim.condition.as_ref());
        for value in claims.chain(self.defaults.iter().map(|(_, value)| value)) {
            value.visit(each);
        }
        for material in &self.materials {
            material.visit(each);
        }
        for output in &self.outputs {
            each(Leaf::Material(&output.material));
            output.material.visit(each);
            output
                .condition
                .iter()
                .for_each(|condition| condition.visit(each));
        }
        visit_entries(&self.entries, each);
    }
}

fn visit_entries<'a>(entries: &'a [Result<Entry, Broken>], each: &mut dyn FnMut(Leaf<'a>)) {
    for entry in entries.iter().flatten() {
        let exprs = [&entry.condition, &entry.repeat].into_iter().flatten();
        let exprs = exprs.chain(entry.set.iter().map(|(_, value)| value));
        let run = entry.run.iter().filter_map(|run| match run {
            Run::When(condition) => Some(condition),
            _ => None,
        });
        exprs.chain(run).for_each(|expr| expr.visit(each));
        let (exprs, references) = match &entry.what {
            What::Pass(pass) => (&pass.mentions.exprs[..], &pass.mentions.references[..]),
            What::Group(inner) => {
                visit_entries(inner, each);
                (&[][..], &[][..])
            }
            What::Include(_) => (&[][..], &[][..]),
        };
        exprs.iter().for_each(|expr| expr.visit(each));
        let bound = entry.bind.iter().map(|(_, reference)| reference);
        for reference in bound.chain(references) {
            each(Leaf::Material(reference));
            reference.visit(each);
        }
    }
}
