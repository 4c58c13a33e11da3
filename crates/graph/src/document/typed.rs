//! The typed form of a document: every value is parsed, no name is looked up yet.

use super::materials::{Input, Material};
use super::raw::Invalid;
use crate::diagnostics::{ErrorGuaranteed, Reported};
use crate::errors::document::DocumentError;
use crate::fields::{Mentions, by_text, prose, short_or_long};
use crate::kinds::{PassKind, ShaderUse};
use crate::language::{Expr, Leaf, Name, Reference};
use crate::param::Param;
use crate::source::{Located, SourceFile, Span};
use serde::Deserialize;
use skiagraph_located_ron::reader::{read, refuse};
use std::{collections::BTreeSet, sync::Arc};

/// A document as its author wrote it, with the documents that it extends merged in.
#[derive(Clone, Debug, Default)]
pub(crate) struct Document {
    pub file: SourceFile,
    /// Paths of the documents that this one extends, directly or through others, the nearest first.
    pub extended: Vec<Arc<str>>,
    pub description: String,
    pub requires: Vec<(Located<String>, wgt::Features)>,
    /// Conditions on the viewport, the scene and its lights that must hold for a plan.
    pub needs: Vec<Expr>,
    /// Params that the document declares itself ([`declared`](Self::declared) of them), then the
    /// params that it exposes from its includes, each in the order of the document.
    pub params: Vec<Param>,
    /// Number of params at the front of `params` that the document declares itself.
    pub declared: usize,
    /// Named expressions of the section `values`: name and expression, in the order of the
    /// document.
    pub values: Vec<(Located<Name>, Expr)>,
    /// Names of `Choice` params, each with the words that remain of it and the reason. Empty once
    /// the params are narrowed.
    pub narrow: Vec<(Located<String>, Narrow)>,
    /// Modules that shaders import in the place of other modules, in the order of the document; a
    /// later one replaces an earlier one for the same module.
    pub imports: Vec<ImportEntry>,
    /// Names of params that the document exposes from its includes, each with the default that the
    /// section `set` gives it.
    pub defaults: Vec<(Located<String>, Expr)>,
    pub inputs: Vec<Input>,
    pub materials: Vec<Material>,
    pub entries: Vec<Result<Entry, Invalid>>,
    pub outputs: Vec<Output>,
    /// Kinds of light that the document takes, as words such as `spot`; empty if it takes the first
    /// kind alone.
    pub lights: Vec<Located<Name>>,
    /// Names of backends that lack part of WebGPU, such as `gl`, on which the graph is known to be
    /// right.
    pub proven_on: Vec<Located<Name>>,
    pub claims: Vec<(Located<String>, ClaimEntry)>,
    /// Names of the materials, inputs and values that could not be read, each with the proof that
    /// this was reported.
    pub broken_materials: Vec<(String, ErrorGuaranteed)>,
    /// Set if a param could not be read; sizes of this document are then unknown.
    pub invalid_params: Option<ErrorGuaranteed>,
    /// Set if something without a readable name could not be read, so that an unknown name may have
    /// been declared there.
    pub incomplete: Option<ErrorGuaranteed>,
    /// Set if an output could not be read; its name is then unknown.
    pub broken_outputs: Option<ErrorGuaranteed>,
    /// Names of the outputs that give a value, not a material.
    pub gives_values: BTreeSet<String>,
    /// Greatest number of includes nested below this document; 0 without includes.
    pub include_depth: usize,
}

/// Fewer words of a `Choice`: `(words: [scene, camera], because: "…")`.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "Narrow"))]
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
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "Import"))]
#[serde(rename = "import", deny_unknown_fields)]
pub(crate) struct ImportEntry {
    /// The module that shaders name, as an `#import` writes it.
    pub of: Located<String>,
    /// The module that they get.
    pub is: Located<String>,
    /// Condition under which it stands in; always without it.
    #[serde(default, rename = "if")]
    pub condition: Option<Expr>,
    /// Provided resource without which the entry is ignored: one of the
    /// [registry](crate::Registry::stand_in).
    #[serde(skip)]
    pub items_of: Option<&'static str>,
}

/// A promise of a method: `(if: "n >= 0.5", because: "…")`, or its condition alone.
#[derive(Clone, Debug)]
pub(crate) struct ClaimEntry(pub ClaimFields);

/// Promise of a method, with the reason.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename = "claim", deny_unknown_fields)]
pub(crate) struct ClaimFields {
    /// Under which params; always without it.
    #[serde(default, rename = "if")]
    pub condition: Option<Expr>,
    /// Why it holds, or ends.
    #[serde(default, deserialize_with = "prose")]
    pub because: String,
}

