//! What is wrong with a document or shader: collected, located, printed in source order.

use crate::source::Span;
use miette::{GraphicalReportHandler, GraphicalTheme, LabeledSpan, NamedSource};
use std::{fmt, ops::Range};

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The document cannot be used.
    Error,
    /// The document can be used, but something in it has no effect or is likely a mistake.
    Warning,
}

macro_rules! codes {
    ($($(#[doc = $doc:literal])+ $name:ident = $text:literal, $remedy:literal;)+) => {
        /// What kind of mistake a [`Diagnostic`] is about; stable names for scripts.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[non_exhaustive]
        pub enum Code { $($(#[doc = $doc])+ $name,)+ }

        impl Code {
            /// Every kind there is.
            pub const ALL: &[Self] = &[$(Self::$name),+];

            /// The kebab-case name that is printed and written to machine-readable output.
            pub fn as_str(self) -> &'static str {
                match self { $(Code::$name => $text,)+ }
            }

            /// What kind of mistake it is, in a sentence.
            pub fn description(self) -> &'static str {
                match self { $(Code::$name => concat!($($doc),+).trim_ascii(),)+ }
            }

            /// The usual way out, in a sentence; a diagnostic's own help is more exact.
            pub fn remedy(self) -> &'static str {
                match self { $(Code::$name => $remedy,)+ }
            }
        }
    };
}

codes! {
    /// A document, shader or imported file is missing or unreadable.
    MissingFile = "missing-file",
        "Check the name and where it is looked for: beside the document, in `shaders/` or `pipelines/`, among the built-in ones. Paths cannot lead out of these folders.";
    /// Documents that include each other.
    IncludeCycle = "include-cycle",
        "Move what both need into a third document that includes neither.";
    /// The RON text is not well-formed, or a value has the wrong type.
    Syntax = "syntax",
        "Mend the RON at the place that is underlined: a comma, a bracket, a value of another type.";
    /// A field that the document format does not know.
    UnknownField = "unknown-field",
        "Check the spelling; the help lists the fields that may stand there.";
    /// A field that must be given is missing.
    MissingField = "missing-field",
        "Add the field.";
    /// A pass kind, enum variant or format that is not known.
    UnknownVariant = "unknown-variant",
        "Check the spelling; the help lists the words that may stand there. A pass kind of a host program must be registered.";
    /// The document's `format` is not one this version reads.
    FormatVersion = "format-version",
        "Write `format: 1`, or use a newer Skiagraph.";
    /// Two things of one name.
    DuplicateName = "duplicate-name",
        "Rename one of the two; an include can get a `prefix`.";
    /// A name that no material, provided resource or view has.
    UnknownResource = "unknown-resource",
        "Check the spelling, declare the material, or `bind` the shader's global to the one that is meant.";
    /// A param that the document does not declare.
    UnknownParam = "unknown-param",
        "Check the spelling, or declare the param.";
    /// A param's value has the wrong type or is out of range.
    ParamValue = "param-value",
        "Give a value of the param's type between its `min` and `max`.";
    /// A size or count that is zero, absurd, or above the adapter's limits.
    Size = "size",
        "Give a size or count of one at least that the adapter can hold; shards of a large buffer are materials of their own.";
    /// A resource that is not of the kind needed here (a buffer where a texture must stand, …).
    ResourceKind = "resource-kind",
        "Name a material of the kind that is needed, or change what the shader declares.";
    /// A texture's format does not fit the shader, the attachment or the copy.
    FormatMismatch = "format-mismatch",
        "Change the material's format or the shader's type; `skiagraph doctor` lists what the adapter can do.";
    /// Two shaders see one buffer with different item layouts, or a layout does not fit the buffer.
    LayoutMismatch = "layout-mismatch",
        "Declare the item's type once, in a module that both shaders import.";
    /// The WGSL does not parse or validate.
    Shader = "shader",
        "Mend the WGSL at the place that is underlined.";
    /// A shader without the entry point that the pass needs.
    EntryPoint = "entry-point",
        "Give the shader one entry point of the stage, or name one of several in the pass.";
    /// A shader's binding cannot be satisfied (unsupported type, clashing numbers).
    Binding = "binding",
        "Leave `@group` and `@binding` out: the graph numbers globals. Bind what shaders have, to materials that there are.";
    /// A material is read before any pass has written it.
    ReadBeforeWrite = "read-before-write",
        "Move the writer above the reader, clear the material first, or read `Previous(\"…\")` if last frame's content is meant.";
    /// Passes that need each other's results.
    Cycle = "cycle",
        "Write a second material, read `Previous(\"…\")`, or move the read into a pass below.";
    /// A pass samples a texture that it draws to.
    FeedbackLoop = "feedback-loop",
        "Read a copy, another mip or layer, or `Previous(\"…\")`.";
    /// Passes that must run or be skipped together have different run conditions.
    RunCondition = "run-condition",
        "Give the passes the same `run`, or one of them another material.";
    /// What the host imports does not serve what passes do with it.
    Import = "import",
        "Make the texture or buffer with the usages that the help names.";
    /// A limit of the adapter.
    Limit = "limit",
        "Use less: fewer or smaller targets, bindings, workgroups; or run on an adapter that has more.";
    /// Materials that take more memory together than the graph may have.
    Memory = "memory",
        "Use a smaller viewport or shadow map, fewer layers, a format with fewer bytes; or allow more memory where there is more.";
    /// A feature that the document requires and the device does not have, or that wgpu does not know.
    Feature = "feature",
        "Run on an adapter that has the feature, or give `requires` a `fallback`.";
    /// A material that no pass uses.
    Unused = "unused",
        "Remove the material, or check the names of the shader globals that should be it.";
    /// A document without outputs, or an output asked for that is not declared.
    Output = "output",
        "Declare the output, or name one that there is.";
}

/// A place and what is to be said about it.
#[derive(Clone, Debug)]
pub struct Label {
    /// The place.
    pub span: Span,
    /// What is to be said; may be empty.
    pub text: String,
}

/// One mistake.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    /// Its kind.
    pub code: Code,
    /// Error or warning.
    pub severity: Severity,
    /// What is wrong, naming the thing.
    pub message: String,
    /// Where; the first label is the place itself, others explain.
    pub labels: Vec<Label>,
    /// What to do about it.
    pub help: Option<String>,
}

impl Diagnostic {
    /// An error without a place yet.
    pub fn error(code: Code, message: impl Into<String>) -> Self {
        Self {
            code,
            severity: Severity::Error,
            message: message.into(),
            labels: Vec::new(),
            help: None,
        }
    }

    /// A warning without a place yet.
    pub fn warning(code: Code, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Warning,
            ..Self::error(code, message)
        }
    }

    /// Adds a place; the first one added is the mistake's own.
    #[must_use]
    pub fn at(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push(Label {
            span,
            text: text.into(),
        });
        self
    }

    /// Says what to do.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help = Some(text.into());
        self
    }

    /// Adds "did you mean …" if one of `known` is close to `word`, else a list of what there is.
    #[must_use]
    pub fn suggest<'a>(self, word: &str, known: impl IntoIterator<Item = &'a str>) -> Self {
        match suggestion(word, known) {
            Some(text) => self.help(text),
            None => self,
        }
    }

    /// As [`Self::suggest`] for the first mistakes of many, by how many were `found` before: a document holds as many misspelt names
    /// as names, and to compare all with all takes minutes.
    #[must_use]
    pub(crate) fn suggest_to<'a, I: IntoIterator<Item = &'a str>>(
        self,
        found: usize,
        word: &str,
        known: impl FnOnce() -> I,
    ) -> Self {
        if found < HINTED {
            self.suggest(word, known())
        } else {
            self
        }
    }

    fn key(&self) -> (Severity, &str, usize) {
        let first = self.labels.first();
        (
            self.severity,
            first.map_or("", |label| &label.span.file.name),
            first.map_or(0, |label| label.span.range.start),
        )
    }
}

