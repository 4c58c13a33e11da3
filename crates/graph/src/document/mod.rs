//! Phase 1: the RON text becomes a document; nothing is looked up yet but pass kinds.

mod entries;
pub mod located;
pub mod materials;
pub mod params;
mod requires;
pub mod value;

use crate::{
    diagnostics::{Code, Diagnostic},
    registry::Registry,
    source::{SourceFile, Span},
};
pub(crate) use entries::{Entry, GroupEntry, IncludeEntry, PassEntry, Run};
use located::{Field, Located, Node, from_fields};
use materials::Material;
use params::{Param, ParamEntry};
use requires::RequireEntry;
pub(crate) use requires::Requirement;
use serde::Deserialize;
use std::collections::HashMap;

/// Most entries of a list as it is written; each may name all others, so time may grow with the square.
pub(crate) const MOST_ENTRIES: usize = 4096;

/// The only document format there is.
const FORMAT: u32 = 1;

/// A document as its author wrote it.
#[derive(Debug)]
pub(crate) struct Document {
    pub file: SourceFile,
    pub description: String,
    pub params: Vec<Param>,
    pub materials: Vec<Material>,
    pub requires: Vec<Requirement>,
    pub entries: Vec<Entry>,
    pub outputs: Vec<OutputEntry>,
    /// How many includes there are one within the other below this document.
    pub include_depth: usize,
    pub broken: Broken,
}

impl Document {
    /// The features that the document itself requires or has a fallback for.
    pub fn features(&self) -> wgpu::Features {
        self.requires
            .iter()
            .fold(wgpu::Features::empty(), |all, requirement| {
                all | requirement.flag
            })
    }
}

/// What could not be read, so that later phases do not take it for missing.
#[derive(Debug, Default)]
pub(crate) struct Broken {
    pub params: bool,
    pub materials: Vec<String>,
}

/// A result of the graph.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct OutputEntry {
    pub name: Located<String>,
    #[serde(default)]
    pub material: Option<Located<String>>,
}

const SECTIONS: [&str; 7] = [
    "format",
    "description",
    "requires",
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
        requires: Vec::new(),
        entries: Vec::new(),
        outputs: Vec::new(),
        include_depth: 0,
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
    for node in list(sections.get("params"), diagnostics) {
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
    for node in list(sections.get("requires"), diagnostics) {
        let entry = node.parse::<RequireEntry>();
        let requirement =
            entry.and_then(|entry| entry.resolve(&document.params, document.broken.params));
        keep(requirement, diagnostics, |requirement| {
            document.requires.push(requirement)
        });
    }
    for node in list(sections.get("materials"), diagnostics) {
        match ok(material(&node), diagnostics) {
            Some(material) => document.materials.push(material),
            None => document.broken.materials.extend(name_of(&node)),
        }
    }
    document.entries = entries::read(sections.get("passes"), registry, diagnostics);
    for node in list(sections.get("outputs"), diagnostics) {
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

fn list(section: Option<&Node>, diagnostics: &mut Vec<Diagnostic>) -> Vec<Node> {
    let nodes = section.and_then(|node| ok(node.list(), diagnostics));
    let nodes = nodes.unwrap_or_default();
    if let Some(node) = nodes.get(MOST_ENTRIES) {
        let count = nodes.len();
        let error = Diagnostic::error(
            Code::Size,
            format!("the list has {count} entries, {MOST_ENTRIES} is the most"),
        );
        diagnostics.push(
            error.at(node.span.clone(), "this one is too many").help(
                "let `repeat` say what is alike, or split the document and `Include` its parts",
            ),
        );
        return Vec::new();
    }
    nodes
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
