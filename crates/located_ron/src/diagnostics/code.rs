//! Kinds of mistakes, each with a stable name.

macro_rules! codes {
    ($($(#[doc = $doc:literal])+ $name:ident = $text:literal;)+) => {
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
        }
    };
}

codes! {
    /// A document, shader or imported file is missing or unreadable.
    MissingFile = "missing-file";
    /// Documents that include or extend each other in a circle.
    IncludeCycle = "include-cycle";
    /// The RON text is not well-formed, or a value has the wrong type.
    Syntax = "syntax";
    /// A field that the document format does not know.
    UnknownField = "unknown-field";
    /// A field that must be given is missing.
    MissingField = "missing-field";
    /// A pass kind, enum variant or format that is not known.
    UnknownVariant = "unknown-variant";
    /// The document's `format` is not one this version reads.
    FormatVersion = "format-version";
    /// A name that breaks the rules for names, is a reserved word, or becomes the same WGSL
    /// identifier as another name.
    Name = "name";
    /// An expression or reference that does not parse, has the wrong type, or has no value.
    Expression = "expression";
    /// Two materials, passes, params or values of one name.
    DuplicateName = "duplicate-name";
    /// A name that no material, input or provided resource has in this document.
    UnknownResource = "unknown-resource";
    /// A param that the document does not declare.
    UnknownParam = "unknown-param";
    /// A param's value has the wrong type or is out of range.
    ParamValue = "param-value";
    /// An input that is missing, of another kind or format, or written without being an output.
    Input = "input";
    /// An edit of an extended document that names an entry which that document lacks, or that the
    /// entry does not allow.
    Edit = "edit";
    /// With one value of a param that an `if` depends on, the graph has a fault that it does not
    /// have with another.
    Condition = "condition";
    /// A word of a `Choice` and a constant of the shader that do not agree.
    ChoiceConstant = "choice-constant";
    /// A mip or layer of a texture, or an item of a buffer, that does not exist.
    Range = "range";
    /// An item of a buffer that cannot be bound by itself.
    Alignment = "alignment";
    /// A size or count that is zero, absurd, or above the adapter's limits.
    Size = "size";
    /// A resource that is not of the kind needed here (a buffer where a texture must stand, …).
    ResourceKind = "resource-kind";
    /// A texture's format does not fit the shader, the attachment or the copy.
    FormatMismatch = "format-mismatch";
    /// Two shaders see one buffer with different item layouts, or a layout does not fit the buffer.
    LayoutMismatch = "layout-mismatch";
    /// The WGSL does not parse or validate.
    Shader = "shader";
    /// A library panicked on the file. The mistake is the library's; the same content written
    /// differently may work.
    LibraryPanic = "library-panic";
    /// A shader without the entry point that the pass needs.
    EntryPoint = "entry-point";
    /// Stages of a draw that do not fit together.
    StageInterface = "stage-interface";
    /// A shader's binding cannot be satisfied (unsupported type, clashing numbers).
    Binding = "binding";
    /// A material is read before any pass has written it.
    ReadBeforeWrite = "read-before-write";
    /// Passes that read each other's results in a circle.
    Cycle = "cycle";
    /// A pass samples a texture that it draws to.
    FeedbackLoop = "feedback-loop";
    /// Passes that must run or be skipped together have different run conditions.
    RunCondition = "run-condition";
    /// An import of the host lacks a usage that a pass needs.
    Import = "import";
    /// The graph needs more than a limit of the adapter allows.
    Limit = "limit";
    /// Materials that take more memory together than the graph may have.
    Memory = "memory";
    /// A feature that the document requires and the device does not have, or that wgpu does not
    /// know.
    Feature = "feature";
    /// A named value whose expression needs the value itself.
    Value = "value";
    /// An include that runs twice, because a pass in between writes a material that it reads.
    TwoCopies = "two-copies";
    /// A light of a kind that the document does not take.
    Light = "light";
    /// A condition in `needs` that the viewport, the scene or its lights do not meet.
    Need = "need";
    /// A material, param or pass that nothing uses, a `bind` or `set` that neither the shader nor
    /// the included document asks for, or an output of a shader without a target.
    Unused = "unused";
    /// A document without outputs, or an output asked for that is not declared.
    Output = "output";
}
