//! Phase 1: the RON text becomes a document; nothing is looked up yet but pass kinds.

pub mod located;
pub mod materials;
pub mod params;
pub mod value;

use crate::{
    diagnostics::{Code, Diagnostic},
    registry::{PassKind, Registry},
    source::{SourceFile, Span},
};
use located::{Field, Located, Node, from_fields};
use materials::Material;
use params::{Param, ParamEntry};
use serde::Deserialize;
use std::{
    collections::{HashMap, HashSet},
    sync::Arc,
};
use value::Pairs;

/// The only document format there is.
const FORMAT: u32 = 1;

/// A document as its author wrote it.
#[derive(Debug)]
pub(crate) struct Document {
    pub file: SourceFile,
    pub description: String,
    pub params: Vec<Param>,
    pub materials: Vec<Material>,
    pub passes: Vec<PassEntry>,
    pub outputs: Vec<OutputEntry>,
    pub broken: Broken,
}

/// What could not be read, so that later phases do not take it for missing.
#[derive(Debug, Default)]
pub(crate) struct Broken {
    pub params: bool,
    pub materials: Vec<String>,
    /// How many passes stand above the first one that could not be read.
    pub first_pass: Option<usize>,
}

/// A pass: what every kind has, and the kind's own body.
#[derive(Clone, Debug)]
pub(crate) struct PassEntry {
    pub name: Located<String>,
    pub shader: Option<Located<String>>,
    pub bind: Vec<(Located<String>, Located<String>)>,
    pub run: Run,
    /// What the author promises that the pass writes in every texel or item.
    pub overwrites: Vec<Located<String>>,
    pub kind: &'static str,
    pub body: Arc<dyn PassKind>,
}

/// In which frames a pass runs.
#[derive(Clone, Debug, Default, Deserialize)]
pub(crate) enum Run {
    /// In every frame.
    #[default]
    Always,
    /// In the first frame after planning.
    Once,
    /// In frames where something that it reads has changed.
    OnChange,
    /// In frames where a Bool param is true.
    When(Located<String>),
}

/// A result of the graph.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct OutputEntry {
    pub name: Located<String>,
    #[serde(default)]
    pub material: Option<Located<String>>,
}

const SECTIONS: [&str; 6] = [
    "format",
    "description",
    "params",
    "materials",
    "passes",
    "outputs",
];

