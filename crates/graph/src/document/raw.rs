//! A document as sections of raw RON. [`extend`](super::extend) edits the sections, and
//! [`typed`](super::typed) reads them.
use crate::diagnostics::{ErrorGuaranteed, Reported, Reports};
use crate::errors::document::DocumentError;
use crate::errors::edit::EditError;
use crate::source::{Located, SourceFile, Span};
use skiagraph_located_ron::mistakes::{field_twice, unknown_field};
use skiagraph_located_ron::reader::{Field, Node};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Most entries of a list or map as it is written; each may name all others, so time may grow with
/// the square.
const MOST_ENTRIES: usize = 4096;

/// Tag of the edit that removes a pass of the extended document.
pub(crate) const REMOVE: &str = "Remove";

/// Version of the document format that this crate reads.
pub(crate) const FORMAT: u32 = 3;

/// A map as it is written in RON: names, each once, with their values not yet read.
pub(crate) type RawMap = Vec<(Located<String>, Node)>;

/// The sections of a document.
#[derive(Debug)]
pub(crate) struct RawDocument {
    pub file: SourceFile,
    /// Paths of the documents that this one extends, directly or through others, the nearest first.
    pub extended: Vec<Arc<str>>,
    pub description: Option<Node>,
    pub extends: Option<Node>,
    pub requires: Vec<Node>,
    pub needs: Vec<Node>,
    pub params: Vec<RawItem>,
    pub values: RawMap,
    /// Narrowed choices, in the order in which they apply: those of extended documents first.
    pub narrow: RawMap,
    pub imports: Vec<Node>,
    pub inputs: Vec<RawItem>,
    pub materials: Vec<RawItem>,
    pub passes: Vec<Result<RawEntry, Invalid>>,
    pub outputs: Vec<Node>,
    pub set: RawMap,
    pub lights: Vec<Node>,
    pub proven_on: Vec<Node>,
    pub claims: RawMap,
    /// Set if a param could not be read; sizes of this document are then unknown.
    pub invalid_params: Option<ErrorGuaranteed>,
    /// Set if a list or one of its items could not be read; some names are then unknown.
    pub incomplete: Option<ErrorGuaranteed>,
}

/// A param, an input or a material, `Kind(name: …, …)`: its tag and its raw fields.
#[derive(Clone, Debug)]
pub(crate) struct RawItem {
    pub tag: Located<String>,
    pub fields: Vec<Field>,
}

/// An entry of `passes` with its raw fields; `bind`, `set` and `passes` are split further.
#[derive(Clone, Debug)]
pub(crate) struct RawEntry {
    pub tag: Located<String>,
    pub fields: Vec<Field>,
    pub bind: RawMap,
    pub set: RawMap,
    /// Entries of a group, in the order of the document; `None` for an entry that is not a group.
    pub passes: Option<Vec<Result<RawEntry, Invalid>>>,
}

/// An entry of `passes` that could not be read, which was reported. The materials that it writes
/// are unknown, and so is the content of an include.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Invalid {
    /// True if the entry is an include, whose content is then unknown, too.
    pub is_include: bool,
    pub reported: ErrorGuaranteed,
}

/// The text of a field `name` in quotes.
fn name_of(fields: &[Field]) -> Option<Located<String>> {
    let field = fields.iter().find(|field| *field.name == "name")?;
    let name: String = field.node.parse().ok()?;
    Some(Located::new(name, field.node.clone()))
}

impl RawItem {
    pub fn name(&self) -> Option<Located<String>> {
        name_of(&self.fields)
    }
}

impl RawEntry {
    /// Returns the entry's name, or for an include without a name the name of its file, without
    /// folder and ending. `None` if neither can be read.
    pub fn name(&self) -> Option<String> {
        if let Some(name) = name_of(&self.fields) {
            return Some(name.value);
        }
        let graph = self.field("graph").filter(|_| *self.tag == "Include")?;
        let graph: String = graph.node.parse().ok()?;
        Some(stem(&graph).to_owned())
    }

    pub fn field(&self, name: &str) -> Option<&Field> {
        self.fields.iter().find(|field| *field.name == name)
    }

    pub fn take(&mut self, name: &str) -> Option<Field> {
        let at = self.fields.iter().position(|field| *field.name == name)?;
        Some(self.fields.remove(at))
    }
}

/// Returns the file name of a path, without its folder and ending.
pub(crate) fn stem(path: &str) -> &str {
    let file = path.rsplit(['/', '\\']).next().unwrap_or(path);
    file.strip_suffix(".ron").unwrap_or(file)
}

