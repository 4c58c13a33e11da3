//! The entries of `passes`: passes, included documents, and groups of entries.

use super::{
    Document, list,
    located::{Field, Located, Node, from_fields},
    ok,
    params::Written,
    value::{Map, Reference, Value},
};
use crate::{
    diagnostics::{Code, Diagnostic},
    registry::{PassKind, Registry},
};
use serde::Deserialize;
use std::{fmt, sync::Arc};

/// One entry, at its place in the sequential program.
#[derive(Debug)]
pub(crate) enum Entry {
    Pass(PassEntry),
    Include(IncludeEntry),
    Group(GroupEntry),
    /// Could not be read, which was reported; what it would have written is not known.
    Broken,
    /// The same of an include: what it would have declared is not known either.
    BrokenInclude,
}

/// How often an entry is instantiated; `None` = once, without an index.
pub(crate) type Repeat = Option<Located<Value<u32>>>;

/// A pass: what every kind has, and the kind's own body.
#[derive(Clone, Debug)]
pub(crate) struct PassEntry {
    pub name: Located<String>,
    pub shader: Option<Located<String>>,
    pub bind: Vec<(Located<String>, Located<String>)>,
    pub run: Run,
    /// What the author promises that the pass writes in every texel or item.
    pub overwrites: Vec<Located<String>>,
    pub repeat: Repeat,
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

impl PartialEq for Run {
    fn eq(&self, other: &Self) -> bool {
        self.to_string() == other.to_string()
    }
}

impl fmt::Display for Run {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::When(param) => write!(f, "When({:?})", param.value),
            other => write!(f, "{other:?}"),
        }
    }
}

/// Another document whose passes stand here.
#[derive(Debug)]
pub(crate) struct IncludeEntry {
    pub graph: Located<String>,
    pub prefix: Option<Located<String>>,
    pub params: Vec<(Located<String>, Located<Value<Written>>)>,
    /// The included document's materials under the names that they get here.
    pub materials: Vec<(Located<String>, Located<String>)>,
    pub repeat: Repeat,
    /// Put here once it is read; `None` if it could not be, which was reported.
    pub document: Option<Arc<Document>>,
}

/// Entries that are repeated together.
#[derive(Debug)]
pub(crate) struct GroupEntry {
    pub name: Located<String>,
    pub repeat: Repeat,
    pub entries: Vec<Entry>,
}

/// The tags that are no pass kinds.
const COMPOSITION: [&str; 2] = ["Include", "Group"];

/// Reads the entries of a section, whatever is wrong with some of them.
pub(super) fn read(
    section: Option<&Node>,
    registry: &Registry,
    diagnostics: &mut Vec<Diagnostic>,
) -> Vec<Entry> {
    let mut entries = Vec::new();
    for node in list(section, diagnostics) {
        let entry = entry(&node, registry, diagnostics);
        entries.push(
            ok(entry, diagnostics).unwrap_or_else(|| match node.variant() {
                Some((tag, _)) if *tag == "Include" => Entry::BrokenInclude,
                _ => Entry::Broken,
            }),
        );
    }
    entries
}

fn entry(
    node: &Node,
    registry: &Registry,
    diagnostics: &mut Vec<Diagnostic>,
) -> Result<Entry, Diagnostic> {
    let tags = || registry.kinds().chain(COMPOSITION);
    let Some((tag, body)) = node.variant() else {
        return Err(
            Diagnostic::error(Code::Syntax, "a pass begins with its kind")
                .at(node.span.clone(), "for example `Compute(name: \"…\", …)`")
                .suggest("", tags()),
        );
    };
    match tag.as_str() {
        "Include" => include(&tag, &body).map(Entry::Include),
        "Group" => group(&tag, &body, registry, diagnostics).map(Entry::Group),
        _ if registry.get(&tag).is_some() => pass(&tag, &body, registry).map(Entry::Pass),
        _ => Err(Diagnostic::error(
            Code::UnknownVariant,
            format!("unknown pass kind `{}`", *tag),
        )
        .at(tag.span.clone(), "no pass kind of this name is registered")
        .suggest(&tag, tags())),
    }
}

