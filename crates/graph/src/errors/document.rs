//! Documents that cannot be read.

use crate::language::{Name, NameFault, RESERVED};
use crate::source::{Located, SourceFile, Span};

mistakes! {
    /// A mistake in the text of a document.
    DocumentError:

    NoDocument(file: SourceFile) =>
        Syntax("the file `{}` holds no document", file.name)
        .at(file.span(0..file.text.lines().next().map_or(0, str::len)), "")
        .help("begin with `(format: 3, …)`");

    NoFormat(place: Span) =>
        MissingField("the document does not say its format")
        .at(place, "").help("begin with `format: 3,`");

    Format(place: Span, version: u32) =>
        FormatVersion("documents of format {version} are not read")
        .at(place, "")
        .help(match version {
            1 => FORMAT_1,
            2 => FORMAT_2,
            _ => "this version of Skiagraph reads `format: 3`",
        });

    UnknownKind(tag: Located<String>, kinds: Vec<String>) =>
        UnknownVariant("unknown pass kind `{tag}`")
        .at(&tag, "no pass kind of this name is registered").suggest(&tag, kinds);

    UnknownParamType(tag: Located<String>) =>
        UnknownVariant("unknown type of param `{tag}`").at(&tag, "").suggest(&tag, PARAM_TYPES);

    UnknownMaterial(tag: Located<String>) =>
        UnknownVariant("unknown kind of material `{tag}`").at(&tag, "").suggest(&tag, MATERIALS);

    KeyTwice(key: Located<String>) =>
        DuplicateName("`{key}` is given twice").at(key, "the second one");

    Twice(what: &'static str, name: Located<String>, first: Span) =>
        DuplicateName("two of the name `{name}`: every {what} needs its own")
        .at(name, "the second one").at(first, "the first one");

    Untagged(span: Span, section: &'static str) =>
        Syntax("an entry begins with its kind")
        .at(span, match section {
            "params" => "for example `U32(name: \"…\", default: 1)`",
            "passes" => "for example `Compute(name: \"…\", …)`",
            _ => "for example `Texture(name: \"…\", …)`",
        })
        .suggest("", match section {
            "params" => &PARAM_TYPES[..],
            "passes" => &[],
            _ => &MATERIALS,
        });

    TooMany { what: &'static str, span: Span, count: usize, most: usize } =>
        Size("the {what} has {count} entries, {most} is the most")
        .at(span, "this one is too many")
        .help("let `repeat` say what is alike, or split the document and `Include` its parts");

    Name(place: Span, word: String, fault: NameFault) =>
        Name("`{word}` is not a name: {fault}").at(place, "");

    Reserved(name: Located<Name>) =>
        Name("`{name}` is a word of the language and names no material, group or include")
        .at(name, "")
        .help(format!("these words have a meaning of their own: {}", RESERVED.join(", ")));

    Unnamed(place: Span, word: String) =>
        Name("`{word}` is not a name: give the include one, `name: \"…\"`")
        .at(place, "this would be its name");

    BareWord(place: Span, word: String) =>
        Syntax("`{word}` has no value")
        .at(place, "")
        .help(
            "an expression stands in quotes, `\"viewport.size / 2\"`; a word of a Choice has small \
             letters",
        );

    Expose(place: Span) =>
        Syntax("`expose` is a list of names, or `All`")
        .at(place, "")
        .help("write `expose: [\"map_size\"]`, or `expose: All` for every param that is not set");

    NoString(place: Span) =>
        Syntax("a name in quotes is needed here").at(place, "for example `\"maps[2]\"`");

    NoTuple(place: Span) =>
        Syntax("a tuple of numbers is needed here").at(place, "for example `(1, 0)`");

    Load(place: Span) =>
        Syntax("this is not a value of `load`")
        .at(place, "").help("write `Load`, `LoadIf(\"…\")`, `Clear(0)` or `Clear(r, g, b, a)`");

    WriteMask(place: Span) =>
        Syntax("a write mask is needed here").at(place, "").help("write `rgb`, `true` or `false`");

    Area(place: Span) =>
        Syntax("an area is four whole numbers: `(x, y, width, height)`").at(place, "");

    BlendFactors(place: Span) =>
        Syntax("`Min` and `Max` have no factors but `One`")
        .at(place, "").help("leave `source` and `target` out");

    BlendConstant(place: Span, what: &'static str) =>
        Syntax("{what}").at(place, "").help("write `constant: 0.5` or `constant: (r, g, b, a)`");

    BlendConstants(place: Span) =>
        Syntax("a draw has one blend constant")
        .at(place, "this is a second one").help("draw to one of the targets in a pass of its own");

    FirstOfIndirect(place: Span) =>
        Syntax("the first vertex and instance of an indirect draw stand in its buffer")
        .at(place, "").help("write them there as the third and fourth u32, and leave this out");

    WhileAlone(field: Located<String>) =>
        MissingField("`while` ends a repetition, and this group has none")
        .at(field, "").help("write how many rounds there are at most: `repeat: 32`");

    Canvas(place: Span) =>
        Syntax("the size of a pass is one number or two: `(width, height)`").at(place, "");

    ClearInArea { clear: Span, area: Span } =>
        Syntax("clearing knows no area")
        .at(clear, "this would clear the whole target").at(area, "and this is a part of it")
        .help(
            "leave `load` out here, which keeps what is there, and put a `Clear` above this pass, \
             with an `if` where a condition decides",
        );

    Data(place: Span) =>
        Syntax("a list of items is needed here")
        .at(place, "").help("write `[0.2, 0.6]` or `[(1, 0), (0, 1)]`");

    InputFormat(place: Span) =>
        Syntax("an input's format is written out")
        .at(place, "").help("leave `format` out where any will do");

    Param(name: Located<Name>, why: String) =>
        ParamValue("the param `{name}` cannot be: {why}").at(name, "");

    Tune(name: String, value: Span, why: String) =>
        ParamValue("`tune` of the param `{name}` cannot be").at(value, why)
        .help("`tune` lists the values that `compare --tune` tries, two at least, each once");
}

/// The types of params, as documents write them.
pub(crate) const PARAM_TYPES: [&str; 8] = [
    "F32", "I32", "U32", "Bool", "Vec2", "Vec3", "Vec4", "Choice",
];

/// The kinds of materials and inputs.
const MATERIALS: [&str; 3] = ["Texture", "Buffer", "Sampler"];

/// Help for documents in format 2: the changes since.
const FORMAT_2: &str = "this is format 3 (docs/authoring.md): write `format: 3`; `refused` of a \
    param is `narrow` of the document; shadow maps come from `shared/create_shadow_map.ron` and \
    their place from `shared/fit_map.ron`, which give `map_layers` and `map_is_projective`, too: \
    a shader that reads one layer must `narrow` the words pssm and tsm of `fit` away; the fit \
    `eye` is `camera`, `tighten` is `fit_to_receivers`, `focus` is `warp`; a shader `x_masked` is \
    `x` with `imports`";

/// Help for documents in format 1: the changes since.
const FORMAT_1: &str = "this is format 3 (docs/authoring.md): a param is `U32(name: …)`, an \
    expression stands in quotes (`size: \"map_size\"`, `count: \"scene.indices.count\"`), \
    `\"x.previous\"` and `\"x.mip[1]\"` are references, included documents state `inputs` and \
    `outputs`, and `Include` has `name`, `bind`, `set` and `expose`";