/// "did you mean …" for a misspelt `word`, or the list of what is known.
pub fn suggestion<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    /// Names that a misspelt one is compared with: a document may hold thousands, and as many mistakes.
    const COMPARED: usize = 1024;
    /// Bytes of a name that can be compared, which takes time by the square, and that is worth a place in a list.
    const LONGEST: usize = 80;
    /// Names in a list.
    const SHOWN: usize = 16;
    let known: Vec<&str> = known.into_iter().collect();
    let count = known.len();
    let known: Vec<&str> = known
        .into_iter()
        .filter(|name| name.len() <= LONGEST)
        .collect();
    if word.len() <= LONGEST {
        let best = known
            .iter()
            .take(COMPARED)
            .map(|name| (strsim::jaro_winkler(word, name), *name))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        // Below 0.8 two short names share little more than a letter or two; a list helps more than a wild guess.
        if let Some((_, name)) = best.filter(|(likeness, _)| *likeness >= 0.8) {
            return Some(format!("did you mean `{name}`?"));
        }
    }
    if known.is_empty() {
        return None;
    }
    let rest = count - known.len().min(SHOWN);
    let mut list = known
        .iter()
        .take(SHOWN)
        .map(|name| format!("`{name}`"))
        .collect::<Vec<_>>()
        .join(", ");
    if rest > 0 {
        list.push_str(&format!(" and {rest} more"));
    }
    Some(format!("known here: {list}"))
}

