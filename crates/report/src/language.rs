//! Writes the reference of the language of graph documents in Markdown, from the JSON Schema of
//! documents.

use crate::table;
use itertools::Itertools;
use serde_json::Value;
use skiagraph_compare::wording::or_nothing;
use std::collections::BTreeSet;

/// Text before the first heading of the page.
const HEAD: &str = "# The language of documents: reference

Format 3, as the types that read it have it: `skiagraph schema --format markdown` made this page,
`skiagraph schema` is the same as a JSON Schema. [Writing a graph](authoring.md) explains it.

Fields in **bold** must be given; the others may be left out.
";

/// Returns the reference page of the language of graph documents in Markdown. `schema` is the JSON
/// Schema of documents.
pub fn markdown(schema: &Value) -> String {
    let mut page = Page {
        text: HEAD.to_owned(),
        defs: &schema["$defs"],
        told: BTreeSet::new(),
    };
    page.heading("## Document");
    page.table(schema, &BTreeSet::new());
    for section in ["params", "inputs", "materials"] {
        page.heading(&format!("## `{section}`"));
        page.tags(&schema["properties"][section]);
    }
    page.heading("## `passes`");
    for common in ["EveryEntry", "EveryPass"] {
        page.description(&page.defs[common]);
        page.table(&page.defs[common], &BTreeSet::new());
        page.told.insert(common.to_owned());
    }
    page.tags(&page.defs["Entries"]);
    page.heading("## Values");
    page.values();
    page.text
}

/// Returns the reference page of scene files in Markdown. `schema` is the JSON Schema of scene
/// files.
pub fn scenes(schema: &Value) -> String {
    let mut page = Page {
        text: "# Fields of scene files\n\nFields in **bold** must be given.\n".to_owned(),
        defs: &schema["$defs"],
        told: BTreeSet::new(),
    };
    page.table(schema, &BTreeSet::new());
    page.values();
    page.text
}

struct Page<'s> {
    text: String,
    defs: &'s Value,
    /// Names of definitions that have a heading of their own already.
    told: BTreeSet<String>,
}

impl<'s> Page<'s> {
    fn heading(&mut self, heading: &str) {
        self.text += &format!("\n{heading}\n");
    }

    fn description(&mut self, schema: &Value) {
        if let Some(description) = schema["description"].as_str() {
            self.prose(description);
        }
    }

    fn prose(&mut self, text: &str) {
        self.text += &format!("\n{}\n", wrapped(text, ""));
    }

    /// The fields of a struct but those that it has in common with others, those first that must be
    /// given.
    fn table(&mut self, definition: &Value, common: &BTreeSet<&String>) {
        let must = |name: &str| {
            let required = definition["required"].as_array();
            required.is_some_and(|required| required.iter().any(|field| field == name))
        };
        let own = |(name, _): &(&String, &Value)| !common.contains(name);
        let mut fields: Vec<_> = fields(definition).filter(own).collect();
        if fields.is_empty() {
            return;
        }
        fields.sort_by_key(|(name, _)| !must(name));
        self.text += "\n| field | value | |\n|---|---|---|\n";
        for (name, schema) in fields {
            let bold = if must(name) { "**" } else { "" };
            let name = format!("{bold}`{name}`{bold}");
            let value = self.value(schema);
            let what = schema["description"].as_str().unwrap_or_default();
            let row = [name, value, what.to_owned()].map(|cell| cell.replace('|', "\\|"));
            self.text += &format!("| {} |\n", row.join(" | "));
        }
    }

    /// The entries of a list of `Tag(…)`, those together that are described by the same.
    fn tags(&mut self, list: &Value) {
        let defs = self.defs;
        let mut groups: Vec<(Vec<&str>, &str)> = Vec::new();
        for (tag, body) in fields(&list["items"]) {
            let name = named(body).unwrap_or_default();
            match groups.last_mut().filter(|(_, last)| *last == name) {
                Some((tags, _)) => tags.push(tag),
                None => groups.push((vec![tag], name)),
            }
        }
        let common = ["EveryEntry", "EveryPass"].map(|name| &defs[name]);
        for (tags, name) in groups {
            let definition = &defs[name];
            let tags = tags.iter().map(|tag| format!("`{tag}`")).join(", ");
            self.heading(&format!("### {tags}"));
            self.description(definition);
            let has = |(name, _): (&String, _)| definition["properties"].get(name).is_some();
            let common = common.into_iter().filter(|common| fields(common).all(has));
            let names = common.flat_map(fields).map(|(name, _)| name);
            self.table(definition, &names.collect());
            self.told.insert(name.to_owned());
        }
    }

