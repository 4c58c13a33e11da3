//! The shaders of all documents, each compiled with the modules that its document has it import.

use super::blame::without_functions;
use super::constants::ChoiceConstants;
use super::expand::{Expanded, Replaced, ShaderFiles};
use super::reflect::Shader;
use super::wgsl_errors::unknown_name;
use crate::diagnostics::{ErrorGuaranteed, Reported, Reports};
use crate::document::Document;
use crate::errors::shader::{ImportError, ShaderError};
use crate::kinds::ShaderUse;
use crate::source::paths::folder_of;
use crate::source::{Located, Span};
use std::collections::{BTreeSet, HashMap, HashSet};
use std::sync::Arc;

/// Most conditions of `imports` around one document: a shader is compiled for all their values.
const MOST_CONDITIONS: usize = 6;

/// The compiled shaders of all documents.
#[derive(Debug, Default)]
pub(crate) struct Shaders {
    shaders: HashMap<ShaderKey, Vec<Variant>>,
    /// Paths of modules, by the folder of the document that names one, and its name there.
    modules: HashMap<(String, String), String>,
    /// Set if some modules or shaders were not read, which was reported.
    pub incomplete: Option<ErrorGuaranteed>,
}

/// The path of the document whose `Choice` words a shader sees, the folder that it was first looked
/// for in, its name.
type ShaderKey = (Arc<str>, String, String);

/// A shader with the modules that stand in for others.
type Variant = (Replaced, Result<Arc<Shader>, Invalid>);

/// A shader that is not valid, which was reported.
#[derive(Clone, Debug)]
pub(crate) struct Invalid {
    pub reported: ErrorGuaranteed,
    /// The shader without its functions; `None` if it is not valid even so.
    pub declarations: Option<Arc<Shader>>,
}

impl Shaders {
    fn key(document: &Document, name: &Located<String>) -> ShaderKey {
        let (folder, name) = Self::module_key(name);
        (Arc::clone(&document.file.name), folder, name)
    }

    /// Returns the shader that a pass of a document names. `around` holds the modules that replace
    /// others in the document's shaders. `None` if the shader was not read with the document.
    pub fn get(
        &self,
        document: &Document,
        shader: &ShaderUse,
        around: &Replaced,
    ) -> Option<Reported<Arc<Shader>>> {
        let shader = self.variant(document, shader, around)?.clone();
        Some(shader.map_err(|invalid| invalid.reported))
    }

    /// Returns the declarations of a shader that is not valid, without its functions; `None` if the
    /// shader is valid, was not read, or not even its declarations are valid.
    pub fn declarations(
        &self,
        document: &Document,
        shader: &ShaderUse,
        around: &Replaced,
    ) -> Option<Arc<Shader>> {
        let invalid = self.variant(document, shader, around)?.as_ref().err()?;
        invalid.declarations.clone()
    }

    fn variant(
        &self,
        document: &Document,
        shader: &ShaderUse,
        around: &Replaced,
    ) -> Option<&Result<Arc<Shader>, Invalid>> {
        let replaced = self.with_own(around, shader);
        let mut variants = self.shaders.get(&Self::key(document, &shader.name))?.iter();
        let variant = variants.find(|(other, _)| *other == replaced);
        variant.map(|(_, shader)| shader)
    }

    /// Iterates over the valid variants of the shader that a pass of a document names: one for each
    /// set of modules that replace others.
    pub fn variants(
        &self,
        document: &Document,
        shader: &ShaderUse,
    ) -> impl Iterator<Item = &Arc<Shader>> {
        let variants = self.shaders.get(&Self::key(document, &shader.name));
        let variants = variants.into_iter().flatten();
        variants.filter_map(|(_, shader)| shader.as_ref().ok())
    }

    /// Returns the paths of all modules that `#import` lines of the valid shaders name.
    pub fn imported(&self) -> BTreeSet<&str> {
        let read = self.shaders.values().flatten();
        read.filter_map(|(_, shader)| shader.as_ref().ok())
            .flat_map(|shader| &shader.source.imports)
            .map(|line| &*line.path)
            .collect()
    }

    /// Returns the path in the store of a module that a document names; `None` if the module was
    /// not found.
    pub fn module(&self, name: &Located<String>) -> Option<&String> {
        self.modules.get(&Self::module_key(name))
    }

