//! Writes a document out with everything that it extends, each line with its origin.

use super::raw::{Invalid, RawDocument, RawEntry, RawItem, RawMap};
use super::typed::Document;
use crate::source::Span;
use skiagraph_located_ron::reader::{Field, Node};

/// Returns a document as text in format 3, with the documents that it extends merged in. Reading
/// the text gives an equal document.
pub(crate) fn flat(document: &RawDocument) -> String {
    let mut flat = Flat::default();
    flat.line(0, "(", &[]);
    flat.line(1, "format: 3,", &[]);
    if let Some(node) = &document.description {
        flat.line(1, &format!("description: {},", node.text()), &[node]);
    }
    flat.list("requires", &document.requires, Flat::node);
    flat.list("needs", &document.needs, Flat::node);
    flat.list("params", &document.params, Flat::item);
    flat.map(1, "set", &document.set);
    flat.map(1, "narrow", &document.narrow);
    flat.list("imports", &document.imports, Flat::node);
    flat.map(1, "values", &document.values);
    flat.list("inputs", &document.inputs, Flat::item);
    flat.list("materials", &document.materials, Flat::item);
    flat.list("passes", &document.passes, |flat, entry| {
        flat.entry(2, entry)
    });
    flat.list("outputs", &document.outputs, Flat::node);
    flat.list("lights", &document.lights, Flat::node);
    flat.list("proven_on", &document.proven_on, Flat::node);
    flat.map(1, "claims", &document.claims);
    flat.line(0, ")", &[]);
    flat.text
}

/// Removes the params, values, inputs and materials from `raw` that `document` does not have;
/// `document` was read from `raw`.
pub(crate) fn keep(raw: &mut RawDocument, document: &Document) {
    // Those that an include exposes stand there.
    let params = document.params[..document.declared].iter();
    let params: Vec<&str> = params.map(|it| it.name.as_str()).collect();
    let materials = document.materials.iter().map(|it| it.name().as_str());
    let inputs = document.inputs.iter().map(|it| it.name.as_str());
    let values = document.values.iter().map(|(name, _)| name.as_str());
    let names: Vec<&str> = materials.chain(inputs).chain(values).collect();
    let is_kept = |item: &RawItem, names: &[&str]| {
        item.name()
            .is_none_or(|name| names.contains(&name.as_str()))
    };
    raw.params.retain(|item| is_kept(item, &params));
    raw.inputs.retain(|item| is_kept(item, &names));
    raw.materials.retain(|item| is_kept(item, &names));
    raw.values
        .retain(|(name, _)| names.contains(&name.as_str()));
}

#[derive(Default)]
struct Flat {
    text: String,
}

impl Flat {
    /// A line, or several where the source has several, and where it comes from.
    fn line(&mut self, depth: usize, content: &str, origins: &[&Span]) {
        let mut places: Vec<String> = Vec::new();
        for origin in origins {
            let place = format!("{}:{}", origin.file.name, origin.line_column().0);
            if !places.contains(&place) {
                places.push(place);
            }
        }
        self.text.push_str(&"    ".repeat(depth));
        self.text.push_str(content);
        if !places.is_empty() {
            self.text.push_str(&format!(" // {}", places.join(", ")));
        }
        self.text.push('\n');
    }

    fn list<T>(&mut self, section: &str, list: &[T], write: impl Fn(&mut Self, &T)) {
        if !list.is_empty() {
            self.line(1, &format!("{section}: ["), &[]);
            list.iter().for_each(|part| write(self, part));
            self.line(1, "],", &[]);
        }
    }

    fn node(&mut self, node: &Node) {
        self.line(2, &format!("{},", node.text()), &[node]);
    }

    fn item(&mut self, item: &RawItem) {
        let content = format!("{}({}),", *item.tag, fields(&item.fields));
        self.line(2, &content, &origins(&item.tag.span, &item.fields));
    }

    fn map(&mut self, depth: usize, section: &str, map: &RawMap) {
        if map.is_empty() {
            return;
        }
        self.line(depth, &format!("{section}: {{"), &[]);
        for (key, value) in map {
            let content = format!("{}: {},", key.span.text(), value.text());
            self.line(depth + 1, &content, &[&key.span]);
        }
        self.line(depth, "},", &[]);
    }

    fn entry(&mut self, depth: usize, entry: &Result<RawEntry, Invalid>) {
        let Ok(entry) = entry else {
            return;
        };
        let origins = origins(&entry.tag.span, &entry.fields);
        let head = format!("{}({}", *entry.tag, fields(&entry.fields));
        if entry.bind.is_empty() && entry.set.is_empty() && entry.passes.is_none() {
            self.line(depth, &format!("{head}),"), &origins);
            return;
        }
        let comma = if entry.fields.is_empty() { "" } else { "," };
        self.line(depth, &format!("{head}{comma}"), &origins);
        self.map(depth + 1, "bind", &entry.bind);
        self.map(depth + 1, "set", &entry.set);
        if let Some(passes) = &entry.passes {
            self.line(depth + 1, "passes: [", &[]);
            passes.iter().for_each(|entry| self.entry(depth + 2, entry));
            self.line(depth + 1, "],", &[]);
        }
        self.line(depth, "),", &[]);
    }
}

fn fields(fields: &[Field]) -> String {
    let field = |field: &Field| format!("{}: {}", *field.name, field.node.text());
    fields.iter().map(field).collect::<Vec<_>>().join(", ")
}

/// The lines that an entry comes from.
fn origins<'a>(tag: &'a Span, fields: &'a [Field]) -> Vec<&'a Span> {
    let mut origins = vec![tag];
    // Lines of one file are one entry; a field of another file is an edit.
    let edited = fields.iter().map(|field| &field.name.span);
    origins.extend(edited.filter(|span| span.file.name != tag.file.name));
    origins
}
