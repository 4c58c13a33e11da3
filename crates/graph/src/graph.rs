//! [`Graph`]: a document with its shaders, ready to be planned.

use crate::{
    compose::{
        reader::{IncludeSite, Reader, label},
        used::{Used, drop_unused},
    },
    diagnostics::{
        diagnostic::{Diagnostic, Severity},
        list::Diagnostics,
        reports::{ErrorGuaranteed, Reports},
    },
    document::{
        flat::{flat, keep},
        materials::{Material, TextureEntry},
        typed::{Document, What, each_entry},
    },
    errors::{compose::ComposeError, resource::SizeError, shader::ShaderError},
    instantiate::params::{Claim, Surroundings, checked, claims},
    kinds::registry::Registry,
    language::{name::Name, syntax::Leaf},
    param::{Param, ParamError, ParamValue, find},
    picture::Picture,
    shader::{
        expand::ShaderFiles,
        store::{self, Shaders},
        unused,
    },
    source::{
        paths::{escapes, include_candidates},
        sources::Sources,
        span::{Located, Span},
    },
};
use std::{
    collections::{BTreeMap, BTreeSet, HashMap},
    sync::Arc,
};

/// A document that was read, with all shaders that its passes name. No GPU has been touched.
///
/// Cheap to clone.
#[derive(Clone, Debug)]
pub struct Graph {
    pub(crate) document: Arc<Document>,
    pub(crate) shaders: Arc<Shaders>,
    pub(crate) pictures: Arc<Pictures>,
    include_sites: Arc<Vec<IncludeSite>>,
    /// Features that the documents require.
    pub(crate) required: wgt::Features,
    /// Features that they ask for by `has`, or that their passes can make use of.
    asked_for: wgt::Features,
    warnings: Vec<Diagnostic>,
}

/// The pictures of all documents, by the path of the document and their own.
#[derive(Debug, Default)]
pub(crate) struct Pictures(HashMap<(Arc<str>, String), Result<Picture, ErrorGuaranteed>>);

impl Pictures {
    pub fn get(
        &self,
        document: &Document,
        file: &Located<String>,
    ) -> Result<Picture, ErrorGuaranteed> {
        let key = (Arc::clone(&document.file.name), file.value.clone());
        self.0[&key].clone()
    }
}

impl Graph {
    /// Reads the document at `path` and every shader it names, from `sources`. Parses and validates
    /// all WGSL.
    ///
    /// # Errors
    /// Everything that is wrong with the document and its shaders, as far as it can be said without
    /// sizes and a device.
    pub fn load(
        path: &str,
        registry: &Registry,
        sources: &dyn Sources,
    ) -> Result<Self, Diagnostics> {
        Self::load_over(path, registry, sources, &BTreeMap::new())
    }

    /// Reads the document at `path` as [`Graph::load`] does, with other documents in its open
    /// includes (`Include(open: "over", …)`). `chosen`: their paths, by the names of the includes
    /// ([`Graph::openings`]).
    ///
    /// # Errors
    /// As [`Graph::load`]; a name that is no open include of the document at `path`.
    pub fn load_over(
        path: &str,
        registry: &Registry,
        sources: &dyn Sources,
        chosen: &BTreeMap<String, String>,
    ) -> Result<Self, Diagnostics> {
        let (graph, errors) = Self::read(path, registry, sources, chosen)?;
        if errors.is_empty() {
            Ok(graph)
        } else {
            Err(graph.diagnostics(errors))
        }
    }

