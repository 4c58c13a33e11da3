//! The entries of `passes`: passes, included documents, and groups of entries.

use super::{
    fields::Mentions,
    raw::{Broken, RawEntry, RawMap, stem},
    ron::{Field, Node, from_fields},
    typed::Document,
};
use crate::{
    diagnostics::{
        diagnostic::Diagnostic,
        reports::{Mistake, Reported, Reports},
    },
    errors::document::DocumentError,
    kinds::{
        kind::{Lowering, PassKind},
        registry::Registry,
        step::Step,
    },
    language::{
        name::{Name, RESERVED},
        syntax::{Expr, Reference},
    },
    source::span::Located,
};
use serde::{Deserialize, Deserializer};
use std::sync::Arc;

/// One entry, at its place in the sequential program.
#[derive(Debug)]
pub(crate) struct Entry {
    pub name: Located<Name>,
    /// Whether it is there.
    pub condition: Option<Expr>,
    /// How often it is instantiated; `None` = once, without an index.
    pub repeat: Option<Expr>,
    /// In which frames it runs; `None` = as what is around it.
    pub run: Option<Run>,
    pub bind: Vec<(Located<String>, Reference)>,
    pub set: Vec<(Located<String>, Expr)>,
    pub what: What,
}

#[derive(Debug)]
pub(crate) enum What {
    Pass(Pass),
    Include(Include),
    Group(Vec<Result<Entry, Broken>>),
}

/// A pass: what every kind has, and the kind's own body.
#[derive(Debug)]
pub(crate) struct Pass {
    pub shader: Option<Located<String>>,
    /// What the author promises that the pass writes in every texel or item.
    pub overwrites: Vec<Reference>,
    pub kind: &'static str,
    pub body: Arc<dyn PassKind>,
    /// Names of the shaders that it runs.
    pub shaders: Vec<Located<String>>,
    /// What its fields name.
    pub mentions: Mentions,
}

/// Another document whose passes stand here.
#[derive(Debug)]
pub(crate) struct Include {
    pub graph: Located<String>,
    /// Whether it has a name of its own, which stands before what it gives.
    pub is_named: bool,
    /// Params of the included document that are params here, too.
    pub expose: Vec<Located<String>>,
    /// Put here once it is read.
    pub document: Option<Result<Arc<Document>, Reported>>,
}

impl Include {
    /// The included document, if it could be read.
    pub fn document(&self) -> Option<&Arc<Document>> {
        self.document.as_ref()?.as_ref().ok()
    }
}

/// In which frames a pass runs.
#[derive(Clone, Debug, Default)]
pub(crate) enum Run {
    /// In every frame.
    #[default]
    Always,
    /// In the first frame after planning.
    Once,
    /// In frames where something that it reads has changed.
    OnChange,
    /// In frames where an expression over params is true.
    When(Expr),
}

impl<'de> Deserialize<'de> for Run {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(rename = "run")]
        enum Words {
            Always,
            Once,
            OnChange,
            When(Expr),
        }
        Ok(match Words::deserialize(deserializer)? {
            Words::Always => Self::Always,
            Words::Once => Self::Once,
            Words::OnChange => Self::OnChange,
            Words::When(expr) => Self::When(expr),
        })
    }
}

/// The tags that are no pass kinds.
const COMPOSITION: [&str; 2] = ["Include", "Group"];

/// Reads the entries of a section, whatever is wrong with some of them.
pub(super) fn read(
    raw: Vec<Result<RawEntry, Broken>>,
    registry: &Registry,
    reports: &mut Reports,
) -> Vec<Result<Entry, Broken>> {
    let read = |raw: Result<RawEntry, Broken>| {
        let raw = raw?;
        let is_include = *raw.tag == "Include";
        let entry = entry(raw, registry, reports);
        entry.map_err(|error| Broken {
            is_include,
            reported: reports.tell(error),
        })
    };
    raw.into_iter().map(read).collect()
}

/// What every entry has.
#[derive(Deserialize)]
struct Header {
    #[serde(default)]
    name: Option<Located<Name>>,
    #[serde(default, rename = "if")]
    condition: Option<Expr>,
    #[serde(default)]
    repeat: Option<Expr>,
    #[serde(default)]
    run: Option<Run>,
}

const HEADER: [&str; 4] = ["name", "if", "repeat", "run"];

