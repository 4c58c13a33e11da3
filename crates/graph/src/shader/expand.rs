//! Replaces each `#import "path"` line by the text of the module, once per module, and maps the
//! expanded text back to its files. `#import "path" instead "other"` also leaves out `other` where
//! it is imported later.
//!
//! Names stay as written, so that errors, captures and bindings use the author's names.

use super::text::{BREAKS, Comments, declares};
use crate::diagnostics::Diagnostic;
use crate::diagnostics::suggest::likeness;
use crate::errors::shader::ImportError;
use crate::source::paths::{
    escapes, folder_of, import_candidates, module_candidates, shader_candidates,
};
use crate::source::{Located, SourceFile, Sources, Span, sources};
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;
use std::sync::Arc;

/// WGSL modules that replace others in imports: path of the replaced module, to path of the module
/// that is imported instead.
pub(crate) type Replaced = BTreeMap<String, String>;

/// Deepest chain of imports; far above any sensible house, far below the stack.
const DEEPEST_IMPORT: usize = 64;

/// Text of a shader with its imports in place.
#[derive(Clone, Debug, Default)]
pub(crate) struct Expanded {
    /// WGSL of the shader, with the modules that it imports in the place of the import lines.
    pub text: String,
    /// File of the shader itself, without its imports.
    pub file: SourceFile,
    /// Consecutive pieces of `text`: where each begins, and the file and offset it came from.
    pieces: Vec<(usize, SourceFile, usize)>,
    /// All `#import` lines of the shader and its modules, in the order in which they were read.
    pub imports: Vec<ImportLine>,
    /// Names of the constants that the document's `Choice` params have in its shaders.
    pub constants: Vec<String>,
}

/// An `#import` line of a shader, or of a module that it imports.
#[derive(Clone, Debug)]
pub(crate) struct ImportLine {
    /// Path as the line writes it, with the place of the line.
    pub asked: Located<String>,
    /// Path in the store of the module that the line names.
    pub path: Arc<str>,
    /// File that is imported: the module that the line names, or the module that replaces it.
    pub file: SourceFile,
    /// True for a line with `instead`, which also leaves out another module.
    pub replaces: bool,
}

impl Expanded {
    /// Begins the expansion of a file, without text.
    pub fn new(file: SourceFile) -> Self {
        Self {
            file,
            ..Self::default()
        }
    }

    /// Maps a byte range of the expanded text to its place in the file that it came from. A range
    /// that spans several files is taken to lie in the first.
    pub fn locate(&self, range: Range<usize>) -> Span {
        let pieces = &self.pieces;
        let behind = pieces.partition_point(|(start, ..)| *start <= range.start);
        match pieces.get(behind.saturating_sub(1)) {
            Some((start, file, offset)) => {
                let from = (offset + range.start - start).min(file.text.len());
                file.span(from..(from + range.len()).min(file.text.len()))
            }
            None => self.file.span(0..0),
        }
    }

    /// Maps a span of naga's in the expanded text to its place in the file that it came from; the
    /// start of the text if naga gives no span.
    pub fn place(&self, span: naga::Span) -> Span {
        self.locate(span.to_range().unwrap_or(0..0))
    }

    /// Appends generated text; mistakes in it are reported at `origin`.
    pub fn push(&mut self, text: &str, origin: &Span) {
        let (file, at) = (origin.file.clone(), origin.range.start);
        self.pieces.push((self.text.len(), file, at));
        self.text.push_str(text);
    }

    /// True if the byte offset `at` of the expanded text belongs to an imported module.
    pub fn is_imported(&self, at: usize) -> bool {
        self.locate(at..at).file != self.file
    }
}

/// Reads shaders and modules for a document and its includes, each file once.
pub(crate) struct ShaderFiles<'a> {
    sources: &'a dyn Sources,
    read: HashMap<String, Option<SourceFile>>,
}

impl<'a> ShaderFiles<'a> {
    pub fn new(sources: &'a dyn Sources) -> Self {
        Self {
            sources,
            read: HashMap::new(),
        }
    }