/// All sections of a document: each name, with a sentence about its content.
pub(crate) const SECTIONS: [(&str, &str); 17] = [
    ("format", "The version of the language, 3."),
    ("extends", "Another document, of which this one is an edit."),
    ("description", "A sentence, shown by `skiagraph presets`."),
    (
        "requires",
        "Features of the device, by wgpu's names, without which the graph does not run.",
    ),
    (
        "needs",
        "Conditions on the viewport, the scene and its lights that must hold for a plan.",
    ),
    ("params", "Values from outside."),
    (
        "set",
        "Other defaults for params of the extended document, or of included ones that are exposed.",
    ),
    (
        "values",
        "Expressions with a name, for every expression and shader of the document.",
    ),
    (
        "narrow",
        "Fewer words for a `Choice`, of this document's own or of an exposed one, with the reason.",
    ),
    (
        "imports",
        "Modules that shaders import in the place of others.",
    ),
    ("inputs", "Materials that the includer gives, or the host."),
    (
        "materials",
        "Textures, buffers and samplers that passes share.",
    ),
    ("passes", "Steps of the method, in this order."),
    ("outputs", "Materials that the graph gives."),
    ("lights", "The kinds of light that the method takes."),
    (
        "proven_on",
        "Backends short of WebGPU, such as `gl`, on which the graph is known to be right.",
    ),
    (
        "claims",
        "Promises of the method, by `exact` and `certain`.",
    ),
];

/// Splits a document into its sections. Mistakes in a section are reported.
pub(crate) fn split(file: SourceFile, reports: &mut Reports) -> Reported<RawDocument> {
    if !file.text.contains('(') {
        return Err(reports.report(DocumentError::NoDocument(file)));
    }
    let fields = reports.check(Node::root(&file).fields())?;
    let mut sections = Sections {
        nodes: sections(fields, reports),
        incomplete: None,
        reports,
    };
    sections.format(&file)?;
    let passes = sections.list("passes");
    let inputs = sections.items("inputs").0;
    let materials = sections.items("materials").0;
    // Without its params nothing of a document is looked at.
    let incomplete = sections.incomplete;
    let (params, invalid_params) = sections.items("params");
    sections.incomplete = incomplete;
    Ok(RawDocument {
        description: sections.nodes.remove("description"),
        extends: sections.nodes.remove("extends"),
        requires: sections.list("requires"),
        needs: sections.list("needs"),
        params,
        values: sections.map("values"),
        narrow: sections.map("narrow"),
        imports: sections.list("imports"),
        inputs,
        materials,
        outputs: sections.list("outputs"),
        set: sections.map("set"),
        lights: sections.list("lights"),
        proven_on: sections.list("proven_on"),
        claims: sections.map("claims"),
        passes: entries(passes, sections.reports),
        invalid_params,
        incomplete: sections.incomplete,
        extended: Vec::new(),
        file,
    })
}

fn sections(fields: Vec<Field>, reports: &mut Reports) -> HashMap<String, Node> {
    let mut sections = HashMap::new();
    for field in fields {
        let mut names = SECTIONS.iter().map(|(name, _)| *name);
        if !names.any(|name| *name == **field.name) {
            reports.report(unknown_field(&field.name, SECTIONS.map(|(name, _)| name)));
            continue;
        }
        let before = sections.insert(field.name.value.clone(), field.node);
        if before.is_some() {
            reports.report(field_twice(&field.name));
        }
    }
    sections
}

struct Sections<'r> {
    nodes: HashMap<String, Node>,
    incomplete: Option<ErrorGuaranteed>,
    reports: &'r mut Reports,
}