    /// The text of the document at `path` with all that it extends written out, each line with its
    /// origin. It reads as the document does; one with mistakes keeps what nothing uses.
    ///
    /// # Errors
    /// Mistakes in one of the documents as a file, or in an edit.
    pub fn flat(
        path: &str,
        registry: &Registry,
        sources: &dyn Sources,
    ) -> Result<String, Diagnostics> {
        let mut reports = Reports::default();
        let chosen = BTreeMap::new();
        let mut reader = Reader::new(registry, sources, &chosen, &mut reports);
        let document = reader.flat(path);
        let asked = std::mem::take(&mut reader.include_sites);
        match document {
            Ok(mut document) if reports.errors() == 0 => {
                if let Ok((graph, errors)) = Self::read(path, registry, sources, &chosen)
                    && errors.is_empty()
                {
                    keep(&mut document, &graph.document);
                }
                Ok(flat(&document))
            }
            _ => {
                let mut list = reports.into_list();
                label(&mut list, path, &asked);
                Err(Diagnostics::new(list))
            }
        }
    }

    /// Collects the mistakes of the graph. Those in other documents get the place where they are
    /// asked for.
    pub(crate) fn diagnostics(&self, mut list: Vec<Diagnostic>) -> Diagnostics {
        label(&mut list, self.path(), &self.include_sites);
        Diagnostics::new(list)
    }

    /// Reads a document. Returns its readable part, and the mistakes.
    pub(crate) fn read(
        path: &str,
        registry: &Registry,
        sources: &dyn Sources,
        chosen: &BTreeMap<String, String>,
    ) -> Result<(Self, Vec<Diagnostic>), Diagnostics> {
        let mut reports = Reports::default();
        let mut reader = Reader::new(registry, sources, chosen, &mut reports);
        let root = reader.root(path);
        let included: Vec<Arc<Document>> = reader.documents().cloned().collect();
        let asked = std::mem::take(&mut reader.include_sites);
        let Ok(mut root) = root else {
            let mut list = reports.into_list();
            label(&mut list, path, &asked);
            return Err(Diagnostics::new(list));
        };
        if root.outputs.is_empty() && reports.errors() == 0 {
            let end = root.file.text.trim_end().len();
            let place = root.file.span(end.saturating_sub(1)..end);
            reports.report(ComposeError::NoOutputs(place));
        }
        let documents: Vec<&Document> = [&root]
            .into_iter()
            .chain(included.iter().map(|d| &**d))
            .collect();
        let shaders = store::load(&root, ShaderFiles::new(sources), &mut reports);
        let pictures = load_pictures(&documents, sources, &mut reports);
        let (required, asked_for) = (required(&documents), asked_for(&documents));
        // The uses of a missing shader are not known.
        let is_known = reports.errors() == 0;
        if is_known {
            drop_unused(&mut root, &shaders, &mut HashMap::new(), &mut reports);
        }
        let mut graph = Self {
            required,
            asked_for,
            document: Arc::new(root),
            shaders: Arc::new(shaders),
            pictures: Arc::new(pictures),
            include_sites: Arc::new(asked),
            warnings: Vec::new(),
        };
        if is_known {
            graph.unused(&mut reports);
        }
        let is_error = |diagnostic: &Diagnostic| diagnostic.severity == Severity::Error;
        let (errors, warnings) = reports.into_list().into_iter().partition(is_error);
        graph.warnings = warnings;
        Ok((graph, errors))
    }

    /// Where the document was read from.
    pub fn path(&self) -> &str {
        &self.document.file.name
    }

    /// Returns the document's description of itself.
    pub fn description(&self) -> &str {
        &self.document.description
    }

    /// The params that the document declares, and those of included documents that it exposes.
    pub fn params(&self) -> &[Param] {
        &self.document.params
    }

    /// Names of the declared outputs that are materials, whatever their conditions.
    pub fn outputs(&self) -> Vec<&str> {
        let outputs = self.document.material_outputs();
        outputs.map(|output| output.name.as_str()).collect()
    }

    /// The same without those that a host gets only if it names them.
    pub fn default_outputs(&self) -> Vec<&str> {
        let outputs = self.document.material_outputs();
        let outputs = outputs.filter(|output| !output.on_request);
        outputs.map(|output| output.name.as_str()).collect()
    }

    /// The words of the section `lights`: the kinds of light that the method takes, each where it
    /// was written. The graph does not know what they mean.
    pub fn lights(&self) -> impl Iterator<Item = &Located<Name>> {
        self.document.lights.iter()
    }

