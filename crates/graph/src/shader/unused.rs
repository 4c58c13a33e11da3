//! Finds the imports, params and globals of a shader that it does not use.

use super::expand::{Expanded, ImportLine};
use super::reflect::Shader;
use super::text::{DECLARES, identifiers};
use super::wgsl_errors::functions;
use crate::source::{Located, SourceFile};
use naga::Expression;
use std::collections::{BTreeMap, BTreeSet};

/// An import, param or global of a shader that is not used.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Unused {
    /// Kind of the unused thing in words, for messages.
    pub what: &'static str,
    /// Name of the unused thing, with its place.
    pub name: Located<String>,
}

/// The words of a file.
#[derive(Default)]
struct Words<'t> {
    mentioned: BTreeSet<&'t str>,
    /// Declared at module scope.
    declared: BTreeSet<&'t str>,
    has_entry_point: bool,
}

impl<'t> Words<'t> {
    fn new(text: &'t str) -> Self {
        let mut words = Self::default();
        for (word, before, is_outside) in identifiers(text) {
            if before == "@" && matches!(word, "compute" | "vertex" | "fragment") {
                words.has_entry_point = true;
            } else if is_outside && DECLARES.contains(&before) {
                words.declared.insert(word);
            } else {
                words.mentioned.insert(word);
            }
        }
        words
    }
}

/// Finds unused items of shaders; each file is split into words once.
#[derive(Default)]
pub(crate) struct UnusedFinder<'s> {
    words: BTreeMap<&'s str, Words<'s>>,
}

impl<'s> UnusedFinder<'s> {
    /// Returns the unused items of a shader: imports of all its files, and params and globals of
    /// its own file. `constants` holds the shader constants that the document uses.
    pub fn find(&mut self, shader: &'s Shader, constants: &BTreeSet<&str>) -> Vec<Unused> {
        let mut unused = self.imports(&shader.source, constants);
        unused.extend(unused_params(shader));
        unused.extend(unused_globals(shader));
        unused
    }

    /// Imports from which no file takes a name, and to which none gives one.
    fn imports(&mut self, source: &'s Expanded, constants: &BTreeSet<&str>) -> Vec<Unused> {
        let imported = source.imports.iter().map(|line| &line.file);
        let files = std::iter::once(&source.file).chain(imported);
        let files: BTreeMap<&str, &SourceFile> = files.map(|file| (&*file.name, file)).collect();
        for (name, file) in &files {
            let words = self.words.entry(name);
            words.or_insert_with(|| Words::new(&file.text));
        }
        let words = &self.words;
        let is_used = |line: &ImportLine| {
            let imported = reached(source, &line.file.name);
            let from = &*line.asked.span.file.name;
            let mut own = imported.iter().filter_map(|file| words.get(file));
            if line.replaces || own.clone().any(|own| own.has_entry_point) {
                return true;
            }
            let declared: BTreeSet<&str> =
                own.clone().flat_map(|own| own.declared.clone()).collect();
            // A module may ask for a function of the file that imports it.
            let gives = &words[from].declared;
            if own.any(|own| !own.mentioned.is_disjoint(gives)) || !constants.is_disjoint(&declared)
            {
                return true;
            }
            // Or another one takes what this file imports for it.
            let mut takers = files
                .keys()
                .filter(|file| **file == from || !reached(source, file).contains(&*line.file.name));
            takers.any(|file| !words[file].mentioned.is_disjoint(&declared))
        };
        let unused = source.imports.iter().filter(|line| !is_used(line));
        unused
            .map(|line| Unused {
                what: "import",
                name: line.asked.clone(),
            })
            .collect()
    }
}

/// Members of the uniform `params` that no function reads.
fn unused_params(shader: &Shader) -> Vec<Unused> {
    let module = shader.module();
    let Some((params, members)) = shader.uniform_params() else {
        return Vec::new();
    };
    let mut read = vec![false; members.len()];
    for function in functions(module) {
        for (handle, expression) in function.expressions.iter() {
            if !matches!(expression, Expression::GlobalVariable(global) if *global == params) {
                continue;
            }
            let mut indices = 0;
            for (_, user) in function.expressions.iter() {
                match user {
                    Expression::AccessIndex { base, index } if *base == handle => {
                        read[*index as usize] = true;
                        indices += 1;
                    }
                    Expression::Load { pointer } if *pointer == handle => read.fill(true),
                    _ => {}
                }
            }
            // Handed on whole.
            if indices == 0 {
                read.fill(true);
            }
        }
    }
    let names = members.iter().zip(read).filter(|(_, read)| !read);
    let names = names.filter_map(|(member, _)| member.name.as_deref());
    let names = names.filter_map(|name| own(shader, name, "param"));
    names.collect()
}

/// Globals that no entry point uses.
fn unused_globals(shader: &Shader) -> Vec<Unused> {
    let module = shader.module();
    let entries: Vec<usize> = (0..module.entry_points.len()).collect();
    let is_used = |handle| entries.iter().any(|entry| shader.uses(*entry, handle));
    let globals = module.global_variables.iter();
    let unused = globals.filter(|(handle, global)| {
        global.binding.is_some() && global.name.as_deref() != Some("params") && !is_used(*handle)
    });
    let names = unused.filter_map(|(_, global)| global.name.as_deref());
    let names = names.filter_map(|name| own(shader, name, "global"));
    names.collect()
}

/// A name that the shader's own file declares.
fn own(shader: &Shader, name: &str, what: &'static str) -> Option<Unused> {
    let text = &shader.source.text;
    let mut places = super::text::words(text, name);
    let at = places.find(|at| text[at + name.len()..].trim_start().starts_with(':'))?;
    let span = shader.source.locate(at..at + name.len());
    let name = Located::new(name.to_owned(), span);
    (name.span.file == shader.source.file).then_some(Unused { what, name })
}

/// The file and those that it imports, directly or not.
fn reached<'s>(source: &'s Expanded, file: &'s str) -> BTreeSet<&'s str> {
    let (mut files, mut open) = (BTreeSet::new(), vec![file]);
    while let Some(file) = open.pop() {
        if files.insert(file) {
            let imports = source.imports.iter();
            let lines = imports.filter(|line| *line.asked.span.file.name == *file);
            open.extend(lines.map(|line| &*line.file.name));
        }
    }
    files
}