impl Sections<'_> {
    fn format(&mut self, file: &SourceFile) -> Reported<()> {
        let Some(node) = self.nodes.get("format") else {
            let begin = file.span(0..1.min(file.text.len()));
            self.reports.report(DocumentError::NoFormat(begin));
            return Ok(());
        };
        match self.reports.check(node.parse::<u32>()) {
            Ok(FORMAT) | Err(_) => Ok(()),
            // Everything else in it would be a mistake, too.
            Ok(other) => {
                let place = node.clone();
                Err(self.reports.report(DocumentError::Format(place, other)))
            }
        }
    }

    fn list(&mut self, section: &str) -> Vec<Node> {
        let node = self.nodes.remove(section);
        let read = node.map_or(Ok(Vec::new()), |node| list(&node, self.reports));
        read.unwrap_or_else(|reported| {
            self.incomplete = Some(reported);
            Vec::new()
        })
    }

    fn map(&mut self, section: &str) -> RawMap {
        let node = self.nodes.remove(section);
        node.map_or_else(Vec::new, |node| map(&node, self.reports))
    }

    /// The items of a section, and the proof if some could not be read.
    fn items(&mut self, section: &'static str) -> (Vec<RawItem>, Option<ErrorGuaranteed>) {
        let (mut items, mut broken) = (Vec::new(), None);
        for node in self.list(section) {
            match item(&node, section) {
                Ok(item) if *item.tag == REMOVE => {
                    self.reports.report(EditError::RemovesItem(item.tag.span));
                }
                Ok(item) => items.push(item),
                Err(error) => {
                    broken = Some(self.reports.report(error));
                    self.incomplete = broken;
                }
            }
        }
        let mut seen: HashMap<String, Span> = HashMap::new();
        // The first of two is the one that counts, so that the second raises no more complaints.
        items.retain(|item: &RawItem| {
            let Some(name) = item.name() else {
                return true;
            };
            let Some(first) = seen.get(&name.value) else {
                seen.insert(name.value, name.span);
                return true;
            };
            let what = section.strip_suffix('s').unwrap_or(section);
            let twice = DocumentError::Twice(what, name, first.clone());
            self.reports.report(twice);
            false
        });
        (items, broken)
    }
}

fn item(node: &Node, section: &'static str) -> Result<RawItem, crate::diagnostics::Diagnostic> {
    let untagged = || DocumentError::Untagged(node.clone(), section);
    let (tag, body) = node.variant().ok_or_else(untagged)?;
    let fields = body.fields()?;
    Ok(RawItem { tag, fields })
}

fn list(node: &Node, reports: &mut Reports) -> Reported<Vec<Node>> {
    let nodes = reports.check(node.list())?;
    few("list", nodes, |node| node, reports)
}

/// The entries of a list or map, if they are not too many.
fn few<T>(
    what: &'static str,
    entries: Vec<T>,
    span: fn(&T) -> &Span,
    reports: &mut Reports,
) -> Reported<Vec<T>> {
    match entries.get(MOST_ENTRIES) {
        None => Ok(entries),
        Some(first) => Err(reports.report(DocumentError::TooMany {
            what,
            span: span(first).clone(),
            count: entries.len(),
            most: MOST_ENTRIES,
        })),
    }
}

fn map(node: &Node, reports: &mut Reports) -> RawMap {
    let entries = reports.check(node.map()).unwrap_or_default();
    let entries = few("map", entries, |(key, _)| &key.span, reports).unwrap_or_default();
    let mut seen = HashSet::new();
    let mut once = Vec::new();
    for (key, value) in entries {
        if seen.insert(key.value.clone()) {
            once.push((key, value));
        } else {
            reports.report(DocumentError::KeyTwice(key));
        }
    }
    once
}

fn entries(nodes: Vec<Node>, reports: &mut Reports) -> Vec<Result<RawEntry, Invalid>> {
    nodes.iter().map(|node| entry(node, reports)).collect()
}

fn entry(node: &Node, reports: &mut Reports) -> Result<RawEntry, Invalid> {
    let item = item(node, "passes").map_err(|error| {
        let tag = node.variant().map(|(tag, _)| tag.value);
        Invalid {
            is_include: tag.is_some_and(|tag| tag == "Include"),
            reported: reports.report(error),
        }
    })?;
    let mut entry = RawEntry {
        tag: item.tag,
        fields: Vec::new(),
        bind: Vec::new(),
        set: Vec::new(),
        passes: None,
    };
    let mut seen = HashSet::new();
    for field in item.fields {
        let name = field.name.value.clone();
        match name.as_str() {
            "bind" | "set" | "passes" if !seen.insert(name.clone()) => {
                reports.report(field_twice(&field.name));
            }
            "bind" => entry.bind = map(&field.node, reports),
            "set" => entry.set = map(&field.node, reports),
            "passes" => {
                let nodes = list(&field.node, reports);
                let unread = |reported| {
                    vec![Err(Invalid {
                        is_include: true,
                        reported,
                    })]
                };
                let read = nodes.map_or_else(unread, |nodes| entries(nodes, reports));
                entry.passes = Some(read);
            }
            _ => entry.fields.push(field),
        }
    }
    Ok(entry)
}
