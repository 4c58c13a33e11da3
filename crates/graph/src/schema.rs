//! JSON Schema of documents, made from the types that read them.

use crate::document::entries::{Header, IncludeFields, PassFields};
use crate::document::extend::PLACES;
use crate::document::materials::{
    BufferEntry, BufferInput, Data, FormatEntry, Mips, SamplerEntry, SamplerInput, TextureEntry,
    TextureInput,
};
use crate::document::params::ParamFields;
use crate::document::raw::{FORMAT, SECTIONS};
use crate::document::typed::{
    ClaimEntry, ClaimFields, Expose, ImportEntry, Narrow, Output, OutputFields,
};
use crate::errors::document::PARAM_TYPES;
use crate::fields::{Chosen, Load};
use crate::kinds::registry::{Kind, Registry};
use crate::language::name::Name;
use crate::language::syntax::{Expr, Reference};
use crate::source::span::Located;
use crate::written::{short_or_long, written};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value, json};
use skiagraph_located_ron::schema::plain;
use std::borrow::Cow;

/// A word of the language, to which a text in quotes is no alternative.
const WORD: &str = "^[A-Z][A-Za-z0-9]*$";

impl<T: JsonSchema> JsonSchema for Chosen<T> {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        T::schema_name()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let word = generator.subschema_for::<T>();
        json_schema!({ "anyOf": [word, { "type": "string", "not": { "pattern": WORD } }] })
    }
}

written!(Name, "Name", _generator => json_schema!({
    "description": "Small letters, digits and `_`; it begins with a letter and has no `__`. In a \
        shader it is the same.",
    "type": "string",
    "pattern": "^[a-z](_?[a-z0-9])*_?$",
}));

written!(Reference, "Reference", _generator => json_schema!({
    "description": "A material or a part of one: `\"image\"`, `\"maps[2]\"`, `\"maps[0..2]\"`, \
        `\"image.mip[1]\"`, `\"left.position\"`, `\"history.previous\"`.",
    "type": "string",
}));

written!(Expr, "Expression", generator => {
    let part = generator.subschema_for::<Self>();
    json_schema!({
        "description": "A number, `true` or `false`, a word, a tuple of these, or an expression in \
            quotes: `\"ceil_div(viewport.width, 2)\"`.",
        "type": ["number", "boolean", "string", "array"],
        "items": part,
    })
});

/// A map with these keys and no others, of which some must be there.
fn object(description: &str, properties: Value, required: &[&str]) -> Value {
    json!({
        "description": description,
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    })
}

written!(Load, "Load", generator => {
    let value = generator.subschema_for::<Expr>();
    let load_if = json!({ "LoadIf": value });
    let clear = json!({ "Clear": value });
    json_schema!({
        "description": "Operation on an attachment before the first draw.",
        "oneOf": [
            { "const": "Load", "description": "Keeps the content." },
            object(
                "Keeps the content under a condition, and clears else; not with an `area`.",
                load_if,
                &["LoadIf"],
            ),
            object("One value for all channels, or four.", clear, &["Clear"]),
        ],
    })
});

written!(Mips, "Mips", generator => {
    let number = generator.subschema_for::<Expr>();
    json_schema!({
        "description": "A number of mips, or `All`: down to one texel.",
        "anyOf": [{ "const": "All" }, number],
    })
});

written!(FormatEntry, "Format", _generator => json_schema!({
    "description": "A format by wgpu's name, or another's: `\"image.format\"`.",
    "anyOf": [
        { "type": "string", "enum": crate::language::formats::FORMATS },
        { "type": "string", "not": { "pattern": WORD } },
    ],
}));

written!(Data, "Data", _generator => json_schema!({
    "description": "Numbers, or tuples of them, one per scalar of the shader's type; expressions \
        stand in quotes.",
    "type": "array",
    "items": { "type": ["number", "array", "string"] },
}));

