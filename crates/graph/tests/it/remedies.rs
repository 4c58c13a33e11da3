//! How each kind of mistake is mended, as docs/diagnostics.md says it. The `help` of a diagnostic
//! is more exact.

use skiagraph_graph::Code;

pub const REMEDIES: &[(Code, &str)] = &[
    (
        Code::MissingFile,
        "Check the name and where it is looked for: beside the document, in `shaders/` or \
         `pipelines/`, among the built-in ones. Paths cannot lead out of these folders.",
    ),
    (
        Code::IncludeCycle,
        "Move what both need into a third document that includes neither.",
    ),
    (
        Code::Syntax,
        "Mend the RON at the place that is underlined: a comma, a bracket, a value of another \
         type.",
    ),
    (
        Code::UnknownField,
        "Check the spelling; the help lists the fields that may stand there.",
    ),
    (Code::MissingField, "Add the field."),
    (
        Code::UnknownVariant,
        "Check the spelling; the help lists the words that may stand there. A pass kind of a host \
         program must be registered.",
    ),
    (
        Code::FormatVersion,
        "Write the document in format 3 (docs/authoring.md), or use a newer Skiagraph.",
    ),
    (
        Code::Name,
        "Names begin with a small letter and go on with small letters, digits and single \
         underscores; some words of the language are taken.",
    ),
    (
        Code::Expression,
        "Mend the expression at the place that is underlined; docs/authoring.md has the grammar.",
    ),
    (
        Code::DuplicateName,
        "Rename one of the two; an include can be given a `name`.",
    ),
    (
        Code::UnknownResource,
        "Check the spelling, declare the material, or `bind` the shader's global to the one that \
         is meant.",
    ),
    (
        Code::UnknownParam,
        "Check the spelling, or declare the param.",
    ),
    (
        Code::ParamValue,
        "Give a value of the param's type between its `min` and `max`.",
    ),
    (
        Code::Input,
        "Give the included document what it asks for, by name or by `bind`; the host imports what \
         the root document asks for.",
    ),
    (
        Code::Edit,
        "Name an entry of the extended document; `skiagraph show FILE --flat` prints what it has.",
    ),
    (
        Code::Condition,
        "Give the pass that reads and the pass that writes conditions that agree.",
    ),
    (
        Code::ChoiceConstant,
        "Leave the constant out of the shader: the document's words bring it.",
    ),
    (
        Code::Range,
        "Name a part that there is; parts are counted from 0.",
    ),
    (
        Code::Alignment,
        "Let items be a multiple of the device's offset alignment apart: 256 bytes always are.",
    ),
    (
        Code::Size,
        "Give a size or count of one at least that the adapter can hold; shards of a large buffer \
         are materials of their own.",
    ),
    (
        Code::ResourceKind,
        "Name a material of the kind that is needed, or change what the shader declares.",
    ),
    (
        Code::FormatMismatch,
        "Change the material's format or the shader's type; `skiagraph doctor` lists what the \
         adapter can do.",
    ),
    (
        Code::LayoutMismatch,
        "Declare the item's type once, in a module that both shaders import.",
    ),
    (
        Code::Shader,
        "Mend the WGSL at the place that is underlined.",
    ),
    (
        Code::LibraryPanic,
        "Write it differently at the place that is underlined, and tell the library's authors.",
    ),
    (
        Code::EntryPoint,
        "Give the shader one entry point of the stage, or name one of several in the pass.",
    ),
    (
        Code::StageInterface,
        "Let the vertex shader write what the fragment shader reads: the same location, type and \
         interpolation.",
    ),
    (
        Code::Binding,
        "Leave `@group` and `@binding` out: the graph numbers globals. Bind what shaders have, to \
         materials that there are.",
    ),
    (
        Code::ReadBeforeWrite,
        "Let a pass write the material, clear it first, move the reader below one of several \
         writers, or read `….previous` if last frame's content is meant.",
    ),
    (
        Code::Cycle,
        "Write a second material, or read `….previous`.",
    ),
    (
        Code::FeedbackLoop,
        "Read a copy, another mip or layer, or `….previous`.",
    ),
    (
        Code::RunCondition,
        "Give the passes the same `run`, or one of them another material.",
    ),
    (
        Code::Import,
        "Make the texture or buffer with the usages that the help names.",
    ),
    (
        Code::Limit,
        "Use less: fewer or smaller targets, bindings, workgroups; or run on an adapter that has \
         more.",
    ),
    (
        Code::Memory,
        "Use a smaller viewport, smaller textures, fewer layers, a format with fewer bytes; or \
         allow more memory where there is more.",
    ),
    (
        Code::Feature,
        "Run on an adapter that has the feature, or ask `has(FEATURE)` in an `if`.",
    ),
    (
        Code::Value,
        "Let one of the values of the ring be made of params or sizes alone.",
    ),
    (
        Code::TwoCopies,
        "Put the include above the pass that writes in between, or give it a name.",
    ),
    (
        Code::Light,
        "Run it under a light of a kind that it takes; if its passes know others, say so in \
         `lights`.",
    ),
    (
        Code::Need,
        "Plan for a viewport, a scene and lights that meet it: `--size`, `--scene`, `--light`.",
    ),
    (Code::Unused, "Check the spelling, or take it out."),
    (
        Code::Output,
        "Declare the output, or name one that there is.",
    ),
];