by_text!(ClaimEntry, |text, _| {
    if text.starts_with('(') {
        return read(text).map(Self);
    }
    Ok(Self(ClaimFields {
        condition: Some(read(text)?),
        because: String::new(),
    }))
});

/// An output that a document gives its includer and the host.
#[derive(Clone, Debug)]
pub(crate) struct Output {
    pub name: Located<Name>,
    pub material: Reference,
    /// Condition under which the output exists; `None` for always.
    pub condition: Option<Expr>,
    /// True if the output is computed only for a host that names it.
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
    material: Option<Reference>,
    /// Condition under which it exists.
    #[serde(default, rename = "if")]
    condition: Option<Expr>,
    /// True if only a host that names it gets it, and all others pay nothing for it: a diagnostic.
    #[serde(default)]
    on_request: bool,
}

by_text!(Output, |text, span| {
    let long = |long: OutputFields| Self {
        material: (long.material).unwrap_or_else(|| Reference::new(long.name.clone())),
        name: long.name,
        condition: long.condition,
        on_request: long.on_request,
    };
    short_or_long((text, span), long, |short: Reference| Self {
        name: short.segments[0].name.clone(),
        material: short,
        condition: None,
        on_request: false,
    })
});

/// An entry of `passes` (a pass, an include or a group), at its place in the document's order.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub name: Located<Name>,
    /// Condition under which the entry exists; `None` for always.
    pub condition: Option<Expr>,
    /// Expression for the number of copies of the entry, which have the index 0, 1 and so on;
    /// `None` for one copy without an index.
    pub repeat: Option<Expr>,
    /// Frames in which the entry runs; `None` to run in the frames of the group or include around
    /// it.
    pub run: Option<Run>,
    pub bind: Vec<(Located<String>, Reference)>,
    pub set: Vec<(Located<String>, Expr)>,
    /// Buffer of a group whose first u32 ends the group's repetition early, once it is 0; `None` to
    /// run all of its rounds.
    pub rounds: Option<Reference>,
    pub what: What,
}

#[derive(Clone, Debug)]
pub(crate) enum What {
    Pass(Pass),
    Include(Include),
    Group(Vec<Result<Entry, Invalid>>),
}

/// A pass: the fields that all kinds share, and the body of its own kind.
#[derive(Clone, Debug)]
pub(crate) struct Pass {
    pub shader: Option<Located<String>>,
    /// Materials that are cleared to zero each time before the pass runs.
    pub clear: Vec<Reference>,
    /// Materials that the pass writes in every texel or item, as the document promises.
    pub overwrites: Vec<Reference>,
    /// All materials that the pass reads; `None` if the document does not list them.
    pub reads: Option<Vec<Reference>>,
    pub kind: &'static str,
    pub body: Arc<dyn PassKind>,
    /// Shaders that the pass runs for any values of its params: its own, and those that its kind
    /// brings.
    pub shaders: Vec<ShaderUse>,
    /// Device features that the pass uses if the device has them.
    pub features: wgt::Features,
    /// Expressions and references in the fields of the pass's kind, and its references in `clear`,
    /// `overwrites` and `reads`.
    pub mentions: Mentions,
}

/// An include: another document whose passes run at this place.
#[derive(Clone, Debug)]
pub(crate) struct Include {
    /// Path of the document to include, as the document writes it; in an open include, of the
    /// document that the host chose for it.
    pub graph: Located<String>,
    /// Name under which the host can choose another document; `None` if the include is not open.
    pub open: Option<Located<Name>>,
    /// True if the include has a name of its own, which is put before the names that it gives.
    pub is_named: bool,
    pub expose: Expose,
    /// The included document; `None` until it is read.
    pub document: Option<Reported<Arc<Document>>>,
}

impl Include {
    /// Returns the included document; `None` if it is not read yet or could not be read.
    pub fn document(&self) -> Option<&Arc<Document>> {
        self.document.as_ref()?.as_ref().ok()
    }
}

/// Params of an included document that become params of the including one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Expose {
    /// True to expose every param that neither the include nor a group around it sets. Once the
    /// document is read, `names` lists them.
    pub all: bool,
    pub names: Vec<Located<String>>,
}

by_text!(Expose, |text, span| match text {
    "All" => Ok(Self {
        all: true,
        names: Vec::new(),
    }),
    _ if text.starts_with('[') => read(text).map(|names| Self { all: false, names }),
    _ => Err(refuse(DocumentError::Expose(span))),
});