/// More diagnostics than anybody reads; each is printed with a piece of its file.
const MOST_SHOWN: usize = 200;

/// Mistakes for which a document's names are searched.
pub(crate) const HINTED: usize = 50;

/// Longest line of which a piece is printed, in bytes: there is no pointing at a word in one that fills a screen, and miette
/// cannot count beyond 65,535 columns.
const LONGEST_LINE: usize = 2000;

/// A non-empty list of diagnostics, errors first, in source order.
#[derive(Clone, Debug)]
pub struct Diagnostics(Vec<Diagnostic>);

impl Diagnostics {
    pub(crate) fn new(mut list: Vec<Diagnostic>) -> Self {
        list.sort_by(|a, b| a.key().cmp(&b.key()));
        list.dedup_by(|a, b| a.message == b.message && a.key() == b.key());
        if let Some(first) = list.get(MOST_SHOWN) {
            let rest = list.len() - MOST_SHOWN;
            let mut more = Diagnostic::error(first.code, format!("and {rest} mistakes more"));
            let place = first.labels.first();
            more.labels.extend(place.map(|label| Label {
                span: label.span.clone(),
                text: "the next one".to_owned(),
            }));
            list.truncate(MOST_SHOWN);
            list.push(more.help("mend those above first: what is left may follow from them"));
        }
        Self(list)
    }

    /// The diagnostics, in the order in which they are printed.
    pub fn iter(&self) -> std::slice::Iter<'_, Diagnostic> {
        self.0.iter()
    }

    /// All of them rendered: file, line, the word underlined, help.
    pub fn render(&self, colour: bool) -> String {
        render(&self.0, colour)
    }
}

impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(false))
    }
}

impl std::error::Error for Diagnostics {}

impl From<Diagnostic> for Diagnostics {
    fn from(diagnostic: Diagnostic) -> Self {
        Self(vec![diagnostic])
    }
}

/// Renders a list of diagnostics, one after the other.
pub fn render(list: &[Diagnostic], colour: bool) -> String {
    let theme = if colour {
        GraphicalTheme::unicode()
    } else {
        GraphicalTheme::unicode_nocolor()
    };
    let handler = GraphicalReportHandler::new_themed(theme)
        .with_width(110)
        .with_links(false);
    let mut text = String::new();
    for diagnostic in list {
        // Rendering into a String fails only if a Display implementation does; then the bare message must do.
        if handler
            .render_report(&mut text, &Report::new(diagnostic))
            .is_err()
        {
            text.push_str(&diagnostic.message);
        }
        text.push('\n');
    }
    text
}

