//! Buffers whose size or layout does not fit.

use crate::source::{Located, Span};

mistakes! {
    /// A buffer whose size or layout does not fit.
    LayoutError:

    /// One name of a member at two offsets, of layouts that agree otherwise.
    Swapped { name: String, member: String, offsets: [usize; 2], spans: [Span; 2] } =>
        LayoutMismatch("`{member}` stands at two places in the items of `{name}`")
        .at(&spans[1], format!("here it is at byte {}", offsets[1]))
        .at(&spans[0], format!("here it is at byte {}", offsets[0]))
        .help("declare the item type once, in a shared module that both import");

    Disagreement(name: String, layouts: [String; 2], spans: [Span; 2]) =>
        LayoutMismatch("two shaders see `{name}` with different layouts")
        .at(&spans[1], format!("here it is {}", layouts[1]))
        .at(&spans[0], format!("here it is {}", layouts[0]))
        .help("declare the item type once, in a shared module that both import");

    Provided { name: String, stride: u64, layout: String, span: Span } =>
        LayoutMismatch("`{name}` has items of {stride} bytes")
        .at(span, format!("the shader sees {layout}"));

    Import { name: String, have: u64, needed: u64, span: Span } =>
        LayoutMismatch("the import `{name}` has {have} bytes, {needed} are needed")
        .at(span, "needed here");

    NoCount(name: String, span: Span, declared: Option<Span>) =>
        Size("`{name}` does not say how many items it has")
        .at(span, "this shader sees an array of any length").at_any(declared, "give it a `count`");

    IgnoredCount(name: String, span: Span, declared: Option<Span>) =>
        Size("the `count` of `{name}` has no effect")
        .at_any(declared, "leave `count` out here").at(span, "this shader sees a fixed size");

    TooLarge { name: String, bytes: u64, most: u64, declared: Option<Span> } =>
        Size("`{name}` needs {bytes} bytes, more than the adapter can bind")
        .at_any(declared, "").help(format!("its limit is {most} bytes"));

    Item { name: String, have: u64, needed: u64, span: Span } =>
        LayoutMismatch(
            "the items of `{name}` that are bound here have {have} bytes, the shader's {needed}"
        )
        .at(span, "seen here")
        .help("let another shader see the buffer as an array of such items");

    Handed { name: String, have: u64, needed: u64, span: Span } =>
        LayoutMismatch("the items of `{name}` have {have} bytes, the CPU's {needed}")
        .at(span, "handed to the CPU here");

    Alignment { name: String, stride: u64, alignment: u64, span: Span } =>
        Alignment("items of `{name}` are {stride} bytes apart, and cannot be bound alone")
        .at(span, "bound here")
        .help(format!(
            "a multiple of {alignment} is needed, which `@size({alignment})` on a member of the \
             item gives"
        ));

    Copy { from: Located<String>, to: Located<String>, bytes: [u64; 2] } =>
        Size("`{from}` cannot be copied onto `{to}`: they differ in size")
        .at(from, format!("{} bytes", bytes[0])).at(to, format!("{} bytes", bytes[1]))
        .help("give both the same `count`");

    Data { name: String, what: String, span: Span, declared: Option<Span> } =>
        LayoutMismatch("the data of `{name}` do not fit its shader: {what}")
        .at_any(declared, "").at(span, "this shader sees it");
}
