//! Every mistake that `src/errors` knows is made by a document of `tests/broken`: the messages are
//! read from the sources, and looked for among what the documents are told.

use crate::broken;
use skiagraph_graph::Diagnostic;
use std::{collections::BTreeSet, path::Path};

/// Mistakes whose message is that of another one, too, or has no words of its own, with a document
/// that makes them.
const BY_HAND: &[(&str, &str)] = &[
    ("DocumentError::Twice", "duplicate_material"),
    ("DocumentError::BlendConstant", "blend_no_constant"),
    ("ComposeError::NoInclude", "include_missing"),
    ("ComposeError::SameName", "duplicate_pass"),
    ("EvaluationError::Words", "param_cull"),
    ("EvaluationError::Unknown", "unknown_param"),
    ("EvaluationError::Negative", "negative_size"),
    ("InterfaceError::Need", "needs_unmet"),
    ("InterfaceError::UnwrittenOutput", "include_unwritten"),
    ("OutputError::UnwrittenOutput", "output_unwritten"),
    ("ShaderError::Naga", "unparsable"),
    ("LayoutError::Alignment", "item_alignment"),
    ("LinkError::Alignment", "item_alignment_provided"),
    ("LinkError::SetValue", "set_vector"),
    ("LinkError::InRounds", "rounds_clear"),
    ("LinkError::CopyFormat", "copy_format"),
    ("LinkError::CopySize", "copy_size"),
    ("LinkError::CopyKinds", "copy_kind"),
    ("TextureMisfit::Scalar", "sampled_type"),
];

/// Mistakes that no document makes, and why.
const ELSEWHERE: &[(&str, &str)] = &[
    (
        "LayoutError::Handed",
        "`gpu`, `on_cpu.rs`: a kind of a host",
    ),
    (
        "LinkError::NoCpuWork",
        "`gpu`, `on_cpu.rs`: a kind of a host",
    ),
    (
        "LinkError::CpuItems",
        "`gpu`, `on_cpu.rs`: a kind of a host",
    ),
    (
        "OutputError::NotProven",
        "`features.rs`: a backend of the request",
    ),
    (
        "DocumentError::TooMany",
        "`mistakes.rs`: lists of 4097 entries",
    ),
    (
        "ComposeError::NoDocument",
        "`mistakes.rs`: the root document",
    ),
    (
        "ComposeError::NoOpening",
        "`format_3.rs`: a document that is asked for",
    ),
    (
        "ComposeError::Unreadable",
        "`mistakes.rs`: files that are no text",
    ),
    (
        "ComposeError::UnreadableInclude",
        "`mistakes.rs`: files that are no text",
    ),
    (
        "ImportError::Unreadable",
        "`mistakes.rs`: files that are no text",
    ),
    (
        "ImportError::UnreadableFile",
        "`mistakes.rs`: files that are no text",
    ),
    ("ComposeError::TooDeep", "`compose.rs`: 80 documents"),
    ("ImportError::TooDeep", "`mistakes.rs`: 100 modules"),
    ("ShaderError::TooLong", "`hostile.rs`: a shader of a MiB"),
    (
        "ShaderError::TooManyDeclarations",
        "`hostile.rs`: thousands of declarations",
    ),
    ("ShaderError::NoLayout", "naga refuses such types before"),
    ("ParamError::Unknown", "`mistakes.rs`: a request"),
    ("ParamError::Asked", "`mistakes.rs`: a request"),
    (
        "InterfaceError::NoImport",
        "`mistakes.rs`: a request; `check` takes what is asked for as given",
    ),
    ("OutputError::NoOutput", "`mistakes.rs`: a request"),
    ("OutputError::NoMaterial", "`mistakes.rs`: a request"),
    ("OutputError::NoPass", "`mistakes.rs`: a request"),
    ("OutputError::Unsized", "`mistakes.rs`: a request"),
    ("OutputError::Sampler", "`mistakes.rs`: a request"),
    ("OutputError::Provided", "`mistakes.rs`: a request"),
    ("OutputError::Unwritten", "`mistakes.rs`: a request"),
    ("OutputError::Unreadable", "`mistakes.rs`: a request"),
    ("OutputError::NoViewport", "`mistakes.rs`: a request"),
    ("OrderError::Capture", "`mistakes.rs`: a request"),
    ("LinkError::NoShader", "a mistake of a pass kind, in Rust"),
    (
        "LinkError::ShaderNotLoaded",
        "a mistake of a pass kind, in Rust",
    ),
];

/// A variant, `Enum::Variant`, and what its message is made of between what is filled in.
struct Variant {
    name: String,
    literals: Vec<String>,
}

impl Variant {
    /// True if a message may be that of this variant.
    fn says(&self, message: &str) -> bool {
        let (Some(first), Some(last)) = (self.literals.first(), self.literals.last()) else {
            return false;
        };
        if !message.starts_with(first.as_str()) || !message.ends_with(last.as_str()) {
            return false;
        }
        let mut rest = message;
        self.literals
            .iter()
            .all(|literal| match rest.find(literal.as_str()) {
                Some(at) => {
                    rest = &rest[at + literal.len()..];
                    true
                }
                None => false,
            })
    }