    fn module_key(name: &Located<String>) -> (String, String) {
        let folder = folder_of(&name.span.file.name).to_owned();
        (folder, name.value.clone())
    }

    /// Sets in `around` that the module `is` replaces `module`, instead of an older
    /// replacement of `module`. Replacements of an included document count more than those of the
    /// document around it, so they are set later. Does nothing if one of the two was not found when
    /// the shaders were loaded (which was reported), or is named nowhere in their documents.
    pub fn replace(&self, around: &mut Replaced, module: &Located<String>, is: &Located<String>) {
        // One that is not there was reported.
        if let (Some(module), Some(is)) = (self.module(module), self.module(is)) {
            around.insert(module.clone(), is.clone());
        }
    }

    /// With the modules that a pass kind has a shader of its own import.
    fn with_own(&self, around: &Replaced, shader: &ShaderUse) -> Replaced {
        let mut replaced = around.clone();
        for (module, is) in &shader.imports {
            self.replace(&mut replaced, module, is);
        }
        replaced
    }
}

/// A module that stands in for another one, or may.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Rule {
    of: String,
    is: String,
    /// The document and the text of the condition.
    condition: Option<(Arc<str>, String)>,
}

/// Reads and compiles the shaders of documents.
pub(crate) struct Loader<'a> {
    files: ShaderFiles<'a>,
    shaders: Shaders,
    /// A shader that several documents use is one, unless their words make two of it.
    parsed: HashMap<String, Result<Arc<Shader>, Invalid>>,
    /// Documents with the rules around them whose shaders are read.
    seen: HashSet<(Arc<str>, Vec<Rule>)>,
    clashed: HashSet<Arc<str>>,
    reports: &'a mut Reports,
}

/// Reads and compiles every shader that a document and its includes name.
pub(crate) fn load(root: &Document, files: ShaderFiles<'_>, reports: &mut Reports) -> Shaders {
    let mut loader = Loader {
        files,
        shaders: Shaders::default(),
        parsed: HashMap::new(),
        seen: HashSet::new(),
        clashed: HashSet::new(),
        reports,
    };
    loader.document(root, &[]);
    loader.shaders
}

