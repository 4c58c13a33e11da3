//! [`Loaded`]: a document that was read, with its shaders and pictures.

use super::reader::{IncludeSite, Reader, label};
use super::used::{Used, drop_unused};
use crate::diagnostics::{Diagnostic, Diagnostics, Reported, Reports, Severity};
use crate::document::{Document, ImportEntry};
use crate::errors::compose::ComposeError;
use crate::errors::resource::SizeError;
use crate::errors::shader::ShaderError;
use crate::expressions::parser;
use crate::kinds::{Registry, StandIn};
use crate::language::{Leaf, Name};
use crate::param::{Param, ParamError, find};
use crate::picture::Picture;
use crate::shader::{ShaderFiles, Shaders, mixed, store, unused};
use crate::source::paths::{escapes, include_candidates, module_candidates};
use crate::source::{Located, SourceFile, Sources, Span};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

/// A document that was read, with all documents, shaders and pictures that it names.
#[derive(Debug)]
pub(crate) struct Loaded {
    /// The document that was asked for, with the documents that it includes.
    pub document: Arc<Document>,
    pub shaders: Shaders,
    pub pictures: Pictures,
    include_sites: Vec<IncludeSite>,
    /// Device features that the document and its includes require (`requires`).
    pub required: wgt::Features,
    /// Features that they ask for by `has`, or that their passes can make use of.
    asked_for: wgt::Features,
    /// Warnings that loading gave, in the order in which they were found.
    pub warnings: Vec<Diagnostic>,
}

/// Decoded pictures of all documents, by the path of the document and the name of the texture.
#[derive(Debug, Default)]
pub(crate) struct Pictures(HashMap<(Arc<str>, String), Reported<Picture>>);

impl Pictures {
    pub fn get(&self, document: &Document, texture: &Name) -> Reported<Picture> {
        let key = (Arc::clone(&document.file.name), texture.to_string());
        self.0[&key].clone()
    }
}

impl Loaded {
    /// Reads the document at `path` with its includes, and all shaders and pictures that they name.
    /// Returns the readable part, and the errors. `chosen` maps names of open includes to paths of
    /// the documents to include there, and names of textures to paths of other pictures.
    ///
    /// # Errors
    /// All diagnostics, if the document at `path` itself cannot be read.
    pub fn read(
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
        let mut files = ShaderFiles::new(sources);
        let defaults = default_imports(registry, &mut files);
        root.imports.splice(0..0, defaults);
        let documents = [&root].into_iter();
        let documents: Vec<&Document> = documents.chain(included.iter().map(|d| &**d)).collect();
        let shaders = store::load(&root, files, &mut reports);
        // All of the registry's or none: shaders were compiled so.
        let imported = shaders.imported();
        let is_default = |entry: &ImportEntry| entry.items_of.is_some();
        let takes_defaults = root.imports.iter().any(|entry| {
            let module = shaders.module(&entry.of);
            is_default(entry) && module.is_some_and(|it| imported.contains(&**it))
        });
        let pictures = load_pictures(&documents, sources, chosen, &mut reports);
        let (required, asked_for) = (required(&documents), asked_for(&documents));
        // The uses of a missing shader are not known.
        let is_known = reports.errors() == 0;
        root.imports.retain(|it| takes_defaults || !is_default(it));
        if is_known {
            drop_unused(&mut root, &shaders, &mut HashMap::new(), &mut reports);
        }
        let mut loaded = Self {
            required,
            asked_for,
            document: Arc::new(root),
            shaders,
            pictures,
            include_sites: asked,
            warnings: Vec::new(),
        };
        if is_known {
            loaded.unused(&mut reports);
        }
        let is_error = |diagnostic: &Diagnostic| diagnostic.severity == Severity::Error;
        let (errors, warnings) = reports.into_list().into_iter().partition(is_error);
        loaded.warnings = warnings;
        Ok((loaded, errors))
    }

    /// Returns the path of the document that was asked for.
    pub fn path(&self) -> &str {
        &self.document.file.name
    }

    /// Returns the start of the document, as the place for mistakes of a request.
    pub fn place(&self) -> Span {
        self.document.file.span(0..0)
    }

    /// Returns all device features that matter to the graph: required ones, ones that `has(…)` asks
    /// for, and ones that a pass can use.
    pub fn features(&self) -> wgt::Features {
        self.required | self.asked_for
    }

    pub fn param(&self, name: &str) -> Result<&Param, ParamError> {
        find(&self.document.params, name, self.path())
    }

    /// Sorts diagnostics of the document. One of an included or extended document also gets the
    /// place where that document is included or extended.
    pub fn diagnostics(&self, mut list: Vec<Diagnostic>) -> Diagnostics {
        label(&mut list, self.path(), &self.include_sites);
        Diagnostics::new(list)
    }

