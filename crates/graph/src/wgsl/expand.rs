//! `#import "path"`: a textual, once-only line, with a map from the expanded text back to the files.
//!
//! Names stay as written, so that errors, captures and bindings speak the author's language.

use crate::{
    diagnostics::{Code, Diagnostic, suggestion},
    source::{self, SourceFile, Sources, Span, escapes, import_candidates, shader_candidates},
};
use std::{collections::HashMap, fmt::Write as _, ops::Range, sync::Arc};

/// Deepest chain of imports; far above any sensible house, far below the stack.
const DEEPEST_IMPORT: usize = 64;

/// WGSL's line breaks besides `\n`: a comment ends at any of them.
const BREAKS: [char; 6] = ['\r', '\u{b}', '\u{c}', '\u{85}', '\u{2028}', '\u{2029}'];

/// A shader with its imports in place.
#[derive(Clone, Debug)]
pub(crate) struct Expanded {
    pub text: String,
    /// The shader's own file.
    pub file: SourceFile,
    /// Consecutive pieces of `text`: where each begins, and the file and offset it came from.
    pieces: Vec<(usize, SourceFile, usize)>,
}

impl Expanded {
    /// The place in the author's file of a place in the expanded text.
    pub fn locate(&self, range: Range<usize>) -> Span {
        let index = self
            .pieces
            .partition_point(|(start, ..)| *start <= range.start)
            .saturating_sub(1);
        match self.pieces.get(index) {
            Some((start, file, offset)) => {
                let from = (offset + range.start - start).min(file.text.len());
                file.span(from..(from + range.len()).min(file.text.len()))
            }
            None => self.file.span(0..0),
        }
    }

    /// Whether a place in the expanded text belongs to an imported module.
    pub fn is_imported(&self, at: usize) -> bool {
        self.locate(at..at).file != self.file
    }
}

/// Reads shaders for a document and those that it includes, each file once.
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

    fn find(&mut self, candidates: &[String]) -> Result<Option<SourceFile>, String> {
        for path in candidates {
            if !self.read.contains_key(path) {
                let file =
                    source::read(self.sources, path).map_err(|why| format!("{path}: {why}"))?;
                self.read.insert(
                    path.clone(),
                    file.map(|text: Arc<str>| SourceFile::new(path.as_str(), text)),
                );
            }
            if let Some(Some(file)) = self.read.get(path) {
                return Ok(Some(file.clone()));
            }
        }
        Ok(None)
    }

    /// The shader `name` of a document in `folder` with its imports in place; `wanted` is where the document asks for it.
    pub fn expand(
        &mut self,
        folder: &str,
        name: &str,
        wanted: &Span,
    ) -> Result<Expanded, Diagnostic> {
        let candidates = shader_candidates(folder, name);
        let missing = |message: String| {
            Diagnostic::error(Code::MissingFile, message).at(wanted.clone(), "asked for here")
        };
        if escapes(name) {
            return Err(missing(format!("the shader `{name}` lies outside the shader folders"))
                .help("shaders stand beside the document or in shaders/, and are named without folder signs like `..`"));
        }
        let file = match self.find(&candidates) {
            Ok(Some(file)) => file,
            Ok(None) => {
                return Err(missing(format!("there is no shader `{name}.wgsl`"))
                    .help(self.searched(&candidates, name)));
            }
            Err(why) => {
                return Err(missing(format!("the shader `{name}.wgsl` cannot be read")).help(why));
            }
        };
        let mut expanded = Expanded {
            text: String::new(),
            file: file.clone(),
            pieces: Vec::new(),
        };
        self.append(&file, &mut expanded, &mut vec![file.name.to_string()], 0)?;
        Ok(expanded)
    }

    fn searched(&self, candidates: &[String], name: &str) -> String {
        let mut text = format!("looked for {}", candidates.join(", "));
        let known: Vec<String> = candidates
            .iter()
            .map(|path| path.rsplit_once('/').map_or("", |(folder, _)| folder))
            .flat_map(|folder| self.sources.list(folder))
            .filter_map(|file| file.strip_suffix(".wgsl").map(str::to_owned))
            .collect();
        if let Some(hint) = suggestion(name, known.iter().map(String::as_str))
            .filter(|hint| hint.starts_with("did"))
        {
            // Writing to a String cannot fail.
            let _ = write!(text, "; {hint}");
        }
        text
    }

    fn append(
        &mut self,
        file: &SourceFile,
        into: &mut Expanded,
        seen: &mut Vec<String>,
        depth: usize,
    ) -> Result<(), Diagnostic> {
        let mut at = 0;
        into.pieces.push((into.text.len(), file.clone(), 0));
        for line in file.text.split_inclusive('\n') {
            let start = at;
            at += line.len();
            let Some(rest) = line.trim_start().strip_prefix("#import") else {
                into.text.push_str(line);
                continue;
            };
            let range = start..start + line.trim_end().len();
            let quoted = rest.trim().strip_prefix('"');
            let path = quoted.and_then(|rest| {
                let (path, after) = rest.split_once('"')?;
                let after = after.trim();
                let ends = after.is_empty() || after.starts_with("//") && !after.contains(BREAKS);
                (ends && !path.is_empty()).then_some(path)
            });
            let Some(path) = path else {
                return Err(
                    Diagnostic::error(Code::Shader, "an import names a file in quotes")
                        .at(file.span(range), "")
                        .help(
                            "write #import \"shared/camera.wgsl\"; only a `//` comment may follow",
                        ),
                );
            };
            if escapes(path) {
                return Err(Diagnostic::error(
                    Code::Shader,
                    format!("the import `{path}` leaves the shader folder"),
                )
                .at(file.span(range), "")
                .help("imports name files in the importing file's folder or in shaders/"));
            }
            let candidates = import_candidates(&file.name, path);
            let imported = match self.find(&candidates) {
                Ok(Some(imported)) => imported,
                Ok(None) => {
                    return Err(Diagnostic::error(
                        Code::MissingFile,
                        format!("there is no file `{path}` to import"),
                    )
                    .at(file.span(range), "")
                    .help(format!("looked for {}", candidates.join(", "))));
                }
                Err(why) => {
                    return Err(Diagnostic::error(
                        Code::MissingFile,
                        format!("`{path}` cannot be read"),
                    )
                    .at(file.span(range), "")
                    .help(why));
                }
            };
            // Once only: this also ends cycles.
            if !seen.contains(&imported.name.to_string()) {
                if depth == DEEPEST_IMPORT {
                    return Err(
                        Diagnostic::error(Code::Shader, "imports are nested too deep")
                            .at(file.span(range), ""),
                    );
                }
                seen.push(imported.name.to_string());
                self.append(&imported, into, seen, depth + 1)?;
                if !into.text.ends_with('\n') {
                    into.text.push('\n');
                }
            }
            into.pieces.push((into.text.len(), file.clone(), at));
        }
        Ok(())
    }
}