impl Loader<'_> {
    fn document(&mut self, document: &Document, around: &[Rule]) {
        let mut rules = around.to_vec();
        for entry in &document.imports {
            let (Some(module), Some(is)) = (self.module(&entry.of), self.module(&entry.is)) else {
                continue;
            };
            self.check(&entry.is, &module, &is);
            let file = &document.file.name;
            let condition = entry.condition.as_ref();
            let condition = condition.map(|expr| (Arc::clone(file), expr.text().to_owned()));
            rules.push(Rule {
                of: module,
                is,
                condition,
            });
        }
        let key = (Arc::clone(&document.file.name), rules.clone());
        if !self.seen.insert(key) {
            return;
        }
        let conditions = rules.iter().filter_map(|rule| rule.condition.clone());
        let conditions: BTreeSet<_> = conditions.collect();
        if conditions.len() > MOST_CONDITIONS {
            let place = document.imports.last().map(|entry| entry.of.span.clone());
            let place = place.unwrap_or_else(|| document.file.span(0..0));
            let error = ImportError::TooManyConditions(place, conditions.len(), MOST_CONDITIONS);
            self.shaders.incomplete = Some(self.reports.report(error));
            return;
        }
        let (constants, clashes) = ChoiceConstants::new(&document.params);
        if self.clashed.insert(Arc::clone(&document.file.name)) {
            for clash in clashes {
                self.reports.report(clash);
            }
        }
        for values in 0..1u32 << conditions.len() {
            let holds = |condition: &(Arc<str>, String)| {
                let at = conditions.iter().position(|other| other == condition);
                at.is_some_and(|at| values >> at & 1 == 1)
            };
            let holds = |rule: &&Rule| rule.condition.as_ref().is_none_or(holds);
            let in_effect = rules.iter().filter(holds);
            let in_effect = in_effect.map(|rule| (rule.of.clone(), rule.is.clone()));
            let replaced: Replaced = in_effect.collect();
            for shader in document.passes().flat_map(|pass| &pass.shaders) {
                self.shader(document, shader, &constants, &replaced);
            }
        }
        for (_, _, inner) in document.includes() {
            self.document(inner, &rules);
        }
    }

    fn shader(
        &mut self,
        document: &Document,
        shader: &ShaderUse,
        constants: &ChoiceConstants,
        around: &Replaced,
    ) {
        for (module, is) in &shader.imports {
            if let (Some(module), Some(path)) = (self.module(module), self.module(is)) {
                self.check(is, &module, &path);
            }
        }
        let replaced = self.shaders.with_own(around, shader);
        let key = Shaders::key(document, &shader.name);
        let variants = self.shaders.shaders.get(&key);
        if variants.is_some_and(|variants| variants.iter().any(|(other, _)| *other == replaced)) {
            return;
        }
        let source = self.files.expand(&shader.name, &replaced);
        let read = match self.reports.check(source) {
            Ok(source) => self.parse(source, constants),
            Err(reported) => Err(Invalid {
                reported,
                declarations: None,
            }),
        };
        let variants = self.shaders.shaders.entry(key).or_default();
        variants.push((replaced, read));
    }

    fn parse(
        &mut self,
        mut source: Expanded,
        constants: &ChoiceConstants,
    ) -> Result<Arc<Shader>, Invalid> {
        let declared = constants.append(&mut source);
        let text = format!("{}\n{}", source.file.name, source.text);
        let (reports, files) = (&mut *self.reports, &mut self.files);
        let read = || {
            Shader::new(source.clone()).map(Arc::new).map_err(|error| {
                let reported = reports.report(with_import(error, &source, files));
                source.text = without_functions(&source.text);
                Invalid {
                    reported,
                    declarations: Shader::new(source).ok().map(Arc::new),
                }
            })
        };
        let shader = self.parsed.entry(text).or_insert_with(read);
        let shader = shader.clone()?;
        match constants.disagreement(&shader, &declared) {
            Some(clash) => Err(Invalid {
                reported: self.reports.report(clash),
                declarations: None,
            }),
            None => Ok(shader),
        }
    }

    /// The path of a module that a document names; `None` if there is none, which is reported once.
    fn module(&mut self, name: &Located<String>) -> Option<String> {
        if let Some(path) = self.shaders.module(name) {
            return Some(path.clone());
        }
        let file = self.reports.check(self.files.module(name)).ok()?;
        let path = file.name.to_string();
        let key = Shaders::module_key(name);
        self.shaders.modules.insert(key, path.clone());
        Some(path)
    }

    /// Functions that both modules have must be called alike.
    fn check(&mut self, name: &Located<String>, module: &str, is: &str) {
        let signatures = |files: &mut ShaderFiles<'_>, path: &str| {
            let file = files.find(&[path.to_owned()]).ok().flatten();
            file.map(|file| signatures(&file)).unwrap_or_default()
        };
        let wanted = signatures(&mut self.files, module);
        let given = signatures(&mut self.files, is);
        for (function, (text, place)) in given {
            let Some((other, declared)) = wanted.get(&function) else {
                continue;
            };
            if *other != text {
                self.reports.report(ImportError::Signature {
                    module: name.clone(),
                    function,
                    place,
                    declared: declared.clone(),
                });
            }
        }
    }
}

/// Names the module that declares a name which a shader does not know.
fn with_import(error: ShaderError, source: &Expanded, files: &mut ShaderFiles<'_>) -> ShaderError {
    let ShaderError::Naga(file, what, places, notes) = error else {
        return error;
    };
    let module = unknown_name(&what).and_then(|name| files.declaring(name, &source.file.name));
    let notes = module.map_or(notes, |path| {
        vec![format!(
            "`{path}` declares it: write `#import \"{path}\"` above"
        )]
    });
    ShaderError::Naga(file, what, places, notes)
}

/// The functions of a module, by name: parameters and result without spaces, and the place.
fn signatures(file: &crate::source::span::SourceFile) -> HashMap<String, (String, Span)> {
    let mut signatures = HashMap::new();
    let text = &file.text;
    for (at, _) in text.match_indices("fn ") {
        let line = text[..at].rsplit('\n').next().unwrap_or("");
        let Some(end) = text[at..].find('{').filter(|_| line.trim().is_empty()) else {
            continue;
        };
        let head = &text[at + 3..at + end];
        let Some((name, rest)) = head.split_once('(') else {
            continue;
        };
        let rest: String = rest.split_whitespace().collect();
        let rest = rest.replace(",)", ")");
        let span = file.span(at..at + end);
        signatures.insert(name.trim().to_owned(), (rest, span));
    }
    signatures
}