fn pass(tag: &Located<String>, body: &Node, registry: &Registry) -> Result<PassEntry, Diagnostic> {
    #[derive(Deserialize)]
    struct Header {
        name: Located<String>,
        #[serde(default)]
        shader: Option<Located<String>>,
        #[serde(default)]
        bind: Map<Reference>,
        #[serde(default)]
        run: Run,
        #[serde(default)]
        overwrites: Vec<Located<String>>,
        #[serde(default)]
        repeat: Repeat,
    }
    const HEADER: [&str; 6] = ["name", "shader", "bind", "run", "overwrites", "repeat"];
    let (header, own): (Vec<Field>, Vec<Field>) = body
        .fields()?
        .into_iter()
        .partition(|field| HEADER.contains(&field.name.as_str()));
    let header: Header = from_fields(&header, &tag.span)?;
    let bind = header.bind.unique("bound")?.into_iter();
    let kind = registry.get(tag).ok_or_else(|| {
        Diagnostic::error(
            Code::UnknownVariant,
            format!("unknown pass kind `{}`", **tag),
        )
        .at(tag.span.clone(), "")
    })?;
    Ok(PassEntry {
        name: header.name,
        shader: header.shader,
        bind: bind
            .map(|(global, Reference(name))| (global, name))
            .collect(),
        run: header.run,
        overwrites: header.overwrites,
        repeat: header.repeat,
        kind: kind.name,
        body: (kind.parse)(&own, &tag.span)?,
    })
}

fn include(tag: &Located<String>, body: &Node) -> Result<IncludeEntry, Diagnostic> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Fields {
        graph: Located<String>,
        #[serde(default)]
        prefix: Option<Located<String>>,
        #[serde(default)]
        params: Map<Located<Value<Written>>>,
        #[serde(default)]
        materials: Map<Located<String>>,
        #[serde(default)]
        repeat: Repeat,
    }
    let fields: Fields = from_fields(&body.fields()?, &tag.span)?;
    let wrong_prefix = match &fields.prefix {
        Some(prefix) if prefix.is_empty() => Some("the prefix is empty"),
        None if fields.repeat.is_some() => Some("a repeated include needs a prefix"),
        _ => None,
    };
    if let Some(what) = wrong_prefix {
        let place = fields.prefix.as_ref().unwrap_or(tag);
        return Err(Diagnostic::error(Code::MissingField, what)
            .at(place.span.clone(), "")
            .help("`prefix: \"eye\"` makes `eye.depth` of `depth`, and `eye[0].depth` where it is repeated"));
    }
    Ok(IncludeEntry {
        graph: fields.graph,
        prefix: fields.prefix,
        params: fields.params.unique("given")?,
        materials: fields.materials.unique("renamed")?,
        repeat: fields.repeat,
        document: None,
    })
}

fn group(
    tag: &Located<String>,
    body: &Node,
    registry: &Registry,
    diagnostics: &mut Vec<Diagnostic>,
) -> Result<GroupEntry, Diagnostic> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Header {
        name: Located<String>,
        #[serde(default)]
        repeat: Repeat,
    }
    let (passes, header): (Vec<Field>, Vec<Field>) = body
        .fields()?
        .into_iter()
        .partition(|field| *field.name == "passes");
    let header: Header = from_fields(&header, &tag.span)?;
    let [passes] = passes.as_slice() else {
        let (code, what) = match passes.is_empty() {
            true => (Code::MissingField, "the field `passes` is missing"),
            false => (Code::DuplicateName, "the field `passes` is given twice"),
        };
        let place = passes.last().map_or(&tag.span, |field| &field.name.span);
        return Err(Diagnostic::error(code, what).at(place.clone(), ""));
    };
    Ok(GroupEntry {
        name: header.name,
        repeat: header.repeat,
        entries: read(Some(&passes.node), registry, diagnostics),
    })
}