    /// The words of the section `proven_on`: backends that give less than WebGPU, on which the
    /// graph is known to be right.
    pub fn proven_on(&self) -> impl Iterator<Item = &Located<Name>> {
        self.document.proven_on.iter()
    }

    /// The open includes of the document: each one's name, and the document that stands there.
    pub fn openings(&self) -> impl Iterator<Item = (&str, &str)> {
        let openings = self.document.openings().into_iter();
        openings.map(|(name, include)| (name.as_str(), include.graph.as_str()))
    }

    /// Names of what the host must import.
    pub fn inputs(&self) -> Vec<&str> {
        let inputs = self.document.inputs.iter();
        inputs.map(|input| input.name.as_str()).collect()
    }

    /// The features that the document and those that it includes require, ask for by `has`, or have
    /// passes that can make use of. A device that has those of them that its adapter offers runs
    /// the graph as well as it can be run there.
    pub fn features(&self) -> wgt::Features {
        self.required | self.asked_for
    }

    /// Returns the warnings about the document.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }

    /// Reads a param's value from text, as the command line gives it.
    ///
    /// # Errors
    /// If there is no such param, or the value has the wrong type or is out of range.
    pub fn parse_param(&self, name: &str, text: &str) -> Result<ParamValue, ParamError> {
        let param = self.param(name)?;
        param.parse(text).map_err(|why| ParamError::Value {
            graph: self.path().to_owned(),
            name: name.to_owned(),
            why,
        })
    }

    pub(crate) fn param(&self, name: &str) -> Result<&Param, ParamError> {
        find(self.params(), name, self.path())
    }

    /// The value of every param: that which is asked for, else the default for this viewport on a
    /// device with these features.
    ///
    /// # Errors
    /// If there is no such param, or a value does not fit.
    pub fn values(
        &self,
        asked: &BTreeMap<String, ParamValue>,
        viewport: [u32; 2],
        features: wgt::Features,
    ) -> Result<BTreeMap<String, ParamValue>, Diagnostics> {
        let mut reports = Reports::default();
        let context = Surroundings { viewport, features };
        match checked(&self.document, asked, context, &mut reports) {
            Ok(params) => Ok(params
                .list
                .into_iter()
                .filter_map(|bound| Some((bound.param.name.value, bound.value.ok()?)))
                .collect()),
            Err(_) => Err(self.diagnostics(reports.into_list())),
        }
    }

    /// Returns the promises of the document about itself for these values of params and this
    /// viewport, on a device with these features.
    ///
    /// # Errors
    /// If a value does not fit, or a condition has no value.
    pub fn claims(
        &self,
        asked: &BTreeMap<String, ParamValue>,
        viewport: [u32; 2],
        features: wgt::Features,
    ) -> Result<Vec<Claim>, Diagnostics> {
        let mut reports = Reports::default();
        let context = Surroundings { viewport, features };
        let claims = claims(&self.document, asked, context, &mut reports);
        match reports.errors() {
            0 => Ok(claims),
            _ => Err(self.diagnostics(reports.into_list())),
        }
    }

    /// Warns of materials and params of the document that nothing names; those of documents that it
    /// includes or extends need not all be of use.
    fn unused(&self, reports: &mut Reports) {
        let document = &self.document;
        let used = Used::new(document, &self.shaders);
        for material in &document.materials {
            let name = material.name();
            if document.is_own(&name.span) && !used.materials.contains(name.as_str()) {
                let name = Located::new(name.value.to_string(), name.span.clone());
                reports.warn(ComposeError::UnusedMaterial(name));
            }
        }
        for (name, _) in &document.values {
            let is_used =
                used.params.contains(name.as_str()) || used.materials.contains(name.as_str());
            if document.is_own(&name.span) && !is_used {
                let name = Located::new(name.value.to_string(), name.span.clone());
                reports.warn(ComposeError::UnusedValue(name));
            }
        }
        for param in &document.params[..document.declared] {
            if document.is_own(&param.name.span) && !used.params.contains(&param.name.value) {
                reports.warn(ComposeError::UnusedParam(param.name.clone()));
            }
        }
        let imported = self.shaders.imported();
        for entry in &document.imports {
            let path = self.shaders.module(&entry.of);
            if document.is_own(&entry.of.span)
                && path.is_some_and(|path| !imported.contains(&**path))
            {
                reports.warn(ComposeError::UnusedImport(entry.of.clone()));
            }
        }
        for (unused, shader) in self.unused_in_shaders() {
            reports.warn(ShaderError::Unused {
                what: unused.what,
                name: unused.name,
                shader,
            });
        }
    }

