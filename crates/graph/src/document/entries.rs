//! Reads the entries of `passes`: passes, included documents, and groups of entries.

use super::raw::{Invalid, RawEntry, RawMap, stem};
use super::typed::{Entry, Expose, Include, Pass, Run, What};
use crate::diagnostics::{Diagnostic, Reports};
use crate::errors::document::DocumentError;
use crate::fields::Mentions;
use crate::kinds::{Lowering, OF_PASS, Program, Registry, Step};
use crate::language::{Expr, Name, RESERVED, Reference};
use crate::source::Located;
use serde::Deserialize;
use skiagraph_located_ron::fields::{from_fields, from_some_fields};
use skiagraph_located_ron::mistakes::{missing_field, unknown_field};
use skiagraph_located_ron::reader::{Field, Node};

/// The tags that are no pass kinds.
const COMPOSITION: [&str; 2] = ["Include", "Group"];

/// Reads the entries of a section, whatever is wrong with some of them.
pub(super) fn read(
    raw: Vec<Result<RawEntry, Invalid>>,
    registry: &Registry,
    reports: &mut Reports,
) -> Vec<Result<Entry, Invalid>> {
    let read = |raw: Result<RawEntry, Invalid>| {
        let raw = raw?;
        let is_include = *raw.tag == "Include";
        let entry = entry(raw, registry, reports);
        entry.map_err(|error| Invalid {
            is_include,
            reported: reports.report(error),
        })
    };
    raw.into_iter().map(read).collect()
}

/// Fields that every entry has.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(crate) struct Header {
    /// Name of the entry; an include without one has the name of its file.
    name: Option<Located<Name>>,
    /// Condition under which the entry exists.
    #[serde(default, rename = "if")]
    condition: Option<Expr>,
    /// How often it stands here one after another, each time with its `index`.
    repeat: Option<Expr>,
    /// In which frames it runs; without it, as what is around it.
    run: Option<Run>,
}

/// Fields that every pass has beside those of its kind.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(crate) struct PassFields {
    /// The shader without folder and ending; the pass's name without it.
    shader: Option<Located<String>>,
    /// Materials that are cleared to zero each time before it runs.
    #[serde(default)]
    clear: Vec<Reference>,
    /// Materials that the pass writes in every texel or item, which reflection cannot see.
    #[serde(default)]
    overwrites: Vec<Reference>,
    /// The materials that it reads, all of them; those of the scene are left out.
    reads: Option<Vec<Reference>>,
}

/// Runs another document as a part of this one.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(crate) struct IncludeFields {
    /// The document: the name of a preset, or a path.
    graph: Located<String>,
    /// Leaves the document open: a run may put another one under this name; without that it is
    /// `graph`.
    open: Option<Located<Name>>,
    /// Its params that are params here, too: a list, or `All` that are not set.
    #[serde(default)]
    expose: Expose,
}

const HEADER: [&str; 4] = ["name", "if", "repeat", "run"];

/// Fields of an include beside its own.
const OF_INCLUDE: [&str; 6] = ["name", "if", "repeat", "run", "bind", "set"];

/// Fields of a group.
const OF_GROUP: [&str; 8] = [
    "name", "if", "repeat", "run", "bind", "set", "while", "passes",
];

fn entry(
    mut raw: RawEntry,
    registry: &Registry,
    reports: &mut Reports,
) -> Result<Entry, Diagnostic> {
    let is_composed = COMPOSITION.contains(&raw.tag.as_str());
    if !is_composed && registry.get(&raw.tag).is_none() {
        let kinds = registry.kinds().chain(COMPOSITION);
        let names = kinds.map(str::to_owned).collect();
        return Err(DocumentError::UnknownKind(raw.tag, names).into());
    }
    if let Some(passes) = raw.passes.take_if(|_| *raw.tag != "Group") {
        drop(passes);
        let name = Located::new("passes".to_owned(), raw.tag.span);
        return Err(unknown_field(&name, OF_PASS));
    }
    let is_of_header = |field: &Field| HEADER.contains(&field.name.as_str());
    let (header, own): (Vec<Field>, Vec<Field>) = raw.fields.into_iter().partition(is_of_header);
    let header: Header = from_fields(&header, &raw.tag.span)?;
    let missing = |field| missing_field(&raw.tag, field);
    let mut rounds = None;
    let (name, what) = match raw.tag.as_str() {
        "Include" => {
            let (include, name) = include(&raw.tag, &own, header.name)?;
            (name, What::Include(include))
        }
        "Group" => {
            let entries = raw.passes.ok_or_else(|| missing("passes"))?;
            for field in &own {
                if field.name.as_str() != "while" {
                    return Err(unknown_field(&field.name, OF_GROUP));
                }
                if header.repeat.is_none() {
                    return Err(DocumentError::WhileAlone(field.name.clone()).into());
                }
                rounds = Some(field.node.parse()?);
            }
            let name = header.name.ok_or_else(|| missing("name"))?;
            (name, What::Group(read(entries, registry, reports)))
        }
        _ => {
            let name = header.name.ok_or_else(|| missing("name"))?;
            let pass = pass(&raw.tag, &name, own, registry)?;
            (name, What::Pass(pass))
        }
    };
    if is_composed && RESERVED.contains(&name.as_str()) {
        return Err(DocumentError::Reserved(name).into());
    }
    Ok(Entry {
        name,
        condition: header.condition,
        repeat: header.repeat,
        run: header.run,
        bind: parsed(raw.bind)?,
        set: parsed(raw.set)?,
        rounds,
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
    const COMMON: [&str; 4] = ["shader", "clear", "overwrites", "reads"];
    let is_common = |field: &Field| COMMON.contains(&field.name.as_str());
    let (common, own): (Vec<Field>, Vec<Field>) = own.into_iter().partition(is_common);
    let common: PassFields = from_fields(&common, &tag.span)?;
    let unknown = || DocumentError::UnknownKind(tag.clone(), Vec::new());
    let kind = registry.get(tag).ok_or_else(unknown)?;
    Mentions::take();
    let body = (kind.parse)(&own, &tag.span)?;
    let mut mentions = Mentions::take();
    let references = common.overwrites.iter().chain(&common.clear);
    let references = references.chain(common.reads.iter().flatten());
    mentions.references.extend(references.cloned());
    // Which shaders it names depends on nothing that has a value later.
    let mut lowering = Lowering::new(name, common.shader.as_ref(), &[], None);
    body.lower(&mut lowering);
    let programs = lowering.steps.iter().filter_map(Step::program);
    let run = programs.filter_map(Program::shader_use);
    let shaders = run.chain(lowering.alternatives).collect();
    let features = lowering.features;
    Ok(Pass {
        shader: common.shader,
        clear: common.clear,
        overwrites: common.overwrites,
        reads: common.reads,
        kind: kind.name,
        body,
        shaders,
        features,
        mentions,
    })
}

fn include(
    tag: &Located<String>,
    own: &[Field],
    name: Option<Located<Name>>,
) -> Result<(Include, Located<Name>), Diagnostic> {
    let fields: IncludeFields = from_some_fields(own, &tag.span, &OF_INCLUDE)?;
    let is_named = name.is_some();
    let name = match name {
        Some(name) => name,
        None => {
            let stem = stem(&fields.graph);
            let span = fields.graph.span.clone();
            let name = Name::new(stem);
            let name = name.map_err(|_| DocumentError::Unnamed(span.clone(), stem.to_owned()));
            Located::new(name?, span)
        }
    };
    let include = Include {
        graph: fields.graph,
        open: fields.open,
        is_named,
        expose: fields.expose,
        document: None,
    };
    Ok((include, name))
}