    /// True if it has enough words to be told from others.
    fn is_plain(&self) -> bool {
        let letters = self.literals.concat();
        letters.chars().filter(|sign| sign.is_alphabetic()).count() > 5
    }
}

/// The string literal that a text begins with, and what follows it.
fn literal(text: &str) -> (String, &str) {
    let mut value = String::new();
    let mut signs = text.char_indices().skip(1);
    while let Some((at, sign)) = signs.next() {
        match sign {
            '"' => return (value, &text[at + 1..]),
            '\\' => match signs.next() {
                Some((_, '\n')) => {
                    let is_space = |(_, sign): &(usize, char)| sign.is_whitespace();
                    while signs.clone().next().as_ref().is_some_and(is_space) {
                        signs.next();
                    }
                }
                Some((_, sign)) => value.push(sign),
                None => break,
            },
            _ => value.push(sign),
        }
    }
    panic!("a string without an end: {text}");
}

/// A template without what is filled in.
fn pieces(template: &str) -> Vec<String> {
    let mut pieces = vec![String::new()];
    let mut depth = 0;
    for sign in template.chars() {
        match sign {
            '{' => {
                depth += 1;
                pieces.push(String::new());
            }
            '}' => depth -= 1,
            _ if depth == 0 => pieces.last_mut().expect("there is one").push(sign),
            _ => {}
        }
    }
    pieces
}

/// The variants of a file of `src/errors` with their messages.
fn variants(text: &str) -> Vec<Variant> {
    let mut variants = Vec::new();
    for declared in text.split("\nmistakes! {").skip(1) {
        let declared = &declared[..declared.find("\n}\n").expect("it ends")];
        let mut enum_name = "";
        for (at, _) in declared.match_indices("\n    ") {
            let own = word(&declared[at + 5..]);
            let rest = &declared[at + 5 + own.len()..];
            if !own.starts_with(char::is_uppercase) {
                continue;
            }
            if rest.starts_with(':') {
                enum_name = own;
                continue;
            }
            let text = &rest[rest.find("=>\n").expect("an arm follows")..];
            let text = &text[text.find('"').expect("it has a text")..];
            variants.push(Variant {
                name: format!("{enum_name}::{own}"),
                literals: pieces(&literal(text).0),
            });
        }
    }
    variants
}

fn word(text: &str) -> &str {
    let end = text.find(|sign: char| !sign.is_alphanumeric());
    &text[..end.unwrap_or(text.len())]
}

fn all_variants() -> Vec<Variant> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/errors");
    let files = std::fs::read_dir(folder).expect("it is part of the repository");
    let text = |file: std::io::Result<std::fs::DirEntry>| {
        std::fs::read_to_string(file.expect("it is readable").path()).expect("it is a text")
    };
    files.map(text).flat_map(|text| variants(&text)).collect()
}

#[test]
fn every_mistake_is_made_by_a_document() {
    let diagnosed = broken::all();
    let documents: BTreeSet<&str> = diagnosed.iter().map(|(name, _)| name.as_str()).collect();
    // Why a texture does not fit stands at its place.
    let texts = |mistake: &Diagnostic| {
        let labels = mistake.labels.iter().map(|label| label.text.clone());
        labels.chain([mistake.message.clone()]).collect::<Vec<_>>()
    };
    let messages = diagnosed
        .iter()
        .flat_map(|(_, mistakes)| mistakes.iter().flat_map(texts));
    let messages: Vec<String> = messages.collect();
    let variants = all_variants();
    assert!(
        variants.len() > 200,
        "only {} variants are read",
        variants.len()
    );
    let mut wrong = Vec::new();
    for variant in &variants {
        let name = variant.name.as_str();
        let by_hand = BY_HAND.iter().find(|(listed, _)| *listed == name);
        let elsewhere = ELSEWHERE.iter().any(|(listed, _)| *listed == name);
        let twins = variants
            .iter()
            .filter(|other| other.literals == variant.literals);
        let is_told_apart = variant.is_plain() && twins.count() == 1;
        let is_said = messages.iter().any(|message| variant.says(message));
        match (by_hand, elsewhere, is_told_apart) {
            (Some((_, document)), ..) if !documents.contains(document) => {
                wrong.push(format!("{name}: there is no document `{document}`"));
            }
            (None, false, false) => wrong.push(format!("{name}: which document makes it?")),
            (None, false, true) if !is_said => wrong.push(format!("{name}: no document makes it")),
            (None, true, true) if is_said => wrong.push(format!("{name}: a document makes it")),
            _ => {}
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The lists above name what there is.
#[test]
fn exceptions_are_variants() {
    let names: BTreeSet<String> = all_variants().into_iter().map(|v| v.name).collect();
    for (name, _) in BY_HAND.iter().chain(ELSEWHERE) {
        assert!(names.contains(*name), "{name} is no variant");
    }
}