    /// Returns the unused items of the shaders of the document's own passes, whatever modules they
    /// import, each with its shader.
    fn unused_in_shaders(&self) -> Vec<(unused::Unused, String)> {
        let mut found: Vec<(unused::Unused, String)> = Vec::new();
        let mut finder = unused::UnusedFinder::default();
        let mut constants = BTreeSet::new();
        self.document.visit(&mut |leaf| {
            if let Leaf::Constant(name) = leaf {
                constants.insert(name);
            }
        });
        each_entry(&self.document.entries, &mut |entry| {
            let What::Pass(pass) = &entry.what else {
                return;
            };
            for shader in &pass.shaders {
                let mut variants = self.shaders.variants(&self.document, shader);
                let Some(first) = variants.next() else {
                    continue;
                };
                let mut unused = finder.find(first, &constants);
                for other in variants {
                    let other = finder.find(other, &constants);
                    unused.retain(|unused| other.contains(unused));
                }
                unused.retain(|unused| found.iter().all(|(known, _)| known != unused));
                found.extend(unused.into_iter().map(|it| (it, first.file().to_owned())));
            }
        });
        found
    }

    /// The place of the document itself, for mistakes of a request.
    pub(crate) fn place(&self) -> Span {
        self.document.file.span(0..0)
    }
}

fn required(documents: &[&Document]) -> wgt::Features {
    let required = documents.iter().flat_map(|document| &document.requires);
    required.fold(wgt::Features::empty(), |all, (_, flag)| all | *flag)
}

fn asked_for(documents: &[&Document]) -> wgt::Features {
    let mut features = wgt::Features::empty();
    for document in documents {
        document.visit(&mut |leaf| {
            if let Leaf::Has(flag) = leaf {
                features |= flag;
            }
        });
        each_entry(&document.entries, &mut |entry| {
            if let What::Pass(pass) = &entry.what {
                features |= pass.features;
            }
        });
    }
    features
}

fn load_pictures(
    documents: &[&Document],
    sources: &dyn Sources,
    reports: &mut Reports,
) -> Pictures {
    let mut pictures = HashMap::new();
    for document in documents {
        for material in &document.materials {
            let Material::Texture(TextureEntry {
                file: Some(file), ..
            }) = material
            else {
                continue;
            };
            let key = (Arc::clone(&document.file.name), file.value.clone());
            pictures.entry(key).or_insert_with(|| {
                let picture = load_picture(file, sources);
                picture.map_err(|error| reports.report(error))
            });
        }
    }
    Pictures(pictures)
}

/// The picture of that name, beside the file in which it is written or in `pipelines/`.
fn load_picture(file: &Located<String>, sources: &dyn Sources) -> Result<Picture, SizeError> {
    let candidates = include_candidates(&file.span.file.name, file);
    if escapes(file) {
        return Err(SizeError::NoPicture(file.clone(), candidates));
    }
    for path in &candidates {
        match sources.picture(path) {
            Ok(Some(picture)) => return Ok(picture),
            Ok(None) => {}
            Err(why) => return Err(SizeError::Picture(file.clone(), why)),
        }
    }
    Err(SizeError::NoPicture(file.clone(), candidates))
}