fn entry(
    mut raw: RawEntry,
    registry: &Registry,
    reports: &mut Reports,
) -> Result<Entry, Diagnostic> {
    let is_composed = COMPOSITION.contains(&raw.tag.as_str());
    if !is_composed && registry.get(&raw.tag).is_none() {
        let known = registry
            .kinds()
            .chain(COMPOSITION)
            .map(str::to_owned)
            .collect();
        return Err(DocumentError::UnknownKind(raw.tag, known).diagnostic());
    }
    if let Some(passes) = raw.passes.take_if(|_| *raw.tag != "Group") {
        drop(passes);
        let name = Located::new("passes".to_owned(), raw.tag.span);
        return Err(DocumentError::UnknownField(name, Vec::new()).diagnostic());
    }
    let (header, own): (Vec<Field>, Vec<Field>) = raw
        .fields
        .into_iter()
        .partition(|field| HEADER.contains(&field.name.as_str()));
    let header: Header = from_fields(&header, &raw.tag.span)?;
    let unnamed = || DocumentError::MissingField(raw.tag.span.clone(), "name".to_owned());
    let (name, what) = match raw.tag.as_str() {
        "Include" => {
            let (include, name) = include(&raw.tag, &own, header.name)?;
            (name, What::Include(include))
        }
        "Group" => {
            let entries = raw.passes.ok_or_else(|| {
                let missing = "passes".to_owned();
                DocumentError::MissingField(raw.tag.span.clone(), missing).diagnostic()
            })?;
            if let Some(field) = own.first() {
                let known = HEADER.map(str::to_owned).to_vec();
                let error = DocumentError::UnknownField(field.name.clone(), known);
                return Err(error.diagnostic());
            }
            let name = header.name.ok_or_else(|| unnamed().diagnostic())?;
            (name, What::Group(read(entries, registry, reports)))
        }
        _ => {
            let name = header.name.ok_or_else(|| unnamed().diagnostic())?;
            let pass = pass(&raw.tag, &name, own, registry)?;
            (name, What::Pass(pass))
        }
    };
    if is_composed && RESERVED.contains(&name.as_str()) {
        return Err(DocumentError::Reserved(name).diagnostic());
    }
    Ok(Entry {
        name,
        condition: header.condition,
        repeat: header.repeat,
        run: header.run,
        bind: parsed(raw.bind)?,
        set: parsed(raw.set)?,
        what,
    })
}

fn parsed<T: serde::de::DeserializeOwned>(
    map: RawMap,
) -> Result<Vec<(Located<String>, T)>, Diagnostic> {
    let parse = |(key, node): (Located<String>, Node)| Ok((key, node.parse()?));
    map.into_iter().map(parse).collect()
}

fn pass(
    tag: &Located<String>,
    name: &Located<Name>,
    own: Vec<Field>,
    registry: &Registry,
) -> Result<Pass, Diagnostic> {
    #[derive(Deserialize)]
    struct Common {
        #[serde(default)]
        shader: Option<Located<String>>,
        #[serde(default)]
        overwrites: Vec<Reference>,
    }
    let (common, own): (Vec<Field>, Vec<Field>) = own
        .into_iter()
        .partition(|field| matches!(field.name.as_str(), "shader" | "overwrites"));
    let common: Common = from_fields(&common, &tag.span)?;
    let kind = registry
        .get(tag)
        .ok_or_else(|| DocumentError::UnknownKind(tag.clone(), Vec::new()).diagnostic())?;
    Mentions::take();
    let body = (kind.parse)(&own, &tag.span)?;
    let mut mentions = Mentions::take();
    mentions
        .references
        .extend(common.overwrites.iter().cloned());
    // Which shaders it names depends on nothing that has a value later.
    let mut lowering = Lowering::new(name, common.shader.as_ref(), &[], None);
    body.lower(&mut lowering);
    let programs = lowering.steps.iter().filter_map(Step::program);
    let shaders = programs
        .filter_map(|program| program.shader.clone())
        .collect();
    Ok(Pass {
        shader: common.shader,
        overwrites: common.overwrites,
        kind: kind.name,
        body,
        shaders,
        mentions,
    })
}

fn include(
    tag: &Located<String>,
    own: &[Field],
    name: Option<Located<Name>>,
) -> Result<(Include, Located<Name>), Diagnostic> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Fields {
        graph: Located<String>,
        #[serde(default)]
        expose: Vec<Located<String>>,
    }
    let fields: Fields = from_fields(own, &tag.span)?;
    let is_named = name.is_some();
    let name = match name {
        Some(name) => name,
        None => {
            let stem = stem(&fields.graph);
            let span = fields.graph.span.clone();
            let name = Name::new(stem);
            let name = name.map_err(|_| DocumentError::Unnamed(span.clone(), stem.to_owned()));
            Located::new(name.map_err(Mistake::diagnostic)?, span)
        }
    };
    let include = Include {
        graph: fields.graph,
        is_named,
        expose: fields.expose,
        document: None,
    };
    Ok((include, name))
}
