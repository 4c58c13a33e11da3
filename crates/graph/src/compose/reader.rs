//! Reads a document with all that it extends and includes.

use super::unique;
use crate::diagnostics::suggest::likeness;
use crate::diagnostics::{Diagnostic, ErrorGuaranteed, Label, Reported, Reports};
use crate::document::extend::extend;
use crate::document::typed::each_include;
use crate::document::{Document, Entry, Include, Invalid, RawDocument, What, raw, read};
use crate::errors::compose::ComposeError;
use crate::kinds::Registry;
use crate::language::{Expr, Leaf, Name};
use crate::param::Param;
use crate::source::paths::{escapes, folder_of, include_candidates};
use crate::source::{Located, SourceFile, Sources, Span, sources};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

/// Deepest chain of includes or extended documents; far above any sensible house, far below the
/// stack.
const DEEPEST: usize = 64;

/// Place where a document is extended or included: path of that document, the place, and a text for
/// the label such as "included here".
pub(crate) type IncludeSite = (String, Span, &'static str);

/// Reads a document with the documents that it extends and includes, each once.
pub(crate) struct Reader<'a> {
    registry: &'a Registry,
    sources: &'a dyn Sources,
    pub reports: &'a mut Reports,
    /// By path.
    read: HashMap<String, Reported<Arc<Document>>>,
    /// The documents that are being read, outermost first, with the include that asks for each.
    open: Vec<(String, Option<Span>)>,
    /// Every place where a document is extended or included, in the order in which they were read.
    pub include_sites: Vec<IncludeSite>,
    /// Paths of documents for open includes of the root document, and of pictures for its textures.
    chosen: &'a BTreeMap<String, String>,
}

impl<'a> Reader<'a> {
    /// Creates a reader. `chosen` maps names of open includes of the root document to paths of the
    /// documents to include there, and names of its textures to paths of pictures.
    pub fn new(
        registry: &'a Registry,
        sources: &'a dyn Sources,
        chosen: &'a BTreeMap<String, String>,
        reports: &'a mut Reports,
    ) -> Self {
        Self {
            registry,
            sources,
            reports,
            read: HashMap::new(),
            open: Vec::new(),
            include_sites: Vec::new(),
            chosen,
        }
    }

    /// Iterates over the included documents that could be read, each once, in no order.
    pub fn documents(&self) -> impl Iterator<Item = &Arc<Document>> {
        self.read.values().flatten()
    }

    /// Reads the document at `path` with all that it includes.
    pub fn root(&mut self, path: &str) -> Reported<Document> {
        let file = self.file(path)?;
        let document = self.document(file, None)?;
        let openings = document.openings();
        let names = openings.map(|(name, _)| name.to_string());
        let pictures = document.pictures().map(|(name, _)| name.to_string());
        let names: Vec<String> = names.chain(pictures).collect();
        for name in self.chosen.keys().filter(|name| !names.contains(name)) {
            let (name, names) = (name.clone(), names.clone());
            self.reports
                .report(ComposeError::NoOpening(name, path.to_owned(), names));
        }
        Ok(document)
    }

    /// Reads the document at `path`, with the documents that it extends merged in. Includes are not
    /// read.
    pub fn flat(&mut self, path: &str) -> Reported<RawDocument> {
        let file = self.file(path)?;
        self.raw(file, &mut Vec::new())
    }

    fn file(&mut self, path: &str) -> Reported<SourceFile> {
        let error = match sources::read(self.sources, path) {
            Ok(Some(text)) => return Ok(SourceFile::new(path, text)),
            Ok(None) => {
                let (folder, name) = path.rsplit_once('/').unwrap_or(("", path));
                let documents = self.documents_in(folder);
                ComposeError::NoDocument(path.to_owned(), likeness(name, documents))
            }
            Err(why) => ComposeError::Unreadable(path.to_owned(), why),
        };
        Err(self.reports.report(error))
    }

    fn documents_in(&self, folder: &str) -> Vec<String> {
        let mut files = self.sources.list(folder);
        files.retain(|name| name.ends_with(".ron"));
        files
    }