/// Reads a document. Whatever is wrong is pushed to `diagnostics`; what could be read is returned all the same, so that
/// later phases find more mistakes in one go.
pub(crate) fn parse(
    file: SourceFile,
    registry: &Registry,
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<Document> {
    if !file.text.contains('(') {
        diagnostics.push(
            Diagnostic::error(
                Code::Syntax,
                format!("the file `{}` holds no document", file.name),
            )
            .at(
                file.span(0..file.text.lines().next().map_or(0, str::len)),
                "",
            )
            .help(format!("begin with `(format: {FORMAT}, …)`")),
        );
        return None;
    }
    let fields = match Node::root(&file).fields() {
        Ok(fields) => fields,
        Err(error) => {
            diagnostics.push(error);
            return None;
        }
    };
    let sections = sections(fields, diagnostics);
    let mut document = Document {
        file: file.clone(),
        description: String::new(),
        params: Vec::new(),
        materials: Vec::new(),
        passes: Vec::new(),
        outputs: Vec::new(),
        broken: Broken::default(),
    };
    match sections
        .get("format")
        .map(|node| (node, node.parse::<u32>()))
    {
        Some((_, Ok(FORMAT))) => {}
        Some((node, Ok(other))) => diagnostics.push(
            Diagnostic::error(
                Code::FormatVersion,
                format!("document format {other} is not known"),
            )
            .at(node.span.clone(), "")
            .help(format!(
                "this version of Skiagraph reads `format: {FORMAT}`"
            )),
        ),
        Some((_, Err(error))) => diagnostics.push(error),
        None => diagnostics.push(
            Diagnostic::error(Code::MissingField, "the document does not say its format")
                .at(file.span(0..1.min(file.text.len())), "")
                .help(format!("begin with `format: {FORMAT},`")),
        ),
    }
    if let Some(node) = sections.get("description") {
        keep(node.parse(), diagnostics, |text| {
            document.description = text
        });
    }
    for node in entries(sections.get("params"), diagnostics) {
        let entry = node.parse::<ParamEntry>().and_then(|entry| {
            Param::from_entry(entry).map_err(|(name, why)| {
                Diagnostic::error(
                    Code::ParamValue,
                    format!("the default of param `{}` does not fit", *name),
                )
                .at(name.span.clone(), why)
            })
        });
        match ok(entry, diagnostics) {
            Some(param) => document.params.push(param),
            None => document.broken.params = true,
        }
    }
    for node in entries(sections.get("materials"), diagnostics) {
        match ok(material(&node), diagnostics) {
            Some(material) => document.materials.push(material),
            None => document.broken.materials.extend(name_of(&node)),
        }
    }
    for node in entries(sections.get("passes"), diagnostics) {
        match ok(pass(&node, registry), diagnostics) {
            Some(pass) => document.passes.push(pass),
            None => {
                let index = document.passes.len();
                document.broken.first_pass.get_or_insert(index);
            }
        }
    }
    for node in entries(sections.get("outputs"), diagnostics) {
        keep(node.parse(), diagnostics, |output| {
            document.outputs.push(output)
        });
    }
    unique(
        "param",
        document.params.iter().map(|param| &param.name),
        diagnostics,
    );
    unique(
        "pass",
        document.passes.iter().map(|pass| &pass.name),
        diagnostics,
    );
    unique(
        "output",
        document.outputs.iter().map(|output| &output.name),
        diagnostics,
    );
    let views = document
        .materials
        .iter()
        .flat_map(|material| match material {
            Material::Texture(texture) => texture.views.iter().map(|view| &view.name).collect(),
            _ => Vec::new(),
        });
    unique(
        "material",
        document.materials.iter().map(Material::name).chain(views),
        diagnostics,
    );
    // The first of two is the one that counts, so that the second raises no more complaints.
    let mut seen = std::collections::HashSet::new();
    document
        .materials
        .retain(|material| seen.insert(material.name().value.clone()));
    Some(document)
}

/// The name of an entry that is wrong elsewhere.
fn name_of(node: &Node) -> Option<String> {
    let (_, body) = node.variant()?;
    let fields = body.fields().ok()?;
    let name = fields.iter().find(|field| *field.name == "name")?;
    name.node.parse().ok()
}

fn ok<T>(result: Result<T, Diagnostic>, diagnostics: &mut Vec<Diagnostic>) -> Option<T> {
    result.map_err(|error| diagnostics.push(error)).ok()
}

fn keep<T>(result: Result<T, Diagnostic>, diagnostics: &mut Vec<Diagnostic>, keep: impl FnOnce(T)) {
    if let Some(value) = ok(result, diagnostics) {
        keep(value);
    }
}

fn sections(fields: Vec<Field>, diagnostics: &mut Vec<Diagnostic>) -> HashMap<String, Node> {
    let mut sections = HashMap::new();
    for field in fields {
        if !SECTIONS.contains(&field.name.as_str()) {
            diagnostics.push(
                Diagnostic::error(
                    Code::UnknownField,
                    format!("unknown field `{}`", *field.name),
                )
                .at(field.name.span.clone(), "not a part of a document")
                .suggest(&field.name, SECTIONS),
            );
        } else if sections
            .insert(field.name.value.clone(), field.node)
            .is_some()
        {
            diagnostics.push(
                Diagnostic::error(
                    Code::DuplicateName,
                    format!("the field `{}` is given twice", *field.name),
                )
                .at(field.name.span.clone(), "the second one"),
            );
        }
    }
    sections
}

fn entries(section: Option<&Node>, diagnostics: &mut Vec<Diagnostic>) -> Vec<Node> {
    section
        .and_then(|node| ok(node.list(), diagnostics))
        .unwrap_or_default()
}

fn material(node: &Node) -> Result<Material, Diagnostic> {
    const KINDS: [&str; 3] = ["Texture", "Buffer", "Sampler"];
    let (tag, body) = node.variant().ok_or_else(|| {
        Diagnostic::error(Code::Syntax, "a material begins with its kind")
            .at(node.span.clone(), "for example `Texture(name: \"…\", …)`")
            .suggest("", KINDS)
    })?;
    let fields = body.fields()?;
    match tag.as_str() {
        "Texture" => from_fields(&fields, &tag.span).map(Material::Texture),
        "Buffer" => from_fields(&fields, &tag.span).map(Material::Buffer),
        "Sampler" => from_fields(&fields, &tag.span).map(Material::Sampler),
        _ => Err(Diagnostic::error(
            Code::UnknownVariant,
            format!("unknown kind of material `{}`", *tag),
        )
        .at(tag.span.clone(), "")
        .suggest(&tag, KINDS)),
    }
}

fn pass(node: &Node, registry: &Registry) -> Result<PassEntry, Diagnostic> {
    #[derive(Deserialize)]
    struct Header {
        name: Located<String>,
        #[serde(default)]
        shader: Option<Located<String>>,
        #[serde(default)]
        bind: Pairs,
        #[serde(default)]
        run: Run,
        #[serde(default)]
        overwrites: Vec<Located<String>>,
    }
    const HEADER: [&str; 5] = ["name", "shader", "bind", "run", "overwrites"];
    let Some((tag, body)) = node.variant() else {
        return Err(
            Diagnostic::error(Code::Syntax, "a pass begins with its kind")
                .at(node.span.clone(), "for example `Compute(name: \"…\", …)`")
                .suggest("", registry.kinds()),
        );
    };
    let Some(kind) = registry.get(&tag) else {
        return Err(Diagnostic::error(
            Code::UnknownVariant,
            format!("unknown pass kind `{}`", *tag),
        )
        .at(tag.span.clone(), "no pass kind of this name is registered")
        .suggest(&tag, registry.kinds()));
    };
    let (header, own): (Vec<Field>, Vec<Field>) = body
        .fields()?
        .into_iter()
        .partition(|field| HEADER.contains(&field.name.as_str()));
    let header: Header = from_fields(&header, &tag.span)?;
    let mut bound = HashSet::new();
    for (global, _) in &header.bind.0 {
        if !bound.insert(global.as_str()) {
            return Err(Diagnostic::error(
                Code::DuplicateName,
                format!("`{}` is bound twice", **global),
            )
            .at(global.span.clone(), "the second one"));
        }
    }
    let body = (kind.parse)(&own, &tag.span)?;
    Ok(PassEntry {
        name: header.name,
        shader: header.shader,
        bind: header.bind.0,
        run: header.run,
        overwrites: header.overwrites,
        kind: kind.name,
        body,
    })
}

fn unique<'a>(
    what: &str,
    names: impl Iterator<Item = &'a Located<String>>,
    diagnostics: &mut Vec<Diagnostic>,
) {
    let mut seen: HashMap<&str, &Span> = HashMap::new();
    for name in names {
        if let Some(first) = seen.get(name.as_str()) {
            diagnostics.push(
                Diagnostic::error(
                    Code::DuplicateName,
                    format!(
                        "two of the name `{}`: every {what} needs its own",
                        name.value
                    ),
                )
                .at(name.span.clone(), "the second one")
                .at((*first).clone(), "the first one"),
            );
        } else {
            seen.insert(name.as_str(), &name.span);
        }
    }
}