/// In which frames a pass runs.
#[derive(Clone, Debug, Default, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "Run"))]
#[serde(rename = "run")]
pub(crate) enum Run {
    /// In every frame that may compute something new.
    #[default]
    Always,
    /// In the first frame after planning.
    Once,
    /// In frames where something that it reads has changed.
    OnChange,
    /// In frames where an expression over params is true and something new may be computed.
    When(Expr),
}

impl Document {
    /// True if a place lies in this document's own file, not in a document that it extends or
    /// includes.
    pub fn is_own(&self, span: &Span) -> bool {
        span.file.name == self.file.name
    }

    /// Returns the param with a name, its own or an exposed one.
    pub fn param(&self, name: &str) -> Option<&Param> {
        self.params.iter().find(|param| param.name.value == name)
    }

    /// Returns the number of extensions between this document and the one that `span` lies in: 0
    /// for this document, 1 for the document that it extends, and so on.
    pub fn rank(&self, span: &Span) -> usize {
        let mut extended = self.extended.iter();
        let depth = extended.position(|file| *file == span.file.name);
        depth.map_or(0, |below| below + 1)
    }

    /// Iterates over the outputs that give a texture, buffer or sampler, not a named value, in the
    /// order of the document.
    pub fn material_outputs(&self) -> impl Iterator<Item = &Output> {
        let is_value = |output: &&Output| self.gives_values.contains(output.name.as_str());
        self.outputs.iter().filter(move |output| !is_value(output))
    }

    /// Iterates over all readable entries of `passes` in the order of the document, including those
    /// in groups: a group before the entries in it.
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

    /// Iterates over all readable passes in the order of the document, including those in groups.
    pub fn passes(&self) -> impl Iterator<Item = &Pass> {
        self.all_entries().filter_map(|entry| match &entry.what {
            What::Pass(pass) => Some(pass),
            _ => None,
        })
    }

    /// Iterates over the includes whose document could be read, including those in groups: the
    /// entry, the include in it, and the included document.
    pub fn includes(&self) -> impl Iterator<Item = (&Entry, &Include, &Arc<Document>)> {
        self.all_entries().filter_map(|entry| match &entry.what {
            What::Include(include) => Some((entry, include, include.document()?)),
            _ => None,
        })
    }

    /// Iterates over the open includes, including those in groups, each with the name under which
    /// the host can choose another document.
    pub fn openings(&self) -> impl Iterator<Item = (&Located<Name>, &Include)> {
        self.all_entries().filter_map(|entry| match &entry.what {
            What::Include(include) => Some((include.open.as_ref()?, include)),
            _ => None,
        })
    }

    /// Iterates over the textures that hold a picture, each by its name with the name of the file.
    pub fn pictures(&self) -> impl Iterator<Item = (&Name, &Located<String>)> {
        self.materials.iter().filter_map(|material| match material {
            Material::Texture(texture) => Some((&texture.name.value, texture.file.as_ref()?)),
            _ => None,
        })
    }

    /// Calls `each` with every leaf (param, word, material, constant or feature) of the document's
    /// expressions and references.
    pub fn visit<'a>(&'a self, each: &mut dyn FnMut(Leaf<'a>)) {
        let params = self.params[..self.declared].iter();
        let claims = self.claims.iter();
        let (imports, outputs) = (self.imports.iter(), self.outputs.iter());
        let exprs = params
            .filter_map(|param| param.default.as_ref())
            .chain(claims.filter_map(|(_, claim)| claim.0.condition.as_ref()))
            .chain(self.defaults.iter().map(|(_, value)| value))
            .chain(self.values.iter().map(|(_, value)| value))
            .chain(&self.needs)
            .chain(imports.filter_map(|import| import.condition.as_ref()))
            .chain(outputs.filter_map(|output| output.condition.as_ref()));
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
    /// Returns the name, in the including document, of the output or exposed param `name` of
    /// `include`, which is this entry: with the entry's name in front (`left.depth`) if the include
    /// has a name of its own.
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
        let exprs = exprs.chain(run);
        let exprs = exprs.chain(mentions.iter().flat_map(|mentions| &mentions.exprs));
        exprs.for_each(|expr| expr.visit(each));
        let references = self.bind.iter().map(|(_, reference)| reference);
        let references = references.chain(&self.rounds);
        let references =
            references.chain(mentions.iter().flat_map(|mentions| &mentions.references));
        references.for_each(|reference| reference.visit(each));
    }
}

/// Calls `each` with every include, including those in groups.
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