    /// Reads a document, which is asked for at `by`.
    fn document(&mut self, file: SourceFile, by: Option<Span>) -> Reported<Document> {
        self.open.push((file.name.to_string(), by));
        let raw = self.raw(file, &mut Vec::new());
        let document = raw.map(|raw| {
            let mut document = read::document(raw, self.registry, self.reports);
            document.include_depth = self.attach(&mut document.entries);
            self.fewer_lights(&mut document);
            self.expose(&mut document);
            self.narrow(&mut document);
            document.gives_values = value_outputs(&document);
            unique::check(&document, self.reports);
            document
        });
        self.open.pop();
        document
    }

    /// The sections of a document with those of the documents that it extends; `chain` are the ones
    /// that extend it.
    fn raw(&mut self, file: SourceFile, chain: &mut Vec<String>) -> Reported<RawDocument> {
        let mut own = raw::split(file, self.reports)?;
        let Some(node) = own.extends.take() else {
            return Ok(own);
        };
        let name = Located::new(self.reports.check(node.parse())?, node);
        let base = self.find(&name)?;
        let path = base.name.to_string();
        chain.push(own.file.name.to_string());
        if let Some(first) = chain.iter().position(|open| *open == path) {
            let mut cycle = chain[first..].to_vec();
            cycle.push(path);
            let error = crate::errors::edit::EditError::Cycle(name.span, cycle);
            return Err(self.reports.report(error));
        }
        if chain.len() > DEEPEST {
            return Err(self.too_deep(&name));
        }
        self.include_sites.push((path, name.span, "extended here"));
        let base = self.raw(base, chain)?;
        Ok(extend(base, own, self.reports))
    }

    /// Reads what the entries of the innermost open document include. Returns the depth of includes
    /// below it.
    fn attach(&mut self, entries: &mut [Result<Entry, Invalid>]) -> usize {
        let mut depth = 0;
        each_include(entries, &mut |include| {
            include.document = Some(self.include(include));
            // A document that could not be read was reported; it counts as depth 0.
            let document = include.document();
            depth = depth.max(document.map_or(0, |document| document.include_depth + 1));
        });
        depth
    }

    fn include(&mut self, include: &mut Include) -> Reported<Arc<Document>> {
        let file = match self.chosen_for(include) {
            Some(path) => {
                include.graph.value = path.clone();
                self.file(&path)?
            }
            None => self.find(&include.graph)?,
        };
        let path = file.name.to_string();
        let span = include.graph.span.clone();
        if let Some(first) = self.open.iter().position(|(open, _)| *open == path) {
            let open = self.open[first..].to_vec();
            let error = ComposeError::Cycle(include.graph.clone(), open);
            return Err(self.reports.report(error));
        }
        let site = (path.clone(), span.clone(), "included here");
        self.include_sites.push(site);
        if self.open.len() > DEEPEST {
            return Err(self.too_deep(&include.graph));
        }
        if !self.read.contains_key(&path) {
            // Without its params nothing of the document has a size.
            let document = self.document(file, Some(span));
            let document = document.and_then(|it| it.invalid_params.map_or(Ok(Arc::new(it)), Err));
            self.read.insert(path.clone(), document);
        }
        let document = self.read[&path].clone()?;
        if self.open.len() + document.include_depth > DEEPEST {
            return Err(self.too_deep(&include.graph));
        }
        Ok(document)
    }

    fn too_deep(&mut self, graph: &Located<String>) -> ErrorGuaranteed {
        let error = ComposeError::TooDeep(graph.clone(), DEEPEST);
        self.reports.report(error)
    }

    /// The path of the document that was asked for in the place of an open include's own. Included
    /// documents keep theirs: one name would mean a place in each of them.
    fn chosen_for(&self, include: &Include) -> Option<String> {
        let is_root = self.open.len() == 1;
        let name = include.open.as_ref().filter(|_| is_root)?;
        self.chosen.get(name.as_str()).cloned()
    }

    /// A document takes no light that the document in an open include of it does not take. One that
    /// names no lights takes those of any that names none.
    fn fewer_lights(&mut self, document: &mut Document) {
        let mut lights = std::mem::take(&mut document.lights);
        for (_, include, inner) in document.includes().filter(|(_, it, _)| it.open.is_some()) {
            let had_some = !lights.is_empty();
            lights.retain(|light| inner.lights.iter().any(|other| other.value == light.value));
            if had_some && lights.is_empty() && !inner.lights.is_empty() {
                let takes = inner.lights.iter().map(|light| light.to_string()).collect();
                let error = ComposeError::NoCommonLight(include.graph.clone(), takes);
                self.reports.report(error);
            }
        }
        document.lights = lights;
    }

