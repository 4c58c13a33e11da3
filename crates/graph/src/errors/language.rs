//! Mistakes in expressions and references.

use crate::language::{Attribute, Function, NameFault};
use crate::source::{Located, Span};

mistakes! {
    /// An expression or reference that cannot be read.
    SyntaxFault:

    Sign(place: Span, sign: char) =>
        Expression("`{sign}` has no meaning here").at(place, "here");

    Number(place: Span) =>
        Expression("`{}` is not a number", place.text()).at(place, "here");

    TooLong(place: Span, most: usize) =>
        Expression("the expression is too long")
        .at(place, "").help(format!("an expression has at most {most} words and signs"));

    Unexpected(span: Span, token: String, expected: String) =>
        Expression("{expected} is expected, not {token}").at(span, "here");

    Name(place: Span, fault: NameFault) =>
        Name("`{}` is not a name", place.text()).at(place, fault.to_string());

    Function(name: Located<String>) =>
        Expression("unknown function `{name}`")
        .at(&name, "")
        .suggest(&name, Function::ALL.iter().map(|(name, ..)| *name).chain(["has"]));

    Feature(name: Located<String>) =>
        Feature("wgpu has no feature `{name}`")
        .at(&name, "")
        .suggest(&name, wgt::Features::all().iter_names().map(|(name, _)| name));

    Arguments { span: Span, function: &'static str, expected: usize, given: usize } =>
        Expression("`{function}` takes {expected} arguments, not {given}").at(span, "here");

    /// End of a reference, such as `.previous` or `.mip[0]`, in the wrong place.
    Part(place: Span, part: &'static str) =>
        Expression("`{}` does not stand here", place.text())
        .at(place, match part {
            "number" => "a part of a material is not a number",
            "attribute" => "an attribute, where a material is named",
            "mip" => "`.mip[…]` follows the name of a material",
            _ => "`.previous` and `.mip[…]` end a reference, in this order",
        })
        .help_any((part == "number").then(|| {
            format!("ask for an attribute of it: {}", attributes())
        }));

    Escape(place: Span) =>
        Expression("strings of the language have no escapes")
        .at(place, "`\\` here").help("write the signs themselves");
}

/// Returns the attributes of materials as a list in words, for messages.
pub(crate) fn attributes() -> String {
    let attributes = Attribute::ALL.iter().map(|(_, attribute)| *attribute);
    let of_materials = attributes.filter(|attribute| *attribute != Attribute::Index);
    let of_materials = of_materials.map(|attribute| format!("`.{}`", attribute.as_str()));
    let names: Vec<String> = of_materials.collect();
    names.join(", ")
}
