//! Edits of an extended document that cannot be made.

use crate::language::Name;
use crate::source::{Located, Span};

const PLACES: &str = "say `before`, `after` or `instead: \"entry\"`; without one, an entry stands \
    behind the new one above it";

mistakes! {
    /// An edit that cannot be made.
    EditError:

    NoSuchEntry(path: Located<String>, name: String, entries: Vec<String>) =>
        Edit("the extended document has no entry `{path}`").at(path, "").suggest(&name, entries);

    RemovesItem(place: Span) =>
        Edit("`Remove` takes out passes alone")
        .at(place, "").help(
            "leave it out: what the extended document declares goes by itself once nothing uses it"
        );

    Widens(name: Located<String>, word: Located<Name>, first: Span) =>
        Edit("`narrow` brings back the word `{word}` of `{name}`")
        .at(word, "widened here").at(first, "narrowed by the extended document")
        .help("`narrow` only takes words away: leave it out");

    Behind(path: Located<String>, entry: String) =>
        Edit("`{path}` stands behind the interface of `{entry}`")
        .at(path, "")
        .help(format!(
            "change the `graph` of `{entry}`; the new document may extend the old one"
        ));

    NoPlace(tag: Located<String>) =>
        Edit("a new `{tag}` needs a place").at(tag, "").help(PLACES);

    TwoPlaces(tag: Located<String>) =>
        Edit("a new `{tag}` has several places").at(tag, "").help(PLACES);

    NoPath(tag: Located<String>, field: &'static str) =>
        Edit("`{tag}` does not say which entry it is about")
        .at(tag, format!("give it `{field}: \"entry\"`"));

    NoString(place: Span) =>
        Edit("an entry is named in quotes").at(place, "for example `\"group.pass\"`");

    Field(name: Located<String>, owner: &'static str) =>
        Edit("`{owner}` has no such field").at(name, "not a field of this");

    Passes(place: Span) =>
        Edit("the entries of a group are changed one by one")
        .at(place, "").help("name them by their paths: `pass: \"group.pass\"`");

    NotExtending(word: Located<String>) =>
        Edit("`{word}` edits an extended document, and this one extends none")
        .at(word, "").help("begin the document with `extends: \"other.ron\"`");

    Cycle(place: Span, files: Vec<String>) =>
        IncludeCycle("the document extends itself")
        .at(place, "extends it again").help(format!("the cycle is {}", files.join(" → ")));
}
