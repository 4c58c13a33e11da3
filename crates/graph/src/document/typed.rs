//! A document with everything in it read, and nothing looked up.

use super::{
    materials::{Input, Material},
    raw::Invalid,
};
use crate::{
    diagnostics::reports::ErrorGuaranteed,
    fields::{Mentions, prose, short_or_long},
    kinds::{kind::PassKind, step::ShaderUse},
    language::{
        name::Name,
        syntax::{Expr, Leaf, Reference},
    },
    param::Param,
    source::span::{Located, SourceFile, Span},
};
use serde::{Deserialize, Deserializer};
use skiagraph_located_ron::reader::{raw, read};
use std::{collections::BTreeSet, sync::Arc};

/// A document as its author wrote it.
#[derive(Clone, Debug)]
pub(crate) struct Document {
    pub file: SourceFile,
    /// The paths of the documents that it extends, the nearest first.
    pub extended: Vec<Arc<str>>,
    pub description: String,
    pub requires: Vec<(Located<String>, wgt::Features)>,
    /// The params that it declares, then those that it exposes.
    pub params: Vec<Param>,
    /// How many of them it declares.
    pub declared: usize,
    /// Expressions with a name.
    pub values: Vec<(Located<Name>, Expr)>,
    /// Fewer words for a `Choice`.
    pub narrow: Vec<(Located<String>, Narrow)>,
    /// Modules that stand in for others.
    pub imports: Vec<ImportEntry>,
    /// Other defaults for exposed params.
    pub defaults: Vec<(Located<String>, Expr)>,
    pub inputs: Vec<Input>,
    pub materials: Vec<Material>,
    pub entries: Vec<Result<Entry, Invalid>>,
    pub outputs: Vec<Output>,
    /// The kinds of light that it takes.
    pub lights: Vec<Located<Name>>,
    /// Backends that give less than WebGPU, on which it is proven all the same.
    pub proven_on: Vec<Located<Name>>,
    pub claims: Vec<(Located<String>, ClaimEntry)>,
    /// Names of materials and inputs that could not be read.
    pub broken_materials: Vec<(String, ErrorGuaranteed)>,
    /// A param could not be read: nothing of the document has a size then.
    pub invalid_params: Option<ErrorGuaranteed>,
    /// Something could not be read, so some names are unknown.
    pub incomplete: Option<ErrorGuaranteed>,
    /// An output could not be read, so its name is unknown.
    pub broken_outputs: Option<ErrorGuaranteed>,
    /// The outputs that are values.
    pub gives_values: BTreeSet<String>,
    /// How many includes there are one within the other below this document.
    pub include_depth: usize,
}

/// Fewer words of a `Choice`: `(words: [scene, camera], because: "…")`.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "Narrow")
)]
#[serde(rename = "narrow", deny_unknown_fields)]
pub(crate) struct Narrow {
    /// The words that stay, in any order.
    pub words: Vec<Located<Name>>,
    /// Why the others are refused.
    #[serde(deserialize_with = "prose")]
    pub because: String,
}

/// A module that shaders import in the place of another one.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "Import")
)]
#[serde(rename = "import", deny_unknown_fields)]
pub(crate) struct ImportEntry {
    /// The module that shaders name, as an `#import` writes it.
    pub of: Located<String>,
    /// The module that they get.
    pub is: Located<String>,
    /// Condition under which it stands in; always without it.
    #[serde(default, rename = "if")]
    pub condition: Option<Expr>,
}

/// Promise of a method: `(if: "n >= 0.5", because: "…")`, or the condition alone.
#[derive(Clone, Debug)]
pub(crate) struct ClaimEntry {
    /// `None`: always.
    pub condition: Option<Expr>,
    pub because: String,
}

/// Promise of a method, with the reason.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename = "claim", deny_unknown_fields)]
pub(crate) struct ClaimFields {
    /// Under which params; always without it.
    #[serde(default, rename = "if")]
    condition: Option<Expr>,
    /// Why it holds, or ends.
    #[serde(default, deserialize_with = "prose")]
    because: String,
}

impl<'de> Deserialize<'de> for ClaimEntry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let (text, _) = raw(deserializer)?;
        if !text.starts_with('(') {
            return Ok(Self {
                condition: Some(read(text)?),
                because: String::new(),
            });
        }
        let long: ClaimFields = read(text)?;
        Ok(Self {
            condition: long.condition,
            because: long.because,
        })
    }
}

/// Output for the includer and the host.
#[derive(Clone, Debug)]
pub(crate) struct Output {
    pub name: Located<Name>,
    pub material: Reference,
    /// Condition under which it exists.
    pub condition: Option<Expr>,
    /// True if a host has to name it to get it.
    pub on_request: bool,
}

/// Output of a document.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(crate) struct OutputFields {
    /// Name for the includer and the host.
    name: Located<Name>,
    /// The material; the one of that name without it.
    #[serde(default)]
    material: Option<Reference>,
    /// Condition under which it exists.
    #[serde(default, rename = "if")]
    condition: Option<Expr>,
    /// True if only a host that names it gets it, and all others pay nothing for it: a diagnostic.
    #[serde(default)]
    on_request: bool,
}