    pub fn find(&mut self, candidates: &[String]) -> Result<Option<SourceFile>, String> {
        for path in candidates {
            if !self.read.contains_key(path) {
                let file =
                    sources::read(self.sources, path).map_err(|why| format!("{path}: {why}"))?;
                let file = file.map(|text: Arc<str>| SourceFile::new(path.as_str(), text));
                self.read.insert(path.clone(), file);
            }
            if let Some(Some(file)) = self.read.get(path) {
                return Ok(Some(file.clone()));
            }
        }
        Ok(None)
    }

    /// Returns the shader that a document names, with its imports in place. The file is looked for
    /// beside the document in which the name is written. `replaced` holds modules to import in the
    /// place of others.
    pub fn expand(
        &mut self,
        name: &Located<String>,
        replaced: &Replaced,
    ) -> Result<Expanded, Diagnostic> {
        let candidates = shader_candidates(folder_of(&name.span.file.name), name);
        if escapes(name) {
            return Err(ImportError::Outside(name.clone()).into());
        }
        let (missing, unreadable) = (ImportError::NoShader, ImportError::Unreadable);
        let file = self.found(name, candidates, missing, unreadable)?;
        let mut expanded = Expanded::new(file.clone());
        let mut seen = vec![file.name.to_string()];
        self.append(&file, replaced, &mut expanded, &mut seen, 0)?;
        Ok(expanded)
    }

    /// Returns the path by which the shader `importer` can import a module that declares `name`;
    /// `None` if there is none, beside it or in the folders `shared`.
    pub fn declaring(&mut self, name: &str, importer: &str) -> Option<String> {
        for folder in ["shared/", ""] {
            for beside in import_candidates(importer, folder) {
                let beside = beside.trim_end_matches('/');
                for file in self.sources.list(beside) {
                    let path = format!("{beside}/{file}");
                    let path = path.trim_start_matches('/').to_owned();
                    if !file.ends_with(".wgsl") || path == importer {
                        continue;
                    }
                    let module = self.find(&[path]).ok().flatten();
                    if module.is_some_and(|module| declares(&module.text, name)) {
                        return Some(format!("{folder}{file}"));
                    }
                }
            }
        }
        None
    }

    /// Returns the file of a module that a document names in `imports`.
    pub fn module(&mut self, name: &Located<String>) -> Result<SourceFile, ImportError> {
        let candidates = module_candidates(folder_of(&name.span.file.name), name);
        self.imported(name, candidates)
    }

    fn imported(
        &mut self,
        path: &Located<String>,
        candidates: Vec<String>,
    ) -> Result<SourceFile, ImportError> {
        if escapes(path) {
            return Err(ImportError::Leaves(path.clone()));
        }
        let (missing, unreadable) = (ImportError::NoFile, ImportError::UnreadableFile);
        self.found(path, candidates, missing, unreadable)
    }

    /// The first of the candidates that is there, or one of two errors: none is, or one cannot be
    /// read.
    fn found(
        &mut self,
        name: &Located<String>,
        candidates: Vec<String>,
        missing: fn(Located<String>, Vec<String>, Option<String>) -> ImportError,
        unreadable: fn(Located<String>, String) -> ImportError,
    ) -> Result<SourceFile, ImportError> {
        let file = self.find(&candidates);
        let file = file.map_err(|why| unreadable(name.clone(), why))?;
        file.ok_or_else(|| {
            let likeness = self.likeness(&candidates, name);
            missing(name.clone(), candidates, likeness)
        })
    }

    fn likeness(&self, candidates: &[String], name: &str) -> Option<String> {
        let candidates = candidates.iter();
        let files = candidates.flat_map(|path| self.sources.list(folder_of(path)));
        // A document names shaders without the ending, an import names a file with its folder.
        let named = |file: String| {
            let stem = file.strip_suffix(".wgsl")?;
            Some(match name.rsplit_once('/') {
                Some((folder, _)) => format!("{folder}/{file}"),
                None if name.ends_with(".wgsl") => file,
                None => stem.to_owned(),
            })
        };
        likeness(name, files.filter_map(named))
    }