    /// Describes the values of fields: every definition that has not been told of.
    fn values(&mut self) {
        let defs = self.defs.as_object();
        for (name, definition) in defs.into_iter().flatten() {
            if self.told.contains(name) || name == "Entries" {
                continue;
            }
            self.heading(&format!("### {name}"));
            self.description(definition);
            let alternatives = either(definition);
            if definition["properties"].is_object() {
                self.table(definition, &BTreeSet::new());
            } else if let Some(words) = definition["enum"].as_array() {
                self.prose(&words.iter().map(quoted).join(", "));
            } else {
                for one in alternatives.into_iter().flatten() {
                    self.alternative(one);
                }
            }
        }
    }

    /// One of several things that a value may be: an item of a list, or a table.
    fn alternative(&mut self, one: &Value) {
        if one["properties"].is_object() && variant(one).is_none() {
            self.text += "\nOr with fields, `(name: …)`:\n";
            return self.table(one, &BTreeSet::new());
        }
        let what = or_nothing(one["description"].as_str(), |what| format!(": {what}"));
        let has_fields = |(_, body): &(&str, &Value)| body["properties"].is_object();
        if let Some((tag, body)) = variant(one).filter(has_fields) {
            self.prose(&format!("`{tag}`{what}"));
            return self.table(body, &BTreeSet::new());
        }
        let value = self.value(one);
        // A list begins after an empty line.
        let is_in_list = |last: &str| last.starts_with("- ") || last.starts_with("  ");
        let is_first = !self.text.lines().last().is_some_and(is_in_list);
        let gap = if is_first { "\n" } else { "" };
        self.text += &format!("{gap}- {}\n", wrapped(&format!("{value}{what}"), "  "));
    }

    fn values_of<'v>(&self, parts: impl IntoIterator<Item = &'v Value>) -> String {
        let parts = parts.into_iter();
        parts.map(|part| self.value(part)).join(", ")
    }

    /// Describes the values that a field may have, in a few words.
    fn value(&self, schema: &Value) -> String {
        if let Some(name) = named(schema) {
            return match name {
                "Entries" => "list of entries".to_owned(),
                _ => format!("[{name}](#{})", name.to_lowercase()),
            };
        }
        if let Some(constant) = schema.get("const") {
            return quoted(constant);
        }
        if let Some(words) = schema["enum"].as_array() {
            return words.iter().map(quoted).join(", ");
        }
        if let Some(several) = either(schema) {
            return several.iter().map(|one| self.value(one)).join(" or ");
        }
        if let Some((tag, inner)) = variant(schema) {
            return match inner["prefixItems"].as_array() {
                Some(parts) => format!("`{tag}`({})", self.values_of(parts)),
                None => format!("`{tag}`({})", self.value(inner)),
            };
        }
        match schema["type"].as_str() {
            Some("array") if schema["prefixItems"].is_array() => {
                let parts = schema["prefixItems"].as_array().into_iter().flatten();
                format!("({})", self.values_of(parts))
            }
            Some("array") if schema["items"]["properties"].is_object() => {
                let mut tags = fields(&schema["items"]).map(|(tag, _)| format!("`{tag}`"));
                format!("list of {}", tags.join(", "))
            }
            Some("array") => format!("list of {}", self.value(&schema["items"])),
            Some("object") => format!(
                "map of names to {}",
                self.value(&schema["additionalProperties"])
            ),
            Some("boolean") => "`true`, `false`".to_owned(),
            Some("integer") => "whole number".to_owned(),
            Some("number") => "number".to_owned(),
            Some("string") if schema["not"].is_object() => "expression in quotes".to_owned(),
            _ => "text".to_owned(),
        }
    }
}

/// The fields of a struct with their schemas.
fn fields(schema: &Value) -> impl Iterator<Item = (&String, &Value)> {
    schema["properties"].as_object().into_iter().flatten()
}

/// The name of the definition that a schema refers to.
fn named(schema: &Value) -> Option<&str> {
    schema["$ref"].as_str()?.strip_prefix("#/$defs/")
}

/// The tag and body of `Tag(…)`.
fn variant(schema: &Value) -> Option<(&str, &Value)> {
    let fields = schema["properties"].as_object()?;
    let (tag, body) = fields.iter().next()?;
    let is_tag = fields.len() == 1 && tag.starts_with(|c: char| c.is_uppercase());
    is_tag.then_some((tag, body))
}

/// The alternatives that a value has.
fn either(schema: &Value) -> Option<&Vec<Value>> {
    let mut keys = ["anyOf", "oneOf"].into_iter();
    keys.find_map(|key| schema[key].as_array())
}

/// Text in lines of at most 100 columns, those after the first indented.
fn wrapped(text: &str, indent: &str) -> String {
    let text = table::wrapped(text, 100 - indent.len());
    text.replace('\n', &format!("\n{indent}"))
}

fn quoted(word: &Value) -> String {
    let word = word
        .as_str()
        .map_or_else(|| word.to_string(), str::to_owned);
    format!("`{word}`")
}