    /// The file of a document, beside the one in which its name is written or in `pipelines/`.
    fn find(&mut self, graph: &Located<String>) -> Reported<SourceFile> {
        if escapes(graph) {
            return Err(self.reports.report(ComposeError::Outside(graph.clone())));
        }
        let candidates = include_candidates(&graph.span.file.name, graph);
        for path in &candidates {
            match sources::read(self.sources, path) {
                Ok(Some(text)) => return Ok(SourceFile::new(path.as_str(), text)),
                Ok(None) => {}
                Err(why) => {
                    let path = Located::new(path.clone(), graph.span.clone());
                    let error = ComposeError::UnreadableInclude(path, why);
                    return Err(self.reports.report(error));
                }
            }
        }
        let below = folder_of(graph);
        let folders = candidates.iter().map(|path| folder_of(path));
        let paths = folders
            .flat_map(|folder| self.documents_in(folder))
            .map(|name| match below {
                "" => name,
                _ => format!("{below}/{name}"),
            });
        let likeness = likeness(graph, paths.collect::<Vec<_>>());
        let error = ComposeError::NoInclude(graph.clone(), candidates, likeness);
        Err(self.reports.report(error))
    }

    /// Takes words away from the choices that a document narrows.
    fn narrow(&mut self, document: &mut Document) {
        for (name, narrow) in std::mem::take(&mut document.narrow) {
            let mut params = document.params.iter_mut();
            let Some(param) = params.find(|param| *param.name.value == *name) else {
                self.no_param(name, document);
                continue;
            };
            if let Err(word) = param.narrow(&narrow.words, &narrow.because) {
                let declared = param.name.span.clone();
                self.reports.report(match word {
                    None => ComposeError::NarrowOfOther(name, declared),
                    Some(word) => {
                        let words = param.words().map(Name::to_string).collect();
                        ComposeError::NarrowWord(word, declared, words)
                    }
                });
            }
        }
    }

    /// Adds the params of included documents that a document makes its own.
    fn expose(&mut self, document: &mut Document) {
        let own = document.params.iter().map(|param| param.name.value.clone());
        let own = own.chain(names_of_values(document)).collect();
        expose_all(&mut document.entries, &own, &BTreeSet::new());
        let mut exposed: Vec<(Param, Span)> = Vec::new();
        for (entry, include, inner) in document.includes() {
            for name in &include.expose.names {
                let Some(param) = inner.param(name) else {
                    self.reports.report(no_param(name.clone(), inner));
                    continue;
                };
                let mut param = param.clone();
                param.name.value = entry.outer_name(include, name);
                if !has_constant_default(&param) {
                    self.reports
                        .report(ComposeError::ExposedDefault(name.clone()));
                    continue;
                }
                exposed.push((param, name.span.clone()));
            }
        }
        for (mut param, span) in exposed {
            let mut params = document.params.iter();
            let position = params.position(|other| other.name.value == param.name.value);
            // The same declaration twice is one param.
            if position.is_some_and(|at| document.params[at].name.span == param.name.span) {
                continue;
            }
            if let Some(at) = position {
                let first = &document.params[at];
                let (declared, exposing) = (document.rank(&first.name.span), document.rank(&span));
                // It takes the place of a param of a document that this one extends.
                if at < document.declared && declared > exposing {
                    let first = document.params.remove(at);
                    document.declared -= 1;
                    let default = first.default;
                    let is_edited = |default: &Expr| document.rank(&default.span) < declared;
                    if let Some(default) = default.filter(is_edited) {
                        param.default = Some(default);
                        param.tune.clear();
                    }
                    document.params.push(param);
                    continue;
                }
                let name = Located::new(param.name.value, span);
                let error = ComposeError::ExposedTwice(name, first.name.span.clone());
                document.invalid_params = Some(self.reports.report(error));
                continue;
            }
            document.params.push(param);
        }
        self.set_defaults(document);
    }