    fn append(
        &mut self,
        file: &SourceFile,
        modules: &Replaced,
        into: &mut Expanded,
        seen: &mut Vec<String>,
        depth: usize,
    ) -> Result<(), ImportError> {
        let mut at = 0;
        into.pieces.push((into.text.len(), file.clone(), 0));
        let mut comments = Comments::default();
        for line in file.text.split_inclusive('\n') {
            let start = at;
            at += line.len();
            let inside = comments.are_open();
            comments.read(line);
            let rest = line.trim_start().strip_prefix("#import");
            let Some(rest) = rest.filter(|_| !inside) else {
                into.text.push_str(line);
                continue;
            };
            let place = file.span(start..start + line.trim_end().len());
            let unquoted = || ImportError::Unquoted(place.clone());
            let (path, replaced) = paths(rest).ok_or_else(unquoted)?;
            let asked = Located::new(path.to_owned(), place.clone());
            let mut imported = self.import(file, &asked)?;
            let path_asked = Arc::clone(&imported.name);
            // A module that stands in for another may import it: then the import means the module
            // itself.
            let stands_in = modules.get(&*imported.name);
            if let Some(path) = stands_in.filter(|path| **path != *file.name)
                && let Ok(Some(file)) = self.find(std::slice::from_ref(path))
            {
                imported = file;
            }
            if let Some(replaced) = replaced {
                let replaced = Located::new(replaced.to_owned(), place.clone());
                let name = self.import(file, &replaced)?.name.to_string();
                // And what the document has imported in its place.
                let is_other = |path: &&String| **path != *imported.name;
                seen.extend(modules.get(&name).filter(is_other).cloned());
                seen.push(name);
            }
            into.imports.push(ImportLine {
                asked,
                path: path_asked,
                file: imported.clone(),
                replaces: replaced.is_some(),
            });
            // Once only: this also ends cycles.
            if !seen.contains(&imported.name.to_string()) {
                if depth == DEEPEST_IMPORT {
                    return Err(ImportError::TooDeep(place));
                }
                seen.push(imported.name.to_string());
                self.append(&imported, modules, into, seen, depth + 1)?;
                if !into.text.ends_with('\n') {
                    into.text.push('\n');
                }
            }
            into.pieces.push((into.text.len(), file.clone(), at));
        }
        Ok(())
    }

    fn import(
        &mut self,
        file: &SourceFile,
        path: &Located<String>,
    ) -> Result<SourceFile, ImportError> {
        self.imported(path, import_candidates(&file.name, path))
    }
}

/// The path in what follows `#import`, and the one behind `instead`; only a line comment may
/// follow.
fn paths(rest: &str) -> Option<(&str, Option<&str>)> {
    let (path, after) = quoted(rest)?;
    let (replaced, after) = match after.strip_prefix("instead") {
        Some(rest) => quoted(rest).map(|(path, after)| (Some(path), after))?,
        None => (None, after),
    };
    let ends = after.is_empty() || after.starts_with("//") && !after.contains(BREAKS);
    ends.then_some((path, replaced))
}

/// A path in quotes, and what follows it.
fn quoted(rest: &str) -> Option<(&str, &str)> {
    let (path, after) = rest.trim().strip_prefix('"')?.split_once('"')?;
    (!path.is_empty()).then_some((path, after.trim()))
}

#[cfg(test)]
mod tests {
    use super::paths;

    #[test]
    fn an_import_names_a_file_and_what_it_stands_in_for() {
        assert_eq!(paths(r#" "a.wgsl" "#), Some(("a.wgsl", None)));
        assert_eq!(paths(r#" "a" instead "b" // why"#), Some(("a", Some("b"))));
        for broken in [
            " a",
            r#" """#,
            r#" "a" instead"#,
            r#" "a" instead b"#,
            r#" "a" "b""#,
        ] {
            assert_eq!(paths(broken), None, "{broken}");
        }
    }
}
