//! Phase 1, second half: the documents that a document includes are read, each once.

use crate::{
    diagnostics::{Code, Diagnostic, suggestion},
    document::{self, Document, Entry, IncludeEntry, located::Located},
    registry::Registry,
    source::{self, SourceFile, Sources, Span, escapes, folder_of, include_candidates},
};
use std::{collections::HashMap, sync::Arc};

/// Deepest chain of includes; far above any sensible house, far below the stack.
const DEEPEST_INCLUDE: usize = 64;

/// Reads included documents.
pub(crate) struct Includes<'a> {
    registry: &'a Registry,
    sources: &'a dyn Sources,
    /// By path; `None` where something prevents its use, which was reported.
    read: HashMap<String, Option<Arc<Document>>>,
    /// The documents that are being read, outermost first, with the include that asks for each.
    open: Vec<(String, Option<Span>)>,
    /// The place of every include, with the path of what it includes.
    pub places: Vec<(String, Span)>,
}

impl<'a> Includes<'a> {
    /// For the document at `path`, which is read already.
    pub fn new(path: &str, registry: &'a Registry, sources: &'a dyn Sources) -> Self {
        Self {
            registry,
            sources,
            read: HashMap::new(),
            open: vec![(path.to_owned(), None)],
            places: Vec::new(),
        }
    }

    /// The features that the documents read so far require.
    pub fn features(&self) -> wgpu::Features {
        let read = self.read.values().flatten();
        read.fold(wgpu::Features::empty(), |all, document| {
            all | document.features()
        })
    }

    /// Reads what the entries of the innermost open document include. Returns the depth of includes below it.
    pub fn attach(&mut self, entries: &mut [Entry], diagnostics: &mut Vec<Diagnostic>) -> usize {
        let mut depth = 0;
        for entry in entries {
            let below = match entry {
                Entry::Include(include) => {
                    include.document = self.include(include, diagnostics);
                    let document = include.document.as_ref();
                    document.map_or(1, |document| document.include_depth + 1)
                }
                Entry::Group(group) => self.attach(&mut group.entries, diagnostics),
                Entry::Pass(_) | Entry::Broken | Entry::BrokenInclude => 0,
            };
            depth = depth.max(below);
        }
        depth
    }

    fn include(
        &mut self,
        include: &IncludeEntry,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Option<Arc<Document>> {
        let file = match self.find(&include.graph) {
            Ok(file) => file,
            Err(error) => {
                diagnostics.push(error);
                return None;
            }
        };
        let path = file.name.to_string();
        if let Some(first) = self.open.iter().position(|(open, _)| *open == path) {
            diagnostics.push(self.cycle(first, &include.graph));
            return None;
        }
        self.places.push((path.clone(), include.graph.span.clone()));
        if !self.read.contains_key(&path) {
            let document = self.document(file, &include.graph, diagnostics);
            self.read.insert(path.clone(), document);
        }
        let document = self.read.get(&path).cloned().flatten()?;
        if self.open.len() + document.include_depth > DEEPEST_INCLUDE {
            diagnostics.push(too_deep(&include.graph));
            return None;
        }
        Some(document)
    }

    fn document(
        &mut self,
        file: SourceFile,
        graph: &Located<String>,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Option<Arc<Document>> {
        if self.open.len() > DEEPEST_INCLUDE {
            diagnostics.push(too_deep(graph));
            return None;
        }
        let path = file.name.to_string();
        let mut document = document::parse(file, self.registry, diagnostics)?;
        self.open.push((path, Some(graph.span.clone())));
        document.include_depth = self.attach(&mut document.entries, diagnostics);
        self.open.pop();
        // Without its params nothing of the document has a size.
        (!document.broken.params).then(|| Arc::new(document))
    }

    fn find(&self, graph: &Located<String>) -> Result<SourceFile, Diagnostic> {
        let missing = |message: String| {
            Diagnostic::error(Code::MissingFile, message).at(graph.span.clone(), "included here")
        };
        if escapes(graph) {
            return Err(missing(format!(
                "the document `{}` lies outside the folders of documents",
                **graph
            ))
            .help("included documents stand beside the including one, in a folder below it, or in pipelines/, and are named without folder signs like `..`"));
        }
        let includer = self.open.last().map_or("", |(path, _)| path);
        let candidates = include_candidates(includer, graph);
        for path in &candidates {
            match source::read(self.sources, path) {
                Ok(Some(text)) => return Ok(SourceFile::new(path.as_str(), text)),
                Ok(None) => {}
                Err(why) => {
                    let error = missing(format!("the document `{path}` cannot be read"));
                    return Err(error.help(why));
                }
            }
        }
        let mut help = format!("looked for {}", candidates.join(", "));
        let below = folder_of(graph);
        let known: Vec<String> = candidates
            .iter()
            .flat_map(|path| self.sources.list(folder_of(path)))
            .filter(|name| name.ends_with(".ron"))
            .map(|name| match below {
                "" => name,
                _ => format!("{below}/{name}"),
            })
            .collect();
        if let Some(hint) = suggestion(graph, known.iter().map(String::as_str))
            .filter(|hint| hint.starts_with("did"))
        {
            help.push_str("; ");
            help.push_str(&hint);
        }
        Err(missing(format!("there is no document `{}`", **graph)).help(help))
    }

    /// The open document number `first` is included again.
    fn cycle(&self, first: usize, graph: &Located<String>) -> Diagnostic {
        let open = &self.open[first..];
        let again = open.first().map_or("", |(path, _)| path);
        let mut error = Diagnostic::error(
            Code::IncludeCycle,
            format!("the document `{again}` includes itself"),
        )
        .at(graph.span.clone(), "includes it again");
        for (path, place) in open.iter().skip(1) {
            if let Some(place) = place {
                error = error.at(place.clone(), format!("includes `{path}`"));
            }
        }
        let path: Vec<&str> = open.iter().map(|(path, _)| path.as_str()).collect();
        error.help(format!(
            "the cycle is {} → {again}: take one of these includes out",
            path.join(" → ")
        ))
    }
}

fn too_deep(graph: &Located<String>) -> Diagnostic {
    Diagnostic::error(
        Code::Size,
        format!("documents are included more than {DEEPEST_INCLUDE} deep"),
    )
    .at(graph.span.clone(), "")
    .help("include them from fewer levels")
}

/// Says for mistakes in included documents where these are included.
pub(crate) fn label(diagnostics: &mut [Diagnostic], root: &str, places: &[(String, Span)]) {
    /// More includes of one document say nothing new.
    const SHOWN: usize = 4;
    for diagnostic in diagnostics {
        // The mistake is the including document's own, and what it includes is only named.
        let own = diagnostic.labels.first().map(|label| &label.span.file.name);
        if own.is_none_or(|own| **own == *root) {
            continue;
        }
        let mut at = 0;
        // A document may be included by one that is included itself.
        while let Some(label) = diagnostic.labels.get(at) {
            let file = label.span.file.name.clone();
            let including: Vec<Span> = places
                .iter()
                .filter(|(path, _)| **path == *file)
                .map(|(_, place)| place.clone())
                .take(SHOWN)
                .collect();
            for place in including {
                if diagnostic.labels.iter().all(|label| label.span != place) {
                    diagnostic.labels.push(crate::diagnostics::Label {
                        span: place,
                        text: "included here".to_owned(),
                    });
                }
            }
            at += 1;
        }
    }
}