written!(Expose, "Expose", generator => {
    let list = generator.subschema_for::<Vec<Located<String>>>();
    json_schema!({
        "description": "Names of params, or `All` that are not set.",
        "anyOf": [list, {"const": "All"}],
    })
});

short_or_long!(Output, "Output", OutputFields);

written!(ClaimEntry, "Claim", generator => {
    let long = ClaimFields::json_schema(generator);
    let condition = generator.subschema_for::<Expr>();
    json_schema!({ "anyOf": [condition, long] })
});

/// Returns the JSON Schema (draft 2020-12) of graph documents (RON files) whose passes are of the
/// kinds in `registry`. It describes RON as JSON: `Kind(field: value)` is `{"Kind": {"field":
/// value}}`, a bare word is a string, a tuple is an array. The schema checks neither names nor
/// values of expressions; [`Graph::check`](crate::Graph::check) does.
pub fn schema(registry: &Registry) -> Value {
    let mut generator = SchemaGenerator::default();
    let mut sections = Map::new();
    let mut kinds = Kinds {
        kinds: registry.all(),
        generator: &mut generator,
        entries: Map::new(),
    };
    for (name, description) in SECTIONS {
        let mut schema = kinds.section(name);
        schema["description"] = description.into();
        sections.insert(name.to_owned(), schema);
    }
    let entries = kinds.entries;
    let mut defs = generator.take_definitions(true);
    defs.extend(entries);
    let mut document = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Skiagraph document",
        "type": "object",
        "properties": sections,
        "required": ["format"],
        "additionalProperties": false,
        "$defs": defs,
    });
    plain(&mut document);
    document
}

fn reference(name: &str) -> Value {
    json!({ "$ref": format!("#/$defs/{name}") })
}

/// A list of `Tag(…)`, each with what its fields may be.
fn tagged(tags: impl IntoIterator<Item = (String, Value)>) -> Value {
    json!({
        "type": "array",
        "items": {
            "type": "object",
            "properties": Map::from_iter(tags),
            "minProperties": 1,
            "maxProperties": 1,
            "additionalProperties": false,
        },
    })
}

struct Kinds<'k> {
    kinds: &'k [Kind],
    generator: &'k mut SchemaGenerator,
    /// Schemas of the entries of `passes`, with their common fields.
    entries: Map<String, Value>,
}