    /// Gives params of included documents the defaults that a document sets.
    fn set_defaults(&mut self, document: &mut Document) {
        for (name, value) in std::mem::take(&mut document.defaults) {
            let mut params = document.params.iter_mut();
            match params.find(|param| *param.name.value == *name) {
                // It is the document's decision now, and no longer to be searched for.
                Some(param) => {
                    param.default = Some(value);
                    param.tune.clear();
                }
                None => self.no_param(name, document),
            }
        }
    }

    /// Reports a name that is no param of a document whose own are all read.
    fn no_param(&mut self, name: Located<String>, document: &Document) {
        if document.invalid_params.is_none() {
            self.reports.report(no_param(name, document));
        }
    }
}

fn no_param(name: Located<String>, document: &Document) -> ComposeError {
    let names = document.params.iter().map(|param| param.name.value.clone());
    ComposeError::NoParam(name, document.file.name.to_string(), names.collect())
}

/// Writes out which params `expose: All` exposes: those that neither the include nor a group around
/// it sets, and that do not ask for a param or value of the document's own.
fn expose_all(
    entries: &mut [Result<Entry, Invalid>],
    own: &BTreeSet<String>,
    set_around: &BTreeSet<String>,
) {
    for entry in entries.iter_mut().flatten() {
        let set = entry.set.iter().map(|(name, _)| name.value.clone());
        let set: BTreeSet<String> = set.chain(set_around.iter().cloned()).collect();
        match &mut entry.what {
            What::Group(inner) => expose_all(inner, own, &set),
            What::Include(include) if include.expose.all => {
                let span = include.graph.span.clone();
                let Some(document) = include.document() else {
                    continue;
                };
                let is_free = |param: &&Param| {
                    let name = &param.name.value;
                    !set.contains(name) && (param.default.is_some() || !own.contains(name))
                };
                let free = document.params.iter().filter(is_free);
                include.expose.names = free
                    .map(|param| Located::new(param.name.value.clone(), span.clone()))
                    .collect();
            }
            What::Include(_) | What::Pass(_) => {}
        }
    }
}

fn names_of_values(document: &Document) -> impl Iterator<Item = String> {
    let values = document.values.iter();
    values.map(|(name, _)| name.value.to_string())
}

/// The outputs of a document that are values: its own, or those of includes without a name.
fn value_outputs(document: &Document) -> BTreeSet<String> {
    let mut values: BTreeSet<String> = names_of_values(document).collect();
    for (entry, include, inner) in document.includes() {
        let given = inner.gives_values.iter();
        values.extend(given.map(|name| entry.outer_name(include, name)));
    }
    let outputs = document.outputs.iter();
    let values = outputs.filter(|output| values.contains(&output.material.path()));
    values.map(|output| output.name.value.to_string()).collect()
}

/// True if a param's default asks for no other param.
fn has_constant_default(param: &Param) -> bool {
    let mut is_constant = true;
    if let Some(default) = &param.default {
        default.visit(&mut |leaf| is_constant &= !matches!(leaf, Leaf::Param(_)));
    }
    is_constant
}

/// Adds labels to mistakes in other documents than `root`: the places where these are included or
/// extended.
pub(crate) fn label(diagnostics: &mut [Diagnostic], root: &str, include_sites: &[IncludeSite]) {
    /// More includes of one document say nothing new.
    const SHOWN: usize = 4;
    for diagnostic in diagnostics {
        // The mistake is the root's own, and what it includes is only named.
        let own = diagnostic.labels.first().map(|label| &label.span.file.name);
        if own.is_none_or(|own| **own == *root) {
            continue;
        }
        let mut at = 0;
        // A document may be included by one that is included itself.
        while let Some(label) = diagnostic.labels.get(at) {
            let file = label.span.file.name.clone();
            let asking = include_sites.iter().filter(|(path, ..)| **path == *file);
            for (_, span, text) in asking.take(SHOWN) {
                if diagnostic.labels.iter().all(|label| label.span != *span) {
                    diagnostic.labels.push(Label {
                        span: span.clone(),
                        text: (*text).to_owned(),
                    });
                }
            }
            at += 1;
        }
    }
}
