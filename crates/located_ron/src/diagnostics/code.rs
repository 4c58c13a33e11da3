//! Kinds of mistakes, each with a stable name.

macro_rules! codes {
    ($($(#[doc = $doc:literal])+ $name:ident = $text:literal, $remedy:literal;)+) => {
        /// Kind of mistake that a [`Diagnostic`](super::diagnostic::Diagnostic) is about, with a
        /// stable name for scripts. Most kinds are about graph documents, whose terms the crate
        /// `skiagraph_graph` explains.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[non_exhaustive]
        pub enum Code { $($(#[doc = $doc])+ $name,)+ }

        impl Code {
            /// All kinds of mistakes, in the order of their declaration, each once.
            pub const ALL: &[Self] = &[$(Self::$name),+];

            /// Returns the kind's kebab-case name, such as `missing-file`, as it is printed and
            /// written to machine-readable output.
            pub fn as_str(self) -> &'static str {
                match self { $(Code::$name => $text,)+ }
            }

            /// Returns a sentence that describes this kind of mistake.
            pub fn description(self) -> &'static str {
                match self { $(Code::$name => concat!($($doc),+).trim_ascii(),)+ }
            }

            /// Returns a sentence that says how to mend this kind of mistake. The `help` of a
            /// diagnostic is more exact.
            pub fn remedy(self) -> &'static str {
                match self { $(Code::$name => $remedy,)+ }
            }
        }
    };
}

codes! {
    /// A document, shader or imported file is missing or unreadable.
    MissingFile = "missing-file",
        "Check the name and where it is looked for: beside the document, in `shaders/` or \
         `pipelines/`, among the built-in ones. Paths cannot lead out of these folders.";
    /// Documents that include or extend each other in a circle.
    IncludeCycle = "include-cycle",
        "Move what both need into a third document that includes neither.";
    /// The RON text is not well-formed, or a value has the wrong type.
    Syntax = "syntax",
        "Mend the RON at the place that is underlined: a comma, a bracket, a value of another \
         type.";
    /// A field that the document format does not know.
    UnknownField = "unknown-field",
        "Check the spelling; the help lists the fields that may stand there.";
    /// A field that must be given is missing.
    MissingField = "missing-field",
        "Add the field.";
    /// A pass kind, enum variant or format that is not known.
    UnknownVariant = "unknown-variant",
        "Check the spelling; the help lists the words that may stand there. A pass kind of a host \
         program must be registered.";
    /// The document's `format` is not one this version reads.
    FormatVersion = "format-version",
        "Write the document in format 3 (docs/authoring.md), or use a newer Skiagraph.";
    /// A name that breaks the rules for names, is a reserved word, or becomes the same WGSL
    /// identifier as another name.
    Name = "name",
        "Names begin with a small letter and go on with small letters, digits and single \
         underscores; some words of the language are taken.";
    /// An expression or reference that does not parse, has the wrong type, or has no value.
    Expression = "expression",
        "Mend the expression at the place that is underlined; docs/authoring.md has the grammar.";
    /// Two materials, passes, params or values of one name.
    DuplicateName = "duplicate-name",
        "Rename one of the two; an include can be given a `name`.";
    /// A name that no material, input or provided resource has in this document.
    UnknownResource = "unknown-resource",
        "Check the spelling, declare the material, or `bind` the shader's global to the one that \
         is meant.";
    /// A param that the document does not declare.
    UnknownParam = "unknown-param",
        "Check the spelling, or declare the param.";
    /// A param's value has the wrong type or is out of range.
    ParamValue = "param-value",
        "Give a value of the param's type between its `min` and `max`.";
    /// An input that is missing, of another kind or format, or written without being an output.
    Input = "input",
        "Give the included document what it asks for, by name or by `bind`; the host imports what \
         the root document asks for.";
    /// An edit of an extended document that names an entry which that document lacks, or that the
    /// entry does not allow.
    Edit = "edit",
        "Name an entry of the extended document; `skiagraph show FILE --flat` prints what it has.";
    /// With one value of a param that an `if` depends on, the graph has a fault that it does not
    /// have with another.
    Condition = "condition",
        "Give the pass that reads and the pass that writes conditions that agree.";
    /// A word of a `Choice` and a constant of the shader that do not agree.
    ChoiceConstant = "choice-constant",
        "Leave the constant out of the shader: the document's words bring it.";
    /// A mip or layer of a texture, or an item of a buffer, that does not exist.
    Range = "range",
        "Name a part that there is; parts are counted from 0.";
    /// An item of a buffer that cannot be bound by itself.
    Alignment = "alignment",
        "Let items be a multiple of the device's offset alignment apart: 256 bytes always are.";
    /// A size or count that is zero, absurd, or above the adapter's limits.
    Size = "size",
        "Give a size or count of one at least that the adapter can hold; shards of a large buffer \
         are materials of their own.";
    /// A resource that is not of the kind needed here (a buffer where a texture must stand, …).
    ResourceKind = "resource-kind",
        "Name a material of the kind that is needed, or change what the shader declares.";
    /// A texture's format does not fit the shader, the attachment or the copy.
    FormatMismatch = "format-mismatch",
        "Change the material's format or the shader's type; `skiagraph doctor` lists what the \
         adapter can do.";
    /// Two shaders see one buffer with different item layouts, or a layout does not fit the buffer.
    LayoutMismatch = "layout-mismatch",
        "Declare the item's type once, in a module that both shaders import.";
    /// The WGSL does not parse or validate.
    Shader = "shader",
        "Mend the WGSL at the place that is underlined.";
    /// A library panicked on the file. The mistake is the library's; the same content written
    /// differently may work.
    LibraryPanic = "library-panic",
        "Write it differently at the place that is underlined, and tell the library's authors.";
    /// A shader without the entry point that the pass needs.
    EntryPoint = "entry-point",
        "Give the shader one entry point of the stage, or name one of several in the pass.";
    /// Stages of a draw that do not fit together.
    StageInterface = "stage-interface",
        "Let the vertex shader write what the fragment shader reads: the same location, type and \
         interpolation.";
    /// A shader's binding cannot be satisfied (unsupported type, clashing numbers).
    Binding = "binding",
        "Leave `@group` and `@binding` out: the graph numbers globals. Bind what shaders have, to \
         materials that there are.";
    /// A material is read before any pass has written it.
    ReadBeforeWrite = "read-before-write",
        "Move the writer above the reader, clear the material first, or read `….previous` if \
         last frame's content is meant.";
    /// Passes that read each other's results in a circle.
    Cycle = "cycle",
        "Write a second material, read `….previous`, or move the read into a pass below.";
    /// A pass samples a texture that it draws to.
    FeedbackLoop = "feedback-loop",
        "Read a copy, another mip or layer, or `….previous`.";
    /// Passes that must run or be skipped together have different run conditions.
    RunCondition = "run-condition",
        "Give the passes the same `run`, or one of them another material.";
    /// An import of the host lacks a usage that a pass needs.
    Import = "import",
        "Make the texture or buffer with the usages that the help names.";
    /// The graph needs more than a limit of the adapter allows.
    Limit = "limit",
        "Use less: fewer or smaller targets, bindings, workgroups; or run on an adapter that has \
         more.";
    /// Materials that take more memory together than the graph may have.
    Memory = "memory",
        "Use a smaller viewport, smaller textures, fewer layers, a format with fewer bytes; or \
         allow more memory where there is more.";
    /// A feature that the document requires and the device does not have, or that wgpu does not
    /// know.
    Feature = "feature",
        "Run on an adapter that has the feature, or ask `has(FEATURE)` in an `if`.";
    /// A named value whose expression needs the value itself.
    Value = "value",
        "Let one of the values of the ring be made of params or sizes alone.";
    /// An include that runs twice, because a pass in between writes a material that it reads.
    TwoCopies = "two-copies",
        "Put the include above the pass that writes in between, or give it a name.";
    /// A light of a kind that the document does not take.
    Light = "light",
        "Run it under a light of a kind that it takes; if its passes know others, say so in \
         `lights`.";
    /// A condition in `needs` that the viewport, the scene or its lights do not meet.
    Need = "need",
        "Plan for a viewport, a scene and lights that meet it: `--size`, `--scene`, `--light`.";
    /// A material, param or pass that nothing uses, a `bind` or `set` that neither the shader nor
    /// the included document asks for, or an output of a shader without a target.
    Unused = "unused",
        "Check the spelling, or take it out.";
    /// A document without outputs, or an output asked for that is not declared.
    Output = "output",
        "Declare the output, or name one that there is.";
}