impl Kinds<'_> {
    fn schema<T: JsonSchema>(&mut self) -> Value {
        self.generator.subschema_for::<T>().to_value()
    }

    fn list<T: JsonSchema>(&mut self) -> Value {
        self.schema::<Vec<T>>()
    }

    fn map<T: JsonSchema>(&mut self) -> Value {
        json!({ "type": "object", "additionalProperties": self.schema::<T>() })
    }

    fn section(&mut self, name: &str) -> Value {
        match name {
            "format" => json!({ "const": FORMAT }),
            "requires" => self.list::<String>(),
            "needs" => self.list::<Expr>(),
            "params" => {
                let fields = self.schema::<ParamFields>();
                let params = PARAM_TYPES.map(|tag| (tag.to_owned(), fields.clone()));
                tagged(params)
            }
            "set" | "values" => self.map::<Expr>(),
            "narrow" => self.map::<Narrow>(),
            "imports" => self.list::<ImportEntry>(),
            "inputs" => tagged([
                ("Texture".to_owned(), self.schema::<TextureInput>()),
                ("Buffer".to_owned(), self.schema::<BufferInput>()),
                ("Sampler".to_owned(), self.schema::<SamplerInput>()),
            ]),
            "materials" => tagged([
                ("Texture".to_owned(), self.schema::<TextureEntry>()),
                ("Buffer".to_owned(), self.schema::<BufferEntry>()),
                ("Sampler".to_owned(), self.schema::<SamplerEntry>()),
            ]),
            "passes" => self.passes(),
            "outputs" => self.list::<Output>(),
            "lights" | "proven_on" => self.list::<Name>(),
            "claims" => self.map::<ClaimEntry>(),
            // `extends`, `description`
            _ => json!({ "type": "string" }),
        }
    }

    fn passes(&mut self) -> Value {
        let every_entry = self.every_entry();
        let every_pass = self.fields::<PassFields>("Fields of every pass.");
        let mut tags = Vec::new();
        let mut entry = |tag: &str, own: Value, common: &[&Value], entries: &mut Map<_, _>| {
            entries.insert(tag.to_owned(), joined(tag, own, common));
            tags.push((tag.to_owned(), reference(tag)));
        };
        for kind in self.kinds {
            let any = || json_schema!({ "type": "object", "additionalProperties": true });
            let schema = kind.schema.map_or_else(any, |make| make(self.generator));
            let common = [&every_entry, &every_pass];
            entry(kind.name, schema.to_value(), &common, &mut self.entries);
        }
        let include = IncludeFields::json_schema(self.generator).to_value();
        let group = object(
            "Entries that have a name, a condition, a repetition in common.",
            json!({
                "passes": { "description": "The entries.", "$ref": "#/$defs/Entries" },
                "while": {
                    "description": "A buffer: rounds of the repetition run while its first u32 is \
                        not 0.",
                    "type": "string",
                },
            }),
            &["passes"],
        );
        let path = json!({ "description": "Its path: `\"blur.x\"` is `x` of the group `blur`.",
            "type": "string" });
        let path = json!({ "pass": path });
        let change = "An entry of the extended document gets other fields, and more.";
        let mut change = object(change, path.clone(), &["pass"]);
        change["additionalProperties"] = true.into();
        let remove = "An entry of the extended document is left out.";
        let remove = object(remove, path, &["pass"]);
        entry("Include", include, &[&every_entry], &mut self.entries);
        entry("Group", group, &[&every_entry], &mut self.entries);
        entry("Change", change, &[], &mut self.entries);
        entry("Remove", remove, &[], &mut self.entries);
        let mut list = tagged(tags);
        list["description"] = "Entries, in order.".into();
        self.entries.insert("Entries".to_owned(), list);
        self.entries.insert("EveryEntry".to_owned(), every_entry);
        self.entries.insert("EveryPass".to_owned(), every_pass);
        reference("Entries")
    }

    /// Returns the schema of a type's fields, with another sentence about them.
    fn fields<T: JsonSchema>(&mut self, description: &str) -> Value {
        let mut fields = T::json_schema(self.generator).to_value();
        fields["description"] = description.into();
        fields
    }

    /// Returns the fields of every entry: those that are read with it, its maps, and its place in
    /// an edit.
    fn every_entry(&mut self) -> Value {
        let mut every = self.fields::<Header>("Fields of every entry.");
        let properties = &mut every["properties"];
        properties["bind"] = self.map::<Reference>();
        properties["bind"]["description"] =
            "Other materials for globals of the shader, or inputs of the document.".into();
        properties["set"] = self.map::<Expr>();
        properties["set"]["description"] =
            "Values of the shader's params and constants, or the document's params.".into();
        for place in PLACES {
            let description = format!(
                "In an edit: the entry that this one stands {place}{}.",
                if place == "instead" { " of" } else { "" }
            );
            properties[place] = json!({ "description": description, "type": "string" });
        }
        every
    }
}

/// Fields of an entry with those that it has in common with others. Only an include need have no
/// name.
fn joined(tag: &str, mut own: Value, common: &[&Value]) -> Value {
    let Some(fields) = own.as_object_mut() else {
        return own;
    };
    let properties = fields.entry("properties").or_insert_with(|| json!({}));
    for more in common {
        let more = more["properties"].as_object();
        for (name, schema) in more.into_iter().flatten() {
            properties[name] = schema.clone();
        }
    }
    if !common.is_empty() && tag != "Include" {
        let required = fields.entry("required").or_insert_with(|| json!([]));
        if let Some(required) = required.as_array_mut() {
            required.push("name".into());
        }
    }
    own
}