/// One diagnostic as miette sees it: labels of the first file on the report itself, those of other files as related notes.
#[derive(Debug)]
struct Report<'a> {
    diagnostic: &'a Diagnostic,
    message: String,
    source: Option<NamedSource<String>>,
    labels: Vec<LabeledSpan>,
    related: Vec<Report<'a>>,
    /// Says only where else to look: code and help stand in the main report.
    is_note: bool,
}

impl<'a> Report<'a> {
    fn new(diagnostic: &'a Diagnostic) -> Self {
        let first = diagnostic
            .labels
            .first()
            .map(|label| label.span.file.clone());
        let mut report = Self::of_file(diagnostic, diagnostic.message.clone(), first.as_ref());
        let mut files: Vec<_> = diagnostic
            .labels
            .iter()
            .map(|label| label.span.file.clone())
            .collect();
        files.sort_by(|a, b| a.name.cmp(&b.name));
        files.dedup();
        for file in files
            .into_iter()
            .filter(|file| Some(file) != first.as_ref())
        {
            let note = Self::of_file(diagnostic, format!("and in {}", file.name), Some(&file));
            report.related.push(Self {
                is_note: true,
                ..note
            });
        }
        report
    }

    fn of_file(
        diagnostic: &'a Diagnostic,
        mut message: String,
        file: Option<&crate::source::SourceFile>,
    ) -> Self {
        let labels = diagnostic.labels.iter();
        let mut labels: Vec<&Label> = labels
            .filter(|label| Some(&label.span.file) == file)
            .collect();
        let mut file = file;
        if labels.iter().any(|label| is_too_wide(&label.span)) {
            // The places in words.
            for label in std::mem::take(&mut labels) {
                message.push_str(&format!("\n{}: {}", label.span, label.text));
            }
            file = None;
        }
        let labels = labels
            .into_iter()
            .map(|label| {
                let text = (!label.text.is_empty()).then(|| label.text.clone());
                let range = clamp(&label.span);
                LabeledSpan::new(text, range.start, range.len())
            })
            .collect();
        let source = file.map(|file| NamedSource::new(&*file.name, file.text.to_string()));
        Self {
            diagnostic,
            message,
            source,
            labels,
            related: Vec::new(),
            is_note: false,
        }
    }
}

/// A span that miette can show: inside the text, on character borders.
fn clamp(span: &Span) -> Range<usize> {
    let text = &span.file.text;
    let border = |mut at: usize| {
        at = at.min(text.len());
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        at
    };
    let start = border(span.range.start);
    start..border(span.range.end).max(start)
}

/// Whether miette would have to print a line that is too long, or too many of them. It shows a line before and after a label.
fn is_too_wide(span: &Span) -> bool {
    let text = &span.file.text;
    let Range { start, end } = clamp(span);
    let before = text[..start].rsplit('\n').take(2).map(str::len).max();
    let after = text[end..].split('\n').take(2).map(str::len).max();
    let within = end - start;
    [before, Some(within), after]
        .into_iter()
        .flatten()
        .any(|length| length > LONGEST_LINE)
}

impl fmt::Display for Report<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Report<'_> {}

impl miette::Diagnostic for Report<'_> {
    fn code<'b>(&'b self) -> Option<Box<dyn fmt::Display + 'b>> {
        (!self.is_note).then(|| Box::new(self.diagnostic.code.as_str()) as Box<dyn fmt::Display>)
    }

    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.diagnostic.severity {
            _ if self.is_note => miette::Severity::Advice,
            Severity::Error => miette::Severity::Error,
            Severity::Warning => miette::Severity::Warning,
        })
    }

    fn help<'b>(&'b self) -> Option<Box<dyn fmt::Display + 'b>> {
        self.diagnostic
            .help
            .as_ref()
            .filter(|_| !self.is_note)
            .map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        self.source
            .as_ref()
            .map(|source| source as &dyn miette::SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(self.labels.iter().cloned()))
    }

    fn related<'b>(&'b self) -> Option<Box<dyn Iterator<Item = &'b dyn miette::Diagnostic> + 'b>> {
        Some(Box::new(
            self.related
                .iter()
                .map(|report| report as &dyn miette::Diagnostic),
        ))
    }
}