    /// Warns of materials and params of the document that nothing names; those of documents that it
    /// includes or extends need not all be of use.
    fn unused(&self, reports: &mut Reports) {
        let document = &self.document;
        let used = Used::new(document, &self.shaders);
        let mut check = |what, name: Located<String>, is_used: bool| {
            if document.is_own(&name.span) && !is_used {
                reports.warn(ComposeError::Unused(what, name));
            }
        };
        for material in &document.materials {
            let name = material.name();
            let is_used = used.materials.contains(name.as_str());
            check("material", name.text(), is_used);
        }
        for (name, _) in &document.values {
            let is_used =
                used.params.contains(name.as_str()) || used.materials.contains(name.as_str());
            check("value", name.text(), is_used);
        }
        for param in &document.params[..document.declared] {
            let is_used = used.params.contains(&param.name.value);
            check("param", param.name.clone(), is_used);
        }
        let imported = self.shaders.imported();
        for entry in &document.imports {
            let path = self.shaders.module(&entry.of);
            let is_used = path.is_none_or(|path| imported.contains(&**path));
            check("import", entry.of.clone(), is_used);
        }
        for (unused, shader) in self.unused_in_shaders() {
            reports.warn(ShaderError::Unused(unused.what, unused.name, shader));
        }
        for file in self.own_shader_files() {
            for mixed::Mixed { first, second, at } in mixed::find(&file.text) {
                let at = Span {
                    file: file.clone(),
                    range: at,
                };
                reports.warn(ShaderError::Mixed(first, second, at));
            }
        }
    }

    /// Returns the files of the shaders of the document's own passes, with those that they import.
    fn own_shader_files(&self) -> impl Iterator<Item = &SourceFile> {
        let shaders = self.document.passes().flat_map(|pass| &pass.shaders);
        let variants = shaders.flat_map(|shader| self.shaders.variants(&self.document, shader));
        let files = variants.flat_map(|variant| {
            let imported = variant.source.imports.iter().map(|line| &line.file);
            std::iter::once(&variant.source.file).chain(imported)
        });
        let files: BTreeMap<&str, &SourceFile> = files.map(|file| (&*file.name, file)).collect();
        files.into_values()
    }

    /// Returns the unused items of the shaders of the document's own passes, whatever modules they
    /// import, each with its shader.
    fn unused_in_shaders(&self) -> Vec<(unused::Unused, String)> {
        let mut unused_items: Vec<(unused::Unused, String)> = Vec::new();
        let mut finder = unused::UnusedFinder::default();
        let mut constants = BTreeSet::new();
        self.document.visit(&mut |leaf| {
            if let Leaf::Constant(name) = leaf {
                constants.insert(name);
            }
        });
        for shader in self.document.passes().flat_map(|pass| &pass.shaders) {
            let mut variants = self.shaders.variants(&self.document, shader);
            let Some(first) = variants.next() else {
                continue;
            };
            let mut unused = finder.find(first, &constants);
            for other in variants {
                let other = finder.find(other, &constants);
                unused.retain(|unused| other.contains(unused));
            }
            unused.retain(|unused| unused_items.iter().all(|(item, _)| item != unused));
            unused_items.extend(unused.into_iter().map(|it| (it, first.file().to_owned())));
        }
        unused_items
    }
}

/// Returns the imports of a registry of which the sources have both modules.
fn default_imports(registry: &Registry, files: &mut ShaderFiles<'_>) -> Vec<ImportEntry> {
    let mut is_there = |name| matches!(files.find(&module_candidates("", name)), Ok(Some(_)));
    let stand_ins = registry.stand_ins().iter();
    let stand_ins = stand_ins.filter(|it| is_there(it.module) && is_there(it.is));
    let entry = |it: &StandIn| {
        let file = SourceFile::new("", format!("{}.count > 0", it.items_of));
        let named = |name: &str| Located::new(name.to_owned(), file.span(0..0));
        Some(ImportEntry {
            of: named(it.module),
            is: named(it.is),
            condition: Some(parser::expression(&file, 0..file.text.len()).ok()?),
            items_of: Some(it.items_of),
        })
    };
    stand_ins.filter_map(entry).collect()
}

fn required(documents: &[&Document]) -> wgt::Features {
    let required = documents.iter().flat_map(|document| &document.requires);
    required.fold(wgt::Features::empty(), |flags, (_, flag)| flags | *flag)
}

fn asked_for(documents: &[&Document]) -> wgt::Features {
    let mut features = wgt::Features::empty();
    for document in documents {
        document.visit(&mut |leaf| {
            if let Leaf::Has(flag) = leaf {
                features |= flag;
            }
        });
        for pass in document.passes() {
            features |= pass.features;
        }
    }
    features
}

fn load_pictures(
    documents: &[&Document],
    sources: &dyn Sources,
    chosen: &BTreeMap<String, String>,
    reports: &mut Reports,
) -> Pictures {
    let mut pictures = HashMap::new();
    for (number, document) in documents.iter().enumerate() {
        for (name, file) in document.pictures() {
            let picture = match chosen.get(name.as_str()).filter(|_| number == 0) {
                Some(path) => {
                    let file = Located::new(path.clone(), file.span.clone());
                    picture_at(&file, std::slice::from_ref(path), sources)
                }
                None => load_picture(file, sources),
            };
            let key = (Arc::clone(&document.file.name), name.to_string());
            pictures.insert(key, picture.map_err(|error| reports.report(error)));
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
    picture_at(file, &candidates, sources)
}

/// The picture at the first of these paths at which there is one.
fn picture_at(
    file: &Located<String>,
    candidates: &[String],
    sources: &dyn Sources,
) -> Result<Picture, SizeError> {
    for path in candidates {
        match sources.picture(path) {
            Ok(Some(picture)) => return Ok(picture),
            Ok(None) => {}
            Err(why) => return Err(SizeError::Picture(file.clone(), why)),
        }
    }
    Err(SizeError::NoPicture(file.clone(), candidates.to_vec()))
}