impl<'de> Deserialize<'de> for Output {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let long = |long: OutputFields| Self {
            material: (long.material).unwrap_or_else(|| Reference::new(long.name.clone())),
            name: long.name,
            condition: long.condition,
            on_request: long.on_request,
        };
        short_or_long(deserializer, long, |short: Reference| Self {
            name: short.segments[0].name.clone(),
            material: short,
            condition: None,
            on_request: false,
        })
    }
}

/// One entry, at its place in the sequential program.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub name: Located<Name>,
    /// Condition under which it exists.
    pub condition: Option<Expr>,
    /// How often it is instantiated; `None` = once, without an index.
    pub repeat: Option<Expr>,
    /// In which frames it runs; `None` = as what is around it.
    pub run: Option<Run>,
    pub bind: Vec<(Located<String>, Reference)>,
    pub set: Vec<(Located<String>, Expr)>,
    pub what: What,
}

#[derive(Clone, Debug)]
pub(crate) enum What {
    Pass(Pass),
    Include(Include),
    Group(Vec<Result<Entry, Invalid>>),
}

/// A pass: the fields of every kind, and the kind's own body.
#[derive(Clone, Debug)]
pub(crate) struct Pass {
    pub shader: Option<Located<String>>,
    /// Materials that are cleared to zero before anything else of it runs.
    pub clear: Vec<Reference>,
    /// Materials that the pass writes in every texel or item, as its author promises.
    pub overwrites: Vec<Reference>,
    /// Materials that the pass reads, if its author lists them.
    pub reads: Option<Vec<Reference>>,
    pub kind: &'static str,
    pub body: Arc<dyn PassKind>,
    /// The shaders that it runs, or may run for other values.
    pub shaders: Vec<ShaderUse>,
    /// The features that it can make use of.
    pub features: wgt::Features,
    /// Names in its fields.
    pub mentions: Mentions,
}

/// Another document whose passes stand here.
#[derive(Clone, Debug)]
pub(crate) struct Include {
    /// The document that stands here; of an open include the one that was asked for.
    pub graph: Located<String>,
    /// The name under which another document can be asked for.
    pub open: Option<Located<Name>>,
    /// True if it has a name of its own, which stands before the names that it gives.
    pub is_named: bool,
    /// Params of the included document that are params here, too; those of `All` are written out
    /// once that document is read.
    pub expose: Vec<Located<String>>,
    /// Every param that is not set is exposed.
    pub exposes_all: bool,
    /// Put here once it is read.
    pub document: Option<Result<Arc<Document>, ErrorGuaranteed>>,
}

impl Include {
    /// The included document, if it could be read.
    pub fn document(&self) -> Option<&Arc<Document>> {
        self.document.as_ref()?.as_ref().ok()
    }
}

/// In which frames a pass runs.
#[derive(Clone, Debug, Default, Deserialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "Run")
)]
#[serde(rename = "run")]
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

impl Document {
    /// True if the document itself says what stands there, not one that it extends or includes.
    pub fn is_own(&self, span: &Span) -> bool {
        span.file.name == self.file.name
    }

    /// How many documents extend the one that says what stands there, this one last.
    pub fn rank(&self, span: &Span) -> usize {
        let mut extended = self.extended.iter();
        let found = extended.position(|file| *file == span.file.name);
        found.map_or(0, |below| below + 1)
    }

    /// The outputs that are no values.
    pub fn material_outputs(&self) -> impl Iterator<Item = &Output> {
        let is_value = |output: &&Output| self.gives_values.contains(output.name.as_str());
        self.outputs.iter().filter(move |output| !is_value(output))
    }

    /// The open includes, those in groups, too, by the name under which another document can be
    /// asked for.
    pub fn openings(&self) -> Vec<(&Located<Name>, &Include)> {
        let mut found = Vec::new();
        each_entry(&self.entries, &mut |entry| {
            if let What::Include(include) = &entry.what {
                found.extend(include.open.as_ref().map(|name| (name, include)));
            }
        });
        found
    }

    /// Calls `each` with everything that expressions and references of the document are made of.
    pub fn visit<'a>(&'a self, each: &mut dyn FnMut(Leaf<'a>)) {
        for param in &self.params[..self.declared] {
            param.default.iter().for_each(|default| default.visit(each));
        }
        let claims = self
            .claims
            .iter()
            .filter_map(|(_, claim)| claim.condition.as_ref());
        let values = self.values.iter().map(|(_, value)| value);
        let imports = self
            .imports
            .iter()
            .filter_map(|entry| entry.condition.as_ref());
        let defaults = self.defaults.iter().map(|(_, value)| value);
        for value in claims.chain(defaults).chain(values).chain(imports) {
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

fn visit_entries<'a>(entries: &'a [Result<Entry, Invalid>], each: &mut dyn FnMut(Leaf<'a>)) {
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

/// Calls `each` with every entry, those in groups, too.
pub(crate) fn each_entry<'e>(
    entries: &'e [Result<Entry, Invalid>],
    each: &mut dyn FnMut(&'e Entry),
) {
    for entry in entries.iter().flatten() {
        each(entry);
        if let What::Group(inner) = &entry.what {
            each_entry(inner, each);
        }
    }
}
