//! A document with everything in it read, and nothing looked up.

use super::{
    materials::{Input, Material},
    raw::Invalid,
};
use crate::{
    diagnostics::reports::ErrorGuaranteed,
    errors::document::DocumentError,
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
use skiagraph_located_ron::reader::{raw, read, refuse};
use std::{collections::BTreeSet, sync::Arc};

/// A document as its author wrote it.
#[derive(Clone, Debug, Default)]
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
        let ClaimFields { condition, because } = read(text)?;
        Ok(Self { condition, because })
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
    pub expose: Expose,
    /// Put here once it is read.
    pub document: Option<Result<Arc<Document>, ErrorGuaranteed>>,
}

impl Include {
    /// The included document, if it could be read.
    pub fn document(&self) -> Option<&Arc<Document>> {
        self.document.as_ref()?.as_ref().ok()
    }
}

/// Params of an included document that are params of this one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Expose {
    /// Those that neither the include nor a group around it sets: `names`, once the document is
    /// read.
    pub all: bool,
    pub names: Vec<Located<String>>,
}

impl<'de> Deserialize<'de> for Expose {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let (text, span) = raw(deserializer)?;
        match text.chars().next() {
            Some('[') => read(text).map(|names| Self { all: false, names }),
            _ if text == "All" => Ok(Self {
                all: true,
                ..Self::default()
            }),
            _ => Err(refuse(DocumentError::Expose(span))),
        }
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

    /// Every entry, those in groups, too.
    pub fn all_entries(&self) -> impl Iterator<Item = &Entry> {
        let mut open = vec![self.entries.iter().flatten()];
        std::iter::from_fn(move || {
            let entry = loop {
                match open.last_mut()?.next() {
                    Some(entry) => break entry,
                    None => open.pop(),
                };
            };
            if let What::Group(inner) = &entry.what {
                open.push(inner.iter().flatten());
            }
            Some(entry)
        })
    }

    /// Every pass, those in groups, too.
    pub fn passes(&self) -> impl Iterator<Item = &Pass> {
        self.all_entries().filter_map(|entry| match &entry.what {
            What::Pass(pass) => Some(pass),
            _ => None,
        })
    }

    /// Every include whose document could be read, those in groups, too, with that document.
    pub fn includes(&self) -> impl Iterator<Item = (&Entry, &Include, &Arc<Document>)> {
        self.all_entries().filter_map(|entry| match &entry.what {
            What::Include(include) => Some((entry, include, include.document()?)),
            _ => None,
        })
    }

    /// The open includes, those in groups, too, by the name under which another document can be
    /// asked for.
    pub fn openings(&self) -> impl Iterator<Item = (&Located<Name>, &Include)> {
        self.all_entries().filter_map(|entry| match &entry.what {
            What::Include(include) => Some((include.open.as_ref()?, include)),
            _ => None,
        })
    }

    /// Calls `each` with everything that expressions and references of the document are made of.
    pub fn visit<'a>(&'a self, each: &mut dyn FnMut(Leaf<'a>)) {
        let params = self.params[..self.declared].iter();
        let exprs = params
            .filter_map(|param| param.default.as_ref())
            .chain(
                self.claims
                    .iter()
                    .filter_map(|(_, of)| of.condition.as_ref()),
            )
            .chain(self.defaults.iter().map(|(_, value)| value))
            .chain(self.values.iter().map(|(_, value)| value))
            .chain(self.imports.iter().filter_map(|of| of.condition.as_ref()))
            .chain(self.outputs.iter().filter_map(|of| of.condition.as_ref()));
        exprs.for_each(|expr| expr.visit(each));
        for material in &self.materials {
            material.visit(each);
        }
        for output in &self.outputs {
            output.material.visit(each);
        }
        for entry in self.all_entries() {
            entry.visit(each);
        }
    }
}

impl Entry {
    /// The name here of what an include gives, or of a param that it exposes.
    pub fn outer_name(&self, include: &Include, name: &str) -> String {
        if include.is_named {
            format!("{}.{name}", *self.name)
        } else {
            name.to_owned()
        }
    }

    fn visit<'a>(&'a self, each: &mut dyn FnMut(Leaf<'a>)) {
        let run = self.run.iter().filter_map(|run| match run {
            Run::When(condition) => Some(condition),
            _ => None,
        });
        let mentions = match &self.what {
            What::Pass(pass) => Some(&pass.mentions),
            _ => None,
        };
        let exprs = [&self.condition, &self.repeat].into_iter().flatten();
        let exprs = exprs.chain(self.set.iter().map(|(_, value)| value));
        let exprs = exprs
            .chain(run)
            .chain(mentions.iter().flat_map(|of| &of.exprs));
        exprs.for_each(|expr| expr.visit(each));
        let references = self.bind.iter().map(|(_, reference)| reference);
        let references = references.chain(mentions.iter().flat_map(|of| &of.references));
        references.for_each(|reference| reference.visit(each));
    }
}

/// Calls `each` with every include, those in groups, too.
pub(crate) fn each_include(
    entries: &mut [Result<Entry, Invalid>],
    each: &mut dyn FnMut(&mut Include),
) {
    for entry in entries.iter_mut().flatten() {
        match &mut entry.what {
            What::Include(include) => each(include),
            What::Group(inner) => each_include(inner, each),
            What::Pass(_) => {}
        }
    }
}
